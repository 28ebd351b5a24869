// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Limits the machine code of a crate, since generating it takes most of a build's time. Bytes do
//! not depend on how busy a machine is.

use std::path::{Path, PathBuf};

use object::read::archive::ArchiveFile;
use object::{Object, ObjectSection, SectionKind};

use crate::command::{Failure, cargo_command, output};

/// The most machine code of crates in a release build for x86-64 [MB].
const MOST: &[(&str, f64)] = &[
    ("palpate-field", 4.2),
    ("palpate-cli", 4.6),
    ("palpate-live", 2.2),
    ("palpate-scene", 2.3),
];

/// Builds the program, and checks how much machine code each crate is.
pub(crate) fn check() -> Result<(), Failure> {
    if !cfg!(target_arch = "x86_64") {
        println!("ceilings of machine code hold for x86-64 alone");
        return Ok(());
    }
    let mut build = cargo_command(&["build", "--release", "--locked", "-p", "palpate-cli"]);
    let messages = output(build.args(["--message-format", "json-render-diagnostics"]))?;
    let mut problems = Vec::new();
    for (name, most) in MOST {
        let library = library(&messages, name)
            .ok_or_else(|| Failure(format!("cargo built no library of {name}")))?;
        let size = machine_code(&library)? as f64 / 1e6;
        println!("{name} is {size:.2} MB of machine code, {most} at most");
        problems.extend(too_much(name, size, *most));
    }
    Failure::any(problems)
}

fn too_much(name: &str, size: f64, most: f64) -> Option<String> {
    (size > most).then(|| format!("{name} is {size:.2} MB of machine code, {most} at most"))
}

/// The `.rlib` of a package among cargo's messages.
fn library(messages: &str, name: &str) -> Option<PathBuf> {
    let crate_name = name.replace('-', "_");
    messages.lines().find_map(|line| {
        let message: serde_json::Value = serde_json::from_str(line).ok()?;
        let is_it = message["reason"] == "compiler-artifact"
            && message["target"]["name"] == crate_name.as_str();
        let files = message["filenames"].as_array().filter(|_| is_it)?;
        let paths = files.iter().filter_map(|file| file.as_str().map(PathBuf::from));
        paths.into_iter().find(|path| path.extension().is_some_and(|end| end == "rlib"))
    })
}

/// The bytes of executable sections in a library.
fn machine_code(library: &Path) -> Result<u64, Failure> {
    let told =
        |error: &dyn std::fmt::Display| Failure(format!("{}: {error}", library.display()));
    let bytes = std::fs::read(library).map_err(|error| told(&error))?;
    let archive = ArchiveFile::parse(&*bytes).map_err(|error| told(&error))?;
    let mut sum = 0;
    for member in archive.members() {
        let data =
            member.and_then(|member| member.data(&*bytes)).map_err(|error| told(&error))?;
        // The metadata of the crate is a member too, and no object.
        let Ok(file) = object::File::parse(data) else { continue };
        let code = file.sections().filter(|section| section.kind() == SectionKind::Text);
        sum += code.map(|section| section.size()).sum::<u64>();
    }
    Ok(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_is_found_among_messages() {
        let messages = concat!(
            r#"{"reason":"compiler-artifact","target":{"name":"palpate_grid"},"filenames":["/g.rlib"]}"#,
            "\n",
            r#"{"reason":"compiler-artifact","target":{"name":"palpate_field"},"filenames":["/a.rmeta","/a.rlib"]}"#,
            "\n{\"reason\":\"build-finished\"}\n",
        );
        assert_eq!(library(messages, "palpate-field"), Some(PathBuf::from("/a.rlib")));
        assert_eq!(library(messages, "palpate-mesh"), None);
    }

    #[test]
    fn too_much_code_is_told() {
        assert_eq!(too_much("a", 4.2, 4.2), None);
        let told = too_much("a", 4.25, 4.2).unwrap();
        assert_eq!(told, "a is 4.25 MB of machine code, 4.2 at most");
    }
}
