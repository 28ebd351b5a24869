// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that move: never late, and early by the tolerance at most.
#![expect(clippy::unwrap_used, reason = "these are tests")]

use std::f64::consts::PI;

#[expect(unreachable_pub, reason = "shared with the fuzz target")]
#[path = "../../../../fuzz/sweep_answers.rs"]
mod sweep_answers;

use palpate_field::kernel::HalfSpace;
use palpate_field::{Pose, Rotation, Screw, Shape, Vector};
use palpate_query::{
    FirstTouch, Limits, ManifoldSettings, Moving, PairWorkspace, Placed, QueryError, Start,
    Stop, SweepSettings, SweepWorkspace, manifold, sweep,
};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::cases;
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::Solid;

fn at<const D: usize>(place: [f64; D]) -> Pose<D> {
    Pose::translation(place)
}

/// A shape that moves between two poses.
fn moves<'a, const D: usize>(shape: &'a Shape<D>, from: Pose<D>, to: Pose<D>) -> Moving<'a, D> {
    Moving::new(shape, Screw::new(from, to, 0).unwrap())
}

fn first<const D: usize>(a: Moving<'_, D>, b: Moving<'_, D>) -> FirstTouch<D> {
    let settings = SweepSettings { time_tolerance: 1e-7, ..SweepSettings::of_size(1.0) };
    sweep(a, b, &settings, &mut SweepWorkspace::new()).unwrap()
}

/// The bounds hold this time, and are together.
fn is_at<const D: usize>(found: &FirstTouch<D>, time: f64) {
    let near = (found.upper - time).abs() <= 2e-6 && found.lower <= time + 1e-12;
    assert!(near && found.upper - found.lower <= 1e-5, "{found:?}, {time}");
    assert_eq!((found.touches(), found.stop), (Some(true), Stop::Converged));
}

#[test]
fn balls_and_boxes_touch_when_equations_say() {
    let ball = Shape::<3>::ball(0.5).unwrap();
    let block = Shape::<3>::cuboid([1.0, 1.0, 1.0]).unwrap();
    let floor = Shape::<3>::half_space([0.0, 1.0, 0.0], 0.0).unwrap();
    // A ball falls on a floor from 3 m to −1 m: at (3 − 0.5) / 4.
    let falling = moves(&ball, at([0.0, 3.0, 0.0]), at([0.3, -1.0, 0.2]));
    is_at(&first((&floor).into(), falling), 0.625);
    // Two balls towards each other, 3 m apart, 2 m and 1 m: at (3 − 1) / 3.
    let right = moves(&ball, at([0.0, 0.0, 0.0]), at([2.0, 0.0, 0.0]));
    let left = moves(&ball, at([3.0, 0.0, 0.0]), at([2.0, 0.0, 0.0]));
    is_at(&first(right, left), 2.0 / 3.0);
    // Both turn about themselves as well: at (3 − 1) / 2.4.
    let turned = |x: f64, angle: f64| {
        Pose::new(Rotation::identity().turned([0.0, angle, 0.0]), Vector([x, 0.0, 0.0]))
    };
    let stays = moves(&ball, turned(0.0, 0.0), turned(0.0, 1.0));
    let comes = [0.0, 2.0].map(|angle| turned(3.0 - 1.2 * angle, angle));
    let comes = Screw::new(comes[0], comes[1], 0).unwrap();
    // A ball that turns as it goes has its centre on an arc.
    let time = (0..1_000_000).map(|i| f64::from(i) * 1e-6);
    let mut time = time.filter(|t| comes.pose(*t).translation.norm() <= 1.0);
    is_at(&first(stays, Moving::new(&ball, comes)), time.next().unwrap());
    // An edge of a box that swings about z by a right angle meets a floor under its centre.
    let under = Shape::<3>::half_space([0.0, 1.0, 0.0], -0.6).unwrap();
    let swung = Pose::new(Rotation::identity().turned([0.0, 0.0, 0.5 * PI]), Vector::ZERO);
    // The corner is √½ m from the centre; it is at −0.6 m when sin(45° + φ) = 0.6 / √½.
    let phi = (0.6 / 0.5_f64.sqrt()).asin() - 0.25 * PI;
    is_at(&first((&under).into(), moves(&block, at([0.0; 3]), swung)), phi / (0.5 * PI));
}

