// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The thread that leads the hand, and tells the pages what the servo does.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender};
use std::time::{Duration, Instant};

use palpate::haptics::Event;
use palpate::safety::StageEffects;
use palpate::scene::{AnyScene, BuiltScene};
use palpate::sim::HandPath;
use tokio::sync::watch;
use tungstenite::Bytes;

use super::Shared;
use super::heartbeat::Heartbeat;
use super::inquiry::Inquiries;
use super::pages::{PageId, Pages};
use super::recording::{MOST_ROWS, Recording, Trace};
use super::room::{Room, Terms};
use super::stop::Stops;
use super::trace::Replay;
use crate::wire::{Frame, StageTold, Told};

/// How often the hand is led on.
const STEP: Duration = Duration::from_millis(8);

/// The steps from one frame to the next: 62 frames a second.
const STEPS_A_FRAME: u32 = 2;

/// The answer before the first scene, and after a servo has ended.
const NO_SERVO: &str = "no servo runs: the next edit of the scene begins one";

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
    /// Gives forces again after a stop.
    Release {
        page: PageId,
        id: Option<u32>,
        number: Option<u64>,
    },
    /// Tells a new page of the stop that holds.
    TellStop(PageId),
    Tour(bool),
    /// The tour of the scene of a revision.
    TakeTour {
        path: HandPath,
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
    /// Takes what is to be replayed.
    TakeReplay(Replay),
    /// What was recorded, as a file.
    Trace(SyncSender<Option<Trace>>),
    /// Renders another scene.
    Show {
        scene: Arc<AnyScene>,
        revision: u32,
        change: Changed,
        reply: SyncSender<Showing>,
    },
    End,
}

