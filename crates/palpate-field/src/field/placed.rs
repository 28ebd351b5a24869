// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rigid motions of fields.

use super::{SharedField, Warp, Warped};
use crate::error::ShapeError;
use crate::pose::{Placement, Pose};
use crate::scalar::{Float, Scalar};
use crate::vector::Vector;

impl<const D: usize> Warp<D, D> for Placement<D> {
    const IS_MOTION: bool = true;

    #[inline(always)]
    fn point<S: Scalar>(&self, p: Vector<S, D>) -> Vector<S, D> {
        self.to_body(p)
    }

    fn placed(&self, pose: &Pose<D>) -> Option<Self> {
        Some(Self::new(*pose * self.world_from_body))
    }

    #[inline(always)]
    fn gradient<T: Float>(
        &self,
        _p: Vector<T, D>,
        child: T,
        child_gradient: Vector<T, D>,
    ) -> (T, Vector<T, D>) {
        (child, self.gradient_to_world(child_gradient))
    }
}

/// The `field` moved by `pose`: in the field where that costs no more, else around it.
///
/// # Errors
///
/// If the field is nested too deeply.
pub(crate) fn placed<const D: usize>(
    field: &SharedField<D>,
    pose: &Pose<D>,
) -> Result<SharedField<D>, ShapeError> {
    if pose.is_identity() {
        return Ok(field.clone());
    }
    match field.placed(pose) {
        Some(moved) => Ok(moved),
        None => {
            let promise = field.promise().placed(pose);
            Warped::shared(Placement::new(*pose), field.clone(), promise)
        }
    }
}
