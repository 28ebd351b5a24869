// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The Python environment with MuJoCo, which is made under `target/` and reused.

use std::fmt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The packages, at the versions that the results are of.
const PACKAGES: [(&str, &str); 2] = [("mujoco", "4.0.0"), ("numpy", "2.4.6")];

/// Why there is no MuJoCo.
#[derive(Debug)]
pub(super) enum Missing {
    /// No program `python3`, or it makes no environments.
    Python(String),
    /// The packages are not installed, and cannot be.
    Packages { folder: PathBuf, said: String },
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Python(said) => write!(
                f,
                "nothing is measured beside MuJoCo: `python3 -m venv` does not work ({said}); \
                 install Python 3.11 or later with its module venv"
            ),
            Self::Packages { folder, said } => write!(
                f,
                "nothing is measured beside MuJoCo: pip did not install {} into {} ({said}); \
                 see that python3 is 3.11 or later and that pip reaches a package index, or \
                 install them there by hand",
                pinned().join(" and "),
                folder.display()
            ),
        }
    }
}

/// The packages as pip names them.
fn pinned() -> [String; 2] {
    PACKAGES.map(|(name, version)| format!("{name}=={version}"))
}

/// The Python program of the environment in a folder, which is made unless it is there.
pub(super) fn python(folder: &Path) -> Result<PathBuf, Missing> {
    let python = program(folder);
    if has_packages(&python) {
        return Ok(python);
    }
    eprintln!("installing MuJoCo in {} …", folder.display());
    // `--clear`: what an interrupted run has left is removed.
    let mut make = Command::new("python3");
    run(make.args(["-m", "venv", "--clear"]).arg(folder)).map_err(Missing::Python)?;
    let mut install = Command::new(&python);
    install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
    let refused = |said| Missing::Packages { folder: folder.into(), said };
    run(install.args(pinned())).map_err(refused)?;
    if has_packages(&python) {
        Ok(python)
    } else {
        Err(refused("installed, but Python does not find them".into()))
    }
}

/// Where an environment has its Python program.
fn program(folder: &Path) -> PathBuf {
    folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" })
}

/// `true` if the packages are there, at their versions.
fn has_packages(python: &Path) -> bool {
    let checks = PACKAGES.map(|(name, version)| {
        format!("import {name}; assert {name}.__version__ == '{version}'")
    });
    let mut command = Command::new(python);
    command.args(["-I", "-c", &checks.join("\n")]);
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

/// Runs a program; else what it said last.
fn run(command: &mut Command) -> Result<(), String> {
    let output = command.output().map_err(|error| error.to_string())?;
    if output.status.success() {
        return Ok(());
    }
    let said = [output.stderr, output.stdout].map(|said| last_line(&said));
    Err(said.into_iter().flatten().next().unwrap_or_else(|| output.status.to_string()))
}

/// The last line that is not empty.
fn last_line(said: &[u8]) -> Option<String> {
    let said = String::from_utf8_lossy(said);
    said.lines().rev().map(str::trim).find(|line| !line.is_empty()).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_quotes_the_last_line() {
        let said = b"Looking\nERROR: no matching distribution\n\n";
        assert_eq!(last_line(said).as_deref(), Some("ERROR: no matching distribution"));
        assert_eq!(last_line(b"\n"), None);
    }

    #[test]
    fn a_missing_package_says_what_to_do() {
        let missing = Missing::Packages { folder: "here".into(), said: "offline".into() };
        let said = missing.to_string();
        assert!(said.contains("mujoco==") && said.contains("numpy=="), "{said}");
        assert!(said.contains("here") && said.contains("offline"), "{said}");
    }

    #[test]
    fn a_folder_without_python_has_no_packages() {
        assert!(!has_packages(&program(Path::new("no/such/folder"))));
    }
}
