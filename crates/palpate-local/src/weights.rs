// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Points of an element as weights of its vertices, and starts spread over it.

use palpate_field::{Aabb, Point, Vector};
use palpate_query::Placed;

/// Barycentric weights of the vertices of a segment or a triangle: the memoir's u, v, w with
/// `P = ua + vb + wc`, none negative and their sum one.
///
/// ```
/// use palpate_local::Weights;
///
/// let start = Weights::new([0.5, 0.25, 0.25])?;
/// assert_eq!(start.of_vertices(), &[0.5, 0.25, 0.25]);
/// let error = Weights::new([0.5, 0.25]).unwrap_err();
/// assert_eq!(error.to_string(), "barycentric weights must add up to 1, got 0.5,0.25, which is 0.75");
/// # Ok::<(), palpate_local::WeightsError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights<const N: usize>([f64; N]);

/// Why numbers are no barycentric weights.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WeightsError {
    /// A weight is negative, above one or not a number.
    #[error("a barycentric weight must be from 0 to 1, got {value:?}")]
    Weight {
        /// The weight.
        value: f64,
    },
    /// The weights do not add up to one.
    #[error("barycentric weights must add up to 1, got {weights}, which is {sum}")]
    Sum {
        /// The weights, separated by commas.
        weights: String,
        /// Their sum.
        sum: f64,
    },
}

impl<const N: usize> Weights<N> {
    /// How far the sum may be from one: thirds that are written with seven digits add up to it.
    const MOST_OFF: f64 = 1e-6;

    /// These weights, divided by their sum, which must be within 1e-6 of one.
    ///
    /// # Errors
    ///
    /// If a weight is not from 0 to 1, or the sum is not one.
    pub fn new(weights: [f64; N]) -> Result<Self, WeightsError> {
        // Written so that NaN is refused.
        if let Some(value) = weights.into_iter().find(|weight| !(0.0..=1.0).contains(weight)) {
            return Err(WeightsError::Weight { value });
        }
        let sum: f64 = weights.iter().sum();
        if (sum - 1.0).abs() > Self::MOST_OFF {
            let weights = weights.map(|weight| weight.to_string()).join(",");
            return Err(WeightsError::Sum { weights, sum });
        }
        Ok(Self(weights.map(|weight| weight / sum)))
    }

    /// The same weight of each vertex: the centroid, where the memoir's descent starts.
    #[must_use]
    pub fn centroid() -> Self {
        Self([1.0 / N as f64; N])
    }

    /// The weights, in the order of the vertices.
    #[must_use]
    pub const fn of_vertices(&self) -> &[f64; N] {
        &self.0
    }
}

/// The bases of Halton's sequence (1960), one for each axis.
const BASES: [u32; 3] = [2, 3, 5];

/// The first `count` points of Halton's sequence, in the common part of both bodies' boxes in world
/// coordinates [m], or in the box of the one body that has one: they fill it evenly, however many there
/// are. None where the boxes do not meet or neither body has one.
///
/// ```
/// use palpate_field::{Pose, Shape, Vector};
/// use palpate_local::halton_starts;
/// use palpate_query::Placed;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let square = Shape::<2>::cuboid([4.0, 4.0])?;
/// let there = |x: f64| Placed::new(&square, Pose::translation([x, 0.0]));
/// // The boxes share x from 1 m to 2 m and y from −2 m to 2 m.
/// let starts = halton_starts(&square, there(3.0), 2);
/// for (start, truth) in starts.into_iter().zip([[1.5, -2.0 / 3.0], [1.25, 2.0 / 3.0]]) {
///     assert!((start - Vector(truth)).norm() < 1e-12);
/// }
/// assert!(halton_starts(&square, there(5.0), 2).is_empty());
/// # Ok(())
/// # }
/// ```
#[must_use]
pub fn halton_starts<'a, const D: usize>(
    a: impl Into<Placed<'a, D>>,
    b: impl Into<Placed<'a, D>>,
    count: u32,
) -> Vec<Point<D>> {
    let boxes = [a.into(), b.into()].map(|body: Placed<'_, D>| {
        let bounds = body.shape.promise().bounds?;
        Some(bounds.aabb.placed(&body.world_from_body))
    });
    let common = match boxes {
        [Some(a), Some(b)] => Aabb {
            min: Vector(std::array::from_fn(|k| a.min[k].max(b.min[k]))),
            max: Vector(std::array::from_fn(|k| a.max[k].min(b.max[k]))),
        },
        [Some(one), None] | [None, Some(one)] => one,
        [None, None] => return Vec::new(),
    };
    if (0..D).any(|k| common.min[k] > common.max[k]) {
        return Vec::new();
    }
    let point = |index: u32| {
        Vector(std::array::from_fn(|k| {
            common.min[k] + (common.max[k] - common.min[k]) * radical_inverse(index, BASES[k])
        }))
    };
    (1..=count).map(point).collect()
}

/// The digits of `index` in this base, mirrored at the point.
fn radical_inverse(mut index: u32, base: u32) -> f64 {
    let (mut inverse, mut place) = (0.0, 1.0);
    while index > 0 {
        place /= f64::from(base);
        inverse += place * f64::from(index % base);
        index /= base;
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_shares_of_one() -> Result<(), WeightsError> {
        let thirds = Weights::new([0.333_333_3, 0.333_333_3, 0.333_333_3])?;
        assert!(thirds.0.iter().all(|weight| (weight - 1.0 / 3.0).abs() < 1e-16));
        for (weights, said) in [
            ([1.5, -0.5], "a barycentric weight must be from 0 to 1, got 1.5"),
            ([f64::NAN, 0.5], "a barycentric weight must be from 0 to 1, got NaN"),
            ([0.5, 0.6], "barycentric weights must add up to 1, got 0.5,0.6, which is 1.1"),
        ] {
            let error = Weights::new(weights).err().map(|error| error.to_string());
            assert_eq!(error.as_deref(), Some(said));
        }
        Ok(())
    }
}

#[cfg(test)]
mod halton_tests {
    use super::*;

    #[test]
    #[expect(clippy::float_cmp, reason = "sums of powers of two")]
    fn digits_are_mirrored() {
        assert_eq!([1, 2, 3, 4].map(|i| radical_inverse(i, 2)), [0.5, 0.25, 0.75, 0.125]);
    }
}
