// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Mass properties against closed forms: the truth is within the errors, and the errors
//! are within the tolerance.

use std::f64::consts::PI;

use palpate_field::kernel::{
    Ball, Cone, Cuboid, Cylinder, Ellipsoid, HalfSpace, Polygon, Segment, Simplex, Torus,
};
use palpate_field::operator::Profile;
use palpate_field::{Mass, MassLimits, Point, Pose, Rotation, Shape, ShapeError, Vector};

const TOLERANCE: f64 = 2e-3;

fn mass<const D: usize>(shape: &Shape<D>, density: f64) -> Mass<D> {
    let limits = MassLimits { tolerance: TOLERANCE, ..MassLimits::default() };
    shape.mass(density, limits).expect("a mass")
}

/// Checks volume, centroid and the trace of the second moments, at a density of 2.
fn check<const D: usize>(name: &str, shape: &Shape<D>, volume: f64, at: Point<D>, trace: f64) {
    let mass = mass(shape, 2.0);
    assert!((mass.volume - volume).abs() <= mass.volume_error, "{name}: {mass:?}, {volume}");
    assert!(mass.volume_error <= TOLERANCE * volume, "{name}: {mass:?}");
    for i in 0..D {
        let error = (mass.centroid[i] - at[i]).abs();
        assert!(error <= mass.centroid_error, "{name}: {mass:?}, {at:?}");
    }
    let size = shape.promise().bounds.expect("bounds").ball.radius;
    assert!(mass.centroid_error <= 4.0 * TOLERANCE * size, "{name}: {mass:?}");
    let error = (mass.polar_inertia() - 2.0 * trace).abs();
    assert!(error <= D as f64 * mass.second_moments_error, "{name}: {mass:?}, {trace}");
    assert!(
        mass.second_moments_error <= 20.0 * TOLERANCE * 2.0 * volume * size * size,
        "{name}: {mass:?}"
    );
    assert_eq!(mass.mass(), 2.0 * mass.volume);
}

#[test]
fn solids() -> Result<(), ShapeError> {
    let zero = Vector::ZERO;
    let ball = Shape::<3>::from_kernel(Ball::new(0.5)?);
    let volume = PI / 6.0;
    // ∫ r² = 3/5 r² V.
    check("ball", &ball, volume, zero, 0.15 * volume);

    let size = Vector([0.2, 0.4, 0.6]);
    let turn = Rotation::from_axis_angle(Vector([1.0, 2.0, 3.0]), 0.7)?;
    let at = Vector([3.0, -1.0, 0.5]);
    let cuboid = Shape::from_kernel(Cuboid::new(size)?).placed(&Pose::new(turn, at))?;
    check("cuboid", &cuboid, 0.048, at, 0.048 * size.dot(size) / 12.0);

    let (r, h) = (0.3, 0.8);
    let cylinder = Shape::from_kernel(Cylinder::new(r, h)?);
    let volume = PI * r * r * h;
    check("cylinder", &cylinder, volume, zero, volume * (0.5 * r * r + h * h / 12.0));

    // Its centroid is a quarter of the height above the base, its base at −h/2.
    let cone = Shape::from_kernel(Cone::new(r, h)?);
    let volume = PI * r * r * h / 3.0;
    let trace = volume * (0.3 * r * r + 3.0 / 80.0 * h * h);
    check("cone", &cone, volume, Vector([0.0, -0.25 * h, 0.0]), trace);

    let (ring, tube) = (0.4, 0.1);
    let torus = Shape::from_kernel(Torus::new(ring, tube)?);
    let volume = 2.0 * PI * PI * ring * tube * tube;
    let trace = volume * (ring * ring + 0.75 * tube * tube + 0.25 * tube * tube);
    check("torus", &torus, volume, zero, trace);

    let radii = Vector([0.2, 0.3, 0.5]);
    let ellipsoid = Shape::from_kernel(Ellipsoid::new(radii)?);
    let volume = 4.0 / 3.0 * PI * 0.03;
    check("ellipsoid", &ellipsoid, volume, zero, volume * radii.dot(radii) / 5.0);

    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let tetrahedron = Shape::from_kernel(Simplex::<3>::new(corners.map(Vector).to_vec())?);
    // ∫ x² = 1/60 for each axis, about the corner.
    let trace = 3.0 * (1.0 / 60.0 - 1.0 / 6.0 / 16.0);
    check("tetrahedron", &tetrahedron, 1.0 / 6.0, Vector([0.25; 3]), trace);
    Ok(())
}

