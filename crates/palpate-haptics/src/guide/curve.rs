// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Guides along curves.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use palpate_device::NumberError;
use palpate_field::{Aabb, Point, Vector};

use super::target::{Closest, Target};
use super::well::Well;
use super::{Guide, Kind, finite};
use crate::error::HapticsError;

/// The most segments of a curve: a tick has time for all of them even if no group can be
/// skipped.
const MOST_SEGMENTS: usize = 1024;

/// Segments in a bounding ball: smaller groups need more balls, larger groups make the balls
/// less tight.
const GROUP: usize = 16;

/// Segments between two points of a smooth curve.
const PIECES: usize = 16;

/// A curve through points: a polyline, or smooth.
///
/// The closest point moves continuously with the hand, except where the hand is equally far
/// from two parts of the curve: there the closest point jumps from one part to the other.
///
/// ```
/// use palpate_field::Vector;
/// use palpate_haptics::{Curve, Guide, GuideOptions};
///
/// # fn main() -> Result<(), palpate_haptics::HapticsError> {
/// let corner = [[0.0, 1.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0]].map(Vector);
/// let mut guide = Guide::along_curve(Curve::polyline(&corner)?, GuideOptions::default())?;
/// let force = guide.force(Vector([0.5, 0.00390625, 0.0]), Vector([0.25, 0.0, 0.0]));
/// assert_eq!(force, Vector([0.0, -1.171875, 0.0])); // 300/256 N
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Curve {
    segments: Vec<Segment>,
    /// Centre and radius of a ball around each [`GROUP`] of segments.
    balls: Vec<(Point<3>, f64)>,
    deviation: f64,
}

#[derive(Clone, Copy, Debug)]
struct Segment {
    from: Point<3>,
    tangent: Vector<f64, 3>,
    length: f64,
}

impl Curve {
    /// A polyline through the points [m]; points that repeat their predecessor are left out.
    ///
    /// # Errors
    ///
    /// [`HapticsError::NoCurve`] without two different points;
    /// [`HapticsError::Number`] with more than 1025, or if a coordinate is not finite.
    #[inline(never)]
    pub fn polyline(points: &[Point<3>]) -> Result<Self, HapticsError> {
        if points.len() > MOST_SEGMENTS + 1 {
            return Err(too_many(points.len(), "at most 1025"));
        }
        for point in points {
            finite("points", *point)?;
        }
        let pairs = points.iter().zip(points.iter().skip(1));
        let segments: Vec<_> = pairs
            .filter_map(|(from, to)| {
                let way = *to - *from;
                let tangent = way.normalized()?;
                Some(Segment { from: *from, tangent, length: way.norm() })
            })
            .collect();
        if segments.is_empty() {
            return Err(HapticsError::NoCurve { count: points.len().min(1) });
        }
        let balls = segments.chunks(GROUP).map(ball_around).collect();
        Ok(Self { segments, balls, deviation: 0.0 })
    }

    /// A smooth curve through the points [m], by the cubics of Catmull and Rom, "A class of
    /// local interpolating splines" (1974): the tangent at each point is half the difference of
    /// its two neighbours; at an end it is the difference to its one neighbour.
    ///
    /// Each cubic is kept as 16 straight pieces: see [`deviation`](Self::deviation).
    ///
    /// # Errors
    ///
    /// As [`polyline`](Self::polyline), with more than 65 points.
    #[inline(never)]
    pub fn smooth(points: &[Point<3>]) -> Result<Self, HapticsError> {
        if points.len() > MOST_SEGMENTS / PIECES + 1 {
            return Err(too_many(points.len(), "at most 65"));
        }
        let at = |i: usize| points.get(i).copied();
        let mut path: Vec<_> = at(0).into_iter().collect();
        let mut deviation: f64 = 0.0;
        for i in 1..points.len() {
            let (Some(from), Some(to)) = (at(i - 1), at(i)) else { break };
            let before = i.checked_sub(2).and_then(at).unwrap_or(from);
            let after = at(i + 1).unwrap_or(to);
            let (leave, arrive) = ((to - before) * 0.5, (after - from) * 0.5);
            let way = to - from;
            for piece in 1..=PIECES {
                let t = piece as f64 / PIECES as f64;
                // Hermite's basis.
                let step = t * t * (3.0 - 2.0 * t);
                let (rise, fall) = (t * (1.0 - t) * (1.0 - t), t * t * (t - 1.0));
                path.push(if piece == PIECES {
                    to
                } else {
                    from + way * step + leave * rise + arrive * fall
                });
            }
            // The second derivative is linear in t, so largest at an end; a chord over a step h
            // deviates by at most h²/8 of the second derivative.
            let bends = [
                way * 6.0 - leave * 4.0 - arrive * 2.0,
                way * -6.0 + leave * 2.0 + arrive * 4.0,
            ];
            let bend = bends.iter().map(|bend| bend.norm()).fold(0.0, f64::max);
            deviation = deviation.max(bend / (8 * PIECES * PIECES) as f64);
        }
        let polyline = Self::polyline(&path)?;
        Ok(Self { deviation, ..polyline })
    }

