// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where two bodies are nearest, and how that changes when they move.

use palpate_field::field::{EvaluateBlock, Field};
use palpate_field::scalar::Model;
use palpate_field::{BLOCK, Point, Vector};

use super::couple::Couple;
use super::descent::share;

/// Gradients that differ by less than this say nothing of a normal.
const FLAT: f64 = 1e-6;

/// Where two bodies are nearest, or overlap most, in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest<const D: usize> {
    /// The point between the bodies, or in both [m].
    pub point: Point<D>,
    /// The unit vector from the first body to the second; `None` where neither's
    /// gradient says.
    pub normal: Option<Vector<f64, D>>,
    /// How the separation changes as the first and the second body's matter at `point`
    /// moves, in metres a metre.
    ///
    /// At the best point a mean `λ·∇g_a + (1 − λ)·∇g_b` of both gradients vanishes, and
    /// as the envelope theorem says, only the fields' own motion counts:
    /// `−2λ·∇g_a` and `−2(1 − λ)·∇g_b`. Of a separation with several best points
    /// it is the derivative of one branch.
    pub rates: [Vector<f64, D>; 2],
}

/// How a separation changes with the pose of one body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseDerivative<const D: usize> {
    /// By its translation, in metres a metre.
    pub translation: Vector<f64, D>,
    /// By its rotation about the x, y and z axes through a pivot, in metres a radian; in
    /// the plane the last alone.
    pub rotation: Vector<f64, 3>,
}

impl<const D: usize> Nearest<D> {
    /// How the separation changes with the pose of the first body (`0`) or the second
    /// (`1`), whose rotations are about `pivot`: by `rate·t + ((point − pivot) × rate)·ω`
    /// for a translation `t` and a rotation vector `ω`.
    ///
    /// ```
    /// use palpate_field::{Shape, Vector, kernel::Ball};
    /// use palpate_query::{Limits, PairWorkspace, separation};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let a = Shape::from_kernel(Ball::new(1.0)?);
    /// let b = Shape::from_kernel(Ball::new(1.0)?).translated(Vector([3.0, 0.0]))?;
    /// let limits = Limits { tolerance: 1e-9, ..Limits::default() };
    /// let nearest = separation(&a, &b, &limits, &mut PairWorkspace::new())?.best;
    /// let of_b = nearest.derivative(1, Vector::ZERO);
    /// // Away from the first is apart, and around it neither.
    /// assert!((of_b.translation - Vector([1.0, 0.0])).norm() < 1e-6);
    /// assert!(of_b.rotation.norm() < 1e-6);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Panics
    ///
    /// If `body` is neither 0 nor 1.
    #[must_use]
    pub fn derivative(&self, body: usize, pivot: Point<D>) -> PoseDerivative<D> {
        let translation = self.rates[body];
        let arm = self.point - pivot;
        let turn = |i: usize, k: usize| {
            if k < D { arm[i] * translation[k] - arm[k] * translation[i] } else { 0.0 }
        };
        let rotation = match D {
            2 => Vector([0.0, 0.0, turn(0, 1)]),
            _ => Vector([turn(1, 2), -turn(0, 2), turn(0, 1)]),
        };
        PoseDerivative { translation, rotation }
    }

    /// The answer at a point of the couple's frame, found to `tolerance` [m].
    pub(super) fn at(couple: &mut Couple<'_, D>, p: Point<D>, tolerance: f64) -> Self
    where
        dyn Field<D>: EvaluateBlock<f64, D, BLOCK> + EvaluateBlock<Model, D, BLOCK>,
    {
        let slopes = couple.slopes(p);
        let [(_, a), (_, b)] = slopes;
        let share = share(slopes, tolerance.max(f64::MIN_POSITIVE));
        let pose = &couple.world_from_frame;
        let between = a - b;
        let length = between.norm();
        Self {
            point: pose.transform_point(p),
            normal: (length > FLAT).then(|| pose.transform_vector(between * (1.0 / length))),
            rates: [a * (-2.0 * share), b * (-2.0 * (1.0 - share))]
                .map(|rate| pose.transform_vector(rate)),
        }
    }
}
