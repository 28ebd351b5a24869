// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that lie on flat faces, against the exact region of contact.
//!
//! The foot of a body is a convex polygon, or several; the top of the floor is one. Where they meet is
//! their intersection, by clipping. The polygon of the contacts leaves out no more than two spacings of
//! it, or the manifold says that it is not whole.

use arbitrary::{Result, Unstructured};
use palpate_field::{Point, Pose, Rotation, Shape, ShapeError, Vector};
use palpate_mesh::{Solid, TriangleMesh};
use palpate_query::{
    Limits, Manifold, ManifoldSettings, PairWorkspace, Placed, Track, manifold,
};
use palpate_testkit::arbitrary::{self as draw};
use palpate_testkit::cases;

/// A place on the floor.
type Place = [f64; 2];

/// Corners of a convex polygon, in order; two of a segment.
type Polygon = Vec<Place>;

/// A body whose feet are in the plane y = 0, and which is above it.
struct Lying {
    shape: Shape<3>,
    feet: Vec<Polygon>,
    /// How thick the body is above its feet [m].
    thickness: f64,
    /// Whether it lies on an edge of its own.
    is_edge: bool,
}

/// Next to the rim of the floor an edge is one of both bodies, and their overlap as wide as the largest ball in
/// it: less deep than a right angle by this share, 1 − 2/(1 + √2).
const BLUNTED: f64 = 0.1716;

/// How many corners a round foot is given.
const ROUND: u32 = 64;

fn rectangle([width, depth]: [f64; 2]) -> Polygon {
    let [x, z] = [0.5 * width, 0.5 * depth];
    vec![[-x, -z], [x, -z], [x, z], [-x, z]]
}

fn regular(count: u32, radius: f64, first: f64) -> Polygon {
    let angle = |i: u32| first + std::f64::consts::TAU * f64::from(i) / f64::from(count);
    (0..count).map(|i| [radius * angle(i).cos(), radius * angle(i).sin()]).collect()
}

fn moved(polygon: &Polygon, [x, z]: Place) -> Polygon {
    polygon.iter().map(|corner| [corner[0] + x, corner[1] + z]).collect()
}

fn turned(polygon: &Polygon, angle: f64) -> Polygon {
    let (sine, cosine) = angle.sin_cos();
    polygon.iter().map(|[x, z]| [cosine * x + sine * z, cosine * z - sine * x]).collect()
}

/// A box as a mesh of 12 triangles.
fn mesh_cuboid([x, y, z]: [f64; 3]) -> std::result::Result<Shape<3>, ShapeError> {
    let corner = |i: u32| {
        let side = |bit: u32, length: f64| if i & bit == 0 { -0.5 } else { 0.5 } * length;
        Vector([side(1, x), side(2, y), side(4, z)])
    };
    let faces = vec![
        [0, 2, 3],
        [0, 3, 1],
        [4, 5, 7],
        [4, 7, 6],
        [0, 1, 5],
        [0, 5, 4],
        [2, 6, 7],
        [2, 7, 3],
        [0, 4, 6],
        [0, 6, 2],
        [1, 3, 7],
        [1, 7, 5],
    ];
    let mesh = TriangleMesh::new((0..8).map(corner).collect(), faces).expect("a box");
    Ok(Shape::from(Solid::from_mesh(&mesh).expect("a box").0))
}

/// The bodies that lie, one of each kind.
fn lying(u: &mut Unstructured<'_>) -> Result<std::result::Result<Lying, ShapeError>> {
    let thin = 10.0_f64.powf(draw::within(u, -4.0, -1.0)?);
    let narrow = 10.0_f64.powf(draw::within(u, -2.0, 0.0)?);
    let kind = u.int_in_range(0..=9_u8)?;
    Ok(body(kind, thin, narrow))
}

fn lies(shape: Shape<3>, feet: Vec<Polygon>, thickness: f64) -> Lying {
    Lying { shape, feet, thickness, is_edge: false }
}

