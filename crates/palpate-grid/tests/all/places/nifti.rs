// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! NIfTI: the place of ITK and nibabel where they agree, else that of the format, else a refusal.

use palpate_grid::Volume;

use super::{Places, assert_places, assert_refused, read, samples};

/// The numbers of a head that say where the nodes are and what the samples mean.
#[derive(Clone, Copy)]
struct Head {
    dim: [i16; 8],
    pixdim: [f32; 4],
    units: u8,
    codes: [i16; 2],
    quaternion: [f32; 3],
    offset: [f32; 3],
    rows: [[f32; 4]; 3],
    scaling: [f32; 2],
}

/// A turned qform.
const QFORM: Head = Head {
    dim: [3, 4, 5, 6, 1, 1, 1, 1],
    pixdim: [1.0, 1.0, 2.0, 3.0],
    units: 2,
    codes: [1, 0],
    quaternion: [0.1, 0.2, 0.3],
    offset: [10.0, 20.0, 30.0],
    rows: [[0.0, -2.0, 0.0, 11.0], [1.0, 0.0, 0.0, 22.0], [0.0, 0.0, 3.0, 33.0]],
    scaling: [1.0, 0.0],
};

/// The same head with an sform, which decides the place.
const SFORM: Head = Head { codes: [0, 2], ..QFORM };

const BY_QFORM: Places = [[10.0, 20.0, 30.0], [12.552834193, 23.207165784, 39.010944746]];
const BY_SFORM: Places = [[11.0, 22.0, 33.0], [7.0, 23.0, 42.0]];

impl Head {
    fn bytes(&self, is_big: bool) -> Vec<u8> {
        let mut head = vec![0; 352];
        let mut put = |place: usize, mut bytes: Vec<u8>| {
            if is_big {
                bytes.reverse();
            }
            head[place..place + bytes.len()].copy_from_slice(&bytes);
        };
        put(0, 348_i32.to_le_bytes().to_vec());
        for (i, count) in self.dim.into_iter().enumerate() {
            put(40 + 2 * i, count.to_le_bytes().to_vec());
        }
        put(70, 4_i16.to_le_bytes().to_vec());
        put(72, 16_i16.to_le_bytes().to_vec());
        put(108, 352_f32.to_le_bytes().to_vec());
        put(123, vec![self.units]);
        for (i, code) in self.codes.into_iter().enumerate() {
            put(252 + 2 * i, code.to_le_bytes().to_vec());
        }
        let rows = self.rows.concat();
        for (first, floats) in [
            (76, &self.pixdim[..]),
            (112, &self.scaling),
            (256, &self.quaternion),
            (268, &self.offset),
            (280, &rows),
        ] {
            for (i, float) in floats.iter().enumerate() {
                put(first + 4 * i, float.to_le_bytes().to_vec());
            }
        }
        head[344..348].copy_from_slice(b"n+1\0");
        head
    }

    fn read(&self) -> Result<Volume, String> {
        read("a.nii", &[self.bytes(false), samples()].concat())
    }
}

/// A negative size turned the volume over.
#[test]
fn a_size_that_is_not_positive_does_not_turn_the_volume_over() {
    assert_places("positive", QFORM.read(), BY_QFORM);
    for axis in 1..4 {
        for size in [-1.0, -2.0, f32::NAN, f32::INFINITY] {
            let mut head = QFORM;
            head.pixdim[axis] = size;
            let said = [&format!("pixdim[{axis}] is {size}"), "write it positive"];
            assert_refused("the qform", head.read(), &said);
            head.codes = SFORM.codes;
            assert_places("the sform", head.read(), BY_SFORM);
        }
    }
    let zero = Head { pixdim: [1.0, 0.0, 2.0, 3.0], ..QFORM };
    assert_places("zero is one", zero.read(), BY_QFORM);
}

#[test]
fn the_first_size_is_the_sign_of_the_third_axis() {
    let mirrored = [[10.0, 20.0, 30.0], [4.795828751, 24.385668357, 22.8109448]];
    for (sign, places) in [(0.0, BY_QFORM), (1.0, BY_QFORM), (2.0, BY_QFORM), (-1.0, mirrored)]
    {
        let mut head = QFORM;
        head.pixdim[0] = sign;
        assert_places(&sign.to_string(), head.read(), places);
    }
    let mut head = QFORM;
    head.pixdim[0] = -0.5;
    assert_refused("-0.5", head.read(), &["pixdim[0]", "-0.5", "write 1 or -1"]);
}

