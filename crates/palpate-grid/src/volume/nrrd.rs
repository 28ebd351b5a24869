// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! NRRD: a text head, a blank line, samples; or the head alone, which names a file of samples.
//! Format: <https://teem.sourceforge.net/nrrd/format.html>. Where the format is silent, this reader does as ITK does.

use std::collections::HashMap;
use std::path::Path;

use palpate_field::Vector;

use super::head::{LEFT_POSTERIOR, LONGEST_HEAD, MILLIMETRE, UNITS, list, unit};
use super::{Kind, Packing, Stored, Volume, VolumeProblem, beside};

const FORMAT: &str = "NRRD";

/// The fields of the format that are written in one way.
const FIELDS: [&str; 21] = [
    "content",
    "number",
    "type",
    "dimension",
    "space",
    "space dimension",
    "sizes",
    "spacings",
    "thicknesses",
    "space directions",
    "kinds",
    "labels",
    "units",
    "min",
    "max",
    "endian",
    "encoding",
    "sample units",
    "space units",
    "space origin",
    "measurement frame",
];

/// Fields that may be written in two ways: the name under which they are kept, and the other one.
const SYNONYMS: [(&str, &str); 9] = [
    ("axis mins", "axismins"),
    ("axis maxs", "axismaxs"),
    ("centerings", "centers"),
    ("block size", "blocksize"),
    ("old min", "oldmin"),
    ("old max", "oldmax"),
    ("line skip", "lineskip"),
    ("byte skip", "byteskip"),
    ("data file", "datafile"),
];

fn wrong(problem: impl Into<String>) -> VolumeProblem {
    VolumeProblem::Malformed { format: FORMAT, problem: problem.into() }
}

/// The fields of a head.
struct Head<'a> {
    fields: HashMap<&'static str, &'a str>,
    /// Where samples begin that are in the same file.
    samples: usize,
}

/// The file of the samples that a head names, if it is another.
pub(super) fn samples_file(bytes: &[u8]) -> Option<String> {
    head(bytes).ok()?.samples_file().ok()?.map(str::to_owned)
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
        let field = line.split_once(": ").filter(|(key, _)| !key.contains(":="));
        let Some((key, value)) = field else {
            // A pair of a program's own, or a line in a list of files, which is refused as a whole.
            if line.contains(":=") || is_list(fields.get("data file")) {
                continue;
            }
            let start: String = line.chars().take(40).collect();
            return Err(wrong(format!("the line {start:?} of its head is no `field: value`")));
        };
        let name = key.trim().to_ascii_lowercase();
        let known = field_name(&name)
            .ok_or_else(|| wrong(format!("{key:?} is no field of the format")))?;
        if fields.insert(known, value.trim()).is_some() {
            return Err(wrong(format!("its head has `{name}` twice")));
        }
    }
    Ok(Head { fields, samples: end + gap })
}

/// Whether `data file` means a list of files, one a line.
fn is_list(data_file: Option<&&str>) -> bool {
    let first = data_file.and_then(|file| file.split_whitespace().next());
    first.is_some_and(|word| word.eq_ignore_ascii_case("LIST"))
}

/// The name under which a field is kept.
fn field_name(name: &str) -> Option<&'static str> {
    let synonyms = SYNONYMS.iter().find(|(kept, other)| [*kept, *other].contains(&name));
    let mut others = FIELDS.iter();
    synonyms.map(|(kept, _)| *kept).or_else(|| others.find(|field| **field == name).copied())
}

