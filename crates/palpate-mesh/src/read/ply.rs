// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! PLY, with ply-rs-bw.

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
    of_polygons(vertices, &sizes, &corners, Format::Ply)
}

/// An error of the parser with the line of a text, or the byte of a binary file at which it
/// stopped.
fn malformed(error: &ParseError, bytes: &[u8], reader: &Reader<&[u8]>) -> ReadProblem {
    let byte = bytes.len() - reader.get_ref().len();
    let message = error.to_string().replace("\n\t", " ");
    let numbered = message.strip_prefix("Line ").and_then(|rest| rest.split_once(": "));
    let is_binary = bytes.windows(13).take(1000).any(|window| window == b"format binary");
    let (place, problem) = match numbered {
        Some((_, problem)) if is_binary => (format!("byte {byte}"), problem),
        Some((line, problem)) => (format!("line {line}"), problem),
        None => (format!("byte {byte}"), message.as_str()),
    };
    let is_end = error.kind() == std::io::ErrorKind::UnexpectedEof
        || byte == bytes.len() && !bytes.ends_with(b"\n");
    let cut = if is_end { "; the file ends there: it is cut off" } else { "" };
    Format::Ply.malformed(format_args!("{place}: {problem}{cut}"))
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
