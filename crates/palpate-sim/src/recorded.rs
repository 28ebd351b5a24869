// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Recorded hands and devices.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::time::Duration;

use palpate_device::{
    Buttons, Device, DeviceError, DeviceLost, DeviceProfile, GripperState, NumberError,
    PointState, Reading, TurnState,
};
use palpate_field::{Rotation, Vector};
use palpate_vibration::{Command, Vibrates};

use crate::error::SimulationError;
use crate::hand_path::HandPath;

/// A device whose points follow recorded hand paths.
///
/// Deterministic: states depend on the servo's time alone. The forces written last can be read.
///
/// # Examples
///
/// ```
/// use palpate_field::Vector;
/// use palpate_device::{Device, PointState};
/// use palpate_sim::{HandPath, Interpolation, RecordedDevice};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ends = vec![Vector([0.0, 0.5, 0.0]), Vector([0.0, 0.0, 0.0])];
/// let path = HandPath::new(vec![0.0, 2.0], ends, Interpolation::Linear)?;
/// let mut device = RecordedDevice::new(vec![path])?;
/// let mut points = [PointState::at_rest(Vector::ZERO)];
/// device.read(1.0, &mut points)?;
/// assert_eq!(points[0].position, Vector([0.0, 0.25, 0.0]));
/// assert_eq!(points[0].velocity, Vector([0.0, -0.25, 0.0]));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct RecordedDevice {
    paths: Vec<HandPath>,
    forces: Vec<Vector<f64, 3>>,
    profile: DeviceProfile,
    /// The path of orientations; `None` for a device without rotation.
    turns: Option<HandPath>,
    turn: Option<TurnState>,
    torque: Vector<f64, 3>,
}

/// The time over which an angular velocity is measured [s]: short for any hand, and long enough
/// that rounding does not matter.
const INSTANT: f64 = 1e-6;

impl RecordedDevice {
    /// A device with one contact point for each path.
    ///
    /// # Errors
    ///
    /// [`DeviceError::NoContactPoint`] if there are no paths.
    #[inline(never)]
    pub fn new(paths: Vec<HandPath>) -> Result<Self, SimulationError> {
        if paths.is_empty() {
            return Err(DeviceError::NoContactPoint.into());
        }
        let forces = vec![Vector::ZERO; paths.len()];
        let (turns, turn, torque) = (None, None, Vector::ZERO);
        let profile = DeviceProfile::unlimited("recorded");
        Ok(Self { paths, forces, profile, turns, turn, torque })
    }

    /// This device with a path of orientations: rotation vectors [rad] relative to the device's
    /// own axes.
    ///
    /// ```
    /// use palpate_field::{Rotation, Vector};
    /// use palpate_device::{Device, PointState};
    /// use palpate_sim::{HandPath, Interpolation, RecordedDevice};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let rest = HandPath::new(vec![0.0, 2.0], vec![Vector([0.0, 0.0, 0.0]); 2], Interpolation::Linear)?;
    /// let turns = vec![Vector([0.0; 3]), Vector([0.0, 0.0, 1.0])];
    /// let turns = HandPath::new(vec![0.0, 2.0], turns, Interpolation::Linear)?;
    /// let mut device = RecordedDevice::new(vec![rest])?.with_turns(turns);
    /// device.read(1.0, &mut [PointState::at_rest(Vector::ZERO)])?;
    /// let turn = device.read_turn()?.ok_or("it turns")?;
    /// let turned = Rotation::identity().turn_to(&turn.orientation);
    /// assert!((turned - Vector([0.0, 0.0, 0.5])).norm() < 1e-15);
    /// assert!((turn.angular_velocity - Vector([0.0, 0.0, 0.5])).norm() < 1e-9);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn with_turns(self, turns: HandPath) -> Self {
        Self { turns: Some(turns), ..self }
    }

    /// This device with the profile of a real one.
    #[must_use]
    pub fn with_profile(self, profile: DeviceProfile) -> Self {
        Self { profile, ..self }
    }

    /// The forces written last [N].
    #[must_use]
    pub fn forces(&self) -> &[Vector<f64, 3>] {
        &self.forces
    }

    /// The torque written last [N·m].
    #[must_use]
    pub fn torque(&self) -> Vector<f64, 3> {
        self.torque
    }

    /// The time at which the last path ends [s].
    #[must_use]
    pub fn end(&self) -> f64 {
        self.paths.iter().map(|p| p.start() + p.duration()).fold(0.0, f64::max)
    }
}

