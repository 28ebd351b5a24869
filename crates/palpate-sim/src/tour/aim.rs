// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Visits of bodies that the way round the scene misses: what is small on a wide table.
//!
//! A body is aimed at from outside, along parallel rays in one of few directions, the first from
//! which enough of it is seen. The hand winds over the part that is seen, and flies from body to
//! body above all that lies between.

use palpate_field::{Aabb, Point, Shape, SpaceShape, Vector};

use super::{
    CLEARANCE, FLIGHT_SPEED, MOST_POINTS, ORBIT_HEIGHT, RAY_TOLERANCE, Route, STEP, Sight,
    Tour, passed, smoothed_points,
};
use crate::error::SimulationError;
use crate::hand_path::{HandPath, Interpolation};

/// The least time for a body [s]; with less the hand would hit it instead of touching it, and
/// goes round the whole scene.
const SHORTEST_VISIT: f64 = 0.1;

/// Rays along which a body is looked at from a direction: 81 in a row in the plane, nine rows of
/// nine in space. A body of which less than an 81st of the width is free in the plane, or less
/// than a ninth in space, may be missed.
const ROW: usize = 9;

/// As [`ROW`], in the plane.
const ROW_IN_PLANE: usize = 81;

/// The part of these rays that must see a body at first; then any will do.
const ENOUGH: f64 = 0.1;

/// How deep the hand presses into what is seen of a body, as a part of its size, unless the tour
/// presses less: a part of 1 cm is felt with 0.15 N at 500 N/m.
const VISIT_DEPTH: f64 = 0.03;

/// The grain of what is seen of a body, as a part of its extents: the hand lands on rims that wide.
const VISIT_GRAIN: f64 = 0.5;

/// The steepest way, height over length, that the hand goes down to a surface in a visit. Down a
/// steeper wall the hand would leave its proxy behind at the edge, so it flies over the foot of
/// the wall.
const STEEPEST_WAY: f64 = 2.0;

/// The least part of a visit's time that flights leave, as a part of the equal share.
const LEAST_SHARE: f64 = 0.25;

/// The fewest sweeps over a body in a visit: a figure of eight; one would be a straight line.
const FEWEST_SWEEPS: f64 = 2.0;

/// The most sweeps over a body in a visit: neighbouring ones are then a twelfth of it apart.
const MOST_SWEEPS: f64 = 12.0;

/// Points at which a visit's way is measured: at least 80 a sweep.
const WAY_POINTS: usize = 2000;

/// The most points of a flight: more than a hand needs over any scene.
const MOST_FLIGHT_POINTS: f64 = 20_000.0;

/// The fewest points of a flight: the hand takes some dozens to speed up, and as many to slow down.
const FEWEST_FLIGHT_POINTS: f64 = 100.0;

/// Points over which the corners of a flight are rounded: so few that a rounded corner stays
/// within the clearance.
const ROUNDED: usize = 8;

/// Points of a flight round the scene.
const ARC_POINTS: u32 = 64;

/// What is seen of a body along parallel rays.
struct Target {
    /// From the body to where the rays come from; of length one.
    up: Vector<f64, 3>,
    /// The middle of what is seen, at the body's foot [m].
    foot: Point<3>,
    /// Axes across the rays, each as long as half of what is seen along it [m].
    across: Vec<Vector<f64, 3>>,
}

impl Target {
    /// Half the longest extent of what is seen [m].
    fn reach(&self) -> f64 {
        self.across.iter().map(|axis| axis.norm()).fold(0.0, f64::max)
    }
}

