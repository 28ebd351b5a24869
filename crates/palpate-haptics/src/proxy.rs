// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The proxy: a ball that follows the device point but cannot enter the bodies.
//!
//! Sources: Zilles and Salisbury, "A constraint-based god-object method for haptic display"
//! (1995); Ruspini, Kolarov and Khatib, "The haptic display of complex graphical environments"
//! (1997), for the radius; Salisbury and Tarr, "Haptic rendering of surfaces defined by
//! implicit functions" (1997), for the slide over `f = 0`. The swept motion and the certified
//! slide are our own.
//!
//! A moving body carries a proxy that touches it and pushes a proxy that it meets. To find the
//! meeting point, the proxy's motion in body coordinates is swept.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod carry_out;
mod squeezed;

use palpate_field::{LARGEST_LENGTH, Point, Vector};

use crate::bodies::Body;

use crate::contact::{
    Dragged, Goal, Held, Hold, LocalSurface, Place, Walls, drag, drag_along, slide,
};
use crate::error::HapticsError;
use crate::nearby::{Nearby, Punctured, Yielding};
use crate::sampler::{Sample, Sampler, Tangent};
use crate::surface::Friction;
use carry_out::CarriedOut;
pub(crate) use carry_out::MOST_OF_POINT;
use palpate_device::NumberError;
use squeezed::Way;

/// The default budget of evaluations in a tick. Sliding takes one to three, a corner up to
/// eight, an impact about ten; the rest is for grazing motions, slots and fast hands.
pub const DEFAULT_BUDGET: u32 = 64;

/// The least budget: two evaluations to find a surface, one to leave it, one in reserve.
const LEAST_BUDGET: u32 = 4;

/// When the next safe step is below this part of the remaining path, the proxy stops advancing
/// on a straight line and slides: steps on a line that grazes or hits the surface would shrink
/// without end.
const WORTH_FLYING: f64 = 0.1;

/// A moving body meets the proxy where the next safe step is below this part of a skin.
const WORTH_ADVANCING: f64 = 0.01;

/// The most ticks in which a proxy rides on a body without a new sample.
const MOST_RIDDEN: u32 = 64;

/// Looking for bodies that push may use one of so many parts of the budget: a body that grazes the
/// proxy would use up all of it, and leave none to find the proxy's place.
const PUSHING: u32 = 2;

/// The most evaluations that place a proxy outside a body that pushes it.
const MOST_PLACING: u32 = 6;

/// A body does not carry the proxy to a place this many times as far from the origin as proxy,
/// device and bodies are: so far away, rounding would hide their walls.
const FARTHEST_CARRIED: f64 = 1e3;

/// The ball that touches: the radius of the proxy and the budget of a tick.
///
/// The force stays continuous over a convex edge if the radius is at least the depth. A radius
/// of `max_force / stiffness` suffices for every force that a device can give.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    radius: f64,
    budget: u32,
}

impl Probe {
    /// A ball of `radius` [m]; a radius of zero makes a point.
    ///
    /// With the radius R of the scene's bounding ball, a probe with a radius below `2e-5 R` moves as
    /// a point: it may cross walls thinner than `1e-4 R`. A larger probe crosses no wall. Each
    /// touches where its own surface is.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the radius is negative or not finite.
    pub fn new(radius: f64) -> Result<Self, HapticsError> {
        let radius = NumberError::check_not_negative("radius", radius, "m")?;
        Ok(Self { radius, budget: DEFAULT_BUDGET })
    }

    /// This probe with at most `budget` evaluations of the shape in a tick.
    ///
    /// When a tick needs more, the proxy lags behind, outside the shape, and catches up in
    /// later ticks.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the budget is below 4.
    pub fn with_budget(self, budget: u32) -> Result<Self, HapticsError> {
        if budget < LEAST_BUDGET {
            let value = f64::from(budget);
            let (parameter, rule, unit) = ("budget", "at least 4", "evaluations");
            return Err(HapticsError::Number(NumberError::new(parameter, rule, value, unit)));
        }
        Ok(Self { budget, ..self })
    }

    /// The radius [m].
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The most evaluations in a tick.
    #[must_use]
    pub fn budget(&self) -> u32 {
        self.budget
    }
}

impl Default for Probe {
    /// A ball of 2 mm radius: at 500 N/m the force stays continuous over every edge up to 1 N.
    fn default() -> Self {
        Self { radius: 0.002, budget: DEFAULT_BUDGET }
    }
}

