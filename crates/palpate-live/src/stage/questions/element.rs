// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! An element against the scene: its least distance, proven and by a local search, and its sweep.

use palpate::field::{Aabb, BoundingBall, LARGEST_LENGTH, Point, Pose, Screw, Vector};
use palpate::local::{ElementMethod, GradientMethod, NaiveDescent, Weights};
use palpate::query::{
    BallWorkspace, Certified, Element, ElementSweep, ElementWorkspace, Limits, QueryError, Ray,
    Stop, SweepSettings, cast_ball, minimum, sweep_element,
};
use palpate::scene::BuiltScene;

use super::super::pages::{point_of, size};
use super::{TOLERANCE, limits};
use crate::wire::{Answered, Ask, Enclosing, Local, Swept, Timed};

/// The most steps of a local search, whose path is told.
const MOST_STEPS: u32 = 10_000;

/// The evaluations of a sweep: a tenth of a second.
const BUDGET: u32 = 500_000;

/// The least distance over a point: its value is all there is to find.
pub(super) fn at_point<const D: usize>(
    scene: &BuiltScene<D>,
    at: &[f64],
) -> Result<Answered<D>, String> {
    let element = Element::new([point_of::<D>(at)?; 2]).map_err(said)?;
    let certified = certified(scene, &element)?;
    Ok(Answered::Element { certified, local: None, enclosing: None })
}

/// The least distance over a segment or a triangle.
pub(super) fn over<const N: usize, const D: usize>(
    scene: &BuiltScene<D>,
    ask: &Ask,
) -> Result<Answered<D>, String> {
    let Ask::Element { corners, method, start, .. } = ask else {
        return Err("not about an element".to_owned());
    };
    let element = element_of::<N, D>(corners)?;
    let certified = certified(scene, &element)?;
    let method = method.as_deref().unwrap_or(ElementMethod::Naive.name());
    let method: ElementMethod = method.parse().map_err(|error| format!("{error}"))?;
    let start = start.as_deref().map(weights::<N>).transpose()?;
    let naive = naive::<D>(ask)?;
    let shape = &scene.whole;
    let local = Timed::of(|| {
        let found = match (method, &start) {
            (ElementMethod::Naive, None) => naive.descend(shape, &element),
            (ElementMethod::Naive, Some(start)) => naive.descend_from(shape, &element, start),
            (method, None) => method.descend(shape, &element),
            (method, Some(start)) => method.descend_from(shape, &element, start),
        };
        Ok::<_, String>(Local::new(method.name(), found))
    })?;
    let BoundingBall { centre, radius } = element.smallest_ball();
    let value = shape.distance(centre);
    let enclosing = Enclosing { centre, radius, value, excludes: value > radius };
    Ok(Answered::Element { certified, local: Some(local), enclosing: Some(enclosing) })
}

fn certified<const N: usize, const D: usize>(
    scene: &BuiltScene<D>,
    element: &Element<N, D>,
) -> Result<Timed<Certified<Point<D>>>, String> {
    let mut workspace = ElementWorkspace::new();
    Timed::of(|| minimum(&scene.whole, element, &limits(scene), &mut workspace)).map_err(said)
}

fn element_of<const N: usize, const D: usize>(
    corners: &[Vec<f64>],
) -> Result<Element<N, D>, String> {
    let mut vertices = [Vector::ZERO; N];
    for (vertex, corner) in vertices.iter_mut().zip(corners) {
        *vertex = point_of(corner)?;
    }
    Element::new(vertices).map_err(said)
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
) -> Result<Answered<D>, String> {
    let (element, by) = (element_of::<N, D>(corners)?, point_of::<D>(by)?);
    let motion = Screw::new(Pose::identity(), Pose::translation(by), 0);
    let motion = motion.map_err(|error| error.to_string())?;
    // What is large and far away makes no gap near what moves.
    let moved = Aabb::around(element.vertices().iter().flat_map(|p| [*p, *p + by]));
    let reach = moved.map_or(0.0, |moved| 2.0 * moved.half_extents().norm());
    let settings =
        SweepSettings { budget: BUDGET, ..SweepSettings::of_size(size(scene).min(reach)) };
    let mut workspace = ElementSweep::new();
    let found = Timed::of(|| {
        let found = sweep_element(&scene.whole, &element, motion, &settings, &mut workspace)?;
        Ok(Swept {
            touches: found.touches(),
            lower: found.lower,
            upper: found.upper,
            contact: found.contact,
            start: found.start,
            stop: found.stop,
            evaluations: found.evaluations,
        })
    });
    found.map(Answered::Sweep).map_err(said)
}

/// The same of a point: a ball without radius.
pub(super) fn swept_point<const D: usize>(
    scene: &BuiltScene<D>,
    at: &[f64],
    by: &[f64],
) -> Result<Answered<D>, String> {
    let (point, by) = (point_of::<D>(at)?, point_of::<D>(by)?);
    let far = by.norm();
    let way = by.normalized().ok_or("the motion has no length")?;
    let ray = Ray::new(point, way, far).map_err(said)?;
    let limits = Limits::new(TOLERANCE * size(scene).min(far)).with_budget(BUDGET);
    let found = Timed::of(|| {
        let found = cast_ball(&scene.whole, &ray, 0.0, &limits, &mut BallWorkspace::new())?;
        let touches = match (found.best, found.stop) {
            (Some(_), _) => Some(true),
            (None, Stop::SignKnown) => Some(false),
            (None, _) => None,
        };
        Ok(Swept {
            touches,
            lower: (found.lower / far).min(1.0),
            upper: found.best.map_or(f64::INFINITY, |_| found.upper / far),
            contact: found.best,
            start: None,
            stop: found.stop,
            evaluations: found.evaluations,
        })
    });
    found.map(Answered::Sweep).map_err(said)
}

fn said(error: QueryError) -> String {
    error.to_string()
}
