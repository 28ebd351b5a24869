// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Models of fields against their values.

use palpate_field::scalar::{AffineModel, Model};
use palpate_field::{CustomField, Point, Vector};

use crate::soup::points;

/// The model of a field over a box with half sides, if no value at `count` places in it and at two corners leaves it;
/// else which does.
///
/// # Errors
///
/// If a value leaves the model.
pub fn bounding(
    field: &impl CustomField<3>,
    centre: Point<3>,
    half: [f64; 3],
    count: u32,
) -> Result<Model, String> {
    let model = CustomField::model(field, &Model::cell(centre.0, half));
    for u in points(count, 1.0).chain([Vector([1.0; 3]), Vector([-1.0; 3])]) {
        let f = field.distance(Vector(std::array::from_fn(|k| centre[k] + half[k] * u[k])));
        let plane = model.value + (0..3).map(|k| model.gradient[k] * u[k]).sum::<f64>();
        if !(plane - model.lower <= f && f <= plane + model.upper) {
            return Err(format!("{f} at {u:?} of {centre:?} ± {half:?}: {model:?}"));
        }
    }
    Ok(model)
}

/// The model of a field over the image of the cube of `M` parameters under the models of the coordinates, if no value
/// at the given parameters leaves it; else which does. At each place the remainders of the coordinates are added or
/// taken away.
///
/// # Errors
///
/// If a value leaves the model.
pub fn bounding_image<const M: usize>(
    field: &impl CustomField<3>,
    cell: &[AffineModel<M>; 3],
    parameters: &[[f64; M]],
) -> Result<AffineModel<M>, String> {
    let model = CustomField::model(field, cell);
    let affine = |x: &AffineModel<M>, u: &[f64; M]| {
        x.value + x.gradient.iter().zip(u).map(|(side, u)| side * u).sum::<f64>()
    };
    for (i, u) in parameters.iter().enumerate() {
        let p = Vector(std::array::from_fn(|k| {
            let remainder = if (i >> k) & 1 == 0 { cell[k].upper } else { -cell[k].lower };
            affine(&cell[k], u) + remainder
        }));
        let (f, plane) = (field.distance(p), affine(&model, u));
        // Of the place of the sample and of the plane there.
        let slack = 16.0 * f64::EPSILON * (p.norm() + plane.abs());
        if !(plane - model.lower - slack <= f && f <= plane + model.upper + slack) {
            return Err(format!("{f} at {u:?} of {cell:?}: {model:?}"));
        }
    }
    Ok(model)
}
