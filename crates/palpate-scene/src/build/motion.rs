// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that move, and where they are at a time.

use palpate_field::{Pose, Screw, Shape, ShapeError};

use super::{BuiltBody, BuiltScene};
use crate::motion::{Motion, Repeat};
use crate::pose::{Turning, Turns};
use crate::problem::{Problem, unknown};
use crate::scene::Scene;

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

    /// When the body comes to rest [s]; `None` if it never does.
    #[must_use]
    pub fn end(&self) -> Option<f64> {
        (self.repeat == Repeat::Once).then_some(self.start + self.duration)
    }
}

impl<const D: usize> BuiltScene<D> {
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
    /// # Panics
    ///
    /// If there is no such body.
    #[must_use]
    pub fn pose_at(&self, body: usize, time: f64) -> Pose<D> {
        let moved = self.motions.iter().filter(|motion| motion.body == body);
        let begun = moved.filter_map(|motion| Some((motion.start, motion.pose(time)?)));
        // Of motions that begin together, the last of the file holds.
        let last = begun.max_by(|a, b| a.0.total_cmp(&b.0));
        last.map_or(self.bodies[body].world_from_body, |(_, pose)| pose)
    }

    /// The scene at a time [s]: its bodies where their motions have taken them.
    ///
    /// # Errors
    ///
    /// If a body cannot be placed there, as its shape says.
    pub fn at(&self, time: f64) -> Result<Self, ShapeError> {
        let mut scene = self.clone();
        for motion in &self.motions {
            let pose = self.pose_at(motion.body, time);
            let body = &mut scene.bodies[motion.body];
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

/// Checks and builds the motions of a scene.
pub(super) fn motions<const D: usize>(
    scene: &Scene,
    bodies: &[BuiltBody<D>],
) -> Result<Vec<BuiltMotion<D>>, Problem>
where
    Turns: Turning<D>,
{
    let built = |(i, motion)| built(motion, bodies).map_err(|problem| problem.at(i));
    scene.motions.iter().enumerate().map(built).collect()
}

fn built<const D: usize>(
    motion: &Motion,
    bodies: &[BuiltBody<D>],
) -> Result<BuiltMotion<D>, Problem>
where
    Turns: Turning<D>,
{
    motion.check()?;
    let Some(body) = bodies.iter().position(|body| body.name == motion.body) else {
        let known: Vec<_> = bodies.iter().map(|body| body.name.as_str()).collect();
        return Err(Problem::new(unknown("body", &motion.body, &known)).under("body"));
    };
    let from = motion.from.as_ref().map(|pose| pose.built()).transpose();
    let from = from.map_err(|problem| problem.under("from"))?;
    let from = from.unwrap_or(bodies[body].world_from_body);
    let to = motion.to.built().map_err(|problem| problem.under("to"))?;
    let screw = Screw::new(from, to, motion.turns).map_err(Problem::of_shape)?;
    let Motion { start, duration, repeat, .. } = *motion;
    Ok(BuiltMotion { body, screw, start, duration, repeat })
}
