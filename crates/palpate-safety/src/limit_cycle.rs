// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Limit cycles: a wall that oscillates by itself is made softer.
//!
//! What a device renders stably is computed from its profile. A device with less damping or
//! friction, with coarser encoders, or with a delay between reading and force oscillates against
//! walls that its profile allows. The observer of energy cannot see all of that: a delayed force
//! does other work than it counts.

use std::f64::consts::TAU;

use crate::effect::Effect;
use crate::passivity::{InnerProduct, PassivityOptions};

// Which motions are counted, and when they make a limit cycle.

/// Half cycles that are kept; so many make a limit cycle if they do not decay. The way of a half cycle is
/// the distance between its two extremes, along the force.
const KEPT: usize = 8;

/// An oscillation decays if its way shrinks to this part of the longest that is kept.
const DECAYED: f64 = 0.7;

/// So many half cycles make a limit cycle if both of its sides grow by [`GROWN`].
const GROWING: usize = 6;

/// The least growth within two half cycles that counts.
const GROWN: f64 = 1.2;

/// Half cycles up to this duration count as quick on every device [s]: few hands go to and fro six
/// times a second.
const QUICK: f64 = 0.08;

/// Half cycles are quick up to this duration at most [s].
const LONGEST_QUICK: f64 = 0.16;

/// Longer half cycles do not count at all [s].
const LONGEST: f64 = 0.2;

/// A mass of the hand that moves with the device [kg].
const HAND: f64 = 0.1;

/// Smallest peak-to-peak position amplitude that counts as felt [m].
const FELT_WAY: f64 = 5e-5;

/// Smallest peak-to-peak force amplitude that counts as felt [N].
const FELT_FORCE: f64 = 0.15;

/// Readings of a device at rest may go to and fro by so many encoder steps.
const STEPS: f64 = 3.0;

/// How much the change of the force between two extremes may differ from that of the spring, as a
/// part of it: beyond, a body moves, and not the hand alone.
const FORCED: f64 = 0.3;

/// The way of the device over its way along the force, at most, unless the force keeps its
/// direction: a hand that travels along a body meets its relief.
const ALONG: f64 = 1.25;

/// The cosine of the largest angle by which a force turns that keeps its direction.
const FLAT: f64 = 0.995;

// How soft a wall becomes, and when its stiffness comes back.

/// A wall that is stable with this part of the device's damping, and with a delay of so many ticks,
/// makes no limit cycle.
const WEAK: f64 = 0.1;
const DELAY: f64 = 2.0;

/// The part of the stiffness that remains after a limit cycle.
const HALVED: f64 = 0.5;

/// How often the stiffness is halved at most, and the least part of it that remains.
const HALVINGS: usize = 5;
const LEAST: f64 = 1.0 / 32.0;

/// The most by which a force changes in a tick because its wall becomes softer [N].
const STEP: f64 = 0.3;

/// How fast the force of a wall comes back to a hand that trembles [N/s].
const RETURN: f64 = 20.0;

/// The time in which the stiffness comes back by a factor of e [s].
const RECOVERY: f64 = 20.0;

/// A hand is calm in a guide if no quick half cycle ended for so long [s].
const CALM: f64 = 1.0;

// Whether the hand drives the oscillation, and how long that is believed.

/// A hand drives an oscillation that keeps its frequency while the stiffness is halved so many times.
const UNMOVED_HALVINGS: usize = 2;

/// It is told after so many halvings at the earliest.
const TOLD_HALVINGS: usize = 3;

/// A damping of half of the weakest hand that the stage is made for [N·s/m].
const HAND_DAMPING: f64 = 0.5;

/// A frequency is kept if the shorter of two times is at least this part of the longer, and the way of
/// the softer wall is at least [`KEPT_WAY`] of the other.
const KEPT_TIME: f64 = 0.75;
const KEPT_WAY: f64 = 0.5;

/// Half cycles up to so many times the hand's way are then ignored, for [`HAND_TIME`] at first and twice as
/// long each time, up to [`LONGEST_HAND_TIME`] [s].
const HAND_MARGIN: f64 = 1.5;
const HAND_TIME: f64 = 10.0;
const LONGEST_HAND_TIME: f64 = 160.0;

