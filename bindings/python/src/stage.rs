// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A servo from its making to its end. The lock of its stage is never held while code of Python may run: a thread that
//! waited for the stage with the interpreter's lock would stop the one that has the stage.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use palpate::device::Device;
use palpate::haptics::{Event, NextPose, Servo, Snapshot};
use palpate::servo_loop::{
    EndedThread, Ending, Records, RunReport, ServoThread, ThreadOptions, TraceRow,
};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::ending::detach;
use crate::error::OrRaise;

/// Moves bodies to where they are at a time [s], by their numbers.
pub(crate) type Motion = Box<dyn FnMut(f64, &mut dyn FnMut(usize, NextPose)) + Send>;

/// What runs.
pub(crate) struct Ready {
    pub(crate) servo: Servo,
    pub(crate) device: Box<dyn Device + Send>,
    pub(crate) options: ThreadOptions,
    /// What moves the bodies, if anything does.
    pub(crate) motion: Option<Motion>,
}

/// What runs in a thread.
pub(crate) struct Running {
    pub(crate) thread: ServoThread,
    records: Option<Records>,
}

/// What has run.
pub(crate) struct Ended {
    pub(crate) report: RunReport,
    pub(crate) rows: Vec<TraceRow>,
    /// Rows for which there was no room.
    pub(crate) lost: u64,
}

/// Where a servo is between its making and its end.
enum Stage {
    Ready(Box<Ready>),
    Running(Box<Running>),
    /// A thread waits for its end.
    Ending,
    Ended(Arc<Ended>, Vec<Event>),
    /// Its thread did not start, or panicked.
    Failed,
}

/// A servo that runs once.
pub(crate) struct Staged {
    /// The process in which its thread is: a child of `fork` has a copy without one.
    process: u32,
    stage: Mutex<Stage>,
    /// Tells those who wait for the end.
    has_ended: Condvar,
}

/// Why a servo cannot be asked.
fn refused(problem: &'static str) -> PyErr {
    PyRuntimeError::new_err(problem)
}

const IS_COPY: &str = "the servo runs in the process that forked this one";
const NOT_BEGUN: &str = "the servo has not begun: use it in a with statement";
const HAS_ENDED: &str = "the servo has ended";
const DID_NOT_START: &str = "the servo did not start";

impl Staged {
    pub(crate) fn new(ready: Ready) -> Self {
        let stage = Mutex::new(Stage::Ready(Box::new(ready)));
        Self { process: std::process::id(), stage, has_ended: Condvar::new() }
    }

    fn is_copy(&self) -> bool {
        self.process != std::process::id()
    }

    fn locked(&self) -> MutexGuard<'_, Stage> {
        self.stage.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins to run in a thread.
    pub(crate) fn start(&self, py: Python<'_>) -> PyResult<()> {
        if self.is_copy() {
            return Err(refused(IS_COPY));
        }
        let begun = {
            let mut stage = self.locked();
            match std::mem::replace(&mut *stage, Stage::Failed) {
                Stage::Ready(ready) => {
                    let Ready { servo, device, mut options, motion } = *ready;
                    if let Some(motion) = motion {
                        options = options.with_motion(motion);
                    }
                    ServoThread::start(servo, device, options).map(|mut thread| {
                        let records = thread.take_records();
                        *stage = Stage::Running(Box::new(Running { thread, records }));
                    })
                }
                other => {
                    *stage = other;
                    return Err(PyRuntimeError::new_err("a servo runs once: make another"));
                }
            }
        };
        begun.or_raise(py)
    }

    /// Refuses a servo that does not run yet, whose end nobody should wait for.
    pub(crate) fn begun(&self) -> PyResult<()> {
        if self.is_copy() {
            return Err(refused(IS_COPY));
        }
        match &*self.locked() {
            Stage::Ready(_) => Err(refused(NOT_BEGUN)),
            _ => Ok(()),
        }
    }

    /// Whether its thread has ended.
    pub(crate) fn has_ended(&self) -> bool {
        if self.is_copy() {
            return true;
        }
        match &*self.locked() {
            Stage::Ready(_) | Stage::Ending => false,
            Stage::Running(own) => own.thread.has_ended(),
            Stage::Ended(..) | Stage::Failed => true,
        }
    }

