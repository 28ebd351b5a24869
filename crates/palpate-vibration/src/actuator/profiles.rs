// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Profiles of known actuators.
//!
//! Makers publish the rated speed or resonance, and the range of voltages; hardly any publishes
//! the width of a resonance or a time constant. The lowest voltage at which a motor may be operated
//! counts as its start level, and the highest as its overdrive. What is not published is assumed: of the order of
//! the rise and stop times in makers' data sheets of parts of that size, and listed as such.

use palpate_field::UnknownName;

use std::borrow::Cow;

use super::{Actuator, Mechanism};

/// The largest level of a resonant actuator for a short time, as a part of the rated one. Drivers
/// of such actuators push above the rated voltage to start and stop; how far is the part's own.
const ASSUMED_OVERDRIVE: f64 = 1.2;

const fn actuator(
    name: &'static str,
    mechanism: Mechanism,
    source: &'static str,
    assumed: &'static [&'static str],
) -> Actuator {
    Actuator {
        name: Cow::Borrowed(name),
        mechanism,
        source: Cow::Borrowed(source),
        assumed: Cow::Borrowed(assumed),
    }
}

/// All known actuators, by their names on the command line.
///
/// ```
/// use palpate_vibration::ACTUATORS;
///
/// let kinds: Vec<_> = ACTUATORS.iter().map(|(_, actuator)| actuator.mechanism.kind_name()).collect();
/// assert_eq!(kinds, ["ERM", "ERM", "LRA", "voice coil"]);
/// ```
pub static ACTUATORS: [(&str, Actuator); 4] = [
    (
        "erm",
        actuator(
            "Jinlong Z30C1T8219731",
            Mechanism::RotatingMass {
                // 12 000 turns a minute at 3.0 V.
                frequency: 200.0,
                // From 2.3 V to 4.5 V, of 3.0 V.
                start_level: 2.3 / 3.0,
                overdrive: 4.5 / 3.0,
                rise: 0.04,
                fall: 0.08,
            },
            "specifications of the M5Stack Hat Vibrator (U159), which holds it: rated 3.0 V and 12 000 turns a minute, operated at 2.3 to 4.5 V",
            &["rise", "fall"],
        ),
    ),
    (
        "coin",
        actuator(
            "Leader LCM0827A3038F, a coin of 8 mm",
            Mechanism::RotatingMass {
                // 9000 turns a minute at 3 V.
                frequency: 150.0,
                start_level: 0.8,
                overdrive: ASSUMED_OVERDRIVE,
                rise: 0.06,
                fall: 0.1,
            },
            "product data at LCSC, part C2759981: rated 3 V and 9000 turns a minute",
            &["start_level", "overdrive", "rise", "fall"],
        ),
    ),
    (
        "lra",
        actuator(
            "Vybronics VG1040003D, a coin of 10 mm",
            Mechanism::Resonant {
                resonance: 170.0,
                bandwidth: 10.0,
                overdrive: ASSUMED_OVERDRIVE,
            },
            "the maker's product page: 2.5 V rms at a resonance of 170 Hz",
            &["bandwidth", "overdrive"],
        ),
    ),
    (
        "voice_coil",
        actuator(
            "Tactile Labs Haptuator Mark II",
            Mechanism::VoiceCoil { lowest: 90.0, highest: 1000.0 },
            "the maker's rated bandwidth, 90 to 1000 Hz",
            &[],
        ),
    ),
];

/// The actuator that the command line calls `name`.
///
/// # Errors
///
/// [`UnknownName`], which lists the known names.
///
/// ```
/// use palpate_vibration::actuator_named;
///
/// assert_eq!(actuator_named("lra").unwrap().name, "Vybronics VG1040003D, a coin of 10 mm");
/// assert_eq!(
///     actuator_named("lar").unwrap_err().to_string(),
///     "there is no actuator \"lar\"; there are erm, coin, lra, voice_coil"
/// );
/// ```
pub fn actuator_named(name: &str) -> Result<Actuator, UnknownName> {
    let found = ACTUATORS.iter().find(|(known, _)| *known == name);
    let known = || ACTUATORS.iter().map(|(known, _)| *known);
    found
        .map(|(_, actuator)| actuator.clone())
        .ok_or_else(|| UnknownName::new("actuator", name, known()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_actuator_is_coherent_and_has_its_name_once() {
        for (name, actuator) in &ACTUATORS {
            actuator.mechanism.check().unwrap();
            assert!(!actuator.source.is_empty(), "{name}");
            assert_eq!(&actuator_named(name).unwrap(), actuator);
            assert_eq!(ACTUATORS.iter().filter(|(other, _)| other == name).count(), 1);
            let figures = actuator.mechanism.figures();
            for field in actuator.assumed.iter() {
                assert!(figures.iter().any(|(figure, ..)| figure == field), "{name}: {field}");
            }
        }
    }
}
