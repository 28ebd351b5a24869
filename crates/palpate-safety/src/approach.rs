// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How a force comes back: approaches, lifts, rises.
//!
//! Each place that restarts a rise, from which force, and what lets the force rise again:
//!
//! | what happens | from | lets it rise |
//! |---|---|---|
//! | a servo begins: a new chain | zero | [`Recovery`] |
//! | an emergency stop is released | zero | [`Recovery`] |
//! | a hand that was lifted is set down in a body | zero | [`Recovery`] |
//! | a device is not ready: it has no state yet, or was lost | zero | [`Recovery`] |
//! | late ticks, and ticks without a new reading, trip the watchdog | the force that was written | at once |
//! | an input is not finite | zero | at once |
//! | a proxy or a tool is placed anew, by an edit, or since a body moves farther onto it in a tick than its radius | zero | at once |
//! | bodies are replaced by ones that push harder, or one jumps | the force before | at once |
//!
//! In the first four the hand may be anywhere, and in a body for any reason: these are beginnings.
//! In the others a hand is at work, and what zeroed the force is not its doing: a wall that stayed
//! soft would let it through. None of the last four ends a wait. An edit that carries a proxy out
//! of a body restarts no rise, nor do bodies that close on the hand: see [`Change::Carried`] and
//! [`Change::HandedOver`].

use palpate_device::{DeviceProfile, GripperProfile, TurningProfile, shortened};
use palpate_field::Vector;

use crate::error::SafetyError;
use crate::passivity::InnerProduct;

/// The most by which a force changes in a tick after an edit [N]: a hand does not feel it as a kick.
/// With more, an edit of a few millimetres would be a blow; with less, a wall would give way under
/// the hand meanwhile.
const STEP: f64 = 0.3;

impl Change {
    /// [`HandedOver`](Self::HandedOver) if a force changes by more in a tick than 0.3 N beyond `moved`
    /// [N], what the motion of hand and bodies makes of it; else this change.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn or_handed_over(self, change: f64, moved: f64) -> Self {
        if self == Self::None && change > STEP + moved { Self::HandedOver } else { self }
    }
}

/// Follows a wanted force by 0.3 N a tick, from an edit or a handover on until it has caught up.
///
/// After an edit a force of zero is followed at once: then nothing pushes, and what lingered would
/// push a hand that nothing touches. After a handover bodies still hold the hand, so the force falls
/// by 0.3 N a tick.
#[derive(Clone, Copy, Debug)]
pub struct Approach {
    /// The most by which the force changes in a tick [N]; for a torque [N·m].
    step: f64,
    last: Vector<f64, 3>,
    is_on: bool,
    /// Whether a force of zero is followed step by step too.
    falls_slowly: bool,
}

impl Approach {
    /// For forces, or for torques where a radian counts as the length `unit` [m].
    #[must_use]
    pub fn new(unit: f64) -> Self {
        Self { step: STEP * unit, last: Vector::ZERO, is_on: false, falls_slowly: false }
    }

    /// Takes as large steps as before where a radian counts as a length that is so many times
    /// `longer`.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn in_units(&mut self, longer: f64) {
        self.step *= longer;
    }

    /// Begins, from the last force on, if a change asks for it.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn begin(&mut self, change: Change) {
        match change {
            Change::Carried => self.is_on = true,
            Change::HandedOver => (self.is_on, self.falls_slowly) = (true, true),
            Change::None | Change::Begins => {}
        }
    }

    /// Whether a force of zero is followed step by step too.
    pub(crate) fn falls_slowly(&self) -> bool {
        self.falls_slowly
    }

    /// Goes on from a force that passed in place of its own.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn passed(&mut self, force: Vector<f64, 3>) {
        self.last = force;
    }

    /// One tick: the force for the force `wanted`; `None` if the force had caught up before. After a
    /// handover it also follows what motion `explains` of the change [N], so that a hand that leaves the
    /// bodies leaves their force.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn step(&mut self, wanted: Vector<f64, 3>, explains: f64) -> Option<Vector<f64, 3>> {
        if !self.is_on {
            self.last = wanted;
            return None;
        }
        // `max` ignores NaN.
        let explained = if self.falls_slowly { explains.max(0.0) / STEP } else { 0.0 };
        let change = shortened(wanted - self.last, self.step * (1.0 + explained));
        match change.filter(|_| self.falls_slowly || wanted != Vector::ZERO) {
            Some(change) => self.last += change,
            None => (self.last, self.is_on, self.falls_slowly) = (wanted, false, false),
        }
        Some(self.last)
    }
}

