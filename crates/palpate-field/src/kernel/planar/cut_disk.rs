// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Discs with a part taken off: by a line, by another disc.

use super::outline::{beside, bounds_about, intersection};
use crate::bounds::Aabb;
use crate::error::{ShapeError, Unit, finite, positive};
use crate::kernel::profile::CutDisc;
use crate::kernel::{Kernel, primitive, tangent_model};
use crate::promise::Promise;
use crate::scalar::{Model, Scalar};
use crate::vector::Vector;

/// How many rounded operations the distance of a cut disc takes at most.
const OPERATIONS: f64 = 6.0;

/// What is above a line of a disc about the origin. Exact.
///
/// Folded to `x ≥ 0`, it is the profile that a [`CutBall`](crate::kernel::CutBall)
/// turns.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::CutDisk};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let cap = Shape::from_kernel(CutDisk::new(5.0, 3.0)?);
/// assert_eq!(cap.distance(Vector([0.0, 7.0])), 2.0); // above
/// assert_eq!(cap.distance(Vector([-2.0, 0.0])), 3.0); // below
/// assert!((cap.distance(Vector([7.0, -1.0])) - 5.0).abs() < 1e-14); // from (4, 3)
/// assert_eq!(cap.distance(Vector([0.0, 3.5])), -0.5);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct CutDisk {
    radius: f64,
    cut_height: f64,
    half: CutDisc,
}

impl CutDisk {
    /// A disc of `radius`, without what is below `cut_height` above its centre [m].
    ///
    /// # Errors
    ///
    /// If the radius is not positive, or the cut does not meet the disc.
    pub fn new(radius: f64, cut_height: f64) -> Result<Self, ShapeError> {
        positive("radius", radius, Unit::Metre)?;
        finite("cut_height", cut_height, Unit::Metre)?;
        if cut_height.abs() >= radius {
            let rule = format!("less than the radius, {radius} m, above or below the centre");
            return Err(ShapeError::number("cut_height", rule, cut_height, Unit::Metre));
        }
        Ok(Self { radius, cut_height, half: CutDisc::new(radius, cut_height) })
    }
}

impl Kernel<2> for CutDisk {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        self.half.distance([p.0[0].abs(), p.0[1]])
    }

    #[inline(always)]
    fn model(&self, cell: Vector<Model, 2>) -> Model {
        tangent_model(self, cell, OPERATIONS, self.radius)
    }

    fn promise(&self) -> Promise<2> {
        let (radius, half_width) = (self.radius, self.half.half_width());
        let below = self.cut_height < 0.0;
        let widest = if below { radius } else { half_width };
        let aabb =
            Aabb { min: Vector([-widest, self.cut_height]), max: Vector([widest, radius]) };
        let aabb = aabb.grown(4.0 * f64::EPSILON * radius);
        let bounds = if below {
            bounds_about(aabb, 0.0, radius)
        } else {
            bounds_about(aabb, self.cut_height, half_width + 4.0 * f64::EPSILON * radius)
        };
        Promise {
            symmetric: [true, false],
            ..Promise::exact_convex(Some(bounds), OPERATIONS, radius)
        }
    }
}

primitive! {
    CutDisk, "cut_disk", 2,
    about: "What is above a line of a disc.",
    model: Tangent,
    parameters: {
        radius: Length = "the radius of the disc",
        cut_height: Coordinate = "how far above the centre the cut is",
    },
    example: (0.9, -0.3),
}

/// How many rounded operations the distance of a moon takes at most.
const MOON_OPERATIONS: f64 = 6.0;

