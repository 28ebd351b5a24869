// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Projected gradient descent on barycentric coordinates: memoir 3.2, after Macklin et
//! al. (2020).

use palpate_field::{Point, Shape, Vector};
use palpate_query::Element;

use crate::{Descent, Weights};

/// The share of the promised descent that a step must keep.
const KEPT: f64 = 0.5;

/// Moves the weights of the vertices against the gradient, and back to where none is
/// negative and their sum is one.
///
/// Starts at the lowest of the vertices and the centroid. With the unit gradient `g` at
/// `p`, the weight of a vertex v falls by `t·g·(v − p)`; t starts at half of one over the
/// longest way to a vertex. The published descents take every step and return the last
/// point: with a constant t they go to and fro, with one that decays by 0.8 each time they
/// may stop before they arrive. Here a step is taken if it leads down by half of what the
/// tangent plane promises (Armijo 1966), and t grows; else t decays.
///
/// An upper bound of the minimum, without a proof: a descent ends in the valley where it
/// began. Here the centroid lies over a small ball, and a larger one is left out:
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ball};
/// use palpate_local::ProjectedGradient;
/// use palpate_query::{Element, Limits, ElementWorkspace, minimum};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let balls = Shape::union([
///     Shape::from_kernel(Ball::new(0.1)?),
///     Shape::from_kernel(Ball::new(0.2)?).translated(Vector([0.6, 0.0]))?,
/// ])?;
/// let corners = [Vector([-0.6, -0.9]), Vector([1.2, 0.0]), Vector([-0.6, 0.9])];
/// let triangle = Element::new(corners)?;
/// let found = ProjectedGradient::default().descend(&balls, &triangle);
/// let certified = minimum(&balls, &triangle, &Limits::new(1e-4), &mut ElementWorkspace::new())?;
/// assert!(found.value == -0.1 && certified.upper < -0.199);
/// let first = (ProjectedGradient {
///     steps: 1,
///     ..ProjectedGradient::default()
/// }).descend(&balls, &triangle);
/// assert_eq!(first.steps, 1);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProjectedGradient {
    /// Steps at most; 64, as in the memoir.
    pub steps: u32,
    /// What t is multiplied by after a step that was not taken, and divided by after one
    /// that was; 0.8.
    pub decay: f64,
    /// The descent ends with a step that changes the weights by less than this; 1e-3.
    pub tolerance: f64,
}

impl Default for ProjectedGradient {
    fn default() -> Self {
        Self { steps: 64, decay: 0.8, tolerance: 1e-3 }
    }
}

impl ProjectedGradient {
    /// The search for the least value of a field over an element, from the lowest of its
    /// vertices and its centroid.
    #[must_use]
    pub fn descend<const N: usize, const D: usize>(
        &self,
        shape: &Shape<D>,
        element: &Element<N, D>,
    ) -> Descent<D> {
        let (weights, descent) = start(shape, element);
        self.follow(shape, element, weights, descent)
    }

    /// The same search from another point of the element.
    #[must_use]
    pub fn descend_from<const N: usize, const D: usize>(
        &self,
        shape: &Shape<D>,
        element: &Element<N, D>,
        start: &Weights<N>,
    ) -> Descent<D> {
        let descent = Descent::from_weights(shape, element, start);
        self.follow(shape, element, *start.of_vertices(), descent)
    }

    /// The search from the point with these weights, which `descent` has visited.
    fn follow<const N: usize, const D: usize>(
        &self,
        shape: &Shape<D>,
        element: &Element<N, D>,
        mut weights: [f64; N],
        mut descent: Descent<D>,
    ) -> Descent<D> {
        let mut p = descent.best;
        let farthest = element.farthest(p);
        if farthest == 0.0 {
            return descent;
        }
        let mut step = 0.5 / farthest;
        let mut gradient = shape.distance_gradient(p).1;
        descent.evaluations += 2;
        for _ in 0..self.steps {
            let downwards = gradient.normalized().unwrap_or(Vector::ZERO);
            let mut next = weights;
            for (weight, vertex) in next.iter_mut().zip(element.vertices()) {
                *weight -= step * downwards.dot(*vertex - p);
            }
            let next = onto_simplex(next);
            let squared: f64 = next.iter().zip(&weights).map(|(a, b)| (a - b) * (a - b)).sum();
            if squared < self.tolerance * self.tolerance {
                break;
            }
            descent.steps += 1;
            let there = element.at(&next);
            let (value, slope) = shape.distance_gradient(there);
            descent.evaluations += 2;
            if value < descent.value - KEPT * gradient.dot(p - there) {
                descent.visit(there, value);
                (p, weights, gradient) = (there, next, slope);
                step /= self.decay;
            } else {
                step *= self.decay;
            }
        }
        descent
    }
}

/// The lowest of the vertices and the centroid, as weights.
pub(crate) fn start<const N: usize, const D: usize>(
    shape: &Shape<D>,
    element: &Element<N, D>,
) -> ([f64; N], Descent<D>) {
    let mut weights = [1.0 / N as f64; N];
    let centroid: Point<D> = element.at(&weights);
    let mut best = (centroid, shape.distance(centroid));
    for (i, vertex) in element.vertices().iter().enumerate() {
        let value = shape.distance(*vertex);
        if value < best.1 {
            best = (*vertex, value);
            weights = [0.0; N];
            weights[i] = 1.0;
        }
    }
    (weights, Descent::from_start(best.0, best.1, N as u32 + 1))
}

/// The nearest weights of which none is negative and the sum is one: all less the same,
/// and those that would be negative zero.
pub(crate) fn onto_simplex<const N: usize>(weights: [f64; N]) -> [f64; N] {
    let mut sorted = weights;
    sorted.sort_by(|a, b| b.total_cmp(a));
    let (mut sum, mut less) = (0.0, 0.0);
    for (i, weight) in sorted.iter().enumerate() {
        sum += weight;
        let shared = (sum - 1.0) / (i + 1) as f64;
        if *weight > shared {
            less = shared;
        }
    }
    weights.map(|weight| (weight - less).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_moved_by_the_same_or_to_zero() {
        assert_eq!(onto_simplex([0.5, 0.75, 0.5]), [0.25, 0.5, 0.25]);
        assert_eq!(onto_simplex([3.0, 0.5, -1.0]), [1.0, 0.0, 0.0]);
        assert_eq!(onto_simplex([1.0, 1.0, -0.5]), [0.5, 0.5, 0.0]);
        assert_eq!(onto_simplex([-7.0, -8.5]), [1.0, 0.0]);
        assert_eq!(onto_simplex([0.25, 0.75]), [0.25, 0.75]);
    }
}
