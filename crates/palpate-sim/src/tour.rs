// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Tours of hands over bodies.

use std::f64::consts::TAU;

use palpate_device::NumberError;
use palpate_field::{Aabb, Point, Shape, Vector};

use crate::error::SimulationError;
use crate::hand_path::{HandPath, Interpolation};

mod aim;

/// The spacing of an orbit's points, as a part of the hand's detail: small enough that the hand
/// keeps its depth between two points, and that a jump from one body to the next is detected.
const STEP: f64 = 1.0 / 15.0;

/// The grain of a scene, the size of its bodies, is the shortest edge of its box, because
/// bodies stand side by side along the others; but at least this part of the longest edge.
const FINEST_GRAIN: f64 = 0.1;

/// The largest number of points of an orbit: ten minutes of touching take a quarter of it.
const MOST_POINTS: f64 = 1_000_000.0;

/// The most steps of a ray: enough for a surface at a grazing angle.
const RAY_STEPS: u32 = 128;

/// The largest Lipschitz constant by which the steps of a ray are multiplied: a screw thread has 40,
/// and rays over a steeper field would take too long.
const STEEPEST_FIELD: f64 = 64.0;

/// How far the orbit is from the shape's box, as a part of the shape's size.
const ORBIT_HEIGHT: f64 = 0.2;

/// The most that an orbit is lengthened to keep the hand's speed: in a scene with little
/// surface the hand stays slow.
const MOST_STRETCH: f64 = 4.0;

/// A ray has arrived within this part of the shape's size.
const RAY_TOLERANCE: f64 = 1e-6;

/// The surface jumps where its height changes by this multiple of the distance between two
/// points: a slope at which a hand would push against a wall instead of sliding over it.
const STEEPEST: f64 = 4.0;

/// The surface has an edge where the cosine of the angle between two normals is below this. A
/// hand deeper than the probe's radius would leave its proxy behind there.
const SHARPEST: f64 = 0.9;

/// The surface has a lip where the cosine of the angle between the normals of two near points is
/// below this. A hand pressed over a lip would leave its proxy behind: friction holds the proxy
/// back, and in a field that is a bound a lip stays sharp whatever the probe's radius.
const LIP: f64 = 0.5;

/// The lag of a proxy that friction holds back, in depths: a lip within it keeps the proxy.
const LAG: f64 = 2.0;

/// The hand's detail, as a multiple of its depth or the probe's radius: the hand flies over
/// shorter notches and enters longer ones.
const DETAIL: f64 = 5.0;

/// The largest detail, as a part of the grain.
const COARSEST_DETAIL: f64 = 0.08;

/// The clearance in flight, as a part of the detail.
const CLEARANCE: f64 = 0.75;

/// The largest depth of a point of the path, as a multiple of the requested depth. Between two
/// points the hand may go a little deeper.
const DEEPEST: f64 = 1.35;

/// Newton steps of a correction: later steps correct what a blend or a corner left of the
/// first.
const CORRECTIONS: u32 = 4;

/// A gradient shorter than this part of the Lipschitz constant belongs to a ridge and gives no
/// direction.
const LEAST_SLOPE: f64 = 0.1;

/// The most times that the hand is lifted where its path is too deep, each time over a wider
/// part.
const MOST_LIFTS: usize = 8;

/// How much faster the hand flies than it slides.
const FLIGHT_SPEED: f64 = 2.0;

/// The points over which the hand accelerates at the start and decelerates at the end.
const START: f64 = 40.0;

/// The part of its speed with which it starts.
const FIRST_SPEED: f64 = 0.05;

/// How deep the hand presses, as a part of the shape's size.
const DEPTH: f64 = 0.01;

/// The depth that keeps the force continuous over edges, as a part of the probe's radius.
const SMOOTH_DEPTH: f64 = 0.75;

