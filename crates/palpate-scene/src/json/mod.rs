// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! JSON with places: reading that knows lines, writing that people like to read.

mod document;
mod grammar;
mod source;
mod word;
mod write;

pub(crate) use document::{Document, read};
pub(crate) use source::{Position, Source};
pub(crate) use write::{found, write};
