// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A servo behind the safety chain of a device.

use palpate_device::{Device, PointState};
use palpate_safety::Accepted;

use super::{Protected, Servo};
use crate::accepted_bodies::{AcceptedBodies, AcceptedTexture, Protection};
use crate::bodies::Bodies;
use crate::error::{HapticsError, ServoOptions};
use crate::guide::Guide;
use crate::tool::Tool;

impl Servo<Protected> {
    /// A servo that renders `bodies` to every contact point of `device`, protected by
    /// [`Protection::new`], with [`ServoOptions::of_device`]: 1 kHz, or
    /// the rate of a device that measures more seldom or sets the pace; a ball of 2 mm; forces up to
    /// the device's largest.
    ///
    /// A plain shape becomes one body with the default surface. For other settings, make a servo by
    /// [`new`](Servo::new) and call [`protected`](Servo::protected).
    ///
    /// # Errors
    ///
    /// As [`protected`](Servo::protected); [`HapticsError::Device`] if the device has
    /// none.
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_field::{Shape, kernel::Ball};
    /// use palpate_sim::{HandPath, Interpolation, RecordedDevice};
    /// use palpate_haptics::Servo;
    /// use palpate_haptics::servo_loop::{Pace, RunOptions, run};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let ends = vec![[0.0, 0.08, 0.0].into(), [0.0, 0.05, 0.0].into()];
    /// let press = HandPath::new(vec![0.0, 1.0], ends, Interpolation::Smooth)?;
    /// let mut device = RecordedDevice::new(vec![press])?;
    /// let mut servo = Servo::for_device(Shape::<3>::from_kernel(Ball::new(0.05)?), &device)?;
    /// let options = RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(1.0) };
    /// assert_eq!(run(&mut servo, &mut device, options)?.ticks, 1000);
    /// # Ok(())
    /// # }
    /// ```
    pub fn for_device(
        bodies: impl TryInto<Bodies, Error: Into<HapticsError>>,
        device: &(impl Device + ?Sized),
    ) -> Result<Self, HapticsError> {
        let options = ServoOptions::of_device(device.profile()).at_rate_of(device);
        Servo::new(bodies, device.points(), options)?.protected_for(device.profile())
    }

    /// A servo that renders `bodies` to a tool held by `device`; otherwise as
    /// [`for_device`](Self::for_device). A tool with a smaller force limit than the device's, or
    /// a longer rise time than the servo's, keeps it.
    ///
    /// # Errors
    ///
    /// As [`for_device`](Self::for_device).
    pub fn for_tool(
        bodies: impl TryInto<Bodies, Error: Into<HapticsError>>,
        tool: Tool,
        device: &(impl Device + ?Sized),
    ) -> Result<Self, HapticsError> {
        let options = ServoOptions::of_device(device.profile()).at_rate_of(device);
        Servo::with_tool(bodies, tool, options)?.protected_for(device.profile())
    }

    /// The protection of the device.
    #[must_use]
    pub fn protection(&self) -> &Protection {
        &self.kind.protection
    }

    /// The accepted stiffness and damping of each body. With a tool: first the translational
    /// entry, in series with the coupling, and second, if the device gives a torque, the
    /// rotational entry. Empty for a device that gives no force.
    #[must_use]
    pub fn accepted(&self) -> &[Accepted] {
        self.renderer.accepted().accepted()
    }

    /// The height textures of bodies as the device renders them: each with the lateral stiffness of
    /// its slopes, and its share of the amplitude.
    #[must_use]
    pub fn accepted_textures(&self) -> &[AcceptedTexture] {
        self.renderer.accepted().textures()
    }

    /// Sets the guides of every contact point, as soft as the device requires.
    ///
    /// # Errors
    ///
    /// As [`Protection::accept_guides`].
    ///
    /// ```
    /// use palpate_field::{Shape, Vector};
    /// use palpate_device::DeviceProfile;
    /// use palpate_haptics::{Guide, GuideOptions, Protection, Servo};
    ///
    /// # fn main() -> Result<(), palpate_haptics::HapticsError> {
    /// let disc = Shape::circle(0.05)?;
    /// let device = DeviceProfile {
    ///     max_stiffness: 1000.0,
    ///     ..DeviceProfile::unlimited("example")
    /// };
    /// let servo = Servo::new(disc, 1, Default::default())?;
    /// let mut servo = servo.protected(&Protection::new(device))?;
    /// let options = GuideOptions { stiffness: 4000.0, ..GuideOptions::default() };
    /// servo.guide(&[Guide::to_point(Vector([0.0, 0.1, 0.0]), options)?])?;
    /// assert_eq!(servo.accepted_guides()[0].stiffness_factor, 0.25);
    /// assert_eq!(servo.guides(0)[0].options().stiffness, 1000.0);
    /// # Ok(())
    /// # }
    /// ```
    #[inline(never)]
    pub fn guide(&mut self, guides: &[Guide]) -> Result<(), HapticsError> {
        let (guides, accepted) =
            self.kind.protection.accept_guides(guides, self.options().rate)?;
        self.renderer.guide(&guides);
        self.kind.accepted_guides = accepted;
        Ok(())
    }

