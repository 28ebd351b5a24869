// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Twist and bend: rotations by an angle that grows along an axis.
//!
//! # Derivation
//!
//! A point is turned in a plane by the angle `k·t`, where `t` is its place along an
//! axis and `k` the rate [rad/m]. But for the rotation, which keeps lengths, the
//! derivative is `I + k·p⊥·eᵀ`: the point, turned by a right angle, times the axis. At
//! a distance `r` from the axis of the rotation `k·p⊥` is `kr` long. For a twist it is
//! at right angles to `e`, a shear, and lengths grow by at most its largest singular
//! value, `½(kr + √(k²r² + 4))`; for a bend, by at most `1 + kr`. Both grow without end, so
//! the child is evaluated inside its swept box alone, the room: elsewhere at the nearest
//! point of the room, with the distance to the room added. Both parts vary in directions at right
//! angles to each other, so the sum is as steep as `√(L² + 1)`.

use crate::bounds::{Aabb, Bounds};
use crate::error::{ShapeError, Unit};
use crate::field::{SharedField, Warp, Warped};
use crate::promise::{Promise, Quality, Rounding};
use crate::scalar::{Float, Scalar};
use crate::vector::{Vector, array};

/// The largest angle of a distortion [rad]: sines of larger angles lose digits.
const MOST_TURN: f64 = 1e4;

/// The box outside which the child is not evaluated.
#[derive(Clone, Copy, Debug)]
struct Room<const D: usize> {
    centre: [f64; D],
    half_extents: [f64; D],
}

impl<const D: usize> Room<D> {
    fn new(aabb: &Aabb<D>) -> Self {
        Self { centre: aabb.centre().0, half_extents: aabb.half_extents().0 }
    }

    /// The point of the room nearest to `p`.
    #[inline(always)]
    fn nearest<S: Scalar>(&self, p: Vector<S, D>) -> Vector<S, D> {
        Vector(array!(i < D => {
            p.0[i].clamp(
                self.centre[i] - self.half_extents[i],
                self.centre[i] + self.half_extents[i],
            )
        }))
    }

    /// The distance from `p` to the room; zero inside.
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, D>) -> S {
        // From the nearest point itself: on a wall, either it moves with `p` or the
        // distance does, whatever is rounded.
        S::norm((p - self.nearest(p)).0)
    }

    /// The distorted field and its gradient at `p`, from the child's answer and the
    /// `slope` of it at the nearest point of the room.
    #[inline(always)]
    fn gradient<T: Float>(
        &self,
        p: Vector<T, D>,
        child: T,
        slope: Vector<T, D>,
    ) -> (T, Vector<T, D>) {
        let (zero, one) = (T::constant(0.0), T::constant(1.0));
        let away = p - self.nearest(p);
        let distance = away.norm();
        let inverse = one / T::select_less(zero, distance, distance, one);
        // Past a wall the nearest point stays, and the distance grows.
        let gradient = array!(i < D => {
            let kept = if away.0[i] == zero { slope.0[i] } else { zero };
            kept + away.0[i] * inverse
        });
        (child + distance, Vector(gradient))
    }
}

/// `(u, v)` turned by `angle` from u towards v.
#[inline(always)]
fn turned<S: Scalar>(u: S, v: S, angle: S) -> [S; 2] {
    let (sin, cos) = (angle.sin(), angle.cos());
    [cos * u - sin * v, sin * u + cos * v]
}

/// The gradient in `(u, v)` and in the angle, from that in the turned `(u, v)`.
#[inline(always)]
fn turned_back<T: Float>([u, v]: [T; 2], angle: T, [by_u, by_v]: [T; 2]) -> ([T; 2], T) {
    let (sin, cos) = (angle.sin(), angle.cos());
    let [turned_u, turned_v] = turned(u, v, angle);
    let slope = [cos * by_u + sin * by_v, cos * by_v - sin * by_u];
    (slope, turned_u * by_v - turned_v * by_u)
}

/// Turned about y by an angle that grows with y.
#[derive(Debug)]
pub(crate) struct Twist {
    rate: f64,
    room: Room<3>,
}

impl Warp<3, 3> for Twist {
    #[inline(always)]
    fn point<S: Scalar>(&self, p: Vector<S, 3>) -> Vector<S, 3> {
        let Vector([x, y, z]) = self.room.nearest(p);
        let [z, x] = turned(z, x, y.scale(-self.rate));
        Vector([x, y, z])
    }

    #[inline(always)]
    fn value<S: Scalar>(&self, p: Vector<S, 3>, child: S) -> S {
        child + self.room.distance(p)
    }

    #[inline(always)]
    fn gradient<T: Float>(
        &self,
        p: Vector<T, 3>,
        child: T,
        Vector([by_x, by_y, by_z]): Vector<T, 3>,
    ) -> (T, Vector<T, 3>) {
        let Vector([x, y, z]) = self.room.nearest(p);
        let ([slope_z, slope_x], by_angle) =
            turned_back([z, x], y.scale(-self.rate), [by_z, by_x]);
        let slope_y = by_y + by_angle.scale(-self.rate);
        self.room.gradient(p, child, Vector([slope_x, slope_y, slope_z]))
    }
}

/// Turned in the plane of x and y by an angle that grows with x.
#[derive(Debug)]
pub(crate) struct Bend<const D: usize> {
    rate: f64,
    room: Room<D>,
}

