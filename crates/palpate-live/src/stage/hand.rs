// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where the contact points of the hand are led.

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

/// The radius of the circle on which contact points lie around a hand that is led, as a share of
/// the scene.
const SPREAD: f64 = 0.04;

/// Leads the contact points of a hand: along a tour, or where the page says.
#[derive(Debug)]
pub(super) struct Lead<const D: usize> {
    /// The contact points beside the hand [m].
    arms: Vec<Vector<f64, D>>,
    /// Whether the arms are those of the scene's tool, which go side by side on a tour.
    is_tool: bool,
    tour: Option<HandPath<D>>,
    is_touring: bool,
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
        Self { targets, arms, is_tool, is_touring: true, tour: None, led: None, is_held: false }
    }

    /// Takes the tour of its scene.
    pub(super) fn take_tour(&mut self, tour: HandPath<D>) {
        self.tour = Some(tour);
    }

    pub(super) fn targets(&self) -> &[Point<D>] {
        &self.targets
    }

    pub(super) fn tours(&mut self, is_touring: bool) {
        self.is_touring = is_touring;
    }

    /// Takes over where another hand was led, as far as there are as many contact points.
    pub(super) fn take_over(&mut self, other: &Self) {
        (self.is_held, self.led) = (other.is_held, other.led);
        self.is_touring &= other.is_touring;
        if self.targets.len() == other.targets.len() {
            self.targets.clone_from(&other.targets);
        }
    }

    /// Leads the hand, or one of its contact points.
    pub(super) fn lead(
        &mut self,
        target: Point<D>,
        point: Option<usize>,
        is_held: bool,
    ) -> Result<(), String> {
        (self.led, self.is_held) = (Some(Instant::now()), is_held);
        match point {
            None => {
                self.targets
                    .iter_mut()
                    .zip(&self.arms)
                    .for_each(|(to, arm)| *to = target + *arm);
            }
            Some(point) => {
                let points = self.targets.len();
                let wrong = || format!("there are {points} contact points, got number {point}");
                *self.targets.get_mut(point).ok_or_else(wrong)? = target;
            }
        }
        Ok(())
    }

    /// Goes on to the time of the servo [s]; whether that is along a tour.
    pub(super) fn go_on(&mut self, time: f64) -> bool {
        let is_led = self.is_held || self.led.is_some_and(|at| at.elapsed() < REST);
        !is_led && self.is_touring && self.go_on_tour(time)
    }

    fn go_on_tour(&mut self, time: f64) -> bool {
        let Some(tour) = &self.tour else { return false };
        let longest = tour.start() + tour.duration();
        for (point, (target, arm)) in self.targets.iter_mut().zip(&self.arms).enumerate() {
            let (behind, beside) =
                if self.is_tool { (0.0, *arm) } else { (LAG * point as f64, Vector::ZERO) };
            let time = tour.start() + (time - behind).rem_euclid(longest - tour.start());
            *target = tour.state_at(time).position + beside;
        }
        true
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
