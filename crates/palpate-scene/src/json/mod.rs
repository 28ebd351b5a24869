// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! JSON with places: reading that knows lines, writing that people like to read.

mod deserialize;
mod document;
mod write;

pub(crate) use deserialize::{found, read};
pub(crate) use document::{Document, Position};
pub(crate) use write::write;
