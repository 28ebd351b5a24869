// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Grids as files: what was saved is read, and what is damaged is refused.
use palpate_field::{CustomField, Shape, Vector};
use palpate_grid::{Grid, GridFileProblem, GridKernel, GridOptions, Store};
use palpate_testkit::arbitrary::within;
use palpate_testkit::cases;

fn grids() -> Vec<Grid<3>> {
    let shape = Shape::torus(0.3, 0.1).unwrap();
    let mut grids = Vec::new();
    for kernel in [GridKernel::Quadratic, GridKernel::Trilinear] {
        for store in [Store::F32, Store::I16, Store::I8] {
            for band in [None, Some(5.0)] {
                let mut options = GridOptions { kernel, store, ..GridOptions::with_cell(0.04) };
                options.band = band;
                grids.push(Grid::bake(&shape, &options).unwrap());
            }
        }
    }
    grids
}

#[test]
fn what_was_saved_is_read_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("torus.grid");
    for grid in grids() {
        grid.save(&path).unwrap();
        let again = Grid::<3>::open(&path).unwrap();
        assert_eq!(again.promise(), grid.promise());
        assert_eq!((again.lattice(), again.store()), (grid.lattice(), grid.store()));
        cases::check(200, |u| {
            let mut p = Vector([0.0; 3]);
            for x in &mut p.0 {
                *x = within(u, -0.4, 0.4)?;
            }
            assert_eq!(again.distance_gradient(p), grid.distance_gradient(p));
            Ok(Ok(()))
        });
    }
    // Nothing else is left in the folder.
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
#[ignore = "slow: cargo xtask test --thorough"]
fn what_is_damaged_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("torus.grid");
    for grid in grids() {
        grid.save(&path).unwrap();
        let good = std::fs::read(&path).unwrap();
        assert!(Grid::<3>::from_bytes(&good).is_ok());
        cases::check(40, |u| {
            let mut bad = good.clone();
            match u.int_in_range(0..=2)? {
                0 => bad.truncate(u.int_in_range(0..=good.len() - 1)?),
                1 => bad.push(0),
                _ => {
                    let at = u.int_in_range(0..=good.len() - 1)?;
                    bad[at] ^= 1 << u.int_in_range(0..=7)?;
                }
            }
            assert!(Grid::<3>::from_bytes(&bad).is_err());
            Ok(Ok(()))
        });
    }
    assert!(matches!(Grid::<3>::from_bytes(b"solid"), Err(GridFileProblem::OtherFormat)));
    hostile();
    let disc = Grid::bake(&Shape::circle(0.3).unwrap(), &GridOptions::with_cell(0.02)).unwrap();
    disc.save(&path).unwrap();
    let error = Grid::<3>::open(&path).unwrap_err();
    assert!(error.to_string().ends_with("torus.grid: it is a grid in 2D, wanted one in 3D"));
    let error = Grid::<3>::open(folder.path()).unwrap_err();
    assert!(matches!(error.problem, GridFileProblem::NoFile));
    assert!(disc.save(folder.path().join("no folder").join("disc.grid")).is_err());
}

/// Files whose sum is right, and whose head is not: they are refused, or make a grid that keeps its promise.
fn hostile() {
    let good = grids().swap_remove(1);
    let mut bytes = Vec::new();
    good.write(&mut bytes).unwrap();
    let text = bytes.len() - blake3::OUT_LEN;
    let summed = |mut bytes: Vec<u8>| {
        let sum = blake3::hash(&bytes[..text]);
        bytes[text..].copy_from_slice(sum.as_bytes());
        bytes
    };
    assert!(Grid::<3>::from_bytes(&summed(bytes.clone())).is_ok());
    // The eight bytes of each number of the head: cell, scale, band, deviation, within, counts and places.
    for number in 0..5 + 3 * 4 {
        for wrong in [0.0, -1.0, 1e300, f64::NAN, f64::INFINITY] {
            let mut bad = bytes.clone();
            let place = 12 + 8 * number;
            bad[place..place + 8].copy_from_slice(&wrong.to_le_bytes());
            if let Ok(grid) = Grid::<3>::from_bytes(&summed(bad)) {
                assert!(grid.promise().lipschitz.is_finite());
            }
        }
    }
    cases::check(150, |u| {
        let mut bad = bytes.clone();
        for _ in 0..u.int_in_range(1..=4)? {
            let at = u.int_in_range(8..=text.min(2000) - 1)?;
            bad[at] = u.arbitrary()?;
        }
        let Ok(grid) = Grid::<3>::from_bytes(&summed(bad)) else { return Ok(Ok(())) };
        let promise = grid.promise();
        for _ in 0..20 {
            let mut ends = [Vector([0.0; 3]); 2];
            for x in ends.iter_mut().flat_map(|end| &mut end.0) {
                *x = within(u, -0.5, 0.5)?;
            }
            let [p, q] = ends;
            let change = (grid.distance(p) - grid.distance(q)).abs();
            let room = 2.0 * promise.rounding.within(2.0);
            assert!(change <= promise.lipschitz * (p - q).norm() + room);
        }
        Ok(Ok(()))
    });
}
