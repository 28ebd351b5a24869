// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The curvature of the surface near a proxy, learnt from the tangent planes that the proxy
//! meets.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::Vector;

/// Relative residual at which the linear solver stops. More precision is wasted: the curvature
/// is an estimate.
const SOLVED: f64 = 1e-4;

/// The shape operator `S` of a surface: along a short displacement `w` the unit normal changes
/// by `S w`.
///
/// Each displacement updates `S` by the symmetric secant update of Powell, "A new algorithm for
/// unconstrained optimization" (1970): the smallest change of `S` that explains the observed
/// change of the normal. The estimate is kept between ticks, because the curvature under a
/// proxy changes little in a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Curvature {
    /// The rows of the symmetric matrix [1/m].
    rows: [Vector<f64, 3>; 3],
}

impl Curvature {
    /// The curvature of a plane: zero.
    pub(crate) const FLAT: Self = Self { rows: [Vector::ZERO; 3] };

    /// The change of the normal along a displacement.
    #[inline]
    fn turn(&self, way: Vector<f64, 3>) -> Vector<f64, 3> {
        Vector(self.rows.map(|row| row.dot(way)))
    }

    /// The residual: the part of the observed `turn` of the normal that this estimate does not
    /// predict.
    #[inline]
    pub(crate) fn residual(&self, way: Vector<f64, 3>, turn: Vector<f64, 3>) -> Vector<f64, 3> {
        turn - self.turn(way)
    }

    /// Corrects the estimate by the [residual](Self::residual) along a `way` of squared length
    /// `squared` [m²].
    ///
    /// `S ← S + (r wᵀ + w rᵀ) / w² − (r·w) w wᵀ / w⁴` with `r = turn − S w`.
    #[inline]
    pub(crate) fn learn(
        &mut self,
        way: Vector<f64, 3>,
        residual: Vector<f64, 3>,
        squared: f64,
    ) {
        let per_squared = 1.0 / squared;
        let rest = residual * per_squared;
        let rest = rest - way * (0.5 * rest.dot(way) * per_squared);
        for ((row, r), w) in self.rows.iter_mut().zip(rest.0).zip(way.0) {
            *row += way * r + rest * w;
        }
    }

    /// `true` if `d ‖S‖ ≤ 1/2`, where `squared_depth` is `d²` [m²]. Then the
    /// [displacement](Self::way) to the point closest to the device is at most twice as long as
    /// on the tangent plane.
    #[inline]
    pub(crate) fn at_most_doubles(&self, squared_depth: f64) -> bool {
        let squared = self.rows.iter().fold(0.0, |sum, row| sum + row.dot(*row));
        squared_depth * squared <= 0.25
    }

    /// The displacement along the surface to the point closest to a device `depth` [m] below
    /// the surface; on the tangent plane this displacement would be `along`. `None` if the
    /// closest point is not near.
    /// `dimensions` are those of [`Solver`].
    #[inline]
    pub(crate) fn way(
        &self,
        along: Vector<f64, 3>,
        depth: f64,
        dimensions: usize,
    ) -> Option<Vector<f64, 3>> {
        let solver = Solver { solved: SOLVED, dimensions };
        surface_displacement(|way| self.turn(way), along, depth, solver)
    }
}

/// When [`surface_displacement`] stops.
#[derive(Clone, Copy)]
pub(crate) struct Solver {
    /// The relative residual.
    pub(crate) solved: f64,
    /// The dimensions of the surface: one for planar shapes, which are straight along z.
    pub(crate) dimensions: usize,
}

/// The displacement over a surface that a point `depth` [m] below the surface sees as `along`;
/// `turn` gives the change of the unit normal along a displacement. `None` if the point is
/// beyond a centre of curvature.
///
/// Where the curvature is `κ`, displacements at depth `d` are `1 − κ d` times those on the
/// surface, so `(1 − d S) w = along`. Conjugate gradients solve this equation to the relative
/// residual of the solver; they are exact after as many steps as the surface has dimensions. They
/// stop where the matrix is not positive definite: beyond a centre of curvature there is no
/// closest point.
#[inline]
pub(crate) fn surface_displacement(
    mut turn: impl FnMut(Vector<f64, 3>) -> Vector<f64, 3>,
    along: Vector<f64, 3>,
    depth: f64,
    Solver { solved, dimensions }: Solver,
) -> Option<Vector<f64, 3>> {
    let (mut way, mut rest, mut step) = (Vector::ZERO, along, along);
    let mut left = rest.dot(rest);
    let solved = solved * solved * left;
    for _ in 0..dimensions {
        let seen = step - turn(step) * depth;
        let steepness = step.dot(seen);
        // A zero residual needs no step.
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

    /// The curvature of a cylinder of radius 1/4 m along the third axis.
    fn cylinder() -> Curvature {
        let mut curvature = Curvature::FLAT;
        let way = Vector([0.125, 0.0, 0.0]);
        curvature.learn(way, curvature.residual(way, way * 4.0), way.dot(way));
        curvature
    }

    #[test]
    fn learnt_curvature_predicts_the_turn() {
        let mut curvature = cylinder();
        assert_eq!(curvature.turn(Vector([1.0, 0.0, 0.0])), Vector([4.0, 0.0, 0.0]));
        assert_eq!(curvature.turn(Vector([0.0, 0.0, 1.0])), Vector::ZERO);
        let (way, turn) = (Vector([0.25, 0.0, 0.5]), Vector([0.5, 0.25, -0.25]));
        curvature.learn(way, curvature.residual(way, turn), way.dot(way));
        assert!(curvature.residual(way, turn).norm() < 1e-15);
    }

    #[test]
    fn the_closest_point_turns_about_the_centre() {
        // At half the radius deep: twice the displacement across the axis, the same along the
        // axis.
        let way = cylinder().way(Vector([0.001, 0.0, 0.002]), 0.125, 2).unwrap();
        assert!((way - Vector([0.002, 0.0, 0.002])).norm() < 1e-15);
        assert!(cylinder().at_most_doubles(0.125 * 0.125));
        assert!(!cylinder().at_most_doubles(0.126 * 0.126));
        // Beyond the axis there is no closest point.
        assert_eq!(cylinder().way(Vector([0.001, 0.0, 0.0]), 0.5, 2), None);
    }
}
