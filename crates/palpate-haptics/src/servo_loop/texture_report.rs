// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The report of height textures in a run.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::Servo;

/// How fast the crests of height textures passed under the hand.
///
/// A texture fades where its crests pass faster than a quarter of the rate
/// ([`Passing`](crate::Passing)).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct TextureReport {
    /// Ticks in which a contact point touched a height texture.
    pub ticks: u64,
    /// Ticks in which the texture of a contact point was rendered in part, or not at all.
    pub faded_ticks: u64,
    /// The most crests that passed a second [Hz].
    pub highest_frequency: f64,
    /// The rate at which all of it would have been rendered in full [Hz].
    pub wanted_rate: f64,
}

impl TextureReport {
    /// Counts a tick.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn tick(&mut self, servo: &Servo) {
        let (bodies, rate) = (servo.bodies().bodies(), servo.options().rate);
        let (mut is_touched, mut is_faded) = (false, false);
        for touch in servo.touches().iter().filter(|touch| touch.contact) {
            let body = bodies.get(touch.body as usize);
            let passing =
                body.and_then(|body| body.passing(touch.velocity, touch.normal, rate));
            let Some(passing) = passing else { continue };
            is_touched = true;
            is_faded |= passing.part < 1.0;
            self.highest_frequency = self.highest_frequency.max(passing.frequency);
            self.wanted_rate = self.wanted_rate.max(passing.wanted_rate());
        }
        self.ticks += u64::from(is_touched);
        self.faded_ticks += u64::from(is_faded);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Bodies, Body, Material, Protection, Servo, ServoOptions, Surface, Texture, TextureKind,
    };
    use palpate_device::{DeviceProfile, PointState};
    use palpate_field::kernel::HalfSpace;
    use palpate_field::{Shape, Vector};

    fn servo() -> Servo {
        let texture = Texture {
            description: None,
            kind: TextureKind::Height,
            amplitude: 1e-5,
            wavelength: 1e-3,
            direction: Some(vec![1.0, 0.0, 0.0]),
        };
        let grooved = Material { texture: Some(texture), ..Material::default() };
        let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0, 0.0]), 0.0).unwrap());
        let floor = Body::new(floor, Surface::new(&grooved).unwrap()).unwrap();
        let bodies = Bodies::new(vec![floor]).unwrap();
        let servo = Servo::new(bodies, 1, ServoOptions::default()).unwrap();
        servo.protected(&Protection::new(DeviceProfile::unlimited("none"))).unwrap()
    }

    #[test]
    fn ticks_are_counted_by_what_was_rendered_of_the_texture() {
        let (mut servo, mut report) = (servo(), TextureReport::default());
        // 10 mm above, then 1 mm deep at 200, 300 and 600 crests a second.
        for (height, speed) in [(0.01, 0.6), (-0.001, 0.2), (-0.001, 0.3), (-0.001, 0.6)] {
            let velocity = Vector([speed, 0.0, 0.0]);
            servo.step(&[PointState { position: Vector([0.0, height, 0.0]), velocity }]);
            report.tick(&servo);
        }
        assert_eq!((report.ticks, report.faded_ticks), (3, 2));
        assert!((report.highest_frequency - 600.0).abs() < 1e-9);
        assert!((report.wanted_rate - 2400.0).abs() < 1e-9);
    }
}
