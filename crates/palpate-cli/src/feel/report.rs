// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The report of a run, as text and JSON.

use std::fmt::Write;
use std::io::Write as _;
use std::path::Path;

use palpate::device::DeviceProfile;
use palpate::haptics::{
    AcceptedTexture, Body, Material, Progress, Servo, Surface, Texture, TextureKind,
};
use palpate::safety::{Acceptance, Accepted, DeviceLimits, Rule};
use palpate::scene::text::rounded;
use palpate::scene::{BakedBody, BuiltScene};
use palpate::servo_loop::RunReport;
use serde::Serialize;

use super::baked::{self, AsGrid};
use super::inside;
use super::paths::Beyond;
use super::vibration::{Played, Vibrated};
use crate::outcome::Failure;
use crate::output::{self, counted, shown};

/// The line that is shown while the servo runs.
pub(crate) fn live_line(progress: &Progress) -> String {
    format!(
        "{:7.2} s  {:2} in contact  {:5.2} N  {:5.2} mm deep  {:3} evaluations  {:6.2} µs",
        progress.time,
        progress.contacts,
        progress.force,
        1e3 * progress.depth,
        progress.evaluations,
        1e-3 * progress.cost_ns as f64,
    )
}

pub(crate) fn title(name: &str, report: &RunReport) -> String {
    let points = match (&report.tool, report.points) {
        (Some(_), _) => "a tool".to_owned(),
        (None, 1) => "one point".to_owned(),
        (None, points) => format!("{points} points"),
    };
    format!("{}, felt with {points}", crate::plot::title(Path::new(name)))
}

/// A hand that felt nothing.
pub(super) enum Missed {
    /// Its path in a file came so near to a body [m].
    OnPath(f64),
    /// The built-in hand did not get where its tour goes.
    OnTour,
}

/// A run that has ended.
pub(super) struct Felt<'a, const D: usize> {
    pub(super) name: &'a str,
    pub(super) scene: &'a BuiltScene<D>,
    pub(super) report: &'a RunReport,
    pub(super) servo: &'a Servo,
    pub(super) device: &'a DeviceProfile,
    /// The file that the device's profile is from.
    pub(super) device_file: Option<&'a Path>,
    pub(super) accepted: &'a [Accepted],
    /// Why nothing was felt, if nothing was.
    pub(super) missed: Option<Missed>,
    /// World metres for each metre of the device, if the program chose them.
    pub(super) workspace_scale: Option<f64>,
    /// How far a path leaves the workspace of the device, if it does.
    pub(super) beyond: Option<Beyond>,
    /// What actuators played, if that was written to a file.
    pub(super) played: Option<&'a Played>,
    /// The bodies of meshes, and how they were touched.
    pub(super) baked: &'a [BakedBody],
}

impl<const D: usize> Felt<'_, D> {
    /// Prints the report.
    pub(super) fn print(&self, as_json: bool) -> Result<(), Failure> {
        let mut out = output::answer();
        if as_json {
            out.json(&self.answer())?;
        } else {
            let mut text = String::new();
            write_report(&mut text, self).unwrap_or_default();
            out.write_all(text.as_bytes())?;
        }
        Ok(())
    }

    fn answer(&self) -> Answer<'_> {
        let is_tool = self.servo.tool().is_some();
        let of_tool = |entry: usize| self.accepted.get(entry).filter(|_| is_tool);
        let of_body = |body: usize| self.accepted.get(body).filter(|_| !is_tool);
        let bodies = self.scene.bodies.iter().enumerate();
        Answer {
            report: self.report,
            device: self.device.name.to_string(),
            device_file: self.device_file.map(|file| file.display().to_string()),
            workspace_scale: self.workspace_scale,
            beyond_workspace: self.beyond.as_ref(),
            as_grids: self.baked.iter().map(AsGrid::from).collect(),
            played: self.played.map(Played::answer),
            coupling: of_tool(0),
            angular_coupling: of_tool(1),
            accepted_guides: self.servo.accepted_guides(),
            bodies: bodies
                .map(|(body, built)| FeltBody { name: &built.name, accepted: of_body(body) })
                .collect(),
            moving: self.moving().map(str::to_owned).collect(),
        }
    }

    /// The name of a body; empty for one that is not there.
    pub(super) fn name_of(&self, body: u32) -> &str {
        self.scene.bodies.get(body as usize).map_or("", |body| &body.name)
    }

    /// The names of the bodies that have motions.
    fn moving(&self) -> impl Iterator<Item = &str> {
        self.scene.moving().map(|body| self.scene.bodies[body].name.as_str())
    }
}

