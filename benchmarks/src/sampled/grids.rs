// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Values and gradients of grids, and their baking.

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use palpate::field::kernel::Ball;
use palpate::field::{BLOCK, Block, Column, CustomField as _, Point, Shape, Vector};
use palpate::grid::{Grid, GridKernel, GridOptions};
use palpate::mesh::{Solid, TriangleMesh};
use rayon::iter::{IntoParallelRefIterator as _, ParallelIterator as _};

use super::places::places;
use super::{QUESTIONS, compare, longest};
use crate::fields::Rows;
use crate::reference::Reference;
use crate::rounds::{self, Subject};

/// Cells along the longest side of the mesh.
pub(super) const CELLS: f64 = 128.0;

/// How much the last answer moves the next question, so that they cannot overlap.
const NUDGE: f64 = 1e-30;

pub(super) fn measure(
    mesh: &TriangleMesh,
    reference: &Reference,
    rows: &mut Rows,
) -> Result<(), Box<dyn Error>> {
    let (solid, _) = Solid::from_mesh(mesh)?;
    let solid: Shape<3> = solid.into();
    let options = GridOptions::with_cell(longest(mesh) / CELLS);
    let trilinear =
        Grid::bake(&solid, &GridOptions { kernel: GridKernel::Trilinear, ..options.clone() })?;
    let plain = Plain::of(&trilinear);
    let quadratic: Shape<3> = Grid::bake(&solid, &options)?.into();
    let trilinear: Shape<3> = trilinear.into();
    let ball = Shape::from_kernel(Ball::new(0.5)?);
    let [near, _, _, path] = places(mesh).map(|(_, points)| points);
    let blocks: Vec<Block<f64, 3, BLOCK>> = near
        .chunks(BLOCK)
        .map(|points| {
            let mut block = Block::zero();
            block.fill(points.len(), |i| points[i]);
            block
        })
        .collect();
    let mut column = Column::<f64, BLOCK>::zero();
    let mut subjects = vec![
        Subject::new("grid.quadratic.gradient.path", QUESTIONS, || {
            gradients(&quadratic, &path)
        }),
        Subject::new("grid.quadratic.gradient.random", QUESTIONS, || {
            gradients(&quadratic, &near)
        }),
        Subject::new("grid.ball.value.path", QUESTIONS, || values(&ball, &path)),
        Subject::new("grid.ball.value.random", QUESTIONS, || values(&ball, &near)),
        Subject::new("grid.trilinear.64", QUESTIONS, || {
            let mut sum = 0.0;
            for block in &blocks {
                trilinear.block_distances(block, BLOCK, &mut column);
                sum += column.get(0);
            }
            sum
        }),
        Subject::new("grid.trilinear.loop", QUESTIONS, || {
            near.iter().map(|p| plain.value(*p)).sum()
        }),
    ];
    for measured in rounds::measure(&mut subjects, reference) {
        measured.insert(rows);
    }
    for (key, over, beside) in [
        ("quadratic.gradient.path", "ball.value.path", "over_ball"),
        ("quadratic.gradient.random", "ball.value.random", "over_ball"),
        ("trilinear.64", "trilinear.loop", "over_loop"),
    ] {
        let [ours, other] = [key, over].map(|key| format!("grid.{key}.ns"));
        compare(rows, [&ours, &other], &format!("grid.{key}.{beside}"));
    }
    let start = Instant::now();
    let banded =
        Grid::bake(&solid, &GridOptions { band: Some(GridOptions::SMALLEST_BAND), ..options })?;
    let baked = start.elapsed().as_nanos() as f64;
    // What is baked without what is certified: the samples within the band, with as many threads.
    let near: Vec<_> = plain.near(GridOptions::SMALLEST_BAND).collect();
    let start = Instant::now();
    black_box(near.par_iter().map(|p| solid.distance(*p)).sum::<f64>());
    let sampled = start.elapsed().as_nanos() as f64;
    rows.insert("grid.bake.band.ns".to_owned(), baked);
    rows.insert("grid.bake.samples.ns".to_owned(), sampled);
    rows.insert("grid.bake.band.over_samples".to_owned(), baked / sampled);
    rows.insert(
        "grid.bake.band.deviation_cells".to_owned(),
        banded.deviation() / banded.lattice().cell,
    );
    Ok(())
}

/// The gradients at points, one after another.
fn gradients(shape: &Shape<3>, points: &[Point<3>]) -> f64 {
    let mut last = 0.0;
    for p in points {
        let nudged = *p + Vector([NUDGE * last, 0.0, 0.0]);
        let (value, gradient) = shape.distance_gradient(nudged);
        last = value + gradient[0];
    }
    last
}

/// The values at points, one after another.
fn values(shape: &Shape<3>, points: &[Point<3>]) -> f64 {
    points.iter().fold(0.0, |last, p| shape.distance(*p + Vector([NUDGE * last, 0.0, 0.0])))
}

/// Samples, interpolated by a plain loop.
struct Plain {
    samples: Vec<f32>,
    counts: [usize; 3],
    origin: Point<3>,
    cell: f64,
}

impl Plain {
    fn of(grid: &Grid<3>) -> Self {
        let lattice = *grid.lattice();
        let [nx, ny, nz] = lattice.counts;
        let mut samples = Vec::with_capacity(nx * ny * nz);
        for z in 0..nz {
            for y in 0..ny {
                for x in 0..nx {
                    samples.push(grid.distance(lattice.node([x, y, z])) as f32);
                }
            }
        }
        let (counts, origin, cell) = (lattice.counts, lattice.origin, lattice.cell);
        Self { samples, counts, origin, cell }
    }

    fn value(&self, p: Point<3>) -> f64 {
        let [nx, ny, _] = self.counts;
        let at = (p - self.origin) * (1.0 / self.cell);
        let first: [usize; 3] =
            std::array::from_fn(|i| (at[i].max(0.0) as usize).min(self.counts[i] - 2));
        let t: [f64; 3] = std::array::from_fn(|i| at[i] - first[i] as f64);
        let mut sum = 0.0;
        for corner in 0..8 {
            let bit = |i: usize| (corner >> i) & 1;
            let [x, y, z] = std::array::from_fn(|i| first[i] + bit(i));
            let weight = |i: usize| if bit(i) == 1 { t[i] } else { 1.0 - t[i] };
            let sample = self.samples[x + nx * (y + ny * z)];
            sum += f64::from(sample) * weight(0) * weight(1) * weight(2);
        }
        sum
    }

    /// The nodes within so many cells of the surface.
    fn near(&self, cells: f64) -> impl Iterator<Item = Point<3>> {
        let [nx, ny, _] = self.counts;
        let band = (cells * self.cell) as f32;
        self.samples.iter().enumerate().filter(move |(_, sample)| sample.abs() <= band).map(
            move |(number, _)| {
                let index = [number % nx, number / nx % ny, number / (nx * ny)];
                self.origin + Vector(index.map(|i| i as f64)) * self.cell
            },
        )
    }
}
