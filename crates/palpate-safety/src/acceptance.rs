// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Which materials a device renders passively, and how others are scaled.
//!
//! The rules bound the Z-width of a device, the range of impedances that it renders passively.
//! J. E. Colgate, G. G. Schenkel, "Passivity of a class of sampled-data systems: application to
//! haptic interfaces" (1997): `b > K T / 2 + |B|`. J. J. Abbott, A. M. Okamura, "Effects of
//! position quantization and sampling rate on virtual-wall passivity" (2005): `K ≤ min(2 b / T,
//! 2 f_c / Δ)`.

use std::sync::Arc;

use crate::device::DeviceProfile;
use crate::error::{NumberError, SafetyError};
use crate::impedance::Impedance;
use crate::limits::DeviceLimits;

/// How a material that a device cannot render is treated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Acceptance {
    /// Stiffness and damping are scaled down by the same factor.
    #[default]
    Scaled,
    /// The material is refused with an error.
    Strict,
    /// The material stays as it is: the passivity controller alone keeps the hand safe.
    AsItIs,
}

/// A rule that limits what a device renders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Rule {
    /// `K ≤ 2 (b − |B|) / T`, Colgate and Schenkel (1997).
    Passivity,
    /// `K ≤ 2 f_c / Δ`, Abbott and Okamura (2005).
    Quantisation,
    /// The device's largest stiffness.
    MaxStiffness,
    /// The device's largest damping.
    MaxDamping,
    /// `κ ≤ 2 (b − |β|) / T`: passivity of rotation.
    AngularPassivity,
    /// `κ ≤ 2 f_c / Δ`: quantisation of rotation.
    AngularQuantisation,
    /// The device's largest angular stiffness.
    MaxAngularStiffness,
    /// The device's largest angular damping.
    MaxAngularDamping,
}

impl Rule {
    /// The rule as a formula or sentence.
    #[must_use]
    pub fn condition(self) -> &'static str {
        match self {
            Self::Passivity => "K ≤ 2 (b − |B|) / T",
            Self::Quantisation => "K ≤ 2 f_c / Δ",
            Self::MaxStiffness => "K ≤ the device's largest stiffness",
            Self::MaxDamping => "B ≤ the device's largest damping",
            Self::AngularPassivity => "κ ≤ 2 (b − |β|) / T",
            Self::AngularQuantisation => "κ ≤ 2 f_c / Δ about axes",
            Self::MaxAngularStiffness => "κ ≤ the device's largest angular stiffness",
            Self::MaxAngularDamping => "β ≤ the device's largest angular damping",
        }
    }
}

