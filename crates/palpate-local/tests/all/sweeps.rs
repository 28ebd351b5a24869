// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Local searches for a first touch: what they find is a touch, and no earlier than proven.

use arbitrary::Unstructured;
use palpate_field::{Pose, Screw, Shape, Vector};
use palpate_local::{ElementMethod, PairMethod, SampledSweep, SpaceTimeGoldenSection};
use palpate_mesh::{Outline, TriangleMesh};
use palpate_query::{
    Element, ElementSweep, Moving, QueryError, SweepSettings, sweep_element, sweep_mesh,
};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::cases;
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::Solid;

type Outcome = Result<(), Box<dyn std::error::Error>>;

/// A cube of 0.2 m.
fn cube() -> TriangleMesh {
    let corner =
        |k: usize| Vector([0, 1, 2].map(|axis| if k >> axis & 1 == 0 { -0.1 } else { 0.1 }));
    let quads =
        [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    let faces = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    TriangleMesh::new((0..8).map(corner).collect(), faces.collect()).unwrap()
}

fn are_touches_no_earlier_than_proven<const N: usize, const D: usize>(count: u64)
where
    Space: Solid<D> + Turn<D>,
{
    let (mut found_both, mut touching) = (0, 0);
    let mut workspace = ElementSweep::new();
    cases::on_trees(count, 4, |u: &mut Unstructured<'_>, _, shape| {
        let size = draw::size(shape);
        let mut vertices = [Vector::ZERO; N];
        for vertex in &mut vertices {
            *vertex = draw::direction::<D>(u)? * (0.3 * size * draw::unit(u)?);
        }
        let element = Element::new(vertices).unwrap();
        let (screw, field) = (draw::screw(u, size, 0)?, draw::screw(u, size, 0)?);
        let settings = SweepSettings { budget: 20_000, ..SweepSettings::of_size(size) };
        let moving = Moving::new(shape, field);
        let proven = sweep_element(moving, &element, screw, &settings, &mut workspace).unwrap();
        let gap = 0.5 * settings.gap;
        let local = SpaceTimeGoldenSection::default().with_longest(0.1 * size);
        let found = local.first_touch(moving, &element, screw, gap).unwrap();
        touching += u64::from(proven.touches() == Some(true));
        let Some(touch) = found.touch else { return Ok(Ok(())) };
        found_both += u64::from(proven.touches() == Some(true));
        let field_there = moving.at(touch.time);
        let there = field_there.world_from_body.inverse().transform_point(touch.point);
        let value = shape.distance(there);
        let rounding = 1e-9 * size;
        if (value - touch.value).abs() > rounding || touch.value > gap {
            return Ok(Err(format!("{value} is not {}", touch.value)));
        }
        if touch.time < proven.lower {
            return Ok(Err(format!("{touch:?} is earlier than {proven:?}")));
        }
        Ok(Ok(()))
    });
    assert!(2 * found_both > touching && touching > 0, "{found_both} of {touching} were found");
}

#[test]
fn touches_are_no_earlier_than_proven_in_space() {
    are_touches_no_earlier_than_proven::<3, 3>(200);
}

#[test]
fn touches_are_no_earlier_than_proven_in_the_plane() {
    are_touches_no_earlier_than_proven::<2, 2>(200);
}

/// A swinging arm meets a ball: the point that touches first is in the middle of the arm.
#[test]
fn the_time_of_a_swing_is_that_of_the_closed_form() -> Outcome {
    // An arm along x from 1 m to 3 m turns about the origin by a quarter; a ball of 0.1 m stands
    // at the angle 45°, 2 m away: the arm touches where 2·sin(45° − φ) = 0.1.
    let ball = Shape::<2>::ball(0.1)?;
    let at = 2.0_f64.sqrt();
    let ball = Moving::from(palpate_query::Placed::new(&ball, Pose::translation([at, at])));
    let arm = Element::new([Vector([1.0, 0.0]), Vector([3.0, 0.0])])?;
    let quarter =
        Pose::new(palpate_field::Rotation::from_angle(90_f64.to_radians())?, Vector::ZERO);
    let swing = Screw::new(Pose::identity(), quarter, 0)?;
    let truth = (45_f64.to_radians() - (0.1_f64 / 2.0).asin()) / 90_f64.to_radians();
    let found = SpaceTimeGoldenSection::default().first_touch(ball, &arm, swing, 1e-7)?;
    let touch = found.touch.ok_or("none was found")?;
    assert!((touch.time - truth).abs() < 1e-6, "{touch:?}, {truth}");
    Ok(())
}

