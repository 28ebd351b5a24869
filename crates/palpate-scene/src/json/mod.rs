// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! JSON with places: reading that knows lines, writing that people like to read.

mod deserialize;
mod document;
mod grammar;
mod reading;
mod source;
mod tokens;
mod word;
mod write;

pub(crate) use deserialize::found;
pub(crate) use document::Document;
pub(crate) use reading::read;
pub(crate) use source::{Position, Source};
pub(crate) use write::write;
