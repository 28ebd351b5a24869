// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rotations, rigid motions and rotation vectors.

use palpate_field::internal::turn_y_towards;
use palpate_field::{Pose, Rotation, Vector};
use palpate_testkit::cases::each as cases;

#[test]
fn a_third_turn_about_the_diagonal_permutes_the_axes() {
    let third = std::f64::consts::TAU / 3.0;
    let turn = Rotation::from_axis_angle(Vector([1.0, 1.0, 1.0]), third).unwrap();
    let image = turn.rotate(Vector([1.0, 2.0, 3.0]));
    assert!((image - Vector([3.0, 1.0, 2.0])).norm() < 1e-15);
}

#[test]
fn quaternions_and_matrices_convert_there_and_back() {
    for q in [
        [0.1, -0.2, 0.3, 0.9],
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 1e-9, 0.0],
        [0.3, 0.3, -0.9, -0.01],
    ] {
        let rotation = Rotation::from_quaternion(q).unwrap();
        let again = Rotation::from_quaternion(rotation.quaternion()).unwrap();
        for i in 0..3 {
            for k in 0..3 {
                assert!((rotation.matrix()[i][k] - again.matrix()[i][k]).abs() < 1e-15);
            }
        }
    }
}

#[test]
fn rows_are_kept_to_the_bit() {
    let turn = Rotation::from_axis_angle(Vector([1.0, 2.0, -0.5]), 0.8).unwrap();
    let turn = turn * turn * turn;
    assert_eq!(Rotation::from_rows(*turn.matrix()), Ok(turn));
    assert!(Rotation::from_rows([[1.0, 0.1], [0.0, 1.0]]).is_err());
}

/// Every rotation is orthonormal up to this: more than the rounding of one product.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The largest deviation of an entry of `R Rᵀ` from the identity.
fn skew<const D: usize>(rotation: &Rotation<D>) -> f64 {
    let rows = rotation.matrix().map(Vector);
    let entries = (0..D).flat_map(|i| (0..=i).map(move |k| (i, k)));
    let off = entries.map(|(i, k)| (rows[i].dot(rows[k]) - f64::from(u8::from(i == k))).abs());
    off.fold(0.0, f64::max)
}

/// Rows that were orthonormal to 1e-6 alone were kept as they were, and rounding grew from
/// product to product: distances of a placed shape were off by that share.
#[test]
fn rotations_are_orthonormal_to_rounding() {
    let rough = Rotation::from_rows([[1.0, 1e-7], [-1e-7, 1.0 + 1e-7]]).unwrap();
    assert!(skew(&rough) <= ROUNDING);
    let step = Rotation::from_axis_angle(Vector([1.0, 2.0, -0.5]), 0.8).unwrap();
    let mut turn = step;
    for _ in 0..10_000 {
        turn = turn * step;
        assert!(skew(&turn) <= ROUNDING);
        let back = turn.inverse();
        assert_eq!(Rotation::from_rows(*back.matrix()), Ok(back));
    }
}

#[test]
fn rows_that_are_no_number_are_refused() {
    assert!(Rotation::from_rows([[f64::NAN, 0.0], [0.0, 1.0]]).is_err());
}

#[test]
fn a_pose_and_its_inverse_cancel() {
    let rotation = Rotation::from_axis_angle(Vector([1.0, 2.0, -0.5]), 0.8).unwrap();
    let pose = Pose::new(rotation, Vector([0.1, -0.2, 0.05]));
    let p = Vector([0.3, 0.7, -1.1]);
    assert!(((pose.inverse() * pose).transform_point(p) - p).norm() < 1e-15);
}

#[test]
fn what_is_not_a_rotation_is_refused() {
    assert!(Rotation::from_matrix([[1.0, 0.1], [0.0, 1.0]]).is_err());
    assert!(Rotation::from_matrix([[1.0, 0.0], [0.0, -1.0]]).is_err());
    assert!(Rotation::from_matrix([[f64::NAN, 0.0], [0.0, 1.0]]).is_err());
    assert!(Rotation::from_quaternion([0.0; 4]).is_err());
    assert!(Rotation::from_axis_angle(Vector([0.0; 3]), 1.0).is_err());
    assert!(Rotation::from_angle(f64::INFINITY).is_err());
}

#[test]
fn a_turn_between_two_rotations_leads_from_one_to_the_other() {
    cases(300, |u| {
        let mut draw = || u.int_in_range(-1000..=1000).map(|x| f64::from(x) * 1e-3);
        let mut vector = || Ok::<_, arbitrary::Error>(Vector([draw()?, draw()?, draw()?]));
        let from = Rotation::<3>::identity().turned(vector()? * 3.0);
        let by = vector()?;
        assert!((from.turn_to(&from.turned(by)) - by).norm() < 1e-14, "{by:?}");
        let flat = Vector([0.0, 0.0, by[2]]);
        let planar = Rotation::<2>::identity().turned(flat);
        assert!((planar.angle() - by[2]).abs() < 1e-15);
        assert!((Rotation::identity().turn_to(&planar) - flat).norm() < 1e-15);
        Ok(())
    });
}

#[test]
fn a_quarter_about_z_takes_x_to_y_and_a_thousand_turns_keep_a_rotation_one() {
    let quarter = Vector([0.0, 0.0, std::f64::consts::FRAC_PI_2]);
    let turned_once = Rotation::<3>::identity().turned(quarter);
    let y = turned_once.rotate(Vector([1.0, 0.0, 0.0]));
    assert!((y - Vector([0.0, 1.0, 0.0])).norm() < 1e-15);
    let mut rotation = turned_once;
    for _ in 0..1000 {
        rotation = rotation.turned([0.3, -0.2, 0.5]);
    }
    let there_and_back = rotation * rotation.inverse();
    assert!(Rotation::identity().turn_to(&there_and_back).norm() < 1e-15);
}

#[test]
fn the_y_axis_turns_to_every_direction() {
    for d in [
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [1.0, 0.0, 0.0],
        [1e-9, -1.0, 0.0],
        [0.3, -0.5, 0.8],
    ] {
        let d = Vector(d).normalized().unwrap();
        let turned = turn_y_towards(d).unwrap().rotate(Vector::unit(1));
        assert!((turned - d).norm() < 1e-15, "{d:?}");
    }
}
