// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Reports of runs.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_device::DeviceLost;
use palpate_field::{Point, Vector};
use palpate_safety::SafetyReport;

use super::connection::ConnectionReport;
use super::recorder::TickTimes;
use super::statistics::{Distribution, Times};
use super::vibration::VibrationReport;
use crate::{EventCounts, Guide, Progress, Servo, Tool};

/// The report of a run of a servo.
///
/// Forces and torques on the hand are those in the world, as in a [trace](super::TraceWriter). A force
/// is as large at the device. A torque at the device is that in the world over the scale of the
/// workspace: a device of a small scale turns more easily than it pushes. The reports of safety
/// chains, and all energies, are at the device.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct RunReport {
    /// Why the run ended.
    pub ending: Ending,
    /// `true` if the device accepted the final zero forces; a lost device may have refused them.
    pub is_released: bool,
    /// Ticks a second [Hz].
    pub rate: f64,
    /// Contact points.
    pub points: usize,
    /// Ticks done.
    pub ticks: u64,
    /// The servo's time that passed: ticks over rate [s].
    pub duration: f64,
    /// The time during which at least one point was in contact [s].
    pub contact_time: f64,
    /// The largest written force on a contact point [N].
    pub largest_force: f64,
    /// The largest depth of a contact point [m]; for a tool, the largest distance of its origin
    /// from the device point.
    pub largest_depth: f64,
    /// Evaluations of the shape a tick, all points together.
    pub evaluations: EvaluationCounts,
    /// The duration of the servo's step in a tick, for all points together, without the device;
    /// `None` if there was no tick.
    pub cost: Option<Distribution>,
    /// How late ticks started; `None` in a run without pacing.
    pub lateness: Option<Distribution>,
    /// Ticks that started more than a period late.
    pub missed_deadlines: u64,
    /// Rows that were not kept, because a recorder was full or a reader of rows fell behind.
    pub rows_dropped: u64,
    /// Counts of events at the contact points.
    pub events: EventCounts,
    /// The report of each contact point's safety chain, whose forces, torques and energies are those
    /// at the device; empty for a device that gives no force.
    pub safety: Vec<SafetyReport>,
    /// The contact points that were inside a body in the first tick.
    pub starts_inside: Vec<StartInside>,
    /// The report of the connection to the device.
    pub connection: ConnectionReport,
    /// The report of each guide of the servo; none if the device gives no force.
    pub guides: Vec<GuideReport>,
    /// The report of height textures; `None` if none was touched.
    pub texture: Option<TextureReport>,
    /// The report of the tool; `None` if the servo renders contact points.
    pub tool: Option<ToolReport>,
    /// The report of a device that vibrates; `None` without one.
    pub vibration: Option<VibrationReport>,
}

impl RunReport {
    /// The report of a run that ended as asked: for callers who take any other ending for an
    /// error.
    ///
    /// # Errors
    ///
    /// [`RunError`] if the device was lost or did not take the zero forces at the end, or if the
    /// loop panicked.
    pub fn unless_failed(self) -> Result<Self, RunError> {
        let lost = |reason: &str| Err(DeviceLost { reason: reason.to_owned() }.into());
        match &self.ending {
            Ending::DeviceLost { reason } => lost(reason),
            Ending::Panicked { message } => {
                let (message, is_released) = (message.clone(), self.is_released);
                Err(RunError::Panicked { message, is_released })
            }
            _ if !self.is_released => lost("it did not take the zero forces at the end"),
            _ => Ok(self),
        }
    }
}

/// Why a run did not end as asked.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The device was lost, or did not take the zero forces at the end.
    #[error(transparent)]
    DeviceLost(#[from] DeviceLost),
    /// The loop panicked, which is a defect.
    #[error("the servo's loop panicked, which is a defect: {message}")]
    Panicked {
        /// The panic's message.
        message: String,
        /// `true` if the device accepted the zero forces.
        is_released: bool,
    },
}

/// How often the shape was evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct EvaluationCounts {
    /// In all ticks.
    pub total: u64,
    /// The mean of a tick.
    pub mean: f64,
    /// The most in a tick.
    pub max: u64,
    /// Ticks in which a contact point or a tool used up its budget.
    pub budget_spent: u64,
}