fn body(kind: u8, thin: f64, narrow: f64) -> std::result::Result<Lying, ShapeError> {
    let above = |shape: Shape<3>, y: f64| shape.translated([0.0, y, 0.0]);
    let quarter =
        Rotation::from_axis_angle(Vector([0.0, 0.0, 1.0]), 0.5 * std::f64::consts::PI)?;
    Ok(match kind {
        // Boards, rulers, tiles, paper.
        0 | 1 => {
            let size = [1.0, thin, narrow.max(thin)];
            let shape = if kind == 0 { Shape::cuboid(size)? } else { mesh_cuboid(size)? };
            let feet = vec![rectangle([size[0], size[2]])];
            lies(above(shape, 0.5 * thin)?, feet, thin)
        }
        2 => {
            let shape = above(Shape::<3>::cylinder(0.5, thin)?, 0.5 * thin)?;
            lies(shape, vec![regular(ROUND, 0.5, 0.0)], thin)
        }
        3 => {
            let triangle = regular(3, 0.5, 0.3);
            let corners: Vec<_> = triangle.iter().map(|place| Vector(*place)).collect();
            let shape = above(Shape::<2>::polygon([corners])?.extruded(thin)?, 0.5 * thin)?;
            lies(shape, vec![triangle], thin)
        }
        4 => {
            let radius = thin.max(0.005);
            let shape = above(Shape::<3>::capsule(radius, 1.0)?.rotated(quarter)?, radius)?;
            let feet = vec![vec![[radius - 0.5, 0.0], [0.5 - radius, 0.0]]];
            lies(shape, feet, 2.0 * radius)
        }
        5 => {
            let radius = thin.max(0.005);
            let shape = above(Shape::<3>::cylinder(radius, 1.0)?.rotated(quarter)?, radius)?;
            lies(shape, vec![vec![[-0.5, 0.0], [0.5, 0.0]]], 2.0 * radius)
        }
        // A box on its edge.
        6 => {
            let side = thin.max(0.01);
            let turn = Rotation::from_axis_angle(
                Vector([1.0, 0.0, 0.0]),
                0.25 * std::f64::consts::PI,
            )?;
            let half = side * 0.5_f64.sqrt();
            let shape = above(Shape::<3>::cuboid([1.0, side, side])?.rotated(turn)?, half)?;
            Lying {
                is_edge: true,
                ..lies(shape, vec![vec![[-0.5, 0.0], [0.5, 0.0]]], 2.0 * half)
            }
        }
        // A tripod, a table, a comb.
        7 => legs(&regular(3, 0.45, 0.2), thin.max(0.003), true)?,
        8 => legs(&rectangle([0.9, 0.9 * narrow.max(0.3)]), thin.max(0.003), false)?,
        _ => {
            let pitch = narrow.clamp(0.03, 0.3);
            let count = (1.0 / pitch) as u32;
            let places: Vec<_> =
                (0..=count).map(|i| [f64::from(i) * pitch - 0.5, 0.0]).collect();
            legs(&places, thin.clamp(0.002, 0.3 * pitch), false)?
        }
    })
}

/// A plate on legs of 0.3 m, round ones or square ones.
fn legs(
    places: &[Place],
    radius: f64,
    are_round: bool,
) -> std::result::Result<Lying, ShapeError> {
    let plate = Shape::<3>::cuboid([1.0, 0.02, 1.0])?.translated([0.0, 0.3, 0.0])?;
    let leg = |[x, z]: &Place| {
        let leg = if are_round {
            Shape::<3>::cylinder(radius, 0.3)?
        } else {
            Shape::<3>::cuboid([2.0 * radius, 0.3, 2.0 * radius])?
        };
        leg.translated([*x, 0.15, *z])
    };
    let parts = places.iter().map(leg).chain([Ok(plate)]);
    let shape = Shape::union(parts.collect::<std::result::Result<Vec<_>, _>>()?)?;
    let foot =
        if are_round { regular(ROUND, radius, 0.0) } else { rectangle([2.0 * radius; 2]) };
    let feet = places.iter().map(|place| moved(&foot, *place)).collect();
    Ok(lies(shape, feet, 0.3))
}

/// A floor whose top is in the plane y = 0, and the corners of its top.
struct Floor {
    shape: Shape<3>,
    top: Option<Polygon>,
    thickness: f64,
}

fn floor(u: &mut Unstructured<'_>) -> Result<std::result::Result<Floor, ShapeError>> {
    let kind = u.int_in_range(0..=3_u8)?;
    let size = [draw::within(u, 0.3, 2.0)?, draw::within(u, 0.3, 2.0)?];
    let thin = 10.0_f64.powf(draw::within(u, -3.0, -1.0)?);
    let below = |shape: Shape<3>, thickness: f64| {
        let shape = shape.translated([0.0, -0.5 * thickness, 0.0])?;
        Ok(Floor { shape, top: Some(rectangle(size)), thickness })
    };
    let block = |thickness: f64| [size[0], thickness, size[1]];
    Ok(match kind {
        0 => Shape::<3>::half_space([0.0, 1.0, 0.0], 0.0).map(|shape| Floor {
            shape,
            top: None,
            thickness: f64::INFINITY,
        }),
        1 => Shape::<3>::cuboid(block(1.0)).and_then(|shape| below(shape, 1.0)),
        2 => mesh_cuboid(block(1.0)).and_then(|shape| below(shape, 1.0)),
        _ => Shape::<3>::cuboid(block(thin)).and_then(|shape| below(shape, thin)),
    })
}

