// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Reading a scene from any text.

#![no_main]

#[path = "../scene_text.rs"]
mod scene_text;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    if let Ok(text) = std::str::from_utf8(data) {
        scene_text::check(text);
    }
});
