// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate render`: draws a scene in space, lit.

mod camera;
mod frames;
mod overlay;
pub(crate) mod report;
mod stage;

use palpate::scene::AnyScene;

use crate::arguments::RenderOptions;
use crate::input;
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output;
use crate::threads;

use frames::Frames;
use stage::Stage;

pub(crate) fn run(options: &RenderOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    let frames = Frames::of(options)?;
    options.question.refuse_unless(options.contacts)?;
    let named = input::scene(Some(&options.scene))?;
    let AnyScene::Spatial(scene) = &named.scene else {
        let problem = "the scene is in the plane, which `palpate plot` draws; render needs \"dimension\": 3";
        return Err(Failure::file(&options.scene, problem));
    };
    let stage = Stage::of(options, scene)?;
    let pool = threads::pool(options.threads)?;
    interrupt.heed();
    let drawn = pool.install(|| frames.draw(&stage, interrupt))?;
    output::answer().print(&report::Answer::of(&stage, &drawn), options.json)?;
    if drawn.is_interrupted() {
        output::remark(drawn.what_is_left());
        return Ok(Outcome::Interrupted);
    }
    Ok(if drawn.undecided() == 0 { Outcome::Yes } else { Outcome::No })
}
