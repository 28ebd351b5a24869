// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How the surface bends near a proxy, learnt from the tangent planes that it meets.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::Vector;

/// The part of a residual below which a step solves its equation: the step is itself a guess.
const SOLVED: f64 = 1e-4;

/// The shape operator `S` of a surface: its unit normal turns by `S w` along a short way `w`.
///
/// Learnt one way at a time by the symmetric secant update of Powell, "A new algorithm for
/// unconstrained optimization" (1970): the least change of `S` that tells the turn seen. It
/// outlives a tick: the surface under a proxy bends much as it did a tick before.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bend<const D: usize> {
    /// The rows of the symmetric matrix [1/m].
    rows: [Vector<f64, D>; D],
}

impl<const D: usize> Bend<D> {
    /// That of a plane.
    pub(crate) const FLAT: Self = Self { rows: [Vector::ZERO; D] };

    /// How the normal turns along a way.
    #[inline]
    fn turn(&self, way: Vector<f64, D>) -> Vector<f64, D> {
        Vector(self.rows.map(|row| row.dot(way)))
    }

    /// What this bend does not tell of a `turn` of the normal along a way.
    #[inline]
    pub(crate) fn untold(&self, way: Vector<f64, D>, turn: Vector<f64, D>) -> Vector<f64, D> {
        turn - self.turn(way)
    }

    /// Learns what was [untold](Self::untold) of the turn along a `way` of squared length
    /// `squared` [m²].
    ///
    /// `S ← S + (r wᵀ + w rᵀ) / w² − (r·w) w wᵀ / w⁴` with `r = turn − S w`.
    #[inline]
    pub(crate) fn learn(&mut self, way: Vector<f64, D>, untold: Vector<f64, D>, squared: f64) {
        let per_squared = 1.0 / squared;
        let rest = untold * per_squared;
        let rest = rest - way * (0.5 * rest.dot(way) * per_squared);
        for ((row, r), w) in self.rows.iter_mut().zip(rest.0).zip(way.0) {
            *row += way * r + rest * w;
        }
    }

    /// `true` if the [way](Self::way) to the point closest to a device at a depth of which this
    /// is the square [m²] is at most twice as long as on the tangent plane: as `d ‖S‖ ≤ 1/2`.
    #[inline]
    pub(crate) fn at_most_doubles(&self, squared_depth: f64) -> bool {
        let squared = self.rows.iter().fold(0.0, |sum, row| sum + row.dot(*row));
        squared_depth * squared <= 0.25
    }

    /// The way to the point closest to a device at `depth` [m] below the surface, for which it
    /// would be `along` on the tangent plane, itself not included; none if the closest point is
    /// not near.
    #[inline]
    pub(crate) fn way(&self, along: Vector<f64, D>, depth: f64) -> Option<Vector<f64, D>> {
        way_over(|way| self.turn(way), along, (depth, SOLVED))
    }
}

/// The way over a surface that a point `depth` [m] below it sees as `along`; `turn` is how the
/// surface's unit normal turns along a way. None if the point is past a centre of the bend.
///
/// The point is `κ d` times closer to the centre of a bend of curvature `κ` than the surface, so
/// `(1 − d S) w = along`. Solved by conjugate gradients, which are exact after as many steps as
/// the surface has dimensions, up to a part `solved` of `along`. They end where the matrix is not
/// positive: past a centre there is no closest point.
#[inline]
pub(crate) fn way_over<const D: usize>(
    mut turn: impl FnMut(Vector<f64, D>) -> Vector<f64, D>,
    along: Vector<f64, D>,
    (depth, solved): (f64, f64),
) -> Option<Vector<f64, D>> {
    let (mut way, mut rest, mut step) = (Vector::ZERO, along, along);
    let mut left = rest.dot(rest);
    let solved = solved * solved * left;
    for _ in 1..D {
        let seen = step - turn(step) * depth;
        let steepness = step.dot(seen);
        // What is nothing needs no step.
        if steepness <= 0.0 || steepness.is_nan() {
            return None;
        }
        let length = left / steepness;
        way += step * length;
        rest -= seen * length;
        let before = left;
        left = rest.dot(rest);
        if left <= solved {
            break;
        }
        step = rest + step * (left / before);
    }
    Some(way)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bend of a cylinder of 1/4 m along the third axis.
    fn cylinder() -> Bend<3> {
        let mut bend = Bend::FLAT;
        let way = Vector([0.125, 0.0, 0.0]);
        bend.learn(way, bend.untold(way, way * 4.0), way.dot(way));
        bend
    }

    #[test]
    fn a_bend_tells_what_it_learnt() {
        let mut bend = cylinder();
        assert_eq!(bend.turn(Vector([1.0, 0.0, 0.0])), Vector([4.0, 0.0, 0.0]));
        assert_eq!(bend.turn(Vector([0.0, 0.0, 1.0])), Vector::ZERO);
        let (way, turn) = (Vector([0.25, 0.0, 0.5]), Vector([0.5, 0.25, -0.25]));
        bend.learn(way, bend.untold(way, turn), way.dot(way));
        assert!(bend.untold(way, turn).norm() < 1e-15);
    }

    #[test]
    fn the_closest_point_turns_about_the_centre() {
        // At a depth of half the radius, twice as far across the axis, as far along it.
        let way = cylinder().way(Vector([0.001, 0.0, 0.002]), 0.125).unwrap();
        assert!((way - Vector([0.002, 0.0, 0.002])).norm() < 1e-15);
        assert!(cylinder().at_most_doubles(0.125 * 0.125));
        assert!(!cylinder().at_most_doubles(0.126 * 0.126));
        // Past the axis there is none.
        assert_eq!(cylinder().way(Vector([0.001, 0.0, 0.0]), 0.5), None);
    }
}
