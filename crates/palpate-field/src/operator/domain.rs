// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Operators that fold or stretch space: mirror, elongation, extrusion,
//! revolution.

use crate::bounds::{Aabb, BoundingBall, Bounds};
use crate::error::{ShapeError, Unit, not_negative, positive};
use crate::field::{Warp, Warped};
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

impl<const D: usize> Shape<D> {
    /// The part at positive coordinates of `axis`, and its mirror image:
    /// `f(|x|, …)`.
    ///
    /// Outside, exact where the shape is if it stays on the positive side; inside,
    /// if it does not touch the mirror either. Else a bound.
    ///
    /// # Errors
    ///
    /// If there is no such axis, or shapes are nested too deeply.
    pub fn mirrored(self, axis: usize) -> Result<Self, ShapeError> {
        if axis >= D {
            let rule = format!("the number of an axis, less than {D}");
            return Err(ShapeError::number("axis", rule, axis as f64, Unit::One));
        }
        let child = self.promise();
        let one_side = child.bounds.is_some_and(|b| b.aabb.min[axis] >= 0.0);
        // Halves that touch have a wall between them that is no surface.
        let apart = child.bounds.is_some_and(|b| b.aabb.min[axis] > 0.0);
        let promise = Promise {
            bounds: child.bounds.map(|b| mirrored_bounds(&b, axis)),
            above_bounds: child.above_bounds && one_side,
            convex: false,
            symmetric: std::array::from_fn(|i| i == axis || child.symmetric[i]),
            region: child.region.map(|ball| BoundingBall {
                // What lies on the positive side only.
                radius: (ball.radius - ball.centre[axis].abs()).max(0.0),
                centre: Vector(array!(i < D => {
                    if i == axis { 0.0 } else { ball.centre[i] }
                })),
            }),
            outside: if one_side { child.outside } else { child.outside.bounded() },
            inside: if apart { child.inside } else { child.inside.bounded() },
            ..*child
        };
        self.warped(Mirror { axis }, promise)
    }

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
    pub fn elongated(self, lengths: [f64; D]) -> Result<Self, ShapeError> {
        for length in lengths {
            not_negative("elongate", length, Unit::Metre)?;
        }
        let half = lengths.map(|l| 0.5 * l);
        let child = self.promise();
        let kept = child.convex && (0..D).all(|i| half[i] == 0.0 || child.symmetric[i]);
        let reach = Vector(half).norm();
        let own = Rounding::of_operations(2.0 * child.lipschitz.max(1.0), reach);
        let promise = Promise {
            outside: if kept { child.outside } else { child.outside.bounded() },
            inside: child.inside.bounded(),
            bounds: child.bounds.map(|b| Bounds {
                aabb: Aabb { min: b.aabb.min - Vector(half), max: b.aabb.max + Vector(half) },
                ball: BoundingBall { radius: b.ball.radius + reach, ..b.ball },
            }),
            above_bounds: child.above_bounds && kept,
            convex: kept,
            // Points move by at most `reach`, and as far from each other at most.
            region: child
                .region
                .map(|ball| BoundingBall { radius: (ball.radius - reach).max(0.0), ..ball }),
            rounding: child.rounding.plus(&own),
            ..*child
        };
        let map = Elongation { half, symmetric: child.symmetric };
        self.warped(map, promise)
    }

    fn warped(self, map: impl Warp<D, D>, promise: Promise<D>) -> Result<Self, ShapeError> {
        let depth = self.depth() + 1;
        Self::from_operator(Warped { map, child: self, promise }, depth)
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

impl Shape<2> {
    /// The profile, drawn in x and z, as a solid of `height` [m] along y.
    ///
    /// Every promise of the profile is kept.
    ///
    /// # Errors
    ///
    /// If the height is not positive, or shapes are nested too deeply.
    pub fn extruded(self, height: f64) -> Result<Shape<3>, ShapeError> {
        let half_height = 0.5 * positive("height", height, Unit::Metre)?;
        let child = self.promise();
        let solid = |p: Vector<f64, 2>, y: f64| Vector([p[0], y, p[1]]);
        let bounds = child.bounds.map(|b| Bounds {
            aabb: Aabb {
                min: solid(b.aabb.min, -half_height),
                max: solid(b.aabb.max, half_height),
            },
            ball: BoundingBall {
                centre: solid(b.ball.centre, 0.0),
                radius: b.ball.radius.hypot(half_height) * (1.0 + 4.0 * f64::EPSILON),
            },
        });
        let own = Rounding::of_operations(5.0 * child.lipschitz.max(1.0), half_height);
        let promise = Promise {
            outside: child.outside,
            inside: child.inside,
            lipschitz: child.lipschitz.max(1.0),
            region: child.region.map(|ball| BoundingBall {
                centre: solid(ball.centre, 0.0),
                radius: ball.radius,
            }),
            bounds,
            above_bounds: child.above_bounds,
            convex: child.convex,
            symmetric: [child.symmetric[0], true, child.symmetric[1]],
            has_interior: child.has_interior,
            reach: child.reach,
            rounding: child.rounding.times(2.0).plus(&own),
        };
        let depth = self.depth() + 1;
        let node = Warped { map: Extrusion { half_height }, child: self, promise };
        Shape::from_operator(node, depth)
    }

    /// The profile turned about the y axis: its x is the distance from the axis.
    ///
    /// Outside, exact where the profile is if it lies in x ≥ 0 or is its own mirror
    /// image; inside, if it does not touch the axis either. Else a bound. A part at
    /// negative x is not seen.
    ///
    /// # Errors
    ///
    /// If shapes are nested too deeply.
    pub fn revolved(self) -> Result<Shape<3>, ShapeError> {
        let child = self.promise();
        let one_side = child.bounds.is_some_and(|b| b.aabb.min[0] >= 0.0);
        // A profile that is its own mirror image turns into itself.
        let kept = one_side || child.symmetric[0];
        // One that touches the axis leaves a line there that is no surface.
        let apart = child.bounds.is_some_and(|b| b.aabb.min[0] > 0.0);
        let solid = apart || child.symmetric[0];
        let bounds = child.bounds.map(|b| {
            let r = b.aabb.max[0].max(0.0);
            let aabb = Aabb {
                min: Vector([-r, b.aabb.min[1], -r]),
                max: Vector([r, b.aabb.max[1], r]),
            };
            let y = b.ball.centre[1];
            let radius = b.ball.centre[0].abs() + b.ball.radius;
            let ball = BoundingBall { centre: Vector([0.0, y, 0.0]), radius };
            let around = Bounds::of_box(aabb).ball;
            Bounds { aabb, ball: if around.radius < radius { around } else { ball } }
        });
        let own = Rounding::of_operations(3.0 * child.lipschitz.max(1.0), 0.0);
        let promise = Promise {
            outside: if kept { child.outside } else { child.outside.bounded() },
            inside: if solid { child.inside } else { child.inside.bounded() },
            lipschitz: child.lipschitz,
            region: child.region.map(|ball| BoundingBall {
                centre: Vector([0.0, ball.centre[1], 0.0]),
                radius: (ball.radius - ball.centre[0].abs()).max(0.0),
            }),
            bounds,
            above_bounds: child.above_bounds && kept,
            convex: child.convex && child.symmetric[0],
            symmetric: [true, child.symmetric[1], true],
            has_interior: child.has_interior,
            reach: child.reach,
            rounding: child.rounding.plus(&own),
        };
        let depth = self.depth() + 1;
        Shape::from_operator(Warped { map: Revolution, child: self, promise }, depth)
    }
}
