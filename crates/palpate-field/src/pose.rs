// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rotations and rigid motions.
//!
//! Frames are named: a pose called `world_from_body` maps body coordinates to
//! world coordinates.

use std::ops::Mul;

use crate::error::{ShapeError, Unit, finite};
use crate::scalar::{Float, Scalar};
use crate::vector::{Point, Vector, array};

/// The largest deviation from orthonormal at which a matrix is accepted as a rotation:
/// the rounding of numbers written with seven digits.
const ORTHONORMAL_TOLERANCE: f64 = 1e-6;

/// Every rotation is orthonormal up to this: more than the rounding of one product.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A rotation about the origin.
///
/// Its matrix is orthonormal up to rounding, some 1e-14, also after many products:
/// what moves a shape changes none of its distances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation<const D: usize> {
    matrix: [[f64; D]; D],
}

impl<const D: usize> Rotation<D> {
    /// The rotation that moves nothing.
    #[must_use]
    pub fn identity() -> Self {
        let row = |i: usize| Vector::<f64, D>::unit(i).0;
        Self { matrix: std::array::from_fn(row) }
    }

    /// The rows of the rotation's matrix.
    #[must_use]
    #[inline]
    pub fn matrix(&self) -> &[[f64; D]; D] {
        &self.matrix
    }

    /// The rotation with the given rows, made orthonormal to rounding.
    ///
    /// # Errors
    ///
    /// If a row or column is not of length one or not square to the others
    /// within 1e-6, or if the matrix mirrors.
    pub fn from_matrix(rows: [[f64; D]; D]) -> Result<Self, ShapeError> {
        let wrong =
            |value| ShapeError::number("rotation", "an orthonormal matrix", value, Unit::One);
        let mut matrix = rows;
        for i in 0..D {
            for k in 0..i {
                let skew = Vector(matrix[i]).dot(Vector(matrix[k]));
                // NaN is beyond every tolerance too.
                if skew.is_nan() || skew.abs() > ORTHONORMAL_TOLERANCE {
                    return Err(wrong(skew));
                }
                matrix[i] = (Vector(matrix[i]) - Vector(matrix[k]) * skew).0;
            }
            let length = Vector(matrix[i]).norm();
            if length.is_nan() || (length - 1.0).abs() > ORTHONORMAL_TOLERANCE {
                return Err(wrong(length));
            }
            matrix[i] = (Vector(matrix[i]) * (1.0 / length)).0;
        }
        let determinant = determinant(&matrix);
        if determinant > 0.0 { Ok(Self { matrix }) } else { Err(wrong(determinant)) }
    }

    /// The rotation with the given rows: to the bit if they are orthonormal to rounding, as those
    /// that [`matrix`](Self::matrix) gives, else made so.
    ///
    /// # Errors
    ///
    /// As [`from_matrix`](Self::from_matrix).
    pub fn from_rows(rows: [[f64; D]; D]) -> Result<Self, ShapeError> {
        let straight = Self::from_matrix(rows)?;
        let given = Self { matrix: rows };
        // An inverse deviates a little more than what it is of.
        Ok(if given.is_orthonormal(4.0 * ROUNDING) { given } else { straight })
    }

    /// `true` if no entry of `R Rᵀ` deviates from the identity by more than `most`.
    fn is_orthonormal(&self, most: f64) -> bool {
        let product = |i: usize, k: usize| Vector(self.matrix[i]).dot(Vector(self.matrix[k]));
        (0..D).all(|i| {
            (0..=i).all(|k| (product(i, k) - f64::from(u8::from(i == k))).abs() <= most)
        })
    }

    /// The rotation that undoes this one.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let mut matrix = self.matrix;
        for (i, row) in matrix.iter_mut().enumerate() {
            *row = array!(k < D => self.matrix[k][i]);
        }
        Self { matrix }
    }

    /// The same rotation in space: that of a plane is about the z axis.
    #[must_use]
    pub fn in_space(&self) -> Rotation<3> {
        self.resized()
    }

    /// The first rows and columns; those that this rotation lacks are of the identity.
    fn resized<const N: usize>(&self) -> Rotation<N> {
        let entry = |i: usize, k: usize| {
            let entry = self.matrix.get(i).and_then(|row| row.get(k));
            entry.copied().unwrap_or(f64::from(u8::from(i == k)))
        };
        Rotation { matrix: std::array::from_fn(|i| std::array::from_fn(|k| entry(i, k))) }
    }

    /// Applies the rotation.
    #[inline]
    #[must_use]
    pub fn rotate(&self, v: Vector<f64, D>) -> Vector<f64, D> {
        Vector(array!(i < D => Vector(self.matrix[i]).dot(v)))
    }
}

