// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Runs the program, and reads what it says.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The path of a file of the repository.
pub(crate) fn root(file: &str) -> String {
    repository().join(file).to_str().unwrap().to_owned()
}

/// The program in the root of the repository, about to start.
pub(crate) fn program(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_palpate"));
    // Nothing is kept from run to run.
    command.args(arguments).current_dir(repository()).env("PALPATE_CACHE", "");
    command
}

pub(crate) fn palpate(arguments: &[&str]) -> Output {
    program(arguments).output().unwrap()
}

pub(crate) fn status(output: &Output) -> i32 {
    output.status.code().unwrap()
}

pub(crate) fn text(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

pub(crate) fn errors(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

pub(crate) fn json(arguments: &[&str]) -> Value {
    let output = palpate(arguments);
    assert_eq!(status(&output), 0, "{}", errors(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Runs a command that must fail with status 2, and checks what it says, to the letter.
pub(crate) fn assert_refused(arguments: &[&str], said: &str) {
    let output = palpate(arguments);
    assert_eq!(errors(&output), format!("palpate: {said}\n"), "{arguments:?}");
    assert_eq!((status(&output), text(&output).as_str()), (2, ""), "{arguments:?}");
}

/// A number of an answer.
pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// A disc of this radius [m] about the origin, as a scene.
pub(crate) fn disc(radius: f64) -> String {
    format!(
        r#"{{ "palpate": 1, "dimension": 2,
          "bodies": [ {{ "name": "disc", "shape": {{ "ball": {{ "radius": {radius} }} }} }} ] }}"#
    )
}

/// A folder of its own for a test's files.
pub(crate) struct Folder(tempfile::TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn name(&self, name: &str) -> String {
        self.path(name).to_str().unwrap().to_owned()
    }

    /// Runs the program in the folder.
    pub(crate) fn run(&self, arguments: &[&str]) -> Output {
        program(arguments).current_dir(self.0.path()).output().unwrap()
    }

    pub(crate) fn write(&self, name: &str, text: &str) -> String {
        std::fs::write(self.path(name), text).unwrap();
        self.name(name)
    }
}
