// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Operators that move a surface.

#[cfg(feature = "oracle")]
use super::catalogue::{Child, Evidence};
use super::catalogue::{Declared, Operator};
use crate::bounds::{Aabb, Bounds};
use crate::error::{ShapeError, Unit, finite, positive};
use crate::field::{Remap, Remapped, SharedField};
use crate::kernel::{Argument, ParameterKind};
use crate::node::Node;
use crate::promise::{Promise, Quality, Rounding};
use crate::scalar::Scalar;
use crate::shape::Shape;
use crate::vector::Vector;

/// `f − r`.
#[derive(Debug)]
pub(crate) struct Offset {
    distance: f64,
}

impl<const D: usize> Remap<D> for Offset {
    #[inline(always)]
    fn value<S: Scalar>(&self, _p: Vector<S, D>, child: S) -> S {
        child - S::constant(self.distance)
    }
}

/// `|f| − t/2`.
#[derive(Debug)]
pub(crate) struct Shell {
    half_thickness: f64,
}

impl<const D: usize> Remap<D> for Shell {
    #[inline(always)]
    fn value<S: Scalar>(&self, _p: Vector<S, D>, child: S) -> S {
        child.abs() - S::constant(self.half_thickness)
    }
}

fn rounding<const D: usize>(child: &Promise<D>, moved: f64) -> Rounding {
    // One subtraction: half an ulp of a value that is at most the distance from
    // the farthest point of the shape, plus the move.
    let size = child.bounds.map_or(0.0, |b| b.radius_about_origin()) + moved;
    child.rounding.plus(&Rounding::of_operations(1.0, size))
}

/// `child − distance`.
pub(crate) fn offset<const D: usize>(
    child: SharedField<D>,
    distance: f64,
) -> Result<SharedField<D>, ShapeError> {
    let distance = finite("offset", distance, Unit::Metre)?;
    if let Some(bounds) = child.promise().bounds {
        let half = bounds.aabb.half_extents();
        let thinnest = half.0.iter().fold(f64::INFINITY, |m, h| m.min(*h));
        if -distance >= thinnest {
            let rule = format!("more than minus the half width of the shape, {thinnest} m");
            return Err(ShapeError::number("offset", rule, distance, Unit::Metre));
        }
    }
    let child = if distance > 0.0 { guarded(child)? } else { child };
    let promise = child.promise();
    let grows = distance > 0.0;
    let kept = |quality: Quality, keep: bool| if keep { quality } else { quality.bounded() };
    let promise = Promise {
        outside: kept(promise.outside, grows),
        // Growing a convex shape moves each inner point's nearest point
        // straight outwards, if both sides are exact.
        inside: kept(
            promise.inside.and(if grows { promise.outside } else { Quality::Exact }),
            !grows || promise.convex,
        ),
        bounds: promise.bounds.map(|b| if grows { b.grown(distance) } else { b }),
        has_interior: promise.has_interior || grows,
        rounding: rounding(promise, distance.abs()),
        deviation: promise.deviation.map(|deviation| deviation.moved(distance.abs())),
        ..*promise
    };
    Remapped::shared(Offset { distance }, child, promise)
}

impl Declared for Shell {
    const OPERATOR: Operator = Operator {
        name: "shell",
        method: "shell",
        about: "Makes a wall of this thickness on the surface of the shape [m].",
        kind: ParameterKind::Length,
        is_per_axis: false,
        first: [0.01; 3],
    };

    fn field<const D: usize>(
        child: SharedField<D>,
        argument: &Argument,
    ) -> Result<SharedField<D>, ShapeError> {
        match argument {
            Argument::Number(thickness) => shell(child, *thickness),
            _ => Self::OPERATOR.unsuitable(),
        }
    }
}

impl<const D: usize> Shape<D> {
    /// A shell of `thickness` [m], half of it on either side of the surface:
    /// `|f| − t/2`.
    ///
    /// Outside, and in the cavity, exact if the shape is convex and exact on
    /// both sides; in the wall a bound, since the nearest point of the inner
    /// face of a corner is not straight inwards.
    ///
    /// # Errors
    ///
    /// If the thickness is not positive.
    pub fn shell(self, thickness: f64) -> Result<Self, ShapeError> {
        Self::from_node(Node::operated::<Shell>(Argument::Number(thickness), self))
    }
}

#[cfg(feature = "oracle")]
impl Evidence for Shell {
    fn definition<S: Scalar, const D: usize>(
        child: &Child<'_, S, D>,
        argument: &Argument,
        p: Vector<S, D>,
    ) -> S {
        let Argument::Number(thickness) = argument else {
            unreachable!("a shell has a number")
        };
        (child.guarded)(p).abs() - S::constant(0.5 * thickness)
    }
}

/// `|child| − thickness/2`.
fn shell<const D: usize>(
    child: SharedField<D>,
    thickness: f64,
) -> Result<SharedField<D>, ShapeError> {
    let half_thickness = 0.5 * positive("thickness", thickness, Unit::Metre)?;
    let child = guarded(child)?;
    let promise = child.promise();
    let quality = promise.outside.and(promise.inside);
    let promise = Promise {
        outside: if promise.convex { quality } else { quality.bounded() },
        inside: quality.bounded(),
        bounds: promise.bounds.map(|b| b.grown(half_thickness)),
        convex: false,
        has_interior: true,
        rounding: rounding(promise, half_thickness),
        deviation: promise.deviation.map(|deviation| deviation.moved(half_thickness)),
        ..*promise
    };
    Remapped::shared(Shell { half_thickness }, child, promise)
}

/// `max(f, distance to the box)`.
#[derive(Debug)]
pub(crate) struct Guard<const D: usize> {
    centre: Vector<f64, D>,
    half_extents: Vector<f64, D>,
}

impl<const D: usize> Guard<D> {
    fn new(aabb: &Aabb<D>) -> Self {
        Self { centre: aabb.centre(), half_extents: aabb.half_extents() }
    }
}

impl<const D: usize> Remap<D> for Guard<D> {
    #[inline(always)]
    fn value<S: Scalar>(&self, p: Vector<S, D>, child: S) -> S {
        let q = (p - Vector::of(&self.centre.0)).abs() - Vector::of(&self.half_extents.0);
        child.max(S::orthant(q.0))
    }
}

/// The same field with values of at least the distance to its box.
///
/// A field that is only a bound may be small far from its shape; an operator
/// that moves the surface outwards would find a surface there. Inside the
/// box nothing changes: the distance to it is negative there, and deeper than
/// the shape's own, which lies in it.
pub(crate) fn guarded<const D: usize>(
    child: SharedField<D>,
) -> Result<SharedField<D>, ShapeError> {
    let promise = child.promise();
    let (Some(bounds), false) = (promise.bounds, promise.above_bounds) else {
        return Ok(child);
    };
    let size = bounds.radius_about_origin();
    let promise = Promise {
        // The ball may be tighter than the box; the guard knows the box alone.
        bounds: Some(Bounds::of_box(bounds.aabb)),
        above_bounds: true,
        rounding: promise.rounding.or(&Rounding::of_operations(8.0, size)),
        ..*promise
    };
    Remapped::shared(Guard::new(&bounds.aabb), child, promise)
}
