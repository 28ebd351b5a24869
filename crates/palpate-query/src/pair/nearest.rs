// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where two bodies are nearest.

use palpate_field::{Point, Vector};

use super::body_pair::BodyPair;
use crate::contact::Contact;
use crate::placed::Placed;

/// Where two bodies are nearest, or overlap most, in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Nearest<const D: usize> {
    /// The point between the bodies, or in both [m].
    pub point: Point<D>,
    /// The unit vector from the first body to the second; `None` where the gradients of both
    /// are equal or vanish.
    pub normal: Option<Vector<f64, D>>,
}

impl<const D: usize> Nearest<D> {
    /// The answer at a point of the pair's frame.
    pub(super) fn at(pair: &mut BodyPair<'_, D>, p: Point<D>) -> Self {
        let (normal, _) = pair.normal(p);
        let pose = &pair.world_from_frame;
        Self {
            point: pose.transform_point(p),
            normal: normal.map(|normal| pose.transform_vector(normal)),
        }
    }

    /// The points of both surfaces next to [`Nearest::point`], found along the gradients.
    ///
    /// Where the bodies are apart, the distance of these points is an upper bound of the
    /// bodies' distance, and the separation a lower bound. `None` if there is no normal, or
    /// no surface was found.
    #[must_use]
    pub fn contact<'a>(
        &self,
        a: impl Into<Placed<'a, D>>,
        b: impl Into<Placed<'a, D>>,
    ) -> Option<Contact<D>> {
        let normal = self.normal?;
        let surface = |placed: Placed<'_, D>| {
            let pose = placed.world_from_body;
            let local = pose.inverse().transform_point(self.point);
            Some(pose.transform_point(placed.shape.surface_point(local)?))
        };
        let (point_a, point_b) = (surface(a.into())?, surface(b.into())?);
        Some(Contact::new(point_a, point_b, normal))
    }
}
