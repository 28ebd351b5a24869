// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Meshes and outlines on random trees, against samples of all elements and against each
//! element asked by itself; contacts of bumps, flats and ridges.
#![expect(clippy::unwrap_used, reason = "these are tests")]

use arbitrary::Unstructured;
use palpate_field::kernel::{Ball, Cuboid};
use palpate_field::scalar::Scalar;
use palpate_field::{Point, Pose, Promise, Shape, ShapeError, Vector};
use palpate_mesh::{Mesh, MeshError, Outline, TriangleMesh};
use palpate_query::{
    Contact, Element, ElementWorkspace, Limits, MeshContact, MeshContacts, MeshWorkspace,
    Placed, PlacedMesh, QueryError, Stop, contacts, mesh_contacts, mesh_hits, minimum, touches,
};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::cases;
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::Solid;

/// Samples along an edge.
const SAMPLES: u32 = 8;

/// A mesh of up to 300 elements in a ball near the surface of a shape: a walk of small
/// steps, with a few elements that are large, flat, doubled or without an extent.
fn mesh<const N: usize, const D: usize>(
    u: &mut Unstructured<'_>,
    shape: &Shape<D>,
) -> arbitrary::Result<Mesh<N, D>> {
    let size = draw::size(shape) * [0.1, 0.5, 2.0][u.choose_index(3)?];
    let middle = draw::point(u, shape)?;
    let count = [1, 2, 8, 9, 70, 300][u.choose_index(6)?];
    let mut vertices = vec![middle];
    for _ in 0..count {
        let step = size * draw::unit(u)? * if u.ratio(1, 20)? { 1.0 } else { 0.1 };
        let last = vertices[vertices.len() - 1];
        let back = (middle - last) * if u.ratio(1, 10)? { 1.0 } else { 0.0 };
        vertices.push(last + back + draw::direction::<D>(u)? * step);
    }
    let mut elements = Vec::new();
    for i in 0..count as u32 {
        let mut element = [i; N];
        for index in &mut element[1..] {
            *index = (i + u.int_in_range(0..=2)?).min(count as u32);
        }
        elements.push(element);
    }
    Mesh::new(vertices, elements).map_err(|_| arbitrary::Error::IncorrectFormat)
}

fn on_trees<const N: usize, const D: usize>(count: u64)
where
    Space: Solid<D> + Turn<D>,
{
    let mut workspace = MeshWorkspace::new();
    let mut alone = ElementWorkspace::new();
    let (mut seen, mut unknown) = (0, 0);
    cases::on_trees(count, 4, |u, _, shape| {
        let mesh: Mesh<N, D> = mesh(u, shape)?;
        let size = draw::size(shape);
        let pose = Pose::new(
            <Space as Turn<D>>::rotation(u)?,
            draw::direction::<D>(u)? * (0.1 * size),
        );
        let gap = [0.0, 0.03 * size][u.choose_index(2)?];
        let level = gap * shape.promise().lipschitz.max(1.0);
        let limits = Limits::new(1e-6 * size);
        let placed = PlacedMesh::new(&mesh, pose);
        let answer = mesh_hits(shape, placed, gap, &limits, &mut workspace).unwrap();
        let (hits, undecided) = (answer.hits.to_vec(), answer.undecided.to_vec());
        seen += mesh.elements().len();
        unknown += undecided.len();
        for name in 0..mesh.elements().len() {
            let is_hit = hits.binary_search(&(name as u32)).is_ok();
            let is_open = undecided.iter().find(|open| open.element as usize == name);
            let corners = mesh.corners(name).map(|corner| pose.transform_point(corner));
            let rounding = |p: Point<D>| shape.promise().rounding.within(p.norm());
            for p in draw::all_over(&corners, SAMPLES) {
                let value = shape.distance(p) + rounding(p);
                if !is_hit && is_open.is_none_or(|open| value < open.lower) && value < level {
                    return Ok(Err(format!("missed {name} at {p:?}: {value}")));
                }
            }
            // Each by itself.
            let element = Element::new(corners).unwrap();
            let one = minimum(shape, &element, &limits, &mut alone).unwrap();
            if is_hit && one.lower > level || !is_hit && is_open.is_none() && one.upper < level
            {
                return Ok(Err(format!("{name} is {one:?}, hit {is_hit}")));
            }
        }
        // Ten evaluations prove little, and nothing that is wrong.
        let hasty = limits.with_budget(10);
        let answer = mesh_hits(shape, placed, gap, &hasty, &mut workspace).unwrap();
        for hit in &answer.hits {
            if hits.binary_search(hit).is_err() && undecided.iter().all(|o| o.element != *hit) {
                return Ok(Err(format!("{hit} touches in haste alone")));
            }
        }
        for hit in &hits {
            let is_open = answer.undecided.iter().any(|open| open.element == *hit);
            if answer.hits.binary_search(hit).is_err() && !is_open {
                return Ok(Err(format!("{hit} is free in haste alone")));
            }
        }
        Ok(contacts_are_right(shape, &mesh, pose, gap, &limits))
    });
    assert!(unknown * 1000 <= seen, "{unknown} of {seen} elements are undecided");
}

