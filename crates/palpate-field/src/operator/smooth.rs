// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Smooth booleans: the creases between shapes filled or cut off.

use std::fmt::Debug;
use std::marker::PhantomData;

use super::boolean::{
    combined, promise_of_difference, promise_of_intersection, promise_of_union,
};
use crate::error::{ShapeError, Unit, positive};
use crate::field::Combine;
use crate::promise::{Promise, Quality, Rounding};
use crate::scalar::{Blend, Circular, Cubic, Exponential, Quadratic, Quartic, Root, Scalar};
use crate::shape::Shape;

/// Which profile fills the crease of a smooth boolean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Smooth {
    /// [`Quadratic`]: reach 4 times the width.
    Quadratic,
    /// [`Cubic`]: reach 6 times the width, rounder at the ends of the fill.
    Cubic,
    /// [`Quartic`]: reach 16/3 times the width, round at the ends and in the middle.
    Quartic,
    /// [`Circular`]: reach 3.41 times the width, a quarter circle.
    Circular,
    /// [`Root`]: a hyperbola, without end.
    Root,
    /// [`Exponential`]: without end; the order of the shapes makes no difference.
    Exponential,
    /// A circle that touches both shapes where they meet at right angles; reach 3.41
    /// times the width.
    ///
    /// Unlike the others it depends on more than the difference of the fields: its
    /// Lipschitz constant is √2 times theirs, and its distances are no bounds until
    /// divided by it.
    CircularGeometrical,
}

/// A smooth minimum.
#[derive(Clone, Debug)]
pub(crate) struct SmoothMin<B> {
    unit: f64,
    profile: PhantomData<B>,
}

impl<B: Blend + Debug> Combine for SmoothMin<B> {
    #[inline(always)]
    fn combine<S: Scalar>(&self, a: S, b: S) -> S {
        a.smooth_min::<B>(b, self.unit)
    }
}

/// A smooth maximum of `a` and `b`, or of `a` and `−b`.
#[derive(Clone, Debug)]
pub(crate) struct SmoothMax<B> {
    unit: f64,
    without: bool,
    profile: PhantomData<B>,
}

impl<B: Blend + Debug> Combine for SmoothMax<B> {
    #[inline(always)]
    fn combine<S: Scalar>(&self, a: S, b: S) -> S {
        a.smooth_max::<B>(if self.without { -b } else { b }, self.unit)
    }
}

/// `max(r, min(a, b)) − ‖max(r − (a, b), 0)‖`: the union of two half-planes at right
/// angles with a fillet of radius `r`.
#[derive(Clone, Debug)]
pub(crate) struct Fillet {
    radius: f64,
}

impl Combine for Fillet {
    #[inline(always)]
    fn combine<S: Scalar>(&self, a: S, b: S) -> S {
        let (zero, radius) = (S::constant(0.0), S::constant(self.radius));
        let within = S::norm([(radius - a).max(zero), (radius - b).max(zero)]);
        radius.max(a.min(b)) - within
    }
}

/// The same turned inside out: an intersection, or a difference, with its edge
/// rounded.
#[derive(Clone, Debug)]
pub(crate) struct Round {
    fillet: Fillet,
    without: bool,
}

impl Combine for Round {
    #[inline(always)]
    fn combine<S: Scalar>(&self, a: S, b: S) -> S {
        -self.fillet.combine(-a, if self.without { b } else { -b })
    }
}

/// What blending adds to the promise of a sharp boolean: a bound on both sides, as any
/// field with Lipschitz constant 1 is one, with the roundings of the fill.
fn blended<const D: usize>(sharp: Promise<D>, reach: f64, unit: f64) -> Promise<D> {
    let fill = Rounding::of_operations(16.0, unit);
    Promise {
        convex: false,
        reach: sharp.reach.max(reach),
        rounding: sharp.rounding.plus(&fill),
        ..sharp.bound()
    }
}

/// What the geometrical circle adds: it is √2 times as steep.
fn steeper<const D: usize>(promise: Promise<D>) -> Promise<D> {
    Promise {
        outside: Quality::Lipschitz,
        inside: Quality::Lipschitz,
        // Rounded up.
        lipschitz: promise.lipschitz * 1.414_213_562_373_096,
        rounding: promise.rounding.times(2.0),
        ..promise
    }
}

