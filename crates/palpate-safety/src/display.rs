// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Reports as a sentence each.

use std::fmt::{Display, Formatter, Result};

use crate::acceptance::{Accepted, Rule};
use crate::passivity::PassivityReport;
use crate::report::SafetyReport;

impl Display for Accepted {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let mut part = |name, number, factor, rule: Option<Rule>| {
            write!(f, "{name} {number}")?;
            rule.map_or(Ok(()), |rule| {
                write!(f, " ({factor} times as requested: {})", rule.condition())
            })
        };
        let impedance = self.impedance;
        part("stiffness", impedance.stiffness(), self.stiffness_factor, self.stiffness_rule)?;
        part(", damping", impedance.damping(), self.damping_factor, self.damping_rule)
    }
}

impl Display for SafetyReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let stages = [
            ("readings held back", self.readings.held + self.readings.turns_held),
            ("limit cycles", self.limit_cycles.effect.ticks),
            ("passivity of guides", self.free_forces.effect.ticks),
            ("passivity", self.passivity.effect.ticks),
            ("power of drives", self.drives.effect.ticks),
            ("slew limit", self.slew.ticks),
            ("force limit", self.force_limit.ticks),
            ("continuous limit", self.continuous.effect.ticks),
            ("guard", self.guard.ticks),
            ("ramp", self.ramp.ticks),
            ("watchdog", self.watchdog.effect.ticks),
            ("emergency stop", self.emergency_stop.ticks),
        ];
        write!(f, "{} ticks, changed by: ", self.ticks)?;
        let mut acted = stages.iter().filter(|(_, ticks)| *ticks > 0);
        let Some((first, ticks)) = acted.next() else { return f.write_str("no stage") };
        write!(f, "{first} {ticks}")?;
        acted.try_for_each(|(stage, ticks)| write!(f, ", {stage} {ticks}"))
    }
}

impl Display for PassivityReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let [taken, given, kept] =
            [self.energy_in, self.energy_out, self.dissipated].map(|energy| 1e3 * energy);
        write!(
            f,
            "{taken:.3} mJ taken from the hand, {given:.3} mJ given, {kept:.3} mJ kept back "
        )?;
        write!(f, "in {} ticks", self.effect.ticks)
    }
}

#[cfg(test)]
mod tests {
    use palpate_field::Vector;

    use crate::{
        Accepted, Impedance, PassivityReport, PortState, SafetyChain, SafetyError,
        SafetyOptions,
    };
    use palpate_device::DeviceProfile;

    #[test]
    fn an_accepted_material_says_which_rule_made_it_softer()
    -> std::result::Result<(), SafetyError> {
        let device = DeviceProfile {
            max_stiffness: 1500.0,
            least_damping: 1.0,
            ..DeviceProfile::unlimited("example")
        };
        let of = |stiffness, damping| {
            Accepted::new(Impedance::new(stiffness, damping)?, 1.0, &device, 1000.0)
        };
        let said = "stiffness 1500 (0.5 times as requested: K ≤ the device's largest stiffness at \
                    this rate), damping 0.25 (0.5 times as requested: B ≤ b − K T / 2)";
        assert_eq!(of(3000.0, 0.5)?.to_string(), said);
        assert_eq!(of(500.0, 0.0)?.to_string(), "stiffness 500, damping 0");
        Ok(())
    }

    #[test]
    fn a_report_names_the_stages_that_changed_a_force() -> std::result::Result<(), SafetyError>
    {
        let device = DeviceProfile { max_force: 1.0, ..DeviceProfile::unlimited("example") };
        let options =
            SafetyOptions::new(Impedance::default()).with(|s| s.rise_rate = f64::INFINITY);
        let mut chain = SafetyChain::new(&device, 1000.0, options)?;
        let mut step = |force| chain.step(Vector([force, 0.0, 0.0]), &PortState::at_rest());
        step(0.5);
        step(2.0);
        let said = "2 ticks, changed by: force limit 1";
        let mut report = chain.report();
        assert_eq!(report.to_string(), said);
        (report.readings.held, report.readings.turns_held) = (2, 3);
        let said = "2 ticks, changed by: readings held back 5, force limit 1";
        assert_eq!(report.to_string(), said);
        Ok(())
    }

    #[test]
    fn energies_are_said_in_millijoules() {
        let report = PassivityReport {
            energy_in: 0.0125,
            energy_out: 0.002,
            dissipated: 5e-4,
            ..PassivityReport::default()
        };
        let said =
            "12.500 mJ taken from the hand, 2.000 mJ given, 0.500 mJ kept back in 0 ticks";
        assert_eq!(report.to_string(), said);
    }
}