/// The answer of `palpate feel`: the run's report, and what the program knows beside it.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Answer<'a> {
    #[serde(flatten)]
    report: &'a RunReport,
    /// The name of the device.
    device: String,
    /// The file that the device's profile is from.
    device_file: Option<String>,
    /// World metres for each metre of the device, if the program chose them.
    workspace_scale: Option<f64>,
    /// How far a path leaves the workspace of the device, if it does.
    beyond_workspace: Option<&'a Beyond>,
    /// The bodies of meshes.
    as_grids: Vec<AsGrid>,
    /// What actuators played, if that was written to a file.
    played: Option<Vibrated>,
    /// The coupling of a tool along axes.
    coupling: Option<&'a Accepted>,
    /// The coupling of a tool about axes.
    angular_coupling: Option<&'a Accepted>,
    /// The accepted stiffness and damping of each guide, in the order of `guides`.
    accepted_guides: &'a [Accepted],
    /// The bodies of the scene; their places in this list are their numbers.
    bodies: Vec<FeltBody<'a>>,
    /// The names of the bodies that have motions.
    moving: Vec<String>,
}

/// A body of the scene.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct FeltBody<'a> {
    /// The name of the body.
    name: &'a str,
    /// Its accepted stiffness and damping; `None` if a tool with a coupling touches it.
    accepted: Option<&'a Accepted>,
}

