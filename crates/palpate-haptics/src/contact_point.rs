// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! One contact point in a tick: its proxy, its force, and its port to the device.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Vector};

use crate::bodies::Body;
use crate::event::{Event, EventKind};
use crate::guide::Guide;
use crate::nearby::Nearby;
use crate::options::ServoOptions;
use crate::ports::Port;
use crate::proxy::{Probe, Proxy};
use crate::surface::{Press, Ringing};
use palpate_safety::internal::{limited, shortening};
use palpate_safety::{PointState, PortState, WorkspaceMap};

/// One contact point after a tick. World coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Touch<const D: usize> {
    /// The device point (haptic interface point) [m]; as read, even if it is not finite.
    pub device: Point<D>,
    /// The velocity of the device point [m/s]: relative to the touched body, or to the world in
    /// free space.
    pub velocity: Vector<f64, D>,
    /// The proxy (god-object) [m]; the device point itself in free space.
    pub proxy: Point<D>,
    /// The force of the touched body on the hand [N], before any limit; the hand exerts the
    /// opposite force on the body.
    pub wanted: Vector<f64, D>,
    /// The force on the hand [N], always finite.
    pub force: Vector<f64, D>,
    /// The unit normal of the surface that the proxy last reached, pointing out.
    pub normal: Vector<f64, D>,
    /// `true` if the surface keeps the proxy from the device point.
    pub contact: bool,
    /// The index of the body whose surface the proxy last reached.
    pub body: u32,
    /// `true` if the proxy moves along the surface against friction.
    pub is_slipping: bool,
    /// Evaluations of the field in this tick.
    pub evaluations: u32,
}

impl<const D: usize> Touch<D> {
    pub(crate) const NONE: Self = Self {
        device: Vector::ZERO,
        velocity: Vector::ZERO,
        proxy: Vector::ZERO,
        wanted: Vector::ZERO,
        force: Vector::ZERO,
        normal: Vector::ZERO,
        contact: false,
        body: 0,
        is_slipping: false,
        evaluations: 0,
    };

    /// The distance from the device point to its proxy [m]: how deep the hand presses.
    #[must_use]
    pub fn depth(&self) -> f64 {
        if self.contact { (self.proxy - self.device).norm() } else { 0.0 }
    }
}

/// The most events of a contact point in a tick: a leave; a touch, slip or stick; and a layer
/// that gives way.
pub(crate) const MOST_EVENTS: usize = 3;

/// A contact point of the hand, with its state from tick to tick.
#[derive(Clone, Debug)]
pub(crate) struct ContactPoint<const D: usize> {
    pub(crate) proxy: Proxy<D>,
    /// The rendered part of the force, in [0, 1].
    rise: f64,
    /// The force of the replaced bodies in the tick before [N]; infinite if the bodies are the
    /// same.
    of_others: f64,
    ringing: Ringing,
    pub(crate) guides: Vec<Guide<D>>,
    /// The port to the device; `None` without protection.
    pub(crate) port: Option<Port<D>>,
}

/// Settings that all contact points share.
#[derive(Clone, Debug)]
pub(crate) struct Setting<const D: usize> {
    pub(crate) options: ServoOptions,
    pub(crate) map: WorkspaceMap<D>,
    /// The increase of [`ContactPoint::rise`] in a tick.
    pub(crate) rise_step: f64,
    pub(crate) is_late: bool,
}

/// The state of a tick that all contact points share.
pub(crate) struct Tick<'a, const D: usize> {
    nearby: &'a Nearby<'a, D>,
    setting: &'a Setting<D>,
    /// A template for events: tick and contact point are filled in.
    event: Event,
    events: &'a mut Vec<Event>,
}

impl<'a, const D: usize> Tick<'a, D> {
    pub(crate) fn new(
        nearby: &'a Nearby<'a, D>,
        setting: &'a Setting<D>,
        tick: u64,
        events: &'a mut Vec<Event>,
    ) -> Self {
        let event = Event { tick, point: 0, body: 0, kind: EventKind::Leave };
        Self { nearby, setting, event, events }
    }

    /// This tick, with events of the contact point `point`.
    pub(crate) fn of_point(&mut self, point: u32) -> &mut Self {
        self.event.point = point;
        self
    }

    #[inline(never)]
    fn tell(&mut self, body: u32, kind: EventKind) {
        // The capacity set aside at the start holds every event that a tick can produce.
        if self.events.len() < self.events.capacity() {
            self.events.push(Event { body, kind, ..self.event });
        }
    }
}

/// The force in free space, of guides and magnets.
#[derive(Clone, Copy)]
pub(crate) struct FreeForce<const D: usize> {
    /// The force [N].
    pub(crate) force: Vector<f64, D>,
    /// Whether the proxy was placed anew: then all forces rise from zero.
    pub(crate) placed: bool,
}

