// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What reports of runs say of the rules that make bodies softer.

use crate::common::{Folder, palpate, text};

/// The lines about rules of a short run.
fn rules(options: &[&str]) -> Vec<String> {
    let said = text(&palpate(&[&["feel", "--fast", "--duration", "0.05"], options].concat()));
    let lines = said.lines().filter(|line| line.contains(" than asked"));
    lines.map(|line| line.trim_start().to_owned()).collect()
}

/// Once only an assumed damping was told, whatever the rule, and twice for a tool.
#[test]
fn a_rule_names_the_numbers_that_it_uses_and_that_are_assumed() {
    let folder = Folder::new();
    let omega = palpate::device::DeviceProfile {
        friction: 1.35e-6,
        ..palpate::device::profile_named("omega").unwrap()
    };
    let ends = |assumed: &'static [&'static str], options: &[&str]| {
        let profile = palpate::scene::device_to_json(&palpate::device::DeviceProfile {
            assumed: assumed.into(),
            ..omega.clone()
        });
        let file = folder.write("omega.json", &profile.unwrap());
        let device = format!("simulated:{file}");
        let rules = rules(&[&["--device", &device], options].concat());
        rules.iter().map(|line| line.split_once(": ").unwrap().1.to_owned()).collect::<Vec<_>>()
    };
    let steps = "K ≤ 2 f_c / Δ";
    let stiff = ["--stiffness", "800", "--damping", "0"];
    assert_eq!(ends(&[], &stiff), [steps]);
    assert_eq!(ends(&["friction"], &stiff), [format!("{steps}; friction is assumed")]);
    let both = format!("{steps}; friction and encoder_step are assumed");
    assert_eq!(ends(&["encoder_step", "friction", "mass"], &stiff), [both.as_str()]);
    let damped = ["--stiffness", "800", "--damping", "9"];
    let left = "B ≤ b − K T / 2; least_damping is assumed".to_owned();
    assert_eq!(ends(&["friction", "encoder_step", "least_damping"], &damped), [both, left]);
}

#[test]
fn a_number_about_axes_is_said_to_be_angular() {
    let tool = ["scenes/stylus_in_cup.json", "--acceptance", "passive"];
    let rules = rules(&[&tool[..], &["--device", "simulated:sigma7"]].concat());
    let [along, about] = &rules[..] else { panic!("{rules:?}") };
    assert!(along.ends_with(": B ≤ b − K T / 2; least_damping is assumed"), "{along}");
    let said = ": κ ≤ 2 b / T about axes; angular least_damping is assumed";
    assert!(about.ends_with(said), "{about}");
}

/// Once a stiffness of zero was 1.928e-9 N/m at the hand.
#[test]
fn a_body_without_a_spring_has_a_stiffness_of_zero() {
    let omega = ["--device", "simulated:omega", "--stiffness", "0"];
    let said =
        text(&palpate(&[&["feel", "--fast", "--duration", "0.05"], &omega[..]].concat()));
    assert!(said.contains("\n  stiffness 0 N/m, "), "{said}");
    assert!(said.contains("  at the hand    stiffness 0 N/m, "), "{said}");
}
