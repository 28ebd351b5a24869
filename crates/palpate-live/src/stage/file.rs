// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Files of scenes: read with care, and replaced so that nothing is lost.

use std::io::{Error, ErrorKind, Result, Write};
use std::path::{Path, PathBuf};

/// The largest scene [bytes]: what the pages are told of it is a few times as large.
pub(super) const LARGEST: usize = 4 << 20;

/// The most links that a path leads over, as on Linux.
const MOST_LINKS: usize = 40;

/// Writes a file beside and renames it, so that there is a whole file at all times; if it `is_new`, over
/// none that came meanwhile.
pub(super) fn replace(file: &Path, text: &str, is_new: bool) -> Result<()> {
    // A link stays one: what it leads to is replaced.
    let file = std::fs::canonicalize(file).unwrap_or_else(|_| end_of_links(file));
    let before = std::fs::metadata(&file).ok();
    if before.as_ref().is_some_and(|before| !before.is_file()) {
        return Err(Error::new(ErrorKind::InvalidInput, "is no file: save as another one"));
    }
    if before.as_ref().is_some_and(|before| before.permissions().readonly()) {
        let why = "is read-only: save as another file, or make it writable";
        return Err(Error::new(ErrorKind::PermissionDenied, why));
    }
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    let mut beside = new_file().tempfile_in(folder)?;
    beside.write_all(text.as_bytes())?;
    beside.as_file().sync_all()?;
    match &before {
        // A rename would cut the file off from its other hard links.
        Some(before) if has_other_names(before) && !is_new => {
            std::fs::write(&file, text)?;
            return beside.close();
        }
        Some(before) => std::fs::set_permissions(beside.path(), before.permissions())?,
        None => {}
    }
    if is_new {
        beside.persist_noclobber(&file)?
    } else {
        beside.persist(&file)?
    };
    Ok(())
}

/// Where a link leads whose end is not there.
fn end_of_links(file: &Path) -> PathBuf {
    let mut end = file.to_owned();
    for _ in 0..MOST_LINKS {
        let Ok(next) = std::fs::read_link(&end) else { break };
        // A path that is whole replaces the folder.
        end = end.with_file_name("").join(next);
    }
    end
}

/// A file that is readable and writable for whom new files are.
fn new_file() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder
}

/// Whether a file has hard links, of which a file that is renamed to it would be none.
fn has_other_names(metadata: &std::fs::Metadata) -> bool {
    #[cfg(unix)]
    return std::os::unix::fs::MetadataExt::nlink(metadata) > 1;
    #[cfg(not(unix))]
    {
        let _ = metadata;
        false
    }
}

/// The text of a file that can be a scene's.
///
/// # Errors
///
/// If it cannot be read, is no regular file, or is too large.
pub(super) fn read_file(file: &Path) -> Result<String> {
    let metadata = std::fs::metadata(file)?;
    if !metadata.is_file() || metadata.len() > LARGEST as u64 {
        let why = format!("is no file of at most {LARGEST} bytes");
        return Err(Error::new(ErrorKind::InvalidInput, why));
    }
    std::fs::read_to_string(file)
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;

    /// A link whose end was deleted once became a file itself.
    #[test]
    fn a_link_to_nothing_stays_a_link() {
        let folder = tempfile::tempdir().unwrap();
        let [link, other, end] = ["link", "other", "end"].map(|name| folder.path().join(name));
        std::os::unix::fs::symlink("other", &link).unwrap();
        std::os::unix::fs::symlink(&end, &other).unwrap();
        replace(&link, "text", false).unwrap();
        assert!(link.is_symlink() && other.is_symlink());
        assert_eq!(read_file(&end).unwrap(), "text");
        assert_eq!(read_file(&link).unwrap(), "text");
        // What is no file is never replaced: once a link to a device was followed.
        assert!(replace(folder.path(), "text", false).is_err());
        // A link to itself leads nowhere, and is left as it is.
        std::fs::remove_file(&end).unwrap();
        std::os::unix::fs::symlink(&end, &end).unwrap();
        assert!(replace(&link, "text", true).is_err());
        assert!(end.is_symlink());
    }
}
