// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A macro that compiles large generic functions once.

/// Compiles functions in the crate that names them.
///
/// A generic function is compiled again in every crate that calls it. A function marked
/// `#[inline(never)]` is not, if a dependency has compiled it with the same generic arguments.
#[doc(hidden)]
#[macro_export]
macro_rules! compile {
    ($($function:expr),* $(,)?) => {
        $(::std::hint::black_box($function as *const ());)*
    };
}
