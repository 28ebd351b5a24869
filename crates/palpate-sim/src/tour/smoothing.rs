// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Smoothing of sequences.

use palpate_field::{Point, Vector};

/// The maximum within `window` places of each value.
pub(super) fn highest(values: &[f64], window: usize) -> Vec<f64> {
    (0..values.len())
        .map(|i| {
            let (from, to) = around(i, window, values.len());
            values[from..to].iter().copied().fold(f64::NEG_INFINITY, f64::max)
        })
        .collect()
}

/// The moving mean over `window` places on both sides, taken twice, which removes corners.
pub(super) fn smoothed(values: &[f64], window: usize) -> Vec<f64> {
    let points: Vec<Vector<f64, 1>> = values.iter().map(|v| Vector([*v])).collect();
    smoothed_points(&points, window).into_iter().map(|v| v.0[0]).collect()
}

/// The moving mean of points, taken twice.
pub(super) fn smoothed_points<const D: usize>(
    points: &[Vector<f64, D>],
    window: usize,
) -> Vec<Point<D>> {
    mean_around(&mean_around(points, window), window)
}

fn mean_around<const D: usize>(points: &[Vector<f64, D>], window: usize) -> Vec<Point<D>> {
    (0..points.len())
        .map(|i| {
            let (from, to) = around(i, window, points.len());
            let sum = points[from..to].iter().fold(Vector::ZERO, |sum, p| sum + *p);
            sum * (1.0 / (to - from) as f64)
        })
        .collect()
}

/// The places within `window` of place `i`; symmetric, and fewer near an end.
fn around(i: usize, window: usize, count: usize) -> (usize, usize) {
    let window = window.min(i).min(count - 1 - i);
    (i - window, i + window + 1)
}
