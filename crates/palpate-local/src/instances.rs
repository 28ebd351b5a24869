// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Compiles local methods in this crate, for the plane and for space.
//! [`compile`] says why.

use palpate_field::compile;

use crate::ElementMethod;

/// Compiles methods for elements with `N` corners in `D` dimensions.
fn of_elements<const N: usize, const D: usize>() {
    compile![ElementMethod::descend::<N, D>, ElementMethod::descend_from::<N, D>];
}

/// Never called. It names functions so that this crate compiles them.
#[doc(hidden)]
#[inline(never)]
pub fn instances() {
    of_elements::<2, 2>();
    of_elements::<2, 3>();
    of_elements::<3, 2>();
    of_elements::<3, 3>();
}
