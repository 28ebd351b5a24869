// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Definitions of more primitives of the plane: outlines of lines and arcs.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_4, PI};

use palpate_field::kernel::Argument;
use palpate_field::{Point, Vector};

use super::planar::{AXES, arc, from_segment, polygon};
use super::{Definition, Patch, number, vector};

fn line(a: [f64; 2], b: [f64; 2]) -> Patch<2> {
    Patch::segment(Vector(a), Vector(b))
}

/// The pieces on the right, and their mirror images on the left.
fn both_sides(
    right: Vec<Patch<2>>,
    contains: impl Fn(Point<2>) -> bool + 'static,
) -> Definition<2> {
    let mut boundary = Vec::new();
    for piece in right {
        let (kept, mirrored) = piece.mirrored();
        boundary.extend([kept, mirrored]);
    }
    Definition::new(boundary, contains)
}

fn corners_of(corners: &[[f64; 2]]) -> Definition<2> {
    polygon(vec![corners.iter().map(|c| Vector(*c)).collect()])
}

/// A rectangle with its corners cut by arcs: top left, top right, bottom right, bottom left.
fn rounded_rectangle(size: Point<2>, radii: [f64; 4]) -> Definition<2> {
    let half = size * 0.5;
    let signs = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
    let centre = move |i: usize| {
        let [sx, sy] = signs[i];
        Vector([sx * (half[0] - radii[i]), sy * (half[1] - radii[i])])
    };
    let mut boundary = Vec::new();
    for (i, from) in [FRAC_PI_2, 0.0, -FRAC_PI_2, PI].into_iter().enumerate() {
        boundary.push(arc(centre(i).0, radii[i], [from, from + FRAC_PI_2]));
        let next = (i + 1) % 4;
        // The edge's normal is the mean of its corners' signs.
        let out = (Vector(signs[i]) + Vector(signs[next])) * 0.5;
        let ends = [i, next].map(|k| centre(k) + out * radii[k]);
        boundary.push(Patch::segment(ends[0], ends[1]));
    }
    Definition::new(boundary, move |p| {
        let in_corner = |i: usize| {
            let q = p - centre(i);
            q[0] * signs[i][0] > 0.0 && q[1] * signs[i][1] > 0.0
        };
        let cut = (0..4).any(|i| in_corner(i) && (p - centre(i)).norm() >= radii[i]);
        p[0].abs() < half[0] && p[1].abs() < half[1] && !cut
    })
}

fn oriented_rectangle(from: Point<2>, to: Point<2>, width: f64) -> Option<Definition<2>> {
    let along = (to - from).normalized()?;
    let across = Vector([-along[1], along[0]]) * (0.5 * width);
    Some(polygon(vec![vec![from - across, to - across, to + across, from + across]]))
}

fn stairs(w: f64, h: f64, steps: usize) -> Definition<2> {
    let n = steps as f64;
    let at = |x: f64, y: f64| Vector([(x - 0.5 * n) * w, (y - 0.5 * n) * h]);
    let mut ring = vec![at(0.0, 0.0), at(n, 0.0), at(n, n)];
    for k in (0..steps).rev() {
        let k = k as f64;
        ring.push(at(k, k + 1.0));
        if k > 0.0 {
            ring.push(at(k, k));
        }
    }
    polygon(vec![ring])
}

fn rounded_x(size: f64, r: f64) -> Definition<2> {
    let end = 0.5 * size - r;
    let straight = end >= r * FRAC_1_SQRT_2;
    // A half turn about the diagonal, extended to where the arc crosses the axes.
    let reach = if straight { FRAC_PI_4 } else { (end / r).asin() };
    let from = if straight { -FRAC_PI_4 } else { -reach };
    let to = FRAC_PI_2 - from;
    let mut right = Vec::new();
    for sign in [1.0, -1.0] {
        let up = Vector([0.0, sign]);
        right.push(Patch::arc(Vector([end, sign * end]), [AXES[0], up], r, [from, to]));
        if straight {
            let s = r * FRAC_1_SQRT_2;
            let inner = r / FRAC_1_SQRT_2;
            right.push(line([inner, 0.0], [end + s, sign * (end - s)]));
            right.push(line([0.0, sign * inner], [end - s, sign * (end + s)]));
        }
    }
    both_sides(right, move |p| {
        let stroke = |y: f64| from_segment(Vector([-end, -y]), Vector([end, y]), p) < r;
        stroke(end) || stroke(-end)
    })
}

