// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A volume as a CT makes them, without a CT: the end of a bone, with its marrow, in soft tissue.
//!
//! `cargo run -p palpate-grid --example bone FILE.nrrd` writes it; without a name, to `scenes/scans/bone.nrrd`.
//! Samples are 0.5 × 0.5 × 0.8 mm apart, in Hounsfield units: about 40 in soft tissue, −50 in marrow, 1000 in the
//! cortex, blurred over a sample and with the noise of a scanner.

use std::error::Error;
use std::io::Write;
use std::path::PathBuf;

use flate2::Compression;
use flate2::write::GzEncoder;

/// Samples along each axis, and their spacing [mm].
const COUNTS: [usize; 3] = [64, 56, 60];
const SPACING: [f64; 3] = [0.5, 0.5, 0.8];

const TISSUE: f64 = 40.0;
const MARROW: f64 = -50.0;
const CORTEX: f64 = 1000.0;

/// The thickness of the cortex, and what the scanner blurs [mm].
const WALL: f64 = 2.2;
const BLUR: f64 = 0.6;

/// The noise [Hounsfield units], and the step of what is stored.
const NOISE: f64 = 24.0;
const STEP: f64 = 8.0;

fn main() -> Result<(), Box<dyn Error>> {
    let usual = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../scenes/scans/bone.nrrd");
    let path = std::env::args_os().nth(1).map_or(usual, PathBuf::from);
    let mut samples = Vec::new();
    let mut noise = 1_u64;
    for z in 0..COUNTS[2] {
        for y in 0..COUNTS[1] {
            for x in 0..COUNTS[0] {
                // Marsaglia's xorshift (2003).
                noise ^= noise << 13;
                noise ^= noise >> 7;
                noise ^= noise << 17;
                let share = (noise >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
                let value = density([x, y, z]) + 2.0 * NOISE * share;
                let stored = ((value / STEP).round() * STEP) as i16;
                samples.extend(stored.to_le_bytes());
            }
        }
    }
    let [nx, ny, nz] = COUNTS;
    let [dx, dy, dz] = SPACING;
    let mut bytes = format!(
        "NRRD0004\ntype: int16\ndimension: 3\nspace: left-posterior-superior\nsizes: {nx} {ny} {nz}\n\
         space directions: ({dx},0,0) (0,{dy},0) (0,0,{dz})\nspace origin: (0,0,0)\n\
         space units: \"mm\" \"mm\" \"mm\"\nendian: little\nencoding: gzip\n\n"
    )
    .into_bytes();
    let mut packed = GzEncoder::new(&mut bytes, Compression::best());
    packed.write_all(&samples)?;
    packed.finish()?;
    std::fs::write(&path, bytes)?;
    println!("{}: {nx} × {ny} × {nz} samples", path.display());
    Ok(())
}

/// The density at a sample, blurred: how much of it is outside the bone, in its wall and in its marrow.
fn density(index: [usize; 3]) -> f64 {
    let middle = |axis: usize| 0.5 * (COUNTS[axis] - 1) as f64;
    let p: [f64; 3] =
        std::array::from_fn(|axis| (index[axis] as f64 - middle(axis)) * SPACING[axis]);
    let outside = bone(p);
    let share = |distance: f64| 0.5 * (1.0 - (distance / BLUR).tanh());
    let (in_bone, in_marrow) = (share(outside), share(outside + WALL));
    TISSUE * (1.0 - in_bone) + CORTEX * (in_bone - in_marrow) + MARROW * in_marrow
}

/// About the distance from a shaft along z that ends in two knuckles [mm].
fn bone([x, y, z]: [f64; 3]) -> f64 {
    let shaft = x.hypot(y) - 5.0 - 1.5 * (z / 24.0).clamp(-1.0, 1.0);
    let knuckle = |side: f64| {
        let [dx, dy, dz] = [x - 6.5 * side, y - 1.0, z - 12.0];
        (dx * dx + dy * dy + dz * dz).sqrt() - 6.5
    };
    let joined = blend(blend(shaft, knuckle(1.0)), knuckle(-1.0));
    // The shaft ends before the border of the volume.
    joined.max(z.abs() - 20.0)
}

/// The smooth minimum of two distances, with a fillet of 3 mm.
fn blend(a: f64, b: f64) -> f64 {
    let h = (0.5 + 0.5 * (b - a) / 3.0).clamp(0.0, 1.0);
    b + (a - b) * h - 3.0 * h * (1.0 - h)
}
