// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What is wrong in two documents about signed distance functions, shown by numbers.
//!
//! Each test evaluates a formula or a rule as printed, and beside it what is right.
//! `docs/guide/errata.md` has the list. The *article* is "Creating haptics using
//! Signed Distance Functions (SDF)"; its distances are positive inside. The *memoir*
//! is Paul Luneau's "Détections de collisions avec des SDFs".

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use palpate_field::kernel::{
    Ball, Cone, ConeApproximation, CubeApproximation, Cuboid, Cylinder, CylinderApproximation,
    HalfSpace, Pyramid, PyramidApproximation,
};
use palpate_field::{Point, Pose, Promise, Rotation, Shape, ShapeError, Vector};

type Outcome = Result<(), ShapeError>;

/// Far above rounding of numbers near 1, far below every disagreement shown.
const ROUNDING: f64 = 1e-12;

/// How many points are asked.
const POINTS: usize = 4000;

/// Points spread evenly over the box of these half extents: the fractional parts of
/// multiples of powers of 1/g, where g⁴ = g + 1.
fn points(half: [f64; 3]) -> impl Iterator<Item = Point<3>> {
    const G: f64 = 1.220_744_084_605_759_5;
    (1..=POINTS).map(move |i| {
        let part = |axis: i32| (i as f64 / G.powi(axis + 1)).fract();
        Vector([0, 1, 2].map(|axis| half[axis] * (2.0 * part(axis as i32) - 1.0)))
    })
}

fn from_axis(p: Point<3>) -> f64 {
    p.0[0].hypot(p.0[2])
}

/// As printed in the article under the exact cylinder.
fn printed_cylinder(p: Point<3>, radius: f64, height: f64) -> f64 {
    let d = [from_axis(p) - radius, p.0[1].abs() - 0.5 * height];
    d[0].max(d[1]).min(0.0) + d[0].max(0.0).hypot(d[1].max(0.0))
}

/// As printed in the article under the exact cone, with its order of arguments.
fn printed_cone(p: Point<3>, h: f64, r: f64) -> f64 {
    let q = Vector([from_axis(p), p.0[1]]);
    let (k1, k2) = (Vector([0.0, h]), Vector([-r, 2.0 * h]));
    let to_base = if q.0[1] < 0.0 { r } else { 0.0 };
    let ca = Vector([q.0[0] - q.0[0].min(to_base), q.0[1].abs() - h]);
    let along = ((k1 - q).dot(k2) / k2.dot(k2)).clamp(0.0, 1.0);
    let cb = q - k1 + k2 * along;
    let s = if cb.0[0] < 0.0 && ca.0[1] < 0.0 { -1.0 } else { 1.0 };
    s * ca.dot(ca).min(cb.dot(cb)).sqrt()
}

/// As printed in the article under the approximate cone.
fn printed_cone_approximation(p: Point<3>, radius: f64, height: f64) -> f64 {
    (radius * (0.5 - p.0[1] / height) - from_axis(p)).min(height * 0.5 - p.0[1].abs())
}

/// As printed in the article under the pyramid.
fn printed_pyramid_approximation(p: Point<3>, side: f64, height: f64) -> f64 {
    let lateral = side * 0.5 * (0.5 - p.0[1] / height) - p.0[0].abs().max(p.0[2].abs());
    lateral.min(height / 2.0 - p.0[1].abs())
}

// The article.

#[test]
fn the_articles_exact_cylinder_is_negative_inside() -> Outcome {
    let (radius, height) = (0.7, 1.6);
    let exact = Shape::from_kernel(Cylinder::new(radius, height)?);
    assert_eq!(printed_cylinder(Vector::ZERO, radius, height), -0.7);
    for p in points([1.5, 1.7, 1.6]) {
        // It is our distance: right in size, and of the other convention.
        let printed = printed_cylinder(p, radius, height);
        assert!((printed - exact.distance(p)).abs() < ROUNDING, "{printed} at {p:?}");
        let approximate = (radius - from_axis(p)).min(0.5 * height - p.0[1].abs());
        assert!(printed * approximate <= 0.0, "the article's two cylinders agree at {p:?}");
    }
    Ok(())
}

