// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Points by where they are.

use palpate_field::{Aabb, Point};

/// Points sorted into cubes, so that those near a point are found in the cubes around.
#[derive(Debug)]
pub(super) struct Grid<const D: usize> {
    min: Point<D>,
    side: f64,
    counts: [usize; D],
    /// Where each cube's points begin in `members`, and the end.
    starts: Vec<u32>,
    /// Where those end that were not taken out.
    ends: Vec<u32>,
    members: Vec<u32>,
}

impl<const D: usize> Grid<D> {
    /// Sorts points into cubes with sides of at least `side`.
    pub(super) fn new(points: impl Iterator<Item = Point<D>> + Clone, side: f64) -> Self {
        let number = points.clone().count();
        let aabb = Aabb::around(points.clone());
        let (min, extent) = aabb.map_or((Point::constant(0.0), Point::constant(0.0)), |aabb| {
            (aabb.min, aabb.max - aabb.min)
        });
        let mut grid = Self {
            min,
            side,
            counts: [1; D],
            starts: Vec::new(),
            ends: Vec::new(),
            members: Vec::new(),
        };
        loop {
            for k in 0..D {
                grid.counts[k] = ((extent[k] / grid.side) as usize).saturating_add(1);
            }
            let places = grid.counts.iter().fold(1_usize, |n, count| n.saturating_mul(*count));
            // Empty places take time too: there are no more than points.
            if places <= number + 1 {
                grid.starts = vec![0; places + 1];
                break;
            }
            grid.side *= 2.0;
        }
        for p in points.clone() {
            let place = grid.place(p);
            grid.starts[place + 1] += 1;
        }
        for place in 1..grid.starts.len() {
            grid.starts[place] += grid.starts[place - 1];
        }
        grid.ends = grid.starts.clone();
        grid.members = vec![0; number];
        for (i, p) in points.enumerate() {
            let place = grid.place(p);
            grid.members[grid.ends[place] as usize] = i as u32;
            grid.ends[place] += 1;
        }
        grid
    }

    fn cube(&self, p: Point<D>) -> [usize; D] {
        std::array::from_fn(|k| {
            (((p[k] - self.min[k]) / self.side) as usize).min(self.counts[k] - 1)
        })
    }

    fn place(&self, p: Point<D>) -> usize {
        self.place_of(self.cube(p))
    }

    fn place_of(&self, cube: [usize; D]) -> usize {
        cube.iter().zip(self.counts).rfold(0, |place, (k, count)| place * count + k)
    }

    /// Takes out the points within a side of `p`, and maybe some others, of which
    /// `is_wanted` says so.
    pub(super) fn take(&mut self, p: Point<D>, mut is_wanted: impl FnMut(usize) -> bool) {
        self.each_place(p, |grid, place| {
            let (start, mut end) = (grid.starts[place] as usize, grid.ends[place] as usize);
            let mut i = start;
            while i < end {
                if is_wanted(grid.members[i] as usize) {
                    end -= 1;
                    grid.members.swap(i, end);
                } else {
                    i += 1;
                }
            }
            grid.ends[place] = end as u32;
        });
    }

    /// Calls `visit` with the points that were taken out within a side of `p`, and maybe
    /// some others.
    pub(super) fn taken(&mut self, p: Point<D>, mut visit: impl FnMut(usize)) {
        self.each_place(p, |grid, place| {
            let (end, all) = (grid.ends[place] as usize, grid.starts[place + 1] as usize);
            grid.members[end..all].iter().for_each(|&member| visit(member as usize));
        });
    }

    /// Calls `visit` with the cubes around a point.
    fn each_place(&mut self, p: Point<D>, mut visit: impl FnMut(&mut Self, usize)) {
        let centre = self.cube(p);
        let first = centre.map(|k| k.saturating_sub(1));
        let last: [usize; D] = std::array::from_fn(|k| (centre[k] + 1).min(self.counts[k] - 1));
        let mut cube = first;
        loop {
            visit(self, self.place_of(cube));
            // The next one, the first coordinate fastest.
            let Some(k) = (0..D).find(|&k| cube[k] < last[k]) else { break };
            cube[k] += 1;
            cube[..k].copy_from_slice(&first[..k]);
        }
    }
}

/// How far two points are apart [m].
#[inline]
pub(super) fn distance<const D: usize>(a: Point<D>, b: Point<D>) -> f64 {
    (a - b).norm()
}