/// The state of a proxy after a tick, in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Following {
    /// The proxy [m], on or outside the surface offset by the probe's radius. Without contact
    /// it is the device point, unless the device point lies outside the region of the field's
    /// promise.
    pub proxy: Point<3>,
    /// The unit normal of the surface that the proxy last reached, pointing out.
    pub normal: Vector<f64, 3>,
    /// `true` if the surface keeps the proxy from the device point.
    pub contact: bool,
    /// The index of the body whose surface the proxy last reached.
    pub body: u32,
    /// `true` if the proxy slips; `false` if it sticks, or if there is no friction.
    pub is_slipping: bool,
    /// `true` if the force must rise gently, because the proxy was placed anew: a body covered
    /// the proxy in the first tick, or deeper than an edit may carry it, or moved onto it.
    pub placed: bool,
    /// What became of a proxy that an edit covered since the tick before; `None` if none did.
    pub edited: Option<Edited>,
    /// A body that the proxy lies in, because it moved and left the proxy no room beside bodies that
    /// stand still; `None` if there is room.
    pub squeezed: Option<u32>,
    /// Evaluations of the field in this tick.
    pub evaluations: u32,
}

/// What became of a proxy that an edit of the bodies covered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Edited {
    /// It was [carried out](Proxy::carry_out).
    Carried {
        /// How far, the shortest way [m].
        distance: f64,
    },
    /// It was placed anew.
    Placed,
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
/// let ball = Bodies::from(Shape::<3>::from_kernel(Ball::new(0.05)?));
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
pub struct Proxy {
    probe: Probe,
    /// The last point found on or outside the offset surface; `None` before the first tick.
    at: Option<Sample>,
    /// Whether the sample in `at` was taken from a field that has changed since.
    is_stale: bool,
    /// Whether there was no place in any tick so far, or since the proxy was lifted.
    begins: bool,
    /// Whether bodies were replaced since the last tick.
    is_edited: bool,
    /// Where an edit since the last tick carries the proxy.
    carried_out: Option<CarriedOut>,
    /// The device point of the last tick [m].
    device: Point<3>,
    normal: Vector<f64, 3>,
    contact: bool,
    hold: Hold,
    /// The local model of the surface near the proxy.
    local: LocalSurface,
    punctured: Punctured,
    /// The bodies that the proxy lies in, because they moved and left it no room.
    yielding: Yielding,
    /// The walls of all bodies that held the proxy in the last tick; `None` if one held it.
    walls: Option<Walls>,
    /// Whether bodies moved in this contact.
    is_moved: bool,
    /// In how many ticks the proxy rode on a body since its sample was taken.
    ridden: u32,
    /// The part of the stretch from device to proxy that friction holds [m].
    held: Vector<f64, 3>,
}

impl Proxy {
    /// A proxy that starts at the first device point.
    #[must_use]
    #[inline(never)]
    pub fn new(probe: Probe) -> Self {
        // Up: y in the plane and in space.
        let normal = Vector(std::array::from_fn(|axis| f64::from(u8::from(axis == 1))));
        Self {
            probe,
            at: None,
            is_stale: false,
            begins: true,
            is_edited: false,
            carried_out: None,
            device: Vector::ZERO,
            normal,
            contact: false,
            hold: Hold::None,
            local: LocalSurface::new(),
            punctured: Punctured::default(),
            yielding: Yielding::default(),
            walls: None,
            is_moved: false,
            ridden: 0,
            held: Vector::ZERO,
        }
    }

    /// The part of the stretch from device to proxy that friction holds [m]. Where static friction
    /// leaves it open, it is as [`hold`](Self::hold) last set it: friction bears what it bore.
    pub(crate) fn held(&self) -> Vector<f64, 3> {
        self.held
    }

    /// Sets the part of the stretch that friction holds [m].
    pub(crate) fn hold(&mut self, held: Vector<f64, 3>) {
        self.held = held;
    }

