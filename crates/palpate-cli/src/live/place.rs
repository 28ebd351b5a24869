// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The port and the token of a page: those of the last run, so that a page that is open comes back.

use std::fs::OpenOptions;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use palpate_live::Live;

use crate::arguments::PageOptions;
use crate::outcome::Failure;
use crate::output;

/// Where a page is to be served.
#[derive(Debug)]
pub(super) struct Place {
    pub(super) port: Option<u16>,
    pub(super) token: Option<String>,
    /// Where port and token are written.
    memory: Memory,
}

#[derive(Debug)]
enum Memory {
    /// A file of the command line: the token alone.
    Token(PathBuf),
    /// The user's own: port and token.
    Last(PathBuf),
    /// None: a new token for each run.
    None,
}

impl Place {
    /// Each scene has its own file of port and token, so that programs which are started in another
    /// order keep theirs.
    pub(super) fn of(asked: &PageOptions, scene: Option<&Path>) -> Result<Self, Failure> {
        if let Some(file) = &asked.token_file {
            let token = match std::fs::read_to_string(file) {
                Ok(text) => Some(text.trim().to_owned()),
                Err(error) if error.kind() == ErrorKind::NotFound => None,
                Err(error) => return Err(Failure::file(file, error)),
            };
            return Ok(Self { port: None, token, memory: Memory::Token(file.clone()) });
        }
        let Some(folder) = dirs::runtime_dir().or_else(dirs::cache_dir) else {
            return Ok(Self { port: None, token: None, memory: Memory::None });
        };
        let name = scene.map_or_else(|| "page".to_owned(), name_for);
        let file = folder.join("palpate").join(name);
        // A damaged file counts as missing.
        let text = std::fs::read_to_string(&file).unwrap_or_default();
        let (port, token) = text.trim().split_once(' ').unzip();
        let port = port.and_then(|port| port.parse().ok());
        let is_token =
            |token: &&str| token.len() == 32 && token.bytes().all(|b| b.is_ascii_hexdigit());
        let token = token.filter(is_token).map(str::to_owned);
        Ok(Self { port, token, memory: Memory::Last(file) })
    }

    /// Keeps where the page is, for the next run.
    pub(super) fn remember(&self, live: &Live) -> Result<(), Failure> {
        match &self.memory {
            Memory::Token(file) if self.token.is_none() => {
                let written = write(file, live.token());
                written.map_err(|error| Failure::file(file, error))
            }
            // The port of the last run stays that of the program which has it, or of a run without --port.
            Memory::Last(_) if self.port.is_some_and(|port| port != live.address().port()) => {
                Ok(())
            }
            Memory::Last(file) => {
                let folder = file.parent().map_or(Ok(()), std::fs::create_dir_all);
                let text = format!("{} {}", live.address().port(), live.token());
                // Without it, an open page does not find the next run, and no more.
                let _ = folder.and_then(|()| write(file, &text));
                Ok(())
            }
            Memory::Token(file) => {
                warn_of_readers(file);
                Ok(())
            }
            Memory::None => Ok(()),
        }
    }
}

/// The name of the file for a scene, of its path.
fn name_for(scene: &Path) -> String {
    let mut hasher = DefaultHasher::new();
    scene.canonicalize().unwrap_or_else(|_| scene.to_owned()).hash(&mut hasher);
    format!("page-{:016x}", hasher.finish())
}

/// Warns of a file with a token that others can read.
fn warn_of_readers(file: &Path) {
    #[cfg(unix)]
    if let Ok(metadata) = std::fs::metadata(file)
        && std::os::unix::fs::MetadataExt::mode(&metadata) & 0o077 != 0
    {
        let file = file.display();
        output::remark(format_args!(
            "warning: others on this machine can read {file}, and with it move the hand: chmod 600 {file}"
        ));
    }
    #[cfg(not(unix))]
    let _ = file;
}

/// Writes a file that only its owner can read.
fn write(file: &Path, text: &str) -> std::io::Result<()> {
    let mut options = OpenOptions::new();
    options.write(true).create(true).truncate(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let mut opened = options.open(file)?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        opened.set_permissions(std::fs::Permissions::from_mode(0o600))?;
    }
    writeln!(opened, "{text}")
}
