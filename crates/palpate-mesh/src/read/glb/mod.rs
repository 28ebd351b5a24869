// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! glTF 2.0: binary, or as text that holds its data (Khronos 2021).
//!
//! The header of a binary file is `glTF`, its version and its length. Chunks follow: JSON, which
//! describes the scene, and the data. Nothing that the JSON says of the data is trusted.

use super::text::{check_encoding, without_mark};
use super::{Format, ReadProblem};
use crate::mesh::TriangleMesh;

mod affine;
mod base64;
mod data;
mod document;
mod extensions;
mod limits;
mod morph;
mod scene;

/// Bytes of the header, of a number in it, and of what comes before the bytes of a chunk.
const HEADER: usize = 12;
const NUMBER: usize = 4;
const CHUNK: usize = 8;

pub(super) fn read(bytes: &[u8]) -> Result<TriangleMesh, ReadProblem> {
    let chunks = if bytes.starts_with(b"glTF") { chunks(bytes)? } else { of_text(bytes)? };
    let document = document::read(&chunks)?;
    extensions::check(&document)?;
    let data = data::Data::new(&document, chunks.data);
    let mut scene = scene::Scene::new(&data);
    scene.place_all(&limits::Limits::of(bytes.len()))?;
    scene.mesh()
}

/// `true` if the first bytes of a file are those of glTF as text.
pub(super) fn is_likely_text(bytes: &[u8]) -> bool {
    /// What is looked at of a file [bytes].
    const HEAD: usize = 1 << 16;
    let head = without_mark(&bytes[..bytes.len().min(HEAD)]).trim_ascii_start();
    let has = |word: &[u8]| head.windows(word.len()).any(|part| part == word);
    head.starts_with(b"{")
        && !has(br#""palpate"#)
        && [&br#""asset""#[..], br#""bufferViews""#, br#""accessors""#].into_iter().any(has)
}

fn malformed(problem: impl std::fmt::Display) -> ReadProblem {
    Format::Glb.malformed(problem)
}

/// The parts of a file.
struct Chunks<'a> {
    json: &'a [u8],
    /// Where the JSON begins in the file [bytes].
    json_start: usize,
    data: Option<&'a [u8]>,
}

/// The chunks of a binary file; those of unknown kinds are passed over.
fn chunks(bytes: &[u8]) -> Result<Chunks<'_>, ReadProblem> {
    let number = |place: usize| {
        let bytes = bytes.get(place..)?.first_chunk::<NUMBER>()?;
        Some(u32::from_le_bytes(*bytes) as usize)
    };
    let found = bytes.len();
    let (Some(version), Some(length)) = (number(NUMBER), number(2 * NUMBER)) else {
        return Err(malformed(format_args!(
            "its header has {HEADER} bytes, and the file ends at byte {found}: it is cut off"
        )));
    };
    if version != 2 {
        return Err(malformed(format_args!(
            "byte {NUMBER}: it is glTF {version}, and version 2 is read"
        )));
    }
    if length > found {
        return Err(malformed(format_args!(
            "byte 8: the file should have {length} bytes, and ends at byte {found}: it is cut off"
        )));
    }
    let (mut json, mut data) = (None, None);
    let mut place = HEADER;
    while length.saturating_sub(place) >= CHUNK {
        let start = place + CHUNK;
        let count = number(place).unwrap_or_default();
        let Some(chunk) = bytes[..length].get(start..).and_then(|rest| rest.get(..count))
        else {
            return Err(malformed(format_args!(
                "byte {place}: a chunk should have {count} bytes, and {} are left of the \
                 {length} of the file: it is cut off",
                length - start
            )));
        };
        match &bytes[place + NUMBER..start] {
            b"JSON" if json.is_none() => json = Some((chunk, start)),
            b"BIN\0" if data.is_none() => data = Some(chunk),
            _ => {}
        }
        place = start.saturating_add(count.next_multiple_of(NUMBER));
    }
    let (json, json_start) = json.ok_or_else(|| malformed("it has no chunk of JSON"))?;
    Ok(Chunks { json, json_start, data })
}

/// A file that is text.
fn of_text(bytes: &[u8]) -> Result<Chunks<'_>, ReadProblem> {
    check_encoding(bytes)?;
    let json = without_mark(bytes);
    if !json.trim_ascii_start().starts_with(b"{") {
        let problem = "it begins neither as binary glTF, with `glTF`, nor as text, with `{`";
        return Err(malformed(problem));
    }
    Ok(Chunks { json, json_start: bytes.len() - json.len(), data: None })
}
