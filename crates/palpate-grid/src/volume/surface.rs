// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The surface where a volume has a value.

use palpate_field::{Aabb, Bounds, CustomField, Point, Promise, Rounding, Shape, Vector};
use palpate_mesh::{ContourError, ContourOptions, TriangleMesh};

use super::{Inside, Volume, VolumeProblem};
use crate::grid::raveled;

/// The value less what a volume has at a place, interpolated linearly between its nodes: with the sign of distances,
/// negative where samples are larger. A step beyond its nodes and farther it is the value less the least sample.
///
/// A place is a number of steps along each axis, so that nodes have whole numbers however the volume lies in space.
#[derive(Debug)]
struct Above {
    counts: [usize; 3],
    samples: Vec<f32>,
    value: f64,
    /// The value less the least sample.
    outside: f64,
    promise: Promise<3>,
}

impl Volume {
    /// The surface where the samples have a value, closed, around what is above it, or below it if that is
    /// [`inside`](Self::inside). What the volume cuts off is closed half a step beyond its border. No sample is passed
    /// over, however large or turned the steps are.
    ///
    /// # Errors
    ///
    /// If no surface lies at the value, or it takes too many triangles.
    pub fn surface(&self, value: f64) -> Result<TriangleMesh, VolumeProblem> {
        let [least, largest] = self.range();
        if !(f64::from(least) < value && value < f64::from(largest)) {
            return Err(VolumeProblem::NoSurface { value, least, largest });
        }
        let above = match self.inside {
            Inside::Above => Above::new(self.counts, self.samples.clone(), value, least.into()),
            // What is below a value is above it with the signs turned.
            Inside::Below => {
                let samples = self.samples.iter().map(|sample| -*sample).collect();
                Above::new(self.counts, samples, -value, -f64::from(largest))
            }
        };
        let options =
            ContourOptions { node: Some(Vector::ZERO), ..ContourOptions::with_cell(1.0) };
        let mesh = TriangleMesh::of_shape(&Shape::custom(above), &options).map_err(refused)?;
        let [x, y, z] = self.steps;
        let place = |at: &Point<3>| self.origin + x * at[0] + y * at[1] + z * at[2];
        // Steps that are left-handed turn faces over.
        let is_mirrored = x.cross(y).dot(z) < 0.0;
        let face = |[a, b, c]: &[u32; 3]| if is_mirrored { [*a, *c, *b] } else { [*a, *b, *c] };
        let (vertices, faces) = (mesh.vertices(), mesh.elements());
        let placed = TriangleMesh::new(
            vertices.iter().map(place).collect(),
            faces.iter().map(face).collect(),
        );
        placed.map_err(|error| refused(error.into()))
    }
}

/// Why there is no mesh, with what can be done about it.
fn refused(error: ContourError) -> VolumeProblem {
    match error {
        ContourError::TooMany { limit, .. } => VolumeProblem::TooFine { limit },
        error => VolumeProblem::Contour(error),
    }
}

impl Above {
    fn new(counts: [usize; 3], samples: Vec<f32>, value: f64, least: f64) -> Self {
        let ends = [Vector([-1.0; 3]), Vector(counts.map(|count| count as f64))];
        let aabb = Aabb { min: ends[0], max: ends[1] };
        let outside = value - least;
        // A derivative along an axis is at most the largest difference of neighbours.
        let mut steepest = [outside; 3];
        for (number, sample) in samples.iter().enumerate() {
            let mut rest = number;
            let mut way = 1;
            for (axis, steepest) in steepest.iter_mut().enumerate() {
                let index = rest % counts[axis];
                rest /= counts[axis];
                let is_last = index + 1 == counts[axis];
                let next = if is_last { least } else { f64::from(samples[number + way]) };
                *steepest = steepest.max((next - f64::from(*sample)).abs());
                if index == 0 {
                    *steepest = steepest.max((f64::from(*sample) - least).abs());
                }
                way *= counts[axis];
            }
        }
        let slope = Vector(steepest).norm();
        let rounding = Rounding::of_operations(64.0, slope * aabb.radius_about_origin());
        let promise = Promise::lipschitz(Some(Bounds::of_box(aabb)), slope * (1.0 + 1e-9));
        Self { counts, samples, value, outside, promise: promise.with_rounding(rounding) }
    }

    /// The field's value at a node, which may be beyond the border.
    fn at(&self, index: [i64; 3]) -> f64 {
        let mut node = [0; 3];
        for (axis, node) in node.iter_mut().enumerate() {
            match usize::try_from(index[axis]) {
                Ok(i) if i < self.counts[axis] => *node = i,
                _ => return self.outside,
            }
        }
        self.value - f64::from(self.samples[raveled(node, self.counts)])
    }
}

impl CustomField<3> for Above {
    fn distance(&self, p: Point<3>) -> f64 {
        self.distance_gradient(p).0
    }

    fn distance_gradient(&self, p: Point<3>) -> (f64, Vector<f64, 3>) {
        let (mut first, mut local) = ([0_i64; 3], [0.0; 3]);
        for axis in 0..3 {
            let along = p[axis];
            let last = self.counts[axis] as f64;
            if !(-1.0..=last).contains(&along) {
                return (self.outside, Vector::ZERO);
            }
            first[axis] = along.floor() as i64;
            local[axis] = along - along.floor();
        }
        let (mut value, mut gradient) = (0.0, Vector::ZERO);
        for corner in 0..8_usize {
            let side: [usize; 3] = std::array::from_fn(|axis| (corner >> axis) & 1);
            let sample = self.at(std::array::from_fn(|axis| first[axis] + side[axis] as i64));
            let weight =
                |axis: usize| if side[axis] == 1 { local[axis] } else { 1.0 - local[axis] };
            let sign = |axis: usize| if side[axis] == 1 { 1.0 } else { -1.0 };
            value += weight(0) * weight(1) * weight(2) * sample;
            gradient[0] += sign(0) * weight(1) * weight(2) * sample;
            gradient[1] += weight(0) * sign(1) * weight(2) * sample;
            gradient[2] += weight(0) * weight(1) * sign(2) * sample;
        }
        (value, gradient)
    }

    fn promise(&self) -> &Promise<3> {
        &self.promise
    }
}
