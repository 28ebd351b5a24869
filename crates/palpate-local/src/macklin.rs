// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Macklin et al.'s recipe for elements of a mesh (2020), with the constants of `PhysX` 5, which
//! has it in `sdfCollision.cuh`.

use palpate_field::{Shape, Vector};
use palpate_query::Element;

use crate::projected_gradient::{onto_simplex, start};
use crate::section::golden_bracket;
use crate::{Descent, Weights, central_differences};

/// What stands for the direction of a gradient that vanishes, in `PhysX`.
const FALLBACK: [f64; 3] = [0.5718, 0.7055, 0.4186];

/// The recipe as it ships. Over a triangle: a projected gradient descent on barycentric coordinates from
/// the lowest of the corners and the centroid, of 16 steps, whose length falls by 0.8 each time and of
/// which the first is half the way to the farthest corner. Gradients are central differences over a
/// voxel, made a unit long. Every step is taken, and the last point is the answer. Over a segment: 16
/// golden sections with two samples each, and the middle of what is left.
///
/// At most 107 samples a triangle, the last gradient for a contact's normal included, and 39 a segment
/// in space. [`ProjectedGradient`](crate::ProjectedGradient) and
/// [`GoldenSection`](crate::GoldenSection) are the same methods with their steps mended.
///
/// An upper bound of the minimum, without a proof. Steps that shrink by 0.8 add up to five times the
/// first; whether they end at the minimum depends on the way there:
///
/// ```
/// use palpate_field::{Shape, Vector};
/// use palpate_local::MacklinDescent;
/// use palpate_query::Element;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::<3>::ball(1.0)?;
/// let corners = [[-1.0, 1.5, -1.0], [2.0, 1.5, -1.0], [-1.0, 1.5, 2.0]].map(Vector);
/// let found = MacklinDescent::default().descend(&ball, &Element::new(corners)?);
/// assert!(found.evaluations <= 107 && (found.value - 0.5).abs() < 0.01);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MacklinDescent {
    /// Steps, or sections of a segment; 16.
    pub steps: u32,
    /// What the length of a step is multiplied by after each; 0.8.
    pub decay: f64,
    /// The descent ends with a step that changes the weights by less than this; 1e-3.
    pub tolerance: f64,
    /// The edge of a voxel of the sampled field, over which differences are taken [m]; a 256th of the
    /// longest edge of the field's box if `None`, or of the element where the field has no box.
    pub voxel: Option<f64>,
}

impl Default for MacklinDescent {
    fn default() -> Self {
        Self { steps: 16, decay: 0.8, tolerance: 1e-3, voxel: None }
    }
}

impl MacklinDescent {
    /// Voxels along the longest edge of a field's box.
    const VOXELS: f64 = 256.0;

    /// The same recipe with another voxel [m].
    #[must_use]
    pub const fn with_voxel(self, voxel: f64) -> Self {
        Self { voxel: Some(voxel), ..self }
    }

    /// The same recipe with another number of steps.
    #[must_use]
    pub const fn with_steps(self, steps: u32) -> Self {
        Self { steps, ..self }
    }

    /// The search for the least value of a field over an element.
    #[must_use]
    pub fn descend<const N: usize, const D: usize>(
        &self,
        shape: &Shape<D>,
        element: &Element<N, D>,
    ) -> Descent<D> {
        if N == 2 {
            return self.along(shape, element);
        }
        let (weights, descent) = start(shape, element);
        self.follow(shape, element, weights, descent)
    }

    /// The same search from another point of the element; of a segment, it has no start.
    #[must_use]
    pub fn descend_from<const N: usize, const D: usize>(
        &self,
        shape: &Shape<D>,
        element: &Element<N, D>,
        start: &Weights<N>,
    ) -> Descent<D> {
        if N == 2 {
            return self.along(shape, element);
        }
        let descent = Descent::from_weights(shape, element, start);
        self.follow(shape, element, *start.of_vertices(), descent)
    }

    /// The offset of differences [m].
    fn offset<const N: usize, const D: usize>(
        &self,
        shape: &Shape<D>,
        element: &Element<N, D>,
    ) -> f64 {
        self.voxel.unwrap_or_else(|| {
            let half = |bounds: palpate_field::Bounds<D>| bounds.aabb.half_extents();
            let longest = shape
                .promise()
                .bounds
                .map(|bounds| half(bounds).0.into_iter().fold(0.0, f64::max) * 2.0);
            longest.unwrap_or_else(|| element.longest_edge()) / Self::VOXELS
        })
    }

    /// The middle of what sections leave of a segment.
    fn along<const N: usize, const D: usize>(
        &self,
        shape: &Shape<D>,
        element: &Element<N, D>,
    ) -> Descent<D> {
        let [from, to] = [element.vertices()[0], element.vertices()[1]];
        let at = |share: f64| from + (to - from) * share;
        let [low, high] = golden_bracket(self.steps, |share| shape.distance(at(share)));
        let middle = at(0.5 * (low + high));
        let evaluations = 2 * self.steps + 1 + 2 * D as u32;
        let mut descent = Descent::from_start(middle, shape.distance(middle), evaluations);
        descent.steps = self.steps;
        descent
    }

    fn follow<const N: usize, const D: usize>(
        &self,
        shape: &Shape<D>,
        element: &Element<N, D>,
        mut weights: [f64; N],
        mut descent: Descent<D>,
    ) -> Descent<D> {
        let (mut p, farthest) = (descent.best, element.farthest(descent.best));
        let offset = self.offset(shape, element);
        if farthest == 0.0 {
            return descent;
        }
        let mut step = 0.5 / farthest;
        for _ in 0..self.steps {
            let gradient = central_differences(|p| shape.distance(p), p, offset);
            descent.evaluations += 2 * D as u32;
            let direction = gradient.unwrap_or_else(|| {
                Vector(std::array::from_fn(|k| FALLBACK[k]))
                    .normalized()
                    .unwrap_or(Vector::ZERO)
            });
            let mut next = weights;
            for (weight, vertex) in next.iter_mut().zip(element.vertices()) {
                *weight -= step * direction.dot(*vertex - p);
            }
            let next = onto_simplex(next);
            let squared: f64 = next.iter().zip(&weights).map(|(a, b)| (a - b) * (a - b)).sum();
            (weights, p) = (next, element.at(&next));
            descent.steps += 1;
            descent.path.push(p);
            step *= self.decay;
            if squared < self.tolerance * self.tolerance {
                break;
            }
        }
        (descent.best, descent.value) = (p, shape.distance(p));
        descent.evaluations += 1 + 2 * D as u32;
        descent
    }
}
