// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a field says at a point.

use std::fmt;

use palpate_field::Point;
use palpate_query::{AtPoint, BallWorkspace, evaluate_point};
use serde::{Deserialize, Serialize};

use super::{AskError, BallAnswer, Balls, point};
use crate::build::BuiltScene;
use crate::text::joined;

/// What does the field of a scene say at a point?
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PointQuestion {
    /// The point [m].
    pub at: Vec<f64>,
    /// The body that is asked about; all bodies as one if left out.
    #[serde(default)]
    pub body: Option<String>,
    /// Asks too whether the ball of this radius about the point touches all bodies [m].
    #[serde(default)]
    pub radius: Option<f64>,
}

/// What a field says at a point.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct PointAnswer<const D: usize> {
    /// Value, gradient and nearest point.
    #[serde(flatten)]
    pub at: AtPoint<D>,
    /// The body that was asked about, or else the one with the least value.
    pub body: Option<String>,
    /// What the field promises, in words.
    pub promise: String,
    /// The Lipschitz constant of the field.
    pub lipschitz: f64,
    /// What is known of the ball, if one was asked about.
    pub ball: Option<BallAnswer<D>>,
}

impl PointQuestion {
    pub(super) fn answer<const D: usize>(
        &self,
        scene: &BuiltScene<D>,
    ) -> Result<PointAnswer<D>, AskError> {
        let (point, shape) = (point::<D>(&self.at)?, scene.shape_of(self.body.as_deref())?);
        let balls = self.radius.map(|radius| Balls::new(scene, radius)).transpose()?;
        let at = evaluate_point(shape, point)?;
        let ball = balls.map(|balls| balls.ask(&at, &mut BallWorkspace::new())).transpose()?;
        let promise = shape.promise();
        Ok(PointAnswer {
            at,
            body: self.body.clone().or_else(|| nearest_body(scene, point)),
            promise: promise.in_words(),
            lipschitz: promise.lipschitz,
            ball,
        })
    }
}

/// The name of the body with the least value at a point.
fn nearest_body<const D: usize>(scene: &BuiltScene<D>, point: Point<D>) -> Option<String> {
    let distance = |body: &&crate::BuiltBody<D>| body.shape.distance(point);
    let least = scene.bodies.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    Some(least.name.clone())
}

impl<const D: usize> fmt::Display for PointAnswer<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let at = &self.at;
        writeln!(f, "distance       {} m", at.distance)?;
        writeln!(f, "gradient       {}", joined(&at.gradient.0))?;
        let proven = self.ball.as_ref().and_then(BallAnswer::surface_point);
        match at.surface.or(proven) {
            Some(surface) => writeln!(f, "surface point  {} m", joined(&surface.0))?,
            None => writeln!(f, "surface point  none found")?,
        }
        writeln!(f, "inside         {}", if at.is_inside { "yes" } else { "no" })?;
        writeln!(f, "safe radius    {} m", at.safe_radius)?;
        writeln!(f, "promise        {}", self.promise)?;
        self.ball.as_ref().map_or(Ok(()), |ball| ball.fmt(f))
    }
}
