// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where the contact points of the hand are led.

use std::collections::VecDeque;
use std::f64::consts::TAU;
use std::time::{Duration, Instant};

use palpate::devices::{DeviceError, HandPath, Tour};
use palpate::field::{Aabb, Point, Vector};
use palpate::haptics::Probe;
use palpate::scene::BuiltScene;

/// How long a hand that nobody leads rests before it goes on its tour.
const REST: Duration = Duration::from_secs(2);

/// How long a tour of a scene takes [s].
const TOUR: f64 = 20.0;

/// How far each contact point follows behind the one before on a tour [s].
const LAG: f64 = 0.5;

/// How fast contact points go to the begin of a tour, in sizes of the scene a second.
const SPEED: f64 = 0.3;

/// The same of a hand that a page begins to lead.
const HASTE: f64 = 4.0;

/// The radius of the circle on which contact points lie around a hand that is led, as a share of
/// the scene.
const SPREAD: f64 = 0.04;

/// What leads a hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Leader {
    /// A page, or nobody: the hand rests.
    #[default]
    Page,
    Tour,
    Replay,
}

/// Leads the contact points of a hand: along a tour or a recording, or where the page says.
#[derive(Debug)]
pub(super) struct Lead<const D: usize> {
    /// The contact points beside the hand [m].
    arms: Vec<Vector<f64, D>>,
    /// Whether the arms are those of the scene's tool, which go side by side on a tour.
    is_tool: bool,
    tour: Option<HandPath<D>>,
    is_touring: bool,
    /// The time on the tour [s].
    tour_time: f64,
    /// A path of each contact point, and the time on it [s].
    replay: Option<(Vec<HandPath<D>>, f64)>,
    /// The way onto the tour or the paths; `None` while the hand is led otherwise.
    approach: Option<Approach<D>>,
    /// Where a hand is led that is on its way there [m].
    goal: Point<D>,
    /// The time of the servo [s].
    time: f64,
    bounds: Option<Aabb<D>>,
    /// Where each contact point is led [m].
    targets: Vec<Point<D>>,
    /// When the page last led the hand; `None` if it never did.
    led: Option<Instant>,
    is_held: bool,
}

impl<const D: usize> Lead<D> {
    /// For a scene whose hand has `count` contact points, unless its tool says how many. It rests
    /// above the scene until it gets a tour.
    pub(super) fn new(scene: &BuiltScene<D>, count: usize) -> Self {
        let mut arms: Vec<_> = scene.contact_points().collect();
        let has_shape = scene.tool.as_ref().is_some_and(|tool| tool.shape.is_some());
        let is_tool = !arms.is_empty() || has_shape;
        let bounds = scene.bounds();
        if !is_tool {
            arms = around(count, bounds.as_ref().map_or(1.0, longest_edge) * SPREAD);
        } else if has_shape {
            arms = vec![Vector::ZERO];
        }
        let rest = bounds.map_or(Vector::ZERO, |bounds| above(&bounds));
        let targets = arms.iter().map(|arm| rest + *arm).collect();
        Self {
            arms,
            is_tool,
            tour: None,
            is_touring: true,
            tour_time: 0.0,
            replay: None,
            approach: None,
            goal: Vector::ZERO,
            time: 0.0,
            bounds,
            targets,
            led: None,
            is_held: false,
        }
    }

    /// Takes the tour of its scene.
    pub(super) fn take_tour(&mut self, tour: HandPath<D>) {
        self.tour = Some(tour);
    }

    pub(super) fn is_held(&self) -> bool {
        self.is_held
    }

    pub(super) fn targets(&self) -> &[Point<D>] {
        &self.targets
    }

    /// Takes note of the bounds of a scene with other bodies.
    pub(super) fn take_bounds(&mut self, bounds: Option<Aabb<D>>) {
        self.bounds = bounds;
    }

    pub(super) fn tours(&mut self, is_touring: bool) {
        self.is_touring = is_touring;
    }

    /// Follows a path of each contact point, from its begin; or no longer.
    pub(super) fn replay(&mut self, paths: Option<Vec<HandPath<D>>>) -> Result<(), String> {
        if let Some(paths) = &paths
            && paths.len() != self.arms.len()
        {
            let (recorded, points) = (paths.len(), self.arms.len());
            return Err(format!(
                "the hand has {points} contact points, what was recorded has {recorded}"
            ));
        }
        if paths.is_some() && self.bounds.is_none() {
            return Err(
                "a scene without bounds has no way over it to what was recorded".to_owned()
            );
        }
        if paths.is_none() {
            self.led = Some(Instant::now());
        }
        (self.replay, self.approach) = (paths.map(|paths| (paths, 0.0)), None);
        self.is_held = false;
        Ok(())
    }

