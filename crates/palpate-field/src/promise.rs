// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Promises: how a field's value relates to the true distance.

use std::fmt;

use crate::bounds::{BoundingBall, Bounds};
use crate::pose::Pose;
use crate::scalar::Scalar;
use crate::vector::Point;

/// How the value `f` of a field relates to `d`, the distance to its surface.
///
/// Ordered from the strongest promise to the weakest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Quality {
    /// `|f| = d`.
    Exact,
    /// `|f| ≤ d`: safe to step by, possibly timid.
    Bound,
    /// `|f| ≤ L·d` with the field's Lipschitz constant `L`: divide before
    /// stepping.
    Lipschitz,
}

impl fmt::Display for Quality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Exact => "exact",
            Self::Bound => "a bound",
            Self::Lipschitz => "Lipschitz",
        })
    }
}

impl Quality {
    /// "exact", "bound" or "Lipschitz".
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Bound => "bound",
            Self::Lipschitz => "Lipschitz",
        }
    }

    /// `Exact` if both are, else `Bound`, or the weaker if one is weaker still.
    #[must_use]
    #[inline]
    pub fn and(self, other: Self) -> Self {
        self.max(other)
    }

    /// The same, but at best a bound.
    #[must_use]
    #[inline]
    pub fn bounded(self) -> Self {
        self.max(Self::Bound)
    }
}

/// The absolute error of `distance`, as a function of how far the point is from
/// the origin.
///
/// Composed per node from the count of its rounded operations, and checked
/// against double-double arithmetic on random trees.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Rounding {
    /// The error at the origin [m].
    pub constant: f64,
    /// The further error for each metre from the origin.
    pub per_metre: f64,
}

impl Rounding {
    /// The error of a formula of `operations` rounded operations on numbers up
    /// to `|p| + size` [m].
    #[must_use]
    #[inline]
    pub fn of_operations(operations: f64, size: f64) -> Self {
        let per_metre = operations * f64::EPSILON;
        Self { constant: per_metre * size, per_metre }
    }

    /// The error for points at most `radius` [m] from the origin.
    #[must_use]
    #[inline]
    pub fn within(&self, radius: f64) -> f64 {
        self.constant + self.per_metre * radius
    }

    /// The larger error of both, at every radius.
    #[must_use]
    #[inline]
    pub fn or(&self, other: &Self) -> Self {
        Self {
            constant: Scalar::max(self.constant, other.constant),
            per_metre: Scalar::max(self.per_metre, other.per_metre),
        }
    }

    /// The error of a sum or of nested steps.
    #[must_use]
    #[inline]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            constant: self.constant + other.constant,
            per_metre: self.per_metre + other.per_metre,
        }
    }

    /// The error at points that were up to `offset` [m] further out and
    /// `stretch` times as far before.
    #[must_use]
    #[inline]
    pub fn at(&self, stretch: f64, offset: f64) -> Self {
        Self { constant: self.within(offset), per_metre: self.per_metre * stretch }
    }

    /// The error of `factor` times the value.
    #[must_use]
    #[inline]
    pub fn times(&self, factor: f64) -> Self {
        Self { constant: self.constant * factor, per_metre: self.per_metre * factor }
    }
}

/// How far a field may be from the one that it stands in for, as a grid for the shape that was baked.
///
/// With both clamped to `within` on both sides, their values differ by at most `value` everywhere. So the
/// surface of each lies where the size of the other's values is at most `value`: of an exact source, nowhere
/// farther than `value` from its surface. Where the source is a bound, places may be farther off. (Where the
/// source is a bound that falls below the distance to its box, that distance is meant.) Where `within` is not
/// larger than `value`, nothing is known.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Deviation {
    /// The largest difference of the values [m].
    pub value: f64,
    /// The values to which both are clamped [m].
    pub within: f64,
}

impl Deviation {
    /// The values of one field beyond which the other has the same sign [m]; `None` if nothing is known.
    #[must_use]
    pub fn of_surface(&self) -> Option<f64> {
        (self.value < self.within).then_some(self.value)
    }

    /// The deviation of `factor` times the values.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self { value: self.value * factor, within: self.within * factor }
    }

    /// The deviation of what values change into that move by at most `by` [m].
    #[must_use]
    pub fn moved(self, by: f64) -> Self {
        Self { within: (self.within - by).max(0.0), ..self }
    }

    /// The deviation of an operation on two fields, of which either value may become the result.
    #[must_use]
    pub fn either(a: Option<Self>, b: Option<Self>) -> Option<Self> {
        let (Some(a), Some(b)) = (a, b) else { return a.or(b) };
        Some(Self { value: a.value.max(b.value), within: a.within.min(b.within) })
    }
}

