// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How stiff and how damped a material may be on a device.
//!
//! The rules bound the Z-width of a device, the range of impedances that it renders passively.
//! J. E. Colgate, G. G. Schenkel, "Passivity of a class of sampled-data systems: application to
//! haptic interfaces" (1997): `b > K T / 2 + |B|`. J. J. Abbott, A. M. Okamura, "Effects of
//! position quantization and sampling rate on virtual-wall passivity" (2005): `K ≤ min(2 b / T,
//! 2 f_c / Δ)`.
//!
//! Stiffness comes first, and damping takes what is left: a hand feels a soft wall at once, and
//! seldom misses a damper.

use std::sync::Arc;

use crate::error::SafetyError;
use crate::limits::{DeviceLimits, Impedance};
use crate::refused::{Refused, Requester};
use palpate_device::{DeviceProfile, NumberError};

/// The rate for which profiles state the largest stiffness and damping [Hz].
const STATED_RATE: f64 = 1000.0;

/// So many times the stiffness that a device renders is taken [as it is](Acceptance::AsIs).
///
/// The stage of limit cycles brings every device with a profile to rest against a wall of 20 times
/// its stiffness. Against 25 times, the force of some is at its limit in most of a swing: the swing
/// is then not that of a spring, which the stage looks for, and never ends.
pub const AS_IS_MOST: f64 = 20.0;

/// What a device renders of a material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Acceptance {
    /// What needs no controller in any hand: beside the rules of [`Device`](Self::Device), the
    /// physical damping alone dissipates what sampling generates, `K ≤ 2 b / T`.
    Passive,
    /// As stiff as the device's maker says it renders at this rate, and as damped as its physical
    /// damping leaves room for. The passivity controller takes care of what is left. If the maker
    /// states no largest stiffness, that of [`Passive`](Self::Passive) counts.
    #[default]
    Device,
    /// As it is, up to [`AS_IS_MOST`] times the stiffness of [`Device`](Self::Device), and refused
    /// beyond: the passivity controller and the stage of limit cycles keep the hand safe.
    AsIs,
}

/// A rule that limits what a device renders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Rule {
    /// `K ≤ 2 b / T`, Colgate and Schenkel (1997); with [`Acceptance::Passive`], and for devices
    /// without a largest stiffness.
    Passivity,
    /// `K ≤ 2 f_c / Δ`, Abbott and Okamura (2005).
    Quantisation,
    /// The device's largest stiffness at the servo's rate.
    MaxStiffness,
    /// `B ≤ b − K T / 2`: the damping that the stiffness leaves, Colgate and Schenkel (1997).
    DampingLeft,
    /// The device's largest damping at the servo's rate.
    MaxDamping,
    /// `κ ≤ 2 b / T`: passivity of rotation.
    AngularPassivity,
    /// `κ ≤ 2 f_c / Δ`: quantisation of rotation.
    AngularQuantisation,
    /// The device's largest angular stiffness at the servo's rate.
    MaxAngularStiffness,
    /// `β ≤ b − κ T / 2`: the damping that the stiffness leaves.
    AngularDampingLeft,
    /// The device's largest angular damping at the servo's rate.
    MaxAngularDamping,
}

impl Rule {
    /// The rule as a formula or sentence.
    #[must_use]
    pub fn condition(self) -> &'static str {
        match self {
            Self::Passivity => "K ≤ 2 b / T",
            Self::Quantisation => "K ≤ 2 f_c / Δ",
            Self::MaxStiffness => "K ≤ the device's largest stiffness at this rate",
            Self::DampingLeft => "B ≤ b − K T / 2",
            Self::MaxDamping => "B ≤ the device's largest damping at this rate",
            Self::AngularPassivity => "κ ≤ 2 b / T about axes",
            Self::AngularQuantisation => "κ ≤ 2 f_c / Δ about axes",
            Self::MaxAngularStiffness => {
                "κ ≤ the device's largest angular stiffness at this rate"
            }
            Self::AngularDampingLeft => "β ≤ b − κ T / 2 about axes",
            Self::MaxAngularDamping => "β ≤ the device's largest angular damping at this rate",
        }
    }
}