fn tunnel(width: f64, height: f64) -> Definition<2> {
    let (r, floor) = (0.5 * width, -0.5 * height);
    let spring = 0.5 * height - r;
    let right = vec![
        arc([0.0, spring], r, [0.0, FRAC_PI_2]),
        line([r, spring], [r, floor]),
        line([0.0, floor], [r, floor]),
    ];
    both_sides(right, move |p| {
        let in_arch = (p - Vector([0.0, spring])).norm() < r;
        p[1] > floor && (in_arch || (p[1] < spring && p[0].abs() < r))
    })
}

/// All discs between two on the y axis, whose centre and radius are interpolated linearly.
fn uneven_capsule(bottom: f64, top: f64, height: f64) -> Definition<2> {
    let half = 0.5 * height;
    // From the axis to where the tangent touches the discs.
    let angle = FRAC_PI_2 - ((bottom - top) / height).acos();
    let touch = |y: f64, r: f64| [r * angle.cos(), y + r * angle.sin()];
    let right = vec![
        arc([0.0, -half], bottom, [-FRAC_PI_2, angle]),
        line(touch(-half, bottom), touch(half, top)),
        arc([0.0, half], top, [angle, FRAC_PI_2]),
    ];
    both_sides(right, move |p| {
        let beyond = |t: f64| {
            let centre = Vector([0.0, -half + t * height]);
            (p - centre).norm() - (bottom + t * (top - bottom))
        };
        // Convex in t, so a ternary search finds the minimum.
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..200 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if beyond(a) < beyond(b) {
                high = b;
            } else {
                low = a;
            }
        }
        beyond(low).min(beyond(0.0)).min(beyond(1.0)) < 0.0
    })
}

/// The part of a ring within half the angle from +y.
fn sector(inner: f64, outer: f64, angle: f64) -> Definition<2> {
    let half = 0.5 * angle;
    let angles = [FRAC_PI_2 - half, FRAC_PI_2];
    let at = |r: f64| [r * half.sin(), r * half.cos()];
    let right = vec![
        arc([0.0; 2], inner, angles),
        arc([0.0; 2], outer, angles),
        line(at(inner), at(outer)),
    ];
    both_sides(right, move |p| {
        let r = p.norm();
        inner < r && r < outer && p[0].abs().atan2(p[1]) < half
    })
}

fn horseshoe(ring: f64, angle: f64, length: f64, width: f64) -> Definition<2> {
    let half = 0.5 * angle;
    let (inner, outer) = (ring - 0.5 * width, ring + 0.5 * width);
    let angles = [FRAC_PI_2 - half, FRAC_PI_2];
    let (out, along) = (Vector([half.sin(), half.cos()]), Vector([half.cos(), -half.sin()]));
    let at = |r: f64, t: f64| out * r + along * t;
    let mut right = vec![Patch::segment(at(inner, length), at(outer, length))];
    for r in [inner, outer] {
        right.push(arc([0.0; 2], r, angles));
        right.push(Patch::segment(at(r, 0.0), at(r, length)));
    }
    both_sides(right, move |p| {
        let p = Vector([p[0].abs(), p[1]]);
        let r = if p[0].atan2(p[1]) < half { p.norm() } else { p.dot(out) };
        inner < r && r < outer && p.dot(along) < length
    })
}

fn cut_disk(r: f64, height: f64) -> Definition<2> {
    let from = (height / r).asin();
    let corner = [r * from.cos(), height];
    let right = vec![arc([0.0; 2], r, [from, FRAC_PI_2]), line([0.0, height], corner)];
    both_sides(right, move |p| p.norm() < r && p[1] > height)
}

fn moon(r: f64, cut: f64, distance: f64) -> Definition<2> {
    let cosine = |a: f64, b: f64| (a * a + distance * distance - b * b) / (2.0 * a * distance);
    // At the disc's centre from +y to the tip, at the other's from −y.
    let (at_disc, at_cut) = (cosine(r, cut).acos(), cosine(cut, r).acos());
    let right = vec![
        arc([0.0; 2], r, [-FRAC_PI_2, FRAC_PI_2 - at_disc]),
        arc([0.0, distance], cut, [-FRAC_PI_2, at_cut - FRAC_PI_2]),
    ];
    let centre = Vector([0.0, distance]);
    both_sides(right, move |p| p.norm() < r && (p - centre).norm() > cut)
}

