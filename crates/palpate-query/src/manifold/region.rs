// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The region in which two bodies touch, box by box.

use palpate_field::scalar::Model;
use palpate_field::{Aabb, BLOCK, Point, Vector};

use super::cover;
use super::patch::{self, Patches, Seeded};
use super::{COPIES, LIKE, ManifoldSettings, Member, Touch};
use crate::certified::Stop;
use crate::contact::NormalSource;
use crate::engine::{self, End, Frontier, Heap, Problem};
use crate::pair::PairWorkspace;
use crate::pair::body_pair::{BodyPair, Memory};
use crate::pair::search::{BoxCell, ROOM, least_of_larger};

/// Steps to the surface between at most.
const STEPS: usize = 4;

/// A point counts as on the surface between the bodies within this share of
/// [`ManifoldSettings::precision_length`].
const ON: f64 = 1e-3;

/// Boxes in which the gap varies by no more than this share of the same beyond an affine
/// function are flat.
const FLAT: f64 = 0.05;

/// Flat boxes with half a side above this many spacings are halved: points are laid in the others, one
/// for each few spacings.
const WIDE: f64 = 4.0;

/// How often boxes are halved that are open far from all candidates: parts of the region that are
/// thinner than the spacing.
const HALVINGS: usize = 6;

/// A box is far from all candidates if none is within so many spacings: less than neighbours are apart.
const SEEDED: f64 = 1.2;

/// A candidate decides a box if no point of the box is farther from it than so many spacings.
const DECIDED: f64 = 0.5;

/// The evaluations that thin parts may take, as a multiple of those before, and in addition.
const THIN_SHARE: u32 = 2;
const THIN_MORE: u32 = 4096;

/// The region in which two bodies touch, in candidates and flat boxes.
#[derive(Debug)]
pub(super) struct Region<const D: usize> {
    /// Points on the surface between the bodies.
    pub(super) candidates: Vec<Touch<D>>,
    /// Flat boxes in the middle of the region.
    pub(super) middles: Vec<Middle<D>>,
    /// Boxes near candidates that may hold a part of the region too.
    pub(super) doubtful: Vec<BoxCell<D>>,
    /// Why the search ended: [`Stop::Converged`] if the region is whole.
    pub(super) stop: Stop,
}

/// Finds the region in which two bodies touch; `first` is the first candidate.
pub(super) fn find<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    settings: &ManifoldSettings,
    budget: u32,
    workspace: &mut PairWorkspace<D>,
    first: Touch<D>,
) -> Region<D> {
    let root = pair.root(0.5 * settings.margin);
    let (mut search, frontier) =
        RegionSearch::new(pair, settings, &root, (budget, workspace), vec![first]);
    frontier.queue.clear();
    BoxCell::unknown(&root).grid(&mut frontier.pending);
    let stop = match engine::search(&mut search, frontier) {
        // No box is left to be halved.
        End::Exhausted => Stop::Converged,
        end => end.stop(),
    };
    let left = search.settle();
    let stop =
        if stop.is_early() { stop } else { search.find_thin(frontier, left, Near::Candidates) };
    search.into_region(stop)
}

impl<const D: usize> Region<D> {
    /// Searches boxes that may hold a part of the region that the contacts leave out, and returns the
    /// candidates that it finds.
    pub(super) fn decide(
        &mut self,
        pair: &mut BodyPair<'_, D>,
        settings: &ManifoldSettings,
        (budget, workspace): (u32, &mut PairWorkspace<D>),
        (left, contacts): (Vec<BoxCell<D>>, &[Member<D>]),
    ) -> Vec<Touch<D>> {
        let root = pair.root(0.5 * settings.margin);
        let known = self.candidates.len();
        let candidates = std::mem::take(&mut self.candidates);
        let (mut search, frontier) =
            RegionSearch::new(pair, settings, &root, (budget, workspace), candidates);
        let stop = search.find_thin(frontier, left, Near::Contacts(contacts));
        self.candidates = search.candidates;
        if !self.stop.is_early() {
            self.stop = stop;
        }
        self.candidates[known..].to_vec()
    }
}

