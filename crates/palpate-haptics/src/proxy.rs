// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The proxy: a ball that follows the device point but cannot enter the bodies.
//!
//! Zilles and Salisbury, "A constraint-based god-object method for haptic display" (1995);
//! Ruspini, Kolarov and Khatib, "The haptic display of complex graphical environments" (1997),
//! who gave it a radius; Salisbury and Tarr, "Haptic rendering of surfaces defined by implicit
//! functions" (1997), who slid it over `f = 0`. The sweep and the certified slide are ours.
//!
//! A body that moves carries the proxy that touches it, and pushes one that it meets: the way
//! of the proxy as the body sees it is swept like any other.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{LARGEST_LENGTH, Point, Vector};

use crate::bodies::Body;

use crate::contact::{Ground, slide};
use crate::error::HapticsError;
use crate::friction::{Hold, drag};
use crate::nearby::{Nearby, Pierced};
use crate::sampler::{Sample, Sampler};
use crate::surface::Friction;
use palpate_safety::{NumberError, not_negative};

/// The evaluations a tick may cost, unless asked otherwise. Sliding takes one to three, a corner
/// up to eight, a strike about ten; the rest is for grazing flights, slots and fast hands.
pub const DEFAULT_BUDGET: u32 = 64;

/// The fewest evaluations a tick can work with: two to see a surface, one to leave it.
const LEAST_BUDGET: u32 = 4;

/// A flight whose next safe step is below this part of the way left goes on along the surface it
/// meets: steps along a line that grazes or hits it would shrink without end.
const WORTH_FLYING: f64 = 0.1;

/// A body is met where its next safe step is below this part of a skin.
const WORTH_ADVANCING: f64 = 0.01;

/// A body that would carry the proxy to a place this many times as far from the origin leaves
/// it behind: so far away, rounding would hide the walls that are here.
const FARTHEST_CARRIED: f64 = 1e3;

/// The ball that touches: the proxy's radius, and what a tick may cost.
///
/// The force stays continuous over a convex edge if the radius is at least the depth pressed to;
/// a radius of `max_force / stiffness` is enough for every force a device can give.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    radius: f64,
    budget: u32,
}

impl Probe {
    /// A ball of `radius` [m]; a point if it is zero.
    ///
    /// A point is held by walls thicker than 1e-4 of the radius of the shape's bounding ball; a ball by any
    /// wall.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the radius is negative or not finite.
    pub fn new(radius: f64) -> Result<Self, HapticsError> {
        let radius = not_negative("radius", radius, "m")?;
        Ok(Self { radius, budget: DEFAULT_BUDGET })
    }

    /// The same, with at most `budget` evaluations of the shape a tick.
    ///
    /// A tick that would need more leaves its proxy behind, outside the shape, to catch up in
    /// the next ones.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the budget is below 4.
    pub fn with_budget(self, budget: u32) -> Result<Self, HapticsError> {
        if budget < LEAST_BUDGET {
            let value = f64::from(budget);
            let (parameter, rule, unit) = ("budget", "at least 4", "evaluations");
            return Err(HapticsError::Number(NumberError { parameter, rule, value, unit }));
        }
        Ok(Self { budget, ..self })
    }

    /// The radius [m].
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The most evaluations a tick may cost.
    #[must_use]
    pub fn budget(&self) -> u32 {
        self.budget
    }
}

impl Default for Probe {
    /// A ball of 2 mm: wide enough for 1 N at 500 N/m to pass every edge smoothly.
    fn default() -> Self {
        Self { radius: 0.002, budget: DEFAULT_BUDGET }
    }
}

/// Where a proxy is after a tick. World coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Following<const D: usize> {
    /// The proxy: on or outside the surface offset by the probe's radius; the device point
    /// itself where nothing is touched, as far as the field's promise goes [m].
    pub proxy: Point<D>,
    /// The unit normal of the surface last seen, pointing out.
    pub normal: Vector<f64, D>,
    /// `true` if the surface keeps the proxy from the device point.
    pub contact: bool,
    /// Whose surface was last seen: the number of the body.
    pub body: u32,
    /// `true` if friction lets the proxy move along the surface; `false` if it holds it, or
    /// there is none.
    pub is_slipping: bool,
    /// `true` if the force should rise gently: the proxy was placed anew because a body
    /// covered it, in the first tick or after a change, or a body moved onto it.
    pub placed: bool,
    /// Evaluations of the field in this tick.
    pub evaluations: u32,
}