/// A probe up to this part of the radius of the box counts as a point, as a servo's does: pressed to a
/// part of its radius, it would feel nothing. With a larger part, thin probes would be pressed
/// deeper than their radius, and their force would jump at edges.
const POINT_PROBE: f64 = 2e-5;

/// The least time between two samples, as a part of the time for one step of the orbit.
const SHORTEST_STEP: f64 = 0.3;

/// The length of a press and the flight after it, as a part of the shape's size.
const PRESS_LENGTH: f64 = 0.8;

/// The part of a press in which the hand is down; the rest is rising, flying and landing.
const DOWN: f64 = 0.85;

/// A generator of hand paths that tour a shape.
///
/// # Examples
///
/// ```
/// use palpate_field::{Shape, kernel::Ball};
/// use palpate_sim::Tour;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::<3>::from_kernel(Ball::new(0.05)?);
/// let bounds = ball.promise().bounds.ok_or("a ball has bounds")?;
/// let path = Tour::new(bounds.aabb, 10.0)?.over(&ball)?;
/// assert_eq!(path.duration(), 10.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tour {
    bounds: Aabb<3>,
    /// Whether the hand stays in the plane z = 0, in which the box then lies.
    is_flat: bool,
    duration: f64,
    size: f64,
    probe_radius: f64,
    depth: Option<f64>,
    speed: f64,
    /// How far friction lets a proxy lag behind the hand along a surface, in depths.
    lag: f64,
}

impl Tour {
    /// The probe radius of a tour that is given no other [m]: that of a servo's default probe.
    pub const PROBE_RADIUS: f64 = 0.002;

    /// A tour of `duration` [s] of what lies in `bounds`.
    ///
    /// With the size `s` of the box (its longest edge) and by default, the hand slides
    /// at `0.3 √(s · 1 m)` a second (0.1 m/s over a scene of 0.1 m, 0.3 m/s over one of 1 m),
    /// touches with the default probe, and presses `0.01 s` deep, but at most 3/4 of the probe's
    /// radius, so that the force is continuous over every edge. A probe with a radius of at
    /// most 2e-5 of half the diagonal of the box is a point, which is pressed `0.01 s` deep.
    ///
    /// Over planar bodies, whose box is planar, the hand stays in the plane z = 0.
    ///
    /// # Errors
    ///
    /// [`SimulationError::Number`] if the duration or the size of the box is not positive and
    /// finite.
    #[inline(never)]
    pub fn new<const D: usize>(
        bounds: Aabb<D>,
        duration: f64,
    ) -> Result<Self, SimulationError> {
        let edges = bounds.half_extents() * 2.0;
        let size = NumberError::check_positive(
            "size of the box",
            edges.0.into_iter().fold(0.0, f64::max),
            "m",
        )?;
        let duration = NumberError::check_positive("duration", duration, "s")?;
        let probe_radius = Self::PROBE_RADIUS;
        let speed = 0.3 * size.sqrt();
        let (bounds, is_flat) = (bounds.in_space(), D == 2);
        let (depth, lag) = (None, LAG);
        Ok(Self { bounds, is_flat, duration, size, probe_radius, depth, speed, lag })
    }

    /// This tour with another probe radius [m]; depths are below the surface offset by it.
    ///
    /// # Errors
    ///
    /// [`SimulationError::Number`] if the radius is negative or not finite.
    pub fn with_probe_radius(self, radius: f64) -> Result<Self, SimulationError> {
        Ok(Self {
            probe_radius: NumberError::check_not_negative("radius", radius, "m")?,
            ..self
        })
    }

    /// This tour with another depth [m].
    ///
    /// # Errors
    ///
    /// [`SimulationError::Number`] if the depth is negative or not finite.
    pub fn with_depth(self, depth: f64) -> Result<Self, SimulationError> {
        Ok(Self { depth: Some(NumberError::check_not_negative("depth", depth, "m")?), ..self })
    }

