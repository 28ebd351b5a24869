// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A device of one's own: a plotter's carriage in the plane, driven by two voltages.
//! The safety chain keeps every force within the limits that the device states.

use palpate::device::{DeviceLost, DeviceProfile, PointState, Reading};
use palpate::prelude::*;

/// A carriage that a motor draws around a circle of 48 mm in two seconds.
struct Carriage {
    profile: DeviceProfile,
    /// What the coils get [V]: 0.5 V for each newton.
    volts: [f64; 2],
}

impl Device for Carriage {
    fn points(&self) -> usize {
        1
    }

    fn profile(&self) -> &DeviceProfile {
        &self.profile
    }

    fn read(&mut self, time: f64, points: &mut [PointState]) -> Result<Reading, DeviceLost> {
        let (sin, cos) = (std::f64::consts::PI * time).sin_cos();
        let speed = 0.048 * std::f64::consts::PI;
        for point in points {
            point.position = Vector([0.048 * cos, 0.048 * sin, 0.0]);
            point.velocity = Vector([-speed * sin, speed * cos, 0.0]);
        }
        Ok(Reading::Fresh { time })
    }

    fn write(&mut self, forces: &[Vector<f64, 3>]) -> Result<(), DeviceLost> {
        self.volts = [0.5 * forces[0][0], 0.5 * forces[0][1]];
        Ok(())
    }
}

fn main() -> Result<(), Error> {
    let profile = DeviceProfile {
        max_force: 1.5,
        continuous_force: 0.5,
        max_force_rate: 3000.0,
        max_stiffness: 1500.0,
        mass: 0.1,
        least_damping: 0.5,
        friction: 0.2,
        encoder_step: 20e-6,
        ..DeviceProfile::unlimited("carriage")
    };
    let mut device = Carriage { profile, volts: [0.0; 2] };
    let disc = Shape::circle(0.02)?.translated([0.06, 0.0])?;
    let mut servo = Servo::for_device(disc, &device)?;
    let report = servo.run(&mut device, Seconds(2.0))?.unless_failed()?;
    println!("{} ticks, at most {:.2} N", report.ticks, report.largest_force);
    Ok(())
}
