// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A contact point.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_device::{PointState, limited, shortening};
use palpate_field::{Point, Vector};
use palpate_query::constraints::CAPACITY;
use palpate_safety::{Approach, Arrival, Change, MovingBodies, PortState, WorkspaceMap};

use crate::bodies::Body;
use crate::crease::{Crease, Place, Shared};
use crate::error::ServoOptions;
use crate::event::{Event, EventKind};
use crate::guide::Guide;
use crate::magnetism::Magnetism;
use crate::nearby::{Nearby, Yielding};
use crate::ports::Port;
use crate::proxy::{Edited, Probe, Proxy};
use crate::seam::Seam;
use crate::squeeze::{Against, Squeeze};
use crate::surface::{Press, Ringing};

/// One contact point after a tick. World coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Touch {
    /// The device point (haptic interface point) [m]; as read, even if it is not finite.
    pub device: Point<3>,
    /// The velocity of the device point [m/s]: relative to the touched body, or to the world in
    /// free space.
    pub velocity: Vector<f64, 3>,
    /// The proxy (god-object) [m]; the device point itself in free space.
    pub proxy: Point<3>,
    /// The force of the touched body on the hand [N], before any limit; the hand exerts the
    /// opposite force on the body.
    pub wanted: Vector<f64, 3>,
    /// The force on the hand [N], always finite.
    pub force: Vector<f64, 3>,
    /// The unit normal of the surface that the proxy last reached, pointing out.
    pub normal: Vector<f64, 3>,
    /// `true` if the surface keeps the proxy from the device point.
    pub contact: bool,
    /// The index of the body whose surface the proxy last reached; of several that hold the proxy,
    /// the one that pushes hardest.
    pub body: u32,
    /// `true` if the proxy moves along the surface against friction.
    pub is_slipping: bool,
    /// Evaluations of the field in this tick.
    pub evaluations: u32,
}

impl Touch {
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

/// Bodies that squeeze a hand out of a wedge carry it by at most this multiple of their motion: the
/// sides of the wedge then meet at 7 degrees or more. In a narrower one the hand has no room.
pub(crate) const LARGEST_GAIN: f64 = 16.0;

/// Where bodies that moved let a hand go, its force falls by this much more in a tick than it is handed
/// over [N]: more would be a kick, and with less it would stay on a hand that nothing holds.
pub(crate) const LET_GO: f64 = 0.2;

/// The most events of a contact point in a tick: a leave, a touch and a layer that gives way for
/// each of the bodies that can hold it, what an edit did, and a squeeze.
pub(crate) const MOST_EVENTS: usize = 3 * CAPACITY + 2;

/// A contact point of the hand, with its state from tick to tick.
#[derive(Clone, Debug)]
pub(crate) struct ContactPoint {
    pub(crate) proxy: Proxy,
    /// The rendered part of the force, in [0, 1].
    rise: f64,
    /// The force before bodies were replaced, or with that of magnets before one jumped [N]; infinite if
    /// neither happened.
    of_others: f64,
    /// The body that jumped since the last tick; of several, the last.
    jumped: Option<u32>,
    /// Whether bodies that moved handed a force over.
    has_handed_over: bool,
    /// How the force follows after an edit carried the proxy. With a port the safety chain has its
    /// own.
    approach: Approach,
    magnetism: Magnetism,
    ringing: Ringing,
    /// The bodies that touch the proxy.
    crease: Crease,
    /// The bodies that the proxy lies in, because they moved and left it no room.
    squeeze: Squeeze,
    /// The force of their springs over the depth, in the last contact [N/m]; infinite before the first.
    pub(crate) stiffness: f64,
    pub(crate) guides: Vec<Guide>,
    /// The rendered part of the force of the guides, in [0, 1]: it rises from zero where the hand is set down.
    guided: f64,
    /// The port to the device; `None` without protection.
    pub(crate) port: Option<Port>,
}

/// Settings that all contact points share.
#[derive(Clone, Debug)]
pub(crate) struct Setting {
    pub(crate) options: ServoOptions,
    pub(crate) map: WorkspaceMap,
    /// The increase of [`ContactPoint::rise`] in a tick.
    pub(crate) rise_step: f64,
    /// How the states of this tick came.
    pub(crate) arrival: Arrival,
    /// Whether the hand is lifted off the bodies.
    pub(crate) is_lifted: bool,
}

/// The state of a tick that all contact points share.
pub(crate) struct Tick<'a> {
    everything: &'a Nearby<'a>,
    /// The bodies that do not yield to the contact point; `None` if none yields.
    firm: Option<Nearby<'a>>,
    setting: &'a Setting,
    /// A template for events: tick and contact point are filled in.
    event: Event,
    events: &'a mut Vec<Event>,
}

