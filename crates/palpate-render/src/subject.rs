// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a picture shows: bodies with their colours.

use palpate_field::{Aabb, BoundingBall, Point, Shape, Vector};
use palpate_query::QueryError;

use crate::color::SrgbColor;
use crate::error::RenderError;

/// How far bodies without bounds are drawn, in radii of the ball around those that have bounds.
const FAR: f64 = 12.0;

/// Half the side of the cube that is shown of a scene without bounds [m].
const HALF_SIDE: f64 = 0.5;

/// A shape in the world, and its colour.
#[derive(Clone, Debug)]
pub struct LitBody {
    /// The shape.
    pub shape: Shape<3>,
    /// The colour.
    pub color: SrgbColor,
}

/// A plane through bodies: what lies on the side to which the normal points is cut away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// A point of the plane [m].
    pub(crate) point: Point<3>,
    /// The unit normal.
    pub(crate) normal: Vector<f64, 3>,
}

impl Cut {
    /// The plane through `point` [m] that is perpendicular to `normal`.
    ///
    /// ```
    /// use palpate_render::{Cut, Settings};
    ///
    /// let cut = Cut::new([0.0, 0.0, 0.01], [0.0, 0.0, 2.0])?;
    /// let settings = Settings { cut: Some(cut), ..Settings::new(64, 48) };
    /// assert!(Cut::new([0.0; 3], [0.0; 3]).is_err());
    /// # Ok::<(), palpate_render::RenderError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the point is not finite or beyond 1e15, or the normal has no direction.
    pub fn new(
        point: impl Into<Point<3>>,
        normal: impl Into<Vector<f64, 3>>,
    ) -> Result<Self, RenderError> {
        let (point, normal) = (point.into(), normal.into());
        QueryError::check_point("a point of a cut", point)?;
        let wrong = RenderError::NoPlane { what: "the normal of a cut", got: normal.0 };
        let normal = normal.normalized().ok_or(wrong)?;
        Ok(Self { point, normal })
    }

    /// The distance of a point from the plane, positive where bodies are cut away [m].
    pub(crate) fn elevation(&self, point: Point<3>) -> f64 {
        (point - self.point).dot(self.normal)
    }
}

/// The bodies of a picture.
#[derive(Clone, Debug)]
pub struct Subject {
    bodies: Vec<LitBody>,
}

impl Subject {
    /// These bodies.
    ///
    /// # Errors
    ///
    /// [`RenderError::NoBody`].
    pub fn new(bodies: Vec<LitBody>) -> Result<Self, RenderError> {
        if bodies.is_empty() { Err(RenderError::NoBody) } else { Ok(Self { bodies }) }
    }

    /// Shapes in the colours of [`SrgbColor::BODIES`].
    ///
    /// # Errors
    ///
    /// [`RenderError::NoBody`].
    pub fn of_shapes(shapes: impl IntoIterator<Item = Shape<3>>) -> Result<Self, RenderError> {
        let body = |(i, shape)| LitBody { shape, color: SrgbColor::of_body(i) };
        Self::new(shapes.into_iter().enumerate().map(body).collect())
    }

    /// The bodies.
    #[must_use]
    pub fn bodies(&self) -> &[LitBody] {
        &self.bodies
    }

    /// The box around all bodies that have bounds; a cube of a metre about the origin if none
    /// has.
    #[must_use]
    pub fn bounds(&self) -> Aabb<3> {
        let boxes = self.bodies.iter().filter_map(|body| body.shape.promise().bounds);
        let all = boxes.map(|bounds| bounds.aabb).reduce(|a, b| a.union(&b));
        all.unwrap_or_else(|| Aabb::centred(Vector::constant(HALF_SIDE)))
    }

    /// The corners of that box.
    #[must_use]
    pub fn corners(&self) -> [Point<3>; 8] {
        let Aabb { min, max } = self.bounds();
        let side = |code: usize, k: usize| if code >> k & 1 == 1 { max[k] } else { min[k] };
        std::array::from_fn(|code| Vector(std::array::from_fn(|k| side(code, k))))
    }

    /// `true` if every body has bounds.
    #[must_use]
    pub fn is_bounded(&self) -> bool {
        self.bodies.iter().all(|body| body.shape.promise().bounds.is_some())
    }

    /// The ball beyond which bodies without bounds are not drawn.
    #[must_use]
    pub fn horizon(&self) -> BoundingBall<3> {
        let bounds = self.bounds();
        let radius = bounds.half_extents().norm();
        // A scene of one point has a horizon too.
        let radius = if radius > 0.0 { radius } else { HALF_SIDE };
        BoundingBall { centre: bounds.centre(), radius: FAR * radius }
    }
}
