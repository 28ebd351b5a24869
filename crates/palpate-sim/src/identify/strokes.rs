// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Strokes, and what is observed.
//!
//! The motions: breakaway, then strokes back and forth between two rests.
//!
//! A stroke pushes the handle over a part of its way, brakes it by a force against the motion
//! or lets it coast, and waits until it rests. The push ends while its work, which is known from
//! force and way and bounds the kinetic energy, still fits into what is left of the travel. A
//! guard then brakes a handle that comes near the end, by its velocity and the mass that the
//! push showed. Friction and damping only shorten the way.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use super::IdentifyError;
use super::port::{Port, Reading};
use super::report::EncoderStep;
use crate::motion::{Axis, Body, Load, Parts};

/// The part of the travel that strokes use; the rest is for what a brake's delay adds.
const USED: f64 = 0.85;

/// The time in which the force of a breakaway rises to the largest one [s]. A faster rise passes
/// the friction by more before the motion is seen.
const RAMP: f64 = 1.0;

/// The part of the travel after which a handle has broken away.
const BROKEN_AWAY: f64 = 0.025;

/// A handle rests if its readings stay for this time [s]. Within one encoder step Δ a mass m that
/// friction f_c stops moves for √(2 Δ m / f_c): 0.07 s for 2 kg, 0.15 N and 0.18 mm.
const REST: f64 = 0.1;

/// The longest that a stroke waits for a rest [s].
const LONGEST_WAIT: f64 = 4.0;

/// The longest push, and the longest brake [s]: strokes with forces near the friction are slow.
const LONGEST_PUSH: f64 = 0.25;

/// A brake ends at this part of the stroke's largest speed, so that it does not push the handle
/// back.
const SLOW: f64 = 0.15;

/// A push ends where a brake would need this part of the largest force.
const BRAKE_RESERVE: f64 = 0.8;

/// The part of the travel at whose ends a coasting handle is braked, as gently as it can be.
const GUARDED: f64 = 0.5;

/// A guard brakes as if only this part of what is left were there: the mass is known to a third.
const GUARD_RESERVE: f64 = 0.7;

/// The part of the travel within which a guarded handle stops.
const STOPPED: f64 = 0.85;

/// The forces above breakaway, over the largest ones.
const LEVELS: [f64; 5] = [0.08, 0.2, 0.4, 0.7, 1.0];

/// The forces of brakes, over those of the pushes; without a force, the handle coasts.
const BRAKES: [f64; 2] = [1.0, 0.0];

/// Strokes of each level and brake in a round: one each way.
const WAYS: usize = 2;

/// The least part of the available way that is pushed, and by how much it varies, so that strokes
/// meet encoder steps at different places.
const PUSHED: (f64, f64) = (0.2, 0.25);

/// Readings beyond those of the longest stroke, for ticks that round up.
const SPARE: usize = 16;

/// The fractional parts of multiples of the golden ratio spread evenly (Weyl 1916).
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The readings of a stroke, from one rest to the next. The force before the first reading is
/// zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Stroke {
    pub(super) readings: Vec<Reading>,
}

/// The forces that broke the handle away [N], or the torques [N·m], up and down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Breakaway {
    up: f64,
    down: f64,
}

impl Breakaway {
    /// Half the difference of both forces: the friction, or a little more.
    pub(super) fn friction(&self) -> f64 {
        0.5 * (self.up + self.down)
    }

    fn towards(&self, way: f64) -> f64 {
        if way > 0.0 { self.up } else { self.down }
    }
}

/// The motions of one axis.
pub(super) struct Motions<'p, 'a> {
    port: &'p mut Port<'a>,
    pub(super) strokes: Vec<Stroke>,
    breakaway: Breakaway,
    /// The largest force above breakaway.
    excess: f64,
    /// About the mass of the handle, for brakes [kg], or [kg·m²].
    mass: f64,
    /// The force of the brake that keeps the handle within its travel; zero if there is no need.
    guard: f64,
    /// The level of the strokes that showed the mass.
    strongest: f64,
    seed: u64,
}

