// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Ways to a gradient, measured against directions known by geometry.
//!
//! Section 2.3 of Paul Luneau's "Détections de collisions avec des SDFs" (the
//! memoir) tries vectors to the closest point, central differences, and a dichotomy
//! over directions. Lengths are the memoir's pixels. Sines come from `libm`, so that
//! the table is the same on every machine.

use std::error::Error;
use std::fmt::Write;

use palpate_field::kernel::{Ball, Cuboid, RegularStar};
use palpate_field::operator::Profile;
use palpate_field::{Point, Shape, ShapeError, Vector};
use palpate_local::{GradientMethod, GradientSampler, angle_between};
use palpate_query::QueryError;

/// A direction of length one; none where a method has none.
pub(crate) type Direction = Option<Vector<f64, 2>>;

/// The window of the memoir's program [pixel].
const WINDOW: [f64; 2] = [1920.0, 1080.0];

/// The memoir's least offset [pixel].
pub(crate) const OFFSET: f64 = 0.005;

const POINTS: usize = 4000;
const DISC: ([f64; 2], f64) = ([750.0, 680.0], 200.0);
const BOX: ([f64; 2], [f64; 2]) = ([900.0, 500.0], [300.0, 180.0]);
const STAR: ([f64; 2], usize, f64) = ([1000.0, 530.0], 12, 300.0);
/// The reach of the program's smooth minimum, k = 1; the fill is a quarter of it.
const REACH: f64 = 1.0;

/// A shape of the memoir, and what is known of it without a field.
pub(crate) struct Case {
    name: &'static str,
    /// The shape as the library builds it.
    pub(crate) shape: Shape<2>,
    /// The gradient, by geometry alone.
    pub(crate) truth: Box<dyn Fn(Point<2>) -> Direction>,
    /// Whether the memoir found vectors to the closest point for it.
    has_closest_vector: bool,
    /// Whether the memoir's program rounds its values to single precision.
    is_rounded: bool,
}

/// The memoir's circle, rectangle, star, and smooth union of star and circle.
pub(crate) fn cases() -> Result<[Case; 4], ShapeError> {
    let star_inner = STAR.2 * 0.5_f64.sqrt();
    let disc = Shape::from_kernel(Ball::new(DISC.1)?).translated(Vector(DISC.0))?;
    let star = RegularStar::new(STAR.1 as u32, STAR.2, star_inner)?;
    let star = Shape::from_kernel(star).translated(Vector(STAR.0))?;
    let rectangle = Shape::from_kernel(Cuboid::new(Vector(BOX.1) * 2.0)?);
    let both = [star.clone(), disc.clone()];
    let joined = Shape::smooth_union(both, Profile::Quadratic, 0.25 * REACH)?;
    let case = |name, shape, truth, has_closest_vector| Case {
        name,
        shape,
        truth,
        has_closest_vector,
        is_rounded: name == "smooth union",
    };
    Ok([
        case("circle", disc, Box::new(|p| nearest_on_disc(p).1), true),
        case(
            "rectangle",
            rectangle.translated(Vector(BOX.0))?,
            polygon(rectangle_corners()),
            true,
        ),
        case("star", star, polygon(star_corners()), false),
        case("smooth union", joined, smooth_union(), false),
    ])
}

/// The signed distance from the disc, and its gradient.
fn nearest_on_disc(p: Point<2>) -> (f64, Direction) {
    let from_centre = p - Vector(DISC.0);
    (from_centre.norm() - DISC.1, from_centre.normalized())
}

fn rectangle_corners() -> Vec<Point<2>> {
    let ([x, y], [w, h]) = BOX;
    [[-w, -h], [w, -h], [w, h], [-w, h]].map(|[dx, dy]| Vector([x + dx, y + dy])).into()
}

fn star_corners() -> Vec<Point<2>> {
    let (centre, branches, radius) = STAR;
    let corner = |i: usize| {
        let angle = std::f64::consts::PI * (0.5 + i as f64 / branches as f64);
        let r = if i.is_multiple_of(2) { radius } else { radius * 0.5_f64.sqrt() };
        Vector(centre) + Vector([libm::cos(angle), libm::sin(angle)]) * r
    };
    (0..2 * branches).map(corner).collect()
}

