// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A grid as a field.

use palpate_field::scalar::AffineModel;
use palpate_field::{Aabb, CustomField, Point, Promise, Shape, Vector};

use crate::grid::{Grid, Tangent};

impl<const D: usize> CustomField<D> for Grid<D> {
    fn distance(&self, p: Point<D>) -> f64 {
        self.value_at(p)
    }

    fn distance_gradient(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        self.at(p)
    }

    fn distances(&self, points: &[Point<D>], distances: &mut [f64]) {
        self.values_at(points, distances);
    }

    fn distances_gradients(
        &self,
        points: &[Point<D>],
        distances: &mut [f64],
        gradients: &mut [Vector<f64, D>],
    ) {
        self.all_at(points, distances, gradients);
    }

    fn promise(&self) -> &Promise<D> {
        self.promise()
    }

    /// Over a few cells the tangent plane at the centre, and how far second derivatives lead off it. Over more the mean
    /// value form: the value at the centre, the middle of the range of each derivative over the box around the cell,
    /// and half the range times half the box for what it leaves open.
    fn model<const M: usize>(&self, cell: &[AffineModel<M>; D]) -> AffineModel<M> {
        let centre = Vector(cell.map(|x| x.value));
        let half = Vector(cell.map(|x| x.deviation()));
        let rounding = self.promise().rounding.within(centre.norm() + half.norm());
        let around = Aabb { min: centre - half, max: centre + half };
        let tangent = self.tangent(centre, &around, half);
        let (value, slopes, [below, above]) = match tangent {
            Some(Tangent { at: (value, slope), off }) => (value, slope, off),
            None => {
                let value = self.value_at(centre);
                let Some(slopes) = self.slopes_over(&around, value.abs()) else {
                    let lipschitz = self.promise().lipschitz;
                    return AffineModel::lipschitz(value, lipschitz, cell, rounding);
                };
                let off = (0..D).map(|i| slopes[i][1] * half[i]).sum();
                (value, Vector(slopes.map(|[middle, _]| middle)), [off; 2])
            }
        };
        let mut gradient = [0.0; M];
        // The slopes are rounded too.
        let mut remainder = 2.0 * rounding;
        for i in 0..D {
            for (k, gradient) in gradient.iter_mut().enumerate() {
                *gradient += slopes[i] * cell[i].gradient[k];
            }
            let bent = cell[i].lower.max(cell[i].upper);
            remainder += slopes[i].abs() * (bent + 4.0 * f64::EPSILON * half[i]);
        }
        let [lower, upper] =
            [below, above].map(|off| (off + remainder) * (1.0 + 16.0 * f64::EPSILON));
        AffineModel { value, gradient, lower, upper }
    }

    /// The bytes of its file.
    #[cfg(feature = "files")]
    fn content(&self, sink: &mut dyn FnMut(&[u8])) -> bool {
        self.put(Sink(sink)).is_ok()
    }
}

/// What is fed as what is written.
#[cfg(feature = "files")]
struct Sink<'a>(&'a mut dyn FnMut(&[u8]));

#[cfg(feature = "files")]
impl std::io::Write for Sink<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        (self.0)(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl<const D: usize> From<Grid<D>> for Shape<D> {
    #[inline(never)]
    fn from(grid: Grid<D>) -> Self {
        Self::custom(grid)
    }
}
