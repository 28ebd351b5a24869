// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Patches of contact, and the few points that span each.

use palpate_field::{Point, Vector};

use super::grid::{Grid, distance};
use super::region::{Towards, towards};
use super::{ManifoldSettings, Member, Touch};
use crate::goal::Goal;
use crate::pair::body_pair::BodyPair;
use crate::pair::descent::descend;

/// Candidates nearer than this many spacings are neighbours.
const NEIGHBOURS: f64 = 2.0;

/// The cosine of how far normals of a patch may be from that of its first, 25°.
const ALIKE: f64 = 0.906;

/// Candidates next to a patch that are less deep by more than this share of
/// [`ManifoldSettings::precision_length`] are its slope, and no patch of their own.
const SLOPE: f64 = 0.1;

/// The precision of the deepest point of a patch, as a share of the same length.
const PRECISE: f64 = 1e-3;

/// Patches smaller than this many spacings are one contact, as are corners.
const SMALL: f64 = 1.5;

/// A patch reaches no farther than so many spacings beyond the sides between its corners.
const BEYOND: f64 = 2.0;

/// A corner is moved by at most so many spacings.
const FAR: f64 = 4.0;

/// The last step of a corner, as a share of the spacing.
const SHARP: f64 = 0.06;

/// Candidates and what they are candidates of.
pub(super) struct Patches<'a, 'b, const D: usize> {
    pub(super) pair: BodyPair<'a, D>,
    pub(super) settings: &'b ManifoldSettings,
    /// The certified best point is among them.
    pub(super) candidates: &'b [Touch<D>],
}

impl<const D: usize> Patches<'_, '_, D> {
    /// The contacts of all patches.
    pub(super) fn contacts(&mut self) -> Vec<Member<D>> {
        let candidates = self.candidates;
        let near = NEIGHBOURS * self.settings.spacing;
        let mut grid = Grid::new(candidates.iter().map(|touch| touch.point), near);
        let mut order: Vec<usize> = (0..candidates.len()).collect();
        order.sort_by(|&i, &k| candidates[i].gap.total_cmp(&candidates[k].gap));
        let mut is_owned = vec![false; candidates.len()];
        let (mut members, mut contacts) = (Vec::new(), Vec::new());
        let mut group = 0;
        for seed in order {
            if is_owned[seed] {
                continue;
            }
            let first = &candidates[seed];
            grid.begin(first.point, seed);
            is_owned[seed] = true;
            let mut is_slope = false;
            grid.taken(first.point, |i| {
                is_slope |=
                    candidates[i].gap < first.gap - SLOPE * self.settings.precision_length();
            });
            if is_slope {
                continue;
            }
            members.clear();
            members.push(seed);
            let mut next = 0;
            while next < members.len() {
                let here = candidates[members[next]].point;
                next += 1;
                let known = members.len();
                grid.take(
                    here,
                    |i| candidates[i].normal.dot(first.normal) > ALIKE,
                    &mut members,
                );
                for &member in &members[known..] {
                    is_owned[member] = true;
                }
            }
            self.span(seed, &members, group, &mut contacts);
            group += 1;
        }
        contacts
    }

    /// Appends the contacts of one patch: its deepest, and its corners.
    fn span(
        &mut self,
        seed: usize,
        members: &[usize],
        group: usize,
        contacts: &mut Vec<Member<D>>,
    ) {
        let spacing = self.settings.spacing;
        let seed = self.by_values(self.candidates[seed]);
        let deepest = self.deepest(seed);
        let points = || members.iter().map(|&i| self.candidates[i].point);
        let mut centre = Vector::ZERO;
        for p in points() {
            centre += p * (1.0 / members.len() as f64);
        }
        let farthest = |measure: &dyn Fn(Point<D>) -> f64| {
            let candidates = members.iter().map(|&i| &self.candidates[i]);
            candidates.fold((f64::NEG_INFINITY, deepest), |best, touch| {
                let far = measure(touch.point);
                if far > best.0 { (far, *touch) } else { best }
            })
        };
        contacts.push(Member { touch: deepest, group });
        let (size, one) = farthest(&|p| distance(p, centre));
        if size < SMALL * spacing {
            return;
        }
        let (_, other) = farthest(&|p| distance(p, one.point));
        // Round the patch, as seen against the normal.
        let mut corners = vec![one, other];
        let mut i = 0;
        while D == 3 && i < corners.len() {
            let (from, to) = (corners[i].point, corners[(i + 1) % corners.len()].point);
            let outwards = square_to(to - from, deepest.normal).and_then(Vector::normalized);
            let beyond = outwards.map(|outwards| farthest(&|p| (p - from).dot(outwards)));
            match beyond {
                // A candidate that is no corner of the flat polygon could come again and again.
                Some((far, corner))
                    if far > BEYOND * spacing
                        && corners.iter().all(|known| known.point != corner.point) =>
                {
                    corners.insert(i + 1, corner);
                }
                _ => i += 1,
            }
        }
        for i in 0..corners.len() {
            let is_apart =
                |other: &Touch<D>| distance(other.point, corners[i].point) > SMALL * spacing;
            if corners[..i].iter().all(is_apart) {
                let corner = self.by_values(corners[i]);
                let touch = self.sharpen(corner, centre);
                contacts.push(Member { touch, group });
            }
        }
    }

