// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! One axis: rounds of strokes until its numbers are known.

use super::IdentifyError;
use super::fit::{Fit, Start, fit, steps};
use super::observed::{Model, Observed};
use super::options::Bounds;
use super::port::Port;
use super::report::{EncoderStep, Estimate, IdentifiedAxis};
use super::strokes::{Breakaway, Motions, Stroke};

/// The least and the most rounds of strokes, of which the most are for an axis whose numbers stay
/// uncertain.
const ROUNDS: (usize, usize) = (1, 12);

/// A number whose error is at most this part of it needs no further round.
const ENOUGH: f64 = 0.03;

/// A spring is one if its stiffness exceeds its standard deviation by this factor.
const SURE: f64 = 5.0;

/// A spring counts if it pulls at the end of the travel by this part of the friction: a hand that
/// is softer is not told from cables and unbalanced weight.
const FELT: f64 = 0.2;

/// The largest misfit of a device that moves as a mass with damping and friction.
const MOST_MISFIT: f64 = 5.0;

/// Two standard deviations are an error.
const DEVIATIONS: f64 = 2.0;

/// A first guess of the damping over the mass [1/s], as of most devices; the fit finds it from
/// anywhere.
const DECAY: f64 = 5.0;

/// Moves an axis until its numbers are known, or stay unknown.
pub(super) fn identify_axis(
    port: &mut Port<'_>,
    seed: u64,
) -> Result<IdentifiedAxis, IdentifyError> {
    let (axis, bounds, period) = (port.axis(), port.bounds, 1.0 / port.rate());
    let (start, tilt) = (port.last().time, port.tilt);
    let mut motions = Motions::begin(port, seed)?;
    let mut round = 0;
    loop {
        motions.round()?;
        round += 1;
        let step = steps(&motions.strokes, bounds.travel);
        let observe = |stroke| Observed::of(stroke, step, bounds.travel, period);
        let observed: Vec<_> = motions.strokes.iter().map(observe).collect();
        let guess = guess(&motions.strokes, motions.breakaway(), &bounds);
        let sprung = fit(&observed, Start { usual: &guess, guess: &guess }, true);
        let softest_spring = sprung.as_ref().map(|sprung| {
            let felt = FELT * sprung.model.friction / bounds.travel;
            felt.max(SURE * sprung.deviations.stiffness)
        });
        if let (Some(sprung), Some(softest)) = (&sprung, softest_spring) {
            let stiffness = sprung.model.stiffness;
            if stiffness > softest {
                return Err(IdentifyError::Held { axis, stiffness });
            }
        }
        let near = sprung.map_or(guess, |fit| Model { stiffness: 0.0, ..fit.model });
        // A fit may end at a friction or a damping of zero, which is no size for the steps of the next.
        let plain = fit(&observed, Start { usual: &guess, guess: &near }, false);
        let (limit, none) = (MOST_MISFIT, f64::INFINITY);
        let misfit = plain.as_ref().map_or(none, |fit| fit.misfit);
        let Some(fit) = plain.filter(|fit| fit.misfit <= MOST_MISFIT) else {
            return Err(IdentifyError::Misfit { axis, misfit, limit });
        };
        let found = IdentifiedAxis {
            encoder_step: step,
            softest_spring,
            strokes: motions.strokes.len() as u64,
            time: motions.time() - start,
            ..described(axis, &fit, tilt)
        };
        let is_known = [found.mass, found.damping, found.friction]
            .iter()
            .all(|number| number.error <= ENOUGH * number.value);
        if round >= ROUNDS.0 && is_known || round >= ROUNDS.1 {
            return Ok(found);
        }
    }
}

/// A first guess: the friction of the breakaway, and the mass that the last push accelerated.
fn guess(strokes: &[Stroke], breakaway: Breakaway, bounds: &Bounds) -> Model {
    let friction = breakaway.friction();
    let fallback = bounds.force * bounds.travel / (bounds.speed * bounds.speed);
    let mut pushed = strokes.iter().rev().filter_map(|stroke| {
        let mut readings = stroke.readings.iter();
        let start = readings.next()?;
        let way = (stroke.readings.get(1)?.held).signum();
        // A force rises and falls within its rate: most of the push has the largest.
        let (mut end, mut most) = (start, 0.0_f64);
        for reading in readings.take_while(|reading| way * reading.held > 0.0) {
            most = most.max(way * reading.held);
            end = reading;
        }
        let (moved, time) = (way * (end.place - start.place), end.time - start.time);
        let force = most - friction;
        (moved > 0.0 && force > 0.0).then(|| 0.5 * force * time * time / moved)
    });
    let mass = pushed.next().unwrap_or(fallback);
    Model {
        mass,
        damping: DECAY * mass,
        friction,
        offset: 0.0,
        stiffness: friction / bounds.travel,
    }
}

/// The numbers of a fit. Angles are components of a rotation vector, whose rate about one axis is
/// the angular velocity but for a part of `tilt`²/12, where `tilt` is the angle about the others
/// (Bullo and Murray 1995): mass and damping count that much less sure, and as much again, since
/// the angle about the axis itself grows too.
fn described(axis: super::DeviceAxis, fit: &Fit, tilt: f64) -> IdentifiedAxis {
    let bias = match axis {
        super::DeviceAxis::Along(_) => 0.0,
        super::DeviceAxis::About(_) => tilt * tilt / 6.0,
    };
    let (model, deviations) = (&fit.model, &fit.deviations);
    let estimate =
        |value: f64, deviation: f64| Estimate { value, error: DEVIATIONS * deviation };
    let turned = |value: f64, deviation: f64| Estimate {
        value,
        error: DEVIATIONS * deviation + bias * value.abs(),
    };
    IdentifiedAxis {
        axis,
        mass: turned(model.mass, model.mass * deviations.mass),
        damping: turned(model.damping, deviations.damping),
        friction: estimate(model.friction, deviations.friction),
        encoder_step: EncoderStep::Unseen(0.0),
        offset: estimate(model.offset, deviations.offset),
        softest_spring: None,
        misfit: fit.misfit,
        strokes: 0,
        time: 0.0,
    }
}
