// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The servo: device points in, forces out, once a tick.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::hint::black_box;
use std::mem::swap;

use palpate_field::{Point, Pose, Vector};

use crate::bodies::Bodies;
use crate::contact_point::{ContactPoint, MOST_EVENTS, Setting, Tick, Touch};
use crate::device::{DeviceProfile, PointState, TurnState};
use crate::error::{HapticsError, positive, positive_or_infinite};
use crate::event::{Event, Reaction};
use crate::guide::Guide;
use crate::nearby::Nearby;
use crate::protection::{Port, Protection, TurningPort};
use crate::proxy::Probe;
use crate::recorder::Energy;
use crate::rendering::Rendering;
use crate::safety::{Accepted, SafetyReport};
use crate::tool::{Coupling, HeldTool, Hung, Tool};
use crate::workspace::WorkspaceMap;

/// What a servo renders with, and how fast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoOptions {
    /// Ticks a second [Hz].
    pub rate: f64,
    /// The ball that touches.
    pub probe: Probe,
    /// The largest force on a contact point [N]; infinite for none.
    pub max_force: f64,
    /// The time over which the force of a contact rises from nothing to all of it, where a
    /// body covered the device point or moved onto it [s].
    pub rise_time: f64,
}

impl Default for ServoOptions {
    /// 1 kHz, a ball of 2 mm, 3.3 N (a desktop stylus), 0.1 s.
    fn default() -> Self {
        Self { rate: 1000.0, probe: Probe::default(), max_force: 3.3, rise_time: 0.1 }
    }
}

/// Bodies fewer than this are all near.
const FEW: usize = 5;

/// How far proxies may go in a tick, in motions and radii of the probe: far enough that they
/// see no horizon.
const WAYS: f64 = 32.0;

/// Renders bodies to some contact points, each on its own.
///
/// # Examples
///
/// A wall pressed to a depth of 1/256 m:
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ball};
/// use palpate_haptics::{Bodies, Body, PointState, Probe, Servo, ServoOptions, Surface};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let options = ServoOptions { probe: Probe::new(0.0)?, ..ServoOptions::default() };
/// let ball = Shape::from_kernel(Ball::new(0.5)?);
/// let bodies = Bodies::new(vec![Body::new(ball, Surface::smooth(512.0, 0.0)?)?])?;
/// let mut servo = Servo::new(bodies, 1, options)?;
/// servo.step(&[PointState::at_rest(Vector([0.0, 1.0]))]);
/// let touches = servo.step(&[PointState::at_rest(Vector([0.0, 0.5 - 1.0 / 256.0]))]);
///
/// assert!(touches[0].contact);
/// assert!((touches[0].force - Vector([0.0, 2.0])).norm() < 1e-4);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Servo<const D: usize> {
    bodies: Bodies<D>,
    contacts: Contacts<D>,
    /// What a tick is rehearsed on.
    doubles: Contacts<D>,
    /// What is felt at the one point, if it is a tool with a shape.
    tool: Option<Box<Hung<D>>>,
    setting: Setting<D>,
    protection: Option<Box<Protection<D>>>,
    /// Ticks done.
    tick: u64,
}

/// Contact points and what the last tick made of them.
#[derive(Clone, Debug)]
struct Contacts<const D: usize> {
    points: Vec<ContactPoint<D>>,
    touches: Vec<Touch<D>>,
    events: Vec<Event>,
    /// The forces to write [N], in device coordinates.
    forces: Vec<Vector<f64, D>>,
}

impl<const D: usize> Contacts<D> {
    fn new(probe: Probe, points: usize) -> Self {
        Self {
            points: vec![ContactPoint::new(probe); points],
            touches: vec![Touch::NONE; points],
            events: Vec::with_capacity(MOST_EVENTS * points),
            forces: vec![Vector::ZERO; points],
        }
    }
}

