// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The types of the page's modules, as their comments say them.

use std::path::Path;
use std::process::Command;

#[test]
fn the_page_has_the_types_that_it_says() {
    let tools = std::env::var_os("PALPATE_PAGE_TOOLS")
        .expect("PALPATE_PAGE_TOOLS is not set: run `cargo xtask test`, which sets it");
    let compiler = Path::new(&tools).join("node_modules/typescript/bin/tsc");
    let config = Path::new(env!("CARGO_MANIFEST_DIR")).join("web/jsconfig.json");
    let status = Command::new("node").arg(compiler).arg("-p").arg(config).status().unwrap();
    assert!(status.success(), "types are wrong: see above");
}
