// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The memory of a query, allocated when it is first needed.

use super::Query;
use crate::ball::BallWorkspace;
use crate::mesh::MeshWorkspace;
use crate::pair::PairWorkspace;
use crate::sweep::{ElementSweep, SweepWorkspace};

/// The workspaces of a query.
#[derive(Debug)]
pub(super) struct Scratch<const D: usize> {
    pair: Option<Box<PairWorkspace<D>>>,
    sweep: Option<Box<SweepWorkspace<D>>>,
    ball: Option<Box<BallWorkspace<D>>>,
    segments: Option<Box<MeshWorkspace<2, D>>>,
    triangles: Option<Box<MeshWorkspace<3, D>>>,
    moving_segments: Option<Box<ElementSweep<2, D>>>,
    moving_triangles: Option<Box<ElementSweep<3, D>>>,
}

impl<const D: usize> Scratch<D> {
    pub(super) fn new() -> Self {
        Self {
            pair: None,
            sweep: None,
            ball: None,
            segments: None,
            triangles: None,
            moving_segments: None,
            moving_triangles: None,
        }
    }

    pub(super) fn pair(&mut self) -> &mut PairWorkspace<D> {
        self.pair.get_or_insert_default()
    }

    pub(super) fn sweep(&mut self) -> &mut SweepWorkspace<D> {
        self.sweep.get_or_insert_default()
    }

    pub(super) fn ball(&mut self) -> &mut BallWorkspace<D> {
        self.ball.get_or_insert_default()
    }
}

/// Memory for elements of `N` points: there are segments (2) and triangles (3). A bound of
/// the methods of [`Query`], to be named where code is generic in `N`.
pub trait ElementMemory<const N: usize, const D: usize> {
    /// The memory for these elements and for meshes of them.
    fn elements(&mut self) -> &mut MeshWorkspace<N, D>;

    /// The memory for these elements and for meshes of them while they move.
    fn moving_elements(&mut self) -> &mut ElementSweep<N, D>;
}

impl<const D: usize> ElementMemory<2, D> for Query<D> {
    fn elements(&mut self) -> &mut MeshWorkspace<2, D> {
        self.scratch.segments.get_or_insert_default()
    }

    fn moving_elements(&mut self) -> &mut ElementSweep<2, D> {
        self.scratch.moving_segments.get_or_insert_default()
    }
}

impl<const D: usize> ElementMemory<3, D> for Query<D> {
    fn elements(&mut self) -> &mut MeshWorkspace<3, D> {
        self.scratch.triangles.get_or_insert_default()
    }

    fn moving_elements(&mut self) -> &mut ElementSweep<3, D> {
        self.scratch.moving_triangles.get_or_insert_default()
    }
}
