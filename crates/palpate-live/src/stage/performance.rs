// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The thread that leads the hand, and tells the pages what the servo does.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender};
use std::time::{Duration, Instant};

use axum::body::Bytes;
use palpate::devices::HandPath;
use palpate::haptics::{Event, StageTicks};
use palpate::scene::{AnyScene, BuiltScene};
use palpate::servo_loop::TraceRow;
use serde_json::{Value, json};
use tokio::sync::watch;

use super::Stop;
use super::pages::{PageId, Pages};
use super::room::{Room, Terms};
use crate::wire::{Frame, trace};

/// How often the hand is led on.
const STEP: Duration = Duration::from_millis(8);

/// The steps from one frame to the next: 60 frames a second.
const STEPS_A_FRAME: u32 = 2;

/// The most rows that are recorded: 20 s of ten points at 1 kHz.
const MOST_ROWS: usize = 200_000;

/// The answer before the first scene, and after a servo has ended.
const NO_SERVO: &str = "there is no servo yet: say hello, or edit the scene";

/// Frames from one message on the safety chain to the next: a quarter of a second at least, and 2 s
/// where nothing is new, for pages that came meanwhile.
const SAFETY_FRAMES: u32 = 15;
const AGAIN_FRAMES: u32 = 120;

/// The most events that are told at once.
const MOST_EVENTS: usize = 100;

/// What the thread is asked to do.
#[derive(Debug)]
pub(crate) enum Order {
    Lead {
        page: PageId,
        id: Option<u32>,
        target: Vec<f64>,
        point: Option<usize>,
        from: Option<Vec<f64>>,
    },
    LetGo,
    /// A page is closed, which may have led the hand.
    Gone(PageId),
    /// All forces were set to zero: a servo whose clock is held takes note by a tick.
    Stopped,
    Tour(bool),
    /// The way of the hand over the scene of a revision.
    Path {
        path: AnyPath,
        revision: u32,
    },
    Clock {
        page: PageId,
        id: Option<u32>,
        speed: Option<f64>,
        step: Option<u32>,
    },
    Record(bool),
    /// Follows what was recorded or taken last.
    Replay {
        page: PageId,
        id: Option<u32>,
        on: bool,
    },
    /// Takes paths to be replayed.
    Paths(AnyPaths),
    /// What was recorded, as a file.
    Trace(SyncSender<Trace>),
    /// Renders another scene; with only its bodies changed if `is_alike`.
    Show {
        scene: Arc<AnyScene>,
        revision: u32,
        is_alike: bool,
        reply: SyncSender<Showing>,
    },
    End,
}

/// How a scene came to be rendered.
#[derive(Debug)]
pub(crate) enum Showing {
    /// The servo goes on with other bodies.
    Replaced,
    /// A servo ended, if there was one, and this one began.
    Began { points: usize },
    /// The scene cannot be rendered; the one before is still.
    Refused(String),
}

/// A hand path of either dimension.
#[derive(Debug)]
pub(crate) enum AnyPath {
    Planar(HandPath<2>),
    Spatial(HandPath<3>),
}

/// A path of each contact point, of either dimension.
#[derive(Debug)]
pub(crate) enum AnyPaths {
    Planar(Vec<HandPath<2>>),
    Spatial(Vec<HandPath<3>>),
}

/// Rows as text, made where there is time for it.
pub(crate) type Trace = Box<dyn FnOnce() -> Vec<u8> + Send>;

/// A room of either dimension, with what is recorded in it.
#[derive(Debug)]
enum AnyRoom {
    Planar(Room<2>, Vec<TraceRow<2>>),
    Spatial(Room<3>, Vec<TraceRow<3>>),
}

/// Runs an expression for the room of either dimension.
macro_rules! in_room {
    ($any:expr, $room:ident, $rows:ident => $work:expr) => {
        match $any {
            AnyRoom::Planar($room, $rows) => $work,
            AnyRoom::Spatial($room, $rows) => $work,
        }
    };
}

/// The state of the thread.
#[derive(Debug)]
pub(super) struct Performance {
    terms: Terms,
    stop: Arc<Stop>,
    pages: Arc<Pages>,
    frames: watch::Sender<Bytes>,
    room: Option<AnyRoom>,
    revision: u32,
    is_recording: bool,
    /// Paths to be replayed instead of what was recorded.
    paths: Option<AnyPaths>,
    /// What the pages were told last of the safety chain, and how many frames ago.
    safety: (StageTicks, u32),
    /// The page that leads the hand.
    leader: Option<PageId>,
}

