// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Operators that fold or stretch space: mirror, elongation, extrusion,
//! revolution.

#[cfg(feature = "oracle")]
use super::catalogue::{Child, Evidence};
use super::catalogue::{Declared, Operator};
use crate::bounds::{Aabb, BoundingBall, Bounds};
use crate::error::{ShapeError, Unit, not_negative, positive};
use crate::field::{SharedField, Warp, Warped};
use crate::kernel::{Argument, ParameterKind};
use crate::node::Node;
use crate::promise::{Promise, Rounding};
use crate::scalar::Scalar;
use crate::shape::Shape;
use crate::vector::{Vector, array, unrolled};

/// `f(|pₐ|, …)` along axis a.
#[derive(Debug)]
pub(crate) struct Mirror {
    axis: usize,
}

impl<const D: usize> Warp<D, D> for Mirror {
    #[inline(always)]
    fn point<S: Scalar>(&self, p: Vector<S, D>) -> Vector<S, D> {
        Vector(array!(i < D => if i == self.axis { p.0[i].abs() } else { p.0[i] }))
    }
}

/// `f(p − clamp(p, −h, h))`.
#[derive(Debug)]
pub(crate) struct Elongation<const D: usize> {
    half: [f64; D],
    /// Axes about which the child is its own mirror image.
    symmetric: [bool; D],
}

impl<const D: usize> Warp<D, D> for Elongation<D> {
    #[inline(always)]
    fn point<S: Scalar>(&self, p: Vector<S, D>) -> Vector<S, D> {
        let zero = S::constant(0.0);
        let mut q = p;
        unrolled!(i < D => {
            let half = S::constant(self.half[i]);
            if self.half[i] <= 0.0 {
                // Nothing is pulled apart: the sum below would have twice the slope
                // at zero.
            } else if self.symmetric[i] {
                // The same for a symmetric child, and convex, which keeps models
                // of convex children tight.
                q.0[i] = (p.0[i].abs() - half).max(zero);
            } else {
                // One of the two is always zero.
                q.0[i] = (p.0[i] - half).max(zero) + (p.0[i] + half).min(zero);
            }
        });
        q
    }
}

/// The orthant distance of the profile in (x, z) and of |y| − h/2.
#[derive(Debug)]
pub(crate) struct Extrusion {
    half_height: f64,
}

impl Warp<3, 2> for Extrusion {
    #[inline(always)]
    fn point<S: Scalar>(&self, p: Vector<S, 3>) -> Vector<S, 2> {
        Vector([p.0[0], p.0[2]])
    }

    #[inline(always)]
    fn value<S: Scalar>(&self, p: Vector<S, 3>, child: S) -> S {
        S::orthant([child, p.0[1].abs() - S::constant(self.half_height)])
    }
}

/// The profile in (√(x² + z²), y).
#[derive(Debug)]
pub(crate) struct Revolution;

impl Warp<3, 2> for Revolution {
    #[inline(always)]
    fn point<S: Scalar>(&self, p: Vector<S, 3>) -> Vector<S, 2> {
        Vector([S::norm([p.0[0], p.0[2]]), p.0[1]])
    }
}

fn mirrored_bounds<const D: usize>(bounds: &Bounds<D>, axis: usize) -> Bounds<D> {
    let mut aabb = bounds.aabb;
    let reach = aabb.max[axis].max(0.0);
    (aabb.min[axis], aabb.max[axis]) = (-reach, reach);
    let mut image = bounds.ball;
    image.centre[axis] = -image.centre[axis];
    let ball = bounds.ball.union(&image);
    let around = Bounds::of_box(aabb).ball;
    Bounds { aabb, ball: if around.radius < ball.radius { around } else { ball } }
}

