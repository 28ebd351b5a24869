// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How much each point of a tool pushes, where bodies have different springs.
//!
//! A rod that lies flat on the ground may be held by its middle or by its two ends. Both solve for the
//! same rest pose, and the search takes either. Over different springs the force would jump with that
//! choice. So the pushes are spread over all points that touch, as evenly as force and torque allow.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use super::Tool;
use super::closest::FREEDOMS;
use super::settle::{Push, stacked_along};

/// A point touches less and less up to a gap of this part of the depth.
const NEAR: f64 = 0.02;

/// The most turns of Newton's method: a rod takes two, random contacts five, rarely twenty.
const MOST_TURNS: usize = 24;

/// The most halvings of one of its steps.
const MOST_HALVINGS: usize = 30;

/// What is added to a matrix that may be singular, as a part of its trace.
const RIDGE: f64 = 1e-10;

type Stacked = [f64; FREEDOMS];

impl Push {
    /// How much a point touches under a hand at this depth [m]: 1, less or 0.
    pub(super) fn touches(&self, depth: f64) -> f64 {
        // Written so that NaN does not touch.
        (1.0 - self.gap.abs() / (NEAR * depth)).max(0.0)
    }
}

impl Tool {
    /// The points that push the tool, each with its push.
    pub(super) fn pushes(&self) -> &[Push] {
        let rest = &self.rest_search.rest;
        if rest.touching.is_empty() { &rest.pushes } else { &rest.touching }
    }

    /// Spreads the pushes over all points that touch the bodies at `depth` [m].
    ///
    /// Of all pushes `λᵢ ≥ 0` with the force and the torque of those that the search found, these have
    /// the least `Σ λᵢ² / mᵢ`, where `mᵢ` is how much a point touches. There is one such solution, it is
    /// continuous in the pose, and `λᵢ = mᵢ max(0, aᵢ·y)` with the rows `aᵢ`: at the minimum over `y` of
    /// the convex `½ Σ mᵢ max(0, aᵢ·y)² − w·y` (Newton's method).
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn spread(&mut self, depth: f64) {
        let (unit, origin) = (self.coupling.unit(), self.touch.pose.translation);
        let rest = &mut self.rest_search.rest;
        let row = |push: &Push| stacked_along(push.centre - origin, push.normal, unit);
        let mut whole = [0.0; FREEDOMS];
        rest.pushes.iter().for_each(|push| add(&mut whole, push.push, &row(push)));
        let touching = rest.touching.iter().map(|push| (push.touches(depth), row(push)));
        let y = least(whole, touching);
        for push in rest.touching.iter_mut() {
            push.push = push.touches(depth) * dot(&row(push), &y).max(0.0);
        }
        rest.touching.retain(|push| push.push > 0.0);
    }
}

/// The `y` at which `½ Σ mᵢ max(0, aᵢ·y)² − w·y` is least.
fn least(w: Stacked, all: impl Iterator<Item = (f64, Stacked)> + Clone) -> Stacked {
    let trace: f64 = all.clone().map(|(m, a)| m * dot(&a, &a)).sum();
    let ridge = RIDGE * trace;
    let value = |y: &Stacked| {
        let pushed = all.clone().map(|(m, a)| 0.5 * m * dot(&a, y).max(0.0).powi(2));
        pushed.sum::<f64>() + 0.5 * ridge * dot(y, y) - dot(&w, y)
    };
    let (mut y, mut best) = ([0.0; FREEDOMS], f64::INFINITY);
    for turn in 0..MOST_TURNS {
        let mut matrix = [[0.0; FREEDOMS]; FREEDOMS];
        matrix.iter_mut().enumerate().for_each(|(k, row)| {
            row.iter_mut().skip(k).take(1).for_each(|x| *x = ridge);
        });
        for (m, a) in all.clone().filter(|(_, a)| turn == 0 || dot(a, &y) > 0.0) {
            matrix.iter_mut().zip(a).for_each(|(row, x)| add(row, m * x, &a));
        }
        let Some(goal) = solve(matrix, w) else { break };
        let mut way = goal;
        add(&mut way, -1.0, &y);
        let (mut next, mut now) = (goal, value(&goal));
        let mut part = 1.0;
        for _ in 0..MOST_HALVINGS {
            if now <= best {
                break;
            }
            part *= 0.5;
            next = y;
            add(&mut next, part, &way);
            now = value(&next);
        }
        // Written so that NaN ends.
        let is_better = now < best;
        if !is_better {
            break;
        }
        (y, best) = (next, now);
    }
    y
}

