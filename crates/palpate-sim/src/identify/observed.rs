// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What readings say about where the handle was, and the motion that a model predicts.

use crate::motion::{Axis, Body, Load, Parts};

use super::report::EncoderStep;
use super::strokes::Stroke;

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