#[test]
fn plates() -> Result<(), ShapeError> {
    let disc = Shape::<2>::from_kernel(Ball::new(0.5)?).translated(Vector([10.0, 0.0]))?;
    let area = PI * 0.25;
    check("disc", &disc, area, Vector([10.0, 0.0]), area * 0.125);

    let square = |half: f64| {
        [[-half, -half], [half, -half], [half, half], [-half, half]].map(Vector).to_vec()
    };
    let frame = Shape::from_kernel(Polygon::new(vec![square(0.5), square(0.3)])?);
    let trace = (1.0 - 0.6_f64.powi(4)) / 6.0;
    check("frame", &frame, 1.0 - 0.36, Vector::ZERO, trace);
    Ok(())
}

#[test]
fn booleans() -> Result<(), ShapeError> {
    let block = Shape::from_kernel(Cuboid::new(Vector([1.0, 1.0, 1.0]))?);
    let hole = Shape::from_kernel(Cylinder::new(0.3, 2.0)?);
    let drilled = block.difference([hole])?;
    let (cube, bore) = (1.0, PI * 0.09);
    let trace = 0.25 * cube - bore * (0.5 * 0.09 + 1.0 / 12.0);
    check("drilled block", &drilled, cube - bore, Vector::ZERO, trace);

    let halves = [0.5, -0.5].map(|x| {
        Shape::<3>::from_kernel(Ball::new(0.3).unwrap()).translated(Vector([x, 0.0, 0.0]))
    });
    let [left, right] = halves;
    let pair = Shape::union([left?, right?])?;
    let volume = 8.0 / 3.0 * PI * 0.027;
    check("pair", &pair, volume, Vector::ZERO, volume * (0.25 + 0.6 * 0.09));
    Ok(())
}

/// What is not exact is enclosed too: here between the balls that it lies between.
#[test]
fn bounds_are_enough() -> Result<(), ShapeError> {
    let balls = [-0.1, 0.1].map(|x| {
        Shape::<3>::from_kernel(Ball::new(0.3).unwrap()).translated(Vector([x, 0.0, 0.0]))
    });
    let [a, b] = balls;
    let (a, b) = (a?, b?);
    let sharp = mass(&Shape::union([a.clone(), b.clone()])?, 1.0);
    let smooth = mass(&Shape::smooth_union([a, b], Profile::Cubic, 0.02)?, 1.0);
    assert!(smooth.volume - smooth.volume_error > sharp.volume + sharp.volume_error);
    assert!(smooth.volume < 4.0 / 3.0 * PI * 0.45_f64.powi(3));
    Ok(())
}

#[test]
fn an_empty_shape_weighs_nothing_and_is_proven_to() -> Result<(), ShapeError> {
    let empty = Shape::sphere(0.2)? - Shape::sphere(0.3)?;
    let nothing = mass(&empty, 1.0);
    assert!(nothing.is_zero());
    assert_eq!((nothing.second_moments_error, nothing.polar_inertia()), (0.0, 0.0));
    assert_eq!(nothing.centroid_error, f64::INFINITY);
    assert!(!mass(&Shape::sphere(0.2)?, 1.0).is_zero());
    Ok(())
}

/// A ball of 1 cm at 1e15 m was proven to be empty: its box has no volume there, and its field
/// rounds to whole decimetres.
#[test]
fn what_is_smaller_than_rounding_is_not_proven_to_be_empty() -> Result<(), ShapeError> {
    let limits = MassLimits { cells: 10_000, ..MassLimits::default() };
    let ball = Shape::sphere(0.01)?;
    for far in [1e9, 1e12, 1e15] {
        let mass = ball.clone().translated(Vector([far, -far, 0.0]))?.mass(1.0, limits)?;
        assert!(!mass.is_zero(), "{far}: {mass:?}");
        let error = (mass.volume - 4e-6 / 3.0 * PI).abs();
        assert!(error <= mass.volume_error, "{far}: {mass:?}");
    }
    Ok(())
}

#[test]
fn a_curve_weighs_nothing() -> Result<(), ShapeError> {
    let curve = Segment::<2>::new(Vector([0.0, 0.0]), Vector([1.0, 0.5]), 0.0)?;
    let limits = MassLimits { tolerance: 1e-3, cells: 20_000 };
    let mass = Shape::from_kernel(curve).mass(1.0, limits)?;
    assert!(mass.volume <= mass.volume_error && mass.volume_error < 0.01, "{mass:?}");
    assert!(mass.centroid_error.is_infinite());
    assert!(mass.cells <= limits.cells);
    Ok(())
}

#[test]
fn what_has_no_bounds_has_no_mass() -> Result<(), ShapeError> {
    let half_space = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0, 0.0]), 0.0)?);
    let error = half_space.mass(1.0, MassLimits::default()).unwrap_err();
    assert_eq!(error.to_string(), "mass needs a shape with bounds");
    let ball = Shape::<3>::from_kernel(Ball::new(0.5)?);
    assert!(ball.mass(-1.0, MassLimits::default()).is_err());
    let limits = MassLimits { tolerance: f64::NAN, cells: 10 };
    assert!(ball.mass(1.0, limits).is_err());
    Ok(())
}