/// Which boxes need no candidate of their own.
#[derive(Clone, Copy)]
enum Near<'c, const D: usize> {
    /// Those near a candidate.
    Candidates,
    /// Those that these contacts leave out by no more than promised, and those decided by a candidate.
    Contacts(&'c [Member<D>]),
}

impl<const D: usize> Near<'_, D> {
    /// How far a candidate may be from the centre of a box [m].
    fn limit(self, cell: &BoxCell<D>, spacing: f64) -> f64 {
        match self {
            Self::Candidates => SEEDED * spacing,
            Self::Contacts(_) => DECIDED * spacing - cell.radius(),
        }
    }
}

/// A search for all boxes down to the spacing that the surface between the bodies crosses.
/// It bounds no least value: no box comes before another, and all are searched.
struct RegionSearch<'s, 'a, const D: usize> {
    pair: &'s mut BodyPair<'a, D>,
    settings: ManifoldSettings,
    budget: u32,
    slack: f64,
    open: &'s mut Vec<usize>,
    memory: &'s mut Memory<D>,
    /// Boxes no larger than the spacing that the surface may cross.
    small: Vec<BoxCell<D>>,
    candidates: Vec<Touch<D>>,
    middles: Vec<Middle<D>>,
    /// Boxes that may hold a part of the region, near candidates.
    doubtful: Vec<BoxCell<D>>,
    /// Points in both bodies that lead to no candidate.
    overlaps: Vec<Point<D>>,
}

impl<'s, 'a, const D: usize> RegionSearch<'s, 'a, D> {
    /// A search of `root`, and the boxes that wait.
    fn new(
        pair: &'s mut BodyPair<'a, D>,
        settings: &ManifoldSettings,
        root: &Aabb<D>,
        (budget, workspace): (u32, &'s mut PairWorkspace<D>),
        candidates: Vec<Touch<D>>,
    ) -> (Self, &'s mut Frontier<Heap<BoxCell<D>>>) {
        let slack = pair.slack(root.radius_about_origin());
        let PairWorkspace { frontier, open, memory, .. } = workspace;
        let search = Self {
            pair,
            settings: *settings,
            budget,
            slack,
            open,
            memory,
            small: vec![],
            candidates,
            middles: vec![],
            doubtful: vec![],
            overlaps: vec![],
        };
        (search, frontier)
    }

    fn into_region(self, stop: Stop) -> Region<D> {
        let Self { candidates, middles, doubtful, .. } = self;
        Region { candidates, middles, doubtful, stop }
    }
}

impl<const D: usize> RegionSearch<'_, '_, D> {
    /// Moves the centres of the small boxes to the surface between, and returns the boxes whose centres do
    /// not get there.
    fn settle(&mut self) -> Vec<BoxCell<D>> {
        let small = std::mem::take(&mut self.small);
        let mut left = Vec::new();
        for cells in small.chunks(BLOCK) {
            self.settle_block(cells, &mut left);
        }
        left
    }

    /// Finds the parts of the region that are thinner than the spacing: in boxes that may hold a part of it
    /// and are not `near` candidates. These are halved as often as it takes.
    #[inline(never)]
    fn find_thin(
        &mut self,
        frontier: &mut Frontier<Heap<BoxCell<D>>>,
        left: Vec<BoxCell<D>>,
        near: Near<'_, D>,
    ) -> Stop {
        let (coarse, mut left) = (self.settings, left);
        let more = THIN_SHARE.saturating_mul(self.pair.evaluations).saturating_add(THIN_MORE);
        let most = self.pair.evaluations.saturating_add(more);
        let is_limited = most < self.budget;
        self.budget = self.budget.min(most);
        for halving in 0..=HALVINGS {
            self.seed(&mut left, near, &coarse);
            if left.is_empty() {
                return self.with_overlaps(near, &coarse);
            }
            if halving == HALVINGS {
                break;
            }
            self.settings.spacing *= 0.5;
            frontier.queue.clear();
            frontier.pending.clear();
            left.iter().for_each(|cell| cell.halve(&mut frontier.pending));
            match engine::search(self, frontier) {
                End::Exhausted => {}
                End::Spent if is_limited => return Stop::Unresolved,
                end => return end.stop(),
            }
            left = self.settle();
        }
        Stop::Unresolved
    }

