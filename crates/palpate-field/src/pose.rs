// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Poses, rotation vectors and screws.
//!
//! Rotations and rigid motions.
//!
//! Frames are named: a pose called `world_from_body` maps body coordinates to
//! world coordinates.

use std::f64::consts::{PI, TAU};
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
        let wrong = |value, which: String| {
            let rule = format!("an orthonormal matrix: {which} within 1e-6");
            Err(ShapeError::number("rotation", rule, value, Unit::One))
        };
        let mut matrix = rows;
        for i in 0..D {
            for k in 0..i {
                let skew = Vector(matrix[i]).dot(Vector(matrix[k]));
                // NaN is beyond every tolerance too.
                if skew.is_nan() || skew.abs() > ORTHONORMAL_TOLERANCE {
                    let (first, second) = (k + 1, i + 1);
                    let which = format!("the product of rows {first} and {second} must be 0");
                    return wrong(skew, which);
                }
                matrix[i] = (Vector(matrix[i]) - Vector(matrix[k]) * skew).0;
            }
            let length = Vector(matrix[i]).norm();
            if length.is_nan() || (length - 1.0).abs() > ORTHONORMAL_TOLERANCE {
                return wrong(length, format!("the length of row {} must be 1", i + 1));
            }
            matrix[i] = (Vector(matrix[i]) * (1.0 / length)).0;
        }
        if determinant(&matrix) > 0.0 {
            Ok(Self { matrix })
        } else {
            Err(ShapeError::Reflection { parameter: "rotation" })
        }
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

/// Below this angle [rad], sin θ / θ is one to the last bit.
const TINY: f64 = 1e-9;

impl<const D: usize> Rotation<D> {
    /// This rotation, followed by that of the rotation vector `by`, which lies along the axis with
    /// the angle as length [rad]; in the plane along z.
    ///
    /// The result is orthonormal to rounding, so that any number of rotations may be chained. A
    /// vector that is not finite turns nothing.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    ///
    /// ```
    /// use palpate_field::Rotation;
    ///
    /// let half = Rotation::<2>::identity().turned([0.0, 0.0, 0.5]);
    /// assert!((half.turned([0.0, 0.0, 0.25]).angle() - 0.75).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn turned(&self, by: impl Into<Vector<f64, 3>>) -> Self {
        let turned = of_vector(by.into()) * *self;
        Self::from_matrix(*turned.matrix()).unwrap_or(*self)
    }

    /// The rotation vector from this rotation to another, at most π long [rad]: the inverse of
    /// [`turned`](Self::turned).
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    ///
    /// ```
    /// use palpate_field::{Rotation, Vector};
    ///
    /// let (start, by) = (Rotation::<3>::identity(), Vector([0.25, -0.5, 1.0]));
    /// assert!((start.turn_to(&start.turned(by)) - by).norm() < 1e-15);
    /// ```
    #[must_use]
    pub fn turn_to(&self, to: &Self) -> Vector<f64, 3> {
        vector_of(*to * self.inverse())
    }
}

/// The rotation by a vector: `R = I + (sin θ / θ) W + (2 sin²(θ/2) / θ²) W²` with `W v = w × v`
/// and `θ = ‖w‖` (Rodrigues 1840).
fn of_vector<const D: usize>(w: Vector<f64, 3>) -> Rotation<D> {
    let angle = w.norm();
    let (first, second) = if angle > TINY {
        let half = libm::sin(0.5 * angle);
        (libm::sin(angle) / angle, 2.0 * half * half / (angle * angle))
    } else {
        (1.0, 0.5)
    };
    let column = |axis: usize| {
        let e = Vector::<f64, 3>::unit(axis);
        let turned = w.cross(e);
        e + turned * first + w.cross(turned) * second
    };
    let (x, y, z) = (column(0), column(1), column(2));
    let rows: [[f64; D]; D] = std::array::from_fn(|i| {
        let row = [x, y, z].map(|column| column.0.get(i).copied().unwrap_or(0.0));
        std::array::from_fn(|k| row.get(k).copied().unwrap_or(0.0))
    });
    Rotation::from_matrix(rows).unwrap_or_else(|_| Rotation::identity())
}

