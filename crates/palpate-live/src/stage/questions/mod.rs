// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Questions of the page.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use palpate::field::{Point, Shape, Vector};
use palpate::local::PairMethod;
use palpate::query::{Limits, PairWorkspace, Placed, penetration, separation};
use palpate::scene::{self, BuiltBody, BuiltScene, Question, Versioned};

use super::pages::{longest_edge, point_of, size};
use crate::wire::{Answered, Ask, Grid, GridPlace, Local, Timed, ToQuestion, written};

mod element;
mod fall;

/// How near bounds are brought to each other, as a share of the scene.
const TOLERANCE: f64 = 1e-6;

/// How a ball falls unless the page says otherwise [m/s²], and how much of its speed is left after a
/// bounce.
const GRAVITY: f64 = 9.81;
const RESTITUTION: f64 = 0.5;

/// The most boxes of a proof that are told.
const MOST_BOXES: usize = 4000;

/// The most evaluations for a pair, and the most cells of a body, that a page may ask for: a search
/// is cancelled between pairs and bodies alone.
const LARGEST_BUDGET: usize = 5_000_000;

/// The longest answer in text [bytes]: of more pairs of bodies, a page asks for some.
const LONGEST: usize = 32 << 20;

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
    Text(String),
    Grid(Grid),
    Picture(Vec<u8>),
}

/// Answers the question with this number about a scene.
pub(super) fn answer<const D: usize>(
    scene: &BuiltScene<D>,
    ask: &Ask,
    id: Option<u32>,
    cancel: &Cancel,
) -> Result<Answer, String> {
    let answered = match ask {
        Ask::Question { question } => answer_to(scene, question, cancel),
        Ask::Element { corners, .. } => match corners.len() {
            1 => element::at_point(scene, &corners[0]),
            2 => element::over::<2, D>(scene, ask),
            3 => element::over::<3, D>(scene, ask),
            count => Err(format!("an element has 1 to 3 corners, got {count}")),
        },
        Ask::Pair { a, b, starts, method } => {
            between(scene, [*a, *b], starts, method.as_deref())
        }
        Ask::Sweep { corners, by } => match corners.len() {
            1 => element::swept_point(scene, &corners[0], by),
            2 => element::swept::<2, D>(scene, corners, by),
            3 => element::swept::<3, D>(scene, corners, by),
            count => Err(format!("an element that moves has 1 to 3 corners, got {count}")),
        },
        Ask::Fall { centre, radius, gravity, restitution } => {
            let numbers =
                [*radius, gravity.unwrap_or(GRAVITY), restitution.unwrap_or(RESTITUTION)];
            fall::fall(scene, centre, numbers, cancel)
        }
        Ask::Slice { .. } => return slice(scene, ask, cancel).map(Answer::Grid),
        Ask::Samples { cells, body } => {
            return samples(scene, *cells, *body, cancel).map(Answer::Grid);
        }
        _ => Err("nothing is known of such a question".to_owned()),
    };
    let text = written(&answered?, id);
    let length = text.len();
    if length > LONGEST {
        return Err(format!(
            "the answer has {length} bytes, of at most {LONGEST}: ask about fewer bodies"
        ));
    }
    Ok(Answer::Text(text))
}

/// Answers a question that every door takes.
fn answer_to<const D: usize>(
    scene: &BuiltScene<D>,
    question: &Question,
    cancel: &Cancel,
) -> Result<Answered<D>, String> {
    let budget = match question {
        Question::Point(_) => 0,
        Question::Contacts(question) => question.budget.unwrap_or(0) as usize,
        Question::Sweep(question) => question.budget.unwrap_or(0) as usize,
        Question::Mass(question) => question.cells,
    };
    if budget > LARGEST_BUDGET {
        return Err(format!(
            "a page may ask for at most {LARGEST_BUDGET} evaluations or cells, got {budget}"
        ));
    }
    let answer = Timed::of(|| {
        let mut answer = scene.ask_until(question, &cancel.0)?;
        let boxes_left_out = leave_out_boxes(&mut answer, MOST_BOXES);
        Ok(ToQuestion { answer: Versioned::new(answer), boxes_left_out })
    });
    let answer = answer.map_err(|error: scene::AskError| error.to_string())?;
    cancel.check()?;
    Ok(Answered::Answer(answer))
}

