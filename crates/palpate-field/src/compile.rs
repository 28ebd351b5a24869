// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How large generic functions are compiled once.

/// Compiles functions in the crate that names them.
///
/// A generic function is compiled again in every crate that calls it. One that is marked
/// `#[inline(never)]` is not, if a crate below has compiled it for the same numbers.
#[doc(hidden)]
#[macro_export]
macro_rules! compile {
    ($($function:expr),* $(,)?) => {
        $(::std::hint::black_box($function as *const ());)*
    };
}