/// The smooth booleans.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Union,
    Intersection,
    Difference,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Union => "smooth_union",
            Self::Intersection => "smooth_intersection",
            Self::Difference => "smooth_difference",
        }
    }

    /// The promise of the sharp boolean; the surface of a smooth union moves outwards
    /// by at most the width.
    fn promise<const D: usize>(self, a: &Promise<D>, b: &Promise<D>, width: f64) -> Promise<D> {
        match self {
            Self::Union => {
                let union = promise_of_union(a, b);
                let bounds = union.bounds.map(|bounds| bounds.grown(width));
                Promise { bounds, ..union }
            }
            Self::Intersection => promise_of_intersection(a, b),
            Self::Difference => promise_of_difference(a, b),
        }
    }

    fn apply<const D: usize>(
        self,
        shapes: Vec<Shape<D>>,
        profile: Smooth,
        width: f64,
    ) -> Result<Shape<D>, ShapeError> {
        match profile {
            Smooth::Quadratic => self.filled::<Quadratic, D>(shapes, width),
            Smooth::Cubic => self.filled::<Cubic, D>(shapes, width),
            Smooth::Quartic => self.filled::<Quartic, D>(shapes, width),
            Smooth::Circular => self.filled::<Circular, D>(shapes, width),
            Smooth::Root => self.filled::<Root, D>(shapes, width),
            Smooth::Exponential => self.filled::<Exponential, D>(shapes, width),
            Smooth::CircularGeometrical => self.rounded(shapes, width),
        }
    }

    fn filled<B: Blend + Debug, const D: usize>(
        self,
        shapes: Vec<Shape<D>>,
        width: f64,
    ) -> Result<Shape<D>, ShapeError> {
        let width = positive("width", width, Unit::Metre)?;
        let unit = width * B::UNIT_OVER_WIDTH;
        let rule = |a: &Promise<D>, b: &Promise<D>| {
            blended(self.promise(a, b, width), B::REACH * unit, unit)
        };
        let profile = PhantomData::<B>;
        match self {
            Self::Union => {
                let shapes = guarded(shapes)?;
                combined(SmoothMin { unit, profile }, self.name(), shapes, rule)
            }
            Self::Intersection | Self::Difference => {
                let without = matches!(self, Self::Difference);
                let operation = SmoothMax { unit, without, profile };
                combined(operation, self.name(), shapes, rule)
            }
        }
    }

    fn rounded<const D: usize>(
        self,
        shapes: Vec<Shape<D>>,
        width: f64,
    ) -> Result<Shape<D>, ShapeError> {
        let width = positive("width", width, Unit::Metre)?;
        let radius = width * Circular::UNIT_OVER_WIDTH;
        let fillet = Fillet { radius };
        let rule = |a: &Promise<D>, b: &Promise<D>| {
            steeper(blended(self.promise(a, b, width), radius, radius))
        };
        match self {
            Self::Union => combined(fillet, self.name(), guarded(shapes)?, rule),
            Self::Intersection | Self::Difference => {
                let without = matches!(self, Self::Difference);
                combined(Round { fillet, without }, self.name(), shapes, rule)
            }
        }
    }
}

/// Shapes whose values are nowhere below the distance to their box.
fn guarded<const D: usize>(shapes: Vec<Shape<D>>) -> Result<Vec<Shape<D>>, ShapeError> {
    shapes.into_iter().map(Shape::guarded).collect()
}

