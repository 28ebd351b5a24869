// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Conversions from and to the types of glam.

use crate::error::ShapeError;
use crate::pose::{Pose, Rotation};
use crate::vector::Vector;

impl From<glam::DVec2> for Vector<f64, 2> {
    fn from(v: glam::DVec2) -> Self {
        Self(v.to_array())
    }
}

impl From<Vector<f64, 2>> for glam::DVec2 {
    fn from(v: Vector<f64, 2>) -> Self {
        Self::from_array(v.0)
    }
}

impl From<glam::DVec3> for Vector<f64, 3> {
    fn from(v: glam::DVec3) -> Self {
        Self(v.to_array())
    }
}

impl From<Vector<f64, 3>> for glam::DVec3 {
    fn from(v: Vector<f64, 3>) -> Self {
        Self::from_array(v.0)
    }
}

impl TryFrom<glam::DAffine2> for Pose<2> {
    type Error = ShapeError;

    /// The matrix must be a rotation: scale and shear are refused.
    fn try_from(affine: glam::DAffine2) -> Result<Self, ShapeError> {
        let rows = affine.matrix2.transpose().to_cols_array_2d();
        Ok(Self::new(Rotation::from_matrix(rows)?, affine.translation))
    }
}

impl From<Pose<2>> for glam::DAffine2 {
    fn from(pose: Pose<2>) -> Self {
        let matrix = glam::DMat2::from_cols_array_2d(pose.rotation.matrix()).transpose();
        Self::from_mat2_translation(matrix, pose.translation.into())
    }
}

impl From<Pose<3>> for glam::DAffine3 {
    fn from(pose: Pose<3>) -> Self {
        Self::from_rotation_translation(pose.rotation.into(), pose.translation.into())
    }
}

impl TryFrom<glam::DAffine3> for Pose<3> {
    type Error = ShapeError;

    /// The matrix must be a rotation: scale and shear are refused.
    fn try_from(affine: glam::DAffine3) -> Result<Self, ShapeError> {
        Ok(Self::new(affine.matrix3.try_into()?, affine.translation))
    }
}

impl From<Rotation<3>> for glam::DQuat {
    fn from(rotation: Rotation<3>) -> Self {
        Self::from_array(rotation.quaternion())
    }
}

impl TryFrom<glam::DQuat> for Rotation<3> {
    type Error = ShapeError;

    fn try_from(quaternion: glam::DQuat) -> Result<Self, ShapeError> {
        Self::from_quaternion(quaternion.to_array())
    }
}

impl TryFrom<glam::DMat3> for Rotation<3> {
    type Error = ShapeError;

    fn try_from(matrix: glam::DMat3) -> Result<Self, ShapeError> {
        Self::from_matrix(matrix.transpose().to_cols_array_2d())
    }
}
