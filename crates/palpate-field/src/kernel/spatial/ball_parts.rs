// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Parts of balls and spheres about the y axis.

use super::cylinder::in_profile;
use crate::bounds::{Aabb, BoundingBall, Bounds};
use crate::error::{ShapeError, Unit, finite, not_negative, positive};
use crate::kernel::mark::{Mark, at, sets};
use crate::kernel::profile::{Curve, CutDiskProfile, Moon, Wedge, bounds_of_zone};
use crate::kernel::{Evaluations, Kernel, primitive, tangent_model};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Scalar};
use crate::vector::Vector;

/// The largest number of rounded operations of the distance of a part.
const OPERATIONS: f64 = 8.0;

/// The part of a ball about the origin in a cone about the +y axis: a cone with a round
/// base. Exact.
///
/// A sector of a disc, turned about the y axis. If the angle exceeds half a turn, the shape is
/// not convex and the formula bounds cells. A full turn would be the whole ball.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::SolidAngle};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let right_angle = std::f64::consts::FRAC_PI_2;
/// let scoop = Shape::from_kernel(SolidAngle::new(2.0, right_angle)?);
/// assert_eq!(scoop.distance(Vector([0.0, 4.0, 3.0])), 3.0); // above the cap
/// assert_eq!(scoop.distance(Vector([0.0, -3.0, 0.0])), 3.0); // below the tip
/// assert!((scoop.distance(Vector([0.0, 1.0, 0.0])) + 0.5_f64.sqrt()).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct SolidAngle(Wedge);

impl SolidAngle {
    /// The part of a ball of `radius` [m] in a cone that opens by `angle` [rad] from
    /// side to side.
    ///
    /// # Errors
    ///
    /// If the radius is not positive, or the angle not between 0 and 2π.
    pub fn new(radius: f64, angle: f64) -> Result<Self, ShapeError> {
        positive("radius", radius, Unit::Metre)?;
        Ok(Self(Wedge::new(angle, 0.0, radius)?))
    }
}

impl Kernel<3> for SolidAngle {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        self.0.sector(in_profile(p))
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 3>) -> AffineModel<N> {
        if self.0.is_convex() {
            tangent_model(self, cell, OPERATIONS, self.0.outer())
        } else {
            let evaluations = Evaluations { operations: OPERATIONS, size: self.0.outer() };
            evaluations.or_by_steepness(self.distance(cell), &cell)
        }
    }

    fn promise(&self) -> Promise<3> {
        let (radius, [sin, cos]) = (self.0.outer(), self.0.end());
        let widest = if cos < 0.0 { radius } else { radius * sin };
        let aabb = Aabb {
            min: Vector([-widest, radius * cos.min(0.0), -widest]),
            max: Vector([widest, radius, widest]),
        };
        // The ball through tip and rim, or the one whose widest circle is the rim.
        let slim = cos > sin;
        let (centre, around) = if slim {
            (0.5 * radius / cos, 0.5 * radius / cos)
        } else {
            (radius * cos.max(0.0), widest)
        };
        let slack = 8.0 * f64::EPSILON * radius;
        let ball = BoundingBall { centre: Vector([0.0, centre, 0.0]), radius: around + slack };
        let bounds = Bounds { aabb: aabb.grown(slack), ball };
        Promise {
            convex: self.0.is_convex(),
            symmetric: [true, false, true],
            ..Promise::exact(Some(bounds), OPERATIONS, radius)
        }
    }
}

primitive! {
    SolidAngle, solid_angle, 3,
    about: "The part of a ball in a cone about the +y axis, its tip at the origin.",
    origin: "at its tip; spread about +y",
    parameters: {
        radius: Length = "the radius of the ball" => |kernel| kernel.0.outer(),
        angle: Angle = "the opening from side to side, less than a full turn"
            => |kernel| kernel.0.angle(),
    },
    marks: |kernel| sets::sector(kernel.radius(), kernel.angle()),
    example: (0.9, 1.2),
}

/// Checks a height at which a ball of a radius is cut.
fn height_of_cut(radius: f64, height: f64) -> Result<f64, ShapeError> {
    finite("cut_height", height, Unit::Metre)?;
    if height.abs() < radius {
        return Ok(height);
    }
    let rule = format!("between minus and plus the radius, {radius} m");
    Err(ShapeError::number("cut_height", rule, height, Unit::Metre))
}

