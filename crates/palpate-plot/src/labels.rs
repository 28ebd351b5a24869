// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Labels and hatching.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::drawing::{Path, TextStyle};
use crate::geometry::{Point, Rect, clip_segment, distance, distance_to_segment};
use crate::legend::Symbol;
use crate::text::{Anchor, CAP_HEIGHT, Text, Weight};

/// Size of the labels on isolines and points [px].
pub(crate) const SIZE: f64 = 12.0;
/// A label keeps this far from what is around it [px].
const CLEARANCE: f64 = 4.5;
/// Labels of one level are at least this far apart [px].
const REPEAT: f64 = 280.0;
/// Candidates along an isoline are this far apart [px].
const STRIDE: f64 = 5.0;
/// A line is not labelled where it bends more than this over the length of its label [px].
const MOST_BEND: f64 = 4.5;
/// The penalty of a label for each pixel to the nearest label of the level before: labels above
/// one another read as a scale.
const STRAY: f64 = 0.012;

/// Lines this close to vertical count as vertical [rad].
const VERTICAL: f64 = 0.05;

/// Occupied room: discs for symbols and text, and lines.
#[derive(Debug, Default)]
pub(crate) struct Occupied {
    discs: Vec<(Point, f64)>,
    lines: Vec<Vec<Point>>,
}

impl Occupied {
    pub(crate) fn add_disc(&mut self, center: Point, radius: f64) {
        self.discs.push((center, radius));
    }

    pub(crate) fn add_line(&mut self, line: Vec<Point>) {
        self.lines.push(line);
    }

    pub(crate) fn add_text(&mut self, text: &Text<'_>) {
        self.discs.extend(discs(text));
    }

    /// `true` if `text` is clear of all discs, and of all lines if `and_lines`.
    pub(crate) fn is_free(&self, text: &Text<'_>, and_lines: bool) -> bool {
        discs(text).into_iter().all(|(center, radius)| {
            let reach = radius + CLEARANCE;
            let is_off = |line: &Vec<Point>| {
                line.windows(2).all(|ab| distance_to_segment(center, ab[0], ab[1]) >= reach)
            };
            self.discs.iter().all(|&(c, r)| distance(c, center) >= r + reach)
                && (!and_lines || self.lines.iter().all(is_off))
        })
    }
}

/// Discs that cover a text, turned by its angle.
fn discs(text: &Text<'_>) -> Vec<(Point, f64)> {
    let bounds = text.bounds();
    let radius = 0.5 * text.size;
    let (left, right) =
        (bounds.min[0] - text.at[0] + radius, bounds.max[0] - text.at[0] - radius);
    let (left, right) = if left < right { (left, right) } else { ((left + right) / 2.0, left) };
    let count = ((right - left) / radius).ceil().max(1.0);
    let (sin, cos) = text.angle.sin_cos();
    let middle = -CAP_HEIGHT * text.size / 2.0;
    (0..=count as usize)
        .map(|i| {
            let x = left + (right - left).max(0.0) * i as f64 / count;
            ([text.at[0] + cos * x - sin * middle, text.at[1] + sin * x + cos * middle], radius)
        })
        .collect()
}

/// The place of a label on an isoline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Spot {
    /// Middle of the baseline [px].
    pub(crate) at: Point,
    /// The angle [rad], clockwise in the picture.
    pub(crate) angle: f64,
}

impl Spot {
    pub(crate) fn text(self, label: &str) -> Text<'_> {
        let Self { at, angle } = self;
        Text {
            text: label,
            at,
            size: SIZE,
            weight: Weight::Regular,
            anchor: Anchor::Middle,
            angle,
        }
    }
}

/// Spots for `label` along the `lines` of one level, all [px], within `plot`, preferably near
/// the spots of the level before; marks them as occupied.
pub(crate) fn place_on_lines(
    lines: &[Vec<Point>],
    label: &str,
    plot: &Rect,
    neighbours: &[Spot],
    occupied: &mut Occupied,
) -> Vec<Spot> {
    let width = crate::text::width(label, SIZE, Weight::Regular) + 2.0 * CLEARANCE;
    let mut candidates: Vec<(f64, Spot)> =
        lines.iter().flat_map(|line| candidates(line, width)).collect();
    for (penalty, spot) in &mut candidates {
        let strays = neighbours.iter().map(|other| distance(other.at, spot.at));
        let stray = strays.fold(f64::INFINITY, f64::min);
        *penalty += if stray.is_finite() { STRAY * stray } else { 0.0 };
    }
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
    let inner = plot.grown(-SIZE);
    let mut spots: Vec<Spot> = Vec::new();
    for (_, spot) in candidates {
        let text = spot.text(label);
        let is_apart = spots.iter().all(|other| distance(other.at, spot.at) >= REPEAT);
        let is_inside = discs(&text).iter().all(|&(center, _)| inner.contains(center));
        if is_apart && is_inside && occupied.is_free(&text, true) {
            occupied.add_text(&text);
            spots.push(spot);
        }
    }
    spots
}

