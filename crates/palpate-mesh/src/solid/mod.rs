// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The solid that a mesh bounds.

use faces::{Boxes, Normals};
use field::{Foot, Part, Walls};
use palpate_field::scalar::AffineModel;
use palpate_field::{
    Aabb, Deviation, LARGEST_LENGTH, Point, Promise, Quality, SMALLEST_LENGTH, Vector, Wide,
    wide,
};
use planes::highest;
use repair::{
    Crossings, Joined, Known, Repair, ShortEdge, Within, by_rim, cracks, shortest_edge, sides,
};
use winding::WindingTree;

use crate::mesh::{Mesh, MeshError, weld};
use crate::report::is_flat;
use crate::solid::faces::Faces;
use crate::tree::BallTree;

pub use field::MeshSheet;
pub(crate) use field::{across, foot};
pub use findings::{Cracks, Findings};
pub use repair::Opening;
pub(crate) use repair::crossing_faces;
pub(crate) use repair::rounding_of;

mod faces;
mod field;
mod findings;
mod planes;
mod repair;
mod winding;

/// Rounded operations of a distance on numbers up to `|p| + size`.
const OPERATIONS: f64 = 64.0;

/// The normal of a face of at most this height, as a share of its largest coordinate, may be off by more than 1e-3:
/// the rounding of its corners.
const DOUBTFUL: f64 = 1e-12;

/// The solid that a mesh bounds: the points of winding number above one half.
///
/// Its field is the distance to the nearest face, negative inside. Faces that have the solid on both sides, or on
/// neither, are no surface and are dropped, unless others cross or touch their piece. Where no faces cross or touch,
/// the distance is exact; else the values inside are bounds, since a wall within the solid may be nearer than its
/// surface. The sign is that of the nearest face, and where faces cross, are nearly flat, or meet in more than
/// pairs at an edge, that of the winding number, which is evaluated until its error bound decides.
///
/// ```
/// use palpate_field::{Shape, Vector};
/// use palpate_mesh::{Solid, TriangleMesh};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// // One face faces the wrong way.
/// let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 2, 3]];
/// let mesh = TriangleMesh::new(corners.map(Vector).to_vec(), faces)?;
/// let (solid, findings) = Solid::from_mesh(&mesh)?;
/// assert_eq!(findings.to_string(), "1 face faced the wrong way and was turned");
/// let shape: Shape<3> = solid.into();
/// assert_eq!(shape.promise().in_words(), "exact outside, exact inside");
/// assert_eq!(shape.distance([0.1, 0.2, -0.5]), 0.5);
/// assert_eq!(shape.distance([0.1, 0.2, 0.2]), -0.1);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Solid<const N: usize, const D: usize> {
    /// The vertices and the faces as they were mended, in the order in which they came.
    vertices: Vec<Point<D>>,
    elements: Vec<[u32; N]>,
    /// The faces that count for the distance.
    surface: Surface<N, D>,
    normals: Normals<N, D>,
    /// `None` if the nearest face alone tells the sign.
    signs: Option<Signs<N, D>>,
    promise: Promise<D>,
}

/// The faces whose winding number tells the sign, walls among them.
#[derive(Clone, Debug)]
struct Signs<const N: usize, const D: usize> {
    faces: Vec<[Point<D>; N]>,
    tree: WindingTree<N, D>,
}

impl<const N: usize, const D: usize> Solid<N, D> {
    /// The solid of a mesh, and what was found and mended.
    ///
    /// Equal vertices are merged; faces with a vertex twice and doubled faces are dropped; faces are parted where
    /// corners of others lie on their edges; neighbours are turned to agree on the inside; openings are closed by
    /// caps; sheets within the solid are dropped; pieces inside out are turned; faces with the solid on both sides,
    /// or on neither, are dropped.
    ///
    /// Where that closes edges, vertices are joined that are equal up to the rounding of the coordinates, or up to a
    /// millionth of the shortest edge. The promise's [deviation](palpate_field::Deviation) says how far that moved
    /// the surface.
    ///
    /// # Errors
    ///
    /// If no face is left, or the faces bound no solid: a piece is not orientable, or the caps are as large as the
    /// faces, as of a sheet or of faces with cracks between them.
    #[inline(never)]
    pub fn from_mesh(mesh: &Mesh<N, D>) -> Result<(Self, Findings<D>), SolidError> {
        Self::joined(mesh, Within::Rounding)
    }

