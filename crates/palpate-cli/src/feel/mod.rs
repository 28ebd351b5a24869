// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate feel`: runs a servo with a device in a hand, and reports.

mod asked;
mod baked;
mod figure;
mod held;
mod inside;
mod limits;
mod moved;
mod nearness;
mod outputs;
mod paths;
pub(crate) mod report;
mod slices;
mod tool;
mod vibration;

use std::io::{self, IsTerminal};
use std::time::Duration;

use palpate::hands::swing;
use palpate::haptics::{HapticsError, Probe, Progress, Tool};
use palpate::safety::{SafetyError, SafetySettings};
use palpate::scene::{AnyScene, BuiltScene, BuiltTool, ServoSettings};
use palpate::servo_loop::{Ending, Pace, Recorder, RunOptions, RunReport, run as run_servo};
use palpate::sim::HandPath;

use crate::arguments::{DeviceChoice, FeelOptions, PageOptions, ProfileChoice, RecoveryChoice};
use crate::emptiness;
use crate::input::{self, Named};
use crate::interrupt::Interrupt;
use crate::live;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, shown};
use crate::picture::{Dimensions, Drawable};
use outputs::{Outputs, Ran};

/// The duration of a run without a path and without `--duration` [s].
const DURATION: f64 = 10.0;

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
    check_page(options)?;
    // The hand goes where the shapes are: grids tell smaller distances far away.
    let exact = &asked(scene, options).at(0.0).map_err(Failure::input)?;
    let tool = tool::of_scene(exact, options)?;
    let paths = hands(exact, options, tool.as_ref(), outputs)?;
    if let Some(file) = &options.path {
        paths::check_times(file, &paths, options.duration)?;
    }
    let (scene, baked) = baked::scene(exact, options)?;
    let scene = &scene;
    let usual = if options.path.is_some() { paths::end(&paths) } else { DURATION };
    let duration = options.duration.unwrap_or(usual);
    let ticks = limits::ticks(duration, options.rate)?;
    let contacts = paths.len();
    let turns = match &tool {
        Some(_) if options.path.is_none() => {
            Some(swing::<D>(duration).map_err(Failure::input)?)
        }
        _ => None,
    };
    let map = held::map(scene, tool.as_ref(), &choice)?;
    let beyond =
        options.path.as_ref().and_then(|_| held::Beyond::of::<D>(&choice, &paths, &map));
    if let Some(beyond) = beyond.as_ref().filter(|_| !options.json) {
        output::remark(beyond.warning());
    }
    let device = held::device(&choice, &paths, turns.as_ref(), &map);
    let mut device = device.map_err(Failure::input)?;
    let safety = SafetySettings {
        is_strict: options.strict,
        recovery: options.recovery.into(),
        ..SafetySettings::default()
    };
    let acceptance = options.acceptance.map(Into::into);
    let settings = ServoSettings { rate: options.rate, acceptance, safety };
    let servo = scene.servo_with(device.as_ref(), settings);
    let mut servo = servo.map_err(|error| refused(error, scene))?;
    let accepted = servo.accepted().to_vec();

    let keeps_rows = outputs.keep_ticks();
    let rows = if keeps_rows { limits::rows(ticks * contacts as f64)? } else { 0 };
    let mut recorder = Recorder::new(rows);
    let shows_line = io::stderr().is_terminal();
    let mut show = |progress: &Progress| output::live(report::live_line(progress));
    let mut motion = scene.motion();
    interrupt.heed();
    let live =
        shows_page(options).then(|| live::beside(&options.page, options.rate, interrupt));
    let live = live.transpose()?.flatten();
    if !options.fast {
        output::remark(format_args!(
            "feeling {name} for {duration} s; Ctrl-C ends that, with the report"
        ));
    }
    let (outcome, traced) = outputs.traced(scene, |sink| {
        let mut run_options = RunOptions {
            pace: if options.fast { Pace::AsFastAsPossible } else { Pace::RealTime },
            rehearses: true,
            interrupt: Some(interrupt.flag()),
            ..RunOptions::new(duration)
        };
        if let Some(sink) = sink {
            run_options = RunOptions { sink: Some(sink), ..run_options };
        }
        if keeps_rows {
            run_options = RunOptions { recorder: Some(&mut recorder), ..run_options };
        }
        if !scene.motions.is_empty() {
            run_options = RunOptions { motion: Some(&mut motion), ..run_options };
        }
        if shows_line {
            run_options = run_options.with_watch(LIVE_EVERY, &mut show);
        }
        run_servo(&mut servo, device.as_mut(), run_options).map_err(Failure::input)
    })?;
    if shows_line {
        output::remark("");
    }

    let ran = Ran {
        rate: options.rate,
        title: &report::title(name, &outcome),
        device: device.profile(),
        rendered: servo
            .bodies()
            .bodies()
            .iter()
            .map(|body| body.surface().stiffness())
            .collect(),
    };
    let (written, played) = outputs.write(scene, &recorder, traced, &ran);
    let felt = report::Felt {
        name,
        scene,
        report: &outcome,
        servo: &servo,
        device: device.profile(),
        device_file: choice.file(),
        accepted: &accepted,
        missed: is_missed(&outcome).then(|| match options.path {
            Some(_) => report::Missed::OnPath(paths::nearest(scene, &paths)),
            None => report::Missed::OnTour,
        }),
        workspace_scale: held::is_fitted(scene, &choice).then(|| map.scale()),
        beyond,
        played: played.as_ref(),
        baked: &baked,
    };
    // The report is whole even if a file cannot be written, and a reader that closed the pipe
    // hides no file that is missing.
    written.and(felt.print(options.json))?;
    if let Some(live) = &live {
        live::until_closed(live, interrupt);
    }
    Ok(match outcome.ending {
        _ if !outcome.is_released => Outcome::No,
        Ending::Finished => Outcome::Yes,
        Ending::Interrupted => Outcome::Interrupted,
        _ => Outcome::No,
    })
}