fn determinant<const D: usize>(m: &[[f64; D]; D]) -> f64 {
    match D {
        2 => m[0][0] * m[1][1] - m[0][1] * m[1][0],
        _ => (0..3)
            .map(|i| {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                m[0][i] * (m[1][j] * m[2][k] - m[1][k] * m[2][j])
            })
            .sum(),
    }
}

impl<const D: usize> Mul for Rotation<D> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let columns = other.inverse();
        let product = Self {
            matrix: std::array::from_fn(|i| {
                std::array::from_fn(|k| Vector(self.matrix[i]).dot(Vector(columns.matrix[k])))
            }),
        };
        if product.is_orthonormal(ROUNDING) {
            return product;
        }
        Self::from_matrix(product.matrix).unwrap_or(product)
    }
}

impl Rotation<2> {
    /// Turns by `angle` [rad], from x towards y.
    ///
    /// # Errors
    ///
    /// If the angle is not finite.
    pub fn from_angle(angle: f64) -> Result<Self, ShapeError> {
        if !angle.is_finite() {
            return Err(ShapeError::number("angle", "finite", angle, Unit::Radian));
        }
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        Ok(Self { matrix: [[cos, -sin], [sin, cos]] })
    }

    /// The angle of the rotation [rad], in (−π, π].
    #[must_use]
    pub fn angle(&self) -> f64 {
        libm::atan2(self.matrix[1][0], self.matrix[0][0])
    }
}

impl Rotation<3> {
    /// Turns by `angle` [rad] about `axis`, counter-clockwise seen from its tip.
    ///
    /// # Errors
    ///
    /// If the axis has no direction or a number is not finite.
    pub fn from_axis_angle(
        axis: impl Into<Vector<f64, 3>>,
        angle: f64,
    ) -> Result<Self, ShapeError> {
        let axis = axis.into();
        if !angle.is_finite() {
            return Err(ShapeError::number("angle", "finite", angle, Unit::Radian));
        }
        let Some(axis) = axis.normalized() else {
            let length = axis.norm();
            return Err(ShapeError::number("axis", "a direction", length, Unit::One));
        };
        let (sin, cos) = (libm::sin(0.5 * angle), libm::cos(0.5 * angle));
        let [x, y, z] = axis.0;
        Self::from_quaternion([x * sin, y * sin, z * sin, cos])
    }

    /// The rotation of the quaternion `[x, y, z, w]`, which need not be of
    /// length one.
    ///
    /// # Errors
    ///
    /// If the quaternion is zero or a number is not finite.
    pub fn from_quaternion(quaternion: [f64; 4]) -> Result<Self, ShapeError> {
        let Some(Vector([x, y, z, w])) = Vector(quaternion).normalized() else {
            let length = Vector(quaternion).norm();
            return Err(ShapeError::number("rotation", "a quaternion", length, Unit::One));
        };
        let matrix = [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
            [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
            [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
        ];
        Ok(Self { matrix })
    }

    /// The unit quaternion `[x, y, z, w]` of the rotation, with `w ≥ 0`.
    ///
    /// The largest component is found first, so that nothing is divided by a
    /// small number (Shepperd 1978).
    #[must_use]
    pub fn quaternion(&self) -> [f64; 4] {
        let m = &self.matrix;
        let trace = m[0][0] + m[1][1] + m[2][2];
        let mut q = [0.0; 4];
        let largest = (0..3).fold(3, |best, i| {
            let candidate = if best == 3 { trace } else { m[best][best] };
            if m[i][i] > candidate { i } else { best }
        });
        if largest == 3 {
            q[3] = 1.0 + trace;
            for (i, q) in q[..3].iter_mut().enumerate() {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                *q = m[k][j] - m[j][k];
            }
        } else {
            let (i, j, k) = (largest, (largest + 1) % 3, (largest + 2) % 3);
            q[i] = 1.0 + m[i][i] - m[j][j] - m[k][k];
            q[j] = m[j][i] + m[i][j];
            q[k] = m[k][i] + m[i][k];
            q[3] = m[k][j] - m[j][k];
        }
        let sign = if q[3] < 0.0 { -1.0 } else { 1.0 };
        let length = Vector(q).norm();
        q.map(|x| sign * x / length)
    }
}

/// A rigid motion: a rotation, then a translation.
///
/// ```
/// use palpate_field::{Pose, Rotation, Vector};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let quarter = Rotation::from_angle(std::f64::consts::FRAC_PI_2)?;
/// let world_from_body = Pose::new(quarter, Vector([1.0, 0.0]));
/// let p = world_from_body.transform_point(Vector([2.0, 0.0]));
/// assert!((p - Vector([1.0, 2.0])).norm() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Pose<const D: usize> {
    /// The rotation, applied first.
    pub rotation: Rotation<D>,
    /// The translation, applied second [m].
    pub translation: Vector<f64, D>,
}

impl<const D: usize> Pose<D> {
    /// Rotates, then translates.
    #[must_use]
    pub fn new(rotation: Rotation<D>, translation: impl Into<Vector<f64, D>>) -> Self {
        Self { rotation, translation: translation.into() }
    }

