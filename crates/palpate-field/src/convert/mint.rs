// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Conversions from and to the types of mint, and so of nalgebra, cgmath, glam and others.

use crate::error::ShapeError;
use crate::pose::Rotation;
use crate::vector::Vector;

macro_rules! converts {
    ($($theirs:ident: $dimension:literal, $($axis:ident)+;)*) => {
        $(
            impl<S> From<mint::$theirs<S>> for Vector<S, $dimension> {
                fn from(v: mint::$theirs<S>) -> Self {
                    Self([$(v.$axis),+])
                }
            }

            impl<S> From<Vector<S, $dimension>> for mint::$theirs<S> {
                fn from(v: Vector<S, $dimension>) -> Self {
                    let [$($axis),+] = v.0;
                    Self { $($axis),+ }
                }
            }
        )*
    };
}

converts! {
    Vector2: 2, x y;
    Point2: 2, x y;
    Vector3: 3, x y z;
    Point3: 3, x y z;
}

impl From<Rotation<3>> for mint::Quaternion<f64> {
    fn from(rotation: Rotation<3>) -> Self {
        let [x, y, z, s] = rotation.quaternion();
        Self { v: mint::Vector3 { x, y, z }, s }
    }
}

impl TryFrom<mint::Quaternion<f64>> for Rotation<3> {
    type Error = ShapeError;

    fn try_from(mint::Quaternion { v, s }: mint::Quaternion<f64>) -> Result<Self, ShapeError> {
        Self::from_quaternion([v.x, v.y, v.z, s])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_points_and_rotations_convert_there_and_back() {
        let v = Vector([1.0, 2.0, 3.0]);
        assert_eq!(Vector::from(mint::Vector3::from(v)), v);
        assert_eq!(Vector::from(mint::Point3::from(v)), v);
        let v = Vector([1.0_f32, 2.0]);
        assert_eq!(Vector::from(mint::Vector2::from(v)), v);
        assert_eq!(Vector::from(mint::Point2::from(v)), v);
        // A quarter turn about x takes y to z.
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let quaternion =
            mint::Quaternion { v: mint::Vector3 { x: half, y: 0.0, z: 0.0 }, s: half };
        let turn = Rotation::try_from(quaternion).unwrap();
        assert!(
            (turn.rotate(Vector([0.0, 1.0, 0.0])) - Vector([0.0, 0.0, 1.0])).norm() < 1e-15
        );
        let again = mint::Quaternion::from(turn);
        assert!((again.v.x - half).abs() < 1e-15 && (again.s - half).abs() < 1e-15);
        let none = mint::Quaternion { v: mint::Vector3 { x: 0.0, y: 0.0, z: 0.0 }, s: 0.0 };
        assert!(Rotation::try_from(none).is_err());
    }
}
