// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate eval`: evaluates a scene at points.

mod answer;
mod ball;
mod stream;

use std::io::Write;

use palpate::query::{self, BallWorkspace};
use palpate::scene::{AnyScene, BuiltScene};

use crate::arguments::EvalOptions;
use crate::input;
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Destination, Files};
use ball::Balls;

pub(crate) fn run(options: &EvalOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    let inputs = [Some(options.scene.as_path()), options.points.as_deref()];
    let destination = match &options.output {
        Some(path) => {
            let mut files = Files::reading(inputs.into_iter().flatten());
            let destination = files.output(path)?;
            if let Some(part) = destination.part() {
                files.output(&part)?;
            }
            destination
        }
        None => Destination::standard(),
    };
    match &input::scene(Some(&options.scene))?.scene {
        AnyScene::Planar(scene) => evaluate(scene, options, &destination, interrupt),
        AnyScene::Spatial(scene) => evaluate(scene, options, &destination, interrupt),
    }
}

fn evaluate<const D: usize>(
    scene: &BuiltScene<D>,
    options: &EvalOptions,
    destination: &Destination,
    interrupt: &Interrupt,
) -> Result<Outcome, Failure> {
    let balls = options.radius.map(|radius| Balls::of(scene, radius)).transpose()?;
    if let Some(points) = &options.points {
        let job = stream::Job { shape: &scene.whole, points, balls };
        return job.run(options, destination, interrupt);
    }
    let Some(at) = &options.at else {
        let example = input::example_point(scene);
        return Err(Failure::input(format!(
            "eval needs a point, as with --at {example}, or many with --points FILE"
        )));
    };
    let point = input::point::<D>(at)?;
    let answer = query::evaluate_point(&scene.whole, point).map_err(Failure::input)?;
    let ball = balls.map(|balls| balls.ask(&answer, &mut BallWorkspace::new())).transpose()?;
    let mut out = output::answer();
    let promise = scene.whole.promise().in_words();
    if options.json {
        let mut object = answer::to_json(&answer);
        object["promise"] = promise.into();
        object["lipschitz"] = scene.whole.promise().lipschitz.into();
        if let Some(ball) = &ball {
            object["ball"] = ball.to_json();
        }
        out.json(&object)?;
    } else {
        writeln!(out, "distance       {} m", answer.distance)?;
        writeln!(out, "gradient       {}", input::joined(&answer.gradient.0))?;
        let proven = ball.as_ref().and_then(|ball| ball.surface_point());
        match answer.surface.or(proven) {
            Some(surface) => writeln!(out, "surface point  {} m", input::joined(&surface.0))?,
            None => writeln!(out, "surface point  none found")?,
        }
        writeln!(out, "inside         {}", if answer.is_inside { "yes" } else { "no" })?;
        writeln!(out, "safe radius    {} m", answer.safe_radius)?;
        writeln!(out, "promise        {promise}")?;
        if let Some(ball) = &ball {
            ball.print(&mut out)?;
        }
    }
    Ok(match ball.map(|ball| ball.meets()) {
        None | Some(Some(true)) => Outcome::Yes,
        Some(_) => Outcome::No,
    })
}