    /// Sets the walls of several bodies that hold the proxy together; `None` if one holds it.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn hold_between(&mut self, walls: Option<Walls>) {
        if walls.is_some() || self.walls.is_some() {
            self.walls = walls;
        }
    }

    /// The ball that touches.
    #[must_use]
    pub fn probe(&self) -> Probe {
        self.probe
    }

    /// Forgets the bodies, because they were replaced.
    ///
    /// The next tick evaluates the new bodies at the proxy, and places the proxy anew if a body
    /// covers it; [`carry_out`](Self::carry_out) keeps its touch instead.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[inline(never)]
    pub fn forget_bodies(&mut self) {
        // Where the proxy has no place yet, an edit changes none.
        (self.is_stale, self.is_edited, self.carried_out) = (true, !self.begins, None);
        (self.punctured, self.yielding) = (Punctured::default(), Yielding::default());
        self.walls = None;
    }

    /// Evaluates the bodies anew at the proxy in the next tick, because one of them jumped.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn look_anew(&mut self) {
        self.is_stale = true;
    }

    /// Lifts the proxy off the bodies: the next tick places it anew, as the first one did.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn lift(&mut self) {
        self.forget_bodies();
        (self.at, self.contact, self.hold) = (None, false, Hold::None);
        (self.held, self.begins, self.is_edited) = (Vector::ZERO, true, false);
    }

    /// Whether the proxy has had no place since the first tick, or since it was lifted.
    pub(crate) fn begins(&self) -> bool {
        self.begins
    }

    /// Punctures the layer of a body that constrains the proxy; `false` if no more bodies can
    /// be recorded.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn puncture(&mut self, body: u32) -> bool {
        self.is_stale = true;
        self.punctured.puncture(body)
    }

    /// The punctured layers of all bodies.
    pub(crate) fn punctured(&self) -> &Punctured {
        &self.punctured
    }

    /// Whether bodies moved in this contact.
    pub(crate) fn is_moved(&self) -> bool {
        self.is_moved
    }

    /// The bodies that do not constrain the proxy, because they moved and left it no room.
    pub(crate) fn yielding(&self) -> Yielding {
        self.yielding
    }

    /// The number of punctured layers of a body.
    pub(crate) fn level(&self, body: u32) -> usize {
        self.punctured.level(body)
    }

    /// Follows the device point to `device` [m] as far as the bodies let it.
    ///
    /// Free space costs one evaluation. The proxy moves only along paths that are proven free,
    /// so it crosses no wall at any speed, except that a [point](Probe::new) may cross one thinner
    /// than 1e-4 of the bounding radius. It rests at points with `f ≥ r − 1e-9 R`, with the
    /// field's value `f`, the probe's radius `r` and the radius `R` of the ball around all
    /// bodies.
    ///
    /// A moving body carries the proxy that touches it, and pushes the one that it meets. Where it
    /// leaves the proxy no room beside bodies that stand still, it yields: the proxy then lies in it
    /// until there is room ([`Following::squeezed`]).
    ///
    /// Some fields promise a Lipschitz constant outside their surface only in a region
    /// ([`Promise::region`](palpate_field::Promise::region)). The proxy then stays in the
    /// region, at the free point closest to the device. A device point that starts outside the
    /// region touches nothing until it enters.
    ///
    /// If a coordinate of the device point is not finite or exceeds 1e15 m, the proxy stays in
    /// place and there is no contact.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic; evaluates the field at most
    /// [`Probe::budget`] times.
    #[inline(never)]
    pub fn follow(&mut self, nearby: &Nearby<'_>, device: Point<3>) -> Following {
        let last = self.at.as_ref().map_or(device, |at| at.point);
        // Written so that NaN fails.
        if !device.0.iter().all(|x| x.abs() <= LARGEST_LENGTH) {
            // Bodies that move in this tick make the samples stale.
            if nearby.has_moved() {
                (self.is_stale, self.carried_out) = (true, None);
            }
            let following = self.following(last, false, 0);
            // After a replacement the body index may be out of range.
            let body = nearby.body(following.body).map_or(0, |_| following.body);
            return Following { contact: false, body, ..following };
        }
        let (was_edited, out) = (std::mem::take(&mut self.is_edited), self.take_out(nearby));
        if was_edited && nearby.has_moved() {
            let has_moved = |body| nearby.body(body).is_none_or(Body::has_moved);
            self.punctured.restore(|body, _| has_moved(body));
        }
        let last = out.map_or(last, |out| out.sample.point);
        let carried =
            if nearby.has_moved() { self.carried(nearby, [last, device]) } else { last };
        let farther = carried.dot(carried).max(device.dot(device)).sqrt();
        let extent = farther + 2.0 * self.probe.radius;
        let squared = |way: Vector<f64, 3>| way.dot(way);
        let moved = if self.at.is_some() { squared(device - self.device) } else { 0.0 };
        self.device = device;
        let moved = moved.max(squared(carried - last)).sqrt();
        let moved = out.map_or(moved, |out| moved.max(out.distance));
        let Probe { radius, budget } = self.probe;
        // Copying the bodies costs as much as an evaluation, and few hands are squeezed.
        let (everything, firm, firmer);
        everything = nearby;
        let nearby = if self.yielding.is_empty() {
            everything
        } else {
            firm = everything.without(self.yielding);
            &firm
        };
        let mut sampler = Sampler::new(nearby, self.punctured, radius, budget, extent);

        if !self.punctured.is_empty() {
            self.restore(&mut sampler);
        }
        let mut is_placed_on = false;
        let has_moved = nearby.has_moved();
        let ridden = if has_moved { self.ridden(&sampler, [last, carried]) } else { None };
        if let Some(ridden) = ridden {
            (self.at, self.is_moved) = (Some(ridden), true);
        } else if nearby.has_moved() && self.at.is_some() {
            self.is_moved = true;
            let ways = [last, carried];
            let pushed =
                sampler.at_most(budget / PUSHING, |sampler| self.pushed(sampler, ways));
            let most = if sampler.is_point() { MOST_OF_POINT } else { radius };
            is_placed_on = pushed.is_some_and(|at| squared(at - last) > most * most);
            if pushed.is_some() && self.contact && self.walls.is_none() {
                self.walls = self.wall(&sampler);
            }
            let at = pushed.unwrap_or(carried);
            self.at = self.look_again(&mut sampler, at);
        } else if self.is_stale && self.at.is_some() {
            self.at = self.look_again(&mut sampler, last);
        }
        if self.is_stale || nearby.has_moved() && ridden.is_none() {
            self.local.forget();
        }
        self.is_stale = false;
        // The tolerance of an edit may be that of other lengths.
        let tolerance = if out.is_some() { 2.0 } else { 1.0 } * sampler.tolerance();
        let is_known = self.at.as_ref().is_some_and(|at| at.gap >= -tolerance);
        let mut placed = is_placed_on && !self.contact;
        let mut has_room = true;
        if !is_known {
            let pushed = self.at.filter(|_| nearby.has_moved());
            let from = self.at.as_ref().map_or(device, |at| at.point);
            let half = self.probe.budget / 2;
            // Between bodies, room is searched for below.
            let most = sampler.evaluations() + MOST_PLACING;
            let most = if pushed.is_some() { half.min(most) } else { half };
            let (start, is_moved) = self.place(&mut sampler, from, most);
            self.at = start;
            match pushed {
                Some(pushed) if !self.is_beside(&mut sampler, last, is_moved) => {
                    let way = Way { from: last, to: pushed.point };
                    has_room = self.make_room(&mut sampler, way);
                }
                // What pushes a hand that is in contact changes its force by as much as it moves.
                Some(_) if self.contact => {}
                _ => placed |= is_moved,
            }
        }
        if !has_room {
            firmer = everything.without(self.yielding);
            sampler = sampler.among(&firmer);
            let at = self.at.as_ref().map_or(device, |at| at.point);
            self.at = self.look_again(&mut sampler, at);
        }
        let goal = sampler.within_region(device);
        self.pursue(&mut sampler, Goal { device: goal, motion: moved });
        if !self.yielding.is_empty() {
            self.look_for_room(&mut sampler, everything);
        }
        let proxy = self.at.as_ref().map_or(device, |at| at.point);
        // A proxy without a place is placed in a later tick.
        let is_lost = self.at.is_none();
        self.begins &= is_lost;
        let edited = match out {
            Some(out) => Some(Edited::Carried { distance: out.distance }),
            None => (was_edited && (placed || is_lost)).then_some(Edited::Placed),
        };
        Following { edited, ..self.following(proxy, placed, sampler.evaluations()) }
    }

    fn following(&self, proxy: Point<3>, placed: bool, evaluations: u32) -> Following {
        Following {
            proxy,
            normal: self.normal,
            contact: self.contact,
            body: self.at.as_ref().map_or(0, |at| at.body),
            is_slipping: self.hold == Hold::Slip,
            placed,
            edited: None,
            squeezed: self.yielding.bodies().next(),
            evaluations,
        }
    }

    /// Where the touched body carries the proxy from `last`; at most [`FARTHEST_CARRIED`] times
    /// as far from the origin as proxy, device and bodies.
    #[inline(never)]
    fn carried(&mut self, nearby: &Nearby<'_>, [last, device]: [Point<3>; 2]) -> Point<3> {
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

    /// Evaluates the field at `at` again, because the old sample is stale.
    #[inline(never)]
    fn look_again(&self, sampler: &mut Sampler<'_>, at: Point<3>) -> Option<Sample> {
        let body = self.at.map_or(0, |at| at.body);
        let unknown = Sample { point: at, gap: f64::NEG_INFINITY, tangent: None, body };
        Some(sampler.gradient(at).unwrap_or(unknown))
    }

    /// The sample of a proxy that rides on a body from `last` to `carried`: it is as it was in the
    /// body. `None` where it must be taken anew: where the proxy rides on no body, where another one is
    /// near, and after [`MOST_RIDDEN`] ticks, so that roundings do not add up.
    #[inline(never)]
    fn ridden(
        &mut self,
        sampler: &Sampler<'_>,
        [last, carried]: [Point<3>; 2],
    ) -> Option<Sample> {
        let nearby = sampler.nearby();
        let at = self.at.filter(|_| nearby.has_moved() && self.contact && !self.is_stale)?;
        let body = nearby.body(at.body).filter(|body| body.has_moved())?;
        let tangent = at.tangent.filter(|tangent| tangent.normal != Vector::ZERO)?;
        self.ridden += 1;
        let is_known = self.ridden < MOST_RIDDEN
            && last == at.point
            && carried == body.carried(last)
            && (carried - last).norm() <= sampler.skin()
            && at.gap >= -sampler.tolerance()
            && self.punctured.is_empty()
            && self.yielding.is_empty()
            && !sampler.is_point();
        let near = at.gap + sampler.radius() + sampler.skin() + (carried - last).norm();
        let is_alone = nearby
            .all()
            .all(|(index, other)| index == at.body || other.above_way(carried) > near);
        if !is_known || !is_alone || !body.is_proven(carried) {
            self.ridden = 0;
            return None;
        }
        let normal = body.carried_vector(tangent.normal);
        Some(Sample { point: carried, tangent: Some(Tangent { normal, ..tangent }), ..at })
    }

    /// The wall of the only body that held the proxy in the last tick.
    fn wall(&self, sampler: &Sampler<'_>) -> Option<Walls> {
        let at = self.at.as_ref()?;
        let depth = (at.point - self.device).norm();
        let friction = friction(sampler, at, depth, &self.punctured)?;
        Some(Walls::of_one(friction, self.normal))
    }

    /// Restores the punctured layers that the hand has left.
    #[inline(never)]
    fn restore(&mut self, sampler: &mut Sampler<'_>) {
        let (device, radius) = (self.device, self.probe.radius);
        let before = self.punctured;
        self.punctured.restore(|index, level| {
            let Some(body) = sampler.nearby().body(index) else { return true };
            let pop = level.checked_sub(1).and_then(|top| body.surface().strata.top(top));
            let away = pop.and_then(|top| top.pop_through).map_or(0.0, |pop| pop.distance);
            sampler.spend(device).is_some() && body.distance(device) - radius > away
        });
        if self.punctured != before {
            self.is_stale = true;
            sampler.puncture(self.punctured);
        }
    }

    /// Where other bodies stop or push a proxy that its own body carries from one place to
    /// another; `None` if the proxy meets no other body.
    #[inline(never)]
    fn pushed(&self, sampler: &mut Sampler<'_>, [from, to]: [Point<3>; 2]) -> Option<Point<3>> {
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

    /// A point on or outside the offset surface near `from`, and whether it differs from
    /// `from`. The point moves up the gradient by `(r − f) / ‖∇f‖` until it is outside; `None`
    /// after `most` evaluations.
    #[inline(never)]
    fn place(
        &mut self,
        sampler: &mut Sampler<'_>,
        from: Point<3>,
        most: u32,
    ) -> (Option<Sample>, bool) {
        let mut point = from;
        while sampler.evaluations() < most {
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

    /// Moves the proxy straight to the device while the path is free, then slides. A proxy
    /// without a place touches nothing.
    fn pursue(&mut self, sampler: &mut Sampler<'_>, goal: Goal) {
        let Self { at, normal, contact, hold, local, punctured, walls, is_moved, .. } = self;
        let (was_held, how) = (std::mem::take(contact), std::mem::take(hold));
        let Some(here) = at else { return };
        let flight = fly(sampler, here, goal.device);
        if !flight.is_stopped {
            return;
        }
        let was_held = was_held && !flight.has_flown;
        let depth = (goal.device - here.point).norm();
        let place = Place { here, normal };
        *is_moved &= was_held;
        let shared = walls.as_ref().map(|walls| walls.friction);
        let friction = shared.or_else(|| friction(sampler, place.here, depth, punctured));
        let dragged = match (walls.as_ref(), friction.filter(|_| was_held)) {
            (Some(walls), Some(_)) if *is_moved => {
                drag_along(sampler, place, goal, (walls, how), local)
            }
            (_, Some(friction)) => {
                drag(sampler, place, goal, Held { friction, hold: how }, local)
            }
            (_, None) => {
                let contact = slide(sampler, place, goal, local);
                Dragged { contact, hold: Hold::None, held: Some(Vector::ZERO) }
            }
        };
        (*contact, *hold) = (dragged.contact, dragged.hold);
        self.held = dragged.held.unwrap_or(self.held);
        *contact = *contact || was_held && is_held_still(sampler, here, normal, goal.device);
        if !*contact {
            *hold = Hold::None;
        }
    }
}

/// How a proxy flew.
struct Flight {
    /// Whether a surface stopped it, along which it must slide.
    is_stopped: bool,
    has_flown: bool,
}

/// Moves the proxy `here` straight to a point, up to the first surface.
///
/// Conservative advancement (Mirtich 1996): no surface is within the free radius.
#[inline(always)]
fn fly(sampler: &mut Sampler<'_>, here: &mut Sample, to: Point<3>) -> Flight {
    let mut has_flown = false;
    loop {
        let way = to - here.point;
        let squared = way.dot(way);
        let free = sampler.free_radius(here);
        let is_free = free > 0.0 && free * free > squared;
        let next = if is_free {
            to
        } else if free > 0.0 && free * free > WORTH_FLYING * WORTH_FLYING * squared {
            here.point + way * (free / squared.sqrt())
        } else {
            return Flight { is_stopped: true, has_flown };
        };
        has_flown = true;
        match sampler.distance(next) {
            Some(sample) if sample.gap >= -sampler.tolerance() => *here = sample,
            _ => return Flight { is_stopped: false, has_flown },
        }
        if is_free {
            return Flight { is_stopped: false, has_flown };
        }
    }
}

/// Whether the surface still constrains a proxy whose search may have run out of budget: the
/// device is below the tangent plane. Beyond a thin wall the device point is outside the body
/// again, so the field's sign alone does not decide.
///
/// The device point counts as below only beyond two tolerances, so that a proxy at the device
/// point is not in contact.
#[cold]
#[inline(never)]
fn is_held_still(
    sampler: &Sampler<'_>,
    here: &Sample,
    normal: &Vector<f64, 3>,
    device: Point<3>,
) -> bool {
    let (normal, gap) = sampler.tangent(here, *normal);
    normal.dot(device - here.point) + gap < -2.0 * sampler.tolerance()
}

/// The friction of the surface at a sample; the device is at distance `depth` [m] from the
/// sample.
fn friction(
    sampler: &Sampler<'_>,
    at: &Sample,
    depth: f64,
    punctured: &Punctured,
) -> Option<Friction> {
    let strata = &sampler.nearby().body(at.body)?.surface().strata;
    Some(strata.at(punctured.level(at.body), depth).friction)
}

/// Where a moving body takes a proxy that it meets in this tick; `None` if they do not meet.
///
/// In body coordinates the proxy moves along a straight line. Conservative advancement along
/// this line (Mirtich 1996) misses no surface; where it nearly reaches the surface, the body
/// takes the proxy along. A proxy that misses the body's bounding ball costs no evaluation:
/// otherwise twenty moving bodies would use up the budget.
fn met(
    sampler: &mut Sampler<'_>,
    body: &Body,
    [before, point]: [Point<3>; 2],
) -> Option<Point<3>> {
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
            // A body that touches the proxy and moves away does not push it.
            return (way.dot(gradient) < 0.0).then_some(taken);
        }
        gone += free;
    }
    None
}
