// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The surface where a volume has a value.

use palpate_field::{Aabb, Bounds, CustomField, Point, Promise, Rounding, Shape, Vector};
use palpate_mesh::{ContourOptions, TriangleMesh};

use super::{Inside, Volume, VolumeProblem};
use crate::lattice::raveled;

/// What a volume has more than a value, interpolated linearly between its nodes, with the sign of distances:
/// negative where samples are larger. Beyond its nodes there is nothing.
#[derive(Debug)]
struct Above {
    volume: Volume,
    value: f64,
    /// What is outside: the value less the least sample.
    outside: f64,
    /// What takes a way [m] to steps along each axis.
    inverse: [Vector<f64, 3>; 3],
    promise: Promise<3>,
}

impl Volume {
    /// The surface where the samples have a value, closed, around what is above it, or below it if that is
    /// [`inside`](Self::inside). What the volume cuts off is closed half a step beyond its border.
    ///
    /// # Errors
    ///
    /// If no surface lies at the value, or it takes too many triangles.
    pub fn surface(&self, value: f64) -> Result<TriangleMesh, VolumeProblem> {
        let [least, largest] = self.range();
        if !(f64::from(least) < value && value < f64::from(largest)) {
            return Err(VolumeProblem::NoSurface { value, least, largest });
        }
        let steps = self.steps.map(Vector::norm);
        let cell = steps.into_iter().fold(f64::INFINITY, f64::min);
        let mut volume = self.clone();
        let above = match self.inside {
            Inside::Above => Above::new(volume, value, least.into()),
            // What is below a value is above it with the signs turned.
            Inside::Below => {
                for sample in &mut volume.samples {
                    *sample = -*sample;
                }
                Above::new(volume, -value, -f64::from(largest))
            }
        };
        // On the nodes of the volume, no sample is passed over.
        let options = ContourOptions::with_cell(cell).with_node(self.origin);
        Ok(TriangleMesh::of_shape(&Shape::custom(above), &options)?)
    }
}

impl Above {
    fn new(volume: Volume, value: f64, least: f64) -> Self {
        let inverse = volume.steps.map(|step| step * (1.0 / step.dot(step)));
        let ends = (0..8_usize).map(|corner| {
            (0..3).fold(volume.origin, |p, axis| {
                let last = volume.counts[axis] as f64;
                let index = if (corner >> axis) & 1 == 0 { -1.0 } else { last };
                p + volume.steps[axis] * index
            })
        });
        let aabb = Aabb::around(ends).unwrap_or(Aabb { min: Vector::ZERO, max: Vector::ZERO });
        let outside = value - least;
        // A derivative along an axis is at most the largest difference of neighbours.
        let mut steepest = [outside; 3];
        for (number, sample) in volume.samples.iter().enumerate() {
            let mut rest = number;
            let mut way = 1;
            for (axis, steepest) in steepest.iter_mut().enumerate() {
                let index = rest % volume.counts[axis];
                rest /= volume.counts[axis];
                if index + 1 < volume.counts[axis] {
                    let next = f64::from(volume.samples[number + way]);
                    *steepest = steepest.max((next - f64::from(*sample)).abs());
                } else {
                    *steepest = steepest.max((f64::from(*sample) - least).abs());
                }
                if index == 0 {
                    *steepest = steepest.max((f64::from(*sample) - least).abs());
                }
                way *= volume.counts[axis];
            }
        }
        let slope: Vector<f64, 3> =
            Vector(std::array::from_fn(|axis| steepest[axis] / volume.steps[axis].norm()));
        let promise =
            Promise::lipschitz(Some(Bounds::of_box(aabb)), slope.norm() * (1.0 + 1e-9))
                .with_rounding(Rounding::of_operations(
                    64.0,
                    slope.norm() * aabb.radius_about_origin(),
                ));
        Self { volume, value, outside, inverse, promise }
    }

    /// The field's value at a node, which may be beyond the border.
    fn at(&self, index: [i64; 3]) -> f64 {
        let mut node = [0; 3];
        for (axis, node) in node.iter_mut().enumerate() {
            match usize::try_from(index[axis]) {
                Ok(i) if i < self.volume.counts[axis] => *node = i,
                _ => return self.outside,
            }
        }
        self.value - f64::from(self.volume.samples[raveled(node, self.volume.counts)])
    }
}

impl CustomField<3> for Above {
    fn distance(&self, p: Point<3>) -> f64 {
        self.distance_gradient(p).0
    }

    fn distance_gradient(&self, p: Point<3>) -> (f64, Vector<f64, 3>) {
        let (mut first, mut local) = ([0_i64; 3], [0.0; 3]);
        for axis in 0..3 {
            let along = (p - self.volume.origin).dot(self.inverse[axis]);
            let last = self.volume.counts[axis] as f64;
            if !(-1.0..=last).contains(&along) {
                return (self.outside, Vector::ZERO);
            }
            first[axis] = along.floor() as i64;
            local[axis] = along - along.floor();
        }
        let (mut value, mut slopes) = (0.0, [0.0; 3]);
        for corner in 0..8_usize {
            let side: [usize; 3] = std::array::from_fn(|axis| (corner >> axis) & 1);
            let sample = self.at(std::array::from_fn(|axis| first[axis] + side[axis] as i64));
            let weight =
                |axis: usize| if side[axis] == 1 { local[axis] } else { 1.0 - local[axis] };
            let sign = |axis: usize| if side[axis] == 1 { 1.0 } else { -1.0 };
            value += weight(0) * weight(1) * weight(2) * sample;
            slopes[0] += sign(0) * weight(1) * weight(2) * sample;
            slopes[1] += weight(0) * sign(1) * weight(2) * sample;
            slopes[2] += weight(0) * weight(1) * sign(2) * sample;
        }
        let gradient =
            (0..3).fold(Vector::ZERO, |sum, axis| sum + self.inverse[axis] * slopes[axis]);
        (value, gradient)
    }

    fn promise(&self) -> &Promise<3> {
        &self.promise
    }
}