fn write_report<const D: usize>(out: &mut String, felt: &Felt<'_, D>) -> std::fmt::Result {
    let Felt { report, servo, device, accepted, .. } = felt;
    let name = shown(felt.name);
    let options = servo.options();
    let surfaces = || servo.bodies().bodies().iter().map(Body::surface);
    match &report.tool {
        Some(tool) => {
            let points = counted(tool.points, "point", "points");
            writeln!(out, "{name}, felt with a tool of {points}")?;
        }
        None => {
            let points = counted(report.points, "contact point", "contact points");
            writeln!(out, "{name}, felt with {points}")?;
        }
    }
    let materials = felt.scene.bodies.iter().map(|body| &body.material);
    let stiffness = of_asked(
        &range(surfaces().map(Surface::stiffness).map(unfelt_as_zero)),
        &stiffness(materials.clone(), device),
    );
    let damping = of_asked(
        &range(surfaces().map(Surface::damping)),
        &range(materials.map(|material| material.damping)),
    );
    let has_forces = device.max_force > 0.0;
    if has_forces {
        write!(
            out,
            "  stiffness {stiffness} N/m, damping {damping} N·s/m, at most {} N, ",
            of_asked(
                &rounded(options.max_force),
                &rounded(asked_force(felt.scene).unwrap_or(options.max_force))
            ),
        )?;
    } else {
        write!(out, "  vibration alone, as the device gives no force; ")?;
    }
    match &report.tool {
        Some(tool) => {
            let is_softest = surfaces().all(|surface| surface.stiffness() > tool.stiffness);
            let softest = if is_softest { ", softer than every body" } else { "" };
            writeln!(
                out,
                "through a coupling of {} N/m, {} N·s/m{softest}",
                rounded(tool.stiffness),
                rounded(tool.damping),
            )?;
        }
        None => writeln!(out, "probe of {} mm", 1e3 * options.probe.radius())?,
    }
    write!(out, "  device         {}", device.name)?;
    if let Some(file) = felt.device_file {
        write!(out, ", by {}", shown(&file.display().to_string()))?;
    }
    writeln!(out)?;
    if !has_forces && !felt.scene.guides.is_empty() {
        let guides = counted(felt.scene.guides.len(), "guide", "guides");
        writeln!(
            out,
            "  guides         {guides} without effect, as the device gives no force"
        )?;
    }
    if let Some(scale) = felt.workspace_scale {
        let scale = rounded(scale);
        writeln!(out, "  workspace      {scale} m of the scene for each metre of the device")?;
    }
    baked::write(out, felt.baked)?;
    if !felt.scene.motions.is_empty() {
        let moving: Vec<_> = felt.moving().map(|name| shown(name).to_string()).collect();
        writeln!(out, "  moving         {}", moving.join(", "))?;
    }
    // A workspace that is larger in the world makes a body stiffer at the hand.
    let along = if report.tool.is_some() { accepted.len().min(1) } else { accepted.len() };
    let along = &accepted[..along];
    if along.iter().any(|a| a.device_stiffness != a.impedance.stiffness()) {
        writeln!(
            out,
            "  at the hand    stiffness {} N/m, damping {} N·s/m",
            range(along.iter().map(|a| a.device_stiffness).map(unfelt_as_zero)),
            range(along.iter().map(|a| a.device_damping)),
        )?;
    }
    match (&report.tool, accepted.split_first()) {
        (Some(_), Some((coupling, turning))) => {
            let coupling = std::slice::from_ref(coupling);
            write_accepted(out, coupling, |_| "coupling and bodies".to_owned())?;
            write_accepted(out, turning, |_| "coupling about axes".to_owned())?;
        }
        _ => {
            let all = counted(accepted.len(), "body", "bodies");
            write_accepted(out, accepted, |count| format!("{count} of {all}"))?;
        }
    }
    let guides = servo.accepted_guides();
    let of_textures = servo.accepted_textures().iter().map(|texture| &texture.lateral);
    write_beyond(out, along.iter().chain(of_textures), device, report.rate)?;
    write_guides(out, guides)?;
    write_waves(out, felt)?;
    inside::write(out, felt)?;
    match felt.missed {
        None => {}
        Some(Missed::OnPath(nearest)) => {
            let nearest = rounded(nearest);
            writeln!(
                out,
                "  nothing felt   the hand came no nearer to a body than {nearest} m; is its path in \
                 metres, and in the coordinates of the scene?"
            )?;
        }
        Some(Missed::OnTour) => {
            let duration = rounded(report.duration);
            writeln!(
                out,
                "  nothing felt   the built-in hand reached no body in {duration} s with this device; \
                 raise --duration, or choose another --device"
            )?;
        }
    }
    write_textures(out, felt)?;
    if let Some(played) = felt.played {
        played.write(out)?;
    }
    write!(out, "{report:#}")
}

/// A line for each body whose waves the contact points were too large or too deep to follow.
fn write_textures<const D: usize>(out: &mut String, felt: &Felt<'_, D>) -> std::fmt::Result {
    let Felt { report, servo, scene, .. } = felt;
    if report.tool.is_some() || report.contact_time == 0.0 {
        return Ok(());
    }
    let reach = servo.options().probe.radius() + report.largest_depth;
    for body in &scene.bodies {
        let texture = body.material.texture.as_ref();
        let texture = texture.filter(|texture| texture.kind == TextureKind::Displacement);
        let Some(radius) = texture.map(Texture::valley_radius) else { continue };
        if radius < reach {
            let [radius, reach] = [radius, reach].map(|length| rounded(1e3 * length));
            writeln!(
                out,
                "  texture        the valleys of body \"{}\" have a radius of {radius} mm, less than \
                 probe and depth together, {reach} mm: waves may be skipped; lower their amplitude, \
                 or use kind \"height\"",
                shown(&body.name),
            )?;
        }
    }
    Ok(())
}

