// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a run writes: files, answers, remarks.
//!
//! All output of the program: files, standard output, messages.
//!
//! Before it begins, a run names the files that it reads and writes to [`Files`], which refuses
//! an output that would overwrite an input or another output. A [`Destination`] is written to a
//! temporary file in the same folder and renamed when complete, so a failed run leaves the old
//! file.

use std::fmt;
use std::fs::{self, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use palpate::scene::Versioned;
use palpate::scene::text::shown_json;
use serde::Serialize;

use self::beside::Beside;
use self::standard::StandardOutput;
use crate::outcome::{Failure, Outcome};

pub(crate) use files::{Files, ending};
pub(crate) use palpate::scene::text::{counted, shown, shown_lines};

mod beside;
mod files;
mod standard;

/// Where an output goes.
#[derive(Debug)]
pub(crate) struct Destination {
    /// The path on the command line; empty for standard output.
    name: PathBuf,
    target: Target,
}

/// How an output is written.
#[derive(Debug)]
enum Target {
    /// Written to standard output.
    Standard,
    /// Written directly: a device or a pipe cannot be replaced.
    Direct,
    /// Written to a file beside this path, then renamed to it. Links are resolved.
    Replaced(PathBuf),
}

impl Destination {
    /// Standard output.
    pub(crate) fn standard() -> Self {
        Self { name: PathBuf::new(), target: Target::Standard }
    }

    /// The path that the command line gave.
    pub(crate) fn name(&self) -> &Path {
        &self.name
    }

    /// `true` for a file; `false` for standard output, devices and pipes.
    pub(crate) fn is_file(&self) -> bool {
        matches!(self.target, Target::Replaced(_))
    }

    /// Where an output goes that is not whole: `NAME.part`, or `None` if the destination cannot
    /// be replaced.
    pub(crate) fn part(&self) -> Option<PathBuf> {
        match &self.target {
            Target::Standard | Target::Direct => None,
            Target::Replaced(place) => Some(part(place)),
        }
    }

    /// Writes what `fill` writes. If that fails, an existing file stays as it was.
    pub(crate) fn write<T>(
        &self,
        fill: impl FnOnce(&mut (dyn Write + Send)) -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        self.write_whole(fill, |_| true)
    }

    /// As [`write`](Self::write), but an output that is not whole goes to
    /// [`part`](Self::part), and an existing file stays as it was.
    pub(crate) fn write_whole<T>(
        &self,
        fill: impl FnOnce(&mut (dyn Write + Send)) -> Result<T, Failure>,
        is_whole: impl FnOnce(&T) -> bool,
    ) -> Result<T, Failure> {
        match &self.target {
            Target::Standard => filled(StandardOutput::new(), fill),
            Target::Direct => {
                // Append: a path such as /dev/stdout may lead to a file that other programs
                // write.
                let file = OpenOptions::new().append(true).open(&self.name);
                file.map_err(Failure::from).and_then(|file| filled(file, fill))
            }
            Target::Replaced(place) => replaced(place, fill, is_whole),
        }
        .map_err(|failure| match failure {
            failure if failure.is_closed_pipe() => failure,
            Failure::Output(error) if !self.name.as_os_str().is_empty() => {
                Failure::file(&self.name, error)
            }
            other => other,
        })
    }
}

/// Calls `fill` with a buffer to `out`, and flushes it.
fn filled<T>(
    out: impl Write + Send,
    fill: impl FnOnce(&mut (dyn Write + Send)) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let mut out = BufWriter::new(out);
    let answer = fill(&mut out)?;
    out.flush()?;
    Ok(answer)
}

/// Calls `fill` with a new file beside `place`, and renames it to `place`, or to its part.
fn replaced<T>(
    place: &Path,
    fill: impl FnOnce(&mut (dyn Write + Send)) -> Result<T, Failure>,
    is_whole: impl FnOnce(&T) -> bool,
) -> Result<T, Failure> {
    let beside = Beside::new(place)?;
    let answer = filled(beside.file(), fill)?;
    if !is_whole(&answer) {
        beside.persist(&part(place))?;
        return Ok(answer);
    }
    if let Ok(old) = fs::metadata(place) {
        beside.file().set_permissions(old.permissions())?;
        // Synchronised first, so the old file goes only once the new one is on the disk.
        beside.file().sync_data()?;
    }
    beside.persist(place)?;
    Ok(answer)
}

/// `NAME.part`.
fn part(place: &Path) -> PathBuf {
    let mut part = place.as_os_str().to_owned();
    part.push(".part");
    part.into()
}

/// Creates a folder for outputs, and missing ones above it.
pub(crate) fn make_folder(path: &Path) -> Result<(), Failure> {
    fs::create_dir_all(path).map_err(|error| Failure::file(path, error))
}

/// The folder that `place` is in.
fn folder(place: &Path) -> &Path {
    match place.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// A time [s] as text.
pub(crate) fn microseconds(time: f64) -> String {
    format!("{:.2} µs", 1e6 * time)
}

/// Standard output for an answer in words or JSON. It escapes characters that a terminal would
/// obey.
#[derive(Debug)]
pub(crate) struct Answer {
    out: StandardOutput,
}

/// The standard output, for the answer of a command.
pub(crate) fn answer() -> Answer {
    Answer { out: StandardOutput::new() }
}

impl Answer {
    /// Writes an answer as an object that begins with its version, and ends the line.
    pub(crate) fn json(&mut self, answer: &impl Serialize) -> io::Result<()> {
        let json = serde_json::to_string_pretty(&Versioned::new(answer))?;
        writeln!(self.out, "{}", shown_json(&json))
    }

    /// Writes an answer, as JSON or in words.
    pub(crate) fn print(
        &mut self,
        answer: &(impl Serialize + fmt::Display),
        as_json: bool,
    ) -> io::Result<()> {
        if as_json { self.json(answer) } else { write!(self, "{answer}") }
    }
}

impl Write for Answer {
    /// Writes the whole of `text`. Formatting passes whole strings, so no character is cut in
    /// two.
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        self.out.write_all(shown_lines(&String::from_utf8_lossy(text)).as_bytes())?;
        Ok(text.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Flushes standard output at the end of a command; the command fails if that fails.
pub(crate) fn ended(outcome: Outcome) -> Result<Outcome, Failure> {
    io::stdout().flush()?;
    Ok(outcome)
}

/// Prints help on standard output, or an error of the command line on standard error; returns
/// the exit status.
pub(crate) fn usage(refused: &clap::Error) -> Result<u8, Failure> {
    if !refused.use_stderr() {
        standard::check()?;
        refused.print()?;
        io::stdout().flush()?;
    } else {
        // Ignored: without standard error there is nowhere to report it.
        let _ = refused.print();
    }
    Ok(u8::try_from(refused.exit_code()).unwrap_or(Failure::STATUS))
}

/// Prints on standard error why a command fails, in one line or several.
pub(crate) fn complain(problem: impl fmt::Display) {
    // Ignored: there is nowhere else to say it.
    let _ = writeln!(io::stderr(), "palpate: {}", shown_lines(&problem.to_string()));
}

/// Prints a remark beside the answer, on standard error.
pub(crate) fn remark(text: impl fmt::Display) {
    // Ignored: a remark does not change the answer.
    let _ = writeln!(io::stderr(), "{}", shown(&text.to_string()));
}

/// Writes over the last live line on standard error.
pub(crate) fn live(line: impl fmt::Display) {
    // Ignored: the line does not change the answer.
    let _ = write!(io::stderr(), "\r{}\x1b[K", shown(&line.to_string()));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn destination(path: &Path) -> Destination {
        Files::default().output(path).unwrap()
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let name = |entry: io::Result<fs::DirEntry>| entry.unwrap().file_name();
        let mut names: Vec<_> =
            entries.map(|entry| name(entry).into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_failure_in_the_middle_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("out.csv");
        fs::write(&place, "old").unwrap();
        let failed: Result<(), Failure> = destination(&place).write(|out| {
            out.write_all(&[b'x'; 100_000])?;
            Err(Failure::input("a bad row"))
        });
        assert_eq!(failed.unwrap_err().to_string(), "a bad row");
        assert_eq!(fs::read(&place).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["out.csv"]);
        destination(&place).write(|out| Ok(out.write_all(b"new")?)).unwrap();
        assert_eq!(fs::read(&place).unwrap(), b"new");
        assert_eq!(names(folder.path()), ["out.csv"]);
    }

    #[test]
    fn an_output_that_is_not_whole_has_a_file_of_its_own() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("out.csv");
        fs::write(&place, "old").unwrap();
        let destination = destination(&place);
        destination.write_whole(|out| Ok(out.write_all(b"half")?), |()| false).unwrap();
        assert_eq!(fs::read(&place).unwrap(), b"old");
        assert_eq!(fs::read(destination.part().unwrap()).unwrap(), b"half");
        assert_eq!(names(folder.path()), ["out.csv", "out.csv.part"]);
    }

    #[cfg(unix)]
    #[test]
    fn permissions_of_a_replaced_file_and_links_to_it_stay() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (place, link) = (folder.path().join("out.csv"), folder.path().join("link"));
        fs::write(&place, "old").unwrap();
        fs::set_permissions(&place, fs::Permissions::from_mode(0o640)).unwrap();
        std::os::unix::fs::symlink("out.csv", &link).unwrap();
        destination(&link).write(|out| Ok(out.write_all(b"new")?)).unwrap();
        assert_eq!(fs::read(&place).unwrap(), b"new");
        assert_eq!(fs::metadata(&place).unwrap().permissions().mode() & 0o777, 0o640);
        assert!(fs::symlink_metadata(&link).unwrap().file_type().is_symlink());
    }

    #[cfg(unix)]
    #[test]
    fn a_new_file_is_as_readable_as_any_other() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let [usual, ours] = ["usual", "ours"].map(|name| folder.path().join(name));
        fs::write(&usual, "").unwrap();
        destination(&ours).write(|_| Ok(())).unwrap();
        let mode = |path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&usual));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_an_error_that_names_the_output() {
        let full = Path::new("/dev/full");
        let failed = destination(full).write(|out| Ok(out.write_all(b"x")?));
        let said = failed.unwrap_err().to_string();
        assert!(said.starts_with("/dev/full: No space left"), "{said}");
    }
}
