// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The servo: from device points to forces, once a tick.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod protected;
mod renderer;
mod unprotected;

use std::ops::Deref;
use std::sync::Arc;

use palpate_device::{Buttons, GripperState, PointState, Reading, TurnState};
use palpate_field::Pose;
use palpate_safety::Accepted;

pub(crate) use renderer::Placement;
pub use renderer::Renderer;

use crate::accepted_bodies::Protection;
use crate::contact_point::Touch;

/// Renders bodies to the contact points of a device, or to a tool.
///
/// A servo made by [`for_device`](Self::for_device) or [`for_tool`](Self::for_tool) is
/// [`Protected`]: a safety chain keeps every force within the limits of its device. The loops of
/// [`servo_loop`](crate::servo_loop) run no other kind. A servo made by [`new`](Self::new) or
/// [`with_tool`](Self::with_tool) is [`Unprotected`] and only limits its force: it is for tests, for
/// measurements, and for settings that are made before the servo is [protected](Self::protected).
///
/// The results of the last tick are methods of [`Renderer`], to which a servo dereferences.
///
/// # Examples
///
/// A device that gives at most 1 N presses 1/256 m into a wall:
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ball};
/// use palpate_device::{DeviceProfile, PointState};
/// use palpate_haptics::{Bodies, Body, Probe, Protection, Servo, ServoOptions, Surface};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::<3>::from_kernel(Ball::new(0.5)?);
/// let bodies = Bodies::new(vec![Body::new(ball, Surface::smooth(512.0, 0.0)?)?])?;
/// let profile = DeviceProfile { max_force: 1.0, ..DeviceProfile::unlimited("example") };
/// let options = ServoOptions { probe: Probe::new(0.0)?, ..ServoOptions::default() };
/// let mut servo = Servo::new(bodies, 1, options)?
///     .protected(&Protection::new(profile).with(|s| s.rise_rate = f64::INFINITY))?;
/// servo.step(&[PointState::at_rest(Vector([0.0, 1.0, 0.0]))]);
/// servo.step(&[PointState::at_rest(Vector([0.0, 0.5 - 1.0 / 256.0, 0.0]))]);
/// assert!((servo.touches()[0].wanted - Vector([0.0, 2.0, 0.0])).norm() < 1e-4); // 2 N are wanted
/// assert!((servo.forces()[0] - Vector([0.0, 1.0, 0.0])).norm() < 1e-12); // 1 N is given
/// # Ok(())
/// # }
/// ```
///
/// No device can be given to a servo without protection:
///
/// ```compile_fail,E0308
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// use palpate_field::{Shape, Vector};
/// use palpate_haptics::Servo;
/// use palpate_haptics::servo_loop::{Pace, RunOptions, run};
/// use palpate_sim::{Hand, SimulatedDevice};
///
/// let hand = Hand::resting(Vector([0.0, 0.1, 0.0]))?;
/// let mut device = SimulatedDevice::new(palpate_device::profile_named("omega")?, vec![hand])?;
/// let mut servo = Servo::new(Shape::circle(0.05)?, 1, Default::default())?;
/// run(&mut servo, &mut device, RunOptions {
///     pace: Pace::AsFastAsPossible,
///     ..RunOptions::new(1.0)
/// })?;
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Servo<P = Protected> {
    renderer: Renderer,
    kind: P,
}

/// The kind of a [`Servo`] that protects a device and the hand that holds it.
#[derive(Clone, Debug)]
pub struct Protected {
    protection: Arc<Protection>,
    accepted_guides: Vec<Accepted>,
}

/// The kind of a [`Servo`] that protects no device: it limits forces and does nothing else.
#[derive(Clone, Copy, Debug)]
pub struct Unprotected;

/// The two kinds of a [`Servo`]: [`Protected`] and [`Unprotected`]. No other type can be one.
pub trait Kind: sealed::Sealed {}

impl Kind for Protected {}

impl Kind for Unprotected {}

mod sealed {
    use std::sync::Arc;

    use crate::accepted_bodies::Protection;

    pub trait Sealed {
        fn protection(&self) -> Option<&Arc<Protection>>;
    }

    impl Sealed for super::Protected {
        fn protection(&self) -> Option<&Arc<Protection>> {
            Some(&self.protection)
        }
    }

    impl Sealed for super::Unprotected {
        fn protection(&self) -> Option<&Arc<Protection>> {
            None
        }
    }
}