/// Contacts lie on their elements, as deep as the least value there, and are what they say.
fn contacts_are_right<const N: usize, const D: usize>(
    shape: &Shape<D>,
    mesh: &Mesh<N, D>,
    pose: Pose<D>,
    gap: f64,
    limits: &Limits,
) -> Result<(), String> {
    let (mut workspace, mut alone) = (MeshWorkspace::new(), ElementWorkspace::new());
    let placed = PlacedMesh::new(mesh, pose);
    let all = mesh_contacts(shape, placed, gap, limits, &mut workspace).unwrap();
    let is_named = |(i, touch): (usize, &MeshContact<D>)| touch.contact.id == i as u64;
    if !all.contacts.is_sorted_by_key(|touch| touch.element)
        || !all.contacts.iter().enumerate().all(is_named)
    {
        return Err("contacts are out of order".to_owned());
    }
    for &hit in &all.hits {
        let corners = mesh.corners(hit as usize).map(|corner| pose.transform_point(corner));
        let element = Element::new(corners).unwrap();
        let least = minimum(shape, &element, limits, &mut alone).unwrap();
        let here = contacts(shape, &element, gap, limits, &mut alone).unwrap();
        let of_hit = all.contacts.iter().filter(|touch| touch.element == hit);
        if of_hit.clone().count() != here.contacts.len().max(1) {
            return Err(format!("{:?} of {hit} are not {here:?}", of_hit.collect::<Vec<_>>()));
        }
        for (i, a) in here.contacts.iter().enumerate() {
            for b in &here.contacts[..i] {
                if !is_barrier_between(shape, a.point_b, b.point_b, limits.tolerance) {
                    return Err(format!("no barrier on {hit} between {a:?} and {b:?}"));
                }
            }
        }
        let values = of_hit.map(|touch| shape.distance(touch.contact.point_b));
        let deepest = values.fold(f64::INFINITY, f64::min);
        let is_known = here.least.stop == Stop::Converged;
        if is_known && deepest > least.upper + limits.tolerance {
            return Err(format!("the deepest of {hit} is {deepest}, not {least:?}, {here:?}"));
        }
        if here.least.lower > least.upper || here.least.upper < least.lower {
            return Err(format!("{:?} is not {least:?}", here.least));
        }
    }
    for MeshContact { contact, .. } in &all.contacts {
        let along = (contact.point_b - contact.point_a).dot(contact.normal);
        if (contact.normal.norm() - 1.0).abs() > 1e-9 || (along - contact.gap).abs() > 1e-9 {
            return Err(format!("{contact:?} does not agree with itself"));
        }
    }
    Ok(())
}

