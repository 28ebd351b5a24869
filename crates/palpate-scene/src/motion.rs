// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Motions.

#[cfg(test)]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::build;
use crate::encoding::utf8;
use crate::json::{Document, Source};
use crate::pose::WrittenPose;
use crate::problem::{Problem, Problems, SceneError, at_least, positive, version};
use crate::scene::Scene;

/// A screw motion of a body from a pose to another, at constant speed.
///
/// The body turns the shorter way, by at most half a turn, unless `turns` adds
/// whole ones.
///
/// ```
/// use palpate_scene::WrittenMotion;
///
/// # fn main() -> Result<(), serde_json::Error> {
/// let drop: WrittenMotion = serde_json::from_str(
///     r#"{ "body": "peg", "to": { "translation": [0, -0.1, 0] }, "duration": 0.2 }"#,
/// )?;
/// assert_eq!((drop.start, drop.turns), (0.0, 0));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "an object")]
#[non_exhaustive]
pub struct WrittenMotion {
    /// A note for readers of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// The name of the body.
    pub body: String,
    /// The first pose; the body's own if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<WrittenPose>,
    /// The last pose.
    pub to: WrittenPose,
    /// When it begins [s]; 0 if left out.
    #[serde(default, skip_serializing_if = "crate::problem::is_default")]
    #[cfg_attr(test, schemars(range(min = 0.0)))]
    pub start: f64,
    /// How long it takes [s]; 1 if left out.
    #[serde(default = "one_second")]
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub duration: f64,
    /// Whole turns added to the rotation in its direction, against it if negative; 0 if left out.
    #[serde(default, skip_serializing_if = "crate::problem::is_default")]
    pub turns: i32,
    /// What happens after its end; it stays there if left out.
    #[serde(default, skip_serializing_if = "crate::problem::is_default")]
    pub repeat: Repeat,
}

impl WrittenMotion {
    /// A motion of the body of this name from its own pose, which takes one second.
    #[must_use]
    pub fn new(body: impl Into<String>, to: WrittenPose) -> Self {
        Self {
            description: None,
            body: body.into(),
            from: None,
            to,
            start: 0.0,
            duration: one_second(),
            turns: 0,
            repeat: Repeat::default(),
        }
    }
}

fn one_second() -> f64 {
    1.0
}

/// What happens at the end of a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(test, derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
#[cfg_attr(test, schemars(inline))]
pub enum Repeat {
    /// The body stays there.
    #[default]
    Once,
    /// The body jumps back and begins again.
    Loop,
    /// The body moves back, and begins again.
    BackAndForth,
}

impl WrittenMotion {
    /// Checks the numbers; body and poses are checked by the scene.
    pub(crate) fn check(&self) -> Result<(), Problems> {
        let start = at_least("start", self.start, 0.0, "s");
        Problems::all([start, positive("duration", self.duration, "s")])
    }
}

/// The version of the format.
const VERSION: u64 = 1;

/// The motions of a file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
struct WrittenMotions {
    palpate_motions: u64,
    #[serde(default, rename = "description")]
    _description: Option<String>,
    motions: Vec<WrittenMotion>,
}

impl Scene {
    /// This scene with the motions of a file in place of its own, whose keys `docs/formats.md` lists.
    ///
    /// # Errors
    ///
    /// All that is wrong with the file, with paths, lines and columns: a body that the scene does not
    /// have, a number out of its range, a text that is no JSON.
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_scene::Scene;
    ///
    /// # fn main() -> Result<(), palpate_scene::SceneError> {
    /// let scene = Scene::from_json(
    ///     r#"{ "palpate": 1, "dimension": 2,
    ///          "bodies": [ { "name": "peg", "shape": { "ball": { "radius": 0.01 } } } ] }"#,
    /// )?;
    /// let falls = r#"{ "palpate_motions": 1,
    ///     "motions": [ { "body": "peg", "to": { "translation": [0, -0.1] }, "duration": 0.5 } ] }"#;
    /// let moving = scene.with_motions_of(falls.as_bytes())?;
    /// assert_eq!(moving.motions[0].duration, 0.5);
    ///
    /// let wrong = falls.replace("peg", "pin");
    /// let error = scene.with_motions_of(wrong.as_bytes()).unwrap_err().to_string();
    /// assert!(error.starts_with("motions[0].body, line 2: "), "{error}");
    /// # Ok(())
    /// # }
    /// ```
    pub fn with_motions_of(&self, bytes: &[u8]) -> Result<Self, SceneError> {
        let text = utf8(bytes).map_err(|error| Problem::new(error.to_string()))?;
        let source = Source::of(text);
        let with = |written: &WrittenMotions| {
            let mut scene = self.clone();
            scene.motions.clone_from(&written.motions);
            scene
        };
        let check = |written: &WrittenMotions| {
            let version = version("palpate_motions", written.palpate_motions, VERSION);
            let built = build::world(&with(written)).map(drop);
            Problems::all([version.map_err(Problems::from), built])
        };
        Ok(with(&Document::parse(&source)?.read(check)?))
    }
}
