// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! MetaImage: lines of a key and a value, the last of which tells where the samples are.
//! Format: <https://itk.org/Wiki/ITK/MetaIO/Documentation>.

use std::collections::HashMap;
use std::path::Path;

use palpate_field::Vector;

use super::{
    Kind, LEFT_POSTERIOR, LONGEST_HEAD, Packing, Stored, Volume, VolumeProblem, beside, list,
};

const FORMAT: &str = "MetaImage";

/// Lengths are in millimetres.
const UNIT: f64 = 1e-3;

fn wrong(problem: impl Into<String>) -> VolumeProblem {
    VolumeProblem::Malformed { format: FORMAT, problem: problem.into() }
}

/// The fields of a head.
struct Head<'a> {
    fields: HashMap<&'a str, &'a str>,
    /// The file of the samples; `None` if they follow.
    samples_file: Option<&'a str>,
    /// Where samples begin that are in the same file.
    samples: usize,
}

/// The file of the samples that a head names, if it is another.
pub(super) fn samples_file(bytes: &[u8]) -> Option<String> {
    head(bytes).ok()?.samples_file.map(str::to_owned)
}

fn head(bytes: &[u8]) -> Result<Head<'_>, VolumeProblem> {
    let mut fields = HashMap::new();
    let mut place = 0;
    let mut file = None;
    for line in bytes[..bytes.len().min(LONGEST_HEAD)].split_inclusive(|byte| *byte == b'\n') {
        place += line.len();
        let Ok(line) = std::str::from_utf8(line) else { break };
        let Some((key, value)) = line.split_once('=') else { break };
        let (key, value) = (key.trim(), value.trim());
        if key == "ElementDataFile" {
            file = Some(value);
            break;
        }
        fields.insert(key, value);
    }
    let file = file.ok_or_else(|| wrong("its head lacks `ElementDataFile`"))?;
    let samples_file = Some(file).filter(|file| !file.eq_ignore_ascii_case("LOCAL"));
    Ok(Head { fields, samples_file, samples: place })
}

pub(super) fn read(bytes: &[u8], folder: &Path) -> Result<Volume, VolumeProblem> {
    let head = head(bytes)?;
    let field = |key: &str| head.fields.get(key).copied();
    let needed =
        |key: &'static str| field(key).ok_or_else(|| wrong(format!("its head lacks `{key}`")));
    let no = |key: &str, value: &str| wrong(format!("{key} {value:?} is not read"));
    if needed("NDims")? != "3" {
        return Err(no("NDims", needed("NDims")?));
    }
    let counts: [usize; 3] = list(needed("DimSize")?)
        .ok_or_else(|| no("DimSize", needed("DimSize").unwrap_or_default()))?;
    let kind = match needed("ElementType")? {
        "MET_CHAR" => Kind::I8,
        "MET_UCHAR" => Kind::U8,
        "MET_SHORT" => Kind::I16,
        "MET_USHORT" => Kind::U16,
        "MET_INT" => Kind::I32,
        "MET_UINT" => Kind::U32,
        "MET_FLOAT" => Kind::F32,
        "MET_DOUBLE" => Kind::F64,
        other => return Err(no("ElementType", other)),
    };
    if let Some(channels) = field("ElementNumberOfChannels").filter(|channels| *channels != "1")
    {
        return Err(no("ElementNumberOfChannels", channels));
    }
    if let Some(size) = field("HeaderSize").filter(|size| *size != "0") {
        return Err(wrong(format!(
            "HeaderSize {size} is not read; write the samples by themselves"
        )));
    }
    if field("BinaryData").is_some_and(|value| value.eq_ignore_ascii_case("false")) {
        return Err(wrong("its samples are text; write them with BinaryData = True"));
    }
    let is_true =
        |key: &str| field(key).is_some_and(|value| value.eq_ignore_ascii_case("true"));
    let is_big = is_true("BinaryDataByteOrderMSB") || is_true("ElementByteOrderMSB");
    let packing = if is_true("CompressedData") { Packing::Zlib } else { Packing::Raw };
    let spacing = match field("ElementSpacing").or_else(|| field("ElementSize")) {
        None => [1.0; 3],
        Some(text) => list::<f64, 3>(text).ok_or_else(|| no("ElementSpacing", text))?,
    };
    // Each row is the direction of an axis.
    let directions = match field("TransformMatrix").or_else(|| field("Rotation")) {
        None => [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        Some(text) => list::<f64, 9>(text).ok_or_else(|| no("TransformMatrix", text))?,
    };
    let origin = match field("Offset").or_else(|| field("Position")).or_else(|| field("Origin"))
    {
        None => [0.0; 3],
        Some(text) => list::<f64, 3>(text).ok_or_else(|| no("Offset", text))?,
    };
    let count = counts.iter().try_fold(1_usize, |all, count| all.checked_mul(*count));
    let count = count.ok_or_else(|| wrong("it has too many samples"))?;
    let stored = Stored { format: FORMAT, kind, is_big, packing, count };
    let samples = match head.samples_file {
        Some(file) => stored.read(&beside(folder, file)?)?,
        None => stored.read(&bytes[head.samples..])?,
    };
    // Whoever tells the orientation of a patient has coordinates to the left, the back and the top.
    let is_oriented =
        |text: &str| text.len() == 3 && text.chars().all(|c| "RLAPIS".contains(c));
    let is_patient = field("AnatomicalOrientation").is_some_and(is_oriented);
    let signs = if is_patient { LEFT_POSTERIOR } else { [1.0; 3] };
    let steps = std::array::from_fn(|axis| {
        let step = spacing[axis] * UNIT;
        Vector(std::array::from_fn(|i| signs[i] * directions[3 * axis + i])) * step
    });
    let origin = Vector(std::array::from_fn(|i| signs[i] * origin[i])) * UNIT;
    Volume::new(counts, origin, steps, samples)
}