impl Rule {
    /// The numbers of the profile that the rule uses, by the names of
    /// [`DeviceProfile::NUMBERS`]; of a rule about rotation, by those of
    /// [`TurningProfile::NUMBERS`](palpate_device::TurningProfile::NUMBERS).
    ///
    /// ```
    /// use palpate_safety::Rule;
    ///
    /// assert_eq!(Rule::Quantisation.numbers(), ["friction", "encoder_step"]);
    /// ```
    #[must_use]
    pub fn numbers(self) -> &'static [&'static str] {
        match self {
            Self::Passivity
            | Self::DampingLeft
            | Self::AngularPassivity
            | Self::AngularDampingLeft => &["least_damping"],
            Self::Quantisation | Self::AngularQuantisation => &["friction", "encoder_step"],
            Self::MaxStiffness | Self::MaxAngularStiffness => &["max_stiffness"],
            Self::MaxDamping | Self::MaxAngularDamping => &["max_damping"],
        }
    }

    /// Whether the rule is about rotation.
    #[must_use]
    pub fn is_angular(self) -> bool {
        matches!(
            self,
            Self::AngularPassivity
                | Self::AngularQuantisation
                | Self::MaxAngularStiffness
                | Self::AngularDampingLeft
                | Self::MaxAngularDamping
        )
    }
}

/// A material as a device renders it.
///
/// With the stiffness `K` and the damping `B` at the device, a period `T`, and the device's least
/// damping `b`, friction `f_c` and encoder step `Δ`, the device renders
///
/// ```text
/// K = min(K asked for, K_max(T), 2 f_c / Δ)         and ≤ 2 b / T, see below
/// B = min(B asked for, B_max(T), max(0, b − K T / 2))
/// ```
///
/// The rule `K ≤ 2 b / T` holds with [`Acceptance::Passive`], and for profiles without a largest
/// stiffness. A profile states its largest stiffness and damping for 1 kHz. Both grow with the
/// rate, because a wall generates less energy between two samples the shorter the period is:
/// `K_max(T) = K_max · 1 ms / T`, and `B_max(T)` alike. The rule with `f_c` does not apply without
/// encoder steps or with infinite friction. Some numbers of the profile may be
/// [`assumed`](Self::assumed).
///
/// Rotation follows the same rules, with the numbers of the
/// [`TurningProfile`](palpate_device::TurningProfile), the angular stiffness `κ` [N·m/rad] for `K` and
/// the angular damping `β` [N·m·s/rad] for `B`.
///
/// # Examples
///
/// ```
/// use palpate_device::DeviceProfile;
/// use palpate_safety::{Accepted, Impedance, Rule};
///
/// # fn main() -> Result<(), palpate_safety::SafetyError> {
/// let device =
///     DeviceProfile {
///         max_stiffness: 1500.0,
///         least_damping: 1.0,
///         ..DeviceProfile::unlimited("example")
///     };
/// let asked = Impedance::new(3000.0, 0.5)?;
/// let accepted = Accepted::new(asked, 1.0, &device, 1000.0)?;
/// // b − K T / 2 = 1 − 0.75
/// assert_eq!(accepted.impedance, Impedance::new(1500.0, 0.25)?);
/// assert_eq!(accepted.stiffness_rule, Some(Rule::MaxStiffness));
/// assert_eq!((accepted.stiffness_factor, accepted.damping_factor), (0.5, 0.5));
/// // At twice the rate the same device is twice as stiff.
/// let faster = Accepted::new(asked, 1.0, &device, 2000.0)?;
/// assert_eq!(faster.impedance, Impedance::new(3000.0, 0.25)?);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Accepted {
    /// The stiffness and damping to render, in the world; angular for a rotational entry.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub impedance: Impedance,
    /// Stiffness at the device over stiffness in the world, and damping likewise.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub scale: f64,
    /// The stiffness that was asked for, at the device [N/m]; [N·m/rad] for a rotational entry.
    pub requested_stiffness: f64,
    /// The damping that was asked for, at the device [N·s/m]; [N·m·s/rad] for a rotational entry.
    pub requested_damping: f64,
    /// The stiffness at the device [N/m]; [N·m/rad] for a rotational entry.
    pub device_stiffness: f64,
    /// The damping at the device [N·s/m]; [N·m·s/rad] for a rotational entry.
    pub device_damping: f64,
    /// The share of the stiffness that the device renders, in (0, 1].
    pub stiffness_factor: f64,
    /// The rule that limits the stiffness; `None` if `stiffness_factor` is 1.
    pub stiffness_rule: Option<Rule>,
    /// The share of the damping that the device renders, in [0, 1]; one without damping.
    pub damping_factor: f64,
    /// The rule that limits the damping; `None` if `damping_factor` is 1.
    pub damping_rule: Option<Rule>,
    /// Names of the device's numbers that are assumed.
    #[cfg_attr(feature = "serde", serde(serialize_with = "as_list"))]
    pub assumed: Arc<[&'static str]>,
}