/// Spots along `line` for a label `width` wide [px], with a penalty for bends and steep text.
fn candidates(line: &[Point], width: f64) -> Vec<(f64, Spot)> {
    let mut lengths = vec![0.0];
    for pair in line.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + distance(pair[0], pair[1]));
    }
    let total = lengths[lengths.len() - 1];
    let count = ((total - 1.2 * width) / STRIDE).floor();
    if count < 1.0 {
        return Vec::new();
    }
    let at = |s: f64| {
        let i = lengths.partition_point(|&l| l <= s).clamp(1, line.len() - 1);
        let span = lengths[i] - lengths[i - 1];
        let t = if span > 0.0 { (s - lengths[i - 1]) / span } else { 0.0 };
        [0, 1].map(|k| line[i - 1][k] + t * (line[i][k] - line[i - 1][k]))
    };
    (0..=count as usize)
        .filter_map(|i| {
            let s = 0.6 * width + i as f64 * STRIDE;
            let (a, b) = (at(s - width / 2.0), at(s + width / 2.0));
            let bend = (-4..=4)
                .map(|k| distance_to_segment(at(s + width * f64::from(k) / 10.0), a, b))
                .fold(0.0, f64::max);
            if bend > MOST_BEND || distance(a, b) < 0.9 * width {
                return None;
            }
            let angle = upright((b[1] - a[1]).atan2(b[0] - a[0]));
            let middle = at(s);
            let down = CAP_HEIGHT * SIZE / 2.0;
            let (sin, cos) = angle.sin_cos();
            let spot = Spot { at: [middle[0] - sin * down, middle[1] + cos * down], angle };
            Some((bend + 1.5 * angle.abs(), spot))
        })
        .collect()
}

/// The angle of a text along a line [rad]: read from left to right, and upwards where the line is
/// vertical.
fn upright(angle: f64) -> f64 {
    if angle > FRAC_PI_2 - VERTICAL {
        angle - PI
    } else if angle < -FRAC_PI_2 - VERTICAL {
        angle + PI
    } else {
        angle
    }
}

/// A place for `label` along the line from `a` to `b` [px], above it or below it, within `plot`;
/// marks it as occupied. `None` if the line is too short, or there is no room.
pub(crate) fn place_along<'a>(
    [a, b]: [Point; 2],
    label: &'a str,
    plot: &Rect,
    occupied: &mut Occupied,
) -> Option<Text<'a>> {
    let style = TextStyle::LEGEND;
    let length = distance(a, b);
    if length < crate::text::width(label, style.size, Weight::SemiBold) {
        return None;
    }
    let angle = upright((b[1] - a[1]).atan2(b[0] - a[0]));
    let (sin, cos) = angle.sin_cos();
    let middle = CAP_HEIGHT * style.size / 2.0;
    let beside = 0.5 * style.size + CLEARANCE + 0.5;
    // From the line to the baseline, downwards.
    let sides = [middle - beside, middle + beside];
    let texts = [0.5, 0.35, 0.65, 0.2, 0.8].into_iter().flat_map(|share| {
        let at = [0, 1].map(|k| a[k] + share * (b[k] - a[k]));
        sides.map(|down| Text {
            text: label,
            at: [at[0] - sin * down, at[1] + cos * down],
            size: style.size,
            weight: Weight::SemiBold,
            anchor: Anchor::Middle,
            angle,
        })
    });
    let inner = plot.grown(-2.0);
    let is_inside = |text: &Text<'_>| discs(text).iter().all(|(at, _)| inner.contains(*at));
    let text = texts.filter(is_inside).find(|text| occupied.is_free(text, true))?;
    occupied.add_text(&text);
    Some(text)
}

