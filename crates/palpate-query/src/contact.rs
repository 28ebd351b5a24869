// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A place where two bodies touch.

use std::fmt;

use palpate_field::{Point, Pose, Vector};

/// What the normal of a [`Contact`] was taken from.
///
/// A body that overlaps another by more than it is thick has no gradient that says on which side it came
/// in: its own way out is through its thickness. Its normal is then taken from elsewhere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum NormalSource {
    /// The gradients of both fields at the contact.
    #[default]
    Gradients,
    /// The gradient of the body that is thick there; the other is thin. The gap is that of its deepest
    /// point there.
    ThickerBody,
    /// The normal of the contact in earlier steps, which began when the bodies did not overlap by more
    /// than the margin: a [`Track`](crate::Track) or a [`World`](crate::World) has followed them from
    /// there. Of bodies that were first seen deeper in each other, the normal at the end of a short
    /// translation that separates them.
    History,
    /// No field gives a direction there: the line between the bodies' centres, or the y axis.
    Assumed,
}

impl fmt::Display for NormalSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Gradients => "gradients",
            Self::ThickerBody => "thicker_body",
            Self::History => "history",
            Self::Assumed => "assumed",
        })
    }
}

/// One place where two bodies touch, or nearly do, in world coordinates.
///
/// Every question that finds contacts answers with this type. Which body is
/// `a` and which is `b` follows from the order of the arguments.
///
/// ```
/// use palpate_field::Vector;
/// use palpate_query::Contact;
///
/// let contact = Contact::new(
///     Vector([0.0, 0.5]),
///     Vector([0.0, 0.25]),
///     Vector([0.0, 1.0]),
/// );
/// assert_eq!((contact.gap, contact.id), (-0.25, 0));
/// assert_eq!(contact.to_string(), "contact 0: gap -0.25 m along [0.0, 1.0] at [0.0, 0.5] m");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Contact<const D: usize> {
    /// The point on the surface of body `a` [m]; see [`on_surfaces`](Self::on_surfaces).
    pub point_a: Point<D>,
    /// The point on the surface of body `b` [m].
    pub point_b: Point<D>,
    /// The unit vector from the first body to the second. Where the fields give no direction,
    /// as at the centre of a ball, it is the line between the centres of the bodies; where that
    /// is none, and for elements, the y axis. See `normal_from`.
    pub normal: Vector<f64, D>,
    /// What the normal was taken from.
    pub normal_from: NormalSource,
    /// `false` where a point is not found on its surface, but estimated along the normal from the values
    /// of both fields: where a field is a bound, the surfaces may be farther apart than the gap.
    pub on_surfaces: bool,
    /// The distance from `point_a` to `point_b` along the normal,
    /// `(point_b − point_a)·normal` [m]; negative where the bodies overlap.
    pub gap: f64,
    /// Tells this contact from the others of the same answer. Where a
    /// [`Track`](crate::Track) or a [`World`](crate::World) follows the bodies, a contact
    /// that lasts keeps its id from step to step. So it does at a tool of `palpate-haptics`,
    /// where the id is `body << 32 | point`, of a body and a point of the tool's shell.
    /// Elsewhere the id is the contact's index in the answer.
    pub id: u64,
    /// For how many steps before this one a [`Track`](crate::Track) or a [`World`](crate::World) has had
    /// this contact: zero for a new one, and for those that nothing follows.
    pub age: u32,
}

impl<const D: usize> Contact<D> {
    /// The contact at these points [m] with this unit `normal`, from body `a` to body `b`.
    /// The gap is `(point_b − point_a)·normal`; id and age are 0, `normal_from` [`NormalSource::Gradients`], and
    /// `on_surfaces` `true`.
    #[must_use]
    #[inline]
    pub fn new(point_a: Point<D>, point_b: Point<D>, normal: Vector<f64, D>) -> Self {
        let gap = (point_b - point_a).dot(normal);
        Self {
            point_a,
            point_b,
            normal,
            normal_from: NormalSource::Gradients,
            on_surfaces: true,
            gap,
            id: 0,
            age: 0,
        }
    }

    /// The contact about a point between the bodies, or in both, where values of the fields tell the
    /// `gap`.
    pub(crate) fn estimated(point: Point<D>, normal: Vector<f64, D>, gap: f64) -> Self {
        let half = normal * (0.5 * gap);
        Self { gap, on_surfaces: false, ..Self::new(point - half, point + half, normal) }
    }

    /// The same contact, whose normal was taken from elsewhere.
    #[must_use]
    pub(crate) fn with_normal_from(self, normal_from: NormalSource) -> Self {
        Self { normal_from, ..self }
    }

    /// The same contact with another `id`.
    #[must_use]
    #[inline]
    pub fn with_id(self, id: u64) -> Self {
        Self { id, ..self }
    }

    /// The same contact in other coordinates. The gap stays: a rigid motion changes no
    /// distance.
    #[must_use]
    pub fn placed(&self, pose: &Pose<D>) -> Self {
        Self {
            point_a: pose.transform_point(self.point_a),
            point_b: pose.transform_point(self.point_b),
            normal: pose.transform_vector(self.normal),
            ..*self
        }
    }
}

impl<const D: usize> fmt::Display for Contact<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { point_a, normal, gap, id, .. } = self;
        write!(f, "contact {id}: gap {gap} m along {:?} at {:?} m", normal.0, point_a.0)
    }
}

#[cfg(test)]
mod tests {
    use palpate_field::Rotation;

    use super::*;

    #[test]
    fn a_placed_contact_keeps_its_gap_and_its_id() {
        let contact = Contact::new(
            Vector([1.0, 2.0, 3.0]),
            Vector([1.0, 2.5, 3.0]),
            Vector([0.0, 1.0, 0.0]),
        )
        .with_id(7);
        let turn =
            Rotation::from_axis_angle(Vector([0.0, 0.0, 1.0]), 0.5 * std::f64::consts::PI);
        let pose = Pose::new(turn.unwrap_or(Rotation::identity()), Vector([10.0, 0.0, 0.0]));
        let placed = contact.placed(&pose);
        assert_eq!((placed.gap, placed.id), (0.5, 7));
        assert!((placed.point_b - Vector([7.5, 1.0, 3.0])).norm() < 1e-14);
        assert!((placed.normal - Vector([-1.0, 0.0, 0.0])).norm() < 1e-15);
    }
}
