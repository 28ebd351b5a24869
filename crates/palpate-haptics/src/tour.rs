// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A hand path made up for a shape: around it, over it, into it and away again.

use std::f64::consts::TAU;

use palpate_field::{Aabb, Point, Shape, Vector};

use crate::error::{HapticsError, not_negative, positive};
use crate::hand_path::{HandPath, Interpolation};

/// Points of the orbit looked at for each grain travelled: finer than the smoothing, so that a
/// jump from one body to the next is seen as one.
const POINTS_A_GRAIN: f64 = 100.0;

/// The grain of a scene is the shortest edge of its box, as bodies stand side by side along the
/// others; but no less than this part of the longest.
const FINEST_GRAIN: f64 = 0.1;

/// The largest number of points of an orbit: ten minutes of touching take this many.
const MOST_POINTS: f64 = 200_000.0;

/// The most steps of a ray: what a surface seen at a grazing angle takes.
const RAY_STEPS: u32 = 128;

/// How far the orbit is from the shape's box, as a part of the shape's size.
const ORBIT_HEIGHT: f64 = 0.2;

/// The most an orbit is lengthened for the hand to keep its speed: a scene of which little is
/// touched stays a slow one.
const MOST_STRETCH: f64 = 4.0;

/// A ray has arrived within this part of the shape's size.
const RAY_TOLERANCE: f64 = 1e-6;

/// The surface jumps where its height changes by this many times the way between two points: an
/// angle at which a hand would push against a wall instead of sliding over it.
const STEEPEST: f64 = 2.5;

/// The cosine of the turn of the surface between two points that is an edge, not a bend. A hand
/// deeper than the probe is wide would leave its proxy behind there.
const SHARPEST: f64 = 0.9;

/// How far the hand keeps from the surface in flight, as a part of the grain.
const CLEARANCE: f64 = 0.06;

/// The length over which corners of the path are rounded, likewise.
const SMOOTHING: f64 = 0.08;

/// Turns about the axis for each pass from pole to pole: enough that neighbouring turns are a
/// twelfth of the shape apart. Not a whole number, so that passes interleave.
const TURNS_A_PASS: f64 = 6.18;

/// How much of the way from the box's middle to its pole an orbit goes.
const HIGHEST_LATITUDE: f64 = 0.97;

/// How much faster the hand flies than it slides.
const FLIGHT_SPEED: f64 = 2.0;

/// The points over which the hand takes up its speed, and gives it up at the end.
const START: f64 = 40.0;

/// The part of its speed with which it starts.
const FIRST_SPEED: f64 = 0.05;

/// How deep the hand presses, as a part of the shape's size.
const DEPTH: f64 = 0.01;

/// The depth as a part of the probe's radius that leaves edges smooth.
const SMOOTH_DEPTH: f64 = 0.75;

/// The least time between two samples, as a part of the time for one step of the orbit.
const SHORTEST_STEP: f64 = 1e-3;

/// The length of a press and the flight after it, as a part of the shape's size.
const PRESS_LENGTH: f64 = 0.8;

/// The part of a press in which the hand is down; the rest is rising, flying and landing.
const DOWN: f64 = 0.7;

/// A hand that tours a shape.
///
/// # Examples
///
/// ```
/// use palpate_field::{Shape, kernel::Ball};
/// use palpate_haptics::Tour;
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
pub struct Tour<const D: usize> {
    bounds: Aabb<D>,
    duration: f64,
    size: f64,
    probe_radius: f64,
    depth: Option<f64>,
    speed: f64,
}

impl<const D: usize> Tour<D> {
    /// A tour of `duration` [s] of what lies in `bounds`.
    ///
    /// With the size `s` of the box (its longest edge) and unless asked otherwise, the hand slides
    /// at `0.3 √(s · 1 m)` a second (0.1 m/s over a scene of 0.1 m, 0.3 m/s over one of 1 m),
    /// touches with the default probe, and presses `0.01 s` deep, but at most 3/4 of the probe's
    /// radius, so that the force is continuous over every edge.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the duration or the size of the box is not positive and
    /// finite.
    pub fn new(bounds: Aabb<D>, duration: f64) -> Result<Self, HapticsError> {
        let edges = bounds.half_extents() * 2.0;
        let size = positive("size of the box", edges.0.into_iter().fold(0.0, f64::max), "m")?;
        let duration = positive("duration", duration, "s")?;
        let probe_radius = crate::proxy::Probe::default().radius();
        let speed = 0.3 * size.sqrt();
        Ok(Self { bounds, duration, size, probe_radius, depth: None, speed })
    }

    /// With the probe's radius [m], from which depths are counted.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the radius is negative or not finite.
    pub fn with_probe_radius(self, radius: f64) -> Result<Self, HapticsError> {
        Ok(Self { probe_radius: not_negative("radius", radius, "m")?, ..self })
    }

    /// With another depth to press to [m].
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the depth is negative or not finite.
    pub fn with_depth(self, depth: f64) -> Result<Self, HapticsError> {
        Ok(Self { depth: Some(not_negative("depth", depth, "m")?), ..self })
    }

