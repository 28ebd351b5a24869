// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The fuzz target's check, on the same cases every time.

mod common;
#[expect(unreachable_pub, reason = "shared with the fuzz target")]
#[path = "../../../fuzz/servo_input.rs"]
mod servo_input;

use common::cases;

#[test]
fn whatever_comes_in_no_promise_is_broken() {
    cases(4000, |u| {
        servo_input::check(u.peek_bytes(u.len()).unwrap());
        Ok(())
    });
}
