// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! One scene with the servo that renders it, and the hand that feels it.

use std::sync::{Arc, Mutex, PoisonError};

use palpate::device::DeviceProfile;
use palpate::field::Point;
use palpate::haptics::{Event, HapticsError, StopSwitch};
use palpate::safety::{Recovery, SafetySettings, StageEffects, WorkspaceMap};
use palpate::sim::{Hand, HandPath, SimulatedDevice, SteeredDevice, Steering};

use palpate::scene::{BuiltScene, BuiltTool, ServoSettings};
use palpate::servo_loop::{
    ClockSpeed, Ending, Priority, Records, ScaledClock, ServoThread, ThreadOptions, TraceRow,
    VirtualClock,
};

use super::hand::{Lead, Leader};
use super::pages::point_in_space;
use super::trace::Replay;
use crate::wire::{Frame, FramePoint};

/// The fastest that a hand follows the page, at the device [m/s].
const FASTEST: f64 = 1.0;

/// The most contact points of a hand.
pub(crate) const MOST_POINTS: usize = 100;

/// How long rows wait to be taken [s].
const KEPT: f64 = 1.0;

/// A scene that is felt.
#[derive(Debug)]
pub(super) struct Room {
    /// The dimension of its scene.
    dimension: usize,
    /// Dropped before the thread, so that a clock that is held lets it end.
    speed: ClockSpeed,
    thread: ServoThread,
    records: Records,
    steering: Steering,
    map: WorkspaceMap,
    lead: Lead,
    /// The largest values since the last frame.
    peaks: Peaks,
    leader: Leader,
    /// Whether the servo was told that the hand is lifted.
    is_lifted: bool,
    /// What the safety chain had done by the last frame.
    safety: StageEffects,
}

/// The largest values since the last frame.
#[derive(Debug, Default)]
struct Peaks {
    depth: f64,
    cost_ns: u64,
    lateness_ns: u64,
    evaluations: u32,
    /// Of each contact point [N].
    forces: Vec<f64>,
    /// Of each contact point: taken, given and kept so far [J].
    energies: Vec<[f64; 3]>,
}

/// What is kept when another scene is opened.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kept {
    speed: f64,
    is_touring: bool,
}

/// A clock that the first servo takes; the machine's clock where none is given.
#[derive(Clone, Debug, Default)]
pub struct GivenClock(Arc<Mutex<Option<VirtualClock>>>);

impl From<VirtualClock> for GivenClock {
    fn from(clock: VirtualClock) -> Self {
        Self(Arc::new(Mutex::new(Some(clock))))
    }
}

/// What a room is made for.
#[derive(Clone, Debug)]
pub(super) struct Terms {
    pub(super) profile: DeviceProfile,
    pub(super) rate: f64,
    /// The contact points of a hand that a scene's tool does not give.
    pub(super) points: usize,
    /// The clock of the first servo; the machine's if `None`, or if it is taken.
    pub(super) clock: GivenClock,
}

impl Room {
    /// Begins to feel a scene, with what is kept of the room before; by its hand, if the room of the same
    /// scene is there.
    pub(super) fn begin<const D: usize>(
        scene: &BuiltScene<D>,
        terms: &Terms,
        before: Option<&Self>,
        kept: Option<Kept>,
        stop: StopSwitch,
    ) -> Result<Self, String> {
        let said = |error: HapticsError| error.to_string();
        let tool = scene.tool.as_ref().map_or(Ok(None), BuiltTool::in_hand).map_err(said)?;
        let map = scene.workspace_of(&terms.profile, tool.as_ref()).map_err(said)?;
        let mut lead = Lead::new(scene, terms.points, map.scale());
        let points = lead.targets().len();
        if points > MOST_POINTS {
            return Err(format!(
                "the hand of a page has at most {MOST_POINTS} contact points, got {points}"
            ));
        }
        if let Some(kept) = kept {
            lead.set_touring(kept.is_touring);
        }
        if let Some(before) = before {
            lead.take_over(&before.lead);
        }
        let (device, steering) =
            device(&lead, &map, terms).map_err(|error| error.to_string())?;
        // A hand that goes into a body while forces are zero would be thrown out by them. A body that
        // moves onto a hand pushes it out at once all the same.
        let safety =
            SafetySettings { recovery: Recovery::OnceOut, ..SafetySettings::default() };
        let settings = ServoSettings { rate: terms.rate, safety, ..ServoSettings::default() };
        let servo = scene.servo_with(&device, settings).map_err(said)?;
        let (clock, speed) = ScaledClock::new(&Priority::Normal);
        let clock = clock.heeding(stop.clone());
        // A clock that is held or slow stays so.
        speed.set(kept.map_or(1.0, |kept| kept.speed)).map_err(|error| error.to_string())?;
        let rows = (KEPT * terms.rate) as usize * lead.targets().len();
        let mut options = ThreadOptions {
            stop_switch: Some(stop),
            rows: Some(rows),
            ..ThreadOptions::default()
        };
        if !scene.motions.is_empty() {
            options = options.with_motion(scene.motion());
        }
        let given = terms.clock.0.lock().unwrap_or_else(PoisonError::into_inner).take();
        let device = Box::new(device);
        let thread = match given {
            Some(given) => ServoThread::start_on(given, servo, device, options),
            None => ServoThread::start_on(clock, servo, device, options),
        };
        let mut thread = thread.map_err(|error| error.to_string())?;
        let records = thread.take_records().ok_or("the servo keeps no rows")?;
        let (peaks, leader, is_lifted) = (Peaks::default(), Leader::default(), false);
        let safety = StageEffects::default();
        let mut room = Self {
            dimension: D,
            speed,
            thread,
            records,
            steering,
            map,
            lead,
            peaks,
            leader,
            is_lifted,
            safety,
        };
        room.steer();
        Ok(room)
    }