/// A material as a device renders it.
///
/// With the stiffness `K` and damping `B` at the device, a period `T`, the device's least
/// damping `b`, friction `f_c` and encoder step `Δ`, a material is accepted if
///
/// ```text
/// K ≤ min(2 (b − |B|) / T, 2 f_c / Δ),  K ≤ K_max,  B ≤ B_max
/// ```
///
/// Otherwise both are multiplied by the largest factor `s` that satisfies every rule:
///
/// ```text
/// s = min(b / (K T / 2 + B), 2 f_c / (Δ K), K_max / K, B_max / B)
/// ```
///
/// The rule with `f_c` does not apply without encoder steps or with infinite friction.
/// Passivity depends on the numbers of the profile, some of which may be
/// [`assumed`](Self::assumed). A profile states its largest stiffness and damping for 1 kHz;
/// the same numbers are used at any rate.
///
/// Rotation follows the same rules, with the numbers of the
/// [`TurningProfile`](crate::TurningProfile), the angular stiffness `κ` [N·m/rad] for `K` and
/// the angular damping `β` [N·m·s/rad] for `B`.
///
/// # Examples
///
/// ```
/// use palpate_safety::{Accepted, DeviceProfile, Impedance, Rule};
///
/// # fn main() -> Result<(), palpate_safety::SafetyError> {
/// let device = DeviceProfile::unlimited("example").with_least_damping(0.5);
/// // b / (K T / 2 + B) = 0.5 / (1.5 + 0.5)
/// let accepted = Accepted::new(Impedance::new(3000.0, 0.5)?, 1.0, &device, 1000.0)?;
/// assert_eq!((accepted.factor, accepted.rule), (0.25, Some(Rule::Passivity)));
/// assert_eq!(accepted.impedance, Impedance::new(750.0, 0.125)?);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Accepted {
    /// The stiffness and damping to render, in the world; angular for a rotational entry.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub impedance: Impedance,
    /// The stiffness at the device [N/m]; [N·m/rad] for a rotational entry.
    pub device_stiffness: f64,
    /// The damping at the device [N·s/m]; [N·m·s/rad] for a rotational entry.
    pub device_damping: f64,
    /// The factor that stiffness and damping were multiplied by, in (0, 1].
    pub factor: f64,
    /// The rule that determined the factor; `None` if the factor is one.
    pub rule: Option<Rule>,
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
    /// profile that a rule needs is not positive, or if the scaled stiffness is zero: such a
    /// device renders no wall.
    pub fn new(
        impedance: Impedance,
        scale: f64,
        device: &DeviceProfile,
        rate: f64,
    ) -> Result<Self, SafetyError> {
        Self::of(impedance, scale, &DeviceLimits::along(device), Acceptance::Scaled, rate)
    }

    /// As [`new`](Self::new), but refuses an impedance that would have to be scaled.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new), or [`SafetyError::MaterialRefused`].
    ///
    /// ```
    /// use palpate_safety::{Accepted, DeviceProfile, Impedance};
    ///
    /// # fn main() -> Result<(), palpate_safety::SafetyError> {
    /// let device = DeviceProfile::unlimited("example").with_least_damping(0.5);
    /// let refused = Accepted::strict(Impedance::new(2000.0, 0.0)?, 1.0, &device, 1000.0);
    /// assert_eq!(
    ///     refused.unwrap_err().to_string(),
    ///     "a stiffness of 2000 N/m and a damping of 0 N·s/m at the device break \
    ///      K ≤ 2 (b − |B|) / T; 0.5 times both would not"
    /// );
    /// # Ok(())
    /// # }
    /// ```
    pub fn strict(
        impedance: Impedance,
        scale: f64,
        device: &DeviceProfile,
        rate: f64,
    ) -> Result<Self, SafetyError> {
        Self::of(impedance, scale, &DeviceLimits::along(device), Acceptance::Strict, rate)
    }

    /// The part of `impedance` that a device with these limits renders; lengths in the world,
    /// or torques, are `scale` times those at the device.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new), or [`strict`](Self::strict) with [`Acceptance::Strict`].
    pub fn of(
        impedance: Impedance,
        scale: f64,
        limits: &DeviceLimits,
        acceptance: Acceptance,
        rate: f64,
    ) -> Result<Self, SafetyError> {
        let (stiffness, damping) = at_device(impedance, scale)?;
        let (mut factor, mut rule) = (1.0, None);
        if acceptance != Acceptance::AsItIs {
            for (limit, of) in factors(stiffness, damping, limits, rate)? {
                if limit < factor {
                    (factor, rule) = (limit, Some(of));
                }
            }
        }
        if let (Acceptance::Strict, Some(rule)) = (acceptance, rule) {
            let condition = rule.condition();
            return Err(if limits.is_turning {
                SafetyError::TurningRefused { stiffness, damping, condition, factor }
            } else {
                SafetyError::MaterialRefused { stiffness, damping, condition, factor }
            });
        }
        let impedance =
            if rule.is_some() { impedance_times(impedance, factor)? } else { impedance };
        let (device_stiffness, device_damping) = at_device(impedance, scale)?;
        let assumed = limits.assumed.clone();
        Ok(Self { impedance, device_stiffness, device_damping, factor, rule, assumed })
    }

    /// Copies `other`, except the names of assumed numbers: both belong to the same device.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn renew(&mut self, other: &Self) {
        let Self { impedance, device_stiffness, device_damping, factor, rule, .. } = *other;
        (self.impedance, self.factor, self.rule) = (impedance, factor, rule);
        (self.device_stiffness, self.device_damping) = (device_stiffness, device_damping);
    }
}

/// Stiffness [N/m] and damping [N·s/m] at the device, where forces equal those of the world and
/// displacements are `scale` times smaller.
fn at_device(impedance: Impedance, scale: f64) -> Result<(f64, f64), SafetyError> {
    let scale = NumberError::check_positive("scale", scale, "(world per device)")?;
    Ok((scale * impedance.stiffness(), scale * impedance.damping()))
}

fn impedance_times(impedance: Impedance, factor: f64) -> Result<Impedance, SafetyError> {
    Impedance::new(factor * impedance.stiffness(), factor * impedance.damping())
}

