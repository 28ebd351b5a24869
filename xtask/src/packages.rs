// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Checks that each package for crates.io ships exactly the files of its crate that git tracks, and
//! every file that its sources include, and that its licences are links to those of the repository.

use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::command::{Failure, cargo_command, failed, output, root};

/// Files that cargo adds to each package.
const ADDED: [&str; 4] = [".cargo_vcs_info.json", "Cargo.lock", "Cargo.toml.orig", "README.md"];

/// Sources that no package compiles: a source for a fuzz target, which includes scenes of this
/// repository.
const NOT_COMPILED: &[&str] = &["crates/palpate-live/src/fuzzing.rs"];

/// Compares the list of files of every package with those of its crate.
pub(crate) fn check(metadata: &Value) -> Result<(), Failure> {
    let mut problems = Vec::new();
    for package in metadata["packages"].as_array().into_iter().flatten() {
        // A crate of this workspace that may be published.
        if !package["source"].is_null() || !package["publish"].is_null() {
            continue;
        }
        let text = |key: &str| package[key].as_str().unwrap_or_default();
        let (name, manifest) = (text("name"), Path::new(text("manifest_path")));
        let Some(folder) = manifest.parent() else { continue };
        let shipped = lines(&output(&mut cargo_command(&[
            "package",
            "--list",
            "--locked",
            "--allow-dirty",
            "--package",
            name,
        ]))?);
        let tracked = lines(&output(Command::new("git").arg("ls-files").current_dir(folder))?);
        problems.extend(differences(name, &shipped, &tracked));
        let modes = ["ls-files", "--stage", "LICENSE-*"];
        let licences = output(Command::new("git").args(modes).current_dir(folder))?;
        problems.extend(copies(name, &licences));
        for source in shipped.iter().filter(|path| path.ends_with(".rs")) {
            let path = folder.join(source);
            let is_compiled = !NOT_COMPILED.iter().any(|other| path == root().join(other));
            if !is_compiled || !(source.starts_with("src/") || source == "build.rs") {
                continue;
            }
            let text = std::fs::read_to_string(&path).map_err(|error| failed(&path, &error))?;
            problems.extend(missing(name, source, &text, &shipped));
        }
    }
    Failure::any(problems)
}

/// How git marks a symbolic link.
const LINK: &str = "120000 ";

/// The licences of a package that are no links, in a list of files with their modes: an edit of a link
/// by a program that writes a new file makes it a copy.
fn copies(name: &str, licences: &str) -> Vec<String> {
    let copies = licences.lines().filter(|line| !line.starts_with(LINK));
    let path = |line: &str| line.rsplit('\t').next().unwrap_or(line).to_owned();
    copies.map(|line| format!("{name}: {} must be a link to ../../", path(line))).collect()
}

fn lines(text: &str) -> BTreeSet<String> {
    text.lines().map(|line| line.replace('\\', "/")).collect()
}

/// How the list of a package differs from the tracked files of its crate.
fn differences(
    name: &str,
    shipped: &BTreeSet<String>,
    tracked: &BTreeSet<String>,
) -> Vec<String> {
    let is_added = |path: &&String| ADDED.contains(&path.as_str());
    let more = shipped.difference(tracked).filter(|path| !is_added(path));
    let more = more.map(|path| format!("{name} would ship {path}, which git does not track"));
    let fewer = tracked.difference(shipped);
    more.chain(fewer.map(|path| format!("{name} would not ship {path}"))).collect()
}

/// The files that a source includes and its package does not ship. Files that documentation
/// includes are needed only by documentation tests.
fn missing(name: &str, source: &str, text: &str, shipped: &BTreeSet<String>) -> Vec<String> {
    let mut missing = Vec::new();
    for line in text.lines().filter(|line| !line.trim_start().starts_with("#[doc")) {
        for macro_name in ["include_str!(\"", "include_bytes!(\""] {
            for after in line.split(macro_name).skip(1) {
                let Some((included, _)) = after.split_once('"') else { continue };
                let beside = Path::new(source).parent().unwrap_or(Path::new(""));
                let is_shipped = resolved(&beside.join(included))
                    .is_some_and(|path| shipped.contains(&path));
                if !is_shipped {
                    missing.push(format!(
                        "{name}: {source} includes {included}, which its package does not ship"
                    ));
                }
            }
        }
    }
    missing
}

/// A path without `..`; `None` if it leaves the folder.
fn resolved(path: &Path) -> Option<String> {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir if !plain.pop() => return None,
            Component::ParentDir | Component::CurDir => {}
            part => plain.push(part),
        }
    }
    Some(plain.to_str()?.replace('\\', "/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(paths: &[&str]) -> BTreeSet<String> {
        paths.iter().map(|path| (*path).to_owned()).collect()
    }

    #[test]
    fn a_licence_that_is_a_copy_is_refused() {
        let link = "120000 965b606f331b5f8b1e9d 0\tLICENSE-APACHE\n";
        assert_eq!(copies("a", link), [""; 0]);
        let wrong = copies("a", &link.replace("120000", "100644"));
        assert_eq!(wrong, ["a: LICENSE-APACHE must be a link to ../../"]);
    }

    #[test]
    fn a_package_ships_what_git_tracks() {
        let tracked = set(&["Cargo.toml", "src/lib.rs"]);
        let good = set(&["Cargo.lock", "Cargo.toml", "Cargo.toml.orig", "src/lib.rs"]);
        assert_eq!(differences("a", &good, &tracked), [""; 0]);
        let bad = set(&["Cargo.toml", "src/notes.txt"]);
        let expected = [
            "a would ship src/notes.txt, which git does not track",
            "a would not ship src/lib.rs",
        ];
        assert_eq!(differences("a", &bad, &tracked), expected);
    }

    #[test]
    fn included_files_are_shipped() {
        let shipped = set(&["scenes/s3.json", "src/lib.rs"]);
        let found = |text: &str| missing("a", "src/one/two.rs", text, &shipped).len();
        assert_eq!(found("const A: &str = include_str!(\"../../scenes/s3.json\");"), 0);
        assert_eq!(found("#[doc = include_str!(\"../../../../README.md\")]"), 0);
        let outside = "const A: &str = include_str!(\"../../../../scenes/s3.json\");";
        assert_eq!(found(outside), 1);
        assert_eq!(found("const A: &[u8] = include_bytes!(\"two.bin\");"), 1);
    }
}
