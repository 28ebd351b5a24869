// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Searches at rest, repeated at equal steps of time: what an engine does that has no continuous
//! search. What is thinner than a step is long is passed through.

use palpate_mesh::Mesh;
use palpate_query::{Element, Motion, Moving, QueryError};

use super::course::Course;
use super::{LocalSweep, LocalTouch};
use crate::{ElementMethod, PairMethod, SumDescent, halton_starts};

/// A local search at rest at each of equal steps of time, until one finds a touch.
///
/// ```
/// use palpate_field::{Pose, Screw, Shape, Vector};
/// use palpate_local::{ElementMethod, SampledSweep};
/// use palpate_mesh::Outline;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // A square of 2 m falls by 8 m: 60 steps find a plate of 0.5 m, and pass one of 2 cm.
/// let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(Vector).to_vec();
/// let square = Outline::new(corners, vec![[0, 1], [1, 2], [2, 3], [3, 0]])?;
/// let [from, to] = [4.0, -4.0].map(|y| Pose::translation([0.0, y]));
/// let falls = Screw::new(from, to, 0)?;
/// let sampled = SampledSweep::new(60, 1e-6);
/// let first = |height: f64| -> Result<_, Box<dyn std::error::Error>> {
///     let plate = Shape::<2>::cuboid([0.1, height])?;
///     Ok(sampled.of_mesh(&plate, &square, falls, ElementMethod::GoldenSection)?.touch)
/// };
/// assert!(first(0.5)?.is_some() && first(0.02)?.is_none());
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SampledSweep {
    /// How many steps the motion has; the begin is asked too.
    pub samples: u32,
    /// The largest value of a touch on a mesh, and the largest separation of one between bodies [m].
    pub gap: f64,
    /// Starts of the search between two bodies at each step; 40.
    pub starts: u32,
}

impl SampledSweep {
    /// A search at so many steps for a separation of at most `gap` [m].
    #[must_use]
    pub const fn new(samples: u32, gap: f64) -> Self {
        Self { samples, gap, starts: SumDescent::STARTS }
    }

    /// The same search with another number of starts between two bodies.
    #[must_use]
    pub const fn with_starts(self, starts: u32) -> Self {
        Self { starts, ..self }
    }

    /// The first step at which `method` finds a place on a mesh at which the field is at most the gap.
    /// Elements at the centre of whose smallest ball the field is more than its steepness times the radius
    /// are passed over, as `PhysX` does.
    ///
    /// # Errors
    ///
    /// If there is no step, the gap is not positive, or a pose is not finite.
    pub fn of_mesh<'a, const N: usize, const D: usize>(
        &self,
        field: impl Into<Moving<'a, D>>,
        mesh: &Mesh<N, D>,
        motion: impl Into<Motion<D>>,
        method: ElementMethod,
    ) -> Result<LocalSweep<D>, QueryError> {
        let course = Course::new(field.into(), motion.into())?;
        let shape = course.field.shape;
        let steepness = shape.promise().lipschitz.max(1.0);
        self.first(|time, found| {
            let (world_from_body, world_from_element) =
                (course.field.motion.pose(time), course.motion.pose(time));
            let body_from_element = world_from_body.inverse() * world_from_element;
            for index in 0..mesh.elements().len() {
                let corners =
                    mesh.corners(index).map(|corner| body_from_element.transform_point(corner));
                let element = Element::new(corners)?;
                let ball = element.smallest_ball();
                found.asked(1);
                if shape.distance(ball.centre) > steepness * ball.radius + self.gap {
                    continue;
                }
                found.searched += 1;
                let descent = method.descend(shape, &element);
                found.asked(descent.evaluations);
                let point = world_from_body.transform_point(descent.best);
                let value = descent.value;
                found.keep_lower(LocalTouch { time, point, value, element: index }, self.gap);
            }
            Ok(())
        })
    }

    /// The first step at which `method` finds a point at which both fields are at most half of the gap,
    /// from one of the [`halton_starts`].
    ///
    /// # Errors
    ///
    /// As [`of_mesh`](Self::of_mesh).
    pub fn of_pair<'a, const D: usize>(
        &self,
        a: impl Into<Moving<'a, D>>,
        b: impl Into<Moving<'a, D>>,
        method: PairMethod,
    ) -> Result<LocalSweep<D>, QueryError> {
        let bodies = [a.into(), b.into()];
        self.first(|time, found| {
            let [a, b] = bodies.map(|body| body.at(time));
            for start in halton_starts(a, b, self.starts) {
                let descent = method.descend(a, b, start, 0.1 * self.gap)?;
                found.searched += 1;
                found.asked(descent.evaluations);
                let (point, value) = (descent.best, descent.value);
                found.keep_lower(LocalTouch { time, point, value, element: 0 }, 0.5 * self.gap);
            }
            Ok(())
        })
    }

    /// What `search` finds at the first step at which it finds a touch.
    fn first<const D: usize>(
        &self,
        mut search: impl FnMut(f64, &mut LocalSweep<D>) -> Result<(), QueryError>,
    ) -> Result<LocalSweep<D>, QueryError> {
        for (what, value) in [("samples", f64::from(self.samples)), ("gap", self.gap)] {
            if value.is_nan() || value <= 0.0 {
                return Err(QueryError::Setting { what, value });
            }
        }
        let mut found = LocalSweep::nothing();
        for k in 0..=self.samples {
            search(f64::from(k) / f64::from(self.samples), &mut found)?;
            if found.touch.is_some() {
                break;
            }
        }
        Ok(found)
    }
}
