// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Laws of followed surfaces, on random trees.

use std::collections::HashMap;

use palpate::field::{Aabb, Rotation, Shape, Vector};
use palpate::plot::{PlaneView, Sampling, Slice, SurfaceLines};
use palpate::query::BallWorkspace;
use palpate_testkit::cases::on_trees;

use super::flat::{compare, outline};
use super::{Dimensions, Drawable};

const CELLS: usize = 60;

/// Edges of finest cells along a pixel: a sampling cell is two pixels and four edges.
const PIXEL: f64 = 2.0;

/// A window of a shape, with its surface.
struct Drawn {
    view: PlaneView,
    outline: SurfaceLines,
    /// Of a finest cell [m].
    edge: f64,
}

impl Drawn {
    fn of<const D: usize>(shape: &Shape<D>, plane: &Slice) -> Self
    where
        Dimensions: Drawable<D>,
    {
        let unit = Aabb::centred(Vector::constant(1.0));
        let bounds = shape.promise().bounds.map_or(unit, |bounds| bounds.aabb);
        let view = Dimensions::view(plane, &bounds, 0.1).unwrap();
        let sampling = Sampling::new(CELLS).unwrap();
        let outline = outline(shape, plane, &view, sampling).unwrap();
        let edge = view.width().max(view.height()) / (4 * CELLS) as f64;
        Self { view, outline, edge }
    }

    /// Points along the lines, a quarter of an edge apart at most [m].
    fn points(&self) -> Vec<[f64; 2]> {
        let mut points = Vec::new();
        for pair in self.outline.lines().iter().flat_map(|line| line.windows(2)) {
            let [a, b] = [pair[0], pair[1]];
            let length = (b[0] - a[0]).hypot(b[1] - a[1]);
            let steps = (4.0 * length / self.edge).ceil().max(1.0) as u32;
            let at = |step: u32| {
                let share = f64::from(step) / f64::from(steps);
                [0, 1].map(|k| a[k] + share * (b[k] - a[k]))
            };
            points.extend((0..=steps).map(at));
        }
        points
    }

    /// The distance of `p` from the nearest of `points`, if it is less than `reach` [m].
    fn near(points: &[[f64; 2]], reach: f64) -> impl Fn([f64; 2]) -> Option<f64> + use<> {
        let bucket = move |p: [f64; 2]| p.map(|x| (x / reach).floor() as i64);
        let mut buckets: HashMap<[i64; 2], Vec<[f64; 2]>> = HashMap::new();
        points.iter().for_each(|&p| buckets.entry(bucket(p)).or_default().push(p));
        move |p| {
            let [x, y] = bucket(p);
            let around = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [x + i, y + j]));
            let found = around.filter_map(|at| buckets.get(&at)).flatten();
            let distance = found.map(|q| (p[0] - q[0]).hypot(p[1] - q[1])).reduce(f64::min);
            distance.filter(|distance| *distance < reach)
        }
    }
}

/// Every change of sign beyond rounding between neighbouring samples, finer than any cell, lies within a pixel of
/// a line; and the field is within a pixel of zero on every line.
fn follows<const D: usize>(shape: &Shape<D>, plane: &Slice) -> Result<(), String>
where
    Dimensions: Drawable<D>,
{
    let drawn = Drawn::of(shape, plane);
    let points = drawn.points();
    let promise = shape.promise();
    let value = |p: [f64; 2]| shape.distance(Dimensions::point(plane, p));
    for &p in &points {
        // The Lipschitz constant holds in a region alone.
        let at = Dimensions::point(plane, p);
        let is_steep =
            promise.region.is_some_and(|ball| (at - ball.centre).norm() > ball.radius);
        let allowed =
            0.75 * promise.lipschitz * drawn.edge + promise.rounding.within(at.norm());
        if !is_steep && value(p).abs() > allowed {
            return Err(format!(
                "the value on a line is {} at {p:?}, over {allowed}",
                value(p)
            ));
        }
    }
    let near = Drawn::near(&points, PIXEL * drawn.edge);
    let step = 0.493 * drawn.edge;
    let count = [drawn.view.width(), drawn.view.height()].map(|size| (size / step) as usize);
    let place = |i: usize, j: usize| {
        let min = drawn.view.min();
        [min[0] + (i as f64 + 0.5) * step, min[1] + (j as f64 + 0.5) * step]
    };
    // Where two fields whose difference this is are equal in an area, signs are rounding.
    let sure = |p: [f64; 2], v: f64| {
        let rounding = promise.rounding.within(Dimensions::point(plane, p).norm());
        if v.abs() <= rounding { 0.0 } else { v.signum() }
    };
    let mut below: Vec<f64> = Vec::new();
    for j in 0..count[1] {
        let sign = |i: usize| sure(place(i, j), value(place(i, j)));
        let row: Vec<f64> = (0..count[0]).map(sign).collect();
        for i in 0..count[0] {
            let beside = (i > 0).then(|| row[i - 1]);
            let changes = [beside, below.get(i).copied()];
            let changes = changes.into_iter().flatten().any(|sign| sign * row[i] < 0.0);
            if changes && near(place(i, j)).is_none() {
                let p = place(i, j);
                return Err(format!("no line near the change of sign at {p:?}"));
            }
        }
        below = row;
    }
    Ok(())
}

