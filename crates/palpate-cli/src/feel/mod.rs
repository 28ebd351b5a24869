// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate feel`: touches a scene.

use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

use clap::{Args, Parser, ValueEnum};
use outputs::{Outputs, Ran};
use palpate::device::PROFILES;
use palpate::hands::swing;
use palpate::haptics::{HapticsError, Probe, Progress, Tool};
use palpate::safety::{Acceptance, Recovery, SafetyError, SafetySettings};
use palpate::scene::{AnyScene, BuiltScene, BuiltTool, ServoSettings, unknown_name};
use palpate::servo_loop::{Ending, Pace, Recorder, RunOptions, RunReport, run as run_servo};
use palpate::sim::HandPath;
use palpate::vibration::{ACTUATORS, Actuator, actuator_named};

use crate::arguments::numbers::{
    count, length, length_or_zero, positive, within, zero_or_more,
};
use crate::arguments::{ProfileChoice, Reading};
use crate::input::{self, Named};
use crate::interrupt::Interrupt;
use crate::live::PageOptions;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, shown};
use crate::picture::{Dimensions, Drawable};
use crate::{emptiness, live, unfelt};

mod baked;
mod figure;
mod inside;
mod limits;
mod outputs;
mod paths;
pub(crate) mod report;
mod slices;
mod tool;
mod vibration;

/// The duration of a run without a path and without `--duration` [s].
const DURATION: f64 = 10.0;

/// The device that feels the built-in gallery.
const SHOWN: &str = "omega";

/// How often the live line is renewed.
const LIVE_EVERY: Duration = Duration::from_millis(100);

pub(crate) fn run(options: &FeelOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    let outputs = Outputs::of(options)?;
    let named = input::scene(options.scene.as_deref(), options.reading)?;
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
    unfelt::warn(scene);
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
    let map = paths::map(scene, tool.as_ref(), &choice)?;
    let beyond =
        options.path.as_ref().and_then(|_| paths::Beyond::of::<D>(&choice, &paths, &map));
    if let Some(beyond) = beyond.as_ref().filter(|_| !options.json) {
        output::remark(beyond.warning());
    }
    let device = paths::device(&choice, &paths, turns.as_ref(), &map);
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
    if let Some(less) = report::less_than_asked(scene, &accepted, device.profile()) {
        output::remark(less);
    }

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
        workspace_scale: paths::is_fitted(scene, &choice).then(|| map.scale()),
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

/// The most contact points: more than any device has.
const MOST_CONTACTS: usize = 1000;

pub(crate) const EXAMPLES: &str = "\
Examples:
  palpate feel
  palpate feel scenes/cup.json --duration 5 --trace touch.csv --plot touch.png
  palpate feel scenes/cup.json --path hand.csv --rate 2000
  palpate feel --points 10 --fast --json
  palpate feel --device glove --wav glove.wav --actuator lra";

/// The options of `palpate feel`.
#[derive(Args, Debug)]
pub(crate) struct FeelOptions {
    /// The scene file; the built-in gallery if left out.
    pub(crate) scene: Option<PathBuf>,
    /// Ticks a second [Hz].
    #[arg(long, allow_negative_numbers = true, default_value = "1000", value_parser = positive("Hz"))]
    pub(crate) rate: f64,
    /// How long to feel [s]; the length of the hand path, or else 10 s, if left out. A built-in tour
    /// is made for that time: with less, the hand is faster.
    #[arg(long, allow_negative_numbers = true, value_parser = positive("s"))]
    pub(crate) duration: Option<f64>,
    /// The hand's path, with the columns time_s,x_m,y_m[,z_m] and optionally point; a built-in
    /// tour of the bodies if left out. A path of one contact point carries all those of the
    /// scene's tool.
    #[arg(long, value_name = "CSV")]
    pub(crate) path: Option<PathBuf>,
    /// What the hand holds: recorded (the hand follows its path whatever the force),
    /// simulated:NAME (a device of `palpate devices`, or of a JSON file as `palpate identify`
    /// writes it, with its limits, in a hand that yields; one with rotation, such as sigma7, turns
    /// a tool with a shape), or glove (no force
    /// feedback). If left out, simulated:omega on the built-in gallery, else recorded.
    #[arg(long)]
    pub(crate) device: Option<DeviceChoice>,
    /// The number of contact points of the built-in hand; if left out, that of the scene's
    /// tool, 10 on the built-in gallery, or else 1. Not for a tool with a shape.
    #[arg(long, alias = "contacts", allow_negative_numbers = true, value_parser = count(1, MOST_CONTACTS))]
    pub(crate) points: Option<usize>,
    /// What a simulated device renders of materials; what the scene says, or else device, if left
    /// out.
    #[arg(long, value_enum)]
    pub(crate) acceptance: Option<AcceptanceChoice>,
    /// How a force comes back after a start in a body, or after the device was lost: rise, by 20 N/s,
    /// or once-out, when no body pushes the hand any more. After late ticks it always rises.
    #[arg(long, value_enum, default_value_t = RecoveryChoice::Rise, hide_default_value = true)]
    pub(crate) recovery: RecoveryChoice,
    /// Refuse bodies, a tool and guides of which a simulated device renders less than all. A glove,
    /// which has no forces, takes neither this nor the options of stiffness, damping, acceptance,
    /// recovery and force.
    #[arg(long)]
    pub(crate) strict: bool,
    /// Stiffness of the surface [N/m]; that of each body if left out.
    #[arg(long, allow_negative_numbers = true, value_parser = zero_or_more("N/m"))]
    pub(crate) stiffness: Option<f64>,
    /// Stiffness of the surface as a part of what a simulated device renders, up to 1; for a device
    /// without limits, that of each body counts.
    #[arg(long, value_name = "PART", conflicts_with = "stiffness", allow_negative_numbers = true, value_parser = within(1e-6, 1.0, ""))]
    pub(crate) relative_stiffness: Option<f64>,
    /// Damping of the surface [N·s/m]; that of each body if left out.
    #[arg(long, allow_negative_numbers = true, value_parser = zero_or_more("N·s/m"))]
    pub(crate) damping: Option<f64>,
    /// The force limit of a contact point [N], at most that of the device; if left out, that of
    /// the tool or of the simulated device, or else 3.3 N.
    #[arg(long, allow_negative_numbers = true, value_parser = positive("N"))]
    pub(crate) max_force: Option<f64>,
    /// The radius of the probe, or of the balls that cover a tool with a shape [m]; the tool's,
    /// or else 2 mm, if left out.
    #[arg(long, allow_negative_numbers = true, value_parser = length_or_zero)]
    pub(crate) radius: Option<f64>,
    /// Touch meshes themselves. If left out, a body that holds a mesh is touched as a grid of it, whose
    /// distances take the same short time everywhere.
    #[arg(long)]
    pub(crate) exact: bool,
    /// The size of the cells of those grids [m]; a 128th of each body if left out.
    #[arg(long, conflicts_with = "exact", allow_negative_numbers = true, value_parser = length)]
    pub(crate) cell: Option<f64>,
    /// Serve no page. Without a scene, `feel` serves one that shows the built-in gallery, and stays as
    /// long as it is open; `palpate live` shows other scenes.
    #[arg(long)]
    pub(crate) no_live: bool,
    #[command(flatten)]
    pub(crate) page: PageOptions,
    /// Run the ticks without waiting for the clock.
    #[arg(long)]
    pub(crate) fast: bool,
    /// Write every tick to this CSV file, whose name ends in .csv.
    #[arg(long, value_name = "CSV")]
    pub(crate) trace: Option<PathBuf>,
    /// Write what actuators play to this WAV file, whose name ends in .wav, with a channel for each
    /// contact point.
    #[arg(long, value_name = "WAV")]
    pub(crate) wav: Option<PathBuf>,
    /// What plays the vibration on each contact point: an actuator of `palpate devices
    /// --actuators`; that of the scene's tool, or else one that plays every frequency, if left out.
    #[arg(long, value_name = "NAME", requires = "wav", value_parser = actuator)]
    pub(crate) actuator: Option<Actuator>,
    /// Draw the path, the proxy and the force over the isolines: .svg or .png.
    #[arg(long, value_name = "PICTURE")]
    pub(crate) plot: Option<PathBuf>,
    /// Print the report as JSON.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) reading: Reading,
}

/// What the hand holds.
#[derive(Clone, Debug)]
pub(crate) enum DeviceChoice {
    /// A hand that follows its path whatever the force.
    Recorded,
    /// A device of this profile in a hand that yields.
    Simulated(Box<ProfileChoice>),
    /// Fingers without force feedback.
    Glove,
}

impl FromStr for DeviceChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let names = PROFILES.each_ref().map(|(name, _)| *name);
        match text.split_once(':') {
            None if text == "recorded" => Ok(Self::Recorded),
            None if text == "glove" => Ok(Self::Glove),
            None if names.contains(&text) => {
                Err(format!("a device of this name is written simulated:{text}"))
            }
            _ if text.to_ascii_lowercase().ends_with(".json") && !text.contains(':') => {
                Err(format!("a device with the profile of a file is written simulated:{text}"))
            }
            Some(("simulated", name)) => Ok(Self::Simulated(Box::new(name.parse()?))),
            _ => Err("must be recorded, simulated:NAME or glove".to_owned()),
        }
    }
}