/// A disc about the origin without a second disc above it on the y axis: a crescent
/// with its horns up. Exact.
///
/// # Derivation
///
/// Fold to `x ≥ 0`; the circles meet at the tip of the horn. Inside, the nearer
/// circle decides. Outside, the nearest point is on an arc, if the direction from its
/// centre is one of the arc's, or it is the tip. That a direction is past the end of
/// an arc shows in the sign of the offset from the line through centre and tip.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Moon};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// // The horns' tips are at (±4, 3).
/// let moon = Shape::from_kernel(Moon::new(5.0, 4.0, 3.0)?);
/// assert_eq!(moon.distance(Vector([0.0, -6.0])), 1.0); // below
/// assert_eq!(moon.distance(Vector([0.0, 1.0])), 2.0); // between the horns
/// assert!((moon.distance(Vector([-7.0, 7.0])) - 5.0).abs() < 1e-14); // from a tip
/// assert_eq!(moon.distance(Vector([0.0, -3.0])), -2.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Moon {
    radius: f64,
    cut_radius: f64,
    distance: f64,
    /// The tip of the right horn.
    tip: [f64; 2],
}

impl Moon {
    /// A disc of `radius` without one of `cut_radius` whose centre is `distance`
    /// above its own [m].
    ///
    /// # Errors
    ///
    /// If a length is not positive, or the circles do not cross.
    pub fn new(radius: f64, cut_radius: f64, distance: f64) -> Result<Self, ShapeError> {
        positive("radius", radius, Unit::Metre)?;
        positive("cut_radius", cut_radius, Unit::Metre)?;
        positive("distance", distance, Unit::Metre)?;
        let (least, most) = ((radius - cut_radius).abs(), radius + cut_radius);
        if !(least < distance && distance < most) {
            let rule = format!("between {least} m and {most} m, where the circles cross");
            return Err(ShapeError::number("distance", rule, distance, Unit::Metre));
        }
        // How far along the line to the other centre the circles cross, from the
        // centre of the smaller, where less cancels: (r² − R² + d²)/2d.
        let (small, large) = (radius.min(cut_radius), radius.max(cut_radius));
        let excess = ((distance - large) / distance) * (distance + large);
        let along = 0.5 * (excess + small * (small / distance));
        let along = along.clamp(-small, small);
        let across = (small - along).sqrt() * (small + along).sqrt();
        let height = if radius <= cut_radius { along } else { distance - along };
        Ok(Self { radius, cut_radius, distance, tip: [across, height] })
    }

    fn size(&self) -> f64 {
        self.radius.max(self.cut_radius) + self.distance
    }
}

impl Kernel<2> for Moon {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        let [x, y] = [p.0[0].abs(), p.0[1]];
        let below = S::constant(self.distance) - y;
        let disc = p.norm() - S::constant(self.radius);
        // `below` first: from its centre, straight down leads to the arc.
        let cut = S::constant(self.cut_radius) - S::norm([below, x]);

        let [tip_x, tip_y] = self.tip;
        let tip = S::norm([x - S::constant(tip_x), y - S::constant(tip_y)]);
        let across = [-tip_y / self.radius, tip_x / self.radius];
        let past_outer = Vector([x, y]).dot_constant(&across);
        let across = [(self.distance - tip_y) / self.cut_radius, -tip_x / self.cut_radius];
        let past_inner = Vector([x, below]).dot_constant(&across);
        let pieces = beside(disc, past_outer, beside(cut, past_inner, tip));
        intersection(disc.max(cut), pieces, self.size())
    }

    fn promise(&self) -> Promise<2> {
        let [tip_x, tip_y] = self.tip;
        let radius = self.radius;
        let widest = if tip_y > 0.0 { radius } else { tip_x };
        let margin = 8.0 * f64::EPSILON * self.size();
        let aabb = Aabb { min: Vector([-widest, -radius]), max: Vector([widest, tip_y]) };
        let aabb = aabb.grown(margin);
        let bounds = if tip_y > 0.0 {
            bounds_about(aabb, 0.0, radius)
        } else {
            bounds_about(aabb, tip_y, tip_x + margin)
        };
        Promise {
            symmetric: [true, false],
            ..Promise::exact(Some(bounds), MOON_OPERATIONS, self.size())
        }
    }
}

primitive! {
    Moon, "moon", 2,
    about: "A disc without a second one above it: a crescent with its horns up.",
    model: ClosedForm,
    parameters: {
        radius: Length = "the radius of the disc",
        cut_radius: Length = "the radius of the disc that is taken off",
        distance: Length = "how far above the disc's centre the other's is",
    },
    example: (0.9, 0.7, 0.45),
}
