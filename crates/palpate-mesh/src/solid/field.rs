// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The field of a solid: nearest points, sheets and walls.
//!
//! Faces that do not bound the solid: it is on both of their sides, or on neither.
//!
//! On each side of a piece that nothing crosses or touches, the winding number is the same all over. So the winding
//! numbers on both sides of one face tell whether the piece is surface.

use palpate_field::scalar::AffineModel;
use palpate_field::{
    Aabb, Bounds, CustomField, LARGEST_LENGTH, Point, Promise, Quality, SMALLEST_LENGTH, Shape,
    Vector,
};

use super::planes::{Corner, MOST_FACES, Middle, feet, highest_within};
use super::winding::{Winding, WindingTree, share};
use super::{MOST_GROUPS, OPERATIONS, Ordered, Signs, Solid, SolidError, Surface};
use crate::mesh::Mesh;
use crate::tree::FAN;

/// The least cosine, of about 80°, between the first normal and any other with which a cell that the surface passes gets
/// a model, unless the normals are few.
const LEAST_COSINE: f64 = 0.17;

/// The same where the winding number tells the sign.
const LEAST_COSINE_OF_SIGNS: f64 = 0.5 + 1e-9;

/// A model by normals is taken if its remainder is at most this share of another's.
const FLATTER: f64 = 0.75;

impl<const N: usize, const D: usize> CustomField<D> for Solid<N, D> {
    fn distance(&self, p: Point<D>) -> f64 {
        self.at(p, &mut None).0
    }

    fn distance_gradient(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        self.at(p, &mut None)
    }

    fn distances(&self, points: &[Point<D>], distances: &mut [f64]) {
        let mut known = None;
        for (p, distance) in points.iter().zip(distances) {
            (*distance, _) = self.at(*p, &mut known);
        }
    }

    fn distances_gradients(
        &self,
        points: &[Point<D>],
        distances: &mut [f64],
        gradients: &mut [Vector<f64, D>],
    ) {
        let mut known = None;
        for ((p, distance), gradient) in points.iter().zip(distances).zip(gradients) {
            (*distance, *gradient) = self.at(*p, &mut known);
        }
    }

    fn promise(&self) -> &Promise<D> {
        self.promise()
    }

    fn model<const M: usize>(&self, cell: &[AffineModel<M>; D]) -> AffineModel<M> {
        let centre = Vector(cell.map(|x| x.value));
        let radius = AffineModel::radius(cell);
        let rounding = self.promise().rounding.within(centre.norm() + radius);
        if !centre.is_finite() {
            return AffineModel::lipschitz(f64::NAN, 1.0, cell, rounding);
        }
        let nearest = self.surface.nearest(centre, None);
        let (f, gradient) = self.at_foot(centre, &nearest);
        let middle = Middle { centre, radius, rounding, f, gradient };
        let distance = f.abs();
        let model = if distance <= radius + rounding {
            let lipschitz = AffineModel::lipschitz(f, 1.0, cell, rounding);
            let across = self.model_across(cell, f, radius, rounding);
            across.filter(|model| model.lower < lipschitz.lower).unwrap_or(lipschitz)
        } else {
            let away = if f < 0.0 { -gradient } else { gradient };
            let nearest = (nearest.0, distance, away);
            match self.surface.model_of_distance(cell, nearest, radius, rounding) {
                None => AffineModel::lipschitz(f, 1.0, cell, rounding),
                Some(model) if f < 0.0 => AffineModel {
                    value: -model.value,
                    gradient: model.gradient.map(|side| -side),
                    lower: model.upper,
                    upper: model.lower,
                },
                Some(model) => model,
            }
        };
        let model = self.model_of_plane(cell, &middle, &model).unwrap_or(model);
        let model = self.model_of_sides(cell, &middle, &model).unwrap_or(model);
        self.model_of_normals(cell, &middle, &model).unwrap_or(model)
    }

    /// The vertices and faces as they were mended, of which all else follows.
    fn content(&self, sink: &mut dyn FnMut(&[u8])) -> bool {
        content(&self.vertices, &self.elements, sink);
        true
    }

