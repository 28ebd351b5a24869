// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Conversions from and to glam, mint and serde.

use palpate_field::{Pose, Promise, Rotation, Shape, Vector};

#[test]
fn poses_and_promises_are_read_back_to_the_bit() -> Result<(), Box<dyn std::error::Error>> {
    let turn = Rotation::from_axis_angle(Vector([1.0, 2.0, -0.5]), 0.8)?;
    let pose = Pose::new(turn * turn, Vector([0.1, 0.2, 0.3]));
    let text = serde_json::to_string(&pose)?;
    assert_eq!(serde_json::from_str::<Pose<3>>(&text)?, pose);
    let promise = *Shape::torus(0.5, 0.1)?.placed(&pose)?.promise();
    let text = serde_json::to_string(&promise)?;
    assert_eq!(serde_json::from_str::<Promise<3>>(&text)?, promise);
    Ok(())
}

#[test]
fn a_vector_is_a_list_of_its_components() -> Result<(), serde_json::Error> {
    assert_eq!(serde_json::to_string(&Vector([0.5, -2.0]))?, "[0.5,-2.0]");
    assert!(serde_json::from_str::<Vector<f64, 2>>("[1.0]").is_err());
    assert!(serde_json::from_str::<Vector<f64, 2>>("[1.0,2.0,3.0]").is_err());
    Ok(())
}

#[test]
fn what_is_no_rotation_is_not_read() {
    assert!(serde_json::from_str::<Rotation<2>>("[[1.0,0.0],[0.0,1.0]]").is_ok());
    assert!(serde_json::from_str::<Rotation<2>>("[[2.0,0.0],[0.0,2.0]]").is_err());
}

#[test]
fn vectors_and_poses_convert_there_and_back() {
    let v = Vector([1.0, 2.0, 3.0]);
    assert_eq!(Vector::from(glam::DVec3::from(v)), v);
    let turn = Rotation::from_axis_angle(Vector([1.0, 2.0, -0.5]), 0.8).unwrap();
    let pose = Pose::new(turn, v);
    let again = Pose::try_from(glam::DAffine3::from(pose)).unwrap();
    assert_eq!(again.translation, pose.translation);
    let p = Vector([0.3, 0.7, -1.1]);
    assert!((again.transform_point(p) - pose.transform_point(p)).norm() < 1e-15);
    let image = glam::DAffine3::from(pose).transform_point3(p.into());
    assert!((Vector::from(image) - pose.transform_point(p)).norm() < 1e-15);

    let pose = Pose::new(Rotation::from_angle(2.5).unwrap(), Vector([1.0, 2.0]));
    let again = Pose::try_from(glam::DAffine2::from(pose)).unwrap();
    let p = Vector([0.3, 0.7]);
    assert!((again.transform_point(p) - pose.transform_point(p)).norm() < 1e-15);
    let image = glam::DAffine2::from(pose).transform_point2(p.into());
    assert!((Vector::from(image) - pose.transform_point(p)).norm() < 1e-15);
}

#[test]
fn scale_and_shear_are_refused_in_both_dimensions() {
    let planar = glam::DAffine2::from_scale(glam::DVec2::splat(2.0));
    assert!(Pose::<2>::try_from(planar).is_err());
    let mirrored = glam::DAffine2::from_scale(glam::DVec2::new(-1.0, 1.0));
    assert!(Pose::<2>::try_from(mirrored).is_err());
    let spatial = glam::DAffine3::from_scale(glam::DVec3::splat(2.0));
    assert!(Pose::<3>::try_from(spatial).is_err());
}

#[test]
fn vectors_points_and_rotations_convert_there_and_back() {
    let v = Vector([1.0, 2.0, 3.0]);
    assert_eq!(Vector::from(mint::Vector3::from(v)), v);
    assert_eq!(Vector::from(mint::Point3::from(v)), v);
    let v = Vector([1.0_f32, 2.0]);
    assert_eq!(Vector::from(mint::Vector2::from(v)), v);
    assert_eq!(Vector::from(mint::Point2::from(v)), v);
    // A quarter turn about x takes y to z.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let quaternion = mint::Quaternion { v: mint::Vector3 { x: half, y: 0.0, z: 0.0 }, s: half };
    let turn = Rotation::try_from(quaternion).unwrap();
    assert!((turn.rotate(Vector([0.0, 1.0, 0.0])) - Vector([0.0, 0.0, 1.0])).norm() < 1e-15);
    let again = mint::Quaternion::from(turn);
    assert!((again.v.x - half).abs() < 1e-15 && (again.s - half).abs() < 1e-15);
    let none = mint::Quaternion { v: mint::Vector3 { x: 0.0, y: 0.0, z: 0.0 }, s: 0.0 };
    assert!(Rotation::try_from(none).is_err());
}
