// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The chain of stages.

use std::iter::Sum;

use palpate_device::{DeviceProfile, NumberError};
use palpate_field::{Point, Vector};

use crate::acceptance::Accepted;
use crate::approach::Change;
use crate::channel::{Channel, Given, Risen, TickInput};
use crate::drive::{Drive, DriveReport, MovingBodies};
use crate::effect::Effect;
use crate::error::SafetyError;
use crate::finite;
use crate::free_energy::{FreeEnergy, FreeEnergyOptions, FreeInput, Passed};
use crate::limit::{Cut, Wanted, cut};
use crate::limit_cycle::{CycleInput, ForcesOf, LimitCycle, LimitCycleOptions};
use crate::limits::{DeviceLimits, Impedance, SafetySettings};
use crate::passivity::{Passivity, PassivityOptions, PassivityReport, PortMotion};
use crate::readings::ReadingsReport;
use crate::report::{Effects, SafetyReport};

/// The input of a contact point's safety chain in a tick, beside the wanted force. In device
/// coordinates ([`WorkspaceMap`](crate::WorkspaceMap)), because the limits are the device's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PortState {
    /// The device point [m], unfiltered.
    pub position: Point<3>,
    /// The velocity of the device point [m/s], for example from a
    /// [`VelocityEstimator`](crate::VelocityEstimator).
    pub velocity: Vector<f64, 3>,
    /// A force on the hand that is added to the wanted force [N]: that of guides and magnets. It may
    /// release its potential energy. Any further energy that it releases is bounded by what the
    /// device's damping dissipates, plus the [reserve](crate::SafetySettings::reserve), plus 0.25 mJ
    /// during a smooth cut, plus one tick. Energy that it releases on purpose, when it comes back to a
    /// hand at rest or rises again, is [reported](crate::FreeForceReport::credited). The chain does
    /// not know a delay of the transport. Encoder steps make motions seem to dissipate more than they
    /// do; guides up to `2 b / T` and `2 f_c / Δ` release no more for it.
    pub free_force: Vector<f64, 3>,
    /// By how much the tick began too late [s]; zero in time. A tick without a new reading is as
    /// good as late.
    pub late: f64,
    /// The time between the last two positions [s]; `None`: a period plus the lateness.
    pub elapsed: Option<f64>,
    /// The part of the force to render in this tick, from which the force
    /// [rises](crate::SafetySettings::rise_rate) again, at once. Normally 1; 0 after the proxy was placed
    /// anew or a body moved onto it; between 0 and 1 after a body was replaced by a stiffer one.
    pub start: f64,
    /// What happened to the contact point in this tick beside the motion of the hand.
    pub change: Change,
    /// By how much the motion of the hand relative to the bodies that push it changes the force in this
    /// tick, at most [N]. After a handover the force follows that much beyond its step.
    pub explained: f64,
    /// The stiffness behind the wanted force [N/m]: force over depth. That of the accepted impedance
    /// counts if this is more, or infinite.
    pub stiffness: f64,
    /// How the bodies that push the hand moved since the tick before.
    pub bodies: MovingBodies<Vector<f64, 3>>,
}

impl PortState {
    /// A point at rest at the origin, in a tick that is not late.
    #[must_use]
    pub fn at_rest() -> Self {
        let still = Vector::ZERO;
        Self {
            position: still,
            velocity: still,
            free_force: still,
            late: 0.0,
            elapsed: None,
            start: 1.0,
            change: Change::None,
            explained: 0.0,
            stiffness: f64::INFINITY,
            bodies: MovingBodies::NONE,
        }
    }
}

/// What a safety chain is to render, and how it protects.
///
/// ```
/// use palpate_safety::{Impedance, SafetyOptions};
///
/// let options = SafetyOptions::new(Impedance::default()).with(|s| s.rise_rate = 10.0);
/// assert_eq!((options.scale, options.settings.rise_rate), (1.0, 10.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SafetyOptions {
    /// The stiffness and damping to render, in the world.
    pub impedance: Impedance,
    /// Lengths in the world over lengths at the device:
    /// [`WorkspaceMap::scale`](crate::WorkspaceMap::scale).
    pub scale: f64,
    /// How the chain protects.
    pub settings: SafetySettings,
}