    fn faces(&self, visit: &mut dyn FnMut([Point<D>; D])) -> bool {
        let Promise { outside, inside, .. } = self.promise();
        // Else faces lie within the solid, or it is counted twice where it overlaps itself.
        let are_boundary = N == D && *outside == Quality::Exact && *inside == Quality::Exact;
        if are_boundary {
            for face in 0..self.surface.faces.len() {
                let corners = self.surface.faces.corners(face);
                visit(std::array::from_fn(|i| corners[i]));
            }
        }
        are_boundary
    }
}

impl<const N: usize, const D: usize> Solid<N, D> {
    /// A model of the signed distance `f` at the centre of a cell that the surface may pass; `None` if too many faces
    /// may be nearest somewhere in it, if they face too many and too different ways, or if one of them may not be
    /// surface.
    ///
    /// Wherever the gradient exists, it is a unit vector in the cone of the outward normals of the faces at the
    /// nearest point: a vertex or an edge is nearest only to points whose direction from it is in the polar cone of
    /// what it bounds, and the extreme rays of that cone are in the cones of two faces each. So the derivative along
    /// each side of the cell is in the range of the normals' components, widened by what normalising a sum of them
    /// may add; the mean value form does the rest.
    fn model_across<const M: usize>(
        &self,
        cell: &[AffineModel<M>; D],
        f: f64,
        radius: f64,
        rounding: f64,
    ) -> Option<AffineModel<M>> {
        let centre = Vector(cell.map(|x| x.value));
        let farthest = f.abs() + 2.0 * radius + rounding;
        let (reach, least_cosine) = match self.signs {
            None => (farthest, LEAST_COSINE),
            Some(_) => (2.0 * farthest * (1.0 + 1e-9), LEAST_COSINE_OF_SIGNS),
        };
        let mut slopes = Slopes::of(cell);
        let (mut groups, mut is_known) = (0, true);
        let mut walk = self.surface.boxes.from(centre);
        while let Some(group) = walk.next(reach * reach) {
            groups += 1;
            for (face, is_nearest) in self.surface.faces.near(group, centre, [reach, farthest])
            {
                let (cosine, is_of_corner) =
                    slopes.take(self.normals.of_face(face), is_nearest);
                is_known &= cosine > least_cosine || self.signs.is_none() && is_of_corner;
            }
            if !is_known || groups > MOST_GROUPS || slopes.width() > radius {
                return None;
            }
        }
        if !self.are_surface(centre, slopes.first? * (2.0 * farthest)) {
            return None;
        }
        slopes.model(cell, f, rounding)
    }

    /// The same model, of the faces that may be nearest as another model of the field bounds their distance: it is for
    /// cells that one does not prove to be outside. `None` if it says not much more, or the winding number tells the
    /// sign.
    fn model_of_normals<const M: usize>(
        &self,
        cell: &[AffineModel<M>; D],
        middle: &Middle<D>,
        model: &AffineModel<M>,
    ) -> Option<AffineModel<M>> {
        let Middle { centre, radius, rounding, f, .. } = *middle;
        if self.signs.is_some() || f < -radius || model.minimum() > 0.0 {
            return None;
        }
        let feet = feet(cell, middle, model);
        let mut slopes = Slopes::of(cell);
        let mut faces = 0;
        self.surface.boxes.try_overlapping(&feet, |group| {
            for (face, _) in self.surface.faces.near(group, centre, [f.abs() + 2.0 * radius; 2])
            {
                let corners = self.surface.faces.corners(face);
                if highest_within(&feet, corners, centre, Vector::ZERO) < 0.0 {
                    continue;
                }
                let (cosine, is_of_corner) = slopes.take(self.normals.of_face(face), true);
                (cosine > LEAST_COSINE || is_of_corner).then_some(())?;
            }
            faces += FAN;
            (faces <= MOST_FACES && slopes.width() <= FLATTER * model.lower).then_some(())
        })?;
        let found = slopes.model(cell, f, rounding)?;
        (found.lower < FLATTER * model.lower).then_some(found)
    }