/// A floor that turns by 90° about the origin, towards a ball of 0.5 m whose centre is 1 m away at
/// 30° above it.
#[test]
fn a_body_without_bounds_may_turn() {
    let floor = Shape::<2>::half_space([0.0, 1.0], 0.0).unwrap();
    let ball = Shape::<2>::ball(0.25).unwrap();
    let turned = Pose::new(Rotation::from_angle(0.5 * PI).unwrap(), Vector::ZERO);
    let swings = moves(&floor, at([0.0; 2]), turned);
    let there = Placed::new(&ball, at([0.75_f64.sqrt(), 0.5]));
    // The distance to the floor is sin(30° − φ) − 0.25 m.
    let phi = PI / 6.0 - 0.25_f64.asin();
    is_at(&first(swings, there.into()), phi / (0.5 * PI));
}

#[test]
fn what_touches_at_the_start_says_how_it_moves_on() {
    let block = Shape::<2>::cuboid([1.0, 1.0]).unwrap();
    let start = |to: [f64; 2]| {
        let found = first((&block).into(), moves(&block, at([0.0, 1.0]), at(to)));
        assert_eq!((found.lower, found.upper), (0.0, 0.0));
        found.start
    };
    assert_eq!(start([0.0, 0.5]), Some(Start::Approaching));
    assert_eq!(start([0.0, 1.5]), Some(Start::Receding));
    assert_eq!(start([0.5, 1.0]), Some(Start::Sliding));
    // Once what rests on another slid.
    let rests = first((&block).into(), Placed::new(&block, at([0.0, 1.0])).into());
    assert_eq!((rests.upper, rests.start), (0.0, Some(Start::Resting)));
}

#[test]
fn motions_that_end_at_a_touch_and_bodies_at_rest() {
    let block = Shape::<2>::cuboid([1.0, 1.0]).unwrap();
    let touch = first((&block).into(), moves(&block, at([0.0, 3.0]), at([0.0, 1.0])));
    assert!(touch.lower <= 1.0 && touch.upper <= 1.0 && touch.upper > 0.999_999, "{touch:?}");
    assert_eq!(touch.touches(), Some(true));
    let apart = first((&block).into(), moves(&block, at([0.0, 3.0]), at([0.0, 1.01])));
    assert_eq!((apart.touches(), apart.upper), (Some(false), 1.0));
    let still = first((&block).into(), Placed::new(&block, at([0.0, 1.5])).into());
    assert_eq!((still.touches(), still.contact), (Some(false), None), "{still:?}");
}

/// The nearest points of the surfaces told less than the depth at an edge, and half of it in a thin body.
#[test]
fn the_contact_of_a_touch_is_as_deep_as_that_of_a_manifold() {
    let ball = Shape::<3>::ball(0.05).unwrap();
    let corner = Shape::<3>::cube(0.2).unwrap().translated([-0.1, -0.1, 0.0]).unwrap();
    let turn = Rotation::from_axis_angle(Vector([0.0, 0.0, 1.0]), PI / 6.0).unwrap();
    let corner = corner.placed(&Pose::new(turn, Vector::ZERO)).unwrap();
    let falls = moves(&ball, at([0.01, 20.0, 0.0]), at([0.01, -20.0, 0.0]));
    let plate = Shape::<3>::cuboid([1.0, 0.4, 1.0]).unwrap();
    let small = Shape::<3>::ball(0.005).unwrap();
    let stays = moves(&small, at([0.0, 0.19, 0.0]), at([0.0, 0.3, 0.0]));
    for (still, moving) in [(&corner, falls), (&plate, stays)] {
        let settings = SweepSettings::of_size(0.1);
        let mut workspace = SweepWorkspace::new();
        let touch = sweep(still, moving, &settings, &mut workspace).unwrap();
        let contact = touch.contact.unwrap();
        let margin =
            ManifoldSettings { margin: settings.gap, ..ManifoldSettings::of_size(0.1) };
        let spanned = manifold(
            still,
            moving.at(touch.upper),
            &margin,
            &Limits::new(0.25 * settings.gap),
            &mut PairWorkspace::new(),
        );
        let deepest = spanned.unwrap().contacts[0];
        assert!((contact.gap - deepest.gap).abs() < 1e-6, "{contact:?}, {deepest:?}");
        assert!(contact.normal.dot(deepest.normal) > 0.999, "{contact:?}, {deepest:?}");
        assert_eq!(contact.normal_from, deepest.normal_from);
    }
}

