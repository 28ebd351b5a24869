// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Values outside the box of a grid.

use palpate_field::Vector;

use crate::control::{MOST_TAPS, apply};
use crate::lattice::unravelled;
use crate::spline::{OfTaps, Spline};

/// The value at `a` from the nearest point of the box [m], where the grid has `value` [m] and gradient `slope`:
///
/// ```text
/// √(L²(|a|² + 2m·|a|₁) + value²)
/// ```
///
/// `L` is the grid's Lipschitz constant, and `m` a distance that the surface keeps from every face. A point s of
/// the surface has `a·(q − s) ≥ m·|a|₁` for the nearest point q of the box, so `|p − s|² ≥ |a|² + 2m·|a|₁ +
/// |q − s|²`: the value is at most `L` times the distance to the surface.
pub(crate) fn outside<const D: usize>(
    away: Vector<f64, D>,
    (value, slope): (f64, Vector<f64, D>),
    lipschitz: f64,
    margin: f64,
) -> (f64, Vector<f64, D>) {
    let sum: f64 = away.0.iter().map(|a| a.abs()).sum();
    let square = lipschitz * lipschitz;
    let result = (square * (away.dot(away) + 2.0 * margin * sum) + value * value).sqrt();
    if !result.is_finite() {
        // NaN, or too far away for squares.
        return (result, Vector::ZERO);
    }
    let gradient = std::array::from_fn(|i| {
        if away[i] == 0.0 {
            value * slope[i] / result
        } else {
            square * (away[i] + margin.copysign(away[i])) / result
        }
    });
    (result, Vector(gradient))
}

/// Of a cell with faces on the border of the box, the least value on these, and the largest `m` with which no value
/// outside next to them is steeper than `lipschitz`. `sides` has the index of the control values on these faces.
///
/// Where n coordinates are outside, the square of the steepness is `(L²(g² − f²) + L⁴n·m² + f²|∇ₜf|²)/g²`, with
/// g the value outside, f that at the box, and ∇ₜf the gradient along the box. That is at most L² if
/// `L²n·m² ≤ f²(1 − |∇ₜf|²/L²)`.
pub(crate) fn at_border<const K: usize, const D: usize>(
    taps: &[f64],
    sides: [Option<usize>; D],
    cell: f64,
    lipschitz: f64,
) -> [f64; 2]
where
    OfTaps<K>: Spline<K>,
{
    let controls = |slope: Option<usize>| {
        let mut control = [0.0; MOST_TAPS];
        let numbers = &mut control[..taps.len()];
        numbers.copy_from_slice(taps);
        for axis in 0..D {
            let shares =
                if Some(axis) == slope { &OfTaps::<K>::SLOPES } else { &OfTaps::<K>::VALUES };
            apply::<K, D>(numbers, axis, shares);
        }
        control
    };
    let values = controls(None);
    let slopes: [[f64; MOST_TAPS]; D] = std::array::from_fn(|axis| controls(Some(axis)));
    let (mut least, mut margin) = (f64::INFINITY, f64::INFINITY);
    // Each face, edge and corner of the box that the cell touches.
    for outside in 1..1_usize << D {
        let is_outside = |axis: usize| (outside >> axis) & 1 == 1;
        if (0..D).any(|axis| is_outside(axis) && sides[axis].is_none()) {
            continue;
        }
        let mut value = f64::INFINITY;
        let mut tangents = [0.0_f64; D];
        for number in 0..taps.len() {
            let index: [usize; D] = unravelled(number, [K; D]);
            if (0..D).any(|axis| is_outside(axis) && sides[axis] != Some(index[axis])) {
                continue;
            }
            value = value.min(values[number]);
            for axis in (0..D).filter(|axis| !is_outside(*axis)) {
                tangents[axis] = tangents[axis].max(slopes[axis][number].abs());
            }
        }
        let steep = tangents.iter().map(|t| t * t).sum::<f64>().sqrt() / (cell * lipschitz);
        let rest = (1.0 - steep * steep).max(0.0);
        let axes = f64::from((outside as u32).count_ones());
        least = least.min(value);
        margin = margin.min(value * (rest / axes).sqrt() / lipschitz);
    }
    [least, margin * (1.0 - 1e-12)]
}