    /// Whether all faces in the ball of half the length of `across` bound the solid. The normals of all faces in the ball
    /// of its whole length must be within 60° of it.
    ///
    /// The winding number grows by one behind each face. From every point of the smaller ball the way to the end of
    /// `-across` leads in at all faces that it meets, the way to the end of `across` out. So the winding number in the
    /// ball is between those at the two ends: if these are 1 and 0, each face parts the inside from the outside.
    fn are_surface(&self, centre: Point<D>, across: Vector<f64, D>) -> bool {
        let Some(Signs { faces, tree }) = &self.signs else { return true };
        // Walls that were dropped change the winding number too.
        if faces.len() > self.surface.faces.len() {
            return false;
        }
        let is = |p: Point<D>, number: f64| {
            let is_settled = |w: Winding| w.error < 0.4;
            let found = tree.settled(faces, p, is_settled);
            (found.number - number).abs() + found.error < 0.5
        };
        is(centre - across, 1.0) && is(centre + across, 0.0)
    }
}

/// The slopes of the field along the sides of a cell, by the normals of the faces that may be nearest.
struct Slopes<const M: usize, const D: usize> {
    sides: [Vector<f64, D>; M],
    /// Of the components of the normals along the sides.
    ranges: [[f64; 2]; M],
    first: Option<Vector<f64, D>>,
    /// The least cosine of another normal with the first.
    least: f64,
    corner: Corner<D>,
}

impl<const M: usize, const D: usize> Slopes<M, D> {
    /// Of no normals yet.
    fn of(cell: &[AffineModel<M>; D]) -> Self {
        Self {
            sides: std::array::from_fn(|k| Vector(cell.map(|x| x.gradient[k]))),
            ranges: [[f64::INFINITY, f64::NEG_INFINITY]; M],
            first: None,
            least: 1.0,
            corner: Corner::new(),
        }
    }

    /// Takes a normal, which is known to an error, into the ranges if its face may be nearest. Returns its cosine with the
    /// first, and whether all so far are those of a corner.
    #[inline]
    fn take(
        &mut self,
        (normal, error): (Vector<f64, D>, f64),
        is_nearest: bool,
    ) -> (f64, bool) {
        let cosine = self.first.get_or_insert(normal).dot(normal) - 2.0 * error;
        self.corner.take(normal, error);
        if is_nearest {
            self.least = self.least.min(cosine);
            for (range, side) in self.ranges.iter_mut().zip(&self.sides) {
                let (along, error) = (normal.dot(*side), error * side.norm());
                *range = [range[0].min(along - error), range[1].max(along + error)];
            }
        }
        (cosine, self.corner.shortest() > LEAST_COSINE)
    }

    /// What the ranges add to a remainder, at least [m].
    fn width(&self) -> f64 {
        self.ranges.iter().map(|[low, high]| 0.5 * (high - low)).sum()
    }

    /// The model with the value `f` at the centre; `None` if the normals are too different.
    fn model(
        &self,
        cell: &[AffineModel<M>; D],
        f: f64,
        rounding: f64,
    ) -> Option<AffineModel<M>> {
        let mut model = AffineModel { value: f, gradient: [0.0; M], lower: 0.0, upper: 0.0 };
        // A mean of the normals is at least as long as its component along the first, so as the least cosine.
        let least = self.least.max(self.corner.shortest());
        self.first.filter(|_| least > LEAST_COSINE)?;
        let longest = 1.0 / least;
        let mut remainder = 0.0;
        let with_sides = self.ranges.into_iter().zip(&self.sides);
        for (([low, high], side), gradient) in with_sides.zip(&mut model.gradient) {
            let most = side.norm();
            let low = low.min(low * longest).max(-most);
            let high = high.max(high * longest).min(most);
            *gradient = 0.5 * (low + high);
            remainder += 0.5 * (high - low) + 2.0 * f64::EPSILON * (low.abs() + high.abs());
        }
        let own: f64 = cell.iter().map(|x| x.lower.max(x.upper)).sum();
        remainder = (remainder + own) * (1.0 + 16.0 * f64::EPSILON) + rounding;
        (model.lower, model.upper) = (remainder, remainder);
        Some(model)
    }
}

