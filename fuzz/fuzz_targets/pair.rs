// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How far any two bodies are apart.

#![no_main]

use arbitrary::{Result, Unstructured};
use palpate_query::PairWorkspace;

#[path = "../pair_answers.rs"]
mod pair_answers;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    if let Ok(Err(complaint)) = asked(&mut Unstructured::new(data)) {
        panic!("{complaint}");
    }
});

/// What is wrong with the answers, if the data say enough to ask.
fn asked(u: &mut Unstructured<'_>) -> Result<std::result::Result<(), String>> {
    let (in_plane, depth) = (u.arbitrary()?, u.int_in_range(1..=3)?);
    let outcome = if in_plane {
        pair_answers::check::<2>(u, depth, &mut PairWorkspace::new())?
    } else {
        pair_answers::check::<3>(u, depth, &mut PairWorkspace::new())?
    };
    Ok(outcome.map(|_| ()))
}
