// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Fields as searches sample them.

use std::sync::{Mutex, PoisonError};

use palpate_field::{
    BLOCK, Block, BoundingBall, Column, Gradients, LARGEST_LENGTH, Point, Pose, Quality, Shape,
    Vector,
};

use crate::error::QueryError;
use crate::pair::PairWorkspace;

/// Roundings of a distance between points, and of the points themselves, which move by
/// one each time that an element is halved; relative to the largest coordinate.
const GEOMETRY_ROUNDINGS: f64 = 64.0;

/// The points that searches ask at once.
pub(crate) const AT_ONCE: usize = 8;

/// Memory of samples.
#[derive(Debug)]
pub(crate) struct Samples<const D: usize> {
    block: Block<f64, D, BLOCK>,
    values: Column<f64, BLOCK>,
    slopes: Gradients<f64, D, BLOCK>,
}

impl<const D: usize> Samples<D> {
    /// Searches of a ball's way make these for each question, so nothing is written here.
    #[inline(always)]
    pub(crate) fn new() -> Self {
        Self {
            block: Block::scratch(),
            values: Column::scratch(),
            slopes: Gradients::scratch(),
        }
    }
}

/// How far a value bounds the field around it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Steepness<const D: usize> {
    pub(crate) lipschitz: f64,
    /// Where `lipschitz` holds, if not everywhere.
    region: Option<BoundingBall<D>>,
    /// The rounding of values and of their bounds [m].
    pub(crate) slack: f64,
}

impl<const D: usize> Steepness<D> {
    /// For points at most `reach` from the origin [m], and values from `level` on.
    #[inline]
    pub(crate) fn new(shape: &Shape<D>, reach: f64, level: f64) -> Self {
        let promise = shape.promise();
        let roundings = GEOMETRY_ROUNDINGS * reach * promise.lipschitz + 2.0 * level.abs();
        Self {
            lipschitz: promise.lipschitz,
            region: promise.region,
            slack: promise.rounding.within(reach) + f64::EPSILON * roundings,
        }
    }

    /// `true` if the steepness holds within `far` of `p` [m].
    #[inline]
    pub(crate) fn holds_within(&self, p: Point<D>, far: f64) -> bool {
        self.region.is_none_or(|region| (p - region.centre).norm() + far <= region.radius)
    }

    /// The largest change of values within `far` of `p`, rounding included [m].
    #[inline]
    pub(crate) fn change(&self, p: impl FnOnce() -> Point<D>, far: f64) -> f64 {
        match &self.region {
            Some(region) if (p() - region.centre).norm() + far > region.radius => f64::INFINITY,
            _ => self.lipschitz * far + self.slack,
        }
    }

    /// Lower bound within `far` of `p`, from the value there [m].
    #[inline]
    pub(crate) fn bound(&self, p: Point<D>, value: f64, far: f64) -> f64 {
        value - self.change(|| p, far)
    }
}

/// Evaluates a field, a short block at a time, and counts evaluations.
pub(crate) struct Sampler<'a, const D: usize> {
    shape: &'a Shape<D>,
    samples: &'a mut Samples<D>,
    pub(crate) steepness: Steepness<D>,
    /// Subtracted from every value, so that the question is about zero [m].
    level: f64,
    pub(crate) evaluations: u32,
}

impl<'a, const D: usize> Sampler<'a, D> {
    /// For points at most `reach` from the origin [m], and values from `level` on.
    #[inline]
    pub(crate) fn new(
        shape: &'a Shape<D>,
        samples: &'a mut Samples<D>,
        reach: f64,
        level: f64,
    ) -> Self {
        let steepness = Steepness::new(shape, reach, level);
        Self { shape, samples, steepness, level, evaluations: 0 }
    }

    /// `true` if the field is a convex function.
    pub(crate) fn is_convex(&self) -> bool {
        self.shape.promise().convex
    }

    /// `true` if positive values are distances.
    pub(crate) fn is_exact_outside(&self) -> bool {
        self.shape.promise().outside == Quality::Exact
    }

    /// The value at a point.
    #[inline(always)]
    pub(crate) fn value(&mut self, p: Point<D>) -> f64 {
        self.evaluations += 1;
        self.shape.distance(p) - self.level
    }

    /// The value at a point and its gradient.
    #[inline(always)]
    pub(crate) fn slope(&mut self, p: Point<D>) -> (f64, Vector<f64, D>) {
        self.evaluations += 2;
        let (value, gradient) = self.shape.distance_gradient(p);
        (value - self.level, gradient)
    }

    /// The values at points.
    #[inline(always)]
    pub(crate) fn values(&mut self, points: &[Point<D>; AT_ONCE]) -> [f64; AT_ONCE] {
        self.evaluations += AT_ONCE as u32;
        let samples = &mut *self.samples;
        samples.block.fill(AT_ONCE, |i| points[i]);
        self.shape.block_distances(&samples.block, AT_ONCE, &mut samples.values);
        let mut values = [0.0; AT_ONCE];
        for (value, found) in values.iter_mut().zip(samples.values.as_slice()) {
            *value = found - self.level;
        }
        values
    }