/// Feeds `sink` with vertices and faces.
pub(super) fn content<const N: usize, const D: usize>(
    vertices: &[Point<D>],
    elements: &[[u32; N]],
    sink: &mut dyn FnMut(&[u8]),
) {
    for count in [vertices.len(), elements.len()] {
        sink(&(count as u64).to_le_bytes());
    }
    for coordinate in vertices.iter().flat_map(|vertex| vertex.0) {
        sink(&coordinate.to_le_bytes());
    }
    for index in elements.iter().flatten() {
        sink(&index.to_le_bytes());
    }
}

impl<const N: usize, const D: usize> From<Solid<N, D>> for Shape<D> {
    #[inline(never)]
    fn from(solid: Solid<N, D>) -> Self {
        Self::custom(solid)
    }
}

/// Where on an element a point of it lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// At a corner.
    Corner(usize),
    /// On the edge of a triangle from this corner to the next.
    Edge(usize),
    /// Within the element.
    Face,
}

/// The point of an element nearest to another point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Foot<const D: usize> {
    pub(crate) point: Point<D>,
    pub(crate) part: Part,
    /// The square of the distance [m²].
    pub(crate) squared: f64,
}

impl<const D: usize> Foot<D> {
    #[inline(always)]
    fn at(p: Point<D>, point: Point<D>, part: Part) -> Self {
        let away = p - point;
        Self { point, part, squared: away.dot(away) }
    }
}

/// The nearest point of an element, off by a few roundings of its size however thin it is.
///
/// If the foot of the perpendicular lies in the triangle, it is the nearest point; else the nearest point of
/// the three edges is. The foot is taken first along the longest edge, then square to it (Gram and Schmidt): at a
/// height h over an edge of length L, rounding turns the direction of the height by at most εL/h and so moves the foot
/// of a point at the distance d by at most εLd/h within the triangle, which makes its distance at most εL longer.
#[inline(always)]
pub(crate) fn foot<const N: usize, const D: usize>(
    corners: &[Point<D>; N],
    p: Point<D>,
) -> Foot<D> {
    const { assert!(N == 2 || N == 3, "segments and triangles") };
    if N == 2 {
        return on_segment(
            corners[0],
            corners[1],
            p,
            [Part::Corner(0), Part::Corner(1), Part::Face],
        );
    }
    let squared = |from: usize, to: usize| {
        let edge = corners[to] - corners[from];
        edge.dot(edge)
    };
    let lengths = [squared(0, 1), squared(1, 2), squared(2, 0)];
    let first = match () {
        () if lengths[0] >= lengths[1] && lengths[0] >= lengths[2] => 0,
        () if lengths[1] >= lengths[2] => 1,
        () => 2,
    };
    let [a, b, c] = [0, 1, 2].map(|k| corners[(first + k) % 3]);
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let longest = lengths[first];
    let (along, third) = (ap.dot(ab) / longest, ac.dot(ab) / longest);
    let (height, off) = (ac - ab * third, ap - ab * along);
    let squared_height = height.dot(height);
    let w = off.dot(height) / squared_height;
    let v = along - third * w;
    if squared_height > FLAT * longest && v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
        return Foot::at(p, a + ab * v + ac * w, Part::Face);
    }
    let nearer = |a: Foot<D>, b: Foot<D>| if b.squared < a.squared { b } else { a };
    let edge = |from: usize, to: usize| {
        let parts = [Part::Corner(from), Part::Corner(to), Part::Edge(from)];
        on_segment(corners[from], corners[to], p, parts)
    };
    nearer(nearer(edge(0, 1), edge(1, 2)), edge(2, 0))
}

/// A triangle with a smaller square of its height, in units of that of its longest edge, is flat up to rounding: its edges
/// are as near as it is.
const FLAT: f64 = (16.0 * f64::EPSILON) * (16.0 * f64::EPSILON);

/// The nearest point of a segment; the parts are its ends and what is between.
#[inline(always)]
fn on_segment<const D: usize>(
    a: Point<D>,
    b: Point<D>,
    p: Point<D>,
    parts: [Part; 3],
) -> Foot<D> {
    let ab = b - a;
    let squared = ab.dot(ab);
    let t = (p - a).dot(ab);
    match () {
        () if t > 0.0 && t < squared => Foot::at(p, a + ab * (t / squared), parts[2]),
        () if t > 0.0 => Foot::at(p, b, parts[1]),
        // Products that overflow are no number.
        () => Foot::at(p, a, parts[0]),
    }
}

