// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What determines the values of a shape, as bytes.

use super::{Node, Opaque};
use crate::shape::Shape;

impl<const D: usize> Shape<D> {
    /// Feeds `sink` with all that determines the values, as bytes: the text that builds the shape, and what its
    /// fields of users [feed](crate::CustomField::content). `false` if a kernel, field or closure in it is known by
    /// its Rust type alone.
    ///
    /// The sum of these bytes is a name under which what was made of the shape can be found again.
    ///
    /// ```
    /// use palpate_field::Shape;
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let content = |radius| {
    ///     let mut bytes = Vec::new();
    ///     let is_known = Shape::circle(radius)?.content(&mut |part| bytes.extend_from_slice(part));
    ///     Ok::<_, palpate_field::ShapeError>((is_known, bytes))
    /// };
    /// assert!(content(0.5)?.0);
    /// assert_eq!(content(0.5)?, content(0.5)?);
    /// assert_ne!(content(0.5)?, content(0.5 + f64::EPSILON)?);
    /// # Ok(())
    /// # }
    /// ```
    pub fn content(&self, sink: &mut dyn FnMut(&[u8])) -> bool {
        let text = self.to_string();
        // The length ends the text, so that no bytes of a field can go on with it.
        sink(&(text.len() as u64).to_le_bytes());
        sink(text.as_bytes());
        self.all_opaque(&mut |part| part.content(sink))
    }

    /// Whether a kernel, field or closure of this Rust type, as [`type_name`](std::any::type_name) gives it, is
    /// in the shape.
    ///
    /// ```
    /// use palpate_field::{Promise, Shape, Vector};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let floor = Shape::from_fn(Promise::lipschitz(None, 1.0), |Vector([_, y])| y);
    /// let palpate_field::Node::Opaque(opaque) = floor.node() else { unreachable!() };
    /// let holed = &floor - Shape::circle(0.1)?;
    /// assert!(holed.holds(opaque.type_name()) && !Shape::circle(0.1)?.holds(opaque.type_name()));
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn holds(&self, type_name: &str) -> bool {
        !self.all_opaque(&mut |part| part.kind() != type_name)
    }

    /// Whether `is` says so of all kernels, fields and closures in the shape.
    fn all_opaque(&self, is: &mut dyn FnMut(&dyn Part) -> bool) -> bool {
        match self.node() {
            Node::Primitive(_) => true,
            Node::Opaque(opaque) => is(opaque),
            Node::Union(of)
            | Node::Intersection(of)
            | Node::Difference(of)
            | Node::SymmetricDifference(of)
            | Node::Smooth { of, .. } => of.iter().all(|shape| shape.all_opaque(is)),
            Node::Displaced { of: a, by: b, .. } | Node::Morphed { from: a, into: b, .. } => {
                a.all_opaque(is) && b.all_opaque(is)
            }
            Node::Placed { of, .. }
            | Node::Scaled { of, .. }
            | Node::Stretched { of, .. }
            | Node::Offset { of, .. }
            | Node::Operated { of, .. }
            | Node::Mirrored { of, .. }
            | Node::Repeated { of, .. }
            | Node::Bent { of, .. }
            | Node::Twisted { of, .. } => of.all_opaque(is),
            Node::Extruded { of, .. } | Node::Revolved { of } => of.all_opaque(is),
        }
    }
}

/// An opaque part of a shape, of either dimension.
trait Part {
    fn kind(&self) -> &'static str;

    /// As [`CustomField::content`](crate::CustomField::content).
    fn content(&self, sink: &mut dyn FnMut(&[u8])) -> bool;
}

impl<const D: usize> Part for Opaque<D> {
    fn kind(&self) -> &'static str {
        self.kind
    }

    fn content(&self, sink: &mut dyn FnMut(&[u8])) -> bool {
        self.field.content(sink)
    }
}
