// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! An element against the scene: its least distance, proven and by a local search, and its sweep.

use std::time::Instant;

use palpate::field::{Aabb, LARGEST_LENGTH, Pose, Screw, Vector};
use palpate::local::{ElementMethod, GradientMethod, NaiveDescent, Weights};
use palpate::query::{
    BallWorkspace, Element, ElementSweep, ElementWorkspace, Limits, Ray, Stop, SweepSettings,
    cast_ball, evaluate_point, minimum, sweep_element,
};
use palpate::scene::BuiltScene;
use serde_json::{Value, json};

use super::{TOLERANCE, limits, nanoseconds};
use crate::stage::points::{point_of, size};
use crate::wire::Ask;

/// The most steps of a local search, whose path is told.
const MOST_STEPS: u32 = 10_000;

/// The evaluations of a sweep: a tenth of a second.
const BUDGET: u32 = 500_000;

/// A point as an element: its value is all there is to find.
pub(super) fn at_point<const D: usize>(
    scene: &BuiltScene<D>,
    at: &[f64],
) -> Result<Value, String> {
    let point = point_of::<D>(at)?;
    let start = Instant::now();
    let found = evaluate_point(&scene.whole, point).map_err(|error| error.to_string())?;
    let ns = nanoseconds(start);
    let [lower, upper] = [-found.rounding, found.rounding].map(|error| found.distance + error);
    Ok(json!({
        "do": "element",
        "certified": {
            "lower": lower, "upper": upper, "point": at, "stop": "converged",
            "evaluations": 1, "ns": ns,
        },
    }))
}

pub(super) fn over<const N: usize, const D: usize>(
    scene: &BuiltScene<D>,
    ask: &Ask,
) -> Result<Value, String> {
    let Ask::Element { corners, method, start, .. } = ask else {
        return Err("not about an element".to_owned());
    };
    let element = element_of::<N, D>(corners)?;
    let begin = Instant::now();
    let mut workspace = ElementWorkspace::new();
    let found = minimum(&scene.whole, &element, &limits(scene), &mut workspace)
        .map_err(|error| error.to_string())?;
    let certified = json!({
        "lower": found.lower, "upper": found.upper, "point": found.best.0.to_vec(),
        "stop": found.stop.to_string(), "evaluations": found.evaluations,
        "ns": nanoseconds(begin),
    });
    let method = method.as_deref().unwrap_or(ElementMethod::Naive.name());
    let method: ElementMethod = method.parse().map_err(|error| format!("{error}"))?;
    let start = start.as_deref().map(weights::<N>).transpose()?;
    let naive = naive::<D>(ask)?;
    let begin = Instant::now();
    let local = match (method, &start) {
        (ElementMethod::Naive, None) => naive.descend(&scene.whole, &element),
        (ElementMethod::Naive, Some(start)) => {
            naive.descend_from(&scene.whole, &element, start)
        }
        (method, None) => method.descend(&scene.whole, &element),
        (method, Some(start)) => method.descend_from(&scene.whole, &element, start),
    };
    let ns = nanoseconds(begin);
    let path: Vec<_> = local.path.iter().map(|point| point.0.to_vec()).collect();
    Ok(json!({
        "do": "element",
        "certified": certified,
        "local": {
            "method": method.name(), "value": local.value, "point": local.best.0.to_vec(),
            "path": path, "steps": local.steps, "evaluations": local.evaluations, "ns": ns,
        },
        "enclosing": enclosing(scene, &element),
    }))
}

/// The circle around an element, and whether its value excludes a touch: the memoir's first test.
fn enclosing<const N: usize, const D: usize>(
    scene: &BuiltScene<D>,
    element: &Element<N, D>,
) -> Value {
    let ball = element.smallest_ball();
    let (centre, radius) = (ball.centre, ball.radius);
    let value = scene.whole.distance(centre);
    json!({
        "centre": centre.0.to_vec(), "radius": radius, "value": value,
        "excludes": value > radius,
    })
}

fn element_of<const N: usize, const D: usize>(
    corners: &[Vec<f64>],
) -> Result<Element<N, D>, String> {
    let mut vertices = [Vector::ZERO; N];
    for (vertex, corner) in vertices.iter_mut().zip(corners) {
        *vertex = point_of(corner)?;
    }
    Element::new(vertices).map_err(|error| error.to_string())
}

