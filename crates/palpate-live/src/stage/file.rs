// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Files of scenes: read with care, and replaced so that nothing is lost.

use std::io::{Error, ErrorKind, Result, Write};
use std::path::{Path, PathBuf};

use palpate::scene::utf8;

/// The largest scene [bytes]: what the pages are told of it is a few times as large.
pub(super) const LARGEST: usize = 4 << 20;

/// The most nodes of a scene, references followed: an edit builds all of them, and the next one
/// waits for that.
pub(super) const MOST_NODES: usize = 20_000;

/// The most links that a path leads over, as on Linux.
const MOST_LINKS: usize = 40;

/// Writes a file beside and renames it, so that there is a whole file at all times; if it `is_new`, over
/// none that came meanwhile.
///
/// # Errors
///
/// If it cannot be written, or is a link out of its folder.
pub(super) fn replace(file: &Path, text: &str, is_new: bool) -> Result<()> {
    let file = behind_links(file)?;
    let before = std::fs::metadata(&file).ok();
    if before.as_ref().is_some_and(|before| !before.is_file()) {
        return Err(Error::new(ErrorKind::InvalidInput, "is no file: save as another one"));
    }
    if before.as_ref().is_some_and(|before| before.permissions().readonly()) {
        let why = "is read-only: save as another file, or make it writable";
        return Err(Error::new(ErrorKind::PermissionDenied, why));
    }
    let mut beside = new_file().tempfile_in(folder(&file))?;
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

/// What a link in the folder of a file leads to, which is replaced: the link stays one.
fn behind_links(file: &Path) -> Result<PathBuf> {
    let end = std::fs::canonicalize(file).unwrap_or_else(|_| end_of_links(file));
    if !folder(&end).canonicalize()?.starts_with(folder(file).canonicalize()?) {
        let why =
            "is a link out of its folder: open the file that it leads to, or save as another";
        return Err(Error::new(ErrorKind::InvalidInput, why));
    }
    Ok(end)
}

/// The folder that a file is in.
fn folder(file: &Path) -> &Path {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
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
    if !std::fs::metadata(file)?.is_file() {
        return Err(Error::new(ErrorKind::InvalidInput, "is no file"));
    }
    let bytes = palpate::scene::read_file(file, LARGEST as u64)?;
    let text = utf8(&bytes).map_err(|error| Error::new(ErrorKind::InvalidData, error))?;
    Ok(text.to_owned())
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;

    /// What a link led to in another folder was once written over, or made.
    #[test]
    fn a_link_out_of_the_folder_is_not_followed() {
        let [own, other] = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let outside = other.path().join("outside.json");
        let [link, chain, folder] =
            ["link", "chain", "folder"].map(|name| own.path().join(name));
        std::os::unix::fs::symlink(&outside, &link).unwrap();
        std::os::unix::fs::symlink("link", &chain).unwrap();
        std::os::unix::fs::symlink(other.path(), &folder).unwrap();
        for there in [false, true] {
            for file in [&link, &chain] {
                let refused = replace(file, "text", false).unwrap_err().to_string();
                assert!(refused.contains("is a link out of its folder"), "{refused}");
                assert!(file.is_symlink() && outside.exists() == there);
            }
            std::fs::write(&outside, "old").unwrap();
        }
        assert_eq!(std::fs::read_to_string(&outside).unwrap(), "old");
        // A folder may be reached over a link.
        replace(&folder.join("outside.json"), "text", false).unwrap();
        assert_eq!(std::fs::read_to_string(&outside).unwrap(), "text");
    }

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
