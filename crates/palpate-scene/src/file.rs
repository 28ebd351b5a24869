// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Files that are read whole, and how large they may be.

use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// The largest file that is read whole where nothing else is said [bytes]: a device such as
/// `/dev/zero` has no end, and would fill the memory.
pub const LARGEST_FILE: u64 = 1 << 28;

/// The bytes of a file, a pipe or a device, of which there are at most `most`.
///
/// # Errors
///
/// If it cannot be read, is a folder, or has more bytes; of those the error is [`too_large`].
///
/// ```
/// use palpate_scene::read_file;
///
/// # let folder = tempfile::tempdir().expect("a folder");
/// # let file = folder.path().join("points.csv");
/// std::fs::write(&file, "x_m,y_m\n").expect("can be written");
/// assert_eq!(read_file(&file, 8).expect("is short"), b"x_m,y_m\n");
/// let error = read_file(&file, 7).unwrap_err();
/// assert_eq!(error.to_string(), "is longer than 7 bytes, the most that are read");
/// ```
pub fn read_file(path: impl AsRef<Path>, most: u64) -> Result<Vec<u8>> {
    let path = path.as_ref();
    let found = std::fs::metadata(path)?;
    if found.is_dir() {
        return Err(Error::new(ErrorKind::IsADirectory, "is a folder; name a file in it"));
    }
    if found.len() > most {
        return Err(too_large(most));
    }
    let mut bytes = Vec::new();
    // One byte more tells a longer file: a pipe does not say its length, and a file may grow.
    File::open(path)?.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(too_large(most));
    }
    Ok(bytes)
}

/// The error of a file that has more bytes than `most`, of kind [`ErrorKind::FileTooLarge`].
#[must_use]
pub fn too_large(most: u64) -> Error {
    let problem = format!("is longer than {most} bytes, the most that are read");
    Error::new(ErrorKind::FileTooLarge, problem)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sparse_file_is_refused_before_it_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("sparse");
        File::create(&file).unwrap().set_len(1 << 40).unwrap();
        let error = read_file(&file, LARGEST_FILE).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::FileTooLarge);
        assert!(error.to_string().contains("longer than 268435456 bytes"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn what_has_no_end_is_refused() {
        let error = read_file("/dev/zero", 1000).unwrap_err();
        assert_eq!(error.to_string(), too_large(1000).to_string());
        assert_eq!(read_file("/dev/null", 0).unwrap(), b"");
    }

    #[test]
    fn a_folder_is_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let error = read_file(folder.path(), LARGEST_FILE).unwrap_err();
        assert_eq!(error.to_string(), "is a folder; name a file in it");
    }
}