fn weights<const N: usize>(numbers: &[f64]) -> Result<Weights<N>, String> {
    let wrong = || format!("a start is {N} weights of the corners, got {}", numbers.len());
    let numbers: [f64; N] = numbers.try_into().map_err(|_| wrong())?;
    Weights::new(numbers).map_err(|error| error.to_string())
}

/// The memoir's descent with the constants of the page.
fn naive<const D: usize>(ask: &Ask) -> Result<NaiveDescent, String> {
    let mut naive = NaiveDescent::default();
    let Ask::Element { alpha, mu, gradient, iterations, .. } = ask else { return Ok(naive) };
    if let Some(alpha) = *alpha {
        // Written so that NaN is refused.
        if !(alpha > 0.0 && alpha.is_finite()) {
            return Err(format!("α must be positive and finite, got {alpha}"));
        }
        naive = naive.with_alpha(alpha);
    }
    if let Some(mu) = *mu {
        if !(0.0..=LARGEST_LENGTH).contains(&mu) {
            return Err(format!("µ must be from 0 to {LARGEST_LENGTH:e} m, got {mu} m"));
        }
        naive = naive.with_mu(mu);
    }
    if let Some(gradient) = gradient {
        let gradient: GradientMethod = gradient.parse().map_err(|error| format!("{error}"))?;
        if D == 3 && gradient.is_planar() {
            return Err(format!("{} finds gradients in the plane alone", gradient.name()));
        }
        naive = naive.with_gradient(gradient);
    }
    match *iterations {
        Some(steps) if steps > MOST_STEPS => {
            Err(format!("there may be at most {MOST_STEPS} iterations, got {steps}"))
        }
        Some(steps) => Ok(naive.with_steps(steps)),
        None => Ok(naive),
    }
}

/// When an element that moves by a vector in 1 s first touches the scene.
pub(super) fn swept<const N: usize, const D: usize>(
    scene: &BuiltScene<D>,
    corners: &[Vec<f64>],
    by: &[f64],
) -> Result<Value, String> {
    let (element, by) = (element_of::<N, D>(corners)?, point_of::<D>(by)?);
    let motion = Screw::new(Pose::identity(), Pose::translation(by), 0);
    let motion = motion.map_err(|error| error.to_string())?;
    // What is large and far away makes no gap near what moves.
    let moved = Aabb::around(element.vertices().iter().flat_map(|p| [*p, *p + by]));
    let reach = moved.map_or(0.0, |moved| 2.0 * moved.half_extents().norm());
    let settings =
        SweepSettings { budget: BUDGET, ..SweepSettings::of_size(size(scene).min(reach)) };
    let begin = Instant::now();
    let mut workspace = ElementSweep::new();
    let found = sweep_element(&scene.whole, &element, motion, &settings, &mut workspace)
        .map_err(|error| error.to_string())?;
    Ok(json!({
        "do": "sweep", "touches": found.touches(), "lower": found.lower,
        "upper": found.upper.is_finite().then_some(found.upper),
        "contact": found.contact.map(|contact| contact.point_a.0.to_vec()),
        "start": found.start.map(|start| format!("{start:?}").to_lowercase()),
        "stop": found.stop.to_string(), "evaluations": found.evaluations, "ns": nanoseconds(begin),
    }))
}

/// The same of a point: a ball without radius.
pub(super) fn swept_point<const D: usize>(
    scene: &BuiltScene<D>,
    at: &[f64],
    by: &[f64],
) -> Result<Value, String> {
    let said = |error: palpate::query::QueryError| error.to_string();
    let (point, by) = (point_of::<D>(at)?, point_of::<D>(by)?);
    let far = by.norm();
    let way = by.normalized().ok_or("the motion has no length")?;
    let begin = Instant::now();
    let ray = Ray::new(point, way, far).map_err(said)?;
    let limits = Limits::new(TOLERANCE * size(scene).min(far)).with_budget(BUDGET);
    let found = cast_ball(&scene.whole, &ray, 0.0, &limits, &mut BallWorkspace::new());
    let found = found.map_err(said)?;
    let touches = match (found.best, found.stop) {
        (Some(_), _) => Some(true),
        (None, Stop::SignKnown) => Some(false),
        (None, _) => None,
    };
    let upper = (found.best.is_some() && found.upper.is_finite()).then(|| found.upper / far);
    Ok(json!({
        "do": "sweep", "touches": touches, "lower": (found.lower / far).min(1.0), "upper": upper,
        "contact": found.best.map(|contact| contact.point_a.0.to_vec()), "start": null,
        "stop": found.stop.to_string(), "evaluations": found.evaluations, "ns": nanoseconds(begin),
    }))
}
