// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies of data: S3 as a grid and as a mesh, against S3.

use std::error::Error;

use palpate::field::Shape;
use palpate::grid::{Grid, GridKernel, GridOptions};
use palpate::mesh::{ContourOptions, Solid, TriangleMesh};
use palpate::query::separation;

use super::TimedRows;
use super::pairs::{ask, placed};
use crate::fields::Rows;
use crate::scenes;

/// Cells along the longest side.
const CELLS: f64 = 128.0;

/// The tolerance of the separation [m].
const TOLERANCE: f64 = 1e-3;

/// How far apart the bodies are [m].
const GAP: f64 = 5e-3;

/// The row that the others are over.
const FORMULA: &str = "sampled.separation.S3_S3";

pub(super) fn measure(rows: &mut TimedRows) -> Result<(), Box<dyn Error>> {
    let s3 = scenes::s3()?.shape;
    let bounds = s3.promise().bounds.ok_or("S3 has no bounds")?.aabb;
    let cell = bounds.half_extents().0.into_iter().fold(0.0, f64::max) * 2.0 / CELLS;
    let baked =
        |kernel| Grid::bake(&s3, &GridOptions { kernel, ..GridOptions::with_cell(cell) });
    let mesh = TriangleMesh::of_shape(&s3, &ContourOptions::with_cell(2.0 * cell))?;
    let bodies: [(&str, Shape<3>); 4] = [
        ("S3", s3.clone()),
        ("trilinear", baked(GridKernel::Trilinear)?.into()),
        ("quadratic", baked(GridKernel::Quadratic)?.into()),
        ("mesh", Solid::from_mesh(&mesh)?.0.into()),
    ];
    // A grid and a mesh of S3 are where S3 is, nearly.
    let pairs = placed([&s3, &s3], GAP)?;
    for (name, body) in &bodies {
        let key = format!("sampled.separation.{name}_S3");
        let pairs: Vec<_> = pairs.iter().map(|[_, other]| [body.into(), *other]).collect();
        ask(&key, separation, TOLERANCE, &pairs, rows)?;
    }
    Ok(())
}

/// Adds what the searches of data take over that of the formula.
pub(super) fn compare(rows: &mut Rows) {
    let Some(formula) = rows.get(&format!("{FORMULA}.p50_ns")).copied() else { return };
    for name in ["trilinear", "quadratic", "mesh"] {
        let key = format!("sampled.separation.{name}_S3");
        if let Some(time) = rows.get(&format!("{key}.p50_ns")).copied() {
            rows.insert(format!("{key}.over_formula"), time / formula);
        }
    }
}
