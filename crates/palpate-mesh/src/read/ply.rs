// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! PLY, with ply-rs-bw.
//!
//! What is wrong is told in the words of the header, not in those of that crate.

use std::borrow::Cow;
use std::collections::HashSet;

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType,
    ScalarType,
};

use palpate_field::{Point, Vector};

use super::text::{check_encoding, lines, quoted, without_mark};
use super::{Format, ReadProblem, of_polygons};
use crate::mesh::TriangleMesh;

const AXES: [&str; 3] = ["x", "y", "z"];

/// What the corners of a face may be called.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

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
        if let Some(axis) = AXES.iter().position(|axis| *axis == name) {
            match number(&property) {
                Some(number) => self.position[axis] = number,
                None => return PropertyAccessResult::UnsupportedType,
            }
        } else if CORNERS.contains(&name) {
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
    check_encoding(bytes)?;
    let bytes = &*with_line_feeds(without_mark(bytes));
    let parser = Parser::<Row>::new();
    let mut reader = Reader::new(bytes);
    let header = parser.read_header(&mut reader);
    let header = header.map_err(|error| {
        let line = "a line of its head: `ply`, `format`, `element`, `property`, `end_header`";
        Stop { bytes, reader: &reader, is_binary: false }.before(line, &error)
    })?;
    if let Some(problem) = doubled_property(bytes) {
        return Err(Format::Ply.malformed(problem));
    }
    check_properties(&header)?;
    let is_binary = is_binary(bytes);
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
        let rows = rows.map_err(|error| {
            Stop { bytes, reader: &reader, is_binary }.before(&row_of(element), &error)
        })?;
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
    let rest = reader.get_ref().trim_ascii_start();
    if !rest.is_empty() {
        let read = &bytes[..bytes.len() - rest.len()];
        let place = if is_binary {
            format!("byte {}", read.len())
        } else {
            format!("line {}", 1 + lines(&String::from_utf8_lossy(read)).count())
        };
        return Err(Format::Ply.malformed(format_args!(
            "{place}: {} bytes follow the last row that its header counts",
            rest.trim_ascii_end().len()
        )));
    }
    of_polygons(vertices, &sizes, &corners, Format::Ply)
}

/// The bytes with LF in place of each CR, if the lines of the head end in CR alone; what is
/// binary stays.
fn with_line_feeds(bytes: &[u8]) -> Cow<'_, [u8]> {
    const END: &[u8] = b"end_header\r";
    let head = bytes.windows(END.len()).position(|part| part == END);
    let Some(head) = head.map(|start| start + END.len()) else { return bytes.into() };
    if bytes[..head].contains(&b'\n') || bytes.get(head) == Some(&b'\n') {
        return bytes.into();
    }
    let mut bytes = bytes.to_vec();
    let text = if is_binary(&bytes) { head } else { bytes.len() };
    for byte in bytes[..text].iter_mut().filter(|byte| **byte == b'\r') {
        *byte = b'\n';
    }
    bytes.into()
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

/// Refuses vertices that have not all coordinates, and faces whose corners are no whole numbers.
fn check_properties(header: &Header) -> Result<(), ReadProblem> {
    let element = |name: &str| header.elements.values().find(|element| element.name == name);
    if let Some(vertex) = element("vertex") {
        for axis in AXES {
            let wrong = match vertex.properties.get(axis).map(|axis| &axis.data_type) {
                None => format!("its vertices have no property {axis:?}"),
                Some(PropertyType::List(..)) => {
                    format!("the property {axis:?} of its vertices is a list, and no number")
                }
                Some(PropertyType::Scalar(_)) => continue,
            };
            return Err(Format::Ply.malformed(wrong));
        }
    }
    if let Some(face) = element("face") {
        let corners = CORNERS.iter().find_map(|name| face.properties.get(*name));
        let wrong = match corners.map(|corners| (&corners.name, &corners.data_type)) {
            None => "its faces have no property \"vertex_indices\"".to_owned(),
            Some((name, PropertyType::Scalar(_))) => {
                format!("the property {name:?} of its faces is a number, and no list")
            }
            Some((name, PropertyType::List(_, ScalarType::Float | ScalarType::Double))) => {
                format!(
                    "the property {name:?} of its faces is a list of floating-point numbers, \
                     and the numbers of vertices are whole, as `int` or `uint`"
                )
            }
            Some((_, PropertyType::List(..))) => return Ok(()),
        };
        return Err(Format::Ply.malformed(wrong));
    }
    Ok(())
}

/// What a row of an element is, as the header says it.
fn row_of(element: &ElementDef) -> String {
    let word = |kind: &ScalarType| format!("{kind:?}").to_ascii_lowercase();
    let property = |(name, kind): (&String, &PropertyType)| match kind {
        PropertyType::Scalar(kind) => format!("{} {name}", word(kind)),
        PropertyType::List(count, kind) => {
            format!("list {} {} {name}", word(count), word(kind))
        }
    };
    let properties = element.properties.values().map(|p| property((&p.name, &p.data_type)));
    let properties: Vec<_> = properties.collect();
    format!("a row of {:?}: {}", element.name, properties.join(", "))
}

/// Where the parser stopped.
struct Stop<'a> {
    bytes: &'a [u8],
    reader: &'a Reader<&'a [u8]>,
    is_binary: bool,
}

impl Stop<'_> {
    /// The complaint that `expected` should stand there: at a line of a text, or at a byte of a
    /// binary file.
    fn before(&self, expected: &str, error: &ParseError) -> ReadProblem {
        let byte = self.bytes.len() - self.reader.get_ref().len();
        let is_end = error.kind() == std::io::ErrorKind::UnexpectedEof
            || byte == self.bytes.len() && !self.bytes.ends_with(b"\n");
        let cut = if is_end { "; the file ends there: it is cut off" } else { "" };
        let read = String::from_utf8_lossy(&self.bytes[..byte]);
        match error.line().filter(|_| !self.is_binary) {
            Some(line) => {
                let found =
                    quoted(lines(&read).nth(line.saturating_sub(1)).unwrap_or_default());
                Format::Ply
                    .malformed(format_args!("line {line}: {found} is not {expected}{cut}"))
            }
            None => Format::Ply.malformed(format_args!(
                "byte {byte}: what stands there is not {expected}{cut}"
            )),
        }
    }
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