/// Options of the stage.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LimitCycleOptions {
    pub(crate) is_on: bool,
    /// The stiffness at the device [N/m].
    pub(crate) stiffness: f64,
    /// The mass of the device [kg].
    pub(crate) mass: f64,
    /// Its least damping [N·s/m].
    pub(crate) damping: f64,
    /// The encoder step [m].
    pub(crate) encoder_step: f64,
    /// The duration of a tick [s].
    pub(crate) period: f64,
}

impl LimitCycleOptions {
    /// For the device and the wall of the passivity stage, with an encoder step [m].
    pub(crate) fn of(passivity: &PassivityOptions, encoder_step: f64) -> Self {
        let PassivityOptions { is_on, stiffness, mass, damping, period, .. } = *passivity;
        Self { is_on, stiffness, mass, damping, encoder_step, period }
    }

    /// Whether a wall is so soft that it cannot oscillate in a hand of this damping [N·s/m]: `b > K
    /// (T/2 + the delay)`, with the delay and the part of the device's damping for which the stage is
    /// made.
    fn is_soft(&self, stiffness: f64, of_hand: f64) -> bool {
        WEAK * self.damping + of_hand > stiffness * self.period * (0.5 + DELAY)
    }
}

/// The wanted force in parts, by its cause [N].
#[derive(Clone, Copy, Debug)]
pub(crate) struct ForcesOf<V> {
    /// The force of bodies.
    pub(crate) bodies: V,
    /// The force of guides and magnets.
    pub(crate) guides: V,
}

/// What the stage sees in a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CycleInput<V> {
    pub(crate) position: V,
    /// The force of bodies and guides, as far as the force limit lets it pass [N].
    pub(crate) force: V,
    /// The size of that force before the force limit [N].
    pub(crate) effort: f64,
    /// Whether guides give a part of the force: their stiffness is not known here.
    pub(crate) is_guided: bool,
    /// Whether they give all of it.
    pub(crate) is_free_of_bodies: bool,
    /// The stiffness of the bodies that are touched, at the device [N/m].
    pub(crate) stiffness: f64,
    /// Whether the force was zeroed, by late ticks, or rises after it was: an oscillation then has
    /// causes that pass.
    pub(crate) is_disturbed: bool,
}

impl<V: InnerProduct> CycleInput<V> {
    /// The input of forces by bodies of this `stiffness` [N/m], which were of size `effort` before the
    /// force limit [N], and by guides.
    pub(crate) fn of(
        ForcesOf { bodies, guides }: ForcesOf<V>,
        effort: f64,
        position: V,
        stiffness: f64,
    ) -> Self {
        let is_guided = guides != V::ZERO;
        let force = if is_guided { bodies + guides } else { bodies };
        let effort = if is_guided { force.norm() } else { effort };
        let is_free_of_bodies = bodies == V::ZERO;
        Self {
            position,
            force,
            effort,
            is_guided,
            is_free_of_bodies,
            stiffness,
            is_disturbed: false,
        }
    }

    /// This input in a tick that is disturbed or not.
    pub(crate) fn disturbed(self, is_disturbed: bool) -> Self {
        Self { is_disturbed, ..self }
    }
}

/// Limit cycles that were found, and what was done about them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct LimitCycleReport {
    /// Ticks in which a force was made softer, and the largest change.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub effect: Effect,
    /// Limit cycles that were detected; each one halves the stiffness.
    pub found: u64,
    /// The least rendered stiffness over the accepted stiffness.
    pub least_part: f64,
}

impl Default for LimitCycleReport {
    fn default() -> Self {
        Self { effect: Effect::default(), found: 0, least_part: 1.0 }
    }
}

/// A motion from one extreme to the next.
#[derive(Clone, Copy, Debug)]
struct HalfCycle {
    /// Its way [m].
    way: f64,
    /// Its time [s].
    time: f64,
}

impl HalfCycle {
    const UNKNOWN: Self = Self { way: 0.0, time: 0.0 };
}

/// An extreme of the motion along the force.
#[derive(Clone, Copy, Debug)]
struct Extreme<V> {
    /// The position of the device [m].
    position: V,
    /// The place along the force, into the body [m].
    place: f64,
    /// The size of the force there [N].
    effort: f64,
    /// The time since the extreme before [s].
    time: f64,
}

