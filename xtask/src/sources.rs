// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rules on source files: their length, where `unsafe` may be, and how they
//! begin.

use std::fs;
use std::path::{Path, PathBuf};

use crate::command::{Failure, root};

/// The longest a source file may be.
const MOST_LINES: usize = 600;

/// How every Rust file begins.
const HEADER: &str = "// SPDX-FileCopyrightText: The palpate authors\n\
                      // SPDX-License-Identifier: MIT OR Apache-2.0\n";

/// The modules where `unsafe` is allowed, at most one a crate, and why.
const UNSAFE_MODULES: &[(&str, &str)] = &[
    ("crates/palpate-field/src/machine", "instruction sets and unwritten scratch memory"),
    ("crates/palpate-field/tests", "an allocator that counts, to prove that none happens"),
];

/// Checks every Rust file of the repository.
pub(crate) fn check() -> Result<(), Failure> {
    let mut wrong = Vec::new();
    let mut files = Vec::new();
    rust_files(&root(), &mut files)
        .map_err(|error| Failure(format!("the sources cannot be read: {error}")))?;
    for file in &files {
        let text = fs::read_to_string(file)
            .map_err(|error| Failure(format!("{} cannot be read: {error}", file.display())))?;
        let path = file.strip_prefix(root()).unwrap_or(file);
        wrong.extend(problems(path, &text));
    }
    for (module, why) in UNSAFE_MODULES {
        println!("unsafe is allowed in {module}: {why}");
    }
    if wrong.is_empty() { Ok(()) } else { Err(Failure(wrong.join("\n"))) }
}

fn problems(path: &Path, text: &str) -> Vec<String> {
    let mut wrong = Vec::new();
    let lines = text.lines().count();
    if lines > MOST_LINES {
        wrong.push(format!("{} has {lines} lines, {MOST_LINES} at most", path.display()));
    }
    if !text.starts_with(HEADER) {
        wrong.push(format!("{} does not begin with the two SPDX lines", path.display()));
    }
    let allowed = UNSAFE_MODULES.iter().any(|(module, _)| path.starts_with(module));
    if !allowed && text.contains(concat!("allow(uns", "afe_code")) {
        wrong.push(format!("{} allows unsafe code; it is not a listed module", path.display()));
    }
    wrong
}

fn rust_files(folder: &Path, files: &mut Vec<PathBuf>) -> std::io::Result<()> {
    let mut entries: Vec<_> = fs::read_dir(folder)?.collect::<Result<_, _>>()?;
    entries.sort_by_key(std::fs::DirEntry::file_name);
    for entry in entries {
        let path = entry.path();
        let name = entry.file_name();
        if path.is_dir() {
            if name != "target" && !name.to_string_lossy().starts_with('.') {
                rust_files(&path, files)?;
            }
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    Ok(())
}