impl Performance {
    pub(super) fn new(
        terms: Terms,
        stop: Arc<Stop>,
        pages: Arc<Pages>,
        frames: watch::Sender<Bytes>,
    ) -> Self {
        Self {
            terms,
            stop,
            pages,
            frames,
            room: None,
            revision: 0,
            is_recording: false,
            paths: None,
            safety: (StageTicks::default(), 0),
            leader: None,
        }
    }

    pub(super) fn run(mut self, orders: &Receiver<Order>) {
        let mut next = Instant::now() + STEP;
        let mut steps = 0_u32;
        loop {
            let wait = next.saturating_duration_since(Instant::now());
            match orders.recv_timeout(wait) {
                Ok(Order::End) | Err(RecvTimeoutError::Disconnected) => return,
                Ok(order) => self.obey(order),
                Err(RecvTimeoutError::Timeout) => {}
            }
            let now = Instant::now();
            if now >= next {
                // What was missed is not made up for.
                next = now + STEP;
                steps = steps.wrapping_add(1);
                self.go_on(steps.is_multiple_of(STEPS_A_FRAME));
            }
        }
    }

    fn obey(&mut self, order: Order) {
        match order {
            Order::Lead { page, id, target, point, from } => {
                let Some(room) = &mut self.room else {
                    return self.pages.refuse(page, id, NO_SERVO, &[]);
                };
                let from = from.as_deref();
                match in_room!(room, room, _rows => room.lead(&target, point, from)) {
                    Ok(()) => self.leader = Some(page),
                    Err(why) => return self.pages.refuse(page, id, &why, &[]),
                }
                self.pages.answer(page, id, json!({ "do": "done" }));
            }
            Order::LetGo => self.let_go(),
            Order::Gone(page) => {
                if self.leader == Some(page) {
                    self.let_go();
                }
            }
            Order::Stopped => {
                if let Some(room) = &self.room {
                    let clock = in_room!(room, room, _rows => room.speed());
                    if clock.get() == 0.0 {
                        clock.step(1);
                    }
                }
            }
            Order::Tour(is_touring) => {
                if let Some(room) = &mut self.room {
                    in_room!(room, room, _rows => room.tours(is_touring));
                }
            }
            Order::Path { path, revision } => match (&mut self.room, path) {
                _ if revision != self.revision => {}
                (Some(AnyRoom::Planar(room, _)), AnyPath::Planar(path)) => room.take_tour(path),
                (Some(AnyRoom::Spatial(room, _)), AnyPath::Spatial(path)) => {
                    room.take_tour(path)
                }
                _ => {}
            },
            Order::Clock { page, id, speed, step } => {
                let Some(room) = &self.room else {
                    return self.pages.refuse(page, id, NO_SERVO, &[]);
                };
                let clock = in_room!(room, room, _rows => room.speed());
                match speed.map_or(Ok(()), |speed| clock.set(speed)) {
                    Ok(()) => {
                        clock.step(u64::from(step.unwrap_or_default()));
                        self.pages.answer(page, id, json!({ "do": "done" }));
                    }
                    Err(why) => self.pages.refuse(page, id, &why.to_string(), &[]),
                }
            }
            Order::Record(is_recording) => {
                if let Some(room) = &mut self.room
                    && is_recording
                    && !self.is_recording
                {
                    in_room!(room, _room, rows => rows.clear());
                    self.paths = None;
                }
                if self.is_recording && !is_recording {
                    // What was recorded last is newer than a trace that came meanwhile.
                    self.paths = None;
                }
                self.is_recording = is_recording;
            }
            Order::Replay { page, id, on } => match self.replay(on) {
                Ok(()) => self.pages.answer(page, id, json!({ "do": "done" })),
                Err(why) => self.pages.refuse(page, id, &why, &[]),
            },
            Order::Paths(paths) => self.paths = Some(paths),
            Order::Trace(reply) => {
                let trace = match &self.room {
                    Some(room) => in_room!(room, _room, rows => {
                        let rows = rows.clone();
                        Box::new(move || trace::written(&rows)) as Trace
                    }),
                    None => Box::new(Vec::new),
                };
                // Who asked may have gone.
                let _ = reply.send(trace);
            }
            Order::Show { scene, revision, is_alike, reply } => {
                let showing = self.show(&scene, is_alike);
                if !matches!(showing, Showing::Refused(_)) {
                    self.revision = revision;
                }
                let _ = reply.send(showing);
            }
            Order::End => {}
        }
    }