/// A hand rests while it stays within this way [m].
const RESTING: f64 = 1e-4;

/// The time for which it must rest before the first lift in a contact [s].
const RESTED: f64 = 0.25;

/// The longest time for which it must rest [s].
const LONGEST: f64 = 8.0;

/// Tells when to lift a force that the passivity controller took.
///
/// What the controller took from a wall stays taken while nothing moves, because a resting hand
/// puts no energy in. So once a hand has rested in a wall for a quarter of a second, the force is
/// lifted. Each lift doubles the wait for the next, up to 8 s, until the hand leaves the wall.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lift<V> {
    /// Where the hand began to rest.
    place: Option<V>,
    /// The time for which it has rested [s].
    rested: f64,
    /// The time for which it must rest [s].
    patience: f64,
    is_on: bool,
}

impl<V: InnerProduct> Lift<V> {
    pub(crate) fn new() -> Self {
        Self { place: None, rested: 0.0, patience: RESTED, is_on: false }
    }

    /// One tick in which the hand is at `position`, after a time `elapsed` [s], and something `is
    /// taken` from the force; `None` outside of all bodies. `true` if the force is to be lifted.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn step(&mut self, position: V, elapsed: f64, is_taken: Option<bool>) -> bool {
        let Some(is_taken) = is_taken else {
            *self = Self::new();
            return false;
        };
        let is_resting = self.place.is_some_and(|place| (position - place).norm() <= RESTING);
        if is_resting {
            self.rested += elapsed;
        } else {
            (self.place, self.rested) = (Some(position), 0.0);
        }
        self.is_on &= is_taken;
        if is_taken && !self.is_on && self.rested >= self.patience {
            self.is_on = true;
            self.patience = (2.0 * self.patience).min(LONGEST);
        }
        self.is_on
    }

    /// Ends the lift, because the controller acts.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn end(&mut self) {
        (self.is_on, self.rested) = (false, 0.0);
    }
}

/// What lets a force rise after a beginning in a body: of a servo, after an emergency stop, where a
/// hand is set down, or when a device that was not ready comes.
///
/// After late ticks, readings that are missed or not finite, and edits, and where a body moves onto
/// the hand, the force rises at once, whichever this is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Recovery {
    /// It rises at once, by [`SafetySettings::rise_rate`](crate::SafetySettings::rise_rate): a hand
    /// that sank into a wall is lifted out gently.
    #[default]
    Rise,
    /// It stays zero until no body pushes the hand, as in CHAI3D's `setWaitForSmallForce`.
    OnceOut,
}

/// What happened to a contact point or a tool in a tick, beside the motion of the hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Change {
    /// Nothing.
    #[default]
    None,
    /// The hand begins anew: it is set down in a body, or the device is not ready. The force is
    /// zero, and [`Recovery`] says what lets it rise.
    Begins,
    /// An edit of the bodies carried the proxy, or the tool, out of them: the wanted force follows at
    /// once, and the force changes by at most 0.3 N a tick until it is there.
    Carried,
    /// Among bodies that move, the force changes by more than motion explains, because others hold
    /// it than before: they left it no room, one came or left, or it began to slip. The force
    /// follows as for [`Carried`](Self::Carried), but faster where motion explains more, and also
    /// down to zero.
    HandedOver,
}

/// A limit on a force that was zeroed, which rises until the force is below it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rise {
    /// The increase of the limit in a tick [N].
    step: f64,
    recovery: Recovery,
    /// The largest force [N]; infinite if no force was zeroed.
    limit: f64,
    /// Whether the limit waits until the hand is out.
    is_waiting: bool,
    /// Whether the hand begins in this tick: whether it is out shows in the next.
    has_begun: bool,
}

/// How a force rises from zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RiseOptions {
    /// The change of the force [N/s].
    pub(crate) rise_rate: f64,
    /// When it rises.
    pub(crate) recovery: Recovery,
    /// Ticks a second [Hz].
    pub(crate) rate: f64,
}

