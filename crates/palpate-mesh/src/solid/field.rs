// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A solid as a field.

use palpate_field::scalar::AffineModel;
use palpate_field::{CustomField, Point, Promise, Shape, Vector};

use super::Solid;
use super::foot::{across, foot};
use crate::tree::FAN;

/// Normals that are farther than about 80° apart make no model of a cell that the surface passes.
const LEAST_COSINE: f64 = 0.17;

/// A model looks at so many groups of eight faces at most: a cell near more is large.
const MOST_GROUPS: usize = 32;

impl<const N: usize, const D: usize> CustomField<D> for Solid<N, D> {
    fn distance(&self, p: Point<D>) -> f64 {
        self.at(p).0
    }

    fn distance_gradient(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        self.at(p)
    }

    fn promise(&self) -> &Promise<D> {
        self.promise()
    }

    fn model<const M: usize>(&self, cell: &[AffineModel<M>; D]) -> AffineModel<M> {
        let centre = Vector(cell.map(|x| x.value));
        let radius = AffineModel::radius(cell);
        let rounding = self.promise().rounding.within(centre.norm() + radius);
        let (f, gradient) = self.at(centre);
        let distance = f.abs();
        let away = if f < 0.0 { -gradient } else { gradient };
        if distance <= radius + rounding {
            let lipschitz = AffineModel::lipschitz(f, 1.0, cell, rounding);
            let across = self.model_across(cell, f, radius, rounding);
            return across.filter(|model| model.lower < lipschitz.lower).unwrap_or(lipschitz);
        }
        match self.model_of_distance(cell, (distance, away), radius, rounding) {
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
        for count in [self.vertices.len(), self.elements.len()] {
            sink(&(count as u64).to_le_bytes());
        }
        for coordinate in self.vertices.iter().flat_map(|vertex| vertex.0) {
            sink(&coordinate.to_le_bytes());
        }
        for index in self.elements.iter().flatten() {
            sink(&index.to_le_bytes());
        }
        true
    }
}

impl<const N: usize, const D: usize> Solid<N, D> {
    /// A model of the distance to the nearest face over a cell that no face meets, from the distance at its
    /// centre and the unit vector away from the nearest point; `None` if too many faces may be nearest
    /// somewhere in it.
    ///
    /// The distance to each face is convex. So it is at least its tangent plane, and the nearest face's is
    /// largest, above a plane, at a corner of the cell.
    fn model_of_distance<const M: usize>(
        &self,
        cell: &[AffineModel<M>; D],
        (distance, away): (f64, Vector<f64, D>),
        radius: f64,
        rounding: f64,
    ) -> Option<AffineModel<M>> {
        let centre = Vector(cell.map(|x| x.value));
        let (nearest, _) = self.nearest(centre);
        let to_nearest = |p: [f64; D]| foot(&self.faces[nearest], Vector(p)).squared.sqrt();
        let mut model = AffineModel::tangent(distance, away.0, to_nearest, cell, rounding);
        let own = model.lower;
        // How far the cell's own remainders move the planes apart.
        let remainders: f64 = cell.iter().map(|x| x.lower.max(x.upper)).sum();
        let farthest = distance + 2.0 * radius + rounding;
        let mut groups = 0;
        self.boxes.nearest_first(centre, farthest * farthest, |group| {
            groups += 1;
            let first = group * FAN;
            for face in self.faces.iter().skip(first).take(FAN) {
                let found = foot(face, centre);
                let far = found.squared.sqrt();
                if far > farthest {
                    continue;
                }
                let between = away - (centre - found.point) * (1.0 / far);
                let apart: f64 = (0..M)
                    .map(|k| {
                        (0..D).map(|i| between[i] * cell[i].gradient[k]).sum::<f64>().abs()
                    })
                    .sum();
                model.lower = model.lower.max(own + distance - far + apart + 2.0 * remainders);
            }
            if groups > MOST_GROUPS { 0.0 } else { farthest * farthest }
        });
        (groups <= MOST_GROUPS).then_some(model)
    }

    /// A model of the signed distance `f` at the centre of a cell that the surface may pass; `None` if too many faces
    /// may be nearest somewhere in it, if they face too different ways, or if faces cross.
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
        if self.signs.is_some() {
            return None;
        }
        let centre = Vector(cell.map(|x| x.value));
        let sides: [Vector<f64, D>; M] =
            std::array::from_fn(|k| Vector(cell.map(|x| x.gradient[k])));
        let farthest = f.abs() + 2.0 * radius + rounding;
        let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; M];
        // The first normal, and the least cosine of another with it.
        let mut first: Option<Vector<f64, D>> = None;
        let (mut least, mut groups, mut is_known) = (1.0_f64, 0, true);
        self.boxes.nearest_first(centre, farthest * farthest, |group| {
            groups += 1;
            for face in self.faces.iter().skip(group * FAN).take(FAN) {
                if foot(face, centre).squared.sqrt() > farthest {
                    continue;
                }
                let (normal, error) = outward(face);
                let cosine = first.get_or_insert(normal).dot(normal) - 2.0 * error;
                least = least.min(cosine);
                is_known &= cosine > LEAST_COSINE;
                for (range, side) in ranges.iter_mut().zip(&sides) {
                    let (along, error) = (normal.dot(*side), error * side.norm());
                    *range = [range[0].min(along - error), range[1].max(along + error)];
                }
            }
            if is_known && groups <= MOST_GROUPS { farthest * farthest } else { 0.0 }
        });
        if !is_known || groups > MOST_GROUPS || first.is_none() {
            return None;
        }
        let mut model = AffineModel { value: f, gradient: [0.0; M], lower: 0.0, upper: 0.0 };
        // A sum of weights one of the normals is at least as long as the least cosine.
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
}

/// The outward unit normal of a face, and a bound of its error.
fn outward<const N: usize, const D: usize>(corners: &[Point<D>; N]) -> (Vector<f64, D>, f64) {
    let normal = across(corners);
    let (size, longest) = (
        normal.norm(),
        corners.iter().fold(0.0_f64, |longest, corner| {
            longest.max((*corner - corners[0]).norm()).max((*corner - corners[N - 1]).norm())
        }),
    );
    // Each component of a product of two sides is rounded thrice; the product of one side is exact.
    let error = 16.0 * f64::EPSILON * longest.powi(N as i32 - 1) / size;
    // Without area, no direction is known.
    if error < 1.0 { (normal * (1.0 / size), error) } else { (Vector::unit(0), 2.0) }
}

impl<const N: usize, const D: usize> From<Solid<N, D>> for Shape<D> {
    fn from(solid: Solid<N, D>) -> Self {
        Self::custom(solid)
    }
}
