// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! One world: the scene as it is edited, the servo that renders it, and who asks about it.
//!
//! Threads work beside the servo, so that none waits for another's work: one leads the hand and
//! makes frames, one edits and builds scenes, some answer questions. They and the servo share
//! lock-free buffers alone. A stop goes to the servo from the thread that reads it.

mod described;
mod document;
mod editor;
mod file;
mod hand;
mod inquiry;
mod pages;
mod performance;
mod points;
mod questions;
mod recording;
mod room;
pub(crate) mod trace;

use std::path::PathBuf;
use std::sync::mpsc::{SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use axum::body::Bytes;
use palpate::haptics::{DeviceProfile, StopSwitch};
use palpate::scene::AnyScene;
use tokio::sync::watch;

use crate::wire::{Ask, Question};
use document::Document;
pub(crate) use document::Refusal;
use inquiry::Inquiries;
#[cfg(any(test, feature = "fuzzing"))]
pub(crate) use inquiry::answer_alone;
pub(crate) use pages::{Out, PageId, Pages};
use performance::Order;
use recording::{AnyReplay, Trace};
use room::Terms;
pub(crate) use room::{GivenClock, MOST_POINTS};

/// Edits that may wait: more are refused.
const WAITING: usize = 64;

/// Orders to the hand that may wait: a hundredth of a second of many pages.
const ORDERS: usize = 1024;

/// What a stage begins with.
#[derive(Clone, Debug)]
pub(crate) struct Program {
    pub(crate) name: String,
    pub(crate) file: Option<PathBuf>,
    pub(crate) text: String,
    pub(crate) profile: DeviceProfile,
    pub(crate) rate: f64,
    pub(crate) points: usize,
    pub(crate) clock: GivenClock,
}

/// The world of all pages.
#[derive(Debug)]
pub(crate) struct Stage {
    orders: SyncSender<Order>,
    edits: SyncSender<(PageId, Question)>,
    inquiries: Arc<Inquiries>,
    pub(crate) stop: Arc<Stop>,
    pub(crate) frames: watch::Receiver<Bytes>,
    pub(crate) pages: Arc<Pages>,
    text: Arc<Text>,
    shown: Arc<Shown>,
    performance: Option<JoinHandle<()>>,
}

/// The text of the scene as a file.
#[derive(Debug, Default)]
struct Text(Mutex<String>);

impl Text {
    fn get(&self) -> String {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn set(&self, text: &str) {
        text.clone_into(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

/// The emergency stop of whatever servo runs.
#[derive(Debug, Default)]
pub(crate) struct Stop(Mutex<(Option<StopSwitch>, bool)>);

impl Stop {
    fn state(&self) -> MutexGuard<'_, (Option<StopSwitch>, bool)> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sets all forces to zero, or ends that.
    pub(crate) fn set(&self, is_stopped: bool) {
        let mut state = self.state();
        state.1 = is_stopped;
        if let Some(switch) = &state.0 {
            if is_stopped { switch.stop() } else { switch.release() }
        }
    }

    /// Whether forces are held at zero.
    fn is_stopped(&self) -> bool {
        self.state().1
    }

    /// Goes on with another servo, which is stopped if the last one was.
    fn take(&self, switch: StopSwitch) {
        let mut state = self.state();
        if state.1 {
            switch.stop()
        } else {
            switch.release()
        }
        state.0 = Some(switch);
    }
}

/// The scene that is shown, for those who ask about it.
#[derive(Debug, Default)]
struct Shown(Mutex<Option<(Arc<AnyScene>, u32)>>);

impl Shown {
    fn get(&self) -> Option<(Arc<AnyScene>, u32)> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn set(&self, scene: Arc<AnyScene>, revision: u32) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some((scene, revision));
    }
}

impl Stage {
    /// Reads the scene, and waits for a page: the servo begins with the first one.
    ///
    /// # Errors
    ///
    /// If the scene has an error.
    pub(crate) fn new(program: Program) -> Result<Self, Refusal> {
        let Program { name, file, text, profile, rate, points, clock } = program;
        let document = Document::open(name, file, &text)?;
        let shared_text = Arc::<Text>::default();
        shared_text.set(&text);
        let terms = Terms { profile, rate, points, clock };
        let (stop, pages, shown) =
            (Arc::<Stop>::default(), Arc::<Pages>::default(), Arc::<Shown>::default());
        let (orders, ordered) = sync_channel(ORDERS);
        let (edits, edited) = sync_channel(WAITING);
        let inquiries = Arc::<Inquiries>::default();
        let (frame_sender, frames) = watch::channel(Bytes::new());
        let performance = performance::Performance::new(
            terms.clone(),
            Arc::clone(&stop),
            Arc::clone(&pages),
            frame_sender,
        );
        let editor = editor::Editor::new(
            document,
            terms,
            orders.clone(),
            Arc::clone(&pages),
            (Arc::clone(&shown), Arc::clone(&shared_text)),
        );
        let performance = std::thread::spawn(move || performance.run(&ordered));
        // These end when nobody can ask them any more; nothing waits for what they still do.
        std::thread::spawn(move || editor.run(&edited));
        inquiries.start(&pages, &shown);
        let performance = Some(performance);
        let text = shared_text;
        Ok(Self { orders, edits, inquiries, stop, frames, pages, text, shown, performance })
    }

    /// Takes a message of a page.
    pub(crate) fn take(&self, page: PageId, question: Question) {
        let id = question.id;
        let is_full = match question.ask {
            Ask::Stop {} | Ask::Release {} => {
                self.stop.set(matches!(question.ask, Ask::Stop {}));
                self.pages.answer(page, id, serde_json::json!({ "do": "done" }));
                return;
            }
            Ask::Hand { target: Some(target), point, from, held: true } => {
                is_full(self.orders.try_send(Order::Lead { page, id, target, point, from }))
            }
            Ask::Hand { held: false, .. } => self.order(page, id, Order::LetGo),
            Ask::Hand { target: None, .. } => {
                self.pages.refuse(page, id, "a hand that is held has a target", &[]);
                return;
            }
            Ask::Tour { on } => self.order(page, id, Order::Tour(on)),
            Ask::Clock { speed, step } => {
                is_full(self.orders.try_send(Order::Clock { page, id, speed, step }))
            }
            Ask::Record { on } => self.order(page, id, Order::Record(on)),
            Ask::Replay { on } => is_full(self.orders.try_send(Order::Replay { page, id, on })),
            Ask::Hello { .. }
            | Ask::Edit { .. }
            | Ask::Undo {}
            | Ask::Redo {}
            | Ask::Open { .. }
            | Ask::Save { .. } => is_full(self.edits.try_send((page, question))),
            Ask::Cancel { question } => {
                if self.inquiries.cancel(page, question, &self.pages) {
                    self.pages.answer(page, id, serde_json::json!({ "do": "done" }));
                } else {
                    let why = format!("no question of number {question} is worked on");
                    self.pages.refuse(page, id, &why, &[]);
                }
                false
            }
            _ => self.inquiries.take(page, question),
        };
        if is_full {
            let why = "the program is busy with what was asked before: ask again";
            self.pages.refuse(page, id, why, &[]);
        }
    }

    /// Gives an order that cannot be refused; whether there is no room for it.
    fn order(&self, page: PageId, id: Option<u32>, order: Order) -> bool {
        let is_full = is_full(self.orders.try_send(order));
        if !is_full {
            self.pages.answer(page, id, serde_json::json!({ "do": "done" }));
        }
        is_full
    }

    /// A page is closed.
    pub(crate) fn gone(&self, page: PageId) {
        self.pages.remove(page);
        self.inquiries.gone(page);
    }

    /// The text of the scene as a file.
    pub(crate) fn text(&self) -> String {
        self.text.get()
    }

    /// Takes a trace to be replayed in the scene that is shown.
    ///
    /// # Errors
    ///
    /// What is wrong with it, in words.
    pub(crate) fn take_trace(&self, bytes: &[u8]) -> Result<(), String> {
        let (scene, _) =
            self.shown.get().ok_or("there is no scene yet: open the page first")?;
        let replay = match &*scene {
            AnyScene::Planar(_) => AnyReplay::Planar(trace::read(bytes)?),
            AnyScene::Spatial(_) => AnyReplay::Spatial(trace::read(bytes)?),
        };
        let sent = self.orders.try_send(Order::TakeReplay(replay));
        sent.map_err(|_| "the program is busy: send the trace again".to_owned())
    }

    /// What was recorded last, if anything was; `None` where the program is busy.
    pub(crate) fn trace(&self) -> Option<Option<Trace>> {
        let (reply, answer) = sync_channel(1);
        self.orders.try_send(Order::Trace(reply)).ok()?;
        answer.recv().ok()
    }
}

fn is_full<T>(sent: Result<(), TrySendError<T>>) -> bool {
    sent.is_err()
}

impl Drop for Stage {
    /// Ends the servo with zero forces.
    fn drop(&mut self) {
        self.inquiries.end();
        // A full queue is emptied within a frame.
        let _ = self.orders.send(Order::End);
        if let Some(performance) = self.performance.take() {
            // A panic in it was printed when it happened.
            let _ = performance.join();
        }
    }
}
