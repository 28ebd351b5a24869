// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Lines and rings in the plane: clip to a rectangle, drop needless points.

/// A point in pixels (x to the right, y down) or in plane coordinates.
pub(crate) type Point = [f64; 2];

/// An axis-aligned rectangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rect {
    pub(crate) min: Point,
    pub(crate) max: Point,
}

impl Rect {
    pub(crate) fn new(x: f64, y: f64, width: f64, height: f64) -> Self {
        Self { min: [x, y], max: [x + width, y + height] }
    }

    pub(crate) fn width(&self) -> f64 {
        self.max[0] - self.min[0]
    }

    pub(crate) fn height(&self) -> f64 {
        self.max[1] - self.min[1]
    }

    pub(crate) fn grown(&self, by: f64) -> Self {
        Self { min: self.min.map(|x| x - by), max: self.max.map(|x| x + by) }
    }

    pub(crate) fn contains(&self, p: Point) -> bool {
        (0..2).all(|i| self.min[i] <= p[i] && p[i] <= self.max[i])
    }

    pub(crate) fn contains_rect(&self, other: &Self) -> bool {
        self.contains(other.min) && self.contains(other.max)
    }

    pub(crate) fn middle(&self) -> Point {
        [0, 1].map(|k| (self.min[k] + self.max[k]) / 2.0)
    }

    /// The rectangle around both.
    pub(crate) fn union(&self, other: &Self) -> Self {
        Self {
            min: [0, 1].map(|k| self.min[k].min(other.min[k])),
            max: [0, 1].map(|k| self.max[k].max(other.max[k])),
        }
    }

    pub(crate) fn corners(&self) -> [Point; 4] {
        let (a, b) = (self.min, self.max);
        [a, [b[0], a[1]], b, [a[0], b[1]]]
    }
}

pub(crate) fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The part of the segment `a b` in `rect` (Liang and Barsky 1984).
pub(crate) fn clip_segment(a: Point, b: Point, rect: &Rect) -> Option<(Point, Point)> {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for i in 0..2 {
        let along = b[i] - a[i];
        if along == 0.0 {
            if a[i] < rect.min[i] || a[i] > rect.max[i] {
                return None;
            }
            continue;
        }
        let (t, u) = ((rect.min[i] - a[i]) / along, (rect.max[i] - a[i]) / along);
        enter = enter.max(t.min(u));
        leave = leave.min(t.max(u));
    }
    let at = |t: f64| {
        std::array::from_fn(|i| (a[i] + t * (b[i] - a[i])).clamp(rect.min[i], rect.max[i]))
    };
    let start = if enter == 0.0 { a } else { at(enter) };
    let end = if leave == 1.0 { b } else { at(leave) };
    (enter < leave).then_some((start, end))
}

/// The pieces of a polyline in `rect`.
pub(crate) fn clip_line(line: &[Point], rect: &Rect) -> Vec<Vec<Point>> {
    let mut pieces: Vec<Vec<Point>> = Vec::new();
    let mut open = false;
    for pair in line.windows(2) {
        let Some((a, b)) = clip_segment(pair[0], pair[1], rect) else {
            open = false;
            continue;
        };
        match pieces.last_mut() {
            Some(piece) if open && a == pair[0] => piece.push(b),
            _ => pieces.push(vec![a, b]),
        }
        open = b == pair[1];
    }
    // A ring cut open at its seam only is one piece.
    if pieces.len() > 1 && line.first() == line.last() {
        let last = pieces.len() - 1;
        if pieces[last].last() == pieces[0].first() {
            let first = std::mem::take(&mut pieces[0]);
            pieces[last].extend_from_slice(&first[1..]);
            pieces.swap_remove(0);
        }
    }
    pieces
}

/// The part of a filled ring in `rect` (Sutherland and Hodgman 1974).
///
/// Parts that are cut apart stay joined by edges along the border, which enclose nothing.
pub(crate) fn clip_ring(ring: &[Point], rect: &Rect) -> Vec<Point> {
    let mut ring = ring.to_vec();
    for i in 0..2 {
        for (bound, keep_above) in [(rect.min[i], true), (rect.max[i], false)] {
            let is_kept = |p: Point| {
                if keep_above { p[i] >= bound } else { p[i] <= bound }
            };
            let mut kept = Vec::with_capacity(ring.len() + 4);
            for (k, &b) in ring.iter().enumerate() {
                let a = ring[(k + ring.len() - 1) % ring.len()];
                if is_kept(a) != is_kept(b) {
                    let t = (bound - a[i]) / (b[i] - a[i]);
                    let mut p = [0, 1].map(|j| a[j] + t * (b[j] - a[j]));
                    p[i] = bound;
                    kept.push(p);
                }
                if is_kept(b) {
                    kept.push(b);
                }
            }
            ring = kept;
        }
    }
    ring
}

