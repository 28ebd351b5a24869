// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Balls in fields: closed forms, rigid motion, pairs, and samples on random trees.

use arbitrary::Unstructured;
use palpate_field::kernel::{Ball, Cuboid, HalfSpace, Sheet};
use palpate_field::{Point, Quality, Rotation, Shape, Vector};
use palpate_query::{
    BallWorkspace, Certified, Contact, Limits, PairWorkspace, QueryError, Stop, contact_ball,
    overlap, touches_ball,
};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::cases;
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::Solid;

type Outcome = Result<(), Box<dyn std::error::Error>>;

/// Points at which the bounds of a gap are tried.
const SAMPLES: usize = 400;

type Answer<const D: usize> = Certified<Option<Contact<D>>>;

/// What is wrong with an answer, as samples of the field show.
fn wrong<const D: usize>(
    u: &mut Unstructured<'_>,
    shape: &Shape<D>,
    (centre, radius): (Point<D>, f64),
    answer: &Answer<D>,
) -> arbitrary::Result<Option<String>> {
    let rounding = |p: Point<D>| 2.0 * shape.promise().rounding.within(p.norm());
    let value = shape.distance(centre);
    let is_inside = value < 0.0;
    if answer.lower > answer.upper {
        return Ok(Some(format!("{answer:?} is empty")));
    }
    if value.abs() <= rounding(centre) {
        return Ok(None);
    }
    let far = 2.0 * draw::size(shape);
    let near = answer.best.map_or(centre, |contact| contact.point_a);
    for i in 0..SAMPLES {
        let (from, spread) =
            [(centre, far), (centre, 1.2 * value.abs()), (near, 0.01 * far)][i % 3];
        let p = from + draw::direction::<D>(u)? * (spread * draw::unit(u)?);
        let (there, apart) = (shape.distance(p), (p - centre).norm());
        let error = rounding(p) + 1e-14 * (apart + radius + 1.0);
        if !is_inside && there < -rounding(p) && apart - radius < answer.lower - error {
            return Ok(Some(format!("{there} at {p:?}, {apart} away, is nearer: {answer:?}")));
        }
        if is_inside && there > rounding(p) && -apart - radius > answer.upper + error {
            return Ok(Some(format!("{there} at {p:?}, {apart} away, is nearer: {answer:?}")));
        }
    }
    if let Some(contact) = &answer.best {
        let on_surface = shape.distance(contact.point_a).abs();
        let reach = contact.point_a.norm() + centre.norm() + radius + 1.0;
        let error = 16.0 * rounding(contact.point_a) + 1e-13 * reach;
        // Through the surface by up to the tolerance of a field as flat as it may be.
        if on_surface > error + 1e-3 * (answer.upper - answer.lower).min(1.0) {
            return Ok(Some(format!("{on_surface} off the surface: {answer:?}")));
        }
        let across = (contact.point_b - contact.point_a).dot(contact.normal);
        let length = contact.normal.norm();
        if (across - contact.gap).abs() > error || (length - 1.0).abs() > 1e-12 {
            return Ok(Some(format!("gap and points of {contact:?} differ by {across}")));
        }
        if contact.gap > answer.upper + error || contact.gap < answer.lower - error {
            return Ok(Some(format!("{contact:?} is not in {answer:?}")));
        }
    }
    Ok(None)
}

fn on_trees<const D: usize>(count: u64)
where
    Space: Solid<D> + Turn<D>,
{
    let mut workspace = BallWorkspace::new();
    let (mut asked, mut spent) = (0, 0);
    cases::on_trees(count, 4, |u, _, shape| {
        let size = draw::size(shape);
        let centre = draw::point(u, shape)?;
        let radius = size * [0.0, 0.01, 0.2, 1.0][u.choose_index(4)?] * draw::unit(u)?;
        let limits = Limits::new(0.01 * size).with_budget(200_000);
        let asks = [
            contact_ball(shape, centre, radius, &limits, &mut workspace),
            touches_ball(shape, centre, radius, &limits, &mut workspace),
            // Ten evaluations prove little, and nothing that is wrong.
            contact_ball(shape, centre, radius, &limits.with_budget(10), &mut workspace),
        ];
        let [gap, sign, hasty] = asks.map(|answer| answer.map_err(|error| error.to_string()));
        for answer in [&gap, &sign, &hasty] {
            let complaint = match answer {
                Ok(answer) => wrong(u, shape, (centre, radius), answer)?,
                Err(error) => Some(error.clone()),
            };
            if let Some(complaint) = complaint {
                return Ok(Err(format!("{complaint}\n  {radius} m about {centre:?}")));
            }
        }
        let (Ok(gap), Ok(sign)) = (gap, sign) else { return Ok(Ok(())) };
        if gap.stop == Stop::Converged && gap.upper - gap.lower > limits.tolerance {
            return Ok(Err(format!("{gap:?} has not converged")));
        }
        if sign.stop == Stop::SignKnown && sign.is_hit().is_none() {
            return Ok(Err(format!("{sign:?} does not know")));
        }
        if sign.lower > gap.upper || gap.lower > sign.upper {
            return Ok(Err(format!("{gap:?} and {sign:?} exclude each other")));
        }
        asked += 1;
        spent += u64::from(gap.stop.is_early()) + u64::from(sign.stop.is_early());
        Ok(Ok(()))
    });
    let count = cases::count(count);
    assert!(asked * 2 > count, "{asked} of {count} trees were built");
    assert!(spent * 50 <= asked, "{spent} of {asked} searches spent their budget");
}

