// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the safety chains of a servo did.

use palpate_safety::{ReadingsReport, SafetyReport, StageTicks, WrenchChain};

use super::Renderer;
use crate::ports::Port;

impl Renderer {
    /// The report of every contact point's safety chain so far; empty for an
    /// [unprotected](crate::Unprotected) servo.
    #[must_use]
    #[inline(never)]
    pub fn safety(&self) -> Vec<SafetyReport> {
        self.with_ports(Port::report, WrenchChain::report)
            .map(|(report, readings)| report.with_readings(readings))
            .collect()
    }

    /// What the safety chain of each contact point says, that of force alone or that of force and
    /// torque, and the readings that were held back before it.
    fn with_ports<'a, T: 'a>(
        &'a self,
        of_port: fn(&Port) -> T,
        of_chain: fn(&WrenchChain) -> T,
    ) -> impl Iterator<Item = (T, ReadingsReport)> + 'a {
        let turning = self.coupled_tool().and_then(|coupled| coupled.port.as_ref());
        let chain = turning.and_then(|turning| turning.chain.as_ref());
        let ports = self.contacts.points.iter().filter_map(|point| point.port.as_ref());
        ports.map(move |port| {
            let readings = port.readings();
            let readings = turning.map_or(readings, |turning| turning.with_turns(readings));
            (chain.map_or_else(|| of_port(port), of_chain), readings)
        })
    }

    /// In how many ticks each stage of the safety chains of all contact points has acted; zero for an
    /// [unprotected](crate::Unprotected) servo.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    #[inline(never)]
    pub fn stage_ticks(&self) -> StageTicks {
        self.with_ports(Port::stage_ticks, WrenchChain::stage_ticks)
            .map(|(ticks, readings)| ticks.with_readings(&readings))
            .sum()
    }
}