impl<P: Kind> Servo<P> {
    /// One tick: for each contact point, takes its state, moves its proxy and computes
    /// its force.
    ///
    /// A point whose state is missing or not finite touches nothing: its force is zero,
    /// and its proxy stays in place.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic unless a custom field
    /// does; evaluates the field at most [`Probe::budget`](crate::Probe::budget) times a
    /// point, once more for each magnet in reach, and once for each dimension of a
    /// textured surface; for a tool,
    /// [`ToolOptions::budget`](crate::ToolOptions::budget) times.
    pub fn step(&mut self, states: &[PointState]) -> &[Touch] {
        self.renderer.step(states)
    }

    /// Sets orientation and angular velocity of the device for the next ticks; a tool
    /// turns with them. `None`, the initial value, is for a device without rotation:
    /// the tool keeps the device's axes.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn set_turn(&mut self, turn: Option<TurnState>) {
        self.renderer.set_turn(turn);
    }

    /// Sets by how much the next tick starts too late [s]; zero in time. A servo loop calls
    /// this before each tick that starts more than a period after its time.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn set_late(&mut self, late: f64) {
        self.renderer.set_late(late);
    }

    /// Sets what the device gave for the next tick alone. Without it the states of a tick
    /// were measured a period, and what the tick is [late](Self::set_late), after those
    /// before.
    ///
    /// The time between two fresh readings gives velocities, and the energies of the
    /// passivity observer. In a tick with a stale reading the states of
    /// [`step`](Self::step) are not looked at: the last ones hold on, and the force with
    /// them, until the watchdog of the safety chain has had enough. A device that is not
    /// ready has no state, as if each point were NaN.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn set_reading(&mut self, reading: Reading) {
        self.renderer.set_reading(reading);
    }

    /// Sets the buttons that are held down from the next tick on; each change is an
    /// [event](crate::EventKind::ButtonDown).
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn set_buttons(&mut self, buttons: Buttons) {
        self.renderer.set_buttons(buttons);
    }

    /// Sets the gripper from the next tick on; `None`, the initial value, is for a device
    /// without one.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn set_gripper(&mut self, state: Option<GripperState>) {
        self.renderer.set_gripper(state);
    }

    /// Sets the force wanted on the fingers in the gripper [N] from the next tick on;
    /// positive opens the jaws. [`gripper_force`](crate::Renderer::gripper_force) is what to write
    /// of it, after the limits of the [gripper's
    /// profile](palpate_device::GripperProfile): zero for a device without one, and without
    /// protection.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn set_gripper_force(&mut self, wanted: f64) {
        self.renderer.set_gripper_force(wanted);
    }

    /// Stops all forces and torques from the next tick on, or releases them: they then
    /// rise from zero.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn stop(&mut self, is_stopped: bool) {
        self.renderer.stop(is_stopped);
    }

    /// Lifts the hand off the bodies from the next tick on, as a clutch does, or sets it down.
    /// A hand that is lifted feels neither bodies nor guides: proxy and tool are where the
    /// device is, through bodies too. Where it is set down they are placed anew, as in the
    /// first tick; in a body, the force rises from zero.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn lift(&mut self, is_lifted: bool) {
        self.renderer.lift(is_lifted);
    }

    /// Moves a body before the next tick; see [`Bodies::set_pose`](crate::Bodies::set_pose).
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn set_pose(&mut self, body: usize, world_from_body: Pose<3>) {
        self.renderer.set_pose(body, world_from_body);
    }

    /// Lowers the force limit of every contact point to `max_force` [N]; never raises
    /// it. With a safety chain, a larger force falls to the limit at the device's
    /// largest rate.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn limit_force(&mut self, max_force: f64) {
        self.renderer.limit_force(max_force);
    }

    /// Lowers the torque limit of a tool to `max_torque` [N·m]; never raises it. With a
    /// safety chain, a larger torque falls to the limit at the device's largest rate.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn limit_torque(&mut self, max_torque: f64) {
        self.renderer.limit_torque(max_torque);
    }

    pub(crate) fn renderer(&self) -> &Renderer {
        &self.renderer
    }

    pub(crate) fn renderer_mut(&mut self) -> &mut Renderer {
        &mut self.renderer
    }

    pub(crate) fn protection_of_any(&self) -> Option<&Arc<Protection>> {
        self.kind.protection()
    }
}

impl<P> Deref for Servo<P> {
    type Target = Renderer;

    fn deref(&self) -> &Renderer {
        &self.renderer
    }
}