/// The intersection of two discs whose circles meet at `from` and `to`, `width` across.
fn lens(from: Point<2>, to: Point<2>, width: f64) -> Option<Definition<2>> {
    let along = (to - from).normalized()?;
    let across = Vector([along[1], -along[0]]);
    let half = 0.5 * (to - from).norm();
    // Half the angle that the arcs span, which is the angle between tangent and chord at the
    // tip.
    let span = 2.0 * (width / (2.0 * half)).atan();
    let r = half / span.sin();
    let middle = (from + to) * 0.5;
    let inward = r - 0.5 * width;
    let centres = [middle - across * inward, middle + across * inward];
    let boundary = [1.0, -1.0]
        .into_iter()
        .zip(centres)
        .map(|(sign, centre)| Patch::arc(centre, [across * sign, along], r, [-span, span]));
    let boundary = boundary.collect();
    Some(Definition::new(boundary, move |p| centres.iter().all(|c| (p - *c).norm() < r)))
}

pub(super) fn definition(name: &str, a: &[Argument]) -> Option<Definition<2>> {
    let n = |i: usize| number(a, i);
    Some(match name {
        "rounded_rectangle" => rounded_rectangle(vector(a, 0), [n(1), n(2), n(3), n(4)]),
        "chamfered_rectangle" => {
            let ([x, y], c) = ((vector::<2>(a, 0) * 0.5).0, n(1));
            corners_of(&[
                [x, y - c],
                [x - c, y],
                [c - x, y],
                [-x, y - c],
                [-x, c - y],
                [c - x, -y],
                [x - c, -y],
                [x, c - y],
            ])
        }
        "oriented_rectangle" => oriented_rectangle(vector(a, 0), vector(a, 1), n(2))?,
        "rhombus" => {
            let [x, y] = (vector::<2>(a, 0) * 0.5).0;
            corners_of(&[[x, 0.0], [0.0, y], [-x, 0.0], [0.0, -y]])
        }
        "isosceles_trapezoid" => {
            let (bottom, top, half) = (0.5 * n(0), 0.5 * n(1), 0.5 * n(2));
            corners_of(&[[bottom, -half], [top, half], [-top, half], [-bottom, -half]])
        }
        "isosceles_triangle" => {
            let (foot, half) = (0.5 * n(0), 0.5 * n(1));
            corners_of(&[[foot, -half], [0.0, half], [-foot, -half]])
        }
        "parallelogram" => {
            let (w, h, s) = (0.5 * n(0), 0.5 * n(1), 0.5 * n(2));
            corners_of(&[[w - s, -h], [w + s, h], [s - w, h], [-w - s, -h]])
        }
        "stairs" => stairs(n(0), n(1), n(2) as usize),
        "cross" => {
            let (l, w) = (0.5 * n(0), 0.5 * n(1));
            corners_of(&[
                [l, w],
                [w, w],
                [w, l],
                [-w, l],
                [-w, w],
                [-l, w],
                [-l, -w],
                [-w, -w],
                [-w, -l],
                [w, -l],
                [w, -w],
                [l, -w],
            ])
        }
        "rounded_x" => rounded_x(n(0), n(1)),
        "tunnel" => tunnel(n(0), n(1)),
        "uneven_capsule" => uneven_capsule(n(0), n(1), n(2)),
        "pie" => sector(0.0, n(0), n(1)),
        "ring_sector" => sector(n(0), n(1), n(2)),
        "horseshoe" => horseshoe(n(0), n(1), n(2), n(3)),
        "cut_disk" => cut_disk(n(0), n(1)),
        "moon" => moon(n(0), n(1), n(2)),
        "vesica" => {
            let tip = Vector([0.0, 0.5 * n(1)]);
            lens(-tip, tip, n(0))?
        }
        "oriented_vesica" => lens(vector(a, 0), vector(a, 1), n(2))?,
        _ => return None,
    })
}