impl SafetyOptions {
    /// Options for `impedance` in a world of the device's scale, with the default settings.
    #[must_use]
    pub fn new(impedance: Impedance) -> Self {
        Self { impedance, scale: 1.0, settings: SafetySettings::default() }
    }

    /// These options with changed settings.
    #[must_use]
    pub fn with(mut self, change: impl FnOnce(&mut SafetySettings)) -> Self {
        change(&mut self.settings);
        self
    }
}

/// The safety chain of one contact point, from the wanted force to the written force.
///
/// The stages, in this order: stiffness and damping ([`Accepted`], at set-up), the rise of a force
/// that was zeroed and the approach after an edit or a handover, limit cycles
/// ([`LimitCycleReport`](crate::LimitCycleReport)), passivity of guides and magnets
/// ([`FreeForceReport`](crate::FreeForceReport)), passivity of walls, power of drives, slew limit,
/// force limit, continuous limit, guard against numbers that are not finite, deadline watchdog and
/// emergency stop. If no stage has to act, the written force equals the wanted force bit for bit.
///
/// # What is promised
///
/// For any input, in any tick:
///
/// - The force is finite and no larger than [`DeviceProfile::max_force`].
/// - In a tick, the force changes by no more than [`DeviceProfile::max_force_rate`] allows in a
///   period, also where ticks come sooner. There are two exceptions, which fall to zero in one tick:
///   an input that is not finite, and the emergency stop.
/// - With passivity control, the force of a wall up to `2 b / T` is never changed, because the
///   device's damping dissipates the energy that the wall leaks, as the encoders show it, which
///   coarse steps overestimate; but where the device oscillates by itself against the wall, the
///   wall becomes softer. A stiffer wall gives out
///   little more energy than it took in: at most 1 mJ for a wall three times as stiff, on 0.05
///   to 0.1 kg with 0.5 N·s/m at 1 kHz, held with 0 to 10 N·s/m and pushed with 1 N for 10 s,
///   from up to 50 mm away and in encoder steps of up to 30 µm (the tests of `palpate-haptics`
///   measure it). This needs a [`DeviceProfile::max_force_rate`] of at least `K v`, the rate at
///   which the force falls when the device leaves the wall; a slower limit holds forces that the
///   controller would remove, and impacts give out more.
///
/// The promise of passivity depends on the least damping of the device's profile, which is
/// often [assumed](DeviceProfile::assumed); the report says so.
///
/// # Examples
///
/// ```
/// use palpate_field::Vector;
/// use palpate_device::DeviceProfile;
/// use palpate_safety::{Impedance, PortState, SafetyChain, SafetyOptions};
///
/// # fn main() -> Result<(), palpate_safety::SafetyError> {
/// let device = DeviceProfile { max_force: 2.5, ..DeviceProfile::unlimited("example") };
/// let options = SafetyOptions::new(Impedance::default()).with(|s| s.rise_rate = f64::INFINITY);
/// let mut chain = SafetyChain::new(&device, 1000.0, options)?;
/// let state = PortState::at_rest();
/// assert_eq!(chain.step(Vector([0.0, 1.0, 0.0]), &state), Vector([0.0, 1.0, 0.0]));
/// assert_eq!(chain.step(Vector([3.0, 4.0, 0.0]), &state), Vector([1.5, 2.0, 0.0]));
/// chain.stop();
/// assert_eq!(chain.step(Vector([0.0, 1.0, 0.0]), &state), Vector([0.0, 0.0, 0.0]));
///
/// let report = chain.report();
/// assert_eq!((report.force_limit.ticks, report.force_limit.largest), (1, 2.5));
/// assert_eq!(report.emergency_stop.ticks, 1);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct SafetyChain {
    accepted: Accepted,
    cycle: LimitCycle<Vector<f64, 3>>,
    free: FreeEnergy<Vector<f64, 3>>,
    passivity: Passivity<Vector<f64, 3>>,
    drive: Drive<Vector<f64, 3>>,
    channel: Channel,
}