    /// This tour with another speed of the hand over the surface [m/s]; the speed in flight is
    /// twice as large.
    ///
    /// # Errors
    ///
    /// [`SimulationError::Number`] if the speed is not positive and finite.
    pub fn with_speed(self, speed: f64) -> Result<Self, SimulationError> {
        Ok(Self { speed: NumberError::check_positive("speed", speed, "m/s")?, ..self })
    }

    /// The path over `shape`: smooth, with continuous velocity, the same for the same input.
    ///
    /// The hand winds about the box from its foot up to the pole and back, or once up in fewer
    /// turns if the time is short. From each point of this orbit a ray towards the core of the
    /// box (the box shrunk by its shortest half edge, so that long and flat scenes are touched
    /// all over) finds the surface that is seen from there. The hand presses into the surface
    /// for some time, rises, flies and lands again; it also rises where the surface jumps from
    /// one body to another. In space no ray starts below the box (y points up), where a scene
    /// has its table.
    ///
    /// Where the path is too deep, it is corrected along the field's gradient; where it still
    /// exceeds 1.35 times the requested depth, the hand is lifted into flight, which is as free
    /// as its rays. So no point of the path is deeper. Two exceptions: between two points of
    /// the path the shape may rise, and a shape may reach out of the box to where the hand
    /// flies.
    ///
    /// # Errors
    ///
    /// [`SimulationError::NothingToTouch`] if no ray meets a surface.
    #[inline(never)]
    pub fn over(&self, shape: &Shape<3>) -> Result<HandPath, SimulationError> {
        // The hand is nearer to the shape than its orbit, so its path is shorter; the second
        // orbit is longer by the same factor.
        let way = self.speed * self.duration;
        let first = self.follow(shape, way)?;
        let factor = (way / first.travelled()).clamp(1.0, MOST_STRETCH);
        let route = self.follow(shape, way * factor)?;
        let times = route.passed.iter().map(|part| self.duration * (part / route.travelled()));
        HandPath::new(times.collect(), route.positions, Interpolation::Smooth)
    }

    /// The size of the bodies in the box [m].
    fn grain(&self) -> f64 {
        (2.0 * self.shortest()).max(FINEST_GRAIN * self.size)
    }

    /// The shortest half edge of the box in which the hand moves [m].
    fn shortest(&self) -> f64 {
        let dimensions = if self.is_flat { 2 } else { 3 };
        let half = self.bounds.half_extents().0.into_iter().take(dimensions);
        half.fold(f64::INFINITY, f64::min)
    }

    /// The depth to which the hand presses [m].
    fn depth(&self) -> f64 {
        let felt = DEPTH * self.size;
        let is_ball = self.probe_radius > POINT_PROBE * self.bounds.half_extents().norm();
        let smooth = if is_ball { SMOOTH_DEPTH * self.probe_radius } else { felt };
        self.depth.unwrap_or(felt.min(smooth))
    }

    /// The length below which the hand does not follow the shape [m].
    fn detail(&self) -> f64 {
        let coarsest = COARSEST_DETAIL * self.grain();
        let detail = DETAIL * self.depth().max(self.probe_radius);
        if detail > 0.0 { detail.min(coarsest) } else { coarsest }
    }

    /// The path of the hand for an orbit of length `way` [m].
    fn follow(&self, shape: &Shape<3>, way: f64) -> Result<Route, SimulationError> {
        let count = (way / (STEP * self.detail())).clamp(100.0, MOST_POINTS) as usize;
        let step = way / count as f64;
        let height = ORBIT_HEIGHT * self.size + self.probe_radius;
        let sights = orbit(&self.bounds, self.is_flat, height, step, count)
            .map(|from| self.look(shape, from))
            .collect();
        self.pressed(shape, sights, step)
    }