/// The part of a ball about the origin above a height. Exact.
///
/// A disc cut by a line, turned about the y axis.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::CutBall};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let bun = Shape::from_kernel(CutBall::new(5.0, -3.0)?);
/// assert_eq!(bun.distance(Vector([0.0, -5.0, 2.0])), 2.0); // below the cut
/// assert_eq!(bun.distance(Vector([7.0, -7.0, 0.0])), 5.0); // from the rim at (4, −3)
/// assert_eq!(bun.distance(Vector([0.0, 6.0, 8.0])), 5.0); // from the ball
/// assert_eq!(bun.distance(Vector([0.0, 0.0, 0.0])), -3.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct CutBall {
    disc: CutDiskProfile,
    radius: f64,
    cut_height: f64,
}

impl CutBall {
    /// A ball of `radius` without what is below `cut_height` [m].
    ///
    /// # Errors
    ///
    /// If the radius is not positive, or the height not between minus and plus the
    /// radius.
    pub fn new(radius: f64, cut_height: f64) -> Result<Self, ShapeError> {
        positive("radius", radius, Unit::Metre)?;
        height_of_cut(radius, cut_height)?;
        Ok(Self { disc: CutDiskProfile::new(radius, cut_height), radius, cut_height })
    }
}

impl Kernel<3> for CutBall {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        self.disc.distance(in_profile(p))
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 3>) -> AffineModel<N> {
        tangent_model(self, cell, OPERATIONS, self.radius)
    }

    fn promise(&self) -> Promise<3> {
        let bounds = bounds_of_zone(self.radius, [self.cut_height, self.radius]);
        Promise {
            symmetric: [true, false, true],
            ..Promise::exact_convex(Some(bounds), OPERATIONS, self.radius)
        }
    }
}

primitive! {
    CutBall, cut_ball, 3,
    about: "A ball about the origin, cut off below a height.",
    origin: "at the centre of its ball; a flat side down",
    parameters: {
        radius: Length = "the radius of the ball",
        cut_height: Coordinate = "where it is cut, between minus and plus the radius",
    },
    marks: |kernel| sets::cut(kernel.radius(), kernel.cut_height()),
    example: (0.8, -0.3),
}

/// A bowl: what is left of a hollow sphere about the origin when all above a height is
/// cut off, its rim rounded. Exact.
///
/// All points within half the thickness of an arc, turned about the y axis. With a thickness of
/// zero it has no inside.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::CutHollowSphere};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let bowl = Shape::from_kernel(CutHollowSphere::new(5.0, -3.0, 1.0)?);
/// assert_eq!(bowl.distance(Vector([0.0, -4.0, 0.0])), 0.5); // in the bowl
/// assert_eq!(bowl.distance(Vector([7.0, 1.0, 0.0])), 4.5); // from the rim at (4, −3)
/// assert_eq!(bowl.distance(Vector([0.0, -8.0, 6.0])), 4.5); // from below
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct CutHollowSphere {
    /// The middle of the wall, upside down.
    wall: Curve,
    radius: f64,
    cut_height: f64,
    half_thickness: f64,
}

impl CutHollowSphere {
    /// A wall of `thickness` about a sphere of `radius` without what is above `cut_height`
    /// [m].
    ///
    /// # Errors
    ///
    /// If the radius is not positive, the height not between minus and plus the
    /// radius, or the thickness negative or so large that the wall meets itself: in
    /// the middle, or across the opening.
    pub fn new(radius: f64, cut_height: f64, thickness: f64) -> Result<Self, ShapeError> {
        positive("radius", radius, Unit::Metre)?;
        height_of_cut(radius, cut_height)?;
        not_negative("thickness", thickness, Unit::Metre)?;
        let wall = Curve::above(radius, -cut_height);
        let most = 2.0 * wall.room();
        if thickness > most {
            let rule = format!("at most {most} m, where the middle or the opening closes");
            return Err(ShapeError::number("thickness", rule, thickness, Unit::Metre));
        }
        Ok(Self { wall, radius, cut_height, half_thickness: 0.5 * thickness })
    }
}