impl Tour {
    /// The path over a scene, `whole`, that touches as many of its `bodies` as it can.
    ///
    /// If the path of [`over`](Self::over) touches all of them, it is that path. Otherwise the
    /// time is divided equally among the bodies: the hand aims at each from outside, from above if
    /// it is seen from there, winds over the part that is seen, and flies above everything to the
    /// next. A body that no ray from outside reaches, or no flight, is left out. If that path
    /// touches no more bodies than that of `over`, or there is less than 0.1 s for each body, the
    /// path is that of `over`.
    ///
    /// # Errors
    ///
    /// [`SimulationError::NothingToTouch`] if no ray meets a surface.
    ///
    /// # Examples
    ///
    /// A ball of 1 cm on a table of 1 m, which the way round the table misses:
    ///
    /// ```
    /// use palpate_sim::Tour;
    /// use palpate_field::{Shape, Vector, kernel::{Ball, Cuboid}};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let table = Shape::from_kernel(Cuboid::new(Vector([1.0, 0.04, 1.0]))?);
    /// let ball = Shape::<3>::from_kernel(Ball::new(0.01)?).translated(Vector([0.31, 0.03, -0.17]))?;
    /// let whole = Shape::union([table.clone(), ball.clone()])?;
    /// let bounds = whole.promise().bounds.ok_or("both have bounds")?.aabb;
    /// let path = Tour::new(bounds, 10.0)?.over_each(&whole, &[table.into(), ball.clone().into()])?;
    /// assert!(path.positions().iter().any(|hand| ball.distance(*hand) < 0.002));
    /// # Ok(())
    /// # }
    /// ```
    #[inline(never)]
    pub fn over_each(
        &self,
        whole: &Shape<3>,
        bodies: &[SpaceShape],
    ) -> Result<HandPath, SimulationError> {
        let around = self.over(whole);
        let touched =
            around.as_ref().map_or(0, |path| self.touched(whole, bodies, path.positions()));
        let is_hasty = bodies.len() as f64 * SHORTEST_VISIT > self.duration;
        if touched == bodies.len() || is_hasty {
            return around;
        }
        match self.visits(whole, bodies) {
            Some(route) if self.touched(whole, bodies, &route.positions) > touched => {
                let travelled = route.travelled();
                let times = route.passed.iter().map(|part| self.duration * (part / travelled));
                HandPath::new(times.collect(), route.positions, Interpolation::Smooth)
            }
            _ => around,
        }
    }

    /// How many of the bodies a path touches.
    fn touched(&self, whole: &Shape<3>, bodies: &[SpaceShape], path: &[Point<3>]) -> usize {
        let tolerance = RAY_TOLERANCE * self.size;
        let mut is_touched = vec![false; bodies.len()];
        for point in path {
            let nearest = whole.distance(*point);
            if nearest > self.probe_radius + tolerance {
                continue;
            }
            let missing = bodies.iter().zip(&mut is_touched).filter(|(_, is)| !**is);
            missing.for_each(|(body, is)| {
                *is = body.shape().distance(*point) <= nearest + tolerance
            });
        }
        is_touched.iter().filter(|is| **is).count()
    }

    /// Visits of all bodies that are seen from outside; `None` if none is. What has been passed
    /// is in seconds at the hand's own speed.
    fn visits(&self, whole: &Shape<3>, bodies: &[SpaceShape]) -> Option<Route> {
        let boxes: Vec<_> = bodies.iter().map(|body| self.box_of(body)).collect();
        let outer = boxes.iter().fold(self.bounds, |all, aabb| all.union(aabb));
        let scene = Outlook { tour: self, whole, outer };
        let targets = in_turn(scene.targets(bodies, &boxes));
        let flights: f64 = targets
            .windows(2)
            .map(|pair| (pair[1].foot - pair[0].foot).norm() / (FLIGHT_SPEED * self.speed))
            .sum();
        let share = self.duration / targets.len().max(1) as f64;
        let time = (share - flights / targets.len().max(1) as f64).max(LEAST_SHARE * share);
        let mut all: Option<(Route, Vector<f64, 3>)> = None;
        for target in &targets {
            let Some(visit) = scene.visit(target, time) else { continue };
            let Some((route, up)) = &mut all else {
                all = Some((visit, target.up));
                continue;
            };
            let ends = (route.positions.last(), visit.positions.first());
            let (Some(&from), Some(&to)) = ends else { continue };
            // A body that the hand cannot fly to is left out.
            if let Some(flight) = scene.flight([from, to], [*up, target.up]) {
                route.append(flight);
                route.append(visit);
                *up = target.up;
            }
        }
        all.map(|(route, _)| route)
    }

    /// The box of a body; of one without bounds, the part of it in and about the scene.
    fn box_of(&self, body: &SpaceShape) -> Aabb<3> {
        let mut part = self.bounds.grown(ORBIT_HEIGHT * self.size);
        if self.is_flat {
            (part.min[2], part.max[2]) = (0.0, 0.0);
        }
        body.bounds().map_or(part, |bounds| bounds.aabb)
    }
}

impl Route {
    /// Goes on with `next`, which begins where this ends.
    fn append(&mut self, next: Self) {
        let before = self.travelled();
        self.positions.extend(next.positions.into_iter().skip(1));
        self.passed.extend(next.passed.into_iter().skip(1).map(|part| before + part));
    }
}

/// A scene that is looked at from outside.
struct Outlook<'a> {
    tour: &'a Tour,
    whole: &'a Shape<3>,
    /// The box around all bodies.
    outer: Aabb<3>,
}