#[test]
fn the_inertia_of_a_ball_is_two_fifths() -> Result<(), ShapeError> {
    let ball = mass(&Shape::<3>::from_kernel(Ball::new(0.5)?), 1000.0);
    let expected = 0.4 * ball.mass() * 0.25;
    let inertia = ball.inertia();
    for (i, row) in inertia.iter().enumerate() {
        for (k, value) in row.iter().enumerate() {
            let expected = if i == k { expected } else { 0.0 };
            assert!((value - expected).abs() <= 3.0 * ball.second_moments_error);
        }
    }
    Ok(())
}

/// Second moments by axis, and products between axes: those of a cuboid that is turned are
/// `R diag(V aᵢ²/12) Rᵀ`, about its centre.
#[test]
fn the_second_moments_of_a_turned_cuboid_turn_with_it() -> Result<(), ShapeError> {
    let size = [0.4, 0.7, 1.1];
    let turn = Rotation::from_axis_angle(Vector([1.0, -2.0, 0.5]), 0.7)?;
    let cuboid = Shape::from_kernel(Cuboid::new(Vector(size))?).rotated(turn)?;
    let mass = mass(&cuboid, 3.0);
    let volume: f64 = size.iter().product();
    let rows = turn.matrix();
    for i in 0..3 {
        for k in 0..3 {
            let of = |axis: usize| rows[i][axis] * rows[k][axis] * size[axis] * size[axis];
            let expected = 3.0 * volume * (of(0) + of(1) + of(2)) / 12.0;
            let error = (mass.second_moments[i][k] - expected).abs();
            assert!(error <= mass.second_moments_error, "{i} {k}: {mass:?}, {expected}");
        }
    }
    // The error that is allowed tells them apart.
    assert!(mass.second_moments_error < 0.05 * mass.second_moments[0][0], "{mass:?}");
    Ok(())
}

/// Faces along the axes, or nearly: the closed form of a cell that such a face cuts divides by slopes that nearly
/// vanish. Its terms cancelled, and second moments were off by four times their error.
#[test]
fn the_moments_of_cuboids_along_the_axes_are_within_their_errors() -> Result<(), ShapeError> {
    for (size, angle) in [
        ([0.1, 0.2, 0.3], 0.0),
        ([0.1, 0.2, 0.3], 1e-7),
        ([0.3, 0.2, 0.1], 1e-4),
        ([0.5, 0.1, 0.4], 3e-3),
        ([0.2, 0.3, 0.7], 1.1e-2),
        ([0.2, 0.2, 0.2], 5e-2),
    ] {
        let turn = Rotation::from_axis_angle(Vector([1.0, 0.3, -0.5]), angle)?;
        let cuboid = Shape::from_kernel(Cuboid::new(Vector(size))?).rotated(turn)?;
        let (rows, volume) = (turn.matrix(), size.iter().product::<f64>());
        for tolerance in [1e-2, 1e-3, 1e-4] {
            let mass =
                cuboid.mass(1000.0, MassLimits { tolerance, ..MassLimits::default() })?;
            assert!((mass.volume - volume).abs() <= mass.volume_error, "{mass:?}");
            for i in 0..3 {
                assert!(mass.centroid[i].abs() <= mass.centroid_error, "{angle}: {mass:?}");
                for k in 0..3 {
                    let of = |axis: usize| rows[i][axis] * rows[k][axis] * size[axis].powi(2);
                    let expected = 1000.0 * volume * (of(0) + of(1) + of(2)) / 12.0;
                    let error = (mass.second_moments[i][k] - expected).abs();
                    assert!(
                        error <= mass.second_moments_error,
                        "{size:?} by {angle}, {i} {k}: {mass:?}, {expected}"
                    );
                }
            }
        }
    }
    Ok(())
}

#[test]
fn the_moments_of_a_rectangle_along_the_axes_are_within_their_errors() -> Result<(), ShapeError>
{
    let rectangle = Shape::rectangle([0.2, 0.5])?.translated([3.0, -1.0])?;
    for tolerance in [1e-2, 1e-3, 1e-5] {
        let mass = rectangle.mass(1.0, MassLimits { tolerance, ..MassLimits::default() })?;
        for (i, size) in [0.2_f64, 0.5].into_iter().enumerate() {
            let error = (mass.second_moments[i][i] - 0.1 * size * size / 12.0).abs();
            assert!(error <= mass.second_moments_error, "{mass:?}");
        }
        assert!(mass.second_moments[0][1].abs() <= mass.second_moments_error, "{mass:?}");
    }
    Ok(())
}