/// The constrained point that follows one device point.
///
/// # Examples
///
/// A point pressed 2 mm into a ball of 50 mm, off centre:
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ball};
/// use palpate_haptics::{Bodies, Probe, Proxy};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Bodies::from(Shape::from_kernel(Ball::new(0.05)?));
/// let mut proxy = Proxy::new(Probe::new(0.0)?);
/// proxy.follow(&ball.everything(), Vector([0.0, 0.06, 0.0]));
/// let device = Vector([0.048 * 0.6, 0.048 * 0.8, 0.0]);
/// let following = proxy.follow(&ball.everything(), device);
///
/// assert!(following.contact);
/// assert!((following.proxy - Vector([0.03, 0.04, 0.0])).norm() < 1e-7);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Proxy<const D: usize> {
    probe: Probe,
    /// The last point found on or outside the offset surface; none before the first tick.
    at: Option<Sample<D>>,
    /// Whether what is known of that point is of another field.
    is_stale: bool,
    /// The device point of the last tick [m].
    device: Point<D>,
    normal: Vector<f64, D>,
    contact: bool,
    hold: Hold,
    /// What is known of the surface where it last was.
    ground: Ground<D>,
    pierced: Pierced,
}

impl<const D: usize> Proxy<D> {
    /// A proxy that starts where the device point first is.
    #[must_use]
    pub fn new(probe: Probe) -> Self {
        // Up: y in the plane and in space.
        let normal = Vector(std::array::from_fn(|axis| f64::from(u8::from(axis == 1))));
        Self {
            probe,
            at: None,
            is_stale: false,
            device: Vector::ZERO,
            normal,
            contact: false,
            hold: Hold::None,
            ground: Ground::new(),
            pierced: Pierced::default(),
        }
    }

    /// The ball that touches.
    #[must_use]
    pub fn probe(&self) -> Probe {
        self.probe
    }

