// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! MetaImage: lines of a key and a value, the last of which tells where the samples are.
//! Format: <https://itk.org/Wiki/ITK/MetaIO/Documentation>. Where the format is silent, this reader does as ITK does: fields of
//! several names, words for true and false, a frame that is always to the left, the back and the top of a patient.

use std::collections::HashMap;
use std::path::Path;

use palpate_field::Vector;

use super::head::{LEFT_POSTERIOR, LONGEST_HEAD, MILLIMETRE, UNITS, list, spaced, unit};
use super::{Kind, Packing, Stored, Volume, VolumeProblem, beside};

const FORMAT: &str = "MetaImage";

/// The names of the same field.
type Names = &'static [&'static str];

const ORIGIN: Names = &["Offset", "Position", "Origin", "ImagePosition"];
const DIRECTIONS: Names = &["TransformMatrix", "Rotation", "Orientation"];
const BIG_ENDIAN: Names = &["BinaryDataByteOrderMSB", "ElementByteOrderMSB"];

/// All fields that are read. `AnatomicalOrientation` is not one: ITK never reads it for a place.
const FIELDS: Names = &[
    "NDims",
    "DimSize",
    "ElementType",
    "ElementNumberOfChannels",
    "HeaderSize",
    "BinaryData",
    "CompressedData",
    "DistanceUnits",
    "ElementSpacing",
    "ElementSize",
    "ElementToIntensityFunctionSlope",
    "ElementToIntensityFunctionOffset",
    "ElementDataFile",
    ORIGIN[0],
    ORIGIN[1],
    ORIGIN[2],
    ORIGIN[3],
    DIRECTIONS[0],
    DIRECTIONS[1],
    DIRECTIONS[2],
    BIG_ENDIAN[0],
    BIG_ENDIAN[1],
];

fn wrong(problem: impl Into<String>) -> VolumeProblem {
    VolumeProblem::Malformed { format: FORMAT, problem: problem.into() }
}

/// The fields of a head that are read.
struct Head {
    fields: HashMap<&'static str, String>,
    /// The value of `ElementDataFile`.
    data_file: String,
    /// Where samples begin that are in the same file.
    samples: usize,
}

/// The file of the samples that a head names, if it is another.
pub(super) fn samples_file(bytes: &[u8]) -> Option<String> {
    head(bytes).ok()?.samples_file().ok()?.map(str::to_owned)
}

fn head(bytes: &[u8]) -> Result<Head, VolumeProblem> {
    let mut fields = HashMap::new();
    let mut samples = 0;
    for line in bytes[..bytes.len().min(LONGEST_HEAD)].split_inclusive(|byte| *byte == b'\n') {
        samples += line.len();
        let line = String::from_utf8_lossy(line);
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let Some((key, value)) = line.split_once(['=', ':']) else {
            let start: String = line.chars().take(40).collect();
            return Err(wrong(format!("the line {start:?} of its head is no `Key = value`")));
        };
        let (key, value) = (key.trim(), value.trim().to_owned());
        let Some(known) = FIELDS.iter().copied().find(|known| known.eq_ignore_ascii_case(key))
        else {
            continue;
        };
        if known != key {
            return Err(wrong(format!("its head has `{key}`: write `{known}`")));
        }
        if known == "ElementDataFile" {
            return Ok(Head { fields, data_file: value, samples });
        }
        if fields.insert(known, value).is_some() {
            return Err(wrong(format!("its head has `{key}` twice")));
        }
    }
    Err(wrong("its head lacks `ElementDataFile`"))
}

impl Head {
    fn field(&self, key: &'static str) -> Option<&str> {
        self.fields.get(key).map(String::as_str)
    }

    fn needed(&self, key: &'static str) -> Result<&str, VolumeProblem> {
        self.field(key).ok_or_else(|| wrong(format!("its head lacks `{key}`")))
    }

    /// The finite numbers of a field, `N` of them.
    fn numbers<const N: usize>(
        &self,
        key: &'static str,
    ) -> Result<Option<[f64; N]>, VolumeProblem> {
        let Some(text) = self.field(key) else { return Ok(None) };
        let numbers = spaced(text).ok_or_else(|| {
            wrong(format!(
                "{key} {text:?} is not read: write {N} numbers with spaces between them"
            ))
        })?;
        Ok(Some(numbers))
    }

    /// Whether a field is true. Its first letter tells, as ITK has it; words that begin with neither are refused.
    fn flag(&self, key: &'static str) -> Result<Option<bool>, VolumeProblem> {
        let Some(text) = self.field(key) else { return Ok(None) };
        match text.chars().next() {
            Some('T' | 't' | '1') => Ok(Some(true)),
            Some('F' | 'f' | '0') => Ok(Some(false)),
            _ => Err(wrong(format!("{key} {text:?} is neither True nor False"))),
        }
    }

