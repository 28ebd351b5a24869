// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where the contact points of the hand are led.

mod lift;
mod tour;

use std::f64::consts::TAU;
use std::sync::Arc;
use std::time::{Duration, Instant};

use palpate::field::{Aabb, Point, SpaceShape, Vector};
use palpate::scene::BuiltScene;
use palpate::sim::HandPath;

use super::pages::size;
use super::trace::Replay;
use lift::{Lift, Step};
pub(super) use tour::tour;
use tour::{LAG, radius};

/// How long a hand that nobody leads rests before it goes on its tour.
const REST: Duration = Duration::from_secs(2);

/// The radius of the circle on which contact points lie around a hand that is led, as a share of
/// the scene.
const SPREAD: f64 = 0.04;

/// A hand that is led farther than this share of the scene is lifted on the way.
const NEAR: f64 = 0.08;

/// How much farther out than touching a hand is set down beside a body, as a share of the scene.
const CLEARANCE: f64 = 5e-3;

/// The farthest that a tour goes on in a step [s]: a hand that is led late does not cut its corners.
const LONGEST_STEP: f64 = 0.02;

/// The most steps out of a body.
const STEPS_OUT: usize = 16;

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
pub(super) struct Lead {
    ground: Ground,
    /// Metres of the scene for a metre of the device.
    scale: f64,
    /// The contact points beside the hand [m].
    arms: Vec<Vector<f64, 3>>,
    /// Whether the arms are those of the scene's tool, which go side by side on a tour.
    is_tool: bool,
    tour: Option<HandPath>,
    is_touring: bool,
    /// Whether forces are stopped: a tour waits.
    is_stopped: bool,
    /// The time on the tour [s]; `None` if the hand is not on it yet.
    tour_time: Option<f64>,
    /// What is replayed, and the time on it [s], `None` before it begins.
    replay: Option<(Arc<Replay>, Option<f64>)>,
    /// The hand is brought to another place.
    lift: Option<Lift>,
    /// Where a hand is led once it is set down [m].
    goal: Option<Point<3>>,
    /// The time of the servo [s].
    time: f64,
    /// Where each contact point is led [m].
    targets: Vec<Point<3>>,
    /// When the hand was led or let go last; `None` if it never was.
    led: Option<Instant>,
    is_held: bool,
}

impl Lead {
    /// For a scene whose hand has `count` contact points, unless its tool says how many. It rests
    /// above the scene until it gets a tour.
    pub(super) fn new<const D: usize>(scene: &BuiltScene<D>, count: usize, scale: f64) -> Self {
        let ground = Ground::of(scene);
        let mut arms: Vec<_> = scene.contact_points().collect();
        let has_shape = scene.tool.as_ref().is_some_and(|tool| tool.shape.is_some());
        let is_tool = !arms.is_empty() || has_shape;
        if !is_tool {
            arms = around(count, ground.size * SPREAD, D - 1);
        } else if has_shape {
            arms = vec![Vector::ZERO];
        }
        let rest = ground.rest();
        let targets = arms.iter().map(|arm| rest + *arm).collect();
        Self {
            ground,
            scale,
            arms,
            is_tool,
            tour: None,
            is_touring: true,
            is_stopped: false,
            tour_time: None,
            replay: None,
            lift: None,
            goal: None,
            time: 0.0,
            targets,
            led: None,
            is_held: false,
        }
    }

    /// Takes the tour of its scene.
    pub(super) fn take_tour(&mut self, tour: HandPath) {
        (self.tour, self.tour_time) = (Some(tour), None);
    }

    pub(super) fn is_held(&self) -> bool {
        self.is_held
    }

    /// Whether the hand is lifted off the bodies.
    pub(super) fn is_lifted(&self) -> bool {
        self.lift.as_ref().is_some_and(Lift::is_lifted)
    }

    pub(super) fn targets(&self) -> &[Point<3>] {
        &self.targets
    }

    /// Goes on in a scene with other bodies. A hand that is lifted is set down beside them.
    pub(super) fn take_scene<const D: usize>(&mut self, scene: &BuiltScene<D>) {
        self.ground = Ground::of(scene);
        if self.is_lifted()
            && let Some(lift) = self.lift.take()
        {
            self.bring(lift.places());
        }
    }

    pub(super) fn is_touring(&self) -> bool {
        self.is_touring
    }

    /// Sets whether a hand that nobody leads goes on its tour.
    pub(super) fn set_touring(&mut self, is_touring: bool) {
        self.is_touring = is_touring;
    }

    pub(super) fn set_stopped(&mut self, is_stopped: bool) {
        self.is_stopped = is_stopped;
    }

