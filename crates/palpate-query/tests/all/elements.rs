// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Segments and triangles on random trees: bounds against dense samples.
#![expect(clippy::unwrap_used, reason = "these are tests")]

use arbitrary::Unstructured;
use palpate_field::kernel::{Ball, Cuboid};
use palpate_field::{Aabb, Point, Shape, ShapeError, Vector};
use palpate_query::{
    Certified, Element, ElementWorkspace, Limits, QueryError, Stop, minimum, touches,
};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::cases;
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::Solid;

/// Samples along an edge.
const SAMPLES: u32 = 24;

/// An element near the surface of a shape, small, large or without an extent.
fn element<const N: usize, const D: usize>(
    u: &mut Unstructured<'_>,
    shape: &Shape<D>,
) -> arbitrary::Result<Element<N, D>> {
    let middle = draw::point(u, shape)?;
    let size = draw::size(shape) * [0.0, 1e-6, 0.05, 0.3, 2.0][u.choose_index(5)?];
    let mut vertices = [middle; N];
    for vertex in &mut vertices {
        *vertex += draw::direction::<D>(u)? * (size * draw::unit(u)?);
    }
    if u.ratio(1, 5)? {
        vertices[N - 1] = (vertices[0] + vertices[1]) * 0.5;
    }
    Element::new(vertices).map_err(|_| arbitrary::Error::IncorrectFormat)
}

fn wrong<const N: usize, const D: usize>(
    shape: &Shape<D>,
    element: &Element<N, D>,
    answer: &Certified<Point<D>>,
) -> Option<String> {
    // What is sampled is off by rounding too, as `upper` is.
    let rounding = |p: Point<D>| shape.promise().rounding.within(p.norm());
    for p in draw::all_over(element.vertices(), SAMPLES) {
        let value = shape.distance(p);
        if value + rounding(p) < answer.lower {
            return Some(format!("{value} at {p:?} is below {answer:?} of {element:?}"));
        }
    }
    // Its box is easy to tell, and what is off the element is soon off its box.
    let reach = element.vertices().iter().fold(0.0_f64, |reach, v| reach.max(v.norm()));
    let aabb = Aabb::around(element.vertices().iter().copied());
    if !aabb.is_some_and(|aabb| aabb.grown(64.0 * f64::EPSILON * reach).contains(answer.best)) {
        return Some(format!("{answer:?} is not on {element:?}"));
    }
    let again = shape.distance(answer.best);
    if again > answer.upper || again < answer.lower - rounding(answer.best) {
        return Some(format!("{again} at the best point of {answer:?}"));
    }
    None
}

/// What is wrong with the minimum of an element that is moved and scaled with the shape,
/// which should be as much larger.
fn moved_otherwise<const N: usize, const D: usize>(
    u: &mut Unstructured<'_>,
    shape: &Shape<D>,
    element: &Element<N, D>,
    limits: &Limits,
    workspace: &mut ElementWorkspace<N, D>,
) -> arbitrary::Result<Option<String>>
where
    Space: Solid<D> + Turn<D>,
{
    let pose = draw::pose::<D>(u)?;
    let factor = 10.0_f64.powf(draw::within(u, -3.0, 3.0)?);
    let scaled = shape.clone().scaled(factor).and_then(|shape| shape.placed(&pose));
    let vertices = element.vertices().map(|v| pose.transform_point(v * factor));
    let (Ok(scaled), Ok(there)) = (scaled, Element::new(vertices)) else { return Ok(None) };
    let here = minimum(shape, element, limits, workspace).unwrap();
    let limits = limits.with_tolerance(factor * limits.tolerance);
    let there = minimum(&scaled, &there, &limits, workspace).unwrap();
    // Vertices are rounded once more.
    let steepness = shape.promise().lipschitz;
    let reach = pose.translation.norm()
        + factor * element.vertices().iter().fold(0.0_f64, |far, v| far.max(v.norm()));
    let bits = 32.0 * f64::EPSILON * steepness * reach;
    let exclude =
        factor * here.lower - bits > there.upper || there.lower - bits > factor * here.upper;
    Ok(exclude.then(|| format!("{there:?} is not {factor} times {here:?} of {element:?}")))
}

fn on_trees<const N: usize, const D: usize>(count: u64)
where
    Space: Solid<D> + Turn<D>,
{
    let mut workspace = ElementWorkspace::new();
    let mut spent = 0;
    cases::on_trees(count, 4, |u, _, shape| {
        let element = element::<N, D>(u, shape)?;
        let limits = Limits::new(0.01 * draw::size(shape));
        let least = minimum(shape, &element, &limits, &mut workspace).unwrap();
        let sign = touches(shape, &element, &limits, &mut workspace).unwrap();
        for answer in [least, sign] {
            if let Some(complaint) = wrong(shape, &element, &answer) {
                return Ok(Err(complaint));
            }
        }
        if least.stop == Stop::Converged && least.upper - least.lower > limits.tolerance {
            return Ok(Err(format!("{least:?} has not converged")));
        }
        if sign.stop == Stop::SignKnown && sign.is_hit().is_none() {
            return Ok(Err(format!("{sign:?} does not know")));
        }
        spent += u64::from(least.stop.is_early());
        if let Some(complaint) = moved_otherwise(u, shape, &element, &limits, &mut workspace)? {
            return Ok(Err(complaint));
        }
        // Ten evaluations prove little, and nothing that is wrong.
        let hasty = limits.with_budget(10);
        let answer = minimum(shape, &element, &hasty, &mut workspace).unwrap();
        Ok(wrong(shape, &element, &answer).map_or(Ok(()), Err))
    });
    assert!(spent * 50 <= count, "{spent} of {count} searches spent their budget");
}