/// The signed distance from a polygon and its gradient: the nearest of all points of
/// all edges, and the number of edges that a ray crosses.
fn nearest_on_polygon(corners: &[Point<2>], p: Point<2>) -> (f64, Direction) {
    let mut to_nearest = Vector([f64::INFINITY; 2]);
    let mut is_inside = false;
    for (i, &from) in corners.iter().enumerate() {
        let along = corners[(i + 1) % corners.len()] - from;
        let share = ((p - from).dot(along) / along.dot(along)).clamp(0.0, 1.0);
        let to = from + along * share - p;
        if to.norm() < to_nearest.norm() {
            to_nearest = to;
        }
        let [x, y] = (p - from).0;
        let crosses = (y < 0.0) != (y < along.0[1]);
        is_inside ^= crosses && x < along.0[0] * y / along.0[1];
    }
    let sign = if is_inside { -1.0 } else { 1.0 };
    (sign * to_nearest.norm(), (-to_nearest * sign).normalized())
}

fn polygon(corners: Vec<Point<2>>) -> Box<dyn Fn(Point<2>) -> Direction> {
    Box::new(move |p| nearest_on_polygon(&corners, p).1)
}

/// The quadratic smooth minimum weighs the gradients: ½ each where the distances are
/// equal, all for the nearer one from a difference of [`REACH`] on.
fn smooth_union() -> Box<dyn Fn(Point<2>) -> Direction> {
    let corners = star_corners();
    Box::new(move |p| {
        let (a, to_a) = nearest_on_polygon(&corners, p);
        let (b, to_b) = nearest_on_disc(p);
        let weight = (0.5 + 0.5 * (b - a) / REACH).clamp(0.0, 1.0);
        (to_a? * weight + to_b? * (1.0 - weight)).normalized()
    })
}

/// Points spread evenly over the window: fractional parts of multiples of powers of
/// 1/g, where g³ = g + 1.
pub(crate) fn points() -> impl Iterator<Item = Point<2>> {
    const G: f64 = 1.324_717_957_244_746;
    (1..=POINTS).map(|i| {
        let [x, y] = [i as f64 / G, i as f64 / (G * G)].map(f64::fract);
        Vector([WINDOW[0] * x, WINDOW[1] * y])
    })
}

/// Angles between a method's directions and the true ones [degree], sorted: outside
/// and inside. Values may be rounded to single precision, as in the memoir's program.
pub(crate) fn errors(
    case: &Case,
    method: GradientMethod,
    is_rounded: bool,
) -> Result<[Vec<f64>; 2], QueryError> {
    let sampler = GradientSampler::new(OFFSET)?;
    let sampler = if is_rounded { sampler.in_single_precision() } else { sampler };
    let mut errors = [Vec::new(), Vec::new()];
    for p in points() {
        let Some(truth) = (case.truth)(p) else { continue };
        let found = sampler.find(method, &case.shape, p).direction;
        let error = found.map_or(180.0, |d| angle_between(d, truth).to_degrees());
        errors[usize::from(case.shape.distance(p) < 0.0)].push(error);
    }
    for side in &mut errors {
        side.sort_by(f64::total_cmp);
    }
    Ok(errors)
}

/// The value that a share of the sorted `errors` does not exceed.
pub(crate) fn quantile(errors: &[f64], share: f64) -> f64 {
    errors[((errors.len() - 1) as f64 * share) as usize]
}

/// The page's table: errors in degrees.
pub(crate) fn table() -> Result<String, Box<dyn Error>> {
    let mut text = String::from(
        "| shape | method | outside: median | 99 % | max | inside: median | 99 % | max |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for case in &cases()? {
        for method in GradientMethod::ALL {
            if *method == GradientMethod::ClosestVector && !case.has_closest_vector {
                continue;
            }
            add_row(&mut text, case, *method, false)?;
            if case.is_rounded && method.samples() {
                add_row(&mut text, case, *method, true)?;
            }
        }
    }
    Ok(text)
}

/// The name of a method in the table.
fn name(method: GradientMethod) -> &'static str {
    match method {
        GradientMethod::ClosestVector => "closest vector",
        GradientMethod::Differences => "central differences",
        GradientMethod::Dichotomy => "dichotomy, fixed offset",
        GradientMethod::AdaptiveDichotomy => "dichotomy, adaptive offset",
        GradientMethod::Exact => "analytic (palpate)",
    }
}

fn add_row(
    text: &mut String,
    case: &Case,
    method: GradientMethod,
    is_rounded: bool,
) -> Result<(), Box<dyn Error>> {
    let note = if is_rounded { ", values in single precision" } else { "" };
    write!(text, "| {} | {}{note} |", case.name, name(method))?;
    for side in errors(case, method, is_rounded)? {
        for share in [0.5, 0.99, 1.0] {
            let error = quantile(&side, share);
            if error < 0.001 {
                write!(text, " < 0.001 |")?;
            } else {
                write!(text, " {error:.3} |")?;
            }
        }
    }
    text.push('\n');
    Ok(())
}
