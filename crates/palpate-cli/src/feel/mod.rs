// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate feel`: runs a servo with a device in a hand, and reports.

mod figure;
mod held;
mod moved;
mod nearness;
mod outputs;
mod report;
mod slices;
mod tool;
mod vibration;

use std::io::{self, IsTerminal};
use std::time::Duration;

use palpate::devices::profile_named;
use palpate::devices::{HandPath, Interpolation, Tour};
use palpate::field::{Pose, Vector};
use palpate::haptics::{Acceptance, Probe, Progress};
use palpate::scene::{AnyScene, BuiltScene, BuiltTool, ServoSettings};
use palpate::servo_loop::{Ending, Pace, Recorder, RunOptions, run as run_servo};

use crate::arguments::{DeviceChoice, FeelOptions};
use crate::emptiness;
use crate::hand_csv;
use crate::input::{self, Named};
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output;
use crate::picture::{Dimensions, Drawable};
use outputs::{Outputs, Ran};

/// The duration of a run without a path and without `--duration` [s].
const DURATION: f64 = 10.0;

/// How far each contact point of the built-in hand lags behind the one before [s].
const LAG: f64 = 0.5;

/// The most rows that a run keeps: an hour of one contact point at 1 kHz. Each takes about 150
/// bytes.
const MOST_ROWS: f64 = 3.6e6;

/// The most ticks of a run: eleven days at 1 kHz.
const MOST_TICKS: f64 = 1e9;

/// The contact points of the built-in hand on the built-in gallery: two hands.
const FINGERS: usize = 10;

/// The device that feels the built-in gallery.
const SHOWN: &str = "omega";

/// How often the live line is renewed.
const LIVE_EVERY: Duration = Duration::from_millis(100);

pub(crate) fn run(options: &FeelOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    let outputs = Outputs::of(options)?;
    let named = input::scene(options.scene.as_deref())?;
    match &named.scene {
        AnyScene::Planar(scene) => feel(&named, scene, options, &outputs, interrupt),
        AnyScene::Spatial(scene) => feel(&named, scene, options, &outputs, interrupt),
    }
}

fn feel<const D: usize>(
    named: &Named,
    scene: &BuiltScene<D>,
    options: &FeelOptions,
    outputs: &Outputs,
    interrupt: &Interrupt,
) -> Result<Outcome, Failure>
where
    Dimensions: Drawable<D>,
{
    emptiness::warn(scene);
    let name = named.name.as_str();
    let choice = choice(options)?;
    check_forces(&choice, options)?;
    let scene = &asked(scene, options).at(0.0).map_err(Failure::input)?;
    // Checked before a path of that length is made.
    ticks(options.duration.unwrap_or(DURATION), options.rate)?;
    let tool = tool::of_scene(scene, options)?;
    let paths = match &tool {
        Some(tool) if options.path.is_none() => {
            vec![tool.path(options.duration.unwrap_or(DURATION))?]
        }
        _ => paths(scene, options)?,
    };
    let longest = paths.iter().map(|p| p.start() + p.duration()).fold(0.0, f64::max);
    let duration = options.duration.unwrap_or(longest);
    let contacts = paths.len();
    let turns = match &tool {
        Some(_) if options.path.is_none() => Some(tool::turns(duration)?),
        _ => None,
    };
    let map = held::map(scene, tool.as_ref(), &choice)?;
    let device = held::device(&choice, &paths, turns.as_ref(), &map);
    let mut device = device.map_err(Failure::input)?;
    let acceptance = if options.strict { Acceptance::Strict } else { Acceptance::Scaled };
    let settings = ServoSettings::default().with_rate(options.rate).with_acceptance(acceptance);
    let mut servo = scene.servo_with(device.as_ref(), settings).map_err(Failure::input)?;
    let accepted = servo.accepted().to_vec();

    let ticks = ticks(duration, options.rate)?;
    let keeps_rows = outputs.keep_ticks();
    let rows = if keeps_rows { rows(ticks * contacts as f64)? } else { 0 };
    let mut recorder = Recorder::new(rows);
    let shows_line = io::stderr().is_terminal();
    let mut show = |progress: &Progress| output::live(report::live_line(progress));
    let mut run_options = RunOptions::new(duration)
        .with_pace(if options.fast { Pace::AsFastAsPossible } else { Pace::RealTime })
        .with_rehearsals(true)
        .with_interrupt(interrupt.flag());
    if keeps_rows {
        run_options = run_options.with_recorder(&mut recorder);
    }
    let mut motion = |time: f64, set_pose: &mut dyn FnMut(usize, Pose<D>)| {
        scene.moving().for_each(|body| set_pose(body, scene.pose_at(body, time)));
    };
    if !scene.motions.is_empty() {
        run_options = run_options.with_motion(&mut motion);
    }
    if shows_line {
        run_options = run_options.with_watch(LIVE_EVERY, &mut show);
    }
    interrupt.heed();
    if !options.fast {
        output::remark(format_args!(
            "feeling {name} for {duration} s; Ctrl-C ends that, with the report"
        ));
    }
    let outcome =
        run_servo(&mut servo, device.as_mut(), run_options).map_err(Failure::input)?;
    if shows_line {
        output::remark("");
    }

    let ran = Ran {
        rate: options.rate,
        title: &report::title(name, &outcome),
        has_forces: device.profile().max_force > 0.0,
    };
    let written = outputs.write(scene, &recorder, &ran);
    let felt = report::Felt {
        name,
        scene,
        report: &outcome,
        servo: &servo,
        device: device.profile(),
        accepted: &accepted,
    };
    // The report is whole even if a file cannot be written, and a reader that closed the pipe
    // hides no file that is missing.
    written.and(felt.print(options.json))?;
    Ok(match outcome.ending {
        _ if !outcome.is_released => Outcome::No,
        Ending::Finished => Outcome::Yes,
        Ending::Interrupted => Outcome::Interrupted,
        _ => Outcome::No,
    })
}

