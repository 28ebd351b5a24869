// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Local searches over an element.

use palpate_field::{Point, Shape, Vector};
use palpate_query::Element;

use crate::descent::Step;
use crate::{Descent, Weights, central_differences};

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

element_search!(ProjectedGradient, ", from the lowest of its vertices and its centroid");

impl ProjectedGradient {
    /// The search from a point of the element, or from its usual start.
    pub(crate) fn search<const N: usize, const D: usize>(
        &self,
        shape: &Shape<D>,
        element: &Element<N, D>,
        start: Option<&Weights<N>>,
    ) -> Descent<D> {
        let (mut weights, mut descent) = begin(shape, element, start);
        let mut p = descent.best;
        let farthest = element.farthest(p);
        if farthest == 0.0 {
            return descent;
        }
        let mut step = 0.5 / farthest;
        let mut gradient = descent.ask_slope(shape, p).1;
        descent.run(self.steps, |descent| {
            let downwards = gradient.normalized().unwrap_or(Vector::ZERO);
            let next = moved(&weights, element, p, downwards, step);
            if are_near(&next, &weights, self.tolerance) {
                return Step::None;
            }
            let there = element.at(&next);
            let (value, slope) = descent.ask_slope(shape, there);
            if value < descent.value - KEPT * gradient.dot(p - there) {
                descent.visit(there, value);
                (p, weights, gradient) = (there, next, slope);
                step /= self.decay;
            } else {
                step *= self.decay;
            }
            Step::Next
        })
    }
}

/// The weights of `p`, moved against a unit gradient, and back to where none is negative.
fn moved<const N: usize, const D: usize>(
    weights: &[f64; N],
    element: &Element<N, D>,
    p: Point<D>,
    gradient: Vector<f64, D>,
    step: f64,
) -> [f64; N] {
    let mut next = *weights;
    for (weight, vertex) in next.iter_mut().zip(element.vertices()) {
        *weight -= step * gradient.dot(*vertex - p);
    }
    onto_simplex(next)
}

/// Whether weights differ by less than the tolerance.
fn are_near<const N: usize>(a: &[f64; N], b: &[f64; N], tolerance: f64) -> bool {
    let squared: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
    squared < tolerance * tolerance
}

/// The weights at which a search starts: those that are given, or those of the lowest of the vertices
/// and the centroid.
fn begin<const N: usize, const D: usize>(
    shape: &Shape<D>,
    element: &Element<N, D>,
    given: Option<&Weights<N>>,
) -> ([f64; N], Descent<D>) {
    if let Some(given) = given {
        return (*given.of_vertices(), Descent::from_weights(shape, element, given));
    }
    let mut weights = *Weights::centroid().of_vertices();
    let mut descent = Descent::from_weights(shape, element, &Weights::centroid());
    for (i, vertex) in element.vertices().iter().enumerate() {
        let value = shape.distance(*vertex);
        if value < descent.value {
            descent = Descent::from_start(*vertex, value, 0);
            weights = std::array::from_fn(|k| if k == i { 1.0 } else { 0.0 });
        }
    }
    descent.evaluations = N as u32 + 1;
    (weights, descent)
}