    /// The motion that moves nothing.
    #[must_use]
    pub fn identity() -> Self {
        Self::new(Rotation::identity(), Vector::ZERO)
    }

    /// A translation alone.
    #[must_use]
    pub fn translation(translation: impl Into<Vector<f64, D>>) -> Self {
        Self::new(Rotation::identity(), translation)
    }

    /// A rotation about the origin alone.
    #[must_use]
    pub fn rotation(rotation: Rotation<D>) -> Self {
        Self::new(rotation, Vector::ZERO)
    }

    /// The image of a point.
    #[inline]
    #[must_use]
    pub fn transform_point(&self, point: Point<D>) -> Point<D> {
        self.rotation.rotate(point) + self.translation
    }

    /// The image of a direction: rotated, not moved.
    #[inline]
    #[must_use]
    pub fn transform_vector(&self, vector: Vector<f64, D>) -> Vector<f64, D> {
        self.rotation.rotate(vector)
    }

    /// The motion that undoes this one.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.inverse();
        Self::new(rotation, -rotation.rotate(self.translation))
    }

    /// Refuses motions to where no shape may be.
    pub(crate) fn check(&self) -> Result<(), ShapeError> {
        for x in self.translation.0 {
            finite("translate", x, Unit::Metre)?;
        }
        Ok(())
    }

    /// `true` if nothing is moved.
    pub(crate) fn is_identity(&self) -> bool {
        self.translation == Vector::ZERO && self.rotation == Rotation::identity()
    }

    /// `true` if no number is NaN or infinite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.translation.is_finite()
            && self.rotation.matrix.iter().flatten().all(|x| x.is_finite())
    }

    /// The same motion in space: that of the plane is one of the plane z = 0.
    ///
    /// ```
    /// use palpate_field::{Pose, Rotation, Vector};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let flat = Pose::new(Rotation::from_angle(0.5)?, [1.0, 2.0]);
    /// let point = flat.in_space().transform_point(Vector([3.0, 4.0, 5.0]));
    /// assert_eq!(point.truncated(), flat.transform_point(Vector([3.0, 4.0])));
    /// assert_eq!((point[2], flat.in_space().truncated()), (5.0, flat));
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn in_space(&self) -> Pose<3> {
        Pose::new(self.rotation.in_space(), self.translation.in_space())
    }
}

impl Pose<3> {
    /// The part of this motion in the first coordinates, as [`Vector::truncated`]: of a motion that keeps the
    /// plane z = 0, that in this plane.
    #[must_use]
    pub fn truncated<const D: usize>(&self) -> Pose<D> {
        Pose::new(self.rotation.resized(), self.translation.truncated::<D>())
    }
}

impl<const D: usize> Mul for Pose<D> {
    type Output = Self;

    /// `a_from_b * b_from_c` is `a_from_c`.
    fn mul(self, other: Self) -> Self {
        Self::new(self.rotation * other.rotation, self.transform_point(other.translation))
    }
}

/// The change of coordinates from the world to a placed body.
#[derive(Clone, Copy, Debug)]
pub struct Placement<const D: usize> {
    /// The pose it was made from.
    pub world_from_body: Pose<D>,
}

/// A column of a matrix, of its rows.
#[inline(always)]
fn column<const D: usize>(rows: &[[f64; D]; D], k: usize) -> [f64; D] {
    array!(i < D => rows[i][k])
}

impl<const D: usize> Placement<D> {
    /// The change of coordinates to a body at `world_from_body`.
    #[must_use]
    pub fn new(world_from_body: Pose<D>) -> Self {
        Self { world_from_body }
    }

    /// `Rᵀ(p − t)`: subtracting first keeps points near the body precise.
    #[inline(always)]
    pub fn to_body<S: Scalar>(&self, p: Vector<S, D>) -> Vector<S, D> {
        let Pose { rotation, translation } = &self.world_from_body;
        let q = array!(i < D => p.0[i].minus(translation[i]));
        Vector(array!(k < D => S::weighted_sum(q, &column(rotation.matrix(), k))))
    }

    /// `R·v`: a gradient in the body's frame, back in the world's.
    #[inline(always)]
    pub fn gradient_to_world<T: Float>(&self, v: Vector<T, D>) -> Vector<T, D> {
        let rows = self.world_from_body.rotation.matrix();
        Vector(array!(i < D => T::weighted_sum(v.0, &rows[i])))
    }
}
