// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Lenses of two equal arcs.

use super::outline::frame_between;
use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::mark::{Mark, sets};
use crate::kernel::profile::Lens;
use crate::kernel::{Kernel, primitive, tangent_model};
use crate::pose::Placement;
use crate::promise::Promise;
use crate::scalar::{AffineModel, Scalar};
use crate::vector::{Point, Vector};

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 8.0;

/// A lens about the origin, bounded by two equal arcs that meet in tips on the y
/// axis. Exact.
///
/// Folded to `x ≥ 0`, it is the profile that a
/// [`VesicaSegment`](crate::kernel::VesicaSegment) turns.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Vesica};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// // The arcs have a radius of 5 and centres at (±3, 0).
/// let lens = Shape::from_kernel(Vesica::new(4.0, 8.0)?);
/// assert_eq!(lens.distance(Vector([0.0, 0.0])), -2.0);
/// assert!((lens.distance(Vector([9.0, 5.0])) - 8.0).abs() < 1e-14); // 5-12-13
/// assert!((lens.distance(Vector([3.0, -8.0])) - 5.0).abs() < 1e-14); // from a tip
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Vesica {
    half_extents: [f64; 2],
    half: Lens,
}

impl Vesica {
    /// A lens of full `width` and `height` [m].
    ///
    /// # Errors
    ///
    /// If either is not positive, or the width more than the height.
    pub fn new(width: f64, height: f64) -> Result<Self, ShapeError> {
        let a = 0.5 * positive("width", width, Unit::Metre)?;
        let b = 0.5 * positive("height", height, Unit::Metre)?;
        if width > height {
            let rule = format!("at most the height, {height} m");
            return Err(ShapeError::number("width", rule, width, Unit::Metre));
        }
        Ok(Self { half_extents: [a, b], half: Lens::new(b, a) })
    }
}

impl Kernel<2> for Vesica {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        self.half.distance([p.0[0].abs(), p.0[1]])
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 2>) -> AffineModel<N> {
        tangent_model(self, cell, OPERATIONS, self.half.half_height())
    }

    fn promise(&self) -> Promise<2> {
        let half = Vector(self.half_extents);
        let bounds = Bounds::centred(half, half[1]);
        Promise::exact_convex(Some(bounds), OPERATIONS, self.half.half_height()).symmetric()
    }
}

primitive! {
    Vesica, vesica, 2,
    about: "A lens of two equal arcs that meet on the y axis.",
    origin: "centred; a tip up, a tip down",
    parameters: {
        width: Length = "the full width" => |kernel| 2.0 * kernel.half_extents[0],
        height: Length = "from tip to tip, at least the width"
            => |kernel| 2.0 * kernel.half_extents[1],
    },
    marks: |kernel| vec![
        Mark::width("width", 0.5 * kernel.width(), 0.0),
        Mark::height(kernel.height(), 0.0, 0.0),
    ],
    example: (0.9, 1.7),
}

/// A lens of two equal arcs between two points. Exact.
///
/// A [`Vesica`] along the line between the points.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::OrientedVesica};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let leaf = OrientedVesica::new(Vector([0.0, 0.0]), Vector([8.0, 0.0]), 4.0)?;
/// let leaf = Shape::from_kernel(leaf);
/// assert!((leaf.distance(Vector([4.0, 0.0])) + 2.0).abs() < 1e-15);
/// assert!((leaf.distance(Vector([12.0, 3.0])) - 5.0).abs() < 1e-14); // from `to`
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct OrientedVesica {
    from: Point<2>,
    to: Point<2>,
    lens: Vesica,
    placement: Placement<2>,
}

impl OrientedVesica {
    /// A lens from tip to tip, of full `width` across [m].
    ///
    /// # Errors
    ///
    /// If the points are the same, a coordinate is not finite, or the width not
    /// positive or more than their distance.
    pub fn new(from: Point<2>, to: Point<2>, width: f64) -> Result<Self, ShapeError> {
        positive("width", width, Unit::Metre)?;
        let (placement, half_length) = frame_between(from, to)?;
        Ok(Self { from, to, lens: Vesica::new(width, 2.0 * half_length)?, placement })
    }
}

impl Kernel<2> for OrientedVesica {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        self.lens.distance(self.placement.to_body(p))
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 2>) -> AffineModel<N> {
        self.lens.model(self.placement.to_body(cell))
    }

    fn promise(&self) -> Promise<2> {
        self.lens.promise().placed(&self.placement.world_from_body)
    }
}

primitive! {
    OrientedVesica, oriented_vesica, 2,
    about: "A lens of two equal arcs between two points.",
    origin: "given by its points",
    parameters: {
        from: Vector = "one tip",
        to: Vector = "the other tip",
        width: Length = "the full width across, at most the distance of the tips"
            => |kernel| kernel.lens.width(),
    },
    marks: |kernel| sets::between(kernel.from(), kernel.to(), kernel.width()),
    example: (Vector([-0.7, -0.4]), Vector([0.6, 0.5]), 0.6),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, Patch, Row};

    impl Evidence<2> for Vesica {
        const SAMPLE: &'static str = r#"{ "width": 0.05, "height": 0.1 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Vesica", "`width`, `height` from tip to tip", "exact, convex")];

        fn definition(&self) -> Definition<2> {
            let tip = Vector([0.0, 0.5 * self.height()]);
            lens(-tip, tip, self.width())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(0.5, 0.25)]
        }
    }

    impl Evidence<2> for OrientedVesica {
        const SAMPLE: &'static str =
            r#"{ "from": [-0.035, -0.035], "to": [0.035, 0.035], "width": 0.04 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Oriented Vesica", "`from`, `to`, `width`", "exact, convex")];

        fn definition(&self) -> Definition<2> {
            lens(self.from(), self.to(), self.width())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(Vector([0.25, 0.5]), Vector([1.25, 0.5]), 1.5)]
        }
    }

    /// The intersection of two discs whose circles meet at `from` and `to`, `width` across.
    fn lens(from: Point<2>, to: Point<2>, width: f64) -> Definition<2> {
        let along = (to - from).normalized().unwrap_or(Vector::unit(0));
        let across = Vector([along[1], -along[0]]);
        let half = 0.5 * (to - from).norm();
        // Half the angle that the arcs span, which is the angle between tangent and chord at the
        // tip.
        let span = 2.0 * (width / (2.0 * half)).atan();
        let r = half / span.sin();
        let middle = (from + to) * 0.5;
        let inward = r - 0.5 * width;
        let centres = [middle - across * inward, middle + across * inward];
        let boundary = [1.0, -1.0]
            .into_iter()
            .zip(centres)
            .map(|(sign, centre)| Patch::arc(centre, [across * sign, along], r, [-span, span]));
        let boundary = boundary.collect();
        Definition::new(boundary, move |p| centres.iter().all(|c| (p - *c).norm() < r))
    }
}
