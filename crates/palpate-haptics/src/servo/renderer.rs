// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a servo renders.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::hint::black_box;
use std::mem::swap;

use palpate_device::{
    Buttons, DeviceError, GripperState, NumberError, PointState, Reading, TurnState,
};
use palpate_field::{Point, Pose, Vector};
use palpate_safety::{
    Arrival, Arrivals, ReadingsReport, SafetyReport, StageEffects, WorkspaceMap, WrenchChain,
};

use crate::accepted_bodies::AcceptedBodies;
use crate::bodies::{Bodies, Reach};
use crate::contact_point::{ContactPoint, MOST_EVENTS, Setting, Tick, Touch};
use crate::coupled_tool::{CoupledTool, Sides};
use crate::error::{HapticsError, ServoOptions};
use crate::event::{Energy, Event, EventKind, Reaction};
use crate::guide::Guide;
use crate::live::GripperPort;
use crate::nearby::Nearby;
use crate::ports::{Port, TurningPort};
use crate::proxy::{MOST_OF_POINT, Probe};
use crate::tool::{Coupling, HeldTool, Tool};

/// Fewer bodies than this all count as near: selecting would cost more than it saves.
const FEW: usize = 5;

/// The largest motion of proxies in a tick, in device motions and probe radii: so large that
/// the horizon never constrains a proxy.
const WAYS: f64 = 32.0;

/// The bodies near a proxy that an edit carries, in probe radii and longest ways: so far away that
/// no other body is in reach.
const REACHES: f64 = 4.0;

/// Renders bodies to contact points or to a tool, and holds the results of the last tick.
///
/// A [`Servo`](crate::Servo) dereferences to its renderer, which has the methods that read; the
/// servo has those that change.
#[derive(Clone, Debug)]
pub struct Renderer {
    accepted: AcceptedBodies,
    contacts: Contacts,
    rendered: Rendered,
    setting: Setting,
    arrivals: Arrivals,
    buttons: Buttons,
    /// The buttons that were down in the tick before.
    buttons_before: Buttons,
    gripper: GripperPort,
    is_stopped: bool,
    /// Ticks done.
    tick: u64,
}

/// Where a body is to be, and over what time [s] it moves there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement {
    pub(crate) pose: Pose<3>,
    pub(crate) over: f64,
}

/// What is rendered: contact points or a tool.
#[derive(Clone, Debug)]
enum Rendered {
    /// Independent contact points.
    Points {
        /// Copies on which a tick is rehearsed.
        doubles: Contacts,
    },
    /// A rigid tool, coupled to the one contact point.
    Tool(Box<CoupledTool>),
}

/// Contact points with the results of the last tick.
#[derive(Clone, Debug)]
struct Contacts {
    points: Vec<ContactPoint>,
    touches: Vec<Touch>,
    events: Vec<Event>,
    /// The forces to write [N], in device coordinates.
    forces: Vec<Vector<f64, 3>>,
}

impl Contacts {
    fn new(probe: Probe, points: usize) -> Self {
        Self {
            points: vec![ContactPoint::new(probe); points],
            touches: vec![Touch::NONE; points],
            events: Vec::with_capacity(MOST_EVENTS * points + usize::from(Buttons::MOST)),
            forces: vec![Vector::ZERO; points],
        }
    }
}