/// Boxes of space and time that are as small as the gap between two plates do not fit into the budget.
#[test]
fn plates_that_slide_closely_past_each_other_advance_in_time() {
    let plate = Shape::<3>::cuboid([1.0, 0.1, 1.0]).unwrap();
    let settings = SweepSettings { budget: 400_000, ..SweepSettings::of_size(1.0) };
    let slide = |to: [f64; 3]| {
        let turned = Rotation::identity().turned([0.0, 0.02, 0.0]);
        let to = Pose::new(turned, Vector(to));
        let moving = moves(&plate, at([0.0, 0.1001, 0.0]), to);
        sweep(&plate, moving, &settings, &mut SweepWorkspace::new()).unwrap()
    };
    let past = slide([0.003, 0.1001, 0.0]);
    assert_eq!((past.touches(), past.stop), (Some(false), Stop::SignKnown), "{past:?}");
    // Falls by 0.2 mm: a touch halfway.
    let falls = slide([0.003, 0.0999, 0.0]);
    assert!(falls.lower <= 0.5 && falls.upper >= 0.495, "{falls:?}");
    assert!(falls.upper - falls.lower <= 0.01, "{falls:?}");
}

/// Plates of 0.1 mm, which a cube crosses at 10 m in one step from any direction.
#[test]
fn a_thin_plate_is_not_missed() {
    let plate = Shape::<3>::cuboid([1.0, 1e-4, 1.0]).unwrap();
    let cube = Shape::<3>::cuboid([0.1, 0.1, 0.1]).unwrap();
    let settings = SweepSettings::of_size(0.1);
    let mut workspace = SweepWorkspace::new();
    cases::check(200, |u| {
        let way: Vector<f64, 3> = draw::direction(u)?;
        let turn: Vector<f64, 3> = draw::direction(u)?;
        let (from, to) = (way * -5.0, way * 5.0);
        let to = Pose::new(Rotation::identity().turned(turn * 3.0), to);
        // Turned about its own centre, which goes straight.
        let Ok(screw) = Screw::new(Pose::translation(from), to, 0) else { return Ok(Ok(())) };
        let middle = screw.pose(0.5).translation.norm();
        let found =
            sweep(&plate, Moving::new(&cube, screw), &settings, &mut workspace).unwrap();
        // A screw goes round; what passes the middle crosses the plate.
        let is_right = middle > 0.05 || found.touches() == Some(true) && found.upper <= 0.5;
        Ok(if is_right { Ok(()) } else { Err(format!("{found:?} of {screw:?}")) })
    });
}

fn on_trees<const D: usize>(count: u64)
where
    Space: Solid<D> + Turn<D>,
{
    let (mut workspace, mut still) = (SweepWorkspace::new(), PairWorkspace::new());
    let (mut asked, mut spent) = (0, 0);
    cases::numbered(count, |seed, u| {
        let memory = (&mut workspace, &mut still);
        let outcome = sweep_answers::check::<D>(u, 1 + seed % 3, memory)?;
        Ok(outcome.map(|stop| {
            asked += u64::from(stop.is_some());
            spent += u64::from(stop.is_some_and(Stop::is_early));
        }))
    });
    let count = cases::count(count);
    assert!(asked * 2 > count, "{asked} of {count} pairs were bounded");
    assert!(spent * 12 <= asked, "{spent} of {asked} sweeps spent their budget");
}

#[test]
fn random_screws_of_random_trees_are_never_late_in_space() {
    on_trees::<3>(100);
}

#[test]
fn random_screws_of_random_trees_are_never_late_in_the_plane() {
    on_trees::<2>(200);
}

#[test]
fn bodies_without_bounds_and_settings_that_are_none_are_refused() {
    let floor = Shape::<3>::half_space([0.0, 1.0, 0.0], 0.0).unwrap();
    let ball = Shape::<3>::ball(0.5).unwrap();
    let mut workspace = SweepWorkspace::new();
    let mut refused = |a: Moving<'_, 3>, settings: SweepSettings| {
        sweep(a, &ball, &settings, &mut workspace).unwrap_err()
    };
    let two = sweep(&floor, &floor, &SweepSettings::of_size(1.0), &mut SweepWorkspace::new());
    assert_eq!(two.unwrap_err(), QueryError::Unbounded);
    let settings = SweepSettings::of_size(1.0);
    for wrong in [0.0, -1.0, f64::NAN] {
        let error = refused((&floor).into(), SweepSettings { gap: wrong, ..settings });
        assert!(matches!(error, QueryError::Setting { what: "gap", .. }), "{error}");
        let error =
            refused((&floor).into(), SweepSettings { time_tolerance: wrong, ..settings });
        assert!(matches!(error, QueryError::Setting { what: "time_tolerance", .. }), "{error}");
    }
}

