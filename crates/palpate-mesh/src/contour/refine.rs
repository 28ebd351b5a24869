// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A surface brought within a tolerance of a shape: vertices move onto edges and corners of the shape, edges that are too
//! far from it are split there, and pairs of triangles take the diagonal that is nearer to it.

use std::ops::ControlFlow;

use palpate_field::{Point, Shape};

use super::deviation::Search;
use super::sharp::{landed, sharp};
use super::surface::{Edge, Surface};
use super::{ContourError, FLAT};
use crate::mesh::single;
use crate::report::is_flat;
use crate::solid::across;

/// Rounds of splits at most.
const ROUNDS: usize = 40;

/// After so many rounds the errors of all open faces must sum to at most this share. Else smaller cells are needed.
const PATIENCE: usize = 6;
const FALL: f64 = 0.7;

/// A vertex whose field is at most this share of the tolerance stays where it is.
const STAYS: f64 = 0.05;

/// Flips after one split at most.
const MOST_FLIPS: usize = 24;

/// A flip makes the error at most this share of what it was.
const GAIN: f64 = 0.9;

/// A new vertex is at least this share of the edge from its ends.
const INSET: f64 = 0.05;

/// An edge of the shape may lie between two vertices if the cosine between their slopes is less than this.
const EVEN: f64 = 0.9;

/// A triangle is folded over if the cosine between its normal and the slope of the field is less than this.
const LEAST_COSINE: f64 = -0.3;

/// Two faces overlap if the cosine between their normals is less than this.
const FOLDS_BACK: f64 = -0.7;

/// Edges of the shape are looked for around a vertex at this share of the way to the nearest other.
const LOOKS_AROUND: f64 = 0.3;

/// Where an edge is split.
enum On {
    /// At this place.
    Edge(Point<3>),
    /// Not at all: this place is so near to one of its ends that the end moves there.
    End(u32, Point<3>),
}

/// What a surface is made to fit.
#[derive(Clone, Copy)]
pub(super) struct Target<'a> {
    pub(super) shape: &'a Shape<3>,
    /// The largest size of the field on a triangle [m].
    pub(super) tolerance: f64,
    /// Whether vertices are in single precision.
    pub(super) is_single: bool,
    /// More triangles than these are refused.
    pub(super) most_triangles: usize,
}

