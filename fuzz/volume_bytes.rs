// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What must hold for any bytes that are read as a volume or as a grid.

use std::path::Path;

use palpate_field::CustomField;
use palpate_grid::{Grid, Volume};

/// Volumes of more samples are not meshed.
const SMALL: usize = 1 << 12;

/// Reads `bytes` as a file of this name and checks what came of it; whether it is one.
///
/// # Panics
///
/// If reading panics, an error says nothing or too much, or what was read is no volume or grid.
pub fn check(bytes: &[u8], name: &str) -> bool {
    if name.ends_with(".grid") {
        return check_grid(bytes);
    }
    let volume = match Volume::from_bytes(bytes, Path::new(name)) {
        Ok(volume) => volume,
        Err(problem) => return told(&problem.to_string()),
    };
    let [least, largest] = volume.range();
    assert!(least.is_finite() && least <= largest, "{least} to {largest}");
    if volume.samples().len() <= SMALL {
        let value = 0.5 * (f64::from(least) + f64::from(largest));
        match volume.surface(value) {
            Ok(mesh) => assert!(mesh.report().is_watertight(), "a surface has openings"),
            Err(problem) => drop(told(&problem.to_string())),
        }
    }
    true
}

/// The sum at the end is added, so that what is read is what its author may have written.
fn check_grid(bytes: &[u8]) -> bool {
    let mut whole = bytes.to_vec();
    whole.extend(blake3::hash(bytes).as_bytes());
    let grid = match Grid::<3>::from_bytes(&whole) {
        Ok(grid) => grid,
        Err(problem) => return told(&problem.to_string()),
    };
    let lattice = *grid.lattice();
    for share in [0.0, 0.3, 1.0] {
        let last = lattice.node(lattice.counts.map(|count| count - 1));
        let p = lattice.origin + (last - lattice.origin) * share;
        let (value, gradient) = grid.distance_gradient(p);
        assert!(value.is_finite() && gradient.is_finite(), "{value}, {gradient:?} at {p:?}");
        let steepest = grid.promise().lipschitz * (1.0 + 1e-9);
        assert!(gradient.norm() <= steepest, "{} of {steepest}", gradient.norm());
    }
    true
}

/// An error has something to say.
fn told(text: &str) -> bool {
    assert!((10..2_000).contains(&text.len()), "{text}");
    false
}