impl SafetyChain {
    /// A chain for `device` at `rate` [Hz].
    ///
    /// # Errors
    ///
    /// As [`Accepted::new`], or [`SafetyError::MaterialRefused`] of a
    /// [strict](crate::SafetySettings::is_strict) chain.
    /// [`SafetyError::Number`] if a limit of the device is not positive, its mass or least damping
    /// is negative, or an energy or a time of the options is negative or not finite.
    pub fn new(
        device: &DeviceProfile,
        rate: f64,
        options: SafetyOptions,
    ) -> Result<Self, SafetyError> {
        let rate = NumberError::check_rate(rate)?;
        let SafetyOptions { impedance, scale, settings } = options;
        let limits = DeviceLimits::along(device);
        let accepted = Accepted::of(impedance, scale, &limits, settings.acceptance, rate)?;
        let accepted = if settings.is_strict { accepted.unchanged()? } else { accepted };
        let damping = limits.least_damping.zero_or_more()?;
        let passivity = PassivityOptions {
            // A device with infinite damping is passive whatever it renders.
            is_on: settings.has_passivity_control && damping < f64::INFINITY,
            stiffness: accepted.device_stiffness,
            max_force: limits.max_force.positive()?,
            damping,
            mass: limits.mass.not_negative()?,
            max_rate: limits.max_force_rate.positive()?,
            reserve: NumberError::check_not_negative("reserve", settings.reserve, "J")?,
            rise_rate: settings.rise_rate,
            period: 1.0 / rate,
        };
        let encoder_step = limits.encoder_step.not_negative()?;
        let cycle = LimitCycleOptions::of(&passivity, encoder_step);
        Ok(Self {
            accepted,
            cycle: LimitCycle::new(cycle),
            free: FreeEnergy::new(FreeEnergyOptions {
                reserve: passivity.reserve,
                max_force: passivity.max_force,
            }),
            passivity: Passivity::new(passivity),
            drive: Drive::new(settings.max_drive_power()?, settings.rise_rate),
            channel: Channel::new(&limits, &settings, 1.0, rate)?,
        })
    }

    /// The stiffness and damping that the device renders; wanted forces must be computed with
    /// them.
    #[must_use]
    pub fn accepted(&self) -> &Accepted {
        &self.accepted
    }