/// What of a scene changed at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd)]
pub(crate) enum Changed {
    /// Its bodies, which are handed to the servo.
    Bodies,
    /// Its guides too, which are handed likewise.
    Guides,
    /// What a servo is made for.
    Servo,
    /// Everything: another scene was opened.
    Scene,
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

/// The state of the thread.
#[derive(Debug)]
pub(super) struct Performance {
    terms: Terms,
    stops: Stops,
    pages: Arc<Pages>,
    /// The number of open pages that the pages were told last.
    clients: usize,
    frames: watch::Sender<Bytes>,
    heartbeat: Heartbeat,
    inquiries: Arc<Inquiries>,
    /// The last frame, which goes on beating when its servo has ended.
    frame: Option<Frame>,
    room: Option<Room>,
    revision: u32,
    /// The revision with which the servo began.
    began: u32,
    recording: Recording,
    /// Ticks that a clock that is held still has to go.
    ticks: u64,
    /// What the pages were told last of the safety chain, and how many frames ago.
    safety: (StageEffects, u32),
    /// The page that leads the hand.
    leader: Option<PageId>,
}

impl Performance {
    pub(super) fn new(
        terms: Terms,
        stops: Stops,
        frames: watch::Sender<Bytes>,
        shared: &Shared,
    ) -> Self {
        let Shared { pages, inquiries, pulse, .. } = shared.clone();
        Self {
            terms,
            stops,
            pages,
            clients: 0,
            frames,
            heartbeat: Heartbeat::new(pulse),
            inquiries,
            frame: None,
            room: None,
            revision: 0,
            began: 0,
            recording: Recording::default(),
            ticks: 0,
            safety: (StageEffects::default(), 0),
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
                self.stops.go_on(now, &self.pages);
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
                match room.lead(&target, point, from) {
                    Ok(()) => self.leader = Some(page),
                    Err(why) => return self.pages.refuse(page, id, &why, &[]),
                }
                self.pages.done(page, id);
            }
            Order::LetGo => self.let_go(),
            Order::Release { page, id, number } => {
                match self.stops.release(page, number, Instant::now(), &self.pages) {
                    Ok(()) => self.pages.done(page, id),
                    Err(why) => self.pages.refuse(page, id, &why, &[]),
                }
            }
            Order::TellStop(page) => self.stops.tell(page, Instant::now(), &self.pages),
            Order::Tour(is_touring) => {
                if let Some(room) = &mut self.room {
                    room.set_touring(is_touring);
                }
            }
            Order::TakeTour { path, revision } => {
                if let Some(room) = self.room.as_mut().filter(|_| revision >= self.began) {
                    room.take_tour(path);
                }
            }
            Order::Clock { page, id, speed, step } => {
                let Some(room) = &self.room else {
                    return self.pages.refuse(page, id, NO_SERVO, &[]);
                };
                let clock = room.speed();
                match speed.map_or(Ok(()), |speed| clock.set(speed)) {
                    Ok(()) => {
                        self.ticks = u64::from(step.unwrap_or_default());
                        self.pages.done(page, id);
                    }
                    Err(why) => self.pages.refuse(page, id, &why.to_string(), &[]),
                }
            }
            Order::Record(is_on) => {
                if let Some(room) = &self.room {
                    self.recording.switch(is_on, room);
                }
            }
            Order::Replay { page, id, on } => match self.replay(on) {
                Ok(()) => self.pages.done(page, id),
                Err(why) => self.pages.refuse(page, id, &why, &[]),
            },
            Order::TakeReplay(replay) => self.recording.take(replay),
            Order::Trace(reply) => {
                // Who asked may have gone.
                let _ = reply.send(self.recording.trace());
            }
            Order::Show { scene, revision, change, reply } => {
                let showing = self.show(&scene, change);
                match showing {
                    Showing::Replaced => self.revision = revision,
                    Showing::Began { .. } => (self.revision, self.began) = (revision, revision),
                    Showing::Refused(_) => {}
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
            return room.replay(None);
        }
        self.recording.replay(room)?;
        self.leader = None;
        Ok(())
    }

    fn let_go(&mut self) {
        self.leader = None;
        if let Some(room) = &mut self.room {
            room.let_go();
        }
    }

    /// Hands a scene to the servo that runs; whether it goes on with it.
    fn replace(&mut self, scene: &AnyScene, change: Changed) -> bool {
        let has_new_guides = change == Changed::Guides;
        let room = self.room.as_mut().filter(|_| change < Changed::Servo);
        let Some(room) = room else { return false };
        let replaced = match scene {
            AnyScene::Planar(scene) => room.replace(scene, has_new_guides),
            AnyScene::Spatial(scene) => room.replace(scene, has_new_guides),
        };
        replaced.is_ok()
    }

    fn show(&mut self, scene: &AnyScene, change: Changed) -> Showing {
        // A servo that cannot take the scene ends, and another begins.
        if self.replace(scene, change) {
            return Showing::Replaced;
        }
        // Another scene has its own places.
        let before = self.room.as_ref().filter(|_| change != Changed::Scene);
        let began = match scene {
            AnyScene::Planar(scene) => self.begun(scene, before),
            AnyScene::Spatial(scene) => self.begun(scene, before),
        };
        match began {
            Ok(room) => {
                let points = room.points();
                self.room = Some(room);
                if let Some(rows) = self.recording.end() {
                    self.notice(&format!(
                        "another servo began: the recording ended with {rows} rows"
                    ));
                }
                Showing::Began { points }
            }
            Err(why) => Showing::Refused(why),
        }
    }

    fn begun<const D: usize>(
        &self,
        scene: &BuiltScene<D>,
        before: Option<&Room>,
    ) -> Result<Room, String> {
        let before = before.filter(|room| room.dimension() == D);
        let kept = self.room.as_ref().map(Room::kept);
        Room::begin(scene, &self.terms, before, kept, self.stops.switch())
    }

    /// Tells all pages what a person should read.
    fn notice(&self, message: &str) {
        self.pages.broadcast(Told::Notice { message, about: None });
    }

    fn go_on(&mut self, is_frame: bool) {
        if self.leader.is_some_and(|page| !self.pages.is_open(page)) {
            self.let_go();
        }
        let clients = self.pages.count();
        if std::mem::replace(&mut self.clients, clients) != clients {
            self.inquiries.forget_closed(&self.pages);
            self.pages.broadcast(Told::Clients { count: clients });
        }
        let Some(room) = self.room.take() else { return self.rest(is_frame) };
        if room.has_ended() {
            let why = room.ending();
            self.recording.end();
            self.notice(&format!("the servo has ended: {why}; the next edit begins another"));
            return self.rest(is_frame);
        }
        let room = self.room.insert(room);
        let is_stopped = self.stops.is_stopped();
        room.set_stopped(is_stopped);
        let speed = room.speed().get();
        // At most the ticks of a step are released, so that the hand is led as often as in real time.
        let ticks = self.ticks.min((self.terms.rate * STEP.as_secs_f64()).ceil() as u64);
        self.ticks -= ticks;
        let (mut events, mut frame): (Vec<Event>, Option<Frame>) = (Vec::new(), None);
        let mut safety = self.safety.0;
        let is_full = self.recording.go_on(room);
        room.speed().step(ticks);
        if is_frame {
            events.extend(std::iter::from_fn(|| room.next_event()).take(MOST_EVENTS));
            frame = room.frame();
            safety = room.safety();
        }
        if is_full {
            self.notice(&format!("the recording is full: {MOST_ROWS} rows"));
        }
        if let Some(message) = self.recording.message(is_frame) {
            self.pages.broadcast(message);
        }
        if !events.is_empty() {
            self.pages.broadcast(Told::Events { events: &events });
        }
        self.tell_safety(safety, is_frame);
        if let Some(mut frame) = frame {
            (frame.revision, frame.is_recording) = (self.revision, self.recording.is_on());
            let pace = (!frame.is_held).then_some(self.terms.rate * speed);
            let now = Instant::now();
            self.heartbeat.watch_servo(frame.ticks, pace, now);
            self.heartbeat.watch_stop(!is_stopped || frame.is_stopped, now);
            self.send(frame);
        }
    }

    /// Goes on without a servo: the last frame has no forces, and goes on beating.
    fn rest(&mut self, is_frame: bool) {
        if let Some(frame) = self.frame.take().filter(|_| is_frame) {
            self.heartbeat.without_servo();
            self.send(frame.without_forces());
        }
    }

    /// Sends a frame to all pages.
    fn send(&mut self, mut frame: Frame) {
        frame.beat = self.heartbeat.beat(Instant::now());
        // There may be no receiver.
        let _ = self.frames.send(frame.bytes());
        self.frame = Some(frame);
    }

    /// Tells the pages what the safety chain did, if that is new and not told too often.
    fn tell_safety(&mut self, now: StageEffects, is_frame: bool) {
        let (told, frames) = &mut self.safety;
        *frames = frames.saturating_add(u32::from(is_frame));
        if *frames < SAFETY_FRAMES || *told == now && *frames < AGAIN_FRAMES {
            return;
        }
        self.safety = (now, 0);
        let stage = |(name, effect)| StageTold::new(name, effect);
        self.pages.broadcast(Told::Safety { stages: now.named().map(stage).collect() });
    }
}