/// `true` if the field may be larger by the tolerance on the way from one point to another
/// than at both.
fn is_barrier_between<const D: usize>(
    shape: &Shape<D>,
    a: Point<D>,
    b: Point<D>,
    tolerance: f64,
) -> bool {
    const STEPS: u32 = 64;
    let least = shape.distance(a).max(shape.distance(b)) + tolerance;
    // Between two samples the field may be larger than at both.
    let unseen = shape.promise().lipschitz * 0.5 * (b - a).norm() / f64::from(STEPS);
    let rounding = shape.promise().rounding.within(a.norm().max(b.norm()));
    (0..=STEPS).any(|step| {
        let value = shape.distance(a + (b - a) * (f64::from(step) / f64::from(STEPS)));
        value + unseen + 2.0 * rounding >= least
    })
}

#[test]
fn every_triangle_of_a_mesh_is_decided_and_none_is_missed() {
    on_trees::<3, 3>(150);
}

#[test]
fn every_segment_of_an_outline_is_decided_and_none_is_missed() {
    on_trees::<2, 2>(150);
}

#[test]
fn segments_in_space_and_triangles_in_the_plane_are_decided_too() {
    on_trees::<2, 3>(40);
    on_trees::<3, 2>(40);
}

/// The contacts of a triangle that lies at `height` over the plane of x and z.
fn on_triangle(shape: &Shape<3>, height: f64, gap: f64) -> Vec<Contact<3>> {
    let corners = [[-3.0, height, -2.0], [3.0, height, -2.0], [0.0, height, 4.0]].map(Vector);
    let limits = Limits::new(1e-5);
    let mut workspace = ElementWorkspace::new();
    let element = Element::new(corners).unwrap();
    contacts(shape, &element, gap, &limits, &mut workspace).unwrap().contacts.to_vec()
}

fn bump(x: f64, z: f64, radius: f64) -> Result<Shape<3>, ShapeError> {
    Shape::from_kernel(Ball::new(radius)?).translated(Vector([x, 0.0, z]))
}

#[test]
fn a_triangle_over_bumps_touches_each() -> Result<(), ShapeError> {
    let places = [(-1.0, -1.0, 0.52), (1.0, -1.0, 0.51), (0.0, 1.5, 0.50)];
    for count in 1..=3 {
        let bumps = places[..count].iter().map(|&(x, z, radius)| bump(x, z, radius));
        let bumps = Shape::union(bumps.collect::<Result<Vec<_>, _>>()?)?;
        // Within them, and over them by less than the gap.
        for (height, gap) in [(0.4, 0.0), (0.6, 0.15)] {
            let found = on_triangle(&bumps, height, gap);
            assert_eq!(found.len(), count, "{found:?}");
            for (contact, (x, z, radius)) in found.iter().zip(places) {
                let apart = contact.point_b - Vector([x, height, z]);
                assert!((contact.gap - (height - radius)).abs() < 1e-5, "{contact:?}");
                // A value that is off by the tolerance is off by its square root in place.
                assert!(apart.norm() < 0.01, "{contact:?}");
                assert!((contact.normal - Vector([0.0, 1.0, 0.0])).norm() < 0.03);
            }
        }
    }
    Ok(())
}

#[test]
fn bumps_joined_below_the_triangle_are_two_contacts_still() -> Result<(), ShapeError> {
    // At the height of 0.1, all of the triangle between the bumps is inside.
    let dumbbell = Shape::union([
        bump(-1.0, 0.0, 0.5)?,
        bump(1.0, 0.0, 0.5)?,
        Shape::from_kernel(Cuboid::new(Vector([2.4, 0.4, 0.4]))?),
    ])?;
    assert_eq!(on_triangle(&dumbbell, 0.1, 0.0).len(), 2);
    Ok(())
}

#[test]
fn flats_and_ridges_touch_once() -> Result<(), ShapeError> {
    let plate = Shape::from_kernel(Cuboid::new(Vector([4.0, 0.6, 2.0]))?);
    for height in [0.3, 0.29, 0.25] {
        assert_eq!(on_triangle(&plate, height, 0.0).len(), 1);
    }
    // An edge along x, upwards.
    let turn = palpate_field::Rotation::from_axis_angle(Vector([1.0, 0.0, 0.0]), 0.785)?;
    let ridge = plate.rotated(turn)?;
    for height in [0.5, 0.8, 0.9] {
        assert_eq!(on_triangle(&ridge, height, 0.0).len(), 1);
    }
    Ok(())
}