/// Writes a shared list as a list.
#[cfg(feature = "serde")]
fn as_list<S: serde::Serializer>(
    list: &Arc<[&'static str]>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(list.iter())
}

impl Accepted {
    /// The part of `impedance` that `device` renders at `rate` [Hz]; lengths in the world are
    /// `scale` times those at the device ([`WorkspaceMap::scale`](crate::WorkspaceMap::scale)).
    ///
    /// # Errors
    ///
    /// [`SafetyError::Number`] if rate or scale is not positive and finite, if a number of the
    /// profile that a rule needs is not positive, or if no stiffness is left: such a device renders
    /// no wall.
    pub fn new(
        impedance: Impedance,
        scale: f64,
        device: &DeviceProfile,
        rate: f64,
    ) -> Result<Self, SafetyError> {
        Self::of(impedance, scale, &DeviceLimits::along(device), Acceptance::Device, rate)
    }

    /// The part of `impedance` that a device with these limits renders; lengths in the world,
    /// or torques, are `scale` times those at the device.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new).
    pub fn of(
        impedance: Impedance,
        scale: f64,
        limits: &DeviceLimits,
        acceptance: Acceptance,
        rate: f64,
    ) -> Result<Self, SafetyError> {
        Self::of_layers(&[impedance], scale, limits, acceptance, rate)
    }

    /// As [`of`](Self::of), for a body of several layers. All have one share of their stiffness,
    /// which the stiffest layer needs, and one share of their damping, the least that any layer
    /// leaves room for. The entry is that of the stiffest layer.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new), or if there is no layer; [`SafetyError::MaterialRefused`] if a device
    /// is to take more than [`AS_IS_MOST`] times what it renders [as it is](Acceptance::AsIs).
    pub fn of_layers(
        layers: &[Impedance],
        scale: f64,
        limits: &DeviceLimits,
        acceptance: Acceptance,
        rate: f64,
    ) -> Result<Self, SafetyError> {
        let scale = NumberError::check_positive("scale", scale, "(world per device)")?;
        let rate = NumberError::check_rate(rate)?;
        let stiffer =
            |a: Impedance, b: Impedance| if b.stiffness() > a.stiffness() { b } else { a };
        let stiffest = layers.iter().copied().reduce(stiffer);
        let stiffest = stiffest.ok_or(NumberError::new("layers", "at least 1", 0.0, ""))?;
        // What a device without sound numbers renders is not known.
        if acceptance == Acceptance::AsIs
            && let Ok(renders) =
                Self::of_layers(layers, scale, limits, Acceptance::Device, rate)
            && let Some(rule) = renders.stiffness_rule
            && renders.stiffness_factor < (1.0 - 4.0 * f64::EPSILON) / AS_IS_MOST
        {
            let refused = Refused::new(&renders, rule, Requester::Material);
            let refused = Refused { is_as_it_is: true, ..refused };
            return Err(SafetyError::MaterialRefused(vec![refused]));
        }
        let (mut of_stiffness, mut of_damping) = (Share::WHOLE, Share::WHOLE);
        if acceptance != Acceptance::AsIs {
            let bounds = stiffness_bounds(limits, acceptance, rate)?;
            of_stiffness = Share::within(scale * stiffest.stiffness(), &bounds);
            for layer in layers.iter().filter(|layer| layer.damping() > 0.0) {
                let stiffness = of_stiffness.factor * scale * layer.stiffness();
                let bounds = damping_bounds(limits, stiffness, rate)?;
                let share = Share::within(scale * layer.damping(), &bounds);
                if share.factor < of_damping.factor {
                    of_damping = share;
                }
            }
        }
        let impedance = Impedance::new(
            of_stiffness.factor * stiffest.stiffness(),
            of_damping.factor * stiffest.damping(),
        )?;
        Ok(Self {
            impedance,
            scale,
            requested_stiffness: scale * stiffest.stiffness(),
            requested_damping: scale * stiffest.damping(),
            device_stiffness: scale * impedance.stiffness(),
            device_damping: scale * impedance.damping(),
            stiffness_factor: of_stiffness.factor,
            stiffness_rule: of_stiffness.rule,
            damping_factor: of_damping.factor,
            damping_rule: of_damping.rule,
            assumed: limits.assumed.clone(),
        })
    }

    /// The largest stiffness that a device with these limits renders at `rate` [Hz], at the device
    /// [N/m]; infinite if nothing limits it. With [`Acceptance::AsIs`], which takes more too, that
    /// of [`Acceptance::Device`].
    ///
    /// # Errors
    ///
    /// [`SafetyError::Number`] if the rate is out of range, or a number of the profile that a rule
    /// needs is not positive.
    ///
    /// ```
    /// use palpate_device::DeviceProfile;
    /// use palpate_safety::{Acceptance, Accepted, DeviceLimits};
    ///
    /// # fn main() -> Result<(), palpate_safety::SafetyError> {
    /// let device = DeviceProfile {
    ///     max_stiffness: 1500.0,
    ///     ..DeviceProfile::unlimited("example")
    /// };
    /// let limits = DeviceLimits::along(&device);
    /// let most = |rate| Accepted::most_stiffness(&limits, Acceptance::Device, rate);
    /// assert_eq!((most(1000.0)?, most(2000.0)?), (1500.0, 3000.0));
    /// # Ok(())
    /// # }
    /// ```
    pub fn most_stiffness(
        limits: &DeviceLimits,
        acceptance: Acceptance,
        rate: f64,
    ) -> Result<f64, SafetyError> {
        let bounds = stiffness_bounds(limits, acceptance, NumberError::check_rate(rate)?)?;
        Ok(bounds.iter().fold(f64::INFINITY, |least, (bound, _)| least.min(*bound)))
    }

    /// The stiffness and the damping that were asked for, in the world [N/m, N·s/m], or about axes.
    #[must_use]
    pub fn requested(&self) -> Impedance {
        Impedance {
            stiffness: self.requested_stiffness / self.scale,
            damping: self.requested_damping / self.scale,
        }
    }

    /// This, unless the device renders less than was asked for.
    ///
    /// # Errors
    ///
    /// [`SafetyError::MaterialRefused`].
    ///
    /// ```
    /// use palpate_device::DeviceProfile;
    /// use palpate_safety::{Accepted, Impedance};
    ///
    /// # fn main() -> Result<(), palpate_safety::SafetyError> {
    /// let device = DeviceProfile {
    ///     max_stiffness: 1000.0,
    ///     ..DeviceProfile::unlimited("example")
    /// };
    /// let accepted = Accepted::new(Impedance::new(2000.0, 0.0)?, 1.0, &device, 1000.0)?;
    /// assert_eq!(
    ///     accepted.unchanged().unwrap_err().to_string(),
    ///     "the device renders stiffness 1000 N/m (asked 2000) and damping 0 N·s/m (asked 0): K ≤ the \
    ///      device's largest stiffness at this rate"
    /// );
    /// # Ok(())
    /// # }
    /// ```
    pub fn unchanged(self) -> Result<Self, SafetyError> {
        match self.refusal(Requester::Material) {
            None => Ok(self),
            Some(refused) => Err(SafetyError::MaterialRefused(vec![refused])),
        }
    }

    /// What is to be said to a `requester` that wants all or nothing; `None` if the device renders
    /// all that was asked for.
    #[must_use]
    pub fn refusal(&self, requester: Requester) -> Option<Refused> {
        let rule = self.stiffness_rule.or(self.damping_rule)?;
        Some(Refused::new(self, rule, requester))
    }

    /// Copies `other`, except the names of assumed numbers: both belong to the same device.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn renew(&mut self, other: &Self) {
        self.impedance = other.impedance;
        self.scale = other.scale;
        self.requested_stiffness = other.requested_stiffness;
        self.requested_damping = other.requested_damping;
        self.device_stiffness = other.device_stiffness;
        self.device_damping = other.device_damping;
        self.stiffness_factor = other.stiffness_factor;
        self.stiffness_rule = other.stiffness_rule;
        self.damping_factor = other.damping_factor;
        self.damping_rule = other.damping_rule;
    }
}

