// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What `palpate render` says of its pictures.

use std::io::Write;

use palpate::render::Work;
use serde_json::{Value, json};

use super::frames::Drawn;
use super::stage::Stage;
use crate::outcome::Failure;
use crate::output::{self, shown};

/// The pictures of a run.
pub(super) struct Report<'a> {
    pub(super) stage: &'a Stage<'a>,
    pub(super) drawn: &'a Drawn,
}

impl Report<'_> {
    pub(super) fn print(&self, as_json: bool) -> Result<(), Failure> {
        let mut out = output::answer();
        if as_json {
            out.json(&self.described())?;
            return Ok(());
        }
        // Numbered files have a line each.
        let what = match &self.drawn.files[..] {
            [] => return Ok(()),
            [file] => shown(&file.display().to_string()).to_string(),
            files => format!("{} pictures", files.len()),
        };
        let [sight, light] = &self.drawn.work;
        let rays = sight.rays + light.rays;
        writeln!(out, "{what}: {} rays, {}", rays, decided(sight, light))?;
        if sight.undecided + light.undecided > 0 {
            let budget = self.stage.settings.budget;
            let magenta = if sight.undecided > 0 { "; their pixels are magenta" } else { "" };
            writeln!(out, "  after {budget} evaluations{magenta}; raise --ray-budget")?;
        }
        Ok(())
    }

    fn described(&self) -> Value {
        let Self { stage, drawn } = self;
        let [sight, light] = drawn.work.map(|work| counts(&work));
        let mut said = json!({
            "outputs": drawn.files,
            "pictures": drawn.pictures,
            "width": stage.settings.width,
            "height": stage.settings.height,
            "camera": {
                "from_m": stage.camera.eye().0,
                "direction": (-stage.camera.sight().back()).0,
                "orthographic": stage.camera.is_orthographic(),
            },
            "ground_m": stage.settings.ground,
            "sight": sight,
            "light": light,
        });
        if let Some(first) = &drawn.first {
            said["gap_m"] = json!(first.gap);
            said["thin_m"] = json!(first.thin);
            if stage.settings.cut.is_some() {
                said["step_m"] = json!(first.spacing);
            }
        }
        if let Some(touched) = &stage.touched {
            said["touching_pairs"] = json!(touched.counts().0);
        }
        said
    }
}

fn decided(sight: &Work, light: &Work) -> String {
    match (sight.undecided, light.undecided) {
        (0, 0) => "all decided".to_owned(),
        (sight, light) => format!("{sight} of sight and {light} to the light undecided"),
    }
}

fn counts(work: &Work) -> Value {
    json!({
        "rays": work.rays,
        "evaluations": work.evaluations,
        "grazing": work.grazing,
        "undecided": work.undecided,
    })
}
