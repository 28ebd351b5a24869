// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Forces in free space: virtual fixtures that a hand follows, wells and slopes that attract
//! it.
//!
//! Source: Rosenberg, "Virtual fixtures: perceptual tools for telerobotic manipulation" (1993),
//! who compares them with a ruler under a pencil.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod curve;
pub(crate) mod limit;
mod slope;
mod target;
mod well;

use palpate_field::{Point, Vector};

use crate::error::HapticsError;
pub use curve::Curve;
use limit::{Motion, damped};
use palpate_device::NumberError;
use palpate_safety::Impedance;
pub use slope::Slope;
use target::Target;

/// The time over which the force of a guide rises that engages within its snap distance [s]: all of it
/// at once is a blow.
const SNAP_TIME: f64 = 0.02;

/// Stiffness, damping and limits of a guide.
///
/// ```
/// use palpate_haptics::GuideOptions;
///
/// let options = GuideOptions {
///     snap_distance: 0.01,
///     release_distance: Some(0.02),
///     ..GuideOptions::default()
/// };
/// assert_eq!((options.snap_distance, options.release_distance), (0.01, Some(0.02)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GuideOptions {
    /// Force per metre of distance from the guide [N/m]; positive.
    pub stiffness: f64,
    /// Force per constrained velocity [N·s/m]; zero or more.
    pub damping: f64,
    /// Distance at which the guide engages [m]; infinite to engage everywhere.
    pub snap_distance: f64,
    /// Distance at which an engaged guide releases the hand [m], at least the snap distance;
    /// `None` means the snap distance.
    pub release_distance: Option<f64>,
    /// The largest force [N]; infinite for no limit.
    pub max_force: f64,
}

impl Default for GuideOptions {
    /// 300 N/m and 1 N·s/m at any distance, at most 2 N: firm to a finger, but a deliberate
    /// push overcomes it.
    fn default() -> Self {
        Self {
            stiffness: 300.0,
            damping: 1.0,
            snap_distance: f64::INFINITY,
            release_distance: None,
            max_force: 2.0,
        }
    }
}

impl GuideOptions {
    fn checked(self) -> Result<Self, HapticsError> {
        NumberError::check_positive("stiffness", self.stiffness, "N/m")?;
        NumberError::check_not_negative("damping", self.damping, "N·s/m")?;
        NumberError::check_positive_or_infinite("snap_distance", self.snap_distance, "m")?;
        NumberError::check_positive_or_infinite("max_force", self.max_force, "N")?;
        // Written so that NaN fails.
        if self.release() >= self.snap_distance {
            return Ok(self);
        }
        let (parameter, rule) = ("release_distance", "at least the snap distance");
        Err(HapticsError::Number(NumberError::new(parameter, rule, self.release(), "m")))
    }

    fn release(&self) -> f64 {
        self.release_distance.unwrap_or(self.snap_distance)
    }
}

/// Refuses a point that is not finite.
fn finite(parameter: &'static str, point: Point<3>) -> Result<Point<3>, HapticsError> {
    match point.0.iter().find(|x| !x.is_finite()) {
        None => Ok(point),
        Some(value) => {
            let (rule, unit) = ("finite", "m");
            Err(HapticsError::Number(NumberError::new(parameter, rule, *value, unit)))
        }
    }
}

/// The unit vector along `direction`; an error if `direction` is zero or not finite.
fn unit(
    parameter: &'static str,
    direction: Vector<f64, 3>,
) -> Result<Vector<f64, 3>, HapticsError> {
    direction.normalized().ok_or(HapticsError::Number(NumberError::new(
        parameter,
        "a finite direction",
        direction.norm(),
        "",
    )))
}

