// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! NIfTI-1: a head of 348 bytes, then samples; the whole may be packed.
//! Format: <https://nifti.nimh.nih.gov/pub/dist/src/niftilib/nifti1.h>. Where ITK and nibabel read it differently, the
//! file is refused, unless the format itself decides between them.

use std::io::Read;

use flate2::read::MultiGzDecoder;
use palpate_field::Vector;

use super::head::MILLIMETRE;
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
    let of_axis = |axis: usize| head.short(40 + 2 * axis);
    let axes = of_axis(0);
    if !(3..=7).contains(&axes) {
        return Err(wrong(format!(
            "dim[0], the number of its axes, is {axes}: write a volume of 3 axes"
        )));
    }
    for axis in 1..=axes.unsigned_abs().into() {
        let count = of_axis(axis);
        if count < 0 || (axis <= 3 && count == 0) {
            return Err(wrong(format!(
                "dim[{axis}] is {count}: an axis has a positive number of samples"
            )));
        }
        // Further axes of one node are no axes.
        if axis > 3 && count > 1 {
            return Err(wrong(format!(
                "dim[{axis}] is {count}: write one of the volumes alone, as nibabel.four_to_three does"
            )));
        }
    }
    Ok([1, 2, 3].map(|axis| of_axis(axis).unsigned_abs().into()))
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
        1024 => Kind::I64,
        1280 => Kind::U64,
        other => {
            return Err(wrong(format!(
                "datatype {other} is not read: write a number a sample, as float32 (16)"
            )));
        }
    };
    let first = head.float(108);
    if !(HEAD as f64..=1e6).contains(&first) {
        return Err(wrong(format!(
            "vox_offset, where its samples begin, is {first}: it must be from {HEAD} to 1000000"
        )));
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
    let unit = unit(&head)?;
    let placement = placement(&head)?;
    let scaling = scaling(&head)?;
    let mut samples = stored.read(bytes.get(first..).unwrap_or_default())?;
    if let Some([slope, offset]) = scaling {
        for sample in &mut samples {
            *sample = (f64::from(*sample) * slope + offset) as f32;
        }
    }
    let metres = |v: Vector<f64, 3>| v * unit;
    Volume::new(counts(&head)?, metres(placement.origin), placement.steps.map(metres), samples)
}

/// The slope and the offset of samples. A slope of zero, or that is no number, means none: so have it the format and
/// nibabel.
fn scaling(head: &Head<'_>) -> Result<Option<[f64; 2]>, VolumeProblem> {
    let [slope, offset]: [f64; 2] = head.floats(112);
    if slope == 0.0 || !slope.is_finite() {
        return Ok(None);
    }
    if !offset.is_finite() {
        return Err(wrong(format!(
            "scl_slope is {slope}, but scl_inter is {offset}: write a finite scl_inter, as 0"
        )));
    }
    Ok(Some([slope, offset]))
}

/// The length [m] in which places are said, as the low three bits of `xyzt_units` tell.
fn unit(head: &Head<'_>) -> Result<f64, VolumeProblem> {
    match head.bytes[123] & 7 {
        0 | 2 => Ok(MILLIMETRE),
        1 => Ok(1.0),
        3 => Ok(1e-6),
        other => Err(wrong(format!(
            "xyzt_units names the unit {other} of lengths: write 1 (m), 2 (mm) or 3 (micron)"
        ))),
    }
}

/// Where the nodes are, in units of the file.
struct Placement {
    steps: [Vector<f64, 3>; 3],
    origin: Vector<f64, 3>,
}

