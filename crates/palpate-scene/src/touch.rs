// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! From a built scene to what can be touched: bodies, a world, a servo.

use palpate_device::{Device, DeviceProfile};
use palpate_field::{Aabb, Rotation, Vector};
use palpate_haptics::{
    Bodies, Body, HapticsError, Probe, Protection, Servo, ServoOptions, Shell, Surface, Tool,
};
use palpate_query::{QueryError, World, WorldSettings};
use palpate_safety::{Acceptance, SafetyError, SafetySettings, WorkspaceMap};

use crate::build::{BuiltScene, BuiltTool};

/// Points on the surface of a tool that is neither a ball nor a capsule. More feel finer things,
/// and cost more; a face of 1 cm² of a tool as large as a hand has a few.
const POINTS: usize = 500;

/// Settings of a servo that scene files do not hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoSettings {
    /// Ticks a second [Hz].
    pub rate: f64,
    /// What the device renders of materials; `None` for what the scene says, or else the
    /// [acceptance](SafetySettings::acceptance) of `safety`.
    pub acceptance: Option<Acceptance>,
    /// How the safety chains protect.
    pub safety: SafetySettings,
}

impl Default for ServoSettings {
    /// 1 kHz; the device renders of materials what the scene says.
    fn default() -> Self {
        let rate = ServoOptions::default().rate;
        Self { rate, acceptance: None, safety: SafetySettings::default() }
    }
}

impl<const D: usize> BuiltTool<D> {
    /// The tool with a shape, as it is felt; `None` for contact points.
    ///
    /// A ball and a capsule are felt as they are, any other shape as 500 points on its surface
    /// ([`Shell::of_shape`]).
    ///
    /// # Errors
    ///
    /// As [`Shell::of_shape`] and [`Tool::new`].
    #[inline(never)]
    pub fn in_hand(&self) -> Result<Option<Tool>, HapticsError> {
        let Some(shape) = &self.shape else { return Ok(None) };
        let shell = Shell::of_shape(shape, POINTS, self.radius)?;
        Tool::new(shell, self.options).map(Some)
    }
}

impl<const D: usize> BuiltScene<D> {
    /// The box around all bodies that have bounds; `None` if none has.
    #[must_use]
    #[inline(never)]
    pub fn bounds(&self) -> Option<Aabb<D>> {
        let boxes = self.bodies.iter().filter_map(|body| body.shape.promise().bounds);
        boxes.map(|bounds| bounds.aabb).reduce(|a, b| a.union(&b))
    }

    /// The box around all bodies that have bounds and the places from which `tool` touches
    /// them: where its origin can be.
    #[must_use]
    #[inline(never)]
    pub fn bounds_with(&self, tool: &Tool) -> Option<Aabb<D>> {
        let bodies = self.bounds()?;
        let rotation = self.device_rotation();
        Some(tool.shell().points().iter().fold(bodies, |all, point| {
            let arm = rotation.rotate(point.centre).truncated();
            all.union(&Aabb { min: bodies.min - arm, max: bodies.max - arm })
        }))
    }

    /// How the device's axes lie in the world.
    #[must_use]
    #[inline(never)]
    pub fn device_rotation(&self) -> Rotation<3> {
        self.workspace.map_or_else(Rotation::identity, |map| map.rotation())
    }

    /// Where the contact points of the tool lie beside the hand [m], in the axes of the world; empty
    /// for a scene whose tool names none, where each point of a device is a contact point.
    ///
    /// # Examples
    ///
    /// The hands of a device, one for each contact point, around a hand at 0.1 m:
    ///
    /// ```
    /// use palpate_sim::Hand;
    /// use palpate_scene::{AnyScene, Scene};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let scene = Scene::from_json(
    ///     r#"{ "palpate": 1, "dimension": 2,
    ///          "bodies": [ { "name": "table", "shape": { "circle": { "radius": 0.05 } } } ],
    ///          "tool": { "points": [[-0.01, 0], [0.01, 0]] } }"#,
    /// )?;
    /// let AnyScene::Planar(scene) = scene.build()? else { unreachable!("dimension is 2") };
    /// let places = scene.contact_points().map(|arm| arm + [0.0, 0.1, 0.0].into());
    /// let hands: Result<Vec<_>, _> = places.map(Hand::resting).collect();
    /// assert_eq!(hands?.len(), 2);
    /// # Ok(())
    /// # }
    /// ```
    pub fn contact_points(&self) -> impl Iterator<Item = Vector<f64, 3>> {
        let rotation = self.device_rotation();
        let points = self.tool.iter().flat_map(|tool| &tool.points);
        points.map(move |arm| rotation.rotate(*arm))
    }

