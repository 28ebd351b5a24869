// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the page asks about a scene: answers with bounds, evaluations and times.

mod element;
mod fall;
mod grid;
mod pair;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use palpate::field::{Aabb, Pose, Shape, Vector};
use palpate::query::{
    BallWorkspace, Limits, PairWorkspace, Placed, evaluate_point, proof, touches_ball,
};
use palpate::scene::{BuiltBody, BuiltScene};
use serde_json::{Value, json};

use super::points::{point_of, size};
use crate::wire::{Ask, Grid};

/// How near bounds are brought to each other, as a share of the scene.
const TOLERANCE: f64 = 1e-6;

/// How a ball falls unless the page says otherwise [m/s²], and how much of its speed is left after a
/// bounce.
const GRAVITY: f64 = 9.81;
const RESTITUTION: f64 = 0.5;

/// The most boxes of a proof that are told.
const MOST_BOXES: usize = 4000;

/// Why a question that was cancelled is refused.
pub(super) const CANCELLED: &str = "cancelled";

/// Tells who answers a question that nobody wants the answer any more.
#[derive(Clone, Debug, Default)]
pub(super) struct Cancel(Arc<AtomicBool>);

impl Cancel {
    pub(super) fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    pub(super) fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Whether both are of one question.
    pub(super) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// An error once it is set.
    fn check(&self) -> Result<(), String> {
        if self.is_set() { Err(CANCELLED.to_owned()) } else { Ok(()) }
    }
}

/// An answer for the page.
#[derive(Debug)]
pub(super) enum Answer {
    Text(Value),
    Grid(Grid),
    Picture(Vec<u8>),
}

/// Answers a question about a scene; `None` if it is about something else.
pub(super) fn answer<const D: usize>(
    scene: &BuiltScene<D>,
    ask: &Ask,
    cancel: &Cancel,
) -> Option<Result<Answer, String>> {
    Some(match ask {
        Ask::Probe { at, body } => probe(scene, at, *body).map(Answer::Text),
        Ask::Element { corners, .. } => match corners.len() {
            1 => element::at_point(scene, &corners[0]),
            2 => element::over::<2, D>(scene, ask),
            3 => element::over::<3, D>(scene, ask),
            count => Err(format!("an element has 1 to 3 corners, got {count}")),
        }
        .map(Answer::Text),
        Ask::Ball { centre, radius } => ball(scene, centre, *radius).map(Answer::Text),
        Ask::Pair { a, b, starts, method } => {
            pair::between(scene, [*a, *b], starts, method.as_deref()).map(Answer::Text)
        }
        Ask::Contacts { proof } => contacts(scene, *proof).map(Answer::Text),
        Ask::Sweep { corners, by } => match corners.len() {
            1 => element::swept_point(scene, &corners[0], by),
            2 => element::swept::<2, D>(scene, corners, by),
            3 => element::swept::<3, D>(scene, corners, by),
            count => Err(format!("an element that moves has 1 to 3 corners, got {count}")),
        }
        .map(Answer::Text),
        Ask::Fall { centre, radius, gravity, restitution } => {
            let numbers =
                [*radius, gravity.unwrap_or(GRAVITY), restitution.unwrap_or(RESTITUTION)];
            fall::fall(scene, centre, numbers, cancel).map(Answer::Text)
        }
        Ask::Slice { .. } => grid::slice(scene, ask, cancel).map(Answer::Grid),
        Ask::Samples { cells, body } => {
            grid::samples(scene, *cells, *body, cancel).map(Answer::Grid)
        }
        _ => return None,
    })
}

/// The shape that is asked about: a body, or the union of all.
fn shape<const D: usize>(
    scene: &BuiltScene<D>,
    body: Option<usize>,
) -> Result<&Shape<D>, String> {
    body.map_or(Ok(&scene.whole), |number| named(scene, number).map(|body| &body.shape))
}

fn named<const D: usize>(
    scene: &BuiltScene<D>,
    number: usize,
) -> Result<&BuiltBody<D>, String> {
    let count = scene.bodies.len();
    scene.bodies.get(number).ok_or_else(|| format!("there are {count} bodies, got {number}"))
}

fn limits<const D: usize>(scene: &BuiltScene<D>) -> Limits {
    Limits::new(TOLERANCE * size(scene))
}

fn nanoseconds(start: Instant) -> u64 {
    u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX)
}

