// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Local searches: never below what is proven, at the minimum of what is convex, and at
//! times elsewhere.
use arbitrary::Unstructured;
use palpate_field::kernel::{Ball, Cuboid, HalfSpace, Torus};
use palpate_field::{Point, Shape, Vector};
use palpate_local::{
    Descent, ElementMethod, FrankWolfe, GoldenSection, NaiveDescent, PairMethod,
};
use palpate_query::{
    Certified, Element, ElementWorkspace, Limits, PairWorkspace, QueryError, minimum, overlap,
    separation,
};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::cases;
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::{Solid, Tree};

type Outcome = Result<(), Box<dyn std::error::Error>>;

/// What is wrong with a descent that is worth `value(p)` at `p`, and returns the best point on its way
/// or, as published, the last.
fn wrong<const D: usize>(
    descent: &Descent<D>,
    value: impl Fn(Point<D>) -> f64,
    [lower, rounding]: [f64; 2],
    returns_last: bool,
) -> Option<String> {
    let values = descent.path.iter().map(|p| value(*p));
    let least =
        values.fold(f64::INFINITY, |least, v| if returns_last { v } else { v.min(least) });
    if descent.value < lower - rounding {
        return Some(format!("{} is below {lower}", descent.value));
    }
    if (least - descent.value).abs() > rounding || !descent.path.contains(&descent.best) {
        return Some(format!("{least} is the answer, not {}", descent.value));
    }
    None
}

fn on_elements<const N: usize, const D: usize>(count: u64)
where
    Space: Solid<D> + Turn<D>,
{
    let mut workspace = ElementWorkspace::new();
    cases::on_trees(count, 4, |u, _, shape| {
        let size = draw::size(shape);
        // Triangles with a corner, an edge or all of it gone too.
        let extent = size * [0.0, 1e-6, 0.3, 2.0][u.choose_index(4)?];
        let mut vertices = [draw::point(u, shape)?; N];
        for vertex in &mut vertices[1..] {
            *vertex += draw::direction::<D>(u)? * (extent * draw::unit(u)?);
        }
        if u.ratio(1, 5)? {
            vertices[N - 1] = (vertices[0] + vertices[1]) * 0.5;
        }
        let Ok(element) = Element::new(vertices) else { return Ok(Ok(())) };
        let limits = Limits::new(1e-3 * size);
        let certified = minimum(shape, &element, &limits, &mut workspace).unwrap();
        let reach = vertices.iter().map(|vertex| vertex.norm()).fold(0.0, f64::max);
        let rounding = 2.0 * shape.promise().rounding.within(reach);
        for method in ElementMethod::ALL {
            let descent = method.descend(shape, &element);
            let value = |p| shape.distance(p);
            let last = *method == ElementMethod::Macklin;
            if let Some(complaint) = wrong(&descent, value, [certified.lower, rounding], last) {
                return Ok(Err(format!("{method}: {complaint}, {element:?}")));
            }
            // A gradient in space takes six values, a dichotomy twelve; and the first value.
            let most = if *method == ElementMethod::Naive { 64 * 13 + 1 } else { 16 * 20 };
            if descent.evaluations > most || descent.steps > 64 {
                return Ok(Err(format!("{method}: {} evaluations", descent.evaluations)));
            }
        }
        Ok(Ok(()))
    });
}

#[test]
fn nothing_is_found_below_what_is_proven_of_elements() {
    on_elements::<3, 3>(500);
    on_elements::<3, 2>(500);
    on_elements::<2, 3>(300);
    on_elements::<2, 2>(300);
}