    /// Where the workspace of a device lies: where the scene says, or else so that it holds the
    /// scene, and the places from which a `tool` touches it. A device without a radius, or a
    /// scene without bounds, lies in the world as it is.
    ///
    /// # Errors
    ///
    /// As [`WorkspaceMap::fitting`].
    #[inline(never)]
    pub fn workspace_of(
        &self,
        device: &DeviceProfile,
        tool: Option<&Tool>,
    ) -> Result<WorkspaceMap, HapticsError> {
        if let Some(map) = self.workspace {
            return Ok(map);
        }
        let bounds = tool.map_or_else(|| self.bounds(), |tool| self.bounds_with(tool));
        match bounds {
            Some(bounds) if device.workspace_radius < f64::INFINITY => {
                Ok(WorkspaceMap::fitting(bounds.in_space(), device.workspace_radius)?)
            }
            _ => Ok(WorkspaceMap::default()),
        }
    }

    /// The bodies with their materials, for a servo.
    ///
    /// # Errors
    ///
    /// As [`Surface::new`], [`Body::new`] and [`Bodies::new`].
    #[inline(never)]
    pub fn bodies(&self) -> Result<Bodies, HapticsError> {
        let body = |body: &crate::BuiltBody<D>| {
            Body::new(&body.shape_in_body, Surface::new(&body.material)?)?
                .at(body.world_from_body.in_space())
        };
        Bodies::new(self.bodies.iter().map(body).collect::<Result<_, _>>()?)
    }

    /// The bodies in a world, whose margins are shares of the smallest bounded body; the numbers
    /// of its bodies are their places in the scene.
    ///
    /// # Errors
    ///
    /// As [`World::new`] and [`World::add`].
    pub fn world(&self) -> Result<World<D>, QueryError> {
        self.world_with(self.world_settings())
    }

    /// The settings of [`world`](Self::world).
    #[must_use]
    pub fn world_settings(&self) -> WorldSettings {
        // Without bounded bodies no pair has contacts, and a body without extent, a point, has no
        // size to take a share of: the margins are then those of a body of 1 m.
        WorldSettings::of_size(self.smallest_size().unwrap_or(1.0))
    }

    /// The bodies in a world with settings of one's own.
    ///
    /// # Errors
    ///
    /// As [`World::new`] and [`World::add`].
    #[inline(never)]
    pub fn world_with(&self, settings: WorldSettings) -> Result<World<D>, QueryError> {
        let mut world = World::new(settings)?;
        for body in &self.bodies {
            world.add(body.shape_in_body.clone(), body.world_from_body)?;
        }
        Ok(world)
    }

    /// The largest edge of the box of the body for which that is least [m]; `None` if no body
    /// has bounds.
    #[must_use]
    #[inline(never)]
    pub fn smallest_size(&self) -> Option<f64> {
        let sizes = self.bodies.iter().filter_map(|body| {
            let half = body.shape_in_body.promise().bounds?.aabb.half_extents();
            Some(2.0 * half.0.into_iter().fold(0.0, f64::max))
        });
        sizes.reduce(f64::min).filter(|size| *size > 0.0)
    }