    /// Starts to follow what was recorded or read, or ends it.
    pub(super) fn replay(&mut self, replay: Option<Arc<Replay>>) -> Result<(), String> {
        if let Some(replay) = &replay
            && replay.paths.len() != self.arms.len()
        {
            let (recorded, points) = (replay.paths.len(), self.arms.len());
            return Err(format!(
                "the hand has {points} contact points, what was recorded has {recorded}"
            ));
        }
        if replay.is_none() {
            self.led = Some(Instant::now());
        }
        self.replay = replay.map(|replay| (replay, None));
        (self.is_held, self.tour_time) = (false, None);
        Ok(())
    }

    /// Takes over where another hand of the scene was led, if it has as many contact points.
    pub(super) fn take_over(&mut self, other: &Self) {
        self.led = other.led;
        if self.targets.len() == other.targets.len() {
            self.is_held = other.is_held;
            self.targets.clone_from(&other.targets);
            self.goal = other.goal;
            if let Some(lift) = &other.lift {
                self.bring(lift.places());
            }
        }
    }

    /// Lets go of the hand, which rests at `places`: where bodies hold it back, there. A hand that is
    /// lifted is still set down where it is brought.
    pub(super) fn let_go(&mut self, places: &[Point<3>]) {
        (self.led, self.is_held) = (Some(Instant::now()), false);
        if self.lift.is_none() && places.len() == self.targets.len() {
            self.targets.copy_from_slice(places);
        }
    }

    /// Leads the hand, or one of its contact points; its tour ends. A hand that was not held is lifted
    /// and set down at `from`, and goes to the target from there; without `from`, it is set down beside
    /// the target, if that is far.
    pub(super) fn lead(
        &mut self,
        target: Point<3>,
        point: Option<usize>,
        from: Option<Point<3>>,
    ) -> Result<(), String> {
        let points = self.targets.len();
        if let Some(point) = point.filter(|point| *point >= points) {
            return Err(format!("there are {points} contact points, got number {point}"));
        }
        let begins = !self.is_held;
        (self.led, self.is_held, self.is_touring) = (Some(Instant::now()), true, false);
        (self.replay, self.tour_time) = (None, None);
        // One contact point alone is never lifted.
        self.goal = point.is_none().then_some(target);
        if let Some(point) = point {
            self.targets[point] = target;
            if let Some(lift) = &mut self.lift {
                lift.redirect(point, target);
            }
            return Ok(());
        }
        let goals = self.beside(target);
        let mut ways = self.targets.iter().zip(&goals);
        let is_far =
            ways.any(|(place, goal)| (*place - *goal).norm() > NEAR * self.ground.size);
        if begins && (from.is_some() || is_far) {
            let places = from.map_or(goals, |from| self.beside(from));
            self.bring(&places);
        } else if self.lift.is_none() {
            self.targets = goals;
        }
        Ok(())
    }

    /// The contact points of a hand in a place.
    fn beside(&self, place: Point<3>) -> Vec<Point<3>> {
        self.arms.iter().map(|arm| place + *arm).collect()
    }

    /// Lifts the hand, and brings its contact points to other places, or to free ones beside them.
    fn bring(&mut self, places: &[Point<3>]) {
        let free = |place: &Point<3>| self.ground.free_beside(*place);
        let places: Vec<_> = places.iter().map(free).collect();
        self.targets.clone_from(&places);
        self.lift = Some(Lift::to(places, self.time));
    }

    /// Goes on to the time of the servo [s], whose device points are at `devices`; what leads the hand
    /// there.
    pub(super) fn go_on(&mut self, time: f64, devices: &[Point<3>]) -> Leader {
        let passed = (time - self.time).max(0.0);
        self.time = time;
        let leader = self.leader();
        if self.lift.is_some() {
            self.go_on_lifted(passed, devices);
            if self.lift.is_none()
                && self.is_held
                && let Some(goal) = self.goal
            {
                self.targets = self.beside(goal);
            }
            return leader;
        }
        match leader {
            Leader::Page => {}
            Leader::Tour if self.is_stopped => {}
            Leader::Tour => self.go_on_touring(passed),
            Leader::Replay => self.go_on_replaying(passed),
        }
        leader
    }

    fn leader(&self) -> Leader {
        let is_resting = self.led.is_some_and(|at| at.elapsed() < REST);
        match (&self.replay, &self.tour) {
            (Some(_), _) => Leader::Replay,
            (None, Some(_)) if self.is_touring && !self.is_held && !is_resting => Leader::Tour,
            _ => Leader::Page,
        }
    }