/// A force on the hand in free space: towards a point, line, plane or curve, into a well, or
/// down a field.
///
/// With the closest point c of the target, and the hand at x with velocity v,
///
/// ```text
/// F = min(K, F_max / ‖c − x‖) (c − x) − λ B P v
/// ```
///
/// where P projects on the constrained directions: all directions at a point and at the ends of
/// a segment or curve, those across a line or curve elsewhere, the normal of a plane. The
/// spring alone never exceeds the largest force, and λ ≤ 1 is the largest factor for which the
/// sum does not. So the spring is conservative, and the damper, `−λ B P v · v ≤ 0`, dissipates.
///
/// The spring force is zero on the target and continuous wherever the closest point is. With a
/// snap distance, the force jumps by at most `min(K d, F_max)` where the guide engages and
/// where it releases at distance d; in a servo, the force of a guide that engages rises over
/// 20 ms. Because the release distance is at least the snap distance,
/// the energy that the hand gains at the snap is at most the energy that it pays until the
/// release.
///
/// # Examples
///
/// ```
/// use palpate_field::Vector;
/// use palpate_haptics::{Guide, GuideOptions};
///
/// # fn main() -> Result<(), palpate_haptics::HapticsError> {
/// let options = GuideOptions { stiffness: 256.0, damping: 2.0, ..GuideOptions::default() };
/// let ruler = Vector([1.0, 0.0, 0.0]);
/// let mut guide = Guide::along_line(Vector::ZERO, ruler, options)?;
///
/// // 1/256 m above the line, sliding along it and rising.
/// let force = guide.force(Vector([3.0, 0.00390625, 0.0]), Vector([0.5, 0.25, 0.0]));
/// assert_eq!(force, Vector([0.0, -1.5, 0.0]));
/// // The largest force limits the spring.
/// assert_eq!(guide.force(Vector([0.0, 1.0, 0.0]), Vector::ZERO), Vector([0.0, -2.0, 0.0]));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Guide {
    kind: Kind,
    options: GuideOptions,
    engaged: bool,
    /// The rendered part of the force of a guide that snapped, in [0, 1].
    snapped: f64,
    /// The force of the last tick [N].
    last: Vector<f64, 3>,
}

#[derive(Clone, Debug)]
enum Kind {
    Target(Target),
    Well(well::Well),
    Slope(Slope),
}

impl Guide {
    /// A guide towards `point` [m].
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if an option is outside its range or a coordinate is not
    /// finite.
    pub fn to_point(
        point: impl Into<Point<3>>,
        options: GuideOptions,
    ) -> Result<Self, HapticsError> {
        Self::of(Kind::Target(Target::Point(finite("point", point.into())?)), options)
    }

    /// A guide towards the line through the point `through` [m] along `direction`, a vector of
    /// any length but zero.
    ///
    /// # Errors
    ///
    /// As [`to_point`](Self::to_point), and if `direction` is zero.
    pub fn along_line(
        through: impl Into<Point<3>>,
        direction: impl Into<Vector<f64, 3>>,
        options: GuideOptions,
    ) -> Result<Self, HapticsError> {
        let through = finite("through", through.into())?;
        let direction = unit("direction", direction.into())?;
        Self::of(Kind::Target(Target::Line { through, direction }), options)
    }

    /// A guide towards the segment from `from` to `to` [m].
    ///
    /// # Errors
    ///
    /// As [`to_point`](Self::to_point), and if the ends coincide.
    pub fn along_segment(
        from: impl Into<Point<3>>,
        to: impl Into<Point<3>>,
        options: GuideOptions,
    ) -> Result<Self, HapticsError> {
        Self::along_curve(Curve::polyline(&[from.into(), to.into()])?, options)
    }

    /// A guide towards the plane (in 2D the line) through `through` [m] with the `normal`, a
    /// vector of any length but zero.
    ///
    /// # Errors
    ///
    /// As [`to_point`](Self::to_point), and if `normal` is zero.
    pub fn on_plane(
        through: impl Into<Point<3>>,
        normal: impl Into<Vector<f64, 3>>,
        options: GuideOptions,
    ) -> Result<Self, HapticsError> {
        let through = finite("through", through.into())?;
        let normal = unit("normal", normal.into())?;
        Self::of(Kind::Target(Target::Plane { through, normal }), options)
    }