#[test]
fn the_articles_exact_cone_is_negative_inside() -> Outcome {
    let (radius, height) = (0.9, 1.4);
    let exact = Shape::from_kernel(Cone::new(radius, height)?);
    for p in points([1.7, 1.5, 1.8]) {
        let printed = printed_cone(p, 0.5 * height, radius);
        assert!((printed - exact.distance(p)).abs() < ROUNDING, "{printed} at {p:?}");
        let approximate = printed_cone_approximation(p, radius, height);
        assert!(printed * approximate <= 0.0, "the article's two cones agree at {p:?}");
    }
    Ok(())
}

#[test]
fn the_articles_exact_cone_takes_half_the_height_first() -> Outcome {
    let (radius, height) = (0.9, 1.4);
    let exact = Shape::from_kernel(Cone::new(radius, height)?);
    let tip = Vector([0.0, 0.5 * height, 0.0]);
    assert!(exact.distance(tip).abs() < ROUNDING);
    assert_eq!(printed_cone_approximation(tip, radius, height), 0.0);
    // The full height makes a cone twice as tall, whose tip is elsewhere.
    assert!(printed_cone(tip, height, radius) < -0.1);
    assert!(printed_cone(tip * 2.0, height, radius).abs() < ROUNDING);
    // The approximation's order of arguments makes a cone of radius 1.4.
    let rim = Vector([height, -radius, 0.0]);
    assert!(printed_cone(rim, radius, height).abs() < ROUNDING);
    Ok(())
}

/// The share of the points outside `exact` where `value` exceeds the distance.
fn share_above(exact: &Shape<3>, half: [f64; 3], value: impl Fn(Point<3>) -> f64) -> f64 {
    let outside = points(half).filter(|p| exact.distance(*p) > 0.0);
    let (mut count, mut above) = (0, 0);
    for p in outside {
        count += 1;
        above += usize::from(value(p) > exact.distance(p) + ROUNDING);
    }
    above as f64 / f64::from(count)
}

#[test]
fn the_articles_approximate_cone_exceeds_the_distance() -> Outcome {
    let (radius, height) = (0.9, 1.4);
    let exact = Shape::from_kernel(Cone::new(radius, height)?);
    let mended = Shape::from_kernel(ConeApproximation::new(radius, height)?);
    let printed = |p| -printed_cone_approximation(p, radius, height);

    // Half a metre straight out of the side the value grows by 1.189 times as much.
    let slant = radius.hypot(height);
    let from = Vector([1.0, 0.0, 0.0]);
    let out = Vector([height / slant, radius / slant, 0.0]);
    let slope = (printed(from + out * 0.5) - printed(from)) / 0.5;
    assert!((slope - (1.0 + (radius / height).powi(2)).sqrt()).abs() < ROUNDING);
    assert!((slope - 1.189).abs() < 5e-4);

    let half = [1.8, 1.4, 1.8];
    let share = share_above(&exact, half, printed);
    assert!((0.5..0.8).contains(&share), "{share} of the points outside");
    assert_eq!(share_above(&exact, half, |p| mended.distance(p)), 0.0);
    Ok(())
}

#[test]
fn the_articles_pyramid_exceeds_the_distance() -> Outcome {
    let (side, height) = (1.2, 1.4);
    let exact = Shape::from_kernel(Pyramid::new(side, height)?);
    let mended = Shape::from_kernel(PyramidApproximation::new(side, height)?);
    let printed = |p| -printed_pyramid_approximation(p, side, height);

    let slant = height.hypot(0.5 * side);
    let from = Vector([1.0, 0.0, 0.1]);
    let out = Vector([height / slant, 0.5 * side / slant, 0.0]);
    let slope = (printed(from + out * 0.5) - printed(from)) / 0.5;
    assert!((slope - slant / height).abs() < ROUNDING);
    assert!((slope - 1.088).abs() < 5e-4);

    let half = [1.2, 1.4, 1.2];
    let share = share_above(&exact, half, printed);
    assert!(share > 0.2, "{share} of the points outside");
    assert_eq!(share_above(&exact, half, |p| mended.distance(p)), 0.0);
    Ok(())
}

