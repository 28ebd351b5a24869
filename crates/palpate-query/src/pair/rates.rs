// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How a separation changes when the bodies move.

use palpate_field::{Point, Vector};

use super::Nearest;
use super::body_pair::BodyPair;
use crate::error::QueryError;
use crate::sampler::Placed;

/// How far about the point gradients are taken, as shares of the size of what both boxes
/// have in common, until their mean vanishes.
const SPREADS: [f64; 5] = [0.0, 1e-6, 1e-5, 1e-4, 1e-3];

/// A field that is less than the larger by more than this share of that size is not what
/// the separation is of: twice the last spread.
const NEARLY: f64 = 2e-3;

/// A mean of gradients that is shorter than this vanishes.
const VANISHES: f64 = 1e-3;

/// Steps towards the shortest mean.
const STEPS: usize = 200;

/// The derivative of the separation with respect to the motion of each body's material, in
/// metres a metre.
///
/// At the point where the larger of both fields is least, a mean of their gradients
/// vanishes, and by the envelope theorem the fields' own motion alone counts: the derivative
/// for a body is −2 times its terms of the mean `Σ wᵢ·∇gᵢ`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Rates<const D: usize> {
    /// Where the separation is found [m].
    pub point: Point<D>,
    /// The derivative with respect to the motion of the material at `point`, of the first and of
    /// the second body; without unit.
    pub of: [Vector<f64, D>; 2],
    /// The length of the mean gradient, which vanishes at the exact point: a bound of the error
    /// of the rates. It is larger where the search left the point uncertain.
    pub residual: f64,
}

/// How a separation changes with the pose of one body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PoseDerivative<const D: usize> {
    /// By its translation, in metres a metre.
    pub translation: Vector<f64, D>,
    /// By its rotation about the x, y and z axes through a pivot, in metres a radian; in
    /// the plane the last alone.
    pub rotation: Vector<f64, 3>,
}

impl<const D: usize> Rates<D> {
    /// How the separation changes with the pose of the first body (`0`) or the second
    /// (`1`), whose rotations are about `pivot`: by `rate·t + ((point − pivot) × rate)·ω`
    /// for a translation `t` and a rotation vector `ω`.
    ///
    /// # Panics
    ///
    /// If `body` is neither 0 nor 1.
    #[must_use]
    pub fn derivative(&self, body: usize, pivot: Point<D>) -> PoseDerivative<D> {
        let translation = self.of[body];
        let arm = self.point - pivot;
        let rotation = arm.in_space().cross(translation.in_space());
        PoseDerivative { translation, rotation }
    }
}

/// How the separation of two bodies changes when they move, from the answer of
/// [`separation`](crate::separation), which should be precise: where its point is off by
/// δ, the rates are off by as much as gradients change over δ.
///
/// At an edge of a field, gradients of several sides are in the mean. Where the separation
/// itself has several best points, it has no derivative, and this is that of one of them.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ball};
/// use palpate_query::{Limits, PairWorkspace, rates, separation};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let a = Shape::from_kernel(Ball::new(1.0)?);
/// let b = Shape::from_kernel(Ball::new(1.0)?).translated(Vector([3.0, 0.0]))?;
/// let limits = Limits::new(1e-9);
/// let nearest = separation(&a, &b, &limits, &mut PairWorkspace::new())?.best;
/// let of_b = rates(&a, &b, &nearest)?.derivative(1, Vector::ZERO);
/// // Away from the first is apart, and around it neither.
/// assert!((of_b.translation - Vector([1.0, 0.0])).norm() < 1e-4);
/// assert!(of_b.rotation.norm() < 1e-4);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// If neither body is bounded, or a pose is not finite or beyond 1e15 m.
pub fn rates<'a, const D: usize>(
    a: impl Into<Placed<'a, D>>,
    b: impl Into<Placed<'a, D>>,
    nearest: &Nearest<D>,
) -> Result<Rates<D>, QueryError> {
    rates_of([a.into(), b.into()], nearest)
}

#[inline(never)]
pub(crate) fn rates_of<const D: usize>(
    [a, b]: [Placed<'_, D>; 2],
    nearest: &Nearest<D>,
) -> Result<Rates<D>, QueryError> {
    let mut pair = BodyPair::new(a, b)?;
    let pose = pair.world_from_frame;
    let centre = pose.inverse().transform_point(nearest.point);
    let size = pair.root(0.0).half_extents().norm();
    let mut best =
        Rates { point: nearest.point, of: [Vector::ZERO; 2], residual: f64::INFINITY };
    for spread in SPREADS.map(|share| share * size) {
        let gradients = around(&mut pair, centre, spread, NEARLY * size);
        let weights = shortest_mean(&gradients);
        let mut of = [Vector::ZERO; 2];
        for ((body, gradient), weight) in gradients.iter().zip(weights) {
            of[*body] += *gradient * weight;
        }
        let residual = (of[0] + of[1]).norm();
        if residual < best.residual {
            let of = of.map(|part| pose.transform_vector(part * -2.0));
            best = Rates { of, residual, ..best };
        }
        if residual < VANISHES {
            break;
        }
    }
    Ok(best)
}

/// The gradients at a point and at points `spread` from it, and of which body they are:
/// of fields that are the larger one there, to within `nearly`.
fn around<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    centre: Point<D>,
    spread: f64,
    nearly: f64,
) -> Vec<(usize, Vector<f64, D>)> {
    let mut points = vec![centre];
    if spread > 0.0 {
        for axis in 0..D {
            points.push(centre + Vector::unit(axis) * spread);
            points.push(centre - Vector::unit(axis) * spread);
        }
    }
    let mut gradients = Vec::new();
    for (i, p) in points.into_iter().enumerate() {
        let slopes = pair.slopes(p);
        let larger = slopes[0].0.max(slopes[1].0);
        for (body, (value, gradient)) in slopes.into_iter().enumerate() {
            let is_known = gradients.iter().any(|(other, known): &(usize, Vector<f64, D>)| {
                *other == body && (*known - gradient).norm() < 1e-9
            });
            let is_less = value < larger - nearly;
            if !is_less && (i == 0 || !is_known) {
                gradients.push((body, gradient));
            }
        }
    }
    gradients
}

/// The weights of the shortest mean: weight goes from the vector that is farthest along
/// the mean to the one that is least so, as much as shortens it most.
fn shortest_mean<const D: usize>(vectors: &[(usize, Vector<f64, D>)]) -> Vec<f64> {
    let mut weights = vec![1.0 / vectors.len() as f64; vectors.len()];
    for _ in 0..STEPS {
        let mut mean = Vector::ZERO;
        for ((_, vector), weight) in vectors.iter().zip(&weights) {
            mean += *vector * *weight;
        }
        let along = |i: usize| vectors[i].1.dot(mean);
        let all = || 0..vectors.len();
        let least = all().min_by(|&i, &k| along(i).total_cmp(&along(k)));
        let most =
            all().filter(|&i| weights[i] > 0.0).max_by(|&i, &k| along(i).total_cmp(&along(k)));
        let (Some(least), Some(most)) = (least, most) else { break };
        let way = vectors[least].1 - vectors[most].1;
        let squared = way.dot(way);
        if squared == 0.0 {
            break;
        }
        let step = (-mean.dot(way) / squared).clamp(0.0, weights[most]);
        weights[least] += step;
        weights[most] -= step;
    }
    weights
}
