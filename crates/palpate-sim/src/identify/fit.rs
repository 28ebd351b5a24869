// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The fit of a model to strokes.
//!
//! The model whose motion fits the readings best.
//!
//! An output-error method (Ljung 1999, section 7.2; Gautier, Janot and Vandanjon 2013 for
//! robots): the motion under the recorded forces is computed in closed form, and the sum of its
//! squared misses is made least by the method of Levenberg (1944) and Marquardt (1963). No
//! reading is differentiated, so encoder steps add noise and no bias of the regressors.
//!
//! The encoder step, from readings alone.
//!
//! Readings of an encoder with the step Δ lie in whole steps, so Δ divides their differences:
//! it is their greatest common divisor, by Euclid's algorithm with a tolerance for rounding.

use super::observed::{Model, Observed, PARAMETERS};
use super::report::{EncoderStep, IdentifiedAxis};
use super::strokes::Stroke;

/// Parameters whose least value is zero.
const NOT_NEGATIVE: [bool; PARAMETERS] = [false, true, true, false, true];

/// Steps of the method at most; a dozen suffice from a start within a factor of a few.
const MOST_STEPS: usize = 60;

/// The method ends when a step makes the sum of squares less by less than this part.
const SETTLED: f64 = 1e-6;

/// The first damping of the method.
const FIRST_DAMPING: f64 = 1e-3;

/// The largest damping of the method.
const LARGEST_DAMPING: f64 = 1e12;

/// A fitted model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fit {
    pub(super) model: Model,
    /// The standard deviation of each parameter.
    pub(super) deviations: Model,
    /// The root mean square of the misses over their standard deviations.
    pub(super) misfit: f64,
    sum: f64,
}

/// What one evaluation finds: misses and their derivatives, by strokes.
struct Linear {
    misses: Vec<f64>,
    /// Negative derivatives of the misses.
    slopes: [Vec<f64>; PARAMETERS],
}

/// Where a fit starts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start<'a> {
    /// A model with the sizes of the numbers, none of which is zero.
    pub(super) usual: &'a Model,
    /// The model about which the starts are.
    pub(super) guess: &'a Model,
}

/// Fits a model to strokes, from starts about the guess, the best first, until one fits.
pub(super) fn fit(
    observed: &[Observed],
    Start { usual, guess }: Start<'_>,
    has_spring: bool,
) -> Option<Fit> {
    let free = [true, true, true, true, has_spring];
    let scales = scales(usual);
    let mut starts: Vec<(f64, Model)> = starts(guess, has_spring)
        .filter_map(|model| Some((squares(&misses(observed, &model)?), model)))
        .collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best: Option<Fit> = None;
    for (_, start) in starts.iter().take(MOST_STARTS) {
        let found = descend(observed, start, free, scales);
        best = [best, found].into_iter().flatten().min_by(|a, b| a.sum.total_cmp(&b.sum));
        if best.is_some_and(|best| best.misfit <= IdentifiedAxis::GOOD_MISFIT) {
            break;
        }
    }
    best
}

/// Starts that are tried at most.
const MOST_STARTS: usize = 5;

/// Starts with other masses, and with springs.
fn starts(guess: &Model, has_spring: bool) -> impl Iterator<Item = Model> {
    let springs = if has_spring { [0.0, 1.0, 10.0].as_slice() } else { &[0.0] };
    let guess = *guess;
    springs.iter().flat_map(move |spring| {
        [0.1, 0.3, 1.0, 3.0, 10.0].into_iter().map(move |factor| Model {
            mass: guess.mass * factor,
            stiffness: guess.stiffness * spring,
            ..guess
        })
    })
}

/// Changes of the parameters that are felt: steps of derivatives are small parts of them.
fn scales(usual: &Model) -> [f64; PARAMETERS] {
    [1.0, usual.damping, usual.friction, usual.friction, usual.stiffness]
}

/// The part of a scale by which a derivative is taken.
const STEP: f64 = 1e-4;

fn misses(observed: &[Observed], model: &Model) -> Option<Vec<f64>> {
    let mut misses = Vec::new();
    observed.iter().all(|stroke| stroke.misses(model, &mut misses)).then_some(misses)
}

