// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A curve of short straight segments, and its closest point in bounded time.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_device::NumberError;
use palpate_field::{Point, Vector};

use super::finite;
use super::target::Closest;
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