impl<'p, 'a> Motions<'p, 'a> {
    /// Waits for a rest, and raises the force in each direction until the handle moves.
    pub(super) fn begin(port: &'p mut Port<'a>, seed: u64) -> Result<Self, IdentifyError> {
        let no_forces = Breakaway { up: 0.0, down: 0.0 };
        let mut motions = Self {
            port,
            strokes: Vec::new(),
            breakaway: no_forces,
            excess: 0.0,
            mass: 0.0,
            guard: 0.0,
            strongest: 0.0,
            seed,
        };
        motions.rest(&mut Stroke::default())?;
        // Away from the nearer end.
        let first = -motions.port.last().place.signum();
        for way in [first, -first] {
            let force = motions.break_away(way)?;
            if way > 0.0 {
                motions.breakaway.up = force;
            } else {
                motions.breakaway.down = force;
            }
        }
        let most = motions.port.bounds.force;
        motions.excess = most - motions.breakaway.up.max(motions.breakaway.down);
        // The first strokes are weak, so the speed of strong ones is known before.
        Ok(motions)
    }

    pub(super) fn breakaway(&self) -> Breakaway {
        self.breakaway
    }

    /// The time of the last reading [s].
    pub(super) fn time(&self) -> f64 {
        self.port.last().time
    }

    /// A round of strokes: every level with every brake, both ways.
    pub(super) fn round(&mut self) -> Result<(), IdentifyError> {
        for level in LEVELS {
            for brake in BRAKES {
                for _ in 0..WAYS {
                    self.stroke(level, brake)?;
                }
            }
        }
        Ok(())
    }

    fn break_away(&mut self, way: f64) -> Result<f64, IdentifyError> {
        let bounds = self.port.bounds;
        let start = self.port.last();
        loop {
            let time = self.port.last().time - start.time;
            let force = bounds.force * time / RAMP;
            if force > bounds.force {
                return Err(IdentifyError::Stuck {
                    axis: self.port.axis(),
                    force: bounds.force,
                });
            }
            let reading = self.port.tick(way * force)?;
            let moved = (reading.place - start.place).abs();
            if moved > BROKEN_AWAY * bounds.travel {
                // All work as kinetic energy: no less than the handle's mass.
                let speed = self.port.speed();
                self.mass = 2.0 * force * moved / (speed * speed);
                self.rest(&mut Stroke::default())?;
                return Ok(force);
            }
        }
    }

    fn stroke(&mut self, level: f64, brake: f64) -> Result<(), IdentifyError> {
        let bounds = self.port.bounds;
        let start = Reading { held: 0.0, ..self.port.last() };
        self.guard = 0.0;
        let way = if start.place > 0.0 { -1.0 } else { 1.0 };
        let force = self.breakaway.towards(way) + level * self.excess;
        let available = USED * bounds.travel - way * start.place;
        // Less than half of the way is pushed: a brake of the same force needs as much.
        let push = available * (PUSHED.0 + PUSHED.1 * self.next_part());
        let mut stroke = Stroke::default();
        // What is recorded allocates nothing during a stroke.
        let longest = 2.0 * LONGEST_PUSH + LONGEST_WAIT + REST;
        stroke.readings.reserve_exact((longest * self.port.rate()) as usize + SPARE);
        stroke.readings.push(start);
        let (mut work, mut fastest) = (0.0, 0.0_f64);
        loop {
            let before = self.port.last().place;
            let reading = self.port.tick(way * force)?;
            stroke.readings.push(reading);
            work += reading.held * (reading.place - before);
            let speed = way * self.port.speed();
            fastest = fastest.max(speed);
            let left = USED * bounds.travel - way * reading.place;
            let is_over = way * (reading.place - start.place) >= push
                || reading.time - start.time >= LONGEST_PUSH
                || speed >= bounds.speed
                || work >= BRAKE_RESERVE * bounds.force * left;
            if is_over {
                break;
            }
        }
        if level >= self.strongest {
            self.strongest = level;
            let (end, friction) = (self.port.last(), self.breakaway.friction());
            let (time, moved) = (end.time - start.time, way * (end.place - start.place));
            self.mass = 0.5 * (force - friction).max(0.0) * time * time / moved.max(0.0);
        }
        if brake > 0.0 {
            self.brake(&mut stroke, -way * brake * force, SLOW * fastest)?;
        }
        self.rest(&mut stroke)?;
        if fastest > bounds.speed {
            // The speed rises with the root of the force.
            let too_fast = fastest / bounds.speed;
            self.excess = self.excess.min(level * self.excess / (too_fast * too_fast));
        }
        self.strokes.push(stroke);
        self.port.progress.strokes += 1;
        Ok(())
    }