fn squares(misses: &[f64]) -> f64 {
    misses.iter().map(|miss| miss * miss).sum()
}

fn linear(
    observed: &[Observed],
    model: &Model,
    free: [bool; PARAMETERS],
    scales: [f64; PARAMETERS],
) -> Option<Linear> {
    let at = misses(observed, model)?;
    let mut slopes = [const { Vec::new() }; PARAMETERS];
    for (i, slope) in slopes.iter_mut().enumerate().filter(|(i, _)| free[*i]) {
        let mut parameters = model.parameters();
        let step = STEP * scales[i];
        parameters[i] += step;
        let beside = misses(observed, &Model::of_parameters(parameters))?;
        *slope = at.iter().zip(&beside).map(|(at, beside)| (at - beside) / step).collect();
    }
    Some(Linear { misses: at, slopes })
}

type Matrix = [[f64; PARAMETERS]; PARAMETERS];

fn descend(
    observed: &[Observed],
    start: &Model,
    free: [bool; PARAMETERS],
    scales: [f64; PARAMETERS],
) -> Option<Fit> {
    let mut model = *start;
    let mut damping = FIRST_DAMPING;
    let mut at = linear(observed, &model, free, scales)?;
    let mut sum = squares(&at.misses);
    for _ in 0..MOST_STEPS {
        let (normal, right) = normal_equations(&at);
        let mut is_better = false;
        while damping < LARGEST_DAMPING && !is_better {
            let next = step(&model, &normal, &right, Step { free, damping });
            let tried = next.and_then(|next| Some((squares(&misses(observed, &next)?), next)));
            match tried {
                Some((less, next)) if less < sum => {
                    let gain = sum - less;
                    (model, is_better) = (next, true);
                    damping = (damping * 0.1).max(1e-12);
                    let is_settled = gain < SETTLED * sum;
                    sum = less;
                    if is_settled {
                        damping = LARGEST_DAMPING;
                    }
                }
                _ => damping *= 10.0,
            }
        }
        at = linear(observed, &model, free, scales)?;
        if damping >= LARGEST_DAMPING {
            break;
        }
    }
    let count = at.misses.len().saturating_sub(observed.len() + PARAMETERS).max(1) as f64;
    let misfit = (sum / count).sqrt();
    let deviations = deviations(observed, &at, free, misfit)?;
    Some(Fit { model, deviations, misfit, sum })
}

/// `JᵀJ` and `Jᵀr`.
fn normal_equations(at: &Linear) -> (Matrix, [f64; PARAMETERS]) {
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum();
    let normal =
        std::array::from_fn(|i| std::array::from_fn(|j| product(&at.slopes[i], &at.slopes[j])));
    (normal, std::array::from_fn(|i| product(&at.slopes[i], &at.misses)))
}

/// How a step of the method is made.
#[derive(Clone, Copy, Debug)]
struct Step {
    /// The parameters that may move.
    free: [bool; PARAMETERS],
    damping: f64,
}

/// The model after a step of the method; parameters at their least value that would fall stay.
fn step(
    model: &Model,
    normal: &Matrix,
    right: &[f64; PARAMETERS],
    Step { free, damping }: Step,
) -> Option<Model> {
    let parameters = model.parameters();
    let moves: [bool; PARAMETERS] = std::array::from_fn(|i| {
        free[i] && !(NOT_NEGATIVE[i] && parameters[i] <= 0.0 && right[i] <= 0.0)
    });
    let mut damped = *normal;
    for (i, row) in damped.iter_mut().enumerate() {
        row[i] *= 1.0 + damping;
    }
    let [change] = solve(&damped, &[*right], moves)?;
    let next = std::array::from_fn(|i| {
        let next = parameters[i] + change[i];
        if NOT_NEGATIVE[i] { next.max(0.0) } else { next }
    });
    Some(Model::of_parameters(next))
}

