// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The page's modules: their types, as their comments say them, and those that are from elsewhere.

use std::path::{Path, PathBuf};
use std::process::Command;

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

#[test]
fn the_page_has_the_types_that_it_says() {
    let tools = std::env::var_os("PALPATE_PAGE_TOOLS")
        .expect("PALPATE_PAGE_TOOLS is not set: run `cargo xtask test`, which sets it");
    let compiler = Path::new(&tools).join("node_modules/typescript/bin/tsc");
    let config = folder("web/jsconfig.json");
    let status = Command::new("node").arg(compiler).arg("-p").arg(config).status().unwrap();
    assert!(status.success(), "types are wrong: see above");
}

#[test]
fn files_of_other_projects_are_as_their_list_says() {
    let script = folder("tests/page/vendor.mjs");
    let status = Command::new("node").arg(script).arg(folder("web/vendor")).status().unwrap();
    assert!(status.success(), "files differ from vendor.toml: see above");
}
