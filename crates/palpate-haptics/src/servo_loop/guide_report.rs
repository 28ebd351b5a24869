// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The report of guides in a run.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::{Guide, Servo};
use palpate_field::{Point, Vector};

/// What a guide did in a run, at all contact points together.
///
/// The forces are those that the guide wanted, before the safety chain; the chain's energies do
/// not count them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct GuideReport {
    /// What the guide is, as [`Guide::kind_name`](crate::Guide::kind_name) says.
    pub kind: &'static str,
    /// The time during which the guide held at least one contact point [s].
    pub time: f64,
    /// Its largest force on a contact point [N].
    pub largest_force: f64,
    /// The energy that its forces took from the hand [J]: the sum of `−F·Δx` where it is
    /// positive, with the motion `Δx` of the device during the tick in which the force `F` is
    /// held.
    pub taken: f64,
    /// The energy that its forces gave to the hand [J]: the sum of `F·Δx` where it is positive.
    pub given: f64,
}

/// Counts during a run, in preallocated memory.
#[derive(Clone, Debug)]
pub(crate) struct GuideTally {
    reports: Vec<GuideReport>,
    ticks: Vec<u64>,
    /// The device point of each contact point in the last tick [m].
    places: Vec<Option<Point<3>>>,
    /// The force of each guide at each contact point in the last tick [N], guides of a point
    /// together.
    forces: Vec<Vector<f64, 3>>,
}

impl GuideTally {
    pub(crate) fn new(servo: &Servo) -> Self {
        // A device that gives no force is not guided.
        let is_felt = servo.protection().profile.max_force > 0.0;
        let all = if is_felt { servo.guides(0) } else { &[] };
        let (points, guides) = (servo.touches().len(), all.len());
        let report =
            |guide: &Guide| GuideReport { kind: guide.kind_name(), ..GuideReport::default() };
        Self {
            reports: all.iter().map(report).collect(),
            ticks: vec![0; guides],
            places: vec![None; points],
            forces: vec![Vector::ZERO; points * guides],
        }
    }

    /// Counts a tick.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn tick(&mut self, servo: &Servo) {
        let guides = self.reports.len();
        if guides == 0 {
            return;
        }
        let per_metre = 1.0 / servo.protection().map.scale();
        let points = (0..).zip(servo.touches()).zip(&mut self.places);
        for (((point, touch), place), forces) in
            points.zip(self.forces.chunks_exact_mut(guides))
        {
            let here = Some(touch.device).filter(|device| device.is_finite());
            let way =
                place.zip(here).map_or(Vector::ZERO, |(last, here)| here - last) * per_metre;
            *place = here;
            let seen = servo.guides(point).iter().zip(forces).zip(&mut self.reports);
            for ((guide, force), report) in seen {
                let work = force.dot(way);
                report.given += work.max(0.0);
                report.taken += (-work).max(0.0);
                *force = guide.last_force();
                report.largest_force = report.largest_force.max(force.norm());
            }
        }
        for (guide, ticks) in self.ticks.iter_mut().enumerate() {
            let holds =
                |point: u32| servo.guides(point).get(guide).is_some_and(|g| g.is_engaged());
            *ticks += u64::from((0..servo.touches().len() as u32).any(holds));
        }
    }

    /// The reports, in the order of the servo's guides.
    pub(crate) fn reports(&self, rate: f64) -> Vec<GuideReport> {
        let of = |(report, ticks): (&GuideReport, &u64)| GuideReport {
            time: *ticks as f64 / rate,
            ..*report
        };
        self.reports.iter().zip(&self.ticks).map(of).collect()
    }
}