/// What a contact point touched in the tick before: its contact, body and motion.
#[derive(Clone, Copy)]
struct Before {
    contact: bool,
    body: u32,
    is_slipping: bool,
}

impl Before {
    fn of<const D: usize>(touch: &Touch<D>) -> Self {
        let Touch { contact, body, is_slipping, .. } = *touch;
        Self { contact, body, is_slipping }
    }
}

impl<const D: usize> ContactPoint<D> {
    pub(crate) fn new(probe: Probe) -> Self {
        let (proxy, guides) = (Proxy::new(probe), Vec::new());
        let (rise, of_others, ringing) = (1.0, f64::INFINITY, Ringing::SILENT);
        Self { proxy, rise, of_others, ringing, guides, port: None }
    }

    /// A copy that rehearses a tick. It has no guides, because copying guides would allocate.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn double(&self) -> Self {
        let (proxy, port) = (self.proxy.clone(), self.port.clone());
        let Self { rise, of_others, ringing, .. } = *self;
        Self { proxy, rise, of_others, ringing, guides: Vec::new(), port }
    }

    /// Forgets the bodies, which are replaced before the next tick; `wanted` is their last
    /// force [N].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn forget_bodies(&mut self, wanted: Vector<f64, D>) {
        self.proxy.forget_bodies();
        self.of_others = wanted.norm();
    }

    /// Lets the force rise from zero; with a port, the safety chain does this.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn rise_anew(&mut self) {
        self.rise = 0.0;
    }

    /// One tick, from the state of the device to the force to write [N], both in device
    /// coordinates; `touch` is the touch of the tick before, and is updated to the touch of
    /// this tick.
    ///
    /// Real-time: as [`Servo::step`](crate::Servo::step).
    pub(crate) fn tick(
        &mut self,
        tick: &mut Tick<'_, D>,
        state: PointState<D>,
        touch: &mut Touch<D>,
    ) -> Vector<f64, D> {
        let at_device = self.port.as_mut().map_or(state, |port| port.state(state));
        let in_world = tick.setting.map.state_to_world(at_device);
        let free = self.feel(tick, &in_world, touch);
        self.give(tick.setting, at_device, touch, free)
    }

    /// Sets the rendered force of `touch` from its wanted force and the force in free space.
    /// Returns the force to write [N], in device coordinates. If `placed`, the force rises from
    /// zero.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[inline(always)]
    pub(crate) fn give(
        &mut self,
        setting: &Setting<D>,
        at_device: PointState<D>,
        touch: &mut Touch<D>,
        free: FreeForce<D>,
    ) -> Vector<f64, D> {
        let FreeForce { force: free, placed } = free;
        let Setting { options, map, rise_step, is_late } = setting;
        let has_start = placed || self.of_others < f64::INFINITY;
        let start = if has_start { self.start(placed, touch.wanted) } else { 1.0 };
        if let Some(port) = &mut self.port {
            let wanted = map.force_to_device(touch.wanted);
            let PointState { position, velocity } = at_device;
            let (free_force, is_late) = (map.force_to_device(free), *is_late);
            let state = PortState { position, velocity, free_force, is_late, start };
            let force = port.write(wanted, options.max_force, &state);
            touch.force = map.force_to_world(force);
            force
        } else {
            let rise = self.rise(start, touch.contact, *rise_step);
            touch.force = limited(touch.wanted + free, options.max_force) * rise;
            map.force_to_device(touch.force)
        }
    }

    /// Updates `touch` but for its rendered force. Returns the force of guides and magnets, and
    /// whether the force must rise from zero.
    fn feel(
        &mut self,
        tick: &mut Tick<'_, D>,
        state: &PointState<D>,
        touch: &mut Touch<D>,
    ) -> FreeForce<D> {
        let device = state.position;
        // The proxy stays where it is if the device point is not finite.
        let following = self.proxy.follow(tick.nearby, device);
        let before = Before::of(touch);
        let body = tick.nearby.body(following.body);
        // Field by field, because copying the whole struct would stall on store forwarding.
        touch.device = device;
        touch.velocity = state.velocity;
        touch.proxy = following.proxy;
        touch.wanted = Vector::ZERO;
        touch.force = Vector::ZERO;
        touch.normal = following.normal;
        touch.contact = following.contact;
        touch.body = following.body;
        touch.is_slipping = following.is_slipping;
        touch.evaluations = following.evaluations;
        let Some(body) = body.filter(|_| state.is_finite()) else {
            touch.velocity = Vector::ZERO;
            self.fall_silent(tick, before);
            return FreeForce { force: Vector::ZERO, placed: following.placed };
        };
        let guides = self.guides.iter_mut();
        let mut free =
            guides.fold(Vector::ZERO, |sum, guide| sum + guide.force(device, state.velocity));
        if following.contact {
            if body.has_moved() {
                touch.velocity -= (body.carried(device) - device) * tick.setting.options.rate;
            }
            self.tell_changes(tick, touch, before, body);
            touch.wanted = self.force(tick, touch, body);
        } else {
            self.fall_silent(tick, before);
        }
        free += self.pull(tick, touch);
        FreeForce { force: free, placed: following.placed }
    }

    /// The part of the force at which the rise begins: zero after a placement; after bodies
    /// were replaced, the part that equals the force of the old bodies.
    #[cold]
    #[inline(never)]
    fn start(&mut self, placed: bool, wanted: Vector<f64, D>) -> f64 {
        let others = std::mem::replace(&mut self.of_others, f64::INFINITY);
        if placed { 0.0 } else { shortening(wanted.norm(), others) }
    }

    /// Ends the contact of the tick before and its ringing.
    fn fall_silent(&mut self, tick: &mut Tick<'_, D>, before: Before) {
        self.ringing = Ringing::SILENT;
        if before.contact {
            tick.tell(before.body, EventKind::Leave);
        }
    }

    /// The rendered part of the force, which rises from `start`.
    fn rise(&mut self, start: f64, contact: bool, step: f64) -> f64 {
        self.rise = match (start < 1.0, contact) {
            (true, _) => self.rise * start,
            (false, true) => (self.rise + step).min(1.0),
            (false, false) => 1.0,
        };
        self.rise
    }

    /// Emits the events of this tick and starts the ringing that they cause.
    fn tell_changes(
        &mut self,
        tick: &mut Tick<'_, D>,
        touch: &Touch<D>,
        before: Before,
        body: &Body<D>,
    ) {
        if !before.contact || before.body != touch.body {
            if before.contact {
                tick.tell(before.body, EventKind::Leave);
            }
            let speed = (-touch.velocity.dot(touch.normal)).max(0.0);
            self.ringing = body.surface().ringing(speed, tick.setting.options.rate);
            tick.tell(touch.body, EventKind::Touch { speed });
        } else if touch.is_slipping != before.is_slipping {
            let kind = if touch.is_slipping { EventKind::Slip } else { EventKind::Stick };
            tick.tell(touch.body, kind);
        }
    }

    /// The force of the touched body [N].
    fn force(
        &mut self,
        tick: &mut Tick<'_, D>,
        touch: &mut Touch<D>,
        body: &Body<D>,
    ) -> Vector<f64, D> {
        let stretch = touch.proxy - touch.device;
        let (surface, level) = (body.surface(), self.proxy.level(touch.body));
        let in_body = body.in_body(touch.proxy);
        let (pull, velocity) =
            (body.vector_in_body(stretch), body.vector_in_body(touch.velocity));
        let normal = body.vector_in_body(touch.normal);
        let turn = |way: Vector<f64, D>, far: f64| {
            let Some(direction) = way.normalized() else { return Vector::ZERO };
            touch.evaluations += 1;
            let (_, gradient) = body.shape().distance_gradient(in_body + direction * far);
            let there = gradient.normalized().unwrap_or(normal);
            (there - normal) * (way.norm() / far)
        };
        let rate = tick.setting.options.rate;
        let press = Press { stretch: pull, velocity, proxy: in_body, rate };
        let force = surface.force(level, press, turn);
        let force = body.vector_in_world(force);
        if let Some(pop) = surface.strata.top(level).and_then(|top| top.pop_through) {
            let held = surface.strata.force(level, stretch.norm());
            if held > pop.force && self.proxy.puncture(touch.body) {
                tick.tell(touch.body, EventKind::Pop { force: held });
            }
        }
        // Ringing shakes the hand, but never pulls it into the body.
        let ring = self.ringing.step().max(-force.dot(touch.normal).max(0.0));
        force + touch.normal * ring
    }

    /// The force of all magnets but the touched body's, which is zero at its own surface [N].
    /// Each acts down the gradient of its field, so the sum is the force of a potential.
    fn pull(&self, tick: &Tick<'_, D>, touch: &mut Touch<D>) -> Vector<f64, D> {
        let mut force = Vector::ZERO;
        for (index, body) in tick.nearby.all() {
            let Some(magnet) = &body.surface().magnet else { continue };
            let is_far = body.above_ball(touch.device)
                > magnet.reach + tick.setting.options.probe.radius();
            let is_touched = touch.contact && index == touch.body;
            if is_far || is_touched || self.proxy.level(index) > 0 {
                continue;
            }
            touch.evaluations += 1;
            let (distance, gradient) = body.distance_gradient(touch.device);
            let pull = magnet.at(distance - tick.setting.options.probe.radius());
            force -= gradient * pull;
        }
        force
    }
}