/// Cube and cylinder are as the article says: the surface is right, outside past the
/// edges the values fall short.
#[test]
fn the_articles_cube_and_cylinder_are_exact_inside_and_bounds_outside() -> Outcome {
    let cube = Shape::from_kernel(Cuboid::new(Vector([1.2, 1.2, 1.2]))?);
    let cylinder = Shape::from_kernel(Cylinder::new(0.6, 1.4)?);
    let pairs = [
        (cube, Shape::from_kernel(CubeApproximation::new(1.2)?)),
        (cylinder, Shape::from_kernel(CylinderApproximation::new(0.6, 1.4)?)),
    ];
    for (exact, approximate) in pairs {
        let mut smallest: f64 = 1.0;
        for p in points([1.6, 1.7, 1.5]) {
            let (true_distance, value) = (exact.distance(p), approximate.distance(p));
            if true_distance <= 0.0 {
                assert!((value - true_distance).abs() < ROUNDING, "at {p:?}");
            } else {
                assert!(0.0 < value && value <= true_distance + ROUNDING, "at {p:?}");
                smallest = smallest.min(value / true_distance);
            }
        }
        assert!(smallest < 0.9, "no point is past an edge: {smallest}");
    }
    Ok(())
}

#[test]
fn a_scaled_distance_must_be_scaled_back() -> Outcome {
    let unit = Shape::<3>::from_kernel(Ball::new(1.0)?);
    // The article's local point, and the field asked there.
    let printed = |p: Point<3>, s: [f64; 3]| {
        unit.distance(Vector([p.0[0] / s[0], p.0[1] / s[1], p.0[2] / s[2]]))
    };
    let p = Vector([3.0, 2.0, 6.0]); // 7 from the origin, 5 from a ball of radius 2
    assert_eq!(printed(p, [2.0; 3]), 2.5);
    assert_eq!(unit.clone().scaled(2.0)?.distance(p), 5.0);
    // A scale below one makes it exceed the distance, which is 6.5.
    assert_eq!(printed(p, [0.5; 3]), 13.0);
    assert_eq!(unit.clone().scaled(0.5)?.distance(p), 6.5);

    // Scales by axes: (0, 0, 3) is 1 from the ellipsoid's tip at 2, which is far
    // more than the value; (2, 0, 0) is 1.5 from the one at 0.5, which is far less.
    let factors = [0.5, 1.0, 2.0];
    let bound = unit.clone().stretched(factors)?;
    assert_eq!(printed(Vector([0.0, 0.0, 3.0]), factors), 0.5);
    assert_eq!(printed(Vector([2.0, 0.0, 0.0]), factors), 3.0);
    assert_eq!(bound.distance(Vector([2.0, 0.0, 0.0])), 1.5);
    assert_eq!(bound.distance(Vector([0.0, 0.0, 3.0])), 0.25); // the smallest factor
    Ok(())
}

#[test]
fn the_gradient_under_a_scale_by_axes_is_divided_by_the_factors() -> Outcome {
    let unit = Shape::<3>::from_kernel(Ball::new(1.0)?);
    let factors = [0.5, 1.0, 2.0];
    let turn = Rotation::from_axis_angle(Vector([1.0, 2.0, 2.0]), 0.7)?;
    let world_from_body = Pose::new(turn, Vector([0.3, -0.2, 0.1]));
    let shape = unit.clone().stretched(factors)?.placed(&world_from_body)?;

    let p = Vector([1.0, 1.5, 2.0]);
    let body = world_from_body.inverse().transform_point(p);
    let local = Vector([0, 1, 2].map(|i| body.0[i] / factors[i]));
    let at_local = unit.distance_gradient(local).1;
    let turned_only = world_from_body.transform_vector(at_local);
    let divided = Vector([0, 1, 2].map(|i| at_local.0[i] / factors[i]));
    let right = world_from_body.transform_vector(divided) * 0.5; // the smallest factor

    let gradient = shape.distance_gradient(p).1;
    assert!((gradient - right).norm() < ROUNDING);
    let cosine = gradient.dot(turned_only) / (gradient.norm() * turned_only.norm());
    assert!(cosine < 0.95, "the gradient is only turned: {cosine}");
    Ok(())
}