/// What the hand holds: what `--device` says; if it is left out, a device that yields on the
/// built-in gallery, and a recorded hand on other scenes.
fn choice(options: &FeelOptions) -> Result<DeviceChoice, Failure> {
    Ok(match (&options.device, &options.scene) {
        (Some(choice), _) => choice.clone(),
        (None, Some(_)) => DeviceChoice::Recorded,
        (None, None) => {
            DeviceChoice::Simulated(Box::new(profile_named(SHOWN).map_err(Failure::input)?))
        }
    })
}

/// The rows of a run that are kept, if they are not too many.
fn rows(count: f64) -> Result<usize, Failure> {
    if count > MOST_ROWS {
        let problem = format!(
            "--trace, --plot and --wav keep {MOST_ROWS} rows at most, got {count}; shorten --duration, \
             lower --rate, or use fewer --points"
        );
        return Err(Failure::input(problem));
    }
    Ok(count.max(0.0).ceil() as usize)
}

/// The ticks of a run.
fn ticks(duration: f64, rate: f64) -> Result<f64, Failure> {
    let ticks = duration * rate;
    if ticks > MOST_TICKS {
        return Err(Failure::input(format!(
            "a run has at most {MOST_TICKS:e} ticks; {duration} s at {rate} Hz are {ticks:e}"
        )));
    }
    Ok(ticks)
}

/// Refuses forces that the device does not give.
fn check_forces(choice: &DeviceChoice, options: &FeelOptions) -> Result<(), Failure> {
    match (choice, options.max_force) {
        (DeviceChoice::Glove, _) => {
            let given = [
                ("--max-force", options.max_force.is_some()),
                ("--stiffness", options.stiffness.is_some()),
                ("--damping", options.damping.is_some()),
                ("--strict", options.strict),
            ];
            let given = given.iter().filter(|(_, is_given)| *is_given);
            let given: Vec<_> = given.map(|(option, _)| *option).collect();
            if given.is_empty() {
                return Ok(());
            }
            let have = if given.len() == 1 { "has" } else { "have" };
            let given = given.join(", ");
            let problem = format!("{given} {have} no meaning for a glove, which has no forces");
            Err(Failure::input(problem))
        }
        (DeviceChoice::Simulated(profile), Some(force)) if force > profile.max_force => {
            Err(Failure::input(format!(
                "--max-force must be at most {} N, the largest force of the {}, got {force} N",
                profile.max_force, profile.name
            )))
        }
        _ => Ok(()),
    }
}

/// The scene, with materials and tool replaced by those of the command line.
fn asked<const D: usize>(scene: &BuiltScene<D>, options: &FeelOptions) -> BuiltScene<D> {
    let mut scene = scene.clone();
    for body in &mut scene.bodies {
        let material = &mut body.material;
        material.stiffness = options.stiffness.unwrap_or(material.stiffness);
        material.damping = options.damping.unwrap_or(material.damping);
    }
    if options.radius.is_some() || options.max_force.is_some() {
        let radius = Probe::default().radius();
        let tool = scene.tool.get_or_insert_with(|| BuiltTool::of_radius(radius));
        tool.radius = options.radius.unwrap_or(tool.radius);
        tool.options.max_force = options.max_force.or(tool.options.max_force);
    }
    scene
}

/// The paths of the contact points, from the file or tours of the scene. On a tour the points
/// of a tool go side by side, others one behind the other.
fn paths<const D: usize>(
    scene: &BuiltScene<D>,
    options: &FeelOptions,
) -> Result<Vec<HandPath<D>>, Failure> {
    if let Some(path) = &options.path {
        return hand_csv::read(path);
    }
    let beside = if options.points.is_some() { Vec::new() } else { beside(scene) };
    let default = if options.scene.is_none() { FINGERS } else { 1 };
    let points = if beside.is_empty() { options.points.unwrap_or(default) } else { 1 };
    let duration = options.duration.unwrap_or(DURATION);
    let lag = LAG * points.saturating_sub(1) as f64;
    let radius = scene.tool.as_ref().map_or(Probe::default().radius(), |tool| tool.radius);
    let tour = Tour::new(input::bounds(scene)?, duration + lag)
        .and_then(|tour| tour.with_probe_radius(radius))
        .and_then(|tour| tour.over(&scene.whole))
        .map_err(Failure::input)?;
    let moved = |ahead: f64, by: Vector<f64, D>| {
        let times = tour.times().iter().map(|time| time - ahead).collect();
        let positions = tour.positions().iter().map(|point| *point + by).collect();
        HandPath::new(times, positions, Interpolation::Smooth).map_err(Failure::input)
    };
    if beside.is_empty() {
        (0..points).map(|contact| moved(LAG * contact as f64, Vector::ZERO)).collect()
    } else {
        beside.into_iter().map(|arm| moved(0.0, arm)).collect()
    }
}

/// The contact points of the scene's tool, relative to the hand; empty if it has none.
fn beside<const D: usize>(scene: &BuiltScene<D>) -> Vec<Vector<f64, D>> {
    let rotation = scene.device_rotation();
    let points = scene.tool.as_ref().map_or(&[][..], |tool| tool.points.as_slice());
    points.iter().map(|arm| rotation.rotate(*arm)).collect()
}
