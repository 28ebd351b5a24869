// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contacts for a solver: the first ones of a pair, and those of a pair at rest.

use std::error::Error;
use std::hint::black_box;

use palpate::field::kernel::{CoolS, RegularStar};
use palpate::field::{Pose, Rotation, Shape, Vector};
use palpate::query::{
    Limits, ManifoldSettings, PairWorkspace, Placed, QueryError, Track, separation,
};

use super::{TimedRows, fastest};

/// Steps at rest.
const STEPS: u32 = 100;

/// How far a solver moves what rests, at most [m].
const TREMBLE: f64 = 1e-9;

/// How deep bodies overlap at most [m].
const DEEP: f64 = 2e-4;

/// The name of a pair, its shapes, and where the second one is above the first.
struct Pair<const D: usize> {
    name: &'static str,
    shapes: [Shape<D>; 2],
    above: Pose<D>,
}

fn in_space() -> Result<Vec<Pair<3>>, Box<dyn Error>> {
    let cube = || Shape::<3>::cuboid([0.1; 3]);
    let cup = Shape::<3>::cylinder(0.1, 0.2)?
        - Shape::<3>::cylinder(0.085, 0.2)?.translated([0.0, 0.015, 0.0])?;
    let mut parts = vec![Shape::<3>::cuboid([0.4, 0.02, 0.4])?];
    for (x, z) in [(0.19, 0.19), (-0.19, 0.19), (0.19, -0.19), (-0.19, -0.19)] {
        parts.push(Shape::<3>::cuboid([0.01, 0.3, 0.01])?.translated([x, -0.15, z])?);
    }
    let turn = Rotation::from_axis_angle([0.0, 1.0, 0.0], 0.3)?;
    let above = |x: f64, z: f64| Pose::new(turn, [x, 0.5, z]);
    let large = Shape::<3>::cuboid([0.4, 0.1, 0.4])?;
    let table = Shape::union(parts)?;
    Ok(vec![
        Pair { name: "boxes", shapes: [large, cube()?], above: above(0.1, 0.05) },
        Pair { name: "cup_cube", shapes: [cup, cube()?], above: above(0.0, 0.0) },
        Pair { name: "table_cube", shapes: [table, cube()?], above: above(0.05, -0.03) },
    ])
}

fn in_the_plane() -> Result<Vec<Pair<2>>, Box<dyn Error>> {
    let star = Shape::from_kernel(RegularStar::new(5, 0.12, 0.06)?);
    let cool = Shape::from_kernel(CoolS::new(0.3)?);
    let above = |angle: f64, x: f64| -> Result<_, Box<dyn Error>> {
        Ok(Pose::new(Rotation::from_angle(angle)?, [x, 1.0]))
    };
    Ok(vec![
        Pair { name: "stars", shapes: [star.clone(), star], above: above(0.1, 0.03)? },
        Pair { name: "cool_s", shapes: [cool.clone(), cool], above: above(0.4, 0.05)? },
    ])
}

/// Adds the rows of tracks.
pub(super) fn measure(rows: &mut TimedRows) -> Result<(), Box<dyn Error>> {
    in_space()?.into_iter().try_for_each(|pair| ask(pair, rows))?;
    in_the_plane()?.into_iter().try_for_each(|pair| ask(pair, rows))
}

/// The second body let down onto the first.
fn let_down<const D: usize>(
    [a, b]: &[Shape<D>; 2],
    mut pose: Pose<D>,
    workspace: &mut PairWorkspace<D>,
) -> Result<Pose<D>, QueryError> {
    let limits = Limits::new(0.1 * DEEP);
    loop {
        let found = separation(a, Placed::new(b, pose), &limits, workspace)?;
        if found.upper <= 0.0 {
            return Ok(pose);
        }
        pose.translation[1] -= found.lower.max(0.0) + 0.25 * DEEP;
    }
}

fn ask<const D: usize>(pair: Pair<D>, rows: &mut TimedRows) -> Result<(), Box<dyn Error>> {
    let Pair { name, shapes, above } = pair;
    let mut workspace = PairWorkspace::new();
    let pose = let_down(&shapes, above, &mut workspace)?;
    let [a, b] = shapes;
    let new = || Track::new(a.clone(), b.clone());
    let mut track = new();
    let size = track.size();
    let settings = ManifoldSettings::for_solver(size);
    let limits = Limits::new(settings.usual_tolerance());
    let poses = |step: u32| {
        let way = Vector::constant(TREMBLE * f64::from(step % 2));
        [Pose::identity(), Pose::new(pose.rotation, pose.translation + way)]
    };
    let first = fastest(|| {
        // That it is no error is seen below.
        let _ =
            black_box(new().contacts(black_box(poses(0)), &settings, &limits, &mut workspace));
    });
    let rough = Limits::new(0.01 * size);
    let apart = fastest(|| {
        let _ =
            black_box(separation(&a, black_box(Placed::new(&b, pose)), &rough, &mut workspace));
    });
    rows.insert(format!("track.first.{name}.over_separation_1pc"), first / apart);
    let (mut evaluations, mut contacts, mut searches) = (0, 0, 0);
    for step in 0..=STEPS {
        let found = track.contacts(poses(step), &settings, &limits, &mut workspace)?;
        if step > 0 {
            evaluations += found.evaluations;
            contacts += found.contacts.len();
            searches += u32::from(found.is_searched);
        }
    }
    // A value with its gradient counts twice, for each of both bodies.
    let for_each = f64::from(evaluations) / 4.0 / contacts as f64;
    rows.insert(format!("track.rest.{name}.evaluations"), for_each);
    rows.insert(format!("track.rest.{name}.contacts"), contacts as f64 / f64::from(STEPS));
    rows.insert(format!("track.rest.{name}.searches"), f64::from(searches));
    let rest = fastest(|| {
        let _ =
            black_box(track.contacts(black_box(poses(1)), &settings, &limits, &mut workspace));
    });
    rows.add_times(&format!("track.rest.{name}"), vec![rest]);
    Ok(())
}
