// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Definitions of planar shapes with outlines of arcs, parabolas and hyperbolas.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4, PI, SQRT_2};

use palpate_field::kernel::Argument;
use palpate_field::{Point, Vector};

use super::planar::{FAR, arc};
use super::{Definition, Patch, number, vector};

/// Samples of a curve, before the search for the nearest point between them.
const LOOKS: usize = 256;

/// Steps of this search, each of which keeps two thirds of the interval.
const THIRDS: usize = 80;

/// The least distance of `p` from a curve over `[0, 1]`: samples the curve, and searches around
/// each sample that is nearer than its neighbours.
fn from_curve(p: Point<2>, at: impl Fn(f64) -> Point<2>) -> f64 {
    let distance = |t: f64| (p - at(t)).norm();
    let place = |i: usize| i as f64 / LOOKS as f64;
    let looks: Vec<f64> = (0..=LOOKS).map(|i| distance(place(i))).collect();
    let mut least = f64::INFINITY;
    for (i, here) in looks.iter().enumerate() {
        let (before, after) = (i.saturating_sub(1), (i + 1).min(LOOKS));
        if looks[before] < *here || looks[after] < *here {
            continue;
        }
        let (mut low, mut high) = (place(before), place(after));
        for _ in 0..THIRDS {
            let third = (high - low) / 3.0;
            if distance(low + third) < distance(high - third) {
                high -= third;
            } else {
                low += third;
            }
        }
        least = least.min(distance(low));
    }
    least
}

/// Half a circle below, a smaller arc on top, and two arcs that join them. The corners of an
/// equilateral triangle are the centres of the top and of the joining arcs.
fn egg(bottom: f64, top: f64) -> Definition<2> {
    let c = bottom - top;
    let high = c * 3.0_f64.sqrt();
    let side = 2.0 * c + top;
    let boundary = vec![
        arc([0.0; 2], bottom, [PI, 2.0 * PI]),
        arc([-c, 0.0], side, [0.0, PI / 3.0]),
        arc([c, 0.0], side, [2.0 * PI / 3.0, PI]),
        arc([0.0, high], top, [PI / 3.0, 2.0 * PI / 3.0]),
    ];
    let junction = high + top * (PI / 3.0).sin();
    let in_disc = |p: Point<2>, x: f64, y: f64, r: f64| (p - Vector([x, y])).norm() < r;
    Definition::new(boundary, move |p| {
        let between = p[1] >= 0.0
            && p[1] <= junction
            && in_disc(p, c, 0.0, side)
            && in_disc(p, -c, 0.0, side);
        (p[1] < 0.0 && p.norm() < bottom) || between || in_disc(p, 0.0, high, top)
    })
}

/// A square on its corner and the discs over its upper edges.
fn heart(height: f64) -> Definition<2> {
    let edge = height / (0.75 * SQRT_2 + 0.5);
    let half = edge * FRAC_1_SQRT_2;
    let low = -0.5 * height;
    let (middle, lobe) = (low + half, low + 1.5 * half);
    let tip = Vector([0.0, low]);
    let boundary = vec![
        Patch::segment(tip, Vector([half, middle])),
        Patch::segment(tip, Vector([-half, middle])),
        arc([0.5 * half, lobe], 0.5 * edge, [-FRAC_PI_4, 3.0 * FRAC_PI_4]),
        arc([-0.5 * half, lobe], 0.5 * edge, [FRAC_PI_4, 5.0 * FRAC_PI_4]),
    ];
    Definition::new(boundary, move |p| {
        let in_square = p[0].abs() + (p[1] - middle).abs() < half;
        let in_lobe = (Vector([p[0].abs(), p[1]]) - Vector([0.5 * half, lobe])).norm();
        in_square || in_lobe < 0.5 * edge
    })
}

/// A rhombus without four discs over its edges.
fn rounded_cross(size: Point<2>, r: f64) -> Definition<2> {
    let [a, b] = (size * 0.5).0;
    let chord = a.hypot(b);
    let beyond = (r * r - 0.25 * chord * chord).max(0.0).sqrt();
    let centre = [0.5 * a + beyond * b / chord, 0.5 * b + beyond * a / chord];
    let angle = |x: f64, y: f64| (y - centre[1]).atan2(x - centre[0]);
    // From the tip on y, to the left of the centre, to the tip on x, below it.
    let (mut from, to) = (angle(0.0, b), angle(a, 0.0));
    if from > 0.0 {
        from -= 2.0 * PI;
    }
    let mut boundary = Vec::new();
    for signs in [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]] {
        boundary.push(Patch::curve(r * (to - from).abs(), move |t| {
            let angle = from + (to - from) * t;
            let x = centre[0] + r * angle.cos();
            let y = centre[1] + r * angle.sin();
            Vector([signs[0] * x, signs[1] * y])
        }));
    }
    Definition::new(boundary, move |p| {
        let [x, y] = [p[0].abs(), p[1].abs()];
        x / a + y / b < 1.0 && (Vector([x, y]) - Vector(centre)).norm() > r
    })
}