/// Why stiffness and damping are less than what is asked for.
fn write_accepted(
    out: &mut String,
    accepted: &[Accepted],
    whose: impl Fn(usize) -> String,
) -> std::fmt::Result {
    type Share = fn(&Accepted) -> (f64, Option<Rule>);
    let shares: [(&str, &str, Share); 2] = [
        ("softer", "stiffness", |a| (a.stiffness_factor, a.stiffness_rule)),
        ("less damped", "damping", |a| (a.damping_factor, a.damping_rule)),
    ];
    for (how, what, share) in shares {
        let less =
            accepted.iter().map(share).filter_map(|(factor, rule)| Some((factor, rule?)));
        let least = less.clone().min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((factor, rule)) = least else { continue };
        let (count, factor) = (less.count(), rounded(factor));
        let (whose, condition) = (whose(count), rule.condition());
        let least = if count > 1 { ", at least" } else { "," };
        // All are of one device.
        let assumed = accepted.first().map_or_else(String::new, |a| assumed(rule, &a.assumed));
        writeln!(
            out,
            "                 {whose} {how} than asked{least} {factor} of the {what}: \
             {condition}{assumed}"
        )?;
    }
    Ok(())
}

/// What a device renders less of than the scene or the command line asks for, in a sentence; `None`
/// if it renders all.
pub(super) fn less_than_asked<const D: usize>(
    scene: &BuiltScene<D>,
    accepted: &[Accepted],
    device: &DeviceProfile,
) -> Option<String> {
    let mut less = Vec::new();
    let most = device.max_force;
    if let Some(asked) = asked_force(scene).filter(|asked| most > 0.0 && *asked > most) {
        less.push(format!("at most {} N of {} N", rounded(most), rounded(asked)));
    }
    let softer = accepted.iter().enumerate().filter(|(_, a)| a.stiffness_rule.is_some());
    // A tool has its coupling along axes, and then about axes.
    let is_tool = scene.tool.as_ref().is_some_and(|tool| tool.shape.is_some());
    let along = softer.filter(|(entry, _)| !is_tool || *entry == 0);
    let softest =
        along.min_by(|(_, a), (_, b)| a.stiffness_factor.total_cmp(&b.stiffness_factor));
    if let Some((entry, softest)) = softest {
        let whose = match scene.bodies.get(entry) {
            Some(body) if !is_tool => format!("body \"{}\"", shown(&body.name)),
            _ => "the tool's coupling".to_owned(),
        };
        let [rendered, asked] =
            [softest.device_stiffness, softest.requested_stiffness].map(rounded);
        less.push(format!("{rendered} N/m of {asked} N/m of {whose}"));
    }
    let less = (!less.is_empty()).then(|| less.join(", and "))?;
    Some(format!("warning: the {} renders less than asked: {less}", shown(&device.name)))
}

/// The largest force that the scene or the command line asks for [N]; `None` for that of the device.
fn asked_force<const D: usize>(scene: &BuiltScene<D>) -> Option<f64> {
    scene.tool.as_ref()?.options.max_force
}

/// Which numbers that a rule uses are `assumed`.
fn assumed(rule: Rule, assumed: &[&str]) -> String {
    let angular = if rule.is_angular() { "angular " } else { "" };
    let used = rule.numbers().iter().filter(|name| assumed.contains(name));
    let used: Vec<_> = used.map(|name| format!("{angular}{name}")).collect();
    match used.len() {
        0 => String::new(),
        1 => format!("; {} is assumed", used.concat()),
        _ => format!("; {} are assumed", used.join(" and ")),
    }
}

/// What is rendered of guides, and why that is less than what is asked for.
fn write_guides(out: &mut String, accepted: &[Accepted]) -> std::fmt::Result {
    if accepted.is_empty() {
        return Ok(());
    }
    let of = |number: fn(&Accepted) -> f64| range(accepted.iter().map(number));
    let stiffness =
        of_asked(&of(|a| a.impedance.stiffness()), &of(|a| a.requested().stiffness()));
    let damping = of_asked(&of(|a| a.impedance.damping()), &of(|a| a.requested().damping()));
    writeln!(out, "  guides         stiffness {stiffness} N/m, damping {damping} N·s/m")?;
    let all = counted(accepted.len(), "guide", "guides");
    write_accepted(out, accepted, |count| format!("{count} of {all}"))
}