    /// The path of the hand over what rays see whose feet are `step` apart [m].
    fn pressed(
        &self,
        shape: &Shape<3>,
        mut sights: Vec<Sight>,
        step: f64,
    ) -> Result<Route, SimulationError> {
        if sights.iter().all(|s| s.seen.is_none()) {
            return Err(SimulationError::NothingToTouch);
        }
        let window = ((0.5 * self.detail() / step).ceil() as usize).max(1);
        let mut press = self.presses(&sights, step, window);
        bridge(&mut sights);
        let mut positions = self.positions(shape, &sights, &press, window);
        for lift in 1..=MOST_LIFTS {
            let deep = self.too_deep(shape, &positions);
            if deep.iter().all(|deep| *deep == 0.0) {
                break;
            }
            let lifted = smoothed(&highest(&deep, 2 * (lift + 1) * window), lift * window);
            press.iter_mut().zip(lifted).for_each(|(press, lift)| *press *= ease(1.0 - lift));
            positions = self.positions(shape, &sights, &press, window);
        }
        Ok(Route { passed: passed(&positions, &press, step, window), positions })
    }

    /// The smooth path with the depth that `press` gives, corrected by the field.
    ///
    /// Smoothing cuts corners, and the correction by the field makes new ones. So both are done
    /// twice, the second time over half the width, and the remaining corners are smoothed once
    /// more over a quarter of the width.
    fn positions(
        &self,
        shape: &Shape<3>,
        sights: &[Sight],
        press: &[f64],
        window: usize,
    ) -> Vec<Point<3>> {
        let clearance = CLEARANCE * self.detail();
        let height: Vec<f64> = sights.iter().map(|sight| sight.height).collect();
        // As wide before as after all smoothing, so that the flight is nowhere below the surface.
        let flight = smoothed(&highest(&height, 8 * window), 2 * window);
        let positions: Vec<Point<3>> = (0..sights.len())
            .map(|i| {
                let touching = height[i] - self.depth();
                let flying = flight[i] + clearance;
                let height = flying + (touching - flying) * press[i];
                sights[i].foot + sights[i].up * height
            })
            .collect();
        let correct = |positions: Vec<Point<3>>| -> Vec<Point<3>> {
            let levels = press.iter().map(|press| -self.depth() * press);
            let positions = positions.into_iter().zip(levels);
            positions.map(|(point, level)| self.corrected(shape, point, level)).collect()
        };
        let positions = correct(smoothed_points(&positions, window));
        let positions = correct(smoothed_points(&positions, (window / 2).max(1)));
        smoothed_points(&positions, (window / 4).max(1))
    }

    /// `point`, or the point up the gradient from it that is `level` above the offset surface [m]
    /// if it is lower. At most as far away as the hand's detail.
    fn corrected(&self, shape: &Shape<3>, point: Point<3>, level: f64) -> Point<3> {
        let lipschitz = shape.promise().lipschitz;
        let mut corrected = point;
        for _ in 0..CORRECTIONS {
            let (value, gradient) = shape.distance_gradient(corrected);
            let missing = level + self.probe_radius - value;
            let slope = gradient.norm();
            // Written so that NaN ends the search.
            let leads_out = missing > 0.0 && slope > LEAST_SLOPE * lipschitz;
            if !leads_out {
                break;
            }
            let next = corrected + gradient * (missing / (slope * slope));
            let is_near = (next - point).norm() <= self.detail();
            if !is_near {
                break;
            }
            corrected = next;
        }
        corrected
    }

