// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! NIfTI-1: a head of 348 bytes, then samples; the whole may be packed.
//! Format: <https://nifti.nimh.nih.gov/pub/dist/src/niftilib/nifti1.h>.

use std::io::Read;

use flate2::read::MultiGzDecoder;
use palpate_field::Vector;

use super::{Kind, LARGEST_VOLUME, Packing, Stored, Volume, VolumeProblem, inflated};

const FORMAT: &str = "NIfTI";

/// The bytes of the head.
const HEAD: usize = 348;

fn wrong(problem: impl Into<String>) -> VolumeProblem {
    VolumeProblem::Malformed { format: FORMAT, problem: problem.into() }
}

/// The head's numbers.
struct Head<'a> {
    bytes: &'a [u8; HEAD],
    is_big: bool,
}

impl Head<'_> {
    fn at<const N: usize>(&self, place: usize) -> [u8; N] {
        let mut bytes: [u8; N] = std::array::from_fn(|i| self.bytes[place + i]);
        if self.is_big {
            bytes.reverse();
        }
        bytes
    }

    fn short(&self, place: usize) -> i16 {
        i16::from_le_bytes(self.at(place))
    }

    fn float(&self, place: usize) -> f64 {
        f32::from_le_bytes(self.at(place)).into()
    }

    fn floats<const N: usize>(&self, place: usize) -> [f64; N] {
        std::array::from_fn(|i| self.float(place + 4 * i))
    }
}

pub(super) fn read(bytes: &[u8]) -> Result<Volume, VolumeProblem> {
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return unpacked(bytes);
    }
    // The head tells how much there is, so the head is unpacked alone first.
    let mut head = [0; HEAD];
    let unpack = || MultiGzDecoder::new(bytes);
    unpack().read_exact(&mut head).map_err(|error| wrong(error.to_string()))?;
    let length = length(&parsed(&head)?)?;
    if length > LARGEST_VOLUME {
        return Err(VolumeProblem::TooLarge { bytes: length });
    }
    let all = inflated(unpack(), length as usize).map_err(|error| wrong(error.to_string()))?;
    unpacked(&all)
}

/// The bytes of a file with this head.
fn length(head: &Head<'_>) -> Result<u64, VolumeProblem> {
    let (stored, first) = stored(head)?;
    let samples = stored.count.checked_mul(stored.kind.bytes());
    let all = samples.and_then(|samples| samples.checked_add(first));
    all.map(|all| all as u64).ok_or_else(|| wrong("it has too many samples"))
}

fn parsed(bytes: &[u8; HEAD]) -> Result<Head<'_>, VolumeProblem> {
    let size: [u8; 4] = std::array::from_fn(|i| bytes[i]);
    let is_big = match (u32::from_le_bytes(size), u32::from_be_bytes(size)) {
        (348, _) => false,
        (_, 348) => true,
        (540, _) | (_, 540) => return Err(wrong("NIfTI-2 is not read; write NIfTI-1")),
        _ => return Err(wrong("its head has another size than 348")),
    };
    match &bytes[344..347] {
        b"n+1" => Ok(Head { bytes, is_big }),
        b"ni1" => Err(wrong("its samples are in another file (.img); write .nii")),
        _ => Err(wrong("its head does not end in n+1")),
    }
}

fn counts(head: &Head<'_>) -> Result<[usize; 3], VolumeProblem> {
    let dimension = head.short(40);
    // Further axes of one node are no axes.
    let others = usize::try_from(dimension.saturating_sub(3)).unwrap_or(0).min(4);
    let are_single = (0..others).all(|axis| head.short(48 + 2 * axis) <= 1);
    let counts = [42, 44, 46].map(|place| usize::try_from(head.short(place)).unwrap_or(0));
    if dimension < 3 || !are_single {
        return Err(wrong(format!("it has {dimension} dimensions, 3 are read")));
    }
    Ok(counts)
}

/// How samples are stored, and where they begin.
fn stored(head: &Head<'_>) -> Result<(Stored, usize), VolumeProblem> {
    let kind = match head.short(70) {
        2 => Kind::U8,
        4 => Kind::I16,
        8 => Kind::I32,
        16 => Kind::F32,
        64 => Kind::F64,
        256 => Kind::I8,
        512 => Kind::U16,
        768 => Kind::U32,
        other => return Err(wrong(format!("the data type {other} is not read"))),
    };
    let first = head.float(108);
    if !(HEAD as f64..=1e6).contains(&first) {
        return Err(wrong(format!("its samples begin at byte {first}")));
    }
    let count = counts(head)?.iter().try_fold(1_usize, |all, count| all.checked_mul(*count));
    let count = count.ok_or_else(|| wrong("it has too many samples"))?;
    let (is_big, packing) = (head.is_big, Packing::Raw);
    Ok((Stored { format: FORMAT, kind, is_big, packing, count }, first as usize))
}

fn unpacked(bytes: &[u8]) -> Result<Volume, VolumeProblem> {
    let head = bytes.first_chunk::<HEAD>().ok_or_else(|| wrong("it ends in its head"))?;
    let head = parsed(head)?;
    let (stored, first) = stored(&head)?;
    let mut samples = stored.read(bytes.get(first..).unwrap_or_default())?;
    let (slope, offset) = (head.float(112), head.float(116));
    if slope != 0.0 && slope.is_finite() && offset.is_finite() {
        for sample in &mut samples {
            *sample = (f64::from(*sample) * slope + offset) as f32;
        }
    }
    // The low three bits tell the unit of lengths; nothing known is taken for millimetres.
    let unit = match head.bytes[123] & 7 {
        1 => 1.0,
        3 => 1e-6,
        _ => 1e-3,
    };
    let (steps, origin) = placed(&head);
    let metres = |v: Vector<f64, 3>| v * unit;
    Volume::new(counts(&head)?, metres(origin), steps.map(metres), samples)
}

/// The steps and the origin, by the affine map, else by the rotation, else by the spacing alone.
fn placed(head: &Head<'_>) -> ([Vector<f64, 3>; 3], Vector<f64, 3>) {
    let spacing: [f64; 3] = head.floats(80);
    if head.short(254) > 0 {
        let rows: [[f64; 4]; 3] = [280, 296, 312].map(|place| head.floats(place));
        let column = |k: usize| Vector(rows.map(|row| row[k]));
        return ([column(0), column(1), column(2)], column(3));
    }
    if head.short(252) > 0 {
        let [b, c, d] = head.floats(256);
        let a = (1.0 - (b * b + c * c + d * d)).max(0.0).sqrt();
        let columns = [
            [a * a + b * b - c * c - d * d, 2.0 * (b * c + a * d), 2.0 * (b * d - a * c)],
            [2.0 * (b * c - a * d), a * a + c * c - b * b - d * d, 2.0 * (c * d + a * b)],
            [2.0 * (b * d + a * c), 2.0 * (c * d - a * b), a * a + d * d - c * c - b * b],
        ];
        // The sign of the first spacing is that of the third axis.
        let hand = if head.float(76) < 0.0 { -1.0 } else { 1.0 };
        let lengths = [spacing[0], spacing[1], spacing[2] * hand];
        let steps = std::array::from_fn(|k| Vector(columns[k]) * lengths[k]);
        return (steps, Vector(head.floats(268)));
    }
    let step = |k: usize| {
        let mut step = Vector([0.0; 3]);
        step[k] = spacing[k];
        step
    };
    ([step(0), step(1), step(2)], Vector([0.0; 3]))
}
