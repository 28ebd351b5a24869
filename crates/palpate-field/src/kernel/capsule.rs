// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Capsules: all points within a radius of a segment.

use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, not_negative, positive};
use crate::kernel::between::Between;
use crate::kernel::mark::{Mark, across, at};
use crate::kernel::{Kernel, primitive};
use crate::promise::Promise;
use crate::scalar::Scalar;
use crate::vector::{Point, Vector};

/// The distance to the segment `|y| ≤ h` on the y axis.
///
/// `‖(x, max(|y| − h, 0), …)‖`: past an end the distance to it, beside the
/// segment the distance to the axis.
#[inline(always)]
fn to_segment<S: Scalar, const D: usize>(p: Vector<S, D>, half_length: f64) -> S {
    let mut q = p.0;
    q[1] = (p.0[1].abs() - S::constant(half_length)).max(S::constant(0.0));
    S::norm(q)
}

/// A rod with round ends along the y axis, `height` from tip to tip. Exact.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Capsule};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let rod = Shape::from_kernel(Capsule::new(0.5, 3.0)?);
/// assert_eq!(rod.distance(Vector([0.0, 2.5, 0.0])), 1.0); // above the tip
/// assert_eq!(rod.distance(Vector([3.0, 0.5, 4.0])), 4.5); // beside it
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Capsule {
    radius: f64,
    height: f64,
    half_length: f64,
}

impl Capsule {
    /// A capsule of `radius` and full `height` [m].
    ///
    /// # Errors
    ///
    /// If the radius is not positive, or the height less than twice the radius.
    pub fn new(radius: f64, height: f64) -> Result<Self, ShapeError> {
        positive("radius", radius, Unit::Metre)?;
        positive("height", height, Unit::Metre)?;
        if height < 2.0 * radius {
            let rule = format!("at least twice the radius, {} m", 2.0 * radius);
            return Err(ShapeError::number("height", rule, height, Unit::Metre));
        }
        Ok(Self { radius, height, half_length: 0.5 * height - radius })
    }
}

impl<const D: usize> Kernel<D> for Capsule {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, D>) -> S {
        to_segment(p, self.half_length) - S::constant(self.radius)
    }

    fn promise(&self) -> Promise<D> {
        promise(self.half_length, self.radius).symmetric()
    }
}

fn promise<const D: usize>(half_length: f64, radius: f64) -> Promise<D> {
    let mut half = Vector::constant(radius);
    half[1] += half_length;
    let bounds = Bounds::centred(half, half[1]);
    Promise { has_interior: radius > 0.0, ..Promise::exact_convex(Some(bounds), 5.0, half[1]) }
}

primitive! {
    Capsule, capsule, any,
    about: "A rod with round ends along the y axis.",
    origin: "centred; its length along y",
    parameters: {
        radius: Length = "the radius of the rod",
        height: Length = "the length from tip to tip",
    },
    marks: |kernel| {
        let [radius, height] = [kernel.radius(), kernel.height()];
        vec![
            Mark::from_origin("radius", at(radius, 0.0)),
            Mark::height(height, 0.0, 0.0),
        ]
    },
    example: (0.3, 1.4),
}

/// All points within `radius` of the segment between two points. Exact.
///
/// A [`Capsule`] along the line between the points. With a radius of zero it has no inside.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Segment};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let wire = Segment::new(Vector([1.0, 0.0]), Vector([1.0, 4.0]), 0.0)?;
/// let wire = Shape::from_kernel(wire);
/// assert_eq!(wire.distance(Vector([3.0, 2.0])), 2.0);
/// assert_eq!(wire.distance(Vector([1.0, 5.0])), 1.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Segment<const D: usize> {
    radius: f64,
    between: Between<D>,
}

impl<const D: usize> Segment<D> {
    /// The segment between two points [m], with a `radius` [m].
    ///
    /// # Errors
    ///
    /// If the radius is negative or a coordinate not finite.
    pub fn new(from: Point<D>, to: Point<D>, radius: f64) -> Result<Self, ShapeError> {
        let between = Between::new(from, to)?;
        not_negative("radius", radius, Unit::Metre)?;
        Ok(Self { radius, between })
    }
}

impl<const D: usize> Kernel<D> for Segment<D> {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, D>) -> S {
        to_segment(self.between.to_body(p), self.between.half_length())
            - S::constant(self.radius)
    }

    fn promise(&self) -> Promise<D> {
        promise(self.between.half_length(), self.radius).placed(self.between.pose())
    }
}

