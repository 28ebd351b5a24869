// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Frank and Wolfe's method (1956), which Macklin et al. (2020) apply to the triangles of
//! a mesh in a signed distance field.

use palpate_field::Shape;
use palpate_query::Element;

use crate::{Descent, Weights, least_vertex, support};

/// Goes from the lowest vertex `2/(k + 2)` of the way to the vertex that lies farthest
/// against the gradient, in step k.
///
/// An upper bound of the minimum, without a proof. Of a convex field that is smooth on
/// the element, with a gradient that varies by at most M times the way, the last value is
/// at most `2M·d²/(k + 2)` above the least, where d is the longest edge.
///
/// Of two bumps it finds one: here the start is on the left, and the deeper ball is not.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ball};
/// use palpate_local::FrankWolfe;
/// use palpate_query::{Element, Limits, ElementWorkspace, minimum};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let balls = Shape::union([
///     Shape::from_kernel(Ball::new(0.2)?).translated(Vector([-1.0, 0.0]))?,
///     Shape::from_kernel(Ball::new(0.1)?).translated(Vector([0.25, -0.3]))?,
/// ])?;
/// let segment = Element::new([Vector([-1.0, 0.25]), Vector([1.0, -0.75])])?;
/// let found = FrankWolfe::default().descend(&balls, &segment);
/// let certified = minimum(&balls, &segment, &Limits::new(1e-4), &mut ElementWorkspace::new())?;
/// assert!(certified.upper < -0.032 && found.value > 0.02);
/// let first = (FrankWolfe { steps: 1, ..FrankWolfe::default() }).descend(&balls, &segment);
/// assert_eq!(first.steps, 1);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrankWolfe {
    /// Steps at most; 16.
    pub steps: u32,
    /// By what share of the longest way to a vertex the tangent plane must still fall
    /// along the element for the search to go on; 1e-6.
    pub tolerance: f64,
}

impl Default for FrankWolfe {
    fn default() -> Self {
        Self { steps: 16, tolerance: 1e-6 }
    }
}

impl FrankWolfe {
    /// The search for the least value of a field over an element, from its lowest vertex.
    #[must_use]
    pub fn descend<const N: usize, const D: usize>(
        &self,
        shape: &Shape<D>,
        element: &Element<N, D>,
    ) -> Descent<D> {
        self.follow(shape, element, least_vertex(shape, element).1)
    }

    /// The same search from another point of the element.
    #[must_use]
    pub fn descend_from<const N: usize, const D: usize>(
        &self,
        shape: &Shape<D>,
        element: &Element<N, D>,
        start: &Weights<N>,
    ) -> Descent<D> {
        self.follow(shape, element, Descent::from_weights(shape, element, start))
    }

    /// The search from the point that `descent` has visited.
    fn follow<const N: usize, const D: usize>(
        &self,
        shape: &Shape<D>,
        element: &Element<N, D>,
        mut descent: Descent<D>,
    ) -> Descent<D> {
        let mut p = descent.best;
        for k in 0..self.steps {
            let (value, gradient) = shape.distance_gradient(p);
            descent.evaluations += 2;
            if k > 0 {
                descent.visit(p, value);
            }
            let (vertex, drop) = support(element, p, gradient);
            if drop <= self.tolerance * element.farthest(p) {
                return descent;
            }
            descent.steps += 1;
            let share = 2.0 / (f64::from(k) + 2.0);
            p += (element.vertices()[vertex] - p) * share;
        }
        descent.visit(p, shape.distance(p));
        descent.evaluations += 1;
        descent
    }
}
