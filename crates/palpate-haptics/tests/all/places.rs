// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where a proxy rests: on creases, in corners, at every scale, never inside.

use crate::common::{
    FollowShape as _, ball, cases, cuboid, half_space, proxy, scaled, stroke, torus, unit,
    vector,
};
use arbitrary::Unstructured;
use palpate_field::{Pose, Rotation, Shape, Vector};

#[test]
fn three_walls_hold_the_proxy_in_their_corner() {
    let walls = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let room = Shape::union(walls.map(|normal| half_space(normal, 0.0))).unwrap();
    for radius in [0.0, 0.002] {
        let mut proxy = proxy(radius);
        let way = (Vector([0.02, 0.02, 0.02]), Vector([-0.0135, -0.01, -0.007]));
        let last = stroke(&mut proxy, &room, way, 3000);
        assert!(last.contact);
        assert!((last.proxy - Vector([radius; 3])).norm() <= 1e-9 * 0.02, "{last:?}");
        assert!(last.evaluations <= 8);
    }
}

#[test]
fn a_skew_crease_holds_the_proxy_on_its_line() {
    // Two boards whose faces make a groove of 120 degrees, neither along an axis.
    let (sin, cos) = 0.3_f64.sin_cos();
    let board = |angle: f64| {
        let turn = Rotation::from_axis_angle(Vector([0.0, 0.0, 1.0]), angle.to_radians() + 0.3);
        let board = cuboid([0.2, 0.1, 0.2]).translated(Vector([0.0, -0.05, 0.0])).unwrap();
        board.rotated(turn.unwrap()).unwrap()
    };
    let groove = Shape::union([board(30.0), board(-30.0)]).unwrap();
    let mut proxy = proxy(0.0);
    let up = Vector([-sin, cos, 0.0]);
    stroke(&mut proxy, &groove, (up * 0.05, up * -0.003), 50);
    for tick in 0..200 {
        let along = Vector([0.0, 0.0, 1e-4 * f64::from(tick)]);
        let last = proxy.follow_shape(&groove, up * -0.003 + along);
        assert!((last.proxy - along).norm() < 1e-7, "{last:?}");
    }
}

#[test]
fn a_vanishing_gradient_keeps_the_last_normal() {
    // A field without slope close to its surface: the cube of a distance, flattened.
    #[derive(Debug)]
    struct Flat(palpate_field::Promise<2>);
    impl palpate_field::CustomField<2> for Flat {
        fn distance(&self, p: palpate_field::Point<2>) -> f64 {
            p[1].clamp(-1.0, 1.0).powi(3)
        }
        fn distance_gradient(&self, p: palpate_field::Point<2>) -> (f64, Vector<f64, 2>) {
            (self.distance(p), Vector([0.0, 3.0 * p[1].clamp(-1.0, 1.0).powi(2)]))
        }
        fn promise(&self) -> &palpate_field::Promise<2> {
            &self.0
        }
    }
    let bounds = ball::<2>(1.0).promise().bounds;
    let flat = Shape::custom(Flat(palpate_field::Promise::lipschitz(bounds, 3.0)));
    let mut proxy = proxy(0.0);
    let last =
        stroke(&mut proxy, &flat, (Vector([0.0, 0.9, 0.0]), Vector([0.3, -0.1, 0.0])), 100);
    assert_eq!(last.normal, Vector([0.0, 1.0, 0.0]));
    assert!(flat.distance(last.proxy.truncated::<2>()) >= -1e-9);
    assert!(last.proxy.is_finite());
}

/// A scene of some bodies about the origin, about 0.2 m wide, at `scale`.
fn scene(u: &mut Unstructured<'_>, scale: f64) -> arbitrary::Result<Shape<3>> {
    let mut bodies = Vec::new();
    for _ in 0..u.int_in_range(1..=4)? {
        let size = (0.02 + 0.04 * unit(u)?.abs()) * scale;
        let body = match u.choose_index(4)? {
            0 => ball(size),
            1 => cuboid([size, 1.5 * size, 2.0 * size]),
            2 => torus(size, 0.4 * size),
            _ => cuboid([2.0 * size; 3]).difference([ball(1.2 * size)]).unwrap(),
        };
        let pose = Pose::new(crate::common::rotation(u)?, vector(u)? * (0.06 * scale));
        bodies.push(body.placed(&pose).unwrap());
    }
    Ok(Shape::union(bodies).unwrap())
}