fn on_pairs<const D: usize>(count: u64)
where
    Space: Solid<D> + Turn<D>,
{
    fn bounded<const D: usize>(
        u: &mut Unstructured<'_>,
        depth: usize,
    ) -> arbitrary::Result<Option<Shape<D>>>
    where
        Space: Solid<D> + Turn<D>,
    {
        let tree: Tree<D> = draw::tree(u, depth)?;
        Ok(tree.shape().ok().filter(|shape| shape.promise().bounds.is_some()))
    }
    let mut workspace = PairWorkspace::new();
    let mut asked = 0;
    cases::numbered(count, |seed, u| {
        let (a, b) = (bounded::<D>(u, 1 + seed % 3)?, bounded::<D>(u, 1 + seed % 3)?);
        let (Some(a), Some(b)) = (a, b) else { return Ok(Ok(())) };
        let size = draw::size(&a);
        let away = draw::direction::<D>(u)? * (2.0 * size * draw::unit(u)?);
        let Ok(b) = b.translated(away) else { return Ok(Ok(())) };
        let start = draw::point(u, &a)?;
        let limits = Limits::new(0.02 * size).with_budget(100_000);
        let Ok(certified) = separation(&a, &b, &limits, &mut workspace) else {
            return Ok(Err("bounded bodies are refused".into()));
        };
        asked += 1;
        for method in PairMethod::ALL {
            let Ok(descent) = method.descend(&a, &b, start, 1e-6 * size) else {
                return Ok(Err(format!("{method}: {start:?} is refused")));
            };
            let reach = descent.best.norm() + size;
            let rounding = a.promise().rounding.within(reach)
                + b.promise().rounding.within(reach)
                + 1e-14 * reach;
            if 2.0 * (descent.value + rounding) < certified.lower {
                return Ok(Err(format!("{method}: {descent:?} is below {certified:?}")));
            }
            if descent.steps > 64 {
                return Ok(Err(format!("{method}: {} steps", descent.steps)));
            }
        }
        Ok(Ok(()))
    });
    let count = cases::count(count);
    assert!(asked * 3 > count, "{asked} of {count} pairs were bounded");
}

#[test]
fn nothing_is_found_below_what_is_proven_of_pairs() {
    on_pairs::<3>(400);
    on_pairs::<2>(400);
}

/// Triangles beside a ball: its distance is convex, and smooth where it is not zero.
#[test]
fn the_minimum_of_a_convex_field_is_found() -> Outcome {
    let ball = Shape::from_kernel(Ball::new(0.4)?);
    let limits = Limits::new(1e-9);
    let mut workspace = ElementWorkspace::new();
    let corner = |i: i32, k: i32| {
        let t = f64::from(7 * i + 3 * k);
        Vector([t.sin(), (1.3 * t).cos(), 0.7 + 0.4 * (2.1 * t).sin()])
    };
    for i in 0..100 {
        let triangle = Element::new([corner(i, 0), corner(i, 1), corner(i, 2)])?;
        let least = minimum(&ball, &triangle, &limits, &mut workspace).unwrap();
        let [a, b, c] = *triangle.vertices();
        let longest = (a - b).norm().max((b - c).norm()).max((c - a).norm());
        for method in ElementMethod::ALL {
            let found = method.descend(&ball, &triangle);
            // The gradient turns by at most 1/r a metre at the radius r.
            let curvature = 1.0 / (least.upper + 0.4);
            let after =
                |steps: u32| 2.0 * curvature * longest * longest / (f64::from(steps) + 1.0);
            let bound = match method {
                ElementMethod::FrankWolfe => after(FrankWolfe::default().steps),
                // Sections are as good as those steps, up to where they end.
                ElementMethod::GoldenSection => {
                    after(GoldenSection::default().steps) + longest / 2207.0
                }
                ElementMethod::ProjectedGradient => 0.002 * longest,
                ElementMethod::Naive => after_constant_steps(&found, &least, longest),
                // Steps that shrink whatever they find have no bound; they have a price.
                ElementMethod::Macklin => {
                    assert!(found.evaluations <= 107, "{found:?}");
                    f64::INFINITY
                }
            };
            let excess = found.value - least.lower;
            assert!(excess <= bound, "{method} is {excess} above, {triangle:?}: {found:?}");
        }
    }
    Ok(())
}

/// How far above the minimum of a convex field the best point of K steps of lengths from s to S
/// along unit gradients is at most, if the start is R from it: `(R² + K·S²)/(2·K·s)`.
fn after_constant_steps(found: &Descent<3>, least: &Certified<Point<3>>, longest: f64) -> f64 {
    let descent = NaiveDescent::default();
    let floor = 0.1 * longest;
    let [shortest, largest] =
        [least.lower, ball_value(found)].map(|value| descent.alpha * value.max(floor));
    let steps = f64::from(found.steps);
    (longest * longest + steps * largest * largest) / (2.0 * steps * shortest)
}

/// The largest value on a path beside the ball of 0.4 m about the origin.
fn ball_value(found: &Descent<3>) -> f64 {
    found.path.iter().map(|p| p.norm() - 0.4).fold(0.0, f64::max)
}

