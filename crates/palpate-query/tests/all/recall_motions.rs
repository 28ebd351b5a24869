// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Motions through the poses of `testdata/recall`: none touches late.
//!
//! Half of the way of each motion ends at a pose whose separation is proven. Where the bodies overlap
//! there, the first touch is not after it, whatever the search says of the rest.

use arbitrary::Unstructured;
use palpate_field::{Pose, Screw, ShapeError};
use palpate_query::{Moving, SweepSettings, SweepWorkspace, sweep};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::cases::entropy;
use palpate_testkit::kernels::Space;
use palpate_testkit::recall::{Pair, Row, Turned, in_space, in_the_plane, rows};
use palpate_testkit::separation::separation;

use crate::recall::{Report, on_rows};

/// The gap and the budget of a sweep; bodies are about 1 m large.
const GAP: f64 = 1e-5;
const BUDGET: u32 = 50_000;

/// The share of sweeps that may spend it.
const SPENT: f64 = 0.05;

/// Of so many motions, the touch of one is proven by the plain search, with so many cells.
const MOTIONS_A_PROOF: u64 = 50;
const CELLS: usize = 20_000;

/// A motion with the pose of a row in its middle, and as far to both sides; `None` where half of it
/// turns by a quarter turn or more.
fn motion<const D: usize>(row: &Row<D>) -> Result<Option<Screw<D>>, ShapeError>
where
    Space: Turned<D> + Turn<D>,
{
    let bytes = entropy(row.seed ^ 0x5bd1_e995);
    let Ok(half) = draw::pose::<D>(&mut Unstructured::new(&bytes)) else { return Ok(None) };
    let half = Screw::new(Pose::identity(), half, 0)?;
    // Half of a motion that turns by at most half a turn.
    let (half, there) = (half.pose(0.5), row.pose()?);
    let screw = Screw::new(there * half.inverse(), there * half, 0)?;
    let (middle, expected) = (screw.pose(0.5), there);
    let off = (middle.translation - expected.translation).norm();
    Ok((off < 1e-9).then_some(screw))
}

fn asked<const D: usize>(pair: &Pair<D>, row: &Row<D>) -> Result<Report, ShapeError>
where
    Space: Turned<D> + Turn<D>,
{
    let mut report = Report { rows: 1, ..Report::default() };
    let Some(screw) = motion(row)? else { return Ok(Report::default()) };
    let [a, b] = &pair.bodies;
    let moving = Moving::new(b, screw);
    let settings = SweepSettings { gap: GAP, budget: BUDGET, ..SweepSettings::of_size(1.0) };
    let found = match sweep(a, moving, &settings, &mut SweepWorkspace::new()) {
        Ok(found) => found,
        Err(error) => {
            report.wrong.push(format!("{row}: {error}"));
            return Ok(report);
        }
    };
    let is_late = row.truth.upper < 0.0 && found.lower > 0.5;
    let mut is_early = false;
    if found.touches() == Some(true) && (row.seed / 100).is_multiple_of(MOTIONS_A_PROOF) {
        let there = moving.at(found.upper).world_from_body;
        let poses = [(a, Pose::identity()), (b, there)];
        let proven = separation(poses, CELLS, |known| known.lower > GAP || known.upper <= GAP);
        is_early = proven.lower > GAP;
    }
    let told = format!("{row} on {screw:?}: {found:?}");
    match () {
        () if is_late || is_early => report.wrong.push(told),
        () if found.stop.is_early() => report.signs_spent.push(told),
        () => {}
    }
    Ok(report)
}

fn replayed<const D: usize>(pairs: &[Pair<D>], expected: usize)
where
    Space: Turned<D> + Turn<D>,
{
    let rows = rows::<D>().expect("rows");
    let Report { rows, wrong, signs_spent, .. } =
        on_rows(pairs, &rows, |pair, row, _| asked(pair, row));
    println!("{rows} motions, {} spent", signs_spent.len());
    assert!(wrong.is_empty(), "{} of {rows} are wrong, such as {}", wrong.len(), wrong[0]);
    assert!(rows >= expected, "{rows} motions");
    let is_few = signs_spent.len() as f64 <= SPENT * rows as f64;
    assert!(is_few, "{} of {rows} are spent, such as {}", signs_spent.len(), signs_spent[0]);
}

#[test]
#[ignore = "slow: cargo xtask test --thorough"]
fn no_motion_in_space_touches_late() -> Result<(), ShapeError> {
    replayed(&in_space()?, 9500);
    Ok(())
}

#[test]
fn no_motion_in_the_plane_touches_late() -> Result<(), ShapeError> {
    replayed(&in_the_plane()?, 2300);
    Ok(())
}