impl Rise {
    pub(crate) fn new(RiseOptions { rise_rate, recovery, rate }: RiseOptions) -> Self {
        let is_waiting = recovery == Recovery::OnceOut;
        let step = rise_rate / rate;
        Self { step, recovery, limit: 0.0, is_waiting, has_begun: false }
    }

    /// Rises by so many times the step.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn in_units(&mut self, longer: f64) {
        self.step *= longer;
    }

    /// Lowers the limit to `force` [N], from where it rises at once, or after the wait that goes on.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn restart(&mut self, force: f64) {
        // `min` ignores NaN.
        self.limit = self.limit.min(if force >= 0.0 { force } else { 0.0 });
    }

    /// Begins anew: from zero, and as [`Recovery`] says.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn begin(&mut self) {
        self.restart(0.0);
        self.is_waiting = self.recovery == Recovery::OnceOut;
        self.has_begun = self.is_waiting;
    }

    /// One tick: the part, in [0, 1], of the sum of a force `wanted` by bodies and a `free` one
    /// that may pass; `None` if the force had risen before. It rises until it has caught up with
    /// `aim`, which the force of the bodies may only approach.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[inline]
    pub(crate) fn step(
        &mut self,
        wanted: Vector<f64, 3>,
        aim: Vector<f64, 3>,
        free: Vector<f64, 3>,
    ) -> Option<f64> {
        (self.limit < f64::INFINITY).then(|| self.rise(wanted, aim, free))
    }

    #[cold]
    fn rise(
        &mut self,
        wanted: Vector<f64, 3>,
        aim: Vector<f64, 3>,
        free: Vector<f64, 3>,
    ) -> f64 {
        let has_begun = std::mem::take(&mut self.has_begun);
        self.is_waiting &= has_begun || wanted != Vector::ZERO;
        let force = (wanted + free).norm();
        if !self.is_waiting {
            self.limit += self.step;
            if force.max((aim + free).norm()) <= self.limit {
                self.limit = f64::INFINITY;
            }
        }
        if force <= self.limit {
            return 1.0;
        }
        self.limit / force
    }
}

/// Refuses a `device` with tighter limits than `made_for`, the profile that a servo was made for: the
/// servo could harm such a device or be unstable on it.
///
/// # Errors
///
/// [`SafetyError::OtherDevice`] with the limit that is tighter.
///
/// ```
/// use palpate_device::DeviceProfile;
/// use palpate_safety::check_bears;
///
/// let strong = DeviceProfile { max_force: 8.0, ..DeviceProfile::unlimited("strong") };
/// let weak = DeviceProfile { max_force: 3.0, ..DeviceProfile::unlimited("weak") };
/// assert!(check_bears(&weak, &strong).is_ok());
/// assert!(check_bears(&strong, &weak).unwrap_err().to_string().contains("max_force of 8 N"));
/// ```
pub fn check_bears(
    made_for: &DeviceProfile,
    device: &DeviceProfile,
) -> Result<(), SafetyError> {
    let of = made_for;
    at_most("max_force", of.max_force, device.max_force, "N")?;
    at_most("continuous_force", of.continuous_force, device.continuous_force, "N")?;
    at_most("max_force_rate", of.max_force_rate, device.max_force_rate, "N/s")?;
    at_most("max_stiffness", of.max_stiffness, device.max_stiffness, "N/m")?;
    at_most("max_damping", of.max_damping, device.max_damping, "N·s/m")?;
    at_most("least_damping", of.least_damping, device.least_damping, "N·s/m")?;
    at_most("friction", of.friction, device.friction, "N")?;
    at_least("encoder_step", of.encoder_step, device.encoder_step, "m")?;
    match (&of.turning, &device.turning) {
        // Without a torque there is no limit to check.
        (None, _) => {}
        (Some(turning), None) => at_most("max_torque", turning.max_torque, 0.0, "N·m")?,
        (Some(turning), Some(device)) => turning_bears(turning, device)?,
    }
    match (&of.gripper, &device.gripper) {
        (None, _) => Ok(()),
        (Some(gripper), None) => at_most("gripper_max_force", gripper.max_force, 0.0, "N"),
        (Some(gripper), Some(device)) => gripper_bears(gripper, device),
    }
}