#[test]
fn the_sform_goes_before_the_qform() {
    for codes in [[0, 1], [0, 2], [1, 1], [1, 2], [2, 1], [1, 4]] {
        assert_places(&format!("{codes:?}"), Head { codes, ..QFORM }.read(), BY_SFORM);
    }
    let pixdim = [1.0; 4];
    assert_places("other sizes", Head { pixdim, ..SFORM }.read(), BY_SFORM);
    for (codes, word) in [
        ([-1, 0], "qform_code is -1"),
        ([0, 7], "sform_code is 7"),
        ([0, 0], "different places"),
    ] {
        assert_refused(word, Head { codes, ..QFORM }.read(), &[word, "_code"]);
    }
    for entry in [0.0, f32::NAN] {
        let mut head = SFORM;
        head.rows[1][0] = entry;
        assert_refused("a step", head.read(), &["its sform", "srow_x", "sform_code 0"]);
    }
}

/// Parts of a quaternion that are too large stretched the steps.
#[test]
fn a_quaternion_is_of_length_one() {
    let quaternion = [1.0000001, 0.0, 0.0];
    let places = [[10.0, 20.0, 30.0], [11.0, 16.0, 21.0]];
    assert_places("rounded", Head { quaternion, ..QFORM }.read(), places);
    for quaternion in [[1.0; 3], [f32::NAN, 0.0, 0.0]] {
        let volume = Head { quaternion, ..QFORM }.read();
        assert_refused("too long", volume, &["quatern_b", "at most 1"]);
    }
}

#[test]
fn units_of_lengths_are_honoured_or_refused() {
    for units in [0, 2, 8, 10, 16] {
        assert_places("millimetres", Head { units, ..SFORM }.read(), BY_SFORM);
    }
    for (units, factor) in [(1, 1e3), (3, 1e-3)] {
        let places = BY_SFORM.map(|place| place.map(|x| x * factor));
        assert_places("another unit", Head { units, ..SFORM }.read(), places);
    }
    assert_refused("5", Head { units: 5, ..SFORM }.read(), &["xyzt_units", "unit 5", "2 (mm)"]);
}

/// Of negative counts it was said that the samples take no bytes and that more follow.
#[test]
fn counts_that_are_none_are_named() {
    for (dim, words) in [
        ([3, -3, 5, 6, 1, 1, 1, 1], ["dim[1] is -3", "positive"]),
        ([3, 4, 0, 6, 1, 1, 1, 1], ["dim[2] is 0", "positive"]),
        ([4, 4, 5, 6, -1, 1, 1, 1], ["dim[4] is -1", "positive"]),
        ([4, 4, 5, 3, 2, 1, 1, 1], ["dim[4] is 2", "four_to_three"]),
        ([5, 4, 5, 2, 1, 3, 1, 1], ["dim[5] is 3", "alone"]),
        ([2, 4, 30, 1, 1, 1, 1, 1], ["dim[0]", "is 2"]),
        ([0, 4, 5, 6, 1, 1, 1, 1], ["dim[0]", "is 0"]),
        ([-3, 4, 5, 6, 1, 1, 1, 1], ["dim[0]", "is -3"]),
        ([8, 4, 5, 6, 1, 1, 1, 1], ["dim[0]", "is 8"]),
    ] {
        assert_refused(&format!("{dim:?}"), Head { dim, ..QFORM }.read(), &words);
    }
    for dim in [[4, 4, 5, 6, 1, 1, 1, 1], [7, 4, 5, 6, 1, 1, 0, 1], [3, 4, 5, 6, 7, 8, 9, 1]] {
        assert_places(&format!("{dim:?}"), Head { dim, ..QFORM }.read(), BY_QFORM);
    }
}

#[test]
fn both_orders_of_bytes_give_the_same_place() {
    let big: Vec<u8> = (0..120_i16).flat_map(i16::to_be_bytes).collect();
    let volume = read("a.nii", &[QFORM.bytes(true), big].concat());
    assert_places("big-endian", volume, BY_QFORM);
}

/// A slope with an offset that is no number was passed over.
#[test]
fn samples_are_scaled_as_the_format_says() {
    let last = |scaling: [f32; 2]| {
        let volume = Head { scaling, ..QFORM }.read();
        volume.map(|volume| volume.samples()[119])
    };
    for (scaling, sample) in [
        ([0.0, 5.0], 119.0),
        ([f32::NAN, 0.0], 119.0),
        ([f32::INFINITY, 0.0], 119.0),
        ([2.0, 5.0], 243.0),
        ([-1.0, 0.0], -119.0),
    ] {
        assert_eq!(last(scaling), Ok(sample), "{scaling:?}");
    }
    assert!(last([2.0, f32::NAN]).unwrap_err().contains("scl_inter is NaN"));
}