/// The part of `child` at positive coordinates of `axis`, and its mirror image.
pub(crate) fn mirrored<const D: usize>(
    child: SharedField<D>,
    axis: usize,
) -> Result<SharedField<D>, ShapeError> {
    if axis >= D {
        let rule = format!("the number of an axis, less than {D}");
        return Err(ShapeError::number("axis", rule, axis as f64, Unit::One));
    }
    let of = child.promise();
    let one_side = of.bounds.is_some_and(|b| b.aabb.min[axis] >= 0.0);
    // Halves that touch have a wall between them that is no surface.
    let apart = of.bounds.is_some_and(|b| b.aabb.min[axis] > 0.0);
    let promise = Promise {
        bounds: of.bounds.map(|b| mirrored_bounds(&b, axis)),
        above_bounds: of.above_bounds && one_side,
        convex: false,
        symmetric: std::array::from_fn(|i| i == axis || of.symmetric[i]),
        region: of.region.map(|ball| BoundingBall {
            // What lies on the positive side only.
            radius: (ball.radius - ball.centre[axis].abs()).max(0.0),
            centre: Vector(array!(i < D => {
                if i == axis { 0.0 } else { ball.centre[i] }
            })),
        }),
        outside: if one_side { of.outside } else { of.outside.bounded() },
        inside: if apart { of.inside } else { of.inside.bounded() },
        ..*of
    };
    Warped::shared(Mirror { axis }, child, promise)
}

/// Pulls a shape apart.
pub(crate) struct Elongate;

impl Declared for Elongate {
    const OPERATOR: Operator = Operator {
        name: "elongate",
        method: "elongated",
        about: "Pulls the shape apart at the coordinate planes [m].",
        kind: ParameterKind::LengthOrZero,
        is_per_axis: true,
        first: [0.05, 0.0, 0.0],
    };

    fn field<const D: usize>(
        child: SharedField<D>,
        argument: &Argument,
    ) -> Result<SharedField<D>, ShapeError> {
        let Argument::Vector(lengths) = argument else { return Self::OPERATOR.unsuitable() };
        match lengths[..].try_into() {
            Ok(lengths) => elongated(child, lengths),
            Err(_) => Self::OPERATOR.unsuitable(),
        }
    }
}

impl<const D: usize> Shape<D> {
    /// The shape cut at the coordinate planes and pulled apart by `lengths` [m],
    /// the gap filled with the cross-section: `f(p − clamp(p, −l/2, l/2))`.
    ///
    /// Outside, exact where the shape is if it is convex and symmetric about
    /// each cut, else a bound; inside, a bound, since the ends are not as near
    /// in the elongated shape as they were.
    ///
    /// # Errors
    ///
    /// If a length is negative, or shapes are nested too deeply.
    pub fn elongated(self, lengths: impl Into<Vector<f64, D>>) -> Result<Self, ShapeError> {
        let lengths = Argument::Vector(lengths.into().0.to_vec());
        Self::from_node(Node::operated::<Elongate>(lengths, self))
    }
}

#[cfg(feature = "oracle")]
impl Evidence for Elongate {
    fn definition<S: Scalar, const D: usize>(
        child: &Child<'_, S, D>,
        argument: &Argument,
        p: Vector<S, D>,
    ) -> S {
        let Argument::Vector(lengths) = argument else {
            unreachable!("a number for each axis")
        };
        (child.value)(Vector(std::array::from_fn(|i| {
            p.0[i] - p.0[i].clamp(-0.5 * lengths[i], 0.5 * lengths[i])
        })))
    }
}

/// The `child` cut at the coordinate planes and pulled apart by `lengths`.
fn elongated<const D: usize>(
    child: SharedField<D>,
    lengths: [f64; D],
) -> Result<SharedField<D>, ShapeError> {
    for length in lengths {
        not_negative("elongate", length, Unit::Metre)?;
    }
    let half = lengths.map(|l| 0.5 * l);
    let of = child.promise();
    let kept = of.convex && (0..D).all(|i| half[i] == 0.0 || of.symmetric[i]);
    let reach = Vector(half).norm();
    let own = Rounding::of_operations(2.0 * of.lipschitz.max(1.0), reach);
    let promise = Promise {
        outside: if kept { of.outside } else { of.outside.bounded() },
        inside: of.inside.bounded(),
        bounds: of.bounds.map(|b| Bounds {
            aabb: Aabb { min: b.aabb.min - Vector(half), max: b.aabb.max + Vector(half) },
            ball: BoundingBall { radius: b.ball.radius + reach, ..b.ball },
        }),
        above_bounds: of.above_bounds && kept,
        convex: kept,
        // Points move by at most `reach`, and as far from each other at most.
        region: of
            .region
            .map(|ball| BoundingBall { radius: (ball.radius - reach).max(0.0), ..ball }),
        rounding: of.rounding.plus(&own),
        ..*of
    };
    let map = Elongation { half, symmetric: of.symmetric };
    Warped::shared(map, child, promise)
}

