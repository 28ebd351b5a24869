// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What an identification finds.

use std::fmt;

use palpate_device::{DeviceProfile, TurningProfile};

/// An axis of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DeviceAxis {
    /// Motions along a coordinate axis: 0 for x.
    Along(usize),
    /// Rotations about a coordinate axis: 2 for z.
    About(usize),
}

impl DeviceAxis {
    /// The unit of a force along the axis, or of a torque about it.
    #[must_use]
    pub fn force_unit(self) -> &'static str {
        self.either("N", "N·m")
    }

    /// The unit of a length along the axis, or of an angle about it.
    #[must_use]
    pub fn length_unit(self) -> &'static str {
        self.either("m", "rad")
    }

    /// The unit of a mass, or of a moment of inertia.
    #[must_use]
    pub fn mass_unit(self) -> &'static str {
        self.either("kg", "kg·m²")
    }

    /// The unit of a damping.
    #[must_use]
    pub fn damping_unit(self) -> &'static str {
        self.either("N·s/m", "N·m·s/rad")
    }

    /// The unit of a stiffness.
    #[must_use]
    pub fn stiffness_unit(self) -> &'static str {
        self.either("N/m", "N·m/rad")
    }

    fn either(self, along: &'static str, about: &'static str) -> &'static str {
        match self {
            Self::Along(_) => along,
            Self::About(_) => about,
        }
    }
}

impl fmt::Display for DeviceAxis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (word, Self::Along(i) | Self::About(i)) = (self.either("along", "about"), self);
        match ["x", "y", "z"].get(*i) {
            Some(name) => write!(f, "{word} {name}"),
            None => write!(f, "{word} axis {i}"),
        }
    }
}

/// A number with its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Two standard deviations: the true number is this close 19 times out of 20, if the device
    /// moves as a mass with damping and friction.
    pub error: f64,
}

impl Estimate {
    /// The largest error of a number that counts as seen, as a part of it: three standard deviations
    /// of such a number are a tenth of it.
    pub const SEEN: f64 = 1.0 / 15.0;

    /// `true` if the error is at most a fifteenth of the number, which then is within a tenth of the
    /// true one but for one in 370.
    ///
    /// ```
    /// use palpate_sim::Estimate;
    ///
    /// assert!(Estimate { value: 2.5, error: 0.1 }.is_seen());
    /// assert!(!Estimate { value: 0.01, error: 0.1 }.is_seen());
    /// ```
    #[must_use]
    pub fn is_seen(&self) -> bool {
        // NaN is not seen.
        self.error <= Self::SEEN * self.value.abs()
    }

    /// The least number within the error, zero at least.
    #[must_use]
    pub fn least(&self) -> f64 {
        (self.value - self.error).max(0.0)
    }

    /// The largest number within the error.
    #[must_use]
    pub fn most(&self) -> f64 {
        self.value + self.error
    }
}

/// What the readings of an axis say about its encoder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EncoderStep {
    /// All readings lie in whole steps of this length [m], or angle [rad].
    Even(f64),
    /// Readings come in steps without a common length, as where the place of the handle follows
    /// from angles of joints; the largest seen in slow motion.
    Uneven(f64),
    /// No steps above this length are seen: the encoder step is 0.
    Unseen(f64),
}

impl EncoderStep {
    /// The step for a profile [m], or [rad]; zero if none is seen.
    #[must_use]
    pub fn size(self) -> f64 {
        match self {
            Self::Even(step) | Self::Uneven(step) => step,
            Self::Unseen(_) => 0.0,
        }
    }
}

/// What was found along an axis, or about it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct IdentifiedAxis {
    /// The axis.
    pub axis: DeviceAxis,
    /// Apparent mass [kg], or moment of inertia [kg·m²].
    pub mass: Estimate,
    /// Viscous damping [N·s/m], or [N·m·s/rad].
    pub damping: Estimate,
    /// Coulomb friction [N], or [N·m].
    pub friction: Estimate,
    /// The encoder's step.
    pub encoder_step: EncoderStep,
    /// A constant force on the handle beside the motors' [N], or torque [N·m]: weight that is not
    /// balanced.
    pub offset: Estimate,
    /// The softest spring by which a hand may hold the handle and be noticed [N/m], or [N·m/rad]: a
    /// softer one, or a hand that only drags, adds to mass and damping. `None` if the motions tell
    /// nothing of a spring.
    pub softest_spring: Option<f64>,
    /// The root mean square of the residuals of the model, over what encoder steps explain: about 1
    /// for a mass with damping and friction, at most [`GOOD_MISFIT`](Self::GOOD_MISFIT).
    pub misfit: f64,
    /// Strokes that were evaluated.
    pub strokes: u64,
    /// The time of all motions of the axis [s].
    pub time: f64,
}

/// What was found of a device.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Identified {
    /// The axes, those of translation first.
    pub axes: Vec<IdentifiedAxis>,
    /// `true` if the device senses its orientation but gives no torque, so that nothing is known
    /// about its rotation.
    pub is_turning_unknown: bool,
}