    /// Takes over where another hand was led, as far as there are as many contact points.
    pub(super) fn take_over(&mut self, other: &Self) {
        (self.is_held, self.led) = (other.is_held, other.led);
        self.is_touring &= other.is_touring;
        if self.targets.len() == other.targets.len() {
            self.targets.clone_from(&other.targets);
        }
    }

    /// Lets go of the hand, which rests at `places`: where bodies hold it back, there.
    pub(super) fn let_go(&mut self, places: &[Point<D>]) {
        (self.led, self.is_held) = (Some(Instant::now()), false);
        self.approach = None;
        if places.len() == self.targets.len() {
            self.targets.copy_from_slice(places);
        }
    }

    /// Leads the hand, or one of its contact points; its tour ends. A hand that was not held comes to the
    /// target from a place `from` which it can be seen, and which it reaches over the scene.
    pub(super) fn lead(
        &mut self,
        target: Point<D>,
        point: Option<usize>,
        from: Option<Point<D>>,
    ) -> Result<(), String> {
        let points = self.targets.len();
        if let Some(point) = point.filter(|point| *point >= points) {
            return Err(format!("there are {points} contact points, got number {point}"));
        }
        let begins = !self.is_held;
        (self.led, self.is_held, self.is_touring) = (Some(Instant::now()), true, false);
        self.replay = None;
        if begins {
            self.approach = None;
            if let (Some(from), Some(bounds), None) = (from, &self.bounds, point) {
                let goals: Vec<_> = self.arms.iter().map(|arm| from + *arm).collect();
                self.approach = Some(Approach::new(&self.targets, &goals, bounds));
            }
        }
        self.goal = target;
        if self.approach.is_some() {
            return Ok(());
        }
        match point {
            None => {
                self.targets
                    .iter_mut()
                    .zip(&self.arms)
                    .for_each(|(to, arm)| *to = target + *arm);
            }
            Some(point) => self.targets[point] = target,
        }
        Ok(())
    }

    /// Goes on to the time of the servo [s]; what leads the hand there.
    pub(super) fn go_on(&mut self, time: f64) -> Leader {
        let passed = (time - self.time).max(0.0);
        self.time = time;
        if let (true, Some(approach), Some(bounds)) =
            (self.is_held, &mut self.approach, &self.bounds)
        {
            let far = passed * longest_edge(bounds) * HASTE;
            if approach.go_on(&mut self.targets, far) {
                let goal = self.goal;
                self.targets.iter_mut().zip(&self.arms).for_each(|(to, arm)| *to = goal + *arm);
                self.approach = None;
            }
            return Leader::Page;
        }
        if self.replay.is_some() {
            return self.go_on_replaying(passed);
        }
        let is_led = self.is_held || self.led.is_some_and(|at| at.elapsed() < REST);
        let (Some(tour), Some(bounds), false) = (&self.tour, &self.bounds, is_led) else {
            return Leader::Page;
        };
        if !self.is_touring {
            return Leader::Page;
        }
        let goals = self.on_tour(tour, self.tour_time);
        let targets = &self.targets;
        let approach =
            self.approach.get_or_insert_with(|| Approach::new(targets, &goals, bounds));
        if approach.go_on(&mut self.targets, passed * longest_edge(bounds) * SPEED) {
            self.tour_time += passed;
            self.targets = goals;
        }
        let behind = if self.is_tool { 0.0 } else { LAG * self.arms.len() as f64 };
        if self.tour_time > tour.duration() + behind {
            // Over the scene to the begin of the tour, not through it.
            (self.tour_time, self.approach) = (0.0, None);
        }
        Leader::Tour
    }

    /// Goes on along the paths of a recording, which the hand comes to over the scene.
    fn go_on_replaying(&mut self, passed: f64) -> Leader {
        let (Some((paths, at)), Some(bounds)) = (&mut self.replay, &self.bounds) else {
            return Leader::Page;
        };
        let place = |path: &HandPath<D>| path.state_at(path.start() + *at).position;
        let goals: Vec<_> = paths.iter().map(place).collect();
        let targets = &self.targets;
        let approach =
            self.approach.get_or_insert_with(|| Approach::new(targets, &goals, bounds));
        if approach.go_on(&mut self.targets, passed * longest_edge(bounds) * SPEED) {
            *at += passed;
            self.targets = goals;
        }
        if paths.iter().all(|path| *at > path.duration()) {
            (self.replay, self.approach, self.led) = (None, None, Some(Instant::now()));
        }
        Leader::Replay
    }