#[test]
fn contacts_come_in_the_same_order_each_time() -> Result<(), Box<dyn std::error::Error>> {
    let grid = |x: i32, z: i32| bump(1.2 * f64::from(x), 1.2 * f64::from(z), 0.5);
    let bumps = (-1..=1).flat_map(|x| (-1..=1).map(move |z| grid(x, z)));
    let bumps = Shape::union(bumps.collect::<Result<Vec<_>, _>>()?)?;
    let corners = [[-2.0, 0.2, -2.0], [2.0, 0.2, -2.0], [2.0, 0.2, 2.0], [-2.0, 0.2, 2.0]];
    let floor = TriangleMesh::new(corners.map(Vector).to_vec(), vec![[0, 2, 1], [0, 3, 2]])?;
    let limits = Limits::new(1e-4);
    let mut workspace = MeshWorkspace::new();
    let first = mesh_contacts(&bumps, &floor, 0.0, &limits, &mut workspace)?.contacts.to_vec();
    // Those on the diagonal touch both triangles.
    assert_eq!(first.len(), 9 + 3);
    let again = mesh_contacts(&bumps, &floor, 0.0, &limits, &mut workspace)?;
    assert_eq!(again.contacts, first);
    let fresh = &mut MeshWorkspace::new();
    assert_eq!(mesh_contacts(&bumps, &floor, 0.0, &limits, fresh)?.contacts, first);
    Ok(())
}

#[test]
fn the_field_and_the_mesh_may_both_be_moved() -> Result<(), Box<dyn std::error::Error>> {
    let square = Shape::from_kernel(Cuboid::new(Vector([2.0, 1.0]))?);
    let line = Outline::new(vec![Vector([-3.0, 0.0]), Vector([3.0, 0.0])], vec![[0, 1]])?;
    let quarter = palpate_field::Rotation::from_angle(std::f64::consts::FRAC_PI_2)?;
    let field = Placed::new(&square, Pose::new(quarter, Vector([10.0, 2.0])));
    let mesh = PlacedMesh::new(&line, Pose::translation(Vector([10.0, 3.1])));
    let mut workspace = MeshWorkspace::new();
    let limits = Limits::new(1e-9);
    let MeshContacts { contacts: none, .. } =
        mesh_contacts(field, mesh, 0.0999, &limits, &mut workspace)?;
    assert!(none.is_empty());
    let near = mesh_contacts(field, mesh, 0.1001, &limits, &mut workspace)?;
    let [MeshContact { contact, .. }] = near.contacts.as_slice() else { panic!("{near:?}") };
    assert!((contact.gap - 0.1).abs() < 1e-8);
    assert!((contact.normal - Vector([0.0, 1.0])).norm() < 1e-6);
    assert!((contact.point_a[1] - 3.0).abs() < 1e-8 && contact.point_a[0] > 9.0);
    Ok(())
}

#[test]
fn elements_without_an_extent_are_points() -> Result<(), Box<dyn std::error::Error>> {
    let ball = Shape::from_kernel(Ball::new(1.0)?);
    let points = [[0.9, 0.0, 0.0], [1.1, 0.0, 0.0], [0.0, 0.0, 0.0]].map(Vector).to_vec();
    let mesh = TriangleMesh::new(points, vec![[0, 0, 0], [1, 1, 1], [1, 0, 1], [2, 2, 2]])?;
    let mut workspace = MeshWorkspace::new();
    let all = mesh_contacts(&ball, &mesh, 0.0, &Limits::new(1e-4), &mut workspace)?;
    assert_eq!(all.hits, [0, 2, 3]);
    let gaps: Vec<f64> = all.contacts.iter().map(|touch| touch.contact.gap).collect();
    assert!((gaps[0] + 0.1).abs() < 1e-9 && (gaps[1] + 0.1).abs() < 1e-4 && gaps[2] == -1.0);
    Ok(())
}

