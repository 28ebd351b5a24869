// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contacts of signed distance fields, beside MuJoCo.
//!
//! Bodies are put into poses in which they overlap by a known depth. `beside.py` asks MuJoCo about
//! them, in a Python environment that is made under `target/`; README.md says what the columns
//! mean. The formula of each body is that of MuJoCo's plugins, in `plugin/sdf/` of its repository;
//! its search is in `src/engine/engine_collision_sdf.c`.

mod bodies;
mod exchange;
mod fastener;
mod gear;
mod ours;
mod poses;
mod results;
mod samples;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use clap::Args;

use crate::fields::Rows;
use crate::python::Peers;
use bodies::Body;
use exchange::{Answer, Asked, Question, Sampled};
use ours::Ours;
use poses::Known;
use results::Case;

const PEERS: Peers =
    Peers { name: "MuJoCo", packages: &[("mujoco", "4.0.0"), ("numpy", "2.4.6")] };

/// The depths of the poses [m], and how keys name them.
const DEPTHS: [(f64, &str); 3] = [(1e-4, "0.1mm"), (1e-3, "1mm"), (5e-3, "5mm")];

/// What is measured.
#[derive(Debug, Args)]
pub(crate) struct Options {
    /// Poses of each pair at each depth.
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..))]
    poses: u32,
    /// One pair alone.
    #[arg(long, value_parser = clap::builder::PossibleValuesParser::new(bodies::PAIRS.map(|p| p.0)))]
    only: Option<String>,
}

impl Options {
    /// `true` if some pairs are left out.
    pub(crate) fn is_part(&self) -> bool {
        self.only.is_some()
    }
}

/// A pair at a depth, and what we say of it.
struct Measured {
    key: String,
    known: Vec<Known>,
    ours: Ours,
}

/// All rows of the suite, the table of which is printed unless `is_quiet`; `None`, and a sentence
/// that says why, without MuJoCo.
pub(crate) fn measure(
    options: &Options,
    is_quiet: bool,
) -> Result<Option<Rows>, Box<dyn Error>> {
    let Some((folder, python)) = PEERS.prepared("mujoco")? else { return Ok(None) };
    let bodies = bodies::all()?;
    let mut measured = Vec::new();
    let mut question = Question { bodies: sampled(&bodies), pairs: Vec::new() };
    let is_asked = |name: &str| options.only.as_deref().is_none_or(|only| only == name);
    for (name, pair) in bodies::PAIRS.into_iter().filter(|(name, _)| is_asked(name)) {
        let pair = pair.map(|body| &bodies[body]);
        for (depth, at) in DEPTHS {
            let key = format!("{name}.{at}");
            eprintln!("measuring {key} …");
            let shapes = pair.map(|body| &body.shape);
            let known = poses::placed(shapes, depth, options.poses as usize)?;
            let ours = ours::ask(shapes, &known)?;
            question.pairs.push(asked(pair, &known));
            measured.push(Measured { key, known, ours });
        }
    }
    let answer = ask_mujoco(&python, &folder, &question)?;
    Ok(Some(report(&bodies, measured, &question, &answer, is_quiet)))
}

/// Each body with the points at which fields are compared.
fn sampled(bodies: &[Body]) -> Vec<Sampled> {
    let sampled = bodies.iter().map(|body| Sampled {
        body: body.plugin.clone(),
        size: samples::size(&body.shape).unwrap_or(1.0),
        points: samples::points(&body.shape).into_iter().map(|p| p.0).collect(),
    });
    sampled.collect()
}

/// A pair as MuJoCo is asked about it.
fn asked(pair: [&Body; 2], known: &[Known]) -> Asked {
    let pose = |known: &Known| {
        let [x, y, z] = known.pose.translation.0;
        let [i, j, k, real] = known.pose.rotation.quaternion();
        [x, y, z, real, i, j, k]
    };
    Asked {
        bodies: pair.map(|body| body.plugin.clone()),
        poses: known.iter().map(pose).collect(),
        witnesses: known.iter().map(|known| known.witness.0).collect(),
    }
}

/// Asks `beside.py`, through files in `folder`.
fn ask_mujoco(
    python: &Path,
    folder: &Path,
    question: &Question,
) -> Result<Answer, Box<dyn Error>> {
    let [asked, answered]: [PathBuf; 2] =
        ["question.json", "answer.json"].map(|name| folder.join(name));
    let script = folder.join("beside.py");
    fs::write(&script, include_str!("beside.py"))?;
    fs::write(&asked, serde_json::to_string(question)?)?;
    eprintln!("asking MuJoCo …");
    let status =
        Command::new(python).arg("-I").arg(&script).arg(&asked).arg(&answered).status()?;
    if !status.success() {
        return Err(format!("{} failed: {status}", script.display()).into());
    }
    Answer::read(&fs::read_to_string(&answered)?, question)
}

/// The rows of all answers; prints the table unless `is_quiet`.
fn report(
    bodies: &[Body],
    measured: Vec<Measured>,
    question: &Question,
    answer: &Answer,
    is_quiet: bool,
) -> Rows {
    let mut rows = Rows::new();
    let cases: Vec<_> = measured
        .into_iter()
        .zip(&answer.pairs)
        .map(|(Measured { key, known, ours }, found)| Case::new(key, &known, found, ours))
        .collect();
    for case in &cases {
        case.add_to(&mut rows);
    }
    let mut sentences = Vec::new();
    for ((body, sampled), theirs) in bodies.iter().zip(&question.bodies).zip(&answer.bodies) {
        let points: Vec<_> = sampled.points.iter().map(|p| (*p).into()).collect();
        let compared = samples::compare(&body.shape, &points, theirs);
        sentences.push(results::describe(body.plugin.plugin, sampled.size, &compared));
        rows.insert(format!("signs.{}.differ", body.name), compared.disagree);
    }
    if !is_quiet {
        println!("MuJoCo {}\n", answer.version);
        results::print(&cases);
        println!("\n{}\n", sentences.join("\n"));
    }
    rows
}
