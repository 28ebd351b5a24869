// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What `palpate live`, and the page of `palpate feel`, refuse; the page itself is tested in a
//! browser.

use crate::common::{Folder, assert_refused, errors, palpate, status};

#[test]
fn options_of_a_page_that_is_not_served_are_refused() {
    let said = "--port, --bind and --token-file are for the page that `palpate feel` serves without a \
                scene, and without --no-live, --fast and --json; `palpate live SCENE` shows a scene";
    assert_refused(&["feel", "scenes/s3.json", "--fast", "--port", "8000"], said);
    assert_refused(&["feel", "--no-live", "--bind", "127.0.0.1"], said);
    assert_refused(&["feel", "--fast", "--token-file", "token"], said);
}

#[test]
fn what_cannot_be_served_is_refused() {
    let folder = Folder::new();
    let token = folder.write("token", "no token\n");
    let said = "a token is 32 hexadecimal digits, got 8 characters";
    assert_refused(&["live", "scenes/s3.json", "--token-file", &token], said);
    let new = folder.name("new");
    let scene = folder.write("scene.json", r#"{ "palpate": 1, "dimension": 2, "bodies": 3 }"#);
    let said = format!("{scene}: bodies, line 1: bodies must be a list, got 3");
    assert_refused(&["live", &scene, "--token-file", &new], &said);
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap();
    let output =
        palpate(&["live", "--port", &address.port().to_string(), "--token-file", &new]);
    let said = errors(&output);
    assert!(said.starts_with(&format!("palpate: cannot listen at {address}: ")), "{said}");
    assert!(said.contains("another port, 0 for any that is free"), "{said}");
    assert_eq!(status(&output), 2);
    assert!(!folder.path("new").exists(), "a page that is not served leaves no token");
    let rate = errors(&palpate(&["live", "--rate", "1e9"]));
    assert!(rate.contains("100000 Hz"), "{rate}");
}
