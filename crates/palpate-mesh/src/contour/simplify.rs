// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Fewer triangles within the same tolerance: edges are collapsed as long as the new triangles are proven to be within
//! it, and so is each vertex that is gone.

use std::ops::ControlFlow;

use palpate_field::{Point, Vector};

use super::ContourError;
use super::deviation::Search;
use super::refine::Target;
use super::surface::{Edge, Surface};
use crate::solid::{across, foot};

/// A triangle turns by at most 60° in a collapse.
const LEAST_COSINE: f64 = 0.5;

/// Triangles have at least this height over their longest edge, unless those before had less.
const ROUND: f64 = 0.02;

/// Vertices from one look at whether to stop to the next.
const A_LOOK: usize = 256;

impl Target<'_> {
    /// Collapses edges until none can be. The surface must be within the tolerance.
    pub(super) fn simplify(
        &self,
        surface: &mut Surface,
        progress: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> Result<(), ContourError> {
        let mut search = Search::new(self.shape);
        // How far what a face stands for may be from it [m]: vertices that are gone.
        let mut hidden =
            Hidden(vec![0.0; surface.faces().max().map_or(0, |last| last as usize + 1)]);
        let mut candidates: Vec<u32> = (0..surface.vertices()).collect();
        let mut is_candidate = vec![true; candidates.len()];
        while !candidates.is_empty() {
            // Neighbours of a vertex that is gone wait for the next round, or few vertices would get all edges.
            let mut waits = vec![false; is_candidate.len()];
            let mut next = Vec::new();
            for (number, &vertex) in candidates.iter().enumerate() {
                if number.is_multiple_of(A_LOOK) && progress().is_break() {
                    return Err(ContourError::Stopped);
                }
                if waits[vertex as usize] {
                    next.push(vertex);
                    continue;
                }
                is_candidate[vertex as usize] = false;
                let Some(edge) = self.collapse_of(surface, vertex, &hidden, &mut search) else {
                    continue;
                };
                let ring = surface.beside(vertex);
                hidden.collapse(surface, &edge);
                surface.collapse(&edge);
                for vertex in ring {
                    waits[vertex as usize] = true;
                    if !std::mem::replace(&mut is_candidate[vertex as usize], true) {
                        next.push(vertex);
                    }
                }
            }
            candidates = next;
        }
        Ok(())
    }

    /// The edge from a vertex that leaves the roundest triangles when it is collapsed, and all within the tolerance.
    fn collapse_of(
        &self,
        surface: &Surface,
        vertex: u32,
        hidden: &Hidden,
        search: &mut Search<'_>,
    ) -> Option<Edge> {
        let fan = surface.fan(vertex);
        let before: Vec<_> = fan.iter().filter_map(|face| surface.triangle(*face)).collect();
        let least = before.iter().map(roundness).fold(ROUND, f64::min);
        let place = surface.place(vertex);
        let mut ways: Vec<_> = surface
            .beside(vertex)
            .into_iter()
            .filter_map(|into| {
                let edge = surface.edge([vertex, into])?;
                let after = fan_after(surface, &edge);
                let turned = after.iter().all(|(old, new)| {
                    let [old, new] = [old, new].map(across);
                    new.dot(old) >= LEAST_COSINE * new.norm() * old.norm()
                });
                let after: Vec<_> = after.into_iter().map(|(_, new)| new).collect();
                let round = after.iter().map(roundness).fold(f64::INFINITY, f64::min);
                (turned && round >= least && !after.is_empty()).then_some((round, edge, after))
            })
            .collect();
        ways.sort_by(|a, b| b.0.total_cmp(&a.0));
        ways.into_iter().find_map(|(_, edge, after)| {
            let away =
                after.iter().map(|new| foot(new, place).squared).fold(f64::INFINITY, f64::min);
            let is_near = away.sqrt() + hidden.around(surface, vertex) <= self.tolerance;
            let may_be = is_near
                && surface.can_collapse(&edge)
                && after
                    .iter()
                    .all(|new| !self.is_folded(new) && self.error(new) <= self.tolerance)
                && search.are_within(&after, self.tolerance).into_iter().all(|is| is);
            may_be.then_some(edge)
        })
    }
}

/// The triangles that stay around the first end of an edge, before and after it is collapsed.
fn fan_after(surface: &Surface, edge: &Edge) -> Vec<([Point<3>; 3], [Point<3>; 3])> {
    let [from, into] = edge.ends;
    let stay = surface.fan(from).iter().filter(|face| !edge.faces.contains(face));
    stay.filter_map(|face| {
        let corners = surface.corners(*face)?;
        let moved = corners.map(|corner| if corner == from { into } else { corner });
        Some([corners, moved].map(|corners| corners.map(|corner| surface.place(corner))).into())
    })
    .collect()
}

/// The height of a triangle over its longest edge, as a share of that: at most √3/2.
fn roundness(corners: &[Point<3>; 3]) -> f64 {
    let [a, b, c] = *corners;
    let longest = [b - a, c - b, a - c].map(|edge: Vector<f64, 3>| edge.dot(edge));
    let longest = longest.into_iter().fold(0.0, f64::max);
    if longest > 0.0 { across(corners).norm() / longest } else { 0.0 }
}

/// How far what each face stands for may be from it [m].
struct Hidden(Vec<f64>);

impl Hidden {
    /// The largest of the faces around a vertex [m].
    fn around(&self, surface: &Surface, vertex: u32) -> f64 {
        surface.fan(vertex).iter().map(|face| self.0[*face as usize]).fold(0.0, f64::max)
    }

    /// Takes what goes when an edge is about to be collapsed.
    fn collapse(&mut self, surface: &Surface, edge: &Edge) {
        let [vertex, _] = edge.ends;
        let place = surface.place(vertex);
        let after = fan_after(surface, edge);
        let away =
            after.iter().map(|(_, new)| foot(new, place).squared).fold(f64::INFINITY, f64::min);
        let hidden = self.around(surface, vertex) + away.sqrt();
        for face in surface.fan(vertex) {
            self.0[*face as usize] = hidden;
        }
    }
}
