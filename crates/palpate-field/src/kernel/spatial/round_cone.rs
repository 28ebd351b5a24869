// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The convex hulls of two balls.

use super::cylinder::in_profile;
use crate::bounds::{Aabb, BoundingBall, Bounds};
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::between::Between;
use crate::kernel::mark::{Mark, across, sets};
use crate::kernel::profile::TwoDiscs;
use crate::kernel::{Kernel, primitive, tangent_model};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Scalar};
use crate::vector::{Point, Vector};

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 8.0;

/// A length [m] by its name.
#[derive(Clone, Copy)]
struct Named {
    name: &'static str,
    length: f64,
}

impl Named {
    fn new(name: &'static str, length: f64) -> Self {
        Self { name, length }
    }
}

/// The profile of two balls, neither of which holds the other.
fn two_discs(radii: [Named; 2], distance: Named) -> Result<TwoDiscs, ShapeError> {
    let [first, second] = radii.map(|radius| radius.length);
    for Named { name, length } in [radii[0], radii[1], distance] {
        positive(name, length, Unit::Metre)?;
    }
    let least = (first - second).abs();
    if distance.length <= least {
        let rule = format!("more than the difference of the radii, {least} m");
        return Err(ShapeError::number(distance.name, rule, distance.length, Unit::Metre));
    }
    Ok(TwoDiscs::new(first, second, distance.length))
}

/// Two balls above each other on the y axis and all that is between: their convex
/// hull. Exact.
///
/// The origin is half-way between the centres. The shape is the hull of two discs, turned about
/// the y axis.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::RoundCone};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let pin = Shape::from_kernel(RoundCone::new(4.0, 1.0, 5.0)?);
/// assert_eq!(pin.distance(Vector([0.0, 5.5, 0.0])), 2.0); // above the upper ball
/// assert_eq!(pin.distance(Vector([6.0, -10.5, 0.0])), 6.0); // below the lower
/// // Beside: the side's normal is (4, 3)/5.
/// assert!((pin.distance(Vector([8.0, 5.5, 0.0])) - 7.2).abs() < 1e-14);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct RoundCone(TwoDiscs);

impl RoundCone {
    /// Balls of two radii, their centres `height` apart [m].
    ///
    /// # Errors
    ///
    /// If a length is not positive, or one ball holds the other.
    pub fn new(bottom_radius: f64, top_radius: f64, height: f64) -> Result<Self, ShapeError> {
        let bottom = Named::new("bottom_radius", bottom_radius);
        let top = Named::new("top_radius", top_radius);
        Ok(Self(two_discs([bottom, top], Named::new("height", height))?))
    }
}

impl Kernel<3> for RoundCone {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        self.0.distance(in_profile(p))
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 3>) -> AffineModel<N> {
        tangent_model(self, cell, OPERATIONS, self.0.size())
    }

    fn promise(&self) -> Promise<3> {
        let (half, [bottom, top]) = (self.0.half_distance(), self.0.radii());
        let widest = bottom.max(top);
        let aabb = Aabb {
            min: Vector([-widest, -half - bottom, -widest]),
            max: Vector([widest, half + top, widest]),
        };
        let centre = Vector([0.0, 0.5 * (top - bottom), 0.0]);
        let radius = 0.5 * self.0.size() * (1.0 + 4.0 * f64::EPSILON);
        let bounds = Bounds { aabb, ball: BoundingBall { centre, radius } };
        Promise {
            symmetric: [true, bottom == top, true],
            ..Promise::exact_convex(Some(bounds), OPERATIONS, self.0.size())
        }
    }
}

primitive! {
    RoundCone, round_cone, 3,
    about: "Two balls above each other and all that is between them.",
    origin: "midway between its centres; the bottom ball down",
    parameters: {
        bottom_radius: Length = "the radius of the lower ball" => |kernel| kernel.0.radii()[0],
        top_radius: Length = "the radius of the upper ball" => |kernel| kernel.0.radii()[1],
        height: Length = "from centre to centre, more than the radii differ"
            => |kernel| 2.0 * kernel.0.half_distance(),
    },
    marks: |kernel| {
        sets::two_balls(kernel.bottom_radius(), kernel.top_radius(), kernel.height())
    },
    example: (0.45, 0.2, 0.8),
}

/// Balls about two points and all that is between: their convex hull. Exact.
///
/// A [`RoundCone`] along the line between the points.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::RoundConeBetween};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let (from, to) = (Vector([1.0, 0.0, 0.0]), Vector([6.0, 0.0, 0.0]));
/// let bone = Shape::from_kernel(RoundConeBetween::new(from, to, 4.0, 1.0)?);
/// assert_eq!(bone.distance(Vector([9.0, 0.0, 4.0])), 4.0); // from the small end
/// assert_eq!(bone.distance(Vector([-8.0, 0.0, 0.0])), 5.0); // from the large end
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct RoundConeBetween {
    cone: RoundCone,
    between: Between<3>,
}

