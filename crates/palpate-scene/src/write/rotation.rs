// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rotations as files hold them, to the bit.

use palpate_field::{Rotation, Vector};

use crate::angle::degrees_near;
use crate::pose::{AxisAngle, WrittenRotation, of_rows};

/// The form of a rotation that reads back to the same bits: an angle in degrees, in space about
/// an axis of coordinates; else in space a quaternion; else the rows of the matrix. `None` if
/// nothing is turned.
pub(super) fn written<const D: usize>(rotation: &Rotation<D>) -> Option<WrittenRotation> {
    if bits(rotation) == bits(&Rotation::<D>::identity()) {
        return None;
    }
    let rows: Vec<_> = rotation.matrix().iter().map(|row| row.to_vec()).collect();
    let short = match D {
        2 => of_rows::<2>(&rows).ok().and_then(|rotation| in_degrees(&rotation)),
        _ => of_rows::<3>(&rows).ok().and_then(|rotation| of_axis_or_quaternion(&rotation)),
    };
    short.or(Some(WrittenRotation::Rows(rows)))
}

fn bits<const D: usize>(rotation: &Rotation<D>) -> Vec<u64> {
    rotation.matrix().as_flattened().iter().map(|x| x.to_bits()).collect()
}

/// An angle in degrees that gives a rotation of the plane to the bit.
fn in_degrees(rotation: &Rotation<2>) -> Option<WrittenRotation> {
    let same = |degrees: &f64| {
        Rotation::from_angle(degrees.to_radians()).is_ok_and(|r| bits(&r) == bits(rotation))
    };
    let degrees = degrees_near(rotation.angle()).into_iter().find(same);
    degrees.map(WrittenRotation::Degrees)
}

/// An angle about an axis of coordinates, or a quaternion, that gives a rotation of space to the
/// bit.
fn of_axis_or_quaternion(rotation: &Rotation<3>) -> Option<WrittenRotation> {
    let quaternion = rotation.quaternion();
    let [axis @ .., w] = quaternion;
    for (i, part) in axis.into_iter().enumerate() {
        let angle = 2.0 * f64::atan2(part, w);
        let along = Vector::<f64, 3>::unit(i);
        let same = |degrees: &f64| {
            let turn = Rotation::from_axis_angle(along, degrees.to_radians());
            turn.is_ok_and(|turn| bits(&turn) == bits(rotation))
        };
        if let Some(degrees) = degrees_near(angle).into_iter().find(same) {
            return Some(WrittenRotation::AxisAngle(AxisAngle::new(along.0, degrees)));
        }
    }
    let same = Rotation::from_quaternion(quaternion).is_ok_and(|r| bits(&r) == bits(rotation));
    same.then_some(WrittenRotation::Quaternion(quaternion))
}
