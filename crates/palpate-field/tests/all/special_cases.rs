// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Kernels with arguments that make them the same shape.

use palpate_field::kernel::{
    Ball, Capsule, ChamferedRectangle, Cuboid, CutDisk, Horseshoe, IsoscelesTrapezoid, Kernel,
    Parallelogram, Pie, RegularPolygon, RegularStar, Rhombus, RingSector, RoundedCuboid,
    RoundedRectangle, RoundedX, Stairs, UnevenCapsule, Vesica,
};
use palpate_field::{Rotation, ShapeError, Vector};

/// Compares two kernels on a grid about the origin, no point of which is special.
fn same(a: &impl Kernel<2>, b: &impl Kernel<2>) {
    for i in 0..40 {
        for k in 0..40 {
            let p = Vector([0.113 * f64::from(i) - 2.2, 0.127 * f64::from(k) - 2.4]);
            let (x, y) = (a.distance(p), b.distance(p));
            assert!((x - y).abs() < 1e-14, "{x} and {y} at {p:?}: {a:?}, {b:?}");
        }
    }
}

#[test]
fn special_cases_are_the_shapes_they_are_known_as() -> Result<(), ShapeError> {
    use std::f64::consts::{PI, SQRT_2};
    let size = Vector([1.9, 1.3]);
    let rectangle = Cuboid::new(size)?;
    same(&rectangle, &ChamferedRectangle::new(size, 0.0)?);
    same(&rectangle, &Parallelogram::new(1.9, 1.3, 0.0)?);
    same(&rectangle, &IsoscelesTrapezoid::new(1.9, 1.9, 1.3)?);
    same(&rectangle, &Stairs::new(1.9, 1.3, 1)?);
    let rounded = RoundedRectangle::new(size, 0.4, 0.4, 0.4, 0.4)?;
    same(&RoundedCuboid::new(size, 0.4)?, &rounded);
    same(&RegularPolygon::new(4, 0.8)?, &Rhombus::new(Vector([1.6, 1.6]))?);
    let octagon = ChamferedRectangle::new(Vector([2.0, 2.0]), 2.0 - SQRT_2)?;
    let corner = 1.0_f64.hypot(SQRT_2 - 1.0);
    let turned = Rotation::from_angle(PI / 8.0)?;
    let back = turned.inverse();
    for (x, y) in [(0.1_f64, 0.2), (1.7, 0.4), (-0.9, -1.1), (0.3, -2.0)] {
        let p = Vector([x, y]);
        let regular = RegularPolygon::new(8, corner)?.distance(back.rotate(p));
        assert!((octagon.distance(p) - regular).abs() < 1e-14, "at {p:?}");
    }
    same(&Ball::new(0.8)?, &Vesica::new(1.6, 1.6)?);
    same(&Ball::new(0.8)?, &RoundedX::new(1.6, 0.8)?);
    same(&Capsule::new(0.5, 2.0)?, &UnevenCapsule::new(0.5, 0.5, 1.0)?);
    same(&CutDisk::new(1.2, 0.0)?, &Pie::new(1.2, PI)?);
    for angle in [1.0, PI, 5.0] {
        let sector = RingSector::new(0.6, 1.2, angle)?;
        same(&sector, &Horseshoe::new(0.9, angle, 0.0, 0.6)?);
    }
    Ok(())
}

/// Outside, the distance to a union is the smaller of its parts'.
#[test]
fn a_hexagram_is_two_triangles() -> Result<(), ShapeError> {
    let (star, triangle) = (RegularStar::hexagram(1.1)?, RegularPolygon::new(3, 1.1)?);
    for i in 0..40 {
        for k in 0..40 {
            let p = Vector([0.113 * f64::from(i) - 2.2, 0.127 * f64::from(k) - 2.4]);
            let both = triangle.distance(p).min(triangle.distance(-p));
            let f = star.distance(p);
            let right = if both < 0.0 { f <= both + 1e-14 } else { (f - both).abs() < 1e-14 };
            assert!(right, "{f} and {both} at {p:?}");
        }
    }
    Ok(())
}