    /// Why a search for thin parts ends that has no box left. It is unresolved if the bodies overlap at a
    /// place that is far from all candidates, or that the contacts leave out.
    fn with_overlaps(&self, near: Near<'_, D>, coarse: &ManifoldSettings) -> Stop {
        let far = SEEDED * coarse.spacing;
        let is_open = |p: &Point<D>| {
            self.candidates.iter().all(|touch| distance(touch.point, *p) > far)
                && !matches!(near, Near::Contacts(contacts)
                    if !cover::is_place_left_out(*p, contacts, coarse.spacing))
        };
        if self.overlaps.iter().any(is_open) { Stop::Unresolved } else { Stop::Converged }
    }

    /// Finds a candidate in or next to each box that is not `near` one, and keeps the boxes where there is
    /// none.
    fn seed(
        &mut self,
        left: &mut Vec<BoxCell<D>>,
        near: Near<'_, D>,
        coarse: &ManifoldSettings,
    ) {
        if left.is_empty() {
            return;
        }
        let far = SEEDED.max(DECIDED) * coarse.spacing;
        let grid = Grid::new(self.candidates.iter().map(|touch| touch.point), far);
        let before = self.candidates.len();
        left.retain(|cell| {
            if let Near::Contacts(contacts) = near
                && !cover::is_box_left_out(cell, contacts, coarse.spacing)
            {
                return false;
            }
            let limit = near.limit(cell, coarse.spacing);
            let is_near = |touch: &Touch<D>| distance(touch.point, cell.centre) < limit;
            if grid.has_within(cell.centre, limit)
                || self.candidates[before..].iter().any(is_near)
            {
                self.doubtful.push(*cell);
                return false;
            }
            if limit <= 0.0 {
                // No candidate would decide so large a box.
                return true;
            }
            let found = match patch::seeded(self.pair, cell, coarse) {
                Seeded::Touch(touch) => Some(touch),
                Seeded::Overlap(p) => {
                    self.overlaps.push(p);
                    None
                }
                Seeded::Nothing => None,
            };
            self.candidates.extend(found);
            match near {
                Near::Candidates => {
                    if found.is_some_and(|touch| !cell.contains(touch.point)) {
                        self.doubtful.push(*cell);
                    }
                    found.is_none()
                }
                Near::Contacts(_) => !found.as_ref().is_some_and(is_near),
            }
        });
    }

    /// Which boxes of a round the surface between may cross, within the margin, as far as
    /// the values at their centres tell.
    fn is_near(&mut self, round: &[BoxCell<D>]) -> [bool; BLOCK] {
        let limit = 0.5 * self.settings.margin + self.slack;
        let mut values = [[0.0; BLOCK]; 2];
        for (body, values) in values.iter_mut().enumerate() {
            self.pair.values(body, round, self.memory, values);
        }
        let mut is_near = [false; BLOCK];
        for (i, part) in round.iter().enumerate() {
            let ([a, b], radius) = ([values[0][i], values[1][i]], part.radius());
            is_near[i] =
                a.max(b) - radius <= limit && (a - b).abs() <= 2.0 * (radius + self.slack);
        }
        is_near
    }
}

impl<const D: usize> Problem for RegionSearch<'_, '_, D> {
    type Queue = Heap<BoxCell<D>>;

    fn round_and_parts(&self) -> (usize, usize) {
        (BLOCK, 1 << D)
    }

