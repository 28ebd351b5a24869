// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Questions about a scene and their answers: one vocabulary for every door.
//!
//! A [`Question`] is plain data with a form in JSON. [`BuiltScene::ask`] gives an [`Answer`], whose
//! fields are the keys of its JSON, and whose `Display` is a report for people.
//!
//! All numbers are in SI units: metres, seconds, kilograms. A bound that is infinite is `null` in
//! JSON. The JSON of an answer begins with its version, `"palpate": 2`, and its kind.
//!
//! ```
//! use palpate_scene::{AnyScene, Question, Scene};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let scene = Scene::from_json(
//!     r#"{ "palpate": 1, "dimension": 2, "bodies": [
//!          { "name": "left", "shape": { "ball": { "radius": 0.5 } } },
//!          { "name": "right", "shape": { "ball": { "radius": 0.5 } },
//!            "pose": { "translation": [2, 0] } } ] }"#,
//! )?;
//! let AnyScene::Planar(scene) = scene.build()? else { unreachable!("dimension is 2") };
//! let question: Question = serde_json::from_str(
//!     r#"{ "question": "point", "at": [0, 1.5] }"#,
//! )?;
//! let answer = scene.ask(&question)?.to_json();
//! assert_eq!((&answer["palpate"], &answer["answer"]), (&2.into(), &"point".into()));
//! assert_eq!((&answer["distance"], &answer["body"]), (&1.0.into(), &"left".into()));
//! # Ok(())
//! # }
//! ```

mod ball;
mod contacts;
mod mass;
mod point;
mod sweep;

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

use palpate_field::{Point, Shape, ShapeError, Vector};
use palpate_query::QueryError;
use serde::{Deserialize, Serialize};

use crate::build::{AnyScene, BuiltBody, BuiltScene};

pub use ball::{BallAnswer, Balls};
pub use contacts::{
    ContactsAnswer, ContactsQuestion, PairContacts, PenetrationBounds, Separation,
};
pub use mass::{BodyMass, MassAnswer, MassQuestion, Weighed};
pub use point::{PointAnswer, PointQuestion};
pub use sweep::{LocalFinding, SweepAnswer, SweepPair, SweepQuestion, SweptPart};

/// The version of answers, questions and the live protocol. A change of a key raises it.
pub const ANSWER_VERSION: u32 = 2;

/// Lists of pairs have every pair where at most so many are asked about, those of 12 bodies; of
/// more, only pairs that touch or may touch.
pub const FEW_PAIRS: usize = 66;

/// A question about a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "question", rename_all = "snake_case")]
pub enum Question {
    /// What the field says at a point; and whether a ball about it touches.
    Point(PointQuestion),
    /// Where bodies touch.
    Contacts(ContactsQuestion),
    /// When bodies that move touch first.
    Sweep(SweepQuestion),
    /// Volumes, masses and moments.
    Mass(MassQuestion),
}

impl Question {
    /// Reads a question in JSON.
    ///
    /// ```
    /// use palpate_scene::Question;
    ///
    /// let refused = Question::from_json(r#"{ "question": "contacts", "margin_m": 0.1 }"#);
    /// let why = refused.unwrap_err().to_string();
    /// assert!(why.ends_with("keys have no units: write `margin` [m]"), "{why}");
    /// ```
    ///
    /// # Errors
    ///
    /// [`AskError::Refused`] for a text that is no question. A key with a unit, as in version 1, is
    /// refused with its new name.
    pub fn from_json(text: &str) -> Result<Self, AskError> {
        serde_json::from_str(text).map_err(|error| {
            let problem = error.to_string();
            let advice = without_unit(&problem).unwrap_or_default();
            AskError::Refused(format!("the question cannot be read: {problem}{advice}"))
        })
    }
}

/// Names the key that is meant, if an unknown one is a known one with a unit.
fn without_unit(problem: &str) -> Option<String> {
    let (key, expected) = problem.strip_prefix("unknown field `")?.split_once('`')?;
    let (name, unit) = key.rsplit_once('_')?;
    let is_known =
        ["m", "mm", "s", "ms"].contains(&unit) && expected.contains(&format!("`{name}`"));
    is_known.then(|| {
        let base = if unit.ends_with('s') { "s" } else { "m" };
        format!("; keys have no units: write `{name}` [{base}]")
    })
}

/// The answer to a [`Question`] of the same name.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "answer", rename_all = "snake_case")]
pub enum Answer<const D: usize> {
    /// What the field says at a point.
    Point(PointAnswer<D>),
    /// Where bodies touch.
    Contacts(ContactsAnswer<D>),
    /// When bodies that move touch first.
    Sweep(SweepAnswer<D>),
    /// Volumes, masses and moments.
    Mass(MassAnswer<D>),
}

/// An answer with its version, as it is written.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Versioned<T> {
    palpate: u32,
    #[serde(flatten)]
    answer: T,
}