impl Device for RecordedDevice {
    fn points(&self) -> usize {
        self.paths.len()
    }

    fn profile(&self) -> &DeviceProfile {
        &self.profile
    }

    fn read(&mut self, time: f64, points: &mut [PointState]) -> Result<Reading, DeviceLost> {
        for (point, path) in points.iter_mut().zip(&self.paths) {
            *point = path.state_at(time);
        }
        self.turn = self.turns.as_ref().map(|turns| {
            let at = |time| Rotation::identity().turned(turns.state_at(time).position);
            let (before, after) = (at(time - INSTANT), at(time + INSTANT));
            let angular_velocity = before.turn_to(&after) * (0.5 / INSTANT);
            TurnState { orientation: at(time), angular_velocity }
        });
        Ok(Reading::Fresh { time })
    }

    fn write(&mut self, forces: &[Vector<f64, 3>]) -> Result<(), DeviceLost> {
        for (kept, force) in self.forces.iter_mut().zip(forces) {
            *kept = *force;
        }
        Ok(())
    }

    fn read_turn(&mut self) -> Result<Option<TurnState>, DeviceLost> {
        Ok(self.turn)
    }

    fn write_torque(&mut self, torque: Vector<f64, 3>) -> Result<(), DeviceLost> {
        self.torque = torque;
        Ok(())
    }
}

/// Buttons and gripper of a device over time.
#[derive(Clone, Debug, Default)]
pub(crate) struct Script {
    /// The buttons that are down from a time on [s], in order of time.
    buttons: Vec<(f64, Buttons)>,
    /// The opening of the gripper [m].
    pub(crate) gripper: Option<HandPath>,
}

impl Script {
    /// # Errors
    ///
    /// [`SimulationError::Number`] if a time is NaN or earlier than the one before.
    pub(crate) fn set_buttons(
        &mut self,
        buttons: Vec<(f64, Buttons)>,
    ) -> Result<(), SimulationError> {
        let mut last = f64::NEG_INFINITY;
        for (time, _) in &buttons {
            // Written so that NaN is refused.
            if *time >= last {
                last = *time;
            } else {
                let rule = "no earlier than the time before";
                return Err(NumberError::new("time of buttons", rule, *time, "s").into());
            }
        }
        self.buttons = buttons;
        Ok(())
    }

    /// The buttons that are down at a time [s].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn buttons(&self, time: f64) -> Buttons {
        let begun = self.buttons.partition_point(|(start, _)| *start <= time);
        let held = begun.checked_sub(1).and_then(|last| self.buttons.get(last));
        held.map_or(Buttons::NONE, |(_, buttons)| *buttons)
    }

    /// The gripper at a time [s].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn gripper(&self, time: f64) -> Option<GripperState> {
        let PointState { position: Vector([opening, ..]), velocity: Vector([velocity, ..]) } =
            self.gripper.as_ref()?.state_at(time);
        Some(GripperState { opening, velocity })
    }
}

/// Says when forces end because nothing was written for a time.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Watchdog {
    /// That time [s]; `None` until it is set.
    patience: Option<f64>,
    /// When the forces that are held were written [s].
    written: Option<f64>,
    trips: u64,
}

impl Watchdog {
    pub(crate) fn set(&mut self, patience: Duration) {
        self.patience = Some(patience.as_secs_f64());
    }

    /// Takes note of forces that were written at a time [s].
    pub(crate) fn written(&mut self, time: Option<f64>) {
        self.written = time;
    }

