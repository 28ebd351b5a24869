// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The points at which fields are asked, in every shape they are asked in.

use palpate::field::scalar::Model;
use palpate::field::{BLOCK, Block, Shape, Vector};

use crate::random::Random;

/// Points of a slice.
pub(crate) const SLICE: usize = 65_536;

/// Points asked one at a time.
pub(crate) const SINGLE: usize = 1024;

/// Clusters of [`BLOCK`] points.
pub(crate) const CLUSTERS: usize = 64;

/// The radius of a cluster [m].
const CLUSTER_RADIUS: f64 = 0.02;

/// Half the side of the cells that models bound [m].
const CELL: f64 = 0.05;

/// The smallest cells next to a surface, as a share of the largest.
const SMALLEST: f64 = 1e-3;

/// Steps to the surface.
const STEPS: usize = 4;

/// Scattered and clustered points in `D` dimensions.
pub(crate) struct Points<const D: usize> {
    /// Points in single precision, so that all ask at the same places.
    pub(crate) scattered: Vec<Vector<f32, D>>,
    pub(crate) clustered: Vec<Vector<f32, D>>,
}

impl<const D: usize> Points<D> {
    pub(crate) fn new(half: f64) -> Self {
        let mut random = Random::new(7);
        let scattered = (0..SLICE).map(|_| single(random.point([0.0; D], half))).collect();
        let mut clustered = Vec::with_capacity(CLUSTERS * BLOCK);
        for _ in 0..CLUSTERS {
            let centre: [f64; D] = random.point([0.0; D], half);
            clustered.extend((0..BLOCK).map(|_| single(in_ball(&mut random, centre))));
        }
        Self { scattered, clustered }
    }

    /// Blocks of `points`.
    pub(crate) fn blocks(points: &[Vector<f32, D>]) -> Vec<Block<f64, D>> {
        points
            .chunks(BLOCK)
            .map(|points| {
                let mut block = Block::zero();
                for (i, p) in points.iter().enumerate() {
                    block.set(i, Vector(p.0.map(f64::from)));
                }
                block
            })
            .collect()
    }

    /// Blocks of cells about `points`.
    pub(crate) fn cells(points: &[Vector<f32, D>]) -> Vec<Block<Model, D, BLOCK>> {
        points
            .chunks(BLOCK)
            .map(|points| {
                let mut block = Block::zero();
                for (i, p) in points.iter().enumerate() {
                    block.set(i, Vector(Model::cell(p.0.map(f64::from), [CELL; D])));
                }
                block
            })
            .collect()
    }

    /// Blocks of cells as a search has them: boxes about points of the surface, each halved along
    /// all its sides; from cells as large as the body down to [`SMALLEST`], those of a block all
    /// of one size.
    pub(crate) fn cells_at_surface(
        &self,
        shape: &Shape<D>,
        half: f64,
    ) -> Vec<Block<Model, D, BLOCK>> {
        let blocks = SINGLE / BLOCK;
        let mut random = Random::new(11);
        let block_of = |(i, points): (usize, &[Vector<f32, D>])| {
            let side = half * SMALLEST.powf(i as f64 / (blocks - 1) as f64);
            let mut boxes = points.iter().map(|p| {
                let mut p = Vector(p.0.map(f64::from));
                for _ in 0..STEPS {
                    let (distance, gradient) = shape.distance_gradient(p);
                    p -= gradient * distance;
                }
                random.point(p.0, side)
            });
            let mut block = Block::zero();
            let mut centre = [0.0; D];
            for i in 0..BLOCK {
                let part = i % (1 << D);
                if part == 0 {
                    centre = boxes.next().unwrap_or(centre);
                }
                let side_of = |k: usize| if part >> k & 1 == 0 { -side } else { side };
                let part = std::array::from_fn(|k| centre[k] + side_of(k));
                block.set(i, Vector(Model::cell(part, [side; D])));
            }
            block
        };
        let chunks = self.scattered[..SINGLE].chunks(BLOCK).enumerate();
        chunks.map(block_of).collect()
    }

    /// One array a coordinate, those past `D` zero.
    pub(crate) fn columns(points: &[Vector<f32, D>]) -> [Vec<f32>; 3] {
        let column =
            |k: usize| points.iter().map(|p| p.0.get(k).copied().unwrap_or(0.0)).collect();
        [column(0), column(1), column(2)]
    }
}

fn single<const D: usize>(p: [f64; D]) -> Vector<f32, D> {
    Vector(p.map(|x| x as f32))
}

/// A point of the ball of [`CLUSTER_RADIUS`] about `centre`.
fn in_ball<const D: usize>(random: &mut Random, centre: [f64; D]) -> [f64; D] {
    loop {
        let p = random.point(centre, CLUSTER_RADIUS);
        let from_centre = Vector(p) - Vector(centre);
        if from_centre.norm() <= CLUSTER_RADIUS {
            return p;
        }
    }
}