impl Outlook<'_> {
    /// The ray that comes down to `foot` from above the scene.
    fn look(&self, foot: Point<3>, up: Vector<f64, 3>) -> Sight {
        let [_, top] = extent(&self.outer, up);
        let length = top + self.clearance() + self.tour.probe_radius - foot.dot(up);
        self.tour.look_down(self.whole, foot, up, length)
    }

    /// The distance that flights keep from all bodies [m].
    fn clearance(&self) -> f64 {
        CLEARANCE * self.tour.detail()
    }

    /// What is seen of each body: in the first direction from which enough of it is seen, else in
    /// the first from which any of it is.
    fn targets(&self, bodies: &[SpaceShape], boxes: &[Aabb<3>]) -> Vec<Target> {
        let mut missing: Vec<usize> = (0..bodies.len()).collect();
        let mut targets = Vec::new();
        for enough in [ENOUGH, 0.0] {
            for up in directions(self.tour.is_flat) {
                missing.retain(|&body| {
                    let target = self.target(bodies[body].shape(), &boxes[body], up, enough);
                    let is_missing = target.is_none();
                    targets.extend(target);
                    is_missing
                });
            }
        }
        targets
    }

    /// What is seen of a body along rays against `up`; `None` if it is not more than the part
    /// `enough` of the rays.
    fn target(
        &self,
        body: &Shape<3>,
        aabb: &Aabb<3>,
        up: Vector<f64, 3>,
        enough: f64,
    ) -> Option<Target> {
        let [low, _] = extent(aabb, up);
        let axes = across(up, self.tour.is_flat);
        let centre = aabb.centre() + up * (low - aabb.centre().dot(up));
        let halves: Vec<f64> = axes
            .iter()
            .map(|axis| {
                let [low, high] = extent(aabb, *axis);
                0.5 * (high - low)
            })
            .collect();
        let row = if self.tour.is_flat { ROW_IN_PLANE } else { ROW };
        let place = |i: usize| (2 * i + 1) as f64 / row as f64 - 1.0;
        let mut found = vec![[f64::INFINITY, f64::NEG_INFINITY]; axes.len()];
        let (mut seen, count) = (0_usize, row.pow(axes.len() as u32));
        for ray in 0..count {
            let places: Vec<f64> =
                (0..axes.len()).map(|k| place(ray / row.pow(k as u32) % row)).collect();
            let off = axes.iter().zip(&halves).zip(&places);
            let foot =
                off.fold(centre, |foot, ((axis, half), part)| foot + *axis * (half * part));
            if !self.meets(body, &self.look(foot, up)) {
                continue;
            }
            seen += 1;
            for (range, part) in found.iter_mut().zip(&places) {
                *range = [range[0].min(*part), range[1].max(*part)];
            }
        }
        if seen as f64 <= enough * count as f64 {
            return None;
        }
        let mut target = Target { up, foot: centre, across: Vec::new() };
        for ((axis, half), [low, high]) in axes.iter().zip(&halves).zip(found) {
            target.foot += *axis * (half * 0.5 * (low + high));
            // A quarter of what lies between two rays more: one ray alone sees some of the body.
            let part = 0.5 * (high - low) + 0.5 / row as f64;
            target.across.push(*axis * (half * part));
        }
        Some(target)
    }

    /// `true` if the surface that a ray sees is that of `body`.
    fn meets(&self, body: &Shape<3>, sight: &Sight) -> bool {
        let reached = self.tour.probe_radius + 2.0 * RAY_TOLERANCE * self.tour.size;
        let at = sight.foot + sight.up * sight.height;
        sight.seen.is_some() && body.distance(at) <= reached
    }

    /// The way over what is seen of a body, for about `time` [s].
    fn visit(&self, target: &Target, time: f64) -> Option<Route> {
        let reach = target.reach();
        let mut sizes = Vector(std::array::from_fn(|axis| {
            target.across.get(axis).map_or(reach, |axis| axis.norm())
        }));
        if self.tour.is_flat {
            sizes[2] = 0.0;
        }
        let size = 2.0 * reach;
        let tour = Tour {
            bounds: Aabb::centred(sizes * (2.0 * VISIT_GRAIN)),
            size,
            speed: self.tour.speed * (size / self.tour.size).sqrt(),
            depth: Some(self.tour.depth().min(VISIT_DEPTH * size)),
            // What is steep is hidden, and a body may be no wider than the lag.
            lag: 0.0,
            ..*self.tour
        };
        let feet = wound(target, tour.speed * time);
        let way: f64 = feet.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        let count = (way / (STEP * tour.detail())).clamp(100.0, MOST_POINTS) as usize;
        let step = way / count as f64;
        let sights = evenly(&feet, count).into_iter();
        let mut sights: Vec<_> = sights.map(|foot| self.look(foot, target.up)).collect();
        hide(&mut sights, STEEPEST_WAY * step);
        let mut route = tour.pressed(self.whole, sights, step).ok()?;
        route.passed.iter_mut().for_each(|way| *way /= tour.speed);
        Some(route)
    }

    /// The flight between two places above which rays in these directions are free: above all
    /// that lies between if the directions are equal, else round the scene. `None` if a body
    /// without bounds is in the way.
    fn flight(&self, ends: [Point<3>; 2], ups: [Vector<f64, 3>; 2]) -> Option<Route> {
        let corners = if ups[0] == ups[1] {
            self.over_between(ends, ups[0])
        } else {
            self.round_between(ends, ups)?
        };
        let way: f64 = corners.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        let step = STEP * self.tour.detail();
        let count = (way / step).clamp(FEWEST_FLIGHT_POINTS, MOST_FLIGHT_POINTS);
        let positions = smoothed_points(&evenly(&corners, count as usize), ROUNDED);
        let press = vec![0.0; positions.len()];
        let passed = passed(&positions, &press, way / count, ROUNDED);
        let passed = passed.into_iter().map(|way| way / self.tour.speed).collect();
        Some(Route { positions, passed })
    }

    /// Up, across above the highest place between, and down.
    fn over_between(&self, [from, to]: [Point<3>; 2], up: Vector<f64, 3>) -> Vec<Point<3>> {
        let [low, _] = extent(&self.outer, up);
        let way = (to - from) - up * (to - from).dot(up);
        let count = (way.norm() / (STEP * self.tour.detail())).min(MOST_FLIGHT_POINTS).ceil();
        let start = from + up * (low - from.dot(up));
        let highest = (0..=count as u32)
            .map(|i| {
                let foot = start + way * (f64::from(i) / count.max(1.0));
                low + self.look(foot, up).height
            })
            .fold(low, f64::max);
        let height = from.dot(up).max(to.dot(up)).max(highest + self.clearance());
        let above = |point: Point<3>| point + up * (height - point.dot(up));
        vec![from, above(from), above(to), to]
    }

    /// Out to a ball around the scene, on it, and in again.
    fn round_between(
        &self,
        [from, to]: [Point<3>; 2],
        ups: [Vector<f64, 3>; 2],
    ) -> Option<Vec<Point<3>>> {
        let centre = self.outer.centre();
        let radius =
            self.outer.half_extents().norm() + 2.0 * self.tour.probe_radius + self.clearance();
        // The larger root of ‖p + t u − c‖ = r.
        let leave = |point: Point<3>, up: Vector<f64, 3>| {
            let off = point - centre;
            let along = off.dot(up);
            let root = along * along - off.dot(off) + radius * radius;
            point + up * (root.max(0.0).sqrt() - along)
        };
        let (out, back) = (leave(from, ups[0]), leave(to, ups[1]));
        let top = centre + Vector::unit(1) * radius;
        let arc = |from: Point<3>, to: Point<3>| {
            on_ball([from, to], centre, radius, self.tour.is_flat)
        };
        let ways = [arc(out, back), [arc(out, top), arc(top, back)].concat()];
        let is_free = |way: &Vec<Point<3>>| {
            way.iter().all(|p| self.whole.distance(*p) > self.tour.probe_radius)
        };
        let round = ways.into_iter().find(is_free)?;
        Some(std::iter::once(from).chain(round).chain([to]).collect())
    }
}

