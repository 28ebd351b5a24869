// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Files that a scene names, and what is kept of them, so that an edit of a scene does not read them anew.

use std::path::{Component, Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

use crate::problem::Problem;

/// A file in the scene's folder or below it.
#[derive(Clone, Debug)]
pub(crate) struct Beside {
    /// Where it is, as messages tell it.
    pub(crate) path: PathBuf,
    /// What tells whether it is as it was.
    pub(crate) stamp: Stamp,
}

/// What tells whether a file is as it was.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stamp {
    path: PathBuf,
    /// When it was written, and its bytes; the same of files that it names.
    states: Vec<State>,
}

type State = Option<(Option<SystemTime>, u64)>;

impl Stamp {
    /// The same, with files that this one names.
    pub(crate) fn with(mut self, files: &[PathBuf]) -> Self {
        self.states.extend(files.iter().map(|file| state(file)));
        self
    }

    /// Whether it is of the same file, as it is or as it was.
    pub(crate) fn is_of_same_file(&self, other: &Self) -> bool {
        self.path == other.path
    }
}

impl Beside {
    /// The file that a scene in `folder` names; `what` is it: "a mesh". A problem is about the file's name.
    pub(crate) fn of(what: &str, file: &str, folder: Option<&Path>) -> Result<Self, Problem> {
        let Some(folder) = folder else {
            return Err(Problem::new(format!(
                "{what} is a file beside the scene's: this scene is in no file"
            )));
        };
        let named = Path::new(file);
        let is_below = named.components().all(|part| matches!(part, Component::Normal(_)));
        if file.is_empty() || !is_below {
            return Err(Problem::new(format!(
                "{what} is a file in the scene's folder or below it, got {file:?}"
            )));
        }
        let path = folder.join(named);
        let cannot =
            |error: std::io::Error| Problem::new(format!("{}: {error}", path.display()));
        let real = path.canonicalize().map_err(cannot)?;
        // The folder of a file that is named alone is empty.
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        if !real.starts_with(folder.canonicalize().map_err(cannot)?) {
            let shown = path.display();
            return Err(Problem::new(format!(
                "{shown}: it is a link out of the scene's folder"
            )));
        }
        let states = vec![state(&real)];
        Ok(Self { path, stamp: Stamp { path: real, states } })
    }
}

/// When a file was written, and its bytes; `None` where there is no file.
fn state(path: &Path) -> State {
    let metadata = std::fs::metadata(path).ok()?;
    Some((metadata.modified().ok(), metadata.len()))
}

/// What was made, by what it was made of: those used last, up to a weight in all.
#[derive(Debug)]
pub(crate) struct Kept<K, T> {
    /// With their weights, the last used last.
    made: Mutex<Vec<(K, T, usize)>>,
    most: usize,
}

impl<K: PartialEq, T: Clone> Kept<K, T> {
    pub(crate) const fn new(most: usize) -> Self {
        Self { made: Mutex::new(Vec::new()), most }
    }

    pub(crate) fn of(&self, key: &K) -> Option<T> {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        let found = made.iter().position(|(known, ..)| known == key)?;
        let used = made.remove(found);
        let value = used.1.clone();
        made.push(used);
        Some(value)
    }

    /// Keeps a value, and drops those that are of no use any more, and what is too much.
    pub(crate) fn keep(
        &self,
        key: K,
        value: &T,
        weight: usize,
        is_of_no_use: impl Fn(&K) -> bool,
    ) {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        made.retain(|(known, ..)| !is_of_no_use(known));
        made.push((key, value.clone(), weight));
        let mut all: usize = made.iter().map(|(_, _, weight)| weight).sum();
        while all > self.most && made.len() > 1 {
            all -= made.remove(0).2;
        }
    }
}