impl<const D: usize> Servo<D> {
    /// A servo that renders `bodies` to `points` contact points. A shape alone is one body of
    /// the default surface.
    ///
    /// # Errors
    ///
    /// [`HapticsError::NoContactPoint`] if there are none; [`HapticsError::Number`] if the
    /// rate, the rise time or the largest force is not positive.
    pub fn new(
        bodies: impl Into<Bodies<D>>,
        points: usize,
        options: ServoOptions,
    ) -> Result<Self, HapticsError> {
        if points == 0 {
            return Err(HapticsError::NoContactPoint);
        }
        let rate = positive("rate", options.rate, "Hz")?;
        let rise_time = positive("rise_time", options.rise_time, "s")?;
        positive_or_infinite("max_force", options.max_force, "N")?;
        Ok(Self {
            bodies: bodies.into(),
            contacts: Contacts::new(options.probe, points),
            doubles: Contacts::new(options.probe, points),
            tool: None,
            protection: None,
            setting: Setting {
                options,
                map: WorkspaceMap::default(),
                is_late: false,
                rise_step: 1.0 / (rate * rise_time),
            },
            tick: 0,
        })
    }

    /// A servo that renders `bodies` to a tool with a shape, which hangs on the one contact point
    /// of a device: its origin is at the device point, its axes are those of the device, or of
    /// what the hand holds where that [turns](Self::set_turn).
    ///
    /// Rate, rise time and largest force of the servo become the tool's; the probe is not used.
    /// The [touch](Self::touches) is that of the whole tool, with the origin for its proxy, the
    /// normal and the body of the contact that pushes hardest, and a wanted force that is limited
    /// already; the rest is in [`tool`](Self::tool).
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] as [`new`](Self::new).
    ///
    /// # Examples
    ///
    /// A ball of 62.5 mm pressed 2 mm into the ground:
    ///
    /// ```
    /// use palpate_field::{Shape, Vector, kernel::HalfSpace};
    /// use palpate_haptics::{PointState, Servo, ServoOptions, Shell, Tool, ToolOptions};
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
    pub fn with_tool(
        bodies: impl Into<Bodies<D>>,
        tool: Tool<D>,
        options: ServoOptions,
    ) -> Result<Self, HapticsError> {
        let servo = Self::new(bodies, 1, options)?;
        Ok(Self { tool: Some(Box::new(Hung::new(tool.of_servo(&options)))), ..servo })
    }

    /// Stands a safety chain between every contact point and a device; states are read and
    /// forces written in the coordinates of the device from now on. Returns what became of the
    /// stiffness and damping of each body; of a tool with a shape, of what is felt through it, and
    /// where the device gives a torque, second, of the coupling's angular ones.
    ///
    /// A device without force feedback needs no protection; its forces are zero.
    ///
    /// # Errors
    ///
    /// If a body is refused, or a limit of the profile is not positive.
    pub fn protect(
        &mut self,
        protection: &Protection<D>,
    ) -> Result<Vec<Accepted>, HapticsError> {
        self.setting.map = protection.map;
        self.limit_force(protection.profile.max_force);
        if self.setting.options.max_force == 0.0 {
            self.limit_torque(0.0);
            return Ok(Vec::new());
        }
        let rate = self.setting.options.rate;
        let wanted = self.wanted_coupling();
        let mut rendering = protection.rendering(self.bodies.clone(), wanted, rate)?;
        let profile = DeviceProfile {
            max_force: self.setting.options.max_force,
            ..protection.profile.clone()
        };
        let limited = Protection { profile, ..protection.clone() };
        if let Some(hung) = &mut self.tool {
            hung.port = limited.turning(&rendering, rate)?;
        }
        let port = limited.port(&rendering, rate)?;
        self.contacts.points.iter_mut().for_each(|point| point.port = Some(port.clone()));
        self.protection = Some(Box::new(protection.clone()));
        self.adopt(&mut rendering);
        Ok(rendering.accepted)
    }

    /// What stands between the servo and its device, if it is protected.
    #[must_use]
    pub fn protection(&self) -> Option<&Protection<D>> {
        self.protection.as_deref()
    }

    /// How the tool was to hang on the hand before any protection; none of contact points.
    pub(crate) fn wanted_coupling(&self) -> Option<Coupling> {
        self.tool.as_ref().map(|hung| hung.wanted)
    }

    /// The tool with a shape that is rendered to; none of contact points.
    #[must_use]
    pub fn tool(&self) -> Option<&Tool<D>> {
        self.tool.as_ref().map(|hung| &hung.tool)
    }

    /// The tool with a shape after the last tick, as it is held; none of contact points.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn held_tool(&self) -> Option<HeldTool<D>> {
        self.tool.as_ref().map(|hung| hung.held())
    }

    /// How a device that turns is turned in the ticks to come: a tool with a shape turns with it.
    /// `None`, as at first, of a device that does not turn: the tool keeps the device's axes.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    ///
    /// # Examples
    ///
    /// A rod of 10 cm is pressed onto the ground by 1 cm and turned by 0.1 rad: it stays flat, and
    /// its coupling of 1 N·m/rad turns the hand back.
    ///
    /// ```
    /// use palpate_field::{Rotation, Shape, Vector, kernel::HalfSpace};
    /// use palpate_haptics::{
    ///     PointState, Servo, ServoOptions, Shell, Tool, ToolOptions, TurnState,
    /// };
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let ground = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0]), 0.0)?);
    /// let rod = Shell::capsule([Vector([-0.05, 0.0]), Vector([0.05, 0.0])], 0.001, 101)?;
    /// let coupling = ToolOptions { angular_stiffness: Some(1.0), ..ToolOptions::default() };
    /// let mut servo =
    ///     Servo::with_tool(ground, Tool::new(rod, coupling)?, ServoOptions::default())?;
    /// servo.step(&[PointState::at_rest(Vector([0.0, 0.01]))]);
    /// for tick in 1..=100 {
    ///     let orientation = Rotation::from_angle(0.001 * f64::from(tick))?;
    ///     servo.set_turn(Some(TurnState::at_rest(orientation)));
    ///     servo.step(&[PointState::at_rest(Vector([0.0, -0.009]))]);
    /// }
    /// assert!((servo.torque() - Vector([0.0, 0.0, -0.1])).norm() < 1e-6);
    /// # Ok(())
    /// # }
    /// ```
    pub fn set_turn(&mut self, turn: Option<TurnState<D>>) {
        if let Some(hung) = &mut self.tool {
            hung.turn = turn;
        }
    }

    /// The torque of the last tick, to be written to a device that turns [N·m]: in its
    /// coordinates, about the device point. None of contact points.
    #[must_use]
    pub fn torque(&self) -> Vector<f64, 3> {
        self.tool.as_ref().map_or(Vector::ZERO, |hung| hung.torque)
    }

    /// The torque of the last tick on a device that turns [N·m]; none on another.
    pub(crate) fn given_torque(&self) -> Option<Vector<f64, 3>> {
        self.tool.as_ref().filter(|hung| hung.turn.is_some()).map(|hung| hung.torque)
    }

    /// Guides every contact point.
    pub fn guide(&mut self, guides: &[Guide<D>]) {
        for point in &mut self.contacts.points {
            point.guides = guides.to_vec();
        }
    }

    /// What is rendered with, and how fast.
    #[must_use]
    pub fn options(&self) -> &ServoOptions {
        &self.setting.options
    }

    /// What is touched.
    #[must_use]
    pub fn bodies(&self) -> &Bodies<D> {
        &self.bodies
    }

    /// The contact points after the last tick.
    #[must_use]
    pub fn touches(&self) -> &[Touch<D>] {
        &self.contacts.touches
    }

    /// The forces of the last tick, to be written to the device [N]: in its coordinates.
    #[must_use]
    pub fn forces(&self) -> &[Vector<f64, D>] {
        &self.contacts.forces
    }

    /// What the safety chain of every contact point did so far; nothing if there is none.
    #[must_use]
    pub fn safety(&self) -> Vec<SafetyReport> {
        let port = self.tool.as_ref().and_then(|hung| hung.port.as_ref());
        if let Some(chain) = port.and_then(|port| port.chain.as_ref()) {
            return vec![chain.report()];
        }
        self.contacts
            .points
            .iter()
            .filter_map(|point| point.port.as_ref())
            .map(Port::report)
            .collect()
    }

    /// The energy at a contact point since the start; none of a servo that is not protected.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn energy(&self, point: u32) -> Energy {
        let turning = self.tool.as_ref().and_then(|hung| hung.port.as_ref());
        if let Some(energy) = turning.and_then(TurningPort::energy) {
            return energy;
        }
        let port =
            self.contacts.points.get(point as usize).and_then(|point| point.port.as_ref());
        port.map_or(Energy::default(), Port::energy)
    }

    /// Says whether the next tick starts too late.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn set_late(&mut self, is_late: bool) {
        self.setting.is_late = is_late;
    }

    /// Stops all forces and torques, or lets them rise again. It needs [protection](Self::protect).
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn stop(&mut self, is_stopped: bool) {
        self.ports().for_each(|port| port.stop(is_stopped));
        if let Some(chain) = self.tool.as_mut().and_then(|hung| hung.chain()) {
            if is_stopped { chain.stop() } else { chain.release() }
        }
    }

    fn ports(&mut self) -> impl Iterator<Item = &mut Port<D>> {
        self.contacts.points.iter_mut().filter_map(|point| point.port.as_mut())
    }

    /// What happened in the last tick.
    #[must_use]
    pub fn events(&self) -> &[Event] {
        &self.contacts.events
    }

    /// What was done to each body in the last tick.
    #[must_use]
    pub fn reactions(&self) -> &[Reaction<D>] {
        self.bodies.reactions()
    }

    /// Moves a body before the next tick; see [`Bodies::set_pose`].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn set_pose(&mut self, body: usize, world_from_body: Pose<D>) {
        self.bodies.set_pose(body, world_from_body);
    }

    /// Renders `bodies` from the next tick on. Returns those rendered so far, to be dropped
    /// where freeing is allowed.
    ///
    /// A contact point that the new bodies cover is placed anew, and its force rises gently; so
    /// does one that pushes harder on them than on those before, from where it was. A
    /// [protected](Self::protect) servo renders them as they are: make them ready for its device
    /// first, by [`Protection::accept`]. A [`Control`](crate::Control) does.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn replace_bodies(&mut self, bodies: Bodies<D>) -> Bodies<D> {
        let mut rendering = Rendering::plain(bodies);
        self.adopt(&mut rendering);
        rendering.bodies
    }

    /// Renders `rendering` from the next tick on, and leaves there the bodies rendered so far.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    pub(crate) fn adopt(&mut self, rendering: &mut Rendering<D>) {
        swap(&mut self.bodies, &mut rendering.bodies);
        let Contacts { points, touches, .. } = &mut self.contacts;
        for (point, touch) in points.iter_mut().zip(touches) {
            point.forget_bodies(touch.wanted);
        }
        if let Some(accepted) = rendering.along() {
            self.ports().for_each(|port| port.renew(accepted));
        }
        if let Some(hung) = &mut self.tool {
            hung.adopt(rendering);
        }
    }

    /// Lowers the largest force on a contact point to `max_force` [N]; never raises it. If the
    /// servo is protected, a larger force falls as fast as the device's forces may change.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn limit_force(&mut self, max_force: f64) {
        // `min` ignores NaN.
        self.setting.options.max_force = self.setting.options.max_force.min(max_force).max(0.0);
        let limit = self.setting.options.max_force;
        if let Some(hung) = &mut self.tool {
            hung.limit_force(limit);
        }
        self.ports().for_each(|port| port.limit_force(limit));
    }

    /// Lowers the largest torque on a tool's device to `max_torque` [N·m]; never raises it. If
    /// the servo is protected, a larger torque falls as fast as the device's torques may change.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn limit_torque(&mut self, max_torque: f64) {
        if let Some(hung) = &mut self.tool {
            hung.limit_torque(max_torque.max(0.0));
        }
    }

    /// One tick: reads each point's state, moves its proxy, gives its force.
    ///
    /// A point that is not finite, or for which there is no state, touches nothing: its force is
    /// zero, and its proxy waits where it was.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic unless a custom field does;
    /// evaluates the field at most [`Probe::budget`] times a point, once more for each magnet in
    /// reach, and once for each dimension of a textured surface; for a tool,
    /// [`ToolOptions::budget`](crate::ToolOptions::budget) times.
    pub fn step(&mut self, states: &[PointState<D>]) -> &[Touch<D>] {
        if let Some(hung) = &mut self.tool {
            self.contacts.events.clear();
            let points = self
                .contacts
                .points
                .iter_mut()
                .zip(&mut self.contacts.touches)
                .zip(&mut self.contacts.forces);
            for (index, ((point, touch), force)) in points.enumerate() {
                let at = (point, &mut self.bodies);
                *force = hung.tick(at, &self.setting, state(states, index), touch);
            }
            let told = hung.tool.events().iter().take(MOST_EVENTS);
            self.contacts.events.extend(told.map(|event| Event { tick: self.tick, ..*event }));
            self.tick += 1;
            return &self.contacts.touches;
        }
        self.render(states);
        self.bodies.settle();
        self.tick += 1;
        &self.contacts.touches
    }

    /// A tick of contact points, up to its end.
    ///
    /// Never inlined: a tick finds warm what its rehearsal warmed, which is the code at this
    /// place.
    #[inline(never)]
    fn render(&mut self, states: &[PointState<D>]) {
        let Contacts { points, touches, events, forces } = &mut self.contacts;
        events.clear();
        let (mut list, mut reactions) = self.bodies.take_scratch();
        reactions.fill(Reaction::NONE);
        let hand = || hand(touches, states, &self.setting);
        let nearby = nearby(&self.bodies, hand, &mut list);
        let mut tick = Tick::new(&nearby, &self.setting, self.tick, events);
        let points = points.iter_mut().zip(touches).zip(forces);
        for (index, ((point, touch), force)) in points.enumerate() {
            *force = point.tick(tick.of_point(index as u32), state(states, index), touch);
            let touched = nearby.body(touch.body).filter(|_| touch.contact);
            let reaction = reactions.get_mut(touch.body as usize);
            if let Some((body, reaction)) = touched.zip(reaction) {
                reaction.add(-touch.wanted, touch.proxy - body.world_from_body().translation);
            }
        }
        self.bodies.put_back((list, reactions));
    }

    /// Does what [`step`](Self::step) would with `states`, on doubles of the contact points:
    /// nothing comes of it but that the next tick finds its code and data in the caches. A tool
    /// has no double, as to copy it would allocate: the bodies alone are asked where it is.
    ///
    /// Real-time: as [`step`](Self::step).
    pub(crate) fn rehearse(&mut self, states: &[PointState<D>]) {
        if let Some(hung) = &self.tool {
            black_box(self.bodies.everything().look(hung.tool.touch().pose.translation));
            return;
        }
        let contacts = self.contacts.points.iter().zip(&self.contacts.touches);
        let doubles = self.doubles.points.iter_mut().zip(&mut self.doubles.touches);
        for ((double, its_touch), (point, touch)) in doubles.zip(contacts) {
            (*double, *its_touch) = (point.double(), *touch);
        }
        self.change_places();
        self.render(states);
        self.change_places();
    }

    /// Puts what a tick changes and its doubles in the place of each other.
    fn change_places(&mut self) {
        swap(&mut self.contacts, &mut self.doubles);
        self.bodies.swap_reactions();
    }
}

