// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A hand that is lifted off the bodies, brought to another place and set down there.

use palpate::field::{Point, Vector};

/// The least and the longest time that a hand is lifted [s]: a device follows within.
const LIFTED: [f64; 2] = [0.05, 2.0];

/// How far a device may be from where it is set down, as a share of the scene.
const THERE: f64 = 2e-3;

/// How long a hand that was set down stays there [s]: until the servo knows of it.
const SET_DOWN: f64 = 0.02;

/// A device is at rest if it moves by at most this share of the scene in a second.
const AT_REST: f64 = 0.05;

/// A hand that is lifted, until the servo knows that it was set down.
#[derive(Debug)]
pub(super) struct Lift<const D: usize> {
    /// Where it is brought [m].
    places: Vec<Point<D>>,
    /// When it was lifted [s].
    since: f64,
    /// Where the device points were last [m].
    devices: Vec<Point<D>>,
    /// When it was set down [s].
    set_down: Option<f64>,
}

/// What is to be done for a hand that is lifted.
#[derive(Debug)]
pub(super) enum Step<const D: usize> {
    OnTheWay,
    /// Friction keeps the device short of the place by so much [m]: it is led farther.
    Short(Vec<Vector<f64, D>>),
    Over,
}

impl<const D: usize> Lift<D> {
    /// A hand that is lifted at a time [s].
    pub(super) fn to(places: Vec<Point<D>>, since: f64) -> Self {
        Self { places, since, devices: Vec::new(), set_down: None }
    }

    pub(super) fn places(&self) -> &[Point<D>] {
        &self.places
    }

    pub(super) fn is_lifted(&self) -> bool {
        self.set_down.is_none()
    }

    /// Sets the hand down once the device is where it is brought. `passed` since the step before [s],
    /// in a scene of this size [m].
    pub(super) fn go_on(
        &mut self,
        time: f64,
        passed: f64,
        devices: &[Point<D>],
        size: f64,
    ) -> Step<D> {
        if let Some(at) = self.set_down {
            return if time - at >= SET_DOWN { Step::Over } else { Step::OnTheWay };
        }
        let is_within = |a: &[Point<D>], b: &[Point<D>], most: f64| {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (*a - *b).norm() <= most)
        };
        let last = std::mem::replace(&mut self.devices, devices.to_vec());
        let (since, [least, longest]) = (time - self.since, LIFTED);
        let is_there = is_within(devices, &self.places, THERE * size);
        if since > longest || since >= least && is_there {
            self.set_down = Some(time);
            return Step::OnTheWay;
        }
        let is_at_rest = passed > 0.0 && is_within(devices, &last, AT_REST * size * passed);
        if since < least || !is_at_rest {
            return Step::OnTheWay;
        }
        let ends = self.places.iter().zip(devices);
        Step::Short(ends.map(|(place, device)| *place - *device).collect())
    }
}
