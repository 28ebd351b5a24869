// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Local searches over an element.

use palpate_field::{Point, Shape, Vector};
use palpate_query::Element;

use crate::{Descent, Weights, central_differences, least_vertex, support};

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

/// 1/φ: what is left of a bracket after a section, so that one of its two points is
/// used again.
const LEFT: f64 = 0.618_033_988_749_894_9;

/// The share from 0 to 1 at which `at` is least of those that `sections` sections ask, and its value.
/// `at` is asked once more often than there are sections.
///
/// It is the minimum of what first falls and then grows, and some local one elsewhere.
pub(crate) fn least_on_unit(sections: u32, mut at: impl FnMut(f64) -> f64) -> (f64, f64) {
    let (mut low, mut high) = (0.0, 1.0);
    let (mut left, mut right) = (1.0 - LEFT, LEFT);
    let (mut at_left, mut at_right) = (at(left), at(right));
    for _ in 1..sections {
        if at_left <= at_right {
            high = right;
            (right, at_right) = (left, at_left);
            left = high - LEFT * (high - low);
            at_left = at(left);
        } else {
            low = left;
            (left, at_left) = (right, at_right);
            right = low + LEFT * (high - low);
            at_right = at(right);
        }
    }
    if at_left <= at_right { (left, at_left) } else { (right, at_right) }
}

/// What `sections` sections leave of the bracket from 0 to 1, where both points of each section are
/// asked anew.
pub(crate) fn golden_bracket(sections: u32, mut at: impl FnMut(f64) -> f64) -> [f64; 2] {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..sections {
        let part = LEFT * (high - low);
        let (left, right) = (high - part, low + part);
        if at(left) < at(right) { high = right } else { low = left }
    }
    [low, high]
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

#[cfg(test)]
mod section_tests {
    use super::*;

    #[test]
    fn sections_close_in_on_the_minimum() {
        let mut asked = 0;
        let (share, value) = least_on_unit(30, |s| {
            asked += 1;
            (s - 0.3) * (s - 0.3)
        });
        assert!((share - 0.3).abs() < 1e-6 && value < 1e-12);
        assert_eq!(asked, 31);
    }
}