    /// Replaces the accepted stiffness and damping by others for the same device.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn renew(&mut self, accepted: &Accepted) {
        self.accepted.renew(accepted);
        let stiffness = accepted.device_stiffness;
        let options = PassivityOptions { stiffness, ..*self.passivity.options() };
        let encoder_step = self.cycle.options().encoder_step;
        self.cycle.renew(LimitCycleOptions::of(&options, encoder_step));
        self.passivity.renew(options);
    }

    /// The duration of a tick [s].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn period(&self) -> f64 {
        self.passivity.options().period
    }

    /// One tick: the force to write [N] for the force `wanted` [N], both in device coordinates.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn step(&mut self, wanted: Vector<f64, 3>, state: &PortState) -> Vector<f64, 3> {
        self.tick(Wanted { force: wanted, effort: wanted.norm(), cut: 0.0 }, state)
    }

    /// As [`step`](Self::step), for a wanted force that is first shortened to `max_force` [N],
    /// which counts as the force limit's doing.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    ///
    /// ```
    /// use palpate_field::Vector;
    /// use palpate_device::DeviceProfile;
    /// use palpate_safety::{Impedance, PortState, SafetyChain, SafetyOptions};
    ///
    /// # fn main() -> Result<(), palpate_safety::SafetyError> {
    /// let device = DeviceProfile::unlimited("example");
    /// let options = SafetyOptions::new(Impedance::default()).with(|s| s.rise_rate = f64::INFINITY);
    /// let mut chain = SafetyChain::new(&device, 1000.0, options)?;
    /// let force = chain.step_within(Vector([3.0, 4.0, 0.0]), 1.0, &PortState::at_rest());
    /// assert_eq!(force, Vector([0.6, 0.8, 0.0]));
    /// let limit = chain.report().force_limit;
    /// assert_eq!((limit.ticks, limit.largest), (1, 4.0));
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn step_within(
        &mut self,
        wanted: Vector<f64, 3>,
        max_force: f64,
        state: &PortState,
    ) -> Vector<f64, 3> {
        let effort = wanted.norm();
        // Leave NaN unclamped: the guard stage detects it and zeroes the force.
        let uncut = Cut { force: wanted, taken: 0.0 };
        let Cut { force, taken } =
            if wanted.is_finite() { cut(wanted, max_force) } else { uncut };
        self.tick(Wanted { force, effort, cut: taken }, state)
    }

    fn tick(&mut self, wanted: Wanted<Vector<f64, 3>>, state: &PortState) -> Vector<f64, 3> {
        let Wanted { force: wanted, effort, cut } = wanted;
        // Stages with a state never see numbers that are not finite; the guard then writes
        // zero.
        let is_sound = finite::is_sound(wanted, state);
        let PortState { position, velocity, free_force, late, elapsed, stiffness, .. } = *state;
        let PortState { start, change, explained, bodies, .. } = *state;
        let input = TickInput { is_sound, late, start, change, explained, cut };
        let risen = self.channel.risen(wanted, free_force, &input);
        let Risen { wanted, part: rise, is_rising, .. } = risen;
        let effort = risen.effort(effort, wanted.norm());
        let rising = if rise < 1.0 { free_force * rise } else { free_force };
        let elapsed = finite::elapsed(elapsed, self.period() + late.max(0.0));
        let options = self.passivity.options();
        let stiffness = options.stiffness_of(stiffness);
        let bodies = if is_sound { bodies } else { MovingBodies::NONE };
        let frame = self.drive.enter(&bodies);
        let in_frame = position - frame.origin;
        let forces = ForcesOf { bodies: wanted, guides: rising };
        let seen = CycleInput::of(forces, effort, in_frame, stiffness).changed(&input);
        let is_disturbed = self.channel.is_late() || is_rising;
        let softness = self.cycle.observed(&seen.disturbed(is_disturbed), is_sound);
        let is_returning = self.cycle.is_returning() || self.drive.is_returning();
        let is_rising = is_rising || is_returning;
        let scale = rise * self.cycle.part();
        let Passed { force: free_force, spent } = self
            .free
            .step(FreeInput { force: free_force, position, scale, elapsed, is_sound }, options);
        let seen = PortMotion {
            position: in_frame,
            velocity: velocity - frame.way * (1.0 / elapsed),
            owed: frame.owed,
            effort,
            is_rising,
            elapsed,
            softness,
            spent,
            stiffness,
        };
        let observed = self.passivity.observed(wanted, &seen, is_sound);
        let observed = self.drive.limit(observed, &bodies, elapsed);
        let Given { force, of_bodies, share } = self.channel.step(observed, free_force, &input);
        self.passivity.written(of_bodies);
        self.drive.written(of_bodies);
        self.free.written(force - of_bodies, share);
        force
    }

    /// Lowers the force limit to `max_force` [N]; never raises it. The written force falls to
    /// the limit at the largest rate.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn limit_force(&mut self, max_force: f64) {
        self.channel.lower_limit(max_force);
        let options = *self.passivity.options();
        // `min` ignores NaN.
        let max_force = options.max_force.min(max_force).max(0.0);
        self.passivity.renew(PassivityOptions { max_force, ..options });
        self.free.lower_limit(max_force);
    }

    /// Begins an emergency stop: the force is zero until [`release`](Self::release).
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn stop(&mut self) {
        self.channel.stop();
    }

    /// Ends an emergency stop; the force begins at zero, as [`recovery`](crate::SafetySettings::recovery)
    /// says.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn release(&mut self) {
        self.channel.release();
    }

    /// `true` between [`stop`](Self::stop) and [`release`](Self::release).
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.channel.is_stopped()
    }

    /// The report of the passivity stage so far.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn passivity(&self) -> PassivityReport {
        self.passivity.report()
    }

    /// The work of moving bodies so far.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn drives(&self) -> DriveReport {
        self.drive.report()
    }

    /// What each stage has done, as in [`report`](Self::report).
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn stage_effects(&self) -> StageEffects {
        let first = BeforeLimits {
            cycles: self.cycle.report().effect,
            guides: self.free.report().effect,
            passivity: self.passivity.report().effect,
            drives: self.drive.report().effect,
        };
        StageEffects::of(first, &self.channel.effects, None)
    }

    /// The report of every stage so far.
    #[must_use]
    pub fn report(&self) -> SafetyReport {
        SafetyReport::of(&self.accepted, self.passivity.report(), &self.channel)
            .with_limit_cycles(self.cycle.report())
            .with_free_forces(self.free.report())
            .with_drives(self.drive.report())
    }
}

