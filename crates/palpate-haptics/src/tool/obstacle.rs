// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The configuration-space obstacle of a tool of fixed orientation.

use palpate_field::{Rotation, Shape, ShapeError, SpaceShape, Vector};

use super::Shell;
use crate::error::HapticsError;

impl Shell {
    /// The configuration-space obstacle of this shell turned by `rotation`: a field `g` of the
    /// tool's origin. The tool touches the shape where `g` is at most the
    /// [radius](crate::ShellPoint::radius) of its points.
    ///
    /// Lozano-Pérez, "Spatial planning: a configuration space approach" (1983). With the centres
    /// `c` of the first `points` of the shell, one at least, and the field `f` of `shape`,
    ///
    /// ```text
    /// g(x) = min f(x + R c)
    /// ```
    ///
    /// A `Tour` of `palpate-sim` over the obstacle, with the points' radius as probe radius, is a
    /// tour of the tool over `shape`, as deep as that of a probe.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Shape`] if the shape is nested too deeply.
    ///
    /// ```
    /// use palpate_field::{Rotation, Shape, Vector, kernel::Ball};
    /// use palpate_haptics::Shell;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let ball = Shape::<3>::from_kernel(Ball::new(0.05)?);
    /// let rod = Shell::capsule([Vector::ZERO, Vector([0.0, 0.1, 0.0])], 0.01, 11)?;
    /// let obstacle = rod.obstacle(&Rotation::identity(), &ball.into(), 11)?;
    /// // The upper end of the rod is 0.02 m below the lower end of the ball.
    /// assert!((obstacle.shape().distance(Vector([0.0, -0.17, 0.0])) - 0.02).abs() < 1e-15);
    /// assert!((obstacle.shape().distance(Vector([0.0, 0.07, 0.0])) - 0.02).abs() < 1e-15);
    /// # Ok(())
    /// # }
    /// ```
    pub fn obstacle(
        &self,
        rotation: &Rotation<3>,
        shape: &SpaceShape,
        points: usize,
    ) -> Result<SpaceShape, HapticsError> {
        let points = self.points().iter().take(points.max(1));
        let ways = points.map(|point| -rotation.rotate(point.centre));
        Ok(match shape.flat() {
            Some(flat) => at_all(flat, ways.map(Vector::truncated))?.into(),
            None => at_all(shape.shape(), ways)?.into(),
        })
    }
}

/// A shape at all of these places at once.
fn at_all<const D: usize>(
    shape: &Shape<D>,
    places: impl Iterator<Item = Vector<f64, D>>,
) -> Result<Shape<D>, ShapeError> {
    let moved = places.map(|place| shape.clone().translated(place));
    Shape::union(moved.collect::<Result<Vec<_>, _>>()?)
}