    /// The accepted stiffness and damping of each guide; empty for a device that gives no force.
    #[must_use]
    pub fn accepted_guides(&self) -> &[Accepted] {
        &self.kind.accepted_guides
    }

    /// Scales bodies to what the servo's device renders, for
    /// [`replace_bodies`](Self::replace_bodies).
    ///
    /// # Errors
    ///
    /// As [`Protection::accept`].
    pub fn accept(
        &self,
        bodies: impl TryInto<Bodies, Error: Into<HapticsError>>,
    ) -> Result<AcceptedBodies, HapticsError> {
        let coupling = self.renderer.requested_coupling();
        self.kind.protection.accepted_bodies(
            bodies.try_into().map_err(Into::into)?,
            coupling,
            self.options().rate,
        )
    }

    /// Replaces the bodies from the next tick on. `bodies` holds the old ones then, to be dropped
    /// on a thread that may free memory, or to be given back later.
    ///
    /// What a hand feels:
    ///
    /// - If the new bodies cover a proxy by at most the probe's radius, or by 5 mm at the device for
    ///   a point, they [carry it out](crate::Proxy::carry_out) the shortest way. The touch goes on:
    ///   the wanted force follows at once, and the written force changes by at most 0.3 N a tick until
    ///   it is there. The event is [`Carried`](crate::EventKind::Carried).
    /// - If they cover it by more, it is placed anew and its force rises from zero. The event is
    ///   [`Placed`](crate::EventKind::Placed).
    /// - If they do not cover it and push harder, the force rises from the old force. If they push
    ///   less, or are not there, it falls at once: what lingered would push a hand that nothing
    ///   touches.
    ///
    /// The same holds for a tool with the least radius of its points; its torque follows as its force.
    /// Bodies that move before the next tick carry nothing out.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic unless a custom field
    /// does; evaluates the fields at most [`Probe::budget`](crate::Probe::budget) times a point.
    ///
    /// # Errors
    ///
    /// [`HapticsError::OtherServo`] if the bodies were accepted for a servo of which this is no
    /// clone; then nothing changes.
    pub fn replace_bodies(&mut self, bodies: &mut AcceptedBodies) -> Result<(), HapticsError> {
        if self.renderer.adopt(bodies) { Ok(()) } else { Err(HapticsError::OtherServo) }
    }

    /// Refuses a device with tighter limits than the one that the servo was made for, with another
    /// number of contact points, that measures more seldom than the servo ticks, or that sets the pace
    /// and measures more often. A loop calls this before its first tick.
    ///
    /// # Errors
    ///
    /// [`SafetyError::OtherDevice`](palpate_safety::SafetyError), [`HapticsError::ContactPoints`],
    /// [`HapticsError::Rate`].
    pub fn check_device(&self, device: &(impl Device + ?Sized)) -> Result<(), HapticsError> {
        palpate_safety::check_bears(&self.kind.protection.profile, device.profile())?;
        if let Some(of_device) = device.rate() {
            let servo = self.options().rate;
            // A device that paces gives its rate to the servo, whose limits of change in a tick would
            // be more in a second at a faster one. Written so that NaN is refused.
            let fits = servo <= of_device && !(device.paces() && servo < of_device);
            if !fits {
                return Err(HapticsError::Rate { servo, device: of_device });
            }
        }
        let (servo, device) = (self.touches().len(), device.points());
        if servo == device {
            Ok(())
        } else {
            Err(HapticsError::ContactPoints { servo, device })
        }
    }

    /// Runs [`step`](Self::step) with `states` on copies, only to load the code and data of the
    /// next tick into the caches. A loop that sleeps between ticks may call it until the next
    /// tick begins.
    ///
    /// Each call evaluates the fields once more, custom fields included.
    ///
    /// Real-time: as [`step`](Self::step).
    pub fn rehearse(&mut self, states: &[PointState]) {
        self.renderer.rehearse(states);
    }
}
