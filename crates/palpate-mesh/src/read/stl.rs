// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! STL, with stl_io.
//!
//! A file is binary if it is as long as its count of triangles says, whatever its header
//! says: headers of binary files may begin as those of text do.

use std::io::Cursor;

use palpate_field::Vector;

use super::Format;
use super::ReadProblem;
use crate::mesh::TriangleMesh;

/// Bytes of a binary header, of the count behind it, and of a triangle.
const HEADER: usize = 80;
const COUNT: usize = 4;
const TRIANGLE: usize = 50;

pub(super) fn read(bytes: &[u8]) -> Result<TriangleMesh, ReadProblem> {
    let mut vertices = Vec::new();
    if is_binary(bytes) {
        check_length(bytes)?;
        let mut copy = bytes.to_vec();
        copy[..HEADER].fill(0);
        append(&copy, &mut vertices, |i| format!("byte {}", HEADER + COUNT + i * TRIANGLE))?;
    } else if bytes.len() < HEADER + COUNT && !begins_as_text(bytes) {
        let length = bytes.len();
        return Err(Format::Stl.malformed(format_args!(
            "it ends at byte {length}: a binary file has {} bytes before its triangles, and a text begins with `solid`",
            HEADER + COUNT
        )));
    } else {
        // Some programs write capitals, which stl_io does not read.
        let text = String::from_utf8_lossy(without_mark(bytes)).to_ascii_lowercase();
        for solid in solids(&text) {
            append(solid.as_bytes(), &mut vertices, |i| line_of_facet(&text, i))?;
        }
    }
    let corners = (0..vertices.len() as u32).collect::<Vec<_>>();
    let (triangles, _) = corners.as_chunks::<3>();
    Ok(TriangleMesh::new(vertices, triangles.to_vec())?.welded())
}

/// Refuses a binary file that is shorter than its count of triangles says, or has whole triangles beyond it.
fn check_length(bytes: &[u8]) -> Result<(), ReadProblem> {
    match binary_length(bytes) {
        Some(length) if length > bytes.len() => {
            let triangles = (length - HEADER - COUNT) / TRIANGLE;
            let found = bytes.len();
            Err(Format::Stl.malformed(format_args!(
                "byte {HEADER}: {triangles} triangles are counted, which take {length} bytes, and \
                 the file ends at byte {found}: it is cut off"
            )))
        }
        Some(length)
            if length < bytes.len() && (bytes.len() - length).is_multiple_of(TRIANGLE) =>
        {
            let triangles = (length - HEADER - COUNT) / TRIANGLE;
            let more = (bytes.len() - length) / TRIANGLE;
            Err(Format::Stl.malformed(format_args!(
                "byte {HEADER}: {triangles} triangles are counted, and {more} more follow"
            )))
        }
        _ => Ok(()),
    }
}

/// Where the `i`-th facet of a text begins: "facet at line 12", and that the text is cut off if it ends there.
fn line_of_facet(text: &str, i: usize) -> String {
    let is_facet = |(_, line): &(usize, &str)| line.trim_start().starts_with("facet");
    let mut facets = text.lines().enumerate().filter(is_facet);
    let Some((line, _)) = facets.nth(i) else {
        return format!(
            "line {}, where the file ends: it may be cut off",
            text.lines().count()
        );
    };
    let is_cut = facets.next().is_none() && !text.contains("endsolid");
    let cut = if is_cut { ", the last: the file is cut off" } else { "" };
    format!("facet at line {}{cut}", line + 1)
}

/// `true` if a file has the length of a binary one, or begins as a text does and goes on with a
/// facet.
pub(super) fn is_likely(bytes: &[u8]) -> bool {
    let words = without_mark(bytes).split(u8::is_ascii_whitespace);
    let mut words = words.filter(|word| !word.is_empty());
    let is_text = words.next().is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
        && words.take(SOON).any(|word| word.eq_ignore_ascii_case(b"facet"));
    is_text || bytes.len() > HEADER + COUNT && Some(bytes.len()) == binary_length(bytes)
}

/// The facets of a text begin within so many words: a name has fewer.
const SOON: usize = 100;

fn is_binary(bytes: &[u8]) -> bool {
    binary_length(bytes).is_some_and(|length| bytes.len() == length || !begins_as_text(bytes))
}

fn begins_as_text(bytes: &[u8]) -> bool {
    let start = without_mark(bytes).trim_ascii_start();
    start.first_chunk::<5>().is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

/// The bytes behind the mark with which some editors begin texts in UTF-8.
fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// The length of a binary file with the count of triangles that `bytes` would give.
fn binary_length(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER..)?.first_chunk::<COUNT>()?;
    let triangles = u32::from_le_bytes(*count) as usize;
    Some(triangles.saturating_mul(TRIANGLE).saturating_add(HEADER + COUNT))
}

/// The solids of a text file, each with the name that stl_io asks for.
fn solids(text: &str) -> Vec<String> {
    let mut solids: Vec<String> = Vec::new();
    let mut is_open = false;
    for line in text.lines() {
        let line = line.trim();
        match line.split_whitespace().next() {
            None => {}
            Some("solid") if !is_open => {
                is_open = true;
                solids.push("solid of a file\n".to_owned());
            }
            word => {
                is_open = is_open && word != Some("endsolid");
                match solids.last_mut() {
                    Some(solid) => {
                        solid.push_str(line);
                        solid.push('\n');
                    }
                    // What does not begin as a solid is for stl_io to refuse.
                    None => solids.push(format!("{line}\n")),
                }
            }
        }
    }
    solids
}

/// Appends the vertices of a file; `place` says where its `i`-th triangle is, all solids counted.
fn append(
    file: &[u8],
    vertices: &mut Vec<Vector<f64, 3>>,
    place: impl Fn(usize) -> String,
) -> Result<(), ReadProblem> {
    let wrong = |i: usize, error: std::io::Error| {
        Format::Stl.malformed(format_args!("{}: {error}", place(i)))
    };
    let known = vertices.len() / 3;
    let mut file = Cursor::new(file);
    let triangles =
        stl_io::create_stl_reader(&mut file).map_err(|error| wrong(known, error))?;
    for (i, triangle) in triangles.enumerate() {
        let triangle = triangle.map_err(|error| wrong(known + i, error))?;
        vertices.extend(triangle.vertices.map(|vertex| Vector(vertex.0.map(f64::from))));
    }
    Ok(())
}