    /// 1 for each point that is deeper than it may be, or halfway to its neighbour is, or is
    /// further from it than the surface is steep, or shortly before a lip; 0 for the others.
    fn too_deep(&self, shape: &Shape<3>, positions: &[Point<3>]) -> Vec<f64> {
        let deepest = DEEPEST * self.depth() + RAY_TOLERANCE * self.size;
        let lowest = self.probe_radius - deepest;
        let reach = self.lag * self.depth();
        (0..positions.len())
            .map(|i| {
                let (here, next) = (positions[i], positions[(i + 1).min(positions.len() - 1)]);
                let halfway = (here + next) * 0.5;
                let is_deep = shape.distance(here) < lowest || shape.distance(halfway) < lowest;
                let is_far = (next - here).norm() > 0.5 * self.detail();
                let ahead = positions[i + 1..].iter().find(|p| (**p - here).norm() >= reach);
                let is_over = ahead.is_some_and(|ahead| self.crosses_lip(shape, here, *ahead));
                f64::from(u8::from(is_deep || is_far || is_over))
            })
            .collect()
    }

    /// `true` if the hand touches or nearly touches at both points, and the surface turns by
    /// [`LIP`] between them. Nearly, because a lip may be touched for less than a step.
    fn crosses_lip(&self, shape: &Shape<3>, here: Point<3>, next: Point<3>) -> bool {
        let near = self.probe_radius + 2.0 * STEP * self.detail();
        let normal = |point: Point<3>| {
            let (value, gradient) = shape.distance_gradient(point);
            if value < near { gradient.normalized() } else { None }
        };
        match (normal(here), normal(next)) {
            (Some(a), Some(b)) => a.dot(b) < LIP && (b - a).dot(next - here) > 0.0,
            _ => false,
        }
    }

    /// Casts the ray from a point of the orbit.
    fn look(&self, shape: &Shape<3>, from: Point<3>) -> Sight {
        let (half, thinnest) = (self.bounds.half_extents(), self.shortest());
        let centre = self.bounds.centre();
        let core = Vector(half.0.map(|half| (half - thinnest).max(0.0)));
        let foot = centre
            + Vector(std::array::from_fn(|i| {
                (from.0[i] - centre.0[i]).clamp(-core.0[i], core.0[i])
            }));
        let length = (from - foot).norm();
        let up = (from - foot) * (1.0 / length);
        let seen = self.trace(shape, from, up, length);
        let height = seen.as_ref().map_or(0.0, |seen| seen.height);
        Sight { foot, up, height, seen }
    }

    /// The ray that comes down from `length` above `foot` [m], against `up`. A ray that begins in
    /// a body sees nothing.
    fn look_down(
        &self,
        shape: &Shape<3>,
        foot: Point<3>,
        up: Vector<f64, 3>,
        length: f64,
    ) -> Sight {
        let seen = self.trace(shape, foot + up * length, up, length);
        let seen = seen.filter(|seen| seen.height < length);
        let height = seen.as_ref().map_or(0.0, |seen| seen.height);
        Sight { foot, up, height, seen }
    }

    /// The first offset surface along the ray; `None` if the ray reaches its foot.
    fn trace(
        &self,
        shape: &Shape<3>,
        from: Point<3>,
        up: Vector<f64, 3>,
        length: f64,
    ) -> Option<Seen> {
        let lipschitz = shape.promise().lipschitz;
        let tolerance = RAY_TOLERANCE * self.size;
        let mut height = length;
        // Steps are shorter by the steepness, and as many more are needed.
        let steps = (f64::from(RAY_STEPS) * lipschitz.clamp(1.0, STEEPEST_FIELD)) as u32;
        for _ in 0..steps {
            let point = from - up * (length - height);
            let gap = shape.distance(point) - self.probe_radius;
            if gap <= tolerance {
                let (_, gradient) = shape.distance_gradient(point);
                return Some(Seen { height, normal: gradient.normalized().unwrap_or(up) });
            }
            height -= gap / lipschitz;
            if height.is_nan() || height < 0.0 {
                return None;
            }
        }
        None
    }