/// A place for `label` beside the symbol of a point [px], within `plot`; marks it as occupied.
/// `None` if there is no room.
pub(crate) fn place_at_point<'a>(
    point: Point,
    label: &'a str,
    plot: &Rect,
    occupied: &mut Occupied,
) -> Option<Text<'a>> {
    let style = TextStyle::LEGEND;
    let reach = Symbol::RADIUS + CLEARANCE + 2.0;
    let diagonal = 0.8 * reach;
    let middle = CAP_HEIGHT * style.size / 2.0;
    let places = [
        ([reach, middle], Anchor::Start),
        ([-reach, middle], Anchor::End),
        ([0.0, -reach], Anchor::Middle),
        ([0.0, reach + 2.0 * middle], Anchor::Middle),
        ([diagonal, -diagonal], Anchor::Start),
        ([-diagonal, -diagonal], Anchor::End),
        ([diagonal, diagonal + 2.0 * middle], Anchor::Start),
        ([-diagonal, diagonal + 2.0 * middle], Anchor::End),
    ];
    let texts = places.map(|(offset, anchor)| Text {
        text: label,
        at: [point[0] + offset[0], point[1] + offset[1]],
        size: style.size,
        weight: Weight::SemiBold,
        anchor,
        angle: 0.0,
    });
    let inside = || texts.iter().filter(|text| plot.grown(-2.0).contains_rect(&text.bounds()));
    let text = inside()
        .find(|text| occupied.is_free(text, true))
        .or_else(|| inside().find(|text| occupied.is_free(text, false)))
        .or_else(|| inside().next())?;
    occupied.add_text(text);
    Some(text.clone())
}

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

    const PLOT: Rect = Rect { min: [0.0, 0.0], max: [400.0, 300.0] };

    #[test]
    fn labels_lie_on_their_line_and_off_each_other() {
        let line = vec![vec![[-10.0, 100.0], [410.0, 120.0]]];
        let mut occupied = Occupied::default();
        let first = place_on_lines(&line, "0.25", &PLOT, &[], &mut occupied);
        let second = place_on_lines(&line, "0.25", &PLOT, &[], &mut occupied);
        assert!(!first.is_empty() && !second.is_empty());
        for a in &first {
            assert!(second.iter().all(|b| distance(a.at, b.at) > 30.0));
            assert!((a.angle - 20.0_f64.atan2(420.0)).abs() < 1e-9);
        }
    }

    #[test]
    fn short_and_crooked_lines_have_no_label() {
        let mut occupied = Occupied::default();
        let short = [vec![[50.0, 50.0], [60.0, 50.0]], vec![[50.0, 50.0]], vec![]];
        assert!(place_on_lines(&short, "0.25", &PLOT, &[], &mut occupied).is_empty());
        let circle = (0..=36)
            .map(|i| f64::from(i * 10).to_radians())
            .map(|a| [200.0 + 12.0 * a.cos(), 150.0 + 12.0 * a.sin()])
            .collect();
        assert!(place_on_lines(&[circle], "0.25", &PLOT, &[], &mut occupied).is_empty());
    }

    #[test]
    fn labels_along_a_line_are_above_it_or_below_and_within_its_length() {
        let mut occupied = Occupied::default();
        let upright = [[100.0, 250.0], [100.0, 50.0]];
        occupied.add_line(upright.to_vec());
        let mut place = |label| place_along(upright, label, &PLOT, &mut occupied).unwrap();
        let (first, second) = (place("radius 0.4 m"), place("height 1 m"));
        assert_eq!((first.angle, second.angle), (-FRAC_PI_2, -FRAC_PI_2));
        assert!(first.at[0] < 100.0 && second.at[0] > 100.0);
        let short = [[100.0, 100.0], [120.0, 100.0]];
        assert!(place_along(short, "radius 0.4 m", &PLOT, &mut occupied).is_none());
    }

    #[test]
    fn point_labels_move_aside() {
        let mut occupied = Occupied::default();
        let first = place_at_point([100.0, 100.0], "A", &PLOT, &mut occupied).unwrap();
        let second = place_at_point([100.0, 100.0], "B", &PLOT, &mut occupied).unwrap();
        assert!(first.at[0] > 100.0 && second.at[0] < 100.0);
        let corner = place_at_point([398.0, 2.0], "corner", &PLOT, &mut occupied).unwrap();
        assert!(PLOT.contains_rect(&corner.bounds()));
    }
}

#[cfg(test)]
mod hatch_tests {
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
