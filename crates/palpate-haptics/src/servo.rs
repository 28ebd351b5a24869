// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The servo: device points in, forces out, once a tick.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Pose, Vector};

use crate::bodies::{Bodies, Body};
use crate::device::PointState;
use crate::error::{HapticsError, positive};
use crate::event::{Event, EventKind, Reaction};
use crate::limit::limited;
use crate::nearby::Nearby;
use crate::proxy::{Following, Probe, Proxy};
use crate::surface::Ringing;

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

/// Events of a contact point in a tick at most: a touch or a leave, a change of its hold, and
/// a layer that gives way.
const MOST_EVENTS: usize = 3;

#[derive(Clone, Debug)]
struct ContactPoint<const D: usize> {
    proxy: Proxy<D>,
    /// The part of the force that is given, in [0, 1].
    rise: f64,
    ringing: Ringing,
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
        if options.max_force.is_nan() || options.max_force <= 0.0 {
            let (value, unit) = (options.max_force, "N");
            let (parameter, rule) = ("max_force", "positive");
            return Err(HapticsError::Number { parameter, rule, value, unit });
        }
        let proxy = Proxy::new(options.probe);
        let point = ContactPoint { proxy, rise: 1.0, ringing: Ringing::SILENT };
        Ok(Self {
            bodies: bodies.into(),
            points: vec![point; points],
            touches: vec![Touch::NONE; points],
            events: Vec::with_capacity(MOST_EVENTS * points),
            options,
            rise_step: 1.0 / (rate * rise_time),
            tick: 0,
        })
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
    /// A contact point that the new bodies cover is placed anew, and its force rises gently.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn replace_bodies(&mut self, bodies: Bodies<D>) -> Bodies<D> {
        for point in &mut self.points {
            point.proxy.forget_bodies();
        }
        std::mem::replace(&mut self.bodies, bodies)
    }

    /// Lowers the largest force on a contact point to `max_force` [N]; never raises it.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn limit_force(&mut self, max_force: f64) {
        // `min` ignores NaN.
        self.options.max_force = self.options.max_force.min(max_force).max(0.0);
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
            self.bodies.nearby(hand(&self.touches, states, &self.options), &mut list)
        };
        let states = states.iter().copied().chain(std::iter::repeat(missing));
        let points = self.points.iter_mut().zip(&mut self.touches);
        for (index, ((point, touch), state)) in (0..).zip(points.zip(states)) {
            let mut tick = Tick {
                nearby,
                options: &self.options,
                rise_step: self.rise_step,
                event: Event { tick: self.tick, point: index, body: 0, kind: EventKind::Leave },
                events: &mut self.events,
            };
            let before = *touch;
            *touch = point.step(&mut tick, &state, &before);
            let touched = nearby.body(touch.body).filter(|_| touch.contact);
            let reaction = reactions.get_mut(touch.body as usize);
            if let Some((body, reaction)) = touched.zip(reaction) {
                reaction.add(-touch.force, touch.proxy - body.world_from_body().translation);
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
    options: &ServoOptions,
) -> (Point<D>, f64) {
    let known = states.iter().zip(touches).filter(|(state, _)| state.position.is_finite());
    let (mut sum, mut count) = (Vector::ZERO, 0.0);
    for (state, _) in known.clone() {
        sum += state.position;
        count += 1.0;
    }
    let centre = if count > 0.0 { sum * (1.0 / count) } else { Vector::ZERO };
    let (mut radius, mut motion) = (0.0_f64, 0.0_f64);
    for (state, touch) in known {
        radius = radius.max((state.position - centre).norm());
        motion = motion.max((state.position - touch.proxy).norm());
    }
    (centre, radius + WAYS * (motion + options.probe.radius()))
}

/// What all contact points see in a tick.
struct Tick<'a, const D: usize> {
    nearby: Nearby<'a, D>,
    options: &'a ServoOptions,
    rise_step: f64,
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
    fn step(
        &mut self,
        tick: &mut Tick<'_, D>,
        state: &PointState<D>,
        before: &Touch<D>,
    ) -> Touch<D> {
        let device = state.position;
        // A proxy told of a point that is not finite stays where it is.
        let following = self.proxy.follow(tick.nearby, device);
        self.rise = if following.placed {
            0.0
        } else if following.contact {
            (self.rise + tick.rise_step).min(1.0)
        } else {
            1.0
        };
        let body = tick.nearby.body(following.body);
        let mut touch = Touch {
            device,
            velocity: state.velocity,
            proxy: following.proxy,
            force: Vector::ZERO,
            normal: following.normal,
            contact: following.contact,
            body: following.body,
            is_slipping: following.is_slipping,
            evaluations: following.evaluations,
        };
        let Some(body) = body.filter(|_| state.is_finite()) else {
            touch.velocity = Vector::ZERO;
            return touch;
        };
        if following.contact {
            if body.has_moved() {
                touch.velocity -= (body.carried(device) - device) * tick.options.rate;
            }
            self.tell_changes(tick, &touch, before, body);
            let force = self.force(tick, &touch, &following, body);
            touch.force = limited(force, tick.options.max_force) * self.rise;
        } else {
            self.ringing = Ringing::SILENT;
            if before.contact {
                tick.tell(before.body, EventKind::Leave);
            }
            touch.force = limited(self.pull(tick, &mut touch), tick.options.max_force);
        }
        touch
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
        let turned = |v: Vector<f64, D>| body.body_from_world().transform_vector(v);
        let force = surface.force(level, turned(stretch), turned(touch.velocity), in_body);
        let force = body.world_from_body().transform_vector(force);
        let held = surface.strata.force(level, stretch.norm());
        let pop = surface.strata.top(level).and_then(|top| top.pop_through);
        if pop.is_some_and(|pop| held > pop.force) && self.proxy.pierce(following.body) {
            tick.tell(following.body, EventKind::Pop { force: held });
        }
        // A ring shakes the hand, but does not pull it in.
        let ring = self.ringing.step().max(-force.dot(following.normal).max(0.0));
        force + following.normal * ring
    }

    /// The pull of magnets on a point that touches nothing [N].
    fn pull(&self, tick: &Tick<'_, D>, touch: &mut Touch<D>) -> Vector<f64, D> {
        let mut force = Vector::ZERO;
        for (index, body) in tick.nearby.all() {
            let Some(magnet) = &body.surface().magnet else { continue };
            let is_far =
                body.above_ball(touch.device) > magnet.reach + tick.options.probe.radius();
            if is_far || self.proxy.level(index) > 0 {
                continue;
            }
            touch.evaluations += 1;
            let (distance, gradient) = body.distance_gradient(touch.device);
            let pull = magnet.at(distance - tick.options.probe.radius());
            if let Some(normal) = gradient.normalized() {
                force -= normal * pull;
            }
        }
        force
    }
}
