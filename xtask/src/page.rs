// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the tests of the live page need: Chromium, Node, and packages of npm.

use std::path::PathBuf;
use std::process::Command;

use crate::command::{Failure, failed, is_there, root, run, target};

/// Where the names and versions of the packages are.
const LIST: &str = "crates/palpate-live/tests/page";

/// Programs, and the Debian packages that have them.
const PROGRAMS: [(&str, &str); 3] =
    [("chromium", "chromium"), ("node", "nodejs"), ("npm", "npm")];

/// The folder of the packages, which tests read from this variable.
pub(crate) const VARIABLE: &str = "PALPATE_PAGE_TOOLS";

/// Installs what is missing; gives the folder of the packages.
///
/// Programs are installed where apt-get is there and may: else the command is named.
pub(crate) fn prepare() -> Result<PathBuf, Failure> {
    let missing: Vec<_> = PROGRAMS
        .iter()
        .filter(|(program, _)| !is_there(program))
        .map(|(_, name)| *name)
        .collect();
    if !missing.is_empty() {
        install(&missing)?;
    }
    let folder = target().join("page");
    let lock = root().join(LIST).join("package-lock.json");
    let wanted = std::fs::read(&lock).map_err(|error| failed(&lock, &error))?;
    let done = folder.join("installed-lock.json");
    if std::fs::read(&done).is_ok_and(|installed| installed == wanted) {
        return Ok(folder);
    }
    std::fs::create_dir_all(&folder).map_err(|error| failed(&folder, &error))?;
    for name in ["package.json", "package-lock.json"] {
        let from = root().join(LIST).join(name);
        std::fs::copy(&from, folder.join(name)).map_err(|error| failed(&from, &error))?;
    }
    let mut npm = Command::new("npm");
    npm.args(["ci", "--ignore-scripts", "--no-audit", "--no-fund"]).current_dir(&folder);
    run(&mut npm)?;
    std::fs::write(&done, wanted).map_err(|error| failed(&done, &error))?;
    Ok(folder)
}

fn install(packages: &[&str]) -> Result<(), Failure> {
    let by_hand = format!(
        "the tests of the live page need Chromium, Node and npm: \
         sudo apt-get install --no-install-recommends {}",
        packages.join(" ")
    );
    if !is_there("apt-get") {
        return Err(Failure(by_hand));
    }
    let apt = |arguments: &[&str]| {
        let mut apt = Command::new("apt-get");
        apt.args(arguments).env("DEBIAN_FRONTEND", "noninteractive");
        run(&mut apt).map_err(|_| Failure(by_hand.clone()))
    };
    apt(&["update"])?;
    apt(&[&["install", "-y", "--no-install-recommends"], packages].concat())
}
