// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Golden sections of lines across the element (Kiefer 1953): of the whole edge in
//! Macklin et al. (2020), towards a vertex in the spatial half of Pelletier-Guénette et
//! al. (2025).

use palpate_field::{Point, Shape, Vector};
use palpate_query::Element;

use crate::section::least_on_unit;
use crate::{Descent, Weights, least_vertex, support};

/// From the lowest vertex, goes to the least value that golden sections find on the line
/// to the vertex that lies farthest against the gradient, and so on from there. On a
/// segment the first line is all of it.
///
/// An upper bound of the minimum, without a proof: sections find the minimum of a line on
/// which the field first falls and then grows, and some local one elsewhere. As
/// published they end in the middle of the last bracket; here with the lowest point.
///
/// A small bump on a floor lies between the points that are asked, and all of them are
/// equally high over the floor:
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::{Ball, HalfSpace}};
/// use palpate_local::GoldenSection;
/// use palpate_query::{Element, Limits, ElementWorkspace, minimum};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0]), 0.0)?);
/// let bump = Shape::from_kernel(Ball::new(0.05)?).translated(Vector([0.8, 0.125]))?;
/// let segment = Element::new([Vector([-1.0, 0.125]), Vector([1.0, 0.125])])?;
/// let scene = Shape::union([floor, bump])?;
/// let found = GoldenSection::default().descend(&scene, &segment);
/// let certified = minimum(&scene, &segment, &Limits::new(1e-4), &mut ElementWorkspace::new())?;
/// assert!(found.value == 0.125 && certified.upper < -0.0499);
/// let coarse = (GoldenSection {
///     sections: 2,
///     ..GoldenSection::default()
/// }).descend(&scene, &segment);
/// assert!(coarse.evaluations < found.evaluations);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GoldenSection {
    /// Lines at most; 16.
    pub steps: u32,
    /// Sections of a line; 16, which leave 1/2207 of it.
    pub sections: u32,
    /// By what share of the longest way to a vertex the tangent plane must still fall
    /// along the element for the search to go on; 1e-6.
    pub tolerance: f64,
}

impl Default for GoldenSection {
    fn default() -> Self {
        Self { steps: 16, sections: 16, tolerance: 1e-6 }
    }
}

impl GoldenSection {
    /// The search for the least value of a field over an element, from its lowest vertex.
    #[must_use]
    pub fn descend<const N: usize, const D: usize>(
        &self,
        shape: &Shape<D>,
        element: &Element<N, D>,
    ) -> Descent<D> {
        let (least, descent) = least_vertex(shape, element);
        // The line from one end of a segment is all of it.
        let other_end = (N == 2).then(|| element.vertices()[(least + 1) % N]);
        self.follow(shape, element, descent, other_end)
    }

    /// The same search from another point of the element.
    #[must_use]
    pub fn descend_from<const N: usize, const D: usize>(
        &self,
        shape: &Shape<D>,
        element: &Element<N, D>,
        start: &Weights<N>,
    ) -> Descent<D> {
        self.follow(shape, element, Descent::from_weights(shape, element, start), None)
    }

    /// The search from the point that `descent` has visited; its first line leads to `first`, if
    /// that is given, and the others against the gradient.
    fn follow<const N: usize, const D: usize>(
        &self,
        shape: &Shape<D>,
        element: &Element<N, D>,
        mut descent: Descent<D>,
        mut first: Option<Point<D>>,
    ) -> Descent<D> {
        for _ in 0..self.steps {
            let p = descent.best;
            let towards = if let Some(first) = first.take() {
                first
            } else {
                let (_, gradient) = shape.distance_gradient(p);
                descent.evaluations += 2;
                let (vertex, drop) = support(element, p, gradient);
                if drop <= self.tolerance * element.farthest(p) {
                    break;
                }
                element.vertices()[vertex]
            };
            descent.steps += 1;
            let (lowest, value) = self.line(shape, p, towards - p);
            descent.evaluations += self.sections + 1;
            if value >= descent.value {
                break;
            }
            descent.visit(lowest, value);
        }
        descent
    }

    /// The lowest of the points that sections of a line ask, and its value.
    fn line<const D: usize>(
        &self,
        shape: &Shape<D>,
        from: Point<D>,
        along: Vector<f64, D>,
    ) -> (Point<D>, f64) {
        let (share, value) =
            least_on_unit(self.sections, |share| shape.distance(from + along * share));
        (from + along * share, value)
    }
}
