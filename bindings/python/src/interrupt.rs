// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Long work that Ctrl-C stops.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::function::raised;

/// How long work goes on before Python is asked whether it is to stop.
pub(crate) const A_WHILE: Duration = Duration::from_millis(40);

/// Does work in a thread of its own, which ends soon after its flag is set, while this one asks Python whether it is to
/// stop.
pub(crate) fn interruptible<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send,
) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    py.detach(|| {
        let (done, answer) = mpsc::channel();
        std::thread::scope(|scope| {
            let stop = &stop;
            scope.spawn(move || done.send(work(stop)));
            loop {
                match answer.recv_timeout(A_WHILE) {
                    Ok(answer) => {
                        raised()?;
                        return Ok(answer);
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => {
                        return Err(PyRuntimeError::new_err("the run ended without an answer"));
                    }
                }
                if let Err(stopped) = Python::attach(|py| py.check_signals()) {
                    stop.store(true, Ordering::Relaxed);
                    return Err(stopped);
                }
            }
        })
    })
}
