// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A servo without a safety chain.

use std::sync::Arc;

use palpate_device::{DeviceProfile, NumberError};

use super::{Protected, Renderer, Servo, Unprotected};
use crate::accepted_bodies::{AcceptedBodies, Protection};
use crate::bodies::Bodies;
use crate::error::{HapticsError, ServoOptions};
use crate::guide::Guide;
use crate::tool::Tool;

impl Servo<Unprotected> {
    /// A servo without protection that renders `bodies` to `points` contact points. A plain shape becomes one body
    /// with the default surface.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Device`] if there are none; [`HapticsError::Number`] if the
    /// rate, the rise time or the largest force is not positive.
    pub fn new(
        bodies: impl TryInto<Bodies, Error: Into<HapticsError>>,
        points: usize,
        options: ServoOptions,
    ) -> Result<Self, HapticsError> {
        let bodies = bodies.try_into().map_err(Into::into)?;
        Ok(Self { renderer: Renderer::of_points(bodies, points, options)?, kind: Unprotected })
    }

    /// A servo without protection that renders `bodies` to a rigid tool, coupled to the one contact point of a
    /// device. The tool's origin is at the device point. Its axes are the handle's if the
    /// device [turns](Self::set_turn), and the device's otherwise.
    ///
    /// The tool takes the rate of `options`; of the force limits of tool and `options` the
    /// smaller holds, and of their rise times the longer. The probe is not used.
    /// The one [touch](Renderer::touches) describes the whole tool: its proxy is the tool's
    /// origin, its normal and body are those of the contact that pushes hardest, and its wanted
    /// force is already limited. The details are in [`tool`](Renderer::tool).
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] as [`new`](Self::new).
    ///
    /// # Examples
    ///
    /// A ball of 62.5 mm radius, pressed 2 mm into the ground:
    ///
    /// ```
    /// use palpate_field::{Shape, Vector, kernel::HalfSpace};
    /// use palpate_device::PointState;
    /// use palpate_haptics::{Servo, ServoOptions, Shell, Tool, ToolOptions};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let ground = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0, 0.0]), 0.0)?);
    /// let coupling = ToolOptions { stiffness: 500.0, damping: 0.0, ..ToolOptions::default() };
    /// let tool = Tool::new(Shell::ball(0.0625)?, coupling)?;
    /// let mut servo = Servo::with_tool(ground, tool, ServoOptions::default())?;
    /// servo.step(&[PointState::at_rest(Vector([0.0, 0.1, 0.0]))]);
    /// servo.step(&[PointState::at_rest(Vector([0.0, 0.0605, 0.0]))]);
    /// assert!((servo.forces()[0] - Vector([0.0, 1.0, 0.0])).norm() < 1e-9);
    /// assert_eq!(servo.tool().map(|tool| tool.touch().contacts.len()), Some(1));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// A rod of 10 cm is pressed 1 cm into the ground while the hand turns by 0.1 rad: the rod
    /// stays flat, and its coupling of 1 N·m/rad turns the hand back.
    ///
    /// ```
    /// use palpate_field::{Rotation, Shape, Vector, kernel::HalfSpace};
    /// use palpate_device::{PointState, TurnState};
    /// use palpate_haptics::{Servo, ServoOptions, Shell, Tool, ToolOptions};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let ground = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0, 0.0]), 0.0)?);
    /// let rod = Shell::capsule([Vector([-0.05, 0.0, 0.0]), Vector([0.05, 0.0, 0.0])], 0.001, 101)?;
    /// let coupling = ToolOptions { angular_stiffness: Some(1.0), ..ToolOptions::default() };
    /// let tool = Tool::new(rod, coupling)?;
    /// let mut servo = Servo::with_tool(ground, tool, ServoOptions::default())?;
    /// servo.step(&[PointState::at_rest(Vector([0.0, 0.01, 0.0]))]);
    /// for tick in 1..=100 {
    ///     let orientation = Rotation::from_angle(0.001 * f64::from(tick))?.in_space();
    ///     servo.set_turn(Some(TurnState::at_rest(orientation)));
    ///     servo.step(&[PointState::at_rest(Vector([0.0, -0.009, 0.0]))]);
    /// }
    /// assert!((servo.torque() - Vector([0.0, 0.0, -0.1])).norm() < 1e-6);
    /// # Ok(())
    /// # }
    /// ```
    pub fn with_tool(
        bodies: impl TryInto<Bodies, Error: Into<HapticsError>>,
        tool: Tool,
        options: ServoOptions,
    ) -> Result<Self, HapticsError> {
        let bodies = bodies.try_into().map_err(Into::into)?;
        Ok(Self { renderer: Renderer::of_tool(bodies, tool, options)?, kind: Unprotected })
    }

    /// This servo with a safety chain between every contact point and a device. States and
    /// forces are in device coordinates.
    ///
    /// Bodies and tool are made as soft as the device requires: see [`Servo::accepted`]. For a
    /// device without force feedback there is no safety chain and all forces are zero.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Safety`] if a body is refused; [`HapticsError::Number`] if a
    /// limit of the profile is not positive.
    ///
    /// # Examples
    ///
    /// A servo for a custom loop, on a device that renders 1000 N/m:
    ///
    /// ```
    /// use palpate_field::{Shape, kernel::Ball};
    /// use palpate_device::DeviceProfile;
    /// use palpate_haptics::{Bodies, Body, Protection, Servo, Surface};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let ball = Shape::<3>::from_kernel(Ball::new(0.05)?);
    /// let bodies = Bodies::new(vec![Body::new(ball, Surface::smooth(2000.0, 0.0)?)?])?;
    /// let device = DeviceProfile {
    ///     max_stiffness: 1000.0,
    ///     ..DeviceProfile::unlimited("example")
    /// };
    /// let servo = Servo::new(bodies, 1, Default::default())?
    ///     .protected(&Protection::new(device))?;
    /// assert_eq!(servo.accepted()[0].stiffness_factor, 0.5);
    /// assert_eq!(servo.bodies().bodies()[0].surface().stiffness(), 1000.0);
    /// # Ok(())
    /// # }
    /// ```
    #[inline(never)]
    pub fn protected(self, protection: &Protection) -> Result<Servo, HapticsError> {
        let max_force = protection.profile.max_force;
        NumberError::check_zero_or_more("max_force", max_force, "N")?;
        let mut renderer = self.renderer;
        let protection = Arc::new(protection.clone());
        renderer.set_map(protection.map);
        renderer.limit_force(protection.profile.max_force);
        if protection.profile.turning.is_none() {
            renderer.limit_torque(0.0);
        }
        let limit = renderer.options().max_force;
        let rate = renderer.options().rate;
        let coupling = renderer.requested_coupling();
        let bodies = renderer.bodies().clone();
        let mut bodies = protection.accepted_bodies(bodies, coupling, rate)?;
        if limit > 0.0 {
            let profile = DeviceProfile { max_force: limit, ..protection.profile.clone() };
            let limited = Protection { profile, ..Protection::clone(&protection) };
            renderer.set_ports(&limited.port(&bodies, rate)?, limited.turning(&bodies, rate)?);
        } else {
            renderer.limit_torque(0.0);
        }
        renderer.set_gripper_port(protection.gripper(rate)?);
        renderer.exchange(&mut bodies);
        let guides = renderer.guides(0).to_vec();
        let kind = Protected { protection, accepted_guides: Vec::new() };
        let mut servo = Servo { renderer, kind };
        servo.guide(&guides)?;
        Ok(servo)
    }

    /// Sets the guides of every contact point.
    pub fn guide(&mut self, guides: &[Guide]) {
        self.renderer.guide(guides);
    }

    /// This servo with the default protection for `profile`.
    pub(super) fn protected_for(self, profile: &DeviceProfile) -> Result<Servo, HapticsError> {
        self.protected(&Protection::new(profile.clone()))
    }

    /// Replaces the bodies from the next tick on. Returns the old bodies, to be dropped on a
    /// thread that may free memory.
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
    #[must_use]
    pub fn replace_bodies(&mut self, bodies: Bodies) -> Bodies {
        let mut bodies = AcceptedBodies::unchanged(bodies);
        self.renderer.exchange(&mut bodies);
        bodies.bodies
    }
}
