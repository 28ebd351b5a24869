// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The ports between contact points, or a tool, and a protected device.

use palpate_field::{Rotation, Vector};

use crate::accepted_bodies::AcceptedBodies;
use crate::energy::Energy;
use crate::error::HapticsError;
use crate::protection::Protection;
use palpate_safety::{
    Acceptance, Accepted, DeviceLimits, Impedance, PassivityReport, PerMotion, PointState,
    PortState, Readings, ReadingsReport, SafetyChain, SafetyOptions, SafetyReport, TurnState,
    VelocityEstimator, WrenchChain,
};

impl<const D: usize> Protection<D> {
    /// Makes the port of one contact point.
    pub(crate) fn port(
        &self,
        bodies: &AcceptedBodies<D>,
        rate: f64,
    ) -> Result<Port<D>, HapticsError> {
        let along = bodies.along().map(|accepted| accepted.impedance);
        let options = self.safety_options(along.unwrap_or_default());
        Ok(Port {
            chain: SafetyChain::new(&self.profile, rate, options)?,
            readings: Readings::new(&self.profile, rate)?,
            held: 0.0,
            period: 1.0 / rate,
            estimator: VelocityEstimator::new(rate, self.profile.encoder_step)?,
            has_steps: self.profile.encoder_step > 0.0,
        })
    }

    /// Makes the port between a tool and a device with rotation; `None` for other devices.
    pub(crate) fn turning(
        &self,
        bodies: &AcceptedBodies<D>,
        rate: f64,
    ) -> Result<Option<TurningPort<D>>, HapticsError> {
        let Some(turning) = &self.profile.turning else { return Ok(None) };
        let chain = if let Some((along, about)) = bodies.wrench() {
            let (along_limits, about_limits) =
                (DeviceLimits::along(&self.profile), DeviceLimits::about(turning));
            let limits = PerMotion { along: &along_limits, about: &about_limits };
            let options = self.safety_options(along.impedance);
            let accepted = PerMotion { along: along.clone(), about: about.clone() };
            Some(WrenchChain::new(limits, accepted, &options, rate)?)
        } else {
            None
        };
        Ok(Some(TurningPort {
            chain,
            estimator: VelocityEstimator::new(rate, turning.encoder_step)?,
            has_steps: turning.encoder_step > 0.0,
            last: None,
            angle: Vector::ZERO,
        }))
    }

    /// The options of a safety chain for an impedance that was already accepted.
    fn safety_options(&self, impedance: Impedance) -> SafetyOptions {
        SafetyOptions::new(impedance)
            .with_scale(self.map.scale())
            .with_acceptance(Acceptance::AsIs)
            .with_passivity_control(self.has_passivity_control)
            .with_recovery(self.recovery)
            .with_rise_rate(self.rise_rate)
    }
}

/// The port between one contact point and the device.
#[derive(Clone, Debug)]
pub(crate) struct Port<const D: usize> {
    chain: SafetyChain<D>,
    readings: Readings<D>,
    /// By how much this tick is late because its reading was held back [s]: a period, or zero.
    held: f64,
    /// The duration of a tick [s].
    period: f64,
    estimator: VelocityEstimator<D>,
    /// Whether encoder steps make it necessary to estimate the velocity.
    has_steps: bool,
}

impl<const D: usize> Port<D> {
    /// The state of the device in a tick that is `late` [s]: at rest where it was if no hand can have
    /// made the reading. Its velocity is estimated from positions if the device has encoder
    /// steps, and is the device's own otherwise.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn state(&mut self, state: PointState<D>, late: f64) -> PointState<D> {
        let counts = self.readings.counts(state.position, late);
        // A device that cannot be read is as good as late: its force is stale.
        self.held = if counts { 0.0 } else { self.period };
        let state = match self.readings.last().filter(|_| !counts) {
            Some(position) => PointState::at_rest(position),
            None => state,
        };
        if !self.has_steps {
            return state;
        }
        PointState { velocity: self.estimator.update(state.position), ..state }
    }

    /// The force to write [N], in device coordinates, for a wanted force of at most `max_force`.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn write(
        &mut self,
        wanted: Vector<f64, D>,
        max_force: f64,
        state: &PortState<D>,
    ) -> Vector<f64, D> {
        let late = self.late(state.late);
        self.chain.step_within(wanted, max_force, &PortState { late, ..*state })
    }

    /// Replaces the accepted impedance.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn renew(&mut self, accepted: &Accepted) {
        self.chain.renew(accepted);
    }

    /// Lowers the largest force [N].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn limit_force(&mut self, max_force: f64) {
        self.chain.limit_force(max_force);
    }

    /// Stops or releases the force.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn stop(&mut self, is_stopped: bool) {
        if is_stopped { self.chain.stop() } else { self.chain.release() }
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn energy(&self) -> Energy {
        energy(&self.chain.passivity())
    }

    pub(crate) fn report(&self) -> SafetyReport {
        self.chain.report().with_readings(self.readings.report())
    }

    /// By how much a tick that is `late` [s] is late in all, with its reading.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn late(&self, late: f64) -> f64 {
        late + self.held
    }

    /// What was held back.
    pub(crate) fn readings(&self) -> ReadingsReport {
        self.readings.report()
    }
}

/// The rotational port between a tool and a device, beside the [`Port`] of its contact point.
#[derive(Clone, Debug)]
pub(crate) struct TurningPort<const D: usize> {
    /// The safety chain of force and torque, which replaces the chain of the [`Port`]; `None`
    /// for a device that gives no torque.
    pub(crate) chain: Option<WrenchChain<D>>,
    estimator: VelocityEstimator<3>,
    /// Whether the orientation has encoder steps.
    has_steps: bool,
    last: Option<Rotation<D>>,
    /// The sum of all rotation vectors so far [rad].
    angle: Vector<f64, 3>,
}

impl<const D: usize> TurningPort<D> {
    /// Orientation and angular velocity of the device, the latter estimated as in
    /// [`Port::state`], and the sum of all rotation vectors so far [rad].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn state(
        &mut self,
        turn: Option<TurnState<D>>,
    ) -> (Option<TurnState<D>>, Vector<f64, 3>) {
        let Some(mut turn) = turn else { return (None, self.angle) };
        let last = self.last.replace(turn.orientation).unwrap_or(turn.orientation);
        self.angle += last.turn_to(&turn.orientation);
        if self.has_steps {
            turn.angular_velocity = self.estimator.update(self.angle);
        }
        (Some(turn), self.angle)
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn energy(&self) -> Option<Energy> {
        self.chain.as_ref().map(|chain| energy(&chain.passivity()))
    }
}

fn energy(seen: &PassivityReport) -> Energy {
    Energy { taken: seen.energy_in, given: seen.energy_out, kept: seen.dissipated }
}
