// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a simulated device has beside its motion: buttons and a gripper by a script, a watchdog.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::error::SimulationError;
use crate::hand_path::HandPath;
use palpate_device::{Buttons, GripperState, NumberError, PointState};
use palpate_field::Vector;
use std::time::Duration;

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

#[cfg(test)]
mod tests {
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
