// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Motions for the bodies of a scene, in a file of their own.

use serde::Deserialize;

use crate::build;
use crate::check::version;
use crate::encoding::utf8;
use crate::error::SceneError;
use crate::json::{Document, Source};
use crate::motion::WrittenMotion;
use crate::problem::Problem;
use crate::problems::Problems;
use crate::scene::Scene;

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
