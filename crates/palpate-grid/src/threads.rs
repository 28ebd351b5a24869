// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Work on many bricks, shared among threads where the feature `parallel` is there.

use crate::error::GridError;

/// The results of `work` for each of `count` numbers, in their order, or an error of one of them.
pub(crate) fn each<T: Send>(
    count: usize,
    work: impl Fn(usize) -> Result<T, GridError> + Send + Sync,
) -> Result<Vec<T>, GridError> {
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        (0..count).into_par_iter().map(work).collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        (0..count).map(work).collect()
    }
}