/// The rotation vector, at most π long: `2 atan2(‖q‖, w) q / ‖q‖` for the quaternion `(q, w)`.
fn vector_of<const D: usize>(rotation: Rotation<D>) -> Vector<f64, 3> {
    let rows = std::array::from_fn(|i| {
        let unit = Vector::<f64, 3>::unit(i).0;
        std::array::from_fn(|k| {
            let inside = rotation.matrix().get(i).and_then(|row| row.get(k));
            inside.or(unit.get(k)).copied().unwrap_or(0.0)
        })
    });
    let Ok(rotation) = Rotation::<3>::from_matrix(rows) else { return Vector::ZERO };
    let [x, y, z, w] = rotation.quaternion();
    let axis = Vector([x, y, z]);
    let sine = axis.norm();
    if sine > 0.0 { axis * (2.0 * libm::atan2(sine, w) / sine) } else { Vector::ZERO }
}

/// A rotation by less than this [rad] has no axis that two poses determine: the axis would be 10⁹
/// times as far away as the body moves.
const NO_ROTATION: f64 = 1e-9;

/// A rigid motion from a pose to another at constant speed: a rotation about an axis together with
/// a translation along it (Chasles 1830); in the plane a rotation about a centre.
///
/// The body turns the shorter way, by at most π; `turns` adds whole turns about the same axis.
/// Where the poses are turned alike, whole turns are about the direction of the translation, as a
/// nut moves on its bolt; without a translation, about the body's y axis, in the plane about its
/// origin.
///
/// # Derivation
///
/// Let θ be the angle, n the axis, `v = v∥ + v⊥` the translation, all seen from the first pose,
/// and `φ = s (θ + 2πk)` the angle at the share s of the motion, with k whole turns. The axis goes
/// through `c = (v⊥ + cot(θ/2) n × v⊥) / 2`, and a point at the origin moves by
///
/// ```text
/// s v∥ + (I − R(φ)) c = s v∥ + sin(φ/2) / sin(θ/2) · (cos((φ − θ)/2) v⊥ + sin((φ − θ)/2) n × v⊥)
/// ```
///
/// The right side loses no digits where θ is small; without whole turns it tends to `s v`.
///
/// # Examples
///
/// Half a turn about (1, 0) takes the origin to (2, 0), over (1, −1):
///
/// ```
/// use palpate_field::{Pose, Rotation, Screw, Vector};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let half_turn = Rotation::from_angle(std::f64::consts::PI)?;
/// let screw = Screw::new(Pose::identity(), Pose::new(half_turn, Vector([2.0, 0.0])), 0)?;
/// let middle = screw.pose(0.5).translation;
/// assert!((middle - Vector([1.0, -1.0])).norm() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screw<const D: usize> {
    from: Pose<D>,
    to: Pose<D>,
    /// The unit axis, seen from the first pose; z in the plane.
    axis: Vector<f64, 3>,
    /// The angle of the shorter way, without whole turns [rad].
    short_angle: f64,
    /// The angle with whole turns [rad].
    angle: f64,
    /// The translation along the axis, seen from the first pose [m]; zero in the plane.
    along: Vector<f64, 3>,
    /// The translation across the axis [m].
    across: Vector<f64, 3>,
}

impl<const D: usize> Screw<D> {
    /// The motion between two poses, with whole `turns` added in its direction, against it if negative.
    ///
    /// # Errors
    ///
    /// If a pose is not finite; in the plane, if whole turns are to end at another place with the
    /// same rotation, which is no rotation about a centre.
    pub fn new(from: Pose<D>, to: Pose<D>, turns: i32) -> Result<Self, ShapeError> {
        for pose in [&from, &to] {
            pose.check()?;
        }
        let between = from.inverse() * to;
        let vector = Rotation::identity().turn_to(&between.rotation);
        let translation = in_space(between.translation);
        let (axis, angle) = match (vector.norm(), vector.normalized()) {
            (angle, Some(axis)) if angle >= NO_ROTATION => (axis, angle),
            _ if turns == 0 || D == 2 => (Vector([0.0, 0.0, 1.0]), 0.0),
            _ => (translation.normalized().unwrap_or(Vector([0.0, 1.0, 0.0])), 0.0),
        };
        let along = axis * translation.dot(axis);
        let across = translation - along;
        if D == 2 && turns != 0 && angle == 0.0 && across != Vector::ZERO {
            let rule = "0 for a translation in the plane";
            return Err(ShapeError::number("turns", rule, f64::from(turns), Unit::One));
        }
        let (short_angle, angle) = (angle, angle + TAU * f64::from(turns));
        Ok(Self { from, to, axis, short_angle, angle, along, across })
    }

