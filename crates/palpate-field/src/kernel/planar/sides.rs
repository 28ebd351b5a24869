// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Models of outlines, by those of their sides that are near a cell.

use super::line::Edge;
use crate::kernel::says_more;
use crate::scalar::{AffineModel, Scalar};
use crate::vector::Vector;

/// The most sides that a model is made of; more are bounded by a constant.
const MOST_NEAR: usize = 8;

/// A side of an outline, or a piece of one that is bent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    pub(super) edge: Edge,
    /// No point of the side is farther from the edge, and none of the edge from the side [m].
    pub(super) off: f64,
}

impl Side {
    /// The model of the distance.
    #[inline(always)]
    fn distance<const N: usize>(&self, cell: Vector<AffineModel<N>, 2>) -> AffineModel<N> {
        let [across, past] = self.edge.offsets(cell);
        let past_an_end = AffineModel::norm([across, past]);
        let zero = AffineModel::constant(0.0);
        AffineModel::select_less(zero, past, past_an_end, across.abs())
            .give_or_take(AffineModel::constant(self.off))
    }
}

/// The model of the signed distance to an outline, `value` at the centre of a cell of this
/// radius, by the sides that may be nearest in it; `None` if they are many, or meet in the cell.
///
/// A side that is 2r farther from the centre than the nearest is nearest nowhere. The sign
/// is the same in all of a cell that no side meets. A cell that meets one side, beside its
/// ends, has the distance to its line, with opposite signs on its sides; they are known if it is
/// known on which of them the centre is.
pub(super) fn model_by_sides<const N: usize>(
    cell: Vector<AffineModel<N>, 2>,
    value: f64,
    radius: f64,
    mut near: impl Iterator<Item = Side>,
) -> Option<AffineModel<N>> {
    if value.abs() > radius {
        let mut least: Option<AffineModel<N>> = None;
        for (count, side) in near.enumerate() {
            if count == MOST_NEAR {
                return None;
            }
            let distance = side.distance(cell);
            least = Some(least.map_or(distance, |least| least.min(distance)));
        }
        return least.map(|distance| if value < 0.0 { -distance } else { distance });
    }
    let (side, others) = (near.next()?, near.next());
    let [across, past] = side.edge.offsets(cell);
    if others.is_some() || past.maximum() > 0.0 || across.value.abs() < side.off {
        return None;
    }
    let signed = if (value < 0.0) == (across.value < 0.0) { across } else { -across };
    Some(signed.give_or_take(AffineModel::constant(side.off)))
}

/// The `model` of sides that are off by an `error` [m], if there is one and it says more than the
/// `constant` by the steepness.
pub(super) fn or_constant<const N: usize>(
    model: Option<AffineModel<N>>,
    constant: AffineModel<N>,
    error: f64,
) -> AffineModel<N> {
    match model {
        Some(model) if says_more(&model, &constant) => {
            AffineModel { lower: model.lower + error, upper: model.upper + error, ..model }
        }
        _ => constant,
    }
}