    /// Forgets what is known of the bodies: they changed.
    ///
    /// The next tick looks again where the proxy is, and places it anew if it is covered.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn forget_bodies(&mut self) {
        self.is_stale = true;
        self.pierced = Pierced::default();
    }

    /// Goes through the layer of a body that holds the proxy; `false` if it is through as many
    /// bodies as there is room for.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn pierce(&mut self, body: u32) -> bool {
        self.is_stale = true;
        self.pierced.pierce(body)
    }

    /// How many layers of a body it went through.
    pub(crate) fn level(&self, body: u32) -> usize {
        self.pierced.level(body)
    }

    /// Follows the device point to `device` [m] as far as the bodies let it.
    ///
    /// One evaluation in free space. The proxy moves only along ways that are proven free, so
    /// it crosses no wall at any speed; it rests at points with `f ≥ r − 1e-9` of the size of
    /// the ball around all bodies, with the field's value `f` and the probe's radius `r`.
    ///
    /// Of a field that outside its surface promises a Lipschitz constant in a region only
    /// ([`Promise::region`](palpate_field::Promise::region)), nothing is known beyond: the proxy
    /// stays in the region, at the point of it closest to the device where that is free. A device
    /// point that starts outside has no proxy, and touches nothing, until it enters.
    ///
    /// A device point that is not finite, or beyond 1e15 m, moves nothing and touches nothing.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic; evaluates the field at most
    /// [`Probe::budget`] times.
    pub fn follow(&mut self, nearby: &Nearby<'_, D>, device: Point<D>) -> Following<D> {
        let last = self.at.as_ref().map_or(device, |at| at.point);
        // Written so that NaN fails.
        if !device.0.iter().all(|x| x.abs() <= LARGEST_LENGTH) {
            // What moves meanwhile is not where it was when the hand comes back.
            self.is_stale |= nearby.has_moved();
            let following = self.following(last, false, 0);
            // Of bodies that were replaced, the number may be gone.
            let body = nearby.body(following.body).map_or(0, |_| following.body);
            return Following { contact: false, body, ..following };
        }
        let carried =
            if nearby.has_moved() { self.carried(nearby, [last, device]) } else { last };
        let farther = carried.dot(carried).max(device.dot(device)).sqrt();
        let extent = farther + 2.0 * self.probe.radius;
        let squared = |way: Vector<f64, D>| way.dot(way);
        let moved = if self.at.is_some() { squared(device - self.device) } else { 0.0 };
        self.device = device;
        let moved = moved.max(squared(carried - last)).sqrt();
        let Probe { radius, budget } = self.probe;
        let mut sampler = Sampler::new((nearby, self.pierced), radius, budget, extent);

        if !self.pierced.is_empty() {
            self.heal(&mut sampler);
        }
        let mut is_pushed = false;
        if nearby.has_moved() && self.at.is_some() {
            let pushed = self.pushed(&mut sampler, [last, carried]);
            is_pushed = pushed.is_some();
            let at = pushed.unwrap_or(carried);
            self.at = self.look_again(&mut sampler, at);
        } else if self.is_stale && self.at.is_some() {
            self.at = self.look_again(&mut sampler, last);
        }
        if self.is_stale || nearby.has_moved() {
            self.ground.forget();
        }
        self.is_stale = false;
        let is_known = self.at.as_ref().is_some_and(|at| at.gap >= -sampler.tolerance());
        let mut placed = is_pushed;
        if !is_known {
            let from = self.at.as_ref().map_or(device, |at| at.point);
            let (start, is_moved) = self.place(&mut sampler, from);
            self.at = start;
            placed |= is_moved;
        }
        let goal = sampler.within_region(device);
        self.pursue(&mut sampler, (goal, moved));
        let proxy = self.at.as_ref().map_or(device, |at| at.point);
        self.following(proxy, placed, sampler.evaluations())
    }

    fn following(&self, proxy: Point<D>, placed: bool, evaluations: u32) -> Following<D> {
        Following {
            proxy,
            normal: self.normal,
            contact: self.contact,
            body: self.at.as_ref().map_or(0, |at| at.body),
            is_slipping: self.hold == Hold::Slip,
            placed,
            evaluations,
        }
    }

    /// Where the body that is touched carries the proxy: away from `last`, but not out of the
    /// neighbourhood of it, the device and the bodies.
    #[inline(never)]
    fn carried(&mut self, nearby: &Nearby<'_, D>, [last, device]: [Point<D>; 2]) -> Point<D> {
        let touched = self.at.filter(|_| self.contact).and_then(|at| nearby.body(at.body));
        let Some(body) = touched.filter(|body| body.has_moved()) else { return last };
        let carried = body.carried(last);
        let here = last.norm().max(device.norm()).max(nearby.size().unwrap_or(0.0));
        if carried.norm() > FARTHEST_CARRIED * here {
            return last;
        }
        self.normal = body.carried(last + self.normal) - carried;
        carried
    }

    /// What is there at the proxy, of which nothing is known any more.
    #[inline(never)]
    fn look_again(&self, sampler: &mut Sampler<'_, D>, at: Point<D>) -> Option<Sample<D>> {
        let body = self.at.map_or(0, |at| at.body);
        let unknown = Sample { point: at, gap: f64::NEG_INFINITY, tangent: None, body };
        Some(sampler.gradient(at).unwrap_or(unknown))
    }

    /// Lets layers hold again that the hand is away from.
    #[inline(never)]
    fn heal(&mut self, sampler: &mut Sampler<'_, D>) {
        let (device, radius) = (self.device, self.probe.radius);
        let before = self.pierced;
        self.pierced.heal(|index, level| {
            let Some(body) = sampler.nearby().body(index) else { return true };
            let pop = level.checked_sub(1).and_then(|top| body.surface().strata.top(top));
            let away = pop.and_then(|top| top.pop_through).map_or(0.0, |pop| pop.distance);
            sampler.spend(device).is_some() && body.distance(device) - radius > away
        });
        if self.pierced != before {
            self.is_stale = true;
            sampler.pierce(self.pierced);
        }
    }

    /// Where other bodies stop a proxy that its body carries from one place to another, or
    /// push it to; none if it meets none.
    #[inline(never)]
    fn pushed(
        &self,
        sampler: &mut Sampler<'_, D>,
        [from, to]: [Point<D>; 2],
    ) -> Option<Point<D>> {
        let nearby = sampler.nearby();
        let touched = self.at.filter(|_| self.contact).map(|at| at.body);
        let is_carried = from != to;
        let mut pushed = None;
        for (index, body) in nearby.all() {
            let is_still = !body.has_moved() && !is_carried;
            if is_still || touched == Some(index) || self.level(index) > 0 {
                continue;
            }
            if let Some(met) = met(sampler, body, [from, pushed.unwrap_or(to)]) {
                pushed = Some(met);
            }
        }
        pushed
    }

    /// A point on or outside the offset surface near `from`, and whether it had to be moved
    /// there: up the gradient by `(r − f) / ‖∇f‖` until it is out. None if half the budget does
    /// not lead out.
    #[inline(never)]
    fn place(
        &mut self,
        sampler: &mut Sampler<'_, D>,
        from: Point<D>,
    ) -> (Option<Sample<D>>, bool) {
        let mut point = from;
        while sampler.evaluations() < self.probe.budget / 2 {
            let Some(sample) = sampler.gradient(point) else { break };
            let (normal, gap) = sampler.tangent(&sample, self.normal);
            if sample.gap >= -sampler.tolerance() {
                return (Some(sample), point != from);
            }
            self.normal = normal;
            point -= normal * gap;
        }
        (None, false)
    }

    /// Flies straight to the device where that is free, and slides from where it is not. A proxy
    /// that has no place touches nothing.
    fn pursue(&mut self, sampler: &mut Sampler<'_, D>, (device, moved): (Point<D>, f64)) {
        let Self { at, normal, contact, hold, ground, pierced, .. } = self;
        let (mut was_held, how) = (std::mem::take(contact), std::mem::take(hold));
        let Some(here) = at else { return };
        loop {
            let way = device - here.point;
            let squared = way.dot(way);
            let free = sampler.free_radius(here);
            let is_free = free > 0.0 && free * free > squared;
            let next = if is_free {
                device
            } else if free > 0.0 && free * free > WORTH_FLYING * WORTH_FLYING * squared {
                // Conservative advancement (Mirtich 1996): nothing is within `free`.
                here.point + way * (free / squared.sqrt())
            } else {
                let place = (&mut *here, &mut *normal);
                let friction = friction(sampler, place.0, (squared.sqrt(), pierced));
                match friction.filter(|_| was_held) {
                    Some(friction) => {
                        let held = (friction, how);
                        (*contact, *hold) = drag(sampler, place, (device, moved), held, ground);
                    }
                    None => *contact = slide(sampler, place, (device, moved), ground),
                }
                *contact =
                    *contact || was_held && is_held_still(sampler, (here, normal), device);
                if !*contact {
                    *hold = Hold::None;
                }
                return;
            };
            was_held = false;
            match sampler.distance(next) {
                Some(sample) if sample.gap >= -sampler.tolerance() => *here = sample,
                _ => return,
            }
            if is_free {
                return;
            }
        }
    }
}