    /// The same, where vertices at open edges are joined that are at most `within` apart [m], if that closes edges.
    /// With zero only vertices that are exactly equal are joined.
    ///
    /// ```
    /// use palpate_field::Vector;
    /// use palpate_mesh::{Solid, TriangleMesh};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// // A tetrahedron of which one face is 10 µm away from the others.
    /// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    /// let lowered = [[0.0, 0.0, -1e-5], [1.0, 0.0, -1e-5], [0.0, 1.0, -1e-5]];
    /// let vertices = corners.into_iter().chain(lowered).map(Vector).collect();
    /// let faces = vec![[4, 6, 5], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
    /// let mesh = TriangleMesh::new(vertices, faces)?;
    /// let (solid, findings) = Solid::from_mesh_within(&mesh, 2e-5)?;
    /// assert_eq!(findings.joined, 3);
    /// assert!((findings.moved - 1e-5).abs() < 1e-12);
    /// assert_eq!(solid.vertices().len(), 4);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// As [`from_mesh`](Self::from_mesh), and if the length is negative, NaN or more than half of the shortest edge
    /// that is left.
    #[inline(never)]
    pub fn from_mesh_within(
        mesh: &Mesh<N, D>,
        within: f64,
    ) -> Result<(Self, Findings<D>), SolidError> {
        if within.is_nan() || within < 0.0 {
            return Err(SolidError::JoinWithin { within });
        }
        Self::joined(mesh, Within::Length(within))
    }

    fn joined(mesh: &Mesh<N, D>, within: Within) -> Result<(Self, Findings<D>), SolidError> {
        let mut repair = Repair::of(mesh, within);
        check(mesh, &repair, within)?;
        if !repair.findings.openings.is_empty() {
            repair.findings.cracks = cracks_of(mesh);
        }
        let all = Ordered::of(&repair.vertices, &repair.elements);
        let (crossings, walls, tree) = examine(&repair, &all);
        let Repair { mut vertices, mut elements, mut findings, caps, .. } = repair;
        (findings.crossings, findings.touching) = (crossings.crossings, crossings.touching);
        (findings.crossing_at, findings.are_more) = (crossings.at, crossings.are_more);
        let mut is_wall = vec![false; elements.len()];
        for (i, wall) in all.order.iter().zip(&walls.is_wall) {
            is_wall[*i as usize] = *wall;
        }
        let own_walls =
            is_wall.iter().zip(&caps).filter(|(is_wall, cap)| **is_wall && cap.is_none());
        let inner = own_walls.count();
        (findings.inner, findings.own) = (findings.inner + inner, findings.own - inner);
        let on_surface = |elements: &[[u32; N]]| -> Vec<[u32; N]> {
            let with_walls = elements.iter().zip(&is_wall);
            with_walls.filter(|(_, is_wall)| !**is_wall).map(|(element, _)| *element).collect()
        };
        if walls.are_all_known {
            elements = on_surface(&elements);
        }
        (vertices, elements) = named(&vertices, elements);
        let surface =
            if walls.are_all_known { elements.clone() } else { on_surface(&elements) };
        if surface.is_empty() {
            return Err(SolidError::NoFaces { given: findings.faces });
        }
        let Ordered { elements: ordered, faces, .. } = Ordered::of(&vertices, &surface);
        findings.flat = faces.iter().filter(|face| is_flat(face, DOUBTFUL)).count();
        let is_crowded = || by_rim(&sides(&surface)).any(|at_rim| at_rim.len() > 2);
        let signs = match tree {
            Some(tree) if !walls.are_all_known => Some(Signs { faces: all.faces, tree }),
            _ if findings.flat > 0 || is_crowded() => {
                Some(Signs { tree: WindingTree::new(&faces), faces: faces.clone() })
            }
            _ => None,
        };
        let mut promise = promise(&faces, quality(&crossings, &walls));
        promise.deviation = deviation(&findings);
        let normals = Normals::new(vertices.len(), &ordered, &faces);
        let surface = Surface::new(&faces);
        Ok((Self { vertices, elements, surface, normals, signs, promise }, findings))
    }

