// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A servo that is sent anything.

#![no_main]

#[path = "../servo_input.rs"]
mod servo_input;

libfuzzer_sys::fuzz_target!(|data: &[u8]| servo_input::check(data));