/// All that a field promises about its values.
///
/// ```
/// use palpate_field::{BoundingBall, Promise, Vector};
///
/// // No steeper than 2 within 0.1 m of the origin; unknown elsewhere.
/// let region = BoundingBall { centre: Vector([0.0, 0.0]), radius: 0.1 };
/// let promise = Promise::lipschitz(None, 2.0).with_region(region);
/// assert_eq!(promise.safe_radius(Vector([0.03, 0.0]), 0.05), 0.025);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Promise<const D: usize> {
    /// The quality where `f > 0`.
    pub outside: Quality,
    /// The quality where `f < 0`.
    pub inside: Quality,
    /// The least known `L` with `|f(p) − f(q)| ≤ L‖p − q‖`.
    pub lipschitz: f64,
    /// The ball in which `lipschitz` holds; everywhere if `None`.
    pub region: Option<BoundingBall<D>>,
    /// Bounds of the set `f ≤ 0`; `None` if it has none.
    pub bounds: Option<Bounds<D>>,
    /// `true` if `f` is at least the distance to both bounds, everywhere outside
    /// them. Exact fields are; others are raised to the distance to
    /// their box where an operator needs it.
    pub above_bounds: bool,
    /// `true` if `f` is a convex function.
    pub convex: bool,
    /// For each axis, `true` if mirroring the axis changes nothing.
    #[cfg_attr(feature = "serde", serde(with = "crate::convert::serde"))]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<bool>"))]
    pub symmetric: [bool; D],
    /// `true` if points with `f < 0` may exist.
    pub has_interior: bool,
    /// The largest difference of two fields over which an operator in this tree
    /// still blends them [m]; zero if all are sharp.
    pub reach: f64,
    /// The absolute error of `distance` in double precision.
    pub rounding: Rounding,
    /// How far the field may be from the one that it stands in for; `None` if it stands for itself, as
    /// formulas do.
    pub deviation: Option<Deviation>,
}

impl<const D: usize> fmt::Display for Promise<D> {
    /// Says the qualities, the Lipschitz constant and the bounds.
    ///
    /// ```
    /// use palpate_field::Shape;
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let wheel = Shape::circle(0.5)? | Shape::rectangle([2.0, 0.5])?;
    /// assert_eq!(
    ///     wheel.promise().to_string(),
    ///     "exact outside, a bound inside, Lipschitz constant 1, \
    ///      within [-1.0, -0.5] to [1.0, 0.5] m",
    /// );
    /// # Ok(())
    /// # }
    /// ```
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { outside, inside, lipschitz, .. } = self;
        write!(f, "{outside} outside, {inside} inside, Lipschitz constant {lipschitz}")?;
        if let Some(region) = self.region {
            write!(f, " within {} m of {:?}", region.radius, region.centre.0)?;
        }
        match self.bounds {
            Some(Bounds { aabb, .. }) => {
                write!(f, ", within {:?} to {:?} m", aabb.min.0, aabb.max.0)?;
            }
            None => f.write_str(", without bounds")?,
        }
        match self.deviation {
            None => Ok(()),
            Some(deviation) => write!(f, ", {deviation}"),
        }
    }
}

impl fmt::Display for Deviation {
    /// ```
    /// use palpate_field::Deviation;
    ///
    /// let deviation = Deviation { value: 1e-5, within: 2e-3 };
    /// assert_eq!(
    ///     deviation.to_string(),
    ///     "values up to 2.00e-3 m in size off its source's by at most 1.00e-5 m",
    /// );
    /// ```
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.of_surface() {
            None => f.write_str("values off its source's by an unknown amount"),
            Some(value) if self.within.is_infinite() => {
                write!(f, "values off its source's by at most {value:.2e} m")
            }
            Some(value) => write!(
                f,
                "values up to {:.2e} m in size off its source's by at most {value:.2e} m",
                self.within
            ),
        }
    }
}