    /// The mesh that bounds the solid, mended: equal vertices merged, all faces turned, openings closed.
    ///
    /// The solid of this mesh is the same, and nothing is left to mend. Where faces cross or touch, they are as they
    /// were; then the walls within the solid are there too, since the winding number counts them.
    ///
    /// ```
    /// use palpate_field::Vector;
    /// use palpate_mesh::{Solid, TriangleMesh};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    /// // One face is missing.
    /// let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3]];
    /// let (solid, _) = Solid::from_mesh(&TriangleMesh::new(corners.map(Vector).to_vec(), faces)?)?;
    /// let mended = solid.mesh()?;
    /// assert!(mended.report().is_watertight());
    /// assert_eq!(mended.report().enclosed, Some(1.0 / 6.0)); // [m³]
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If it has more faces than `u32::MAX`, by its caps.
    pub fn mesh(&self) -> Result<Mesh<N, D>, MeshError> {
        Mesh::new(self.vertices.clone(), self.elements.clone())
    }

    /// The vertices of [`mesh`](Self::mesh) [m].
    #[must_use]
    pub fn vertices(&self) -> &[Point<D>] {
        &self.vertices
    }

    /// The faces of [`mesh`](Self::mesh), by the numbers of their vertices.
    #[must_use]
    pub fn elements(&self) -> &[[u32; N]] {
        &self.elements
    }

    /// The promise of its field.
    #[must_use]
    pub fn promise(&self) -> &Promise<D> {
        &self.promise
    }

    /// The signed distance at a point [m], and its gradient; `known` is a point of the surface, if there is one, and
    /// becomes the nearest.
    fn at(&self, p: Point<D>, known: &mut Option<Point<D>>) -> (f64, Vector<f64, D>) {
        if !p.is_finite() {
            return (f64::NAN, Vector::ZERO);
        }
        let nearest = self.surface.nearest(p, *known);
        *known = Some(nearest.1.point).filter(|point| point.is_finite());
        self.at_foot(p, &nearest)
    }

    /// The same, from the nearest face and its nearest point.
    fn at_foot(&self, p: Point<D>, (face, foot): &(usize, Foot<D>)) -> (f64, Vector<f64, D>) {
        let away = p - foot.point;
        let distance = foot.squared.sqrt();
        let normal = self.normals.at(*face, foot.part);
        let is_inside = match &self.signs {
            None => away.dot(normal) < 0.0,
            Some(Signs { faces, tree }) => tree.is_inside(faces, p),
        };
        let side = if is_inside { -1.0 } else { 1.0 };
        // Near the surface the way to the foot is rounding alone; over a face it is the normal.
        let is_known = distance > self.promise.rounding.within(p.norm());
        let gradient = match foot.part {
            Part::Face if is_known && side * away.dot(normal) < 0.0 => -normal,
            Part::Face => normal,
            _ if is_known => away * (side / distance),
            _ => normal,
        };
        (side * distance, gradient)
    }
}

/// Refuses what bounds no solid.
fn check<const N: usize, const D: usize>(
    mesh: &Mesh<N, D>,
    repair: &Repair<N, D>,
    within: Within,
) -> Result<(), SolidError> {
    let given = mesh.elements().len();
    if repair.elements.is_empty() {
        return Err(SolidError::NoFaces { given });
    }
    let half_extents = mesh.bounds().half_extents().0;
    let size = half_extents.iter().fold(0.0_f64, |size, half| half.max(size)) * 2.0;
    if !(SMALLEST_LENGTH..=LARGEST_LENGTH).contains(&size) {
        return Err(SolidError::Size { size });
    }
    if let Within::Length(within) = within
        && let Some(ShortEdge { ends, length }) =
            shortest_edge(&repair.vertices, &repair.elements, 0.0)
        && within > 0.5 * length
    {
        let ends = ends.map(|end| format!("({})", end.0.map(|x| x.to_string()).join(", ")));
        return Err(SolidError::ShortEdge { within, length, ends: ends.join(" to ") });
    }
    match repair.findings.one_sided {
        0 if repair.is_sheet => Err(match cracks_of(mesh) {
            Some(cracks) => SolidError::Cracked { cracks },
            None => SolidError::Sheet,
        }),
        0 => Ok(()),
        pieces => Err(SolidError::OneSided { pieces }),
    }
}