/// A share of what is asked for, and the rule that leaves no more.
#[derive(Clone, Copy)]
struct Share {
    factor: f64,
    rule: Option<Rule>,
}

impl Share {
    const WHOLE: Self = Self { factor: 1.0, rule: None };

    /// The share of `asked` that is within all bounds.
    fn within(asked: f64, bounds: &[(f64, Rule)]) -> Self {
        bounds.iter().fold(Self::WHOLE, |least, (bound, rule)| {
            let factor = bound / asked;
            if factor < least.factor { Self { factor, rule: Some(*rule) } } else { least }
        })
    }
}

/// What a damping must be by `K ≤ 2 b / T`.
const OF_PASSIVITY: &str =
    "positive where no largest stiffness is stated or all must be passive";

/// What a friction must be by `K ≤ 2 f_c / Δ`.
const OF_STEPS: &str = "positive beside encoder steps";

/// The largest stiffness at the device that each rule allows; infinite where a rule does not apply.
fn stiffness_bounds(
    limits: &DeviceLimits,
    acceptance: Acceptance,
    rate: f64,
) -> Result<[(f64, Rule); 3], SafetyError> {
    limits.least_damping.zero_or_more()?;
    let is_stated = limits.max_stiffness.positive()? < f64::INFINITY;
    // Of a device whose maker says nothing, only physics is known.
    let passive = match acceptance {
        Acceptance::Device | Acceptance::AsIs if is_stated => f64::INFINITY,
        _ => 2.0 * limits.least_damping.positive_for(OF_PASSIVITY)? * rate,
    };
    let step = limits.encoder_step.not_negative()?;
    let seen = if step > 0.0 {
        2.0 * limits.friction.positive_for(OF_STEPS)? / step
    } else {
        f64::INFINITY
    };
    let stated = limits.max_stiffness.positive()? * (rate / STATED_RATE);
    let [of_passivity, of_steps, of_maker, ..] = limits.rules;
    Ok([(passive, of_passivity), (seen, of_steps), (stated, of_maker)])
}

