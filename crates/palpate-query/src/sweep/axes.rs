// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Axes along which the boxes of a sweep are cut.
//!
//! Two flat sides that face each other rule out a box between them however large it is, if it is cut along them. A box
//! that is cut askew reaches through both, and so come many small ones.

use palpate_field::{Aabb, Point, Pose, Rotation, Shape, Vector};

use super::motion::Moving;

/// Gradients are sampled at so many points.
const SAMPLES: u32 = 64;

/// An axis is that of at least so many gradients.
const LEAST: u32 = 4;

/// Unit vectors are alike, or square to each other, up to this sine.
const ALIKE: f64 = 1e-6;

/// A motion that turns by more is left as it is [rad]: its ends would not say which way it turns.
const MOST_TURN: f64 = 3.0;

/// A body in coordinates of other axes.
pub(super) struct Turned<const D: usize> {
    pub(super) shape: Shape<D>,
    /// From the other coordinates to the body's own.
    own_from_turned: Pose<D>,
}

impl<const D: usize> Turned<D> {
    /// A body in coordinates whose axes are those of most of its gradients; `None` if its own are such, or if few
    /// gradients are alike. Evaluates `SAMPLES` gradients.
    pub(super) fn of(body: &Moving<'_, D>, aabb: &Aabb<D>) -> Option<Self> {
        if body.motion.angle() > MOST_TURN {
            return None;
        }
        let turn = axes(body.shape, aabb)?;
        let shape = body.shape.clone().rotated(turn.inverse()).ok()?;
        Some(Self { shape, own_from_turned: Pose::rotation(turn) })
    }

    /// How often fields are evaluated for it.
    pub(super) const EVALUATIONS: u32 = 2 * SAMPLES;

    /// The body on its way.
    pub(super) fn moving(&self, body: &Moving<'_, D>) -> Option<Moving<'_, D>> {
        let motion = body.motion.of_part(&self.own_from_turned).ok()?;
        Some(Moving { shape: &self.shape, motion })
    }

    /// A point of the body's own coordinates in the others.
    pub(super) fn point(&self, p: Point<D>) -> Point<D> {
        self.own_from_turned.inverse().transform_point(p)
    }
}

/// The rotation whose columns are the axes.
fn axes<const D: usize>(shape: &Shape<D>, aabb: &Aabb<D>) -> Option<Rotation<D>> {
    let mut alike: Vec<(Vector<f64, D>, u32)> = Vec::new();
    for i in 1..=SAMPLES {
        let (_, gradient) = shape.distance_gradient(sample(aabb, i));
        let Some(direction) = gradient.normalized() else { continue };
        let is_alike = |(other, _): &&mut (Vector<f64, D>, u32)| {
            let cosine = other.dot(direction);
            (direction - *other * cosine).norm() < ALIKE
        };
        match alike.iter_mut().find(is_alike) {
            Some((_, count)) => *count += 1,
            None => alike.push((direction, 1)),
        }
    }
    alike.retain(|(_, count)| *count >= LEAST);
    alike.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    if alike.is_empty() {
        return None;
    }
    let mut axes: Vec<Vector<f64, D>> = Vec::new();
    let units = (0..D).map(Vector::unit);
    for direction in alike.into_iter().map(|(direction, _)| direction) {
        if axes.iter().all(|axis| axis.dot(direction).abs() < ALIKE) {
            axes.push(direction);
        }
    }
    // The rest is any.
    for unit in units {
        let rest = axes.iter().fold(unit, |rest, axis| rest - *axis * axis.dot(rest));
        if axes.len() < D && rest.norm() > 0.5 {
            axes.extend(rest.normalized());
        }
    }
    let is_own = |axis: &Vector<f64, D>| axis.0.iter().any(|x| x.abs() > 1.0 - ALIKE);
    if axes.len() < D || axes.iter().all(is_own) {
        return None;
    }
    let columns = |axes: &[Vector<f64, D>]| {
        Rotation::from_matrix(std::array::from_fn(|i| std::array::from_fn(|k| axes[k][i]))).ok()
    };
    columns(&axes).or_else(|| {
        axes[D - 1] = -axes[D - 1];
        columns(&axes)
    })
}

/// A point of a sequence that fills a box evenly.
fn sample<const D: usize>(aabb: &Aabb<D>, i: u32) -> Point<D> {
    const STEPS: [f64; 3] = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9];
    let share = |k: usize| 2.0 * (f64::from(i) * STEPS[k % 3]).fract() - 1.0;
    let (centre, half) = (aabb.centre(), aabb.half_extents());
    Vector(std::array::from_fn(|k| centre[k] + share(k) * half[k]))
}
