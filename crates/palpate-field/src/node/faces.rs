// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The faces of a polyhedron or polygon.

use super::Node;
use crate::shape::Shape;
use crate::vector::Point;

impl<const D: usize> Shape<D> {
    /// Calls `visit` with each face of a field of faces that was moved and scaled at most; `false` if the shape is
    /// something else.
    pub(crate) fn faces(&self, visit: &mut dyn FnMut([Point<D>; D])) -> bool {
        match self.node() {
            Node::Opaque(opaque) => opaque.field.faces(visit),
            Node::Placed { pose, of } => {
                of.faces(&mut |face| visit(face.map(|p| pose.transform_point(p))))
            }
            Node::Scaled { factor, of } => {
                of.faces(&mut |face| visit(face.map(|p| p * *factor)))
            }
            _ => false,
        }
    }
}