    /// Leads the device to where the hand is set down.
    fn go_on_lifted(&mut self, passed: f64, devices: &[Point<3>]) {
        let Some(lift) = &mut self.lift else { return };
        match lift.go_on(self.time, passed, devices, [self.ground.size, self.scale]) {
            Step::OnTheWay => {}
            Step::Short(short) => {
                self.targets.iter_mut().zip(short).for_each(|(target, short)| *target += short);
            }
            Step::SetDown(places) => self.targets = places,
            Step::Over => self.lift = None,
        }
    }

    fn go_on_touring(&mut self, passed: f64) {
        let Some(tour) = &self.tour else { return };
        let behind = if self.is_tool { 0.0 } else { LAG * self.arms.len() as f64 };
        let end = tour.duration() + behind;
        match self.tour_time {
            Some(at) if at <= end => {
                self.targets = self.on_tour(tour, at);
                self.tour_time = Some(at + passed.min(LONGEST_STEP));
            }
            _ => {
                let begin = self.on_tour(tour, 0.0);
                self.bring(&begin);
                self.tour_time = Some(0.0);
            }
        }
    }

    /// Goes on along a recording. Where its hand was lifted, this one is, and is set down where that was.
    fn go_on_replaying(&mut self, passed: f64) {
        let Some((replay, at)) = &mut self.replay else { return };
        let Some(time) = *at else {
            *at = Some(0.0);
            let begin = replay.places(0.0);
            return self.bring(&begin);
        };
        if let Some(end) = replay.lifted_until(time) {
            *at = Some(end);
            let end = replay.places(end);
            return self.bring(&end);
        }
        self.targets = replay.places(time);
        if replay.is_over(time) {
            (self.replay, self.led) = (None, Some(Instant::now()));
        } else {
            *at = Some(time + passed);
        }
    }

    /// Where the contact points are at a time of a tour [s].
    fn on_tour(&self, tour: &HandPath, time: f64) -> Vec<Point<3>> {
        let place = |(point, arm): (usize, &Vector<f64, 3>)| {
            let (behind, beside) =
                if self.is_tool { (0.0, *arm) } else { (LAG * point as f64, Vector::ZERO) };
            // Before the tour begins and after it ends, a point rests there.
            tour.state_at(tour.start() + (time - behind).max(0.0)).position + beside
        };
        self.arms.iter().enumerate().map(place).collect()
    }
}

/// What a hand feels of a scene, as far as it is led by that.
#[derive(Debug)]
struct Ground {
    shape: SpaceShape,
    bounds: Option<Aabb<3>>,
    /// The longest edge of the bounds [m]; 1 m for a scene without.
    size: f64,
    /// The radius of what touches the scene [m].
    radius: f64,
}

impl Ground {
    fn of<const D: usize>(scene: &BuiltScene<D>) -> Self {
        Self {
            shape: (&scene.whole).into(),
            bounds: scene.bounds().map(|bounds| bounds.in_space()),
            size: size(scene),
            radius: radius(scene),
        }
    }

    /// A place over the scene, as high over it as the circle of contact points is wide.
    fn rest(&self) -> Point<3> {
        let Some(bounds) = &self.bounds else { return Vector::ZERO };
        let mut place = bounds.centre();
        place[1] = bounds.max[1] + 2.0 * SPREAD * self.size;
        place
    }

    /// A place without bodies: as near as steps along the gradient find one, or else over the scene.
    fn free_beside(&self, place: Point<3>) -> Point<3> {
        let clearance = self.radius + CLEARANCE * self.size;
        let mut free = place;
        for _ in 0..STEPS_OUT {
            let (distance, gradient) = self.shape.shape().distance_gradient(free);
            if distance >= clearance {
                return free;
            }
            // At least as long as in a field of slope 1/2: in the middle of a body the gradient
            // may vanish.
            let squared = gradient.dot(gradient).max(0.5 * gradient.norm());
            free += gradient * ((clearance - distance) / squared);
            // Written so that NaN ends it.
            let is_near = (free - place).norm() <= self.size;
            if !is_near {
                break;
            }
        }
        match &self.bounds {
            Some(bounds) => {
                let mut over = place;
                over[1] = over[1].max(bounds.max[1] + clearance);
                over
            }
            None => place,
        }
    }
}

/// Points on a circle, one in the middle; the axes of its plane are x and `up`.
fn around(count: usize, radius: f64, up: usize) -> Vec<Vector<f64, 3>> {
    let place = |point: usize| {
        let (sin, cos) = (TAU * point as f64 / count as f64).sin_cos();
        Vector::unit(0) * (radius * cos) + Vector::unit(up) * (radius * sin)
    };
    if count < 2 { vec![Vector::ZERO] } else { (0..count).map(place).collect() }
}