    /// A guide towards `curve`.
    ///
    /// # Errors
    ///
    /// As [`to_point`](Self::to_point).
    #[inline(never)]
    pub fn along_curve(curve: Curve, options: GuideOptions) -> Result<Self, HapticsError> {
        Self::of(Kind::Target(Target::Curve(curve)), options)
    }

    /// A guide towards `centre` [m] that acts within `reach` [m]. With distance, the pull rises
    /// by the stiffness to the largest force, then falls linearly to zero at the reach.
    ///
    /// The pull is continuous and central, so it does no work over a closed path. The damper
    /// acts against all motion, at full strength up to the largest pull, and falls with the
    /// pull beyond. Snap and release distances are ignored.
    ///
    /// # Errors
    ///
    /// As [`to_point`](Self::to_point), and if the largest force is not finite, or the reach is
    /// not beyond `max_force / stiffness`, the distance of the largest pull.
    ///
    /// ```
    /// use palpate_field::Vector;
    /// use palpate_haptics::{Guide, GuideOptions};
    ///
    /// # fn main() -> Result<(), palpate_haptics::HapticsError> {
    /// let options = GuideOptions { stiffness: 128.0, ..GuideOptions::default() };
    /// let mut well = Guide::well(Vector::ZERO, 0.046875, options)?;
    /// let mut pull = |x: f64| well.force(Vector([x, 0.0, 0.0]), Vector::ZERO)[0];
    /// assert_eq!(pull(0.0078125), -1.0); // half way to 1/64 m
    /// assert_eq!(pull(0.015625), -2.0);
    /// assert_eq!(pull(0.03125), -1.0); // half way from there to the reach, 3/64 m
    /// assert_eq!(pull(0.046875), 0.0);
    /// # Ok(())
    /// # }
    /// ```
    pub fn well(
        centre: impl Into<Point<3>>,
        reach: f64,
        options: GuideOptions,
    ) -> Result<Self, HapticsError> {
        let options = options.checked()?;
        Self::of(Kind::Well(well::Well::new(centre.into(), reach, &options)?), options)
    }

    /// A guide down the field of a shape within a band of distances: see [`Slope`].
    ///
    /// Only the damping and the largest force of the options are used.
    ///
    /// # Errors
    ///
    /// As [`to_point`](Self::to_point).
    #[inline(never)]
    pub fn down(slope: Slope, options: GuideOptions) -> Result<Self, HapticsError> {
        Self::of(Kind::Slope(slope), options)
    }

    fn of(kind: Kind, options: GuideOptions) -> Result<Self, HapticsError> {
        Ok(Self {
            kind,
            options: options.checked()?,
            engaged: false,
            snapped: 1.0,
            last: Vector::ZERO,
        })
    }

    /// The options.
    #[must_use]
    pub fn options(&self) -> &GuideOptions {
        &self.options
    }

    /// The steepest change of the force [N/m] and the damping [N·s/m].
    pub(crate) fn impedance(&self) -> Result<Impedance, HapticsError> {
        let stiffness = match &self.kind {
            Kind::Target(_) | Kind::Well(_) => self.options.stiffness,
            Kind::Slope(slope) => slope.stiffness(),
        };
        Ok(Impedance::new(stiffness.max(f64::MIN_POSITIVE), self.options.damping)?)
    }

    /// This guide with these parts of its stiffness and damping. A well or slope keeps its shape and
    /// pulls less.
    pub(crate) fn softened(self, stiffness: f64, damping: f64) -> Self {
        let options = GuideOptions {
            stiffness: self.options.stiffness * stiffness,
            damping: self.options.damping * damping,
            ..self.options
        };
        let kind = match self.kind {
            Kind::Target(target) => Kind::Target(target),
            Kind::Well(well) => Kind::Well(well.scaled(stiffness)),
            Kind::Slope(slope) => Kind::Slope(slope.scaled(stiffness)),
        };
        Self { kind, options, ..self }
    }

