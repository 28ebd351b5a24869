// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Calls into the core, which functions of Python may be called from: what those raise ends the call.

use std::cell::{Cell, RefCell};
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::ending::{attached, detach};
use crate::pool::Pool;

/// The first exception of a function: a search cannot carry it.
type Slot = Mutex<Option<PyErr>>;

thread_local! {
    /// The slot of the call that this thread works for.
    static CURRENT: RefCell<Option<Arc<Slot>>> = const { RefCell::new(None) };

    /// How deep this thread is in functions that ask shapes of functions.
    static DEPTH: Cell<u32> = const { Cell::new(0) };

    /// The pool that owns this worker thread; used when the thread runs no other call.
    static OF_POOL: RefCell<Option<Arc<Shared>>> = const { RefCell::new(None) };
}

/// The call that the threads of a pool work for.
#[derive(Default)]
pub(crate) struct Shared(Mutex<Call>);

impl Shared {
    /// Makes this thread work for whatever call the pool works for.
    pub(crate) fn serve(own: &Arc<Self>) {
        OF_POOL.replace(Some(Arc::clone(own)));
    }

    /// Makes the pool work for a call.
    pub(crate) fn set(&self, call: &Call) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = call.clone();
    }

    fn call(&self) -> Call {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// One call.
#[derive(Clone)]
pub(crate) struct Call {
    slot: Arc<Slot>,
    /// How deep the thread that calls is in functions.
    depth: u32,
}

impl Default for Call {
    fn default() -> Self {
        Self { slot: Arc::default(), depth: DEPTH.get() }
    }
}

impl Call {
    /// Does work of this call in the thread that asks.
    pub(crate) fn run<T>(&self, work: impl FnOnce() -> T) -> T {
        let before = CURRENT.replace(Some(Arc::clone(&self.slot)));
        let restored = Restored(before, DEPTH.replace(self.depth));
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
        match self.slot.lock().unwrap_or_else(PoisonError::into_inner).take() {
            None => Ok(()),
            Some(error) => Err(error),
        }
    }
}

/// Puts the call back that a thread worked for before, also after a panic.
struct Restored(Option<Arc<Slot>>, u32);

impl Drop for Restored {
    fn drop(&mut self) {
        CURRENT.replace(self.0.take());
        DEPTH.set(self.1);
    }
}

/// The slot of this thread's call; `None` if it works for none.
fn slot() -> Option<Arc<Slot>> {
    let own = CURRENT.with_borrow(Clone::clone);
    own.or_else(|| OF_POOL.with_borrow(|pool| pool.as_deref().map(|pool| pool.call().slot)))
}

/// How deep this thread is in functions that ask shapes of functions, before it goes one deeper.
pub(crate) fn deeper() -> u32 {
    let of_pool = OF_POOL.with_borrow(|pool| pool.as_deref().map(|pool| pool.call().depth));
    let before = DEPTH.get();
    DEPTH.set(before.max(of_pool.unwrap_or(0)) + 1);
    before
}

/// How deep it is now.
pub(crate) fn depth() -> u32 {
    DEPTH.get()
}

/// As deep as it was before.
pub(crate) fn set_depth(before: u32) {
    DEPTH.set(before);
}

/// Keeps an exception for the end of this thread's call, unless there is one.
pub(crate) fn fail(error: PyErr) {
    match slot() {
        Some(slot) => {
            slot.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
        }
        // While the interpreter ends, there is nobody to report to.
        None => _ = attached(|py| error.write_unraisable(py, None)),
    }
}

/// Whether a function has raised in this thread's call: no function needs to be asked any more.
pub(crate) fn has_failed() -> bool {
    slot().is_some_and(|slot| slot.lock().unwrap_or_else(PoisonError::into_inner).is_some())
}

/// Does work without the interpreter's lock, and raises what functions that it called have raised.
pub(crate) fn detached<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    let call = Call::default();
    let answer = detach(py, || call.run(work));
    call.ended()?;
    Ok(answer)
}

/// The same on the threads of a pool.
pub(crate) fn detached_in<T: Send>(
    py: Python<'_>,
    pool: &Pool,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    let call = Call::default();
    let answer = detach(py, || pool.run(&call, work));
    call.ended()?;
    Ok(answer)
}
