// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Models enclose the field over their cell.

use palpate_field::scalar::Model;
use palpate_field::{BLOCK, Block, Column, Point, Rotation, Shape, Vector};

use super::rounding;

/// A box of points.
#[derive(Clone, Copy, Debug)]
pub struct Cell<const D: usize> {
    /// Its centre [m].
    pub centre: Point<D>,
    /// Half its edge lengths [m].
    pub half: Vector<f64, D>,
}

impl<const D: usize> Cell<D> {
    /// The point at parameters `u` in `[−1, 1]`, of the cell that is turned about its centre.
    #[must_use]
    pub fn at(&self, u: [f64; D], turn: Option<&Rotation<D>>) -> Point<D> {
        let away = Vector(std::array::from_fn(|i| self.half[i] * u[i]));
        self.centre + turn.map_or(away, |turn| turn.rotate(away))
    }
}

/// The largest lower remainder of a convex field, in ulp of the largest number in the
/// evaluation.
const CONVEX_ULP: f64 = 32.0;

/// A model that is not convex may be wider than the bound by the steepness by this share, if it
/// has a slope, and with it says more.
const WIDER: f64 = 1.125;

/// Roundings that a model adds to those of the promise.
const WIDTH_ROUNDINGS: f64 = 8.0;

/// The models of up to [`BLOCK`] cells, perhaps all turned alike, enclose the field at the
/// parameters `samples`.
///
/// # Errors
///
/// Says which cell and sample, and by how much.
pub fn model_encloses<const D: usize>(
    shape: &Shape<D>,
    turn: Option<&Rotation<D>>,
    cells: &[Cell<D>],
    samples: &[[f64; D]],
) -> Result<(), String> {
    for (cell, model) in cells.iter().zip(models(shape, turn, cells)) {
        let reach = cell.centre.norm() + cell.half.norm();
        let numbers = [model.value, model.lower, model.upper];
        if !numbers.iter().chain(&model.gradient).all(|x| x.is_finite())
            || model.lower < 0.0
            || model.upper < 0.0
        {
            return Err(format!("{model:?} over {cell:?}"));
        }
        for u in samples {
            let p = cell.at(*u, turn);
            let f = shape.distance(p);
            let plane: f64 =
                model.value + (0..D).map(|k| model.gradient[k] * u[k]).sum::<f64>();
            // Of the sample: its place and its value; of the plane: its sum.
            let slack = rounding(shape, p)
                + 4.0 * f64::EPSILON * (reach * shape.promise().lipschitz + plane.abs());
            let (low, high) = (plane - model.lower - slack, plane + model.upper + slack);
            if !(low <= f && f <= high) {
                let apart = if f < low { low - f } else { f - high };
                return Err(format!(
                    "{f:e} at {u:?} is {apart:e} outside [{low:e}, {high:e}] over {cell:?}, \
                     turned by {turn:?}: {model:?}"
                ));
            }
            if !(model.minimum() <= f + slack && f - slack <= model.maximum()) {
                return Err(format!("{f:e} beyond the extremes of {model:?} over {cell:?}"));
            }
        }
    }
    Ok(())
}

/// If the field is convex, the models of up to [`BLOCK`] cells have no lower remainder but
/// rounding.
///
/// # Errors
///
/// Says over which cell, and how large it is.
pub fn convex_models_are_tight<const D: usize>(
    shape: &Shape<D>,
    cells: &[Cell<D>],
) -> Result<(), String> {
    let promise = shape.promise();
    if !promise.convex {
        return Ok(());
    }
    // The largest number in the formula besides the coordinates.
    let size = promise.rounding.constant / promise.rounding.per_metre;
    for (cell, model) in cells.iter().zip(models(shape, None, cells)) {
        let largest = cell.centre.norm() + cell.half.norm() + size;
        let ulp = model.lower / (f64::EPSILON * largest);
        if ulp > CONVEX_ULP {
            return Err(format!(
                "a lower remainder of {ulp:.0} ulp of {largest} over {cell:?}"
            ));
        }
    }
    Ok(())
}

/// The model of a cell is as good as the bound by the steepness of the field, but for
/// roundings and `WIDER`: it is no wider than twice the steepness times the cell's half diagonal. For a
/// convex field, whose model keeps the slope of its plane, the lower bound is as good as that.
///
/// # Errors
///
/// Says which cell's model is wider, and by how much.
pub fn model_says_as_much_as_the_steepness<const D: usize>(
    shape: &Shape<D>,
    cell: &Cell<D>,
) -> Result<(), String> {
    let promise = shape.promise();
    if promise.region.is_some() {
        return Ok(());
    }
    let reach = cell.centre.norm() + cell.half.norm();
    let slack = WIDTH_ROUNDINGS * (promise.rounding.within(reach) + f64::EPSILON * reach);
    let most = promise.lipschitz * cell.half.norm() + slack;
    for model in models(shape, None, &[*cell]) {
        let below = model.value - model.minimum();
        let width = model.maximum() - model.minimum();
        let wide = if promise.convex { below > most } else { width > 2.0 * WIDER * most };
        if wide {
            return Err(format!(
                "{below:e} below, {width:e} wide, {most:e} by the steepness over {cell:?}: \
                 {model:?}"
            ));
        }
    }
    Ok(())
}

/// The models of a shape over cells of at most a block, turned by `turn`.
#[must_use]
pub fn models<const D: usize>(
    shape: &Shape<D>,
    turn: Option<&Rotation<D>>,
    cells: &[Cell<D>],
) -> Vec<Model> {
    let mut block = Block::<Model, D, BLOCK>::zero();
    let mut models = Column::<Model, BLOCK>::zero();
    block.fill_boxes(cells.len(), turn, |i| (cells[i].centre, cells[i].half));
    shape.block_distances(&block, cells.len(), &mut models);
    (0..cells.len()).map(|i| models.get(i)).collect()
}
