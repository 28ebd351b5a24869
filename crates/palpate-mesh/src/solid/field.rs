// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A solid as a field.

use palpate_field::scalar::AffineModel;
use palpate_field::{CustomField, Point, Promise, Shape, Vector};

use super::Solid;
use super::foot::foot;
use crate::tree::FAN;

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
        let model = (distance > radius + rounding)
            .then(|| self.model_of_distance(cell, (distance, away), radius, rounding))
            .flatten();
        match model {
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

    /// The corners of all faces, in their order, and whether the distance is exact.
    fn content(&self, sink: &mut dyn FnMut(&[u8])) -> bool {
        for coordinate in self.faces.iter().flatten().flat_map(|corner| corner.0) {
            sink(&coordinate.to_le_bytes());
        }
        sink(self.promise().to_string().as_bytes());
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
}

impl<const N: usize, const D: usize> From<Solid<N, D>> for Shape<D> {
    fn from(solid: Solid<N, D>) -> Self {
        Self::custom(solid)
    }
}