impl Target<'_> {
    /// Brings a surface within the tolerance, which is then proven; `false` if rounds of splits do not.
    pub(super) fn refine(
        &self,
        surface: &mut Surface,
        progress: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> Result<bool, ContourError> {
        let mut search = Search::new(self.shape);
        let mut pending: Vec<u32> = surface.faces().collect();
        let all: Vec<_> = pending.iter().filter_map(|face| surface.triangle(*face)).collect();
        if search.are_within(&all, self.tolerance).into_iter().all(|is| is) {
            return Ok(true);
        }
        self.sharpen(surface);
        let mut errors = Vec::new();
        for _ in 0..ROUNDS {
            let faces: Vec<_> = pending
                .iter()
                .filter_map(|face| surface.triangle(*face).map(|corners| (*face, corners)))
                .collect();
            let corners: Vec<_> = faces.iter().map(|(_, corners)| *corners).collect();
            let are_within = search.are_within(&corners, self.tolerance);
            let open: Vec<_> = faces.iter().zip(are_within).filter(|(_, is)| !is).collect();
            if open.is_empty() {
                pending = self.unfold(surface);
                if pending.is_empty() {
                    return Ok(true);
                }
                continue;
            }
            let error = open.iter().map(|((_, corners), _)| self.error(corners)).sum::<f64>();
            errors.push(error);
            if errors.len() > PATIENCE && error > FALL * errors[errors.len() - 1 - PATIENCE] {
                return Ok(false);
            }
            pending.clear();
            for ((face, corners), _) in open {
                if progress().is_break() {
                    return Err(ContourError::Stopped);
                }
                if surface.triangle(*face) != Some(*corners) {
                    // A neighbour's split changed it.
                    pending.push(*face);
                    continue;
                }
                self.split(surface, *face, &mut pending);
                if surface.count() > self.most_triangles {
                    return Err(ContourError::TooManyTriangles { limit: self.most_triangles });
                }
            }
            pending.sort_unstable();
            pending.dedup();
        }
        Ok(false)
    }

    /// Moves vertices onto the surface, and those beside edges and corners of the shape onto these.
    fn sharpen(&self, surface: &mut Surface) {
        for vertex in 0..surface.vertices() {
            let place = surface.place(vertex);
            let off = self.off(place);
            if off > STAYS * self.tolerance {
                let sharp = sharp(self.shape, place, 2.0 * off);
                let landed = || landed(self.shape, place).map(|crossing| crossing.place);
                let mut places = [sharp, landed()].into_iter().flatten();
                places.any(|to| {
                    self.off(to) < off && self.moves(surface, vertex, to, f64::INFINITY)
                });
            }
        }
        let slope = |vertex: u32| self.shape.distance_gradient(surface.place(vertex)).1;
        let slopes: Vec<_> = (0..surface.vertices()).map(slope).collect();
        for vertex in 0..surface.vertices() {
            let (place, beside) = (surface.place(vertex), surface.beside(vertex));
            let turns = |other: &u32| {
                let [a, b] = [slopes[vertex as usize], slopes[*other as usize]];
                a.dot(b) < EVEN * a.norm() * b.norm()
            };
            if !beside.iter().any(turns) {
                continue;
            }
            let lengths = beside.iter().map(|other| (place - surface.place(*other)).norm());
            let reach = LOOKS_AROUND * lengths.fold(f64::INFINITY, f64::min);
            if let Some(to) = sharp(self.shape, place, reach) {
                self.moves(surface, vertex, to, f64::INFINITY);
            }
        }
    }

    /// Moves a vertex if the error of the faces around it becomes at most this share of what it was, and none folds over.
    fn moves(&self, surface: &mut Surface, vertex: u32, to: Point<3>, share: f64) -> bool {
        let place = surface.place(vertex);
        let state = |surface: &Surface| {
            let fan = surface.fan(vertex).iter().filter_map(|face| surface.triangle(*face));
            fan.fold((0, 0.0), |(folded, error), corners| {
                (folded + usize::from(self.is_folded(&corners)), error + self.error(&corners))
            })
        };
        let before = state(surface);
        surface.set_place(vertex, self.rounded(to));
        let after = state(surface);
        let may = after.0 <= before.0 && after.1 <= share * before.1;
        if !may {
            surface.set_place(vertex, place);
        }
        may
    }

    /// Splits the edge of a face that is farthest from the shape. The faces that changed are pending then.
    fn split(&self, surface: &mut Surface, face: u32, pending: &mut Vec<u32>) {
        let Some(corners) = surface.corners(face) else { return };
        for corner in corners {
            let place = surface.place(corner);
            if self.off(place) > 0.5 * self.tolerance
                && let Some(to) = landed(self.shape, place)
                && self.moves(surface, corner, to.place, f64::INFINITY)
            {
                pending.extend(surface.fan(corner));
                return;
            }
        }
        let ends = [0, 1, 2].map(|i| [corners[i], corners[(i + 1) % 3]]);
        let off = |[a, b]: [u32; 2]| self.off((surface.place(a) + surface.place(b)) * 0.5);
        let long = |[a, b]: [u32; 2]| (surface.place(a) - surface.place(b)).norm();
        let [farthest, longest] = [&off as &dyn Fn([u32; 2]) -> f64, &long].map(|size| {
            ends.into_iter().max_by(|a, b| size(*a).total_cmp(&size(*b))).unwrap_or(ends[0])
        });
        // Where all three edges are near the surface, the middle of the face is not.
        let ends = if off(farthest) > 0.5 * self.tolerance { farthest } else { longest };
        let Some(edge) = surface.edge(ends) else { return };
        let vertex = match self.place_on(surface, &edge) {
            On::Edge(place) => surface.split(&edge, place),
            On::End(end, place) if self.moves(surface, end, place, GAIN) => end,
            On::End(..) => surface.split(&edge, self.rounded(self.middle(surface, &edge))),
        };
        self.flip_around(surface, vertex, pending);
        pending.extend(surface.fan(vertex));
    }

    /// The place of the surface at which an edge is split: at an edge or a corner of the shape if there is one, else
    /// below the middle. No face may be folded over by it that was not.
    fn place_on(&self, surface: &Surface, edge: &Edge) -> On {
        let [a, b] = edge.ends.map(|end| surface.place(end));
        let (middle, length) = (self.middle(surface, edge), (b - a).norm());
        let reach = (2.0 * self.off(middle)).clamp(1e-3 * length, 0.5 * length);
        let sharp = sharp(self.shape, middle, reach);
        let landed = || landed(self.shape, middle).map(|crossing| crossing.place);
        let halves = |place: Point<3>| {
            let pairs = edge.apexes.into_iter().zip([[a, b], [b, a]]);
            pairs.flat_map(move |(apex, [from, to])| {
                let apex = surface.place(apex);
                [[from, place, apex], [place, to, apex]]
            })
        };
        let folded = |place| halves(place).filter(|half| self.is_folded(half)).count();
        let before = folded(middle);
        let is_between = |place: Point<3>| {
            let [from, to] = [a, b].map(|end| (place - end).norm());
            from.min(to) > INSET * length && from.max(to) < length
        };
        let landed = landed();
        for place in [sharp, landed].into_iter().flatten().map(|place| self.rounded(place)) {
            let ends = edge.ends.into_iter().zip([a, b]);
            if let Some((end, _)) = ends.min_by(|one, other| {
                (place - one.1).norm().total_cmp(&(place - other.1).norm())
            }) && (place - surface.place(end)).norm() <= INSET * length
            {
                return On::End(end, place);
            }
            if is_between(place) && folded(place) <= before {
                return On::Edge(place);
            }
        }
        // A vertex off the surface would never be within the tolerance; what folds over may be flipped.
        let landed = landed.map(|place| self.rounded(place)).filter(|place| is_between(*place));
        On::Edge(landed.unwrap_or_else(|| self.rounded(middle)))
    }

    fn middle(&self, surface: &Surface, edge: &Edge) -> Point<3> {
        let [a, b] = edge.ends.map(|end| surface.place(end));
        (a + b) * 0.5
    }

    /// Flips edges opposite to a vertex, and those that this puts opposite to it, where it brings the surface nearer to the
    /// shape.
    fn flip_around(&self, surface: &mut Surface, vertex: u32, pending: &mut Vec<u32>) {
        let opposite = |surface: &Surface, face: u32| {
            let corners = surface.corners(face)?;
            let at = corners.iter().position(|corner| *corner == vertex)?;
            surface.edge([corners[(at + 1) % 3], corners[(at + 2) % 3]])
        };
        let mut faces = surface.fan(vertex).to_vec();
        for _ in 0..MOST_FLIPS {
            let Some(face) = faces.pop() else { break };
            let Some(edge) = opposite(surface, face) else { continue };
            if self.gains(surface, &edge) && surface.flip(&edge) {
                pending.extend(edge.faces);
                faces.extend(edge.faces);
            }
        }
    }

    /// Flips edges whose faces lie on each other. The faces that changed are pending then.
    fn unfold(&self, surface: &mut Surface) -> Vec<u32> {
        let mut changed = Vec::new();
        for face in surface.faces().collect::<Vec<_>>() {
            for i in 0..3 {
                let Some(corners) = surface.corners(face) else { continue };
                let edge = surface.edge([corners[i], corners[(i + 1) % 3]]);
                let Some(edge) = edge.filter(|edge| edge.ends[0] < edge.ends[1]) else {
                    continue;
                };
                let [a, b, c, d] = [edge.ends, edge.apexes].concat()[..] else { continue };
                let halves =
                    [[a, b, c], [b, a, d]].map(|half| half.map(|end| surface.place(end)));
                if cosine(&halves) < FOLDS_BACK
                    && self.gains(surface, &edge)
                    && surface.flip(&edge)
                {
                    changed.extend(edge.faces);
                }
            }
        }
        changed
    }

    /// Whether the other diagonal of the two faces at an edge is nearer to the shape, or they lie on each other and would
    /// not; and it folds nothing over.
    fn gains(&self, surface: &Surface, edge: &Edge) -> bool {
        let [a, b] = edge.ends.map(|end| surface.place(end));
        let [c, d] = edge.apexes.map(|apex| surface.place(apex));
        let error = |halves: &[[Point<3>; 3]; 2], [from, to]: [Point<3>; 2]| {
            let middles = halves.iter().map(|[p, q, r]| (*p + *q + *r) * (1.0 / 3.0));
            middles.chain([(from + to) * 0.5]).map(|p| self.off(p)).fold(0.0, f64::max)
        };
        let (old, new) = ([[a, b, c], [b, a, d]], [[a, d, c], [d, b, c]]);
        let [now, then] = [error(&old, [a, b]), error(&new, [c, d])];
        if cosine(&old) < FOLDS_BACK
            && cosine(&new) > 0.0
            && then <= now.max(0.5 * self.tolerance)
        {
            return true;
        }
        if now <= STAYS * self.tolerance || then >= GAIN * now {
            return false;
        }
        let folded = |halves: &[[Point<3>; 3]; 2]| {
            halves.iter().filter(|half| self.is_folded(half)).count()
        };
        folded(&new) <= folded(&old)
    }

    /// Whether a triangle is flat, or faces the inside. It may stand on the surface like a fin: a vertex on an edge of the
    /// shape leaves such triangles until others are split or flipped.
    pub(super) fn is_folded(&self, corners: &[Point<3>; 3]) -> bool {
        let [a, b, c] = *corners;
        let (_, slope) = self.shape.distance_gradient((a + b + c) * (1.0 / 3.0));
        // Written so that NaN is folded.
        let across = across(corners);
        let is_out = across.dot(slope) > LEAST_COSINE * across.norm() * slope.norm();
        !is_out || is_flat(corners, FLAT)
    }

    /// The largest size of the field at the middles of a triangle and of its sides [m].
    pub(super) fn error(&self, [a, b, c]: &[Point<3>; 3]) -> f64 {
        let middles = [(*a + *b) * 0.5, (*b + *c) * 0.5, (*c + *a) * 0.5];
        let all = middles.into_iter().chain([(*a + *b + *c) * (1.0 / 3.0)]);
        all.map(|p| self.off(p)).fold(0.0, f64::max)
    }

    fn off(&self, p: Point<3>) -> f64 {
        self.shape.distance(p).abs()
    }

    fn rounded(&self, place: Point<3>) -> Point<3> {
        if self.is_single { single(place) } else { place }
    }
}

/// The cosine between the normals of two triangles; 1 if one has none.
fn cosine(halves: &[[Point<3>; 3]; 2]) -> f64 {
    let [a, b] = [0, 1].map(|i| across(&halves[i]).normalized());
    a.zip(b).map_or(1.0, |(a, b)| a.dot(b))
}