impl Kernel<3> for CutHollowSphere {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        let [rho, y] = in_profile(p);
        self.wall.distance([rho, -y]) - S::constant(self.half_thickness)
    }

    #[inline(always)]
    fn bounded_by_steepness(&self) -> Option<Evaluations> {
        Some(Evaluations { operations: OPERATIONS, size: self.radius + self.half_thickness })
    }

    fn promise(&self) -> Promise<3> {
        let sheet = bounds_of_zone(self.radius, [-self.radius, self.cut_height]);
        let size = self.radius + self.half_thickness;
        Promise {
            has_interior: self.half_thickness > 0.0,
            symmetric: [true, false, true],
            ..Promise::exact(Some(sheet.grown(self.half_thickness)), OPERATIONS, size)
        }
    }
}

primitive! {
    CutHollowSphere, cut_hollow_sphere, 3,
    about: "A bowl: a hollow sphere about the origin, cut off above a height, its rim round.",
    origin: "at the centre of its sphere; hollow upwards",
    parameters: {
        radius: Length = "from the origin to the middle of the wall",
        cut_height: Coordinate = "where it is cut, between minus and plus the radius",
        thickness: LengthOrZero = "the thickness of the wall, zero for a sheet without inside"
            => |kernel| 2.0 * kernel.half_thickness,
    },
    marks: |kernel| {
        let (radius, half) = (kernel.radius(), 0.5 * kernel.thickness());
        let place = |x: f64, radius: f64| at(x * radius, -0.8 * radius);
        let cut = kernel.cut_height();
        let rim = ((radius - cut) * (radius + cut)).max(0.0).sqrt();
        vec![
            Mark::from_origin("radius", place(0.6, radius)),
            Mark::from_origin("cut_height", at(rim, cut)).right(),
            Mark::length_between(
                "thickness", place(-0.6, radius - half), place(-0.6, radius + half),
            ),
        ]
    },
    example: (0.8, 0.2, 0.15),
}

/// A ball about the origin with a bite from above: without another ball. Exact.
///
/// A disc without another, turned about the y axis.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::DeathStar};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let star = Shape::from_kernel(DeathStar::new(5.0, 5.0, 8.0)?);
/// assert_eq!(star.distance(Vector([0.0, 4.0, 0.0])), 1.0); // in the bite
/// assert_eq!(star.distance(Vector([0.0, 0.0, 0.0])), -3.0); // below its bottom
/// assert_eq!(star.distance(Vector([0.0, -6.0, 8.0])), 5.0); // from the ball
/// assert_eq!(star.distance(Vector([3.0, 8.0, 0.0])), 4.0); // from the rim at (3, 4)
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct DeathStar(Moon);

impl DeathStar {
    /// A ball of `radius` without one of `cut_radius` that is `distance` above it,
    /// from centre to centre [m].
    ///
    /// # Errors
    ///
    /// If a length is not positive, or the spheres do not cross.
    pub fn new(radius: f64, cut_radius: f64, distance: f64) -> Result<Self, ShapeError> {
        positive("radius", radius, Unit::Metre)?;
        positive("cut_radius", cut_radius, Unit::Metre)?;
        positive("distance", distance, Unit::Metre)?;
        let (least, most) = ((radius - cut_radius).abs(), radius + cut_radius);
        if distance <= least || distance >= most {
            let rule = format!(
                "between the difference and the sum of the radii, {least} m and {most} m"
            );
            return Err(ShapeError::number("distance", rule, distance, Unit::Metre));
        }
        Ok(Self(Moon::new(radius, cut_radius, distance)))
    }
}

impl Kernel<3> for DeathStar {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        self.0.distance(in_profile(p))
    }

    #[inline(always)]
    fn bounded_by_steepness(&self) -> Option<Evaluations> {
        Some(Evaluations { operations: OPERATIONS, size: self.0.size() })
    }

    fn promise(&self) -> Promise<3> {
        let bounds = self.0.turned_bounds();
        Promise {
            symmetric: [true, false, true],
            ..Promise::exact(Some(bounds), OPERATIONS, self.0.size())
        }
    }
}

primitive! {
    DeathStar, death_star, 3,
    about: "A ball about the origin with a ball-shaped bite from above.",
    origin: "at the centre of its ball; hollow upwards",
    parameters: {
        radius: Length = "the radius of the ball" => |kernel| kernel.0.radius,
        cut_radius: Length = "the radius of the bite" => |kernel| kernel.0.cut_radius,
        distance: Length = "from centre to centre, so that the spheres cross"
            => |kernel| kernel.0.distance,
    },
    marks: |kernel| sets::bite(kernel.radius(), kernel.cut_radius(), kernel.distance()),
    example: (0.9, 0.6, 1.1),
}

