// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The motion closest to a desired one under linear constraints.
//!
//! The dual active-set method of Goldfarb and Idnani, "A numerically stable dual method for
//! solving strictly convex quadratic programs" (1983), with the identity as matrix. Starting at
//! the desired motion, the most violated constraint becomes active, and constraints with a
//! negative multiplier become inactive. At most six constraints are active at a time, so their
//! dual vectors are kept instead of a factorisation.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

/// Degrees of freedom of a rigid motion, and the most active constraints.
pub(super) const FREEDOMS: usize = 6;

/// The most constraints activated one after the other. Contacts of a hull take about ten; a
/// search that is not finished after this many has a desired motion that nearly all constraints
/// forbid.
const MOST_TURNS: usize = 48;

/// A constraint counts as linearly dependent on the active ones if at most this part of its
/// squared length is orthogonal to them.
const DEPENDENT: f64 = 1e-12;

/// All motions `u` with `along·u ≥ least`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    pub(super) along: [f64; FREEDOMS],
    pub(super) least: f64,
}

/// An active constraint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Held {
    /// The index of the row.
    pub(super) row: usize,
    /// The multiplier: the sum of `push · along` separates the motion from the desired one.
    pub(super) push: f64,
    along: [f64; FREEDOMS],
    /// The dual vector: its product with its own row is 1, and with the other active rows 0.
    dual: [f64; FREEDOMS],
}

/// The result of the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Closest {
    /// The motion.
    pub(super) motion: [f64; FREEDOMS],
    held: [Held; FREEDOMS],
    count: usize,
}

impl Closest {
    fn free(wish: [f64; FREEDOMS]) -> Self {
        let zero = [0.0; FREEDOMS];
        let none = Held { row: 0, push: 0.0, along: zero, dual: zero };
        Self { motion: wish, held: [none; FREEDOMS], count: 0 }
    }

    /// The active constraints, which keep the motion from the desired one.
    pub(super) fn held(&self) -> impl Iterator<Item = &Held> {
        self.held.iter().take(self.count)
    }

    /// Activates one more row; `false` if it is infeasible together with the active rows.
    fn hold(&mut self, index: usize, row: &Row) -> bool {
        let mut push = 0.0;
        for _ in 0..=FREEDOMS {
            let beyond = self.beyond(row.along);
            let squared = dot(&beyond, &beyond);
            // The largest step before the multiplier of an active row becomes negative.
            let (mut most, mut first) = (f64::INFINITY, 0);
            for (k, held) in self.held().enumerate() {
                let response = dot(&held.dual, &row.along);
                if response > 0.0 && held.push < most * response {
                    (most, first) = (held.push / response, k);
                }
            }
            let independent = squared > DEPENDENT * dot(&row.along, &row.along);
            let whole = if independent && self.count < FREEDOMS {
                (row.least - dot(&row.along, &self.motion)) / squared
            } else {
                f64::INFINITY
            };
            let step = whole.min(most);
            if step.is_nan() || step == f64::INFINITY {
                return false;
            }
            push += step;
            for held in self.held.iter_mut().take(self.count) {
                held.push -= step * dot(&held.dual, &row.along);
            }
            if whole < f64::INFINITY {
                add(&mut self.motion, step, &beyond);
            }
            if whole <= most {
                let dual = beyond.map(|x| x / squared);
                self.keep(Held { row: index, push, along: row.along, dual });
                return true;
            }
            self.let_go(first);
        }
        false
    }

    /// The part of a row that is orthogonal to all active rows.
    fn beyond(&self, along: [f64; FREEDOMS]) -> [f64; FREEDOMS] {
        let mut beyond = along;
        // Twice, because the second pass removes rounding errors of the first.
        for _ in 0..2 {
            let before = beyond;
            for held in self.held() {
                add(&mut beyond, -dot(&held.dual, &before), &held.along);
            }
        }
        beyond
    }

    fn keep(&mut self, new: Held) {
        for held in self.held.iter_mut().take(self.count) {
            let shared = dot(&held.dual, &new.along);
            add(&mut held.dual, -shared, &new.dual);
        }
        if let Some(place) = self.held.get_mut(self.count) {
            *place = new;
            self.count += 1;
        }
    }

    fn let_go(&mut self, index: usize) {
        let Some(last) = self.count.checked_sub(1) else { return };
        self.held.swap(index.min(last), last);
        self.count = last;
        let Some(gone) = self.held.get(last).map(|held| held.dual) else { return };
        let squared = dot(&gone, &gone);
        for held in self.held.iter_mut().take(last) {
            let shared = dot(&held.dual, &gone) / squared;
            add(&mut held.dual, -shared, &gone);
        }
    }
}

