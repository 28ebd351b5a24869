// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate eval`: what the field says at points.

use std::path::PathBuf;

use clap::Args;
use palpate::query::AtPoint;
use palpate::scene::{AnyScene, BallAnswer, Balls, BuiltScene, PointQuestion, Question};

use crate::arguments::Reading;
use crate::arguments::numbers::count;
use crate::ask;
use crate::input::{self, AXES};
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Destination, Files};

pub(crate) mod stream;

pub(crate) fn run(options: &EvalOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    let inputs = [Some(options.scene.as_path()), options.points.as_deref()];
    let destination = match &options.output {
        Some(path) => {
            let mut files = Files::reading(inputs.into_iter().flatten(), options.reading);
            let destination = files.output(path)?;
            if let Some(part) = destination.part() {
                files.output(&part)?;
            }
            destination
        }
        None => Destination::standard(),
    };
    match &input::scene(Some(&options.scene), options.reading)?.scene {
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

pub(crate) const EXAMPLES: &str = "\
Examples:
  palpate eval scenes/s3.json --at 0.1,0.5,-0.2
  palpate eval scenes/memoir_star.json --at 0.3,0 --json
  palpate eval scenes/s3.json --points points.csv --output distances.csv
  palpate eval scenes/memoir_star.json --at 1.35,0.8 --radius 0.1

The points file has the header x_m,y_m,z_m (x_m,y_m in 2D). With --at and --radius the exit status
is 0 if the ball meets the scene, and 1 if it does not or that is undecided.";

/// The options of `palpate eval`.
#[derive(Args, Debug)]
pub(crate) struct EvalOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    /// One point, its coordinates joined by commas [m].
    #[arg(long, value_name = "X,Y[,Z]", allow_hyphen_values = true)]
    pub(crate) at: Option<String>,
    /// Many points, from a CSV file.
    #[arg(long, value_name = "CSV", conflicts_with = "at")]
    pub(crate) points: Option<PathBuf>,
    /// Also ask whether a ball of this radius about each point meets the scene [m].
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) radius: Option<f64>,
    /// The file for the answers to many points; standard output if left out.
    #[arg(long, value_name = "FILE", requires = "points", conflicts_with = "at")]
    pub(crate) output: Option<PathBuf>,
    /// The number of threads; as many as the machine has if left out. Answers have the same
    /// bits for any number.
    #[arg(long, requires = "points", conflicts_with = "at", allow_negative_numbers = true, value_parser = count(1, 1_000_000_usize))]
    pub(crate) threads: Option<usize>,
    /// Print JSON: one object, or one per line for many points.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) reading: Reading,
}

/// The columns of a row.
pub(crate) fn header<const D: usize>() -> Vec<String> {
    let axes = &AXES[..D];
    let mut header: Vec<String> = axes.iter().map(|axis| format!("{axis}_m")).collect();
    header.push("distance_m".to_owned());
    header.extend(axes.iter().map(|axis| format!("gradient_{axis}")));
    header.extend(axes.iter().map(|axis| format!("surface_{axis}_m")));
    header.extend(["inside".to_owned(), "safe_radius_m".to_owned()]);
    header
}

/// The row of an answer; the surface point is empty where none was found.
pub(crate) fn row<const D: usize>(answer: &AtPoint<D>) -> Vec<String> {
    let mut row: Vec<String> = answer.point.0.iter().map(f64::to_string).collect();
    row.push(answer.distance.to_string());
    row.extend(answer.gradient.0.iter().map(f64::to_string));
    match answer.surface {
        Some(surface) => row.extend(surface.0.iter().map(f64::to_string)),
        None => row.extend(vec![String::new(); D]),
    }
    row.extend([answer.is_inside.to_string(), answer.safe_radius.to_string()]);
    row
}

/// The columns of a ball.
fn header_of_ball<const D: usize>() -> Vec<String> {
    let axes = &AXES[..D];
    let mut header =
        ["radius_m", "meets", "gap_lower_m", "gap_upper_m"].map(str::to_owned).to_vec();
    header.extend(axes.iter().map(|axis| format!("nearest_{axis}_m")));
    header.extend(axes.iter().map(|axis| format!("ball_{axis}_m")));
    header.extend(["memoir_test", "memoir_test_is_right"].map(str::to_owned));
    header
}

/// The row of a ball; what is not known is empty, and `meets` is `undecided`.
fn row_of_ball<const D: usize>(ball: &BallAnswer<D>) -> Vec<String> {
    let meets = match ball.touches {
        Some(true) => "yes",
        Some(false) => "no",
        None => "undecided",
    };
    let mut row = vec![ball.radius.to_string(), meets.to_owned()];
    row.extend([ball.lower, ball.upper].map(|gap| gap.to_string()));
    match ball.contact {
        Some(contact) => {
            row.extend(contact.point_a.0.iter().map(f64::to_string));
            row.extend(contact.point_b.0.iter().map(f64::to_string));
        }
        None => row.extend(vec![String::new(); 2 * D]),
    }
    row.push(ball.memoir_test.to_string());
    row.push(ball.memoir_test_is_right.map_or_else(String::new, |right| right.to_string()));
    row
}
