// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Operators that move the surface: offset and shell.

use crate::error::{ShapeError, Unit, finite, positive};
use crate::field::{Remap, Remapped};
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

impl<const D: usize> Shape<D> {
    /// The shape grown by `distance` [m], or shrunk by it if negative: `f − r`.
    ///
    /// Growing keeps an exact outside, and an exact inside of convex shapes;
    /// shrinking keeps an exact inside. All else is a bound.
    ///
    /// # Errors
    ///
    /// If the distance is not finite, or shrinking leaves nothing of the shape's
    /// box.
    pub fn offset(self, distance: f64) -> Result<Self, ShapeError> {
        let distance = finite("offset", distance, Unit::Metre)?;
        if let Some(bounds) = self.promise().bounds {
            let half = bounds.aabb.half_extents();
            let thinnest = half.0.iter().fold(f64::INFINITY, |m, h| m.min(*h));
            if -distance >= thinnest {
                let rule = format!("more than minus the half width of the shape, {thinnest} m");
                return Err(ShapeError::number("offset", rule, distance, Unit::Metre));
            }
        }
        let child = if distance > 0.0 { self.guarded()? } else { self };
        let promise = child.promise();
        let grows = distance > 0.0;
        let kept =
            |quality: Quality, keep: bool| if keep { quality } else { quality.bounded() };
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
            ..*promise
        };
        let depth = child.depth() + 1;
        let node = Remapped { map: Offset { distance }, child, promise };
        Self::from_operator(node, depth)
    }

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
        let half_thickness = 0.5 * positive("thickness", thickness, Unit::Metre)?;
        let child = self.guarded()?;
        let promise = child.promise();
        let quality = promise.outside.and(promise.inside);
        let promise = Promise {
            outside: if promise.convex { quality } else { quality.bounded() },
            inside: quality.bounded(),
            bounds: promise.bounds.map(|b| b.grown(half_thickness)),
            convex: false,
            has_interior: true,
            rounding: rounding(promise, half_thickness),
            ..*promise
        };
        let depth = child.depth() + 1;
        let node = Remapped { map: Shell { half_thickness }, child, promise };
        Self::from_operator(node, depth)
    }
}