/// The cracks of a mesh, if joining corners closes nearly all of its open edges.
fn cracks_of<const N: usize, const D: usize>(mesh: &Mesh<N, D>) -> Option<Cracks> {
    let (vertices, names) = weld(mesh.vertices());
    let named = |element: &[u32; N]| element.map(|index| names[index as usize]);
    let elements: Vec<_> = mesh.elements().iter().map(named).collect();
    let Joined { farthest, tolerance, .. } = cracks(&vertices, &elements, mesh.rounding())?;
    Some(Cracks { width: farthest, join_within: tolerance })
}

/// How far the solid may be from that of the mesh as it came: where vertices were joined by what they moved, and by an
/// unknown amount where openings were closed.
fn deviation<const D: usize>(findings: &Findings<D>) -> Option<Deviation> {
    let largest = findings.openings.iter().map(|opening| opening.doubtful);
    match largest.reduce(f64::max) {
        Some(value) => Some(Deviation { value, within: 0.0 }),
        None if findings.moved > 0.0 => {
            Some(Deviation { value: findings.moved, within: f64::INFINITY })
        }
        None => None,
    }
}

/// Elements in the order of the tree.
struct Ordered<const N: usize, const D: usize> {
    order: Vec<u32>,
    elements: Vec<[u32; N]>,
    faces: Vec<[Point<D>; N]>,
}

impl<const N: usize, const D: usize> Ordered<N, D> {
    fn of(vertices: &[Point<D>], elements: &[[u32; N]]) -> Self {
        let order = BallTree::new(vertices, elements).order().to_vec();
        let elements: Vec<_> = order.iter().map(|i| elements[*i as usize]).collect();
        let corners = |element: &[u32; N]| element.map(|index| vertices[index as usize]);
        let faces = elements.iter().map(corners).collect();
        Self { order, elements, faces }
    }
}

/// Which faces cross or touch, which are walls, and the winding numbers if they were asked.
fn examine<const N: usize, const D: usize>(
    repair: &Repair<N, D>,
    all: &Ordered<N, D>,
) -> (Crossings<D>, Walls, Option<WindingTree<N, D>>) {
    let Repair { vertices, pieces, caps, is_flat, findings, .. } = repair;
    let Ordered { order, elements, faces } = all;
    let of_piece: Vec<_> = order.iter().map(|i| pieces.of_element[*i as usize]).collect();
    let are_solids = |a: usize, b: usize| {
        let [a, b] = [of_piece[a], of_piece[b]];
        a != b && !pieces.is_cavity[a] && !pieces.is_cavity[b]
    };
    let are_apart = |a: usize, b: usize| {
        let [a, b] = [a, b].map(|face| caps[order[face] as usize]);
        a == b && a.is_some_and(|opening| is_flat[opening])
    };
    let known = Known { are_apart, are_solids };
    let crossings = Crossings::of(vertices, elements, &Boxes::new(faces), &known);
    // Pieces that nothing meets, of which none lies right within its like, are surface all over.
    if crossings.crossings + crossings.touching + findings.nested == 0 {
        return (crossings, Walls::none(faces.len()), None);
    }
    let tree = WindingTree::new(faces);
    let walls = field::find(faces, &tree, &of_piece, &crossings.is_met);
    (crossings, walls, Some(tree))
}

/// The vertices that elements name, in their order, and the elements with their new names.
fn named<const N: usize, const D: usize>(
    vertices: &[Point<D>],
    mut elements: Vec<[u32; N]>,
) -> (Vec<Point<D>>, Vec<[u32; N]>) {
    let mut is_named = vec![false; vertices.len()];
    for index in elements.iter().flatten() {
        is_named[*index as usize] = true;
    }
    let (mut kept, mut names) = (Vec::new(), Vec::with_capacity(vertices.len()));
    for (vertex, is_named) in vertices.iter().zip(is_named) {
        names.push(kept.len() as u32);
        if is_named {
            kept.push(*vertex);
        }
    }
    for index in elements.iter_mut().flatten() {
        *index = names[*index as usize];
    }
    (kept, elements)
}

