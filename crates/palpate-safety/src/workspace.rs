// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The workspace map: between device and world coordinates.

use palpate_field::{Aabb, Point, Pose, Rotation, Vector};

use crate::error::SafetyError;
use palpate_device::{NumberError, PointState};

/// From device to world coordinates and back: `world = s R device + t`.
///
/// A displacement is rotated by `R` and scaled by `s`; a force is only rotated, so that the
/// hand feels the newtons of the world. A displacement `x` at the device therefore stretches a
/// spring of the world by `s x`, and the device renders `F = K s x`: `K_device = s K_world`.
/// The limits of a device apply to the stiffness at the device.
///
/// Angles are equal in both, so an angular velocity is only rotated. The lever arm of a force
/// at the device is `1/s` of the arm in the world, and so is the torque. The power at the
/// device, `F·v + τ·ω`, is then `1/s` of the power in the world: the map creates no energy.
///
/// # Examples
///
/// ```
/// use palpate_field::{Pose, Vector};
/// use palpate_safety::WorkspaceMap;
///
/// # fn main() -> Result<(), palpate_safety::SafetyError> {
/// let map = WorkspaceMap::new(Pose::translation(Vector([1.0, 0.0, 0.0])), 4.0)?;
/// assert_eq!(map.point_to_world(Vector([0.5, 0.25, 0.0])), Vector([3.0, 1.0, 0.0]));
/// assert_eq!(map.force_to_device(Vector([0.0, 2.0, 0.0])), Vector([0.0, 2.0, 0.0]));
/// assert_eq!(map.device_stiffness(500.0), 2000.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkspaceMap {
    world_from_device: Pose<3>,
    device_from_world: Pose<3>,
    scale: f64,
    /// Whether the map is the identity.
    is_identity: bool,
}

impl Default for WorkspaceMap {
    /// The identity: world coordinates equal device coordinates.
    fn default() -> Self {
        let identity = Pose::identity();
        Self {
            world_from_device: identity,
            device_from_world: identity,
            scale: 1.0,
            is_identity: true,
        }
    }
}

impl WorkspaceMap {
    /// The map that multiplies device coordinates by `scale` and then applies the pose
    /// `world_from_device`.
    ///
    /// # Errors
    ///
    /// [`SafetyError::Number`] if the scale is not positive and finite, or the translation not
    /// finite.
    pub fn new(world_from_device: Pose<3>, scale: f64) -> Result<Self, SafetyError> {
        let scale = NumberError::check_positive("scale", scale, "(world per device)")?;
        let wrong = world_from_device.translation.0.into_iter().find(|x| !x.is_finite());
        match wrong {
            Some(value) => {
                Err(SafetyError::Number(NumberError::new("translation", "finite", value, "m")))
            }
            None => Ok(Self {
                world_from_device,
                device_from_world: world_from_device.inverse(),
                scale,
                is_identity: scale == 1.0 && world_from_device == Pose::identity(),
            }),
        }
    }

    /// The smallest map without rotation that lets a device reach every point of the box
    /// `scene`; the workspace is a ball of `workspace_radius` [m] about the device's origin.
    ///
    /// # Errors
    ///
    /// [`SafetyError::Number`] if the radius or the scene's size is not positive and finite.
    ///
    /// ```
    /// use palpate_field::{Aabb, Vector};
    /// use palpate_safety::WorkspaceMap;
    ///
    /// # fn main() -> Result<(), palpate_safety::SafetyError> {
    /// let scene = Aabb::centred(Vector([3.0, 4.0, 0.0]));
    /// assert_eq!(WorkspaceMap::fitting(scene, 0.125)?.scale(), 40.0);
    /// # Ok(())
    /// # }
    /// ```
    pub fn fitting(scene: Aabb<3>, workspace_radius: f64) -> Result<Self, SafetyError> {
        let workspace_radius =
            NumberError::check_positive("workspace_radius", workspace_radius, "m")?;
        let half_diagonal = NumberError::check_positive(
            "half diagonal of the scene",
            scene.half_extents().norm(),
            "m",
        )?;
        Self::new(Pose::translation(scene.centre()), half_diagonal / workspace_radius)
    }