/// Bodies that lie on each other, or overlap a little, and part: the places at which they touch are as
/// small as the gap, and no search by boxes finds them all.
#[test]
fn bodies_that_rest_on_each_other_and_part_touch_at_the_start() {
    let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0, 0.0]), 0.0).unwrap());
    let bodies = [Shape::<3>::ball(0.5).unwrap(), Shape::<3>::cuboid([1.0, 1.0, 1.0]).unwrap()];
    let settings = SweepSettings::of_size(1.0);
    for body in &bodies {
        for overlap in [0.0, 1e-6, 1e-5, 1e-4, 1e-2] {
            let [from, to] = [0.5 - overlap, 4.0].map(|y| Pose::translation([0.0, y, 0.0]));
            let rises = Moving::new(body, Screw::new(from, to, 0).unwrap());
            let touch = sweep(&floor, rises, &settings, &mut SweepWorkspace::new()).unwrap();
            assert_eq!(
                (touch.upper, touch.start),
                (0.0, Some(Start::Receding)),
                "{overlap}: {touch:?}"
            );
            assert!(touch.evaluations < 100_000, "{touch:?}");
        }
    }
}

/// Bodies that are through each other within a fraction of the tolerance: their touch was looked for at
/// the end of the tolerance alone, and boxes filled the memory.
#[test]
fn what_passes_within_a_tolerance_is_found() {
    let along = |axis: usize| {
        let end = Vector::<f64, 3>::unit(axis);
        Shape::<3>::segment(-end, end, 0.0).unwrap()
    };
    let (wire, other, ball) = (along(0), along(2), Shape::<3>::ball(1e-3).unwrap());
    for way in [1.0, 1e3] {
        let [above, below] = [way, -way].map(|y| at([0.01, y, 0.0]));
        for (thrown, reach) in [(&other, 0.0), (&ball, 1e-3)] {
            let found = first((&wire).into(), moves(thrown, above, below));
            is_at(&found, 0.5 - 0.5 * reach / way);
        }
    }
}

/// A cube that slides over a plate into a wall: a touch that was known early, not when first, once ended
/// the search with most of its budget unspent.
#[test]
fn a_late_touch_that_is_known_soon_does_not_end_the_search() {
    let plate = Shape::<3>::cuboid([4.0, 1.0, 2.0]).unwrap();
    let wall =
        Shape::<3>::cuboid([1.0, 2.0, 2.0]).unwrap().translated([2.5, 1.0, 0.0]).unwrap();
    let ground = plate | wall;
    let cube = Shape::<3>::cuboid([1.0; 3]).unwrap();
    let slides = moves(&cube, at([-1.0, 1.0001, 0.0]), at([3.0, 1.0001, 0.0]));
    let settings = SweepSettings::of_size(1.0);
    let found = sweep(&ground, slides, &settings, &mut SweepWorkspace::new()).unwrap();
    assert_eq!(found.stop, Stop::Converged, "{found:?}");
    assert!(found.lower <= 0.625 && found.upper - found.lower <= 1e-4, "{found:?}");
}

/// A peg that goes into its hole with little room: the memory is full before it is proven free, and its
/// touch at the bottom was not looked for.
#[test]
fn a_search_that_ends_early_still_knows_a_touch() {
    let hole = Shape::<3>::cylinder(0.020_001, 0.2).unwrap();
    let block = Shape::<3>::cuboid([0.1, 0.1, 0.1]).unwrap()
        - hole.translated([0.0, 0.08, 0.0]).unwrap();
    let peg = Shape::<3>::cylinder(0.02, 0.05).unwrap();
    let found = first((&block).into(), moves(&peg, at([0.0, 0.1, 0.0]), at([0.0, 0.0, 0.0])));
    // The bottom of the hole is at −0.02 m, that of the peg 0.025 m below its middle.
    let truth = 0.95;
    assert!(found.lower <= truth && (found.upper - truth).abs() < 2e-3, "{found:?}");
}