    fn decided(&self, _lower: f64) -> Option<Stop> {
        None
    }

    fn has_room(&self, frontier: &Frontier<Self::Queue>) -> bool {
        frontier.pending.len() + (BLOCK << D) <= ROOM
    }

    fn is_spent(&self) -> bool {
        self.pair.evaluations >= self.budget
    }

    /// Boxes are halved once they are bounded, and their halves are pending.
    fn can_split(&self, _queue: &Self::Queue) -> bool {
        false
    }

    fn split(&mut self, cell: &BoxCell<D>, round: &mut Vec<BoxCell<D>>) {
        cell.halve(round);
    }

    fn bound(&mut self, frontier: &mut Frontier<Self::Queue>) {
        let Frontier { pending, round, .. } = frontier;
        let mut is_open = self.is_near(round);
        self.open.clear();
        self.open.extend((0..round.len()).filter(|&i| is_open[i]));
        self.pair.keep_known(round, self.open, self.memory);
        for body in 0..2 {
            self.pair.models(body, round, self.open, self.memory);
        }
        for (lane, &i) in self.open.iter().enumerate() {
            let models = [0, 1].map(|body| self.pair.model(body, self.memory, lane));
            let mut found = look::<D>(&models, &self.settings, self.slack);
            if longest_half(&round[i]) > WIDE * self.settings.spacing && found == Look::Middle {
                found = Look::Open;
            }
            is_open[i] = found == Look::Open;
            if let (Look::Middle, Some(middle)) = (found, Middle::of(&round[i], &models)) {
                middle.lay(&round[i], &self.settings, &mut self.candidates);
                self.middles.push(middle);
            }
        }
        let mut lanes = is_open.iter();
        round.retain(|_| lanes.next() == Some(&true));
        for part in round.drain(..) {
            if longest_half(&part) <= 0.5 * self.settings.spacing {
                self.small.push(part);
            } else {
                self.split(&part, pending);
            }
        }
    }

    fn is_open(&self, _cell: &BoxCell<D>) -> bool {
        false
    }

    fn close(&mut self, _cell: &BoxCell<D>, _queue: &mut Self::Queue) {}

    fn closed(&self) -> f64 {
        f64::NEG_INFINITY
    }
}

/// Half of the longest side of a box [m].
fn longest_half<const D: usize>(part: &BoxCell<D>) -> f64 {
    (0..D).fold(0.0_f64, |longest, k| longest.max(part.half[k]))
}

/// What models prove of the surface between the bodies in a box.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Look {
    /// The box may hold a part of it.
    Open,
    /// It holds the middle of a flat patch, which its rim spans, where there is one.
    Middle,
    /// It holds none, or none within the margin.
    Nothing,
}

fn look<const D: usize>([a, b]: &[Model; 2], settings: &ManifoldSettings, slack: f64) -> Look {
    let (mut across, mut along) = (0.0, 0.0);
    for (a, b) in a.gradient.iter().zip(b.gradient) {
        across += (a - b).abs();
        along += (a + b).abs();
    }
    let half_margin = 0.5 * settings.margin;
    let between = across + (a.lower + b.upper).max(a.upper + b.lower);
    let is_flat =
        a.lower.max(a.upper) + b.lower.max(b.upper) <= FLAT * settings.precision_length();
    // On the surface between, both values are their mean, which varies less than either.
    let is_inside = 0.5 * (a.value + b.value + along + a.upper + b.upper) < half_margin;
    if (a.value - b.value).abs() > between + 2.0 * slack
        || least_of_larger::<D>(a, b, f64::INFINITY).0 > half_margin + slack
    {
        Look::Nothing
    } else if is_flat && is_inside {
        Look::Middle
    } else {
        Look::Open
    }
}