#[test]
fn the_articles_difference_is_the_second_without_the_first() -> Outcome {
    let a = Shape::<2>::from_kernel(Ball::new(1.0)?);
    let b = a.clone().translated(Vector([1.0, 0.0]))?;
    let printed = |p: Point<2>| (a.distance(p)).min(-b.distance(p)); // min(−a, b), a = −f
    let (in_a, in_b) = (Vector([-0.5, 0.0]), Vector([1.5, 0.0]));
    let without = a.clone().difference([b.clone()])?;
    assert!(printed(in_a) < 0.0 && printed(in_b) > 0.0); // positive inside
    assert!(without.distance(in_a) < 0.0 && without.distance(in_b) > 0.0); // negative
    let swapped = b.clone().difference([a.clone()])?;
    assert_eq!(printed(in_b), -swapped.distance(in_b));
    Ok(())
}

#[test]
fn a_union_is_exact_only_outside() -> Outcome {
    // Two squares of 2 m side by side make a rectangle of 4 m by 2 m.
    let square = Shape::from_kernel(Cuboid::new(Vector([2.0, 2.0]))?);
    let left = square.clone().translated(Vector([-1.0, 0.0]))?;
    let right = square.translated(Vector([1.0, 0.0]))?;
    let union = Shape::union([left, right])?;
    let whole = Shape::from_kernel(Cuboid::new(Vector([4.0, 2.0]))?);
    assert_eq!(union.distance(Vector::ZERO), 0.0); // on no surface
    assert_eq!(whole.distance(Vector::ZERO), -1.0);
    let outside = Vector([3.0, 2.0]);
    assert_eq!(union.distance(outside), whole.distance(outside));
    Ok(())
}

#[test]
fn an_intersection_is_exact_only_inside() -> Outcome {
    let right = Shape::from_kernel(HalfSpace::new(Vector([1.0, 0.0]), 0.0)?);
    let top = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0]), 0.0)?);
    let quadrant = Shape::intersection([right, top])?;
    assert_eq!(quadrant.distance(Vector([3.0, 4.0])), 4.0); // truly 5, from the corner
    assert_eq!(quadrant.distance(Vector([-3.0, -4.0])), -3.0);
    Ok(())
}

#[test]
fn a_tree_costs_an_evaluation_a_leaf() -> Outcome {
    let count = Arc::new(AtomicUsize::new(0));
    let leaves = (0..37).map(|_| {
        let count = Arc::clone(&count);
        Shape::<2>::from_fn(Promise::lipschitz(None, 1.0), move |p| {
            count.fetch_add(1, Ordering::Relaxed);
            p.norm()
        })
    });
    let _ = Shape::intersection(leaves)?.distance_gradient(Vector([1.0, 2.0]));
    assert_eq!(count.load(Ordering::Relaxed), 37);
    Ok(())
}

/// Between the conventions every value is negated, and so minimum and maximum change
/// places.
#[test]
fn a_union_is_a_maximum_of_distances_positive_inside() -> Outcome {
    let a = Shape::from_kernel(Cuboid::new(Vector([1.0, 1.2, 1.4]))?);
    let b = Shape::from_kernel(Ball::new(0.7)?).translated(Vector([0.4, 0.3, 0.0]))?;
    let union = Shape::union([a.clone(), b.clone()])?;
    let intersection = Shape::intersection([a.clone(), b.clone()])?;
    for p in points([1.5, 1.4, 1.3]) {
        let (positive_a, positive_b) = (-a.distance(p), -b.distance(p));
        assert_eq!(positive_a.max(positive_b), -union.distance(p));
        assert_eq!(positive_a.min(positive_b), -intersection.distance(p));
    }
    Ok(())
}

