// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A servo from its making to its end. The lock of its stage is never held while code of Python may run: a thread that
//! waited for the stage with the interpreter's lock would stop the one that has the stage.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use palpate::devices::Device;
use palpate::haptics::{Event, Servo, Snapshot};
use palpate::scene::BuiltScene;
use palpate::servo_loop::{
    EndedThread, Records, RunReport, ServoThread, ThreadOptions, TraceRow,
};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::error::OrRaise;

/// What runs.
pub(crate) struct Ready<const D: usize> {
    pub(crate) servo: Servo<D>,
    pub(crate) device: Box<dyn Device<D> + Send>,
    pub(crate) options: ThreadOptions<D>,
    pub(crate) scene: BuiltScene<D>,
}

/// What runs in a thread.
pub(crate) struct Running<const D: usize> {
    pub(crate) thread: ServoThread<D>,
    records: Option<Records<D>>,
}

/// What has run.
pub(crate) struct Ended<const D: usize> {
    pub(crate) report: RunReport,
    pub(crate) rows: Vec<TraceRow<D>>,
    /// Rows for which there was no room.
    pub(crate) lost: u64,
}

/// Where a servo is between its making and its end.
enum Stage<const D: usize> {
    Ready(Box<Ready<D>>),
    Running(Box<Running<D>>),
    /// A thread waits for its end.
    Ending,
    Ended(Arc<Ended<D>>, Vec<Event>),
    /// Its thread did not start.
    Failed,
}

/// A servo that runs once.
pub(crate) struct Staged<const D: usize> {
    stage: Mutex<Stage<D>>,
    /// Tells those who wait for the end.
    has_ended: Condvar,
}

const NOT_RUNNING: &str = "the servo does not run: use it in a with statement";

impl<const D: usize> Staged<D> {
    pub(crate) fn new(ready: Ready<D>) -> Self {
        Self { stage: Mutex::new(Stage::Ready(Box::new(ready))), has_ended: Condvar::new() }
    }

    fn locked(&self) -> MutexGuard<'_, Stage<D>> {
        self.stage.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins to run in a thread.
    pub(crate) fn start(&self, py: Python<'_>) -> PyResult<()> {
        let begun = {
            let mut stage = self.locked();
            match std::mem::replace(&mut *stage, Stage::Failed) {
                Stage::Ready(ready) => {
                    let Ready { servo, device, mut options, scene } = *ready;
                    if !scene.motions.is_empty() {
                        options = options.with_motion(move |time, set_pose| {
                            scene.motion()(time, set_pose);
                        });
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
        match &*self.locked() {
            Stage::Ready(_) => Err(PyRuntimeError::new_err(NOT_RUNNING)),
            _ => Ok(()),
        }
    }

    /// Whether its thread has ended.
    pub(crate) fn has_ended(&self) -> bool {
        match &*self.locked() {
            Stage::Ready(_) | Stage::Ending => false,
            Stage::Running(own) => own.thread.has_ended(),
            Stage::Ended(..) | Stage::Failed => true,
        }
    }

    /// Does something with the thread that runs; `None` if none does.
    fn with_running<T>(&self, work: impl FnOnce(&mut Running<D>) -> T) -> Option<T> {
        match &mut *self.locked() {
            Stage::Running(own) => Some(work(own)),
            _ => None,
        }
    }

    /// Does something with the thread that runs.
    pub(crate) fn running<T>(&self, work: impl FnOnce(&mut Running<D>) -> T) -> PyResult<T> {
        self.with_running(work).ok_or_else(|| PyRuntimeError::new_err(NOT_RUNNING))
    }

    /// The newest state of a servo that runs.
    pub(crate) fn latest(&self) -> Option<Snapshot<D>> {
        self.with_running(|own| own.thread.control().latest().cloned()).flatten()
    }

    /// The events since the last call.
    pub(crate) fn take_events(&self) -> Vec<Event> {
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
        py.detach(|| {
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
                *self.locked() = own.ended();
                self.has_ended.notify_all();
            }
        });
    }

    /// What has run.
    pub(crate) fn ended(&self) -> PyResult<Arc<Ended<D>>> {
        match &*self.locked() {
            Stage::Ended(ended, _) => Ok(Arc::clone(ended)),
            _ => Err(PyRuntimeError::new_err("the servo has not ended")),
        }
    }
}

impl<const D: usize> Running<D> {
    fn ended(self) -> Stage<D> {
        let EndedThread { report, mut control, .. } = self.thread.end();
        let events = std::iter::from_fn(|| control.next_event()).collect();
        let (rows, lost) = self.records.map_or((Vec::new(), 0), |mut records| {
            let rows = records.take().collect();
            (rows, records.lost())
        });
        Stage::Ended(Arc::new(Ended { report, rows, lost }), events)
    }
}
