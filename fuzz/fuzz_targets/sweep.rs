// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! When any two bodies that move touch.

#![no_main]

use arbitrary::{Result, Unstructured};
use palpate_query::{PairWorkspace, SweepWorkspace};

#[path = "../sweep_answers.rs"]
mod sweep_answers;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    if let Ok(Err(complaint)) = asked(&mut Unstructured::new(data)) {
        panic!("{complaint}");
    }
});

/// What is wrong with the answers, if the data say enough to ask.
fn asked(u: &mut Unstructured<'_>) -> Result<std::result::Result<(), String>> {
    let (in_plane, depth) = (u.arbitrary()?, u.int_in_range(1..=3)?);
    let outcome = if in_plane {
        let memory = (&mut SweepWorkspace::new(), &mut PairWorkspace::new());
        sweep_answers::check::<2>(u, depth, memory)?
    } else {
        let memory = (&mut SweepWorkspace::new(), &mut PairWorkspace::new());
        sweep_answers::check::<3>(u, depth, memory)?
    };
    Ok(outcome.map(|_| ()))
}