/// The largest damping at the device that each rule allows beside a stiffness.
fn damping_bounds(
    limits: &DeviceLimits,
    stiffness: f64,
    rate: f64,
) -> Result<[(f64, Rule); 2], SafetyError> {
    let least = limits.least_damping.zero_or_more()?;
    let taken = 0.5 * stiffness / rate;
    // What rounding leaves of a stiffness that takes all is none.
    let left = if taken < least * (1.0 - 4.0 * f64::EPSILON) { least - taken } else { 0.0 };
    let stated = limits.max_damping.zero_or_more()? * (rate / STATED_RATE);
    let [.., of_rest, of_maker] = limits.rules;
    Ok([(left, of_rest), (stated, of_maker)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_testkit::cases::each as cases;

    fn device() -> DeviceProfile {
        DeviceProfile {
            least_damping: 0.5,
            friction: 0.0625,
            encoder_step: 3e-5,
            max_stiffness: 2500.0,
            max_damping: 4.0,
            assumed: (&["least_damping"][..]).into(),
            ..DeviceProfile::unlimited("example")
        }
    }

    fn accept(stiffness: f64, damping: f64, device: &DeviceProfile) -> Accepted {
        Accepted::new(Impedance::new(stiffness, damping).unwrap(), 1.0, device, 1000.0).unwrap()
    }

    fn passive(stiffness: f64, damping: f64, device: &DeviceProfile) -> Accepted {
        let impedance = Impedance::new(stiffness, damping).unwrap();
        let limits = DeviceLimits::along(device);
        Accepted::of(impedance, 1.0, &limits, Acceptance::Passive, 1000.0).unwrap()
    }

    #[test]
    fn every_rule_binds_somewhere() {
        let base = device();
        let with = |change: &dyn Fn(&mut DeviceProfile)| {
            let mut device = device();
            change(&mut device);
            device
        };
        let of_stiffness = |a: Accepted| (a.device_stiffness, a.stiffness_rule);
        let of_damping = |a: Accepted| (a.device_damping, a.damping_rule);
        assert_eq!(of_stiffness(accept(1000.0, 0.0, &base)), (1000.0, None));
        assert_eq!(of_stiffness(accept(2000.0, 0.0, &base)), (2000.0, None));
        let sampled = (1000.0, Some(Rule::Passivity));
        assert_eq!(of_stiffness(passive(2000.0, 0.0, &base)), sampled);
        let rough = with(&|d| d.encoder_step = 0.000_25);
        let seen = (500.0, Some(Rule::Quantisation));
        assert_eq!(of_stiffness(accept(1000.0, 0.0, &rough)), seen);
        let soft = with(&|d| d.max_stiffness = 250.0);
        let stated = (250.0, Some(Rule::MaxStiffness));
        assert_eq!(of_stiffness(accept(1000.0, 0.0, &soft)), stated);
        // b − K T / 2 = 0.5 − 0.25, and nothing beside 2 b / T and more.
        let left = |damping: f64| (damping, Some(Rule::DampingLeft));
        assert_eq!(of_damping(accept(500.0, 0.5, &base)), left(0.25));
        assert_eq!(of_damping(accept(1500.0, 0.5, &base)), left(0.0));
        let thin = with(&|d| d.max_damping = 0.0625);
        let stated = (0.0625, Some(Rule::MaxDamping));
        assert_eq!(of_damping(accept(100.0, 0.25, &thin)), stated);
        let unstated = with(&|d| d.max_stiffness = f64::INFINITY);
        assert_eq!(of_stiffness(accept(2000.0, 0.0, &unstated)), sampled);
        let free = with(&|d| d.friction = f64::INFINITY);
        assert_eq!(of_stiffness(accept(1000.0, 0.0, &free)), (1000.0, None));
    }

    /// Damping takes no stiffness away: presets of 1000 N/m were felt with 75 N/m.
    #[test]
    fn what_is_accepted_satisfies_every_rule_and_no_larger_share_does() {
        let device = device();
        cases(500, |u| {
            let k = f64::from(u.int_in_range(1..=20_000)?);
            let b = f64::from(u.int_in_range(0..=10_000)?) * 1e-3;
            let rate = *u.choose(&[500.0, 1000.0, 4000.0, 10_000.0])?;
            let acceptance = *u.choose(&[Acceptance::Passive, Acceptance::Device])?;
            let impedance = Impedance::new(k, b).unwrap();
            let limits = DeviceLimits::along(&device);
            let accepted = Accepted::of(impedance, 1.0, &limits, acceptance, rate).unwrap();
            let mut most = f64::min(2.0 * 0.0625 / 3e-5, 2.5 * rate);
            if acceptance == Acceptance::Passive {
                most = most.min(2.0 * 0.5 * rate);
            }
            let stiffness = k.min(most);
            let damping = b.min((0.5 - 0.5 * stiffness / rate).max(0.0)).min(4e-3 * rate);
            let off = |x: f64, y: f64| (x - y).abs() / x.max(1e-9);
            assert!(off(stiffness, accepted.device_stiffness) < 1e-12, "{accepted:?}");
            assert!((damping - accepted.device_damping).abs() < 1e-12, "{accepted:?}");
            assert_eq!(accepted.stiffness_rule.is_none(), accepted.stiffness_factor == 1.0);
            assert_eq!(accepted.damping_rule.is_none(), accepted.damping_factor == 1.0);
            assert_eq!((accepted.requested_stiffness, accepted.requested_damping), (k, b));
            Ok(())
        });
    }

    #[test]
    fn layers_have_one_share_of_stiffness_and_one_of_damping() {
        let layers = [(1000.0, 0.1), (5000.0, 0.0), (500.0, 0.9)];
        let layers = layers.map(|(k, b)| Impedance::new(k, b).unwrap());
        let limits = DeviceLimits::along(&device());
        let of = |layers: &[Impedance]| {
            Accepted::of_layers(layers, 1.0, &limits, Acceptance::Device, 1000.0)
        };
        let accepted = of(&layers).unwrap();
        assert_eq!(accepted.impedance, Impedance::new(2500.0, 0.0).unwrap());
        assert_eq!(accepted.stiffness_factor, 0.5);
        // The third layer has 250 N/m left, and 0.5 − 0.125 N·s/m of 0.9.
        assert!((accepted.damping_factor - 0.375 / 0.9).abs() < 1e-15);
        assert_eq!(accepted.damping_rule, Some(Rule::DampingLeft));
        assert_eq!(of(&[]).unwrap_err().to_string(), "layers must be at least 1, got 0");
    }

    #[test]
    fn a_material_as_it_is_keeps_every_number() {
        let impedance = Impedance::new(5e4, 1e3).unwrap();
        let limits = DeviceLimits::along(&device());
        let accepted = Accepted::of(impedance, 1.0, &limits, Acceptance::AsIs, 1000.0).unwrap();
        assert_eq!((accepted.impedance, accepted.stiffness_rule), (impedance, None));
        accepted.unchanged().unwrap();
    }

    /// An omega swung by 2.3 mm for ever against walls of 1e6 and 1e9 N/m.
    #[test]
    fn a_stiffness_that_no_limit_cycle_ends_is_refused_with_its_number() {
        let of = |stiffness: f64| {
            let asked = Impedance::new(stiffness, 0.0).unwrap();
            let limits = DeviceLimits::along(&device());
            Accepted::of(asked, 1.0, &limits, Acceptance::AsIs, 1000.0)
        };
        for stiffness in [5e4 * (1.0 + 1e-9), 1e6, 1e9] {
            assert!(
                matches!(of(stiffness), Err(SafetyError::MaterialRefused(_))),
                "{stiffness}"
            );
        }
        assert_eq!(
            of(1e6).unwrap_err().to_string(),
            "the device renders stiffness 2500 N/m (asked 1000000) and damping 0 N·s/m (asked 0): \
             K ≤ the device's largest stiffness at this rate; as it is, at most 20 times the \
             stiffness that it renders comes to rest: ask for less, or for what the device renders"
        );
        // Of a device whose numbers are not known, nothing is.
        let unknown = DeviceLimits::along(&DeviceProfile::unlimited("unknown"));
        let stiff = Impedance::new(1e9, 0.0).unwrap();
        Accepted::of(stiff, 1.0, &unknown, Acceptance::AsIs, 1000.0).unwrap();
    }

    #[test]
    fn stiffness_at_the_device_counts() {
        let impedance = Impedance::new(1000.0, 0.0).unwrap();
        let accepted = Accepted::new(impedance, 4.0, &device(), 1000.0).unwrap();
        assert_eq!((accepted.requested_stiffness, accepted.device_stiffness), (4000.0, 2500.0));
        assert_eq!(accepted.impedance.stiffness(), 625.0);
        assert_eq!(accepted.assumed[..], ["least_damping"]);
    }

    #[test]
    fn a_device_that_renders_nothing_is_an_error_that_says_why() {
        let impedance = Impedance::new(100.0, 0.0).unwrap();
        for least_damping in [-1.0, f64::NAN] {
            let device = DeviceProfile { least_damping, ..device() };
            assert!(Accepted::new(impedance, 1.0, &device, 1000.0).is_err());
        }
        // Without any damping, a device whose maker states no stiffness renders none.
        let undamped = DeviceProfile { least_damping: 0.0, ..device() };
        assert!(Accepted::new(impedance, 1.0, &undamped, 1000.0).is_ok());
        let unstated = DeviceProfile { max_stiffness: f64::INFINITY, ..undamped };
        let error = Accepted::new(impedance, 1.0, &unstated, 1000.0).unwrap_err();
        assert_eq!(
            error.to_string(),
            "least_damping must be positive where no largest stiffness is stated or all must be \
             passive, got 0 N·s/m"
        );
        let device = DeviceProfile { friction: 0.0, ..device() };
        let error = Accepted::new(impedance, 1.0, &device, 1000.0).unwrap_err();
        assert_eq!(
            error.to_string(),
            "friction must be positive beside encoder steps, got 0 N"
        );
        assert!(Accepted::new(impedance, 0.0, &device, 1000.0).is_err());
        assert!(Accepted::new(impedance, 1.0, &device, f64::NAN).is_err());
    }
}