/// Standard deviations: the larger of those that encoder steps explain, scaled by the misfit,
/// and those from how much single strokes disagree (the sandwich of Liang and Zeger 1986).
fn deviations(
    observed: &[Observed],
    at: &Linear,
    free: [bool; PARAMETERS],
    misfit: f64,
) -> Option<Model> {
    let (normal, _) = normal_equations(at);
    let identity: Matrix =
        std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }));
    let inverse: Matrix = solve(&normal, &identity, free)?;
    let mut spread = [[0.0; PARAMETERS]; PARAMETERS];
    let mut first = 0;
    for stroke in observed {
        let range = first..first + stroke.places.len();
        first = range.end;
        let pull: [f64; PARAMETERS] = std::array::from_fn(|i| {
            let slopes = at.slopes[i].get(range.clone()).unwrap_or_default();
            slopes.iter().zip(&at.misses[range.clone()]).map(|(slope, miss)| slope * miss).sum()
        });
        for (i, row) in spread.iter_mut().enumerate() {
            for (j, cell) in row.iter_mut().enumerate() {
                *cell += pull[i] * pull[j];
            }
        }
    }
    let deviation = |i: usize| {
        let row = &inverse[i];
        let mut squares = 0.0;
        for (j, a) in row.iter().enumerate() {
            for (k, b) in row.iter().enumerate() {
                squares += a * spread[j][k] * b;
            }
        }
        (row[i] * misfit.max(1.0).powi(2)).max(squares).max(0.0).sqrt()
    };
    let [mass, damping, friction, offset, stiffness] = std::array::from_fn(deviation);
    // That of the logarithm is a part of the mass.
    Some(Model { mass, damping, friction, offset, stiffness })
}

/// Solves `A x = r` for the rows of `right`, among the parameters in `free`, by the factors of
/// Cholesky; `None` if `A` is not positive definite. Scaled to a unit diagonal first, because
/// the parameters differ in unit.
fn solve<const N: usize>(
    matrix: &Matrix,
    right: &[[f64; PARAMETERS]; N],
    free: [bool; PARAMETERS],
) -> Option<[[f64; PARAMETERS]; N]> {
    let scale: [f64; PARAMETERS] =
        std::array::from_fn(|i| if free[i] { 1.0 / matrix[i][i].sqrt() } else { 0.0 });
    let mut lower = [[0.0; PARAMETERS]; PARAMETERS];
    for i in 0..PARAMETERS {
        for j in 0..=i {
            let scaled = if free[i] && free[j] {
                matrix[i][j] * scale[i] * scale[j]
            } else if i == j {
                1.0
            } else {
                0.0
            };
            let known: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            let rest = scaled - known;
            lower[i][j] = if i > j {
                rest / lower[j][j]
            } else if rest > SINGULAR {
                rest.sqrt()
            } else {
                return None;
            };
        }
    }
    Some(right.map(|right| {
        let mut x = [0.0; PARAMETERS];
        for i in 0..PARAMETERS {
            let known: f64 = (0..i).map(|k| lower[i][k] * x[k]).sum();
            x[i] = (right[i] * scale[i] - known) / lower[i][i];
        }
        for i in (0..PARAMETERS).rev() {
            let known: f64 = (i + 1..PARAMETERS).map(|k| lower[k][i] * x[k]).sum();
            x[i] = (x[i] - known) / lower[i][i];
        }
        std::array::from_fn(|i| x[i] * scale[i])
    }))
}

/// A pivot below this, over a unit diagonal, is rounding.
const SINGULAR: f64 = 1e-12;

/// The part of a step by which a multiple may miss: of rounding, not of other steps.
const MISS: f64 = 0.1;

/// The part of the travel below which a step is not told from rounding: a driver in single
/// precision rounds 0.1 m to 7 nm.
const LEAST: f64 = 1e-5;

