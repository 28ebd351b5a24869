// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Python environments with peers, which are made under `target/` and reused.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{fmt, fs, io};

/// Peers of Python.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Peers {
    /// Their names in sentences.
    pub(crate) name: &'static str,
    /// The packages as pip names them, at the versions that the results are of.
    pub(crate) packages: &'static [(&'static str, &'static str)],
}

/// Why there are no peers.
#[derive(Debug)]
pub(crate) enum Missing {
    /// No program `python3`, or it makes no environments.
    Python(Peers, String),
    /// The packages are not installed, and cannot be.
    Packages { peers: Peers, folder: PathBuf, said: String },
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Python(Peers { name, .. }, said) => write!(
                f,
                "nothing is measured beside {name}: `python3 -m venv` does not work ({said}); \
                 install Python 3.11 or later with its module venv"
            ),
            Self::Packages { peers, folder, said } => write!(
                f,
                "nothing is measured beside {}: pip did not install {} into {} ({said}); \
                 see that python3 is 3.11 or later and that pip reaches a package index, or \
                 install them there by hand",
                peers.name,
                peers.pinned().join(" and "),
                folder.display()
            ),
        }
    }
}

impl Peers {
    /// The packages as pip names them.
    fn pinned(self) -> Vec<String> {
        self.packages.iter().map(|(name, version)| format!("{name}=={version}")).collect()
    }

    /// The folder of this name under `target/`, and the Python program of its environment; both are made
    /// unless they are there. `None`, and a sentence that says why, without these peers.
    pub(crate) fn prepared(self, name: &str) -> io::Result<Option<(PathBuf, PathBuf)>> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target").join(name);
        fs::create_dir_all(&folder)?;
        let folder = folder.canonicalize()?;
        Ok(match self.python(&folder.join("environment")) {
            Ok(python) => Some((folder, python)),
            Err(missing) => {
                eprintln!("palpate-bench: {missing}");
                None
            }
        })
    }

    /// The Python program of the environment in a folder, which is made unless it is there.
    fn python(self, folder: &Path) -> Result<PathBuf, Missing> {
        let python = program(folder);
        if self.are_in(&python) {
            return Ok(python);
        }
        eprintln!("installing {} in {} …", self.name, folder.display());
        // `--clear`: what an interrupted run has left is removed.
        let mut make = Command::new("python3");
        run(make.args(["-m", "venv", "--clear"]).arg(folder))
            .map_err(|said| Missing::Python(self, said))?;
        let mut install = Command::new(&python);
        install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
        let refused = |said| Missing::Packages { peers: self, folder: folder.into(), said };
        run(install.args(self.pinned())).map_err(refused)?;
        if self.are_in(&python) {
            Ok(python)
        } else {
            Err(refused("installed, but Python does not find them".into()))
        }
    }

    /// `true` if the packages are there, at their versions.
    fn are_in(self, python: &Path) -> bool {
        let checks = self
            .packages
            .iter()
            .map(|(name, version)| format!("assert version('{name}') == '{version}'"));
        let checks: Vec<_> = checks.collect();
        let script = format!("from importlib.metadata import version\n{}", checks.join("\n"));
        let mut command = Command::new(python);
        command.args(["-I", "-c", &script]).stdout(Stdio::null()).stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success())
    }
}

/// Where an environment has its Python program.
fn program(folder: &Path) -> PathBuf {
    folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" })
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

    const PEERS: Peers = Peers { name: "MuJoCo", packages: &[("mujoco", "4"), ("numpy", "2")] };

    #[test]
    fn a_refusal_quotes_the_last_line() {
        let said = b"Looking\nERROR: no matching distribution\n\n";
        assert_eq!(last_line(said).as_deref(), Some("ERROR: no matching distribution"));
        assert_eq!(last_line(b"\n"), None);
    }

    #[test]
    fn a_missing_package_says_what_to_do() {
        let (folder, said) = ("here".into(), "offline".into());
        let said = Missing::Packages { peers: PEERS, folder, said }.to_string();
        for part in ["MuJoCo", "mujoco==4 and numpy==2", "here", "offline"] {
            assert!(said.contains(part), "{said}");
        }
    }

    #[test]
    fn a_folder_without_python_has_no_packages() {
        assert!(!PEERS.are_in(&program(Path::new("no/such/folder"))));
    }
}