impl Renderer {
    /// A renderer of `bodies` to `points` contact points.
    #[inline(never)]
    pub(crate) fn of_points(
        bodies: Bodies,
        points: usize,
        options: ServoOptions,
    ) -> Result<Self, HapticsError> {
        if points == 0 {
            return Err(DeviceError::NoContactPoint.into());
        }
        let rate = NumberError::check_rate(options.rate)?;
        let rise_time = NumberError::check_positive("rise_time", options.rise_time, "s")?;
        NumberError::check_positive_or_infinite("max_force", options.max_force, "N")?;
        Ok(Self {
            accepted: AcceptedBodies::unchanged(bodies),
            contacts: Contacts::new(options.probe, points),
            rendered: Rendered::Points { doubles: Contacts::new(options.probe, points) },
            setting: Setting {
                options,
                map: WorkspaceMap::default(),
                arrival: Arrival { late: 0.0, elapsed: None, is_ready: false },
                rise_step: 1.0 / (rate * rise_time),
                is_lifted: false,
            },
            arrivals: Arrivals::new(rate)?,
            buttons: Buttons::NONE,
            buttons_before: Buttons::NONE,
            gripper: GripperPort::default(),
            is_stopped: false,
            tick: 0,
        })
    }

    /// A renderer of `bodies` to a tool.
    #[inline(never)]
    pub(crate) fn of_tool(
        bodies: Bodies,
        tool: Tool,
        options: ServoOptions,
    ) -> Result<Self, HapticsError> {
        let mut renderer = Self::of_points(bodies, 1, options)?;
        let tool = tool.of_servo(&options);
        renderer.setting.options.max_force = tool.options().force_limit();
        Ok(Self { rendered: Rendered::Tool(Box::new(CoupledTool::new(tool))), ..renderer })
    }

    fn coupled_tool(&self) -> Option<&CoupledTool> {
        match &self.rendered {
            Rendered::Points { .. } => None,
            Rendered::Tool(tool) => Some(tool),
        }
    }

    fn coupled_tool_mut(&mut self) -> Option<&mut CoupledTool> {
        match &mut self.rendered {
            Rendered::Points { .. } => None,
            Rendered::Tool(tool) => Some(tool),
        }
    }

    /// The tool; `None` if the servo renders contact points.
    #[must_use]
    pub fn tool(&self) -> Option<&Tool> {
        self.coupled_tool().map(|coupled| &coupled.tool)
    }