    /// The press at each point, from 0 in flight to 1 at full depth: down most of the time, up
    /// where the surface jumps or ends.
    fn presses(&self, sights: &[Sight], step: f64, window: usize) -> Vec<f64> {
        let last = sights.len() - 1;
        let jumps = |i: usize| match (&sights[i].seen, &sights[(i + 1).min(last)].seen) {
            (Some(a), Some(b)) => {
                let is_edge = a.normal.dot(b.normal) < SHARPEST;
                let slips = is_edge && self.depth() > self.probe_radius;
                slips || (b.height - a.height).abs() > STEEPEST * step
            }
            _ => true,
        };
        let near_jump: Vec<f64> = (0..=last).map(|i| f64::from(u8::from(jumps(i)))).collect();
        let near_jump = smoothed(&highest(&near_jump, window), (window / 2).max(1));
        // Whole presses, so that the path begins and ends in flight.
        let way = step * sights.len() as f64;
        let count = (way / (PRESS_LENGTH * self.size)).round().max(1.0);
        near_jump
            .iter()
            .enumerate()
            .map(|(i, jump)| {
                let phase = (i as f64 / sights.len() as f64 * count).fract();
                envelope(phase) * ease((1.0 - jump).clamp(0.0, 1.0))
            })
            .collect()
    }
}

/// Positions of the hand, and the length of the path to each [m]; lengths in flight count less,
/// because the hand is faster there.
struct Route {
    positions: Vec<Point<3>>,
    passed: Vec<f64>,
}

impl Route {
    fn travelled(&self) -> f64 {
        self.passed[self.passed.len() - 1]
    }
}

/// A ray from a point of the orbit: its foot, its direction upwards, the height above which it
/// is free [m], and the surface at that height, if it meets one.
struct Sight {
    foot: Point<3>,
    up: Vector<f64, 3>,
    height: f64,
    seen: Option<Seen>,
}

/// A surface: its height above the foot of the ray [m] and its unit normal.
struct Seen {
    height: f64,
    normal: Vector<f64, 3>,
}

/// Gives rays that meet no surface the heights of a straight line over the gap, so that the
/// hand does not go down and up again.
fn bridge(sights: &mut [Sight]) {
    let seen: Vec<usize> = (0..sights.len()).filter(|&i| sights[i].seen.is_some()).collect();
    let (Some(&first), Some(&last)) = (seen.first(), seen.last()) else { return };
    let (start, end) = (sights[first].height, sights[last].height);
    sights[..first].iter_mut().for_each(|sight| sight.height = start);
    sights[last + 1..].iter_mut().for_each(|sight| sight.height = end);
    for pair in seen.windows(2) {
        let (from, to) = (sights[pair[0]].height, sights[pair[1]].height);
        let gap = (pair[1] - pair[0]) as f64;
        for (i, sight) in (0_u32..).zip(&mut sights[pair[0]..pair[1]]) {
            sight.height = from + (to - from) * (f64::from(i) / gap);
        }
    }
}

/// The length of the path to each point [m]; lengths in flight count less, because the hand is
/// faster there.
fn passed(positions: &[Point<3>], press: &[f64], step: f64, window: usize) -> Vec<f64> {
    let last = positions.len() - 2;
    let ways: Vec<f64> = positions.windows(2).map(|pair| (pair[1] - pair[0]).norm()).collect();
    // Where the hand reverses, the path is short, but the hand needs time.
    let steady = smoothed(&ways, 2 * window);
    let ways =
        ways.iter().zip(steady).zip(press).enumerate().map(|(i, ((way, steady), press))| {
            let from_end = i.min(last - i) as f64;
            let start = FIRST_SPEED + (1.0 - FIRST_SPEED) * ease((from_end / START).min(1.0));
            let haste = (FLIGHT_SPEED + (1.0 - FLIGHT_SPEED) * press) * start;
            way.max(steady) / haste
        });
    let sums = ways.scan(0.0, |sum, way| {
        *sum += way.max(SHORTEST_STEP * step);
        Some(*sum)
    });
    std::iter::once(0.0).chain(sums).collect()
}

