// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Definition of the screw thread.

use std::f64::consts::TAU;

use palpate_field::kernel::Argument;
use palpate_field::{Point, Vector};

use super::{Definition, Patch, number, vector};

/// The profile of a thread along its axis.
#[derive(Clone, Copy)]
struct Thread {
    radius: f64,
    half: f64,
    pitch: f64,
    lead: f64,
    crest: f64,
    root: f64,
    depth: f64,
}

impl Thread {
    /// The radius at `h` along the profile, of which a crest's middle is at zero.
    fn radius(&self, h: f64) -> f64 {
        let from_crest = (h - self.pitch * (h / self.pitch).round()).abs();
        let past = from_crest - 0.5 * self.crest;
        let width = 0.5 * (self.pitch - self.crest - self.root);
        if past <= 0.0 {
            self.radius
        } else if past >= width {
            self.radius - self.depth
        } else {
            self.radius - self.depth * past / width
        }
    }

    fn contains(&self, p: Point<3>) -> bool {
        // Right-handed: from +x towards −z while it climbs.
        let turn = (-p[2]).atan2(p[0]) / TAU;
        p[1].abs() < self.half && p[0].hypot(p[2]) < self.radius(p[1] - self.lead * turn)
    }

    /// Where the helix of the place `h` along the profile is at the height `y`, at `radius`.
    fn at(&self, h: f64, radius: f64, y: f64) -> Point<3> {
        let angle = TAU * (y - h) / self.lead;
        Vector([radius * angle.cos(), y, -radius * angle.sin()])
    }

    /// What the segment of the profile from one place and radius to another sweeps along the
    /// thread, and on both ends.
    fn swept(self, [from, to]: [[f64; 2]; 2]) -> [Patch<3>; 3] {
        let on = move |share: f64| [0, 1].map(|k| from[k] + (to[k] - from[k]) * share);
        let around = TAU * self.radius / self.lead.abs();
        let across = (to[1] - from[1]).hypot((to[0] - from[0]) * around);
        let along = 2.0 * self.half * 1.0_f64.hypot(around);
        let side = Patch::surface([across, along], move |u, v| {
            let [h, radius] = on(u);
            self.at(h, radius, self.half * (2.0 * v - 1.0))
        });
        let end = |y: f64| {
            Patch::surface([across, self.radius], move |u, v| {
                let [h, radius] = on(u);
                self.at(h, radius * v, y)
            })
        };
        [side, end(self.half), end(-self.half)]
    }
}

pub(super) fn definition(a: &[Argument]) -> Definition<3> {
    let [crest, root, depth] = vector::<3>(a, 4).0;
    let (pitch, starts) = (number(a, 2), number(a, 3));
    let thread = Thread {
        radius: number(a, 0),
        half: 0.5 * number(a, 1),
        pitch: pitch.abs(),
        lead: pitch * starts,
        crest,
        root,
        depth,
    };
    let (high, low) = (thread.radius, thread.radius - depth);
    let mut boundary = Vec::new();
    for start in 0..starts as u32 {
        let middle = f64::from(start) * thread.pitch;
        let corners = [
            [middle - 0.5 * crest, high],
            [middle + 0.5 * crest, high],
            [middle + 0.5 * (thread.pitch - root), low],
            [middle + 0.5 * (thread.pitch + root), low],
            [middle + thread.pitch - 0.5 * crest, high],
        ];
        for ends in corners.windows(2) {
            boundary.extend(thread.swept([ends[0], ends[1]]));
        }
    }
    Definition::new(boundary, move |p| thread.contains(p))
}