// The memoir.

#[test]
fn the_memoirs_circle_lacks_its_radius() -> Outcome {
    let (centre, radius) = (Vector([0.4, -0.3]), 0.5);
    let disc = Shape::from_kernel(Ball::new(radius)?).translated(centre)?;
    let printed = |p: Point<2>| (p - centre).norm();
    let rim = centre + Vector([0.3, 0.4]);
    assert!((printed(rim) - 0.5).abs() < ROUNDING); // on the circle, and not zero
    assert!(disc.distance(rim).abs() < ROUNDING);
    assert_eq!(printed(centre), 0.0); // nowhere negative
    assert_eq!(disc.distance(centre), -0.5);
    Ok(())
}

#[test]
fn a_gradient_is_of_length_one_only_almost_everywhere_and_of_exact_fields() -> Outcome {
    // Across the diagonal of a square, where two sides are equally near, it jumps.
    let square = Shape::from_kernel(Cuboid::new(Vector([2.0, 2.0]))?);
    let before = square.distance_gradient(Vector([0.5, 0.5 - 1e-9])).1;
    let after = square.distance_gradient(Vector([0.5, 0.5 + 1e-9])).1;
    assert_eq!((before, after), (Vector([1.0, 0.0]), Vector([0.0, 1.0])));
    // A bound is flatter.
    let ellipse = Shape::<2>::from_kernel(Ball::new(1.0)?).stretched([1.0, 4.0])?;
    assert_eq!(ellipse.distance_gradient(Vector([0.0, 6.0])).1, Vector([0.0, 0.25]));
    Ok(())
}

#[test]
fn the_length_of_the_closest_vector_has_no_sign() -> Outcome {
    let disc = Shape::<2>::from_kernel(Ball::new(1.0)?);
    let closest_vector = |p: Point<2>| p * (1.0 / p.norm()) - p;
    for (p, is_outside) in [(Vector([1.2, 1.6]), true), (Vector([0.3, 0.4]), false)] {
        let g = closest_vector(p);
        let (distance, gradient) = disc.distance_gradient(p);
        let sign = if is_outside { 1.0 } else { -1.0 };
        assert!((distance - sign * g.norm()).abs() < ROUNDING);
        // The memoir's −g/|g|, right outside and opposite inside.
        let printed = -g * (1.0 / g.norm());
        assert!((gradient - printed * sign).norm() < ROUNDING);
        assert_eq!(gradient.dot(printed) > 0.0, is_outside);
        assert_eq!((distance - g.norm()).abs() < ROUNDING, is_outside);
    }
    Ok(())
}

/// The points of a segment that are nearest to `p`.
fn onto_segment(p: Point<2>, from: Point<2>, to: Point<2>) -> Point<2> {
    let along = to - from;
    from + along * ((p - from).dot(along) / along.dot(along)).clamp(0.0, 1.0)
}

#[test]
fn stopping_on_the_gradients_length_never_fires() -> Outcome {
    let disc = Shape::from_kernel(Ball::new(1.0)?);
    // The edge of a triangle that passes above the disc; its lowest value is at x = 0.
    let (from, to) = (Vector([-2.0, 1.5]), Vector([3.0, 1.5]));
    let mut p = to;
    for _ in 0..200 {
        let gradient = disc.distance_gradient(p).1;
        assert!((gradient.norm() - 1.0).abs() < ROUNDING, "the memoir's rule fires");
        p = onto_segment(p - gradient * 0.5, from, to);
    }
    let gradient = disc.distance_gradient(p).1;
    let projected_step = onto_segment(p - gradient * 0.5, from, to) - p;
    assert!(projected_step.norm() < 1e-9, "{projected_step:?}");
    // The gap that the Frank-Wolfe method stops on: over the farther end.
    let gap = [from, to].map(|end| gradient.dot(p - end)).into_iter().fold(0.0, f64::max);
    assert!(gap < 1e-9, "{gap}");
    assert!((disc.distance(p) - 0.5).abs() < ROUNDING);
    Ok(())
}

