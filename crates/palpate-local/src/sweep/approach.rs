// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The broad phase of Pelletier-Guénette et al. (2025), section 4.6: a ball around each element is
//! marched through the field.

use palpate_query::Element;

use super::course::Course;

/// Steps of a march at most; the search begins where it is then.
const STEPS: u32 = 64;

/// The first time from `from` to `to` at which the field may be at most `gap` [m] on the element;
/// `None` if there is none. The second is how often the field was asked.
///
/// The smallest ball around the element turns in itself, so what counts is how its centre moves. Where a
/// field of steepness L has the value f at the centre, the ball meets no surface until the centre has
/// moved by `f/L` less the radius. So the march passes over no touch, but for rounding; where the
/// steepness holds in a region only, the march ends.
pub(super) fn approach<const N: usize, const D: usize>(
    course: &Course<'_, D>,
    element: &Element<N, D>,
    [from, to]: [f64; 2],
    gap: f64,
) -> (Option<f64>, u32) {
    /// Shorter steps, as a share of the time that is left, end the march.
    const LEAST: f64 = 1e-3;
    let ball = element.smallest_ball();
    let promise = course.field.shape.promise();
    if promise.region.is_some() {
        return (Some(from), 0);
    }
    let steepness = promise.lipschitz.max(1.0);
    let mut time = from;
    for asked in 1..=STEPS {
        let free = (course.value(ball.centre, time) - gap) / steepness - ball.radius;
        if free.is_nan() || free <= 0.0 {
            return (Some(time), asked);
        }
        let step = free / course.fastest(ball.centre, time);
        if time + step > to {
            return (None, asked);
        }
        time += step;
        if step < LEAST * (to - from) {
            return (Some(time), asked);
        }
    }
    (Some(time), STEPS)
}