    /// With another speed of the hand over the surface [m/s]; in flight it is twice that.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the speed is not positive and finite.
    pub fn with_speed(self, speed: f64) -> Result<Self, HapticsError> {
        Ok(Self { speed: positive("speed", speed, "m/s")?, ..self })
    }

    /// The path over `shape`: smooth, with continuous velocity, the same for the same input.
    ///
    /// The hand winds about the box from pole to pole and back. From each point of this orbit a
    /// ray towards the core of the box (the box shrunk by its shortest half edge, so that long
    /// and flat scenes are touched all over) finds the surface that is seen from there. The hand
    /// presses into it for some time, rises, flies and lands again, and rises as well where what
    /// is seen jumps from one body to another.
    ///
    /// # Errors
    ///
    /// [`HapticsError::NothingToTouch`] if no ray meets a surface.
    pub fn over(&self, shape: &Shape<D>) -> Result<HandPath<D>, HapticsError> {
        // The hand is nearer to the shape than its orbit, so it goes a shorter way; the second
        // orbit is as much longer.
        let way = self.speed * self.duration;
        let first = self.follow(shape, way)?;
        let factor = (way / first.travelled()).clamp(1.0, MOST_STRETCH);
        let route = self.follow(shape, way * factor)?;
        let times = route.passed.iter().map(|part| self.duration * (part / route.travelled()));
        HandPath::new(times.collect(), route.positions, Interpolation::Smooth)
    }

    /// The size of what stands in the box [m].
    fn grain(&self) -> f64 {
        let shortest = self.bounds.half_extents().0.into_iter().fold(f64::INFINITY, f64::min);
        (2.0 * shortest).max(FINEST_GRAIN * self.size)
    }

    /// How deep the hand presses [m].
    fn depth(&self) -> f64 {
        let felt = DEPTH * self.size;
        let smooth =
            if self.probe_radius > 0.0 { SMOOTH_DEPTH * self.probe_radius } else { felt };
        self.depth.unwrap_or(felt.min(smooth))
    }

    /// Where the hand goes while its orbit goes `way` [m].
    fn follow(&self, shape: &Shape<D>, way: f64) -> Result<Route<D>, HapticsError> {
        let count = (way / self.grain() * POINTS_A_GRAIN).clamp(100.0, MOST_POINTS) as usize;
        let step = way / count as f64;
        let sights: Vec<Sight<D>> =
            self.orbit(step, count).map(|from| self.look(shape, from)).collect();
        if sights.iter().all(|s| s.seen.is_none()) {
            return Err(HapticsError::NothingToTouch);
        }
        let window = ((0.5 * SMOOTHING * self.grain() / step).ceil() as usize).max(1);
        let press = self.presses(&sights, step, window);
        let height: Vec<f64> = sights.iter().map(Sight::height).collect();
        // As wide before as after smoothing, so that the flight is nowhere below the surface.
        let flight = smoothed(&highest(&height, 4 * window), 2 * window);
        let positions = (0..=count).map(|i| {
            let touching = height[i] - self.depth();
            let flying = flight[i] + CLEARANCE * self.grain();
            let height = flying + (touching - flying) * press[i];
            sights[i].foot + sights[i].up * height
        });
        let positions = smoothed_points(&positions.collect::<Vec<_>>(), window);
        let ways = positions.windows(2).zip(&press).enumerate().map(|(i, (pair, press))| {
            let from_end = i.min(count - 1 - i) as f64;
            let start = FIRST_SPEED + (1.0 - FIRST_SPEED) * ease((from_end / START).min(1.0));
            let haste = (FLIGHT_SPEED + (1.0 - FLIGHT_SPEED) * press) * start;
            (pair[1] - pair[0]).norm() / haste
        });
        // Where the hand turns back, it goes little way, but takes its time.
        let ways = smoothed(&ways.collect::<Vec<_>>(), 2 * window);
        let mut passed = vec![0.0];
        let mut sum = 0.0;
        for way in ways {
            sum += way.max(SHORTEST_STEP * step);
            passed.push(sum);
        }
        Ok(Route { positions, passed })
    }

    /// Points `step` apart [m] on a box around everything, winding from pole to pole.
    fn orbit(&self, step: f64, count: usize) -> impl Iterator<Item = Point<D>> {
        let grown = self.bounds.grown(ORBIT_HEIGHT * self.size + self.probe_radius);
        let (centre, half) = (grown.centre(), grown.half_extents());
        // The angle is advanced by what the last advance travelled.
        let mut angle = 0.0;
        let mut rate = step / half.norm();
        let mut here = on_box(direction(angle), centre, half);
        (0..=count).map(move |_| {
            let result = here;
            let ahead = on_box(direction(angle + rate), centre, half);
            let travelled = (ahead - here).norm();
            rate *= (step / travelled.max(0.1 * step)).clamp(0.5, 2.0);
            angle += rate;
            here = on_box(direction(angle), centre, half);
            result
        })
    }