impl<const D: usize> RegionSearch<'_, '_, D> {
    /// Moves the centres of boxes to the surface between, along the gradient of `g_a − g_b`, and appends
    /// those that get there and where the bodies face each other to the candidates; `left` are the boxes of
    /// the others.
    fn settle_block(&mut self, cells: &[BoxCell<D>], left: &mut Vec<BoxCell<D>>) {
        let mut points = [Vector::ZERO; BLOCK];
        let mut from = [0; BLOCK];
        let mut is_settled = [false; BLOCK];
        for (i, cell) in cells.iter().enumerate() {
            (points[i], from[i]) = (cell.centre, i);
        }
        let mut count = cells.len();
        let mut slopes = [[(0.0, Vector::ZERO); BLOCK]; 2];
        for step in 0..STEPS {
            self.pair.block_slopes(&points[..count], self.memory, &mut slopes);
            let mut open = 0;
            for i in 0..count {
                let cell = &cells[from[i]];
                match towards(points[i], [slopes[0][i], slopes[1][i]], &self.settings) {
                    Towards::Nothing => {}
                    Towards::There(touch) if touch.gap > self.settings.margin => {}
                    Towards::There(touch) => {
                        is_settled[from[i]] = true;
                        self.candidates.push(touch);
                        if !cell.contains(touch.point) {
                            // Another part of the region may be in the box itself.
                            self.doubtful.push(*cell);
                        }
                    }
                    Towards::Next(next) => {
                        if step + 1 < STEPS
                            && (next - cell.centre).norm() <= 1.5 * cell.radius()
                        {
                            (points[open], from[open]) = (next, from[i]);
                            open += 1;
                        }
                    }
                }
            }
            count = open;
            if count == 0 {
                break;
            }
        }
        left.extend(cells.iter().zip(is_settled).filter(|(_, is)| !is).map(|(cell, _)| *cell));
    }
}

/// Where the surface between the bodies is, as seen from a point with its slopes.
pub(super) enum Towards<const D: usize> {
    /// It is here.
    There(Touch<D>),
    /// It may be here.
    Next(Point<D>),
    /// The bodies do not face each other.
    Nothing,
}

/// One step of Newton's method to where both values are equal.
pub(super) fn towards<const D: usize>(
    p: Point<D>,
    [(a, slope_a), (b, slope_b)]: [(f64, Vector<f64, D>); 2],
    settings: &ManifoldSettings,
) -> Towards<D> {
    let between = slope_a - slope_b;
    let squared = between.dot(between);
    if slope_a.dot(slope_b) >= 0.0 || squared == 0.0 {
        return Towards::Nothing;
    }
    let apart = a - b;
    if apart.abs() > ON * settings.precision_length() {
        return Towards::Next(p - between * (apart / squared));
    }
    let (gap, normal) = (2.0 * a.max(b), between * (1.0 / squared.sqrt()));
    Towards::There(Touch { point: p, normal, gap, source: NormalSource::Gradients })
}

/// Points sorted into cubes, so that those near a point are found in the cubes around. They
/// are taken out in groups of points that are alike.
#[derive(Debug)]
pub(super) struct Grid<const D: usize> {
    min: Point<D>,
    /// Cubes in a metre.
    per_metre: f64,
    /// The square of the distance up to which points are near [m²].
    near_squared: f64,
    counts: [usize; D],
    /// Where each cube's points begin in `members`, and the end.
    starts: Vec<u32>,
    /// Where those end that were not taken out.
    ends: Vec<u32>,
    /// Of each cube that the present group came to: where those end that are alike.
    alike: Vec<u32>,
    /// The last group that came to each cube.
    groups: Vec<u32>,
    group: u32,
    members: Vec<(Point<D>, u32)>,
}

