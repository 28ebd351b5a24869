// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Cylinders and cones between two points.

use super::{CappedCone, Cylinder};
use crate::bounds::{Aabb, Bounds};
use crate::error::{ShapeError, Unit, not_negative, positive};
use crate::kernel::between::Between;
use crate::kernel::mark::{Mark, across};
use crate::kernel::{Kernel, primitive};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Scalar};
use crate::vector::{Point, Vector};

/// The bounds of the hull of two discs across the frame's axis, with the given radii at its
/// start and end.
fn bounds_of_discs(between: &Between<3>, [start, end]: [f64; 2]) -> Bounds<3> {
    let (pose, half_length) = (between.pose(), between.half_length());
    let direction = between.direction();
    let disc = |along: f64, radius: f64| {
        let centre = pose.transform_point(Vector([0.0, along, 0.0]));
        let reach = |i: usize| radius * direction[(i + 1) % 3].hypot(direction[(i + 2) % 3]);
        let half = Vector(std::array::from_fn(reach));
        Aabb { min: centre - half, max: centre + half }
    };
    let aabb = disc(-half_length, start).union(&disc(half_length, end));
    let radius = half_length.hypot(start.max(end)) * (1.0 + 4.0 * f64::EPSILON);
    let around = Bounds::centred(Vector::ZERO, radius).placed(pose);
    let slack = 8.0 * f64::EPSILON * around.radius_about_origin();
    Bounds { aabb: aabb.grown(slack), ..around }
}

/// A cylinder with flat ends between two points. Exact.
///
/// A [`Cylinder`] along the line between the points.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::CylinderBetween};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let (from, to) = (Vector([1.0, 0.0, 0.0]), Vector([5.0, 0.0, 0.0]));
/// let rod = Shape::from_kernel(CylinderBetween::new(from, to, 2.0)?);
/// assert_eq!(rod.distance(Vector([3.0, 4.0, 3.0])), 3.0); // beside it
/// assert_eq!(rod.distance(Vector([8.0, 6.0, 0.0])), 5.0); // past the rim
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct CylinderBetween {
    cylinder: Cylinder,
    radius: f64,
    between: Between<3>,
}

impl CylinderBetween {
    /// A cylinder of `radius` [m], the middles of its ends at two points [m].
    ///
    /// # Errors
    ///
    /// If the radius is not positive, a coordinate not finite, or the points are the same.
    pub fn new(from: Point<3>, to: Point<3>, radius: f64) -> Result<Self, ShapeError> {
        let between = Between::apart(from, to)?;
        let cylinder = Cylinder::new(radius, 2.0 * between.half_length())?;
        Ok(Self { cylinder, radius, between })
    }
}

impl Kernel<3> for CylinderBetween {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        self.cylinder.distance(self.between.to_body(p))
    }

    fn promise(&self) -> Promise<3> {
        let bounds = bounds_of_discs(&self.between, [self.radius; 2]);
        let placed = self.cylinder.promise().placed(self.between.pose());
        Promise { bounds: Some(bounds), ..placed }
    }
}

primitive! {
    CylinderBetween, cylinder_between, 3,
    about: "A cylinder with flat ends between two points.",
    origin: "given by its points",
    parameters: {
        from: Vector = "the middle of one end" => |kernel| kernel.between.from(),
        to: Vector = "the middle of the other end" => |kernel| kernel.between.to(),
        radius: Length = "the radius",
    },
    marks: |kernel| {
        let (from, to) = (kernel.from(), kernel.to());
        let middle = (from + to) * 0.5;
        let out = across(to - from) * kernel.radius;
        vec![
            Mark::position("from", from),
            Mark::position("to", to),
            Mark::length_between("radius", middle, middle + out),
        ]
    },
    example: (Vector([-0.5, -0.4, 0.2]), Vector([0.6, 0.3, -0.1]), 0.35),
}

/// A capped cone between two points. Exact.
///
/// A [`CappedCone`] along the line between the points.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::CappedConeBetween};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let (from, to) = (Vector([0.0, 0.0, 1.0]), Vector([0.0, 0.0, 5.0]));
/// let spike = Shape::from_kernel(CappedConeBetween::new(from, to, 3.0, 0.0)?);
/// assert_eq!(spike.distance(Vector([0.0, 3.0, 9.0])), 5.0); // from the tip
/// assert!((spike.distance(Vector([1.0, 1.0, 0.0])) - 1.0).abs() < 1e-15); // at the base
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct CappedConeBetween {
    cone: CappedCone,
    radii: [f64; 2],
    between: Between<3>,
}