/// Four concave arcs of parabolas between the tips, grown.
fn bobbly_cross(width: f64, dip: f64, r: f64) -> Definition<2> {
    let tip = 0.5 * width - r;
    let half_chord = tip * FRAC_1_SQRT_2;
    // In the frame of the diagonal (1, 1): the offset beside it, the place along it.
    let turned = |s: f64, t: f64| Vector([t + s, t - s]) * FRAC_1_SQRT_2;
    let on_arc = move |u: f64| turned(half_chord * u, half_chord - dip + dip * u * u);
    let grown = move |u: f64| {
        let slope = 2.0 * dip * u / half_chord;
        on_arc(u) + turned(-slope, 1.0) * (r / slope.hypot(1.0))
    };
    let steepest = 2.0 * dip / half_chord;
    let speed = 2.0 * half_chord * steepest.hypot(1.0) + 2.0 * r * steepest;
    let reach = FRAC_PI_4 + steepest.atan();
    let mut boundary = Vec::new();
    for quarter in 0..4 {
        let angle = 0.5 * PI * f64::from(quarter);
        let (sin, cos) = angle.sin_cos();
        let turn =
            move |p: Point<2>| Vector([cos * p[0] - sin * p[1], sin * p[0] + cos * p[1]]);
        boundary.push(Patch::curve(speed, move |t| turn(grown(2.0 * t - 1.0))));
        let end = turn(Vector([tip, 0.0]));
        boundary.push(arc(end.0, r, [angle - reach, angle + reach]));
    }
    let curvature_radius = half_chord * half_chord / (2.0 * dip);
    let cross = Definition::new(boundary, move |p| {
        let q = Vector([p[0].abs(), p[1].abs()]);
        let [s, t] = [q[0] - q[1], q[0] + q[1]].map(|x| x * FRAC_1_SQRT_2 / half_chord);
        let within = s.abs() < 1.0 && t * half_chord < half_chord + dip * (s * s - 1.0);
        within || from_curve(q, |u| on_arc(2.0 * u - 1.0)) < r
    });
    Definition { overlaps_itself: r > curvature_radius, ..cross }
}

/// The region above the graph of an even function on `|x| ≤ reach`, which is steepest at the
/// ends.
fn over(
    graph: impl Fn(f64) -> f64 + Copy + 'static,
    reach: f64,
    steepest: f64,
) -> Definition<2> {
    let curve = Patch::curve(2.0 * reach * steepest.hypot(1.0), move |t| {
        let x = reach * (2.0 * t - 1.0);
        Vector([x, graph(x)])
    });
    Definition::new(vec![curve], move |p| p[1] > graph(p[0]))
}

fn parabola_segment(width: f64, height: f64) -> Definition<2> {
    let half = 0.5 * width;
    let top = move |x: f64| height * (0.5 - (x / half) * (x / half));
    let speed = 2.0 * half.hypot(2.0 * height);
    let ends = [-half, half].map(|x| Vector([x, -0.5 * height]));
    let boundary = vec![
        Patch::segment(ends[0], ends[1]),
        Patch::curve(speed, move |t| {
            let x = half * (2.0 * t - 1.0);
            Vector([x, top(x)])
        }),
    ];
    Definition::new(boundary, move |p| -0.5 * height < p[1] && p[1] < top(p[0]))
}

/// The point, and the derivative, of the curve of three control points by de
/// Casteljau's lines.
fn bezier([a, b, c]: [Point<2>; 3], t: f64) -> [Point<2>; 2] {
    let (first, second) = (a + (b - a) * t, b + (c - b) * t);
    [first + (second - first) * t, (second - first) * 2.0]
}