    /// When the held forces end, if that is before `time` [s].
    pub(crate) fn trip(&mut self, time: f64) -> Option<f64> {
        let end = self.written? + self.patience?;
        if end >= time {
            return None;
        }
        self.written = None;
        self.trips += 1;
        Some(end)
    }

    /// How often it tripped.
    pub(crate) fn trips(&self) -> u64 {
        self.trips
    }
}

/// Keeps the commands to a device that vibrates, for tests and for looking at what would be played.
///
/// ```
/// use palpate_sim::VibrationRecorder;
/// use palpate_vibration::{Command, Tone, Vibrates};
///
/// let mut glove = VibrationRecorder::new(2);
/// let tap = Command { tone: Tone { frequency: 200.0, amplitude: 0.5 }, duration: 0.05 };
/// glove.play(&[tap, Command::default()])?;
/// assert_eq!(glove.played().next(), Some(&[tap, Command::default()][..]));
/// # Ok::<(), palpate_device::DeviceLost>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VibrationRecorder {
    channels: usize,
    commands: Vec<Command>,
}

impl VibrationRecorder {
    /// A device with so many actuators.
    #[must_use]
    pub fn new(channels: usize) -> Self {
        Self { channels, commands: Vec::new() }
    }

    /// The commands, in order of time: one for each actuator at a time.
    pub fn played(&self) -> impl Iterator<Item = &[Command]> + Clone {
        self.commands.chunks(self.channels.max(1))
    }
}

impl Vibrates for VibrationRecorder {
    fn channels(&self) -> usize {
        self.channels
    }

    /// Allocates: not for a servo that runs in real time.
    fn play(&mut self, commands: &[Command]) -> Result<(), DeviceLost> {
        let missing = self.channels.saturating_sub(commands.len());
        self.commands.extend(commands.iter().take(self.channels));
        self.commands.extend(std::iter::repeat_n(Command::default(), missing));
        Ok(())
    }
}

#[cfg(test)]
mod script_tests {
    use super::*;
    use crate::hand::Hand;
    use crate::hand_path::Interpolation;
    use crate::simulated::SimulatedDevice;
    use palpate_device::{Device, DeviceProfile, GripperProfile};

    #[test]
    fn buttons_and_gripper_follow_their_script() {
        let gripper = HandPath::new(
            vec![0.0, 2.0],
            vec![Vector::ZERO, Vector([0.02, 0.0, 0.0])],
            Interpolation::Linear,
        );
        let limits = GripperProfile::new(0.025, 8.0);
        let profile =
            DeviceProfile { mass: 0.1, least_damping: 0.5, ..DeviceProfile::unlimited("test") };
        let profile = DeviceProfile { friction: 0.0, gripper: Some(limits), ..profile };
        let hand = Hand::resting(Vector([0.0, 0.0, 0.0])).unwrap();
        let device = SimulatedDevice::new(profile, vec![hand]).unwrap();
        let device = device.with_gripper(gripper.unwrap());
        let (one, two) = (Buttons::NONE.with(1), Buttons::NONE.with(1).with(4));
        let mut device = device.with_buttons(vec![(0.5, one), (1.0, two)]).unwrap();
        let mut points = [PointState::at_rest(Vector::ZERO)];
        for (time, buttons) in [(0.0, Buttons::NONE), (0.5, one), (0.75, one), (1.0, two)] {
            device.read(time, &mut points).unwrap();
            assert_eq!(device.buttons(), buttons);
        }
        let gripper = device.read_gripper().unwrap();
        assert_eq!(gripper, Some(GripperState { opening: 0.01, velocity: 0.01 }));
        for (written, held) in [(5.0, 5.0), (-9.0, -8.0), (f64::NAN, 0.0)] {
            device.write_gripper_force(written).unwrap();
            assert_eq!(device.gripper_force(), held);
        }
        let error = device.with_buttons(vec![(1.0, one), (0.5, one)]).unwrap_err();
        let said = "time of buttons must be no earlier than the time before, got 0.5 s";
        assert_eq!(error.to_string(), said);
    }
}
