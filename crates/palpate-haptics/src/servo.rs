// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The servo: device points in, forces out, once a tick.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Pose, Vector};

use crate::bodies::{Bodies, Body};
use crate::device::{DeviceProfile, PointState};
use crate::error::{HapticsError, positive, positive_or_infinite};
use crate::event::{Event, EventKind, Reaction};
use crate::guide::Guide;
use crate::limit::limited;
use crate::nearby::Nearby;
use crate::protection::{Port, Protection};
use crate::proxy::{Following, Probe, Proxy};
use crate::recorder::Energy;
use crate::safety::{Accepted, PortState, SafetyReport};
use crate::surface::Ringing;
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

/// One contact point after a tick. World coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch<const D: usize> {
    /// The device point [m]; as read, even if it is not finite.
    pub device: Point<D>,
    /// How fast it moves relative to the body that it touches, or to the world [m/s].
    pub velocity: Vector<f64, D>,
    /// The proxy [m]; the device point itself in free space.
    pub proxy: Point<D>,
    /// The force of what is touched [N], before any limit: what the hand does to the body is
    /// its negative.
    pub wanted: Vector<f64, D>,
    /// The force on the hand [N], always finite.
    pub force: Vector<f64, D>,
    /// The unit normal of the surface last seen, pointing out.
    pub normal: Vector<f64, D>,
    /// `true` if the surface keeps the proxy from the device point.
    pub contact: bool,
    /// Whose surface it is: the number of the body.
    pub body: u32,
    /// `true` if the proxy moves along the surface against friction.
    pub is_slipping: bool,
    /// Evaluations of the field in this tick.
    pub evaluations: u32,
}

impl<const D: usize> Touch<D> {
    const NONE: Self = Self {
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

/// Bodies fewer than this are all near.
const FEW: usize = 5;

/// How far proxies may go in a tick, in motions and radii of the probe: far enough that they
/// see no horizon.
const WAYS: f64 = 32.0;

/// Events of a contact point in a tick at most: a leave, a touch or a change of its hold, and
/// a layer that gives way.
const MOST_EVENTS: usize = 3;

#[derive(Clone, Debug)]
struct ContactPoint<const D: usize> {
    proxy: Proxy<D>,
    /// The part of the force that is given, in [0, 1].
    rise: f64,
    ringing: Ringing,
    guides: Vec<Guide<D>>,
}

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
    points: Vec<ContactPoint<D>>,
    touches: Vec<Touch<D>>,
    events: Vec<Event>,
    /// The forces to write [N], in device coordinates.
    forces: Vec<Vector<f64, D>>,
    /// Of each contact point to the device; none of a servo that is not protected.
    ports: Vec<Port<D>>,
    map: WorkspaceMap<D>,
    is_late: bool,
    options: ServoOptions,
    /// What is added to a force's part in a tick.
    rise_step: f64,
    /// Ticks done.
    tick: u64,
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
        let proxy = Proxy::new(options.probe);
        let point =
            ContactPoint { proxy, rise: 1.0, ringing: Ringing::SILENT, guides: Vec::new() };
        Ok(Self {
            bodies: bodies.into(),
            points: vec![point; points],
            touches: vec![Touch::NONE; points],
            events: Vec::with_capacity(MOST_EVENTS * points),
            forces: vec![Vector::ZERO; points],
            ports: Vec::new(),
            map: WorkspaceMap::default(),
            is_late: false,
            options,
            rise_step: 1.0 / (rate * rise_time),
            tick: 0,
        })
    }

