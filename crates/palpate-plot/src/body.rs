// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The bodies of a scene in a picture.

use crate::outline::SurfaceLines;

/// A body with its surface, to be drawn in a colour of its own.
///
/// # Examples
///
/// ```
/// use palpate_plot::{DrawnBody, SurfaceLines};
///
/// # let outline = SurfaceLines::default();
/// let cup = DrawnBody::new("cup", outline).with_note("glass");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnBody {
    pub(crate) name: String,
    pub(crate) note: String,
    pub(crate) outline: SurfaceLines,
}

impl DrawnBody {
    /// The body `name`, with its surface in the window of the picture.
    #[must_use]
    pub fn new(name: impl Into<String>, outline: SurfaceLines) -> Self {
        Self { name: name.into(), note: String::new(), outline }
    }

    /// With a few words that stand below its name, such as its material.
    #[must_use]
    pub fn with_note(self, note: impl Into<String>) -> Self {
        Self { note: note.into(), ..self }
    }

    /// Its name, with the note.
    pub(crate) fn in_words(&self) -> String {
        let Self { name, note, .. } = self;
        if note.is_empty() { name.clone() } else { format!("{name} ({note})") }
    }
}
