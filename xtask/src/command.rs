// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Running other programs.

use std::fmt;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What went wrong, in a sentence for the terminal.
#[derive(Debug)]
pub(crate) struct Failure(pub(crate) String);

impl Failure {
    /// All problems, each on a line; nothing if there are none.
    pub(crate) fn any(problems: Vec<String>) -> Result<(), Self> {
        if problems.is_empty() { Ok(()) } else { Err(Self(problems.join("\n"))) }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "xtask: {}", self.0)
    }
}

/// The root of the repository.
pub(crate) fn root() -> PathBuf {
    let package = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    package.parent().map_or(package.clone(), PathBuf::from)
}

/// The folder of what is built.
pub(crate) fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// Whether a program is where programs are looked for.
pub(crate) fn is_there(program: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| folder.join(program).is_file())
}

/// Runs a program, its output on the terminal.
pub(crate) fn run(command: &mut Command) -> Result<(), Failure> {
    let status = command.status();
    match status {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(Failure(format!("{command:?} failed: {status}"))),
        Err(error) => Err(Failure(format!("{command:?} did not start: {error}"))),
    }
}

/// What went wrong with a file or a folder.
pub(crate) fn failed(path: &Path, error: &std::io::Error) -> Failure {
    Failure(format!("{}: {error}", path.display()))
}

pub(crate) fn cargo_command(arguments: &[&str]) -> Command {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(arguments).current_dir(root());
    command
}

/// Runs cargo, its output on the terminal.
pub(crate) fn cargo(arguments: &[&str]) -> Result<(), Failure> {
    cargo_with(arguments, &[])
}

/// Runs cargo with more environment variables.
pub(crate) fn cargo_with(
    arguments: &[&str],
    environment: &[(&str, &str)],
) -> Result<(), Failure> {
    let line = format!("cargo {}", arguments.join(" "));
    let status = cargo_command(arguments)
        .envs(environment.iter().copied())
        .status()
        .map_err(|error| Failure(format!("`{line}` did not start: {error}")))?;
    if status.success() { Ok(()) } else { Err(Failure(format!("`{line}` failed"))) }
}

/// What a program prints on standard output.
pub(crate) fn output(command: &mut Command) -> Result<String, Failure> {
    let line = format!("{command:?}");
    let output = command
        .output()
        .map_err(|error| Failure(format!("`{line}` did not start: {error}")))?;
    if !output.status.success() {
        let message = String::from_utf8_lossy(&output.stderr);
        return Err(Failure(format!("`{line}` failed: {message}")));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The dependency tree, as `cargo metadata` prints it.
pub(crate) fn metadata() -> Result<serde_json::Value, Failure> {
    let printed =
        output(&mut cargo_command(&["metadata", "--format-version", "1", "--locked"]))?;
    serde_json::from_str(&printed)
        .map_err(|error| Failure(format!("`cargo metadata` printed no JSON: {error}")))
}