/// The `child`, drawn in x and z, as a solid of `height` along y.
pub(crate) fn extruded(
    child: SharedField<2>,
    height: f64,
) -> Result<SharedField<3>, ShapeError> {
    let half_height = 0.5 * positive("height", height, Unit::Metre)?;
    let of = child.promise();
    let solid = |p: Vector<f64, 2>, y: f64| Vector([p[0], y, p[1]]);
    let bounds = of.bounds.map(|b| Bounds {
        aabb: Aabb {
            min: solid(b.aabb.min, -half_height),
            max: solid(b.aabb.max, half_height),
        },
        ball: BoundingBall {
            centre: solid(b.ball.centre, 0.0),
            radius: b.ball.radius.hypot(half_height) * (1.0 + 4.0 * f64::EPSILON),
        },
    });
    let own = Rounding::of_operations(5.0 * of.lipschitz.max(1.0), half_height);
    let promise = Promise {
        outside: of.outside,
        inside: of.inside,
        lipschitz: of.lipschitz.max(1.0),
        region: of
            .region
            .map(|ball| BoundingBall { centre: solid(ball.centre, 0.0), radius: ball.radius }),
        bounds,
        above_bounds: of.above_bounds,
        convex: of.convex,
        symmetric: [of.symmetric[0], true, of.symmetric[1]],
        has_interior: of.has_interior,
        reach: of.reach,
        deviation: of.deviation,
        rounding: of.rounding.times(2.0).plus(&own),
    };
    Warped::shared(Extrusion { half_height }, child, promise)
}

/// The `child` turned about the y axis.
pub(crate) fn revolved(child: SharedField<2>) -> Result<SharedField<3>, ShapeError> {
    let of = child.promise();
    let one_side = of.bounds.is_some_and(|b| b.aabb.min[0] >= 0.0);
    // A profile that is its own mirror image turns into itself.
    let kept = one_side || of.symmetric[0];
    // One that touches the axis leaves a line there that is no surface.
    let apart = of.bounds.is_some_and(|b| b.aabb.min[0] > 0.0);
    let solid = apart || of.symmetric[0];
    let bounds = of.bounds.map(|b| {
        let r = b.aabb.max[0].max(0.0);
        let aabb =
            Aabb { min: Vector([-r, b.aabb.min[1], -r]), max: Vector([r, b.aabb.max[1], r]) };
        let y = b.ball.centre[1];
        let radius = b.ball.centre[0].abs() + b.ball.radius;
        let ball = BoundingBall { centre: Vector([0.0, y, 0.0]), radius };
        let around = Bounds::of_box(aabb).ball;
        Bounds { aabb, ball: if around.radius < radius { around } else { ball } }
    });
    let own = Rounding::of_operations(3.0 * of.lipschitz.max(1.0), 0.0);
    let promise = Promise {
        outside: if kept { of.outside } else { of.outside.bounded() },
        inside: if solid { of.inside } else { of.inside.bounded() },
        lipschitz: of.lipschitz,
        region: of.region.map(|ball| BoundingBall {
            centre: Vector([0.0, ball.centre[1], 0.0]),
            radius: (ball.radius - ball.centre[0].abs()).max(0.0),
        }),
        bounds,
        above_bounds: of.above_bounds && kept,
        convex: of.convex && of.symmetric[0],
        symmetric: [true, of.symmetric[1], true],
        has_interior: of.has_interior,
        reach: of.reach,
        deviation: of.deviation,
        rounding: of.rounding.plus(&own),
    };
    Warped::shared(Revolution, child, promise)
}
