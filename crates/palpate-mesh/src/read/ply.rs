// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! PLY, with ply-rs-bw.

use std::collections::HashSet;

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};

use palpate_field::{Point, Vector};

use super::ReadProblem;
use super::{Format, of_polygons};
use crate::mesh::TriangleMesh;

/// One row of a file: a vertex, a face, or something that does not matter.
struct Row {
    position: Point<3>,
    corners: Vec<u32>,
    /// A corner that is no index of a vertex.
    wrong: Option<i64>,
}

impl PropertyAccess for Row {
    fn new() -> Self {
        // What a file leaves out is refused later.
        Self { position: Vector([f64::NAN; 3]), corners: Vec::new(), wrong: None }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if let Some(axis) = ["x", "y", "z"].iter().position(|axis| *axis == name) {
            match number(&property) {
                Some(number) => self.position[axis] = number,
                None => return PropertyAccessResult::UnsupportedType,
            }
        } else if matches!(name, "vertex_indices" | "vertex_index") {
            let Some(indices) = integers(property) else {
                return PropertyAccessResult::UnsupportedType;
            };
            for index in indices {
                match u32::try_from(index) {
                    Ok(index) => self.corners.push(index),
                    Err(_) => self.wrong = Some(index),
                }
            }
        } else {
            return PropertyAccessResult::Ignored;
        }
        PropertyAccessResult::Set
    }
}

pub(super) fn read(bytes: &[u8]) -> Result<TriangleMesh, ReadProblem> {
    let parser = Parser::<Row>::new();
    let mut reader = Reader::new(bytes);
    let header = parser.read_header(&mut reader);
    let header = header.map_err(|error| malformed(&error, bytes, &reader))?;
    if let Some(problem) = doubled_property(bytes) {
        return Err(Format::Ply.malformed(problem));
    }
    for element in header.elements.values() {
        // Every row takes a byte at least, so that the file bounds what is read.
        if element.properties.is_empty() || element.count > bytes.len() {
            let (count, name) = (element.count, &element.name);
            let problem = format!("its {} bytes hold no {count} rows of {name:?}", bytes.len());
            return Err(Format::Ply.malformed(problem));
        }
    }
    let (mut vertices, mut sizes, mut corners) = (Vec::new(), Vec::new(), Vec::new());
    for element in header.elements.values() {
        let rows = parser.read_payload_for_element(&mut reader, element, &header);
        let rows = rows.map_err(|error| malformed(&error, bytes, &reader))?;
        match element.name.as_str() {
            "vertex" => vertices.extend(rows.iter().map(|row| row.position)),
            "face" => {
                for (face, row) in rows.into_iter().enumerate() {
                    if let Some(index) = row.wrong {
                        let problem = format!("face {face} names vertex {index}");
                        return Err(Format::Ply.malformed(problem));
                    }
                    sizes.push(row.corners.len() as u32);
                    corners.extend(row.corners);
                }
            }
            "tristrips" => {
                return Err(ReadProblem::Unsupported {
                    what: "strips of triangles",
                    advice: "export faces",
                });
            }
            _ => {}
        }
    }
    let rest = reader.get_ref().trim_ascii();
    if !rest.is_empty() {
        let read = &bytes[..bytes.len() - rest.len()];
        let place = if is_binary(bytes) {
            format!("byte {}", read.len())
        } else {
            format!("line {}", 1 + read.iter().filter(|byte| **byte == b'\n').count())
        };
        return Err(Format::Ply.malformed(format_args!(
            "{place}: {} bytes follow the last row that its header counts",
            rest.len()
        )));
    }
    of_polygons(vertices, &sizes, &corners, Format::Ply)
}

/// A complaint about an element that has two properties of one name, of which a reader would lose
/// one and misread all others.
fn doubled_property(bytes: &[u8]) -> Option<String> {
    let header = bytes.split(|byte| *byte == b'\n').map(|line| line.trim_ascii());
    let header = header.take_while(|line| *line != b"end_header");
    let mut names = HashSet::new();
    for (line, text) in (1..).zip(header) {
        let mut words = text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        match words.next() {
            Some(b"element") => names.clear(),
            Some(b"property") => {
                let name = words.next_back().unwrap_or_default();
                if !names.insert(name) {
                    let name = String::from_utf8_lossy(name);
                    return Some(format!("line {line}: a second property {name:?}"));
                }
            }
            _ => {}
        }
    }
    None
}

/// An error of the parser with the line of a text, or the byte of a binary file at which it
/// stopped.
fn malformed(error: &ParseError, bytes: &[u8], reader: &Reader<&[u8]>) -> ReadProblem {
    let byte = bytes.len() - reader.get_ref().len();
    let message = error.to_string().replace("\n\t", " ");
    let numbered = message.strip_prefix("Line ").and_then(|rest| rest.split_once(": "));
    let (place, problem) = match numbered {
        Some((_, problem)) if is_binary(bytes) => (format!("byte {byte}"), problem),
        Some((line, problem)) => (format!("line {line}"), problem),
        None => (format!("byte {byte}"), message.as_str()),
    };
    // The parser tells its own state in the words of Rust.
    let problem = if problem.contains("ParseError") || problem.contains("fill whole buffer") {
        "what stands there is no line or row of PLY, or only a part of one"
    } else {
        problem
    };
    let is_end = error.kind() == std::io::ErrorKind::UnexpectedEof
        || byte == bytes.len() && !bytes.ends_with(b"\n");
    let cut = if is_end { "; the file ends there: it is cut off" } else { "" };
    Format::Ply.malformed(format_args!("{place}: {problem}{cut}"))
}

/// Whether the header says that rows are binary.
fn is_binary(bytes: &[u8]) -> bool {
    bytes.windows(13).take(1000).any(|window| window == b"format binary")
}

fn number(property: &Property) -> Option<f64> {
    match *property {
        Property::Char(x) => Some(f64::from(x)),
        Property::UChar(x) => Some(f64::from(x)),
        Property::Short(x) => Some(f64::from(x)),
        Property::UShort(x) => Some(f64::from(x)),
        Property::Int(x) => Some(f64::from(x)),
        Property::UInt(x) => Some(f64::from(x)),
        Property::Float(x) => Some(f64::from(x)),
        Property::Double(x) => Some(x),
        _ => None,
    }
}

fn integers(property: Property) -> Option<Vec<i64>> {
    fn wide<T: Into<i64>>(list: Vec<T>) -> Option<Vec<i64>> {
        Some(list.into_iter().map(T::into).collect())
    }
    match property {
        Property::ListChar(list) => wide(list),
        Property::ListUChar(list) => wide(list),
        Property::ListShort(list) => wide(list),
        Property::ListUShort(list) => wide(list),
        Property::ListInt(list) => wide(list),
        Property::ListUInt(list) => wide(list),
        _ => None,
    }
}