#[test]
fn minima_of_triangles_in_space_are_enclosed() {
    on_trees::<3, 3>(600);
}

#[test]
fn minima_of_triangles_in_the_plane_are_enclosed() {
    on_trees::<3, 2>(600);
}

#[test]
fn minima_of_segments_are_enclosed() {
    on_trees::<2, 3>(400);
    on_trees::<2, 2>(400);
}

#[test]
fn a_triangle_through_a_ball_and_one_that_passes_it_are_told_apart() -> Result<(), ShapeError> {
    let ball = Shape::from_kernel(Ball::new(1.0)?);
    // A large triangle, at ±1e-9 m from the ball.
    for (clearance, is_hit) in [(1e-9, false), (-1e-9, true)] {
        let z = 1.0 + clearance;
        let vertices = [Vector([-3.0, -2.0, z]), Vector([4.0, -2.5, z]), Vector([0.3, 5.0, z])];
        let limits = Limits::new(1e-12);
        let triangle = Element::new(vertices).unwrap();
        let answer = touches(&ball, &triangle, &limits, &mut ElementWorkspace::new()).unwrap();
        assert_eq!(answer.is_hit(), Some(is_hit), "{answer:?}");
    }
    Ok(())
}

#[test]
fn the_depth_of_a_segment_in_a_box_is_exact_to_the_tolerance() -> Result<(), ShapeError> {
    let square = Shape::from_kernel(Cuboid::new(Vector([2.0, 1.0]))?);
    let segment = Element::new([Vector([-2.0, 0.2]), Vector([3.0, 0.2])]).unwrap();
    let limits = Limits::new(1e-6);
    let answer = minimum(&square, &segment, &limits, &mut ElementWorkspace::new()).unwrap();
    assert_eq!(answer.stop, Stop::Converged);
    assert!(answer.lower <= -0.3 && -0.3 <= answer.upper && answer.upper < -0.3 + 1e-6);
    Ok(())
}

/// Triangles without an area were halved into parts that are there twice, until the
/// budget was spent.
#[test]
fn elements_without_an_extent_are_what_is_left_of_them() -> Result<(), ShapeError> {
    let block = Shape::from_kernel(Cuboid::new(Vector([2.0, 1.0, 0.5]))?);
    let (a, b) = (Vector([-2.0, 0.2, 0.1]), Vector([3.0, 0.2, 0.1]));
    let middle = (a + b) * 0.5;
    let limits = Limits::new(1e-6);
    // On a line, the same twice, and a point alone: 0.15 m deep, or 1 m off.
    for (vertices, truth) in [
        ([a, middle, b], -0.15),
        ([b, a, a], -0.15),
        ([a, b, a], -0.15),
        ([middle; 3], -0.15),
        ([a; 3], 1.0),
    ] {
        let element = Element::new(vertices).unwrap();
        let answer = minimum(&block, &element, &limits, &mut ElementWorkspace::new()).unwrap();
        assert_eq!(answer.stop, Stop::Converged, "{answer:?}");
        assert!(answer.lower <= truth && truth <= answer.upper, "{answer:?}");
        let sign = touches(&block, &element, &limits, &mut ElementWorkspace::new()).unwrap();
        assert_eq!((sign.is_hit(), sign.stop), (Some(truth < 0.0), Stop::SignKnown));
    }
    let point = Element::new([b; 2]).unwrap();
    let answer = minimum(&block, &point, &limits, &mut ElementWorkspace::new()).unwrap();
    assert!(answer.lower <= 2.0 && 2.0 <= answer.upper && answer.upper <= 2.0 + 1e-6);
    Ok(())
}

#[test]
fn limits_that_are_no_lengths_are_refused_and_zero_says_nothing_wrong() -> Result<(), ShapeError>
{
    let ball = Shape::from_kernel(Ball::new(1.0)?);
    let segment = Element::new([Vector([-2.0, 0.6]), Vector([3.0, 0.5])]).unwrap();
    let mut workspace = ElementWorkspace::new();
    for tolerance in [f64::NAN, -1.0, 0.0, f64::INFINITY] {
        let limits = Limits::new(tolerance).with_budget(1000);
        for answer in [
            minimum(&ball, &segment, &limits, &mut workspace),
            touches(&ball, &segment, &limits, &mut workspace),
        ] {
            match answer {
                Ok(answer) => {
                    assert_eq!(tolerance, 0.0);
                    assert_eq!(wrong(&ball, &segment, &answer), None);
                }
                Err(error) => {
                    assert!(tolerance != 0.0 && matches!(error, QueryError::Length { .. }));
                }
            }
        }
    }
    Ok(())
}

#[test]
fn a_coordinate_that_is_no_number_is_refused() {
    let wrong = Element::new([Vector([0.0, 1.0]), Vector([f64::NAN, 0.0])]);
    assert!(matches!(wrong, Err(QueryError::Coordinate { .. })));
    let far = Element::new([Vector([0.0, 1.0]), Vector([2e16, 0.0])]).unwrap_err();
    assert_eq!(far.to_string(), "vertex must be finite and at most 1e15 m in size, got 2e16 m");
}