/// A vector perpendicular to an element, as long as its length or twice its area: out of a solid whose triangles
/// are counter-clockwise seen from outside, and whose segments have it on their left. Zero if the element
/// is not one less in dimension than space.
#[inline]
pub(crate) fn across<const N: usize, const D: usize>(
    corners: &[Point<D>; N],
) -> Vector<f64, D> {
    if N != D {
        return Vector::ZERO;
    }
    Vector::across(&std::array::from_fn(|i| corners[i]))
}

/// The plate about the faces of a mesh: all points at most half its thickness away from one.
///
/// Its field is the distance to the nearest face less half the thickness: exact outside, a bound inside. The mesh may
/// be open, cross itself or face anywhere; nothing is mended.
///
/// ```
/// use palpate_field::{Shape, Vector};
/// use palpate_mesh::{MeshSheet, TriangleMesh};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
/// let mesh = TriangleMesh::new(corners.map(Vector).to_vec(), vec![[0, 1, 2]])?;
/// let plate: Shape<3> = MeshSheet::from_mesh(&mesh, 0.002)?.into(); // 2 mm
/// assert_eq!(plate.promise().in_words(), "exact outside, bound inside");
/// assert_eq!(plate.distance([0.2, 0.5, 0.2]), 0.499);
/// assert_eq!(plate.distance([0.2, -0.0005, 0.2]), -0.0005);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct MeshSheet<const N: usize, const D: usize> {
    /// The vertices and faces as they came.
    mesh: Mesh<N, D>,
    surface: Surface<N, D>,
    /// Half the thickness [m].
    half: f64,
    promise: Promise<D>,
}

impl<const N: usize, const D: usize> MeshSheet<N, D> {
    /// The plate of a thickness [m] about the faces of a mesh.
    ///
    /// # Errors
    ///
    /// If the mesh or the thickness is too small or too large.
    #[inline(never)]
    pub fn from_mesh(mesh: &Mesh<N, D>, thickness: f64) -> Result<Self, SolidError> {
        let lengths = SMALLEST_LENGTH..=LARGEST_LENGTH;
        if !lengths.contains(&thickness) {
            return Err(SolidError::Thickness { thickness });
        }
        let aabb = mesh.bounds().grown(0.5 * thickness);
        let size = aabb.half_extents().0.into_iter().fold(0.0, f64::max) * 2.0;
        if !lengths.contains(&size) {
            return Err(SolidError::Size { size });
        }
        let Ordered { faces, .. } = Ordered::of(mesh.vertices(), mesh.elements());
        let surface = Surface::new(&faces);
        let promise = promise(aabb);
        Ok(Self { mesh: mesh.clone(), surface, half: 0.5 * thickness, promise })
    }

    /// The mesh, as it came.
    #[must_use]
    pub fn mesh(&self) -> &Mesh<N, D> {
        &self.mesh
    }

    /// The thickness of the plate [m].
    #[must_use]
    pub fn thickness(&self) -> f64 {
        2.0 * self.half
    }

    /// The signed distance at a point [m], and its gradient.
    fn at(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        if p.0.iter().any(|x| !x.is_finite()) {
            return (f64::NAN, Vector::ZERO);
        }
        let (face, foot) = self.surface.nearest(p, None);
        let (distance, gradient) = self.at_foot(p, face, &foot);
        (distance - self.half, gradient)
    }

    /// The distance to the nearest face [m], from its nearest point, and its gradient.
    fn at_foot(&self, p: Point<D>, face: usize, foot: &Foot<D>) -> (f64, Vector<f64, D>) {
        let distance = foot.squared.sqrt();
        let is_known = distance > self.promise.rounding.within(p.norm());
        let gradient = if is_known {
            (p - foot.point) * (1.0 / distance)
        } else {
            let normal = across(self.surface.faces.corners(face)).normalized();
            normal.unwrap_or(Vector::unit(0))
        };
        (distance, gradient)
    }
}

