// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The safety chain of one contact point, from the wanted force to the one that is written.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::num::NonZeroU32;

use palpate_field::{Point, Vector};

use crate::acceptance::{Acceptance, Accepted};
use crate::channel::{Channel, Moment};
use crate::device::DeviceProfile;
use crate::error::{SafetyError, not_negative, positive};
use crate::finite;
use crate::impedance::Impedance;
use crate::limits::Limits;
use crate::passivity::{Passivity, PassivityOptions, PassivityReport, Seen};
use crate::report::SafetyReport;

/// One contact point in a tick, as its safety chain sees it. Device coordinates, as it is the
/// device that has limits: [`WorkspaceMap`](crate::WorkspaceMap) gives them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PortState<const D: usize> {
    /// Where the hand holds the device [m], unfiltered.
    pub position: Point<D>,
    /// How fast it moves [m/s], as by [`VelocityEstimator`](crate::VelocityEstimator).
    pub velocity: Vector<f64, D>,
    /// A force on the hand that is added to the wanted one and is not observed for passivity
    /// [N]: that of guides and magnets, which is a function of the place and gives back what
    /// it takes.
    pub free_force: Vector<f64, D>,
    /// The tick began too late.
    pub is_late: bool,
    /// The part of the force that is given in this tick, from which it rises to all of it: 1 as
    /// a rule; 0 if the point was placed inside a shape, or a shape was moved onto it; less than
    /// one if a stiffer material took the place of another. In one tick; in each of many, the
    /// force stays down.
    pub start: f64,
}

impl<const D: usize> PortState<D> {
    /// A point at rest at the origin, in time.
    #[must_use]
    pub fn at_rest() -> Self {
        let still = Vector::ZERO;
        let (is_late, start) = (false, 1.0);
        Self { position: still, velocity: still, free_force: still, is_late, start }
    }
}

/// What a safety chain protects from, beside the limits of the device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SafetyOptions {
    /// What is to be rendered, in the world.
    pub impedance: Impedance,
    /// Lengths in the world over lengths at the device:
    /// [`WorkspaceMap::scale`](crate::WorkspaceMap::scale).
    pub scale: f64,
    /// What is done with a material that the device cannot render.
    pub acceptance: Acceptance,
    /// Whether the passivity controller acts. It observes anyway. Forces that are to do work on
    /// the hand, such as attractions, are incompatible with it.
    pub has_passivity_control: bool,
    /// Energy that may be given out before any was taken in [J].
    pub reserve: f64,
    /// The time constant with which the motors cool [s]. Makers do not state it.
    pub cooling_time: f64,
    /// The time over which the force rises after the start, a placement or an emergency [s].
    pub rise_time: f64,
    /// So many late ticks in a row lower the force to zero; as many in time raise it again.
    pub late_ticks: NonZeroU32,
    /// The time over which late ticks lower the force to zero [s].
    pub fall_time: f64,
}

impl SafetyOptions {
    /// For `impedance` in a world as large as the device's: scaled where it must be, passivity
    /// controlled with a reserve of 0.1 mJ, which the hand does not feel; motors that cool in
    /// 2 s; forces that rise in 0.2 s; and fall in 0.02 s after 5 late ticks.
    #[must_use]
    pub fn new(impedance: Impedance) -> Self {
        Self {
            impedance,
            scale: 1.0,
            acceptance: Acceptance::Scaled,
            has_passivity_control: true,
            reserve: 1e-4,
            cooling_time: 2.0,
            rise_time: 0.2,
            late_ticks: NonZeroU32::MIN.saturating_add(4),
            fall_time: 0.02,
        }
    }
}

