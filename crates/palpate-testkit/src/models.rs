// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Models of fields against their values.

use palpate_field::scalar::Model;
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
