// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! NRRD: a text head, a blank line, samples; or the head alone, which names a file of samples.
//! Format: <https://teem.sourceforge.net/nrrd/format.html>.

use std::collections::HashMap;
use std::path::Path;

use palpate_field::Vector;

use super::numbers::{Kind, Packing, Stored, list};
use super::{Volume, VolumeProblem, beside};

const FORMAT: &str = "NRRD";

/// The longest head [bytes].
const LONGEST: usize = 1 << 16;

fn wrong(problem: impl Into<String>) -> VolumeProblem {
    VolumeProblem::Malformed { format: FORMAT, problem: problem.into() }
}

pub(super) fn read(bytes: &[u8], folder: &Path) -> Result<Volume, VolumeProblem> {
    if !bytes.starts_with(b"NRRD") {
        return Err(wrong("it does not begin with NRRD"));
    }
    let start = &bytes[..bytes.len().min(LONGEST)];
    let blank = start.windows(2).position(|pair| pair == b"\n\n").map(|at| (at, 2));
    let blank = blank
        .or_else(|| start.windows(4).position(|four| four == b"\r\n\r\n").map(|at| (at, 4)));
    let (end, gap) = blank.unwrap_or((start.len(), 0));
    let head = std::str::from_utf8(&bytes[..end]).map_err(|_| wrong("its head is no text"))?;
    let mut fields = HashMap::new();
    for line in head.lines().skip(1).filter(|line| !line.starts_with('#')) {
        if let Some((key, value)) = line.split_once(": ") {
            fields.insert(key.trim().to_ascii_lowercase(), value.trim());
        }
    }
    let field = |key: &str| fields.get(key).copied();
    let needed =
        |key: &'static str| field(key).ok_or_else(|| wrong(format!("its head lacks `{key}`")));
    let no = |key: &str, value: &str| wrong(format!("{key} {value:?} is not read"));
    if needed("dimension")? != "3" {
        return Err(no("dimension", needed("dimension")?));
    }
    let counts: [usize; 3] = list(needed("sizes")?)
        .ok_or_else(|| no("sizes", needed("sizes").unwrap_or_default()))?;
    let kind = match needed("type")? {
        "signed char" | "int8" | "int8_t" => Kind::I8,
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => Kind::U8,
        "short" | "short int" | "signed short" | "int16" | "int16_t" => Kind::I16,
        "ushort" | "unsigned short" | "uint16" | "uint16_t" => Kind::U16,
        "int" | "signed int" | "int32" | "int32_t" => Kind::I32,
        "uint" | "unsigned int" | "uint32" | "uint32_t" => Kind::U32,
        "float" => Kind::F32,
        "double" => Kind::F64,
        other => return Err(no("type", other)),
    };
    let packing = match needed("encoding")? {
        "raw" => Packing::Raw,
        "gzip" | "gz" => Packing::Gzip,
        other => return Err(no("encoding", other)),
    };
    let is_big = match field("endian") {
        Some("big") => true,
        Some("little") => false,
        None if kind.bytes() == 1 => false,
        other => return Err(wrong(format!("endian {other:?} is neither little nor big"))),
    };
    // Lengths are in millimetres unless the head says otherwise.
    let unit = match field("space units").map(|units| units.replace(['"', ' '], "")) {
        Some(units) if units.starts_with("mmm") || units == "mm" => 1e-3,
        Some(units) if units.starts_with('m') => 1.0,
        Some(units) if units.starts_with("um") || units.starts_with('µ') => 1e-6,
        Some(units) if units.starts_with("cm") => 1e-2,
        Some(units) => return Err(no("space units", &units)),
        None => 1e-3,
    };
    let steps: [[f64; 3]; 3] = match (field("space directions"), field("spacings")) {
        (Some(text), _) => vectors(text).ok_or_else(|| no("space directions", text))?,
        (None, Some(text)) => {
            let [x, y, z] = list(text).ok_or_else(|| no("spacings", text))?;
            [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]]
        }
        (None, None) => return Err(wrong("its head lacks `space directions` and `spacings`")),
    };
    let origin = match field("space origin") {
        None => [0.0; 3],
        Some(text) => {
            list(text.trim_matches(['(', ')'])).ok_or_else(|| no("space origin", text))?
        }
    };
    let count = counts.iter().try_fold(1_usize, |all, count| all.checked_mul(*count));
    let count = count.ok_or_else(|| wrong("it has too many samples"))?;
    let stored = Stored { format: FORMAT, kind, is_big, packing, count };
    let samples = match field("data file").or_else(|| field("datafile")) {
        Some(name) => stored.read(&beside(folder, name)?)?,
        None => stored.read(&bytes[end + gap..])?,
    };
    let metres = |v: [f64; 3]| Vector(v) * unit;
    Volume::new(counts, metres(origin), steps.map(metres), samples)
}

/// Three vectors in parentheses.
fn vectors(text: &str) -> Option<[[f64; 3]; 3]> {
    let each: Option<Vec<[f64; 3]>> = text
        .split(')')
        .map(|part| part.trim().trim_start_matches('('))
        .filter(|part| !part.is_empty())
        .map(list)
        .collect();
    each?.try_into().ok()
}