#[test]
fn barycentric_coordinates_are_of_the_third_corner() {
    let [a, b, c] = [Vector([0.0, 0.0]), Vector([4.0, 1.0]), Vector([1.0, 3.0])];
    let weighted = |[u, v, w]: [f64; 3], third: Point<2>| a * u + b * v + third * w;
    assert_eq!(weighted([0.0, 0.0, 1.0], c), c);
    // The point that the memoir starts from: the mean of the corners.
    let mean = weighted([1.0 / 3.0; 3], c);
    assert!((mean - Vector([5.0, 4.0]) * (1.0 / 3.0)).norm() < ROUNDING);
    // Its r is no corner; whatever other point it is, the third corner is missed.
    let r = Vector([5.0, 5.0]);
    assert_eq!(weighted([0.0, 0.0, 1.0], r), r);
}

#[test]
fn a_step_multiplied_by_the_value_stops_at_the_surface() -> Outcome {
    let disc = Shape::from_kernel(Ball::new(200.0)?);
    let mut p = Vector([-350.0, 170.0]);
    for _ in 0..1000 {
        let (value, gradient) = disc.distance_gradient(p);
        p -= gradient * (0.1 * value);
        assert!(disc.distance(p) > -ROUNDING * 200.0, "it got inside");
    }
    assert!(disc.distance(p) < 1e-9); // and its deepest point is at −200
    Ok(())
}

/// As the memoir's program has it: µ = 100 and a rate of 0.1, in pixels.
#[test]
fn a_step_of_at_least_a_constant_does_not_converge() -> Outcome {
    let disc = Shape::from_kernel(Ball::new(200.0)?);
    let mut p = Vector([-350.0, 171.0]);
    let mut last_values = Vec::new();
    for step in 0..1000 {
        let (value, gradient) = disc.distance_gradient(p);
        let next = p - gradient * (0.1 * value.max(100.0));
        assert!((next - p).norm() > 9.999, "it converges at step {step}");
        p = next;
        if step >= 990 {
            last_values.push(disc.distance(p));
        }
    }
    let deepest = last_values.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = last_values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    assert!(highest - deepest > 1.0, "between {deepest} and {highest}");

    // Golden sections of the line do.
    let direction = disc.distance_gradient(Vector([-350.0, 171.0])).1;
    let at = |t: f64| disc.distance(Vector([-350.0, 171.0]) - direction * t);
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = (0.0, 800.0);
    for _ in 0..64 {
        let (left, right) = (high - ratio * (high - low), low + ratio * (high - low));
        if at(left) < at(right) { high = right } else { low = left }
    }
    assert!((at(0.5 * (low + high)) + 200.0).abs() < 1e-9);
    Ok(())
}

#[test]
fn a_slivers_circumscribed_circle_excludes_nothing() -> Outcome {
    let [a, b, c] = [Vector([0.0, 0.0]), Vector([1.0, 0.0]), Vector([0.5, 0.01])];
    let lengths = [(a - b).norm(), (b - c).norm(), (c - a).norm()];
    let area = 0.5 * ((b - a).0[0] * (c - a).0[1] - (b - a).0[1] * (c - a).0[0]);
    let radius = lengths.iter().product::<f64>() / (4.0 * area);
    assert!((radius - 12.505).abs() < 1e-3, "{radius}");
    let centre = Vector([0.5, 0.01 - radius]);
    for corner in [a, b, c] {
        assert!(((corner - centre).norm() - radius).abs() < 1e-9);
    }
    // The smallest circle about an obtuse triangle has its longest edge for diameter.
    let (middle, half) = ((a + b) * 0.5, 0.5);
    assert!((c - middle).norm() < half);

    let disc = Shape::from_kernel(Ball::new(1.0)?).translated(Vector([0.0, -6.0]))?;
    assert!(disc.distance(centre) <= radius, "the circumscribed circle is clear");
    assert!(disc.distance(middle) > half, "the smallest circle is not clear");
    Ok(())
}

