// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The files of the repository.

use std::fs;
use std::path::{Path, PathBuf};

use crate::command::{Failure, root};

/// A file with its text.
pub(crate) struct Text {
    /// From the root of the repository.
    pub(crate) path: PathBuf,
    pub(crate) text: String,
}

/// All files with one of these endings; `""` stands for the programs in `.ci`, which have none.
pub(crate) fn texts(endings: &[&str]) -> Result<Vec<Text>, Failure> {
    let mut paths = Vec::new();
    walk(&root(), &mut paths)
        .map_err(|error| Failure(format!("the sources cannot be read: {error}")))?;
    let is_wanted = |path: &PathBuf| match path.extension() {
        Some(ending) => ending.to_str().is_some_and(|ending| endings.contains(&ending)),
        None => endings.contains(&"") && path.starts_with(root().join(".ci")),
    };
    let wanted = paths.into_iter().filter(is_wanted);
    wanted.map(|path| read(&path)).collect()
}

fn read(path: &Path) -> Result<Text, Failure> {
    let text = fs::read_to_string(path)
        .map_err(|error| Failure(format!("{} cannot be read: {error}", path.display())))?;
    Ok(Text { path: path.strip_prefix(root()).unwrap_or(path).to_owned(), text })
}

/// Adds the files under `folder`, but for those that are built, and hidden ones.
fn walk(folder: &Path, files: &mut Vec<PathBuf>) -> std::io::Result<()> {
    let mut entries: Vec<_> = fs::read_dir(folder)?.collect::<Result<_, _>>()?;
    entries.sort_by_key(fs::DirEntry::file_name);
    for entry in entries {
        let (path, name) = (entry.path(), entry.file_name());
        let name = name.to_string_lossy();
        let is_ours = (!name.starts_with('.') && name != "target") || name == ".ci";
        // A folder of raw files: corpora and licences are not ours to judge.
        if path.is_dir() && is_ours && name != "corpus" {
            walk(&path, files)?;
        } else if path.is_file() && is_ours {
            files.push(path);
        }
    }
    Ok(())
}