    /// The tool after the last tick, with its torque at the device; `None` if the servo renders
    /// contact points.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn held_tool(&self) -> Option<HeldTool> {
        self.coupled_tool().map(CoupledTool::held)
    }

    /// The torque of the last tick, to be written to a device with rotation [N·m]: in device
    /// coordinates, about the device point. Zero without a tool.
    #[must_use]
    pub fn torque(&self) -> Vector<f64, 3> {
        self.coupled_tool().map_or(Vector::ZERO, |coupled| coupled.torque)
    }

    /// Rate, probe and force limit.
    #[must_use]
    pub fn options(&self) -> &ServoOptions {
        &self.setting.options
    }

    /// The bodies, with the stiffness and damping that are rendered.
    #[must_use]
    pub fn bodies(&self) -> &Bodies {
        &self.accepted.bodies
    }

    /// The bodies with what was accepted for the device.
    pub(super) fn accepted(&self) -> &AcceptedBodies {
        &self.accepted
    }

    /// The contact points after the last tick.
    #[must_use]
    pub fn touches(&self) -> &[Touch] {
        &self.contacts.touches
    }

    /// The forces of the last tick, to be written to the device [N], in device coordinates.
    #[must_use]
    pub fn forces(&self) -> &[Vector<f64, 3>] {
        &self.contacts.forces
    }

    /// The events of the last tick.
    #[must_use]
    pub fn events(&self) -> &[Event] {
        &self.contacts.events
    }

    /// Force and torque on each body in the last tick.
    #[must_use]
    pub fn reactions(&self) -> &[Reaction] {
        self.bodies().reactions()
    }

    /// The buttons that were held down in the last tick.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn buttons(&self) -> Buttons {
        self.buttons
    }

    /// The gripper in the last tick; `None` for a device without one.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn gripper(&self) -> Option<GripperState> {
        self.gripper.state
    }

    /// The force on the fingers in the gripper in the last tick, to be written to the device [N];
    /// positive opens the jaws.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn gripper_force(&self) -> f64 {
        self.gripper.force
    }

    /// Whether forces and torques are stopped.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.is_stopped
    }

    /// The energy at a contact point since the start; zero for an
    /// [unprotected](crate::Unprotected) servo.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn energy(&self, point: u32) -> Energy {
        let turning = self.coupled_tool().and_then(|coupled| coupled.port.as_ref());
        if let Some(energy) = turning.and_then(TurningPort::energy) {
            return energy;
        }
        let port =
            self.contacts.points.get(point as usize).and_then(|point| point.port.as_ref());
        port.map_or(Energy::default(), Port::energy)
    }

    /// The requested coupling of the tool, before device limits; `None` for contact points.
    #[inline(never)]
    pub(crate) fn requested_coupling(&self) -> Option<Coupling> {
        self.coupled_tool().map(|coupled| coupled.requested)
    }

    /// Sets the map between device and world coordinates.
    #[inline(never)]
    pub(crate) fn set_map(&mut self, map: WorkspaceMap) {
        self.setting.map = map;
    }

    /// Sets the port of every contact point, and for a tool the rotational port `turning`. What
    /// was limited or stopped before stays so.
    #[inline(never)]
    pub(crate) fn set_ports(&mut self, port: &Port, turning: Option<TurningPort>) {
        self.contacts.points.iter_mut().for_each(|point| point.port = Some(port.clone()));
        if let Some(coupled) = self.coupled_tool_mut() {
            coupled.port = turning;
            coupled.keep_torque_limit();
        }
        if self.is_stopped {
            self.stop(true);
        }
    }

    pub(crate) fn set_turn(&mut self, turn: Option<TurnState>) {
        if let Some(coupled) = self.coupled_tool_mut() {
            coupled.turn = turn;
        }
    }

    pub(crate) fn set_late(&mut self, late: f64) {
        self.arrivals.set_late(late);
    }

    pub(crate) fn set_reading(&mut self, reading: Reading) {
        self.arrivals.set_reading(reading);
    }

    pub(crate) fn set_buttons(&mut self, buttons: Buttons) {
        self.buttons = buttons;
    }

    pub(crate) fn set_gripper(&mut self, state: Option<GripperState>) {
        self.gripper.state = state;
    }

    pub(crate) fn set_gripper_force(&mut self, wanted: f64) {
        self.gripper.wanted = wanted;
    }

    /// Sets the safety chain of the gripper's force.
    pub(super) fn set_gripper_port(&mut self, port: GripperPort) {
        self.gripper = port;
        self.gripper.stop(self.is_stopped);
    }

    #[inline(never)]
    pub(crate) fn stop(&mut self, is_stopped: bool) {
        self.is_stopped = is_stopped;
        self.ports().for_each(|port| port.stop(is_stopped));
        self.gripper.stop(is_stopped);
        if let Some(chain) = self.coupled_tool_mut().and_then(CoupledTool::chain) {
            if is_stopped { chain.stop() } else { chain.release() }
        }
    }

    fn ports(&mut self) -> impl Iterator<Item = &mut Port> {
        self.contacts.points.iter_mut().filter_map(|point| point.port.as_mut())
    }

    #[inline(never)]
    pub(crate) fn set_pose(&mut self, body: usize, world_from_body: Pose<3>) {
        self.accepted.bodies.set_pose(body, world_from_body);
    }

    /// Moves a body along a screw to a pose, over a time [s]. Where it would carry a contact point
    /// faster than `largest_speed` [m/s], it jumps: the proxy is placed anew, and the force rises from
    /// what it was.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[inline(never)]
    pub(crate) fn move_body(&mut self, body: usize, to: &Placement, largest_speed: f64) {
        let Placement { pose, over } = *to;
        let ticks = over * self.setting.options.rate;
        let way = |touch| self.accepted.bodies.way_to(body, &pose, self.reach(touch));
        let way_of_any = self.contacts.touches.iter().map(way).fold(0.0, f64::max);
        // A hand that is lost, with a way of NaN, touches nothing. A speed of NaN allows none.
        let speed = way_of_any * self.setting.options.rate / ticks.max(1.0);
        let jumps = speed > 0.0 && (speed > largest_speed || largest_speed.is_nan());
        if jumps {
            self.jump(body, pose);
        } else {
            self.accepted.bodies.move_to(body, pose, ticks);
        }
    }

    /// Lets a body jump to a pose: the proxies that are or were near it are placed anew, and the force
    /// rises from what it was.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[inline(never)]
    pub(crate) fn jump(&mut self, body: usize, pose: Pose<3>) {
        let mut is_near_any = false;
        for index in 0..self.contacts.touches.len() {
            let Some(touch) = self.contacts.touches.get(index) else { continue };
            let is_near = self.accepted.bodies.way_to(body, &pose, self.reach(touch)) > 0.0;
            is_near_any |= is_near;
            if let Some(point) = self.contacts.points.get_mut(index) {
                point.see_jump(is_near.then_some(body as u32), touch.wanted);
            }
        }
        self.accepted.bodies.jump_to(body, pose);
        if let Rendered::Tool(coupled) = &mut self.rendered {
            coupled.tool.see_jump(is_near_any);
        }
    }

    /// What a body that jumps may meet of a hand.
    fn reach(&self, touch: &Touch) -> Reach {
        let radius = self.setting.options.probe.radius();
        let spread = match &self.rendered {
            Rendered::Tool(coupled) => coupled.tool.shell().reach(),
            _ => 0.0,
        };
        Reach { place: touch.device, spread, reach: REACHES * (radius + touch.depth()) }
    }

    /// Swaps the rendered bodies with `bodies`; the next tick renders the new ones. `false`, and
    /// nothing changes, if `bodies` were accepted for another servo.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic unless a custom field
    /// does.
    #[must_use]
    #[inline(never)]
    pub(crate) fn adopt(&mut self, bodies: &mut AcceptedBodies) -> bool {
        let is_own = self.accepted.is_for_servo_of(bodies);
        if is_own {
            self.exchange(bodies);
        }
        is_own
    }

    /// Swaps the rendered bodies with `bodies`, whichever servo they were accepted for. The new ones
    /// carry out the proxies that they cover.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic unless a custom field
    /// does; evaluates the fields at most [`Probe::budget`] times a point.
    #[inline(never)]
    pub(crate) fn exchange(&mut self, bodies: &mut AcceptedBodies) {
        let most_of_point = MOST_OF_POINT * self.setting.map.scale();
        let Self { accepted, contacts, rendered, setting, .. } = self;
        let around = REACHES * (setting.options.probe.radius() + most_of_point);
        let (before, after) = (&mut accepted.bodies, &mut bodies.bodies);
        let (mut old, mut new) = (before.take_scratch(), after.take_scratch());
        for (point, touch) in contacts.points.iter_mut().zip(&contacts.touches) {
            let near = || (touch.proxy, around);
            let before = nearby(before, near, &mut old.0);
            let after = nearby(after, near, &mut new.0);
            point.replace_bodies([&before, &after], touch.wanted, most_of_point);
        }
        before.put_back(old.0, old.1);
        after.put_back(new.0, new.1);
        swap(accepted, bodies);
        for point in &mut contacts.points {
            if let Some((port, accepted)) = point.port.as_mut().zip(accepted.along()) {
                port.renew(accepted);
            }
        }
        if let Rendered::Tool(coupled) = rendered {
            coupled.adopt(accepted, most_of_point);
        }
    }

    #[inline(never)]
    pub(crate) fn limit_force(&mut self, max_force: f64) {
        // `min` ignores NaN.
        self.setting.options.max_force = self.setting.options.max_force.min(max_force).max(0.0);
        let limit = self.setting.options.max_force;
        if let Some(coupled) = self.coupled_tool_mut() {
            coupled.limit_force(limit);
        }
        self.ports().for_each(|port| port.limit_force(limit));
    }

    #[inline(never)]
    pub(crate) fn limit_torque(&mut self, max_torque: f64) {
        if let Some(coupled) = self.coupled_tool_mut() {
            coupled.limit_torque(max_torque.max(0.0));
        }
    }

    #[inline(never)]
    pub(crate) fn step(&mut self, states: &[PointState]) -> &[Touch] {
        let arrival = self.arrivals.arrive();
        self.setting.arrival = arrival;
        self.accepted.bodies.advance();
        // A point without a state touches nothing.
        let states = if arrival.is_ready { states } else { &[] };
        if matches!(self.rendered, Rendered::Tool(_)) {
            self.render_tool(states);
        } else {
            self.render_points(states);
            self.accepted.bodies.settle();
        }
        self.gripper.tick(arrival);
        self.tell_buttons();
        self.tick += 1;
        if self.is_stopped {
            self.withhold();
        }
        &self.contacts.touches
    }

    /// Adds an event for each button that was pressed or released.
    fn tell_buttons(&mut self) {
        let before = std::mem::replace(&mut self.buttons_before, self.buttons);
        let Self { contacts: Contacts { events, .. }, tick, buttons, .. } = self;
        let changed = buttons.changed(before);
        if changed == Buttons::NONE {
            return;
        }
        for button in changed.iter() {
            let kind = if buttons.is_down(button) {
                EventKind::ButtonDown { button }
            } else {
                EventKind::ButtonUp { button }
            };
            // The capacity set aside at the start holds every event that a tick can produce.
            if events.len() < events.capacity() {
                events.push(Event { tick: *tick, point: 0, body: 0, kind });
            }
        }
    }

    /// Sets all forces to zero; after the release, forces rise from zero.
    #[cold]
    fn withhold(&mut self) {
        let Contacts { points, touches, forces, .. } = &mut self.contacts;
        forces.fill(Vector::ZERO);
        touches.iter_mut().for_each(|touch| touch.force = Vector::ZERO);
        points.iter_mut().for_each(ContactPoint::rise_anew);
        if let Some(coupled) = self.coupled_tool_mut() {
            coupled.withhold();
        }
    }

    fn render_tool(&mut self, states: &[PointState]) {
        let Rendered::Tool(coupled) = &mut self.rendered else { return };
        let Contacts { points, touches, events, forces } = &mut self.contacts;
        events.clear();
        let points = points.iter_mut().zip(touches).zip(forces);
        for (index, ((point, touch), force)) in points.enumerate() {
            let sides = Sides { point, bodies: &mut self.accepted.bodies };
            *force = coupled.tick(sides, &self.setting, state(states, index), touch);
        }
        let told = coupled.tool.events().iter().take(MOST_EVENTS);
        events.extend(told.map(|event| Event { tick: self.tick, ..*event }));
    }

    /// The contact points' part of a tick.
    ///
    /// Never inlined: rehearsal and tick share one code address, so the rehearsal warms the
    /// instruction cache for the tick.
    #[inline(never)]
    fn render_points(&mut self, states: &[PointState]) {
        let Contacts { points, touches, events, forces } = &mut self.contacts;
        events.clear();
        let bodies = &mut self.accepted.bodies;
        let (mut list, mut reactions) = bodies.take_scratch();
        reactions.fill(Reaction::NONE);
        let hand = || hand(touches, states, &self.setting);
        let nearby = nearby(bodies, hand, &mut list);
        let mut tick = Tick::new(&nearby, &self.setting, self.tick, events);
        let points = points.iter_mut().zip(touches).zip(forces);
        for (index, ((point, touch), force)) in points.enumerate() {
            *force = point.tick(tick.of_point(index as u32), state(states, index), touch);
            for (index, push) in point.pushes(touch) {
                let reaction = reactions.get_mut(index as usize);
                if let Some((body, reaction)) = nearby.body(index).zip(reaction) {
                    reaction.add(-push, touch.proxy - body.world_from_body().translation);
                }
            }
        }
        bodies.put_back(list, reactions);
    }

    /// Runs a tick with `states` on copies of the contact points, only to load the code and
    /// data of the next tick into the caches. A tool has no copy, because copying a tool would
    /// allocate: its rehearsal only evaluates the bodies at the tool.
    ///
    /// Real-time: as [`Servo::step`](crate::Servo::step).
    #[inline(never)]
    pub(crate) fn rehearse(&mut self, states: &[PointState]) {
        match &mut self.rendered {
            Rendered::Tool(coupled) => {
                let origin = coupled.tool.touch().pose.translation;
                black_box(self.accepted.bodies.everything().look(origin));
                return;
            }
            Rendered::Points { doubles } => {
                let contacts = self.contacts.points.iter().zip(&self.contacts.touches);
                let copies = doubles.points.iter_mut().zip(&mut doubles.touches);
                for ((double, its_touch), (point, touch)) in copies.zip(contacts) {
                    (*double, *its_touch) = (point.double(), *touch);
                }
            }
        }
        self.swap_doubles();
        self.render_points(states);
        self.swap_doubles();
    }

    /// Swaps the state that a tick changes with its copies.
    fn swap_doubles(&mut self) {
        if let Rendered::Points { doubles } = &mut self.rendered {
            swap(&mut self.contacts, doubles);
        }
        self.accepted.bodies.swap_reactions();
    }
}