impl<'a> Tick<'a> {
    pub(crate) fn new(
        everything: &'a Nearby<'a>,
        setting: &'a Setting,
        tick: u64,
        events: &'a mut Vec<Event>,
    ) -> Self {
        let event = Event { tick, point: 0, body: 0, kind: EventKind::Leave };
        Self { everything, firm: None, setting, event, events }
    }

    /// Leaves out the bodies that yield to the contact point.
    fn leave_out(&mut self, yielding: Yielding) {
        let yields = !yielding.is_empty();
        self.firm = yields.then(|| self.everything.without(yielding));
    }

    /// The bodies that do not yield to the contact point.
    fn nearby(&self) -> &Nearby<'a> {
        self.firm.as_ref().unwrap_or(self.everything)
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

/// How the force of a body is asked for.
#[derive(Clone, Copy)]
struct Pressing {
    /// Ticks a second [Hz].
    rate: f64,
    /// Whether the body's own dampers act.
    has_dampers: bool,
}

/// What a contact point touched in the tick before: its contact, body and motion.
#[derive(Clone, Copy, PartialEq)]
struct Before {
    contact: bool,
    body: u32,
    is_slipping: bool,
}

impl Before {
    fn of(touch: &Touch) -> Self {
        let Touch { contact, body, is_slipping, .. } = *touch;
        Self { contact, body, is_slipping }
    }
}

/// Tells what an edit did to the proxy at a body.
#[cold]
fn tell_edited(tick: &mut Tick<'_>, body: u32, edited: Edited) -> Change {
    let (kind, change) = match edited {
        Edited::Carried { distance } => (EventKind::Carried { distance }, Change::Carried),
        Edited::Placed => (EventKind::Placed, Change::None),
    };
    tick.tell(body, kind);
    change
}

impl ContactPoint {
    pub(crate) fn new(probe: Probe) -> Self {
        let (proxy, guides) = (Proxy::new(probe), Vec::new());
        let (rise, of_others, ringing) = (1.0, f64::INFINITY, Ringing::SILENT);
        let (crease, stiffness) = (Crease::NONE, f64::INFINITY);
        let (guided, approach, port) = (1.0, Approach::new(1.0), None);
        let (jumped, has_handed_over, squeeze) = (None, false, Squeeze::NONE);
        let magnetism = Magnetism::new();
        Self {
            proxy,
            rise,
            of_others,
            jumped,
            has_handed_over,
            approach,
            magnetism,
            ringing,
            crease,
            squeeze,
            stiffness,
            guides,
            guided,
            port,
        }
    }

    /// A copy that rehearses a tick. It has no guides, because copying guides would allocate.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn double(&self) -> Self {
        let (proxy, port) = (self.proxy.clone(), self.port.clone());
        let Self { rise, of_others, approach, ringing, crease, stiffness, guided, .. } = *self;
        let (guides, squeeze) = (Vec::new(), self.squeeze);
        let Self { jumped, has_handed_over, magnetism, .. } = *self;
        Self {
            proxy,
            rise,
            of_others,
            jumped,
            has_handed_over,
            approach,
            magnetism,
            ringing,
            crease,
            squeeze,
            stiffness,
            guides,
            guided,
            port,
        }
    }

    /// One tick, from the state of the device to the force to write [N], both in device
    /// coordinates; `touch` is the touch of the tick before, and is updated to the touch of
    /// this tick.
    ///
    /// Real-time: as [`Servo::step`](crate::Servo::step).
    pub(crate) fn tick(
        &mut self,
        tick: &mut Tick<'_>,
        state: PointState,
        touch: &mut Touch,
    ) -> Vector<f64, 3> {
        let at_device = self
            .port
            .as_mut()
            .map_or(state, |port| port.state(state, tick.setting.arrival, true));
        let in_world = tick.setting.map.state_to_world(at_device);
        let free = self.feel(tick, &in_world, touch);
        self.give(tick.setting, at_device, touch, free)
    }

