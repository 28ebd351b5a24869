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