/// What a half-plane leaves of a convex polygon: the points with `(p − from)·inwards ≥ 0`.
fn clipped(polygon: &Polygon, from: Place, inwards: Place) -> Polygon {
    let inside = |p: &Place| (p[0] - from[0]) * inwards[0] + (p[1] - from[1]) * inwards[1];
    let mut left = Vec::new();
    for (i, here) in polygon.iter().enumerate() {
        let next = &polygon[(i + 1) % polygon.len()];
        let [a, b] = [inside(here), inside(next)];
        if a >= 0.0 {
            left.push(*here);
        }
        if (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0) {
            let share = a / (a - b);
            left.push([0, 1].map(|k| here[k] + share * (next[k] - here[k])));
        }
    }
    left
}

/// The intersection of two convex polygons; the second has corners in order, either way round.
fn intersection(polygon: &Polygon, other: &Polygon) -> Polygon {
    let count = other.len();
    let centre = [0, 1].map(|k| other.iter().map(|p| p[k]).sum::<f64>() / count as f64);
    (0..count).fold(polygon.clone(), |left, i| {
        let [from, to] = [other[i], other[(i + 1) % count]];
        let mut inwards = [from[1] - to[1], to[0] - from[0]];
        let side = (centre[0] - from[0]) * inwards[0] + (centre[1] - from[1]) * inwards[1];
        if side < 0.0 {
            inwards = inwards.map(|k| -k);
        }
        clipped(&left, from, inwards)
    })
}

/// How wide a convex polygon is where it is narrowest; a segment, how long it is [m].
fn width(polygon: &Polygon) -> f64 {
    let (mut narrowest, mut longest) = (f64::INFINITY, 0.0_f64);
    for (i, from) in polygon.iter().enumerate() {
        let to = polygon[(i + 1) % polygon.len()];
        let side = [to[0] - from[0], to[1] - from[1]];
        let length = side[0].hypot(side[1]);
        longest = longest.max(length);
        let beside = |p: &Place| (p[1] - from[1]) * side[0] - (p[0] - from[0]) * side[1];
        let wide = polygon.iter().map(|p| beside(p).abs()).fold(0.0, f64::max);
        // The sides of a clipped segment that are points, and those on each other, have no width.
        if wide > 1e-12 {
            narrowest = narrowest.min(wide / length);
        }
    }
    if narrowest.is_finite() { narrowest } else { longest }
}

/// How far a place is from the convex hull of others, by the widest strip between them.
fn away(place: Place, others: &[Place]) -> f64 {
    const DIRECTIONS: u32 = 360;
    (0..DIRECTIONS).fold(0.0_f64, |most, i| {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(DIRECTIONS);
        let along = |p: &Place| p[0] * angle.cos() + p[1] * angle.sin();
        let farthest = others.iter().map(along).fold(f64::NEG_INFINITY, f64::max);
        most.max(along(&place) - farthest)
    })
}

/// Two bodies that lie on each other, and what is true of them.
struct Case {
    bodies: [Shape<3>; 2],
    poses: [Pose<3>; 2],
    /// From the world to where the top of the floor is y = 0.
    floor_from_world: Pose<3>,
    patches: Vec<Polygon>,
    depth: f64,
    thinnest: f64,
    /// Whether one body is more than half way through the other.
    is_behind: bool,
    /// By what share of the depth the deepest gap may be less.
    blunted: f64,
    size: f64,
}

fn case(u: &mut Unstructured<'_>) -> Result<Option<Case>> {
    let (Ok(lying), Ok(floor)) = (lying(u)?, floor(u)?) else { return Ok(None) };
    let size = Track::new(floor.shape.clone(), lying.shape.clone()).size();
    let depth = match u.int_in_range(0..=3_u8)? {
        0 => 0.0,
        1 => draw::within(u, -1.0, 1.0)? * 1e-5 * size,
        _ => draw::within(u, -1e-3, 3e-3)? * size,
    };
    let (angle, there) = (
        draw::within(u, 0.0, 7.0)?,
        [draw::within(u, -0.3, 0.3)?, draw::within(u, -0.3, 0.3)?],
    );
    let feet = lying.feet.iter().map(|foot| moved(&turned(foot, angle), there));
    let patches = feet
        .map(|foot| floor.top.as_ref().map_or(foot.clone(), |top| intersection(&foot, top)))
        .filter(|patch| !patch.is_empty())
        .collect();
    let Ok(yaw) = Rotation::from_axis_angle(Vector([0.0, 1.0, 0.0]), angle) else {
        return Ok(None);
    };
    let world_from_floor = draw::pose::<3>(u)?;
    let lies = Pose::new(yaw, Vector([there[0], -depth, there[1]]));
    Ok(Some(Case {
        bodies: [floor.shape, lying.shape],
        poses: [world_from_floor, world_from_floor * lies],
        floor_from_world: world_from_floor.inverse(),
        patches,
        depth,
        thinnest: floor.thickness.min(lying.thickness),
        is_behind: depth > 0.5 * (floor.thickness + lying.thickness),
        blunted: if lying.is_edge && floor.top.is_some() { BLUNTED } else { 0.0 },
        size,
    }))
}