/// The stages in their order, in words.
const STAGES: [&str; 15] = [
    "held readings",
    "limit cycles",
    "passivity of guides",
    "passivity",
    "power of drives",
    "force rate",
    "largest force",
    "lasting force",
    "not a number",
    "rise from zero",
    "watchdog",
    "emergency stop",
    "torque rate",
    "largest torque",
    "lasting torque",
];

/// What each stage of a safety chain, or of several together, has done.
///
/// ```
/// use palpate_safety::StageEffects;
///
/// let quiet = StageEffects::default();
/// assert_eq!(quiet.named().count(), 15);
/// assert!(quiet.named().all(|(_, effect)| effect.ticks == 0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StageEffects([Effect; STAGES.len()]);

/// What the stages before the limits have done.
pub(crate) struct BeforeLimits {
    pub(crate) cycles: Effect,
    pub(crate) guides: Effect,
    pub(crate) passivity: Effect,
    pub(crate) drives: Effect,
}

impl StageEffects {
    /// Each stage in words with what it has done, in the order in which the stages act. How much held
    /// readings change a force is not known.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, Effect)> + '_ {
        STAGES.into_iter().zip(self.0)
    }

    /// What a chain has done: the stages before its limits, of its force, and of its torque.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn of(
        BeforeLimits { cycles, guides, passivity, drives }: BeforeLimits,
        force: &Effects,
        torque: Option<&Effects>,
    ) -> Self {
        let turning = |of: fn(&Effects) -> Effect| torque.map_or(Effect::default(), of);
        Self([
            Effect::default(),
            cycles,
            guides,
            passivity,
            drives,
            force.slew,
            force.force_limit,
            force.continuous,
            force.guard,
            force.ramp,
            force.watchdog,
            force.emergency_stop,
            turning(|torque| torque.slew),
            turning(|torque| torque.force_limit),
            turning(|torque| torque.continuous),
        ])
    }

    /// These with readings that were held back before the chain.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn with_readings(mut self, readings: &ReadingsReport) -> Self {
        let [held, ..] = &mut self.0;
        held.ticks = readings.held + readings.turns_held;
        self
    }
}

impl From<&SafetyReport> for StageEffects {
    fn from(report: &SafetyReport) -> Self {
        let force = Effects {
            slew: report.slew,
            force_limit: report.force_limit,
            continuous: report.continuous.effect,
            guard: report.guard,
            ramp: report.ramp,
            watchdog: report.watchdog.effect,
            emergency_stop: report.emergency_stop,
            ..Effects::default()
        };
        let torque = report.turning.as_ref().map(|turning| Effects {
            slew: turning.slew,
            force_limit: turning.torque_limit,
            continuous: turning.continuous.effect,
            ..Effects::default()
        });
        let first = BeforeLimits {
            cycles: report.limit_cycles.effect,
            guides: report.free_forces.effect,
            passivity: report.passivity.effect,
            drives: report.drives.effect,
        };
        Self::of(first, &force, torque.as_ref()).with_readings(&report.readings)
    }
}

impl Sum for StageEffects {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |mut sum, one| {
            sum.0.iter_mut().zip(one.0).for_each(|(sum, effect)| sum.add(effect));
            sum
        })
    }
}
