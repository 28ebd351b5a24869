// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! NanoVDB: files made here and by its own tools, and what is damaged.
#![cfg(feature = "volumes")]
#![expect(clippy::unwrap_used, reason = "tests")]

mod writer;

use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Duration, Instant};

use palpate_field::Vector;
use palpate_grid::{Inside, Volume, VolumeProblem};

use crate::writer::{Grid, LEAVES, LOWER, UPPER, file, put, version, zip};

fn read(bytes: &[u8]) -> Result<Volume, VolumeProblem> {
    Volume::from_bytes(bytes, Path::new("a.nvdb"))
}

fn said(bytes: &[u8]) -> String {
    read(bytes).unwrap_err().to_string()
}

#[test]
fn voxels_tiles_and_background_are_read_to_the_bit_however_they_are_stored() {
    let grid = Grid::small();
    let mut newer = grid.bytes();
    newer[7] = b'1';
    for bytes in [
        file(b"NanoVDB0", &[&grid], 0),
        file(b"NanoVDB2", &[&grid], 0),
        file(b"NanoVDB2", &[&grid], 1),
        grid.bytes(),
        newer,
    ] {
        let volume = read(&bytes).unwrap();
        // Active voxels are from (3, 4, 0) to (15, 15, 7), and one voxel is around them.
        assert_eq!(volume.counts(), [15, 14, 10]);
        assert_eq!(volume.inside(), Inside::Above);
        for (number, sample) in volume.samples().iter().enumerate() {
            // The lattice begins at (2, 3, -1); before 0 the root lists nothing.
            let place = [number % 15 + 2, number / 15 % 14 + 3, (number / 210).wrapping_sub(1)];
            let expected = match place {
                [8..16, 8..16, 0..8] => 8.0,
                _ => grid.voxels.get(&place).copied().unwrap_or(0.5),
            };
            assert_eq!(*sample, expected, "{place:?}");
        }
        // World = matrix · (2, 3, -1) + (10, 20, 30).
        assert_eq!(volume.origin(), Vector([11.0, 22.0, 33.0]));
        assert_eq!(volume.steps()[0], Vector([0.5, 0.0, 0.0]));
        assert_eq!(volume.steps()[1], Vector([0.0, 0.0, 1.0]));
        assert_eq!(volume.steps()[2], Vector([0.0, -2.0, 0.0]));
    }
}

/// Written by `nanovdb_convert --zip` 32.4.2 of a ball of pyopenvdb 10.0.1: radius 1.5, middle (4, 5, 6), voxels of
/// 0.25, half a band of 3 voxels.
#[test]
fn a_level_set_of_the_tools_of_open_vdb_is_a_ball() {
    let volume = read(include_bytes!("ball.nvdb")).unwrap();
    assert_eq!((volume.inside(), volume.counts()), (Inside::Below, [19; 3]));
    assert!((volume.node([9; 3]) - Vector([4.0, 5.0, 6.0])).norm() < 1e-12);
    assert_eq!(volume.range(), [-0.75, 0.75]);
    let mut checked = 0;
    for (number, sample) in volume.samples().iter().enumerate() {
        let place = [number % 19, number / 19 % 19, number / 361];
        let off = (volume.node(place) - Vector([4.0, 5.0, 6.0])).norm() - 1.5;
        if off.abs() < 0.75 {
            assert!((f64::from(*sample) - off).abs() < 1e-6, "{place:?}");
            checked += 1;
        }
    }
    assert!(checked > 2000, "{checked}");
    let mesh = volume.surface(0.0).unwrap();
    assert!(mesh.report().is_watertight() && mesh.report().enclosed.unwrap() > 0.0);
    for vertex in mesh.vertices() {
        // Linear interpolation of a distance is off by at most h² / 8 of its curvatures, three axes of 1 / r.
        let off = (*vertex - Vector([4.0, 5.0, 6.0])).norm() - 1.5;
        assert!(off.abs() < 3.0 * 0.25_f64.powi(2) / (8.0 * 1.25), "{off}");
    }
}