/// A rise from 0 to 1 with zero slope at both ends: `3u² − 2u³`.
fn ease(u: f64) -> f64 {
    u * u * (3.0 - 2.0 * u)
}

/// The depth over a press: 0 at both ends, 1 in between.
fn envelope(phase: f64) -> f64 {
    let from_end = phase.min(1.0 - phase) * 2.0;
    ease((from_end / (1.0 - DOWN)).clamp(0.0, 1.0))
}

/// The maximum within `window` places of each value.
fn highest(values: &[f64], window: usize) -> Vec<f64> {
    (0..values.len())
        .map(|i| {
            let (from, to) = around(i, window, values.len());
            values[from..to].iter().copied().fold(f64::NEG_INFINITY, f64::max)
        })
        .collect()
}

/// The moving mean over `window` places on both sides, taken twice, which removes corners.
fn smoothed(values: &[f64], window: usize) -> Vec<f64> {
    let points: Vec<Vector<f64, 1>> = values.iter().map(|v| Vector([*v])).collect();
    smoothed_points(&points, window).into_iter().map(|v| v.0[0]).collect()
}

/// The moving mean of points, taken twice.
fn smoothed_points<const D: usize>(points: &[Vector<f64, D>], window: usize) -> Vec<Point<D>> {
    mean_around(&mean_around(points, window), window)
}

fn mean_around<const D: usize>(points: &[Vector<f64, D>], window: usize) -> Vec<Point<D>> {
    (0..points.len())
        .map(|i| {
            let (from, to) = around(i, window, points.len());
            let sum = points[from..to].iter().fold(Vector::ZERO, |sum, p| sum + *p);
            sum * (1.0 / (to - from) as f64)
        })
        .collect()
}

/// The places within `window` of place `i`; symmetric, and fewer near an end.
fn around(i: usize, window: usize, count: usize) -> (usize, usize) {
    let window = window.min(i).min(count - 1 - i);
    (i - window, i + window + 1)
}

/// The most turns about the axis in a pass from end to end: neighbouring turns are then a
/// twelfth of the shape apart. Not a whole number, so that passes interleave.
const MOST_TURNS: f64 = 6.18;

/// The fewest turns in a pass, however short the orbit: with fewer the hand would climb one
/// side and miss the others.
const FEWEST_TURNS: f64 = 0.62;

/// Points at which the length of a pass is measured: at least 40 a turn, so that the error is
/// below one per cent.
const PASS_POINTS: u32 = 256;

/// Bisections for the turns of a pass: to a thousandth of a turn.
const HALVINGS: u32 = 12;

/// The highest latitude of an orbit, as a part of that of the pole.
const HIGHEST_LATITUDE: f64 = 0.97;

/// The lowest latitude, as a part of that of the other pole: where a turn begins to pass below
/// the box, at `tan⁻¹ √½` of a quarter turn.
const LOWEST_LATITUDE: f64 = 0.39;

/// Points `step` apart [m] on a box `height` [m] around the scene. In space the orbit winds
/// from the foot of the box to its upper pole and back, and no point is below the box, where
/// the table is. In the plane the orbit goes round the box.
///
/// An orbit too short for a pass of [`MOST_TURNS`] is one pass with fewer turns, so that the
/// hand reaches the sides and the top of the shape in any time.
fn orbit(
    bounds: &Aabb<3>,
    is_flat: bool,
    height: f64,
    step: f64,
    count: usize,
) -> impl Iterator<Item = Point<3>> {
    let grown = bounds.grown(height);
    let (mut centre, mut half) = (grown.centre(), grown.half_extents());
    let turns = if is_flat {
        half.0[2] = 0.0;
        None
    } else {
        centre.0[1] += 0.5 * height;
        half.0[1] -= 0.5 * height;
        Some(turns_a_pass(centre, half, step * count as f64))
    };
    // The step in angle is adapted to the distance of the last step.
    let mut angle = 0.0;
    let mut rate = step / half.norm();
    let mut here = on_box(direction(angle, turns), centre, half);
    (0..=count).map(move |_| {
        let result = here;
        let ahead = on_box(direction(angle + rate, turns), centre, half);
        let travelled = (ahead - here).norm();
        rate *= (step / travelled.max(0.1 * step)).clamp(0.5, 2.0);
        angle += rate;
        here = on_box(direction(angle, turns), centre, half);
        result
    })
}

