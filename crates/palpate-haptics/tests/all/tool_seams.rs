// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rods across the seam of two level bodies of different stiffness, which stand still.

use crate::common::cuboid;
use crate::common::tools::{at, rest, smooth, springs, turned};
use palpate_field::{Pose, Vector};
use palpate_haptics::{Bodies, Body, Material, Shell, Surface, Tool, ToolOptions};

const SOFT: f64 = 300.0;
const STIFF: f64 = 1000.0;
const RADIUS: f64 = 0.002;
const DEPTH: f64 = 0.006;

/// A soft plate for x < 0 and a stiff one for x > 0, whose level tops are at y = 0.
fn plates() -> Bodies {
    let plate = |x, stiffness| {
        let surface = Surface::new(&Material { stiffness, ..smooth() }).unwrap();
        let body = Body::new(cuboid([0.1, 0.02, 0.1]), surface).unwrap();
        body.at(Pose::translation(Vector([x, -0.01, 0.0]))).unwrap()
    };
    Bodies::new(vec![plate(-0.05, SOFT), plate(0.05, STIFF)]).unwrap()
}

/// A rod of 30 mm along x that lies on the plates.
fn rod(bodies: &mut Bodies) -> Tool {
    let ends = [-0.013, 0.013].map(|x| Vector([x, 0.0, 0.0]));
    let options = ToolOptions { stiffness: STIFF, max_force: Some(7.9), ..springs() };
    let mut tool = Tool::new(Shell::capsule(ends, RADIUS, 15).unwrap(), options).unwrap();
    tool.step(bodies, &at([-0.04, 0.01, 0.0]));
    tool
}

/// Once the force stepped from 6 N to 1.8 N in a tick.
#[test]
fn a_rod_that_slides_over_a_seam_feels_one_stiffness_blend_into_the_other() {
    let mut bodies = plates();
    let mut tool = rod(&mut bodies);
    let (mut last, mut step) = (SOFT * DEPTH, 0.0_f64);
    rest(&mut tool, &mut bodies, &at([-0.03, RADIUS - DEPTH, 0.0]));
    for tick in -2500..=2500 {
        let x = 1.2e-5 * f64::from(tick);
        let force = tool.step(&mut bodies, &at([x, RADIUS - DEPTH, 0.0])).force;
        let up = force[1];
        step = step.max((up - last).abs());
        let expected = match tick {
            -2500 => Some(SOFT),
            0 => Some(0.5 * (SOFT + STIFF)),
            2500 => Some(STIFF),
            _ => None,
        };
        if let Some(stiffness) = expected {
            assert!((up - stiffness * DEPTH).abs() < 1e-6, "{x}: {up}");
        }
        assert!(up >= last - 1e-6, "{x}: {up} after {last}");
        last = up;
    }
    assert!(step < 0.005, "{step}");
}

/// The search finds another pair of points that bear the rod for either turn.
#[test]
fn a_rod_over_a_seam_does_not_feel_which_of_its_points_bear_it() {
    let mut bodies = plates();
    let mut tool = rod(&mut bodies);
    for x in [-0.008, -0.001, 0.003, 0.0117] {
        let mut felt = |turn| {
            let state = turned([0.0, 0.0, 1.0], turn, [x, RADIUS - DEPTH, 0.0]);
            rest(&mut tool, &mut bodies, &state).force[1]
        };
        let flat = felt(0.0);
        for turn in [1e-7, -1e-7] {
            let turned = felt(turn);
            assert!((turned - flat).abs() < 1e-4, "{x}, {turn}: {turned}, {flat}");
        }
    }
}