/// The largest factor that each rule allows; infinite where a rule does not apply.
fn factors(
    stiffness: f64,
    damping: f64,
    limits: &DeviceLimits,
    rate: f64,
) -> Result<[(f64, Rule); 4], SafetyError> {
    let period = 1.0 / NumberError::check_rate(rate)?;
    let least = limits.least_damping.positive()?;
    let max_stiffness = limits.max_stiffness.positive()?;
    let step = limits.encoder_step.not_negative()?;
    let quantisation = if step > 0.0 {
        2.0 * limits.friction.positive()? / (step * stiffness)
    } else {
        f64::INFINITY
    };
    let of_damping =
        if damping > 0.0 { limits.max_damping.positive()? / damping } else { f64::INFINITY };
    let [passive, seen, stiff, damped] = limits.rules;
    Ok([
        (least / (0.5 * period * stiffness + damping), passive),
        (quantisation, seen),
        (max_stiffness / stiffness, stiff),
        (of_damping, damped),
    ])
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

    #[test]
    fn every_rule_binds_somewhere() {
        let base = device();
        let with = |change: &dyn Fn(&mut DeviceProfile)| {
            let mut device = device();
            change(&mut device);
            device
        };
        let rule_of = |k, b, device: &DeviceProfile| {
            let accepted = accept(k, b, device);
            (accepted.factor, accepted.rule)
        };
        assert_eq!(rule_of(1000.0, 0.0, &base), (1.0, None));
        assert_eq!(rule_of(2000.0, 0.0, &base), (0.5, Some(Rule::Passivity)));
        assert_eq!(rule_of(1000.0, 0.5, &base), (0.5, Some(Rule::Passivity)));
        let rough = with(&|d| d.encoder_step = 0.000_25);
        assert_eq!(rule_of(1000.0, 0.0, &rough), (0.5, Some(Rule::Quantisation)));
        let soft = with(&|d| d.max_stiffness = 250.0);
        assert_eq!(rule_of(1000.0, 0.0, &soft), (0.25, Some(Rule::MaxStiffness)));
        let thin = with(&|d| d.max_damping = 0.0625);
        assert_eq!(rule_of(100.0, 0.25, &thin), (0.25, Some(Rule::MaxDamping)));
        let free = with(&|d| d.friction = f64::INFINITY);
        assert_eq!(rule_of(1000.0, 0.0, &free), (1.0, None));
    }

    #[test]
    fn what_is_accepted_satisfies_every_rule_and_no_larger_factor_does() {
        let device = device();
        cases(500, |u| {
            let k = f64::from(u.int_in_range(1..=20_000)?);
            let b = f64::from(u.int_in_range(0..=10_000)?) * 1e-3;
            let accepted = accept(k, b, &device);
            let holds = |s: f64, k: f64, b: f64| {
                let (k, b) = (s * k, s * b);
                k <= 2.0 * (0.5 - b) / 1e-3
                    && k <= 2.0 * 0.0625 / 3e-5
                    && k <= 2500.0
                    && b <= 4.0
            };
            let (k_accepted, b_accepted) = (accepted.device_stiffness, accepted.device_damping);
            assert!(holds(1.0 - 1e-12, k_accepted, b_accepted));
            assert_eq!(accepted.rule.is_none(), accepted.factor == 1.0);
            assert!(accepted.rule.is_none() || !holds(accepted.factor * (1.0 + 1e-12), k, b));
            Ok(())
        });
    }

    #[test]
    fn stiffness_at_the_device_counts() {
        let impedance = Impedance::new(1000.0, 0.0).unwrap();
        let accepted = Accepted::new(impedance, 4.0, &device(), 1000.0).unwrap();
        assert_eq!(accepted.factor, 0.25);
        assert_eq!(accepted.device_stiffness, 1000.0);
        assert_eq!(accepted.impedance.stiffness(), 250.0);
        assert_eq!(accepted.assumed[..], ["least_damping"]);
    }

    #[test]
    fn a_device_that_renders_nothing_is_an_error() {
        let impedance = Impedance::new(100.0, 0.0).unwrap();
        for least_damping in [0.0, -1.0, f64::NAN] {
            let device = DeviceProfile { least_damping, ..device() };
            assert!(Accepted::new(impedance, 1.0, &device, 1000.0).is_err());
        }
        let device = DeviceProfile { friction: 0.0, ..device() };
        let error = Accepted::new(impedance, 1.0, &device, 1000.0).unwrap_err();
        assert_eq!(error.to_string(), "friction must be positive, got 0 N");
        assert!(Accepted::new(impedance, 0.0, &device, 1000.0).is_err());
        assert!(Accepted::new(impedance, 1.0, &device, f64::NAN).is_err());
    }
}