/// The solution of a symmetric positive definite system, by elimination; `None` if it is not.
fn solve(mut matrix: [Stacked; FREEDOMS], mut right: Stacked) -> Option<Stacked> {
    for k in 0..FREEDOMS {
        let (pivot_row, pivot_right) = (*matrix.get(k)?, *right.get(k)?);
        let pivot = *pivot_row.get(k)?;
        // Written so that NaN is refused.
        let is_positive = pivot > 0.0;
        if !is_positive {
            return None;
        }
        for (row, right) in matrix.iter_mut().zip(&mut right).skip(k + 1) {
            let factor = *row.get(k)? / pivot;
            add(row, -factor, &pivot_row);
            *right -= factor * pivot_right;
        }
    }
    let mut solution = [0.0; FREEDOMS];
    for k in (0..FREEDOMS).rev() {
        let row = matrix.get(k)?;
        let rest = right.get(k)? - dot(row, &solution);
        *solution.get_mut(k)? = rest / row.get(k)?;
    }
    Some(solution)
}

fn add(to: &mut Stacked, factor: f64, other: &Stacked) {
    to.iter_mut().zip(other).for_each(|(to, other)| *to += factor * other);
}

fn dot(a: &Stacked, b: &Stacked) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_testkit::cases::each as cases;

    #[test]
    fn spread_pushes_have_the_force_and_the_torque_of_the_pushes() {
        cases(400, |u| {
            let mut number = || Ok(f64::from(u.int_in_range(-1000..=1000)?) * 1e-3);
            let (mut rows, mut w) = (Vec::new(), [0.0; FREEDOMS]);
            for _ in 0..20 {
                let mut row = [0.0; FREEDOMS];
                for x in &mut row {
                    *x = number()?;
                }
                // Contacts of a floor push up.
                row[1] = 1.0;
                let touches = 0.5 + 0.5 * number()?.abs();
                add(&mut w, number()?.max(0.0), &row);
                rows.push((touches, row));
            }
            let y = least(w, rows.iter().copied());
            for (m, a) in &rows {
                add(&mut w, -m * dot(a, &y).max(0.0), a);
            }
            assert!(dot(&w, &w).sqrt() < 1e-6, "{w:?}");
            Ok(())
        });
    }

    #[test]
    fn the_middle_of_a_rod_is_borne_by_all_its_points() {
        let row = |x: f64| [0.0, 1.0, 0.0, 0.0, 0.0, x];
        let all = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|x| (1.0, row(x)));
        let shares = |w| {
            let y = least(w, all.into_iter());
            all.map(|(m, a)| (m * dot(&a, &y).max(0.0) * 1e6).round() * 1e-6)
        };
        assert_eq!(shares([0.0, 5.0, 0.0, 0.0, 0.0, 0.0]), [1.0; 5]);
        // Nearer and nearer to an end.
        assert_eq!(shares([0.0, 5.0, 0.0, 0.0, 0.0, 5.0]), [0.0, 0.5, 1.0, 1.5, 2.0]);
        assert_eq!(shares([0.0, 5.0, 0.0, 0.0, 0.0, 10.0]), [0.0, 0.0, 0.0, 0.0, 5.0]);
    }
}