/// The paths of the contact points, or of the tool: those of a file, or of a tour. What a tour would
/// take is refused before the tour is made.
fn hands<const D: usize>(
    scene: &BuiltScene<D>,
    options: &FeelOptions,
    tool: Option<&Tool>,
    outputs: &Outputs,
) -> Result<Vec<HandPath>, Failure> {
    if let Some(file) = &options.path {
        return paths::in_file(scene, options, file);
    }
    let duration = options.duration.unwrap_or(DURATION);
    let ticks = limits::ticks(duration, options.rate)?;
    let points = if tool.is_some() { 1 } else { paths::count(scene, options) };
    if outputs.keep_ticks() {
        limits::rows(ticks * points as f64)?;
    }
    paths::on_tour(scene, options, duration)
}

/// Whether a page shows what is felt: the built-in gallery, in real time, to a person.
fn shows_page(options: &FeelOptions) -> bool {
    options.scene.is_none() && !options.no_live && !options.fast && !options.json
}

/// Refuses options of the page where none is served.
fn check_page(options: &FeelOptions) -> Result<(), Failure> {
    if shows_page(options) || options.page == PageOptions::default() {
        return Ok(());
    }
    Err(Failure::input(
        "--port, --bind and --token-file are for the page that `palpate feel` serves without a scene, \
         and without --no-live, --fast and --json; `palpate live SCENE` shows a scene",
    ))
}

/// Whether a run felt nothing, no guide or magnet either.
fn is_missed(report: &RunReport) -> bool {
    report.contact_time == 0.0 && report.largest_force == 0.0
}