/// Why a run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Ending {
    /// The duration was over, or the handle of the servo's thread ended the run.
    Finished,
    /// The [interrupt flag](super::RunOptions::interrupt) of the run was set.
    Interrupted,
    /// The device was lost.
    DeviceLost {
        /// The message of the transport.
        reason: String,
    },
    /// The loop panicked, which is a defect. [`RunReport::is_released`] says whether the device
    /// took the zero forces after it.
    Panicked {
        /// The panic's message.
        message: String,
    },
}

/// How a run ended, and what others than the [`Tally`] saw of it.
#[derive(Debug)]
pub(crate) struct Ended {
    pub(crate) ending: Ending,
    pub(crate) is_released: bool,
    pub(crate) rows_dropped: u64,
    pub(crate) safety: Vec<SafetyReport>,
    pub(crate) connection: ConnectionReport,
    pub(crate) vibration: Option<VibrationReport>,
}

/// Counts during a run, in preallocated memory.
#[derive(Debug)]
pub(crate) struct Tally {
    points: usize,
    rate: f64,
    ticks: u64,
    contact_ticks: u64,
    missed_deadlines: u64,
    budget_spent: u64,
    evaluations: u64,
    most_evaluations: u64,
    largest_force: f64,
    largest_depth: f64,
    cost: Times,
    lateness: Times,
    events: EventCounts,
    starts: StartTally,
    guides: GuideTally,
    texture: TextureReport,
    tool: Option<ToolTally>,
}

impl Tally {
    pub(crate) fn new(servo: &Servo) -> Self {
        let points = servo.touches().len();
        Self {
            points,
            rate: servo.options().rate,
            ticks: 0,
            contact_ticks: 0,
            missed_deadlines: 0,
            budget_spent: 0,
            evaluations: 0,
            most_evaluations: 0,
            largest_force: 0.0,
            largest_depth: 0.0,
            cost: Times::new(),
            lateness: Times::new(),
            events: EventCounts::default(),
            starts: StartTally::new(points),
            guides: GuideTally::new(servo),
            texture: TextureReport::default(),
            tool: None,
        }
    }

    /// Counts how late a tick started.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn late(&mut self, lateness_ns: u64, missed: bool) {
        self.lateness.record(lateness_ns);
        self.missed_deadlines += u64::from(missed);
    }

    /// Counts a tick, and returns the progress for other threads.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn tick(&mut self, times: TickTimes, servo: &Servo) -> Progress {
        let (touches, mut budget) = (servo.touches(), servo.options().probe.budget());
        if let Some(tool) = servo.tool() {
            budget = tool.options().budget;
            let written = servo.held_tool().and_then(|held| held.given);
            self.tool.get_or_insert_default().tick(tool, written);
        }
        self.starts.tick(servo);
        self.guides.tick(servo);
        self.texture.tick(servo);
        servo.events().iter().for_each(|event| self.events.count(event));
        self.ticks += 1;
        self.cost.record(times.cost_ns);
        let mut progress = Progress {
            ticks: self.ticks,
            time: times.time_s,
            cost_ns: times.cost_ns,
            ..Progress::default()
        };
        let mut is_spent = false;
        for touch in touches {
            progress.contacts += u64::from(touch.contact);
            progress.evaluations += u64::from(touch.evaluations);
            progress.force = progress.force.max(touch.force.norm());
            progress.depth = progress.depth.max(touch.depth());
            is_spent |= touch.evaluations >= budget;
        }
        self.contact_ticks += u64::from(progress.contacts > 0);
        self.budget_spent += u64::from(is_spent);
        self.evaluations += progress.evaluations;
        self.most_evaluations = self.most_evaluations.max(progress.evaluations);
        self.largest_force = self.largest_force.max(progress.force);
        self.largest_depth = self.largest_depth.max(progress.depth);
        progress
    }

    pub(crate) fn report(&self, ended: Ended) -> RunReport {
        let Ended { ending, is_released, rows_dropped, safety, connection, vibration } = ended;
        let ticks = self.ticks as f64;
        RunReport {
            ending,
            is_released,
            rate: self.rate,
            points: self.points,
            ticks: self.ticks,
            duration: ticks / self.rate,
            contact_time: self.contact_ticks as f64 / self.rate,
            largest_force: self.largest_force,
            largest_depth: self.largest_depth,
            evaluations: EvaluationCounts {
                total: self.evaluations,
                mean: if self.ticks > 0 { self.evaluations as f64 / ticks } else { 0.0 },
                max: self.most_evaluations,
                budget_spent: self.budget_spent,
            },
            cost: self.cost.distribution(),
            lateness: self.lateness.distribution(),
            missed_deadlines: self.missed_deadlines,
            rows_dropped,
            events: self.events,
            safety,
            connection,
            vibration,
            starts_inside: self.starts.reports(self.rate),
            guides: self.guides.reports(self.rate),
            texture: Some(self.texture).filter(|texture| texture.ticks > 0),
            tool: self.tool.as_ref().map(ToolTally::report),
        }
    }
}

