// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Calls into the core, which functions of Python may be called from: what those raise ends the call.

use std::cell::RefCell;
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::pool::Pool;

/// The first exception of a function: a search cannot carry it.
type Slot = Mutex<Option<PyErr>>;

/// That of functions that other threads of a pool call: which call they work for is not known.
static STRAY: Slot = Mutex::new(None);

thread_local! {
    /// The slot of the call that this thread works for.
    static CURRENT: RefCell<Option<Arc<Slot>>> = const { RefCell::new(None) };
}

/// One call.
#[derive(Clone, Default)]
pub(crate) struct Call {
    slot: Arc<Slot>,
    /// Whether threads of a pool share its work.
    is_shared: bool,
}

impl Call {
    /// A call whose work threads of a pool share.
    pub(crate) fn shared(pool: &Pool) -> Self {
        Self { is_shared: pool.current_num_threads() > 1, ..Self::default() }
    }

    /// Does work of this call in the thread that asks.
    pub(crate) fn run<T>(&self, work: impl FnOnce() -> T) -> T {
        let before = CURRENT.replace(Some(Arc::clone(&self.slot)));
        let restored = Restored(before);
        let answer = work();
        drop(restored);
        answer
    }

    /// Calls no function from now on: nobody waits for the answer.
    pub(crate) fn abandon(&self) {
        let problem = PyRuntimeError::new_err("nobody waits for the answer");
        self.slot.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(problem);
    }

    /// Raises what a function raised.
    pub(crate) fn ended(self) -> PyResult<()> {
        let stray = if self.is_shared { taken(&STRAY) } else { None };
        match taken(&self.slot).or(stray) {
            None => Ok(()),
            Some(error) => Err(error),
        }
    }
}

/// Puts the call back that a thread worked for before, also after a panic.
struct Restored(Option<Arc<Slot>>);

impl Drop for Restored {
    fn drop(&mut self) {
        CURRENT.replace(self.0.take());
    }
}

fn taken(slot: &Slot) -> Option<PyErr> {
    slot.lock().unwrap_or_else(PoisonError::into_inner).take()
}

/// Does something with the slot of this thread's call.
fn with_slot<T>(work: impl FnOnce(&Slot) -> T) -> T {
    let own = CURRENT.with_borrow(Clone::clone);
    work(own.as_deref().unwrap_or(&STRAY))
}

/// Keeps an exception for the end of this thread's call, unless there is one.
pub(crate) fn fail(error: PyErr) {
    with_slot(|slot| {
        slot.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
    });
}

/// Whether a function has raised in this thread's call: no function needs to be asked any more.
pub(crate) fn has_failed() -> bool {
    with_slot(|slot| slot.lock().unwrap_or_else(PoisonError::into_inner).is_some())
}

/// Does work without the interpreter's lock, and raises what functions that it called have raised.
pub(crate) fn detached<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    let call = Call::default();
    let answer = py.detach(|| call.run(work));
    call.ended()?;
    Ok(answer)
}

/// The same on the threads of a pool.
pub(crate) fn detached_in<T: Send>(
    py: Python<'_>,
    pool: &Pool,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    let call = Call::shared(pool);
    let answer = py.detach(|| pool.install(|| call.run(work)));
    call.ended()?;
    Ok(answer)
}