    /// A servo that renders the scene to `device`, protected: its bodies with their materials, its
    /// guides, its tool with the radius, the coupling and the largest force, what the device is to
    /// render of materials, and the workspace, which is made to hold the scene if the scene gives
    /// none. What moves the bodies is [`motion`](Self::motion).
    ///
    /// # Errors
    ///
    /// As [`Servo::for_device`], if a tool has no surface, and
    /// [`HapticsError::ContactPoints`] if the tool has contact points and the device another
    /// number of them.
    ///
    /// # Examples
    ///
    /// A scene file, felt by a hand that rests in the workspace of a device:
    ///
    /// ```
    /// use palpate_device::profile_named;
    /// use palpate_sim::{Hand, SimulatedDevice};
    /// use palpate_haptics::servo_loop::{Pace, RunOptions, run};
    /// use palpate_scene::{AnyScene, Scene};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/terrain.json");
    /// let AnyScene::Spatial(scene) = Scene::from_file(file)?.build()? else {
    ///     return Err("the terrain is in space".into());
    /// };
    /// let mut device =
    ///     SimulatedDevice::new(profile_named("omega")?, vec![Hand::resting([0.0; 3])?])?;
    /// let mut servo = scene.servo(&device)?;
    /// let mut motion = scene.motion();
    /// let options = RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(0.5) };
    /// let report = run(&mut servo, &mut device, RunOptions {
    ///     motion: Some(&mut motion),
    ///     ..options
    /// })?;
    /// assert_eq!(report.ticks, 500);
    /// # Ok(())
    /// # }
    /// ```
    pub fn servo(&self, device: &(impl Device + ?Sized)) -> Result<Servo, HapticsError> {
        let rate = ServoOptions::default().at_rate_of(device).rate;
        self.servo_with(device, ServoSettings { rate, ..ServoSettings::default() })
    }

    /// The same with settings of one's own.
    ///
    /// # Errors
    ///
    /// As [`servo`](Self::servo).
    pub fn servo_with(
        &self,
        device: &(impl Device + ?Sized),
        settings: ServoSettings,
    ) -> Result<Servo, HapticsError> {
        self.servo_for(device.profile(), device.points(), settings)
    }

    #[inline(never)]
    pub(crate) fn servo_for(
        &self,
        profile: &DeviceProfile,
        device_points: usize,
        settings: ServoSettings,
    ) -> Result<Servo, HapticsError> {
        let points = self.contact_points().count();
        if points > 0 && points != device_points {
            return Err(HapticsError::ContactPoints { servo: points, device: device_points });
        }
        let tool = self.tool.as_ref().map_or(Ok(None), BuiltTool::in_hand)?;
        let map = self.workspace_of(profile, tool.as_ref())?;
        let options = self.servo_options(profile, settings.rate)?;
        let servo = match tool {
            None => Servo::new(self.bodies()?, device_points, options)?,
            Some(tool) => {
                let tool = match &profile.turning {
                    // Torques in the world are so many times those at the device.
                    Some(turning) if turning.max_torque > 0.0 => {
                        tool.with_max_torque(map.scale() * turning.max_torque)?
                    }
                    _ => tool,
                };
                Servo::with_tool(self.bodies()?, tool, options)?
            }
        };
        let of_scene = || self.tool.as_ref().and_then(|tool| tool.acceptance);
        let acceptance = settings.acceptance.or_else(of_scene);
        let mut protection = Protection::new(profile.clone()).with_map(map);
        protection.settings = settings.safety;
        protection.settings.acceptance = acceptance.unwrap_or(settings.safety.acceptance);
        if let Some(power) = self.tool.as_ref().and_then(|tool| tool.drive_power) {
            protection.settings.drive_power = power;
        }
        let guided = || protection.accept_guides(&self.guides, settings.rate).err();
        let servo = servo.protected(&protection);
        let mut servo = servo.map_err(|error| all_refused(error, guided()))?;
        servo.guide(&self.guides)?;
        Ok(servo)
    }

    /// The options of a servo: the probe and the largest force of the tool, as far as the scene
    /// names them.
    fn servo_options(
        &self,
        device: &DeviceProfile,
        rate: f64,
    ) -> Result<ServoOptions, HapticsError> {
        let mut options = ServoOptions { rate, ..ServoOptions::of_device(device) };
        if let Some(tool) = &self.tool {
            options.probe = Probe::new(tool.radius)?;
            options.max_force = tool.options.max_force.unwrap_or(options.max_force);
        }
        Ok(options)
    }
}

/// The error with what is refused of guides too, if bodies were refused.
fn all_refused(error: HapticsError, guides: Option<HapticsError>) -> HapticsError {
    use HapticsError::Safety;
    use SafetyError::MaterialRefused;
    match (error, guides) {
        (Safety(MaterialRefused(mut all)), Some(Safety(MaterialRefused(guides)))) => {
            all.extend(guides);
            Safety(MaterialRefused(all))
        }
        (error, _) => error,
    }
}
