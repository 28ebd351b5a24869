// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Reports as a sentence each.

use std::fmt::{Display, Formatter, Result};

use crate::acceptance::Accepted;
use crate::report::SafetyReport;

impl Display for Accepted {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { impedance, factor, rule, .. } = self;
        write!(f, "stiffness {}, damping {}", impedance.stiffness(), impedance.damping())?;
        match rule {
            None => f.write_str(", as requested"),
            Some(rule) => write!(f, ", {factor} times as requested: {}", rule.condition()),
        }
    }
}

impl Display for SafetyReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let stages = [
            ("passivity", self.passivity.effect),
            ("slew limit", self.slew),
            ("force limit", self.force_limit),
            ("continuous limit", self.continuous.effect),
            ("guard", self.guard),
            ("ramp", self.ramp),
            ("watchdog", self.watchdog.effect),
            ("emergency stop", self.emergency_stop),
        ];
        write!(f, "{} ticks, changed by: ", self.ticks)?;
        let mut acted = stages.iter().filter(|(_, effect)| effect.ticks > 0);
        let Some((first, effect)) = acted.next() else { return f.write_str("no stage") };
        write!(f, "{first} {}", effect.ticks)?;
        acted.try_for_each(|(stage, effect)| write!(f, ", {stage} {}", effect.ticks))
    }
}

#[cfg(test)]
mod tests {
    use palpate_field::Vector;

    use crate::{
        Accepted, DeviceProfile, Impedance, PortState, SafetyChain, SafetyError, SafetyOptions,
    };

    #[test]
    fn an_accepted_material_says_which_rule_made_it_softer()
    -> std::result::Result<(), SafetyError> {
        let device = DeviceProfile::unlimited("example").with_least_damping(0.5);
        let of = |stiffness, damping| {
            Accepted::new(Impedance::new(stiffness, damping)?, 1.0, &device, 1000.0)
        };
        let said = "stiffness 750, damping 0.125, 0.25 times as requested: K ≤ 2 (b − |B|) / T";
        assert_eq!(of(3000.0, 0.5)?.to_string(), said);
        let said = "stiffness 500, damping 0, as requested";
        assert_eq!(of(500.0, 0.0)?.to_string(), said);
        Ok(())
    }

    #[test]
    fn a_report_names_the_stages_that_changed_a_force() -> std::result::Result<(), SafetyError>
    {
        let device = DeviceProfile::unlimited("example").with_max_force(1.0);
        let options = SafetyOptions::new(Impedance::default()).with_rise_time(0.0);
        let mut chain = SafetyChain::<2>::new(&device, 1000.0, options)?;
        let mut step = |force| chain.step(Vector([force, 0.0]), &PortState::at_rest());
        step(0.5);
        step(2.0);
        let said = "2 ticks, changed by: force limit 1";
        assert_eq!(chain.report().to_string(), said);
        Ok(())
    }
}
