// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The ports between contact points, or a tool, and a protected device.

use palpate_field::{Point, Vector};

use crate::accepted_bodies::{AcceptedBodies, Protection};
use crate::error::HapticsError;
use crate::event::Energy;
use palpate_device::{PointState, TurnState};
use palpate_safety::{
    Acceptance, Accepted, Arrival, DeviceLimits, DriveReport, Impedance, PassivityReport,
    PerMotion, PortState, Readings, ReadingsReport, SafetyChain, SafetyOptions, SafetyReport,
    SafetySettings, StageEffects, TurnReadings, VelocityEstimator, WrenchChain,
};

impl Protection {
    /// Makes the port of one contact point.
    pub(crate) fn port(
        &self,
        bodies: &AcceptedBodies,
        rate: f64,
    ) -> Result<Port, HapticsError> {
        let along = bodies.along().map(|accepted| accepted.impedance);
        let options = self.safety_options(along.unwrap_or_default());
        Ok(Port {
            chain: SafetyChain::new(&self.profile, rate, options)?,
            readings: Readings::new(&self.profile)?,
            last: None,
            elapsed: None,
            uncounted: 0.0,
            period: 1.0 / rate,
            estimator: VelocityEstimator::new(rate, self.profile.encoder_step)?,
            has_steps: self.profile.encoder_step > 0.0,
        })
    }

    /// Makes the port between a tool and a device with rotation; `None` for other devices.
    pub(crate) fn turning(
        &self,
        bodies: &AcceptedBodies,
        rate: f64,
    ) -> Result<Option<TurningPort>, HapticsError> {
        let Some(turning) = &self.profile.turning else { return Ok(None) };
        let chain = if let Some((along, about)) = bodies.wrench() {
            let (along_limits, about_limits) =
                (DeviceLimits::along(&self.profile), DeviceLimits::about(turning));
            let limits = PerMotion { along: &along_limits, about: &about_limits };
            let options = self.safety_options(along.impedance);
            let accepted = PerMotion { along: along.clone(), about: about.clone() };
            Some(WrenchChain::new(limits, accepted, &options.settings, rate)?)
        } else {
            None
        };
        Ok(Some(TurningPort {
            chain,
            readings: TurnReadings::new(turning)?,
            estimator: VelocityEstimator::new(rate, turning.encoder_step)?,
            has_steps: turning.encoder_step > 0.0,
            last: None,
            angle: Vector::ZERO,
        }))
    }

    /// The options of a safety chain for an impedance that was already accepted.
    pub(crate) fn safety_options(&self, impedance: Impedance) -> SafetyOptions {
        let settings =
            SafetySettings { acceptance: Acceptance::AsIs, is_strict: false, ..self.settings };
        SafetyOptions { impedance, scale: self.map.scale(), settings }
    }
}

/// The port between one contact point and the device.
#[derive(Clone, Debug)]
pub(crate) struct Port {
    chain: SafetyChain,
    readings: Readings,
    /// The state in the tick before.
    last: Option<PointState>,
    /// The time between the last reading that counted and that of this tick [s]; `None` if this
    /// tick has none.
    elapsed: Option<f64>,
    /// The time of the readings that did not count since the last one that did [s].
    uncounted: f64,
    /// The duration of a tick [s].
    period: f64,
    estimator: VelocityEstimator,
    /// Whether encoder steps make it necessary to estimate the velocity.
    has_steps: bool,
}