/// The bodies that a contact can reach in a tick.
fn nearby<'a>(
    bodies: &'a Bodies,
    hand: impl FnOnce() -> (Point<3>, f64),
    list: &'a mut [u32],
) -> Nearby<'a> {
    if bodies.bodies().len() < FEW {
        return bodies.everything();
    }
    let (centre, radius) = hand();
    bodies.nearby(centre, radius, list)
}

/// The state of a contact point; NaN if it is missing.
fn state(states: &[PointState], index: usize) -> PointState {
    states.get(index).copied().unwrap_or(PointState::at_rest(Vector([f64::NAN; 3])))
}

/// A ball around all finite contact points and the places that their proxies can reach in this
/// tick.
fn hand(
    touches: &[Touch],
    states: &[PointState],
    Setting { map, options, .. }: &Setting,
) -> (Point<3>, f64) {
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
    // With a single point the centre is the point itself.
    if count > 1.0 {
        for (position, _) in known {
            radius = radius.max((position - centre).norm());
        }
    }
    (centre, radius + WAYS * (motion + options.probe.radius()))
}

impl Renderer {
    /// The guides of a contact point, as the last tick left them; none for a point that is not
    /// there.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    ///
    /// ```
    /// use palpate_field::{Shape, Vector};
    /// use palpate_device::PointState;
    /// use palpate_haptics::{Guide, GuideOptions, Servo};
    /// let mut servo = Servo::new(Shape::circle(0.05)?, 1, Default::default())?;
    /// servo.guide(&[Guide::to_point([0.0, 0.1, 0.0], GuideOptions::default())?]);
    /// servo.step(&[PointState::at_rest(Vector([0.0, 0.103, 0.0]))]);
    /// assert!(servo.guides(0)[0].is_engaged());
    /// assert!((servo.guides(0)[0].last_force() - Vector([0.0, -0.9, 0.0])).norm() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn guides(&self, point: u32) -> &[Guide] {
        self.contacts.points.get(point as usize).map_or(&[], |point| &point.guides)
    }

    /// The bodies, by their indices, that the proxy of a contact point lies in, because they moved and
    /// left it no room beside bodies that stand still; none if there is room, and for a tool.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    ///
    /// ```
    /// use palpate_device::PointState;
    /// use palpate_field::{Pose, Shape, Vector};
    /// use palpate_haptics::{Bodies, Body, Material, Servo, ServoOptions};
    ///
    /// let plate = |y: f64| -> Result<Body, palpate_haptics::HapticsError> {
    ///     let plate = Shape::cuboid([0.1, 0.02, 0.1])?;
    ///     Body::new(plate, Material::default())?.at(Pose::translation([0.0, y, 0.0]))
    /// };
    /// let bodies = Bodies::new(vec![plate(-0.01)?, plate(0.0141)?])?;
    /// let mut servo = Servo::new(bodies, 1, ServoOptions::default())?;
    /// let hand = [PointState::at_rest(Vector([0.0, 0.002, 0.0]))];
    /// servo.step(&hand);
    /// assert_eq!(servo.squeezed_by(0).count(), 0);
    /// // The gap for a ball of 4 mm becomes 3.9 mm.
    /// servo.set_pose(1, Pose::translation([0.0, 0.0139, 0.0]));
    /// servo.step(&hand);
    /// assert_eq!(servo.squeezed_by(0).collect::<Vec<_>>(), [1]);
    /// # Ok::<(), palpate_haptics::HapticsError>(())
    /// ```
    pub fn squeezed_by(&self, point: u32) -> impl Iterator<Item = u32> {
        let point = self.contacts.points.get(point as usize);
        point.into_iter().flat_map(|point| point.proxy.yielding().bodies())
    }

    /// Sets the guides of every contact point.
    #[inline(never)]
    pub(crate) fn guide(&mut self, guides: &[Guide]) {
        for point in &mut self.contacts.points {
            point.guides = guides.to_vec();
        }
    }

    /// Swaps the guides of each contact point with those of a list.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    #[inline(never)]
    pub(crate) fn exchange_guides(&mut self, guides: &mut [Vec<Guide>]) {
        let points = self.contacts.points.iter_mut();
        points.zip(guides).for_each(|(point, new)| swap(&mut point.guides, new));
    }
}

