// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Balls around points and balls; lengths of vectors.

use palpate_field::scalar::Model;
use palpate_field::{Block, BoundingBall, Vector};

const FEW: usize = 8;

/// Points along a spiral, of which no two are alike.
fn spiral(i: usize) -> Vector<f64, 2> {
    let t = i as f64;
    Vector([(0.5 + t) * t.cos(), (0.5 + t) * t.sin()])
}

#[test]
fn the_ball_touches_the_farthest_of_any_number_of_points() {
    for count in 1..=FEW {
        let mut points = Block::<f64, 2, FEW>::zero();
        points.fill(count, spiral);
        let ball = points.ball_around(count);
        let distances = (0..count).map(|i| (spiral(i) - ball.centre).norm());
        let farthest = distances.fold(0.0_f64, f64::max);
        assert!(ball.radius >= farthest, "{count}: {ball:?} {farthest}");
        assert!(ball.radius <= farthest * (1.0 + 1e-14), "{count}: {ball:?} {farthest}");
    }
}

#[test]
fn points_past_the_count_do_not_matter() {
    let mut points = Block::<f64, 2, FEW>::zero();
    points.set(0, Vector([3.0, 4.0]));
    let ball = points.ball_around(1);
    assert_eq!((ball.centre, ball.radius), (Vector([3.0, 4.0]), 0.0));
}

#[test]
fn cells_lie_in_it_whole() {
    let mut cells = Block::<Model, 2, FEW>::zero();
    cells.fill(5, |i| Vector(Model::cell(spiral(i).0, [0.5, 0.25])));
    let ball = cells.ball_around(5);
    for i in 0..5 {
        let corner = (spiral(i) - ball.centre).abs() + Vector([0.5, 0.25]);
        assert!(corner.norm() <= ball.radius, "{i}: {ball:?}");
    }
}

#[test]
fn the_ball_of_two_balls_touches_both() {
    let a = BoundingBall { centre: Vector([0.0, 0.0]), radius: 1.0 };
    let b = BoundingBall { centre: Vector([4.0, 0.0]), radius: 2.0 };
    let both = a.union(&b);
    assert_eq!(both.centre, Vector([2.5, 0.0]));
    assert!((both.radius - 3.5).abs() < 1e-14);
    assert_eq!(a.union(&BoundingBall { radius: 0.5, ..a }), a);
}

#[test]
fn normalizing_survives_tiny_and_huge_vectors() {
    for scale in [1e-300, 1.0, 1e300] {
        let v = Vector([3.0 * scale, 4.0 * scale]).normalized().unwrap();
        assert!((v - Vector([0.6, 0.8])).norm() < 1e-15);
    }
    assert_eq!(Vector([0.0, 0.0, 0.0]).normalized(), None);
    assert_eq!(Vector([f64::NAN, 1.0]).normalized(), None);
    assert_eq!(Vector([f64::INFINITY, 1.0]).normalized(), None);
}