impl<const D: usize> Grid<D> {
    /// Sorts points into cubes with sides of at least `near`.
    pub(super) fn new(points: impl Iterator<Item = Point<D>> + Clone, near: f64) -> Self {
        let number = points.clone().count();
        let aabb = Aabb::around(points.clone());
        let (min, extent) = aabb.map_or((Point::constant(0.0), Point::constant(0.0)), |aabb| {
            (aabb.min, aabb.max - aabb.min)
        });
        let mut grid = Self {
            min,
            per_metre: 1.0 / near,
            near_squared: near * near,
            counts: [1; D],
            starts: Vec::new(),
            ends: Vec::new(),
            alike: Vec::new(),
            groups: Vec::new(),
            group: 0,
            members: vec![(Point::constant(0.0), 0); number],
        };
        loop {
            for k in 0..D {
                grid.counts[k] = ((extent[k] * grid.per_metre) as usize).saturating_add(1);
            }
            let places = grid.counts.iter().fold(1_usize, |n, count| n.saturating_mul(*count));
            // Empty places take time too: there are no more than points.
            if places <= number + 1 {
                grid.starts = vec![0; places + 1];
                break;
            }
            grid.per_metre *= 0.5;
        }
        let places: Vec<usize> = points.clone().map(|p| grid.place_of(grid.cube(p))).collect();
        for place in &places {
            grid.starts[place + 1] += 1;
        }
        for place in 1..grid.starts.len() {
            grid.starts[place] += grid.starts[place - 1];
        }
        grid.ends = grid.starts.clone();
        grid.alike = grid.starts.clone();
        grid.groups = vec![0; grid.starts.len()];
        for ((i, p), place) in (0..).zip(points).zip(places) {
            grid.members[grid.ends[place] as usize] = (p, i);
            grid.ends[place] += 1;
        }
        grid
    }

    fn cube(&self, p: Point<D>) -> [usize; D] {
        std::array::from_fn(|k| {
            (((p[k] - self.min[k]) * self.per_metre) as usize).min(self.counts[k] - 1)
        })
    }

    fn place_of(&self, cube: [usize; D]) -> usize {
        let mut place = 0;
        for k in (0..D).rev() {
            place = place * self.counts[k] + cube[k];
        }
        place
    }

    /// Whether a point is within `limit` of `p` [m], which is at most what is near; taken out or not.
    pub(super) fn has_within(&self, p: Point<D>, limit: f64) -> bool {
        let is_within = |point: Point<D>| distance(p, point) < limit;
        let mut first = [0; D];
        let mut last = [0; D];
        for k in 0..D {
            let place = (p[k] - self.min[k]) * self.per_metre;
            // Negative numbers saturate at zero, so that a point off the grid looks at its border.
            let place = place.floor();
            first[k] = ((place - 1.0).max(0.0) as usize).min(self.counts[k] - 1);
            last[k] = ((place + 1.0).max(0.0) as usize).min(self.counts[k] - 1);
        }
        let mut row = first;
        loop {
            let start = self.place_of(row);
            for place in start..=start + last[0] - first[0] {
                let all = self.starts[place] as usize..self.starts[place + 1] as usize;
                if self.members[all].iter().any(|(point, _)| is_within(*point)) {
                    return true;
                }
            }
            let Some(k) = (1..D).find(|&k| row[k] < last[k]) else { return false };
            row[k] += 1;
            row[1..k].copy_from_slice(&first[1..k]);
        }
    }

    fn is_near(&self, p: Point<D>, other: Point<D>) -> bool {
        let apart = p - other;
        apart.dot(apart) < self.near_squared
    }

    /// Takes out the point `index`, which is at `p`, and begins a group.
    pub(super) fn begin(&mut self, p: Point<D>, index: usize) {
        let place = self.place_of(self.cube(p));
        let (start, end) = (self.starts[place] as usize, self.ends[place] as usize);
        let is_it = |member: &(Point<D>, u32)| member.1 as usize == index;
        if let Some(i) = self.members[start..end].iter().position(is_it) {
            self.members.swap(start + i, end - 1);
            self.ends[place] -= 1;
        }
        self.group += 1;
    }