    /// Does something with the thread that runs; `None` if none does.
    fn with_running<T>(&self, work: impl FnOnce(&mut Running) -> T) -> Option<T> {
        if self.is_copy() {
            return None;
        }
        match &mut *self.locked() {
            Stage::Running(own) => Some(work(own)),
            _ => None,
        }
    }

    /// Does something with the thread that runs.
    pub(crate) fn running<T>(&self, work: impl FnOnce(&mut Running) -> T) -> PyResult<T> {
        if self.is_copy() {
            return Err(refused(IS_COPY));
        }
        self.with_running(work).ok_or_else(|| match &*self.locked() {
            Stage::Ready(_) => refused(NOT_BEGUN),
            Stage::Failed => refused(DID_NOT_START),
            _ => refused(HAS_ENDED),
        })
    }

    /// The newest state of a servo that runs.
    pub(crate) fn latest(&self) -> Option<Snapshot> {
        let newest = |own: &mut Running| {
            (!own.thread.has_ended()).then(|| own.thread.control().latest().cloned())
        };
        self.with_running(newest).flatten().flatten()
    }

    /// The events since the last call.
    pub(crate) fn take_events(&self) -> Vec<Event> {
        if self.is_copy() {
            return Vec::new();
        }
        match &mut *self.locked() {
            Stage::Running(own) => {
                std::iter::from_fn(|| own.thread.control().next_event()).collect()
            }
            Stage::Ended(_, events) => std::mem::take(events),
            _ => Vec::new(),
        }
    }

    /// Ends its thread, and waits for that without the interpreter's lock.
    pub(crate) fn end(&self, py: Python<'_>) {
        if self.is_copy() {
            return;
        }
        detach(py, || {
            let mut stage = self.locked();
            while matches!(&*stage, Stage::Ending) {
                stage = self.has_ended.wait(stage).unwrap_or_else(PoisonError::into_inner);
            }
            if !matches!(&*stage, Stage::Running(_)) {
                return;
            }
            let taken = std::mem::replace(&mut *stage, Stage::Ending);
            drop(stage);
            if let Stage::Running(own) = taken {
                let told = Told(self);
                let ended = own.ended();
                *self.locked() = ended;
                drop(told);
            }
        });
    }

    /// What has run.
    pub(crate) fn ended(&self, py: Python<'_>) -> PyResult<Arc<Ended>> {
        if self.is_copy() {
            return Err(refused(IS_COPY));
        }
        // A servo that ended by itself may be asked before its block ends.
        if self.has_ended() {
            self.end(py);
        }
        match &*self.locked() {
            Stage::Ended(ended, _) => Ok(Arc::clone(ended)),
            Stage::Ready(_) => Err(refused(NOT_BEGUN)),
            Stage::Failed => Err(refused(DID_NOT_START)),
            _ => Err(refused("the servo has not ended")),
        }
    }

    /// Why it ended, if nobody wanted that.
    pub(crate) fn broken(&self) -> Option<Ending> {
        if self.is_copy() {
            return None;
        }
        match &*self.locked() {
            Stage::Ended(ended, _) => match &ended.report.ending {
                Ending::Finished | Ending::Interrupted => None,
                ending => Some(ending.clone()),
            },
            _ => None,
        }
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        if self.is_copy() {
            // Its thread, which would be waited for, is not in this process.
            let stage = self.stage.get_mut().unwrap_or_else(PoisonError::into_inner);
            std::mem::forget(std::mem::replace(stage, Stage::Failed));
        }
    }
}

/// Tells those who wait that a servo has ended, also if its thread panicked.
struct Told<'a>(&'a Staged);

impl Drop for Told<'_> {
    fn drop(&mut self) {
        let mut stage = self.0.locked();
        if matches!(&*stage, Stage::Ending) {
            *stage = Stage::Failed;
        }
        drop(stage);
        self.0.has_ended.notify_all();
    }
}

impl Running {
    fn ended(self) -> Stage {
        let EndedThread { report, mut control, .. } = self.thread.end();
        let events = std::iter::from_fn(|| control.next_event()).collect();
        let (rows, lost) = self.records.map_or((Vec::new(), 0), |mut records| {
            let rows = records.take().collect();
            (rows, records.lost())
        });
        Stage::Ended(Arc::new(Ended { report, rows, lost }), events)
    }
}