fn turning_bears(of: &TurningProfile, device: &TurningProfile) -> Result<(), SafetyError> {
    at_most("max_torque", of.max_torque, device.max_torque, "N·m")?;
    at_most("continuous_torque", of.continuous_torque, device.continuous_torque, "N·m")?;
    at_most("max_torque_rate", of.max_torque_rate, device.max_torque_rate, "N·m/s")?;
    at_most("angular_max_stiffness", of.max_stiffness, device.max_stiffness, "N·m/rad")?;
    at_most("angular_max_damping", of.max_damping, device.max_damping, "N·m·s/rad")?;
    at_most("angular_least_damping", of.least_damping, device.least_damping, "N·m·s/rad")?;
    at_most("angular_friction", of.friction, device.friction, "N·m")?;
    at_least("angular_encoder_step", of.encoder_step, device.encoder_step, "rad")
}

fn gripper_bears(of: &GripperProfile, device: &GripperProfile) -> Result<(), SafetyError> {
    at_most("gripper_max_force", of.max_force, device.max_force, "N")?;
    at_most("gripper_max_force_rate", of.max_force_rate, device.max_force_rate, "N/s")
}

/// Refuses a limit of the servo's device that is larger than the running device's.
fn at_most(
    limit: &'static str,
    servo: f64,
    device: f64,
    unit: &'static str,
) -> Result<(), SafetyError> {
    // Written so that NaN is refused.
    if servo <= device {
        Ok(())
    } else {
        Err(SafetyError::OtherDevice { limit, servo, device, unit })
    }
}

