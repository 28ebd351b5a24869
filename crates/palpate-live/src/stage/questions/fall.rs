// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A ball that falls onto the scene and bounces: straight flights in short steps, each proven free up
//! to the first touch.

use std::ops::RangeInclusive;
use std::time::{Duration, Instant};

use palpate::field::{Aabb, LARGEST_LENGTH, Point, Shape, Vector};
use palpate::query::{BallWorkspace, Limits, Ray, Stop, cast_ball};
use palpate::scene::BuiltScene;

use super::super::pages::{point_of, size};
use super::{Cancel, TOLERANCE};
use crate::wire::{Answered, Bounce, FallEnd, Fell, Timed};

/// Steps in the time in which the ball would fall by the size of the scene, and of a way at most.
const STEPS_A_FALL: f64 = 200.0;
const MOST_STEPS: usize = 6000;

/// Touches in a step at most: a ball in a corner goes to and fro.
const MOST_TOUCHES: usize = 8;

/// Evaluations of a way at most.
const BUDGET: u32 = 5_000_000;

/// How long a way is searched for at most.
const PATIENCE: Duration = Duration::from_secs(3);

/// The gravities that are taken [m/s²].
const GRAVITIES: RangeInclusive<f64> = 1e-6..=1e6;

/// A ball that touches is put off the surface by this share of its radius.
const SKIN: f64 = 1e-4;

/// A touch that is slower than the fall of so many steps is no bounce.
const SLOW: f64 = 4.0;

/// What is left of the speed after a step in which the ball slides.
const SLIDES_ON: f64 = 0.99;

/// The ball rests after so many steps of touch that are slower than this share of the speed of a
/// fall by the size of the scene.
const REST_STEPS: usize = 60;
const REST_SPEED: f64 = 0.005;

/// The ball as it falls.
struct Fall<'a, const D: usize> {
    shape: &'a Shape<D>,
    bounds: Option<Aabb<D>>,
    /// The size of the scene [m].
    size: f64,
    radius: f64,
    gravity: f64,
    restitution: f64,
    /// A step of time [s].
    step: f64,
    workspace: BallWorkspace<D>,
    centre: Point<D>,
    velocity: Vector<f64, D>,
    evaluations: u32,
    path: Vec<Point<D>>,
    bounces: Vec<Bounce<D>>,
}

/// The way of a ball.
pub(super) fn fall<const D: usize>(
    scene: &BuiltScene<D>,
    centre: &[f64],
    [radius, gravity, restitution]: [f64; 3],
    cancel: &Cancel,
) -> Result<Answered<D>, String> {
    let centre = point_of::<D>(centre)?;
    // Written so that NaN is refused.
    if !(radius > 0.0 && radius <= LARGEST_LENGTH) {
        return Err(format!(
            "the radius must be more than 0 and at most {LARGEST_LENGTH:e} m, got {radius:e} m"
        ));
    }
    if !GRAVITIES.contains(&gravity) {
        return Err(format!("gravity must be from 1e-6 to 1e6 m/s², got {gravity:e} m/s²"));
    }
    if !(0.0..=1.0).contains(&restitution) {
        return Err(format!("restitution is a share from 0 to 1, got {restitution}"));
    }
    let size = size(scene).max(radius);
    let mut fall = Fall {
        shape: &scene.whole,
        bounds: scene.bounds(),
        size,
        radius,
        gravity,
        restitution,
        step: (2.0 * size / gravity).sqrt() / STEPS_A_FALL,
        workspace: BallWorkspace::new(),
        centre,
        velocity: Vector::ZERO,
        evaluations: 0,
        path: vec![centre],
        bounces: Vec::new(),
    };
    let fell = Timed::of(|| {
        let end = fall.run(Instant::now(), cancel)?;
        let Fall { step, path, bounces, evaluations, .. } = fall;
        Ok::<_, String>(Fell { step, path, bounces, end, evaluations })
    });
    fell.map(Answered::Fall)
}