primitive! {
    Segment<D>, segment, any,
    about: "All points within a radius of the segment between two points.",
    origin: "given by its points",
    parameters: {
        from: Vector = "one end" => |kernel| kernel.between.from(),
        to: Vector = "the other end" => |kernel| kernel.between.to(),
        radius: LengthOrZero = "the radius, zero for a curve without inside",
    },
    marks: |kernel| {
        let (from, to) = (kernel.from(), kernel.to());
        vec![
            Mark::position("from", from),
            Mark::position("to", to),
            Mark::length_between("radius", to, to + across(to - from) * kernel.radius),
        ]
    },
    example: (
        Vector(std::array::from_fn(|i| [-0.4, -0.3, 0.2][i])),
        Vector(std::array::from_fn(|i| [0.5, 0.3, -0.1][i])),
        0.2,
    ),
}

#[cfg(feature = "oracle")]
mod evidence {
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    use super::*;
    use crate::oracle::{AXES, Definition, Evidence, Patch, Row, cross, from_segment};

    impl Evidence<2> for Segment<2> {
        const SAMPLE: &'static str =
            r#"{ "from": [-0.04, -0.03], "to": [0.04, 0.03], "radius": 0.01 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Segment", "`from`, `to`, `radius` 0", "exact, convex")];

        fn definition(&self) -> Definition<2> {
            stadium(self.from(), self.to(), self.radius())
        }
    }

    impl Evidence<3> for Segment<3> {
        const SAMPLE: &'static str =
            r#"{ "from": [-0.04, -0.03, -0.02], "to": [0.04, 0.03, 0.02], "radius": 0.01 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Capsule, arbitrary", "`from`, `to`, `radius`", "exact, convex")];

        fn definition(&self) -> Definition<3> {
            rod(self.from(), self.to(), self.radius())
        }
    }

    impl Evidence<2> for Capsule {
        const SAMPLE: &'static str = r#"{ "radius": 0.025, "height": 0.1 }"#;

        fn definition(&self) -> Definition<2> {
            let end = Vector([0.0, 0.5 * self.height() - self.radius()]);
            stadium(-end, end, self.radius())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.5, 0.25)]
        }
    }

    impl Evidence<3> for Capsule {
        const SAMPLE: &'static str = r#"{ "radius": 0.025, "height": 0.1 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Capsule, vertical",
            "`radius`, `height` from tip to tip",
            "exact, convex",
        )];

        fn definition(&self) -> Definition<3> {
            let end = Vector([0.0, 0.5 * self.height() - self.radius(), 0.0]);
            rod(-end, end, self.radius())
        }
    }

    /// All points within `radius` of a segment.
    fn stadium(a: Point<2>, b: Point<2>, radius: f64) -> Definition<2> {
        let along = (b - a).normalized().unwrap_or(AXES[0]);
        let across = Vector([-along[1], along[0]]);
        let caps = [(b, [along, across]), (a, [-along, -across])];
        let sides = [across * radius, across * -radius];
        let mut boundary: Vec<_> = sides.map(|s| Patch::segment(a + s, b + s)).into();
        boundary.extend(
            caps.map(|(end, axes)| Patch::arc(end, axes, radius, [-0.5 * PI, 0.5 * PI])),
        );
        Definition::new(boundary, move |p| from_segment(a, b, p) < radius)
    }

    /// All points within `r` of a segment.
    fn rod(a: Point<3>, b: Point<3>, r: f64) -> Definition<3> {
        let along = (b - a).normalized().unwrap_or(Vector::unit(1));
        let least =
            (0..3).min_by(|i, j| along[*i].abs().total_cmp(&along[*j].abs())).unwrap_or(0);
        let across = cross(along, Vector::unit(least)).normalized().unwrap_or(Vector::unit(0));
        let other = cross(along, across);
        let around = move |v: f64| across * (TAU * v).cos() + other * (TAU * v).sin();
        let mut boundary = vec![Patch::surface([(b - a).norm(), TAU * r], move |u, v| {
            a + (b - a) * u + around(v) * r
        })];
        for (end, out) in [(b, along), (a, -along)] {
            boundary.push(Patch::surface([FRAC_PI_2 * r, TAU * r], move |u, v| {
                let up = FRAC_PI_2 * u;
                end + out * (r * up.sin()) + around(v) * (r * up.cos())
            }));
        }
        Definition::new(boundary, move |p| from_segment(a, b, p) < r)
    }
}
