// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Points by where they are.

use palpate_field::{Aabb, Point};

/// More places than this many times the points are not worth their memory.
const MOST_PLACES: usize = 16;

/// Points sorted into cubes, so that those near a point are found in the cubes around.
#[derive(Debug)]
pub(super) struct Grid<const D: usize> {
    min: Point<D>,
    side: f64,
    counts: [usize; D],
    /// Where each cube's points begin in `members`, and the end.
    starts: Vec<u32>,
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
        let mut grid =
            Self { min, side, counts: [1; D], starts: Vec::new(), members: Vec::new() };
        loop {
            for k in 0..D {
                grid.counts[k] = (extent[k] / grid.side) as usize + 1;
            }
            let places = grid.counts.iter().fold(1_usize, |n, count| n.saturating_mul(*count));
            if places <= MOST_PLACES * (number + 1) {
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
        let mut next = grid.starts.clone();
        grid.members = vec![0; number];
        for (i, p) in points.enumerate() {
            let place = grid.place(p);
            grid.members[next[place] as usize] = i as u32;
            next[place] += 1;
        }
        grid
    }

    fn cube(&self, p: Point<D>) -> [usize; D] {
        std::array::from_fn(|k| {
            (((p[k] - self.min[k]) / self.side) as usize).min(self.counts[k] - 1)
        })
    }

    fn place(&self, p: Point<D>) -> usize {
        self.cube(p).iter().zip(self.counts).rfold(0, |place, (k, count)| place * count + k)
    }

    /// Calls `visit` with all points that are within a side of `p`, and some others.
    pub(super) fn near(&self, p: Point<D>, mut visit: impl FnMut(usize)) {
        let centre = self.cube(p);
        for code in 0..3_usize.pow(D as u32) {
            let (mut place, mut scale, mut rest, mut is_inside) = (0, 1, code, true);
            for k in 0..D {
                let index = (centre[k] + rest % 3).wrapping_sub(1);
                is_inside &= index < self.counts[k];
                place += scale * index.min(self.counts[k]);
                scale *= self.counts[k];
                rest /= 3;
            }
            if is_inside {
                let (start, end) = (self.starts[place], self.starts[place + 1]);
                for &member in &self.members[start as usize..end as usize] {
                    visit(member as usize);
                }
            }
        }
    }
}

/// How far two points are apart [m].
#[inline]
pub(super) fn distance<const D: usize>(a: Point<D>, b: Point<D>) -> f64 {
    (a - b).norm()
}