    /// The largest distance between this curve and the exact cubics [m]; zero for a polyline.
    #[must_use]
    pub fn deviation(&self) -> f64 {
        self.deviation
    }

    /// The ends of all segments, in order [m].
    pub(super) fn corners(&self) -> Vec<Point<3>> {
        let starts = self.segments.iter().map(|segment| segment.from);
        let end = self.segments.last().map(|last| last.from + last.tangent * last.length);
        starts.chain(end).collect()
    }

    /// The closest point; the first along the curve if several are equally close.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic; looks at 64 balls and 1024
    /// segments at most.
    pub(super) fn closest(&self, position: Point<3>) -> Closest {
        let mut best = (f64::INFINITY, Closest::on_curve(position, None));
        let last = self.segments.len() - 1;
        let groups = self.segments.chunks(GROUP).zip(&self.balls).enumerate();
        for (group, (segments, (centre, radius))) in groups {
            if (*centre - position).norm() - radius > best.0 {
                continue;
            }
            for (i, segment) in segments.iter().enumerate() {
                let i = group * GROUP + i;
                let wanted = (position - segment.from).dot(segment.tangent);
                let along = wanted.clamp(0.0, segment.length);
                let point = segment.from + segment.tangent * along;
                let distance = (point - position).norm();
                if distance < best.0 {
                    let at_end =
                        (i == 0 && wanted < 0.0) || (i == last && wanted > segment.length);
                    let tangent = (!at_end).then_some(segment.tangent);
                    best = (distance, Closest::on_curve(point, tangent));
                }
            }
        }
        best.1
    }
}

fn too_many(count: usize, rule: &'static str) -> HapticsError {
    HapticsError::Number(NumberError::new("points", rule, count as f64, "points"))
}

/// A ball around segments that follow one another.
fn ball_around(segments: &[Segment]) -> (Point<3>, f64) {
    let ends = || segments.iter().flat_map(|s| [s.from, s.from + s.tangent * s.length]);
    let mut centre = Vector::ZERO;
    for end in ends() {
        centre += end * (0.5 / segments.len() as f64);
    }
    let radius = ends().map(|end| (end - centre).norm()).fold(0.0, f64::max);
    // Enlarged, so that rounding cannot put a segment outside its ball.
    (centre, radius * (1.0 + 1e-12) + 1e-12 * centre.norm())
}

/// The size of the cross at a point, as a part of the half diagonal of the box.
const CROSS: f64 = 0.03;

/// Corners of a circle: smooth at the size of a picture.
const CORNERS: u32 = 96;

impl Guide {
    /// What reports call the guide: `"point"`, `"line"`, `"plane"`, `"curve"` (segments too),
    /// `"well"` or `"slope"`.
    ///
    /// ```
    /// use palpate_haptics::{Guide, GuideOptions};
    /// let well = Guide::well([0.0, 0.1, 0.0], 0.05, GuideOptions::default())?;
    /// assert_eq!(well.kind_name(), "well");
    /// # Ok::<(), palpate_haptics::HapticsError>(())
    /// ```
    #[must_use]
    pub fn kind_name(&self) -> &'static str {
        match &self.kind {
            Kind::Target(Target::Point(_)) => "point",
            Kind::Target(Target::Line { .. }) => "line",
            Kind::Target(Target::Plane { .. }) => "plane",
            Kind::Target(Target::Curve(_)) => "curve",
            Kind::Well(_) => "well",
            Kind::Slope(_) => "slope",
        }
    }

    /// Lines that show where the guide is [m], each a list of its corners: a cross at a point, of
    /// 6 % of the diagonal of the box `within`; a line and the lines of a plane, cut off at that
    /// box; a curve, and circles at the reach of a well, whole. A slope has none. The box of a planar
    /// scene has no extent along z, and no lines go along z.
    ///
    /// ```
    /// use palpate_field::{Aabb, Vector};
    /// use palpate_haptics::{Guide, GuideOptions};
    /// let options = GuideOptions::default();
    /// let guide = Guide::along_line([0.0, 0.5, 0.0], [2.0, 0.0, 0.0], options)?;
    /// let lines = guide.lines_within(&Aabb::centred(Vector([1.0, 2.0, 0.0])));
    /// assert_eq!(lines, [[Vector([-1.0, 0.5, 0.0]), Vector([1.0, 0.5, 0.0])]]);
    /// # Ok::<(), palpate_haptics::HapticsError>(())
    /// ```
    #[must_use]
    #[inline(never)]
    pub fn lines_within(&self, within: &Aabb<3>) -> Vec<Vec<Point<3>>> {
        match &self.kind {
            Kind::Target(Target::Point(point)) => {
                let arm = CROSS * within.half_extents().norm();
                let cross = |axis| {
                    vec![*point - Vector::unit(axis) * arm, *point + Vector::unit(axis) * arm]
                };
                axes_of(within).map(cross).collect()
            }
            Kind::Target(Target::Line { through, direction }) => {
                clipped(*through, *direction, within).into_iter().collect()
            }
            Kind::Target(Target::Plane { through, normal }) => {
                let along = in_plane(*normal);
                let lines =
                    along.into_iter().filter_map(|axis| clipped(*through, axis, within));
                lines.collect()
            }
            Kind::Target(Target::Curve(curve)) => vec![curve.corners()],
            Kind::Well(well) => circles(well, within),
            Kind::Slope(_) => Vec::new(),
        }
    }
}

