// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Threads for calls, which do not outlive a fork.

use std::collections::HashMap;
use std::ops::Deref;
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::call::{Call, Shared};

/// More are a mistake.
const MOST_THREADS: usize = 1024;

/// Threads that share the work of one call.
pub(crate) struct Pool {
    threads: ThreadPool,
    /// The call that they work for.
    call: Arc<Shared>,
}

impl Pool {
    fn new(threads: usize) -> PyResult<Self> {
        let call = Arc::new(Shared::default());
        let own = Arc::clone(&call);
        let made = ThreadPoolBuilder::new()
            .num_threads(threads)
            .start_handler(move |_| Shared::serve(&own))
            .build();
        let threads = made.map_err(|error| {
            PyRuntimeError::new_err(format!("{threads} threads did not start: {error}"))
        })?;
        Ok(Self { threads, call })
    }

    /// How many threads there are.
    pub(crate) fn count(&self) -> usize {
        self.threads.current_num_threads()
    }

    /// Does work of a call on these threads.
    pub(crate) fn run<T: Send>(&self, call: &Call, work: impl FnOnce() -> T + Send) -> T {
        self.call.set(call);
        self.threads.install(work)
    }
}

/// A pool that no other call has until it is dropped: what a function raises in its threads is of this call.
pub(crate) struct Lent {
    process: u32,
    pool: Option<Pool>,
}

/// Those that no call has, by the process that made them and their threads: a child of `fork` has none of its parent's
/// threads, so it makes pools of its own.
static IDLE: Mutex<Option<Idle>> = Mutex::new(None);

type Idle = HashMap<(u32, usize), Vec<Pool>>;

impl Lent {
    fn new(threads: usize) -> PyResult<Self> {
        let process = std::process::id();
        let mut idle = IDLE.lock().unwrap_or_else(PoisonError::into_inner);
        let found =
            idle.get_or_insert_default().get_mut(&(process, threads)).and_then(Vec::pop);
        drop(idle);
        let pool = found.map_or_else(|| Pool::new(threads), Ok)?;
        Ok(Self { process, pool: Some(pool) })
    }
}

impl Deref for Lent {
    type Target = Pool;

    fn deref(&self) -> &Pool {
        self.pool.as_ref().expect("a pool is there until it is given back")
    }
}

impl Drop for Lent {
    fn drop(&mut self) {
        let Some(pool) = self.pool.take() else { return };
        if self.process == std::process::id() {
            let mut idle = IDLE.lock().unwrap_or_else(PoisonError::into_inner);
            let key = (self.process, pool.count());
            idle.get_or_insert_default().entry(key).or_default().push(pool);
        } else {
            // In a child of `fork` its threads do not exist, and a lock of it may be held for ever.
            std::mem::forget(pool);
        }
    }
}

/// How many threads a caller asks for.
pub(crate) fn check(threads: isize) -> PyResult<usize> {
    match usize::try_from(threads) {
        Ok(threads) if threads <= MOST_THREADS => Ok(threads),
        _ => {
            let problem = format!(
                "threads must be 0, for all processors, or from 1 to {MOST_THREADS}, got {threads}"
            );
            Err(PyValueError::new_err(problem))
        }
    }
}

/// So many threads; those of all processors if that is 0, none but the caller's if it is 1.
pub(crate) fn of(threads: isize) -> PyResult<Option<Lent>> {
    let threads = match check(threads)? {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        threads => threads,
    };
    if threads == 1 { Ok(None) } else { Lent::new(threads).map(Some) }
}

/// The same, with a pool of one thread where one is asked for. What the core shares among the threads of the pool that
/// it is called from would without one be shared among those of all processors.
pub(crate) fn of_at_least_one(threads: isize) -> PyResult<Lent> {
    of(threads)?.map_or_else(|| Lent::new(1), Ok)
}
