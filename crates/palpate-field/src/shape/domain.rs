// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes in space that is folded, stretched or turned: mirror, repetition, bend,
//! twist, extrusion, revolution.

use super::Shape;
use crate::error::ShapeError;
use crate::node::Node;
use crate::operator::Copies;

impl<const D: usize> Shape<D> {
    /// The part at positive coordinates of `axis`, and its mirror image:
    /// `f(|x|, …)`.
    ///
    /// Outside, exact where the shape is if it stays on the positive side; inside,
    /// if it does not touch the mirror either. Else a bound.
    ///
    /// # Errors
    ///
    /// If there is no such axis, or shapes are nested too deeply.
    pub fn mirrored(self, axis: usize) -> Result<Self, ShapeError> {
        Self::from_node(Node::Mirrored { axis, of: self })
    }
}

impl<const D: usize> Shape<D> {
    /// Copies of the shape on a grid: for each axis, how many and how far apart.
    ///
    /// Along an axis in which the shape is symmetric and no wider than the spacing,
    /// one copy is evaluated, and every promise outside is kept. Along another axis the
    /// copies to both sides are evaluated too, three in all, and distances are bounds.
    ///
    /// ```
    /// use palpate_field::operator::Copies;
    /// use palpate_field::{Shape, Vector, kernel::Ball};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let bead = Shape::from_kernel(Ball::new(0.1)?);
    /// let row = Copies::Between { spacing: 0.5, first: 0, last: 3 };
    /// let beads = bead.clone().repeated([row, Copies::One])?;
    /// assert_eq!(beads.distance(Vector([1.0, 0.2])), 0.1);
    /// assert_eq!(beads.distance(Vector([2.0, 0.0])), 0.4);
    ///
    /// let floor = bead.repeated([Copies::Endless { spacing: 0.25 }, Copies::One])?;
    /// assert!((floor.distance(Vector([-1000.0, 0.3])) - 0.2).abs() < 1e-15);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If the shape has no bounds or a steepness that is known in part of space alone,
    /// a spacing is not positive or less than half the width of the shape, the first
    /// number is larger than the last, or shapes are nested too deeply.
    pub fn repeated(self, copies: [Copies; D]) -> Result<Self, ShapeError> {
        Self::from_node(Node::Repeated { copies, of: self })
    }
}

impl<const D: usize> Shape<D> {
    /// The shape bent: turned in the plane of x and y by `rate` · x [rad/m].
    ///
    /// Distances are no bounds, but no steeper than the promise says. Only a shape with
    /// bounds can be bent.
    ///
    /// ```
    /// use palpate_field::{Shape, Vector, kernel::Cuboid};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let bar = Shape::from_kernel(Cuboid::new(Vector([0.4, 0.02]))?);
    /// let bow = bar.bent(2.0)?;
    /// assert_eq!(bow.distance(Vector([0.0, 0.0])), -0.01);
    /// // At x = 0.1 the bar has turned by 0.2 rad.
    /// let on_bow = Vector([0.1, 0.1 * 0.2_f64.tan()]);
    /// assert!((bow.distance(on_bow) + 0.01).abs() < 1e-15);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If the rate turns the shape by more than 10⁴ rad, the shape has no bounds or a
    /// steepness that is known in part of space alone, or shapes are nested too deeply.
    pub fn bent(self, rate: f64) -> Result<Self, ShapeError> {
        Self::from_node(Node::Bent { rate, of: self })
    }
}

impl Shape<3> {
    /// The shape twisted: turned about y by `rate` · y [rad/m], from z towards x.
    ///
    /// Promises and errors as of [`bent`](Self::bent).
    ///
    /// ```
    /// use palpate_field::{Shape, Vector, kernel::Cuboid};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let bar = Shape::from_kernel(Cuboid::new(Vector([0.02, 0.4, 0.1]))?);
    /// let quarter_turn = std::f64::consts::FRAC_PI_2 / 0.1;
    /// let screw = bar.twisted(quarter_turn)?;
    /// assert!((screw.distance(Vector([0.0, 0.0, 0.05]))).abs() < 1e-15);
    /// // 0.1 m up, the long side has turned from z to x.
    /// assert!((screw.distance(Vector([0.05, 0.1, 0.0]))).abs() < 1e-15);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// As [`bent`](Self::bent).
    pub fn twisted(self, rate: f64) -> Result<Self, ShapeError> {
        Self::from_node(Node::Twisted { rate, of: self })
    }
}

impl Shape<2> {
    /// The profile, drawn in x and z, as a solid of `height` [m] along y.
    ///
    /// Every promise of the profile is kept.
    ///
    /// # Errors
    ///
    /// If the height is not positive, or shapes are nested too deeply.
    pub fn extruded(self, height: f64) -> Result<Shape<3>, ShapeError> {
        Shape::from_node(Node::Extruded { height, of: self })
    }

    /// The profile turned about the y axis: its x is the distance from the axis.
    ///
    /// Outside, exact where the profile is if it lies in x ≥ 0 or is its own mirror
    /// image; inside, if it does not touch the axis either. Else a bound. A part at
    /// negative x is not seen.
    ///
    /// # Errors
    ///
    /// If shapes are nested too deeply.
    pub fn revolved(self) -> Result<Shape<3>, ShapeError> {
        Shape::from_node(Node::Revolved { of: self })
    }
}
