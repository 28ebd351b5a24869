// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The threads of a run.

use std::num::NonZero;

use rayon::ThreadPool;

use crate::outcome::Failure;
use crate::output;

/// The requested number of threads, but no more than the machine runs at once: further ones
/// would wait, each with memory of its own.
pub(crate) fn pool(asked: Option<usize>) -> Result<ThreadPool, Failure> {
    let most = std::thread::available_parallelism().map_or(1, NonZero::get);
    let asked = asked.unwrap_or(most);
    if asked > most {
        output::remark(format_args!("--threads {asked}: this machine runs {most} at once"));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(asked.min(most)).build();
    pool.map_err(Failure::input)
}