/// The qualities outside and inside.
///
/// Where it is known of all faces that they bound the solid, the distance is exact. Else the winding number is a sum
/// over pieces. Of one whose faces do not cross or touch each other it is 1 within and 0 without, of a cavity −1: if
/// only pieces meet that are no cavities, and it is not negative beside the others, it is nowhere negative, and from
/// outside the nearest face bounds the solid. Faces within the solid are nearer than its surface, never farther.
fn quality<const D: usize>(crossings: &Crossings<D>, walls: &Walls) -> [Quality; 2] {
    let exact_if = |is_exact: bool| if is_exact { Quality::Exact } else { Quality::Bound };
    let is_outside_exact = walls.are_all_known || crossings.only_solids && !walls.has_negative;
    [exact_if(is_outside_exact), exact_if(walls.are_all_known)]
}

fn promise<const N: usize, const D: usize>(
    faces: &[[Point<D>; N]],
    [outside, inside]: [Quality; 2],
) -> Promise<D> {
    let aabb = Aabb::around(faces.iter().flatten().copied())
        .unwrap_or(Aabb { min: Vector::ZERO, max: Vector::ZERO });
    let bounds = palpate_field::Bounds::of_box(aabb);
    let size = bounds.radius_about_origin();
    let mut promise = Promise::exact(Some(bounds), OPERATIONS, size);
    (promise.outside, promise.inside) = (outside, inside);
    promise
}

/// Why a mesh bounds no solid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolidError {
    /// All faces were dropped.
    #[error(
        "none of the {given} faces is left: each has a vertex twice, is cancelled by its copy, or has the same side \
         on both sides"
    )]
    NoFaces {
        /// The faces of the mesh.
        given: usize,
    },
    /// The mesh is too small or too large for its distances.
    #[error(
        "it is {size:e} units across, and must be from {SMALLEST_LENGTH:e} to {LARGEST_LENGTH:e}: export it in other units"
    )]
    Size {
        /// The longest side of the box around it, in its units.
        size: f64,
    },
    /// The length within which vertices are joined is none.
    #[error("vertices are joined within a length of at least 0, got {within:e}")]
    JoinWithin {
        /// The length, in the units of the mesh.
        within: f64,
    },
    /// Vertices were to be joined over more than half of an edge.
    #[error(
        "vertices are to be joined within {within:e}, and the edge from {ends} is only {length:e} long: join within less \
         than half of it"
    )]
    ShortEdge {
        /// The length within which vertices were to be joined, in the units of the mesh.
        within: f64,
        /// The length of the shortest edge, in the units of the mesh.
        length: f64,
        /// Its ends, in the units of the mesh.
        ends: String,
    },
    /// The faces have cracks between them.
    #[error("it bounds no solid: {cracks}")]
    Cracked {
        /// How wide the cracks are, in the units of the mesh.
        cracks: Cracks,
    },
    /// The thickness of a sheet is too small or too large.
    #[error(
        "thickness must be from {SMALLEST_LENGTH:e} to {LARGEST_LENGTH:e} of its units, got {thickness:e}"
    )]
    Thickness {
        /// The thickness, in the units of the mesh.
        thickness: f64,
    },
    /// A piece is not orientable.
    #[error(
        "pieces that are not orientable (like a Möbius strip): {pieces}; they bound no solid; with a thickness \
         (\"thickness\": METRES in a scene, `MeshSheet` in Rust) it is a plate"
    )]
    OneSided {
        /// The number of such pieces.
        pieces: usize,
    },
    /// The mesh is a sheet.
    #[error(
        "the openings are as large as the surface: it is a sheet, and bounds no solid; with a thickness \
         (\"thickness\": METRES in a scene, `MeshSheet` in Rust) it is a plate"
    )]
    Sheet,
}

/// The rounding of a nearest point and of its distance, as a share of coordinates and of the size of all faces.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A model looks at so many groups of eight faces at most: a cell near more is large.
const MOST_GROUPS: usize = 32;

