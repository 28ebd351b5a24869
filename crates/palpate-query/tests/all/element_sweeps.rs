// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Segments and triangles that move: never late, and early by the tolerance at most.
#![expect(clippy::unwrap_used, reason = "these are tests")]

use palpate_field::{Pose, Shape, Vector};
use palpate_query::{
    Element, ElementSweep, ElementWorkspace, Limits, Moving, Stop, SweepSettings, minimum,
    sweep_element,
};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::cases;
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::Solid;

/// Times of the way that are looked at, and points of the element at each.
const TIMES: u32 = 100;
const POINTS: u32 = 20;

fn on_trees<const N: usize, const D: usize>(count: u64, is_carried: bool)
where
    Space: Solid<D> + Turn<D>,
{
    let (mut ran, mut spent, mut touched) = (0, 0, 0);
    let (mut workspace, mut still) = (ElementSweep::new(), ElementWorkspace::new());
    cases::on_trees(count, 4, |u, _, shape| {
        let size = draw::size(shape);
        let screw = draw::screw(u, size, 0)?;
        let field = if is_carried { Some(draw::screw(u, 0.3 * size, 0)?) } else { None };
        let wide = size * [0.01, 0.1, 0.5][u.choose_index(3)?];
        let mut vertices = [Vector::ZERO; N];
        for vertex in &mut vertices {
            let way: Vector<f64, D> = draw::direction(u)?;
            *vertex = way * wide;
        }
        let element = Element::new(vertices).unwrap();
        let moving = field.map_or(Moving::from(shape), |screw| Moving::new(shape, screw));
        let settings =
            SweepSettings { gap: 1e-4 * size, budget: 500_000, ..SweepSettings::of_size(size) };
        let answer = sweep_element(moving, &element, screw, &settings, &mut workspace).unwrap();
        let wrong =
            |what: String| Ok(Err(format!("{what}: {answer:?} of {element:?} on {screw:?}")));
        for time in 0..TIMES {
            let time = answer.lower * f64::from(time) / f64::from(TIMES);
            let place = moving.at(time).world_from_body.inverse() * screw.pose(time);
            for _ in 0..POINTS {
                let mut weights = [0.0; N];
                for weight in &mut weights {
                    *weight = draw::within(u, 0.0, 1.0)?;
                }
                let sum: f64 = weights.iter().sum();
                let p = place.transform_point(element.at(&weights.map(|w| w / sum.max(1e-9))));
                let value = shape.distance(p);
                if answer.lower > 0.0
                    && value < 0.5 * settings.gap - shape.promise().rounding.within(p.norm())
                {
                    return wrong(format!("{value} m at {time}"));
                }
            }
        }
        if answer.touches() == Some(true) {
            touched += 1;
            let time = answer.upper;
            let place = moving.at(time).world_from_body.inverse() * screw.pose(time);
            let there = Element::new(vertices.map(|p| place.transform_point(p))).unwrap();
            let limits = Limits::new(1e-5 * size);
            let least = minimum(shape, &there, &limits, &mut still).unwrap();
            if least.lower > settings.gap {
                return wrong(format!("{} m where it touches", least.lower));
            }
            if answer.stop == Stop::Converged && answer.upper - answer.lower > 1.01e-4 {
                return wrong("not converged".into());
            }
        } else if answer.stop == Stop::SignKnown && answer.lower < 1.0 {
            return wrong("free, but not to the end".into());
        }
        ran += 1;
        spent += u64::from(answer.stop.is_early());
        Ok(Ok(()))
    });
    assert!(spent * 50 <= ran, "{spent} of {ran} spent their budget");
    assert!(touched * 10 > ran, "{touched} of {ran} touched");
}

#[test]
fn triangles_in_space_are_never_late() {
    on_trees::<3, 3>(200, false);
    on_trees::<3, 3>(200, true);
}

#[test]
fn segments_are_never_late() {
    on_trees::<2, 2>(200, false);
    on_trees::<2, 3>(200, true);
}

/// In a field steeper than one, an element that rests spent the whole budget: a point at rest left the
/// balls at no time.
#[test]
fn what_rests_beside_a_steep_field_is_free_at_once() {
    let twisted = Shape::<3>::cuboid([1.0, 1.0, 1.0]).unwrap().twisted(4.0).unwrap();
    assert!(twisted.promise().lipschitz > 2.0, "{:?}", twisted.promise());
    let corners = [[0.85, 0.0, 0.2], [0.85, 0.3, 0.1], [0.85, -0.3, -0.2]].map(Vector);
    let element = Element::new(corners).unwrap();
    let mut workspace = ElementSweep::new();
    let settings = SweepSettings::of_size(1.0);
    let rest = Pose::identity();
    let found = sweep_element(&twisted, &element, rest, &settings, &mut workspace).unwrap();
    assert_eq!((found.touches(), found.evaluations < 10_000), (Some(false), true), "{found:?}");
}