/// Leaves boxes out of proofs that have more than `most`; how many.
fn leave_out_boxes<const D: usize>(answer: &mut scene::Answer<D>, most: usize) -> usize {
    let scene::Answer::Contacts(contacts) = answer else { return 0 };
    let proofs = contacts.pairs.iter_mut().filter_map(|pair| pair.proof.as_mut());
    let boxes = proofs.map(|proof| &mut proof.boxes);
    boxes.map(|boxes| boxes.drain(boxes.len().min(most)..).count()).sum()
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

/// The most starts of local descents.
const MOST_STARTS: usize = 1000;

/// The share of the budget that a penetration may take: a page asks again whenever a body moves.
const SHARE_OF_PENETRATION: u32 = 10;

/// The separation of two bodies and their penetration, proven, and by local searches from some starts.
fn between<const D: usize>(
    scene: &BuiltScene<D>,
    bodies: [usize; 2],
    starts: &[Vec<f64>],
    method: Option<&str>,
) -> Result<Answered<D>, String> {
    let [a, b] = [named(scene, bodies[0])?, named(scene, bodies[1])?];
    let limits = limits(scene);
    let certified = Timed::of(|| {
        separation(placed(a), placed(b), &limits, &mut PairWorkspace::new())
            .map_err(|error| error.to_string())
    })?;
    let contact = certified.result.best.contact(placed(a), placed(b));
    let is_overlapping = certified.result.upper < 0.0;
    let penetration = is_overlapping.then(|| {
        let limits = limits.with_budget(limits.budget / SHARE_OF_PENETRATION);
        Timed::of(|| {
            penetration(placed(a), placed(b), &limits, &mut PairWorkspace::new())
                .map_err(|error| error.to_string())
        })
    });
    let penetration = penetration.transpose()?;
    let method = method.unwrap_or(PairMethod::AlternatingProjection.name());
    let method: PairMethod = method.parse().map_err(|error| format!("{error}"))?;
    if starts.len() > MOST_STARTS {
        let count = starts.len();
        return Err(format!("a pair has at most {MOST_STARTS} starts, got {count}"));
    }
    let descent = |start: &Vec<f64>| {
        let start = point_of(start)?;
        Timed::of(|| {
            let found = method.descend(&a.shape, &b.shape, start, limits.tolerance);
            found
                .map(|found| Local::new(method.name(), found))
                .map_err(|error| error.to_string())
        })
    };
    let local = starts.iter().map(descent).collect::<Result<_, String>>()?;
    Ok(Answered::Pair { certified, penetration, contact, local })
}

fn placed<const D: usize>(body: &BuiltBody<D>) -> Placed<'_, D> {
    Placed::new(&body.shape_in_body, body.world_from_body)
}

/// By how much samples reach over the bounds of the scene on each side, as a share of its longest edge.
const MARGIN: f64 = 0.05;

/// The most values along a side of a slice.
const MOST_ALONG: usize = 512;

/// The most values of a grid: 16 MB as single floats.
const MOST_VALUES: usize = 1 << 22;

/// Values on a plane.
fn slice<const D: usize>(
    scene: &BuiltScene<D>,
    ask: &Ask,
    cancel: &Cancel,
) -> Result<Grid, String> {
    let Ask::Slice { origin, right, up, width, height, columns, rows, body } = ask else {
        return Err("not about a slice".to_owned());
    };
    let shape = shape(scene, *body)?;
    let axis = |given: &Option<Vec<f64>>, number: usize| match given {
        Some(axis) => point_of::<D>(axis),
        None if D == 2 => {
            Ok(Vector(std::array::from_fn(|k| if k == number { 1.0 } else { 0.0 })))
        }
        None => Err("a slice in space has the directions `right` and `up`".to_owned()),
    };
    let (origin, right, up) = (point_of::<D>(origin)?, axis(right, 0)?, axis(up, 1)?);
    if columns.max(rows) > &MOST_ALONG {
        return Err(format!("a slice has at most {MOST_ALONG} values along a side"));
    }
    let counts = checked([*columns, *rows, 1])?;
    if !(*width > 0.0 && *height > 0.0 && width.is_finite() && height.is_finite()) {
        return Err(format!("a slice has a width and a height, got {width} m and {height} m"));
    }
    let (first, last) = ([-0.5 * width, -0.5 * height, 0.0], [0.5 * width, 0.5 * height, 0.0]);
    let place = GridPlace { dimension: 2, counts, first, last };
    let at = |[across, along, _]: [f64; 3]| origin + right * across + up * along;
    let values = filled(shape, place, at, cancel)?;
    Ok(Grid { place, values, is_half: false })
}

