// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The live page in a browser: `palpate-live/tests/page/page.mjs`.

use std::path::Path;
use std::process::Command;

/// Pictures of README.md, and what the cases call them.
const SHOWN: [(&str, &str); 3] = [
    ("gallery-1280-light.png", "live_gallery.png"),
    ("touch.png", "live_touch.png"),
    ("memoir.png", "live_memoir.png"),
];

#[test]
fn the_live_page_works_in_a_browser() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let pictures = Path::new(env!("CARGO_TARGET_TMPDIR")).join("page");
    let status = Command::new("node")
        .arg(crates.join("palpate-live/tests/page/page.mjs"))
        .arg(env!("CARGO_BIN_EXE_palpate"))
        .arg(crates.join("../scenes"))
        .arg(&pictures)
        .status()
        .unwrap();
    assert!(status.success(), "a case failed: see above");
    if std::env::var_os("PALPATE_UPDATE_PICTURES").is_some() {
        for (name, shown) in SHOWN {
            let shown = crates.join("../docs/pictures").join(shown);
            std::fs::copy(pictures.join(name), shown).unwrap();
        }
    }
}