    /// `true` if the guide held the hand in the last tick; for a well or slope, if the hand was
    /// within its reach or band.
    #[must_use]
    pub fn is_engaged(&self) -> bool {
        self.engaged
    }

    /// Lets go of the hand, as if it had never held it.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn let_go(&mut self) {
        (self.engaged, self.last) = (false, Vector::ZERO);
    }

    /// The force on a hand at `position` [m] that moves at `velocity` [m/s], in world
    /// coordinates [N]: finite, and at most the largest force. A number that is not finite
    /// releases the hand, and the force is zero.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic unless a custom field does. A
    /// curve costs at most 1024 segments, a slope one evaluation of its shape.
    #[inline(never)]
    pub fn force(&mut self, position: Point<3>, velocity: Vector<f64, 3>) -> Vector<f64, 3> {
        let motion = self.motion(position, velocity);
        self.engaged = motion.is_some();
        let force = motion.map(|motion| damped(&motion, self.options.max_force));
        self.last = force.filter(Vector::is_finite).unwrap_or(Vector::ZERO);
        self.last
    }

    /// As [`force`](Self::force) in a servo of `rate` [Hz]: the force of a guide that engages rises
    /// over [`SNAP_TIME`].
    ///
    /// Real-time: as `force`.
    #[inline]
    pub(crate) fn rising_force(
        &mut self,
        position: Point<3>,
        velocity: Vector<f64, 3>,
        rate: f64,
    ) -> Vector<f64, 3> {
        let was_engaged = self.engaged;
        let force = self.force(position, velocity);
        let snaps =
            matches!(self.kind, Kind::Target(_)) && self.options.snap_distance < f64::INFINITY;
        if snaps && self.engaged && !was_engaged {
            self.snapped = 0.0;
        }
        if self.snapped < 1.0 {
            self.snapped = (self.snapped + 1.0 / (SNAP_TIME * rate)).min(1.0);
            self.last = force * self.snapped;
        }
        self.last
    }

    /// The force that [`force`](Self::force) gave last [N]; zero before.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    ///
    /// ```
    /// use palpate_field::Vector;
    /// use palpate_haptics::{Guide, GuideOptions};
    /// let mut guide = Guide::to_point([0.0, 0.0, 0.0], GuideOptions::default())?;
    /// assert_eq!(guide.last_force(), Vector::ZERO);
    /// let force = guide.force(Vector([0.0, 0.001, 0.0]), Vector::ZERO);
    /// assert_eq!(guide.last_force(), force);
    /// # Ok::<(), palpate_haptics::HapticsError>(())
    /// ```
    #[must_use]
    pub fn last_force(&self) -> Vector<f64, 3> {
        self.last
    }

    /// Spring and damper, without the limit; `None` where the guide does not act.
    fn motion(&self, position: Point<3>, velocity: Vector<f64, 3>) -> Option<Motion> {
        if !position.is_finite() || !velocity.is_finite() {
            return None;
        }
        let GuideOptions { stiffness, damping, .. } = self.options;
        match &self.kind {
            Kind::Target(target) => {
                let closest = target.closest(position);
                let off = closest.point - position;
                let o = &self.options;
                let hold = if self.engaged { o.release() } else { o.snap_distance };
                // Written so that NaN releases the hand.
                let holds = off.norm() <= hold;
                let damper = closest.constrained(velocity) * -damping;
                holds.then(|| Motion { spring: off * stiffness, damper })
            }
            Kind::Well(well) => well.pull(position).map(|(pull, fade)| Motion {
                spring: pull,
                damper: velocity * (-damping * fade),
            }),
            Kind::Slope(slope) => slope.motion(position, velocity, damping),
        }
    }
}