impl<const D: usize> Promise<D> {
    /// Whether the values are distances on both sides.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        let is_inside_exact = self.inside == Quality::Exact || !self.has_interior;
        self.outside == Quality::Exact && is_inside_exact
    }

    /// The qualities in a few words: "exact outside, bound inside".
    ///
    /// ```
    /// use palpate_field::Shape;
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let wheel = Shape::circle(0.5)? | Shape::rectangle([2.0, 0.5])?;
    /// assert_eq!(wheel.promise().in_words(), "exact outside, bound inside");
    /// assert_eq!(Shape::segment([0.0, 0.0], [1.0, 0.0], 0.0)?.promise().in_words(), "exact outside, no inside");
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn in_words(&self) -> String {
        let outside = self.outside.word();
        let inside = match self.has_interior {
            true => format!("{} inside", self.inside.word()),
            false => "no inside".to_owned(),
        };
        match self.deviation {
            None => format!("{outside} outside, {inside}"),
            Some(deviation) => format!("{outside} outside, {inside}, {deviation}"),
        }
    }

    /// The promise of a closed formula that is exact on both sides.
    ///
    /// `operations` counts the rounded operations of the formula on numbers up
    /// to `|p| + size`.
    #[must_use]
    pub fn exact(bounds: Option<Bounds<D>>, operations: f64, size: f64) -> Self {
        Self {
            outside: Quality::Exact,
            inside: Quality::Exact,
            lipschitz: 1.0,
            region: None,
            bounds,
            above_bounds: true,
            convex: false,
            symmetric: [false; D],
            has_interior: true,
            reach: 0.0,
            rounding: Rounding::of_operations(operations, size),
            deviation: None,
        }
    }

    /// The promise of a field of which only its steepness is known: its
    /// Lipschitz constant, rounded up.
    #[must_use]
    pub fn lipschitz(bounds: Option<Bounds<D>>, lipschitz: f64) -> Self {
        Self {
            outside: Quality::Lipschitz,
            inside: Quality::Lipschitz,
            lipschitz,
            above_bounds: false,
            ..Self::exact(bounds, 16.0, bounds.map_or(0.0, |b| b.radius_about_origin()))
        }
    }

    /// As [`exact`](Self::exact), for a convex shape.
    #[must_use]
    pub fn exact_convex(bounds: Option<Bounds<D>>, operations: f64, size: f64) -> Self {
        Self { convex: true, ..Self::exact(bounds, operations, size) }
    }

    /// The same shape, symmetric about every coordinate plane.
    #[must_use]
    pub fn symmetric(self) -> Self {
        Self { symmetric: [true; D], ..self }
    }

    /// A lower bound of the distance that says no more.
    #[must_use]
    pub fn bound(self) -> Self {
        Self { outside: self.outside.bounded(), inside: self.inside.bounded(), ..self }
    }

    /// The same promise with a Lipschitz constant that holds in `region` alone.
    #[must_use]
    pub const fn with_region(self, region: BoundingBall<D>) -> Self {
        Self { region: Some(region), ..self }
    }

    /// The same promise with another rounding.
    #[must_use]
    pub const fn with_rounding(self, rounding: Rounding) -> Self {
        Self { rounding, ..self }
    }

    /// The same promise of a field that stands in for another.
    #[must_use]
    pub const fn with_deviation(self, deviation: Deviation) -> Self {
        Self { deviation: Some(deviation), ..self }
    }

    /// The radius of a ball about `p` that is sure to hold no surface, where the
    /// value is `f` [m].
    ///
    /// Where only a Lipschitz constant is known, the ball ends with the region in
    /// which it holds. The rounding of `f` is not part of it: subtract
    /// [`rounding`](Self::rounding) where it matters.
    #[must_use]
    pub fn safe_radius(&self, p: Point<D>, f: f64) -> f64 {
        let quality = if f < 0.0 { self.inside } else { self.outside };
        match quality {
            Quality::Exact | Quality::Bound => f.abs(),
            Quality::Lipschitz => {
                let in_region = self
                    .region
                    .map_or(f64::INFINITY, |region| region.radius - (p - region.centre).norm());
                (f.abs() / self.lipschitz).min(in_region).max(0.0)
            }
        }
    }

    /// The promise after a rigid motion, which keeps everything but symmetry.
    #[must_use]
    #[inline(never)]
    pub fn placed(&self, pose: &Pose<D>) -> Self {
        let offset = pose.translation.norm();
        // Subtract, then D products and sums a coordinate.
        let motion =
            Rounding::of_operations(2.0 * D as f64 + 2.0, offset).times(self.lipschitz);
        Self {
            bounds: self.bounds.map(|b| b.placed(pose)),
            region: self
                .region
                .map(|ball| BoundingBall { centre: pose.transform_point(ball.centre), ..ball }),
            symmetric: [false; D],
            rounding: self.rounding.at(1.0, offset).plus(&motion),
            ..*self
        }
    }
}