impl<T: Serialize> Versioned<T> {
    /// This answer with the [`ANSWER_VERSION`] in front.
    pub fn new(answer: T) -> Self {
        Self { palpate: ANSWER_VERSION, answer }
    }
}

impl<const D: usize> Answer<D> {
    /// The answer as JSON, its version first. Infinite numbers are `null`.
    ///
    /// # Panics
    ///
    /// Never: an answer has no key that is not text.
    #[must_use]
    pub fn to_json(&self) -> serde_json::Value {
        serde_json::to_value(Versioned::new(self)).expect("keys of answers are text")
    }
}

impl<const D: usize> fmt::Display for Answer<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Point(answer) => answer.fmt(f),
            Self::Contacts(answer) => answer.fmt(f),
            Self::Sweep(answer) => answer.fmt(f),
            Self::Mass(answer) => answer.fmt(f),
        }
    }
}

/// Why a question has no answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AskError {
    /// The scene has no body of this name.
    #[error("{0}")]
    UnknownBody(String),
    /// A point has as many numbers as the scene has dimensions.
    #[error("the scene is {dimension}D: a point has {dimension} numbers, got {got}")]
    Dimension {
        /// The dimension of the scene.
        dimension: usize,
        /// How many numbers the point had.
        got: usize,
    },
    /// A search refused its input.
    #[error(transparent)]
    Query(#[from] QueryError),
    /// A pose at a time, or a motion, is out of range.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// The question asks too much, or does not fit the scene.
    #[error("{0}")]
    Refused(String),
}

impl AnyScene {
    /// Answers a question in JSON: the road for other languages.
    ///
    /// # Errors
    ///
    /// As [`BuiltScene::ask`]; [`AskError::Refused`] for a question that cannot be read.
    pub fn ask_json(&self, question: &str) -> Result<String, AskError> {
        let question = Question::from_json(question)?;
        let answer = match self {
            Self::Planar(scene) => scene.ask(&question)?.to_json(),
            Self::Spatial(scene) => scene.ask(&question)?.to_json(),
        };
        Ok(answer.to_string())
    }
}

impl<const D: usize> BuiltScene<D> {
    /// Answers a question.
    ///
    /// # Errors
    ///
    /// [`AskError`], if the question does not fit the scene, or a number is out of range.
    #[inline(never)]
    pub fn ask(&self, question: &Question) -> Result<Answer<D>, AskError> {
        self.ask_until(question, &AtomicBool::new(false))
    }

    /// Answers a question, unless `stop` is set meanwhile. Then lists end early, and say so by
    /// `is_whole`.
    ///
    /// # Errors
    ///
    /// As [`ask`](Self::ask).
    #[inline(never)]
    pub fn ask_until(
        &self,
        question: &Question,
        stop: &AtomicBool,
    ) -> Result<Answer<D>, AskError> {
        Ok(match question {
            Question::Point(question) => Answer::Point(question.answer(self)?),
            Question::Contacts(question) => Answer::Contacts(question.answer(self, stop)?),
            Question::Sweep(question) => Answer::Sweep(question.answer(self, stop)?),
            Question::Mass(question) => Answer::Mass(question.answer(self, stop)?),
        })
    }

    /// The indices of the bodies of these names, each once and in order; all names must be known.
    fn numbers_of(&self, names: &[String]) -> Result<Vec<usize>, AskError> {
        let mut numbers =
            names.iter().map(|name| self.number_of(name)).collect::<Result<Vec<_>, _>>()?;
        numbers.sort_unstable();
        numbers.dedup();
        Ok(numbers)
    }

    fn number_of(&self, name: &str) -> Result<usize, AskError> {
        let found = self.bodies.iter().position(|body| body.name == name);
        found.ok_or_else(|| {
            let names: Vec<_> = self.bodies.iter().map(|body| body.name.as_str()).collect();
            AskError::UnknownBody(crate::unknown_name("body", name, &names))
        })
    }

    /// The shape of a body in the world, or of all bodies.
    fn shape_of(&self, body: Option<&str>) -> Result<&Shape<D>, AskError> {
        let Some(name) = body else { return Ok(&self.whole) };
        Ok(&self.bodies[self.number_of(name)?].shape)
    }

    /// The names of the bodies.
    fn names(&self) -> Vec<String> {
        self.bodies.iter().map(|body| body.name.clone()).collect()
    }

    /// The names of bodies whose fields are bounds outside, and no distances.
    fn bound_fields(&self) -> Vec<String> {
        let is_bound = |body: &&BuiltBody<D>| {
            body.shape_in_body.promise().outside != palpate_field::Quality::Exact
        };
        self.bodies.iter().filter(is_bound).map(|body| body.name.clone()).collect()
    }
}

/// How many pairs `all` bodies have with one of `asked`; all of them if none is asked for.
fn pairs_of(all: usize, asked: usize) -> usize {
    let pairs = |bodies: usize| bodies * bodies.saturating_sub(1) / 2;
    if asked == 0 { pairs(all) } else { pairs(all) - pairs(all - asked) }
}