/// What a guide did in a run, at all contact points together.
///
/// The forces are those that the guide wanted, before the safety chain; the chain's energies do
/// not count them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct GuideReport {
    /// What the guide is, as [`Guide::kind_name`](crate::Guide::kind_name) says.
    pub kind: &'static str,
    /// The time during which the guide held at least one contact point [s].
    pub time: f64,
    /// Its largest force on a contact point [N].
    pub largest_force: f64,
    /// The energy that its forces took from the hand [J]: the sum of `−F·Δx` where it is
    /// positive, with the motion `Δx` of the device during the tick in which the force `F` is
    /// held.
    pub taken: f64,
    /// The energy that its forces gave to the hand [J]: the sum of `F·Δx` where it is positive.
    pub given: f64,
}

/// Counts during a run, in preallocated memory.
#[derive(Clone, Debug)]
pub(crate) struct GuideTally {
    reports: Vec<GuideReport>,
    ticks: Vec<u64>,
    /// The device point of each contact point in the last tick [m].
    places: Vec<Option<Point<3>>>,
    /// The force of each guide at each contact point in the last tick [N], guides of a point
    /// together.
    forces: Vec<Vector<f64, 3>>,
}

impl GuideTally {
    pub(crate) fn new(servo: &Servo) -> Self {
        // A device that gives no force is not guided.
        let is_felt = servo.protection().profile.max_force > 0.0;
        let all = if is_felt { servo.guides(0) } else { &[] };
        let (points, guides) = (servo.touches().len(), all.len());
        let report =
            |guide: &Guide| GuideReport { kind: guide.kind_name(), ..GuideReport::default() };
        Self {
            reports: all.iter().map(report).collect(),
            ticks: vec![0; guides],
            places: vec![None; points],
            forces: vec![Vector::ZERO; points * guides],
        }
    }

    /// Counts a tick.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn tick(&mut self, servo: &Servo) {
        let guides = self.reports.len();
        if guides == 0 {
            return;
        }
        let per_metre = 1.0 / servo.protection().map.scale();
        let points = (0..).zip(servo.touches()).zip(&mut self.places);
        for (((point, touch), place), forces) in
            points.zip(self.forces.chunks_exact_mut(guides))
        {
            let here = Some(touch.device).filter(|device| device.is_finite());
            let way =
                place.zip(here).map_or(Vector::ZERO, |(last, here)| here - last) * per_metre;
            *place = here;
            let seen = servo.guides(point).iter().zip(forces).zip(&mut self.reports);
            for ((guide, force), report) in seen {
                let work = force.dot(way);
                report.given += work.max(0.0);
                report.taken += (-work).max(0.0);
                *force = guide.last_force();
                report.largest_force = report.largest_force.max(force.norm());
            }
        }
        for (guide, ticks) in self.ticks.iter_mut().enumerate() {
            let holds =
                |point: u32| servo.guides(point).get(guide).is_some_and(|g| g.is_engaged());
            *ticks += u64::from((0..servo.touches().len() as u32).any(holds));
        }
    }

    /// The reports, in the order of the servo's guides.
    pub(crate) fn reports(&self, rate: f64) -> Vec<GuideReport> {
        let of = |(report, ticks): (&GuideReport, &u64)| GuideReport {
            time: *ticks as f64 / rate,
            ..*report
        };
        self.reports.iter().zip(&self.ticks).map(of).collect()
    }
}

/// Forces below this are not felt [N]: a hundredth of the weight of a gram.
const FELT: f64 = 1e-4;