/// Which waves of height textures are lower than asked for, and why.
fn write_waves<const D: usize>(out: &mut String, felt: &Felt<'_, D>) -> std::fmt::Result {
    for AcceptedTexture { body, lateral, .. } in felt.servo.accepted_textures() {
        let body = felt.scene.bodies.get(*body);
        let asked = body.and_then(|body| Some((&body.name, body.material.texture.as_ref()?)));
        let Some(((name, asked), rule)) = asked.zip(lateral.stiffness_rule) else { continue };
        let rendered = lateral.stiffness_factor * asked.amplitude;
        let [rendered, asked] = [rendered, asked.amplitude].map(|height| rounded(1e3 * height));
        let [stiffness, steep] =
            [lateral.device_stiffness, lateral.requested_stiffness].map(rounded);
        writeln!(
            out,
            "  texture        waves of body \"{}\" are {rendered} mm high (asked {asked}); their \
             slopes have a stiffness of {stiffness} N/m (asked {steep}) under the largest force: \
             {}{}",
            shown(name),
            rule.condition(),
            assumed(rule, &lateral.assumed)
        )?;
    }
    Ok(())
}

/// How stiff the stiffest is, if that is more than the device renders stably.
fn write_beyond<'a>(
    out: &mut String,
    accepted: impl Iterator<Item = &'a Accepted>,
    device: &DeviceProfile,
    rate: f64,
) -> std::fmt::Result {
    let Ok(most) =
        Accepted::most_stiffness(&DeviceLimits::along(device), Acceptance::Device, rate)
    else {
        return Ok(());
    };
    let stiffest = accepted.map(|a| a.device_stiffness).fold(0.0, f64::max);
    // What rounding adds to the most is no more.
    if stiffest <= most * (1.0 + 1e-12) {
        return Ok(());
    }
    let [stiffest, most] = [stiffest, most].map(rounded);
    writeln!(
        out,
        "                 {stiffest} N/m is rendered as asked (as-is); the device renders at most {most} N/m stably"
    )
}

/// What is rendered, and what was asked for if that is another.
fn of_asked(rendered: &str, asked: &str) -> String {
    if rendered == asked { rendered.to_owned() } else { format!("{rendered} (asked {asked})") }
}

/// The stiffness [N/m], or zero for one below a millionth, which stands in for no spring at all.
fn unfelt_as_zero(stiffness: f64) -> f64 {
    if stiffness < 1e-6 { 0.0 } else { stiffness }
}

/// The part of what the device renders that a material asks for; `None` if it asks for a stiffness
/// in N/m, or the device has no largest.
pub(super) fn part(material: &Material, device: &DeviceProfile) -> Option<f64> {
    // Whether there is a largest depends on no rate.
    let most =
        Accepted::most_stiffness(&DeviceLimits::along(device), Acceptance::Device, 1000.0);
    let is_limited = device.max_force > 0.0 && most.is_ok_and(f64::is_finite);
    material.relative_stiffness.filter(|_| is_limited)
}

/// The stiffness that materials ask for [N/m], and the part of the device's that others do.
pub(super) fn stiffness<'a>(
    materials: impl Iterator<Item = &'a Material> + Clone,
    device: &DeviceProfile,
) -> String {
    let parts = materials.clone().filter_map(|material| part(material, device));
    let own = materials.filter(|material| part(material, device).is_none());
    let own = own.map(|material| material.stiffness);
    let of_device = || format!("{} of what the device renders", range(parts.clone()));
    match (own.clone().next(), parts.clone().next()) {
        (_, None) => range(own),
        (None, Some(_)) => of_device(),
        (Some(_), Some(_)) => format!("{}, and {}", range(own), of_device()),
    }
}

/// The numbers of all bodies: one number if they are equal, else their range.
pub(super) fn range(numbers: impl Iterator<Item = f64> + Clone) -> String {
    let least = numbers.clone().fold(f64::INFINITY, f64::min);
    let largest = numbers.fold(f64::NEG_INFINITY, f64::max);
    if least < largest {
        format!("{} to {}", rounded(least), rounded(largest))
    } else {
        rounded(least)
    }
}