fn actuator(name: &str) -> Result<Actuator, String> {
    let names = ACTUATORS.each_ref().map(|(name, _)| *name);
    actuator_named(name).map_err(|_| unknown_name("actuator", name, &names))
}

impl DeviceChoice {
    /// The file that the device's profile is from.
    pub(crate) fn file(&self) -> Option<&Path> {
        match self {
            Self::Simulated(choice) => choice.file.as_deref(),
            Self::Recorded | Self::Glove => None,
        }
    }
}

impl FeelOptions {
    /// The options of an empty command line.
    pub(crate) fn parse_from_nothing() -> Self {
        #[derive(Parser)]
        struct Nothing {
            #[command(flatten)]
            options: FeelOptions,
        }
        Nothing::parse_from(["palpate"]).options
    }
}

/// What a device renders of materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum AcceptanceChoice {
    /// What needs no passivity controller in any hand.
    Passive,
    /// As stiff as the device renders well at this rate, and as damped as that leaves room for.
    Device,
    /// As they are.
    #[value(alias = "as_is")]
    AsIs,
}

impl From<AcceptanceChoice> for Acceptance {
    fn from(choice: AcceptanceChoice) -> Self {
        match choice {
            AcceptanceChoice::Passive => Self::Passive,
            AcceptanceChoice::Device => Self::Device,
            AcceptanceChoice::AsIs => Self::AsIs,
        }
    }
}

/// How a force comes back after a beginning in a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RecoveryChoice {
    /// By 20 N/s, at once.
    Rise,
    /// When no body pushes the hand.
    OnceOut,
}

impl From<RecoveryChoice> for Recovery {
    fn from(choice: RecoveryChoice) -> Self {
        match choice {
            RecoveryChoice::Rise => Self::Rise,
            RecoveryChoice::OnceOut => Self::OnceOut,
        }
    }
}