/// A contact point that is inside a body in the first tick of a run.
///
/// A proxy follows from outside; of a point that begins inside, none is known. As soon as one is
/// found outside the body, the force rises from zero; until then, or until the point leaves, there
/// is none.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct StartInside {
    /// The number of the contact point, from 0.
    pub point: u32,
    /// The index of the body.
    pub body: u32,
    /// How deep the point itself, not its probe, is in the body [m]: `−f`, with the field f of the
    /// body.
    pub depth: f64,
    /// Ticks from the start without a force, as long as the point has not left the body.
    pub ticks_without_force: u64,
    /// The time of these ticks [s].
    pub time_without_force: f64,
    /// `true` if a force was felt before the point left: more than 0.1 mN.
    pub is_felt: bool,
    /// `true` if point and probe left the body during the run.
    pub has_left: bool,
}

/// The points that begin inside, in preallocated memory.
#[derive(Clone, Debug)]
pub(crate) struct StartTally {
    starts: Vec<Option<StartInside>>,
    has_begun: bool,
}

impl StartTally {
    pub(crate) fn new(points: usize) -> Self {
        Self { starts: vec![None; points], has_begun: false }
    }

    /// Counts a tick. A point that began inside costs an evaluation of the bodies about it in
    /// each tick until it has left.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic unless a custom field does.
    pub(crate) fn tick(&mut self, servo: &Servo) {
        let is_first = !std::mem::replace(&mut self.has_begun, true);
        let radius = if servo.tool().is_some() { 0.0 } else { servo.options().probe.radius() };
        for ((point, touch), start) in (0..).zip(servo.touches()).zip(&mut self.starts) {
            if is_first && touch.device.is_finite() {
                let (value, nearest) = servo.bodies().everything().nearest(touch.device);
                *start = (value < 0.0).then_some(StartInside {
                    point,
                    body: nearest,
                    depth: -value,
                    ticks_without_force: 0,
                    time_without_force: 0.0,
                    is_felt: false,
                    has_left: false,
                });
            }
            let Some(start) = start.as_mut().filter(|start| !start.has_left) else { continue };
            let value = |at| servo.bodies().everything().nearest(at).0;
            start.has_left = !touch.contact && value(touch.device) >= radius;
            if start.has_left {
                continue;
            }
            start.is_felt |= touch.force.norm() > FELT;
            start.ticks_without_force += u64::from(!start.is_felt);
        }
    }

    /// The points that began inside.
    pub(crate) fn reports(&self, rate: f64) -> Vec<StartInside> {
        let of = |start: &StartInside| StartInside {
            time_without_force: start.ticks_without_force as f64 / rate,
            ..*start
        };
        self.starts.iter().flatten().map(of).collect()
    }
}

/// How fast the crests of height textures passed under the hand.
///
/// A texture fades where its crests pass faster than a quarter of the rate
/// ([`Passing`](crate::Passing)).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct TextureReport {
    /// Ticks in which a contact point touched a height texture.
    pub ticks: u64,
    /// Ticks in which the texture of a contact point was rendered in part, or not at all.
    pub faded_ticks: u64,
    /// The most crests that passed a second [Hz].
    pub highest_frequency: f64,
    /// The rate at which all of it would have been rendered in full [Hz].
    pub wanted_rate: f64,
}

impl TextureReport {
    /// Counts a tick.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn tick(&mut self, servo: &Servo) {
        let (bodies, rate) = (servo.bodies().bodies(), servo.options().rate);
        let (mut is_touched, mut is_faded) = (false, false);
        for touch in servo.touches().iter().filter(|touch| touch.contact) {
            let body = bodies.get(touch.body as usize);
            let passing =
                body.and_then(|body| body.passing(touch.velocity, touch.normal, rate));
            let Some(passing) = passing else { continue };
            is_touched = true;
            is_faded |= passing.part < 1.0;
            self.highest_frequency = self.highest_frequency.max(passing.frequency);
            self.wanted_rate = self.wanted_rate.max(passing.wanted_rate());
        }
        self.ticks += u64::from(is_touched);
        self.faded_ticks += u64::from(is_faded);
    }
}