/// f(C) < r is a hit only of exact fields; of a bound it says nothing, while f(C) > r
/// says that there is none.
#[test]
fn a_ball_may_miss_a_bound_that_is_nearer_than_its_radius() -> Outcome {
    let exact = Shape::from_kernel(Cuboid::new(Vector([2.0; 3]))?);
    let bound = Shape::from_kernel(CubeApproximation::new(2.0)?);
    let (centre, radius) = (Vector([4.0, 5.0, 0.0]), 4.5);
    assert!(bound.distance(centre) < radius);
    assert!(exact.distance(centre) > radius);
    Ok(())
}

#[test]
fn a_bound_is_not_reached_in_one_step() -> Outcome {
    let bound = Shape::from_kernel(CubeApproximation::new(2.0)?);
    let step = |p: Point<3>| {
        let (value, gradient) = bound.distance_gradient(p);
        p - gradient * value
    };
    let first = step(Vector([4.0, 5.0, 0.0]));
    assert_eq!(bound.distance(first), 3.0);
    assert_eq!(bound.distance(step(first)), 0.0);
    assert!(bound.surface_point(Vector([4.0, 5.0, 0.0])).is_some());
    Ok(())
}

#[test]
fn a_constant_step_oscillates_across_a_ridge() -> Outcome {
    // A wedge, its tip up at the origin; and what lies above y = 0.5.
    let faces = [Vector([0.6, 0.8]), Vector([-0.6, 0.8])];
    let [right, left] = faces.map(|normal| HalfSpace::new(normal, 0.0));
    let wedge = Shape::intersection([Shape::from_kernel(right?), Shape::from_kernel(left?)])?;
    let above = Shape::from_kernel(HalfSpace::new(Vector([0.0, -1.0]), -0.5)?);
    let rate = 0.1;
    let mut p = Vector([0.37, 2.0]);
    let mut smallest_move = f64::INFINITY;
    for _ in 0..1000 {
        let mut next = p - wedge.distance_gradient(p).1 * rate;
        let (value, gradient) = above.distance_gradient(next);
        if value > 0.0 {
            next -= gradient * value;
        }
        smallest_move = smallest_move.min((next - p).norm());
        p = next;
    }
    // The nearest pair is found at x = 0, y = 0.5; the rule |ΔP| < ε never says so.
    assert!((smallest_move - 0.06).abs() < 1e-9, "{smallest_move}");
    assert!(p.0[0].abs() <= 0.06 && (p.0[1] - 0.5).abs() < ROUNDING);
    Ok(())
}

#[test]
fn bodies_that_touch_have_no_point_inside_both() -> Outcome {
    let a = Shape::<2>::from_kernel(Ball::new(1.0)?);
    let b = a.clone().translated(Vector([2.0, 0.0]))?;
    let touch = Vector([1.0, 0.0]);
    let values = [a.distance(touch), b.distance(touch)];
    assert!(values.iter().all(|f| *f <= 0.0)); // as the memoir defines a hit
    assert!(!values.iter().all(|f| *f < 0.0)); // as its loop looks for one
    Ok(())
}

#[test]
fn a_point_inside_both_is_no_depth() -> Outcome {
    let a = Shape::<2>::from_kernel(Ball::new(1.0)?);
    let b = a.clone().translated(Vector([1.5, 0.0]))?;
    // Where the memoir's loop may stop: inside both, by almost nothing.
    let p = Vector([0.501, 0.0]);
    assert!(a.distance(p) < 0.0 && b.distance(p) < 0.0);
    assert!((b.distance(p) + 0.001).abs() < ROUNDING);
    // b must move by 0.5 until they only touch: twice the depth of the deepest point.
    let both = Shape::intersection([a, b])?;
    assert!((both.distance(Vector([0.75, 0.0])) + 0.25).abs() < ROUNDING);
    Ok(())
}