#[cfg(feature = "oracle")]
mod evidence {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;
    use crate::oracle::{Definition, Evidence, Row, arc, line, turned};

    impl Evidence<3> for SolidAngle {
        const SAMPLE: &'static str = r#"{ "radius": 0.06, "angle_degrees": 70 }"#;
        const GUIDE: &'static [Row] = &[Row::new("Solid Angle", "`radius`, `angle`", "exact")];

        fn definition(&self) -> Definition<3> {
            solid_angle(self.radius(), self.angle())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(1.0, std::f64::consts::TAU)]
        }
    }

    impl Evidence<3> for CutBall {
        const SAMPLE: &'static str = r#"{ "radius": 0.05, "cut_height": -0.02 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Cut Sphere", "`radius`, `cut_height`", "exact, convex")];

        fn definition(&self) -> Definition<3> {
            cut_ball(self.radius(), self.cut_height())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.5, -0.5)]
        }
    }

    impl Evidence<3> for CutHollowSphere {
        const SAMPLE: &'static str =
            r#"{ "radius": 0.045, "cut_height": 0.02, "thickness": 0.01 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Cut Hollow Sphere", "`radius`, `cut_height`, `thickness`", "exact")];

        fn definition(&self) -> Definition<3> {
            bowl(self.radius(), self.cut_height(), self.thickness())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.5, 0.4, 0.75)]
        }
    }

    impl Evidence<3> for DeathStar {
        const SAMPLE: &'static str =
            r#"{ "radius": 0.05, "cut_radius": 0.035, "distance": 0.055 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Death Star", "`radius`, `cut_radius`, `distance`", "exact")];

        fn definition(&self) -> Definition<3> {
            death_star(self.radius(), self.cut_radius(), self.distance())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.5, 0.25, 0.25), Self::new(0.5, 0.25, 0.75)]
        }
    }

    fn solid_angle(radius: f64, angle: f64) -> Definition<3> {
        let half = 0.5 * angle;
        let rim = [radius * half.sin(), radius * half.cos()];
        let profile =
            vec![line([0.0; 2], rim), arc([0.0; 2], radius, [FRAC_PI_2 - half, FRAC_PI_2])];
        turned(profile, radius, move |rho, y| rho.hypot(y) < radius && rho.atan2(y) < half)
    }

    fn cut_ball(radius: f64, height: f64) -> Definition<3> {
        let rim = (height / radius).asin();
        let width = radius * rim.cos();
        let profile =
            vec![arc([0.0; 2], radius, [rim, FRAC_PI_2]), line([0.0, height], [width, height])];
        turned(profile, radius, move |rho, y| rho.hypot(y) < radius && y > height)
    }

    /// The middle of the wall and its rim, thickened.
    fn bowl(radius: f64, height: f64, thickness: f64) -> Definition<3> {
        let (rim, half) = ((height / radius).asin(), 0.5 * thickness);
        let on_rim = [radius * rim.cos(), radius * rim.sin()];
        let profile = vec![
            arc([0.0; 2], radius - half, [-FRAC_PI_2, rim]),
            arc([0.0; 2], radius + half, [-FRAC_PI_2, rim]),
            arc(on_rim, half, [rim, rim + PI]),
        ];
        turned(profile, radius + half, move |rho, y| {
            let angle = y.atan2(rho).min(rim);
            (rho - radius * angle.cos()).hypot(y - radius * angle.sin()) < half
        })
    }

    fn death_star(radius: f64, cut_radius: f64, distance: f64) -> Definition<3> {
        // By the cosine rule, about either centre.
        let opposite =
            |a: f64, b: f64, c: f64| ((b - c).mul_add(b + c, a * a) / (2.0 * a * b)).acos();
        let rim = FRAC_PI_2 - opposite(distance, radius, cut_radius);
        let bite = opposite(distance, cut_radius, radius) - FRAC_PI_2;
        let profile = vec![
            arc([0.0; 2], radius, [-FRAC_PI_2, rim]),
            arc([0.0, distance], cut_radius, [-FRAC_PI_2, bite]),
        ];
        turned(profile, radius, move |rho, y| {
            rho.hypot(y) < radius && rho.hypot(y - distance) > cut_radius
        })
    }
}
