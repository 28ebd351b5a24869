// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Round arches and rods that taper.

use super::outline::bounds_about;
use crate::bounds::{Aabb, BoundingBall, Bounds};
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::mark::sets;
use crate::kernel::profile::TwoDiscs;
use crate::kernel::{Kernel, primitive, tangent_model};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Scalar};
use crate::vector::Vector;

/// The cross-section of a tunnel, a rectangle below and half a disc on top, about
/// the y axis and centred at half its height. Exact.
///
/// # Derivation
///
/// Without its floor the shape is all points within `r` of a ray down the y axis. The floor is
/// perpendicular to the walls, so both together are an orthant.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Tunnel};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let tunnel = Shape::from_kernel(Tunnel::new(4.0, 6.0)?);
/// assert_eq!(tunnel.distance(Vector([3.0, 5.0])), 3.0); // from the arch: 3-4-5
/// assert_eq!(tunnel.distance(Vector([-5.0, -7.0])), 5.0); // from the corner (−2, −3)
/// assert_eq!(tunnel.distance(Vector([0.0, -2.0])), -1.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Tunnel {
    radius: f64,
    half_height: f64,
}

impl Tunnel {
    /// A tunnel of full `width` and `height`, the arch included [m].
    ///
    /// # Errors
    ///
    /// If either is not positive, or the height less than half the width.
    pub fn new(width: f64, height: f64) -> Result<Self, ShapeError> {
        let radius = 0.5 * positive("width", width, Unit::Metre)?;
        positive("height", height, Unit::Metre)?;
        if height < radius {
            let rule = format!("at least half the width, {radius} m");
            return Err(ShapeError::number("height", rule, height, Unit::Metre));
        }
        Ok(Self { radius, half_height: 0.5 * height })
    }
}

impl Kernel<2> for Tunnel {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        let [x, y] = p.0;
        let above = (y - S::constant(self.half_height - self.radius)).max(S::constant(0.0));
        let wall = S::norm([x, above]) - S::constant(self.radius);
        S::orthant([wall, -y - S::constant(self.half_height)])
    }

    fn promise(&self) -> Promise<2> {
        let half = Vector([self.radius, self.half_height]);
        // The centre from which the top and the corners are equally far.
        let below = self.radius * (0.25 * self.radius / self.half_height);
        let bounds = bounds_about(Aabb::centred(half), -below, self.half_height + below);
        Promise {
            symmetric: [true, false],
            ..Promise::exact_convex(Some(bounds), 6.0, half.norm())
        }
    }
}

primitive! {
    Tunnel, tunnel, 2,
    about: "A rectangle below and half a disc on top.",
    origin: "centred, at half its height; a flat side down",
    parameters: {
        width: Length = "the full width" => |kernel| 2.0 * kernel.radius,
        height: Length = "the full height, the half disc included"
            => |kernel| 2.0 * kernel.half_height,
    },
    marks: |kernel| sets::arch("width", kernel.width(), kernel.height()),
    example: (1.1, 1.5),
}

/// The largest number of rounded operations of the distance of an uneven capsule.
const CAPSULE_OPERATIONS: f64 = 6.0;

/// Two discs on the y axis and all between their common tangents, centred between
/// the discs' centres. Exact.
///
/// Folded to `x ≥ 0`, it is the profile that a [`RoundCone`](crate::kernel::RoundCone)
/// turns.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::UnevenCapsule};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let pin = Shape::from_kernel(UnevenCapsule::new(4.0, 1.0, 5.0)?);
/// assert_eq!(pin.distance(Vector([0.0, 4.5])), 1.0); // above the tip, at 3.5
/// assert_eq!(pin.distance(Vector([0.0, -7.0])), 0.5); // below
/// // On the tangent's normal (0.8, 0.6) through the bottom centre.
/// assert!((pin.distance(Vector([8.0, 3.5])) - 6.0).abs() < 1e-14);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct UnevenCapsule {
    bottom_radius: f64,
    top_radius: f64,
    height: f64,
    half: TwoDiscs,
}

impl UnevenCapsule {
    /// A capsule of discs with the given radii, their centres `height` apart [m].
    ///
    /// # Errors
    ///
    /// If a length is not positive, or one disc holds the other.
    pub fn new(bottom_radius: f64, top_radius: f64, height: f64) -> Result<Self, ShapeError> {
        positive("bottom_radius", bottom_radius, Unit::Metre)?;
        positive("top_radius", top_radius, Unit::Metre)?;
        positive("height", height, Unit::Metre)?;
        let difference = bottom_radius - top_radius;
        if height <= difference.abs() {
            let difference = difference.abs();
            let rule = format!("more than the difference of the radii, {difference} m");
            return Err(ShapeError::number("height", rule, height, Unit::Metre));
        }
        let half = TwoDiscs::new(bottom_radius, top_radius, height);
        Ok(Self { bottom_radius, top_radius, height, half })
    }