    /// The scale `s`: lengths in the world over lengths at the device.
    #[must_use]
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The rotation `R`: the device's axes in world coordinates.
    #[must_use]
    pub fn rotation(&self) -> Rotation<3> {
        self.world_from_device.rotation
    }

    /// Maps a point from device to world coordinates [m]. Real-time.
    #[must_use]
    pub fn point_to_world(&self, point: Point<3>) -> Point<3> {
        self.world_from_device.transform_point(point * self.scale)
    }

    /// Maps a point from world to device coordinates [m]. Real-time.
    #[must_use]
    pub fn point_to_device(&self, point: Point<3>) -> Point<3> {
        self.device_from_world.transform_point(point) * (1.0 / self.scale)
    }

    /// Maps a velocity from device to world coordinates [m/s]. Real-time.
    #[must_use]
    pub fn velocity_to_world(&self, velocity: Vector<f64, 3>) -> Vector<f64, 3> {
        self.world_from_device.transform_vector(velocity * self.scale)
    }

    /// Maps a velocity from world to device coordinates [m/s]. Real-time.
    #[must_use]
    pub fn velocity_to_device(&self, velocity: Vector<f64, 3>) -> Vector<f64, 3> {
        self.device_from_world.transform_vector(velocity) * (1.0 / self.scale)
    }

    /// Maps the state of a contact point from device to world coordinates. Real-time.
    #[must_use]
    pub fn state_to_world(&self, state: PointState) -> PointState {
        if self.is_identity {
            return state;
        }
        PointState {
            position: self.point_to_world(state.position),
            velocity: self.velocity_to_world(state.velocity),
        }
    }

    /// Rotates a force from world to device coordinates [N]; its size stays. Real-time.
    #[must_use]
    pub fn force_to_device(&self, force: Vector<f64, 3>) -> Vector<f64, 3> {
        if self.is_identity { force } else { self.device_from_world.transform_vector(force) }
    }

    /// Rotates a force from device to world coordinates [N]; its size stays. Real-time.
    #[must_use]
    pub fn force_to_world(&self, force: Vector<f64, 3>) -> Vector<f64, 3> {
        if self.is_identity { force } else { self.world_from_device.transform_vector(force) }
    }

    /// Maps an orientation from device to world coordinates. Real-time.
    #[must_use]
    pub fn orientation_to_world(&self, orientation: Rotation<3>) -> Rotation<3> {
        self.world_from_device.rotation * orientation
    }

    /// Rotates an angular velocity from device to world coordinates [rad/s]. Real-time.
    #[must_use]
    pub fn spin_to_world(&self, spin: Vector<f64, 3>) -> Vector<f64, 3> {
        self.world_from_device.transform_vector(spin)
    }

    /// Rotates an angular velocity from world to device coordinates [rad/s]. Real-time.
    #[must_use]
    pub fn spin_to_device(&self, spin: Vector<f64, 3>) -> Vector<f64, 3> {
        self.device_from_world.transform_vector(spin)
    }

    /// Maps a torque from world to device coordinates [N·m]: rotated and divided by `s`.
    /// Real-time.
    ///
    /// ```
    /// use palpate_field::{Pose, Vector};
    /// use palpate_safety::WorkspaceMap;
    ///
    /// # fn main() -> Result<(), palpate_safety::SafetyError> {
    /// let map = WorkspaceMap::new(Pose::identity(), 4.0)?;
    /// assert_eq!(map.torque_to_device(Vector([0.0, 2.0, 0.0])), Vector([0.0, 0.5, 0.0]));
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn torque_to_device(&self, torque: Vector<f64, 3>) -> Vector<f64, 3> {
        self.device_from_world.transform_vector(torque) * (1.0 / self.scale)
    }

    /// Maps a torque from device to world coordinates [N·m]: rotated and multiplied by `s`.
    /// Real-time.
    #[must_use]
    pub fn torque_to_world(&self, torque: Vector<f64, 3>) -> Vector<f64, 3> {
        self.world_from_device.transform_vector(torque) * self.scale
    }

    /// The stiffness at the device for a stiffness of the world [N/m]: `s` times as large.
    #[must_use]
    pub fn device_stiffness(&self, world_stiffness: f64) -> f64 {
        self.scale * world_stiffness
    }

