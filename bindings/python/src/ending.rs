// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Threads that work while the interpreter ends.
//!
//! Daemon threads of Python, and threads that call functions of Python, may want the interpreter when it
//! is gone, or be in Python when it ends. Before 3.14 CPython unwinds the latter, which Rust does not
//! allow: the process aborts. So before the interpreter ends, threads that come back to Python wait
//! for the end of the process instead, functions are called no more, and those that run are waited
//! for.

use std::cell::Cell;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering::SeqCst};
use std::thread::{self, ThreadId};
use std::time::{Duration, Instant};

use pyo3::prelude::*;

/// How long functions of Python that run are waited for when the interpreter ends.
const PATIENCE: Duration = Duration::from_secs(5);

/// How long threads are waited for that are in Python but in no function that was called from here:
/// most are on their way out of a call. One that does something else waits in vain.
const GRACE: Duration = Duration::from_millis(100);

/// How often the threads are looked at.
const LOOK: Duration = Duration::from_millis(1);

/// The thread in which the interpreter ends.
static ENDING: OnceLock<ThreadId> = OnceLock::new();

/// How many threads that have asked the core are in Python.
static IN_PYTHON: AtomicUsize = AtomicUsize::new(0);

/// How many functions of Python run that were called from here.
static CALLS: AtomicUsize = AtomicUsize::new(0);

thread_local! {
    /// Counts this thread once it has asked the core.
    static ASKER: Counted = Counted::new(&IN_PYTHON);

    /// How many functions of Python this thread is in.
    static DEPTH: Cell<u32> = const { Cell::new(0) };
}

/// Counts while it lives.
struct Counted(&'static AtomicUsize);

impl Counted {
    fn new(count: &'static AtomicUsize) -> Self {
        count.fetch_add(1, SeqCst);
        Self(count)
    }
}

impl Drop for Counted {
    fn drop(&mut self) {
        self.0.fetch_sub(1, SeqCst);
    }
}

/// `true` if the interpreter ends, in another thread than this one.
fn ends_elsewhere() -> bool {
    ENDING.get().is_some_and(|ending| *ending != thread::current().id())
}

/// Does work without the interpreter's lock, as [`Python::detach`]. While the interpreter ends, the
/// thread does not come back.
pub(crate) fn detach<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> T {
    if DEPTH.get() == 0 {
        ASKER.with(|_| ());
    }
    py.detach(|| {
        let _back = Away::new();
        work()
    })
}

/// While it lives, a thread is out of Python.
struct Away;

impl Away {
    fn new() -> Self {
        IN_PYTHON.fetch_sub(1, SeqCst);
        Self
    }
}

impl Drop for Away {
    fn drop(&mut self) {
        // Counted before the look, so that the thread is either seen or sees.
        IN_PYTHON.fetch_add(1, SeqCst);
        // A function that runs is waited for.
        if ends_elsewhere() && DEPTH.get() == 0 {
            IN_PYTHON.fetch_sub(1, SeqCst);
            loop {
                thread::park();
            }
        }
    }
}

/// Does work with the interpreter's lock, as [`Python::attach`]; `None` where the interpreter ends.
pub(crate) fn attached<T>(work: impl FnOnce(Python<'_>) -> T) -> Option<T> {
    let _counted = [Counted::new(&IN_PYTHON), Counted::new(&CALLS)];
    if ends_elsewhere() {
        return None;
    }
    let _deeper = Deeper::new();
    Python::try_attach(work)
}

/// While it lives, this thread is in one more function.
struct Deeper;

impl Deeper {
    fn new() -> Self {
        DEPTH.set(DEPTH.get() + 1);
        Self
    }
}

impl Drop for Deeper {
    fn drop(&mut self) {
        DEPTH.set(DEPTH.get() - 1);
    }
}

/// Is called before the interpreter ends, in the thread in which it does.
#[pyfunction]
fn ends(py: Python<'_>) {
    ASKER.with(|_| ());
    if ENDING.set(thread::current().id()).is_err() {
        return;
    }
    py.detach(|| {
        let since = Instant::now();
        let patience = || if CALLS.load(SeqCst) > 0 { PATIENCE } else { GRACE };
        // This thread is one of those that are counted.
        while IN_PYTHON.load(SeqCst) > 1 && since.elapsed() < patience() {
            thread::sleep(LOOK);
        }
    });
}

/// Has Python call [`ends`].
pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let atexit = module.py().import("atexit")?;
    atexit.call_method1("register", (wrap_pyfunction!(ends, module)?,))?;
    Ok(())
}