fn on_floor(pose: &Pose<3>, p: Point<3>) -> Place {
    let Vector([x, _, z]) = pose.transform_point(p);
    [x, z]
}

/// What is wrong with the contacts of a case.
fn complaint(case: &Case, found: &Manifold<3>, settings: &ManifoldSettings) -> Option<String> {
    let middles: Vec<Place> = found
        .contacts
        .iter()
        .map(|contact| {
            on_floor(&case.floor_from_world, (contact.point_a + contact.point_b) * 0.5)
        })
        .collect();
    let near = 2.0 * settings.spacing;
    for patch in &case.patches {
        for corner in patch {
            let left_out = away(*corner, &middles);
            if left_out > near {
                return Some(format!("{left_out} m are left out at {corner:?} of {patch:?}"));
            }
        }
        let [x, z] = patch[0];
        let apart = |other: &Place| (other[0] - x).hypot(other[1] - z);
        let is_small = patch.iter().all(|corner| apart(corner) < near);
        let others = case.patches.iter().filter(|other| *other != patch);
        let is_alone = others.flatten().all(|other| apart(other) > 3.0 * near);
        if is_small && is_alone && middles.iter().all(|place| apart(place) > 2.0 * near) {
            return Some(format!("no contact at {patch:?}"));
        }
    }
    let deepest =
        found.contacts.iter().map(|contact| contact.gap).fold(f64::INFINITY, f64::min);
    // In thin bodies the deepest gap may be the separation alone; in narrow patches, it may be that of the sides.
    let widest = case.patches.iter().map(width).fold(0.0, f64::max);
    let is_thick = case.thinnest > 8.0 * case.depth.abs()
        && widest > 8.0 * case.depth.max(settings.margin);
    let precise = 0.05 * settings.margin;
    let is_right = deepest > -case.depth - precise
        && deepest < -case.depth + case.blunted * case.depth.max(0.0) + precise;
    if is_thick && !is_right {
        return Some(format!("the deepest gap is {deepest}, the depth {}", case.depth));
    }
    None
}

/// What was asked of the cases so far.
#[derive(Default)]
struct Asked {
    all: u32,
    whole: u32,
    workspace: PairWorkspace<3>,
}

impl Asked {
    /// What is wrong with the contacts of a case that is drawn.
    fn ask(&mut self, u: &mut Unstructured<'_>) -> Result<std::result::Result<(), String>> {
        let Some(case) = case(u)? else { return Ok(Ok(())) };
        if case.patches.is_empty() || case.is_behind {
            return Ok(Ok(()));
        }
        let settings = ManifoldSettings { most: 64, ..ManifoldSettings::of_size(case.size) };
        let limits = Limits::new(settings.usual_tolerance());
        let [a, b] = [0, 1].map(|i| Placed::new(&case.bodies[i], case.poses[i]));
        let found = manifold(a, b, &settings, &limits, &mut self.workspace).expect("bounded");
        self.all += 1;
        self.whole += u32::from(found.is_whole);
        if !found.is_whole {
            return Ok(Ok(()));
        }
        let wrong = complaint(&case, &found, &settings);
        Ok(wrong.map_or(Ok(()), |wrong| {
            let places = found.contacts.iter().map(|contact| {
                let [x, z] =
                    on_floor(&case.floor_from_world, (contact.point_a + contact.point_b) * 0.5);
                format!("{x:.4} {z:.4} {:.2e}", contact.gap)
            });
            let places: Vec<_> = places.collect();
            let Case { bodies, depth, .. } = case;
            let spacing = settings.spacing;
            Err(format!("{wrong}: spacing {spacing}, {depth} deep: {places:?}, {bodies:?}"))
        }))
    }
}

#[test]
fn contacts_span_flat_patches() {
    let mut asked = Asked::default();
    cases::check(4000, |u| asked.ask(u));
    let Asked { all, whole, .. } = asked;
    assert!(whole >= 95 * all / 100, "{whole} of {all} are whole");
}

/// Once, these cases left out more than two spacings.
#[test]
fn contacts_still_span_flat_patches() {
    let mut asked = Asked::default();
    cases::these(&[2591, 3149, 20212, 26912, 44049, 108_509], |u| asked.ask(u));
}