fn promise<const D: usize>(aabb: Aabb<D>) -> Promise<D> {
    let bounds = Bounds::of_box(aabb);
    let size = bounds.radius_about_origin();
    let mut promise = Promise::exact(Some(bounds), OPERATIONS, size);
    promise.inside = Quality::Bound;
    promise
}

impl<const N: usize, const D: usize> CustomField<D> for MeshSheet<N, D> {
    fn distance(&self, p: Point<D>) -> f64 {
        self.at(p).0
    }

    fn distance_gradient(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        self.at(p)
    }

    fn promise(&self) -> &Promise<D> {
        &self.promise
    }

    fn model<const M: usize>(&self, cell: &[AffineModel<M>; D]) -> AffineModel<M> {
        let centre = Vector(cell.map(|x| x.value));
        let radius = AffineModel::radius(cell);
        let rounding = self.promise.rounding.within(centre.norm() + radius);
        if !centre.is_finite() {
            return AffineModel::lipschitz(f64::NAN, 1.0, cell, rounding);
        }
        let (face, foot) = self.surface.nearest(centre, None);
        let (distance, away) = self.at_foot(centre, face, &foot);
        let f = distance - self.half;
        let nearest = (face, distance, away);
        let model = (distance > radius + rounding)
            .then(|| self.surface.model_of_distance(cell, nearest, radius, rounding));
        match model.flatten() {
            Some(model) => AffineModel { value: model.value - self.half, ..model },
            None => AffineModel::lipschitz(f, 1.0, cell, rounding),
        }
    }

    fn content(&self, sink: &mut dyn FnMut(&[u8])) -> bool {
        content(self.mesh.vertices(), self.mesh.elements(), sink);
        sink(&self.half.to_le_bytes());
        true
    }
}

impl<const N: usize, const D: usize> From<MeshSheet<N, D>> for Shape<D> {
    #[inline(never)]
    fn from(sheet: MeshSheet<N, D>) -> Self {
        Self::custom(sheet)
    }
}

/// So many faces of a piece must agree, the largest first.
const SAMPLES: usize = 3;

/// What the pieces are to the solid.
#[derive(Debug, Default)]
pub(super) struct Walls {
    /// Of each face, whether it does not bound the solid.
    pub(super) is_wall: Vec<bool>,
    /// Whether it is known of all faces whether they bound the solid.
    pub(super) are_all_known: bool,
    /// Whether the winding number is negative beside one of the pieces of which this is known.
    pub(super) has_negative: bool,
}

impl Walls {
    /// Where all faces bound the solid.
    pub(super) fn none(faces: usize) -> Self {
        Self { is_wall: vec![false; faces], are_all_known: true, has_negative: false }
    }
}

/// Of faces in the order of the tree, each with the number of its piece and whether it crosses or touches another.
pub(super) fn find<const N: usize, const D: usize>(
    faces: &[[Point<D>; N]],
    tree: &WindingTree<N, D>,
    of_piece: &[usize],
    is_met: &[bool],
) -> Walls {
    let count = of_piece.iter().max().map_or(0, |last| last + 1);
    let mut members = vec![Vec::new(); count];
    let mut is_free = vec![true; count];
    for (face, piece) in of_piece.iter().enumerate() {
        members[*piece].push(face);
        is_free[*piece] &= !is_met[face];
    }
    let mut walls = Walls::none(faces.len());
    for (members, is_free) in members.into_iter().zip(is_free) {
        let within = is_free.then(|| within(faces, tree, &members)).flatten();
        match within {
            None => walls.are_all_known = false,
            // Outside it is one less.
            Some(within) => {
                walls.has_negative |= within < 1.0;
                if within != 1.0 {
                    members.iter().for_each(|face| walls.is_wall[*face] = true);
                }
            }
        }
    }
    walls
}