    /// Hands the places to which the hand is led to the device, and whether it is lifted to the servo.
    fn steer(&mut self) {
        let is_lifted = self.lead.is_lifted();
        if std::mem::replace(&mut self.is_lifted, is_lifted) != is_lifted {
            self.thread.control().lift(is_lifted);
        }
        let place = |target: &Point<3>| self.map.point_to_device(*target);
        let targets: Vec<_> = self.lead.targets().iter().map(place).collect();
        // There is a target for each hand, and all are finite.
        let _ = self.steering.steer(&targets);
    }

    /// The dimension of its scene.
    pub(super) fn dimension(&self) -> usize {
        self.dimension
    }

    pub(super) fn speed(&self) -> &ClockSpeed {
        &self.speed
    }

    /// Tells the hand whether forces are stopped.
    pub(super) fn set_stopped(&mut self, is_stopped: bool) {
        self.lead.set_stopped(is_stopped);
    }

    pub(super) fn has_ended(&self) -> bool {
        self.thread.has_ended()
    }

    pub(super) fn points(&self) -> usize {
        self.lead.targets().len()
    }

    /// Hands the bodies of another scene to the servo, which goes on; and its guides, if they are new:
    /// guides that stay keep their hold of the hand.
    pub(super) fn replace<const D: usize>(
        &mut self,
        scene: &BuiltScene<D>,
        has_new_guides: bool,
    ) -> Result<(), String> {
        let said = |error: HapticsError| error.to_string();
        let control = self.thread.control();
        control.replace_bodies(scene.bodies().map_err(said)?).map_err(said)?;
        if has_new_guides {
            control.replace_guides(&scene.guides).map_err(said)?;
        }
        self.lead.take_scene(scene);
        Ok(())
    }

    /// Leads the hand, or one of its contact points, to a place in the world [m].
    pub(super) fn lead(
        &mut self,
        target: &[f64],
        point: Option<usize>,
        from: Option<&[f64]>,
    ) -> Result<(), String> {
        let place = |numbers| point_in_space(numbers, self.dimension);
        let (target, from) = (place(target)?, from.map(place).transpose()?);
        self.lead.lead(target, point, from)?;
        self.steer();
        Ok(())
    }

    /// Lets go of the hand, where bodies hold it back.
    pub(super) fn let_go(&mut self) {
        let proxies: Vec<_> = match self.thread.control().latest() {
            Some(snapshot) => snapshot.touches.iter().map(|touch| touch.proxy).collect(),
            None => Vec::new(),
        };
        self.lead.let_go(&proxies);
        self.steer();
    }

    /// Starts to lead the hand along a path of each contact point, or ends it.
    pub(super) fn replay(&mut self, replay: Option<Arc<Replay>>) -> Result<(), String> {
        self.lead.replay(replay)
    }

    /// In how many ticks each stage of the safety chain has acted.
    pub(super) fn safety(&mut self) -> StageEffects {
        self.thread.control().latest().map_or(StageEffects::default(), |latest| latest.safety)
    }

    pub(super) fn take_tour(&mut self, tour: HandPath) {
        self.lead.take_tour(tour);
    }

    pub(super) fn kept(&self) -> Kept {
        Kept { speed: self.speed.get(), is_touring: self.lead.is_touring() }
    }

    /// Sets whether a hand that nobody leads goes on its tour. Where it leaves a tour, it rests where
    /// bodies hold it back.
    pub(super) fn set_touring(&mut self, is_touring: bool) {
        self.lead.set_touring(is_touring);
        if self.leader == Leader::Tour && !is_touring {
            self.let_go();
        }
    }