/// Values in the bounds of the scene, for a texture.
fn samples<const D: usize>(
    scene: &BuiltScene<D>,
    cells: usize,
    body: Option<usize>,
    cancel: &Cancel,
) -> Result<Grid, String> {
    let shape = shape(scene, body)?;
    let bounds = scene.bounds().ok_or("a scene without bounds cannot be sampled")?;
    let longest = longest_edge(&bounds);
    let grown = MARGIN * longest;
    if !(2..=2048).contains(&cells) {
        return Err(format!("samples lie in 2 to 2048 cells, got {cells}"));
    }
    let step = (longest + 2.0 * grown) / cells as f64;
    let (min, max) = (bounds.min.in_space().0, bounds.max.in_space().0);
    let grow = |axis: usize, side: f64| if axis < D { side * grown } else { 0.0 };
    let first: [f64; 3] = std::array::from_fn(|axis| min[axis] + grow(axis, -1.0));
    let last: [f64; 3] = std::array::from_fn(|axis| max[axis] + grow(axis, 1.0));
    let count = |axis: usize| {
        if axis < D { ((last[axis] - first[axis]) / step).ceil() as usize + 1 } else { 1 }
    };
    let counts = checked(std::array::from_fn(count))?;
    let place = GridPlace { dimension: D as u8, counts, first, last };
    let at = |at: [f64; 3]| Vector(std::array::from_fn(|axis| at[axis]));
    let values = filled(shape, place, at, cancel)?;
    Ok(Grid { place, values, is_half: true })
}

fn checked(counts: [usize; 3]) -> Result<[usize; 3], String> {
    let product = counts.iter().try_fold(1_usize, |all, count| all.checked_mul(*count));
    match product {
        Some(1..=MOST_VALUES) => Ok(counts),
        _ => Err(format!("a grid has 1 to {MOST_VALUES} values, got {counts:?}")),
    }
}

/// The values of a shape in a grid whose points `place` maps to the scene.
fn filled<const D: usize>(
    shape: &Shape<D>,
    grid: GridPlace,
    place: impl Fn([f64; 3]) -> Point<D>,
    cancel: &Cancel,
) -> Result<Vec<f32>, String> {
    let GridPlace { counts, first, last, .. } = grid;
    let at = |axis: usize, number: usize| {
        let share = number as f64 / (counts[axis].max(2) - 1) as f64;
        first[axis] + share * (last[axis] - first[axis])
    };
    let mut points = Vec::with_capacity(counts[0]);
    let mut row = vec![0.0; counts[0]];
    let mut values = Vec::with_capacity(counts.iter().product());
    for z in 0..counts[2] {
        for y in 0..counts[1] {
            cancel.check()?;
            points.clear();
            points.extend((0..counts[0]).map(|x| place([at(0, x), at(1, y), at(2, z)])));
            shape.distances(&points, &mut row);
            values.extend(row.iter().map(|distance| *distance as f32));
        }
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use palpate::scene::{AnyScene, Scene};

    use super::*;

    #[test]
    fn boxes_that_are_left_out_are_counted() {
        let text = r#"{ "palpate": 1, "dimension": 2, "bodies": [
            { "name": "a", "shape": { "circle": { "radius": 0.5 } } },
            { "name": "b", "shape": { "circle": { "radius": 0.5 } },
              "pose": { "translation": [2, 0] } } ] }"#;
        let AnyScene::Planar(scene) = Scene::from_json(text).unwrap().build().unwrap() else {
            panic!("in the plane")
        };
        let question = r#"{ "question": "contacts", "proof": true }"#;
        let mut answer = scene.ask(&serde_json::from_str(question).unwrap()).unwrap();
        let boxes = |answer: &scene::Answer<2>| match answer {
            scene::Answer::Contacts(found) => {
                found.pairs[0].proof.as_ref().map_or(0, |proof| proof.boxes.len())
            }
            other => panic!("{other:?}"),
        };
        let all = boxes(&answer);
        assert!(all > 4, "{all} boxes");
        assert_eq!((leave_out_boxes(&mut answer, 4), boxes(&answer)), (all - 4, 4));
        assert_eq!(leave_out_boxes(&mut answer, 4), 0);
    }
}