/// The same ball, by `nanovdb_convert --zip --fp4` and so on, and as double by `createLevelSetSphere` of NanoVDB 32.4.2.
#[test]
fn numbers_of_few_bits_and_of_many_are_read() {
    let exact = read(include_bytes!("ball.nvdb")).unwrap();
    // In steps of its range, 1.5, a leaf of b bits is off by half a step; `fpN` chooses bits for an error of 0.025.
    let half = |bits: i32| 0.75 / (2_f32.powi(bits) - 1.0) + 1e-6;
    for (bytes, most) in [
        (&include_bytes!("ball_fp4.nvdb")[..], half(4)),
        (include_bytes!("ball_fp8.nvdb"), half(8)),
        (include_bytes!("ball_fp16.nvdb"), half(16)),
        (include_bytes!("ball_fpN.nvdb"), 0.025),
        (include_bytes!("ball_double.nvdb"), 1e-5),
    ] {
        let volume = read(bytes).unwrap();
        assert_eq!((volume.inside(), volume.counts()), (Inside::Below, exact.counts()));
        let off = volume.samples().iter().zip(exact.samples()).map(|(a, b)| (a - b).abs());
        let off = off.fold(0.0, f32::max);
        assert!(off <= most, "{off} > {most}");
        for at in 0..bytes.len() {
            let mut bad = bytes.to_vec();
            bad[at] ^= 0x55;
            survives(&bad);
        }
    }
}

#[test]
fn the_side_of_a_value_is_what_the_file_says_or_the_caller() {
    let middle = [20.2, 19.5, 18.9];
    let volume = read(&file(b"NanoVDB2", &[&Grid::ball(middle, 9.0)], 1)).unwrap();
    assert_eq!(volume.inside(), Inside::Below);
    let round = 4.0 / 3.0 * std::f64::consts::PI * 9.0_f64.powi(3);
    let ball = volume.surface(0.0).unwrap();
    assert!(ball.report().is_watertight());
    assert!((ball.report().enclosed.unwrap() / round - 1.0).abs() < 0.02);
    // The same place, with the world's lengths, and a quarter turned.
    let middle = Vector([10.0 + 20.2 / 2.0, 20.0 - 2.0 * 18.9, 30.0 + 19.5]);
    for vertex in ball.vertices() {
        let [x, y, z] = (*vertex - middle).0;
        let off = Vector([2.0 * x, y / 2.0, z]).norm() - 9.0;
        assert!(off.abs() < 0.1, "{off}");
    }
    // Above, what is around the ball is the solid, with the ball as a cavity.
    let volume = volume.with_inside(Inside::Above);
    let around = volume.surface(0.0).unwrap().report().enclosed.unwrap();
    assert!(around > round, "{around}");
}

#[test]
fn what_is_not_read_is_told_with_what_to_do() {
    let (one, two) = (Grid::small(), Grid::ball([20.0; 3], 5.0));
    let error = said(&file(b"NanoVDB2", &[&one, &two], 0));
    assert!(error.contains("\"density\" (float), \"ball\" (float); say which"), "{error}");
    assert!(said(&file(b"NanoVDB2", &[&one], 2)).contains("nanovdb_convert --zip"));
    let mut bytes = one.bytes();
    put(&mut bytes, 636, &6_u32.to_le_bytes());
    assert!(said(&bytes).contains("vec3f"));
    let mut bytes = file(b"NanoVDB2", &[&one], 0);
    put(&mut bytes, 8, &version(33));
    assert!(said(&bytes).contains("version 33.4.2, 32.x is read"));
    let vdb = [&0x5644_4220_u64.to_le_bytes()[..], &[0; 40]].concat();
    assert!(said(&vdb).contains("nanovdb_convert in.vdb out.nvdb"));
    let error = Volume::from_bytes(&vdb, Path::new("a.vdb")).unwrap_err();
    assert!(matches!(error, VolumeProblem::OpenVdb));
    let mut bytes = one.bytes();
    put(&mut bytes, 384 + 8, &0.3_f64.to_le_bytes());
    assert!(said(&bytes).contains("sheared"));
    // A cube of 128 voxels at the far end is active too.
    let mut bytes = one.bytes();
    bytes[UPPER + 32 + 4095] |= 0x80;
    let error = said(&bytes);
    assert!(
        error.contains("[4095, 4094, 4098] nodes") && error.contains("16777216"),
        "{error}"
    );
    let bytes =
        file(b"NanoVDB2", &[&Grid { tiles: Vec::new(), voxels: BTreeMap::new(), ..one }], 0);
    assert!(said(&bytes).contains("none of its voxels is active"));
}

