// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The mesh of any shape.

#![no_main]

use arbitrary::Unstructured;

#[path = "../contour_answers.rs"]
mod contour_answers;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    if let Ok(Err(complaint)) = contour_answers::check(&mut Unstructured::new(data), 3, 20) {
        panic!("{complaint}");
    }
});
