// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The bolt and the nut of MuJoCo's plugins `mujoco.sdf.bolt` and `mujoco.sdf.nut`, about the y
//! axis. All lengths but the radius are fixed.
//!
//! - The thread is right-handed, of pitch 1/12 m. Its flanks are at 45° to the axis and meet at
//!   the radius R below and at R + 1/24 m above.
//! - The head is a hexagonal prism, 1 m across the flats, from −0.5 m to 0, chamfered above to
//!   the radius R + 0.22 m.
//! - The bolt is the head with a thread down to −1 m, which is chamfered below to the radius R.
//! - The nut is the head without the thread, but for what is outside a cone that has the radius R
//!   at −0.5 m, and without a cone that has the radius R + 0.05 m at 0.
//!
//! All cones open by a right angle. Nut and bolt fit without a clearance.

use std::f64::consts::{FRAC_PI_2, PI};

use palpate::field::kernel::{HexagonalPrism, InfiniteCone, ScrewThread};
use palpate::field::{Rotation, Shape, ShapeError, Vector};

/// From a crest to the next [m].
const PITCH: f64 = 1.0 / 12.0;

/// From the axis to a side of the head [m].
const HEAD: f64 = 0.5;

/// The height of the head, that of the nut [m].
const HEIGHT: f64 = 0.5;

/// The length of the bolt with its head [m].
const LENGTH: f64 = 1.0;

/// The bolt with this radius of the roots [m].
pub(super) fn bolt(radius: f64) -> Result<Shape<3>, ShapeError> {
    let thread = thread(radius, -0.5 * LENGTH)?;
    let thread = Shape::intersection([thread, opening_up(radius, -LENGTH)?])?;
    Shape::union([thread, head(radius)?])
}

/// The nut of a bolt with this radius of the roots [m].
pub(super) fn nut(radius: f64) -> Result<Shape<3>, ShapeError> {
    // Longer than the nut: its ends are outside.
    let thread = thread(radius, -0.5 * HEIGHT)?;
    let thread = Shape::intersection([thread, opening_up(radius, -HEIGHT)?])?;
    Shape::difference(head(radius)?, [thread, opening_up(radius, -0.05)?])
}

/// A thread of the bolt's length about `middle`, which is a multiple of the pitch: a crest is at
/// +x, at the height 0.
fn thread(radius: f64, middle: f64) -> Result<Shape<3>, ShapeError> {
    let depth = 0.5 * PITCH;
    let profile = Vector([0.0, 0.0, depth]);
    let thread = ScrewThread::new(radius + depth, LENGTH, PITCH, 1, profile)?;
    Shape::from_kernel(thread).translated(Vector([0.0, middle, 0.0]))
}

fn head(radius: f64) -> Result<Shape<3>, ShapeError> {
    let corner = HEAD / (PI / 6.0).cos();
    let prism = Shape::from_kernel(HexagonalPrism::new(corner, HEIGHT)?);
    let prism = prism.translated(Vector([0.0, -0.5 * HEIGHT, 0.0]))?;
    let chamfer = Shape::from_kernel(InfiniteCone::new(FRAC_PI_2)?);
    let chamfer = chamfer.translated(Vector([0.0, radius + 0.22, 0.0]))?;
    Shape::intersection([prism, chamfer])
}

/// A cone that opens upwards and has a radius at a height [m].
fn opening_up(radius: f64, height: f64) -> Result<Shape<3>, ShapeError> {
    let cone = Shape::from_kernel(InfiniteCone::new(FRAC_PI_2)?);
    let cone = cone.rotated(Rotation::from_axis_angle(Vector::unit(0), PI)?)?;
    cone.translated(Vector([0.0, height - radius, 0.0]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_1_SQRT_2, TAU};

    use crate::random::Random;

    const RADIUS: f64 = 0.26;

    /// Numbers of the formulas at a point about the y axis: those of the thread and of the head,
    /// how far the point is above the roots' radius, and its height.
    fn by_formula([x, y, z]: [f64; 3]) -> [f64; 4] {
        let over_root = x.hypot(z) - RADIUS;
        let turns = 12.0 * y - (-z).atan2(x) / TAU;
        let wave = (turns - turns.floor() - 0.5).abs();
        let thread = FRAC_1_SQRT_2 * (over_root - wave / 12.0);
        let sides = (0..6).map(|side| {
            let angle = TAU / 6.0 * f64::from(side);
            x * angle.cos() + z * angle.sin() - 0.5
        });
        let across = sides.fold(f64::NEG_INFINITY, f64::max);
        let chamfer = FRAC_1_SQRT_2 * (y + over_root - 0.22);
        [thread, across.max((y + 0.25).abs() - 0.25).max(chamfer), over_root, y]
    }

    fn bolt_by_formula(p: [f64; 3]) -> f64 {
        let [thread, head, over_root, y] = by_formula(p);
        let thread = thread.max((y + 0.5).abs() - 0.5);
        thread.max(FRAC_1_SQRT_2 * (over_root - y - 1.0)).min(head)
    }

    fn nut_by_formula(p: [f64; 3]) -> f64 {
        let [thread, head, over_root, y] = by_formula(p);
        let cone = |height: f64| FRAC_1_SQRT_2 * (y + height - over_root);
        head.max((-thread).min(cone(0.5))).max(cone(0.05))
    }

    #[test]
    fn shapes_are_those_of_the_formulas() -> Result<(), ShapeError> {
        let (bolt, nut) = (bolt(RADIUS)?, nut(RADIUS)?);
        let mut random = Random::new(11);
        for _ in 0..50_000 {
            let [x, y, z] = random.point([0.0; 3], 0.6);
            let p = [x, y - 0.5, z];
            for (shape, field) in [(&bolt, bolt_by_formula(p)), (&nut, nut_by_formula(p))] {
                let distance = shape.distance(Vector(p));
                let agree = (distance < 0.0) == (field < 0.0);
                assert!(agree || distance.abs() < 1e-12, "{p:?}: {distance}, {field}");
                // Depths too: ours less for the helix, more at roots, where only ours are exact.
                if (-0.01..0.0).contains(&field) {
                    assert!((0.98..1.415).contains(&(distance / field)), "{p:?}: {distance}");
                }
            }
        }
        Ok(())
    }

    #[test]
    fn the_nut_fits_the_bolt() -> Result<(), ShapeError> {
        let bolt = bolt(RADIUS)?;
        let nut = nut(RADIUS)?.translated(Vector([0.0, -0.5, 0.0]))?;
        let mut random = Random::new(12);
        let mut is_beside = false;
        for _ in 0..20_000 {
            let [x, y, z] = random.point([0.0; 3], 0.5);
            let p = Vector([x, y - 0.5, z]);
            let [a, b] = [&bolt, &nut].map(|shape| shape.distance(p));
            assert!(a.max(b) > -1e-12, "{p:?}: {a}, {b}");
            is_beside |= a < 0.0 && a > -0.01 && b < 0.02;
        }
        assert!(is_beside);
        Ok(())
    }
}