#[test]
fn gaps_in_space_are_enclosed() {
    on_trees::<3>(1000);
}

#[test]
fn gaps_in_the_plane_are_enclosed() {
    on_trees::<2>(1500);
}

/// A union is a bound inside: the true depth is known where two discs cross.
#[test]
fn the_depth_in_a_union_is_that_of_the_nearest_surface() -> Outcome {
    let disc = Shape::from_kernel(Ball::new(0.5)?);
    let both = Shape::union([
        disc.clone().translated(Vector([-0.3, 0.0]))?,
        disc.translated(Vector([0.3, 0.0]))?,
    ])?;
    assert_eq!(both.promise().inside, Quality::Bound);
    let limits = Limits::new(1e-9);
    let answer =
        contact_ball(&both, Vector([0.0, 0.1]), 0.05, &limits, &mut BallWorkspace::new())?;
    // The field is √(0.3² + 0.1²) − 0.5 there; the discs cross at (0, 0.4).
    let truth = -0.3 - 0.05;
    assert_eq!(answer.stop, Stop::Converged, "{answer:?}");
    assert!(answer.lower <= truth && truth <= answer.upper, "{answer:?}");
    let contact = answer.best.ok_or("a contact")?;
    assert!((contact.point_a - Vector([0.0, 0.4])).norm() < 1e-4, "{contact:?}");
    assert!((contact.normal - Vector([0.0, 1.0])).norm() < 1e-3, "{contact:?}");
    Ok(())
}

/// An ellipse of half axes 1 and 4, a bound everywhere, from both sides of its ends.
#[test]
fn the_gap_to_a_stretched_ball_is_that_of_an_ellipsoid() -> Outcome {
    let ellipsoid = Shape::from_kernel(Ball::new(1.0)?).stretched([1.0, 4.0, 1.0])?;
    let mut workspace = BallWorkspace::new();
    let limits = Limits::new(1e-7);
    for (centre, radius, truth) in [
        (Vector([0.0, 5.5, 0.0]), 1.0, 0.5),
        (Vector([0.0, 5.5, 0.0]), 1.6, -0.1),
        (Vector([2.0, 0.0, 0.0]), 0.25, 0.75),
        (Vector([0.0, 0.0, -0.9]), 0.25, -0.35),
        (Vector([0.0, 3.99, 0.0]), 0.0, -0.01),
        (Vector([0.0, 0.0, 0.0]), 0.5, -1.5),
    ] {
        let answer = contact_ball(&ellipsoid, centre, radius, &limits, &mut workspace)?;
        assert!(answer.lower <= truth && truth <= answer.upper, "{truth}: {answer:?}");
        assert!(answer.upper - answer.lower <= 1e-7, "{answer:?}");
        let sign = touches_ball(&ellipsoid, centre, radius, &limits, &mut workspace)?;
        assert_eq!(sign.is_hit(), Some(truth < 0.0), "{sign:?}");
        assert!(sign.evaluations <= answer.evaluations);
    }
    Ok(())
}

#[test]
fn an_exact_field_is_asked_once_and_gives_the_witness() -> Outcome {
    let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0, 0.0]), 0.0)?);
    let mut workspace = BallWorkspace::new();
    let limits = Limits::new(1e-4);
    let answer = contact_ball(&floor, Vector([3.0, 0.25, -2.0]), 0.5, &limits, &mut workspace)?;
    let (on_floor, on_ball) = (Vector([3.0, 0.0, -2.0]), Vector([3.0, -0.25, -2.0]));
    let expected = Contact::new(on_floor, on_ball, Vector([0.0, 1.0, 0.0]));
    assert_eq!(expected.gap, -0.25);
    assert_eq!((answer.best, answer.evaluations), (Some(expected), 2));
    // From below the floor too.
    let answer =
        contact_ball(&floor, Vector([3.0, -0.25, -2.0]), 0.5, &limits, &mut workspace)?;
    let contact = answer.best.ok_or("a contact")?;
    assert_eq!((contact.gap, contact.normal), (-0.75, Vector([0.0, 1.0, 0.0])));
    assert_eq!(contact.point_b, Vector([3.0, -0.75, -2.0]));
    Ok(())
}

