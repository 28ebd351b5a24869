// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The live page in a browser: `palpate-live/tests/page/page.mjs`.

use std::path::Path;
use std::process::Command;

#[test]
fn the_live_page_works_in_a_browser() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let status = Command::new("node")
        .arg(crates.join("palpate-live/tests/page/page.mjs"))
        .arg(env!("CARGO_BIN_EXE_palpate"))
        .arg(crates.join("../scenes"))
        .arg(Path::new(env!("CARGO_TARGET_TMPDIR")).join("page"))
        .status()
        .unwrap();
    assert!(status.success(), "a case failed: see above");
}