    /// The damping at the device for a damping of the world [N·s/m]: `s` times as large,
    /// because velocities scale like lengths.
    #[must_use]
    pub fn device_damping(&self, world_damping: f64) -> f64 {
        self.scale * world_damping
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map() -> WorkspaceMap {
        let rotation = Rotation::from_axis_angle(Vector([1.0, 2.0, -0.5]), 0.7).unwrap();
        let pose = Pose::new(rotation, Vector([0.3, -1.0, 2.0]));
        WorkspaceMap::new(pose, 2.5).unwrap()
    }

    #[test]
    fn there_and_back_is_where_it_was() {
        let (map, v) = (map(), Vector([0.1, -0.2, 0.7]));
        let close = |a: Vector<f64, 3>| assert!((a - v).norm() < 1e-14);
        close(map.point_to_device(map.point_to_world(v)));
        close(map.velocity_to_device(map.velocity_to_world(v)));
        close(map.force_to_device(map.force_to_world(v)));
    }

    #[test]
    fn a_spring_of_the_world_is_felt_as_the_scaled_one() {
        let (map, stiffness) = (map(), 300.0);
        let (from, to) = (Vector([0.01, 0.02, 0.03]), Vector([0.011, 0.018, 0.033]));
        let stretch = map.point_to_world(from) - map.point_to_world(to);
        let felt = map.force_to_device(stretch * stiffness);
        let expected = (from - to) * map.device_stiffness(stiffness);
        assert!((felt - expected).norm() < 1e-12);
        assert_eq!(map.device_stiffness(stiffness), 750.0);
    }

    #[test]
    fn a_velocity_is_the_change_of_the_point() {
        let map = map();
        let (at, way) = (Vector([0.01, 0.02, 0.03]), Vector([0.5, 0.25, -1.0]));
        let moved = map.point_to_world(at + way) - map.point_to_world(at);
        let state = map.state_to_world(PointState { position: at, velocity: way });
        assert!((moved - state.velocity).norm() < 1e-14);
    }

    #[test]
    fn the_power_at_the_device_is_that_of_the_world_over_the_scale() {
        let map = map();
        let (velocity, spin) = (Vector([0.3, -0.1, 0.2]), Vector([-1.0, 0.5, 2.0]));
        let (force, torque) = (Vector([1.0, 2.0, -0.5]), Vector([0.1, 0.3, -0.2]));
        let power =
            force.dot(map.velocity_to_world(velocity)) + torque.dot(map.spin_to_world(spin));
        let at_device =
            map.force_to_device(force).dot(velocity) + map.torque_to_device(torque).dot(spin);
        assert!((2.5 * at_device - power).abs() < 1e-14);
        assert!((map.torque_to_world(map.torque_to_device(torque)) - torque).norm() < 1e-15);
        let quarter = Rotation::from_angle(0.5).unwrap().in_space();
        let planar = WorkspaceMap::new(Pose::rotation(quarter), 2.0).unwrap();
        let about_z = Vector([0.0, 0.0, 0.5]);
        assert_eq!(planar.spin_to_world(about_z), about_z);
        assert_eq!(planar.orientation_to_world(quarter), quarter * quarter);
    }

    #[test]
    fn a_fitted_workspace_reaches_every_corner_and_no_farther() {
        let points = [Vector([1.0, -2.0, 0.0]), Vector([4.0, 2.0, 0.0])];
        let scene = Aabb::around(points).unwrap();
        let map = WorkspaceMap::fitting(scene, 0.1).unwrap();
        for [x, y] in [[1.0, -2.0], [4.0, 2.0], [1.0, 2.0], [4.0, -2.0]] {
            assert!((map.point_to_device(Vector([x, y, 0.0])).norm() - 0.1).abs() < 1e-15);
        }
    }

    #[test]
    fn wrong_numbers_are_named() {
        for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(WorkspaceMap::new(Pose::identity(), scale).is_err());
        }
        let far = Pose::translation(Vector([0.0, f64::NAN, 0.0]));
        assert!(WorkspaceMap::new(far, 1.0).is_err());
        let point = Aabb::centred(Vector([0.0, 0.0, 0.0]));
        assert!(WorkspaceMap::fitting(point, 0.1).is_err());
        assert!(
            WorkspaceMap::fitting(Aabb::centred(Vector([1.0, 1.0, 0.0])), f64::INFINITY)
                .is_err()
        );
    }
}
