// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Starts of searches between two bodies.

use palpate_field::{Aabb, Point, Vector};
use palpate_query::Placed;

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
    #[expect(clippy::float_cmp, reason = "sums of powers of two")]
    fn digits_are_mirrored() {
        assert_eq!([1, 2, 3, 4].map(|i| radical_inverse(i, 2)), [0.5, 0.25, 0.75, 0.125]);
    }
}
