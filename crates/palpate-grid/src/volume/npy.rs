// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! NumPy's `.npy`: an array, whose first axis is x. It says nothing of lengths: a node is a metre from the next.
//! Format: <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>.

use palpate_field::Vector;

use super::head::list;
use super::{Kind, Packing, Stored, Volume, VolumeProblem};
use crate::grid::{indices, raveled};

const FORMAT: &str = ".npy";

fn wrong(problem: impl Into<String>) -> VolumeProblem {
    VolumeProblem::Malformed { format: FORMAT, problem: problem.into() }
}

pub(super) fn read(bytes: &[u8]) -> Result<Volume, VolumeProblem> {
    let rest = bytes
        .strip_prefix(b"\x93NUMPY")
        .ok_or_else(|| wrong("it does not begin as NumPy's files do"))?;
    let short = || wrong("it ends in its head");
    let ([version, _], rest) = rest.split_first_chunk::<2>().ok_or_else(short)?;
    let (length, rest) = if *version == 1 {
        let (length, rest) = rest.split_first_chunk::<2>().ok_or_else(short)?;
        (usize::from(u16::from_le_bytes(*length)), rest)
    } else {
        let (length, rest) = rest.split_first_chunk::<4>().ok_or_else(short)?;
        (u32::from_le_bytes(*length) as usize, rest)
    };
    let (head, samples) = rest.split_at_checked(length).ok_or_else(short)?;
    let head = std::str::from_utf8(head).map_err(|_| wrong("its head is no text"))?;
    let after = |key: &str| {
        let quoted = head.find(&format!("'{key}'"))? + key.len() + 2;
        Some(head[quoted..].trim_start().strip_prefix(':')?.trim_start())
    };
    let lacks = |key: &str| wrong(format!("its head lacks '{key}'"));
    let descr = after("descr").and_then(|text| text.strip_prefix('\'')?.split('\'').next());
    let descr = descr.ok_or_else(|| lacks("descr"))?;
    let (order, name) = descr.split_at_checked(1).ok_or_else(|| lacks("descr"))?;
    let kind = match name {
        "i1" => Kind::I8,
        "u1" | "b1" => Kind::U8,
        "i2" => Kind::I16,
        "u2" => Kind::U16,
        "i4" => Kind::I32,
        "u4" => Kind::U32,
        "f4" => Kind::F32,
        "f8" => Kind::F64,
        _ => return Err(wrong(format!("the type {descr:?} is not read; write float32"))),
    };
    let is_fortran =
        after("fortran_order").ok_or_else(|| lacks("fortran_order"))?.starts_with("True");
    let shape = after("shape").and_then(|text| text.strip_prefix('(')?.split(')').next());
    let shape = shape.ok_or_else(|| lacks("shape"))?;
    let counts: [usize; 3] =
        list(shape).ok_or_else(|| wrong(format!("its shape ({shape}) has not 3 axes")))?;
    let count = counts.iter().try_fold(1_usize, |all, count| all.checked_mul(*count));
    let count = count.ok_or_else(|| wrong("it has too many samples"))?;
    let stored =
        Stored { format: FORMAT, kind, is_big: order == ">", packing: Packing::Raw, count };
    let mut found = stored.read(samples)?;
    if !is_fortran {
        let [x, y, z] = counts;
        let turned = |[i, j, k]: [usize; 3]| found[raveled([k, j, i], [z, y, x])];
        found = indices([0; 3], counts).map(turned).collect();
    }
    let step = |axis: usize| {
        let mut step = Vector([0.0; 3]);
        step[axis] = 1.0;
        step
    };
    Volume::new(counts, Vector([0.0; 3]), [step(0), step(1), step(2)], found)
}