#[test]
fn one_of_several_grids_is_read_by_its_name() {
    let (one, two) = (Grid::small(), Grid::ball([20.0; 3], 5.0));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("two.nvdb");
    for bytes in [
        file(b"NanoVDB2", &[&one, &two, &two], 1),
        [two.bytes(), one.bytes(), two.bytes()].concat(),
    ] {
        std::fs::write(&path, bytes).unwrap();
        assert_eq!(Volume::open_grid(&path, "density").unwrap(), read(&one.bytes()).unwrap());
        let said = |name| Volume::open_grid(&path, name).unwrap_err().to_string();
        assert!(said("heat").contains("it has no grid \"heat\", only \""), "{}", said("heat"));
        assert!(said("ball").contains("several of its grids have the name \"ball\""));
    }
}

/// Reads what is damaged: an error or a volume, soon, and of no more samples than the rule for small files allows.
fn survives(bytes: &[u8]) {
    let begin = Instant::now();
    match read(bytes) {
        Ok(volume) => assert!(volume.samples().len() <= 1 << 24),
        // Debug assertions and other tests beside this one take their time too.
        Err(error) => {
            assert!(begin.elapsed() < Duration::from_secs(2), "{error}: {:?}", begin.elapsed())
        }
    }
}

#[test]
fn damaged_files_are_refused_or_read_without_panic() {
    let good = file(b"NanoVDB2", &[&Grid::small()], 0);
    let head = good.len() - Grid::small().bytes().len();
    // Every byte but those of tables, and of the masks of 32³ children; there with a step that is no entry's.
    let is_table = |at: usize| {
        let tables = [(UPPER + 64, LOWER), (LOWER + 1088 + 16, LEAVES)];
        tables.iter().any(|(begin, end)| (head + begin..head + end).contains(&at))
    };
    for at in (0..good.len()).filter(|at| !is_table(*at) || at % 601 == 0) {
        let mut bad = good.clone();
        bad[at] ^= if at % 2 == 0 { 0xff } else { 0x01 };
        survives(&bad);
    }
    let zipped = file(b"NanoVDB2", &[&Grid::small()], 1);
    for at in 0..zipped.len() {
        let mut bad = zipped.clone();
        bad[at] ^= 0xff;
        survives(&bad);
        assert!(read(&zipped[..at]).is_err(), "cut at {at}");
    }
    let cuts = (0..good.len())
        .filter(|at| *at < head + UPPER + 64 || *at > good.len() - 64 || at % 997 == 0);
    for at in cuts {
        assert!(read(&good[..at]).is_err(), "cut at {at}");
    }
    // Counts, sizes and places, made huge.
    for at in (0..head + UPPER).step_by(4) {
        let mut bad = good.clone();
        for length in [4, 8] {
            bad[at..at + length].fill(0xff);
            survives(&bad);
            bad[at + length - 1] = 0x7f;
            survives(&bad);
        }
    }
}

#[test]
fn trees_that_meet_themselves_and_bombs_end_soon() {
    // Each entry of the upper node leads to the same lower node, whose entries all lead to the same leaf.
    let mut bytes = Grid::small().bytes();
    for (node, log, table, child) in [(UPPER, 5, 8256, LOWER), (LOWER, 4, 1088, LEAVES)] {
        let count = 1_usize << (3 * log);
        bytes[node + 32 + count / 8..node + 32 + count / 4].fill(0xff);
        for i in 0..count {
            put(&mut bytes, node + table + 8 * i, &((child - node) as u64).to_le_bytes());
        }
    }
    assert!(said(&bytes).contains("more than its"));
    survives(&bytes);
    // A few bytes that unpack to many zeros.
    let bomb = zip(&vec![0; 1 << 26]);
    let mut bytes = file(b"NanoVDB2", &[&Grid::small()], 1);
    let begin = bytes.len() - zip(&Grid::small().bytes()).len();
    bytes.truncate(begin);
    put(&mut bytes, 16, &(1_u64 << 26).to_le_bytes());
    put(&mut bytes, 24, &(bomb.len() as u64).to_le_bytes());
    bytes.extend(bomb);
    assert!(said(&bytes).contains("write it without `--zip`"));
    survives(&bytes);
}