impl<const D: usize> Fall<'_, D> {
    /// Falls until the way ends.
    fn run(&mut self, begin: Instant, cancel: &Cancel) -> Result<FallEnd, String> {
        if self.shape.distance(self.centre) <= self.radius {
            let mut down = Vector::ZERO;
            down[1] = -1.0;
            if self.touch(down, self.size)?.is_some_and(|(free, _)| free <= 0.0) {
                return Ok(FallEnd::Inside);
            }
        }
        let fall_speed = (2.0 * self.size * self.gravity).sqrt();
        let mut slow = 0;
        for step in 0..MOST_STEPS {
            cancel.check()?;
            let touches = self.go_on(step as f64 * self.step)?;
            self.path.push(self.centre);
            slow = if touches && self.velocity.norm() < REST_SPEED * fall_speed {
                slow + 1
            } else {
                0
            };
            if slow == REST_STEPS {
                return Ok(FallEnd::Rests);
            }
            if self.has_left() {
                return Ok(FallEnd::Leaves);
            }
            if self.evaluations >= BUDGET || begin.elapsed() > PATIENCE {
                return Ok(FallEnd::Budget);
            }
        }
        Ok(FallEnd::Time)
    }

    /// Goes on by a step that begins at `time` [s]; whether the ball touched.
    fn go_on(&mut self, time: f64) -> Result<bool, String> {
        let mut left = self.step;
        let (mut touches, mut slides) = (false, false);
        for _ in 0..MOST_TOUCHES {
            // The chord of the flight, which is a parabola.
            let mut chord = self.velocity * left;
            chord[1] -= 0.5 * self.gravity * left * left;
            let far = chord.norm();
            let Some(way) = chord.normalized().filter(|_| far > 0.0) else { break };
            let Some((free, normal)) = self.touch(way, far)? else {
                self.centre += chord;
                self.velocity[1] -= self.gravity * left;
                break;
            };
            touches = true;
            left -= self.fly(way[1] * free, left * free / far);
            self.centre += way * free + normal * (SKIN * self.radius);
            let closing = -self.velocity.dot(normal);
            if closing > SLOW * self.gravity * self.step {
                self.velocity += normal * ((1.0 + self.restitution) * closing);
                // What the ball was put off the surface costs it as much.
                if self.velocity[1] > 0.0 {
                    self.fly(normal[1] * SKIN * self.radius, 0.0);
                }
                self.bounces.push(Bounce {
                    time: time + self.step - left,
                    centre: self.centre,
                    normal,
                    speed: closing,
                });
            } else {
                slides = true;
                self.velocity += normal * closing.max(0.0);
            }
        }
        if slides {
            self.velocity = self.velocity * SLIDES_ON;
        }
        Ok(touches)
    }

    /// Takes the speed of a flight that rises by `rise` [m], which keeps the energy, and gives the time that
    /// it takes, which is near `about` [s].
    fn fly(&mut self, rise: f64, about: f64) -> f64 {
        let before = self.velocity[1];
        let squared = (before * before - 2.0 * self.gravity * rise).max(0.0);
        let is_up = before > self.gravity * about;
        self.velocity[1] = if is_up { squared.sqrt() } else { -squared.sqrt() };
        ((before - self.velocity[1]) / self.gravity).clamp(0.0, 2.0 * about)
    }

    /// How far the ball is proven free along a way of `far` [m], and the normal where it touches;
    /// `None` if it touches nothing.
    fn touch(
        &mut self,
        way: Vector<f64, D>,
        far: f64,
    ) -> Result<Option<(f64, Vector<f64, D>)>, String> {
        let said = |error: palpate::query::QueryError| error.to_string();
        let ray = Ray::new(self.centre, way, far).map_err(said)?;
        let limits = Limits::new(TOLERANCE * self.size);
        let found = cast_ball(self.shape, &ray, self.radius, &limits, &mut self.workspace)
            .map_err(said)?;
        self.evaluations = self.evaluations.saturating_add(found.evaluations);
        if found.stop == Stop::SignKnown && found.best.is_none() {
            return Ok(None);
        }
        // Where no gradient tells the side, the ball goes back along its way.
        let normal = found.best.map_or(-way, |contact| contact.normal);
        Ok(Some((found.lower.clamp(0.0, far), normal)))
    }

    /// Whether the ball is below the scene's bounds or beside them, grown by their size.
    fn has_left(&self) -> bool {
        let far = self.size + self.radius;
        self.bounds.is_some_and(|bounds| {
            (0..D).any(|axis| {
                let x = self.centre[axis];
                x < bounds.min[axis] - far || axis != 1 && x > bounds.max[axis] + far
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use palpate::scene::{AnyScene, Scene};

    use super::*;

    fn floor() -> BuiltScene<2> {
        let text = r#"{ "palpate": 1, "dimension": 2, "bodies": [ { "name": "floor",
            "shape": { "rectangle": { "size": [2, 0.2] } } } ] }"#;
        match Scene::from_json(text).unwrap().build().unwrap() {
            AnyScene::Planar(scene) => scene,
            AnyScene::Spatial(_) => panic!("in the plane"),
        }
    }

    /// The way of a ball onto the floor, or why there is none.
    fn fell(centre: [f64; 2], numbers: [f64; 3], cancel: &Cancel) -> Result<Fell<2>, String> {
        match fall(&floor(), &centre, numbers, cancel)? {
            Answered::Fall(fell) => Ok(fell.result),
            other => panic!("{other:?} is no fall"),
        }
    }

    #[test]
    fn a_ball_falls_bounces_and_rests_on_a_floor() {
        let Fell { step, path, bounces, end, .. } =
            fell([0.0, 0.7], [0.1, 9.81, 0.5], &Cancel::default()).unwrap();
        assert_eq!(end, FallEnd::Rests);
        // By 0.5 m: √(2 h / g), and √(2 g h).
        assert!((bounces[0].time - (1.0 / 9.81_f64).sqrt()).abs() < 2.0 * step);
        assert!((bounces[0].speed - 9.81_f64.sqrt()).abs() < 9.81 * 2.0 * step);
        assert_eq!(bounces[0].normal, Vector([0.0, 1.0]));
        for place in &path {
            assert!(place[1] >= 0.2 - 1e-9, "{place:?}");
        }
        let lowest = path.last().unwrap()[1];
        assert!((0.2..0.201).contains(&lowest), "{lowest}");
        // Half of the speed each time: a quarter of the height.
        let heights = path.iter().skip((bounces[0].time / step) as usize + 2);
        let highest = heights.map(|place| place[1] - 0.2).fold(0.0, f64::max);
        assert!((highest - 0.125).abs() < 0.01, "{highest}");
    }

    #[test]
    fn a_ball_that_loses_nothing_comes_up_again_and_again() {
        for (height, gravity) in [(0.1, 9.81), (0.5, 9.81), (0.5, 1.62)] {
            let at = [0.0, 0.2 + height];
            let Fell { step, path, bounces, .. } =
                fell(at, [0.1, gravity, 1.0], &Cancel::default()).unwrap();
            let (speed, time) =
                ((2.0 * gravity * height).sqrt(), (2.0 * height / gravity).sqrt());
            for (number, bounce) in bounces.iter().enumerate() {
                let error = bounce.speed / speed - 1.0;
                assert!(error.abs() < 2e-3, "{error}");
                let due = (1.0 + 2.0 * number as f64) * time;
                assert!((bounce.time / due - 1.0).abs() < 5e-3, "{bounce:?}, {due} s");
            }
            let whole = step * (path.len() - 1) as f64;
            let expected = ((whole / time + 1.0) / 2.0).floor();
            assert!((bounces.len() as f64 - expected).abs() <= 1.0, "{expected}");
        }
    }

    #[test]
    fn a_ball_far_above_comes_down() {
        let fell = fell([0.0, 9.0], [0.1, 9.81, 0.0], &Cancel::default()).unwrap();
        assert_eq!(fell.end, FallEnd::Rests);
    }

    #[test]
    fn a_ball_beside_the_floor_leaves_and_one_in_it_stays() {
        let ask = |at: [f64; 2]| fell(at, [0.1, 9.81, 0.5], &Cancel::default());
        assert_eq!(ask([1.5, 0.5]).unwrap().end, FallEnd::Leaves);
        assert_eq!(ask([0.0, 0.0]).unwrap().end, FallEnd::Inside);
        assert!(fell([0.0, 1.0], [0.1, 9.81, 1.5], &Cancel::default()).is_err());
        let cancel = Cancel::default();
        cancel.set();
        assert!(fell([0.0, 1.0], [0.1, 9.81, 0.5], &cancel).is_err());
    }
}