    /// Updates `touch` but for its rendered force. Returns the force of guides and magnets, and
    /// whether the force must rise from zero.
    fn feel(
        &mut self,
        tick: &mut Tick<'_>,
        state: &PointState,
        touch: &mut Touch,
    ) -> FreeForce {
        let device = state.position;
        if tick.setting.is_lifted {
            return self.hover(tick, state, touch);
        }
        let begins = self.proxy.begins();
        let held = self.carried(tick.everything, touch);
        let has_moved = tick.everything.has_moved() || self.proxy.is_moved();
        let watches = self.port.is_some() && (has_moved || self.has_handed_over);
        let way = device - touch.device;
        let slid = if watches { self.slides(tick.everything, touch, way) } else { 0.0 };
        // The proxy stays where it is if the device point is not finite.
        let following = self.proxy.follow(tick.everything, device);
        tick.leave_out(self.proxy.yielding());
        let placed = following.placed;
        let mut change = if begins && placed { Change::Begins } else { Change::None };
        if let Some(edited) = following.edited {
            change = tell_edited(tick, following.body, edited);
        }
        if following.squeezed != self.squeeze.body() {
            change = self.tell_squeezed(tick, following.squeezed, change);
        }
        let before = Before::of(touch);
        let wanted_before = touch.wanted;
        let body = tick.nearby().body(following.body);
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
            let (carried, explained) = (Vector::ZERO, 0.0);
            return FreeForce { force: Vector::ZERO, placed, change, explained, carried };
        };
        let mut free = self.guided(device, state.velocity, tick.setting);
        if following.contact {
            touch.wanted = self.held(tick, touch, before, body);
        } else {
            self.fall_silent(tick, before);
        }
        if following.squeezed.is_some() {
            let pushed = self.squeezed(tick, touch);
            touch.wanted += pushed;
        }
        let (whole, pull_before) = (self.pull(tick, touch), self.magnetism.pull());
        free += self.magnetism.follow(whole, self.jumped.is_some());
        let carried = match held {
            _ if placed => Vector::ZERO,
            Some(held) => held,
            // A body that moved onto the hand carries it from this tick on.
            None => self.carried(tick.everything, touch).unwrap_or(Vector::ZERO),
        };
        let mut explained = 0.0;
        if watches {
            let slides = self.slides(tick.everything, touch, way);
            explained = self.stiffness * slides.max(slid);
            let is_held = touch.contact || following.squeezed.is_some();
            if !is_held {
                explained += if self.jumped.is_some() { f64::INFINITY } else { LET_GO };
            }
            if before.contact && has_moved && self.jumped.is_none() {
                let moved = (touch.wanted - wanted_before).norm();
                change = change.or_handed_over(moved, explained);
                self.has_handed_over |= change == Change::HandedOver;
            }
        }
        if let Some(body) = self.jumped.filter(|_| following.edited.is_none()) {
            let has_stepped = |change: Vector<f64, 3>, moved| {
                Change::None.or_handed_over(change.norm(), moved) != Change::None
            };
            let moved = self.stiffness * way.norm();
            if before.contact && has_stepped(touch.wanted - wanted_before, moved) {
                tick.tell(before.body, EventKind::Placed);
            } else if has_stepped(whole - pull_before, 0.0) {
                tick.tell(body, EventKind::Placed);
            }
        }
        FreeForce { force: free, placed, change, explained, carried }
    }

    /// The largest motion of the hand relative to a body that pushes it in `touch`, if the hand
    /// goes by `way` [m].
    fn slides(&self, nearby: &Nearby<'_>, touch: &Touch, way: Vector<f64, 3>) -> f64 {
        let bodies = self.pushes(touch).filter_map(|(index, _)| nearby.body(index));
        let slides = bodies.map(|body| {
            let carried = body.carried(touch.device) - touch.device;
            if body.has_moved() { (way - carried).norm() } else { way.norm() }
        });
        slides.reduce(f64::max).unwrap_or_else(|| way.norm())
    }

    /// How far the bodies that push the hand in `touch` carry it in this tick [m]; `None` if none pushes.
    ///
    /// With the forces `Fᵢ` of the bodies, their sum `F`, and the motions `uᵢ` of their material points at
    /// the hand, it is the vector `u` nearest to the mean of the `uᵢ`, weighted by the sizes of the
    /// forces, for which `F·u` is the work `Σ Fᵢ·uᵢ` of the bodies.
    fn carried(&self, nearby: &Nearby<'_>, touch: &Touch) -> Option<Vector<f64, 3>> {
        if !nearby.has_moved() {
            return touch.contact.then_some(Vector::ZERO);
        }
        let (mut sum, mut whole) = (Vector::ZERO, 0.0);
        let (mut force, mut work, mut fastest) = (Vector::ZERO, 0.0, 0.0_f64);
        for (index, push) in self.pushes(touch) {
            let Some(body) = nearby.body(index) else { continue };
            let share = push.norm();
            whole += share;
            force += push;
            if body.has_moved() {
                let way = body.carried(touch.device) - touch.device;
                sum += way * share;
                work += way.dot(push);
                fastest = fastest.max(way.norm());
            }
        }
        let mean = sum * (1.0 / whole);
        let lacking = work - mean.dot(force);
        // Where bodies push against each other, most of their work is on each other: the mean then
        // counts alone.
        let is_of_hand = lacking.abs() <= LARGEST_GAIN * fastest * force.norm();
        let carried = if is_of_hand && lacking != 0.0 {
            mean + force * (lacking / force.dot(force))
        } else {
            mean
        };
        // Written so that NaN carries nothing.
        let is_pushed = whole > 0.0 && carried.is_finite();
        is_pushed.then_some(carried)
    }

    /// A tick of a hand that is lifted: the proxy is at the device, and nothing is touched.
    #[cold]
    #[inline(never)]
    fn hover(
        &mut self,
        tick: &mut Tick<'_>,
        state: &PointState,
        touch: &mut Touch,
    ) -> FreeForce {
        let before = Before::of(touch);
        self.fall_silent(tick, before);
        self.proxy.lift();
        self.let_go();
        self.magnetism = Magnetism::new();
        let is_known = state.is_finite();
        *touch = Touch {
            device: state.position,
            velocity: if is_known { state.velocity } else { Vector::ZERO },
            proxy: if is_known { state.position } else { touch.proxy },
            wanted: Vector::ZERO,
            force: Vector::ZERO,
            contact: false,
            is_slipping: false,
            evaluations: 0,
            ..*touch
        };
        let (force, carried) = (Vector::ZERO, Vector::ZERO);
        FreeForce { force, placed: false, change: Change::None, explained: 0.0, carried }
    }

    /// Ends the contact of the tick before and its ringing.
    fn fall_silent(&mut self, tick: &mut Tick<'_>, before: Before) {
        self.ringing = Ringing::SILENT;
        if before.contact {
            self.leave(tick, before, &Crease::NONE);
        }
        self.release_others();
    }

    /// Forgets the bodies of a crease.
    fn release_others(&mut self) {
        if self.crease.count() > 0 {
            self.crease = Crease::NONE;
        }
        self.proxy.hold_between(None);
    }

    /// Tells which body leaves the proxy no room; `None` if there is room again. Returns `change`,
    /// or a handover if it is none.
    #[cold]
    fn tell_squeezed(
        &mut self,
        tick: &mut Tick<'_>,
        body: Option<u32>,
        change: Change,
    ) -> Change {
        self.squeeze = Squeeze::by(body);
        if let Some(body) = body {
            tick.tell(body, EventKind::Squeezed);
        }
        if change == Change::None { Change::HandedOver } else { change }
    }

    /// The force of the bodies that the proxy lies in [N].
    #[cold]
    #[inline(never)]
    fn squeezed(&mut self, tick: &Tick<'_>, touch: &mut Touch) -> Vector<f64, 3> {
        let radius = tick.setting.options.probe.radius();
        let against = Against { device: touch.device, radius, wanted: touch.wanted };
        let yielding = self.proxy.yielding();
        let evaluations = &mut touch.evaluations;
        self.squeeze.press(tick.everything, &yielding, &against, evaluations);
        let force = self.squeeze.force();
        // The springs push against each other, and store more than their sum tells.
        let stored = touch.wanted.dot(touch.wanted) / self.stiffness + self.squeeze.stored();
        let sum = touch.wanted + force;
        if stored > 0.0 {
            self.stiffness = sum.dot(sum) / stored;
        }
        force
    }

    /// Whether a body touched the proxy in the tick before.
    fn was_touched(&self, before: Before, body: u32) -> bool {
        match self.crease.count() {
            0 => before.contact && before.body == body,
            _ => self.crease.has(body),
        }
    }

    /// Tells that the proxy left the bodies that touched it before and do not touch it now.
    fn leave(&self, tick: &mut Tick<'_>, before: Before, now: &Crease) {
        if self.crease.count() == 0 && !now.has(before.body) {
            tick.tell(before.body, EventKind::Leave);
        }
        for wall in self.crease.walls().filter(|wall| !now.has(wall.body)) {
            tick.tell(wall.body, EventKind::Leave);
        }
    }

    /// The force of the bodies that hold the proxy [N]. The body `least` has the least field there.
    fn held(
        &mut self,
        tick: &mut Tick<'_>,
        touch: &mut Touch,
        before: Before,
        least: &Body,
    ) -> Vector<f64, 3> {
        let rate = tick.setting.options.rate;
        let mut body = least;
        if tick.nearby().bodies.bodies().len() > 1 {
            let crease = self.crease_at(tick, touch, before);
            let is_several = crease.count() > 1 && crease.whole() > 0.0;
            if is_several && !(crease.is_level() && self.is_seam(tick, &crease)) {
                return self.held_by_several(tick, touch, before, crease);
            }
            // The body with the least field may only stand by.
            let hardest = crease.hardest().filter(|_| is_several && !crease.pushes(touch.body));
            let everything = tick.everything;
            let hardest = hardest.and_then(|wall| Some((everything.body(wall.body)?, wall)));
            if let Some((hardest, wall)) = hardest {
                (body, touch.body, touch.normal) = (hardest, wall.body, wall.normal);
            }
        }
        if body.has_moved() {
            touch.velocity -= (body.carried(touch.device) - touch.device) * rate;
        }
        // A tick that changes nothing has nothing to tell.
        if self.crease.count() > 0 || Before::of(touch) != before {
            self.tell_changes(tick, touch, before, &Crease::of_one(touch.body, touch.normal));
        }
        self.release_others();
        let stretch = touch.proxy - touch.device;
        self.proxy.hold(stretch - touch.normal * stretch.dot(touch.normal));
        let force = self.pressed(touch, body, stretch, Pressing { rate, has_dampers: true });
        let level = self.proxy.level(touch.body);
        self.stiffness = body.surface().strata.secant(level, stretch.norm());
        self.pop(tick, touch.body, stretch.norm());
        let force = force + self.blend(tick, touch, stretch);
        force + self.ring(touch, force)
    }

    /// Whether bodies of a crease have different springs.
    fn is_seam(&self, tick: &Tick<'_>, crease: &Crease) -> bool {
        let strata = |body| tick.nearby().body(body).map(|body| &body.surface().strata);
        let mut all = crease.walls().filter_map(|wall| strata(wall.body));
        let first = all.next();
        first.is_some_and(|first| all.any(|other| !other.has_springs_of(first)))
    }

    /// What the bodies beside the touched one change of its force [N].
    fn blend(
        &mut self,
        tick: &Tick<'_>,
        touch: &mut Touch,
        stretch: Vector<f64, 3>,
    ) -> Vector<f64, 3> {
        if tick.nearby().bodies.bodies().len() < 2 {
            return Vector::ZERO;
        }
        let Touch { proxy, body, normal, .. } = *touch;
        let options = &tick.setting.options;
        let place = Place { proxy, stretch, body, normal, radius: options.probe.radius() };
        let punctured = self.proxy.punctured();
        let (most_force, evaluations) = (options.max_force, &mut touch.evaluations);
        let seam = Seam::at(tick.nearby(), &place, punctured, most_force, evaluations);
        let Some((seam, along)) = seam.zip(stretch.normalized()) else { return Vector::ZERO };
        self.stiffness += seam.springs / stretch.norm();
        along * seam.springs + seam.sideways
    }

    /// The bodies that touch the proxy.
    fn crease_at(&self, tick: &Tick<'_>, touch: &mut Touch, before: Before) -> Crease {
        let Touch { proxy, body, normal, .. } = *touch;
        let radius = tick.setting.options.probe.radius();
        let stretch = proxy - touch.device - self.proxy.held();
        let place = Place { proxy, stretch, body, normal, radius };
        let was_touched = |body| self.was_touched(before, body);
        let punctured = self.proxy.punctured();
        Crease::at(tick.nearby(), &place, punctured, was_touched, &mut touch.evaluations)
    }

    /// The force of several bodies that hold the proxy together [N].
    ///
    /// With the stretch `s = Σ λᵢ nᵢ + t`, of which friction holds `t` (see [`Crease`]), each body
    /// gives the force of its material at the stretch `λᵢ nᵢ + wᵢ t` with the weight `wᵢ = λᵢ / Σ λ`.
    /// Dampers, and friction in the next tick, are those of all bodies with these weights. So bodies
    /// of one material feel like one body, and the force does not jump when a body begins or ceases
    /// to push. Behind oblique walls the springs work against each other; their force is at most
    /// [`Shared::most`]. The more two bodies [face](Crease::facing) each other, the more the force is the
    /// mean of their springs along the stretch. Textures come on top.
    fn held_by_several(
        &mut self,
        tick: &mut Tick<'_>,
        touch: &mut Touch,
        before: Before,
        mut crease: Crease,
    ) -> Vector<f64, 3> {
        let stretch = touch.proxy - touch.device;
        let (depth, whole) = (stretch.norm(), crease.whole());
        let rest = crease.walls().fold(stretch, |rest, wall| rest - wall.normal * wall.push);
        let (mut springs, mut plain, mut carried) = (Vector::ZERO, Vector::ZERO, Vector::ZERO);
        let (mut shared, mut mean) = (Shared::default(), 0.0);
        let (velocity, rate) = (touch.velocity, tick.setting.options.rate);
        for wall in crease.pushing_mut() {
            let Some(body) = tick.nearby().body(wall.body) else { continue };
            let part = wall.push / whole;
            let own = wall.normal * wall.push + rest * part;
            let (strata, level) = (&body.surface().strata, self.proxy.level(wall.body));
            let whole_force = strata.force(level, depth);
            shared.add(strata.at(level, own.norm()), whole_force, part);
            mean += whole_force * part;
            touch.velocity = velocity;
            if body.has_moved() {
                let way = body.carried(touch.device) - touch.device;
                touch.velocity -= way * rate;
                carried += way * part;
            }
            (touch.body, touch.normal) = (wall.body, wall.normal);
            wall.force = self.pressed(touch, body, own, Pressing { rate, has_dampers: false });
            springs += wall.force;
            if let Some(along) = own.normalized() {
                plain += along * strata.force(level, own.norm());
            }
        }
        touch.velocity = velocity - carried * rate;
        if let Some(hardest) = crease.hardest() {
            (touch.body, touch.normal) = (hardest.body, hardest.normal);
        }
        self.tell_changes(tick, touch, before, &crease);
        let facing = crease.facing();
        if facing > 0.0 {
            // Springs of bodies that face each other would push across the stretch.
            springs = springs * (1.0 - facing) + stretch * (mean / depth * facing);
            plain = plain * (1.0 - facing) + stretch * (mean / depth * facing);
        }
        let fit = shortening(plain.norm(), shared.most());
        self.stiffness = fit * plain.norm() / depth;
        let dampers = shared.dampers(touch.velocity, stretch, rest);
        for wall in crease.pushing_mut() {
            wall.force = wall.force * fit + dampers * (wall.push / whole);
            self.pop(tick, wall.body, wall.push);
        }
        self.proxy.hold_between(Some(crease.walls_with(shared.friction)));
        self.crease = crease;
        self.proxy.hold(rest);
        let force = springs * fit + dampers;
        force + self.ring(touch, force)
    }

    /// Emits the events of this tick and starts the ringing that they cause; `now` are the bodies
    /// that touch the proxy.
    fn tell_changes(
        &mut self,
        tick: &mut Tick<'_>,
        touch: &Touch,
        before: Before,
        now: &Crease,
    ) {
        if before.contact {
            self.leave(tick, before, now);
        }
        let mut is_new = false;
        for wall in now.walls() {
            if self.was_touched(before, wall.body) {
                continue;
            }
            let Some(body) = tick.nearby().body(wall.body) else { continue };
            let speed = (-touch.velocity.dot(wall.normal)).max(0.0);
            self.ringing = body.surface().ringing(speed, tick.setting.options.rate);
            tick.tell(wall.body, EventKind::Touch { speed });
            is_new = true;
        }
        if !is_new && touch.is_slipping != before.is_slipping {
            let kind = if touch.is_slipping { EventKind::Slip } else { EventKind::Stick };
            tick.tell(touch.body, kind);
        }
    }

    /// The force of a body whose part of the stretch is `stretch` [N].
    fn pressed(
        &self,
        touch: &mut Touch,
        body: &Body,
        stretch: Vector<f64, 3>,
        Pressing { rate, has_dampers }: Pressing,
    ) -> Vector<f64, 3> {
        let level = self.proxy.level(touch.body);
        let in_body = body.in_body(touch.proxy);
        let (pull, velocity) =
            (body.vector_in_body(stretch), body.vector_in_body(touch.velocity));
        let normal = body.vector_in_body(touch.normal);
        let turn = |way: Vector<f64, 3>, far: f64| {
            let Some(direction) = way.normalized() else { return Vector::ZERO };
            touch.evaluations += 1;
            let (_, gradient) = body.shape().distance_gradient(in_body + direction * far);
            let there = gradient.normalized().unwrap_or(normal);
            (there - normal) * (way.norm() / far)
        };
        let press =
            Press { stretch: pull, normal, velocity, proxy: in_body, rate, has_dampers };
        body.vector_in_world(body.surface().force(level, press, turn))
    }

    /// Punctures the top layer of a body that is pressed by `depth` [m], if it gives way.
    fn pop(&mut self, tick: &mut Tick<'_>, index: u32, depth: f64) {
        let Some(body) = tick.nearby().body(index) else { return };
        let (strata, level) = (&body.surface().strata, self.proxy.level(index));
        if let Some(pop) = strata.top(level).and_then(|top| top.pop_through) {
            let held = strata.force(level, depth);
            if held > pop.force && self.proxy.puncture(index) {
                tick.tell(index, EventKind::Pop { force: held });
            }
        }
    }

    /// The force of this tick's ringing beside the `force` of the bodies [N]. It shakes the hand, but
    /// never pulls it into the body.
    fn ring(&mut self, touch: &Touch, force: Vector<f64, 3>) -> Vector<f64, 3> {
        touch.normal * self.ringing.step().max(-force.dot(touch.normal).max(0.0))
    }

    /// The force of each body on the hand in the tick [N]; their sum is the wanted force.
    #[inline]
    pub(crate) fn pushes(&self, touch: &Touch) -> impl Iterator<Item = (u32, Vector<f64, 3>)> {
        let others = self.crease.walls().filter(|wall| wall.body != touch.body);
        let others = others.chain(self.squeeze.walls());
        let is_alone = self.crease.count() == 0 && self.squeeze.body().is_none();
        let of_others = if is_alone {
            Vector::ZERO
        } else {
            others.clone().fold(Vector::ZERO, |sum, wall| sum + wall.force)
        };
        let hardest = (touch.body, touch.wanted - of_others);
        let others = others.map(|wall| (wall.body, wall.force));
        let most = if is_alone { 1 } else { 2 * CAPACITY };
        std::iter::once(hardest).chain(others).take(if touch.contact { most } else { 0 })
    }

    /// The force of all magnets but the touched body's, which is zero at its own surface [N].
    /// Each acts down the gradient of its field, so the sum is the force of a potential.
    fn pull(&self, tick: &Tick<'_>, touch: &mut Touch) -> Vector<f64, 3> {
        let mut force = Vector::ZERO;
        for (index, body) in tick.nearby().all() {
            let Some(magnet) = &body.surface().magnet else { continue };
            let is_far = body.above_ball(touch.device)
                > magnet.reach + tick.setting.options.probe.radius();
            let is_touched = touch.contact && (index == touch.body || self.crease.has(index));
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

/// The force in free space, of guides and magnets.
#[derive(Clone, Copy)]
pub(crate) struct FreeForce {
    /// The force [N].
    pub(crate) force: Vector<f64, 3>,
    /// Whether the proxy was placed anew: forces then rise from zero, or after a jump from the last
    /// force.
    pub(crate) placed: bool,
    /// What happened beside the motion of the hand.
    pub(crate) change: Change,
    /// By how much motion changes the force, at most [N].
    pub(crate) explained: f64,
    /// How far the touched bodies carry the hand in this tick [m].
    pub(crate) carried: Vector<f64, 3>,
}

impl ContactPoint {
    /// Takes note that the bodies `before` are replaced by those of `after` before the next tick;
    /// `wanted` is their last force [N]. The new ones carry the proxy out where they cover it, for a
    /// point by `most_of_point` [m] at most.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn replace_bodies(
        &mut self,
        [before, after]: [&Nearby<'_>; 2],
        wanted: Vector<f64, 3>,
        most_of_point: f64,
    ) {
        self.proxy.carry_out(before, after, most_of_point);
        self.of_others = wanted.norm();
    }

    /// Takes note that a body jumped; `near` is its index if it is or was near, and `wanted` is the last
    /// force [N]. Where the body covers the proxy now, the proxy is placed anew, and the force rises from
    /// the last one.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn see_jump(&mut self, near: Option<u32>, wanted: Vector<f64, 3>) {
        if near.is_none() {
            self.proxy.look_anew();
            return;
        }
        self.proxy.forget_bodies();
        self.of_others = (wanted + self.magnetism.pull()).norm();
        self.jumped = near;
    }

    /// Lets the force rise from zero; with a port, the safety chain does this.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn rise_anew(&mut self) {
        self.rise = 0.0;
    }

    /// Sets the rendered force of `touch` from its wanted force and the force in free space.
    /// Returns the force to write [N], in device coordinates. If `placed`, the force rises from
    /// zero, or after a jump from the last one.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[inline(always)]
    pub(crate) fn give(
        &mut self,
        setting: &Setting,
        at_device: PointState,
        touch: &mut Touch,
        free: FreeForce,
    ) -> Vector<f64, 3> {
        let FreeForce { force: free, placed, change, explained, carried } = free;
        let Setting { options, map, rise_step, arrival, .. } = setting;
        let has_start = placed || self.of_others < f64::INFINITY;
        let start = if has_start { self.start(placed, change, touch.wanted) } else { 1.0 };
        if let Some(port) = &mut self.port {
            let wanted = map.force_to_device(touch.wanted);
            let PointState { position, velocity } = at_device;
            let free_force = map.force_to_device(free);
            let Arrival { late, elapsed, is_ready } = *arrival;
            let change = if is_ready { change } else { Change::Begins };
            let stiffness = self.stiffness * map.scale();
            let state = PortState {
                position,
                velocity,
                free_force,
                late,
                elapsed,
                start,
                change,
                explained,
                stiffness,
                bodies: MovingBodies {
                    driven: map.velocity_to_device(carried),
                    ..MovingBodies::default()
                },
            };
            let force = port.write(wanted, options.max_force, &state);
            touch.force = map.force_to_world(force);
            force
        } else {
            let rise = self.rise(start, touch.contact, *rise_step);
            if change == Change::Carried {
                self.approach.begin(change);
            }
            let wanted = self.approach.step(touch.wanted, explained).unwrap_or(touch.wanted);
            touch.force = limited(wanted + free, options.max_force) * rise;
            map.force_to_device(touch.force)
        }
    }

    /// The part of the force at which the rise begins: zero after a placement; after bodies
    /// were replaced or one jumped, the part that equals the force before, unless they carried the
    /// proxy out.
    #[cold]
    #[inline(never)]
    fn start(&mut self, placed: bool, change: Change, wanted: Vector<f64, 3>) -> f64 {
        let others = std::mem::replace(&mut self.of_others, f64::INFINITY);
        let has_jumped = self.jumped.take().is_some();
        let wanted = if has_jumped { wanted + self.magnetism.pull() } else { wanted };
        match change {
            _ if placed && !has_jumped => 0.0,
            Change::Carried | Change::HandedOver => 1.0,
            _ => shortening(wanted.norm(), others),
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
}

impl ContactPoint {
    /// The force of the guides [N]; zero if a number is not finite.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[inline]
    pub(crate) fn guided(
        &mut self,
        position: Point<3>,
        velocity: Vector<f64, 3>,
        setting: &Setting,
    ) -> Vector<f64, 3> {
        if self.guides.is_empty() || !(position.is_finite() && velocity.is_finite()) {
            return Vector::ZERO;
        }
        let rate = setting.options.rate;
        let forces =
            self.guides.iter_mut().map(|guide| guide.rising_force(position, velocity, rate));
        let all = forces.fold(Vector::ZERO, |sum, force| sum + force);
        let part = self.guided;
        self.guided = (part + setting.rise_step).min(1.0);
        all * part
    }

    /// Lets go of the guides, as a hand that is lifted does.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn let_go(&mut self) {
        self.guides.iter_mut().for_each(Guide::let_go);
        self.guided = 0.0;
    }
}
