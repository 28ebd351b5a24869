// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Interrupts, progress and threads.

use std::fmt::Display;
use std::num::NonZero;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use palpate::haptics::StopSwitch;
use rayon::ThreadPool;

use crate::outcome::Failure;
use crate::output;

/// How often the program looks whether it is asked to end while a thread works.
const LOOK: Duration = Duration::from_millis(50);

/// How long the program waits for what is known when it is asked to end.
const SOON: Duration = Duration::from_secs(1);

/// A request to end a run early.
///
/// A signal handler ends the process if [`at_once`](Self::at_once) is set. Otherwise it sets
/// that flag and [`asked`](Self::asked), and the command ends by itself: it sets forces to zero,
/// then writes and reports what is done. A handler whose signal may come twice for one reason
/// looks at [`unheeded`](Self::unheeded) instead, and sets `asked` alone.
///
/// A thread that takes the same signals presses the [`stop_switch`](Self::stop_switch) of the servo of a
/// live page, so that forces are zero whatever the command does meanwhile.
#[derive(Clone, Debug)]
pub struct Interrupt {
    asked: Arc<AtomicBool>,
    at_once: Arc<AtomicBool>,
    unheeded: Arc<AtomicBool>,
    stop: StopSwitch,
}

impl Interrupt {
    /// The exit status of a run that was asked to end.
    pub const STATUS: u8 = 130;

    /// No request yet.
    #[must_use]
    pub fn new() -> Self {
        Self {
            asked: Arc::new(AtomicBool::new(false)),
            at_once: Arc::new(AtomicBool::new(true)),
            unheeded: Arc::new(AtomicBool::new(true)),
            stop: StopSwitch::new(),
        }
    }

    /// Set to `true` to ask the run to end.
    #[must_use]
    pub fn asked(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.asked)
    }

    /// The emergency stop of the servo of a live page.
    #[must_use]
    pub fn stop_switch(&self) -> StopSwitch {
        self.stop.clone()
    }

    /// `true` while a signal should end the process at once, because the command has nothing to
    /// finish or was asked to end before.
    #[must_use]
    pub fn at_once(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.at_once)
    }

    /// `true` until the command checks whether it is asked to end.
    #[must_use]
    pub fn unheeded(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.unheeded)
    }

    /// Promises that from now on the command checks whether it is asked to end.
    pub(crate) fn heed(&self) {
        self.unheeded.store(false, Ordering::Relaxed);
        self.at_once.store(self.is_asked(), Ordering::Relaxed);
    }

    pub(crate) fn is_asked(&self) -> bool {
        self.asked.load(Ordering::Relaxed)
    }

    /// The result of work that does not look at the flag itself; `None` if the program is asked to
    /// end before it is known. The thread that works ends with the program.
    pub(crate) fn unless_asked<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> Option<T> {
        self.within("interruptible", Duration::ZERO, move |_| work())
    }

    /// The result of work that ends early, with what it has, when the flag is set; `None` if it
    /// does not end soon after.
    pub(crate) fn soon<T: Send + 'static>(
        &self,
        work: impl FnOnce(&AtomicBool) -> T + Send + 'static,
    ) -> Option<T> {
        self.within("question", SOON, work)
    }

    /// The result of work, for which the program waits so long after it was asked to end.
    fn within<T: Send + 'static>(
        &self,
        name: &str,
        grace: Duration,
        work: impl FnOnce(&AtomicBool) -> T + Send + 'static,
    ) -> Option<T> {
        self.heed();
        let (sender, done) = mpsc::channel();
        let asked = self.asked();
        let named = thread::Builder::new().name(name.to_owned());
        let worker = named.spawn(move || sender.send(work(&asked)));
        // As `thread::spawn`, which gives no name: a system without threads is no interrupt.
        let worker = worker.unwrap_or_else(|error| panic!("no thread can be started: {error}"));
        loop {
            match done.recv_timeout(LOOK) {
                Ok(_) if grace.is_zero() && self.is_asked() => return None,
                Ok(result) => return Some(result),
                Err(RecvTimeoutError::Timeout) if self.is_asked() => {
                    return done.recv_timeout(grace).ok();
                }
                Err(RecvTimeoutError::Timeout) => {}
                // The worker panicked, and so does the program.
                Err(RecvTimeoutError::Disconnected) => match worker.join() {
                    Ok(_) => return None,
                    Err(panic) => std::panic::resume_unwind(panic),
                },
            }
        }
    }

    /// The flag, for loops that read it themselves.
    pub(crate) fn flag(&self) -> &AtomicBool {
        &self.asked
    }
}

impl Default for Interrupt {
    fn default() -> Self {
        Self::new()
    }
}

/// How often a line says how far the work is where no terminal shows a bar.
const EACH: Duration = Duration::from_secs(10);

/// A progress bar, which is hidden unless standard error is a terminal.
pub(crate) fn bar() -> ProgressBar {
    ProgressBar::new(0).with_style(
        ProgressStyle::with_template("{msg}{bar:40} {percent} %, {eta} left")
            .unwrap_or_else(|_| ProgressStyle::default_bar()),
    )
}

/// How far work that may take minutes is: a bar on a terminal, else a line now and then.
pub(crate) struct Progress {
    what: &'static str,
    bar: ProgressBar,
    told: Mutex<Instant>,
}

impl Progress {
    pub(crate) fn of(what: &'static str) -> Self {
        Self { what, bar: bar(), told: Mutex::new(Instant::now()) }
    }

    /// Shows that `done` of `of` pieces are done, of a part of the work if it has a name.
    pub(crate) fn show(&self, done: usize, of: usize, part: impl Display) {
        self.bar.set_length(of as u64);
        self.bar.set_position(done as u64);
        let part = part.to_string();
        if !self.bar.is_hidden() {
            let separator = if part.is_empty() { "" } else { ": " };
            self.bar.set_message(format!("{part}{separator}"));
            return;
        }
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        if told.elapsed() >= EACH {
            *told = Instant::now();
            let separator = if part.is_empty() { "" } else { ", " };
            let percent = 100 * done / of.max(1);
            output::remark(format_args!("{}{separator}{part}: {percent} %", self.what));
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// The requested number of threads, but no more than the machine runs at once: further ones
/// would wait, each with memory of its own.
pub(crate) fn pool(asked: Option<usize>) -> Result<ThreadPool, Failure> {
    let most = std::thread::available_parallelism().map_or(1, NonZero::get);
    let asked = asked.unwrap_or(most);
    if asked > most {
        output::remark(format_args!("--threads {asked}: this machine runs {most} at once"));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(asked.min(most)).build();
    pool.map_err(Failure::input)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_left_alone_once_the_program_is_asked_to_end() {
        let interrupt = Interrupt::new();
        assert_eq!(interrupt.unless_asked(|| 6 * 7), Some(42));
        let (hold, held) = mpsc::channel::<()>();
        let asked = interrupt.asked();
        let work = move || {
            asked.store(true, Ordering::Relaxed);
            // Without end, as the sender is kept.
            held.recv().is_ok()
        };
        assert_eq!(interrupt.unless_asked(work), None);
        drop(hold);
    }

    #[test]
    #[should_panic(expected = "a body without a side")]
    fn the_program_panics_as_its_work_does() {
        Interrupt::new().unless_asked(|| panic!("a body without a side"));
    }
}