impl IdentifiedAxis {
    /// The largest [misfit](Self::misfit) that counts as good. Simulated devices that nobody holds reach
    /// 1.1. A hand whose spring is just too soft to be noticed gives up to 3; a hand with less than half
    /// of that spring stays below 1.4, and on a device of much friction any hand that is not noticed
    /// may.
    pub const GOOD_MISFIT: f64 = 1.4;

    /// `true` if the misfit is [good](Self::GOOD_MISFIT). If not, the errors of the numbers say
    /// nothing: a hand that holds the handle softly adds to mass and damping.
    #[must_use]
    pub fn is_fitted(&self) -> bool {
        self.misfit <= Self::GOOD_MISFIT
    }

    /// `true` if the misfit is good, and mass, damping and friction are
    /// [seen](Estimate::is_seen).
    #[must_use]
    pub fn is_seen(&self) -> bool {
        self.is_fitted()
            && [self.mass, self.damping, self.friction].iter().all(Estimate::is_seen)
    }

    /// `true` if the constant force beside the motors' is more than its error, and more than a
    /// fifth of the friction: the weight of the handle is not balanced.
    #[must_use]
    pub fn has_weight(&self) -> bool {
        let offset = self.offset.value.abs();
        offset > self.offset.error && offset > WEIGHT * self.friction.value
    }
}

/// The constant force that counts as weight, over the friction.
const WEIGHT: f64 = 0.2;

/// Names of the numbers that are found along axes.
const ALONG: [&str; 4] = ["mass", "least_damping", "friction", "encoder_step"];

/// Names of the numbers that are found about axes.
const ABOUT: [&str; 4] = ["inertia", "least_damping", "friction", "encoder_step"];

/// The numbers of the worst axis, in the order of their names.
struct Worst {
    /// Whether every axis moves as a mass with damping and friction.
    is_fitted: bool,
    mass: f64,
    damping: f64,
    /// The least and the most within the errors.
    friction: [f64; 2],
    /// Whether the least is at least half of the value on every axis.
    is_friction_known: bool,
    /// The largest step that is seen.
    step: f64,
    /// Whether each is seen on every axis.
    is_seen: [bool; 4],
}

impl Worst {
    /// The encoder step for a profile that states one: where none is seen, the one stated stays,
    /// since velocities depend on it.
    fn step_beside(&self, stated: f64) -> f64 {
        let [.., is_seen] = self.is_seen;
        if is_seen { self.step } else { self.step.max(stated) }
    }

    /// The mass or the damping that was `found` for a profile that states one: the less of both where
    /// a hand may have added to what was found.
    fn beside(&self, found: f64, stated: f64) -> f64 {
        if self.is_fitted { found } else { found.min(stated) }
    }

    /// The friction for a profile that states one, which stays as far as the errors allow where
    /// they are more than half of what was found.
    fn friction_beside(&self, stated: f64) -> f64 {
        let [least, most] = self.friction;
        match () {
            () if !self.is_fitted && stated > 0.0 => stated.min(most),
            () if self.is_friction_known => least,
            () if stated > 0.0 => stated.clamp(least, most),
            () => most,
        }
    }

    /// Those of the names whose numbers are found here, for a profile that states an encoder step.
    fn seen<'n>(&self, names: &[&'n str; 4], stated: f64) -> Vec<&'n str> {
        let [.., is_step_seen] = self.is_seen;
        let is_found = |(i, _): &(usize, &&str)| {
            self.is_seen.get(*i) == Some(&true)
                || *i == 3 && !is_step_seen && self.step > stated
        };
        names.iter().enumerate().filter(is_found).map(|(_, name)| *name).collect()
    }
}

