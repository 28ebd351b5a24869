// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Files that are written beside the one that they replace.

use std::fs::File;
use std::io;
use std::path::Path;

use tempfile::{Builder, NamedTempFile};

use super::folder;

/// A new file in the folder of an output. On Linux it has no name before it is whole, so that nothing
/// is left of it however the program ends; elsewhere, and on file systems without such files, it has
/// one, and is removed unless it is renamed.
pub(super) enum Beside {
    #[cfg(target_os = "linux")]
    Unnamed(File),
    Named(NamedTempFile),
}

impl Beside {
    /// A new file beside `place`.
    pub(super) fn new(place: &Path) -> io::Result<Self> {
        #[cfg(target_os = "linux")]
        if let Some(file) = unnamed::file(place) {
            return Ok(Self::Unnamed(file));
        }
        named().tempfile_in(folder(place)).map(Self::Named)
    }

    pub(super) fn file(&self) -> &File {
        match self {
            #[cfg(target_os = "linux")]
            Self::Unnamed(file) => file,
            Self::Named(file) => file.as_file(),
        }
    }

    /// Gives the file its name; one that has it is replaced.
    pub(super) fn persist(self, place: &Path) -> io::Result<()> {
        let file = match self {
            #[cfg(target_os = "linux")]
            Self::Unnamed(file) => return unnamed::persist(&file, place),
            Self::Named(file) => file,
        };
        file.persist(place).map_err(|refused| refused.error)?;
        Ok(())
    }
}

/// Files with a name, and with the permissions of any new file, from which the user's mask takes away.
fn named() -> Builder<'static, 'static> {
    let mut builder = Builder::new();
    builder.prefix(".palpate-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder
}

/// Files without a name.
#[cfg(target_os = "linux")]
mod unnamed {
    use std::fs::File;
    use std::io::{self, ErrorKind};
    use std::os::fd::AsRawFd;
    use std::path::{Path, PathBuf};

    use rustix::fs::{AtFlags, CWD, Mode, OFlags, linkat, open};

    use super::{folder, named};

    /// A new file, if there can be one and it can be given a name.
    pub(super) fn file(place: &Path) -> Option<File> {
        let flags = OFlags::TMPFILE | OFlags::RDWR | OFlags::CLOEXEC;
        let file: File = open(folder(place), flags, Mode::from_raw_mode(0o666)).ok()?.into();
        name_of_open(&file).symlink_metadata().is_ok().then_some(file)
    }

    /// Gives a file its name; one that has it is replaced, over a second name for a moment.
    pub(super) fn persist(file: &File, place: &Path) -> io::Result<()> {
        match link(file, place) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                let linked = named().make_in(folder(place), |name| link(file, name))?;
                linked.persist(place).map_err(|refused| refused.error)
            }
            done => done,
        }
    }

    fn link(file: &File, name: &Path) -> io::Result<()> {
        Ok(linkat(CWD, name_of_open(file), CWD, name, AtFlags::SYMLINK_FOLLOW)?)
    }

    /// A link to an open file.
    fn name_of_open(file: &File) -> PathBuf {
        format!("/proc/self/fd/{}", file.as_raw_fd()).into()
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::io::Write;

    use super::*;

    #[test]
    fn a_file_replaces_another_once_it_is_whole() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("out.csv");
        let usual = || Beside::new(&place).unwrap();
        let with_a_name = || Beside::Named(named().tempfile_in(folder.path()).unwrap());
        for new in [&usual as &dyn Fn() -> Beside, &usual, &with_a_name] {
            let beside = new();
            beside.file().write_all(b"whole").unwrap();
            beside.persist(&place).unwrap();
            assert_eq!(fs::read(&place).unwrap(), b"whole");
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        }
    }

    /// A program that was killed left a file of another name.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_file_that_is_not_whole_has_no_name() {
        let folder = tempfile::tempdir().unwrap();
        let beside = Beside::new(&folder.path().join("out.csv")).unwrap();
        beside.file().write_all(b"half").unwrap();
        // A file system without unnamed files is none of those that tests run on.
        assert!(matches!(beside, Beside::Unnamed(_)));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
