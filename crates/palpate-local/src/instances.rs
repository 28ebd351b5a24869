// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Compiles local methods in this crate, for the plane and for space.
//!
//! A generic function is compiled again in every crate that calls it. One that is marked
//! `#[inline(never)]` is not, if a crate below has compiled it for the same numbers.

use std::hint::black_box;

use crate::ElementMethod;

macro_rules! compile {
    ($($function:expr),* $(,)?) => {
        $(black_box($function as *const ());)*
    };
}

/// Compiles methods for elements with `N` corners in `D` dimensions.
fn of_elements<const N: usize, const D: usize>() {
    compile![ElementMethod::descend::<N, D>, ElementMethod::descend_from::<N, D>];
}

/// Never called: what it names is compiled.
#[doc(hidden)]
#[inline(never)]
pub fn instances() {
    of_elements::<2, 2>();
    of_elements::<2, 3>();
    of_elements::<3, 2>();
    of_elements::<3, 3>();
}