/// Refuses a limit of the servo's device that is smaller than the running device's.
fn at_least(
    limit: &'static str,
    servo: f64,
    device: f64,
    unit: &'static str,
) -> Result<(), SafetyError> {
    if servo >= device {
        Ok(())
    } else {
        Err(SafetyError::OtherDevice { limit, servo, device, unit })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_goes_straight_to_the_wanted_one_and_is_free_then() {
        let mut approach = Approach::new(1.0);
        assert_eq!(approach.step(Vector([0.0, 1.0, 0.0]), 0.0), None);
        approach.begin(Change::Carried);
        let along = [0.6, 0.2].map(|x| Vector([x, 1.0, 0.0]));
        assert_eq!(approach.step(along[0], 0.0), Some(Vector([0.3, 1.0, 0.0])));
        assert_eq!(approach.step(along[1], 0.0), Some(along[1]));
        assert_eq!(approach.step(Vector([0.0, 9.0, 0.0]), 0.0), None);
    }

    #[test]
    fn a_force_that_ends_ends_at_once() {
        let mut approach = Approach::new(0.5);
        assert_eq!(approach.step(Vector([0.0, 1.0, 0.0]), 0.0), None);
        approach.begin(Change::Carried);
        assert_eq!(approach.step(Vector([0.0, 2.0, 0.0]), 0.0), Some(Vector([0.0, 1.15, 0.0])));
        assert_eq!(approach.step(Vector::ZERO, 0.0), Some(Vector::ZERO));
        assert_eq!(approach.step(Vector([0.0, 2.0, 0.0]), 0.0), None);
    }

    #[test]
    fn a_force_that_is_handed_over_ends_step_by_step() {
        let mut approach = Approach::new(1.0);
        assert_eq!(approach.step(Vector([0.0, 1.0, 0.0]), 0.0), None);
        approach.begin(Change::HandedOver);
        for left in [0.7, 0.4, 0.1] {
            let step = approach.step(Vector::ZERO, 0.0).unwrap();
            assert!((step - Vector([0.0, left, 0.0])).norm() < 1e-15, "{step:?}");
        }
        assert_eq!(approach.step(Vector::ZERO, 0.0), Some(Vector::ZERO));
        assert_eq!(approach.step(Vector([0.0, 2.0, 0.0]), 0.0), None);
    }

    #[test]
    fn after_a_handover_a_force_follows_the_hand_too() {
        let mut approach = Approach::new(1.0);
        assert_eq!(approach.step(Vector([0.0, 5.0, 0.0]), 1.0), None);
        approach.begin(Change::HandedOver);
        let steps = [3.7, 2.4, 1.1, 0.0].map(|left| Some(Vector([0.0, left, 0.0])));
        for step in steps {
            let given = approach.step(Vector::ZERO, 1.0);
            assert!((given.unwrap() - step.unwrap()).norm() < 1e-15, "{given:?}");
        }
        assert_eq!(approach.step(Vector::ZERO, 1.0), None);
    }

    #[test]
    fn a_change_is_handed_over_beyond_three_tenths_of_a_newton() {
        assert_eq!(Change::None.or_handed_over(0.5, 0.2), Change::None);
        assert_eq!(Change::None.or_handed_over(0.51, 0.2), Change::HandedOver);
        assert_eq!(Change::Carried.or_handed_over(9.0, 0.0), Change::Carried);
    }
}

#[cfg(test)]
mod lift_tests {
    use palpate_field::Vector;

    use super::*;

    #[test]
    fn a_lift_waits_for_rest_and_twice_as_long_the_next_time() {
        let mut lift = Lift::new();
        let ticks = |lift: &mut Lift<_>, x: f64| {
            let begins = (0..).find(|_| lift.step(Vector([x, 0.0, 0.0]), 0.125, Some(true)));
            begins.unwrap_or_default()
        };
        assert_eq!(ticks(&mut lift, 0.0), 2);
        // It goes on while the hand is moved.
        assert!(lift.step(Vector([0.01, 0.0, 0.0]), 0.125, Some(true)));
        lift.end();
        assert_eq!(ticks(&mut lift, 0.02), 4);
        assert!(!lift.step(Vector([0.02, 0.0, 0.0]), 0.125, Some(false)));
        assert!(!lift.step(Vector([0.02, 0.0, 0.0]), 0.125, None));
        assert_eq!(ticks(&mut lift, 0.02), 2);
    }
}

#[cfg(test)]
mod rise_tests {
    use super::*;

    fn rise(recovery: Recovery) -> Rise {
        Rise::new(RiseOptions { rise_rate: 20.0, recovery, rate: 10.0 })
    }

    fn step(rise: &mut Rise, wanted: Vector<f64, 3>, free: Vector<f64, 3>) -> Option<f64> {
        rise.step(wanted, wanted, free)
    }

    fn steps(rise: &mut Rise, forces: &[f64]) -> Vec<f64> {
        let part = |rise: &mut Rise, x: f64| {
            step(rise, Vector([x, 0.0, 0.0]), Vector::ZERO).unwrap_or(1.0)
        };
        forces.iter().map(|x| x * part(rise, *x)).collect()
    }

    #[test]
    fn it_rises_until_it_has_caught_up() {
        let mut rise = rise(Recovery::Rise);
        assert_eq!(steps(&mut rise, &[8.0, 8.0, 5.0, 9.0]), [2.0, 4.0, 5.0, 9.0]);
        assert_eq!(step(&mut rise, Vector([0.0, 9.0, 0.0]), Vector::ZERO), None);
        rise.restart(3.0);
        assert_eq!(steps(&mut rise, &[8.0, 8.0]), [5.0, 7.0]);
        rise.restart(f64::NAN);
        assert_eq!(steps(&mut rise, &[8.0]), [2.0]);
    }

    #[test]
    fn it_waits_until_the_hand_is_out() {
        let mut rise = rise(Recovery::OnceOut);
        assert_eq!(steps(&mut rise, &[8.0, 8.0, 0.0, 8.0]), [0.0, 0.0, 0.0, 8.0]);
        rise.begin();
        // A body that covers the hand may push it in the next tick.
        assert_eq!(steps(&mut rise, &[0.0, 8.0]), [0.0, 0.0]);
        assert_eq!(step(&mut rise, Vector::ZERO, Vector([0.0, 4.0, 0.0])), Some(0.5));
        assert_eq!(steps(&mut rise, &[16.0, 4.0]), [4.0, 4.0]);
    }

    #[test]
    fn a_restart_neither_begins_nor_ends_a_wait() {
        let mut rise = rise(Recovery::OnceOut);
        rise.restart(5.0);
        assert_eq!(steps(&mut rise, &[8.0, 8.0, 0.0, 8.0]), [0.0, 0.0, 0.0, 8.0]);
        rise.restart(3.0);
        assert_eq!(steps(&mut rise, &[8.0, 8.0, 8.0]), [5.0, 7.0, 8.0]);
        rise.begin();
        rise.restart(3.0);
        assert_eq!(steps(&mut rise, &[8.0, 8.0]), [0.0, 0.0]);
    }
}