    /// Pushes against the motion until it is slower than `slow`.
    fn brake(
        &mut self,
        stroke: &mut Stroke,
        force: f64,
        slow: f64,
    ) -> Result<(), IdentifyError> {
        let start = self.port.last().time;
        loop {
            let guard = self.guard();
            let reading =
                self.port.tick(if guard.abs() > force.abs() { guard } else { force })?;
            stroke.readings.push(reading);
            let is_slow = -force.signum() * self.speed() <= slow;
            if is_slow || reading.time - start >= LONGEST_PUSH {
                return Ok(());
            }
        }
    }

    /// Waits until the readings stay, and brakes a handle that would leave its travel.
    fn rest(&mut self, stroke: &mut Stroke) -> Result<(), IdentifyError> {
        let start = self.port.last().time;
        let mut still = self.port.last();
        loop {
            let guard = self.guard();
            let reading = self.port.tick(guard)?;
            stroke.readings.push(reading);
            if reading.place != still.place {
                still = reading;
            }
            if reading.time - still.time >= REST {
                return Ok(());
            }
            let time = reading.time - start;
            if time > LONGEST_WAIT {
                return Err(IdentifyError::NeverRests { axis: self.port.axis(), time });
            }
        }
    }

    /// The velocity, from the mass if it is known.
    fn speed(&self) -> f64 {
        let is_known = self.mass > 0.0 && self.mass.is_finite();
        if is_known { self.port.speed_of(self.mass) } else { self.port.speed() }
    }

    /// The force that stops the handle within its travel, where it is near the end: it grows to
    /// what is needed, and acts until the handle turns around.
    fn guard(&mut self) -> f64 {
        let (bounds, speed) = (self.port.bounds, self.speed());
        let way = speed.signum();
        let left = STOPPED * bounds.travel - way * self.port.last().place;
        // Beyond the end as near to it.
        let left = left.max((1.0 - STOPPED) * bounds.travel);
        let needed = 0.5 * self.mass * speed * speed / left;
        let is_near = left < GUARDED * bounds.travel;
        let must_brake = is_near || needed >= BRAKE_RESERVE * bounds.force;
        let is_braking = self.guard * way < 0.0;
        if !is_braking {
            self.guard = 0.0;
        }
        if must_brake && needed.is_finite() {
            self.guard = -way * self.guard.abs().max(needed / GUARD_RESERVE);
        }
        self.guard
    }

    /// The next number from 0 to 1.
    fn next_part(&self) -> f64 {
        let count = self.strokes.len() as f64;
        // A seed shifts the sequence by a part of its own.
        let shift = (self.seed % 1_000_003) as f64 * std::f64::consts::SQRT_2;
        (count * GOLDEN + shift).fract()
    }
}

/// The places that readings tell of a stroke, from its first one.
///
/// A reading that differs from the one before says most: with one step between them, the handle
/// passed the edge between two steps within that tick, somewhere on a way `v T`. So the mean of
/// both readings is the mean of both places up to `v T / √12`, or `Δ / √12` where the handle
/// moves by more than a step a tick (quantisation as uniform noise: Widrow 1956). Readings that
/// stay say nothing more.
#[derive(Clone, Debug)]
pub(super) struct Observed {
    /// The stroke's ticks: duration [s], and the force held during it.
    ticks: Vec<(f64, f64)>,
    pub(super) places: Vec<Place>,
    /// The place of the first reading.
    start: f64,
}

/// A place that the handle had.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// The readings between which the handle was there.
    between: [usize; 2],
    /// The place, from the first reading.
    at: f64,
    /// One over its standard deviation.
    pub(super) weight: f64,
}

/// The part of the travel to which a reading without steps is trusted: the rounding of a driver in
/// single precision.
const FINEST: f64 = 1e-6;

/// The readings on both sides of a change over which its speed is measured.
const NEIGHBOURS: usize = 2;