    /// Leads the hand along what was taken or recorded last; or no longer.
    fn replay(&mut self, is_on: bool) -> Result<(), String> {
        let Some(room) = &mut self.room else { return Err(NO_SERVO.to_owned()) };
        if !is_on {
            return in_room!(room, room, _rows => room.replay(None));
        }
        (self.leader, self.is_recording) = (None, false);
        match (room, &self.paths) {
            (AnyRoom::Planar(room, _), Some(AnyPaths::Planar(paths))) => {
                room.replay(Some(paths.clone()))
            }
            (AnyRoom::Spatial(room, _), Some(AnyPaths::Spatial(paths))) => {
                room.replay(Some(paths.clone()))
            }
            (_, Some(_)) => Err("the trace is of a scene of another dimension".to_owned()),
            (room, None) => in_room!(room, room, rows => {
                let paths = trace::paths(rows)?;
                room.replay(Some(paths))
            }),
        }
    }

    fn let_go(&mut self) {
        self.leader = None;
        if let Some(room) = &mut self.room {
            in_room!(room, room, _rows => room.let_go());
        }
    }

    fn show(&mut self, scene: &AnyScene, is_alike: bool) -> Showing {
        let replaced = match (&mut self.room, scene) {
            (Some(AnyRoom::Planar(room, _)), AnyScene::Planar(scene)) if is_alike => {
                room.replace(Arc::new(scene.clone()))
            }
            (Some(AnyRoom::Spatial(room, _)), AnyScene::Spatial(scene)) if is_alike => {
                room.replace(Arc::new(scene.clone()))
            }
            _ => Err(String::new()),
        };
        if replaced.is_ok() {
            return Showing::Replaced;
        }
        let began = match scene {
            AnyScene::Planar(scene) => {
                let before = match &self.room {
                    Some(AnyRoom::Planar(room, _)) => Some(room),
                    _ => None,
                };
                self.begun(scene, before).map(|room| AnyRoom::Planar(room, Vec::new()))
            }
            AnyScene::Spatial(scene) => {
                let before = match &self.room {
                    Some(AnyRoom::Spatial(room, _)) => Some(room),
                    _ => None,
                };
                self.begun(scene, before).map(|room| AnyRoom::Spatial(room, Vec::new()))
            }
        };
        match began {
            Ok(mut room) => {
                self.stop.take(in_room!(&mut room, room, _rows => room.stop_switch()));
                let points = in_room!(&room, room, _rows => room.points());
                self.room = Some(room);
                Showing::Began { points }
            }
            Err(why) => Showing::Refused(why),
        }
    }

    fn begun<const D: usize>(
        &self,
        scene: &BuiltScene<D>,
        before: Option<&Room<D>>,
    ) -> Result<Room<D>, String> {
        Room::begin(Arc::new(scene.clone()), &self.terms, before, self.stop.is_stopped())
    }

    fn go_on(&mut self, is_frame: bool) {
        let is_recording = self.is_recording;
        let Some(room) = &mut self.room else { return };
        if in_room!(room, room, _rows => room.has_ended()) {
            let message = "the servo has ended with zero forces; the next edit begins another";
            self.pages.broadcast(&json!({ "do": "notice", "message": message }));
            self.room = None;
            return;
        }
        let (mut events, mut frame): (Vec<Event>, Option<Frame>) = (Vec::new(), None);
        let mut safety = self.safety.0;
        let is_full = in_room!(room, room, rows => {
            room.go_on(|row| if is_recording && rows.len() < MOST_ROWS {
                rows.push(*row);
            });
            if is_frame {
                events.extend(std::iter::from_fn(|| room.next_event()).take(MOST_EVENTS));
                frame = room.frame();
                safety = room.safety();
            }
            rows.len() >= MOST_ROWS
        });
        if is_recording && is_full {
            self.is_recording = false;
            let message = format!("the recording is full: {MOST_ROWS} rows");
            self.pages.broadcast(&json!({ "do": "notice", "message": message }));
        }
        if !events.is_empty() {
            self.pages.broadcast(&json!({ "do": "events", "events": events }));
        }
        self.tell_safety(safety, is_frame);
        if let Some(mut frame) = frame {
            (frame.revision, frame.is_recording) = (self.revision, self.is_recording);
            // Nobody may look.
            let _ = self.frames.send(frame.bytes());
        }
    }

    /// Tells the pages what the safety chain did, if that is new and not told too often.
    fn tell_safety(&mut self, now: StageTicks, is_frame: bool) {
        let (told, frames) = &mut self.safety;
        *frames = frames.saturating_add(u32::from(is_frame));
        if *frames < SAFETY_FRAMES || *told == now && *frames < AGAIN_FRAMES {
            return;
        }
        self.safety = (now, 0);
        self.pages.broadcast(&safety_message(&now));
    }
}

/// What the safety chain did.
fn safety_message(ticks: &StageTicks) -> Value {
    let stage = |(name, ticks)| json!({ "name": name, "ticks": ticks });
    json!({ "do": "safety", "stages": ticks.named().map(stage).collect::<Vec<_>>() })
}
