// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Ways to a gradient, measured against directions known by geometry.
//!
//! Section 2.3 of Paul Luneau's "Détections de collisions avec des SDFs" (the
//! memoir) tries vectors to the closest point, central differences, and a dichotomy
//! over directions. Lengths are the memoir's pixels. Sines come from `libm`, so that
//! the table is the same on every machine.

use std::fmt::Write;

use palpate_field::kernel::{Ball, Cuboid, RegularStar};
use palpate_field::operator::Profile;
use palpate_field::{Point, Shape, ShapeError, Vector};

/// A direction of length one; none where a method has none.
pub(crate) type Direction = Option<Vector<f64, 2>>;

/// The window of the memoir's program [pixel].
pub(crate) const WINDOW: [f64; 2] = [1920.0, 1080.0];

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

/// How a gradient is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Method {
    /// −g/‖g‖ of the vector g to the closest point.
    ClosestVector,
    /// Four values at a distance of [`OFFSET`].
    CentralDifferences,
    /// Three values and nine halvings, at a distance of [`OFFSET`].
    Dichotomy,
    /// The same, at the memoir's distance, which grows with the value.
    AdaptiveDichotomy,
    /// The library's.
    Analytic,
}

impl Method {
    fn name(self) -> &'static str {
        match self {
            Self::ClosestVector => "closest vector",
            Self::CentralDifferences => "central differences",
            Self::Dichotomy => "dichotomy, fixed offset",
            Self::AdaptiveDichotomy => "dichotomy, adaptive offset",
            Self::Analytic => "analytic (palpate)",
        }
    }

    /// The direction at `p`, where the field's values are as `value` gives them.
    pub(crate) fn direction(
        self,
        case: &Case,
        value: &dyn Fn(Point<2>) -> f64,
        p: Point<2>,
    ) -> Direction {
        match self {
            // The vector itself is right; what is measured is what is made of it.
            Self::ClosestVector => {
                let (truth, distance) = ((case.truth)(p)?, case.shape.distance(p));
                (truth * distance).normalized()
            }
            Self::CentralDifferences => central_differences(value, p),
            Self::Dichotomy => dichotomy(value, p, OFFSET),
            Self::AdaptiveDichotomy => {
                dichotomy(value, p, OFFSET.max(value(p) * OFFSET / 20.0))
            }
            Self::Analytic => case.shape.distance_gradient(p).1.normalized(),
        }
    }
}

/// The differences of values on both sides, along each axis.
pub(crate) fn central_differences(value: &dyn Fn(Point<2>) -> f64, p: Point<2>) -> Direction {
    let steps = [Vector([OFFSET, 0.0]), Vector([0.0, OFFSET])];
    Vector(steps.map(|step| value(p + step) - value(p - step))).normalized()
}

/// Of three directions the better two, and then halves the angle between them nine
/// times: 12 values, and 0.12° between the answer and the best direction at most.
pub(crate) fn dichotomy(
    value: &dyn Fn(Point<2>) -> f64,
    p: Point<2>,
    offset: f64,
) -> Direction {
    const HALVINGS: usize = 9;
    let direction = |degrees: f64| {
        let angle = degrees.to_radians();
        Vector([libm::cos(angle), libm::sin(angle)])
    };
    let ask = |degrees: f64| (value(p + direction(degrees) * offset), degrees);
    let three = [60.0, 180.0, 300.0].map(ask);
    let worst = if three[0].0 <= three[1].0 && three[0].0 <= three[2].0 {
        0
    } else if three[1].0 <= three[2].0 {
        1
    } else {
        2
    };
    let mut low = three[(worst + 1) % 3];
    let mut high = three[(worst + 2) % 3];
    if high.1 < low.1 {
        high.1 += 360.0;
    }
    for _ in 0..HALVINGS {
        let middle = ask(0.5 * (low.1 + high.1));
        if low.0 < high.0 { low = middle } else { high = middle }
    }
    Some(direction(if low.0 < high.0 { high.1 } else { low.1 }))
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
/// and inside.
pub(crate) fn errors(case: &Case, method: Method, is_rounded: bool) -> [Vec<f64>; 2] {
    let value = value(case, is_rounded);
    let mut errors = [Vec::new(), Vec::new()];
    for p in points() {
        let Some(truth) = (case.truth)(p) else { continue };
        let error = method.direction(case, &value, p).map_or(180.0, |d| {
            let across = d.0[0] * truth.0[1] - d.0[1] * truth.0[0];
            libm::atan2(across.abs(), d.dot(truth)).to_degrees()
        });
        errors[usize::from(case.shape.distance(p) < 0.0)].push(error);
    }
    for side in &mut errors {
        side.sort_by(f64::total_cmp);
    }
    errors
}

/// The values of the field, as the memoir's program rounds them or not.
pub(crate) fn value(case: &Case, is_rounded: bool) -> impl Fn(Point<2>) -> f64 {
    move |p| {
        let value = case.shape.distance(p);
        if is_rounded { f64::from(value as f32) } else { value }
    }
}

/// The value that a share of the sorted `errors` does not exceed.
pub(crate) fn quantile(errors: &[f64], share: f64) -> f64 {
    errors[((errors.len() - 1) as f64 * share) as usize]
}

/// The page's table: errors in degrees.
pub(crate) fn table() -> Result<String, ShapeError> {
    let mut text = String::from(
        "| shape | method | outside: median | 99 % | max | inside: median | 99 % | max |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for case in &cases()? {
        let methods = [
            Method::ClosestVector,
            Method::CentralDifferences,
            Method::Dichotomy,
            Method::AdaptiveDichotomy,
            Method::Analytic,
        ];
        for method in methods {
            if method == Method::ClosestVector && !case.has_closest_vector {
                continue;
            }
            add_row(&mut text, case, method, false);
            let asks_values = method != Method::Analytic;
            if case.is_rounded && asks_values {
                add_row(&mut text, case, method, true);
            }
        }
    }
    Ok(text)
}

fn add_row(text: &mut String, case: &Case, method: Method, is_rounded: bool) {
    let note = if is_rounded { ", values in single precision" } else { "" };
    let _ = write!(text, "| {} | {}{note} |", case.name, method.name());
    for side in errors(case, method, is_rounded) {
        for share in [0.5, 0.99, 1.0] {
            let error = quantile(&side, share);
            let _ = if error < 0.001 {
                write!(text, " < 0.001 |")
            } else {
                write!(text, " {error:.3} |")
            };
        }
    }
    text.push('\n');
}