impl Identified {
    /// `profile` with the numbers that were found, those of the worst axis: the least mass (a
    /// light handle moves most for a force), the largest encoder step, and the least damping and
    /// friction within their [errors](Estimate::least), because walls rely on them. `source` says in
    /// a few words what found them, and their names leave the list of those that are assumed.
    ///
    /// - A mass, damping or friction that is not [seen](Estimate::is_seen) on every axis counts as
    ///   assumed, and so do all three if an axis is not [fitted](IdentifiedAxis::is_fitted): mass and
    ///   damping are then the less of the one found and that of `profile`, and the friction is that of
    ///   `profile`, but no more than the error of the one found allows.
    /// - Where the error of a friction is more than half of it, that of `profile` stays, as far as the
    ///   error allows; the most that it allows if `profile` says zero, because a device of no friction
    ///   renders nothing in encoder steps.
    /// - The encoder step is the largest that is seen; where an axis shows none, that of `profile`
    ///   stays, as its source tells it, unless another axis shows a larger one.
    ///
    /// Limits of force, stiffness, damping, speed and workspace stay: motions without a hand do
    /// not tell them.
    #[must_use]
    pub fn profile(&self, profile: &DeviceProfile, source: &str) -> DeviceProfile {
        let mut found = profile.clone();
        if let Some(worst) = self.worst(|axis| matches!(axis, DeviceAxis::Along(_))) {
            let seen = worst.seen(&ALONG, profile.encoder_step);
            found = DeviceProfile {
                mass: worst.beside(worst.mass, profile.mass),
                least_damping: worst.beside(worst.damping, profile.least_damping),
                friction: worst.friction_beside(profile.friction),
                encoder_step: worst.step_beside(profile.encoder_step),
                assumed: assumed(&profile.assumed, &ALONG, &seen).into(),
                source: both(source, &seen, &profile.source).into(),
                ..found
            };
        }
        let about = self.worst(|axis| matches!(axis, DeviceAxis::About(_)));
        if let (Some(worst), Some(turning)) = (about, &profile.turning) {
            let seen = worst.seen(&ABOUT, turning.encoder_step);
            found.turning = Some(TurningProfile {
                inertia: worst.beside(worst.mass, turning.inertia),
                least_damping: worst.beside(worst.damping, turning.least_damping),
                friction: worst.friction_beside(turning.friction),
                encoder_step: worst.step_beside(turning.encoder_step),
                assumed: assumed(&turning.assumed, &ABOUT, &seen).into(),
                source: both(source, &seen, &turning.source).into(),
                ..turning.clone()
            });
        }
        found
    }

    fn worst(&self, is_meant: impl Fn(DeviceAxis) -> bool) -> Option<Worst> {
        let axes = || self.axes.iter().filter(|found| is_meant(found.axis));
        axes().next()?;
        let least = |of: fn(&IdentifiedAxis) -> f64| {
            rounded(axes().map(of).fold(f64::INFINITY, f64::min))
        };
        let is_fitted = axes().all(IdentifiedAxis::is_fitted);
        let are_seen = |of: fn(&IdentifiedAxis) -> Estimate| {
            is_fitted && axes().all(|axis| of(axis).is_seen())
        };
        Some(Worst {
            is_fitted,
            mass: least(|found| found.mass.value),
            damping: least(|found| found.damping.least()),
            friction: [
                least(|found| found.friction.least()),
                least(|found| found.friction.most()),
            ],
            is_friction_known: axes()
                .all(|found| found.friction.least() >= 0.5 * found.friction.value),
            step: rounded(axes().map(|found| found.encoder_step.size()).fold(0.0, f64::max)),
            is_seen: [
                are_seen(|found| found.mass),
                are_seen(|found| found.damping),
                are_seen(|found| found.friction),
                axes().all(|found| !matches!(found.encoder_step, EncoderStep::Unseen(_))),
            ],
        })
    }
}

/// A number with five digits, of which the errors leave fewer.
fn rounded(number: f64) -> f64 {
    format!("{number:.4e}").parse().unwrap_or(number)
}

/// The numbers that are assumed after those of these `names` were looked for, and some `seen`: in
/// the order of before, then those that a source told but the search does not.
fn assumed(
    before: &[&'static str],
    names: &[&'static str],
    seen: &[&'static str],
) -> Vec<&'static str> {
    let left = before.iter().filter(|name| !seen.contains(name));
    let unseen = names.iter().filter(|name| {
        // A step that is not found stays as its source tells it.
        **name != "encoder_step" && !seen.contains(name) && !before.contains(name)
    });
    left.chain(unseen).copied().collect()
}

/// What stands before the source of the numbers that nothing before names.
const ALL_ELSE: &str = "all else: ";

/// The source of the numbers that were `found`, and that of the others, which may have parts of its
/// own: names that are found anew leave them.
fn both(source: &str, found: &[&str], other: &str) -> String {
    if found.is_empty() {
        return other.to_owned();
    }
    let (parts, rest) = other.rsplit_once(ALL_ELSE).unwrap_or(("", other));
    let parts = parts.split("; ").filter_map(|part| {
        let (names, source) = part.split_once(": ")?;
        let names: Vec<_> = names.split(", ").filter(|name| !found.contains(name)).collect();
        (!names.is_empty()).then(|| format!("{}: {source}; ", names.join(", ")))
    });
    let parts: String = parts.collect();
    format!("{}: {source}; {parts}{ALL_ELSE}{rest}", found.join(", "))
}

#[cfg(test)]
mod tests {
    use super::both;

    /// Each identification once wrote its source before that of the one before.
    #[test]
    fn what_is_found_anew_leaves_the_source_of_before() {
        let first = both("strokes", &["mass", "friction"], "a data sheet");
        assert_eq!(first, "mass, friction: strokes; all else: a data sheet");
        let second = both("others", &["mass"], &first);
        assert_eq!(second, "mass: others; friction: strokes; all else: a data sheet");
        let third = both("a third", &["friction", "mass"], &second);
        assert_eq!(third, "friction, mass: a third; all else: a data sheet");
        assert_eq!(both("nothing", &[], &third), third);
    }
}