/// The report of a rigid tool in a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct ToolReport {
    /// Points of its shell.
    pub points: u32,
    /// The largest distance of the tool's surface from the balls of the whole shell [m].
    pub resolution: f64,
    /// The coupling's stiffness [N/m].
    pub stiffness: f64,
    /// The coupling's damping [N·s/m].
    pub damping: f64,
    /// The largest torque that was wanted on the hand [N·m], in the world.
    pub largest_torque: f64,
    /// The largest torque written to a device with rotation [N·m], in the world as well: at the
    /// device it is as [`TurningReport`](palpate_safety::TurningReport) says. `None` for other
    /// devices.
    pub largest_torque_written: Option<f64>,
    /// The most contacts that pushed in a tick.
    pub most_contacts: u32,
    /// The mean number of pushing contacts in ticks with contact.
    pub mean_contacts: f64,
    /// Ticks whose budget did not allow all levels of the shell.
    pub degraded_ticks: u64,
    /// The largest distance of the tool's surface from balls that were proven outside, in the
    /// worst tick in which the tool was not covered [m].
    pub coarsest_resolution: f64,
    /// Ticks in which bodies covered the tool.
    pub covered_ticks: u64,
}

/// Counts during a run.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ToolTally {
    report: ToolReport,
    contacts: u64,
    contact_ticks: u64,
}

impl ToolTally {
    /// Counts a tick with the torque written to a device with rotation, in the world.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn tick(&mut self, tool: &Tool, written: Option<Vector<f64, 3>>) {
        let (held, shell, report) = (tool.held(), tool.shell(), &mut self.report);
        report.points = shell.points().len() as u32;
        report.resolution = shell.resolution(shell.points().len());
        report.stiffness = tool.coupling().stiffness;
        report.damping = tool.coupling().damping;
        report.largest_torque = report.largest_torque.max(held.torque.norm());
        if let Some(written) = written {
            let largest = report.largest_torque_written.unwrap_or(0.0).max(written.norm());
            report.largest_torque_written = Some(largest);
        }
        report.most_contacts = report.most_contacts.max(held.contacts);
        report.degraded_ticks += u64::from(held.is_degraded);
        report.covered_ticks += u64::from(held.is_covered);
        if held.resolution.is_finite() {
            report.coarsest_resolution = report.coarsest_resolution.max(held.resolution);
        }
        self.contacts += u64::from(held.contacts);
        self.contact_ticks += u64::from(held.contacts > 0);
    }

    pub(crate) fn report(&self) -> ToolReport {
        let ticks = self.contact_ticks.max(1) as f64;
        ToolReport { mean_contacts: self.contacts as f64 / ticks, ..self.report }
    }
}

#[cfg(test)]
mod texture_report_tests {
    use super::*;
    use crate::{
        Bodies, Body, Material, Protection, Servo, ServoOptions, Surface, Texture, TextureKind,
    };
    use palpate_device::{DeviceProfile, PointState};
    use palpate_field::kernel::HalfSpace;
    use palpate_field::{Shape, Vector};

    fn servo() -> Servo {
        let texture = Texture {
            description: None,
            kind: TextureKind::Height,
            amplitude: 1e-5,
            wavelength: 1e-3,
            direction: Some(vec![1.0, 0.0, 0.0]),
        };
        let grooved = Material { texture: Some(texture), ..Material::default() };
        let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0, 0.0]), 0.0).unwrap());
        let floor = Body::new(floor, Surface::new(&grooved).unwrap()).unwrap();
        let bodies = Bodies::new(vec![floor]).unwrap();
        let servo = Servo::new(bodies, 1, ServoOptions::default()).unwrap();
        servo.protected(&Protection::new(DeviceProfile::unlimited("none"))).unwrap()
    }

    #[test]
    fn ticks_are_counted_by_what_was_rendered_of_the_texture() {
        let (mut servo, mut report) = (servo(), TextureReport::default());
        // 10 mm above, then 1 mm deep at 200, 300 and 600 crests a second.
        for (height, speed) in [(0.01, 0.6), (-0.001, 0.2), (-0.001, 0.3), (-0.001, 0.6)] {
            let velocity = Vector([speed, 0.0, 0.0]);
            servo.step(&[PointState { position: Vector([0.0, height, 0.0]), velocity }]);
            report.tick(&servo);
        }
        assert_eq!((report.ticks, report.faded_ticks), (3, 2));
        assert!((report.highest_frequency - 600.0).abs() < 1e-9);
        assert!((report.wanted_rate - 2400.0).abs() < 1e-9);
    }
}
