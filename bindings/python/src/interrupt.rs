// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Long work that Ctrl-C stops.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::call::Call;
use crate::ending::{attached, detach};
use crate::pool::Pool;

/// How long work goes on before Python is asked whether it is to stop.
pub(crate) const A_WHILE: Duration = Duration::from_millis(40);

/// Does work on the threads of a pool, which ends soon after its flag is set, while this thread asks Python whether it
/// is to stop.
pub(crate) fn interruptible<T: Send>(
    py: Python<'_>,
    pool: &Pool,
    work: impl FnOnce(&AtomicBool) -> T + Send,
) -> PyResult<T> {
    let (stop, call) = (AtomicBool::new(false), Call::default());
    let answer = detach(py, || {
        let (done, answer) = mpsc::channel();
        std::thread::scope(|scope| {
            let (stop, own) = (&stop, call.clone());
            let thread = move || done.send(pool.run(&own, || work(stop)));
            std::thread::Builder::new().spawn_scoped(scope, thread)?;
            awaited(answer).inspect_err(|_| stop.store(true, Ordering::Relaxed))
        })
    });
    // What functions raised after Ctrl-C is of no call.
    let raised = call.ended();
    let answer = answer?;
    raised?;
    Ok(answer)
}

/// Goes on unless the flag is set.
pub(crate) fn unless_asked(stop: &AtomicBool) -> ControlFlow<()> {
    if stop.load(Ordering::Relaxed) {
        ControlFlow::Break(())
    } else {
        ControlFlow::Continue(())
    }
}

/// Does work that has no flag, in a thread of its own: if Python is to stop, the thread goes on by itself to its end.
pub(crate) fn abandonable<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let call = Call::default();
    let (own, (done, answer)) = (call.clone(), mpsc::channel());
    // Nobody may wait for the answer any more.
    let thread = move || done.send(own.run(work));
    std::thread::Builder::new().spawn(thread)?;
    let answer = detach(py, move || awaited(answer));
    // Functions are not called after that: Python may end.
    let answer = answer.inspect_err(|_| call.abandon())?;
    call.ended()?;
    Ok(answer)
}

/// The answer of a thread, unless Python is to stop before.
fn awaited<T>(answer: Receiver<T>) -> PyResult<T> {
    loop {
        match answer.recv_timeout(A_WHILE) {
            Ok(answer) => return Ok(answer),
            Err(RecvTimeoutError::Timeout) => {
                attached(|py| py.check_signals()).unwrap_or(Ok(()))?
            }
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the work ended without an answer"));
            }
        }
    }
}