impl<const D: usize> Warp<D, D> for Bend<D> {
    #[inline(always)]
    fn point<S: Scalar>(&self, p: Vector<S, D>) -> Vector<S, D> {
        let mut q = self.room.nearest(p);
        let [x, y] = turned(q.0[0], q.0[1], q.0[0].scale(-self.rate));
        (q.0[0], q.0[1]) = (x, y);
        q
    }

    #[inline(always)]
    fn value<S: Scalar>(&self, p: Vector<S, D>, child: S) -> S {
        child + self.room.distance(p)
    }

    #[inline(always)]
    fn gradient<T: Float>(
        &self,
        p: Vector<T, D>,
        child: T,
        child_gradient: Vector<T, D>,
    ) -> (T, Vector<T, D>) {
        let (q, mut slope) = (self.room.nearest(p), child_gradient);
        let (x, y) = (q.0[0], q.0[1]);
        let by = [slope.0[0], slope.0[1]];
        let ([slope_x, slope_y], by_angle) = turned_back([x, y], x.scale(-self.rate), by);
        slope.0[0] = slope_x + by_angle.scale(-self.rate);
        slope.0[1] = slope_y;
        self.room.gradient(p, child, slope)
    }
}

/// The box around what `aabb` sweeps when it is turned in the plane of two axes, and
/// how far its corners are from the axis of the rotation.
fn swept<const D: usize>(aabb: &Aabb<D>, [u, v]: [usize; 2]) -> (Aabb<D>, f64) {
    let farthest = |i: usize| aabb.min[i].abs().max(aabb.max[i].abs());
    let radius = farthest(u).hypot(farthest(v)) * (1.0 + 4.0 * f64::EPSILON);
    let mut swept = *aabb;
    for i in [u, v] {
        (swept.min[i], swept.max[i]) = (-radius, radius);
    }
    (swept, radius * std::f64::consts::SQRT_2 * (1.0 + f64::EPSILON))
}

/// The promise of a shape whose points are turned by up to `turn` [rad] and whose
/// lengths are stretched by up to `stretch`.
fn distorted<const D: usize>(
    child: &Promise<D>,
    room: &Aabb<D>,
    stretch: f64,
    turn: f64,
) -> Promise<D> {
    let bounds = Bounds::of_box(*room);
    let size = bounds.radius_about_origin();
    // A relative error of the angle moves a point in proportion to the angle.
    let operations = (12.0 + 2.0 * turn) * stretch * child.lipschitz.max(1.0);
    let moved = Rounding::of_operations(operations, size);
    Promise {
        outside: Quality::Lipschitz,
        inside: Quality::Lipschitz,
        lipschitz: (child.lipschitz * stretch).hypot(1.0) * (1.0 + 8.0 * f64::EPSILON),
        bounds: Some(bounds),
        above_bounds: true,
        convex: false,
        symmetric: [false; D],
        rounding: child.rounding.at(1.0, size).plus(&moved),
        ..*child
    }
}

/// A rotation in the plane of two axes, by an angle that grows along an axis.
struct Turning {
    operator: &'static str,
    plane: [usize; 2],
    along: usize,
}

impl Turning {
    const BEND: Self = Self { operator: "bend", plane: [0, 1], along: 0 };
    const TWIST: Self = Self { operator: "twist", plane: [2, 0], along: 1 };

    /// The largest stretch of a length, for the rate times the radius.
    fn stretch(&self, kr: f64) -> f64 {
        if self.plane.contains(&self.along) { 1.0 + kr } else { 0.5 * (kr + kr.hypot(2.0)) }
    }

    /// The room and the promise of a shape turned by `rate` [rad/m].
    fn of<const D: usize>(
        &self,
        child: &Promise<D>,
        rate: f64,
    ) -> Result<(Room<D>, Promise<D>), ShapeError> {
        let operator = self.operator;
        let needs =
            |needs: &'static str| ShapeError::Unsuitable { operator, needs: needs.into() };
        let bounds = child.bounds.ok_or_else(|| needs("a shape with bounds"))?;
        if child.region.is_some() {
            return Err(needs("a shape whose steepness is known everywhere"));
        }
        let (room, radius) = swept(&bounds.aabb, self.plane);
        let along = room.min[self.along].abs().max(room.max[self.along].abs());
        let turn = rate.abs() * along;
        if turn.is_nan() || turn > MOST_TURN {
            let rule = format!("such that the shape turns by at most {MOST_TURN} rad");
            return Err(ShapeError::number(operator, rule, rate, Unit::One));
        }
        let stretch = self.stretch(rate.abs() * radius);
        Ok((Room::new(&room), distorted(child, &room, stretch, turn)))
    }
}

/// The `child` turned in the plane of x and y by `rate` · x.
pub(crate) fn bent<const D: usize>(
    child: SharedField<D>,
    rate: f64,
) -> Result<SharedField<D>, ShapeError> {
    let (room, promise) = Turning::BEND.of(child.promise(), rate)?;
    Warped::shared(Bend { rate, room }, child, promise)
}

/// The `child` turned about y by `rate` · y.
pub(crate) fn twisted(child: SharedField<3>, rate: f64) -> Result<SharedField<3>, ShapeError> {
    let (room, promise) = Turning::TWIST.of(child.promise(), rate)?;
    Warped::shared(Twist { rate, room }, child, promise)
}