/// The number of turns that makes a pass `way` long [m].
fn turns_a_pass(centre: Point<3>, half: Vector<f64, 3>, way: f64) -> f64 {
    let length = |turns: f64| -> f64 {
        let at = |i: u32| {
            let part = f64::from(i) / f64::from(PASS_POINTS);
            on_box(direction(TAU * turns * part, Some(turns)), centre, half)
        };
        (0..PASS_POINTS).map(|i| (at(i + 1) - at(i)).norm()).sum()
    };
    let (mut low, mut high) = (FEWEST_TURNS, MOST_TURNS);
    if length(high) <= way {
        return high;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if length(middle) <= way {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// The unit vector of the orbit at `angle` [rad], with `turns` turns in a pass; round in the plane,
/// without passes, if that is `None`.
fn direction(angle: f64, turns: Option<f64>) -> Vector<f64, 3> {
    let (sin, cos) = libm::sincos(angle);
    let Some(turns) = turns else { return Vector([sin, cos, 0.0]) };
    // From the foot up to the pole and back.
    let pass = angle / (TAU * turns);
    let risen = 1.0 - 2.0 * ((0.5 * pass).fract() - 0.5).abs();
    let part = risen * (HIGHEST_LATITUDE + LOWEST_LATITUDE) - LOWEST_LATITUDE;
    let (height, radius) = libm::sincos(0.25 * TAU * part);
    Vector([radius * sin, height, radius * cos])
}

/// The point of the box `|pᵢ − cᵢ| ≤ hᵢ` in `direction`, with the box stretched to a cube.
fn on_box(direction: Vector<f64, 3>, centre: Point<3>, half: Vector<f64, 3>) -> Point<3> {
    let largest = direction.0.into_iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    centre + Vector(std::array::from_fn(|i| half.0[i] * direction.0[i] / largest))
}

#[cfg(test)]
mod orbit_tests {
    use super::*;

    /// The heights of the lowest and the highest point of an orbit `way` long [m].
    fn heights(way: f64) -> (f64, f64) {
        let bounds = Aabb { min: Vector([-0.3, 0.0, -0.05]), max: Vector([0.3, 0.1, 0.05]) };
        let points = orbit(&bounds, false, 0.1, 0.001, (way / 0.001) as usize).map(|p| p[1]);
        points.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), y| (l.min(y), h.max(y)))
    }

    #[test]
    fn an_orbit_comes_from_the_foot_to_the_top_however_short_it_is() {
        for way in [2.0, 3.0, 5.0, 9.0, 20.0, 40.0] {
            let (lowest, highest) = heights(way);
            assert!((0.0..0.03).contains(&lowest), "{way} m: {lowest}");
            assert!((highest - 0.2).abs() < 1e-9, "{way} m: {highest}");
        }
    }

    #[test]
    fn a_pass_has_as_many_turns_as_its_way_is_long_for() {
        let half = Vector([0.1, 0.2, 0.3]);
        let turns = |way: f64| turns_a_pass(Vector([1.0, 2.0, 3.0]), half, way);
        assert_eq!(
            (turns(0.1).to_bits(), turns(100.0).to_bits()),
            (FEWEST_TURNS.to_bits(), MOST_TURNS.to_bits())
        );
        let (few, more) = (turns(2.0), turns(4.0));
        assert!(FEWEST_TURNS < few && 1.5 * few < more && more < MOST_TURNS, "{few} {more}");
    }
}
