// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The servo: from device points to forces, once a tick.
//!
//! A [`Servo`] is made for a device, and a safety chain stands between every force and the hand.
//! It is the only kind that the loops of `palpate-loop` run. An [`UnprotectedServo`] has no
//! chain: it is for tests, and for the step before a servo gets its device.

mod any;
mod both;
mod options;
mod renderer;
mod unprotected;

use std::ops::Deref;

pub(crate) use any::AnyServo;
pub use options::ServoOptions;
pub use renderer::Renderer;
pub use unprotected::UnprotectedServo;

use crate::accepted_bodies::AcceptedBodies;
use crate::bodies::Bodies;
use crate::error::HapticsError;
use crate::protection::Protection;
use crate::tool::Tool;
use palpate_safety::Accepted;
use palpate_safety::{Device, PointState};

/// Renders bodies to the contact points of a device, or to a tool that its hand holds, and
/// keeps every force within what the device and the hand can bear.
///
/// What the servo shows of its last tick are the methods of [`Renderer`], which it lends.
///
/// # Examples
///
/// A wall is pressed to a depth of 1/256 m, on a device that gives at most 1 N:
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ball};
/// use palpate_haptics::{
///     Bodies, Body, DeviceProfile, PointState, Probe, Protection, ServoOptions, Surface,
///     UnprotectedServo,
/// };
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::from_kernel(Ball::new(0.5)?);
/// let bodies = Bodies::new(vec![Body::new(ball, Surface::smooth(512.0, 0.0)?)?])?;
/// let profile = DeviceProfile { max_force: 1.0, ..DeviceProfile::unlimited("example") };
/// let options = ServoOptions { probe: Probe::new(0.0)?, ..ServoOptions::default() };
/// let mut servo = UnprotectedServo::new(bodies, 1, options)?
///     .protected(&Protection { rise_time: 0.0, ..Protection::new(profile) })?;
/// servo.step(&[PointState::at_rest(Vector([0.0, 1.0]))]);
/// servo.step(&[PointState::at_rest(Vector([0.0, 0.5 - 1.0 / 256.0]))]);
/// assert!((servo.touches()[0].wanted - Vector([0.0, 2.0])).norm() < 1e-4); // 2 N are wanted
/// assert!((servo.forces()[0] - Vector([0.0, 1.0])).norm() < 1e-12); // 1 N is given
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Servo<const D: usize> {
    renderer: Renderer<D>,
    protection: Protection<D>,
    accepted: Vec<Accepted>,
}

impl<const D: usize> Servo<D> {
    /// A servo that renders `bodies` to every contact point of `device`, protected by
    /// [`Protection::new`]: 1 kHz, a ball of 2 mm, forces up to the device's largest.
    ///
    /// A shape alone is one body of the default surface. For other settings, protect an
    /// [`UnprotectedServo`] as its [`protected`](UnprotectedServo::protected) says.
    ///
    /// # Errors
    ///
    /// As [`UnprotectedServo::protected`]; [`HapticsError::NoContactPoint`] if the device has
    /// none.
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_field::{Shape, kernel::Ball};
    /// use palpate_devices::{HandPath, Interpolation, RecordedDevice};
    /// use palpate_haptics::Servo;
    /// use palpate_loop::{Pace, RunOptions, run};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let ends = vec![[0.0, 0.08, 0.0].into(), [0.0, 0.05, 0.0].into()];
    /// let press = HandPath::new(vec![0.0, 1.0], ends, Interpolation::Smooth)?;
    /// let mut device = RecordedDevice::new(vec![press])?;
    /// let mut servo = Servo::for_device(Shape::from_kernel(Ball::new(0.05)?), &device)?;
    /// let options = RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(1.0) };
    /// assert_eq!(run(&mut servo, &mut device, options)?.ticks, 1000);
    /// # Ok(())
    /// # }
    /// ```
    pub fn for_device(
        bodies: impl TryInto<Bodies<D>, Error: Into<HapticsError>>,
        device: &(impl Device<D> + ?Sized),
    ) -> Result<Self, HapticsError> {
        let options = ServoOptions::of_device(device.profile());
        UnprotectedServo::new(bodies, device.points(), options)?.protected_for(device.profile())
    }

    /// A servo that renders `bodies` to a tool with a shape, held by `device`; the rest is as
    /// [`for_device`](Self::for_device).
    ///
    /// # Errors
    ///
    /// As [`for_device`](Self::for_device).
    pub fn for_tool(
        bodies: impl TryInto<Bodies<D>, Error: Into<HapticsError>>,
        tool: Tool<D>,
        device: &(impl Device<D> + ?Sized),
    ) -> Result<Self, HapticsError> {
        let options = ServoOptions::of_device(device.profile());
        UnprotectedServo::with_tool(bodies, tool, options)?.protected_for(device.profile())
    }

    /// What stands between the servo and its device.
    #[must_use]
    pub fn protection(&self) -> &Protection<D> {
        &self.protection
    }

    /// What became of the stiffness and damping of each body on the way to the device. With a
    /// tool: what became of those felt through it, and second, where the device gives a torque,
    /// of the coupling's angular ones. Empty on a device that gives no force.
    #[must_use]
    pub fn accepted(&self) -> &[Accepted] {
        &self.accepted
    }

    /// The bodies as the servo's device renders them, for [`replace_bodies`](Self::replace_bodies).
    ///
    /// # Errors
    ///
    /// As [`Protection::accept`].
    pub fn accept(
        &self,
        bodies: impl TryInto<Bodies<D>, Error: Into<HapticsError>>,
    ) -> Result<AcceptedBodies<D>, HapticsError> {
        let coupling = self.renderer.requested_coupling();
        self.protection.accepted_bodies(
            bodies.try_into().map_err(Into::into)?,
            coupling,
            self.options().rate,
        )
    }

    /// Renders `bodies` from the next tick on. Returns those rendered so far, to be dropped
    /// where freeing is allowed.
    ///
    /// A contact point that the new bodies cover is placed anew, and its force rises gently; so
    /// does one that pushes harder on them than on those before, from where it was.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn replace_bodies(&mut self, mut bodies: AcceptedBodies<D>) -> AcceptedBodies<D> {
        self.renderer.adopt(&mut bodies);
        bodies
    }

    /// Refuses a device that bears less than the one that the servo was made for, or has another
    /// number of contact points. A loop asks before its first tick.
    ///
    /// # Errors
    ///
    /// [`HapticsError::OtherDevice`], [`HapticsError::ContactPoints`].
    pub fn check_device(&self, device: &(impl Device<D> + ?Sized)) -> Result<(), HapticsError> {
        self.protection.profile.check_bears(device.profile())?;
        let (servo, device) = (self.touches().len(), device.points());
        if servo == device {
            Ok(())
        } else {
            Err(HapticsError::ContactPoints { servo, device })
        }
    }

    /// Does what [`step`](Self::step) would with `states`, on copies: its only effect is that the
    /// next tick finds its code and data in the caches. A loop that sleeps between ticks may call
    /// it until the next tick begins.
    ///
    /// It asks fields once more for each call, custom ones too.
    ///
    /// Real-time: as [`step`](Self::step).
    pub fn rehearse(&mut self, states: &[PointState<D>]) {
        self.renderer.rehearse(states);
    }
}

impl<const D: usize> Deref for Servo<D> {
    type Target = Renderer<D>;

    fn deref(&self) -> &Renderer<D> {
        &self.renderer
    }
}