/// Finds oscillations of the device against the force, and makes the force softer until they end.
///
/// The motion along the force is parted at its extremes into half cycles: ways of at least 50 µm,
/// or of 0.15 N in the force if that is less, and of three encoder steps. A half cycle counts if
///
/// - it takes at most 0.2 s;
/// - the device moves along the force, or the force keeps its direction: otherwise the relief of the
///   body would move it;
/// - and the force changes as the spring explains, so that no body moves the hand, and the wall is
///   not so soft that a tenth of the device's damping is enough for it, through a delay of two ticks.
///
/// It is quick within 80 ms, or `2π √(M/K)` up to 160 ms with the mass `M` of device and hand and
/// the stiffness `K`: the natural half cycle of a bouncing mass is longer than that of one in
/// contact, `π √(M/K)`. There is a limit cycle if
///
/// - six quick half cycles grow, both sides by 1.2 a cycle;
/// - or the last of eight quick half cycles is at least 0.7 of the longest;
/// - or eight half cycles grow, each cycle a little.
///
/// The stiffness is then halved, at the rate of 0.3 N a tick, and half cycles are counted anew. It
/// comes back by a factor of e in 20 s in which nothing pushes, or in which a hand in a guide makes
/// no quick half cycles; not in contact with a body, where the oscillation would return. Late ticks that
/// zero the force, and its rise, start the count anew.
///
/// The tremor of a hand, 6 to 12 times a second, looks like a limit cycle. But an oscillation of the
/// device gets slower in a softer wall, or ends. One that keeps its frequency in a quarter of the
/// stiffness without a bounce, or goes on in a wall too soft to oscillate, is the hand's. Then the
/// stiffness comes back, and half cycles of that size are ignored for a while.
///
/// It is blind to oscillations that turn the force and not its size, such as circles about a point,
/// and to those across the force, such as from wall to wall of a groove.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LimitCycle<V> {
    options: LimitCycleOptions,
    /// The position of the last tick, unless it was not finite.
    last_position: Option<V>,
    /// The direction of the last force that was not zero.
    direction: V,
    /// 1 on the way into the body, −1 on the way out.
    heading: f64,
    /// The place along the force, into the body [m].
    place: f64,
    /// The extreme from which the present way came.
    last: Extreme<V>,
    /// The farthest place on the present way.
    farthest: Extreme<V>,
    /// The time since the farthest place [s].
    since: f64,
    /// The ways and the times of the last half cycles, the newest first [m, s].
    ways: [f64; KEPT],
    times: [f64; KEPT],
    /// How many of them count.
    counted: usize,
    /// How many of them are quick.
    quick: usize,
    /// How many of the last ones left the body at neither end.
    pressed: usize,
    /// The mean half cycle for which the stiffness was halved, by the number of halvings before; unknown
    /// also where the cycles left the body.
    seen: [HalfCycle; HALVINGS + 1],
    /// The direction of the force at the start of the present way, and the cosine of the largest angle
    /// to it since.
    start: V,
    bent: f64,
    /// Oscillations up to this amplitude are attributed to the hand [m].
    hand_way: f64,
    /// The time left in which they are ignored [s].
    hand_time: f64,
    /// The length of the next such period [s].
    next_hand_time: f64,
    /// The time since a quick half cycle [s].
    calm: f64,
    /// The part of the stiffness to come.
    target: f64,
    /// The part of the stiffness in this tick.
    part: f64,
    report: LimitCycleReport,
}

impl<V: InnerProduct> LimitCycle<V> {
    pub(crate) fn new(options: LimitCycleOptions) -> Self {
        let start = Extreme { position: V::ZERO, place: 0.0, effort: 0.0, time: 0.0 };
        Self {
            options,
            last_position: None,
            direction: V::ZERO,
            heading: 1.0,
            place: 0.0,
            last: start,
            farthest: start,
            since: 0.0,
            ways: [0.0; KEPT],
            times: [0.0; KEPT],
            counted: 0,
            quick: 0,
            pressed: 0,
            seen: [HalfCycle::UNKNOWN; HALVINGS + 1],
            start: V::ZERO,
            bent: 1.0,
            hand_way: 0.0,
            hand_time: 0.0,
            next_hand_time: HAND_TIME,
            calm: 0.0,
            target: 1.0,
            part: 1.0,
            report: LimitCycleReport::default(),
        }
    }