#[test]
fn lines_follow_the_surfaces_of_random_trees_in_the_plane() {
    on_trees::<2>(60, 3, |_, _, shape| Ok(follows(shape, &Slice::planar())));
}

#[test]
fn lines_follow_the_surfaces_of_random_trees_on_slices_of_space() {
    let slices = [
        Slice::xy(0.01).unwrap(),
        Slice::xz(-0.02).unwrap(),
        Slice::free([0.01, 0.0, 0.02], [1.0, 2.0, 0.3], [0.2, -0.1, 1.0]).unwrap(),
    ];
    on_trees::<3>(30, 2, |u, _, shape| Ok(follows(shape, u.choose(&slices)?)));
}

/// Whether steps along the gradient lead from `p` to a zero within `reach` [m]. Where the surfaces
/// of two parts of a union touch within a pixel, lines show their walls, which have no zeros.
fn is_beside_a_zero(shape: &Shape<2>, p: [f64; 2], reach: f64) -> bool {
    let start = Vector(p);
    let (mut q, rounding) = (start, shape.promise().rounding.within(start.norm()));
    for _ in 0..8 {
        let (f, g) = shape.distance_gradient(q);
        if f.abs() <= 4.0 * rounding {
            return (q - start).norm() <= reach;
        }
        q -= g * f;
    }
    false
}

/// The nearest surface is no farther than what the picture shows of it, and no nearer than the
/// bounds say.
#[test]
fn bounds_of_distances_hold_for_the_lines_of_pictures() {
    let mut workspace = BallWorkspace::new();
    on_trees::<2>(40, 3, |_, _, shape| {
        let drawn = Drawn::of(shape, &Slice::planar());
        let (mut points, slack) = (drawn.points(), 2.0 * drawn.edge);
        points.retain(|&q| is_beside_a_zero(shape, q, drawn.edge));
        let (min, width) = (drawn.view.min(), drawn.view.width());
        for i in 0..12 {
            let share = [0.618, 0.414].map(|step| (step * f64::from(i)).fract());
            let p = [0, 1].map(|k| min[k] + share[k] * width);
            let found = compare(shape, Vector(p), &mut workspace).distance;
            let shown = points.iter().map(|q| (p[0] - q[0]).hypot(p[1] - q[1]));
            let shown = shown.reduce(f64::min).unwrap_or(f64::INFINITY);
            if found[0] > found[1] || found[0] > shown + slack {
                return Ok(Err(format!("{found:?} at {p:?}, where {shown} is shown")));
            }
        }
        Ok(Ok(()))
    });
}

/// Checks that all points of a `wire` are near lines, and that all lines are zeros.
fn check_wire(shape: &Shape<2>, wire: impl Fn(f64) -> [f64; 2]) {
    let drawn = Drawn::of(shape, &Slice::planar());
    let points = drawn.points();
    let near = Drawn::near(&points, 10.0 * drawn.edge);
    for p in (0..=1000).map(|i| wire(f64::from(i) / 1000.0)) {
        let found = near(p).unwrap_or(f64::INFINITY);
        assert!(found <= 0.75 * drawn.edge, "{found} of {} at {p:?}", drawn.edge);
    }
    for &p in &points {
        let value = shape.distance(p);
        assert!(value.abs() <= 0.5 * drawn.edge, "{value} of {} at {p:?}", drawn.edge);
    }
}