/// The motion closest to `wish` that satisfies all `rows` up to `slack`; if no motion does, one
/// that satisfies some of them.
///
/// # Derivation
///
/// Minimise `‖u − w‖²` under `aᵢ·u ≥ bᵢ`. For a set of active rows, `u = w + Σ λᵢ aᵢ`; the
/// answer is the set with all `λ ≥ 0` and all rows satisfied (Karush, Kuhn and Tucker).
/// Increasing the multiplier of one more row `a` by `t` moves `u` by `t z`, where `z` is the
/// part of `a` orthogonal to the active rows, and subtracts `t dᵢ·a` from their `λᵢ`, with
/// duals `dᵢ·aⱼ = δᵢⱼ`.
///
/// Real-time: allocates nothing, takes no lock, cannot panic; activates at most 48 rows.
pub(super) fn closest(wish: [f64; FREEDOMS], rows: &[Row], slack: f64) -> Closest {
    let mut found = Closest::free(wish);
    for _ in 0..MOST_TURNS {
        let mut worst = (slack, None);
        for (index, row) in rows.iter().enumerate() {
            let missing = row.least - dot(&row.along, &found.motion);
            if missing > worst.0 {
                worst = (missing, Some((index, row)));
            }
        }
        let Some((index, row)) = worst.1 else { break };
        if !found.hold(index, row) {
            break;
        }
    }
    found
}

#[inline]
fn dot(a: &[f64; FREEDOMS], b: &[f64; FREEDOMS]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[inline]
fn add(to: &mut [f64; FREEDOMS], factor: f64, other: &[f64; FREEDOMS]) {
    for (to, other) in to.iter_mut().zip(other) {
        *to += factor * other;
    }
}

#[cfg(test)]
#[expect(clippy::indexing_slicing, reason = "tests know their lengths")]
mod tests {
    use super::*;
    use palpate_testkit::cases::each as cases;

    fn row(along: [f64; 3], least: f64) -> Row {
        let [x, y, z] = along;
        Row { along: [x, y, z, 0.0, 0.0, 0.0], least }
    }

    #[test]
    fn a_corner_holds_a_wish() {
        let rows = [
            row([1.0, 0.0, 0.0], 0.25),
            row([0.0, 1.0, 0.0], -0.5),
            row([0.0, 0.0, 1.0], -9.0),
        ];
        let found = closest([-1.0, -2.0, 3.0, 4.0, 5.0, 6.0], &rows, 0.0);
        assert_eq!(found.motion, [0.25, -0.5, 3.0, 4.0, 5.0, 6.0]);
        let mut held: Vec<_> = found.held().map(|held| (held.row, held.push)).collect();
        held.sort_by_key(|held| held.0);
        assert_eq!(held, [(0, 1.25), (1, 1.5)]);
    }

    #[test]
    fn the_answer_is_that_of_karush_kuhn_and_tucker() {
        cases(400, |u| {
            let mut number = || Ok(f64::from(u.int_in_range(-1000..=1000)?) * 1e-3);
            let mut six = || -> arbitrary::Result<[f64; 6]> {
                let mut v = [0.0; 6];
                for x in &mut v {
                    *x = number()?;
                }
                Ok(v)
            };
            let wish = six()?;
            let mut rows = Vec::new();
            for _ in 0..20 {
                // Every row admits the zero motion, so that a solution exists.
                let along = six()?;
                let least = -0.1 * along.iter().map(|x| x * x).sum::<f64>();
                rows.push(Row { along, least });
            }
            let found = closest(wish, &rows, 1e-13);
            let mut left = found.motion;
            for (left, wish) in left.iter_mut().zip(&wish) {
                *left -= wish;
            }
            for held in found.held() {
                assert!(held.push >= -1e-12, "{held:?}");
                add(&mut left, -held.push, &rows[held.row].along);
            }
            assert!(left.iter().all(|x| x.abs() < 1e-9), "{left:?}");
            for row in &rows {
                assert!(dot(&row.along, &found.motion) >= row.least - 1e-12);
            }
            Ok(())
        });
    }

    #[test]
    fn what_cannot_be_satisfied_ends() {
        let rows = [row([1.0, 0.0, 0.0], 1.0), row([-1.0, 0.0, 0.0], 1.0)];
        let found = closest([0.0; 6], &rows, 0.0);
        assert!(found.motion.iter().all(|x| x.is_finite()));
        let rows = [row([f64::NAN, 0.0, 0.0], 1.0)];
        assert_eq!(closest([0.0; 6], &rows, 0.0).motion, [0.0; 6]);
    }
}
