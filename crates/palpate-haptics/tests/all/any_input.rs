// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The fuzz target's check, on the same cases every time, and on what once broke a promise.

#[expect(unreachable_pub, reason = "shared with the fuzz target")]
#[path = "../../../../fuzz/servo_input.rs"]
mod servo_input;

use crate::common::cases;

#[test]
fn whatever_comes_in_no_promise_is_broken() {
    cases(4000, |u| {
        servo_input::check(u.peek_bytes(u.len()).unwrap());
        Ok(())
    });
}

#[test]
fn what_once_broke_a_promise_no_longer_does() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/regressions/servo");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        servo_input::check(&std::fs::read(entry.unwrap().path()).unwrap());
        count += 1;
    }
    assert!(count > 0, "{folder} is empty");
}