/// Faces in the order of their boxes.
#[derive(Clone, Debug)]
struct Surface<const N: usize, const D: usize> {
    faces: Faces<N, D>,
    boxes: Boxes<D>,
}

impl<const N: usize, const D: usize> Surface<N, D> {
    /// Of faces in the order of the tree.
    fn new(faces: &[[Point<D>; N]]) -> Self {
        Self { faces: Faces::new(faces), boxes: Boxes::new(faces) }
    }

    /// The face nearest to a point, in the order of the boxes, and its nearest point.
    ///
    /// `known` is a point of the surface, if there is one: its distance bounds the search, and the nearer it is, the
    /// shorter is the search.
    fn nearest(&self, p: Point<D>, known: Option<Point<D>>) -> (usize, Foot<D>) {
        let least = known.map_or(f64::INFINITY, |known| {
            // Its face must still be found, whose nearest point is rounded too.
            let rounding = ROUNDING * (p.norm() + known.norm() + self.faces.size());
            ((p - known).norm() * (1.0 + ROUNDING) + rounding).powi(2)
        });
        wide(Nearest { surface: self, p, least })
    }

    /// A model of the distance to the nearest face over a cell that no face meets, from the face nearest to its centre,
    /// the distance there, and the unit vector away from the nearest point; `None` if too many faces may be nearest
    /// somewhere in it.
    ///
    /// The distance to each face is convex. So it is at least its tangent plane, and the nearest face's is
    /// largest, above a plane, at a corner of the cell. It is also at least the height over each plane that the face
    /// does not rise above: so faces in the plane of the nearest one lower nothing.
    fn model_of_distance<const M: usize>(
        &self,
        cell: &[AffineModel<M>; D],
        (face, distance, away): (usize, f64, Vector<f64, D>),
        radius: f64,
        rounding: f64,
    ) -> Option<AffineModel<M>> {
        let centre = Vector(cell.map(|x| x.value));
        let nearest = self.faces.corners(face);
        let to_nearest = |p: [f64; D]| foot(nearest, Vector(p)).squared.sqrt();
        let mut model = AffineModel::tangent(distance, away.0, to_nearest, cell, rounding);
        let own = model.lower;
        // How far the cell's own remainders move the planes apart.
        let remainders: f64 = cell.iter().map(|x| x.lower.max(x.upper)).sum();
        let farthest = distance + 2.0 * radius + rounding;
        let mut groups = 0;
        let mut walk = self.boxes.from(centre);
        while let Some(group) = walk.next(farthest * farthest) {
            groups += 1;
            // A model no narrower than that of the Lipschitz constant is not worth the search.
            if groups > MOST_GROUPS || model.lower + model.upper > 2.0 * radius {
                return None;
            }
            self.faces.within(group, centre, farthest, |corners, found, far| {
                let between = away - (centre - found.point) * (1.0 / far);
                let apart: f64 = (0..M)
                    .map(|k| {
                        (0..D).map(|i| between[i] * cell[i].gradient[k]).sum::<f64>().abs()
                    })
                    .sum();
                let by_tangent = distance - far + apart + 2.0 * remainders;
                if own + by_tangent > model.lower {
                    let by_plane = distance + highest(corners, centre, away) + rounding;
                    model.lower = model.lower.max(own + by_tangent.min(by_plane));
                }
            });
        }
        Some(model)
    }
}

/// The search of the nearest face.
struct Nearest<'a, const N: usize, const D: usize> {
    surface: &'a Surface<N, D>,
    p: Point<D>,
    /// The square of the distance is known to be less [m²].
    least: f64,
}

impl<const N: usize, const D: usize> Wide for Nearest<'_, N, D> {
    type Out = (usize, Foot<D>);

    #[inline(always)]
    fn run(self) -> (usize, Foot<D>) {
        let Self { surface: Surface { faces, boxes }, p, least } = self;
        let mut nearest = (0, Foot { point: p, part: Part::Corner(0), squared: least });
        let mut walk = boxes.from(p);
        while let Some(group) = walk.next(nearest.1.squared) {
            faces.nearer(group, p, &mut nearest);
        }
        if nearest.1.squared < least { nearest } else { (0, foot(faces.corners(0), p)) }
    }
}
