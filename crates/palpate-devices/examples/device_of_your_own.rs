// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A device of your own: a plotter's carriage in the plane, driven by two voltages.
//!
//! palpate needs one trait of a device, [`Device`]: it reads the device points and writes the
//! forces. Here the transport is two numbers; yours would be a port.

use palpate_devices::{Device, DeviceLost, DeviceProfile, PointState};
use palpate_field::{Shape, ShapeError, Vector, kernel::Ball};
use palpate_haptics::{HapticsError, Servo};
use palpate_loop::{Pace, RunOptions, RunReport, run};

/// A carriage that a motor moves around a circle of 48 mm in two seconds.
struct Carriage {
    profile: DeviceProfile,
    /// The voltages on the coils [V]: 0.5 V per newton.
    volts: [f64; 2],
}

impl Device<2> for Carriage {
    fn points(&self) -> usize {
        1
    }

    fn profile(&self) -> &DeviceProfile {
        &self.profile
    }

    fn read(&mut self, time: f64, points: &mut [PointState<2>]) -> Result<(), DeviceLost> {
        let (sin, cos) = (std::f64::consts::PI * time).sin_cos();
        let speed = 0.048 * std::f64::consts::PI;
        for point in points {
            point.position = Vector([0.048 * cos, 0.048 * sin]);
            point.velocity = Vector([-speed * sin, speed * cos]);
        }
        Ok(())
    }

    fn write(&mut self, forces: &[Vector<f64, 2>]) -> Result<(), DeviceLost> {
        for force in forces {
            self.volts = [0.5 * force[0], 0.5 * force[1]];
        }
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let report = feel()?;
    println!("{} ticks, {:.3} s in contact", report.ticks, report.contact_time);
    println!("deepest {:.2} mm", 1e3 * report.largest_depth);
    println!("largest force {:.2} N, of the device's 1.50 N", report.largest_force);
    Ok(())
}

/// Two seconds on a disc that reaches 20 mm into the circle.
fn feel() -> Result<RunReport, Failure> {
    let profile = DeviceProfile {
        max_force: 1.5,
        max_force_rate: 3000.0,
        mass: 0.1,
        least_damping: 0.5,
        ..DeviceProfile::unlimited("carriage")
    };
    let mut device = Carriage { profile, volts: [0.0; 2] };
    let disc = Shape::from_kernel(Ball::new(0.02)?).translated(Vector([0.06, 0.0]))?;
    // The servo keeps the limits of the profile: no larger force reaches the hand.
    let mut servo = Servo::for_device(disc, &device)?;
    let options = RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(2.0) };
    Ok(run(&mut servo, &mut device, options)?)
}

#[derive(Debug, thiserror::Error)]
enum Failure {
    #[error(transparent)]
    Shape(#[from] ShapeError),
    #[error(transparent)]
    Touch(#[from] HapticsError),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_carriage_feels_the_disc_and_its_limit() {
        let report = feel().unwrap();
        assert_eq!(report.ticks, 2000);
        assert!((report.largest_force - 1.5).abs() < 1e-15);
    }
}