    /// The value of a field that has several names, which must not contradict each other.
    fn one_of<T: PartialEq>(
        &self,
        names: Names,
        value: impl Fn(&Self, &'static str) -> Result<Option<T>, VolumeProblem>,
    ) -> Result<Option<T>, VolumeProblem> {
        let mut found: Option<(&str, T)> = None;
        for name in names.iter().copied() {
            let Some(value) = value(self, name)? else { continue };
            match &found {
                Some((first, other)) if *other != value => {
                    let problem = format!(
                        "`{first}` and `{name}` are the same field, and differ: keep one"
                    );
                    return Err(wrong(problem));
                }
                Some(_) => {}
                None => found = Some((name, value)),
            }
        }
        Ok(found.map(|(_, value)| value))
    }

    /// The file of the samples, if it is another one.
    fn samples_file(&self) -> Result<Option<&str>, VolumeProblem> {
        let file = self.data_file.as_str();
        let first = file.split_whitespace().next().unwrap_or_default();
        if first.eq_ignore_ascii_case("LIST") || file.contains('%') {
            return Err(wrong(format!(
                "ElementDataFile {file:?} means several files, which are not read: write the samples into one file"
            )));
        }
        Ok(Some(file).filter(|file| !file.eq_ignore_ascii_case("LOCAL")))
    }

    fn stored(&self, counts: [usize; 3]) -> Result<Stored, VolumeProblem> {
        let kind = match self.needed("ElementType")? {
            "MET_CHAR" | "MET_ASCII_CHAR" => Kind::I8,
            "MET_UCHAR" => Kind::U8,
            "MET_SHORT" => Kind::I16,
            "MET_USHORT" => Kind::U16,
            // The long of MetaImage has four bytes.
            "MET_INT" | "MET_LONG" => Kind::I32,
            "MET_UINT" | "MET_ULONG" => Kind::U32,
            "MET_LONG_LONG" => Kind::I64,
            "MET_ULONG_LONG" => Kind::U64,
            "MET_FLOAT" => Kind::F32,
            "MET_DOUBLE" => Kind::F64,
            other => {
                return Err(wrong(format!(
                    "ElementType {other:?} is not read: write a number a sample, as MET_FLOAT"
                )));
            }
        };
        if let Some(channels) =
            self.field("ElementNumberOfChannels").filter(|channels| *channels != "1")
        {
            return Err(wrong(format!(
                "ElementNumberOfChannels {channels:?} is not read: write one of the channels alone"
            )));
        }
        if self.flag("BinaryData")? == Some(false) {
            return Err(wrong("its samples are text; write them with BinaryData = True"));
        }
        for (key, neutral) in [
            ("ElementToIntensityFunctionSlope", 1.0),
            ("ElementToIntensityFunctionOffset", 0.0),
        ] {
            if let Some([value]) = self.numbers(key)?.filter(|[value]| *value != neutral) {
                return Err(wrong(format!(
                    "{key} {value} is not read, nor does ITK: write the intensities themselves"
                )));
            }
        }
        let is_big = self.one_of(BIG_ENDIAN, Self::flag)?.unwrap_or(false);
        let is_packed = self.flag("CompressedData")?.unwrap_or(false);
        let packing = if is_packed { Packing::Zlib } else { Packing::Raw };
        let count = counts.iter().try_fold(1_usize, |all, count| all.checked_mul(*count));
        let count = count.ok_or_else(|| wrong("it has too many samples"))?;
        Ok(Stored { format: FORMAT, kind, is_big, packing, count })
    }

    fn samples(
        &self,
        stored: Stored,
        bytes: &[u8],
        folder: &Path,
    ) -> Result<Vec<f32>, VolumeProblem> {
        let file = self.samples_file()?;
        let other = file.map(|file| beside(folder, file)).transpose()?;
        let all = other.as_deref().unwrap_or_else(|| &bytes[self.samples..]);
        let size = self.field("HeaderSize").unwrap_or("0");
        let is_raw = stored.packing == Packing::Raw;
        let skipped = match size.parse::<i64>() {
            Ok(0) => 0,
            // The samples are the last bytes.
            Ok(-1) if is_raw => all.len().saturating_sub(stored.length()?),
            Ok(skipped) if is_raw && skipped > 0 && file.is_some() => {
                usize::try_from(skipped).unwrap_or(usize::MAX).min(all.len())
            }
            _ => {
                return Err(wrong(format!(
                    "HeaderSize {size} is not read; write the samples by themselves"
                )));
            }
        };
        let found = &all[skipped..];
        let is_gzip = !is_raw && found.starts_with(&[0x1f, 0x8b]);
        let packing = if is_gzip { Packing::Gzip } else { stored.packing };
        Stored { packing, ..stored }.read(found)
    }

    /// The length [m] in which places are said.
    fn unit(&self) -> Result<f64, VolumeProblem> {
        match self.field("DistanceUnits") {
            None | Some("?" | "") => Ok(MILLIMETRE),
            Some(name) => unit(name).ok_or_else(|| {
                wrong(format!("DistanceUnits {name:?} is not read: write {UNITS}"))
            }),
        }
    }
}

pub(super) fn read(bytes: &[u8], folder: &Path) -> Result<Volume, VolumeProblem> {
    let head = head(bytes)?;
    let dimension = head.needed("NDims")?;
    if dimension != "3" {
        return Err(wrong(format!(
            "NDims {dimension:?} is not read: write one volume of 3 dimensions"
        )));
    }
    let counts = head.needed("DimSize")?;
    let counts: [usize; 3] = list(counts).ok_or_else(|| {
        wrong(format!("DimSize {counts:?} is not read: write the 3 counts of samples"))
    })?;
    let spacing = match head.numbers("ElementSpacing")? {
        Some(spacing) => spacing,
        None => head.numbers("ElementSize")?.unwrap_or([1.0; 3]),
    };
    // Each row is the direction of an axis.
    let directions = head
        .one_of(DIRECTIONS, Head::numbers::<9>)?
        .unwrap_or([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    let origin = head.one_of(ORIGIN, Head::numbers::<3>)?.unwrap_or([0.0; 3]);
    let unit = head.unit()?;
    let samples = head.samples(head.stored(counts)?, bytes, folder)?;
    let steps = std::array::from_fn(|axis| {
        let step = spacing[axis] * unit;
        Vector(std::array::from_fn(|i| LEFT_POSTERIOR[i] * directions[3 * axis + i])) * step
    });
    let origin = Vector(std::array::from_fn(|i| LEFT_POSTERIOR[i] * origin[i])) * unit;
    Volume::new(counts, origin, steps, samples)
}
