// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! parry's shapes, where it has the same.

use std::any::Any;

use palpate::field::kernel::Argument;
use palpate::field::{Node, Pose, Shape};
use parry3d_f64::math::{Pose as ParryPose, Rotation, Vector};
use parry3d_f64::shape::{Ball, Cuboid, SharedShape};

/// A placed shape of parry.
pub(crate) struct Body {
    shape: SharedShape,
    pose: ParryPose,
}

impl Body {
    /// A shape of space, if parry has it: a ball or a box, perhaps placed.
    pub(crate) fn of<const D: usize>(of: &Shape<D>) -> Option<Self> {
        let of: &dyn Any = of;
        let of = of.downcast_ref::<Shape<3>>()?;
        let (pose, of) = match of.node() {
            Node::Placed { pose, of } => (*pose, of),
            _ => (Pose::identity(), of),
        };
        let [x, y, z, w] = pose.rotation.quaternion();
        let rotation = Rotation::from_xyzw(x, y, z, w);
        let [x, y, z] = pose.translation.0;
        let pose = ParryPose::from_parts(Vector::new(x, y, z), rotation);
        Some(Self { shape: shape(of)?, pose })
    }

    /// The signed distance of a point.
    pub(crate) fn distance(&self, [x, y, z]: [f64; 3]) -> f64 {
        self.shape.distance_to_point(&self.pose, Vector::new(x, y, z), false)
    }
}

fn shape(of: &Shape<3>) -> Option<SharedShape> {
    let Node::Primitive(primitive) = of.node() else { return None };
    match (primitive.name(), primitive.arguments().first()?) {
        ("ball", Argument::Number(radius)) => Some(SharedShape::new(Ball::new(*radius))),
        ("cuboid", Argument::Vector(size)) => {
            let [x, y, z] = size.as_slice().try_into().ok()?;
            Some(SharedShape::new(Cuboid::new(Vector::new(0.5 * x, 0.5 * y, 0.5 * z))))
        }
        _ => None,
    }
}
