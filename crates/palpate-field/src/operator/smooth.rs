// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Smooth booleans: the creases between shapes filled or cut off.

use std::fmt::Debug;
use std::marker::PhantomData;

use super::boolean::{
    combined, promise_of_difference, promise_of_intersection, promise_of_union,
};
use super::surface;
use crate::error::{ShapeError, Unit, positive};
use crate::field::{Combine, SharedField};
use crate::promise::{Deviation, Promise, Quality, Rounding};
use crate::scalar::{Blend, Circular, Cubic, Exponential, Quadratic, Quartic, Root, Scalar};

/// The profile that fills the crease of a smooth boolean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Profile {
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

impl Profile {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Quadratic,
        Self::Cubic,
        Self::Quartic,
        Self::Circular,
        Self::Root,
        Self::Exponential,
        Self::CircularGeometrical,
    ];

    /// The name in scene files.
    ///
    /// ```
    /// use palpate_field::operator::Profile;
    ///
    /// assert_eq!(Profile::CircularGeometrical.name(), "circular_geometrical");
    /// assert_eq!(Profile::named("root"), Some(Profile::Root));
    /// ```
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Quadratic => "quadratic",
            Self::Cubic => "cubic",
            Self::Quartic => "quartic",
            Self::Circular => "circular",
            Self::Root => "root",
            Self::Exponential => "exponential",
            Self::CircularGeometrical => "circular_geometrical",
        }
    }

    /// The profile of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|profile| profile.name() == name)
    }
}

/// Which boolean is smooth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Boolean {
    /// What is in any shape.
    Union,
    /// What is in all shapes.
    Intersection,
    /// The first shape without the others.
    Difference,
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

/// The promise of a smooth boolean from that of the sharp one. Any field with Lipschitz
/// constant 1 is a bound on both sides; the fill adds its rounding.
fn blended<const D: usize>(sharp: Promise<D>, reach: f64, unit: f64) -> Promise<D> {
    let fill = Rounding::of_operations(16.0, unit);
    Promise {
        convex: false,
        reach: sharp.reach.max(reach),
        // Values change by what lies within reach, or is blended in.
        deviation: sharp.deviation.map(|deviation| deviation.moved(reach)),
        rounding: sharp.rounding.plus(&fill),
        ..sharp.bound()
    }
}

/// The promise with the geometrical circle, which is √2 times as steep.
fn steeper<const D: usize>(promise: Promise<D>) -> Promise<D> {
    Promise {
        outside: Quality::Lipschitz,
        inside: Quality::Lipschitz,
        // Rounded up.
        lipschitz: promise.lipschitz * 1.414_213_562_373_096,
        rounding: promise.rounding.times(2.0),
        deviation: promise.deviation.map(|deviation| Deviation {
            value: deviation.value * 1.414_213_562_373_096,
            ..deviation
        }),
        ..promise
    }
}

impl Boolean {
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
                // Where both surfaces are near, their union is filled.
                Promise { bounds, has_interior: true, ..union }
            }
            Self::Intersection => promise_of_intersection(a, b),
            Self::Difference => promise_of_difference(a, b),
        }
    }

    fn apply<const D: usize>(
        self,
        children: Vec<SharedField<D>>,
        profile: Profile,
        width: f64,
    ) -> Result<SharedField<D>, ShapeError> {
        match profile {
            Profile::Quadratic => self.filled::<Quadratic, D>(children, width),
            Profile::Cubic => self.filled::<Cubic, D>(children, width),
            Profile::Quartic => self.filled::<Quartic, D>(children, width),
            Profile::Circular => self.filled::<Circular, D>(children, width),
            Profile::Root => self.filled::<Root, D>(children, width),
            Profile::Exponential => self.filled::<Exponential, D>(children, width),
            Profile::CircularGeometrical => self.rounded(children, width),
        }
    }

    fn filled<B: Blend + Debug, const D: usize>(
        self,
        children: Vec<SharedField<D>>,
        width: f64,
    ) -> Result<SharedField<D>, ShapeError> {
        let unit = width * B::UNIT_OVER_WIDTH;
        let rule = |a: &Promise<D>, b: &Promise<D>| {
            blended(self.promise(a, b, width), B::REACH * unit, unit)
        };
        let profile = PhantomData::<B>;
        match self {
            Self::Union => {
                let children = guarded(children)?;
                combined(SmoothMin { unit, profile }, self.name(), children, rule)
            }
            Self::Intersection | Self::Difference => {
                let without = matches!(self, Self::Difference);
                let operation = SmoothMax { unit, without, profile };
                combined(operation, self.name(), children, rule)
            }
        }
    }

    fn rounded<const D: usize>(
        self,
        children: Vec<SharedField<D>>,
        width: f64,
    ) -> Result<SharedField<D>, ShapeError> {
        let radius = width * Circular::UNIT_OVER_WIDTH;
        let fillet = Fillet { radius };
        let rule = |a: &Promise<D>, b: &Promise<D>| {
            steeper(blended(self.promise(a, b, width), radius, radius))
        };
        match self {
            Self::Union => combined(fillet, self.name(), guarded(children)?, rule),
            Self::Intersection | Self::Difference => {
                let without = matches!(self, Self::Difference);
                combined(Round { fillet, without }, self.name(), children, rule)
            }
        }
    }
}

/// Each child, guarded.
fn guarded<const D: usize>(
    children: Vec<SharedField<D>>,
) -> Result<Vec<SharedField<D>>, ShapeError> {
    children.into_iter().map(surface::guarded).collect()
}

/// The `boolean` of `children` with its creases of `width` filled or cut off.
pub(crate) fn smooth<const D: usize>(
    boolean: Boolean,
    profile: Profile,
    width: f64,
    children: Vec<SharedField<D>>,
) -> Result<SharedField<D>, ShapeError> {
    let width = positive("width", width, Unit::Metre)?;
    boolean.apply(children, profile, width)
}