    /// Replaces the options, where an angle may count as another length than before.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn renew(&mut self, options: LimitCycleOptions) {
        self.options = options;
        self.lose();
    }

    /// The options.
    pub(crate) fn options(&self) -> &LimitCycleOptions {
        &self.options
    }

    /// Forgets the motion so far.
    fn lose(&mut self) {
        self.last_position = None;
        (self.counted, self.quick) = (0, 0);
    }

    /// As [`step`](Self::step); if an input is not finite, the motion so far is forgotten.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn observed(&mut self, input: &CycleInput<V>, is_sound: bool) -> f64 {
        if is_sound {
            return self.step(input);
        }
        self.lose();
        1.0
    }

    /// One tick: the part of the stiffness to render.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn step(&mut self, input: &CycleInput<V>) -> f64 {
        if !self.options.is_on {
            return 1.0;
        }
        self.follow(input);
        if input.is_disturbed {
            (self.counted, self.quick) = (0, 0);
        }
        if self.target == 1.0 && self.part == 1.0 {
            return 1.0;
        }
        self.soften(input)
    }

    #[cold]
    fn soften(&mut self, input: &CycleInput<V>) -> f64 {
        let (force, effort) = (input.force.norm(), input.effort);
        // A guide need not end anywhere, so that its stiffness comes back while a hand is in it.
        let is_calm = input.is_free_of_bodies && self.calm >= CALM;
        if force == 0.0 && effort == 0.0 || is_calm {
            self.target = (self.target * (1.0 + self.options.period / RECOVERY)).min(1.0);
        }
        if self.part <= self.target {
            let rise = if effort > 0.0 { RETURN * self.options.period / effort } else { 1.0 };
            self.part = (self.part + rise).min(self.target);
            return self.part;
        }
        // As long as the wall gives more than the force limit, less of it changes nothing.
        let free = if force < effort { force / effort } else { 1.0 };
        self.part = (self.part.min(free) - STEP / effort).max(self.target);
        let left = (self.part * effort).min(force);
        self.report.effect.count_size(force - left);
        self.report.least_part = self.report.least_part.min(self.part);
        self.part
    }

    /// Follows the motion along the force to its next extreme.
    fn follow(&mut self, input: &CycleInput<V>) {
        let size = input.force.norm();
        if size > 0.0 {
            self.direction = input.force * (1.0 / size);
            self.bent = self.bent.min(self.direction.dot(self.start));
        }
        let way = self.last_position.map_or(V::ZERO, |last| input.position - last);
        self.last_position = Some(input.position);
        self.place -= way.dot(self.direction);
        // Ticks are even on average, readings need not be.
        let period = self.options.period;
        self.since += period;
        self.calm += period;
        self.hand_time -= period;
        let beyond = self.heading * (self.place - self.farthest.place);
        let CycleInput { position, effort, .. } = *input;
        let here = Extreme { position, place: self.place, effort, time: self.since };
        if beyond > 0.0 {
            self.farthest = Extreme { time: self.farthest.time + self.since, ..here };
            self.since = 0.0;
        } else if -beyond >= self.least_way(input.stiffness) {
            self.turn(input);
            (self.start, self.bent) = (self.direction, 1.0);
            self.farthest = here;
            self.since = 0.0;
        }
    }

    /// The least way that counts as an oscillation [m].
    fn least_way(&self, stiffness: f64) -> f64 {
        FELT_WAY.min(FELT_FORCE / stiffness).max(STEPS * self.options.encoder_step)
    }

    /// Ends a half cycle at the farthest place.
    fn turn(&mut self, input: &CycleInput<V>) {
        let (from, to) = (self.last, self.farthest);
        let way = (to.place - from.place).abs();
        let stiffness = input.stiffness;
        let of_spring = stiffness * way;
        // A spring presses more where it is deeper.
        let change = (to.effort - from.effort) * self.heading;
        let is_touching = to.effort > 0.0 || from.effort > 0.0;
        // Outside of the body, the hand moves without a force.
        let is_always_touching = to.effort > 0.0 && from.effort > 0.0;
        let least = if is_always_touching { 1.0 - FORCED } else { 0.0 };
        let is_of_spring = (least * of_spring..=(1.0 + FORCED) * of_spring).contains(&change);
        let is_free = input.is_guided || is_of_spring && !self.options.is_soft(stiffness, 0.0);
        let is_straight = (to.position - from.position).norm() <= ALONG * way;
        let is_along = is_straight || self.bent >= FLAT;
        if is_free && is_touching && is_along && to.time <= LONGEST {
            let stiffness = if input.is_guided { self.options.stiffness } else { stiffness };
            self.pressed = if is_always_touching { self.pressed + 1 } else { 0 };
            self.count(way, to.time, stiffness);
        } else {
            (self.counted, self.quick) = (0, 0);
        }
        self.last = to;
        self.heading = -self.heading;
    }

    /// Counts a half cycle of a way [m] that took a time [s], in a wall of a stiffness [N/m].
    fn count(&mut self, way: f64, time: f64, stiffness: f64) {
        if self.hand_time > 0.0 && way <= self.hand_way {
            (self.counted, self.quick) = (0, 0);
            return;
        }
        self.ways.rotate_right(1);
        self.times.rotate_right(1);
        let [newest, ..] = &mut self.ways;
        *newest = way;
        let [newest, ..] = &mut self.times;
        *newest = time;
        self.counted = (self.counted + 1).min(KEPT);
        let natural = TAU * ((self.options.mass + HAND) / stiffness).sqrt();
        let is_quick = time <= natural.clamp(QUICK, LONGEST_QUICK);
        self.quick = if is_quick { (self.quick + 1).min(KEPT) } else { 0 };
        if is_quick {
            self.calm = 0.0;
        }
        if self.is_limit_cycle() {
            self.found(stiffness);
        }
    }

    /// Halves a stiffness, or gives it back to a hand that drives the oscillation.
    fn found(&mut self, stiffness: f64) {
        let mean = |of: &[f64; KEPT]| of.iter().sum::<f64>() / KEPT as f64;
        let now = HalfCycle { way: mean(&self.ways), time: mean(&self.times) };
        // What follows is the motion in another wall.
        (self.counted, self.quick) = (0, 0);
        if self.is_of_hand(now, stiffness) {
            let longest = self.ways.iter().copied().fold(0.0, f64::max);
            (self.hand_way, self.hand_time) = (HAND_MARGIN * longest, self.next_hand_time);
            self.next_hand_time = (2.0 * self.next_hand_time).min(LONGEST_HAND_TIME);
            self.target = 1.0;
        } else {
            self.target = (self.target * HALVED).max(LEAST);
            self.report.found += 1;
        }
    }

    /// Whether a hand drives half cycles like this mean one in a wall that had this stiffness before
    /// it was halved [N/m].
    fn is_of_hand(&mut self, now: HalfCycle, stiffness: f64) -> bool {
        let halvings = (-self.target.log2()).round() as usize;
        let (stiffer, softer) = self.seen.split_at_mut(halvings.min(HALVINGS));
        softer.fill(HalfCycle::UNKNOWN);
        // How often a mass bounces on a wall is hardly a matter of its stiffness.
        let is_pressed = self.pressed >= GROWING;
        if let [here, ..] = softer
            && is_pressed
        {
            *here = now;
        }
        let is_kept = |HalfCycle { way, time }: &HalfCycle| {
            let is_way_kept = *way > 0.0 && now.way >= KEPT_WAY * way;
            is_way_kept && time.min(now.time) >= KEPT_TIME * time.max(now.time)
        };
        let is_unmoved = stiffer.iter().rev().skip(UNMOVED_HALVINGS - 1).any(is_kept);
        let is_soft = self.options.is_soft(stiffness * self.target, HAND_DAMPING);
        halvings >= TOLD_HALVINGS && (is_soft || is_pressed && is_unmoved)
    }

    /// Whether the stiffness comes back in this tick, by what a hand was told from the wall.
    pub(crate) fn is_returning(&self) -> bool {
        self.target == 1.0 && self.part < 1.0
    }

    fn is_limit_cycle(&self) -> bool {
        let [a, b, c, d, e, f, g, h] = self.ways;
        let grows = |x: f64, y: f64, z: f64| x >= GROWN * y && y >= GROWN * z;
        let explodes = self.quick >= GROWING && grows(a, c, e) && grows(b, d, f);
        let longest = self.ways.iter().copied().fold(0.0, f64::max);
        let persists = self.quick >= KEPT && a >= DECAYED * longest;
        let [out, back] =
            [[a, c, e, g], [b, d, f, h]].map(|ways| ways.is_sorted_by(|x, y| x > y));
        explodes || persists || self.counted >= KEPT && out && back
    }

    pub(crate) fn report(&self) -> LimitCycleReport {
        self.report
    }
}

#[cfg(test)]
mod tests;