#[test]
fn wires_are_drawn_whole() {
    let along = |a: [f64; 2], b: [f64; 2]| {
        move |share: f64| [0, 1].map(|k| a[k] + share * (b[k] - a[k]))
    };
    // The second one runs along an axis through the middle of the window.
    for (a, b) in [([-0.4, -0.1], [0.3, 0.25]), ([-0.4, 0.0], [0.4, 0.0])] {
        check_wire(&Shape::segment(a, b, 0.0).unwrap(), along(a, b));
    }
    let arc = Shape::arc(0.3, 4.0, 0.0).unwrap();
    let on_arc = |share: f64| {
        let angle = 4.0 * (share - 0.5);
        [0.3 * angle.sin(), 0.3 * angle.cos()]
    };
    check_wire(&arc, on_arc);
}

#[test]
fn wires_are_drawn_beside_solids() {
    let (a, b) = ([-0.4, -0.1], [0.3, 0.25]);
    let wire = Shape::segment(a, b, 0.0).unwrap();
    let disc = Shape::circle(0.1).unwrap().translated([-0.25, 0.2]).unwrap();
    check_wire(&(wire | disc), |share| [0, 1].map(|k| a[k] + share * (b[k] - a[k])));
    // The upper stroke down the middle of the letter.
    let letter = Shape::cool_s(1.0).unwrap();
    let inner = |share: f64| [0.0, 0.1 + 0.2 * share];
    let zero = |share: f64| letter.distance(inner(share)).abs() < 1e-12;
    assert!((0..=10).all(|i| zero(f64::from(i) / 10.0)));
    check_wire(&letter, inner);
}

#[test]
fn gaps_and_walls_thinner_than_a_cell_are_lines() {
    let half = |x: f64| Shape::rectangle([0.5, 1.0]).unwrap().translated([x, 0.0]).unwrap();
    // A tenth of an edge wide: the window is 1.2 m high.
    let gap = 0.1 * 1.2 / (4 * CELLS) as f64;
    let parted = half(-0.25 - 0.5 * gap) | half(0.25 + 0.5 * gap);
    check_wire(&parted, |share| [0.0, share - 0.5]);
    let wall = Shape::rectangle([0.7, gap]).unwrap();
    let wall = wall.rotated(Rotation::from_angle(0.4).unwrap()).unwrap();
    let (sin, cos) = 0.4_f64.sin_cos();
    check_wire(&wall, |share| [0.7 * (share - 0.5) * cos, 0.7 * (share - 0.5) * sin]);
}

#[test]
fn a_sheet_in_the_plane_of_the_picture_is_surface_as_a_whole() {
    let corners = [[-0.3, -0.2, 0.0], [0.3, -0.2, 0.0], [0.3, 0.2, 0.0], [-0.3, 0.2, 0.0]];
    let sheet = Shape::quad_sheet(corners.map(Vector), 0.0).unwrap();
    let drawn = Drawn::of(&sheet, &Slice::xy(0.0).unwrap());
    let squares = drawn.outline.solids().iter();
    let area: f64 = squares.map(|square| (square[1][0] - square[0][0]).powi(2)).sum();
    // The cells along its edges are lines.
    assert!((area - 0.24).abs() < 2.0 * drawn.edge, "{area}");
    let is_inside = |[x, y]: &[f64; 2]| x.abs() < 0.301 && y.abs() < 0.201;
    assert!(drawn.points().iter().all(is_inside));
    let near = Drawn::near(&drawn.points(), drawn.edge);
    assert!((-9..10).all(|i| near([0.3, 0.02 * f64::from(i)]).is_some()));
}

#[test]
fn points_are_dots() {
    let point = Shape::segment([0.1, 0.2], [0.1, 0.2], 0.0).unwrap();
    let ball = Shape::circle(0.2).unwrap().translated([-0.3, -0.2]).unwrap();
    check_wire(&(point | ball), |_| [0.1, 0.2]);
}

#[test]
fn a_circle_is_a_line_within_a_tenth_of_a_pixel() {
    let drawn = Drawn::of(&Shape::circle(0.3).unwrap(), &Slice::planar());
    assert_eq!(drawn.outline.lines().len(), 1);
    for [x, y] in drawn.points() {
        assert!((x.hypot(y) - 0.3).abs() < 0.1 * PIXEL * drawn.edge, "({x}, {y})");
    }
}

#[test]
fn the_same_surface_is_followed_to_the_same_lines() {
    let shape = Shape::regular_star(5, 0.3, 0.12).unwrap();
    let outline = || Drawn::of(&shape, &Slice::planar()).outline;
    assert_eq!(outline(), outline());
}
