// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Tools as scene files have them.

use palpate_field::kernel::Argument;
use palpate_field::{Point, Pose, Rotation, Shape, ShapeError, Vector};
use palpate_scene::{Form, Node, Primitive, WrittenRotation};

use super::{Shell, Tool, ToolOptions};
use crate::error::HapticsError;
use crate::rotation::{in_place, in_space};

/// Points on the surface of a tool that is neither a ball nor a capsule. More feel finer things,
/// and cost more; a face of 1 cm² of a tool as large as a hand has a few.
const POINTS: usize = 500;

/// The balls of a capsule are this part of its radius apart: then its sides are 3 % of the
/// radius from them at most.
const SPACING: f64 = 0.5;

/// Balls of a capsule at most: those of one thinner than a hair are farther apart.
const MOST_BALLS: f64 = 512.0;

impl<const D: usize> Tool<D> {
    /// The tool that a scene describes, with its shape as the scene
    /// [built](palpate_scene::BuiltScene::tool) it.
    ///
    /// A ball, and a capsule, are felt as they are, also where they are placed; the surface of any
    /// other shape as 500 points ([`Shell::from_field`]). The tool's `radius` makes it that much
    /// thicker. What is left out of the coupling is that of [`ToolOptions::default`].
    ///
    /// Not for the servo: it allocates.
    ///
    /// # Errors
    ///
    /// As [`Shell::from_field`] and [`Tool::new`].
    ///
    /// ```
    /// use palpate_haptics::Tool;
    /// use palpate_scene::{Scene, World};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let scene = Scene::from_json(
    ///     r#"{ "palpate": 1, "dimension": 3,
    ///          "bodies": [ { "name": "table", "shape": { "ball": { "radius": 0.5 } } } ],
    ///          "tool": { "shape": { "capsule": { "radius": 0.004, "height": 0.1 } },
    ///                    "coupling": { "stiffness": 800 } } }"#,
    /// )?;
    /// let World::Spatial(world) = scene.build()? else { return Err("it is in space".into()) };
    /// let data = scene.tool.as_ref().ok_or("it has a tool")?;
    /// let tool = Tool::from_data(data, world.tool.as_ref().ok_or("with a shape")?)?;
    /// assert_eq!((tool.options().stiffness, tool.options().damping), (800.0, 1.0));
    /// assert!(tool.shell().points().iter().all(|point| point.radius == 0.004));
    /// # Ok(())
    /// # }
    /// ```
    pub fn from_data(
        data: &palpate_scene::Tool,
        shape: &Shape<D>,
    ) -> Result<Self, HapticsError> {
        let default = ToolOptions::default();
        let coupling = data.coupling.clone().unwrap_or_default();
        let options = ToolOptions {
            stiffness: coupling.stiffness.unwrap_or(default.stiffness),
            angular_stiffness: coupling.angular_stiffness.or(default.angular_stiffness),
            damping: coupling.damping.unwrap_or(default.damping),
            angular_damping: coupling.angular_damping.unwrap_or(default.angular_damping),
            max_force: data.max_force.unwrap_or(default.max_force),
            ..default
        };
        let balls = data.shape.as_ref().and_then(|node| balls::<D>(node, Pose::identity()));
        let shell = match balls {
            Some((ends, radius)) => rod(ends.map(in_place), radius + data.radius)?,
            None => Shell::from_field(shape, POINTS, data.radius)?,
        };
        Self::new(shell, options)
    }
}

/// All points within a radius [m] of a segment.
fn rod<const D: usize>(
    [from, to]: [Point<D>; 2],
    radius: f64,
) -> Result<Shell<D>, HapticsError> {
    let length = (to - from).norm();
    if length == 0.0 && from == Vector::ZERO {
        return Shell::ball(radius);
    }
    let steps = (length / (SPACING * radius)).ceil().clamp(1.0, MOST_BALLS - 1.0);
    Shell::capsule([from, to], radius, steps as usize + 1)
}

