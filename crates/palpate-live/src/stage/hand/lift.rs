// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A hand that is lifted off the bodies, brought to another place and set down there.

use palpate::field::{Point, Vector};

/// The least and the longest time that a hand is lifted [s].
const LIFTED: [f64; 2] = [0.05, 10.0];

/// How far a device may be from where it is set down, as a share of the scene.
const THERE: f64 = 2e-3;

/// A device is at rest below this speed, in its own coordinates [m/s].
const AT_REST: f64 = 5e-3;

/// How long a hand that was set down stays there [s]: until the servo knows of it.
const SET_DOWN: f64 = 0.02;

/// A hand that is lifted, until the servo knows that it was set down.
#[derive(Debug)]
pub(super) struct Lift {
    /// Where it is brought [m].
    places: Vec<Point<3>>,
    /// When it was lifted [s].
    since: f64,
    /// Where the device points were last [m].
    devices: Vec<Point<3>>,
    /// When it was set down [s].
    set_down: Option<f64>,
}

/// What is to be done for a hand that is lifted.
#[derive(Debug)]
pub(super) enum Step {
    OnTheWay,
    /// Friction keeps the device short of the place by so much [m]: it is led farther.
    Short(Vec<Vector<f64, 3>>),
    /// It is set down, and rests here: where it was brought, or if it took too long where it is [m].
    SetDown(Vec<Point<3>>),
    Over,
}

impl Lift {
    /// A hand that is lifted at a time [s].
    pub(super) fn to(places: Vec<Point<3>>, since: f64) -> Self {
        Self { places, since, devices: Vec::new(), set_down: None }
    }

    pub(super) fn places(&self) -> &[Point<3>] {
        &self.places
    }

    pub(super) fn is_lifted(&self) -> bool {
        self.set_down.is_none()
    }

    /// Brings one contact point elsewhere.
    pub(super) fn redirect(&mut self, point: usize, place: Point<3>) {
        if let Some(old) = self.places.get_mut(point) {
            *old = place;
        }
    }

    /// Sets the hand down once the device is where it is brought. `passed` since the step before [s],
    /// in a scene of this size [m], of `scale` metres for a metre of the device.
    pub(super) fn go_on(
        &mut self,
        time: f64,
        passed: f64,
        devices: &[Point<3>],
        [size, scale]: [f64; 2],
    ) -> Step {
        if let Some(at) = self.set_down {
            return if time - at >= SET_DOWN { Step::Over } else { Step::OnTheWay };
        }
        let is_within = |a: &[Point<3>], b: &[Point<3>], most: f64| {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (*a - *b).norm() <= most)
        };
        let last = std::mem::replace(&mut self.devices, devices.to_vec());
        let (since, [least, longest]) = (time - self.since, LIFTED);
        if since < least {
            return Step::OnTheWay;
        }
        if is_within(devices, &self.places, THERE * size) {
            self.set_down = Some(time);
            return Step::SetDown(self.places.clone());
        }
        if since > longest {
            self.set_down = Some(time);
            return Step::SetDown(devices.to_vec());
        }
        if passed > 0.0 && is_within(devices, &last, AT_REST * scale * passed) {
            let ends = self.places.iter().zip(devices);
            return Step::Short(ends.map(|(place, device)| *place - *device).collect());
        }
        Step::OnTheWay
    }
}