/// A tube around a curve: parallels on either side, and round ends.
fn bezier_tube(points: [Point<2>; 3], r: f64) -> Definition<2> {
    let [a, b, c] = points;
    let across =
        |v: Point<2>| v.normalized().map_or(Vector([0.0, 1.0]), |v| Vector([-v[1], v[0]]));
    let second = (a - b * 2.0 + c) * 2.0;
    let fastest = (b - a).norm().max((c - b).norm()) * 2.0;
    let slowest = from_curve(Vector::ZERO, |t| bezier(points, t)[1]);
    let turning = (second[0] * (b - a)[1] - second[1] * (b - a)[0]).abs() * 2.0;
    // A curve that turns back on itself is a hairpin with a round end.
    let hairpin = turning * r > 1e3 * fastest * slowest * slowest;
    let turned = if hairpin || turning == 0.0 { 0.0 } else { turning / (slowest * slowest) };
    // The parameter of the least speed, at which a hairpin turns.
    let square = second.dot(second);
    let place = if square > 0.0 { -2.0 * (b - a).dot(second) / square } else { 0.5 };
    let place = place.clamp(0.0, 1.0);
    let mut boundary = Vec::new();
    for side in [r, -r] {
        for [from, to] in [[0.0, place], [place, 1.0]] {
            boundary.push(Patch::curve(fastest + r * turned, move |t| {
                let [p, v] = bezier(points, from + (to - from) * t);
                p + across(v) * side
            }));
        }
    }
    if hairpin || slowest <= 1e-9 * fastest {
        boundary.push(arc(bezier(points, place)[0].0, r, [0.0, 2.0 * PI]));
    }
    // Half circles, away from the curve.
    // The control point may be an end too.
    let tangent = |near: Point<2>, far: Point<2>| if near.norm() > 0.0 { near } else { far };
    for (end, away) in [(a, tangent(a - b, a - c)), (c, tangent(c - b, c - a))] {
        let [x, y] = away.0;
        let away = y.atan2(x);
        // The whole circle if all three points are equal.
        let reach = if x == 0.0 && y == 0.0 { PI } else { 0.5 * PI };
        boundary.push(arc(end.0, r, [away - reach, away + reach]));
    }
    let tube = Definition::new(boundary, move |p| from_curve(p, |t| bezier(points, t)[0]) < r);
    // With a smaller radius the parallels have no cusps.
    let curvature_radius = slowest.powi(3) / turning;
    Definition {
        overlaps_itself: turning == 0.0 || hairpin || r > 0.999 * curvature_radius,
        ..tube
    }
}

fn quadratic_circle(r: f64) -> Definition<2> {
    let mut boundary = Vec::new();
    for [x, y] in [[r, r], [-r, r], [-r, -r], [r, -r]] {
        let points = [Vector([x, 0.0]), Vector([x, y]), Vector([0.0, y])];
        boundary.push(Patch::curve(2.0 * r, move |t| bezier(points, t)[0]));
    }
    Definition::new(boundary, move |p| {
        let (sum, difference) = (p[0].abs() + p[1].abs(), p[0].abs() - p[1].abs());
        sum < 1.5 * r - difference * difference / (2.0 * r)
    })
}

/// Equal arcs about points on either side of the x axis in turn.
fn circle_wave(ring: f64, angle: f64, r: f64) -> Definition<2> {
    let half = 0.5 * angle;
    let pitch = 2.0 * ring * half.sin();
    // The centre of an arc, and which way it bulges.
    let arc_of = move |index: f64| {
        let up = if index.rem_euclid(2.0) == 0.0 { 1.0 } else { -1.0 };
        (Vector([pitch * index, -up * ring * half.cos()]), up)
    };
    let last = (FAR / pitch).ceil() + 1.0;
    let count = 2.0 * last + 1.0;
    let mut boundary = Vec::new();
    for side in [r, -r] {
        let speed = count * angle * (ring + r);
        boundary.push(Patch::curve(speed, move |t| {
            let place = t * count;
            let index = place.floor().min(count - 1.0);
            let (centre, up) = arc_of(index - last);
            let turned = (place - index - 0.5) * angle;
            centre + Vector([turned.sin(), up * turned.cos()]) * (ring + up * side)
        }));
    }
    let wave = Definition::new(boundary, move |p: Point<2>| {
        let nearest = (p[0] / pitch).round();
        (-3..=3_i32).any(|i| {
            let (centre, up) = arc_of(nearest + f64::from(i));
            let [x, y] = (p - centre).0;
            let end = Vector([half.sin(), half.cos()]) * ring;
            let distance = if x.abs().atan2(y * up) <= half {
                (x.hypot(y) - ring).abs()
            } else {
                (Vector([x.abs(), y * up]) - end).norm()
            };
            distance < r
        })
    });
    Definition { overlaps_itself: r > ring || (half > 0.5 * PI && pitch - ring < r), ..wave }
}

pub(super) fn definition(name: &str, a: &[Argument]) -> Option<Definition<2>> {
    let n = |i: usize| number(a, i);
    Some(match name {
        "egg" => egg(n(0), n(1)),
        "heart" => heart(n(0)),
        "rounded_cross" => rounded_cross(vector(a, 0), n(1)),
        "bobbly_cross" => bobbly_cross(n(0), n(1), n(2)),
        "parabola" => {
            let focal = n(0);
            let reach = FAR.min((4.0 * focal * FAR).sqrt());
            over(move |x| x * x / (4.0 * focal), reach, reach / (2.0 * focal))
        }
        "parabola_segment" => parabola_segment(n(0), n(1)),
        "quadratic_bezier" => bezier_tube([vector(a, 0), vector(a, 1), vector(a, 2)], n(3)),
        "quadratic_circle" => quadratic_circle(n(0)),
        "hyperbola" => {
            let [a, b] = vector::<2>(a, 0).0;
            // The vertex may be some way up.
            let reach = (FAR + b).min(a * (FAR + b) / b);
            over(move |x| b * (x / a).hypot(1.0), reach, b / a)
        }
        "circle_wave" => circle_wave(n(0), n(1), n(2)),
        _ => return None,
    })
}