impl RoundConeBetween {
    /// Balls of two radii about two points [m].
    ///
    /// # Errors
    ///
    /// If a radius is not positive, a coordinate not finite, or one ball holds the
    /// other.
    pub fn new(
        from: Point<3>,
        to: Point<3>,
        from_radius: f64,
        to_radius: f64,
    ) -> Result<Self, ShapeError> {
        let between = Between::new(from, to)?;
        let from = Named::new("from_radius", from_radius);
        let to = Named::new("to_radius", to_radius);
        let distance = 2.0 * between.half_length();
        let distance = Named::new("the distance from `from` to `to`", distance);
        Ok(Self { cone: RoundCone(two_discs([from, to], distance)?), between })
    }
}

impl Kernel<3> for RoundConeBetween {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        self.cone.distance(self.between.to_body(p))
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 3>) -> AffineModel<N> {
        self.cone.model(self.between.to_body(cell))
    }

    fn promise(&self) -> Promise<3> {
        let (discs, pose) = (&self.cone.0, self.between.pose());
        let [start, end] = discs.radii();
        let ball = |along: f64, radius: f64| {
            let centre = pose.transform_point(Vector([0.0, along, 0.0]));
            Aabb { min: centre, max: centre }.grown(radius)
        };
        let half = discs.half_distance();
        let aabb = ball(-half, start).union(&ball(half, end));
        let placed = self.cone.promise().placed(pose);
        let bounds = placed.bounds.map(|around| {
            let slack = 8.0 * f64::EPSILON * around.radius_about_origin();
            Bounds { aabb: aabb.grown(slack), ..around }
        });
        Promise { bounds, ..placed }
    }
}

primitive! {
    RoundConeBetween, round_cone_between, 3,
    about: "Balls about two points and all that is between them.",
    origin: "given by its points",
    parameters: {
        from: Vector = "the centre of one ball" => |kernel| kernel.between.from(),
        to: Vector = "the centre of the other ball" => |kernel| kernel.between.to(),
        from_radius: Length = "the radius of one ball" => |kernel| kernel.cone.0.radii()[0],
        to_radius: Length = "the radius of the other ball" => |kernel| kernel.cone.0.radii()[1],
    },
    marks: |kernel| {
        let (from, to) = (kernel.from(), kernel.to());
        let (out, along) = (across(to - from), (to - from).normalized().unwrap_or(Vector::ZERO));
        let away = |along: Vector<f64, 3>, radius: f64| (along * 0.6 - out * 0.8) * radius;
        vec![
            Mark::position("from", from),
            Mark::position("to", to),
            Mark::length_between("from_radius", from, from + away(-along, kernel.from_radius())),
            Mark::length_between("to_radius", to, to + away(along, kernel.to_radius())),
        ]
    },
    example: (Vector([-0.4, -0.3, 0.2]), Vector([0.5, 0.4, -0.1]), 0.4, 0.2),
}

#[cfg(feature = "oracle")]
mod evidence {
    use std::f64::consts::FRAC_PI_2;

    use super::*;
    use crate::oracle::{Definition, Evidence, Row, arc, between, line, turned};

    impl Evidence<3> for RoundCone {
        const SAMPLE: &'static str =
            r#"{ "bottom_radius": 0.03, "top_radius": 0.015, "height": 0.05 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Round Cone, vertical",
            "`bottom_radius`, `top_radius`, `height` between the centres",
            "exact, convex",
        )];

        fn definition(&self) -> Definition<3> {
            round_cone(self.bottom_radius(), self.top_radius(), self.height())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.75, 0.25, 0.5)]
        }
    }

    impl Evidence<3> for RoundConeBetween {
        const SAMPLE: &'static str = r#"{ "from": [-0.02, -0.02, -0.01], "to": [0.03, 0.03, 0.01],
             "from_radius": 0.025, "to_radius": 0.015 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Round Cone, arbitrary",
            "`from`, `to`, `from_radius`, `to_radius`",
            "exact, convex",
        )];

        fn definition(&self) -> Definition<3> {
            let (from, to) = (self.from(), self.to());
            let length = (to - from).norm();
            between(from, to, round_cone(self.from_radius(), self.to_radius(), length))
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(Vector([0.5, 0.25, 0.0]), Vector([0.5, 0.25, 0.75]), 1.0, 0.25)]
        }
    }

    /// Halvings of the range that holds the minimum of a convex function.
    const STEPS: usize = 200;

    /// All balls between two, whose centre and radius are interpolated linearly.
    fn round_cone(bottom: f64, top: f64, height: f64) -> Definition<3> {
        let low = -0.5 * height;
        let lean = ((bottom - top) / height).asin();
        let touch = |centre: f64, r: f64| [r * lean.cos(), centre + r * lean.sin()];
        let profile = vec![
            arc([0.0, low], bottom, [-FRAC_PI_2, lean]),
            arc([0.0, -low], top, [lean, FRAC_PI_2]),
            line(touch(low, bottom), touch(-low, top)),
        ];
        turned(profile, bottom.max(top), move |rho, y| {
            let out_of = |t: f64| rho.hypot(y - low - height * t) - bottom - (top - bottom) * t;
            let (mut from, mut to) = (0.0, 1.0);
            for _ in 0..STEPS {
                let third = (to - from) / 3.0;
                if out_of(from + third) < out_of(to - third) {
                    to -= third;
                } else {
                    from += third;
                }
            }
            out_of(from).min(out_of(0.0)).min(out_of(1.0)) < 0.0
        })
    }
}