#[test]
fn golden_sections_end_at_the_minimum_of_a_segment() -> Outcome {
    let ball = Shape::from_kernel(Ball::new(0.25)?);
    let segment = Element::new([Vector([-1.0, 0.5]), Vector([2.0, 0.5])])?;
    let found = ElementMethod::GoldenSection.descend(&ball, &segment);
    // √(0.5² + x²) − 0.25 with x off by at most 3/2207.
    assert!(found.best[0].abs() <= 3.0 / 2207.0, "{found:?}");
    assert!((found.value - 0.25).abs() < 2e-6);
    Ok(())
}

#[test]
fn an_element_without_extent_is_its_point() -> Outcome {
    let square = Shape::from_kernel(Cuboid::new(Vector([1.0, 1.0]))?);
    let point = Vector([0.75, 0.0]);
    for method in ElementMethod::ALL {
        let triangle = method.descend(&square, &Element::new([point; 3])?);
        let segment = method.descend(&square, &Element::new([point; 2])?);
        for descent in [triangle, segment] {
            assert_eq!((descent.best, descent.value), (point, 0.25), "{method}");
        }
    }
    Ok(())
}

/// A field that is flat but for a needle: no gradient leads there.
#[test]
fn a_needle_on_a_floor_is_missed_by_all_and_proven() -> Outcome {
    let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0, 0.0]), 0.0)?);
    let needle = Shape::from_kernel(Cuboid::new(Vector([0.01, 0.4, 0.01]))?);
    let shape = Shape::union([floor, needle.translated(Vector([0.2, 0.0, 0.1]))?])?;
    let corners =
        [Vector([-1.0, 0.1, -0.8]), Vector([1.0, 0.1, -0.7]), Vector([0.1, 0.1, 1.0])];
    let triangle = Element::new(corners)?;
    let certified =
        minimum(&shape, &triangle, &Limits::new(1e-4), &mut ElementWorkspace::new()).unwrap();
    assert_eq!(certified.is_hit(), Some(true), "{certified:?}");
    for method in ElementMethod::ALL {
        let found = method.descend(&shape, &triangle);
        assert!(found.value > 0.09, "{method} found it: {found:?}");
    }
    Ok(())
}

/// An upright ring that cuts a plate: from the far side of the ring both end in the air.
#[test]
fn a_ring_that_cuts_a_plate_is_missed_from_a_bad_start_and_proven() -> Outcome {
    let plate = Shape::from_kernel(Cuboid::new(Vector([1.0, 1.0, 0.02]))?);
    let rings = Shape::union([
        Shape::from_kernel(Torus::new(0.1, 0.05)?).translated(Vector([0.3, 0.0, 0.155]))?,
        Shape::from_kernel(Torus::new(0.1, 0.05)?).translated(Vector([-0.3, 0.0, 0.17]))?,
    ])?;
    let limits = Limits::new(1e-4);
    let mut workspace = PairWorkspace::new();
    assert_eq!(overlap(&plate, &rings, &limits, &mut workspace)?.is_hit(), Some(true));
    for method in PairMethod::ALL {
        let good = method.descend(&plate, &rings, Vector([0.32, 0.02, 0.03]), 1e-7)?;
        let bad = method.descend(&plate, &rings, Vector([-0.32, 0.02, 0.03]), 1e-7)?;
        assert!(good.value <= 0.0 && bad.value > 0.004, "{method}: {good:?} {bad:?}");
    }
    Ok(())
}

#[test]
fn bodies_that_touch_have_a_common_point() -> Outcome {
    let ball = Shape::from_kernel(Ball::new(0.5)?);
    let other = ball.clone().translated(Vector([1.0, 0.0]))?;
    for method in PairMethod::ALL {
        let found = method.descend(&ball, &other, Vector([0.3, 0.7]), 1e-9)?;
        // Projections come near a touch as one over the root of their number.
        let near = if method == &PairMethod::MinimaxProximal { 1e-6 } else { 5e-3 };
        assert!(found.value.abs() < near, "{method}: {found:?}");
    }
    let nowhere =
        PairMethod::MinimaxProximal.descend(&ball, &other, Vector([f64::NAN, 0.0]), 0.1);
    assert!(matches!(nowhere, Err(QueryError::Coordinate { .. })));
    let coarse = PairMethod::AlternatingProjection.descend(&ball, &other, Vector::ZERO, -1.0);
    assert!(matches!(coarse, Err(QueryError::Length { .. })));
    Ok(())
}
