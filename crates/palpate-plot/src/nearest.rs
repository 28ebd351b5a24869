// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Distances from many points to many short segments.

use crate::geometry::{Point, distance, nearest_on_segment};

/// Buckets along the longer side: few segments in each, and few empty ones to cross.
const BUCKETS: f64 = 24.0;

/// Segments, sorted into square buckets.
#[derive(Debug, Clone)]
pub(crate) struct Nearest {
    segments: Vec<[Point; 2]>,
    min: Point,
    /// Edge of a bucket.
    edge: f64,
    count: [i64; 2],
    /// Indices of the segments whose boxes meet a bucket.
    buckets: Vec<Vec<usize>>,
}

impl Nearest {
    /// Sorts `segments`; a point is a segment of no length. `size` is about the extent of the
    /// points that [`distance`](Self::distance) is called with. It keeps the buckets of small
    /// sets of segments so large that a search crosses few.
    pub(crate) fn new(segments: Vec<[Point; 2]>, size: f64) -> Self {
        let ends = || segments.iter().flatten();
        let bound = |i: usize, start: f64, pick: fn(f64, f64) -> f64| {
            ends().map(|p| p[i]).fold(start, pick)
        };
        let (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
        let min = [0, 1].map(|i| bound(i, low, f64::min));
        let extent = [0, 1].map(|i| bound(i, high, f64::max) - min[i]);
        let edge = extent[0].max(extent[1]).max(size) / BUCKETS;
        let count = extent.map(|side| (side.max(0.0) / edge) as i64 + 1);
        let empty = vec![Vec::new(); (count[0] * count[1]) as usize];
        let mut nearest = Self { segments: Vec::new(), min, edge, count, buckets: empty };
        for (index, &[a, b]) in segments.iter().enumerate() {
            let (a, b) = (nearest.bucket(a), nearest.bucket(b));
            for row in a[1].min(b[1])..=a[1].max(b[1]) {
                for column in a[0].min(b[0])..=a[0].max(b[0]) {
                    if let Some(bucket) = nearest.index([column, row]) {
                        nearest.buckets[bucket].push(index);
                    }
                }
            }
        }
        Self { segments, ..nearest }
    }

    /// The distance from `p` to the nearest segment, infinite if there is none. The caller
    /// knows that it is `at_least` this.
    ///
    /// Searches rings of buckets around that of `p` until no farther ring can hold a nearer
    /// segment.
    pub(crate) fn distance(&self, p: Point, at_least: f64) -> f64 {
        if self.segments.is_empty() {
            return f64::INFINITY;
        }
        // The nearest point so far, and the square of its distance in edges: a square of a
        // length in metres could underflow.
        let (mut nearest, mut square) = ([f64::INFINITY; 2], f64::INFINITY);
        let per_edge = 1.0 / self.edge;
        let [x, y] = self.bucket(p);
        // The nearest and the farthest ring that meet the buckets, also from outside them.
        let gap = |i: i64, count: i64| (-i).max(i - count + 1).max(0);
        let far = |i: i64, count: i64| i.abs().max((count - 1 - i).abs());
        let first = gap(x, self.count[0]).max(gap(y, self.count[1]));
        let last = far(x, self.count[0]).max(far(y, self.count[1]));
        // Ring k reaches (k + 1)·√2 edges far; one ring more for rounding.
        let reached = (at_least / (std::f64::consts::SQRT_2 * self.edge)) as i64 - 2;
        for ring in first.max(reached)..=last {
            if square.sqrt() <= (ring - 1) as f64 {
                break;
            }
            for offset in -ring..=ring {
                let sides = [
                    [x + offset, y - ring],
                    [x + offset, y + ring],
                    [x - ring, y + offset],
                    [x + ring, y + offset],
                ];
                for bucket in sides.into_iter().filter_map(|at| self.index(at)) {
                    for &[a, b] in self.buckets[bucket].iter().map(|&i| &self.segments[i]) {
                        let q = nearest_on_segment(p, a, b);
                        let [dx, dy] = [0, 1].map(|i| (p[i] - q[i]) * per_edge);
                        if dx * dx + dy * dy < square {
                            (nearest, square) = (q, dx * dx + dy * dy);
                        }
                    }
                }
            }
        }
        distance(p, nearest)
    }

    /// The column and row of the bucket of `p`, also outside all buckets.
    fn bucket(&self, p: Point) -> [i64; 2] {
        [0, 1].map(|i| ((p[i] - self.min[i]) / self.edge).floor() as i64)
    }

    fn index(&self, [column, row]: [i64; 2]) -> Option<usize> {
        let is_inside =
            (0..self.count[0]).contains(&column) && (0..self.count[1]).contains(&row);
        is_inside.then_some((row * self.count[0] + column) as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::distance_to_segment;

    #[test]
    fn distances_are_those_of_a_search_of_all() {
        let at = |i: usize, f: f64| (i as f64 * f).fract();
        let segments = Vec::from_iter((0..500).map(|i| {
            let a = [3.0 * at(i, 0.618), at(i, 0.414)];
            [a, [a[0] + 0.1 * at(i, 0.732), a[1] - 0.05 * at(i, 0.236)]]
        }));
        let nearest = Nearest::new(segments.clone(), 1.0);
        for i in 0..400 {
            let p = [6.0 * at(i, 0.302) - 2.0, 5.0 * at(i, 0.791) - 2.0];
            let expected = segments
                .iter()
                .map(|&[a, b]| distance_to_segment(p, a, b))
                .fold(f64::INFINITY, f64::min);
            for known in [0.0, 0.5, 0.999] {
                assert_eq!(nearest.distance(p, known * expected), expected, "{p:?}");
            }
        }
    }

    #[test]
    fn one_point_and_none_have_distances() {
        assert_eq!(Nearest::new(vec![[[1.0, 2.0]; 2]], 5.0).distance([4.0, 6.0], 0.0), 5.0);
        assert_eq!(Nearest::new(Vec::new(), 5.0).distance([4.0, 6.0], 0.0), f64::INFINITY);
    }
}