    /// Takes out the points near `p` that are alike, which the group must agree on, and
    /// appends them to `taken`.
    pub(super) fn take(
        &mut self,
        p: Point<D>,
        is_alike: impl Fn(usize) -> bool,
        taken: &mut Vec<usize>,
    ) {
        self.each_place(p, |grid, place| {
            if grid.groups[place] != grid.group {
                grid.part(place, &is_alike);
            }
            let mut i = grid.starts[place] as usize;
            while i < grid.alike[place] as usize {
                let (point, member) = grid.members[i];
                if grid.is_near(p, point) {
                    taken.push(member as usize);
                    grid.alike[place] -= 1;
                    grid.ends[place] -= 1;
                    let (alike, end) = (grid.alike[place] as usize, grid.ends[place] as usize);
                    grid.members[i] = grid.members[alike];
                    grid.members[alike] = grid.members[end];
                    grid.members[end] = (point, member);
                } else {
                    i += 1;
                }
            }
        });
    }

    /// Puts the points of a cube that are alike before the others.
    fn part(&mut self, place: usize, is_alike: impl Fn(usize) -> bool) {
        let start = self.starts[place] as usize;
        let left = &mut self.members[start..self.ends[place] as usize];
        let mut count = 0;
        for i in 0..left.len() {
            if is_alike(left[i].1 as usize) {
                left.swap(count, i);
                count += 1;
            }
        }
        (self.alike[place], self.groups[place]) = ((start + count) as u32, self.group);
    }

    /// Calls `visit` with the points near `p` that were taken out.
    pub(super) fn taken(&mut self, p: Point<D>, mut visit: impl FnMut(usize)) {
        self.each_place(p, |grid, place| {
            let (end, all) = (grid.ends[place] as usize, grid.starts[place + 1] as usize);
            for &(point, member) in &grid.members[end..all] {
                if grid.is_near(p, point) {
                    visit(member as usize);
                }
            }
        });
    }

    /// Calls `visit` with the cubes around a point.
    fn each_place(&mut self, p: Point<D>, mut visit: impl FnMut(&mut Self, usize)) {
        let centre = self.cube(p);
        let (mut first, mut last) = (centre, centre);
        for k in 0..D {
            first[k] = centre[k].saturating_sub(1);
            last[k] = (centre[k] + 1).min(self.counts[k] - 1);
        }
        // Those that differ in the first coordinate alone are next to each other.
        let mut row = first;
        loop {
            let start = self.place_of(row);
            for place in start..=start + last[0] - first[0] {
                visit(self, place);
            }
            let Some(k) = (1..D).find(|&k| row[k] < last[k]) else { break };
            row[k] += 1;
            row[1..k].copy_from_slice(&first[1..k]);
        }
    }
}

/// How far two points are apart [m].
#[inline]
pub(crate) fn distance<const D: usize>(a: Point<D>, b: Point<D>) -> f64 {
    (a - b).norm()
}

/// How far apart points are laid, in spacings: less than `NEIGHBOURS` of patches.
const LAID: f64 = 1.9;

/// A flat box in the middle of a region, of which no candidate was made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Middle<const D: usize> {
    point: Point<D>,
    normal: Vector<f64, D>,
    radius: f64,
    values: [f64; 2],
    slopes: [Vector<f64, D>; 2],
}

impl<const D: usize> Middle<D> {
    /// The box, by the models of both fields in it; `None` where they do not face each
    /// other.
    pub(super) fn of(cell: &BoxCell<D>, [a, b]: &[Model; 2]) -> Option<Self> {
        let mut slopes = [Vector::ZERO; 2];
        for k in (0..D).filter(|k| cell.half[*k] > 0.0) {
            (slopes[0][k], slopes[1][k]) =
                (a.gradient[k] / cell.half[k], b.gradient[k] / cell.half[k]);
        }
        let normal = (slopes[0] - slopes[1]).normalized()?;
        let is_facing = slopes[0].dot(slopes[1]) < 0.0;
        let (point, radius, values) = (cell.centre, cell.radius(), [a.value, b.value]);
        is_facing.then_some(Self { point, normal, radius, values, slopes })
    }

