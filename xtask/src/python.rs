// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The wheel for Python, and its tests, in an environment of their own.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::command::{Failure, failed, is_there, root, run, target};

/// Where the package is.
const PACKAGE: &str = "bindings/python";

/// Builds the wheel, installs it with what its tests need, and runs them.
pub(crate) fn test() -> Result<(), Failure> {
    let python = installed()?;
    check_workflows(&python)?;
    let mut pytest = Command::new(&python);
    run(pytest.args(["-m", "pytest", "-q"]).current_dir(root().join(PACKAGE)))
}

/// Writes the classes of answers from their schema, and the constructors of all primitives from the catalogue of a
/// wheel that is made for it.
pub(crate) fn renew() -> Result<(), Failure> {
    let write = |python, program| {
        run(Command::new(python).arg(program).current_dir(root().join(PACKAGE)))
    };
    write(environment()?, "generate_answers.py")?;
    write(installed()?, "generate.py")
}

/// The interpreter of an environment where the wheel is installed with what its tests need.
fn installed() -> Result<PathBuf, Failure> {
    let python = environment()?;
    let package = root().join(PACKAGE);
    let wheels = target().join("python").join("wheels");
    if wheels.exists() {
        std::fs::remove_dir_all(&wheels).map_err(|error| failed(&wheels, &error))?;
    }
    // The profile of the other tests, whose crates are compiled already.
    let mut build = Command::new(&python);
    build.args(["-m", "maturin", "build", "--profile", "dev", "--features", "as-tested"]);
    build.args(["--locked", "--out"]);
    run(build.arg(&wheels).current_dir(&package))?;
    let wheel = std::fs::read_dir(&wheels)
        .map_err(|error| failed(&wheels, &error))?
        .find_map(|entry| entry.ok().map(|entry| entry.path()))
        .ok_or_else(|| Failure(format!("{}: maturin made no wheel", wheels.display())))?;
    let with_tests = format!("{}[test]", wheel.display());
    run(pip(&python).arg(with_tests))?;
    // The version stays the same, so pip would keep the wheel of the last run.
    run(pip(&python).args(["--force-reinstall", "--no-deps"]).arg(&wheel))?;
    Ok(python)
}

/// Checks the workflows against the schema of their format.
fn check_workflows(python: &Path) -> Result<(), Failure> {
    run(pip(python).arg("check-jsonschema>=0.33,<1"))?;
    let folder = root().join(".github").join("workflows");
    let files = std::fs::read_dir(&folder).map_err(|error| failed(&folder, &error))?;
    let mut check = Command::new(python);
    check.args(["-m", "check_jsonschema", "--builtin-schema", "vendor.github-workflows"]);
    run(check.args(files.filter_map(|entry| entry.ok().map(|entry| entry.path()))))
}

/// The interpreter of an environment with what builds wheels, made if it is not there.
fn environment() -> Result<PathBuf, Failure> {
    let folder = target().join("python").join("environment");
    let python = folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    // What was interrupted has no pip.
    let pip_version = Command::new(&python).args(["-m", "pip", "--version"]).output();
    if !pip_version.is_ok_and(|output| output.status.success()) {
        let own = ["python3", "python"].into_iter().find(|name| is_there(name));
        let own = own.ok_or_else(|| {
            let by_hand = "the tests of the Python package need Python 3.10 or later: sudo apt-get install python3 python3-venv";
            Failure(by_hand.to_owned())
        })?;
        run(Command::new(own).args(["-m", "venv", "--clear"]).arg(&folder))?;
    }
    run(pip(&python).args(["maturin>=1.16,<2"]))?;
    Ok(python)
}

fn pip(python: &Path) -> Command {
    let mut pip = Command::new(python);
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
    pip
}