    /// Stands a safety chain between every contact point and a device; states are read and
    /// forces written in the coordinates of the device from now on. Returns what became of the
    /// stiffness and damping of each body.
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
        self.map = protection.map;
        self.limit_force(protection.profile.max_force);
        if self.options.max_force == 0.0 {
            return Ok(Vec::new());
        }
        let rate = self.options.rate;
        let (bodies, accepted) = protection.accept(self.bodies.clone(), rate)?;
        let profile =
            DeviceProfile { max_force: self.options.max_force, ..protection.profile.clone() };
        let port = Protection { profile, ..protection.clone() }.port(&accepted, rate)?;
        self.ports = vec![port; self.points.len()];
        self.bodies = bodies;
        Ok(accepted)
    }

    /// Guides every contact point.
    pub fn guide(&mut self, guides: &[Guide<D>]) {
        for point in &mut self.points {
            point.guides = guides.to_vec();
        }
    }

    /// What is rendered with, and how fast.
    #[must_use]
    pub fn options(&self) -> &ServoOptions {
        &self.options
    }

    /// What is touched.
    #[must_use]
    pub fn bodies(&self) -> &Bodies<D> {
        &self.bodies
    }

    /// The contact points after the last tick.
    #[must_use]
    pub fn touches(&self) -> &[Touch<D>] {
        &self.touches
    }

    /// The forces of the last tick, to be written to the device [N]: in its coordinates.
    #[must_use]
    pub fn forces(&self) -> &[Vector<f64, D>] {
        &self.forces
    }

    /// What the safety chain of every contact point did so far; nothing if there is none.
    #[must_use]
    pub fn safety(&self) -> Vec<SafetyReport> {
        self.ports.iter().map(Port::report).collect()
    }

    /// The energy at a contact point since the start; none of a servo that is not protected.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn energy(&self, point: u32) -> Energy {
        self.ports.get(point as usize).map_or(Energy::default(), Port::energy)
    }

    /// Says whether the next tick starts too late.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn set_late(&mut self, is_late: bool) {
        self.is_late = is_late;
    }

    /// Stops all forces, or lets them rise again. It needs [protection](Self::protect).
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn stop(&mut self, is_stopped: bool) {
        self.ports.iter_mut().for_each(|port| port.stop(is_stopped));
    }

    /// What happened in the last tick.
    #[must_use]
    pub fn events(&self) -> &[Event] {
        &self.events
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
    /// A contact point that the new bodies cover is placed anew, and its force rises gently. If
    /// the servo is protected, make them ready for the device first: [`Protection::accept`].
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn replace_bodies(&mut self, bodies: Bodies<D>) -> Bodies<D> {
        for point in &mut self.points {
            point.proxy.forget_bodies();
        }
        std::mem::replace(&mut self.bodies, bodies)
    }

    /// Lowers the largest force on a contact point to `max_force` [N]; never raises it. If the
    /// servo is protected, a larger force falls as fast as the device's forces may change.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn limit_force(&mut self, max_force: f64) {
        // `min` ignores NaN.
        self.options.max_force = self.options.max_force.min(max_force).max(0.0);
        let limit = self.options.max_force;
        self.ports.iter_mut().for_each(|port| port.limit_force(limit));
    }

    /// One tick: reads each point's state, moves its proxy, gives its force.
    ///
    /// A point that is not finite, or for which there is no state, touches nothing: its force is
    /// zero, and its proxy waits where it was.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic unless a custom field does;
    /// evaluates the field at most [`Probe::budget`] times a point, and once more for each
    /// magnet in reach.
    pub fn step(&mut self, states: &[PointState<D>]) -> &[Touch<D>] {
        let missing = PointState::at_rest(Vector([f64::NAN; D]));
        self.events.clear();
        let (mut list, mut reactions) = self.bodies.take_scratch();
        let nearby = if self.bodies.bodies().len() < FEW {
            self.bodies.everything()
        } else {
            self.bodies
                .nearby(hand(&self.touches, states, (&self.map, &self.options)), &mut list)
        };
        let states = states.iter().copied().chain(std::iter::repeat(missing));
        let mut ports = self.ports.iter_mut();
        let points = self.points.iter_mut().zip(&mut self.touches).zip(&mut self.forces);
        for (index, (((point, touch), force), state)) in (0..).zip(points.zip(states)) {
            let mut tick = Tick {
                nearby,
                options: &self.options,
                event: Event { tick: self.tick, point: index, body: 0, kind: EventKind::Leave },
                events: &mut self.events,
            };
            let mut port = ports.next();
            let at_device = port.as_mut().map_or(state, |port| port.state(state));
            let before = *touch;
            let (mut felt, free, placed) =
                point.step(&mut tick, &self.map.state_to_world(at_device), &before);
            match port {
                Some(port) => {
                    let wanted = limited(felt.wanted, self.options.max_force);
                    let PointState { position, velocity } = at_device;
                    let free_force = self.map.force_to_device(free);
                    let (is_late, wants_ramp) = (self.is_late, placed);
                    *force = port.write(
                        self.map.force_to_device(wanted),
                        &PortState { position, velocity, free_force, is_late, wants_ramp },
                    );
                    felt.force = self.map.force_to_world(*force);
                }
                None => {
                    let rise = point.rise(placed, felt.contact, self.rise_step);
                    let all = limited(felt.wanted + free, self.options.max_force);
                    felt.force = all * rise;
                    *force = self.map.force_to_device(felt.force);
                }
            }
            *touch = felt;
            let touched = nearby.body(touch.body).filter(|_| touch.contact);
            let reaction = reactions.get_mut(touch.body as usize);
            if let Some((body, reaction)) = touched.zip(reaction) {
                reaction.add(-touch.wanted, touch.proxy - body.world_from_body().translation);
            }
        }
        self.bodies.put_back((list, reactions));
        self.bodies.settle();
        self.tick += 1;
        &self.touches
    }
}

