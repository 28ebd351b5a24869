// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! NRRD: a text head, a blank line, samples; or the head alone, which names a file of samples.
//! Format: <https://teem.sourceforge.net/nrrd/format.html>.

use std::collections::HashMap;
use std::path::Path;

use palpate_field::Vector;

use super::{
    Kind, LEFT_POSTERIOR, LONGEST_HEAD, Packing, Stored, Volume, VolumeProblem, beside, list,
};

const FORMAT: &str = "NRRD";

fn wrong(problem: impl Into<String>) -> VolumeProblem {
    VolumeProblem::Malformed { format: FORMAT, problem: problem.into() }
}

/// The fields of a head.
struct Head<'a> {
    fields: HashMap<String, &'a str>,
    /// Where samples begin that are in the same file.
    samples: usize,
}

impl Head<'_> {
    fn field(&self, key: &str) -> Option<&str> {
        self.fields.get(key).copied()
    }

    /// The file of the samples, if it is another.
    fn samples_file(&self) -> Option<&str> {
        self.field("data file").or_else(|| self.field("datafile"))
    }
}

/// The file of the samples that a head names, if it is another.
pub(super) fn samples_file(bytes: &[u8]) -> Option<String> {
    head(bytes).ok()?.samples_file().map(str::to_owned)
}

fn head(bytes: &[u8]) -> Result<Head<'_>, VolumeProblem> {
    if !bytes.starts_with(b"NRRD") {
        return Err(wrong("it does not begin with NRRD"));
    }
    let start = &bytes[..bytes.len().min(LONGEST_HEAD)];
    let first = |blank: &[u8]| start.windows(blank.len()).position(|part| part == blank);
    // The earlier one: samples may look like the other.
    let blank = [b"\n\n".as_slice(), b"\r\n\r\n"]
        .into_iter()
        .filter_map(|blank| Some((first(blank)?, blank.len())))
        .min();
    let (end, gap) = blank.unwrap_or((start.len(), 0));
    let head = std::str::from_utf8(&bytes[..end]).map_err(|_| wrong("its head is no text"))?;
    let mut fields = HashMap::new();
    for line in head.lines().skip(1).filter(|line| !line.starts_with('#')) {
        if let Some((key, value)) = line.split_once(": ") {
            let key = key.trim().to_ascii_lowercase();
            if fields.insert(key.clone(), value.trim()).is_some() {
                return Err(wrong(format!("its head has `{key}` twice")));
            }
        }
    }
    Ok(Head { fields, samples: end + gap })
}

pub(super) fn read(bytes: &[u8], folder: &Path) -> Result<Volume, VolumeProblem> {
    let head = head(bytes)?;
    let field = |key: &str| head.field(key);
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
    for key in ["line skip", "lineskip", "byte skip", "byteskip"] {
        if let Some(skipped) = field(key).filter(|skipped| *skipped != "0") {
            let problem =
                format!("{key} {skipped:?} is not read; write the samples by themselves");
            return Err(wrong(problem));
        }
    }
    let unit = match field("space units").or_else(|| field("units")) {
        Some(units) => unit(units).ok_or_else(|| no("space units", units))?,
        // Lengths are in millimetres unless the head says otherwise.
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
    let origin = match (field("space origin"), field("axis mins").or_else(|| field("axismins")))
    {
        (Some(text), _) => {
            list(text.trim_matches(['(', ')'])).ok_or_else(|| no("space origin", text))?
        }
        (None, Some(text)) => {
            let least = list(text).ok_or_else(|| no("axis mins", text))?;
            first_nodes(least, &steps, field("centers").or_else(|| field("centerings")))
        }
        (None, None) => [0.0; 3],
    };
    let count = counts.iter().try_fold(1_usize, |all, count| all.checked_mul(*count));
    let count = count.ok_or_else(|| wrong("it has too many samples"))?;
    let stored = Stored { format: FORMAT, kind, is_big, packing, count };
    let samples = match head.samples_file() {
        Some(name) => stored.read(&beside(folder, name)?)?,
        None => stored.read(&bytes[head.samples..])?,
    };
    if let Some(kinds) = field("kinds")
        && kinds.split_whitespace().any(|kind| !["domain", "space", "???"].contains(&kind))
    {
        return Err(wrong(format!(
            "kinds {kinds:?} are not read: all three axes are of space"
        )));
    }
    let signs = match field("space").map(str::to_ascii_lowercase).as_deref() {
        Some("left-posterior-superior" | "lps") => LEFT_POSTERIOR,
        Some("left-anterior-superior" | "las") => [-1.0, 1.0, 1.0],
        None
        | Some(
            "right-anterior-superior" | "ras" | "3d-right-handed" | "3drh" | "scanner-xyz",
        ) => [1.0; 3],
        Some(_) => return Err(no("space", field("space").unwrap_or_default())),
    };
    let metres = |v: [f64; 3]| Vector(std::array::from_fn(|i| signs[i] * v[i])) * unit;
    Volume::new(counts, metres(origin), steps.map(metres), samples)
}

/// Where the first node is, from the least coordinates along the axes: half a step from them, where samples are of
/// cells, as they are unless the head says that they are of nodes.
fn first_nodes(least: [f64; 3], steps: &[[f64; 3]; 3], centres: Option<&str>) -> [f64; 3] {
    let mut of_axis = centres.unwrap_or_default().split_whitespace();
    std::array::from_fn(|i| {
        let share = if of_axis.next() == Some("node") { 0.0 } else { 0.5 };
        least[i] + share * steps[i][i]
    })
}

/// The length [m] that the units of all axes, each in quotes, say alike.
fn unit(units: &str) -> Option<f64> {
    let mut words = units.split(['"', ' ']).filter(|word| !word.is_empty());
    let first = words.next()?;
    let is_alike = words.all(|word| word == first);
    let metres = match first {
        "m" | "meter" | "metre" | "meters" | "metres" => 1.0,
        "cm" | "centimeter" | "centimetre" | "centimeters" | "centimetres" => 1e-2,
        "mm" | "millimeter" | "millimetre" | "millimeters" | "millimetres" => 1e-3,
        // The micro sign and the Greek letter.
        "um" | "\u{b5}m" | "\u{3bc}m" | "micron" | "microns" | "micrometer" | "micrometre" => {
            1e-6
        }
        _ => return None,
    };
    is_alike.then_some(metres)
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