    /// Waits until the servo has ended, and tells why, in words.
    pub(super) fn ending(self) -> String {
        match self.thread.join().report.ending {
            Ending::DeviceLost { reason } => reason,
            Ending::Panicked { message } => message,
            _ => "its time was over".to_owned(),
        }
    }

    /// Leads the hand on, and takes the rows of the ticks since; `row` gets each.
    pub(super) fn go_on(&mut self, mut row: impl FnMut(&TraceRow)) {
        let (time, devices) = match self.thread.control().latest() {
            Some(snapshot) => {
                let devices = snapshot.touches.iter().map(|touch| touch.device);
                (snapshot.progress.time, devices.collect())
            }
            None => (0.0, Vec::new()),
        };
        let before = std::mem::replace(&mut self.leader, self.lead.go_on(time, &devices));
        if before == Leader::Replay && self.leader == Leader::Page && !self.lead.is_held() {
            // What was recorded may end in a body.
            self.let_go();
        }
        self.steer();
        for new in self.records.take() {
            self.peaks.take(&new);
            row(&new);
        }
    }

    pub(super) fn next_event(&mut self) -> Option<Event> {
        self.thread.control().next_event()
    }

    /// The state after the last tick, with the largest values since the last frame; `None` before
    /// the first tick.
    pub(super) fn frame(&mut self) -> Option<Frame> {
        let lost = self.records.lost();
        let is_held = self.speed.get() == 0.0;
        let leader = self.leader;
        let snapshot = self.thread.control().latest()?;
        let peaks = std::mem::take(&mut self.peaks);
        let safety = std::mem::replace(&mut self.safety, snapshot.safety);
        let point = |(number, touch): (usize, &palpate::haptics::Touch)| FramePoint {
            vectors: [touch.device, touch.proxy, touch.force, touch.wanted, touch.normal]
                .map(|vector| vector.0),
            depth: touch.depth(),
            largest_force: peaks.forces.get(number).copied().unwrap_or_default(),
            body: touch.body,
            is_in_contact: touch.contact,
            is_slipping: touch.is_slipping,
        };
        let energy = peaks.energies.iter().fold([0.0; 3], |all: [f64; 3], of_point| {
            std::array::from_fn(|kind| all[kind] + of_point[kind])
        });
        let frame = Frame {
            dimension: self.dimension as u8,
            is_stopped: snapshot.is_stopped,
            is_lifted: snapshot.is_lifted,
            is_held,
            has_acted: safety != snapshot.safety,
            is_touring: leader == Leader::Tour,
            is_replaying: leader == Leader::Replay,
            ticks: snapshot.progress.ticks,
            time: snapshot.progress.time,
            force: peaks.forces.iter().copied().fold(snapshot.progress.force, f64::max),
            depth: peaks.depth.max(snapshot.progress.depth),
            cost: 1e-9 * peaks.cost_ns as f64,
            lateness: 1e-9 * peaks.lateness_ns as f64,
            energy,
            evaluations: peaks.evaluations,
            lost: snapshot.events_lost + lost,
            points: snapshot.touches.iter().enumerate().map(point).collect(),
            ..Frame::default()
        };
        // Energies are sums since the start: they stay where no tick came.
        self.peaks.energies = peaks.energies;
        Some(frame)
    }
}

impl Peaks {
    fn take(&mut self, row: &TraceRow) {
        let point = row.point as usize;
        if self.forces.len() <= point {
            self.forces.resize(point + 1, 0.0);
        }
        if self.energies.len() <= point {
            self.energies.resize(point + 1, [0.0; 3]);
        }
        self.forces[point] = self.forces[point].max(row.force.norm());
        self.energies[point] = [row.energy.taken, row.energy.given, row.energy.kept];
        if row.contact {
            self.depth = self.depth.max((row.proxy - row.device).norm());
        }
        self.cost_ns = self.cost_ns.max(row.cost_ns);
        self.lateness_ns = self.lateness_ns.max(row.lateness_ns);
        self.evaluations = self.evaluations.max(row.evaluations);
    }
}

type Steered = (SteeredDevice, Steering);

/// The device, with a hand for each contact point.
fn device(
    lead: &Lead,
    map: &WorkspaceMap,
    terms: &Terms,
) -> Result<Steered, palpate::sim::SimulationError> {
    let hand = |place: &Point<3>| Hand::resting(map.point_to_device(*place));
    let hands = lead.targets().iter().map(hand).collect::<Result<_, _>>()?;
    SteeredDevice::new(SimulatedDevice::new(terms.profile.clone(), hands)?, FASTEST)
}