/// A ball around all contact points and where their proxies may go in this tick, as far as
/// they are finite.
fn hand<const D: usize>(
    touches: &[Touch<D>],
    states: &[PointState<D>],
    (map, options): (&WorkspaceMap<D>, &ServoOptions),
) -> (Point<D>, f64) {
    let known = states.iter().zip(touches).filter(|(state, _)| state.position.is_finite());
    let known = known.map(|(state, touch)| (map.point_to_world(state.position), touch));
    let (mut sum, mut count) = (Vector::ZERO, 0.0);
    for (position, _) in known.clone() {
        sum += position;
        count += 1.0;
    }
    let centre = if count > 0.0 { sum * (1.0 / count) } else { Vector::ZERO };
    let (mut radius, mut motion) = (0.0_f64, 0.0_f64);
    for (position, touch) in known {
        radius = radius.max((position - centre).norm());
        motion = motion.max((position - touch.proxy).norm());
    }
    (centre, radius + WAYS * (motion + options.probe.radius()))
}

/// What all contact points see in a tick.
struct Tick<'a, const D: usize> {
    nearby: Nearby<'a, D>,
    options: &'a ServoOptions,
    /// An event of this point in this tick, to be filled in.
    event: Event,
    events: &'a mut Vec<Event>,
}

impl<const D: usize> Tick<'_, D> {
    fn tell(&mut self, body: u32, kind: EventKind) {
        // There is room for all that can happen: it is set aside at the start.
        if self.events.len() < self.events.capacity() {
            self.events.push(Event { body, kind, ..self.event });
        }
    }
}

impl<const D: usize> ContactPoint<D> {
    /// The touch with its wanted force, the force of guides and magnets, and whether the force
    /// should rise anew.
    fn step(
        &mut self,
        tick: &mut Tick<'_, D>,
        state: &PointState<D>,
        before: &Touch<D>,
    ) -> (Touch<D>, Vector<f64, D>, bool) {
        let device = state.position;
        // A proxy told of a point that is not finite stays where it is.
        let following = self.proxy.follow(tick.nearby, device);
        let body = tick.nearby.body(following.body);
        let mut touch = Touch {
            device,
            velocity: state.velocity,
            proxy: following.proxy,
            wanted: Vector::ZERO,
            force: Vector::ZERO,
            normal: following.normal,
            contact: following.contact,
            body: following.body,
            is_slipping: following.is_slipping,
            evaluations: following.evaluations,
        };
        let Some(body) = body.filter(|_| state.is_finite()) else {
            touch.velocity = Vector::ZERO;
            self.fall_silent(tick, before);
            return (touch, Vector::ZERO, following.placed);
        };
        let guides = self.guides.iter_mut();
        let mut free =
            guides.fold(Vector::ZERO, |sum, guide| sum + guide.force(device, state.velocity));
        if following.contact {
            if body.has_moved() {
                touch.velocity -= (body.carried(device) - device) * tick.options.rate;
            }
            self.tell_changes(tick, &touch, before, body);
            touch.wanted = self.force(tick, &touch, &following, body);
        } else {
            self.fall_silent(tick, before);
        }
        free += self.pull(tick, &mut touch);
        (touch, free, following.placed)
    }