/// A hand that wanders through a scene at up to 2 m/s.
fn wander(u: &mut Unstructured<'_>, ticks: usize) -> arbitrary::Result<Vec<Vector<f64, 3>>> {
    let mut device = vector(u)? * 0.15;
    let mut velocity: Vector<f64, 3> = vector(u)? * 0.001;
    let mut hand = Vec::new();
    for tick in 0..ticks {
        if tick % 8 == 0 {
            velocity = vector(u)? * 0.001 - device * 0.01;
        }
        device += velocity;
        hand.push(device);
    }
    Ok(hand)
}

#[test]
fn the_proxy_is_never_inside() {
    cases(5000, |u| {
        let shape = scene(u, 1.0)?;
        let size = shape.promise().bounds.unwrap().ball.radius;
        let radius = [0.0, 0.001, 0.004][u.choose_index(3)?];
        let mut proxy = proxy(radius);
        for device in wander(u, 200)? {
            let last = proxy.follow_shape(&shape, device);
            // A hand deep inside a concave body from the start may need another tick.
            if last.contact || last.evaluations == 1 {
                let gap = shape.distance(last.proxy) - radius;
                assert!(gap >= -1e-9 * size, "{gap} at {last:?}");
            }
            assert!(last.evaluations <= proxy.probe().budget());
        }
        Ok(())
    });
}

#[test]
fn no_straight_way_from_a_proxy_at_rest_leads_closer() {
    cases(4000, |u| {
        let shape = scene(u, 1.0)?;
        let radius = [0.0, 0.001, 0.004][u.choose_index(3)?];
        let mut proxy = proxy(radius);
        for device in wander(u, 100)? {
            let mut last = proxy.follow_shape(&shape, device);
            // The hand waits until the proxy has come to rest.
            for _ in 0..20 {
                last = proxy.follow_shape(&shape, device);
            }
            if !last.contact || last.evaluations > 20 {
                continue;
            }
            let stretch = (last.proxy - device).norm();
            for _ in 0..8 {
                let way = vector(u)? * 1e-4;
                let at = |part: f64| last.proxy + way * part;
                // Close to the proxy a thin rim would fit between evenly spaced points.
                let even = (1..=32).map(|i| f64::from(i) / 32.0);
                let mut parts = even.chain((6..40).map(|i| 0.5_f64.powi(i)));
                if parts.all(|part| shape.distance(at(part)) >= radius) {
                    let closer = stretch - (at(1.0) - device).norm();
                    assert!(closer <= 1e-6, "{closer} m closer at {:?} than {last:?}", at(1.0));
                }
            }
        }
        Ok(())
    });
}

#[test]
fn scenes_of_a_micrometre_and_of_a_kilometre_feel_alike() {
    // Powers of two scale every operation exactly, and no tolerance has a length of its own.
    cases(300, |u| {
        let seed: Vec<u8> = (0..4096).map(|_| u.arbitrary()).collect::<Result<_, _>>()?;
        let play = |scale: f64| {
            let u = &mut Unstructured::new(&seed);
            let shape = scene(u, scale)?;
            let radius = 0.002 * scale;
            let mut proxy = proxy(radius);
            let hand = wander(u, 100)?;
            let follow = |device: Vector<f64, 3>| proxy.follow_shape(&shape, device * scale);
            Ok(hand.into_iter().map(follow).collect::<Vec<_>>())
        };
        let reference = play(1.0)?;
        for scale in [1.0 / 1024.0, 1024.0] {
            for (a, b) in play(scale)?.iter().zip(&reference) {
                assert_eq!(a.contact, b.contact);
                assert!((a.proxy * (1.0 / scale) - b.proxy).norm() < 1e-9, "{a:?} {b:?}");
                assert_eq!(a.evaluations, b.evaluations);
            }
        }
        Ok(())
    });
}

#[test]
fn a_field_of_other_slope_holds_the_proxy_on_its_own_level() {
    for factor in [0.5, 2.0] {
        let shape = scaled(&cuboid([0.5, 0.5]), factor, factor.max(1.0));
        let mut proxy = proxy(0.0078125);
        let way = (Vector([0.0625, 0.5, 0.0]), Vector([0.0625, 0.1875, 0.0]));
        let last = stroke(&mut proxy, &shape, way, 64);
        let level = 0.25 + 0.0078125 / factor;
        assert!((last.proxy - Vector([0.0625, level, 0.0])).norm() < 1e-9, "{last:?}");
    }
}
