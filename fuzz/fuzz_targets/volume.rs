// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Reading a volume or a grid from any bytes, the first of which says in which format.

#![no_main]

#[path = "../volume_bytes.rs"]
mod volume_bytes;

/// A file of each format, and a grid's.
const NAMES: [&str; 6] = ["a.nrrd", "a.mha", "a.nii", "a.npy", "a.nvdb", "a.grid"];

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    if let [format, bytes @ ..] = data {
        volume_bytes::check(bytes, NAMES[*format as usize % NAMES.len()]);
    }
});
