// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Compiles servo loops in this crate, for the plane and for space.
//! [`compile`] says why.

use palpate_field::compile;

use crate::servo_loop::ServoLoop;
use crate::{ServoThread, run_on};

fn in_dimension<const D: usize>() {
    compile![
        ServoLoop::<D>::new,
        ServoLoop::<D>::run,
        run_on::<D>,
        ServoThread::<D>::start,
        ServoThread::<D>::end,
        ServoThread::<D>::join,
    ];
}

/// Never called. It names functions so that this crate compiles them.
#[doc(hidden)]
#[inline(never)]
pub fn instances() {
    in_dimension::<2>();
    in_dimension::<3>();
}