/// The bodies that are near enough to matter in a tick.
fn nearby<'a, const D: usize>(
    bodies: &'a Bodies<D>,
    hand: impl FnOnce() -> (Point<D>, f64),
    list: &'a mut [u32],
) -> Nearby<'a, D> {
    if bodies.bodies().len() < FEW { bodies.everything() } else { bodies.nearby(hand(), list) }
}

/// The state of a contact point; not finite if it is missing.
fn state<const D: usize>(states: &[PointState<D>], index: usize) -> PointState<D> {
    states.get(index).copied().unwrap_or(PointState::at_rest(Vector([f64::NAN; D])))
}

/// A ball around all contact points and where their proxies may go in this tick, as far as
/// they are finite.
fn hand<const D: usize>(
    touches: &[Touch<D>],
    states: &[PointState<D>],
    Setting { map, options, .. }: &Setting<D>,
) -> (Point<D>, f64) {
    let known = states.iter().zip(touches).filter(|(state, _)| state.position.is_finite());
    let known = known.map(|(state, touch)| (map.point_to_world(state.position), touch));
    let (mut sum, mut count, mut motion) = (Vector::ZERO, 0.0, 0.0_f64);
    for (position, touch) in known.clone() {
        sum += position;
        count += 1.0;
        motion = motion.max((position - touch.proxy).norm());
    }
    let centre = if count > 0.0 { sum * (1.0 / count) } else { Vector::ZERO };
    let mut radius = 0.0_f64;
    // One alone is the centre.
    if count > 1.0 {
        for (position, _) in known {
            radius = radius.max((position - centre).norm());
        }
    }
    (centre, radius + WAYS * (motion + options.probe.radius()))
}