/// The segment and the radius of a ball or a capsule, if a node is one, placed by a pose; in
/// space, where the plane is that of x and y.
fn balls<const D: usize>(
    node: &Node,
    world_from_node: Pose<3>,
) -> Option<([Point<3>; 2], f64)> {
    match &node.form {
        Form::Placed { translate, rotation, of } => {
            let translation: [f64; D] = match translate {
                Some(translate) => translate.as_slice().try_into().ok()?,
                None => [0.0; D],
            };
            let rotation = rotation.as_ref().map(turned).transpose().ok()?;
            let rotation = rotation.unwrap_or_else(Rotation::identity);
            let placed = Pose::new(rotation, in_space(Vector(translation)));
            balls::<D>(of, world_from_node * placed)
        }
        Form::Primitive(primitive) if primitive.name == "ball" => {
            Some(([world_from_node.translation; 2], number(primitive, "radius")?))
        }
        Form::Primitive(primitive) if primitive.name == "capsule" => {
            let radius = number(primitive, "radius")?;
            let half = Vector::unit(1) * (0.5 * number(primitive, "height")? - radius);
            Some(([-half, half].map(|end| world_from_node.transform_point(end)), radius))
        }
        _ => None,
    }
}

/// A rotation of the plane or of space, in space.
fn turned(written: &WrittenRotation) -> Result<Rotation<3>, ShapeError> {
    match written {
        WrittenRotation::Degrees(angle) => {
            Rotation::from_axis_angle(Vector::unit(2), angle.to_radians())
        }
        WrittenRotation::AxisAngle(turn) => {
            Rotation::from_axis_angle(Vector(turn.axis), turn.angle.to_radians())
        }
        WrittenRotation::Quaternion(quaternion) => Rotation::from_quaternion(*quaternion),
    }
}

fn number(primitive: &Primitive, key: &str) -> Option<f64> {
    match primitive.arguments.get(key) {
        Some(Argument::Number(number)) => Some(*number),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use palpate_scene::{Scene, World};

    use super::*;

    fn shell(tool: &str) -> Shell<3> {
        let scene = Scene::from_json(&format!(
            r#"{{ "palpate": 1, "dimension": 3, "tool": {tool},
                 "bodies": [ {{ "name": "table", "shape": {{ "ball": {{ "radius": 0.5 }} }} }} ] }}"#
        ));
        let scene = scene.unwrap();
        let shape = match scene.build().unwrap() {
            World::Spatial(world) => world.tool,
            World::Planar(_) => None,
        };
        let tool = Tool::from_data(&scene.tool.unwrap(), &shape.unwrap());
        tool.unwrap().shell().clone()
    }

    #[test]
    fn a_ball_and_a_capsule_are_felt_as_they_are() {
        let ball = shell(r#"{ "radius": 0.001, "shape": { "ball": { "radius": 0.02 } } }"#);
        let radii: Vec<_> = ball.points().iter().map(|point| point.radius).collect();
        assert_eq!(radii, [0.021]);
        let rod = r#"{ "shape": { "rotate_degrees": { "axis": [1, 0, 0], "angle": 90 },
            "of": { "translate": [0, 0.05, 0],
                    "of": { "capsule": { "radius": 0.01, "height": 0.12 } } } } }"#;
        let rod = shell(rod);
        assert_eq!(rod.points().len(), 21);
        assert!(rod.points().iter().all(|point| point.centre[1].abs() < 1e-16));
        let heights = || rod.points().iter().map(|point| point.centre[2]);
        assert!(heights().fold(f64::INFINITY, f64::min).abs() < 1e-16);
        assert!((heights().fold(0.0, f64::max) - 0.1).abs() < 1e-16);
        // √(r² + (r/4)²) − r
        assert!(rod.resolution(21) < 0.032 * 0.01);
    }

    #[test]
    fn what_is_neither_is_a_field() {
        let ring =
            shell(r#"{ "shape": { "torus": { "ring_radius": 0.02, "radius": 0.005 } } }"#);
        assert_eq!(ring.points().len(), POINTS);
        let grown = r#"{ "radius": 0.002,
            "shape": { "offset": 0.001, "of": { "ball": { "radius": 0.01 } } } }"#;
        let grown = shell(grown);
        assert_eq!(grown.points().len(), POINTS);
        assert!(grown.points().iter().all(|point| point.radius == 0.002));
    }
}