/// The broad phase leaves out the elements that stay away; the earliest touch is that of the mesh.
#[test]
fn a_mesh_touches_where_its_elements_do() -> Outcome {
    let floor = Shape::<3>::cuboid([4.0, 0.2, 4.0])?;
    let cube = cube();
    let [from, to] = [2.0, -2.0].map(|y| Pose::translation([0.0, y, 0.0]));
    let falls = Screw::new(from, to, 0)?;
    let local = SpaceTimeGoldenSection::default();
    let found = local.first_touch_of_mesh(&floor, &cube, falls, 1e-6)?;
    let touch = found.touch.ok_or("none was found")?;
    // 1.8 m of 4 m.
    assert!((touch.time - 0.45).abs() < 1e-6, "{touch:?}");
    assert!((touch.point[1] - 0.1).abs() < 1e-5, "{touch:?}");
    let [plate, there] = [Shape::<3>::cuboid([4.0, 0.01, 4.0])?, Shape::<3>::ball(0.1)?];
    let touches = local.touches_of_mesh(&plate, &cube, falls, 1e-6)?;
    assert_eq!(touches.len(), 12);
    let parts = local.with_longest(0.06).touches_of_mesh(&plate, &cube, falls, 1e-6)?;
    assert!(parts.len() > 100, "{}", parts.len());
    let aside = Moving::new(&there, Pose::translation([1.0, 0.0, 0.0]));
    let passes = local.first_touch_of_mesh(aside, &cube, falls, 1e-6)?;
    assert!(passes.touch.is_none() && passes.searched == 0, "{passes:?}");
    Ok(())
}

/// Steps of time pass a thin plate; what is proven does not.
#[test]
fn samples_pass_a_thin_plate_that_the_proof_finds() -> Outcome {
    let plate = Shape::<3>::cuboid([4.0, 1e-4, 4.0])?;
    let [from, to] = [1.33, -1.0].map(|y| Pose::translation([0.0, y, 0.0]));
    let falls = Screw::new(from, to, 0)?;
    let (cube, sampled) = (cube(), SampledSweep::new(60, 1e-6));
    // The upright faces meet the plate for 5 of 60 steps, but the lowest value on them must be found.
    let settings = SweepSettings::of_size(1.0);
    let proven = sweep_mesh(&plate, &cube, falls, &settings, &mut ElementSweep::new())?;
    assert_eq!(proven.touches(), Some(true));
    for method in ElementMethod::ALL {
        let found = sampled.of_mesh(&plate, &cube, falls, *method)?;
        assert!(
            found.touch.is_none_or(|touch| touch.time >= proven.lower),
            "{method}: {found:?}"
        );
    }
    let ball = Shape::<3>::ball(0.004)?;
    let ball = Moving::new(&ball, falls);
    for method in PairMethod::ALL {
        assert!(sampled.of_pair(&plate, ball, *method)?.touch.is_none(), "{method}");
    }
    Ok(())
}

/// A large ball that falls on a large one is found by each of the methods, at the first step at which
/// they overlap.
#[test]
fn samples_find_what_is_thicker_than_a_step() -> Outcome {
    let ball = Shape::<3>::ball(0.5)?;
    let [from, to] = [2.0, 0.0].map(|y| Pose::translation([0.0, y, 0.0]));
    let falls = Moving::new(&ball, Screw::new(from, to, 0)?);
    for method in PairMethod::ALL {
        let found = SampledSweep::new(7, 1e-6).of_pair(&ball, falls, *method)?;
        let touch = found.touch.ok_or("none was found")?;
        // After 4 of 7 steps the centres are 6/7 m apart.
        assert!((touch.time - 4.0 / 7.0).abs() < 1e-12, "{method}: {touch:?}");
    }
    let square = Outline::new(
        [[-1.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(Vector).to_vec(),
        vec![[0, 1], [1, 2], [2, 0]],
    )?;
    let disc = Shape::<2>::ball(0.5)?;
    let [from, to] = [2.0, 0.0].map(|y| Pose::translation([0.0, y]));
    let falls = Screw::new(from, to, 0)?;
    for method in ElementMethod::ALL {
        let found = SampledSweep::new(7, 1e-6).of_mesh(&disc, &square, falls, *method)?;
        let touch = found.touch.ok_or("none was found")?;
        // After 6 of 7 steps the lower side is 2/7 m high.
        assert!((touch.time - 6.0 / 7.0).abs() < 1e-12, "{method}: {touch:?}");
    }
    Ok(())
}

#[test]
fn what_cannot_be_searched_is_refused() -> Outcome {
    let ball = Shape::<2>::ball(0.5)?;
    let edge = Element::new([Vector([1.0, 0.0]), Vector([1.0, 1.0])])?;
    let rest = || Pose::<2>::identity();
    let local = SpaceTimeGoldenSection::default();
    for gap in [0.0, -1.0, f64::NAN] {
        let refused = local.first_touch(&ball, &edge, rest(), gap);
        assert!(matches!(refused, Err(QueryError::Setting { what: "gap", .. })), "{refused:?}");
    }
    let endless = local.with_longest(0.0).first_touch(&ball, &edge, rest(), 1e-6);
    assert!(matches!(endless, Err(QueryError::Setting { what: "longest", .. })));
    let none = SampledSweep::new(0, 1e-6).of_pair(&ball, &ball, PairMethod::SumDescent);
    assert!(matches!(none, Err(QueryError::Setting { what: "samples", .. })));
    Ok(())
}
