// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that move, and where they are at a time.

use palpate_field::{Pose, Screw, Shape, ShapeError};
use palpate_haptics::NextPose;

use super::{BuiltBody, BuiltScene};
use crate::motion::{Repeat, WrittenMotion};
use crate::names::unknown;
use crate::pose::{Turning, Turns};
use crate::problem::{Problem, Problems};
use crate::scene::Scene;

/// The largest angle between two times of a motion [rad]: less than half a turn.
const LARGEST_PART: f64 = 3.0;

/// The least share that a part of a motion has of the time at which it begins: a shorter
/// part is less than 10⁶ rounding errors of its start.
const LEAST_PART: f64 = 1e-10;

/// Times are as exact as this part of a period.
const ROUNDING: f64 = 1e-12;

/// How far a number of half periods is within a `period` of them; one that is a rounding before the
/// next whole half period is that.
fn within_period(passed: f64, period: f64) -> f64 {
    let rounded = passed.round();
    let is_whole = (passed - rounded).abs() <= ROUNDING * passed.abs().max(1.0);
    (if is_whole { rounded } else { passed }).rem_euclid(period)
}

/// A motion of a body of a built scene.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct BuiltMotion<const D: usize> {
    /// The number of the body in the scene.
    pub body: usize,
    /// The motion from the first to the last pose.
    pub screw: Screw<D>,
    /// When it begins [s].
    pub start: f64,
    /// How long it takes [s].
    pub duration: f64,
    /// What happens after its end.
    pub repeat: Repeat,
}

impl<const D: usize> BuiltMotion<D> {
    /// The pose of the body at a time [s]; `None` before the motion begins.
    #[must_use]
    #[inline(never)]
    pub fn pose(&self, time: f64) -> Option<Pose<D>> {
        let passed = (time - self.start) / self.duration;
        if passed.is_nan() || passed < 0.0 {
            return None;
        }
        Some(self.screw.pose(match self.repeat {
            Repeat::Once => passed,
            Repeat::Loop => passed.fract(),
            Repeat::BackAndForth => 1.0 - (1.0 - passed.rem_euclid(2.0)).abs(),
        }))
    }

    /// How long its parts take, each of which turns by less than half a turn [s], and how many there
    /// are: infinitely many if it repeats.
    fn parts(&self) -> (f64, f64) {
        let parts = (self.screw.angle().abs() / LARGEST_PART).ceil().max(1.0);
        let is_once = self.repeat == Repeat::Once;
        (self.duration / parts, if is_once { parts } else { f64::INFINITY })
    }

    /// How many parts of less than half a turn it has until a time [s].
    #[must_use]
    pub fn parts_until(&self, until: f64) -> f64 {
        let (step, most) = self.parts();
        ((until - self.start).max(0.0) / step).ceil().min(most)
    }

    /// When the body comes to rest [s]; `None` if it never does.
    #[must_use]
    pub fn end(&self) -> Option<f64> {
        (self.repeat == Repeat::Once).then_some(self.start + self.duration)
    }
}

/// A moment at which a motion puts a body somewhere else at once.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MotionJump {
    /// The number of the body in the scene.
    pub body: usize,
    /// When it jumps first [s].
    pub time: f64,
    /// How far its origin jumps [m].
    pub distance: f64,
    /// By what angle it jumps [rad].
    pub angle: f64,
    /// The time between two jumps of a loop [s]; `None` if it jumps once.
    pub period: Option<f64>,
    /// When another motion of the body begins [s], infinite if none does: a loop jumps until then.
    pub until: f64,
}

/// How fast a motion is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionSpeed {
    /// The body, by its number.
    pub body: usize,
    /// When the motion begins [s].
    pub start: f64,
    /// The fastest speed [m/s].
    pub speed: f64,
}

/// The steps in which the speed of a motion is looked for.
const STEPS: u32 = 64;

impl MotionJump {
    /// The jump of a body from one pose to another; `None` if they differ by rounding alone.
    fn between<const D: usize>(
        body: usize,
        time: f64,
        [from, to]: [&Pose<D>; 2],
    ) -> Option<Self> {
        let [from, to] = [from.in_space(), to.in_space()];
        let distance = (to.translation - from.translation).norm();
        let angle = from.rotation.turn_to(&to.rotation).norm();
        let size = from.translation.norm().max(to.translation.norm());
        let is_there = distance <= ROUNDING * size && angle <= ROUNDING;
        let (period, until) = (None, f64::INFINITY);
        (!is_there).then_some(Self { body, time, distance, angle, period, until })
    }