/// The targets in the order of visits: those of a direction together, and each next to the one
/// before.
fn in_turn(mut targets: Vec<Target>) -> Vec<Target> {
    let mut ordered: Vec<Target> = Vec::with_capacity(targets.len());
    while !targets.is_empty() {
        let next = ordered.last().map_or(0, |last| {
            let way = |target: &Target| (target.foot - last.foot).norm();
            let turned = |target: &Target| u8::from(target.up != last.up);
            let order = |a: &Target, b: &Target| {
                turned(a).cmp(&turned(b)).then(way(a).total_cmp(&way(b)))
            };
            let least = targets.iter().enumerate().min_by(|a, b| order(a.1, b.1));
            least.map_or(0, |(place, _)| place)
        });
        ordered.push(targets.remove(next));
    }
    ordered
}

/// The least and the largest coordinate of a box along `axis` [m].
fn extent(aabb: &Aabb<3>, axis: Vector<f64, 3>) -> [f64; 2] {
    let (middle, half) = (aabb.centre().dot(axis), aabb.half_extents());
    let reach: f64 = half.0.iter().zip(axis.0).map(|(half, part)| half * part.abs()).sum();
    [middle - reach, middle + reach]
}

/// The directions to look from, of length one: from above, from above at a slant, from the
/// sides, and from below last.
fn directions(is_flat: bool) -> Vec<Vector<f64, 3>> {
    let signs = [1.0, 0.0, -1.0];
    let mut all: Vec<Vector<f64, 3>> = (0..27)
        .map(|i| Vector(std::array::from_fn(|axis| signs[i / 3_usize.pow(axis as u32) % 3])))
        .collect();
    all.retain(|direction| *direction != Vector::ZERO && !(is_flat && direction[2] != 0.0));
    all.sort_by(|a, b| b[1].total_cmp(&a[1]).then(a.norm().total_cmp(&b.norm())));
    all.into_iter().map(|direction| direction * (1.0 / direction.norm())).collect()
}