    /// The first pose.
    #[must_use]
    pub fn from(&self) -> &Pose<D> {
        &self.from
    }

    /// The last pose.
    #[must_use]
    pub fn to(&self) -> &Pose<D> {
        &self.to
    }

    /// The angle of the whole motion, whole turns included [rad].
    #[must_use]
    pub fn angle(&self) -> f64 {
        self.angle
    }

    /// The pose after a share of the motion: the first at 0 and below, the last at 1 and above.
    #[must_use]
    pub fn pose(&self, share: f64) -> Pose<D> {
        if share >= 1.0 {
            return self.to;
        }
        if share.is_nan() || share <= 0.0 {
            return self.from;
        }
        let phi = share * self.angle;
        // A motion without rotation has no centre to turn about.
        let (ratio, off) = if self.short_angle < NO_ROTATION {
            (share, 0.0)
        } else {
            let half = 0.5 * self.short_angle;
            (libm::sin(0.5 * phi) / libm::sin(half), 0.5 * phi - half)
        };
        let across =
            self.across * libm::cos(off) + self.axis.cross(self.across) * libm::sin(off);
        let translation: Point<D> = from_space(self.along * share + across * ratio);
        // `turned` takes vectors of any length; whole turns change nothing.
        let phi = phi - TAU * ((phi + PI) / TAU).floor();
        let rotation = Rotation::identity().turned(self.axis * phi);
        self.from * Pose::new(rotation, translation)
    }

    /// The part of the motion between two shares. If the first share is the later one, the part runs
    /// backwards. Below 0 and above 1 the body rests.
    ///
    /// ```
    /// use palpate_field::{Pose, Screw};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let [from, to] = [0.0, 2.0].map(|x| Pose::<2>::translation([x, 0.0]));
    /// let back = Screw::new(from, to, 0)?.part(1.0, 0.5)?;
    /// assert_eq!([0.0, 0.5, 1.0].map(|share| back.pose(share).translation[0]), [2.0, 1.5, 1.0]);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If the part turns by half a turn or more, or a share is NaN: its ends would not say about which
    /// axis.
    pub fn part(&self, first: f64, last: f64) -> Result<Self, ShapeError> {
        let [first, last] = [first, last].map(|share| share.clamp(0.0, 1.0));
        let angle = (self.angle * (last - first)).abs();
        // Written so that NaN is refused.
        if angle < PI {
            Self::new(self.pose(first), self.pose(last), 0)
        } else {
            Err(ShapeError::number(
                "angle of a part",
                "less than half a turn",
                angle,
                Unit::Radian,
            ))
        }
    }

    /// The velocity of a point of the body over the whole motion as a unit of time, both in the
    /// body's coordinates [m]: it stays the same, and so does its size in the world.
    ///
    /// With the numbers of the derivation and `Θ = θ + 2πk`, it is `v∥ + Θ/2 (cot(θ/2) v⊥ − n × v⊥) +
    /// Θ n × p`: the derivative at the beginning, where the origin moves by the first two terms.
    ///
    /// ```
    /// use palpate_field::{Pose, Rotation, Screw, Vector};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let half_turn = Rotation::from_angle(std::f64::consts::PI)?;
    /// let screw = Screw::new(Pose::identity(), Pose::new(half_turn, Vector([2.0, 0.0])), 0)?;
    /// // The centre of rotation stays, and the origin goes half a circle of one metre round it.
    /// assert!(screw.velocity(Vector([1.0, 0.0])).norm() < 1e-15);
    /// assert!((screw.velocity(Vector([0.0, 0.0])).norm() - std::f64::consts::PI).abs() < 1e-15);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn velocity(&self, p: Point<D>) -> Vector<f64, D> {
        let half = 0.5 * self.short_angle;
        let across = if self.short_angle < NO_ROTATION {
            self.across
        } else {
            let tangent = libm::tan(half);
            (self.across * (1.0 / tangent) - self.axis.cross(self.across)) * (0.5 * self.angle)
        };
        let turning = self.axis.cross(in_space(p)) * self.angle;
        from_space(self.along + across + turning)
    }
}

fn in_space<const D: usize>(v: Vector<f64, D>) -> Vector<f64, 3> {
    Vector(std::array::from_fn(|k| v.0.get(k).copied().unwrap_or(0.0)))
}

fn from_space<const D: usize>(v: Vector<f64, 3>) -> Vector<f64, D> {
    Vector(std::array::from_fn(|k| v[k]))
}