/// Directions in the plane with this normal, those nearest to axes: one in 2D, two in 3D.
fn in_plane(normal: Vector<f64, 3>) -> Vec<Vector<f64, 3>> {
    let mut known = vec![normal];
    for axis in 0..3 {
        let rest = known.iter().fold(Vector::unit(axis), |rest, k| rest - *k * rest.dot(*k));
        // Of at least one axis half or more is left; a rest of rounding has no direction.
        if rest.norm() > 0.5 && known.len() < 3 {
            known.extend(rest.normalized());
        }
    }
    known.split_off(1)
}

/// The part of a line in a box; `None` if there is none.
fn clipped(
    through: Point<3>,
    direction: Vector<f64, 3>,
    within: &Aabb<3>,
) -> Option<Vec<Point<3>>> {
    let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
    let (min, max) = (within.min.0, within.max.0);
    for (((at, along), low), high) in through.0.iter().zip(direction.0).zip(min).zip(max) {
        if along.abs() < f64::MIN_POSITIVE {
            // Written so that NaN is outside.
            let is_between = *at >= low && *at <= high;
            if !is_between {
                return None;
            }
            continue;
        }
        let (a, b) = ((low - at) / along, (high - at) / along);
        (from, to) = (from.max(a.min(b)), to.min(a.max(b)));
    }
    (from < to).then(|| vec![through + direction * from, through + direction * to])
}

/// The axes along which a box has an extent: two for that of a planar scene.
fn axes_of(within: &Aabb<3>) -> impl Iterator<Item = usize> + Clone + use<> {
    let half = within.half_extents();
    (0..3).filter(move |axis| half[*axis] > 0.0)
}

/// Circles at the reach of a well, one in each plane of two axes along which the box has an extent.
fn circles(well: &Well, within: &Aabb<3>) -> Vec<Vec<Point<3>>> {
    let (centre, radius) = (well.centre, well.reach);
    let axes = axes_of(within);
    let after = |a| axes.clone().filter(move |b| *b > a);
    let pairs = axes.clone().flat_map(|a| after(a).map(move |b| (a, b)));
    let circle = |(a, b): (usize, usize)| {
        let corner = |i: u32| {
            let (sin, cos) = libm::sincos(TAU * f64::from(i) / f64::from(CORNERS));
            centre + (Vector::unit(a) * cos + Vector::unit(b) * sin) * radius
        };
        (0..=CORNERS).map(corner).collect()
    };
    pairs.map(circle).collect()
}

#[cfg(test)]
#[expect(clippy::indexing_slicing, reason = "tests know their lengths")]
mod tests {
    use super::*;
    use palpate_testkit::cases::each as cases;

    #[test]
    fn the_closest_point_of_a_long_curve_is_that_of_all_its_segments() {
        let mut points = Vec::new();
        for i in 0..1025 {
            let angle = f64::from(i) * 0.05;
            points.push(Vector([0.1 * angle.cos(), 1e-4 * f64::from(i), 0.1 * angle.sin()]));
        }
        let curve = Curve::polyline(&points).unwrap();
        cases(300, |u| {
            let mut coordinate = || u.int_in_range(-1000..=1000).map(|i| 1.5e-4 * f64::from(i));
            let position = Vector([coordinate()?, coordinate()?, coordinate()?]);
            let found = (curve.closest(position).point - position).norm();
            let nearest = points.windows(2).map(|pair| {
                let way = pair[1] - pair[0];
                let part = (position - pair[0]).dot(way) / way.dot(way);
                (pair[0] + way * part.clamp(0.0, 1.0) - position).norm()
            });
            assert!((found - nearest.fold(f64::INFINITY, f64::min)).abs() < 1e-14);
            Ok(())
        });
    }

    #[test]
    fn a_smooth_curve_passes_its_points_and_says_how_far_off_it_is() {
        let points =
            [[0.0, 0.0, 0.0], [1.0, 2.0, 0.0], [3.0, 2.0, 0.0], [4.0, -1.0, 0.0]].map(Vector);
        let curve = Curve::smooth(&points).unwrap();
        for point in points {
            assert!((curve.closest(point).point - point).norm() < 1e-15);
        }
        // The middle of the second span, by hand: the mean of its ends plus an eighth of the
        // difference of its tangents, (3, 2)/2 and (3, −3)/2.
        let middle = Vector([2.0, 2.0 + 0.3125, 0.0]);
        assert!((curve.closest(middle).point - middle).norm() < 1e-14);
        assert!(curve.deviation() > 0.0 && curve.deviation() < 0.01);
        assert_eq!(Curve::polyline(&points).unwrap().deviation(), 0.0);
    }
}