    /// What is seen from a point of the orbit.
    fn look(&self, shape: &Shape<D>, from: Point<D>) -> Sight<D> {
        let half = self.bounds.half_extents();
        let thinnest = half.0.into_iter().fold(f64::INFINITY, f64::min);
        let centre = self.bounds.centre();
        let core: Vector<f64, D> = Vector(std::array::from_fn(|i| half.0[i] - thinnest));
        let foot = centre
            + Vector(std::array::from_fn(|i| {
                (from.0[i] - centre.0[i]).clamp(-core.0[i], core.0[i])
            }));
        let length = (from - foot).norm();
        let up = (from - foot) * (1.0 / length);
        Sight { foot, up, seen: self.trace(shape, from, up, length) }
    }

    /// The first offset surface on the way down; none before the foot.
    fn trace(
        &self,
        shape: &Shape<D>,
        from: Point<D>,
        up: Vector<f64, D>,
        length: f64,
    ) -> Option<Seen<D>> {
        let lipschitz = shape.promise().lipschitz;
        let tolerance = RAY_TOLERANCE * self.size;
        let mut height = length;
        for _ in 0..RAY_STEPS {
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

    /// How far the hand is down at each point, from 0 in flight to 1 at full depth: down most
    /// of the time, up where the surface jumps or ends.
    fn presses(&self, sights: &[Sight<D>], step: f64, window: usize) -> Vec<f64> {
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
        let near_jump = smoothed(&highest(&near_jump, 4 * window), window);
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

/// Positions of the hand, and the way to each [m], with ways in flight counted as shorter as the
/// hand is faster there.
struct Route<const D: usize> {
    positions: Vec<Point<D>>,
    passed: Vec<f64>,
}

impl<const D: usize> Route<D> {
    fn travelled(&self) -> f64 {
        self.passed[self.passed.len() - 1]
    }
}

/// What is seen from a point of the orbit: the foot of the ray, its direction upwards, and the
/// surface if it meets one.
struct Sight<const D: usize> {
    foot: Point<D>,
    up: Vector<f64, D>,
    seen: Option<Seen<D>>,
}

/// A surface: its height above the foot of the ray [m] and its unit normal.
struct Seen<const D: usize> {
    height: f64,
    normal: Vector<f64, D>,
}

impl<const D: usize> Sight<D> {
    fn height(&self) -> f64 {
        self.seen.as_ref().map_or(0.0, |seen| seen.height)
    }
}

/// The unit vector of the orbit at `angle` [rad] of its turns.
fn direction<const D: usize>(angle: f64) -> Vector<f64, D> {
    let (sin, cos) = libm::sincos(angle);
    let mut direction = [0.0; D];
    match &mut direction[..] {
        [x, y] => (*x, *y) = (sin, cos),
        [x, y, z] => {
            // From the middle up to one pole, down to the other and back.
            let pass = angle / (TAU * TURNS_A_PASS);
            let triangle = 4.0 * (0.5 - ((0.5 * pass + 0.75).fract() - 0.5).abs()) - 1.0;
            let latitude = 0.25 * TAU * HIGHEST_LATITUDE * triangle;
            let (height, radius) = libm::sincos(latitude);
            (*x, *y, *z) = (radius * sin, height, radius * cos);
        }
        _ => {}
    }
    Vector(direction)
}

/// The point of the box `|pᵢ − cᵢ| ≤ hᵢ` in `direction`, with the box stretched to a cube.
fn on_box<const D: usize>(
    direction: Vector<f64, D>,
    centre: Point<D>,
    half: Vector<f64, D>,
) -> Point<D> {
    let largest = direction.0.into_iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    centre + Vector(std::array::from_fn(|i| half.0[i] * direction.0[i] / largest))
}

/// A rise from 0 to 1 with no slope at either end: `3u² − 2u³`.
fn ease(u: f64) -> f64 {
    u * u * (3.0 - 2.0 * u)
}

/// How far the hand is down at a part of a press: up at both ends, down in between.
fn envelope(phase: f64) -> f64 {
    let from_end = phase.min(1.0 - phase) * 2.0;
    ease((from_end / (1.0 - DOWN)).clamp(0.0, 1.0))
}

/// The highest value within `window` places of each.
fn highest(values: &[f64], window: usize) -> Vec<f64> {
    (0..values.len())
        .map(|i| {
            let (from, to) = around(i, window, values.len());
            values[from..to].iter().copied().fold(f64::NEG_INFINITY, f64::max)
        })
        .collect()
}

/// The mean of the values within `window` places of each, taken twice: without corners.
fn smoothed(values: &[f64], window: usize) -> Vec<f64> {
    let points: Vec<Vector<f64, 1>> = values.iter().map(|v| Vector([*v])).collect();
    smoothed_points(&points, window).into_iter().map(|v| v.0[0]).collect()
}

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

/// The places within `window` of place `i`, fewer on both sides near an end.
fn around(i: usize, window: usize, count: usize) -> (usize, usize) {
    let window = window.min(i).min(count - 1 - i);
    (i - window, i + window + 1)
}
