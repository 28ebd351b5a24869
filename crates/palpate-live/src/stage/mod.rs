// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! One world: the scene as it is edited, the servo that renders it, and who asks about it.
//!
//! Threads work beside the servo, so that none waits for another's work: one reads messages, one leads
//! the hand and makes frames, one edits and builds scenes, some answer questions. They and the servo
//! share lock-free buffers alone. A stop goes to the servo from the thread that reads the socket.

mod described;
mod dispatcher;
mod document;
mod editor;
mod file;
mod hand;
mod heartbeat;
mod inquiry;
mod pages;
mod performance;
mod questions;
mod recording;
mod room;
mod stop;
pub(crate) mod trace;
mod unsaved;

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use palpate::device::DeviceProfile;
use palpate::haptics::StopSwitch;
use palpate::scene::AnyScene;
use tokio::sync::watch;
use tungstenite::{Bytes, Utf8Bytes};

use crate::wire::is_stop;
use dispatcher::Dispatcher;
use document::Document;
pub(crate) use document::Refusal;
use editor::Edit;
use inquiry::Inquiries;
#[cfg(any(test, feature = "fuzzing"))]
pub(crate) use inquiry::answer_alone;
use pages::Received;
pub use pages::Watch;
pub use pages::Work;
pub(crate) use pages::{Opened, Out, Outbox, PageId, Pages, Waiting};
use performance::Order;
use recording::Trace;
pub use room::GivenClock;
pub(crate) use room::MOST_POINTS;
use room::Terms;
pub(crate) use stop::{Presser, Stop};
use unsaved::LatestScene;
pub use unsaved::{Unsaved, UnsavedError};

/// Messages of all pages that may wait to be read: more end their page.
const MESSAGES: usize = 4096;

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
    /// The emergency stop, which others may press too.
    pub(crate) stop: StopSwitch,
    pub(crate) watch: Watch,
}

/// The world of all pages.
#[derive(Debug)]
pub(crate) struct Stage {
    messages: SyncSender<Received>,
    orders: SyncSender<Order>,
    edits: SyncSender<Edit>,
    inquiries: Arc<Inquiries>,
    pub(crate) stop: Arc<Stop>,
    pub(crate) frames: watch::Receiver<Bytes>,
    pub(crate) pages: Arc<Pages>,
    /// Counts while the thread that reads sockets goes on.
    pub(crate) pulse: Arc<Pulse>,
    pub(crate) watch: Watch,
    latest: Arc<LatestScene>,
    shown: Arc<Shown>,
    performance: Mutex<Option<JoinHandle<()>>>,
}

/// What the threads of a stage share.
#[derive(Clone, Debug)]
struct Shared {
    pages: Arc<Pages>,
    shown: Arc<Shown>,
    latest: Arc<LatestScene>,
    inquiries: Arc<Inquiries>,
    /// Counts while the thread that reads sockets goes on.
    pulse: Arc<Pulse>,
    watch: Watch,
}

/// Counts while a thread goes on.
#[derive(Debug, Default)]
pub(crate) struct Pulse(AtomicU64);

impl Pulse {
    pub(crate) fn beat(&self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    fn count(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
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
        let Program { name, file, text, profile, rate, points, clock, stop, watch } = program;
        let document = Document::open(name, file, &text)?;
        let shared = Shared {
            pages: Arc::default(),
            shown: Arc::default(),
            latest: Arc::new(LatestScene::of(&document)),
            inquiries: Arc::default(),
            pulse: Arc::default(),
            watch,
        };
        let terms = Terms { profile, rate, points, clock };
        let (stop, stops) = stop::stop(stop);
        let stop = Arc::new(stop);
        let (messages, received) = sync_channel(MESSAGES);
        let (orders, ordered) = sync_channel(ORDERS);
        let (edits, edited) = sync_channel(WAITING);
        let (frame_sender, frames) = watch::channel(Bytes::new());
        let performance =
            performance::Performance::new(terms.clone(), stops, frame_sender, &shared);
        let editor = editor::Editor::new(document, terms, orders.clone(), &shared);
        let dispatcher = Dispatcher {
            orders: orders.clone(),
            edits: edits.clone(),
            stop: Arc::clone(&stop),
            shared: shared.clone(),
        };
        let performance = std::thread::spawn(move || performance.run(&ordered));
        // These end when nobody can ask them any more; nothing waits for what they still do.
        std::thread::spawn(move || editor.run(&edited));
        std::thread::spawn(move || dispatcher.run(&received));
        shared.inquiries.start(&shared);
        let Shared { pages, shown, latest, inquiries, pulse, watch } = shared;
        Ok(Self {
            messages,
            orders,
            edits,
            inquiries,
            stop,
            frames,
            pages,
            pulse,
            watch,
            latest,
            shown,
            performance: Mutex::new(Some(performance)),
        })
    }

    /// Takes a message of a page. `waiting` counts the bytes of the page that wait. A stop acts at once.
    ///
    /// Waits for no other thread.
    pub(crate) fn take(&self, page: PageId, text: Utf8Bytes, waiting: &Waiting) {
        if is_stop(&text) {
            self.stop.press(Presser::Page(page, text));
            return;
        }
        let message = waiting.message(page, text);
        let taken = message.and_then(|message| self.messages.try_send(message).ok());
        if taken.is_none() {
            self.pages.close(page, "the page sent more than the program could read".to_owned());
        }
    }

    /// Takes a message of a page that is closed: a stop acts, and nothing else.
    pub(crate) fn take_last(&self, text: &str) {
        if is_stop(text) {
            self.stop.press_unnamed();
        }
    }

    /// The text of the scene as a file.
    pub(crate) fn text(&self) -> String {
        self.latest.text()
    }

    /// The scene with its edits, if they are not saved; edits that wait are made first, as far as that
    /// takes no longer than `patience`.
    pub(crate) fn unsaved(&self, patience: Duration) -> Option<Unsaved> {
        let (done, made) = sync_channel(1);
        if self.edits.try_send(Edit::Settle(done)).is_ok() {
            // If that takes longer, the last finished scene is kept.
            let _ = made.recv_timeout(patience);
        }
        self.latest.unsaved()
    }

    /// Takes a trace to be replayed in the scene that is shown.
    ///
    /// # Errors
    ///
    /// What is wrong with it, in words.
    pub(crate) fn take_trace(&self, bytes: &[u8]) -> Result<(), String> {
        let (scene, _) =
            self.shown.get().ok_or("there is no scene yet: open the page first")?;
        let dimension = match &*scene {
            AnyScene::Planar(_) => 2,
            AnyScene::Spatial(_) => 3,
        };
        let replay = trace::read(bytes, dimension)?;
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

impl Stage {
    /// Ends the servo with zero forces, whoever still holds the stage.
    pub(crate) fn end(&self) {
        self.inquiries.end();
        let performance =
            self.performance.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(performance) = performance {
            // A full queue is emptied within a frame.
            let _ = self.orders.send(Order::End);
            // A panic in it was printed when it happened.
            let _ = performance.join();
        }
    }
}

impl Drop for Stage {
    fn drop(&mut self) {
        self.end();
    }
}