impl Renderer {
    /// Whether the hand is [lifted](crate::Servo::lift) off the bodies.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn is_lifted(&self) -> bool {
        self.setting.is_lifted
    }

    /// Lifts the hand off the bodies, or sets it down.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[inline(never)]
    pub(crate) fn lift(&mut self, is_lifted: bool) {
        self.setting.is_lifted = is_lifted;
    }
}

impl Renderer {
    /// The report of every contact point's safety chain so far; empty for an
    /// [unprotected](crate::Unprotected) servo.
    #[must_use]
    #[inline(never)]
    pub fn safety(&self) -> Vec<SafetyReport> {
        self.with_ports(Port::report, WrenchChain::report)
            .map(|(report, readings)| report.with_readings(readings))
            .collect()
    }

    /// What the safety chain of each contact point says, that of force alone or that of force and
    /// torque, and the readings that were held back before it.
    fn with_ports<'a, T: 'a>(
        &'a self,
        of_port: fn(&Port) -> T,
        of_chain: fn(&WrenchChain) -> T,
    ) -> impl Iterator<Item = (T, ReadingsReport)> + 'a {
        let turning = self.coupled_tool().and_then(|coupled| coupled.port.as_ref());
        let chain = turning.and_then(|turning| turning.chain.as_ref());
        let ports = self.contacts.points.iter().filter_map(|point| point.port.as_ref());
        ports.map(move |port| {
            let readings = port.readings();
            let readings = turning.map_or(readings, |turning| turning.with_turns(readings));
            (chain.map_or_else(|| of_port(port), of_chain), readings)
        })
    }

    /// What each stage of the safety chains of all contact points has done; nothing for an
    /// [unprotected](crate::Unprotected) servo.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    #[inline(never)]
    pub fn stage_effects(&self) -> StageEffects {
        self.with_ports(Port::stage_effects, WrenchChain::stage_effects)
            .map(|(effects, readings)| effects.with_readings(&readings))
            .sum()
    }
}
