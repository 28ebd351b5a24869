// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Threads, which do not outlive a fork.

use std::cell::RefCell;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Threads that share work.
pub(crate) type Pool = ThreadPool;

/// More are a mistake.
const MOST_THREADS: usize = 1024;

/// The pools by the process that made them and their threads: a child of `fork` has none of its parent's threads, so
/// it makes pools of its own.
static POOLS: Mutex<Option<Pools>> = Mutex::new(None);

type Pools = HashMap<(u32, usize), Arc<Pool>>;

/// So many threads; those of all processors if that is 0, none but the caller's if it is 1.
pub(crate) fn of(threads: isize) -> PyResult<Option<Arc<Pool>>> {
    let threads = match usize::try_from(threads) {
        Ok(0) => std::thread::available_parallelism().map_or(1, usize::from),
        Ok(threads) if threads <= MOST_THREADS => threads,
        _ => {
            let problem = format!(
                "threads must be 0, for all processors, or from 1 to {MOST_THREADS}, got {threads}"
            );
            return Err(PyValueError::new_err(problem));
        }
    };
    if threads == 1 { Ok(None) } else { shared(threads).map(Some) }
}

/// The same, with a pool of one thread where one is asked for.
pub(crate) fn of_at_least_one(threads: isize) -> PyResult<Arc<Pool>> {
    match of(threads)? {
        Some(pool) => Ok(pool),
        None => alone(),
    }
}

fn shared(threads: usize) -> PyResult<Arc<Pool>> {
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let pools = pools.get_or_insert_with(HashMap::new);
    let key = (std::process::id(), threads);
    if let Some(pool) = pools.get(&key) {
        return Ok(Arc::clone(pool));
    }
    // Those of another process are never dropped: that would wait for threads that do not exist here.
    let pool = made(threads)?;
    pools.insert(key, Arc::clone(&pool));
    Ok(pool)
}

fn made(threads: usize) -> PyResult<Arc<Pool>> {
    let made = ThreadPoolBuilder::new().num_threads(threads).build();
    made.map(Arc::new).map_err(|error| {
        PyRuntimeError::new_err(format!("{threads} threads did not start: {error}"))
    })
}

/// A pool of one thread, and the process that made it.
struct Alone {
    process: u32,
    pool: Option<Arc<Pool>>,
}

impl Drop for Alone {
    fn drop(&mut self) {
        if self.process != std::process::id() {
            // In a child of `fork` its thread does not exist, and a lock of it may be held for ever.
            std::mem::forget(self.pool.take());
        }
    }
}

thread_local! {
    /// That of each thread of Python.
    static ALONE: RefCell<Option<Alone>> = const { RefCell::new(None) };
}

/// A pool of one thread that no other thread of Python waits for. What the core shares among the threads of the pool
/// that it is called from would without one be shared among those of all processors.
fn alone() -> PyResult<Arc<Pool>> {
    let process = std::process::id();
    ALONE.with_borrow_mut(|own| {
        if let Some(Alone { process: of, pool: Some(pool) }) = own.as_ref()
            && *of == process
        {
            return Ok(Arc::clone(pool));
        }
        let pool = made(1)?;
        *own = Some(Alone { process, pool: Some(Arc::clone(&pool)) });
        Ok(pool)
    })
}