/// What the hand holds: what `--device` says; if it is left out, a device that yields on the
/// built-in gallery, and a recorded hand on other scenes.
fn choice(options: &FeelOptions) -> Result<DeviceChoice, Failure> {
    Ok(match (&options.device, &options.scene) {
        (Some(choice), _) => choice.clone(),
        (None, Some(_)) => DeviceChoice::Recorded,
        (None, None) => DeviceChoice::Simulated(Box::new(
            ProfileChoice::named(SHOWN).map_err(Failure::input)?,
        )),
    })
}

/// Refuses options that have no effect with the device, and forces that it does not give.
fn check_forces(choice: &DeviceChoice, options: &FeelOptions) -> Result<(), Failure> {
    let whose = match choice {
        DeviceChoice::Recorded => Some(
            "a recorded hand, whose device renders everything; choose one by --device \
             simulated:NAME"
                .to_owned(),
        ),
        DeviceChoice::Glove => Some("a glove, which has no forces".to_owned()),
        DeviceChoice::Simulated(choice) if choice.profile.max_force == 0.0 => {
            Some(format!("{}, which has no forces", choice.profile.name))
        }
        DeviceChoice::Simulated(_) => None,
    };
    if let Some(whose) = whose {
        let is_forceless = !matches!(choice, DeviceChoice::Recorded);
        let given = [
            ("--max-force", is_forceless && options.max_force.is_some()),
            ("--stiffness", is_forceless && options.stiffness.is_some()),
            ("--relative-stiffness", options.relative_stiffness.is_some()),
            ("--damping", is_forceless && options.damping.is_some()),
            ("--acceptance", options.acceptance.is_some()),
            ("--recovery", is_forceless && options.recovery != RecoveryChoice::Rise),
            ("--strict", options.strict),
        ];
        let given = given.iter().filter(|(_, is_given)| *is_given);
        let given: Vec<_> = given.map(|(option, _)| *option).collect();
        if given.is_empty() {
            return Ok(());
        }
        let have = if given.len() == 1 { "has" } else { "have" };
        let given = given.join(", ");
        return Err(Failure::input(format!("{given} {have} no meaning for {whose}")));
    }
    match (choice, options.max_force) {
        (DeviceChoice::Simulated(choice), Some(force)) if force > choice.profile.max_force => {
            let profile = &choice.profile;
            Err(Failure::input(format!(
                "--max-force must be at most {} N, the largest force of the {}, got {force} N",
                profile.max_force, profile.name
            )))
        }
        _ => Ok(()),
    }
}

/// Why there is no servo, with the names of the bodies that are to blame.
fn refused<const D: usize>(error: HapticsError, scene: &BuiltScene<D>) -> Failure {
    let HapticsError::Safety(SafetyError::MaterialRefused(refused)) = &error else {
        return Failure::input(error);
    };
    let name = |body: usize| {
        let body = scene.bodies.get(body);
        body.map_or_else(String::new, |body| format!("\"{}\"", shown(&body.name)))
    };
    let told: Vec<_> = refused.iter().map(|refused| refused.told(name)).collect();
    Failure::input(told.join("\n  "))
}

/// The scene, with materials, tool and contact points replaced by those of the command line.
fn asked<const D: usize>(scene: &BuiltScene<D>, options: &FeelOptions) -> BuiltScene<D> {
    let mut scene = scene.clone();
    for body in &mut scene.bodies {
        let material = &mut body.material;
        if let Some(stiffness) = options.stiffness {
            (material.stiffness, material.relative_stiffness) = (stiffness, None);
        }
        material.relative_stiffness =
            options.relative_stiffness.or(material.relative_stiffness);
        material.damping = options.damping.unwrap_or(material.damping);
    }
    if let (Some(_), Some(tool)) = (options.points, &mut scene.tool) {
        tool.points.clear();
    }
    if options.radius.is_some() || options.max_force.is_some() {
        let radius = Probe::default().radius();
        let tool = scene.tool.get_or_insert_with(|| BuiltTool::of_radius(radius));
        tool.radius = options.radius.unwrap_or(tool.radius);
        tool.options.max_force = options.max_force.or(tool.options.max_force);
    }
    scene
}
