// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Turned lenses.

use super::cylinder::in_profile;
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::between::Between;
use crate::kernel::mark::sets;
use crate::kernel::profile::Lens;
use crate::kernel::{Kernel, primitive, tangent_model};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Scalar};
use crate::vector::{Point, Vector};

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 8.0;

/// A spindle between two points: an arc from one to the other, turned about the line
/// between them. Exact.
///
/// Half the intersection of two discs, turned about the line between the points.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::VesicaSegment};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let (from, to) = (Vector([-4.0, 0.0, 0.0]), Vector([4.0, 0.0, 0.0]));
/// let seed = Shape::from_kernel(VesicaSegment::new(from, to, 4.0)?);
/// assert_eq!(seed.distance(Vector([0.0, 0.0, 0.0])), -2.0); // half the width
/// assert_eq!(seed.distance(Vector([0.0, 4.0, -3.0])), 3.0); // beside it
/// assert_eq!(seed.distance(Vector([16.0, 0.0, 5.0])), 13.0); // from the tip
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct VesicaSegment {
    width: f64,
    spindle: Spindle,
    between: Between<3>,
}

impl VesicaSegment {
    /// A spindle with its tips at two points, of full `width` in the middle [m].
    ///
    /// # Errors
    ///
    /// If the width is not positive or more than the distance of the points, or a
    /// coordinate not finite.
    pub fn new(from: Point<3>, to: Point<3>, width: f64) -> Result<Self, ShapeError> {
        let between = Between::apart(from, to)?;
        positive("width", width, Unit::Metre)?;
        let length = 2.0 * between.half_length();
        if width > length {
            let rule = format!("at most the distance of the tips, {length} m");
            return Err(ShapeError::number("width", rule, width, Unit::Metre));
        }
        let spindle = Spindle(Lens::new(between.half_length(), 0.5 * width));
        Ok(Self { width, spindle, between })
    }
}

impl Kernel<3> for VesicaSegment {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        self.spindle.distance(self.between.to_body(p))
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 3>) -> AffineModel<N> {
        self.spindle.model(self.between.to_body(cell))
    }

    fn promise(&self) -> Promise<3> {
        let pose = self.between.pose();
        let lens = &self.spindle.0;
        let bounds = lens.turned_bounds(self.between.direction(), pose.translation);
        Promise { bounds: Some(bounds), ..self.spindle.promise().placed(pose) }
    }
}

/// A spindle along the y axis about the origin.
#[derive(Clone, Debug)]
struct Spindle(Lens);

impl Kernel<3> for Spindle {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        self.0.distance(in_profile(p))
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 3>) -> AffineModel<N> {
        tangent_model(self, cell, OPERATIONS, self.0.half_height())
    }

    fn promise(&self) -> Promise<3> {
        let bounds = self.0.turned_bounds(Vector::unit(1), Vector::ZERO);
        Promise::exact_convex(Some(bounds), OPERATIONS, self.0.half_height()).symmetric()
    }
}

primitive! {
    VesicaSegment, vesica_segment, 3,
    about: "A spindle between two points: an arc turned about the line between them.",
    origin: "given by its points",
    parameters: {
        from: Vector = "one tip" => |kernel| kernel.between.from(),
        to: Vector = "the other tip" => |kernel| kernel.between.to(),
        width: Length = "the full width in the middle, at most the distance of the tips",
    },
    marks: |kernel| sets::between(kernel.from(), kernel.to(), kernel.width()),
    example: (Vector([-0.7, -0.5, 0.2]), Vector([0.8, 0.6, -0.1]), 0.7),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, Row, arc, between, turned};

    impl Evidence<3> for VesicaSegment {
        const SAMPLE: &'static str =
            r#"{ "from": [-0.035, -0.035, -0.01], "to": [0.035, 0.035, 0.01], "width": 0.04 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Revolved Vesica", "`from`, `to`, `width`", "exact, convex")];

        fn definition(&self) -> Definition<3> {
            let (from, to) = (self.from(), self.to());
            let length = (to - from).norm();
            between(from, to, spindle(length, self.width()))
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(Vector([0.5, 0.25, 0.0]), Vector([0.5, 0.25, 0.75]), 0.8)]
        }
    }

    fn spindle(length: f64, width: f64) -> Definition<3> {
        let (h, w) = (0.5 * length, 0.5 * width);
        let centre = (h - w) * (h + w) / (2.0 * w);
        let radius = centre + w;
        let tip = h.atan2(centre);
        turned(vec![arc([-centre, 0.0], radius, [-tip, tip])], w, move |rho, y| {
            (rho + centre).hypot(y) < radius
        })
    }
}
