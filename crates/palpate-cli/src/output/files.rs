// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The files that a run reads and writes, checked before it begins.

use std::ffi::OsString;
use std::fs::{self, Metadata, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

use palpate::grid::Volume;
use same_file::Handle;
use serde_json::Value;

use super::beside::Beside;
use super::{Destination, Target, folder, shown};
use crate::arguments::Reading;
use crate::outcome::Failure;

/// The files that a run reads and writes, all different by whatever name.
#[derive(Debug, Default)]
pub(crate) struct Files {
    inputs: Vec<(PathBuf, Identity)>,
    outputs: Vec<(PathBuf, Identity)>,
}

/// The identity of a file, whatever its name.
#[derive(Debug, PartialEq, Eq)]
enum Identity {
    /// An existing file, found through links of either kind, and through names in another case
    /// where the file system ignores case.
    Existing(Handle),
    /// A new file: its folder, and its name in lower case. Names that differ only in case are
    /// one file on some systems, and are refused on all.
    Absent(Handle, OsString),
}

/// The files of meshes, volumes and grids that a scene names, of the samples of volumes too. None of what is no scene:
/// that is told where it is read.
fn files_of_scene(path: &Path, reading: Reading) -> Vec<PathBuf> {
    // A pipe can be read once only.
    let is_file = fs::metadata(path).is_ok_and(|found| found.is_file());
    let text = if is_file { reading.bytes(path).unwrap_or_default() } else { Vec::new() };
    let (mut waiting, mut names) = (Vec::new(), Vec::new());
    waiting.extend(serde_json::from_slice::<Value>(&text));
    while let Some(value) = waiting.pop() {
        match value {
            Value::Object(entries) => {
                names.extend(entries.get("file").and_then(Value::as_str).map(str::to_owned));
                waiting.extend(entries.into_iter().map(|(_, value)| value));
            }
            Value::Array(elements) => waiting.extend(elements),
            _ => {}
        }
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let named = names.into_iter().map(|name| folder.join(name));
    named
        .flat_map(|file| match Volume::is_named(&file) {
            true => Volume::files(&file).unwrap_or_else(|_| vec![file]),
            false => vec![file],
        })
        .collect()
}

impl Files {
    /// A run that reads `inputs`, and what scenes among them name.
    pub(crate) fn reading<'a>(
        inputs: impl IntoIterator<Item = &'a Path>,
        reading: Reading,
    ) -> Self {
        // A missing input is an error where it is read; a pipe cannot be overwritten.
        let known = |path: PathBuf| {
            let is_file = fs::metadata(&path).is_ok_and(|metadata| metadata.is_file());
            let handle = is_file.then(|| Handle::from_path(&path).ok())??;
            Some((path, Identity::Existing(handle)))
        };
        let inputs = inputs.into_iter().flat_map(|input| {
            std::iter::once(input.to_owned()).chain(files_of_scene(input, reading))
        });
        Self { inputs: inputs.filter_map(known).collect(), outputs: Vec::new() }
    }

    /// As [`output`](Self::output), for a file whose name must end in `.expected`; a refusal
    /// says `what` it is. A device or a pipe has no ending.
    pub(crate) fn output_as(
        &mut self,
        path: &Path,
        what: &str,
        expected: &str,
    ) -> Result<Destination, Failure> {
        let destination = self.output(path)?;
        if destination.is_file() && ending(path) != expected {
            let problem = format!("the name of {what} must end in .{expected}");
            return Err(Failure::file(path, problem));
        }
        Ok(destination)
    }

    /// Checks that the run can write `path` without losing an input or another output.
    ///
    /// # Errors
    ///
    /// If `path` is an input or another output of the run, a folder, or write-protected, or if
    /// its folder is missing or cannot be written to.
    pub(crate) fn output(&mut self, path: &Path) -> Result<Destination, Failure> {
        let wrong = |problem: String| Failure::file(path, problem);
        let unable = |error: io::Error| Failure::file(path, error);
        let found = match fs::metadata(path) {
            Ok(found) => Some(found),
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(unable(error)),
        };
        let (identity, target) = match found {
            Some(found) if found.is_dir() => return Err(wrong("is a folder".to_owned())),
            Some(found) if !found.is_file() => return Ok(direct(path)),
            Some(found) => existing(path, &found).map_err(unable)?,
            None if path.is_symlink() => {
                return Err(wrong("is a link to a missing file".to_owned()));
            }
            None => absent(path)?,
        };
        if let Some((input, _)) = self.inputs.iter().find(|(_, input)| *input == identity) {
            let input = input.display();
            return Err(wrong(format!("the output would overwrite the input {input}")));
        }
        if let Some((other, _)) = self.outputs.iter().find(|(_, other)| *other == identity) {
            let other = other.display();
            return Err(wrong(format!("the output would overwrite the output {other}")));
        }
        self.outputs.push((path.to_owned(), identity));
        if is_special(path) {
            return Ok(direct(path));
        }
        // Creating a file shows that the folder can be written to.
        Beside::new(&target).map_err(|error| {
            let folder = folder(&target).display().to_string();
            wrong(format!("its folder {} cannot be written to: {error}", shown(&folder)))
        })?;
        Ok(Destination { name: path.to_owned(), target: Target::Replaced(target) })
    }
}

/// The ending of a file's name, in lower case; empty if it has none.
pub(crate) fn ending(path: &Path) -> String {
    let ending = path.extension().and_then(|ending| ending.to_str());
    ending.unwrap_or_default().to_ascii_lowercase()
}

fn direct(path: &Path) -> Destination {
    Destination { name: path.to_owned(), target: Target::Direct }
}

/// `true` for names of open files, such as `/dev/stdout`; other files below `/dev`, as in
/// `/dev/shm`, are files as any.
fn is_special(path: &Path) -> bool {
    let open_files = ["/dev/fd", "/dev/stdin", "/dev/stdout", "/dev/stderr", "/proc"];
    open_files.iter().any(|open| path.starts_with(open))
}

/// An existing file, to be replaced, and its real path.
fn existing(path: &Path, found: &Metadata) -> io::Result<(Identity, PathBuf)> {
    if found.permissions().readonly() {
        return Err(io::Error::new(io::ErrorKind::PermissionDenied, "is write-protected"));
    }
    // Renaming could replace a file that may not be written to; this open fails instead.
    OpenOptions::new().append(true).open(path)?;
    Ok((Identity::Existing(Handle::from_path(path)?), fs::canonicalize(path)?))
}

/// A new file, and its path.
fn absent(path: &Path) -> Result<(Identity, PathBuf), Failure> {
    let wrong = |problem: String| Failure::file(path, problem);
    let name = path.file_name().ok_or_else(|| wrong("names no file".to_owned()))?;
    let folder = folder(path);
    if !folder.is_dir() {
        let folder = folder.display().to_string();
        return Err(wrong(format!("there is no folder {}", shown(&folder))));
    }
    let handle = Handle::from_path(folder).map_err(|error| Failure::file(path, error))?;
    // A name that is not Unicode is compared as it is.
    let lower =
        name.to_str().map_or_else(|| name.to_owned(), |name| name.to_lowercase().into());
    Ok((Identity::Absent(handle, lower), path.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Folder(tempfile::TempDir);

    impl Folder {
        fn with(files: &[&str]) -> Self {
            let folder = Self(tempfile::tempdir().unwrap());
            for file in files {
                fs::write(folder.path(file), "text").unwrap();
            }
            folder
        }

        fn path(&self, name: &str) -> PathBuf {
            self.0.path().join(name)
        }
    }

    fn refusal(files: &mut Files, path: &Path) -> String {
        files.output(path).unwrap_err().to_string()
    }

    #[test]
    fn an_input_is_no_output_by_any_name() {
        let folder = Folder::with(&["in.csv"]);
        fs::create_dir(folder.path("sub")).unwrap();
        fs::hard_link(folder.path("in.csv"), folder.path("hard.csv")).unwrap();
        let input = folder.path("in.csv");
        let mut files = Files::reading([input.as_path()], Reading::default());
        let mut names = vec!["in.csv", "./in.csv", "sub/../in.csv", "hard.csv"];
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("in.csv", folder.path("soft.csv")).unwrap();
            std::os::unix::fs::symlink(".", folder.path("here")).unwrap();
            names.extend(["soft.csv", "here/in.csv"]);
        }
        for name in names {
            let said = refusal(&mut files, &folder.path(name));
            assert!(said.contains("would overwrite the input"), "{name}: {said}");
        }
        files.output(&folder.path("out.csv")).unwrap();
    }

    #[test]
    fn two_outputs_are_two_files() {
        let folder = Folder::with(&["old.csv"]);
        for [first, second] in
            [["new.csv", "./new.csv"], ["new.csv", "NEW.csv"], ["old.csv", "old.csv"]]
        {
            let mut files = Files::default();
            files.output(&folder.path(first)).unwrap();
            let said = refusal(&mut files, &folder.path(second));
            assert!(said.contains("would overwrite the output"), "{first} {second}: {said}");
        }
        let mut files = Files::default();
        for name in ["old.csv", "new.csv", "newer.csv"] {
            files.output(&folder.path(name)).unwrap();
        }
    }

    #[test]
    fn places_that_cannot_be_written_to_are_refused() {
        let folder = Folder::with(&["locked.csv"]);
        let locked = folder.path("locked.csv");
        let mut permissions = fs::metadata(&locked).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&locked, permissions).unwrap();
        let mut files = Files::default();
        for (place, why) in [
            ("locked.csv", "is write-protected"),
            ("no/such/out.csv", "there is no folder"),
            (".", "is a folder"),
        ] {
            let said = refusal(&mut files, &folder.path(place));
            assert!(said.contains(why), "{place}: {said}");
        }
        assert_eq!(fs::read_dir(folder.0.path()).unwrap().count(), 1);
    }

    /// A file in `/dev/shm` was written as a pipe is: after a run it could not be made, and an
    /// old one grew.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_file_in_shared_memory_is_a_file() {
        let Ok(folder) = tempfile::tempdir_in("/dev/shm") else { return };
        let place = folder.path().join("trace.csv");
        for text in ["the old trace", "new"] {
            let destination = Files::default().output(&place).unwrap();
            destination.write(|out| Ok(out.write_all(text.as_bytes())?)).unwrap();
            assert_eq!(fs::read_to_string(&place).unwrap(), text);
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_nothing_is_refused_and_devices_are_not() {
        let folder = Folder::with(&[]);
        std::os::unix::fs::symlink("nowhere", folder.path("link")).unwrap();
        assert!(refusal(&mut Files::default(), &folder.path("link")).contains("missing"));
        let mut files = Files::default();
        for _ in 0..2 {
            files.output(Path::new("/dev/null")).unwrap();
        }
    }
}