    /// The values at points, and the unit vectors in which they grow.
    #[inline(always)]
    pub(crate) fn slopes(
        &mut self,
        points: &[Point<D>; AT_ONCE],
    ) -> ([f64; AT_ONCE], [Vector<f64, D>; AT_ONCE]) {
        self.evaluations += 2 * AT_ONCE as u32;
        let samples = &mut *self.samples;
        samples.block.fill(AT_ONCE, |i| points[i]);
        self.shape.block_gradients(&samples.block, AT_ONCE, &mut samples.slopes);
        let (mut values, mut directions) = ([0.0; AT_ONCE], [Vector::ZERO; AT_ONCE]);
        for i in 0..AT_ONCE {
            values[i] = samples.slopes.distance.get(i) - self.level;
            directions[i] = unit(samples.slopes.gradient.get(i));
        }
        (values, directions)
    }

    /// As [`free_radius`].
    #[inline]
    pub(crate) fn free_radius(&self, p: Point<D>, value: f64) -> f64 {
        free_radius(self.shape, p, value)
    }
}

/// The radius of a ball about `p` in which the field of `shape` is positive, from a positive value
/// there, rounding of the value and of points included; negative where rounding exceeds the
/// value; all in metres.
///
/// ```
/// use palpate_field::Shape;
/// use palpate_query::free_radius;
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let ball = Shape::<3>::ball(1.0)?;
/// let free = free_radius(&ball, [3.0, 0.0, 0.0].into(), 2.0);
/// assert!(2.0 - 1e-12 < free && free < 2.0);
/// # Ok(())
/// # }
/// ```
#[inline]
#[must_use]
pub fn free_radius<const D: usize>(shape: &Shape<D>, p: Point<D>, value: f64) -> f64 {
    let (promise, reach) = (shape.promise(), p.norm());
    let slack = promise.rounding.within(reach)
        + promise.lipschitz * GEOMETRY_ROUNDINGS * f64::EPSILON * reach;
    let value = value - slack;
    if value > 0.0 { promise.safe_radius(p, value) } else { value }
}

/// A gradient shorter than this gives no direction.
const FLAT: f64 = 1e-6;

/// The unit vector in which a field with this gradient grows; `None` below [`FLAT`].
pub(crate) fn normal<const D: usize>(gradient: Vector<f64, D>) -> Option<Vector<f64, D>> {
    let length = gradient.norm();
    (length >= FLAT).then(|| gradient * (1.0 / length))
}

/// The direction where neither field nor bodies give one: the y axis.
pub(crate) fn arbitrary<const D: usize>() -> Vector<f64, D> {
    Vector::unit(1)
}

/// The unit vector along `v`; zero if that is.
#[inline]
pub(crate) fn unit<const D: usize>(v: Vector<f64, D>) -> Vector<f64, D> {
    let length = v.norm();
    if length > 0.0 { v * (1.0 / length) } else { Vector::ZERO }
}

/// The larger of two numbers: a, unless b is larger. `f64::max` looks for NaN besides.
#[inline]
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// A shape and its pose. A plain `&Shape` converts to one at the identity.
///
/// ```
/// use palpate_field::{Pose, Shape, Vector, kernel::Ball};
/// use palpate_query::{Limits, PairWorkspace, Placed, separation};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::from_kernel(Ball::new(1.0)?);
/// let there = Placed::new(&ball, Pose::translation(Vector([0.0, 5.0, 0.0])));
/// let apart = separation(&ball, there, &Limits::new(1e-4), &mut PairWorkspace::new())?;
/// assert!(apart.lower <= 3.0 && 3.0 <= apart.upper);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a, const D: usize> {
    /// The shape.
    pub shape: &'a Shape<D>,
    /// From the shape's coordinates to the world's.
    pub world_from_body: Pose<D>,
}

impl<'a, const D: usize> Placed<'a, D> {
    /// `shape` moved by `world_from_body`.
    #[must_use]
    pub fn new(shape: &'a Shape<D>, world_from_body: Pose<D>) -> Self {
        Self { shape, world_from_body }
    }
}

impl<'a, const D: usize> From<&'a Shape<D>> for Placed<'a, D> {
    fn from(shape: &'a Shape<D>) -> Self {
        Self::new(shape, Pose::identity())
    }
}

/// Refuses the pose at this index if it is not finite, or so far away that squares overflow.
pub(crate) fn check_pose<const D: usize>(
    index: usize,
    pose: &Pose<D>,
) -> Result<(), QueryError> {
    if !pose.is_finite() {
        return Err(QueryError::Pose { index });
    }
    let far = pose.translation.0.into_iter().find(|x| x.abs() > LARGEST_LENGTH);
    far.map_or(Ok(()), |value| Err(QueryError::Coordinate { what: "translation", value }))
}

/// Idle workspaces, in boxes: moving one takes a fifth of the time of a question. The contents
/// of a workspace change no answer.
#[derive(Debug)]
pub(crate) struct Pool<const D: usize>(Mutex<Vec<Box<PairWorkspace<D>>>>);

impl<const D: usize> Pool<D> {
    pub(crate) fn new() -> Self {
        Self(Mutex::new(Vec::new()))
    }

    /// Runs `ask` with a workspace, a new one if all are in use.
    pub(crate) fn with(&self, ask: impl FnOnce(&mut PairWorkspace<D>)) {
        let idle = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let lent = idle().pop();
        let mut workspace = lent.unwrap_or_default();
        ask(&mut workspace);
        idle().push(workspace);
    }
}
