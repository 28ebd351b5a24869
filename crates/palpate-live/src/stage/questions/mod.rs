// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the page asks about a scene: answers with bounds, evaluations and times.

mod element;
mod fall;
mod grid;
mod pair;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use palpate::field::Shape;
use palpate::query::Limits;
use palpate::scene::{self, BuiltBody, BuiltScene, Question, Versioned};

use super::points::size;
use crate::wire::{Answered, Ask, Grid, Timed, ToQuestion, written};

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
            pair::between(scene, [*a, *b], starts, method.as_deref())
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
        Ask::Slice { .. } => return grid::slice(scene, ask, cancel).map(Answer::Grid),
        Ask::Samples { cells, body } => {
            return grid::samples(scene, *cells, *body, cancel).map(Answer::Grid);
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