/// Whether a surface that held a proxy still does where it may have run out of budget on its way:
/// the hand is below its tangent plane. Beyond a thin wall a hand is outside the body again.
///
/// A proxy that is at the device is no lower than two tolerances.
#[cold]
#[inline(never)]
fn is_held_still<const D: usize>(
    sampler: &Sampler<'_, D>,
    (here, normal): (&Sample<D>, &Vector<f64, D>),
    device: Point<D>,
) -> bool {
    let (normal, gap) = sampler.tangent(here, *normal);
    normal.dot(device - here.point) + gap < -2.0 * sampler.tolerance()
}

/// The friction of the surface at a sample that the device is `depth` from [m].
fn friction<const D: usize>(
    sampler: &Sampler<'_, D>,
    at: &Sample<D>,
    (depth, pierced): (f64, &Pierced),
) -> Option<Friction> {
    let strata = &sampler.nearby().body(at.body)?.surface().strata;
    Some(strata.at(pierced.level(at.body), depth).friction)
}

/// Where a body meets a proxy on its way in this tick, and takes it to; none if it does not
/// meet it.
///
/// As the body sees it, the proxy moves along a straight line. Conservative advancement along
/// it (Mirtich 1996) misses nothing; it ends, and the body takes the proxy along, where it is
/// nearly there. What stays beside the ball around a body costs no evaluation: twenty bodies
/// that move would leave none for the one that is touched.
fn met<const D: usize>(
    sampler: &mut Sampler<'_, D>,
    body: &Body<D>,
    [before, point]: [Point<D>; 2],
) -> Option<Point<D>> {
    let margin = sampler.radius() + sampler.skin();
    let [from, to] = body.way_in_body([before, point], margin)?;
    let way = to - from;
    let length = way.norm();
    let lipschitz = body.shape().promise().lipschitz.max(1.0);
    let mut gone = 0.0;
    while gone < length {
        let at = from + way * (gone / length);
        let taken = body.world_from_body().transform_point(at);
        if sampler.spend(point).is_none() {
            return Some(taken);
        }
        let (value, gradient) = body.shape().distance_gradient(at);
        let free = (value - sampler.radius() - sampler.tolerance()) / lipschitz;
        if free <= WORTH_ADVANCING * sampler.skin() {
            // What it touches and leaves, it does not push.
            return (way.dot(gradient) < 0.0).then_some(taken);
        }
        gone += free;
    }
    None
}
