// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Values that one thread asks at a time.

use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::ThreadId;
use std::time::{Duration, Instant};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::call::detached;
use crate::ending::attached;
use crate::interrupt::A_WHILE;

/// How long a thread sleeps that waits for the value.
const PAUSE: Duration = Duration::from_micros(200);

/// A value that one thread asks at a time, without the interpreter's lock: a thread that waited for the value with that
/// lock would stop the one that has the value.
pub(crate) struct Guarded<T> {
    value: Mutex<T>,
    /// The thread that asks.
    asks: Mutex<Option<ThreadId>>,
}

impl<T: Send> Guarded<T> {
    pub(crate) fn new(value: T) -> Self {
        Self { value: Mutex::new(value), asks: Mutex::new(None) }
    }

    /// Asks the value. A function of Python that is called meanwhile may not ask it again: it would wait for itself.
    pub(crate) fn ask<R: Send>(
        &self,
        py: Python<'_>,
        question: impl FnOnce(&mut T) -> R + Send,
    ) -> PyResult<R> {
        let own = std::thread::current().id();
        if *locked(&self.asks) == Some(own) {
            let problem = "a function asks the object that asks the function: give it another object to ask";
            return Err(PyRuntimeError::new_err(problem));
        }
        detached(py, || {
            let mut value = self.waited()?;
            let _asking = Asking::by(own, &self.asks);
            Ok(question(&mut value))
        })?
    }

    /// The value, once no other thread asks. Two functions that wait for each other's objects end by Ctrl-C.
    fn waited(&self) -> PyResult<MutexGuard<'_, T>> {
        let mut looked = Instant::now();
        loop {
            match self.value.try_lock() {
                Ok(value) => return Ok(value),
                Err(TryLockError::Poisoned(value)) => return Ok(value.into_inner()),
                Err(TryLockError::WouldBlock) => std::thread::sleep(PAUSE),
            }
            if looked.elapsed() > A_WHILE {
                looked = Instant::now();
                attached(|py| py.check_signals()).unwrap_or(Ok(()))?;
            }
        }
    }
}

/// While it lives, a thread is known to ask.
struct Asking<'a>(&'a Mutex<Option<ThreadId>>);

impl<'a> Asking<'a> {
    fn by(thread: ThreadId, asks: &'a Mutex<Option<ThreadId>>) -> Self {
        *locked(asks) = Some(thread);
        Self(asks)
    }
}

impl Drop for Asking<'_> {
    fn drop(&mut self) {
        *locked(self.0) = None;
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
