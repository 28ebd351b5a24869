// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Points by where they are.

use palpate_field::{Aabb, Point};

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