    /// Appends points of the surface between the bodies in the box, where its flat models have it: near
    /// its sides, and so far apart that each has neighbours.
    pub(super) fn lay(
        &self,
        cell: &BoxCell<D>,
        settings: &ManifoldSettings,
        candidates: &mut Vec<Touch<D>>,
    ) {
        let [a, b] = self.slopes;
        let between = a - b;
        let across =
            (0..D).fold(0, |k, i| if between[i].abs() > between[k].abs() { i } else { k });
        // Of the axis across, the surface tells the place.
        let counts: [usize; D] = std::array::from_fn(|k| {
            let steps = 2.0 * cell.half[k] / (LAID * settings.spacing);
            if k == across { 1 } else { steps.ceil().max(1.0) as usize }
        });
        for index in 0..counts.iter().product() {
            let (mut offset, mut rest, mut is_outer) = (Vector::ZERO, index, false);
            for k in (0..D).filter(|k| *k != across) {
                let step = rest % counts[k];
                let share = (step as f64 + 0.5) / counts[k] as f64;
                offset[k] = (2.0 * share - 1.0) * cell.half[k];
                is_outer |= step == 0 || step + 1 == counts[k];
                rest /= counts[k];
            }
            if !is_outer {
                continue;
            }
            let apart = self.values[0] - self.values[1] + between.dot(offset);
            offset[across] = -apart / between[across];
            let gap = 2.0 * (self.values[0] + a.dot(offset));
            if offset[across].abs() <= cell.half[across] && gap <= settings.margin {
                let (point, source) = (self.point + offset, NormalSource::Gradients);
                candidates.push(Touch { point, normal: self.normal, gap, source });
            }
        }
    }

    fn is_like(&self, contact: &Member<D>) -> bool {
        contact.touch.normal.dot(self.normal) > LIKE
    }

    /// Whether the box is next to one of the contacts from `first` on, or between one of
    /// them and another: in the ball about both.
    fn is_spanned(&self, contacts: &[Member<D>], first: usize, near: f64) -> bool {
        let away = |contact: &Member<D>| contact.touch.point - self.point;
        (first..contacts.len()).filter(|i| self.is_like(&contacts[*i])).any(|i| {
            let one = away(&contacts[i]);
            let mut others = contacts[..i].iter().filter(|other| self.is_like(other));
            one.norm() < near || others.any(|other| one.dot(away(other)) <= 0.0)
        })
    }

    /// How far the next contact with a like normal is, and its group.
    fn next(&self, contacts: &[Member<D>]) -> (f64, Option<usize>) {
        let like = contacts.iter().filter(|contact| self.is_like(contact));
        like.fold((f64::INFINITY, None), |least, member| {
            let apart = distance(member.touch.point, self.point);
            if apart < least.0 { (apart, Some(member.group)) } else { least }
        })
    }
}

impl<const D: usize> Patches<'_, '_, D> {
    /// Appends contacts until they span all of `middles`, always where it is farthest to
    /// the next.
    pub(super) fn fill(&mut self, middles: &mut Vec<Middle<D>>, contacts: &mut Vec<Member<D>>) {
        let near = COPIES * self.settings.spacing;
        let mut first = 0;
        loop {
            middles.retain(|middle| !middle.is_spanned(contacts, first, near));
            first = contacts.len();
            let farthest = (0..middles.len()).max_by(|&i, &k| {
                let [one, other] = [i, k].map(|i| middles[i].next(contacts).0);
                one.total_cmp(&other).then(k.cmp(&i))
            });
            let Some(farthest) = farthest else { break };
            let middle = middles.swap_remove(farthest);
            let Some(touch) = self.settle(middle.point, middle.radius) else { continue };
            let new = contacts.iter().map(|member| member.group + 1).max().unwrap_or(0);
            let group = middle.next(contacts).1.unwrap_or(new);
            contacts.push(Member { touch, group });
        }
    }
}
