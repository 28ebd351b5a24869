// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where a node or an instance is: an affine map.

use palpate_field::{Point, Vector};

/// Three rows of four.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Affine([[f64; 4]; 3]);

/// A translation, a rotation and a scale, which is applied first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parts {
    pub(super) translation: [f64; 3],
    /// A quaternion with its real part last, of any length but 0.
    pub(super) rotation: [f64; 4],
    pub(super) scale: [f64; 3],
}

impl Parts {
    pub(super) const IDENTITY: Self =
        Self { translation: [0.0; 3], rotation: [0.0, 0.0, 0.0, 1.0], scale: [1.0; 3] };
}

impl Affine {
    pub(super) const IDENTITY: Self =
        Self([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);

    /// The map of four columns of four, of which the last row is that of an affine map.
    pub(super) fn of_columns(columns: &[f64; 16]) -> Self {
        Self(std::array::from_fn(|i| std::array::from_fn(|k| columns[4 * k + i])))
    }

    /// The map of the parts; `None` if the quaternion is zero. Quaternions of bytes are not of
    /// unit length, so the length is divided out.
    pub(super) fn of_parts(parts: &Parts) -> Option<Self> {
        let [x, y, z, w] = parts.rotation;
        let squared = x * x + y * y + z * z + w * w;
        if squared == 0.0 {
            return None;
        }
        // Of the unit quaternion the rotation is 1 + 2 (products of two parts).
        let twice = 2.0 / squared;
        let rotation = [
            [1.0 - twice * (y * y + z * z), twice * (x * y - w * z), twice * (x * z + w * y)],
            [twice * (x * y + w * z), 1.0 - twice * (x * x + z * z), twice * (y * z - w * x)],
            [twice * (x * z - w * y), twice * (y * z + w * x), 1.0 - twice * (x * x + y * y)],
        ];
        Some(Self(std::array::from_fn(|i| {
            let [a, b, c] = std::array::from_fn(|k| rotation[i][k] * parts.scale[k]);
            [a, b, c, parts.translation[i]]
        })))
    }

    /// The map that applies `first` before this one.
    pub(super) fn after(&self, first: &Self) -> Self {
        Self(self.0.map(|row| {
            std::array::from_fn(|k| {
                let moved: f64 = (0..3).map(|j| row[j] * first.0[j][k]).sum();
                if k == 3 { moved + row[3] } else { moved }
            })
        }))
    }

    pub(super) fn apply(&self, p: [f64; 3]) -> Point<3> {
        Vector(self.0.map(|[x, y, z, offset]| x * p[0] + y * p[1] + z * p[2] + offset))
    }

    /// Whether triangles turn over.
    pub(super) fn is_mirrored(&self) -> bool {
        let m = self.0;
        let minor = |i: usize, j: usize| m[1][i] * m[2][j] - m[1][j] * m[2][i];
        m[0][0] * minor(1, 2) + m[0][1] * minor(2, 0) + m[0][2] * minor(0, 1) < 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_scale_then_turn_then_move() {
        // A quarter turn about z, of twice the unit length.
        let parts = Parts {
            translation: [10.0, 20.0, 30.0],
            rotation: [0.0, 0.0, 2.0, 2.0],
            scale: [2.0, 3.0, -1.0],
        };
        let map = Affine::of_parts(&parts).unwrap();
        assert_eq!(map.apply([1.0, 1.0, 1.0]), Vector([7.0, 22.0, 29.0]));
        assert!(map.is_mirrored());
        assert_eq!(Affine::of_parts(&Parts { rotation: [0.0; 4], ..parts }), None);
    }

    #[test]
    fn the_first_of_two_maps_is_applied_first() {
        let moved = Parts { translation: [1.0, 2.0, 3.0], ..Parts::IDENTITY };
        let scaled = Parts { scale: [2.0, 4.0, 8.0], ..Parts::IDENTITY };
        let [moved, scaled] = [moved, scaled].map(|parts| Affine::of_parts(&parts).unwrap());
        assert_eq!(scaled.after(&moved).apply([1.0, 1.0, 1.0]), Vector([4.0, 12.0, 32.0]));
        assert_eq!(moved.after(&scaled).apply([1.0, 1.0, 1.0]), Vector([3.0, 6.0, 11.0]));
        assert_eq!(Affine::IDENTITY.after(&moved), moved);
    }

    #[test]
    fn columns_are_one_after_the_other() {
        let columns =
            [1.0, 2.0, 3.0, 0.0, 4.0, 5.0, 6.0, 0.0, 7.0, 8.0, 9.0, 0.0, 10.0, 11.0, 12.0, 1.0];
        let moved = Affine::of_columns(&columns).apply([1.0, 0.0, 2.0]);
        assert_eq!(moved, Vector([25.0, 29.0, 33.0]));
    }
}