/// The safety chain of one contact point: from the wanted force to the one that is written.
///
/// In this order: the material and the device's stiffness and damping ([`Accepted`], at
/// set-up), passivity, the fastest change of force, the largest force, the continuous force,
/// the guard against what is not a number, and the factors of ramp, deadline watchdog and
/// emergency stop. Where nothing is wrong, the force written is the wanted one, bit for bit.
///
/// # What is promised
///
/// Whatever comes in, in any tick:
///
/// - The force is finite and no larger than [`DeviceProfile::max_force`].
/// - It changes by no more than [`DeviceProfile::max_force_rate`] a second. The exceptions fall
///   to zero in one tick: an input that is not a number, and the emergency stop.
/// - With passivity control, a wall of up to `2 b / T` is never changed, as the device's damping
///   eats what it leaks. A stiffer one gives out little more than it took in: three times as
///   stiff, on 0.05 to 0.1 kg with 0.5 N·s/m at 1 kHz, held with 0 to 10 N·s/m and pushed with
///   1 N for 10 s, from up to 50 mm away and in encoder steps of up to 30 µm, at most 1 mJ
///   (`tests/safety.rs`). The force must be allowed to change as fast as it does on the way out
///   of the wall, `K v`: a slower [`DeviceProfile::max_force_rate`] holds forces that the
///   controller would take back, and after strikes more is given out.
///
/// The least damping of the device's profile is what the promise of passivity stands on, and is
/// often [assumed](DeviceProfile::assumed); the report says so.
///
/// # Examples
///
/// ```
/// use palpate_field::Vector;
/// use palpate_safety::{DeviceProfile, Impedance, PortState, SafetyChain, SafetyOptions};
///
/// # fn main() -> Result<(), palpate_safety::SafetyError> {
/// let device = DeviceProfile { max_force: 2.5, ..DeviceProfile::unlimited("example") };
/// let options = SafetyOptions { rise_time: 0.0, ..SafetyOptions::new(Impedance::default()) };
/// let mut chain = SafetyChain::new(&device, 1000.0, options)?;
/// let state = PortState::at_rest();
/// assert_eq!(chain.step(Vector([0.0, 1.0]), &state), Vector([0.0, 1.0]));
/// assert_eq!(chain.step(Vector([3.0, 4.0]), &state), Vector([1.5, 2.0]));
/// chain.stop();
/// assert_eq!(chain.step(Vector([0.0, 1.0]), &state), Vector([0.0, 0.0]));
///
/// let report = chain.report();
/// assert_eq!((report.force_limit.ticks, report.force_limit.largest), (1, 2.5));
/// assert_eq!(report.emergency_stop.ticks, 1);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct SafetyChain<const D: usize> {
    accepted: Accepted,
    passivity: Passivity<Vector<f64, D>>,
    channel: Channel<D>,
}

impl<const D: usize> SafetyChain<D> {
    /// A chain for `device` at `rate` [Hz].
    ///
    /// # Errors
    ///
    /// As [`Accepted::new`] or, where the options say so, [`Accepted::strict`];
    /// [`SafetyError::Number`] if a limit of the device is not positive, its mass negative, or
    /// an energy or a time of the options negative or not finite.
    pub fn new(
        device: &DeviceProfile,
        rate: f64,
        options: SafetyOptions,
    ) -> Result<Self, SafetyError> {
        let rate = positive("rate", rate, "Hz")?;
        let SafetyOptions { impedance, scale, .. } = options;
        let limits = Limits::along(device);
        let accepted = Accepted::of(impedance, scale, &limits, options.acceptance, rate)?;
        let damping = limits.least_damping.positive()?;
        let passivity = PassivityOptions {
            // A device that loses any energy at once is passive whatever it renders.
            is_on: options.has_passivity_control && damping < f64::INFINITY,
            stiffness: accepted.device_stiffness,
            damping,
            mass: limits.mass.not_negative()?,
            max_rate: limits.max_force_rate.positive()?,
            reserve: not_negative("reserve", options.reserve, "J")?,
            period: 1.0 / rate,
        };
        Ok(Self {
            accepted,
            passivity: Passivity::new(passivity),
            channel: Channel::new(&limits, &options, rate)?,
        })
    }

    /// The material as the device renders it: what the wanted forces are to be made with.
    #[must_use]
    pub fn accepted(&self) -> &Accepted {
        &self.accepted
    }

    /// Renders another material from now on, accepted for the same device.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn renew(&mut self, accepted: &Accepted) {
        self.accepted.renew(accepted);
        let stiffness = accepted.device_stiffness;
        let options = PassivityOptions { stiffness, ..*self.passivity.options() };
        self.passivity.renew(options);
    }

    /// The force to write [N] where `wanted` [N] is wanted, at the device, in one tick.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn step(&mut self, wanted: Vector<f64, D>, state: &PortState<D>) -> Vector<f64, D> {
        // What is not a number reaches no stage that remembers; the guard answers for it.
        let is_sound = finite::is_sound(wanted, state);
        let PortState { position, velocity, is_late, start, .. } = *state;
        let seen = Seen { position, velocity, has_start: start < 1.0 };
        let observed = self.passivity.observed(wanted, &seen, is_sound);
        let moment = Moment { is_sound, is_late, start };
        let (force, left) = self.channel.step((observed, state.free_force), &moment);
        self.passivity.written(left);
        force
    }

    /// Lowers the largest force to `max_force` [N]; never raises it. What is written falls to it
    /// as fast as forces may change.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn limit_force(&mut self, max_force: f64) {
        self.channel.lower_limit(max_force);
    }

    /// Stops: no force until [`release`](Self::release).
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn stop(&mut self) {
        self.channel.stop();
    }

    /// Ends an emergency stop; the force rises from nothing.
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

    /// What the passivity stage saw and did so far.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn passivity(&self) -> PassivityReport {
        self.passivity.report()
    }

    /// What every stage did so far.
    #[must_use]
    pub fn report(&self) -> SafetyReport {
        SafetyReport::of(&self.accepted, self.passivity.report(), &self.channel)
    }
}