impl<const D: usize> Shape<D> {
    /// The union of `shapes` with the creases between them filled.
    ///
    /// `width` is the fill where two distances are equal [m]: the surface moves
    /// outwards by at most that. The fill begins where two distances differ by
    /// less than the reach of the profile, a multiple of the width. More than two
    /// shapes are folded in their order.
    ///
    /// A bound on both sides, with Lipschitz constant 1 for exact shapes and bounds;
    /// [`Smooth::CircularGeometrical`] has √2 instead, and is no bound. Shapes whose
    /// values may fall below the distance to their box are guarded by it first, so
    /// that the bounds hold.
    ///
    /// ```
    /// use palpate_field::{Shape, Vector, kernel::HalfSpace, operator::Smooth};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0]), 0.0)?);
    /// let wall = Shape::from_kernel(HalfSpace::new(Vector([1.0, 0.0]), 0.0)?);
    /// let corner = Shape::smooth_union([floor, wall], Smooth::Cubic, 0.01)?;
    /// assert!((corner.distance(Vector([0.0, 0.0])) + 0.01).abs() < 1e-17);
    /// assert_eq!(corner.distance(Vector([0.06, 0.0])), 0.0); // past the reach of 0.06 m
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If the width is not positive, there are no shapes, or they are nested too
    /// deeply.
    pub fn smooth_union(
        shapes: impl IntoIterator<Item = Self>,
        profile: Smooth,
        width: f64,
    ) -> Result<Self, ShapeError> {
        Kind::Union.apply(shapes.into_iter().collect(), profile, width)
    }

    /// The intersection of `shapes` with the edges between them cut off: the surface
    /// moves inwards by at most `width` [m], where two distances are equal.
    ///
    /// Promises as of [`smooth_union`](Self::smooth_union).
    ///
    /// # Errors
    ///
    /// As [`smooth_union`](Self::smooth_union).
    pub fn smooth_intersection(
        shapes: impl IntoIterator<Item = Self>,
        profile: Smooth,
        width: f64,
    ) -> Result<Self, ShapeError> {
        Kind::Intersection.apply(shapes.into_iter().collect(), profile, width)
    }

    /// This shape without `others`, the edges of the cuts rounded off: the surface
    /// moves inwards by at most `width` [m] for each of the others.
    ///
    /// Promises as of [`smooth_union`](Self::smooth_union).
    ///
    /// # Errors
    ///
    /// If the width is not positive, or shapes are nested too deeply.
    pub fn smooth_difference(
        self,
        others: impl IntoIterator<Item = Self>,
        profile: Smooth,
        width: f64,
    ) -> Result<Self, ShapeError> {
        let shapes = std::iter::once(self).chain(others).collect();
        Kind::Difference.apply(shapes, profile, width)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::HalfSpace;
    use crate::vector::Vector;

    #[test]
    fn every_profile_moves_a_right_angle_by_its_width() -> Result<(), ShapeError> {
        let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0]), 0.0)?);
        let wall = Shape::from_kernel(HalfSpace::new(Vector([1.0, 0.0]), 0.0)?);
        for profile in [
            Smooth::Quadratic,
            Smooth::Cubic,
            Smooth::Quartic,
            Smooth::Circular,
            Smooth::Root,
            Smooth::Exponential,
            Smooth::CircularGeometrical,
        ] {
            let pair = || [floor.clone(), wall.clone()];
            let passes = |shape: Shape<2>, p: [f64; 2]| {
                let distance = shape.distance(Vector(p));
                assert!(distance.abs() < 1e-16, "{profile:?}: {distance} at {p:?}");
            };
            // Where both distances are the width.
            passes(Shape::smooth_union(pair(), profile, 0.01)?, [0.01, 0.01]);
            passes(Shape::smooth_intersection(pair(), profile, 0.01)?, [-0.01, -0.01]);
            let difference = floor.clone().smooth_difference([wall.clone()], profile, 0.01)?;
            passes(difference, [0.01, -0.01]);
        }
        Ok(())
    }

    #[test]
    fn the_geometrical_circle_is_a_fillet() -> Result<(), ShapeError> {
        let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0]), 0.0)?);
        let wall = Shape::from_kernel(HalfSpace::new(Vector([1.0, 0.0]), 0.0)?);
        let radius = 0.1;
        let width = radius * (1.0 - std::f64::consts::FRAC_1_SQRT_2);
        let corner = Shape::smooth_union([floor, wall], Smooth::CircularGeometrical, width)?;
        for angle in [0.1, 0.7, 1.5_f64] {
            // On the circle about (r, r), seen from the corner.
            let p = Vector([radius * (1.0 - angle.cos()), radius * (1.0 - angle.sin())]);
            assert!(corner.distance(p).abs() < 1e-16);
        }
        Ok(())
    }
}