/// Whether `p` lies within `rings` by the even-odd rule.
pub(crate) fn is_within([x, y]: Point, rings: &[Vec<Point>]) -> bool {
    let crosses = |a: Point, b: Point| {
        (a[1] < y) != (b[1] < y) && x < a[0] + (b[0] - a[0]) * ((y - a[1]) / (b[1] - a[1]))
    };
    let crossings = rings.iter().map(|ring| {
        let next = ring.iter().cycle().skip(1);
        ring.iter().zip(next).filter(|(a, b)| crosses(**a, **b)).count()
    });
    crossings.sum::<usize>() % 2 == 1
}

/// Drops points that lie within `tolerance` of the line without them (Ramer 1972, Douglas and
/// Peucker 1973). Keeps both ends.
pub(crate) fn simplify(line: &[Point], tolerance: f64) -> Vec<Point> {
    if line.len() < 3 {
        return line.to_vec();
    }
    let mut keep = vec![false; line.len()];
    keep[0] = true;
    keep[line.len() - 1] = true;
    let mut open = vec![(0, line.len() - 1)];
    while let Some((from, to)) = open.pop() {
        let farthest = (from + 1..to)
            .map(|i| (i, distance_to_segment(line[i], line[from], line[to])))
            .fold((from, tolerance), |best, x| if x.1 > best.1 { x } else { best });
        if farthest.0 > from {
            keep[farthest.0] = true;
            open.push((from, farthest.0));
            open.push((farthest.0, to));
        }
    }
    line.iter().zip(keep).filter_map(|(&p, keep)| keep.then_some(p)).collect()
}

/// Distance of `p` from the segment `a b`.
pub(crate) fn distance_to_segment(p: Point, a: Point, b: Point) -> f64 {
    distance(p, nearest_on_segment(p, a, b))
}

/// The point of the segment `a b` that is nearest to `p`.
pub(crate) fn nearest_on_segment(p: Point, a: Point, b: Point) -> Point {
    let along = [b[0] - a[0], b[1] - a[1]];
    let length_squared = along[0] * along[0] + along[1] * along[1];
    if length_squared == 0.0 {
        return a;
    }
    let t = ((p[0] - a[0]) * along[0] + (p[1] - a[1]) * along[1]) / length_squared;
    let t = t.clamp(0.0, 1.0);
    [a[0] + t * along[0], a[1] + t * along[1]]
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Rect = Rect { min: [0.0, 0.0], max: [1.0, 1.0] };

    #[test]
    fn lines_are_cut_at_the_border() {
        let line = [[-1.0, 0.5], [0.5, 0.5], [0.5, 3.0], [0.75, 3.0], [0.75, 0.5]];
        let pieces = clip_line(&line, &UNIT);
        assert_eq!(
            pieces,
            [vec![[0.0, 0.5], [0.5, 0.5], [0.5, 1.0]], vec![[0.75, 1.0], [0.75, 0.5]]]
        );
        assert!(clip_line(&[[-1e150, 2.0], [1e150, 2.0]], &UNIT).is_empty());
        assert_eq!(clip_line(&[[-1e12, 0.5], [1e12, 0.5]], &UNIT).len(), 1);
    }

    #[test]
    fn rings_inside_stay_whole() {
        let ring = [[0.2, 0.2], [0.8, 0.2], [0.5, 0.8], [0.2, 0.2]];
        assert_eq!(clip_line(&ring, &UNIT), [ring.to_vec()]);
        let cut = [[0.5, 0.5], [2.0, 0.5], [2.0, 0.7], [0.5, 0.7], [0.5, 0.5]];
        assert_eq!(clip_line(&cut, &UNIT).len(), 1);
    }

    #[test]
    fn filled_rings_are_cut_at_the_border() {
        let ring = [[-1.0, -1.0], [0.5, -1.0], [0.5, 2.0], [-1.0, 2.0]];
        let area: f64 = {
            let cut = clip_ring(&ring, &UNIT);
            (0..cut.len())
                .map(|k| (cut[k], cut[(k + 1) % cut.len()]))
                .map(|(a, b)| (a[0] * b[1] - b[0] * a[1]) / 2.0)
                .sum()
        };
        assert_eq!(area.abs(), 0.5);
        assert!(clip_ring(&[[2.0, 2.0], [3.0, 2.0], [3.0, 3.0]], &UNIT).is_empty());
    }

    #[test]
    fn holes_are_not_within() {
        let rings = [UNIT.grown(1.0).corners().to_vec(), UNIT.corners().to_vec()];
        assert!(is_within([-0.5, 0.3], &rings) && is_within([0.3, 1.7], &rings));
        assert!(!is_within([0.2, 0.7], &rings) && !is_within([2.5, 0.7], &rings));
    }

    #[test]
    fn simplification_stays_within_its_tolerance() {
        let circle: Vec<Point> = (0..=1000)
            .map(|i| f64::from(i).to_radians() * 0.36)
            .map(|a| [a.cos(), a.sin()])
            .collect();
        let simple = simplify(&circle, 1e-3);
        assert!(simple.len() <= 129, "{}", simple.len());
        for p in circle {
            let nearest = simple
                .windows(2)
                .map(|pair| distance_to_segment(p, pair[0], pair[1]))
                .fold(f64::INFINITY, f64::min);
            assert!(nearest <= 1e-3);
        }
    }
}