/// The steps that the readings of strokes show, with the travel of the strokes.
pub(super) fn steps(strokes: &[Stroke], travel: f64) -> EncoderStep {
    let least = LEAST * travel;
    let differences = || {
        strokes.iter().flat_map(|stroke| {
            stroke.readings.windows(2).filter_map(move |pair| {
                let [before, after] = pair else { return None };
                let difference = (after.place - before.place).abs();
                (difference > least).then_some(difference)
            })
        })
    };
    let smallest = differences().fold(f64::INFINITY, f64::min);
    if smallest == f64::INFINITY {
        return EncoderStep::Unseen(least);
    }
    let divisor = differences().fold(smallest, |divisor, next| common(divisor, next, least));
    if divisor > least {
        // The least squares of all multiples, which averages their rounding.
        let (mut products, mut squares) = (0.0, 0.0);
        for difference in differences() {
            let count = (difference / divisor).round();
            products += count * difference;
            squares += count * count;
        }
        return EncoderStep::Even(products / squares);
    }
    let single = strokes.iter().flat_map(single_steps).fold(0.0, f64::max);
    if single > least { EncoderStep::Uneven(single) } else { EncoderStep::Unseen(least) }
}

/// The greatest common divisor; `least` or less if there is none.
fn common(divisor: f64, next: f64, least: f64) -> f64 {
    let (mut large, mut small) = (next, divisor);
    while small > least {
        let rest = (large - (large / small).round() * small).abs();
        if rest <= MISS * small {
            return small;
        }
        (large, small) = (small, rest);
    }
    small
}

/// The changes of readings between two that stayed: single steps of a slow motion.
fn single_steps(stroke: &Stroke) -> impl Iterator<Item = f64> {
    stroke.readings.windows(4).filter_map(|four| {
        let [a, b, c, d] = four else { return None };
        let is_single = a.place == b.place && b.place != c.place && c.place == d.place;
        is_single.then_some((c.place - b.place).abs())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn free_parameters_are_solved_and_the_others_stay() {
        // 4 x + 2 y = 10, 2 x + 3 y = 11: x = 1, y = 3, in units a million apart.
        let mut matrix = [[0.0; PARAMETERS]; PARAMETERS];
        matrix[1][1] = 4.0;
        matrix[1][3] = 2e6;
        matrix[3][1] = 2e6;
        matrix[3][3] = 3e12;
        let right = [7.0, 10.0, 7.0, 11e6, 7.0];
        let free = [false, true, false, true, false];
        let [solved] = solve(&matrix, &[right], free).unwrap();
        assert!((solved[1] - 1.0).abs() < 1e-14 && (solved[3] - 3e-6).abs() < 1e-20);
        assert_eq!((solved[0], solved[2], solved[4]), (0.0, 0.0, 0.0));
        matrix[3][3] = 1e12;
        assert_eq!(solve(&matrix, &[right], free), None, "singular");
    }
}

#[cfg(test)]
mod steps_tests {
    use super::super::port::Reading;
    use super::*;

    fn stroke(places: impl IntoIterator<Item = f64>) -> Stroke {
        let reading = |(i, place)| Reading { time: f64::from(i), place, held: 0.0 };
        Stroke { readings: (0..).zip(places).map(reading).collect() }
    }

    #[test]
    fn the_step_divides_all_differences() {
        // Steps of 6, 10 and 15 times 7 µm, without a single one.
        let places = [0.0, 6.0, 16.0, 31.0, 31.0, 25.0].map(|n| n * 7e-6);
        let EncoderStep::Even(step) = steps(&[stroke(places)], 0.005) else { panic!("even") };
        assert!((step / 7e-6 - 1.0).abs() < 1e-12, "{step}");
    }

    #[test]
    fn rounding_to_single_precision_hides_no_step() {
        let places = (0..200_i32).map(|i| {
            let place = 0.1 + 1e-5 * f64::from(i * i % 37);
            f64::from(place as f32)
        });
        let EncoderStep::Even(step) = steps(&[stroke(places)], 0.005) else { panic!("even") };
        assert!((step / 1e-5 - 1.0).abs() < 1e-4, "{step}");
    }

    #[test]
    fn readings_without_steps_show_none() {
        let places = (0..200).map(|i| 1e-3 * f64::from(i).sin());
        assert_eq!(steps(&[stroke(places)], 0.005), EncoderStep::Unseen(1e-5 * 0.005));
        assert_eq!(steps(&[stroke([0.0; 3])], 0.005), EncoderStep::Unseen(1e-5 * 0.005));
    }
}