impl Head<'_> {
    fn field(&self, key: &str) -> Option<&str> {
        self.fields.get(key).copied()
    }

    fn needed(&self, key: &str) -> Result<&str, VolumeProblem> {
        self.field(key).ok_or_else(|| wrong(format!("its head lacks `{key}`")))
    }

    /// Three numbers, which are finite.
    fn numbers(&self, key: &str) -> Result<Option<[f64; 3]>, VolumeProblem> {
        let Some(text) = self.field(key) else { return Ok(None) };
        let numbers = three(text.trim_matches(['(', ')']));
        numbers
            .map(Some)
            .ok_or_else(|| wrong(format!("{key} {text:?} is not read: write 3 finite numbers")))
    }

    /// The file of the samples, if it is another.
    fn samples_file(&self) -> Result<Option<&str>, VolumeProblem> {
        let Some(file) = self.field("data file") else { return Ok(None) };
        if is_list(Some(&file)) || file.contains('%') {
            return Err(wrong(format!(
                "data file {file:?} means several files, which are not read: write the samples into one file"
            )));
        }
        Ok(Some(file))
    }

    fn counts(&self) -> Result<[usize; 3], VolumeProblem> {
        for key in ["dimension", "space dimension"] {
            if let Some(dimension) = self.field(key).filter(|dimension| *dimension != "3") {
                return Err(wrong(format!(
                    "{key} {dimension:?} is not read: write one volume of 3 axes, with a number a sample"
                )));
            }
        }
        self.needed("dimension")?;
        let is_of_space = |kind: &str| {
            ["domain", "space", "none", "???"].contains(&kind.to_ascii_lowercase().as_str())
        };
        if let Some(kinds) = self.field("kinds")
            && !kinds.split_whitespace().all(is_of_space)
        {
            return Err(wrong(format!(
                "kinds {kinds:?} are not read: all three axes are of space; write one volume, with a number a sample"
            )));
        }
        let sizes = self.needed("sizes")?;
        list(sizes).ok_or_else(|| {
            wrong(format!("sizes {sizes:?} is not read: write the 3 counts of samples"))
        })
    }

    fn stored(&self, counts: [usize; 3]) -> Result<Stored, VolumeProblem> {
        let kind = match self.needed("type")?.to_ascii_lowercase().as_str() {
            "signed char" | "int8" | "int8_t" => Kind::I8,
            "uchar" | "unsigned char" | "uint8" | "uint8_t" => Kind::U8,
            "short" | "short int" | "signed short" | "signed short int" | "int16"
            | "int16_t" => Kind::I16,
            "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => {
                Kind::U16
            }
            "int" | "signed int" | "int32" | "int32_t" => Kind::I32,
            "uint" | "unsigned int" | "uint32" | "uint32_t" => Kind::U32,
            "longlong"
            | "long long"
            | "long long int"
            | "signed long long"
            | "signed long long int"
            | "int64"
            | "int64_t" => Kind::I64,
            "ulonglong"
            | "unsigned long long"
            | "unsigned long long int"
            | "uint64"
            | "uint64_t" => Kind::U64,
            "float" => Kind::F32,
            "double" => Kind::F64,
            other => {
                return Err(wrong(format!(
                    "type {other:?} is not read: write one of the format's numbers, as float"
                )));
            }
        };
        let encoding = self.needed("encoding")?;
        let packing = match encoding.to_ascii_lowercase().as_str() {
            "raw" => Packing::Raw,
            "gzip" | "gz" => Packing::Gzip,
            _ => {
                return Err(wrong(format!(
                    "encoding {encoding:?} is not read: write raw or gzip"
                )));
            }
        };
        let endian = self.field("endian").map(str::to_ascii_lowercase);
        let is_big = match endian.as_deref() {
            Some("big") => true,
            Some("little") => false,
            None if kind.bytes() == 1 => false,
            None => return Err(wrong("its head lacks `endian`: write little or big")),
            Some(other) => {
                return Err(wrong(format!("endian {other:?} is neither little nor big")));
            }
        };
        for key in ["line skip", "byte skip"] {
            if let Some(skipped) = self.field(key).filter(|skipped| *skipped != "0") {
                return Err(wrong(format!(
                    "{key} {skipped:?} is not read; write the samples by themselves"
                )));
            }
        }
        let count = counts.iter().try_fold(1_usize, |all, count| all.checked_mul(*count));
        let count = count.ok_or_else(|| wrong("it has too many samples"))?;
        Ok(Stored { format: FORMAT, kind, is_big, packing, count })
    }

    /// The length [m] in which places are said. ITK does not read it: its places are numbers.
    fn unit(&self) -> Result<f64, VolumeProblem> {
        let key = if self.field("space units").is_some() { "space units" } else { "units" };
        let Some(units) = self.field(key) else { return Ok(MILLIMETRE) };
        let mut words = units.split(['"', ' ']).filter(|word| !word.is_empty());
        let Some(first) = words.next() else { return Ok(MILLIMETRE) };
        let is_alike = words.all(|word| word == first);
        unit(first).filter(|_| is_alike).ok_or_else(|| {
            wrong(format!("{key} {units:?} is not read: write {UNITS}, the same for all axes"))
        })
    }

    /// The signs that turn the coordinates of the head's frame into those of all volumes. A frame that tells of no
    /// patient stays as it is.
    fn signs(&self) -> Result<[f64; 3], VolumeProblem> {
        let Some(space) = self.field("space") else { return Ok([1.0; 3]) };
        let why = match space.to_ascii_lowercase().as_str() {
            "left-posterior-superior" | "lps" => return Ok(LEFT_POSTERIOR),
            "left-anterior-superior" | "las" => return Ok([-1.0, 1.0, 1.0]),
            "right-anterior-superior" | "ras" | "3d-right-handed" | "3drh" => {
                return Ok([1.0; 3]);
            }
            "3d-left-handed" | "3dlh" => {
                "it does not say which of its axes is mirrored, and ITK mirrors none"
            }
            "scanner-xyz" => {
                "it does not say how the patient lies, and ITK takes it for a patient's frame"
            }
            _ => "its frame is not known",
        };
        Err(wrong(format!(
            "space {space:?} is not read, as {why}: write the place in left-posterior-superior or \
             right-anterior-superior"
        )))
    }

    /// Where the nodes are, in the head's frame and unit.
    fn placement(&self) -> Result<Placement, VolumeProblem> {
        let spacings = self.numbers("spacings")?;
        let steps = match (self.field("space directions"), spacings) {
            (Some(_), Some(_)) => {
                return Err(wrong(
                    "its head has `space directions` and `spacings`, one of which is right: keep that one",
                ));
            }
            (Some(text), None) => vectors(text).ok_or_else(|| {
                wrong(format!(
                    "space directions {text:?} is not read: write 3 vectors of 3 finite numbers"
                ))
            })?,
            (None, Some([x, y, z])) => [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]],
            (None, None) => {
                return Err(wrong("its head lacks `space directions` and `spacings`"));
            }
        };
        let origin = match (self.numbers("space origin")?, self.field("axis mins")) {
            (Some(_), Some(_)) => {
                return Err(wrong(
                    "its head has `space origin` and `axis mins`, one of which is right: keep that one",
                ));
            }
            (Some(origin), None) => origin,
            (None, _) => self.first_node(&steps)?,
        };
        Ok(Placement { steps, origin })
    }

    /// Where the first node is by the least coordinates along the axes: half a step from them where samples are of
    /// cells, as they are unless the head says that they are of nodes.
    fn first_node(&self, steps: &[[f64; 3]; 3]) -> Result<[f64; 3], VolumeProblem> {
        let (least, most) = (self.numbers("axis mins")?, self.numbers("axis maxs")?);
        let Some(least) = least else {
            return match most {
                None => Ok([0.0; 3]),
                Some(_) => Err(wrong("its head has `axis maxs` without `axis mins`")),
            };
        };
        let is_along = |i: usize| (0..3).all(|k| k == i || steps[i][k] == 0.0);
        if !(0..3).all(is_along) {
            return Err(wrong(
                "axis mins do not say where turned axes begin: write `space origin` in their place",
            ));
        }
        let shares = self.shares()?;
        let counts = self.counts()?;
        let first = std::array::from_fn(|i| least[i] + shares[i] * steps[i][i]);
        for (i, most) in most.into_iter().flatten().enumerate() {
            // Along an axis of cells there are as many steps as samples, along one of nodes one fewer.
            let span = (counts[i] as f64 - 1.0 + 2.0 * shares[i]) * steps[i][i];
            if (least[i] + span - most).abs() > 1e-3 * steps[i][i].abs() {
                let end = least[i] + span;
                return Err(wrong(format!(
                    "axis maxs say that axis {} ends at {most}, by its step and its size it ends at {end}: correct \
                     one of them",
                    i + 1
                )));
            }
        }
        Ok(first)
    }

    /// The share of a step by which the first sample of each axis lies from the axis' beginning.
    fn shares(&self) -> Result<[f64; 3], VolumeProblem> {
        let mut shares = [0.5; 3];
        let Some(text) = self.field("centerings") else { return Ok(shares) };
        let mut words = text.split_whitespace();
        for share in &mut shares {
            *share = match words.next().map(str::to_ascii_lowercase).as_deref() {
                Some("node") => 0.0,
                Some("cell" | "none" | "???") => 0.5,
                _ => {
                    return Err(wrong(format!(
                        "centerings {text:?} is not read: write cell or node for each of the 3 axes"
                    )));
                }
            };
        }
        Ok(shares)
    }
}

