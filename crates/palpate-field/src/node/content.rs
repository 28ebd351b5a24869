// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a node holds: its operands, faces and text.

use std::cell::Cell;
use std::fmt::{self, Debug, Display, Formatter};

use super::{Boolean, Node, Opaque, Primitive};
use crate::kernel::Argument;
use crate::pose::{Pose, Rotation};
use crate::shape::Shape;
use crate::vector::Point;

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

/// How many shapes `Debug` shows before it counts the others.
const MOST_SHOWN: usize = 64;

/// How tightly an expression holds together, as the operators of Rust do.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Tightness {
    Union,
    SymmetricDifference,
    Intersection,
    Difference,
    Call,
}

/// Writes a shape, and leaves out the parts that do not fit.
struct Text<'a, const D: usize> {
    shape: &'a Shape<D>,
    /// The operator around it: the shape is put in brackets if it is no tighter.
    within: Option<Tightness>,
    room: &'a Cell<usize>,
}

impl<const D: usize> Display for Shape<D> {
    /// Writes what builds the shape. Numbers read back to the same bits; a rotation is
    /// written as the rows of its matrix.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}", Text { shape: self, within: None, room: &Cell::new(usize::MAX) })
    }
}

impl<const D: usize> Debug for Shape<D> {
    /// As `Display`; of a large shape the first parts, and how many more there are.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}", Text { shape: self, within: None, room: &Cell::new(MOST_SHOWN) })
    }
}

fn tightness<const D: usize>(node: &Node<D>) -> Tightness {
    match node {
        Node::Union(_) => Tightness::Union,
        Node::SymmetricDifference(_) => Tightness::SymmetricDifference,
        Node::Intersection(_) => Tightness::Intersection,
        Node::Difference(_) => Tightness::Difference,
        _ => Tightness::Call,
    }
}

impl<const D: usize> Display for Text<'_, D> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let room = self.room.get();
        if room == 0 {
            return f.write_str("…");
        }
        self.room.set(room - 1);
        let own = tightness(self.shape.node());
        let brackets = self.within.is_some_and(|within| own <= within);
        f.write_str(if brackets { "(" } else { "" })?;
        self.node(f)?;
        f.write_str(if brackets { ")" } else { "" })
    }
}

impl<const D: usize> Text<'_, D> {
    fn node(&self, f: &mut Formatter<'_>) -> fmt::Result {
        // Before a method all operators need brackets.
        let before = |of| Text { shape: of, within: Some(Tightness::Difference), ..*self };
        let inside = |of| Text { shape: of, within: None, ..*self };
        match self.shape.node() {
            Node::Primitive(primitive) => write!(f, "{primitive}"),
            Node::Union(of) => self.chain(f, of, " | ", Tightness::Union),
            Node::SymmetricDifference(of) => {
                self.chain(f, of, " ^ ", Tightness::SymmetricDifference)
            }
            Node::Intersection(of) => self.chain(f, of, " & ", Tightness::Intersection),
            Node::Difference(of) => self.chain(f, of, " - ", Tightness::Difference),
            Node::Smooth { boolean, profile, width, of } => {
                self.smooth(f, *boolean, of)?;
                write!(f, ", {profile:?}, {width:?})")
            }
            Node::Displaced { of, by, height } => {
                write!(f, "{}.displaced({}, {height:?})", before(of), inside(by))
            }
            Node::Morphed { from, into, progress } => {
                write!(f, "{}.morphed({}, {progress:?})", before(from), inside(into))
            }
            Node::Placed { pose, of } => write!(f, "{}{}", before(of), Motion(pose)),
            Node::Scaled { factor, of } => write!(f, "{}.scaled({factor:?})", before(of)),
            Node::Stretched { factors, of } => {
                write!(f, "{}.stretched({factors:?})", before(of))
            }
            Node::Offset { distance, of } => write!(f, "{}.offset({distance:?})", before(of)),
            Node::Operated { operator, argument, of } => {
                write!(f, "{}.{}({argument})", before(of), operator.method)
            }
            Node::Mirrored { axis, of } => write!(f, "{}.mirrored({axis})", before(of)),
            Node::Repeated { copies, of } => write!(f, "{}.repeated({copies:?})", before(of)),
            Node::Bent { rate, of } => write!(f, "{}.bent({rate:?})", before(of)),
            Node::Twisted { rate, of } => write!(f, "{}.twisted({rate:?})", before(of)),
            Node::Extruded { height, of } => {
                write!(f, "{}.extruded({height:?})", self.profile(of))
            }
            Node::Revolved { of } => write!(f, "{}.revolved()", self.profile(of)),
            Node::Opaque(opaque) => write!(f, "{opaque:?}"),
        }
    }

    /// The profile of a solid, before a method.
    fn profile<'a>(&'a self, of: &'a Shape<2>) -> Text<'a, 2> {
        Text { shape: of, within: Some(Tightness::Difference), room: self.room }
    }

    /// Shapes with an operator between them.
    fn chain(
        &self,
        f: &mut Formatter<'_>,
        of: &[Shape<D>],
        operator: &str,
        own: Tightness,
    ) -> fmt::Result {
        for (i, shape) in of.iter().enumerate() {
            f.write_str(if i == 0 { "" } else { operator })?;
            if self.room.get() == 0 {
                return write!(f, "… {} more", of.len() - i);
            }
            write!(f, "{}", Text { shape, within: Some(own), ..*self })?;
        }
        Ok(())
    }

    /// A smooth boolean up to the last of its shapes.
    fn smooth(&self, f: &mut Formatter<'_>, boolean: Boolean, of: &[Shape<D>]) -> fmt::Result {
        let name = match boolean {
            Boolean::Union => "smooth_union([",
            Boolean::Intersection => "smooth_intersection([",
            Boolean::Difference => ".smooth_difference([",
        };
        let mut of = of;
        if let (Boolean::Difference, Some((shape, others))) = (boolean, of.split_first()) {
            write!(f, "{}", Text { shape, within: Some(Tightness::Difference), ..*self })?;
            of = others;
        }
        f.write_str(name)?;
        for (i, shape) in of.iter().enumerate() {
            f.write_str(if i == 0 { "" } else { ", " })?;
            if self.room.get() == 0 {
                write!(f, "… {} more", of.len() - i)?;
                break;
            }
            write!(f, "{}", Text { shape, within: None, ..*self })?;
        }
        f.write_str("]")
    }
}

impl<const D: usize> Display for Primitive<D> {
    /// Writes the call of the constructor.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}(", self.name())?;
        for (i, argument) in self.arguments().iter().enumerate() {
            f.write_str(if i == 0 { "" } else { ", " })?;
            write!(f, "{argument}")?;
        }
        f.write_str(")")
    }
}

impl Display for Argument {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number:?}"),
            Self::Count(count) => write!(f, "{count}"),
            Self::Vector(vector) => write!(f, "{vector:?}"),
            Self::Points(points) => write!(f, "{points:?}"),
            Self::Rings(rings) => write!(f, "{rings:?}"),
        }
    }
}

/// A motion as the methods that make it.
struct Motion<'a, const D: usize>(&'a Pose<D>);

impl<const D: usize> Display for Motion<'_, D> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Pose { rotation, translation } = self.0;
        let turned = *rotation != Rotation::identity();
        if turned {
            write!(f, ".rotated({:?})", rotation.matrix())?;
        }
        if !turned || translation.0.iter().any(|x| *x != 0.0) {
            write!(f, ".translated({:?})", translation.0)?;
        }
        Ok(())
    }
}