#[test]
fn what_is_no_question_is_an_error() -> Result<(), Box<dyn std::error::Error>> {
    assert!(matches!(TriangleMesh::new(vec![], vec![]), Err(MeshError::Empty { .. })));
    let ball = Shape::from_kernel(Ball::new(1.0)?);
    let point = TriangleMesh::new(vec![Vector([0.0; 3])], vec![[0, 0, 0]])?;
    let mut workspace = MeshWorkspace::new();
    let limits = Limits::new(1e-4);
    for gap in [f64::NAN, -1.0, f64::INFINITY] {
        let wrong = mesh_hits(&ball, &point, gap, &limits, &mut workspace);
        assert!(matches!(wrong, Err(QueryError::Length { .. })), "{wrong:?}");
    }
    let nowhere = Pose::translation(Vector([f64::NAN, 0.0, 0.0]));
    let placed = PlacedMesh::new(&point, nowhere);
    let wrong = mesh_hits(&ball, placed, 0.0, &limits, &mut workspace);
    assert_eq!(wrong, Err(QueryError::Pose { index: 1 }));
    let far = PlacedMesh::new(&point, Pose::translation(Vector([1e200, 0.0, 0.0])));
    let wrong = mesh_contacts(&ball, far, 0.0, &limits, &mut workspace);
    assert!(matches!(wrong, Err(QueryError::Coordinate { .. })));
    Ok(())
}

#[test]
fn of_a_field_that_is_no_number_nothing_is_known() -> Result<(), Box<dyn std::error::Error>> {
    let promise = Promise::lipschitz(None, 1.0);
    let nothing = Shape::from_fn(promise, |Vector([x, _, _])| x.scale(f64::NAN));
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Vector).to_vec();
    let triangle = TriangleMesh::new(corners, vec![[0, 1, 2]])?;
    let mut workspace = MeshWorkspace::new();
    let answer = mesh_contacts(&nothing, &triangle, 0.0, &Limits::new(1e-4), &mut workspace)?;
    assert!(answer.hits.is_empty() && answer.contacts.is_empty());
    assert_eq!(answer.undecided.len(), 1);
    assert_eq!(answer.undecided[0].lower, f64::NEG_INFINITY);
    Ok(())
}

#[test]
fn a_mesh_touches_where_its_elements_do_by_themselves() -> Result<(), Box<dyn std::error::Error>>
{
    // A wavy strip of 2000 triangles over a plate, a thin rod and a ball.
    let height = |x: f64, z: f64| 0.5 + 0.2 * (5.0 * x).sin() * (3.0 * z).cos();
    let mut vertices = Vec::new();
    for i in 0..=100 {
        for k in 0..=10 {
            let (x, z) = (-2.0 + 0.04 * f64::from(i), -0.2 + 0.04 * f64::from(k));
            vertices.push(Vector([x, height(x, z), z]));
        }
    }
    let quads = (0..100_u32).flat_map(|i| (0..10_u32).map(move |k| 11 * i + k));
    let triangles = quads.flat_map(|a| [[a, a + 1, a + 12], [a, a + 12, a + 11]]).collect();
    let strip = TriangleMesh::new(vertices, triangles)?;
    let shape = Shape::union([
        Shape::from_kernel(Cuboid::new(Vector([0.5, 0.45, 2.0]))?),
        Shape::from_kernel(Cuboid::new(Vector([2.0, 0.005, 0.005]))?)
            .translated(Vector([0.0, 0.61, 0.1]))?,
        Shape::from_kernel(Ball::new(0.3)?).translated(Vector([-1.2, 0.6, 0.0]))?,
    ])?;
    let limits = Limits::new(1e-9);
    let mut workspace = MeshWorkspace::new();
    let answer = mesh_hits(&shape, &strip, 0.0, &limits, &mut workspace)?;
    assert!(answer.undecided.is_empty() && answer.hits.len() > 100);
    let mut alone = ElementWorkspace::new();
    let one_by_one: Vec<u32> = (0..strip.elements().len())
        .filter(|&name| {
            let element = Element::new(strip.corners(name)).unwrap();
            touches(&shape, &element, &limits, &mut alone).unwrap().is_hit().unwrap()
        })
        .map(|name| name as u32)
        .collect();
    assert_eq!(answer.hits, one_by_one);
    Ok(())
}