/// The winding number behind the faces of a piece; `None` if it is not the same behind all that are looked at.
fn within<const N: usize, const D: usize>(
    faces: &[[Point<D>; N]],
    tree: &WindingTree<N, D>,
    members: &[usize],
) -> Option<f64> {
    let mut by_area: Vec<(f64, usize)> =
        members.iter().map(|face| (across(&faces[*face]).norm(), *face)).collect();
    let largest = by_area.len().min(SAMPLES);
    by_area.select_nth_unstable_by(largest - 1, |a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let behind = |(_, face): &(f64, usize)| {
        let corners = &faces[*face];
        let p =
            corners.iter().fold(Vector::ZERO, |sum, corner| sum + *corner * (1.0 / N as f64));
        // What all others sum up to is half a turn less than it is behind the face, a whole number, of which there
        // must be no other within the error.
        let own = share(corners, p);
        let behind = |w: Winding| w.number - own + 0.5;
        let is_settled =
            |w: Winding| w.error < 0.4 && (behind(w) - behind(w).round()).abs() + w.error < 0.8;
        let sum = tree.settled(faces, p, is_settled);
        is_settled(sum).then_some(behind(sum).round())
    };
    let mut found = by_area[..largest].iter().map(behind);
    let first = found.next()??;
    found.all(|other| other == Some(first)).then_some(first)
}

#[cfg(test)]
mod foot_tests {
    use super::*;

    #[test]
    fn every_part_of_a_triangle_is_found() {
        let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0]].map(Vector);
        let cases = [
            ([1.0, 1.0, 2.0], [1.0, 1.0, 0.0], Part::Face),
            ([-1.0, -1.0, 1.0], [0.0, 0.0, 0.0], Part::Corner(0)),
            ([6.0, -1.0, 0.0], [4.0, 0.0, 0.0], Part::Corner(1)),
            ([-0.5, 4.0, 0.0], [0.0, 3.0, 0.0], Part::Corner(2)),
            ([2.0, -2.0, 1.0], [2.0, 0.0, 0.0], Part::Edge(0)),
            ([2.0 + 0.6, 1.5 + 0.8, 1.0], [2.0, 1.5, 0.0], Part::Edge(1)),
            ([-2.0, 1.0, 0.0], [0.0, 1.0, 0.0], Part::Edge(2)),
        ];
        for (p, nearest, part) in cases {
            let found = foot(&corners, Vector(p));
            assert!((found.point - Vector(nearest)).norm() < 1e-15, "{found:?}");
            assert_eq!(found.part, part, "{p:?}");
        }
    }

    /// The foot by barycentric coordinates from the Gram matrix was off by ε times the length over the square of the
    /// thinness: by 5e-9 m at a height of 0.25 mm.
    #[test]
    fn the_foot_on_a_thin_triangle_is_off_by_roundings_of_its_length() {
        // Along, across and off the triangle: square to each other, each 7 m long.
        let axes = [[2.0, 3.0, 6.0], [6.0, 2.0, -3.0], [3.0, -6.0, 2.0]].map(Vector);
        let at = |u: f64, v: f64, w: f64| axes[0] * u + axes[1] * v + axes[2] * w;
        let error = 64.0 * f64::EPSILON * 7.0;
        for halvings in 0..60 {
            let height = 0.5_f64.powi(halvings);
            for (third, turn) in [(0.3, 0), (0.5, 1), (-0.2, 2), (0.999, 0)] {
                let mut corners =
                    [at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.0), at(third, height, 0.0)];
                corners.rotate_left(turn);
                for (share, up) in [(0.1, 0.2), (0.5, 0.4), (0.7, 0.25)] {
                    // Within the triangle, up to its height.
                    let along = third * up + share * (1.0 - up);
                    for off in [0.0, 1e-9, 1e-4, 0.1, 3.0] {
                        let p = at(along, height * up, off);
                        let found = foot(&corners, p).squared.sqrt();
                        assert!((found - 7.0 * off).abs() < error, "{height} {off}: {found}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_foot_on_a_sliver_is_that_of_its_edges() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1e-12, 0.0]].map(Vector);
        let found = foot(&corners, Vector([0.25, 0.0, 2.0]));
        assert!((found.squared - 4.0).abs() < 1e-14, "{found:?}");
        assert!((found.point - Vector([0.25, 0.0, 0.0])).norm() < 1e-11);
    }
}
