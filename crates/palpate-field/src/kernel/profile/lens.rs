// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The intersection of two discs.

use crate::bounds::{Aabb, BoundingBall, Bounds};
use crate::kernel::face_if_on_it;
use crate::scalar::Scalar;
use crate::vector::{Point, Vector};

/// The intersection of two equal discs, its tips at `(0, ±h)`: to the right of the
/// y axis the part of a disc about `(−c, 0)`.
///
/// # Derivation
///
/// Of half width `w`, the disc has the radius `R = c + w`, and `R² = c² + h²`. So `c/R`, `h/R`
/// and `1/R` are quotients with `h² + w²`, where nothing cancels. The distance from the circle
/// is `‖(x + c, y)‖ − R`, in which nearly all digits cancel if the lens is thin. Multiplied and
/// divided by the sum of both terms it is
///
/// ```text
/// (x(x/R + 2c/R) + (y − h)(y + h)/R) / (‖(x + c, y)‖/R + 1).
/// ```
///
/// With `y ≥ 0`, the tip is nearest past the line from the disc's centre through it.
#[derive(Clone, Debug)]
pub(in crate::kernel) struct Lens {
    half_height: f64,
    /// The normal of the arc at its tip, `(c, h)/R`.
    tip: [f64; 2],
    curvature: f64,
}

impl Lens {
    /// A lens of `half_height` and `half_width` [m], at most as wide as high.
    pub(in crate::kernel) fn new(half_height: f64, half_width: f64) -> Self {
        let (h, w) = (half_height, half_width);
        // Divided by the larger, so that no square overflows.
        let slim = w / h;
        let sum = 1.0 + slim * slim;
        let tip = [(1.0 - slim) * (1.0 + slim) / sum, 2.0 * slim / sum];
        Self { half_height, tip, curvature: tip[1] / h }
    }

    /// The signed distance.
    #[inline(always)]
    pub(in crate::kernel) fn distance<S: Scalar>(&self, p: [S; 2]) -> S {
        let [x, y] = [p[0], p[1].abs()];
        let [tip_x, tip_y] = self.tip;
        let beyond = y - S::constant(self.half_height);
        let past_tip = S::weighted_sum([beyond, x], &[tip_x, -tip_y]);
        let (across, up) = (x.scale(self.curvature), y.scale(self.curvature));
        let sum = S::norm([across + S::constant(tip_x), up]) + S::constant(1.0);
        let product =
            x * (across + S::constant(2.0 * tip_x)) + beyond * (up + S::constant(tip_y));
        let zero = S::constant(0.0);
        let arc = product / sum;
        // `beyond` first, because the first component decides the gradient at the tip, and +y
        // is a normal there.
        let tip = face_if_on_it(S::norm([beyond, x]), arc, self.half_height);
        S::select_less(zero, past_tip, tip, arc)
    }

    /// The bounds when turned about the unit vector `axis` through `centre`.
    ///
    /// In a direction between the normal of the tip and that across, the disc reaches
    /// `R − c·across`; with `n` the normal of the tip and `u` the direction this is the
    /// tip's own height and `R‖u − n‖²/2`.
    pub(in crate::kernel) fn turned_bounds(
        &self,
        axis: Vector<f64, 3>,
        centre: Point<3>,
    ) -> Bounds<3> {
        let reach = |i: usize| {
            let along = axis[i].abs();
            let across = axis[(i + 1) % 3].hypot(axis[(i + 2) % 3]);
            let [x, y] = [across - self.tip[0], along - self.tip[1]];
            let bulge = if x > 0.0 { 0.5 * (x * x + y * y) / self.curvature } else { 0.0 };
            self.half_height * along + bulge
        };
        let half = Vector(std::array::from_fn(reach));
        let slack = 8.0 * f64::EPSILON * (self.half_height + centre.norm());
        let aabb = Aabb { min: centre - half, max: centre + half }.grown(slack);
        Bounds { aabb, ball: BoundingBall { centre, radius: self.half_height + slack } }
    }

    /// Half the height [m].
    pub(in crate::kernel) fn half_height(&self) -> f64 {
        self.half_height
    }
}