    /// Nothing is touched any more.
    fn fall_silent(&mut self, tick: &mut Tick<'_, D>, before: &Touch<D>) {
        self.ringing = Ringing::SILENT;
        if before.contact {
            tick.tell(before.body, EventKind::Leave);
        }
    }

    /// The part of the force that is given, which rises after a placement.
    fn rise(&mut self, placed: bool, contact: bool, step: f64) -> f64 {
        self.rise = match (placed, contact) {
            (true, _) => 0.0,
            (false, true) => (self.rise + step).min(1.0),
            (false, false) => 1.0,
        };
        self.rise
    }

    /// Tells of what is new since the last tick, and starts what rings because of it.
    fn tell_changes(
        &mut self,
        tick: &mut Tick<'_, D>,
        touch: &Touch<D>,
        before: &Touch<D>,
        body: &Body<D>,
    ) {
        if !before.contact || before.body != touch.body {
            if before.contact {
                tick.tell(before.body, EventKind::Leave);
            }
            let speed = (-touch.velocity.dot(touch.normal)).max(0.0);
            self.ringing = body.surface().ringing(speed, tick.options.rate);
            tick.tell(touch.body, EventKind::Touch { speed });
        } else if touch.is_slipping != before.is_slipping {
            let kind = if touch.is_slipping { EventKind::Slip } else { EventKind::Stick };
            tick.tell(touch.body, kind);
        }
    }

    /// The force of the body that is touched [N].
    fn force(
        &mut self,
        tick: &mut Tick<'_, D>,
        touch: &Touch<D>,
        following: &Following<D>,
        body: &Body<D>,
    ) -> Vector<f64, D> {
        let stretch = following.proxy - touch.device;
        let (surface, level) = (body.surface(), self.proxy.level(following.body));
        let in_body = body.in_body(following.proxy);
        let (pull, velocity) =
            (body.vector_in_body(stretch), body.vector_in_body(touch.velocity));
        let force = body.vector_in_world(surface.force(level, pull, velocity, in_body));
        let held = surface.strata.force(level, stretch.norm());
        let pop = surface.strata.top(level).and_then(|top| top.pop_through);
        if pop.is_some_and(|pop| held > pop.force) && self.proxy.pierce(following.body) {
            tick.tell(following.body, EventKind::Pop { force: held });
        }
        // A ring shakes the hand, but does not pull it in.
        let ring = self.ringing.step().max(-force.dot(following.normal).max(0.0));
        force + following.normal * ring
    }

    /// The pull of magnets, but that of the body that is touched, which is zero at its surface
    /// [N]: down the gradients of their fields, and so that of a potential.
    fn pull(&self, tick: &Tick<'_, D>, touch: &mut Touch<D>) -> Vector<f64, D> {
        let mut force = Vector::ZERO;
        for (index, body) in tick.nearby.all() {
            let Some(magnet) = &body.surface().magnet else { continue };
            let is_far =
                body.above_ball(touch.device) > magnet.reach + tick.options.probe.radius();
            let is_touched = touch.contact && index == touch.body;
            if is_far || is_touched || self.proxy.level(index) > 0 {
                continue;
            }
            touch.evaluations += 1;
            let (distance, gradient) = body.distance_gradient(touch.device);
            let pull = magnet.at(distance - tick.options.probe.radius());
            force -= gradient * pull;
        }
        force
    }
}
