// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Profiles of devices on the command line: by name, or in a file.

use std::path::PathBuf;
use std::str::FromStr;

use palpate::device::{DeviceProfile, PROFILES, profile_named};
use palpate::scene::{device_from_file, unknown_name};

use crate::output::shown_lines;

/// The profile of a device, by a name of `palpate devices` or in a JSON file.
#[derive(Clone, Debug)]
pub(crate) struct ProfileChoice {
    /// As the command line names it.
    pub(crate) name: String,
    pub(crate) profile: DeviceProfile,
    /// The file that it is from.
    pub(crate) file: Option<PathBuf>,
}

impl ProfileChoice {
    /// The profile of this name in the list of devices.
    pub(crate) fn named(name: &str) -> Result<Self, String> {
        let names = PROFILES.each_ref().map(|(name, _)| *name);
        let profile = profile_named(name).map_err(|_| unknown_name("device", name, &names))?;
        Ok(Self { name: name.to_owned(), profile, file: None })
    }
}

impl FromStr for ProfileChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let path = PathBuf::from(text);
        if !path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json")) {
            return Self::named(text);
        }
        let read = device_from_file(&path).map_err(|error| {
            let problems: Vec<_> = error.problems().map(ToString::to_string).collect();
            // What the file holds must not steer a terminal.
            shown_lines(&problems.join("\n")).into_owned()
        });
        Ok(Self { name: text.to_owned(), profile: read?, file: Some(path) })
    }
}
