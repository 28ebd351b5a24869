// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

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

/// The least part of the available way that is pushed.
const LEAST_PUSHED: f64 = 0.2;

/// By how much that part varies, so that strokes meet encoder steps at different places.
const PUSHED_RANGE: f64 = 0.25;

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
        let push = available * (LEAST_PUSHED + PUSHED_RANGE * self.next_part());
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