    /// Whether the body jumps after one time and not after another [s].
    fn is_within(&self, from: f64, to: f64) -> bool {
        let Some(period) = self.period else { return from < self.time && self.time <= to };
        // As `BuiltMotion::pose` counts them.
        let loops =
            |time: f64| ((time.min(self.until) - (self.time - period)) / period).floor();
        loops(to) > loops(from).max(0.0)
    }
}

impl<const D: usize> BuiltScene<D> {
    /// The moments at which motions jump: a motion that begins elsewhere than where the body is
    /// before it, and the end of a loop that does not meet its beginning. A hand that touches the body
    /// then feels a force that rises by 20 N/s.
    ///
    /// ```
    /// use palpate_scene::{AnyScene, Scene};
    ///
    /// # fn main() -> Result<(), palpate_scene::SceneError> {
    /// let scene = Scene::from_json(
    ///     r#"{ "palpate": 1, "dimension": 2,
    ///          "bodies": [ { "name": "belt", "shape": { "ball": { "radius": 0.01 } } } ],
    ///          "motions": [ { "body": "belt", "from": { "translation": [0, 0.03] },
    ///                         "to": { "translation": [0.1, 0.03] },
    ///                         "start": 1, "duration": 2, "repeat": "loop" } ] }"#,
    /// )?;
    /// let AnyScene::Planar(scene) = scene.build()? else { unreachable!("dimension is 2") };
    /// let jumps: Vec<_> = scene.jumps().iter().map(|jump| (jump.time, jump.distance)).collect();
    /// assert_eq!(jumps, [(1.0, 0.03), (3.0, 0.1)]);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn jumps(&self) -> Vec<MotionJump> {
        let mut jumps = Vec::new();
        for motion in &self.motions {
            let BuiltMotion { body, screw, start, duration, .. } = motion;
            let same = self.motions.iter().filter(|other| other.body == *body);
            let later = same.clone().map(|other| other.start).filter(|other| other > start);
            let until = later.fold(f64::INFINITY, f64::min);
            let earlier = same.filter(|other| other.start < *start);
            let before = earlier.max_by(|a, b| a.start.total_cmp(&b.start));
            let before = before.and_then(|before| before.pose(*start));
            let before = before.unwrap_or(self.bodies[*body].world_from_body);
            jumps.extend(MotionJump::between(*body, *start, [&before, screw.from()]));
            if motion.repeat == Repeat::Loop {
                let end = start + duration;
                let jump = MotionJump::between(*body, end, [screw.to(), screw.from()]);
                let period = Some(*duration);
                let jump = jump.filter(|jump| jump.time < until);
                jumps.extend(jump.map(|jump| MotionJump { period, until, ..jump }));
            }
        }
        jumps
    }

    /// The fastest speed of each motion [m/s]: that of the body's origin and of the farthest point of its
    /// bounding ball, by poses at 64 steps of the motion. Zero for a motion that leads back to where it
    /// begins by way of nowhere, such as a turn by 360 degrees without `turns`.
    ///
    /// ```
    /// use palpate_scene::{AnyScene, Scene};
    ///
    /// # fn main() -> Result<(), palpate_scene::SceneError> {
    /// let scene = Scene::from_json(
    ///     r#"{ "palpate": 1, "dimension": 2,
    ///          "bodies": [ { "name": "lift", "shape": { "ball": { "radius": 0.01 } } } ],
    ///          "motions": [ { "body": "lift", "to": { "translation": [0, 0.1] }, "duration": 2 },
    ///                       { "body": "lift", "to": { "rotate_degrees": 360 }, "start": 3 } ] }"#,
    /// )?;
    /// let AnyScene::Planar(scene) = scene.build()? else { unreachable!("dimension is 2") };
    /// let speeds: Vec<_> = scene.motion_speeds().iter().map(|motion| motion.speed).collect();
    /// assert!((speeds[0] - 0.05).abs() < 1e-12 && speeds[1] == 0.0);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn motion_speeds(&self) -> Vec<MotionSpeed> {
        self.motions
            .iter()
            .map(|motion| {
                let BuiltMotion { body, start, duration, screw, .. } = motion;
                let bounds = self.bodies[*body].shape_in_body.promise().bounds;
                let reach = bounds.map_or(0.0, |it| it.ball.centre.norm() + it.ball.radius);
                let pose =
                    |step: u32| screw.pose(f64::from(step) / f64::from(STEPS)).in_space();
                let ways = (0..STEPS).map(|step| {
                    let [from, to] = [step, step + 1].map(pose);
                    let turn = from.rotation.turn_to(&to.rotation).norm();
                    (to.translation - from.translation).norm() + turn * reach
                });
                let way = ways.fold(0.0, f64::max);
                let size = reach + screw.from().translation.norm();
                let is_moving = way > ROUNDING * size;
                let speed = if is_moving { way * f64::from(STEPS) / duration } else { 0.0 };
                MotionSpeed { body: *body, start: *start, speed }
            })
            .collect()
    }

    /// The pose of a body at a time [s], by its number: where the motion that began last has taken
    /// it, or its own pose if none has begun.
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_scene::{AnyScene, Scene};
    ///
    /// # fn main() -> Result<(), palpate_scene::SceneError> {
    /// let scene = Scene::from_json(
    ///     r#"{ "palpate": 1, "dimension": 2,
    ///          "bodies": [ { "name": "peg", "shape": { "ball": { "radius": 0.01 } } } ],
    ///          "motions": [ { "body": "peg", "to": { "translation": [0, -0.1] },
    ///                         "start": 1, "duration": 0.5 } ] }"#,
    /// )?;
    /// let AnyScene::Planar(scene) = scene.build()? else { unreachable!("dimension is 2") };
    /// let height = |time| scene.pose_at(0, time).translation[1];
    /// assert_eq!([0.9, 1.25, 2.0].map(height), [0.0, -0.05, -0.1]);
    /// let gap = scene.at(2.0).unwrap().whole.distance([0.0, 0.0]);
    /// assert!((gap - 0.09).abs() < 1e-15);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// Real-time: allocates nothing, takes no lock.
    ///
    /// # Panics
    ///
    /// If there is no such body.
    #[must_use]
    #[inline(never)]
    pub fn pose_at(&self, body: usize, time: f64) -> Pose<D> {
        pose_at(&self.motions, (body, self.bodies[body].world_from_body), time)
    }

    /// Times [s] from 0 to `until` between which every body either rests or goes on along one screw,
    /// by less than half a turn: both ends, and where motions begin, end, turn back or start anew. There
    /// are as many as [`parts_until`](BuiltMotion::parts_until) says.
    ///
    /// ```
    /// use palpate_scene::{AnyScene, Scene};
    ///
    /// # fn main() -> Result<(), palpate_scene::SceneError> {
    /// let scene = Scene::from_json(
    ///     r#"{ "palpate": 1, "dimension": 2,
    ///          "bodies": [ { "name": "peg", "shape": { "ball": { "radius": 0.01 } } } ],
    ///          "motions": [ { "body": "peg", "to": { "translation": [0, -0.1] }, "start": 1,
    ///                         "duration": 0.5, "repeat": "back_and_forth" } ] }"#,
    /// )?;
    /// let AnyScene::Planar(scene) = scene.build()? else { unreachable!("dimension is 2") };
    /// assert_eq!(scene.times_of_motion(2.25), [0.0, 1.0, 1.5, 2.0, 2.25]);
    /// let back = scene.way(0, 1.5, 1.75).unwrap().ok_or("it moves").unwrap();
    /// assert_eq!(back.pose(1.0).translation[1], -0.05);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    #[inline(never)]
    pub fn times_of_motion(&self, until: f64) -> Vec<f64> {
        let mut times = vec![0.0, until];
        for motion in &self.motions {
            let (step, most) = motion.parts();
            let mut count = 0.0;
            while count <= most && motion.start + count * step < until {
                times.push(motion.start + count * step);
                count += 1.0;
            }
        }
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }

    /// The way of a body between two times [s] of [`times_of_motion`](Self::times_of_motion), by its
    /// number; `None` if it rests.
    ///
    /// # Errors
    ///
    /// If it does not go on along one screw by less than half a turn, as between other times.
    ///
    /// # Panics
    ///
    /// If there is no such body.
    #[inline(never)]
    pub fn way(&self, body: usize, from: f64, to: f64) -> Result<Option<Screw<D>>, ShapeError> {
        let moved = self.motions.iter().filter(|motion| motion.body == body);
        let begun = moved.filter(|motion| motion.start <= from);
        let last = begun.max_by(|a, b| a.start.total_cmp(&b.start));
        let Some(motion) = last else { return Ok(None) };
        let (passed, way) =
            ((from - motion.start) / motion.duration, (to - from) / motion.duration);
        let [first, last] = match motion.repeat {
            Repeat::Once if passed >= 1.0 => return Ok(None),
            Repeat::Once => [passed, passed + way],
            // A time that is a rounding before the next period is of the next one.
            Repeat::Loop => {
                let share = within_period(passed, 1.0);
                [share, share + way]
            }
            Repeat::BackAndForth => match within_period(passed, 2.0) {
                share if share < 1.0 => [share, share + way],
                share => [2.0 - share, 2.0 - share - way],
            },
        };
        motion.screw.part(first, last).map(Some)
    }

    /// The numbers of the bodies that have motions, each once.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn moving(&self) -> impl Iterator<Item = usize> {
        let bodies = self.motions.iter().map(|motion| motion.body).enumerate();
        bodies.filter_map(|(i, body)| {
            let mut before = self.motions.iter().take(i);
            before.all(|motion| motion.body != body).then_some(body)
        })
    }

    /// Moves the bodies of a servo as the scene says: a closure for
    /// `palpate_haptics::servo_loop::RunOptions::with_motion`, which gets the time of a tick [s] and a function
    /// that sets the pose of a body by its number. Bodies [jump](Self::jumps) at the first time that it
    /// gets, and where time goes back.
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_haptics::NextPose;
    /// use palpate_scene::{AnyScene, Scene};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let scene = Scene::from_json(
    ///     r#"{ "palpate": 1, "dimension": 2,
    ///          "bodies": [ { "name": "table", "shape": { "rectangle": { "size": [1, 0.1] } } },
    ///                      { "name": "lid", "shape": { "rectangle": { "size": [0.1, 0.1] } } } ],
    ///          "motions": [ { "body": "lid", "to": { "translation": [0, 0.5] }, "duration": 2 } ] }"#,
    /// )?;
    /// let AnyScene::Planar(scene) = scene.build()? else { unreachable!("dimension is 2") };
    /// let mut moved = Vec::new();
    /// let mut set_pose = |body, next: NextPose| moved.push((body, next.pose.translation.0));
    /// scene.motion()(2.0, &mut set_pose);
    /// assert_eq!(moved, [(1, [0.0, 0.5, 0.0])]);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// Real-time: the closure allocates nothing, takes no lock, cannot panic.
    pub fn motion(
        &self,
    ) -> impl FnMut(f64, &mut dyn FnMut(usize, NextPose)) + Send + use<D> + 'static {
        let own = |body: usize| self.bodies[body].world_from_body;
        let moving: Vec<_> = self.moving().map(|body| (body, own(body))).collect();
        let (motions, jumps) = (self.motions.clone(), self.jumps());
        let mut before = f64::NEG_INFINITY;
        move |time, set_pose| {
            for (body, own) in &moving {
                let pose = pose_at(&motions, (*body, *own), time).in_space();
                let of_body = |jump: &&MotionJump| jump.body == *body;
                let mut of_body = jumps.iter().filter(of_body);
                let jumps = time < before || of_body.any(|jump| jump.is_within(before, time));
                set_pose(*body, NextPose { pose, jumps });
            }
            before = time;
        }
    }

    /// The scene at a time [s]: its bodies where their motions have taken them.
    ///
    /// # Errors
    ///
    /// If a body cannot be placed there, as its shape says.
    #[inline(never)]
    pub fn at(&self, time: f64) -> Result<Self, ShapeError> {
        let mut scene = self.clone();
        for number in self.moving() {
            let pose = self.pose_at(number, time);
            let body = &mut scene.bodies[number];
            *body = BuiltBody {
                shape: body.shape_in_body.clone().placed(&pose)?,
                world_from_body: pose,
                ..body.clone()
            };
        }
        if !self.motions.is_empty() {
            scene.whole = Shape::union(scene.bodies.iter().map(|body| body.shape.clone()))?;
        }
        Ok(scene)
    }
}