/// Axes across a direction, of length one and perpendicular to each other.
fn across(up: Vector<f64, 3>, is_flat: bool) -> Vec<Vector<f64, 3>> {
    let mut axes = vec![up];
    // x and z before y: seen from above, they are the axes themselves.
    let most = if is_flat { 2 } else { 3 };
    for axis in [0, 2, 1].into_iter().filter(|axis| *axis < most) {
        let rest = axes
            .iter()
            .fold(Vector::unit(axis), |rest, other| rest - *other * rest.dot(*other));
        if rest.norm() > 0.5 && axes.len() < most {
            axes.push(rest * (1.0 / rest.norm()));
        }
    }
    axes.split_off(1)
}

/// The places of a way about `way` long [m] that winds over a target, from its middle to its
/// middle: `sin(2πmt)` along the first axis and `sin(2πt)` along the second.
fn wound(target: &Target, way: f64) -> Vec<Point<3>> {
    let reach = target.reach();
    let sweeps = (way / (4.0 * reach)).round().clamp(FEWEST_SWEEPS, MOST_SWEEPS);
    let place = |i: usize| {
        let part = std::f64::consts::TAU * (i as f64 / WAY_POINTS as f64);
        let swings = [libm::sin(sweeps * part), libm::sin(part)];
        let axes = target.across.iter().zip(swings);
        axes.fold(target.foot, |foot, (axis, swing)| foot + *axis * swing)
    };
    (0..=WAY_POINTS).map(place).collect()
}

/// Removes each sight that lies lower than a neighbour by more than `fall` [m] for each ray between
/// them.
fn hide(sights: &mut [Sight], fall: f64) {
    let mut cover: Vec<f64> = sights.iter().map(|sight| sight.height).collect();
    for i in 1..cover.len() {
        cover[i] = cover[i].max(cover[i - 1] - fall);
    }
    for i in (1..cover.len()).rev() {
        cover[i - 1] = cover[i - 1].max(cover[i] - fall);
    }
    for (sight, cover) in sights.iter_mut().zip(cover) {
        if cover > sight.height {
            sight.seen = None;
        }
    }
}

/// `count + 1` places at equal distances along a line.
fn evenly(line: &[Point<3>], count: usize) -> Vec<Point<3>> {
    let sums = line.windows(2).scan(0.0, |sum, pair| {
        *sum += (pair[1] - pair[0]).norm();
        Some(*sum)
    });
    let passed: Vec<f64> = std::iter::once(0.0).chain(sums).collect();
    let length = passed[passed.len() - 1];
    let place = |i: usize| {
        let way = length * (i as f64 / count as f64);
        let after = passed.partition_point(|sum| *sum <= way).clamp(1, line.len() - 1);
        let span = passed[after] - passed[after - 1];
        let part = if span > 0.0 { ((way - passed[after - 1]) / span).min(1.0) } else { 0.0 };
        line[after - 1] + (line[after] - line[after - 1]) * part
    };
    (0..=count).map(place).collect()
}

/// The shorter arc between two places on a ball; over one of its sides if they are opposite.
fn on_ball(
    [from, to]: [Point<3>; 2],
    centre: Point<3>,
    radius: f64,
    is_flat: bool,
) -> Vec<Point<3>> {
    let (a, b) = ((from - centre) * (1.0 / radius), (to - centre) * (1.0 / radius));
    let angle = libm::acos(a.dot(b).clamp(-1.0, 1.0));
    let side = (b - a * a.dot(b)).normalized();
    let side = side.or_else(|| across(a, is_flat).first().copied()).unwrap_or(a);
    let place = |i: u32| {
        let (sin, cos) = libm::sincos(angle * (f64::from(i) / f64::from(ARC_POINTS)));
        centre + (a * cos + side * sin) * radius
    };
    (0..=ARC_POINTS).map(place).collect()
}