impl Port {
    /// The state of the device in a tick: that of the tick before if nothing was measured, or
    /// nothing that a hand can have made; `is_turn_sound` says so of the orientation that was read
    /// beside it. Its velocity is estimated from positions if the device has encoder steps, and is
    /// the device's own otherwise.
    ///
    /// A state that repeats keeps its velocity: at rest it would look as if the hand had stopped, and
    /// the force would jump.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn state(
        &mut self,
        state: PointState,
        arrival: Arrival,
        is_turn_sound: bool,
    ) -> PointState {
        let counted = arrival
            .elapsed
            .filter(|time| self.readings.counts(state.position, *time) && is_turn_sound);
        let Some(elapsed) = counted else {
            self.uncounted += arrival.elapsed.unwrap_or(0.0);
            self.elapsed = None;
            // What repeats before the first reading is no state.
            return self.last.unwrap_or(PointState::at_rest(Vector([f64::NAN; 3])));
        };
        let elapsed = std::mem::take(&mut self.uncounted) + elapsed;
        self.elapsed = Some(elapsed);
        let state = if self.has_steps {
            let velocity = self.estimator.update_after(state.position, elapsed);
            PointState { velocity, ..state }
        } else {
            state
        };
        self.last = Some(state);
        state
    }

    /// The time since the last reading that counted [s]; `None` if this tick has none that does.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn elapsed(&self) -> Option<f64> {
        self.elapsed
    }

    /// The force to write [N], in device coordinates, for a wanted force of at most `max_force`.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn write(
        &mut self,
        wanted: Vector<f64, 3>,
        max_force: f64,
        state: &PortState,
    ) -> Vector<f64, 3> {
        let (late, elapsed) = (self.late(state.late), self.elapsed);
        self.chain.step_within(wanted, max_force, &PortState { late, elapsed, ..*state })
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
        energy(&self.chain.passivity(), &self.chain.drives())
    }

    /// In how many ticks each stage of the safety chain has acted, without the readings.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn stage_effects(&self) -> StageEffects {
        self.chain.stage_effects()
    }

    /// What the safety chain did, without the readings.
    pub(crate) fn report(&self) -> SafetyReport {
        self.chain.report()
    }

    /// By how much a tick that is `late` [s] is late in all: without a reading that counts its force
    /// is a period older.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn late(&self, late: f64) -> f64 {
        late + if self.elapsed.is_some() { 0.0 } else { self.period }
    }

    /// What was held back of positions.
    pub(crate) fn readings(&self) -> ReadingsReport {
        self.readings.report()
    }
}

/// The rotational port between a tool and a device, beside the [`Port`] of its contact point.
#[derive(Clone, Debug)]
pub(crate) struct TurningPort {
    /// The safety chain of force and torque, which replaces the chain of the [`Port`]; `None`
    /// for a device that gives no torque.
    pub(crate) chain: Option<WrenchChain>,
    readings: TurnReadings,
    estimator: VelocityEstimator,
    /// Whether the orientation has encoder steps.
    has_steps: bool,
    /// The state in the tick before.
    last: Option<TurnState>,
    /// The sum of all rotation vectors so far [rad].
    angle: Vector<f64, 3>,
}

impl TurningPort {
    /// Whether what was read of the orientation, beside a position, counts. A position that is no
    /// number is that of a device which was lost: its orientation may be any once it is found.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn counts(
        &mut self,
        turn: Option<TurnState>,
        position: Point<3>,
        elapsed: Option<f64>,
    ) -> bool {
        if !position.is_finite() {
            self.readings.forget();
            return true;
        }
        match (turn, elapsed) {
            (Some(turn), Some(elapsed)) => self.readings.counts(turn.orientation, elapsed),
            (None, Some(elapsed)) => {
                self.readings.miss(elapsed);
                true
            }
            (_, None) => true,
        }
    }

    /// The report of positions with what was held back of orientations.
    pub(crate) fn with_turns(&self, readings: ReadingsReport) -> ReadingsReport {
        readings.with_turns(&self.readings)
    }

    /// Orientation and angular velocity of the device, measured `elapsed` after the last [s], and the
    /// sum of all rotation vectors so far [rad]. As in [`Port::state`], the angular velocity is
    /// estimated, and the state of the tick before repeats if nothing was measured.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn state(
        &mut self,
        turn: Option<TurnState>,
        elapsed: Option<f64>,
    ) -> (Option<TurnState>, Vector<f64, 3>) {
        let Some((mut turn, elapsed)) = turn.zip(elapsed) else {
            return (turn.and(self.last), self.angle);
        };
        let last = self.last.map_or(turn.orientation, |last| last.orientation);
        self.angle += last.turn_to(&turn.orientation);
        if self.has_steps {
            turn.angular_velocity = self.estimator.update_after(self.angle, elapsed);
        }
        self.last = Some(turn);
        (Some(turn), self.angle)
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn energy(&self) -> Option<Energy> {
        self.chain.as_ref().map(|chain| energy(&chain.passivity(), &chain.drives()))
    }
}

fn energy(seen: &PassivityReport, drives: &DriveReport) -> Energy {
    Energy {
        taken: seen.energy_in,
        given: seen.energy_out,
        driven: drives.driven,
        kept: seen.dissipated,
    }
}