    /// A candidate with the gap of the fields' values: that of a flat model is too small where bodies are
    /// round.
    fn by_values(&mut self, candidate: Touch<D>) -> Touch<D> {
        Touch { gap: self.pair.gap_at(candidate.point), ..candidate }
    }

    /// The deepest point near a candidate.
    fn deepest(&mut self, start: Touch<D>) -> Touch<D> {
        let goal = Goal::least(PRECISE * self.settings.precision_length());
        // Bodies that touch in a valley meet all along it nearly as deep: short steps find
        // no way down.
        let first = Some(self.settings.spacing);
        let (_, p) = descend(&mut self.pair, start.point, first, goal, 0.0);
        let is_near = distance(p, start.point) < NEIGHBOURS * self.settings.spacing;
        let found = is_near.then(|| self.settle(p, self.settings.spacing)).flatten();
        found.filter(|found| found.gap < start.gap).unwrap_or(start)
    }

    /// Moves a corner outwards along the patch until the gap is the margin or the
    /// bodies no longer face each other: never far, unless the budget left out the rim.
    fn sharpen(&mut self, corner: Touch<D>, centre: Point<D>) -> Touch<D> {
        let away = corner.point - centre;
        let away = away - corner.normal * away.dot(corner.normal);
        let outwards = away * (1.0 / away.norm().max(f64::MIN_POSITIVE));
        let sideways = square_to(corner.normal, outwards).unwrap_or(Vector::ZERO);
        let ways = [outwards, (outwards + sideways) * 0.7, (outwards - sideways) * 0.7];
        let start = corner.point;
        let mut corner = corner;
        let mut step = 0.5 * self.settings.spacing;
        while step > SHARP * self.settings.spacing {
            let moved = ways.iter().find_map(|way| {
                let touch = self.settle(corner.point + *way * step, step)?;
                let is_on = touch.normal.dot(corner.normal) > super::LIKE;
                let is_out = (touch.point - corner.point).dot(outwards) > 0.3 * step;
                let is_far = distance(touch.point, start) > FAR * self.settings.spacing;
                (is_on && is_out && !is_far).then_some(touch)
            });
            match moved {
                Some(touch) => corner = touch,
                None => step *= 0.5,
            }
        }
        corner
    }

    /// The point of the surface between next to `p`, if it is within `far` and the
    /// bodies touch there.
    pub(super) fn settle(&mut self, p: Point<D>, far: f64) -> Option<Touch<D>> {
        let found = settled(&mut self.pair, p, far, self.settings);
        found.filter(|touch| touch.gap <= self.settings.margin)
    }
}

/// The point of the surface between two bodies next to `p`, if it is within `far` and the bodies face
/// each other there.
pub(super) fn settled<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    p: Point<D>,
    far: f64,
    settings: &ManifoldSettings,
) -> Option<Touch<D>> {
    let mut here = p;
    for _ in 0..4 {
        let slopes = pair.slopes(here);
        match towards(here, slopes, settings) {
            Towards::There(touch) => return Some(touch),
            Towards::Next(next) if distance(next, p) <= far => here = next,
            _ => return None,
        }
    }
    None
}

/// A vector square to both, in space; in the plane there is none.
fn square_to<const D: usize>(a: Vector<f64, D>, b: Vector<f64, D>) -> Option<Vector<f64, D>> {
    (D == 3).then(|| a.in_space().cross(b.in_space()).truncated())
}