    /// Where the contact points are at a time of a tour [s].
    fn on_tour(&self, tour: &HandPath<D>, time: f64) -> Vec<Point<D>> {
        let place = |(point, arm): (usize, &Vector<f64, D>)| {
            let (behind, beside) =
                if self.is_tool { (0.0, *arm) } else { (LAG * point as f64, Vector::ZERO) };
            // Before the tour begins and after it ends, a point rests there.
            tour.state_at(tour.start() + (time - behind).max(0.0)).position + beside
        };
        self.arms.iter().enumerate().map(place).collect()
    }
}

/// A way from anywhere to a place on a tour: up over the scene, across, and down, so that no body
/// is in between where the places can be reached from above.
#[derive(Debug)]
struct Approach<const D: usize>(Vec<VecDeque<Point<D>>>);

impl<const D: usize> Approach<D> {
    fn new(from: &[Point<D>], to: &[Point<D>], bounds: &Aabb<D>) -> Self {
        let height = above(bounds)[1];
        let over = |place: &Point<D>| {
            let mut over = *place;
            over[1] = over[1].max(height);
            over
        };
        let ways = from.iter().zip(to).map(|(from, to)| [over(from), over(to), *to].into());
        Self(ways.collect())
    }

    /// Goes on by at most so far [m]; whether all are there.
    fn go_on(&mut self, places: &mut [Point<D>], far: f64) -> bool {
        for (way, place) in self.0.iter_mut().zip(places) {
            let mut left = far;
            while let Some(next) = way.front() {
                let step = *next - *place;
                let length = step.norm();
                if length > left {
                    *place += step * (left / length);
                    break;
                }
                (*place, left) = (*next, left - length);
                way.pop_front();
            }
        }
        self.0.iter().all(VecDeque::is_empty)
    }
}

/// Points on a circle, in space in the plane xz; one is in the middle.
fn around<const D: usize>(count: usize, radius: f64) -> Vec<Vector<f64, D>> {
    let place = |point: usize| {
        let (up, across) = (TAU * point as f64 / count as f64).sin_cos();
        let mut arm = Vector::ZERO;
        arm[0] = radius * across;
        arm[D - 1] = radius * up;
        arm
    };
    if count < 2 { vec![Vector::ZERO] } else { (0..count).map(place).collect() }
}

/// A place over a box, as high over it as the circle of contact points is wide.
fn above<const D: usize>(bounds: &Aabb<D>) -> Point<D> {
    let mut place = bounds.centre();
    place[1] = bounds.max[1] + 2.0 * SPREAD * longest_edge(bounds);
    place
}

/// The tour of a scene, for a hand of `count` contact points; `None` if the scene has no bounds.
/// It takes a part of a second.
pub(super) fn tour<const D: usize>(
    scene: &BuiltScene<D>,
    count: usize,
) -> Option<Result<HandPath<D>, DeviceError>> {
    let bounds = scene.bounds()?;
    let radius = scene.tool.as_ref().map_or(Probe::default().radius(), |tool| tool.radius);
    let shapes: Vec<_> = scene.bodies.iter().map(|body| body.shape.clone()).collect();
    let duration = TOUR + LAG * count as f64;
    let tour = Tour::new(bounds, duration).and_then(|tour| tour.with_probe_radius(radius));
    Some(tour.and_then(|tour| tour.over_each(&scene.whole, &shapes)))
}

/// The longest edge of a box [m].
pub(super) fn longest_edge<const D: usize>(bounds: &Aabb<D>) -> f64 {
    2.0 * bounds.half_extents().0.into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hand_goes_onto_its_tour_from_above() {
        let bounds = Aabb { min: Vector([-1.0, -1.0]), max: Vector([1.0, 1.0]) };
        let mut places = [Vector([-3.0, 0.0])];
        let goal = Vector([0.0, 1.0]);
        let mut approach = Approach::new(&places, &[goal], &bounds);
        let mut lowest_between = f64::INFINITY;
        let mut steps = 0;
        while !approach.go_on(&mut places, 0.01) {
            if places[0][0].abs() < 2.9 && places[0][0] < -0.01 {
                lowest_between = lowest_between.min(places[0][1]);
            }
            steps += 1;
        }
        assert_eq!(places[0], goal);
        assert!(lowest_between > 1.1, "{lowest_between}");
        // Up by 1.16, across by 3, down by 0.16.
        assert!((431..=434).contains(&steps), "{steps}");
    }
}