/// Where the nodes are.
struct Placement {
    steps: [[f64; 3]; 3],
    origin: [f64; 3],
}

pub(super) fn read(bytes: &[u8], folder: &Path) -> Result<Volume, VolumeProblem> {
    let head = head(bytes)?;
    let counts = head.counts()?;
    let stored = head.stored(counts)?;
    let unit = head.unit()?;
    let signs = head.signs()?;
    let placement = head.placement()?;
    let samples = match head.samples_file()? {
        Some(name) => stored.read(&beside(folder, name)?)?,
        None => stored.read(&bytes[head.samples..])?,
    };
    let metres = |v: [f64; 3]| Vector(std::array::from_fn(|i| signs[i] * v[i])) * unit;
    Volume::new(counts, metres(placement.origin), placement.steps.map(metres), samples)
}

/// Three numbers, which are finite.
fn three(text: &str) -> Option<[f64; 3]> {
    list(text).filter(|numbers: &[f64; 3]| numbers.iter().all(|number| number.is_finite()))
}

/// Three vectors in parentheses.
fn vectors(text: &str) -> Option<[[f64; 3]; 3]> {
    let each: Option<Vec<[f64; 3]>> = text
        .split(')')
        .map(|part| part.trim().trim_start_matches('('))
        .filter(|part| !part.is_empty())
        .map(three)
        .collect();
    each?.try_into().ok()
}