/// The place of the sform, if its code is set, else of the qform: nibabel's order. The format leaves the order to the
/// reader; ITK takes the qform of a file that has both, unless its `sform_code` is 1.
fn placement(head: &Head<'_>) -> Result<Placement, VolumeProblem> {
    let [qform, sform] = [252, 254].map(|place| head.short(place));
    for (name, code) in [("qform_code", qform), ("sform_code", sform)] {
        if !(0..=5).contains(&code) {
            return Err(wrong(format!("{name} is {code}: the format knows 0 to 5")));
        }
    }
    match (qform, sform) {
        (0, 0) => Err(wrong(
            "qform_code and sform_code are 0, so it does not say where it lies, and ITK and nibabel put it at \
             different places: set one of them; nibabel.save(nibabel.Nifti1Image(image.dataobj, image.affine), path) \
             writes nibabel's place",
        )),
        (_, 0) => of_qform(head),
        _ => of_sform(head),
    }
}

/// The columns of the sform. They hold the lengths of the steps: `pixdim` has no part in it.
fn of_sform(head: &Head<'_>) -> Result<Placement, VolumeProblem> {
    let rows: [[f64; 4]; 3] = [280, 296, 312].map(|place| head.floats(place));
    let [x, y, z, origin] = std::array::from_fn(|k| Vector(rows.map(|row| row[k])));
    let steps = [x, y, z];
    if !origin.is_finite() || !steps.iter().all(|step| step.is_finite() && step.norm() > 0.0) {
        return Err(wrong(format!(
            "its sform, srow_x, srow_y and srow_z, is {rows:?}: write finite steps that are not zero, or \
             sform_code 0 and a qform"
        )));
    }
    Ok(Placement { steps, origin })
}

/// The steps along the axes of a rotation.
fn of_qform(head: &Head<'_>) -> Result<Placement, VolumeProblem> {
    let [hand, sizes @ ..] = head.floats::<4>(76);
    let origin = Vector(head.floats(268));
    if !origin.is_finite() {
        return Err(wrong(format!("its qoffset {:?} is not finite", origin.0)));
    }
    // The sign of the third axis. Programs write 0 for 1.
    let hand = match hand {
        -1.0 => -1.0,
        hand if hand < 0.0 => {
            return Err(wrong(format!(
                "pixdim[0], the sign of its third axis, is {hand}: write 1 or -1"
            )));
        }
        _ => 1.0,
    };
    let mut lengths = [1.0; 3];
    for (k, size) in sizes.into_iter().enumerate() {
        let axis = k + 1;
        if size < 0.0 || !size.is_finite() {
            return Err(wrong(format!(
                "pixdim[{axis}] is {size}: the format has no negative sizes, ITK mirrors the axis, and nibabel \
                 takes the size without its sign; write it positive, and the direction into the qform"
            )));
        }
        // ITK and nibabel read a size of zero as 1.
        if size > 0.0 {
            lengths[k] = size;
        }
    }
    let columns = rotation(head.floats(256))?;
    lengths[2] *= hand;
    Ok(Placement { steps: std::array::from_fn(|k| columns[k] * lengths[k]), origin })
}

/// The axes of the rotation of a unit quaternion. The head holds its last three parts.
fn rotation(parts: [f64; 3]) -> Result<[Vector<f64, 3>; 3], VolumeProblem> {
    let squares: f64 = parts.iter().map(|part| part * part).sum();
    // Parts are of single precision.
    if squares.is_nan() || squares > 1.0 + 3.0 * f64::from(f32::EPSILON) {
        return Err(wrong(format!(
            "quatern_b, quatern_c and quatern_d are {parts:?}: the sum of their squares is {squares}, it must be at \
             most 1"
        )));
    }
    let length = squares.max(1.0).sqrt();
    let [b, c, d] = parts.map(|part| part / length);
    let a = (1.0 - squares).max(0.0).sqrt();
    Ok([
        [a * a + b * b - c * c - d * d, 2.0 * (b * c + a * d), 2.0 * (b * d - a * c)],
        [2.0 * (b * c - a * d), a * a + c * c - b * b - d * d, 2.0 * (c * d + a * b)],
        [2.0 * (b * d + a * c), 2.0 * (c * d - a * b), a * a + d * d - c * c - b * b],
    ]
    .map(Vector))
}