    fn size(&self) -> f64 {
        0.5 * self.height + self.bottom_radius.max(self.top_radius)
    }
}

impl Kernel<2> for UnevenCapsule {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        self.half.distance([p.0[0].abs(), p.0[1]])
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 2>) -> AffineModel<N> {
        tangent_model(self, cell, CAPSULE_OPERATIONS, self.size())
    }

    fn promise(&self) -> Promise<2> {
        let (half, size) = (0.5 * self.height, self.size());
        let disc = |y: f64, radius: f64| BoundingBall { centre: Vector([0.0, y]), radius };
        let (bottom, top) = (disc(-half, self.bottom_radius), disc(half, self.top_radius));
        let widest = self.bottom_radius.max(self.top_radius);
        let aabb = Aabb {
            min: Vector([-widest, -half - self.bottom_radius]),
            max: Vector([widest, half + self.top_radius]),
        };
        let aabb = aabb.grown(4.0 * f64::EPSILON * size);
        let bounds = Bounds { aabb, ball: bottom.union(&top) };
        Promise {
            symmetric: [true, self.bottom_radius == self.top_radius],
            ..Promise::exact_convex(Some(bounds), CAPSULE_OPERATIONS, size)
        }
    }
}

primitive! {
    UnevenCapsule, uneven_capsule, 2,
    about: "Two discs on the y axis and all between their common tangents.",
    origin: "midway between its centres; the bottom disc down",
    parameters: {
        bottom_radius: Length = "the radius of the lower disc",
        top_radius: Length = "the radius of the upper disc",
        height: Length = "between the centres of the discs",
    },
    marks: |kernel| {
        sets::two_balls(kernel.bottom_radius(), kernel.top_radius(), kernel.height())
    },
    example: (0.5, 0.25, 0.8),
}

#[cfg(feature = "oracle")]
mod evidence {
    use std::f64::consts::FRAC_PI_2;

    use super::*;
    use crate::oracle::{Definition, Evidence, Row, arc, both_sides, line};

    impl Evidence<2> for Tunnel {
        const SAMPLE: &'static str = r#"{ "width": 0.07, "height": 0.1 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Tunnel", "`width`, `height` with the half disc", "exact")];

        fn definition(&self) -> Definition<2> {
            tunnel(self.width(), self.height())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(1.0, 0.25)]
        }
    }

    impl Evidence<2> for UnevenCapsule {
        const SAMPLE: &'static str =
            r#"{ "bottom_radius": 0.03, "top_radius": 0.015, "height": 0.05 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Uneven Capsule",
            "`bottom_radius`, `top_radius`, `height` between the centres",
            "exact, convex",
        )];

        fn definition(&self) -> Definition<2> {
            uneven_capsule(self.bottom_radius(), self.top_radius(), self.height())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.75, 0.25, 0.5)]
        }
    }

    fn tunnel(width: f64, height: f64) -> Definition<2> {
        let (r, floor) = (0.5 * width, -0.5 * height);
        let spring = 0.5 * height - r;
        let right = vec![
            arc([0.0, spring], r, [0.0, FRAC_PI_2]),
            line([r, spring], [r, floor]),
            line([0.0, floor], [r, floor]),
        ];
        both_sides(right, move |p| {
            let in_arch = (p - Vector([0.0, spring])).norm() < r;
            p[1] > floor && (in_arch || (p[1] < spring && p[0].abs() < r))
        })
    }

    /// All discs between two on the y axis, whose centre and radius are interpolated linearly.
    fn uneven_capsule(bottom: f64, top: f64, height: f64) -> Definition<2> {
        let half = 0.5 * height;
        // From the axis to where the tangent touches the discs.
        let angle = FRAC_PI_2 - ((bottom - top) / height).acos();
        let touch = |y: f64, r: f64| [r * angle.cos(), y + r * angle.sin()];
        let right = vec![
            arc([0.0, -half], bottom, [-FRAC_PI_2, angle]),
            line(touch(-half, bottom), touch(half, top)),
            arc([0.0, half], top, [angle, FRAC_PI_2]),
        ];
        both_sides(right, move |p| {
            let beyond = |t: f64| {
                let centre = Vector([0.0, -half + t * height]);
                (p - centre).norm() - (bottom + t * (top - bottom))
            };
            // Convex in t, so a ternary search finds the minimum.
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..200 {
                let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
                if beyond(a) < beyond(b) {
                    high = b;
                } else {
                    low = a;
                }
            }
            beyond(low).min(beyond(0.0)).min(beyond(1.0)) < 0.0
        })
    }
}