fn probe<const D: usize>(
    scene: &BuiltScene<D>,
    at: &[f64],
    body: Option<usize>,
) -> Result<Value, String> {
    let (point, shape) = (point_of::<D>(at)?, shape(scene, body)?);
    let found = evaluate_point(shape, point).map_err(|error| error.to_string())?;
    let nearest = |a: &f64, b: &f64| a.total_cmp(b);
    let distances = scene.bodies.iter().map(|body| body.shape.distance(point)).enumerate();
    let body = body.or(distances.min_by(|a, b| nearest(&a.1, &b.1)).map(|(body, _)| body));
    Ok(json!({
        "do": "probed",
        "value": found.distance,
        "gradient": found.gradient.0.to_vec(),
        "normal": found.normal.map(|normal| normal.0.to_vec()),
        "nearest": found.surface.map(|surface| surface.0.to_vec()),
        "safe": found.safe_radius,
        "rounding": found.rounding,
        "body": body,
        "promise": shape.promise().in_words(),
    }))
}

fn ball<const D: usize>(
    scene: &BuiltScene<D>,
    centre: &[f64],
    radius: f64,
) -> Result<Value, String> {
    let centre = point_of::<D>(centre)?;
    let start = Instant::now();
    let mut workspace = BallWorkspace::new();
    let limits = Limits::new(0.0);
    let found = touches_ball(&scene.whole, centre, radius, &limits, &mut workspace)
        .map_err(|error| error.to_string())?;
    let ns = nanoseconds(start);
    let value = scene.whole.distance(centre);
    Ok(json!({
        "do": "ball", "touches": found.is_hit(), "lower": found.lower, "upper": found.upper,
        "value": value, "memoir": value < radius, "evaluations": found.evaluations, "ns": ns,
    }))
}

fn contacts<const D: usize>(scene: &BuiltScene<D>, with_proof: bool) -> Result<Value, String> {
    let begin = Instant::now();
    let settings = scene.world_settings();
    let margin = settings.manifold.margin;
    let mut world = scene.world().map_err(|error| error.to_string())?;
    let mut pairs = Vec::new();
    for near in world.step() {
        let bodies = near.bodies.map(|body| body.index());
        let found = near.manifold.as_ref().map(|manifold| manifold.separation);
        let contact = |contact: &palpate::query::Contact<D>| {
            json!({
                "point_a": contact.point_a.0.to_vec(), "point_b": contact.point_b.0.to_vec(),
                "normal": contact.normal.0.to_vec(), "gap": contact.gap,
            })
        };
        let mut answer = json!({
            "a": bodies[0], "b": bodies[1],
            "verdict": format!("{:?}", near.verdict(margin)).to_lowercase(),
            "lower": found.map(|found| found.lower), "upper": found.map(|found| found.upper),
            "contacts": near.contacts().iter().map(contact).collect::<Vec<_>>(),
        });
        if with_proof {
            let [a, b] = bodies.map(|body| placed(&scene.bodies[body]));
            let proof = proof(a, b, &settings.limits, &mut PairWorkspace::new())
                .map_err(|error| error.to_string())?;
            let boxes = proof.boxes.iter().take(MOST_BOXES);
            let boxes = boxes.map(|cell| corners(&cell.aabb, &proof.world_from_boxes));
            answer["boxes"] = boxes.collect::<Vec<_>>().into();
            answer["boxes_left_out"] = proof.boxes.len().saturating_sub(MOST_BOXES).into();
        }
        pairs.push(answer);
    }
    Ok(json!({ "do": "contacts", "pairs": pairs, "ns": nanoseconds(begin) }))
}

fn placed<const D: usize>(body: &BuiltBody<D>) -> Placed<'_, D> {
    Placed::new(&body.shape_in_body, body.world_from_body)
}

/// The corners of a box that is placed by `pose`.
fn corners<const D: usize>(aabb: &Aabb<D>, pose: &Pose<D>) -> Vec<Vec<f64>> {
    let corner = |number: usize| {
        let upper = |axis: usize| number >> axis & 1 == 1;
        let corner = |axis| if upper(axis) { aabb.max[axis] } else { aabb.min[axis] };
        pose.transform_point(Vector(std::array::from_fn(corner))).0.to_vec()
    };
    (0..1 << D).map(corner).collect()
}
