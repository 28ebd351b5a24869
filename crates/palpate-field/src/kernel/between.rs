// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The frame of shapes that stand between two points.

use crate::error::{ShapeError, Unit, finite, positive};
use crate::pose::{Placement, Pose, Rotation};
use crate::scalar::Scalar;
use crate::vector::{Point, Vector};

/// A frame whose y axis runs from one point to another, its origin half-way.
#[derive(Clone, Debug)]
pub(super) struct Between<const D: usize> {
    placement: Placement<D>,
    from: Point<D>,
    to: Point<D>,
    /// Half the distance between the points [m].
    half_length: f64,
}

impl<const D: usize> Between<D> {
    /// The frame between the points called `from` and `to` [m]; along the axes if
    /// they are the same.
    ///
    /// # Errors
    ///
    /// If a coordinate is not finite.
    pub(super) fn new(from: Point<D>, to: Point<D>) -> Result<Self, ShapeError> {
        for (name, point) in [("from", from), ("to", to)] {
            for x in point.0 {
                finite(name, x, Unit::Metre)?;
            }
        }
        let rotation = match (to - from).normalized() {
            Some(direction) => turn_y_towards(direction)?,
            None => Rotation::identity(),
        };
        let placement = Placement::new(Pose::new(rotation, (from + to) * 0.5));
        Ok(Self { placement, from, to, half_length: 0.5 * (to - from).norm() })
    }

    /// As [`new`](Self::new), for shapes that need a direction.
    ///
    /// # Errors
    /// If a coordinate is not finite, or the points are the same.
    pub(super) fn apart(from: Point<D>, to: Point<D>) -> Result<Self, ShapeError> {
        let between = Self::new(from, to)?;
        let apart = 2.0 * between.half_length;
        positive("the distance from `from` to `to`", apart, Unit::Metre)?;
        Ok(between)
    }

    /// The point at the negative end of the y axis.
    pub(super) fn from(&self) -> Point<D> {
        self.from
    }

    /// The point at the positive end of the y axis.
    pub(super) fn to(&self) -> Point<D> {
        self.to
    }

    /// Half the distance between the points [m].
    #[inline(always)]
    pub(super) fn half_length(&self) -> f64 {
        self.half_length
    }

    /// The pose of the frame.
    pub(super) fn pose(&self) -> &Pose<D> {
        &self.placement.world_from_body
    }

    /// The unit vector from one point to the other.
    pub(super) fn direction(&self) -> Vector<f64, D> {
        self.pose().transform_vector(Vector::unit(1))
    }

    /// `p` in the frame.
    #[inline(always)]
    pub(super) fn to_body<S: Scalar>(&self, p: Vector<S, D>) -> Vector<S, D> {
        self.placement.to_body(p)
    }
}

/// A rotation that takes the y axis to the unit vector `direction`.
///
/// The rotation is a reflection and a flip of one axis. A reflection along `y + d` takes −y to
/// `d`, one along `y − d` takes y to `d`; the longer of the two vectors is used, so that
/// nothing cancels.
///
/// # Errors
///
/// If `direction` is no unit vector.
pub fn turn_y_towards<const D: usize>(
    direction: Vector<f64, D>,
) -> Result<Rotation<D>, ShapeError> {
    let y = Vector::<f64, D>::unit(1);
    let (along, flipped) =
        if direction[1] < 0.0 { (y - direction, 0) } else { (y + direction, 1) };
    let along = along.normalized().unwrap_or(y);
    let columns = std::array::from_fn(|axis| {
        let unit = Vector::<f64, D>::unit(axis);
        let image = unit - along * (2.0 * unit.dot(along));
        if axis == flipped { (-image).0 } else { image.0 }
    });
    Ok(Rotation::from_matrix(columns)?.inverse())
}
