// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Parallel lines over parts of a picture.

use crate::drawing::Path;
use crate::geometry::{Point, Rect, clip_segment, distance};

/// Parallel lines.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hatching {
    /// How much lines fall over one pixel to the right [px].
    pub(crate) slope: f64,
    /// From line to line, up or down [px].
    pub(crate) spacing: f64,
}

/// Shorter lines are not seen [px]: such are those between outlines that run together.
const SHORTEST: f64 = 2.0;

impl Hatching {
    /// The lines over those points of `area` [px] that lie in as many of `regions` as `is_here`
    /// says. A region is what its rings enclose by the even-odd rule.
    pub(crate) fn over(
        self,
        area: &Rect,
        regions: &[&[Vec<Point>]],
        is_here: impl Fn(usize) -> bool,
    ) -> Path {
        let mut path = Path::default();
        let fall = self.slope * area.width();
        let (top, bottom) = (area.min[1] - fall.max(0.0), area.max[1] - fall.min(0.0));
        let count = ((bottom - top) / self.spacing) as usize;
        for i in 0..=count {
            let start = top + (i as f64 + 0.5) * self.spacing;
            let at = |x: f64| [x, start + self.slope * (x - area.min[0])];
            let mut crossings = self.crossings(regions, at(0.0)[1]);
            crossings.push((f64::INFINITY, 0));
            crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut is_inside = vec![false; regions.len()];
            let mut left = area.min[0];
            for (right, region) in crossings {
                let right = right.clamp(area.min[0], area.max[0]);
                if right > left && is_here(is_inside.iter().filter(|inside| **inside).count()) {
                    let line = clip_segment(at(left), at(right), area);
                    if let Some((a, b)) = line.filter(|(a, b)| distance(*a, *b) >= SHORTEST) {
                        path.add_line(&[a, b]);
                    }
                }
                left = right;
                if let Some(inside) = is_inside.get_mut(region) {
                    *inside = !*inside;
                }
            }
        }
        path
    }

    /// Where the line through `[0, start]` crosses rings, with the numbers of their regions.
    fn crossings(self, regions: &[&[Vec<Point>]], start: f64) -> Vec<(f64, usize)> {
        let above = |p: Point| p[1] - start - self.slope * p[0];
        let mut crossings = Vec::new();
        for (region, rings) in regions.iter().enumerate() {
            for ring in rings.iter() {
                let next = ring.iter().cycle().skip(1);
                for (&a, &b) in ring.iter().zip(next) {
                    let (from, to) = (above(a), above(b));
                    if (from < 0.0) != (to < 0.0) {
                        crossings.push((a[0] + (b[0] - a[0]) * (from / (from - to)), region));
                    }
                }
            }
        }
        crossings
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::Verb;

    fn square(x: f64, y: f64) -> Vec<Vec<Point>> {
        vec![Rect::new(x, y, 40.0, 40.0).corners().to_vec()]
    }

    /// The ends of all lines.
    fn ends(path: &Path) -> Vec<Point> {
        let end = |verb: &Verb| match *verb {
            Verb::Move(p) | Verb::Line(p) => p,
            _ => panic!("{verb:?}"),
        };
        path.verbs.iter().map(end).collect()
    }

    #[test]
    fn lines_cover_what_regions_share() {
        let area = Rect::new(0.0, 0.0, 100.0, 100.0);
        let (a, b) = (square(10.0, 10.0), square(30.0, 20.0));
        for slope in [-1.0, 0.0, 1.0] {
            let hatching = Hatching { slope, spacing: 5.0 };
            let shared = hatching.over(&area, &[&a, &b], |count| count == 2);
            let seen = ends(&shared);
            assert!(seen.len() >= 8, "{seen:?}");
            for [x, y] in seen {
                assert!((29.99..=50.01).contains(&x) && (19.99..=50.01).contains(&y));
            }
        }
    }

    #[test]
    fn what_is_narrower_than_a_line_is_not_hatched() {
        let area = Rect::new(0.0, 0.0, 100.0, 100.0);
        for (overlap, is_seen) in [(0.5, false), (3.0, true)] {
            let (a, b) = (square(10.0, 10.0), square(50.0 - overlap, 10.0));
            let hatching = Hatching { slope: -1.0, spacing: 5.0 };
            let shared = hatching.over(&area, &[&a, &b], |count| count == 2);
            assert_eq!(!ends(&shared).is_empty(), is_seen, "{overlap} px");
        }
    }

    #[test]
    fn lines_outside_begin_at_the_border_of_the_area() {
        let area = Rect::new(20.0, 20.0, 20.0, 20.0);
        // The ring reaches beyond the area to its left.
        let ring = square(-10.0, 25.0);
        let level = Hatching { slope: 0.0, spacing: 4.0 };
        let outside = ends(&level.over(&area, &[&ring], |count| count == 0));
        let expected = [[20.0, 22.0], [40.0, 22.0], [30.0, 26.0], [40.0, 26.0]];
        assert_eq!(outside[..4], expected);
    }
}