fn is_set(stop: &AtomicBool) -> bool {
    stop.load(Ordering::Relaxed)
}

/// A point of a question.
fn point<const D: usize>(numbers: &[f64]) -> Result<Point<D>, AskError> {
    let wrong = |_| AskError::Dimension { dimension: D, got: numbers.len() };
    numbers.try_into().map(Vector).map_err(wrong)
}

/// Names the bodies of `pairs` whose fields are bounds, at most four of them, and says what that
/// means.
fn write_bound_fields<'a>(
    f: &mut fmt::Formatter<'_>,
    bound_fields: &[String],
    pairs: impl Iterator<Item = &'a [String; 2]>,
) -> fmt::Result {
    const MOST: usize = 4;
    let in_pairs: std::collections::BTreeSet<_> = pairs.flatten().collect();
    let bodies: Vec<_> = bound_fields.iter().filter(|name| in_pairs.contains(name)).collect();
    if bodies.is_empty() {
        return Ok(());
    }
    let mut said: Vec<_> =
        bodies.iter().take(MOST).map(|name| crate::text::shown(name)).collect();
    if bodies.len() > MOST {
        said.push(format!("{} more", bodies.len() - MOST).into());
    }
    writeln!(
        f,
        "Bodies whose fields are bounds outside: {}. Their separations from others are lower \
         bounds of distances.",
        said.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scene;

    /// Two discs of radius 0.5, 1 m apart; the first falls on the second in 1 s.
    const DISCS: &str = r#"{ "palpate": 1, "dimension": 2,
        "bodies": [
          { "name": "upper", "shape": { "ball": { "radius": 0.5 } },
            "pose": { "translation": [0, 2] } },
          { "name": "lower", "shape": { "ball": { "radius": 0.5 } } } ],
        "motions": [ { "body": "upper", "to": { "translation": [0, 0] } } ] }"#;

    fn asked(question: &str) -> Result<serde_json::Value, String> {
        let scene = Scene::from_json(DISCS).unwrap().build().unwrap();
        let answer = scene.ask_json(question).map_err(|error| error.to_string())?;
        assert!(answer.starts_with(r#"{"palpate":2,"answer":""#), "{answer}");
        Ok(serde_json::from_str(&answer).unwrap())
    }

    #[test]
    fn every_kind_of_question_is_answered() {
        let answer = asked(r#"{ "question": "point", "at": [0, 1], "radius": 0.6 }"#).unwrap();
        assert_eq!(
            (&answer["distance"], &answer["ball"]["touches"]),
            (&0.5.into(), &true.into())
        );
        let answer = asked(r#"{ "question": "contacts", "proof": true }"#).unwrap();
        let pair = &answer["pairs"][0];
        assert_eq!((&answer["apart"], &pair["verdict"]), (&1.into(), &"apart".into()));
        assert!(pair["separation"]["lower"].as_f64().unwrap() <= 1.0);
        assert!(!pair["proof"]["boxes"].as_array().unwrap().is_empty());
        // Half of the way is gone after half of the time.
        let answer = asked(r#"{ "question": "sweep" }"#).unwrap();
        let touch = answer["pairs"][0]["upper"].as_f64().unwrap();
        assert!((touch - 0.5).abs() < 1e-3, "{answer}");
        let answer = asked(r#"{ "question": "mass", "bodies": ["lower"] }"#).unwrap();
        let area = answer["bodies"][0]["volume"].as_f64().unwrap();
        assert!((area - std::f64::consts::FRAC_PI_4).abs() < 1e-3, "{answer}");
    }

    #[test]
    fn what_does_not_fit_is_refused_with_its_name() {
        for (question, why) in [
            (r#"{ "question": "point", "at": [0, 1, 2] }"#, "a point has 2 numbers, got 3"),
            (r#"{ "question": "contacts", "margin_m": 1 }"#, "unknown field `margin_m`"),
            (r#"{ "question": "contacts", "bodies": ["uper"] }"#, "upper"),
            (r#"{ "question": "fly" }"#, "unknown variant `fly`"),
            (r#"{ "question": "point", "at": [0, 1], "radius": -1 }"#, "the radius must be"),
        ] {
            let refused = asked(question).unwrap_err();
            assert!(refused.contains(why), "{question}: {refused}");
        }
    }

    #[test]
    fn a_search_that_is_stopped_says_that_it_is_not_whole() {
        let AnyScene::Planar(scene) = Scene::from_json(DISCS).unwrap().build().unwrap() else {
            unreachable!("the dimension is 2")
        };
        let stop = AtomicBool::new(true);
        let question = Question::Sweep(SweepQuestion::default());
        let answer = scene.ask_until(&question, &stop).unwrap().to_json();
        assert_eq!((&answer["is_whole"], &answer["pairs"][0]), (&false.into(), &().into()));
    }
}
