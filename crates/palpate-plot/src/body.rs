// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The bodies of a scene in a picture.

use crate::outline::Outline;

/// A body with its surface, to be drawn in a colour of its own.
///
/// # Examples
///
/// ```
/// use palpate_plot::{Body, Outline};
///
/// # let outline = Outline::default();
/// let cup = Body::new("cup", outline).with_note("glass");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    pub(crate) name: String,
    pub(crate) note: String,
    pub(crate) outline: Outline,
}

impl Body {
    /// The body `name`, with its surface in the window of the picture.
    #[must_use]
    pub fn new(name: impl Into<String>, outline: Outline) -> Self {
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