impl CappedConeBetween {
    /// A cone with a radius at each of two points [m].
    ///
    /// # Errors
    ///
    /// If a radius is negative, both are zero, a coordinate is not finite, or the points are
    /// the same.
    pub fn new(
        from: Point<3>,
        to: Point<3>,
        from_radius: f64,
        to_radius: f64,
    ) -> Result<Self, ShapeError> {
        let between = Between::apart(from, to)?;
        not_negative("from_radius", from_radius, Unit::Metre)?;
        not_negative("to_radius", to_radius, Unit::Metre)?;
        positive("from_radius or to_radius", from_radius.max(to_radius), Unit::Metre)?;
        let cone = CappedCone::new(from_radius, to_radius, 2.0 * between.half_length())?;
        Ok(Self { cone, radii: [from_radius, to_radius], between })
    }
}

impl Kernel<3> for CappedConeBetween {
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
        let bounds = bounds_of_discs(&self.between, self.radii);
        let placed = self.cone.promise().placed(self.between.pose());
        Promise { bounds: Some(bounds), ..placed }
    }
}

primitive! {
    CappedConeBetween, capped_cone_between, 3,
    about: "A cone between two points, with a radius at each.",
    origin: "given by its points",
    parameters: {
        from: Vector = "the middle of one end" => |kernel| kernel.between.from(),
        to: Vector = "the middle of the other end" => |kernel| kernel.between.to(),
        from_radius: LengthOrZero = "the radius at one end" => |kernel| kernel.radii[0],
        to_radius: LengthOrZero = "the radius at the other end" => |kernel| kernel.radii[1],
    },
    marks: |kernel| {
        let (from, to) = (kernel.from(), kernel.to());
        let (out, along) = (across(to - from), (to - from).normalized().unwrap_or(Vector::ZERO));
        let radius = |name, at: Vector<f64, 3>, radius: f64| {
            Mark::length_between(name, at, at + out * radius)
        };
        vec![
            Mark::position("from", from),
            Mark::position("to", to),
            radius("from_radius", from, kernel.from_radius()).beside(-along),
            radius("to_radius", to, kernel.to_radius()).beside(along),
        ]
    },
    example: (Vector([-0.5, -0.4, 0.2]), Vector([0.6, 0.5, -0.1]), 0.45, 0.15),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, Row, between, capped_cone, cylinder};

    impl Evidence<3> for CylinderBetween {
        const SAMPLE: &'static str =
            r#"{ "from": [-0.03, -0.03, -0.01], "to": [0.03, 0.03, 0.01], "radius": 0.02 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Capped Cylinder, arbitrary",
            "`from`, `to`, `radius`",
            "exact, convex",
        )];

        fn definition(&self) -> Definition<3> {
            let (from, to) = (self.from(), self.to());
            let length = (to - from).norm();
            between(from, to, cylinder(self.radius(), 0.5 * length))
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(Vector([0.5, 0.25, 0.0]), Vector([0.5, 0.25, 0.0]), 0.1)]
        }
    }

    impl Evidence<3> for CappedConeBetween {
        const SAMPLE: &'static str = r#"{ "from": [-0.03, -0.03, -0.01], "to": [0.03, 0.03, 0.01],
             "from_radius": 0.025, "to_radius": 0.01 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Capped Cone, arbitrary",
            "`from`, `to`, `from_radius`, `to_radius`",
            "exact, convex",
        )];

        fn definition(&self) -> Definition<3> {
            let (from, to) = (self.from(), self.to());
            let length = (to - from).norm();
            between(from, to, capped_cone(self.from_radius(), self.to_radius(), length))
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![
                Self::new(Vector([0.5, 0.25, 0.0]), Vector([0.5, 0.25, 0.75]), -0.1, 0.2),
                Self::new(Vector([0.5, 0.25, 0.0]), Vector([0.5, 0.25, 0.75]), 0.0, 0.0),
            ]
        }
    }
}
