// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Concave corners of two and three walls hold the proxy where they meet, to 1e-6 of the scene.

use crate::common::{body, cases, cuboid, direction, unit};
use arbitrary::Unstructured;
use palpate_device::PointState;
use palpate_field::{Point, Shape, Vector};
use palpate_haptics::{Material, Probe, Servo, ServoOptions, Surface};

/// The radius of the scene [m].
const SIZE: f64 = 0.1;

/// Half-spaces below planes through the offset corner, with bounds: big boxes would do as well.
fn walls<const D: usize>(normals: &[Vector<f64, D>]) -> Shape<D> {
    let wall = |n: &Vector<f64, D>| crate::common::half_space(n.0, 0.0);
    let all = Shape::union(normals.iter().map(wall)).unwrap();
    Shape::intersection([all, cuboid([SIZE * 2.0 / (D as f64).sqrt(); D])]).unwrap()
}

/// Presses into the corner of walls; how far the proxy is from where they meet [m].
fn miss<const D: usize>(
    u: &mut Unstructured<'_>,
    normals: &[Vector<f64, D>],
    (corner, friction): (Point<D>, f64),
    radius: f64,
) -> arbitrary::Result<f64> {
    let (static_friction, dynamic_friction) = (friction, friction);
    let material = Material { static_friction, dynamic_friction, ..Material::default() };
    let bodies = body(walls(normals), Surface::new(&material).unwrap());
    let probe = Probe::new(radius).unwrap();
    let options = ServoOptions { probe, ..ServoOptions::default() };
    let mut servo = Servo::new(bodies, 1, options).unwrap();
    let (normals, corner) = (normals.iter().map(|n| n.in_space()), corner.in_space());
    let up = normals.clone().fold(Vector::ZERO, |sum, n| sum + n).normalized().unwrap();
    let mut press = Vector::ZERO;
    for n in normals {
        press -= n * (0.004 + 0.002 * unit(u)?.abs());
    }
    let from = corner + up * 0.02;
    let mut last = corner;
    for tick in 0..=400 {
        let part = (f64::from(tick) / 300.0).min(1.0);
        let device = from + (corner + press - from) * part;
        last = servo.step(&[PointState::at_rest(device)])[0].proxy;
    }
    Ok((last - corner).norm())
}

/// Unit normals at angles of 60 to 120 degrees.
fn normals<const D: usize>(
    u: &mut Unstructured<'_>,
    count: usize,
) -> arbitrary::Result<Vec<Vector<f64, D>>> {
    let mut normals: Vec<Vector<f64, D>> = Vec::new();
    for _ in 0..count {
        let n: Vector<f64, D> = direction(u)?;
        if normals.iter().any(|m| m.dot(n).abs() > 0.5) {
            return Err(arbitrary::Error::IncorrectFormat);
        }
        normals.push(n);
    }
    Ok(normals)
}

/// The point at the height of the radius over planes through the origin.
fn corner<const D: usize>(normals: &[Vector<f64, D>], radius: f64) -> Point<D> {
    let mut point = Vector::ZERO;
    for _ in 0..10_000 {
        for n in normals {
            point += *n * (radius - n.dot(point));
        }
    }
    point
}

fn corners_are_exact<const D: usize>(count: usize, friction: f64) {
    let mut checked = 0;
    cases(60, |u| {
        // Most of what is drawn is too flat.
        for _ in 0..30 {
            let Ok(normals) = normals::<D>(u, count) else { continue };
            let radius = [0.0, 0.002][u.choose_index(2)?];
            let at = corner(&normals, radius);
            let miss = miss(u, &normals, (at, friction), radius)?;
            assert!(miss <= 1e-6 * SIZE, "{miss} m: {normals:?} radius {radius}");
            checked += 1;
        }
        Ok(())
    });
    assert!(checked > palpate_testkit::cases::count(100), "{checked}");
}

#[test]
fn friction_that_is_overcome_leaves_the_corner_where_it_is() {
    // Every wall is pressed with 4 to 6 mm along its normal, which pulls the proxy along each
    // other wall by more than 0.1 of what it is pressed with.
    corners_are_exact::<2>(2, 0.1);
    corners_are_exact::<3>(3, 0.1);
}

#[test]
fn two_walls_in_the_plane() {
    corners_are_exact::<2>(2, 0.0);
}

#[test]
fn two_walls_in_space() {
    corners_are_exact::<3>(2, 0.0);
}

#[test]
fn three_walls_in_space() {
    corners_are_exact::<3>(3, 0.0);
}
