// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! parry's shapes, where it has the same.

use palpate::field::Pose;
use palpate::field::kernel::Argument;
use palpate::scene::{Form, Node, Scene};
use parry3d_f64::math::{Pose as ParryPose, Rotation, Vector};
use parry3d_f64::shape::{Ball, Cuboid, SharedShape};

use crate::scenes::pose;

/// A placed shape of parry.
pub(crate) struct Body {
    shape: SharedShape,
    pose: ParryPose,
}

impl Body {
    /// The first body of a scene, if parry has it: a ball or a box, perhaps placed.
    pub(crate) fn of(scene: &Scene) -> Option<Self> {
        let node = &scene.bodies[0].shape;
        let (pose, node) = match &node.form {
            Form::Placed { translate, rotation, of } => {
                (pose(translate.as_deref(), rotation.as_ref()).ok()?, &**of)
            }
            _ => (Pose::identity(), node),
        };
        let [x, y, z, w] = pose.rotation.quaternion();
        let rotation = Rotation::from_xyzw(x, y, z, w);
        let [x, y, z] = pose.translation.0;
        let pose = ParryPose::from_parts(Vector::new(x, y, z), rotation);
        Some(Self { shape: shape(node)?, pose })
    }

    /// The signed distance of a point.
    pub(crate) fn distance(&self, [x, y, z]: [f64; 3]) -> f64 {
        self.shape.distance_to_point(&self.pose, Vector::new(x, y, z), false)
    }
}

fn shape(node: &Node) -> Option<SharedShape> {
    let Form::Primitive(primitive) = &node.form else { return None };
    let argument = primitive.arguments.values().next()?;
    match (primitive.name.as_str(), argument) {
        ("ball", Argument::Number(radius)) => Some(SharedShape::new(Ball::new(*radius))),
        ("cuboid", Argument::Vector(size)) => {
            let [x, y, z] = size.as_slice().try_into().ok()?;
            Some(SharedShape::new(Cuboid::new(Vector::new(0.5 * x, 0.5 * y, 0.5 * z))))
        }
        _ => None,
    }
}