/// A ball against a field, and the same ball as a body.
#[test]
fn a_ball_overlaps_as_its_shape_does() {
    let (mut workspace, mut of_pairs) = (BallWorkspace::new(), PairWorkspace::new());
    let mut compared = 0;
    cases::on_trees::<3>(600, 3, |u, _, shape| {
        let size = draw::size(shape);
        let radius = size * (0.02 + 0.5 * draw::unit(u)?);
        let (centre, limits) =
            (draw::point(u, shape)?, Limits::new(1e-3 * size).with_budget(200_000));
        let Ok(body) = Ball::new(radius).map(Shape::from_kernel) else { return Ok(Ok(())) };
        let Ok(body) = body.translated(centre) else { return Ok(Ok(())) };
        let by_ball = touches_ball(shape, centre, radius, &limits, &mut workspace);
        let by_pair = overlap(shape, &body, &limits, &mut of_pairs);
        let (Ok(by_ball), Ok(by_pair)) = (by_ball, by_pair) else { return Ok(Ok(())) };
        if let (Some(one), Some(other)) = (by_ball.is_hit(), by_pair.is_hit()) {
            compared += 1;
            if one != other {
                return Ok(Err(format!("{by_ball:?} and {by_pair:?}")));
            }
        }
        Ok(Ok(()))
    });
    assert!(compared > cases::count(300), "{compared} pairs were compared");
}

#[test]
fn moved_together_the_gap_stays() -> Outcome {
    let shape = Shape::union([
        Shape::from_kernel(Cuboid::new(Vector([0.8, 0.3, 0.5]))?),
        Shape::from_kernel(Ball::new(0.3)?).translated(Vector([0.4, 0.1, 0.0]))?,
    ])?
    .stretched([1.0, 1.5, 0.7])?;
    let turn = Rotation::from_quaternion([0.1, 0.3, -0.2, 0.9])?;
    let away = Vector([3.0, -2.0, 1.0]);
    let moved = shape.clone().rotated(turn)?.translated(away)?;
    let limits = Limits::new(1e-6);
    let mut workspace = BallWorkspace::new();
    for centre in [Vector([0.9, 0.4, 0.2]), Vector([0.35, 0.05, -0.02])] {
        let there = turn.rotate(centre) + away;
        let here = contact_ball(&shape, centre, 0.2, &limits, &mut workspace)?;
        let there = contact_ball(&moved, there, 0.2, &limits, &mut workspace)?;
        println!("{here:?} {there:?}");
        assert_eq!((here.stop, there.stop), (Stop::Converged, Stop::Converged));
        assert!(here.lower <= there.upper && there.lower <= here.upper, "{here:?} {there:?}");
        let (Some(here), Some(there)) = (here.best, there.best) else { panic!("contacts") };
        assert!((turn.rotate(here.normal) - there.normal).norm() < 1e-2);
    }
    Ok(())
}

#[test]
fn a_sheet_is_touched_where_it_is() -> Outcome {
    let corners =
        vec![Vector([0.0, 0.0, 0.0]), Vector([1.0, 0.0, 0.0]), Vector([0.0, 1.0, 0.0])];
    let sheet =
        Shape::from_kernel(Sheet::<3>::new(corners, 0.0)?).stretched([1.0, 2.0, 3.0])?;
    let mut workspace = BallWorkspace::new();
    let limits = Limits::new(1e-6);
    for (height, truth) in [(0.3, 0.1), (-0.15, -0.05)] {
        let centre = Vector([0.2, 0.3, height]);
        let answer = contact_ball(&sheet, centre, 0.2, &limits, &mut workspace)?;
        assert!((answer.lower - truth).abs() < 1e-5, "{answer:?}");
        assert!((answer.upper - truth).abs() < 1e-5, "{answer:?}");
    }
    Ok(())
}

#[test]
fn bad_balls_are_refused() -> Outcome {
    let disc = Shape::<2>::from_kernel(Ball::new(1.0)?);
    let (limits, mut workspace) = (Limits::new(1e-4), BallWorkspace::new());
    let mut ask =
        |x: f64, r: f64| contact_ball(&disc, Vector([x, 0.0]), r, &limits, &mut workspace);
    assert!(matches!(ask(f64::NAN, 1.0), Err(QueryError::Coordinate { .. })));
    assert!(matches!(ask(0.0, f64::NAN), Err(QueryError::Length { .. })));
    assert!(matches!(ask(0.0, -1.0), Err(QueryError::Length { value: -1.0 })));
    Ok(())
}