/// The nearest weights of which none is negative and the sum is one: all less the same,
/// and those that would be negative zero.
fn onto_simplex<const N: usize>(weights: [f64; N]) -> [f64; N] {
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

element_search!(FrankWolfe, ", from its lowest vertex");

impl FrankWolfe {
    /// The search from a point of the element, or from its lowest vertex.
    pub(crate) fn search<const N: usize, const D: usize>(
        &self,
        shape: &Shape<D>,
        element: &Element<N, D>,
        start: Option<&Weights<N>>,
    ) -> Descent<D> {
        let descent = match start {
            Some(start) => Descent::from_weights(shape, element, start),
            None => least_vertex(shape, element).1,
        };
        let (mut p, mut is_settled) = (descent.best, false);
        let mut descent = descent.run(self.steps, |descent| {
            let (value, gradient) = descent.ask_slope(shape, p);
            if descent.steps > 0 {
                descent.visit(p, value);
            }
            let Some(vertex) = downwards(element, p, gradient, self.tolerance) else {
                is_settled = true;
                return Step::None;
            };
            let share = 2.0 / (f64::from(descent.steps) + 2.0);
            p += (vertex - p) * share;
            Step::Next
        });
        if !is_settled {
            descent.visit(p, shape.distance(p));
            descent.evaluations += 1;
        }
        descent
    }
}

/// The vertex with the least value, its number first, at which a search may start; all
/// vertices are asked.
fn least_vertex<const N: usize, const D: usize>(
    shape: &Shape<D>,
    element: &Element<N, D>,
) -> (usize, Descent<D>) {
    let values = element.vertices().map(|vertex| shape.distance(vertex));
    let least = (1..N).fold(0, |k, i| if values[i] < values[k] { i } else { k });
    (least, Descent::from_start(element.vertices()[least], values[least], N as u32))
}

/// The vertex that is farthest against a gradient at `p`.
pub(crate) fn support<const N: usize, const D: usize>(
    element: &Element<N, D>,
    p: Point<D>,
    gradient: Vector<f64, D>,
) -> Point<D> {
    let drops = element.vertices().map(|vertex| gradient.dot(p - vertex));
    let farthest = (1..N).fold(0, |k, i| if drops[i] > drops[k] { i } else { k });
    element.vertices()[farthest]
}

/// That vertex, unless the tangent plane at `p` is lower there by at most `tolerance` of the longest way to
/// a vertex: so much a convex field may be below its value at `p` somewhere on the element.
fn downwards<const N: usize, const D: usize>(
    element: &Element<N, D>,
    p: Point<D>,
    gradient: Vector<f64, D>,
    tolerance: f64,
) -> Option<Point<D>> {
    let vertex = support(element, p, gradient);
    let drop = gradient.dot(p - vertex).max(0.0);
    let is_settled = drop <= tolerance * element.farthest(p);
    (!is_settled).then_some(vertex)
}

/// What stands for the direction of a gradient that vanishes, in `PhysX`.
const FALLBACK: [f64; 3] = [0.5718, 0.7055, 0.4186];

/// The recipe as it ships. Over a triangle: a projected gradient descent on barycentric coordinates from
/// the lowest of the corners and the centroid, of 16 steps, whose length falls by 0.8 each time and of
/// which the first is half the way to the farthest corner. Gradients are central differences over a
/// voxel, made a unit long. Every step is taken, and the last point is the answer. Over a segment: 16
/// golden sections with two samples each, and the middle of what is left; a start does not matter there.
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

    /// The search from a point of the element, or from its usual start.
    pub(crate) fn search<const N: usize, const D: usize>(
        &self,
        shape: &Shape<D>,
        element: &Element<N, D>,
        start: Option<&Weights<N>>,
    ) -> Descent<D> {
        if N == 2 {
            return self.along(shape, element);
        }
        let (mut weights, descent) = begin(shape, element, start);
        let (mut p, farthest) = (descent.best, element.farthest(descent.best));
        let offset = self.offset(shape, element);
        if farthest == 0.0 {
            return descent;
        }
        let mut step = 0.5 / farthest;
        let mut descent = descent.run(self.steps, |descent| {
            let gradient = central_differences(|p| shape.distance(p), p, offset);
            descent.evaluations += 2 * D as u32;
            let direction = gradient.unwrap_or_else(|| {
                Vector(std::array::from_fn(|k| FALLBACK[k]))
                    .normalized()
                    .unwrap_or(Vector::ZERO)
            });
            let next = moved(&weights, element, p, direction, step);
            let is_last = are_near(&next, &weights, self.tolerance);
            (weights, p) = (next, element.at(&next));
            descent.path.push(p);
            step *= self.decay;
            if is_last { Step::Last } else { Step::Next }
        });
        (descent.best, descent.value) = (p, shape.distance(p));
        descent.evaluations += 1 + 2 * D as u32;
        descent
    }
}

element_search!(MacklinDescent, ", from the lowest of its vertices and its centroid");

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

element_search!(GoldenSection, ", from its lowest vertex");

impl GoldenSection {
    /// The search from a point of the element, or from its lowest vertex. The first line from one end of a
    /// segment is all of it; all others lead against the gradient.
    pub(crate) fn search<const N: usize, const D: usize>(
        &self,
        shape: &Shape<D>,
        element: &Element<N, D>,
        start: Option<&Weights<N>>,
    ) -> Descent<D> {
        let (descent, mut other_end) = match start {
            Some(start) => (Descent::from_weights(shape, element, start), None),
            None => {
                let (least, descent) = least_vertex(shape, element);
                (descent, (N == 2).then(|| element.vertices()[(least + 1) % N]))
            }
        };
        descent.run(self.steps, |descent| {
            let p = descent.best;
            let towards = other_end.take().or_else(|| {
                let (_, gradient) = descent.ask_slope(shape, p);
                downwards(element, p, gradient, self.tolerance)
            });
            let Some(towards) = towards else { return Step::None };
            let (lowest, value) = self.line(shape, p, towards - p);
            descent.evaluations += self.sections + 1;
            if value >= descent.value {
                return Step::Last;
            }
            descent.visit(lowest, value);
            Step::Next
        })
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
