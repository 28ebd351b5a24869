// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A solid as a field.

use palpate_field::scalar::AffineModel;
use palpate_field::{CustomField, Point, Promise, Quality, Shape, Vector};

use super::surface::MOST_GROUPS;
use super::winding::Winding;
use super::{Signs, Solid};

/// The least cosine, of about 80°, between the first normal and any other with which a cell that the surface passes gets
/// a model.
const LEAST_COSINE: f64 = 0.17;

/// The same where the winding number tells the sign.
const LEAST_COSINE_OF_SIGNS: f64 = 0.5 + 1e-9;

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
        let distance = f.abs();
        let away = if f < 0.0 { -gradient } else { gradient };
        if distance <= radius + rounding {
            let lipschitz = AffineModel::lipschitz(f, 1.0, cell, rounding);
            let across = self.model_across(cell, f, radius, rounding);
            return across.filter(|model| model.lower < lipschitz.lower).unwrap_or(lipschitz);
        }
        match self.surface.model_of_distance(
            cell,
            (nearest.0, distance, away),
            radius,
            rounding,
        ) {
            None => AffineModel::lipschitz(f, 1.0, cell, rounding),
            Some(model) if f < 0.0 => AffineModel {
                value: -model.value,
                gradient: model.gradient.map(|side| -side),
                lower: model.upper,
                upper: model.lower,
            },
            Some(model) => model,
        }
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
    /// may be nearest somewhere in it, if they face too different ways, or if one of them may not be surface.
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
        let sides: [Vector<f64, D>; M] =
            std::array::from_fn(|k| Vector(cell.map(|x| x.gradient[k])));
        let farthest = f.abs() + 2.0 * radius + rounding;
        let (reach, least_cosine) = match self.signs {
            None => (farthest, LEAST_COSINE),
            Some(_) => (2.0 * farthest * (1.0 + 1e-9), LEAST_COSINE_OF_SIGNS),
        };
        let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; M];
        // The first normal, and the least cosine of another with it.
        let mut first: Option<Vector<f64, D>> = None;
        let (mut least, mut groups, mut is_known) = (1.0_f64, 0, true);
        let mut walk = self.surface.boxes.from(centre);
        while let Some(group) = walk.next(reach * reach) {
            groups += 1;
            for (face, is_nearest) in self.surface.faces.near(group, centre, [reach, farthest])
            {
                let (normal, error) = self.normals.of_face(face);
                let cosine = first.get_or_insert(normal).dot(normal) - 2.0 * error;
                is_known &= cosine > least_cosine;
                if !is_nearest {
                    continue;
                }
                least = least.min(cosine);
                for (range, side) in ranges.iter_mut().zip(&sides) {
                    let (along, error) = (normal.dot(*side), error * side.norm());
                    *range = [range[0].min(along - error), range[1].max(along + error)];
                }
            }
            let width: f64 = ranges.iter().map(|[low, high]| 0.5 * (high - low)).sum();
            if !is_known || groups > MOST_GROUPS || width > radius {
                return None;
            }
        }
        let first = first?;
        if !self.are_surface(centre, first * (2.0 * farthest)) {
            return None;
        }
        let mut model = AffineModel { value: f, gradient: [0.0; M], lower: 0.0, upper: 0.0 };
        // A mean of the normals is at least as long as its component along the first, so as the least cosine.
        let longest = 1.0 / least;
        let mut remainder = 0.0;
        for ([low, high], gradient) in ranges.into_iter().zip(&mut model.gradient) {
            let [low, high] = [low.min(low * longest), high.max(high * longest)];
            *gradient = 0.5 * (low + high);
            remainder += 0.5 * (high - low) + 2.0 * f64::EPSILON * (low.abs() + high.abs());
        }
        let own: f64 = cell.iter().map(|x| x.lower.max(x.upper)).sum();
        remainder = (remainder + own) * (1.0 + 16.0 * f64::EPSILON) + rounding;
        (model.lower, model.upper) = (remainder, remainder);
        Some(model)
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