impl Observed {
    pub(super) fn of(stroke: &Stroke, steps: EncoderStep, travel: f64, period: f64) -> Self {
        let readings = &stroke.readings;
        let places: Vec<_> = readings.iter().map(|reading| reading.place).collect();
        let start = places.first().copied().unwrap_or_default();
        let (step, finest) = (steps.size(), FINEST * travel);
        let last = places.len().saturating_sub(1);
        let at_rest = |i: usize| Place {
            between: [i, i],
            at: places[i] - start,
            weight: 1.0 / (step / TWELVE.sqrt()).max(finest),
        };
        let change = |i: usize| {
            let [before, after] = [places[i - 1], places[i]];
            let (first, final_) =
                (i.saturating_sub(1 + NEIGHBOURS), (i + NEIGHBOURS).min(last));
            let count = (final_ - first) as f64;
            let per_tick = (places[final_] - places[first]).abs() / count;
            // A handle that turns around has a way too.
            let way = per_tick.max(step / count).min(step);
            let deviation = (way / TWELVE.sqrt()).max(finest);
            Place {
                between: [i - 1, i],
                at: 0.5 * (before + after) - start,
                weight: 1.0 / deviation,
            }
        };
        let changes = (1..places.len()).filter(|i| places[*i] != places[*i - 1]).map(change);
        let ends = [0, last].into_iter().filter(|i| *i < places.len()).map(at_rest);
        let found = ends.chain(changes).collect();
        let ticks = readings.windows(2).map(|pair| {
            let duration = pair[1].time - pair[0].time;
            // Rounding of times apart, ticks have the same duration, whose responses are kept.
            let is_usual = (duration - period).abs() < SAME * period;
            (if is_usual { period } else { duration }, pair[1].held)
        });
        Self { ticks: ticks.collect(), places: found, start }
    }

    /// The misses of the model in standard deviations, added to `misses`; `false` if there is no
    /// such motion. The place where the handle was at first is known to a step, and fitted.
    pub(super) fn misses(&self, model: &Model, misses: &mut Vec<f64>) -> bool {
        let Some(mut body) = model.body() else { return false };
        let mut axis = Axis { position: 0.0, velocity: 0.0 };
        let mut way = Vec::with_capacity(self.ticks.len() + 1);
        way.push(0.0);
        for (duration, force) in &self.ticks {
            let load = Load {
                force: *force,
                push: model.offset,
                target: -self.start,
                target_velocity: 0.0,
            };
            body.displace(&mut axis, load, *duration);
            way.push(axis.position);
        }
        let first = misses.len();
        misses.extend(self.places.iter().map(|place| {
            let [before, after] = place.between;
            place.weight * (place.at - 0.5 * (way[before] + way[after]))
        }));
        self.shift(&mut misses[first..]);
        true
    }

    /// Takes away the shift of the whole stroke that makes the squares least.
    pub(super) fn shift(&self, misses: &mut [f64]) {
        let (mut sum, mut squares) = (0.0, 0.0);
        for (miss, place) in misses.iter().zip(&self.places) {
            sum += miss * place.weight;
            squares += place.weight * place.weight;
        }
        let shift = if squares > 0.0 { sum / squares } else { 0.0 };
        for (miss, place) in misses.iter_mut().zip(&self.places) {
            *miss -= shift * place.weight;
        }
    }
}

/// The variance of a uniform distribution over its squared width is one twelfth.
const TWELVE: f64 = 12.0;

/// The part of a period by which a tick's duration is rounding.
const SAME: f64 = 1e-6;

/// Number of parameters of a [`Model`].
pub(super) const PARAMETERS: usize = 5;

/// A mass with damping, friction, a constant force and a spring:
/// `m x'' + b x' + k x + f_c sign(x') = F + f_0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Model {
    pub(super) mass: f64,
    pub(super) damping: f64,
    pub(super) friction: f64,
    pub(super) offset: f64,
    pub(super) stiffness: f64,
}

impl Model {
    /// The numbers that are fitted. The mass is positive: its logarithm is.
    pub(super) fn parameters(&self) -> [f64; PARAMETERS] {
        [libm::log(self.mass), self.damping, self.friction, self.offset, self.stiffness]
    }

    pub(super) fn of_parameters(parameters: [f64; PARAMETERS]) -> Self {
        let [mass, damping, friction, offset, stiffness] = parameters;
        Self { mass: libm::exp(mass), damping, friction, offset, stiffness }
    }

    fn body(&self) -> Option<Body> {
        Body::new(&Parts {
            device_mass: self.mass,
            hand_mass: 0.0,
            damping: self.damping,
            friction: self.friction,
            grip_stiffness: self.stiffness,
            grip_damping: 0.0,
        })
        .ok()
    }
}
