// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The motions: breakaway, then strokes back and forth between two rests.
//!
//! A stroke pushes the handle over a part of its way, brakes it by a force against the motion
//! or lets it coast, and waits until it rests. It ends within the travel whatever the mass: the
//! work that the push did is known from force and way, and the brake begins where that work
//! just fits into what is left of the travel. Friction and damping only shorten the way.

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
const LONGEST_WAIT: f64 = 2.0;

/// The longest push, and the longest brake [s]: strokes with forces near the friction are slow.
const LONGEST_PUSH: f64 = 0.25;

/// A brake ends at this part of the stroke's largest speed; friction does the rest.
const SLOW: f64 = 0.1;

/// A brake begins where this part of the work fits into what is left, for the ticks until it
/// acts.
const BRAKE_RESERVE: f64 = 0.8;

/// The forces above breakaway, over the largest ones.
const LEVELS: [f64; 5] = [0.08, 0.2, 0.4, 0.7, 1.0];

/// The forces of brakes, over those of the pushes; without a force, the handle coasts.
const BRAKES: [f64; 2] = [1.0, 0.0];

/// Strokes of each level and brake in a round: one each way.
const WAYS: usize = 2;

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
pub(super) struct Motions<'p, 'a, const D: usize> {
    port: &'p mut Port<'a, D>,
    pub(super) strokes: Vec<Stroke>,
    breakaway: Breakaway,
    /// The largest force above breakaway.
    excess: f64,
    seed: u64,
}

impl<'p, 'a, const D: usize> Motions<'p, 'a, D> {
    /// Waits for a rest, and raises the force in each direction until the handle moves.
    pub(super) fn begin(port: &'p mut Port<'a, D>, seed: u64) -> Result<Self, IdentifyError> {
        let no_forces = Breakaway { up: 0.0, down: 0.0 };
        let mut motions =
            Self { port, strokes: Vec::new(), breakaway: no_forces, excess: 0.0, seed };
        motions.rest(None, None)?;
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
                return Err(IdentifyError::Stuck { axis: self.port.axis(), force: bounds.force });
            }
            let reading = self.port.tick(way * force)?;
            if (reading.place - start.place).abs() > BROKEN_AWAY * bounds.travel {
                let work = force * (reading.place - start.place).abs();
                self.coast(None, Moving { way, work, brake: bounds.force })?;
                return Ok(force);
            }
        }
    }

    fn stroke(&mut self, level: f64, brake: f64) -> Result<(), IdentifyError> {
        let bounds = self.port.bounds;
        let place = self.port.last().place;
        let way = if place > 0.0 { -1.0 } else { 1.0 };
        let force = self.breakaway.towards(way) + level * self.excess;
        let available = USED * bounds.travel - way * place;
        let part = self.next_part();
        // Half of the way is pushed, if a brake of the same force follows.
        let push = available * (0.25 + 0.35 * part) * if brake > 0.0 { 1.0 } else { 0.7 };
        let mut stroke = Stroke::default();
        let longest = 2.0 * LONGEST_PUSH + LONGEST_WAIT + REST;
        // What is recorded allocates nothing during a stroke.
        stroke.readings.reserve_exact((longest * self.port.rate()) as usize + 16);
        let start = Reading { held: 0.0, ..self.port.last() };
        stroke.readings.push(start);
        let mut moving = Moving { way, work: 0.0, brake: bounds.force };
        let mut fastest = 0.0_f64;
        loop {
            let before = self.port.last().place;
            let reading = self.port.tick(way * force)?;
            stroke.readings.push(reading);
            moving.add(before, &reading);
            let speed = way * self.port.speed();
            fastest = fastest.max(speed);
            let is_over = way * (reading.place - start.place) >= push
                || reading.time - start.time >= LONGEST_PUSH
                || speed >= bounds.speed
                || self.must_brake(&moving);
            if is_over {
                break;
            }
        }
        if brake > 0.0 {
            self.brake(&mut stroke, &mut moving, brake * force, SLOW * fastest)?;
        }
        self.coast(Some(&mut stroke), moving)?;
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
        moving: &mut Moving,
        force: f64,
        slow: f64,
    ) -> Result<(), IdentifyError> {
        let start = self.port.last().time;
        loop {
            let before = self.port.last().place;
            let reading = self.port.tick(-moving.way * force)?;
            stroke.readings.push(reading);
            moving.add(before, &reading);
            let is_slow = moving.way * self.port.speed() <= slow;
            if is_slow || reading.time - start >= LONGEST_PUSH {
                return Ok(());
            }
        }
    }

    /// Lets the handle come to rest, and brakes only where it would leave its travel.
    fn coast(
        &mut self,
        mut stroke: Option<&mut Stroke>,
        mut moving: Moving,
    ) -> Result<(), IdentifyError> {
        if self.must_brake(&moving) {
            let mut unrecorded = Stroke::default();
            let into = stroke.as_deref_mut().unwrap_or(&mut unrecorded);
            let force = moving.brake;
            self.brake(into, &mut moving, force, 0.0)?;
        }
        self.rest(stroke, Some(moving))
    }

    /// Waits without a force until the readings stay.
    fn rest(
        &mut self,
        mut stroke: Option<&mut Stroke>,
        mut moving: Option<Moving>,
    ) -> Result<(), IdentifyError> {
        let start = self.port.last().time;
        let mut still = self.port.last();
        loop {
            let before = self.port.last().place;
            let reading = self.port.tick(0.0)?;
            if let Some(stroke) = stroke.as_deref_mut() {
                stroke.readings.push(reading);
            }
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
            let Some(mut now) = moving else { continue };
            now.add(before, &reading);
            moving = Some(now);
            if self.must_brake(&now) && now.way * self.port.speed() > 0.0 {
                let mut unrecorded = Stroke::default();
                let into = stroke.as_deref_mut().unwrap_or(&mut unrecorded);
                let force = now.brake;
                self.brake(into, &mut now, force, 0.0)?;
                moving = None;
            }
        }
    }

    /// `true` where the brake must begin.
    fn must_brake(&self, moving: &Moving) -> bool {
        let left = USED * self.port.bounds.travel - moving.way * self.port.last().place;
        moving.work >= BRAKE_RESERVE * moving.brake * left
    }

    /// The next number from 0 to 1.
    fn next_part(&self) -> f64 {
        let count = self.strokes.len() as f64;
        // A seed shifts the sequence by a part of its own.
        let shift = (self.seed % 1_000_003) as f64 * std::f64::consts::SQRT_2;
        (count * GOLDEN + shift).fract()
    }
}

/// A handle that was pushed.
#[derive(Clone, Copy, Debug)]
struct Moving {
    /// The direction, 1 or −1.
    way: f64,
    /// The work of the forces so far [J]: at least the kinetic energy.
    work: f64,
    /// The force of the brake that keeps it within its travel.
    brake: f64,
}

impl Moving {
    fn add(&mut self, before: f64, reading: &Reading) {
        self.work += reading.held * (reading.place - before);
    }
}
