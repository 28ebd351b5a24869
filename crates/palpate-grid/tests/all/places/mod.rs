// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where volumes lie, compared with ITK and nibabel. The places are those that SimpleITK 2.5.7 and nibabel 5.4.2 give
//! for the same bytes; the tests of the Python package ask both again, where they are installed.

mod metaimage;
mod nifti;
mod nrrd;

use std::path::Path;

use palpate_field::Vector;
use palpate_grid::Volume;

/// Samples along each axis, all different.
const COUNTS: [usize; 3] = [4, 5, 6];

/// Heads hold single precision: a place of 40 mm is known to 2e-6 mm.
const ROUNDING: f64 = 4e-9;

/// A sample for each node: its number.
fn samples() -> Vec<u8> {
    (0..120_i16).flat_map(i16::to_le_bytes).collect()
}

/// The places of the first node and of node [1, 2, 3], in millimetres to the right, the front and the top.
type Places = [[f64; 3]; 2];

fn read(name: &str, bytes: &[u8]) -> Result<Volume, String> {
    Volume::from_bytes(bytes, Path::new(name)).map_err(|error| error.to_string())
}

/// Reads a file, whose nodes must be at these places, and whose samples must be their numbers.
#[track_caller]
fn assert_places(what: &str, volume: Result<Volume, String>, places: Places) {
    let volume = volume.unwrap_or_else(|error| panic!("{what}: {error}"));
    assert_eq!(volume.counts(), COUNTS, "{what}");
    assert!(volume.samples().iter().enumerate().all(|(i, s)| *s == i as f32), "{what}");
    for (node, place) in [[0; 3], [1, 2, 3]].into_iter().zip(places) {
        let found = volume.node(node);
        let off = (found - Vector(place) * 1e-3).norm();
        assert!(off <= ROUNDING, "{what}: node {node:?} is at {found:?}, not {place:?} mm");
    }
}

/// A refusal must have all these words.
#[track_caller]
fn assert_refused(what: &str, volume: Result<Volume, String>, words: &[&str]) {
    let error = volume.err().unwrap_or_else(|| panic!("{what} is read"));
    for word in words {
        assert!(error.contains(word), "{what}: {error:?} lacks {word:?}");
    }
}
