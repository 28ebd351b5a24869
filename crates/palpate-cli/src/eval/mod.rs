// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate eval`: evaluates a scene at points.

mod answer;
pub(crate) mod stream;

use palpate::scene::{AnyScene, Balls, BuiltScene, PointQuestion, Question};

use crate::arguments::EvalOptions;
use crate::ask;
use crate::input;
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Destination, Files};

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
    if let Some(points) = &options.points {
        let balls = options.radius.map(|radius| Balls::new(scene, radius)).transpose();
        let balls = balls.map_err(ask::failure)?;
        let job = stream::Job { shape: &scene.whole, points, balls };
        return job.run(options, destination, interrupt);
    }
    let Some(at) = &options.at else {
        let example = input::example_point(scene);
        return Err(Failure::input(format!(
            "eval needs a point, as with --at {example}, or many with --points FILE"
        )));
    };
    let at = input::point::<D>(at)?.0.to_vec();
    let question = Question::Point(PointQuestion {
        at,
        radius: options.radius,
        ..PointQuestion::default()
    });
    let answer = scene.ask(&question).map_err(ask::failure)?;
    output::answer().print(&answer, options.json)?;
    Ok(match &ask::point(&answer).ball {
        Some(ball) if ball.touches != Some(true) => Outcome::No,
        _ => Outcome::Yes,
    })
}