/// The pose of a body at a time [s], given by its number and its own pose.
fn pose_at<const D: usize>(
    motions: &[BuiltMotion<D>],
    (body, own): (usize, Pose<D>),
    time: f64,
) -> Pose<D> {
    let moved = motions.iter().filter(|motion| motion.body == body);
    let begun = moved.filter_map(|motion| Some((motion.start, motion.pose(time)?)));
    // Of motions that begin together, the last of the file holds.
    let last = begun.max_by(|a, b| a.0.total_cmp(&b.0));
    last.map_or(own, |(_, pose)| pose)
}

/// Checks and builds the motions of a scene; `bodies` are `None` if they have problems.
pub(super) fn motions<const D: usize>(
    scene: &Scene,
    bodies: Option<&[BuiltBody<D>]>,
) -> Result<Vec<BuiltMotion<D>>, Problems>
where
    Turns: Turning<D>,
{
    let mut wrong = Problems::default();
    let mut motions = Vec::with_capacity(scene.motions.len());
    for (i, motion) in scene.motions.iter().enumerate() {
        let built = built(motion, scene, bodies).map_err(|problems| problems.at(i));
        motions.extend(wrong.kept(built));
    }
    wrong.end(Ok(motions))
}

fn built<const D: usize>(
    motion: &WrittenMotion,
    scene: &Scene,
    bodies: Option<&[BuiltBody<D>]>,
) -> Result<BuiltMotion<D>, Problems>
where
    Turns: Turning<D>,
{
    let mut wrong = Problems::default();
    wrong.kept(motion.check());
    let names: Vec<_> = scene.bodies.iter().map(|body| body.name.as_str()).collect();
    let body = names.iter().position(|name| *name == motion.body);
    let body =
        body.ok_or_else(|| Problem::new(unknown("body", &motion.body, &names)).under("body"));
    let body = wrong.kept(body);
    let from = motion.from.as_ref().map(|pose| pose.built::<D>()).transpose();
    let from = wrong.kept(from.map_err(|problems| problems.under("from")));
    let to = wrong.kept(motion.to.built::<D>().map_err(|problems| problems.under("to")));
    let (Some(body), Some(from), Some(to), false) = (body, from, to, wrong.is_failed()) else {
        return Err(wrong);
    };
    let Some(bodies) = bodies else { return Err(Problems::told()) };
    let from = from.unwrap_or(bodies[body].world_from_body);
    // Both poses are checked: what is refused are the turns.
    let screw = Screw::new(from, to, motion.turns)
        .map_err(|error| Problem::of_shape(error).under("turns"))?;
    let WrittenMotion { start, duration, repeat, .. } = *motion;
    let built = BuiltMotion { body, screw, start, duration, repeat };
    if built.parts().0 < LEAST_PART * start {
        // Rounded up, so that what is told is accepted.
        let least = 1.1 * LEAST_PART * start * duration / built.parts().0;
        return Err(Problem::new(format!(
            "the motion is too short to be timed after {start} s: it must take {least:.1e} s at least, \
             and takes {duration:e} s; begin earlier"
        ))
        .under("duration")
        .into());
    }
    Ok(built)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::AnyScene;

    /// The ticks of 0.25 s in which the only body of a scene jumps, in 8 s.
    fn jumps(motions: &str) -> Vec<usize> {
        let text = format!(
            r#"{{ "palpate": 1, "dimension": 2,
                 "bodies": [ {{ "name": "belt", "shape": {{ "ball": {{ "radius": 0.01 }} }} }} ],
                 "motions": {motions} }}"#
        );
        let scene = Scene::from_json(&text).unwrap().build().unwrap();
        let AnyScene::Planar(scene) = scene else { unreachable!("dimension is 2") };
        let mut motion = scene.motion();
        let mut found = Vec::new();
        for tick in 0..32 {
            motion(0.25 * tick as f64, &mut |_, next| found.extend(next.jumps.then_some(tick)));
        }
        found
    }

    #[test]
    fn a_body_jumps_where_poses_before_and_after_a_moment_differ() {
        let to = r#""to": { "translation": [0.1, 0] }, "duration": 1"#;
        let from = r#""from": { "translation": [0.03, 0] }"#;
        assert!(jumps(&format!(r#"[{{ "body": "belt", {to}, "start": 1 }}]"#)).is_empty());
        assert_eq!(jumps(&format!(r#"[{{ "body": "belt", {from}, {to}, "start": 1 }}]"#)), [4]);
        let begins = jumps(&format!(r#"[{{ "body": "belt", {from}, {to} }}]"#));
        assert_eq!(begins, [0]);
        let back = jumps(&format!(
            r#"[{{ "body": "belt", {to}, "start": 1, "repeat": "back_and_forth" }}]"#
        ));
        assert!(back.is_empty());
        let loops =
            jumps(&format!(r#"[{{ "body": "belt", {to}, "start": 1, "repeat": "loop" }}]"#));
        assert_eq!(loops, [8, 12, 16, 20, 24, 28]);
        // Another motion ends the loop: it begins where the loop does not end.
        let ended = jumps(&format!(
            r#"[{{ "body": "belt", {to}, "start": 1, "repeat": "loop" }},
                {{ "body": "belt", {from}, {to}, "start": 4.5 }}]"#
        ));
        assert_eq!(ended, [8, 12, 16, 18]);
    }
}
