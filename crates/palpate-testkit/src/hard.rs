// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Meshes that are hard to make solids of, each with the solid that is meant.

use palpate_field::{Rotation, Vector};

use crate::soup::Soup;

/// A mesh, and what it is meant to bound.
#[derive(Clone, Debug)]
pub struct Hard {
    /// What is wrong with it.
    pub name: &'static str,
    /// As it comes.
    pub mesh: Soup,
    /// A sound mesh of the solid that is meant, whose faces are surface alone. `None` if no such mesh is known: where
    /// parts cross, or what is gone is anyone's guess.
    pub meant: Option<Soup>,
}

/// The same meshes at each call, of tens to thousands of triangles.
#[must_use]
pub fn solids() -> Vec<Hard> {
    let mut all = sound();
    all.extend(of_parts());
    all.extend(damaged());
    all.extend(thin());
    all.extend(scales());
    all
}

/// Meshes that bound no solid.
#[must_use]
pub fn refused() -> Vec<(&'static str, Soup)> {
    let triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.5]].map(Vector).to_vec();
    vec![
        ("Klein bottle", Soup::klein(24, 17)),
        ("open sheet", sheet(5, 1.0)),
        ("cracks all over", body().unwelded().jittered(1e-4)),
        ("one triangle", Soup { vertices: triangle, faces: vec![[0, 1, 2]] }),
    ]
}

/// A ball of 1 m, in this list the body that is damaged.
fn body() -> Soup {
    Soup::ball([0.1, -0.2, 0.3], 1.0, 16)
}

/// A square sheet in the plane y = 0.1, of `count` by `count` squares.
#[must_use]
pub fn sheet(count: u32, size: f64) -> Soup {
    let mut soup = Soup::default();
    let along = |i: u32| size * (f64::from(i) / f64::from(count) - 0.5);
    for x in 0..=count {
        soup.vertices.extend((0..=count).map(|z| Vector([along(x), 0.1, along(z)])));
    }
    for x in 0..count {
        for z in 0..count {
            let a = x * (count + 1) + z;
            let [b, c, d] = [a + 1, a + count + 1, a + count + 2];
            soup.faces.extend([[a, b, c], [b, d, c]]);
        }
    }
    soup
}

/// A rotation that leaves no face along an axis.
fn askew() -> Rotation<3> {
    Rotation::from_axis_angle([0.3, 0.9, 0.2], 0.7).unwrap_or_else(|_| Rotation::identity())
}

fn hard(name: &'static str, mesh: Soup, meant: impl Into<Option<Soup>>) -> Hard {
    Hard { name, mesh, meant: meant.into() }
}

/// Closed meshes, and a fan that is open below.
fn sound() -> Vec<Hard> {
    let hollow = body().and(Soup::ball([0.2, -0.2, 0.3], 0.5, 9).inside_out());
    let plate = Soup::cuboid([0.0; 3], [1.0, 0.001, 0.8]).turned(&askew());
    let needle = needle();
    vec![
        hard("ball", body(), body()),
        hard("cavity", hollow.clone(), hollow),
        hard("plate of 1 mm", plate.clone(), plate),
        hard("needle of 3 degrees", needle.clone(), needle),
        hard("fan of 10000 faces at one vertex", Soup::fan(10_000), closed_fan(10_000)),
    ]
}

/// A pyramid whose sides meet at 3 degrees.
fn needle() -> Soup {
    let r = (1.5_f64).to_radians().tan();
    let tip = Vector([0.0, 1.0, 0.0]);
    let base = [[r, 0.0, 0.0], [0.0, 0.0, r], [-r, 0.0, 0.0], [0.0, 0.0, -r]].map(Vector);
    let mut vertices = vec![tip];
    vertices.extend(base);
    let mut faces: Vec<[u32; 3]> = (0..4).map(|i| [0, 1 + (i + 1) % 4, 1 + i]).collect();
    faces.extend([[1, 2, 3], [1, 3, 4]]);
    Soup { vertices, faces }
}

/// A cone of which `sectors` faces meet at its tip, and as many at the middle of its base.
fn closed_fan(sectors: u32) -> Soup {
    let mut fan = Soup::fan(sectors);
    let middle = fan.vertices.len() as u32;
    fan.vertices.push(Vector([0.0, 0.0, 0.0]));
    fan.faces.extend((0..sectors).map(|i| [middle, 1 + i, 1 + (i + 1) % sectors]));
    fan
}

/// Solids of several parts.
fn of_parts() -> Vec<Hard> {
    let cube = Soup::cuboid([0.0; 3], [1.0; 3]);
    let left = Soup::cuboid([-0.5, 0.0, 0.0], [1.0; 3]);
    let other = Soup::cuboid([0.4, 0.3, 0.2], [1.0, 0.8, 0.9]).turned(&askew());
    let inner = Soup::ball([0.2, -0.2, 0.3], 0.5, 9);
    let at_edge = left.clone().and(Soup::cuboid([0.5, 1.0, 0.0], [1.0; 3]));
    let beside = left.clone().and(Soup::cuboid([0.5, 0.0, 0.0], [1.0; 3]));
    let whole = Soup::cuboid([0.0; 3], [2.0, 1.0, 1.0]);
    // A wall of its own between two halves that share its corners.
    let mut shared = beside.clone();
    shared.faces.retain(|face| face.iter().any(|i| shared.vertices[*i as usize][0] != 0.0));
    let wall: Vec<u32> = [1, 3, 7, 5].to_vec();
    shared.faces.extend([[wall[0], wall[1], wall[2]], [wall[0], wall[2], wall[3]]]);
    let smaller = left.and(Soup::cuboid([0.25, 0.1, 0.05], [0.5, 0.4, 0.3]));
    vec![
        hard("boxes that overlap", cube.clone().and(other), None),
        hard("ball in a ball, both outward", body().and(inner), body()),
        hard("membrane inside a cube", cube.clone().and(sheet(4, 0.6)), cube),
        hard("cubes that share an edge", at_edge.clone(), at_edge),
        hard("cubes that share a face", beside, whole.clone()),
        hard("halves with one wall between them", shared, whole),
        hard("boxes whose faces lie on each other", smaller, None),
    ]
}

/// The body with what befalls meshes.
fn damaged() -> Vec<Hard> {
    let every = |n: usize, shift: usize| move |i: usize| (i + shift).is_multiple_of(n);
    let faces = body().faces.len();
    let top = body();
    let cut_off =
        body().without(|i| top.faces[i].iter().all(|v| top.vertices[*v as usize][1] > 0.6));
    let mut copies = body();
    let some: Vec<_> = copies.faces.iter().step_by(7).copied().collect();
    copies.faces.extend(some);
    vec![
        hard("not welded", body().unwelded(), body()),
        hard("cut off", cut_off, None),
        hard("10 % of the faces gone", body().without(every(10, 3)), None),
        hard("cracks", cracks(), None),
        hard("copies", copies, body()),
        hard("10 % flipped", body().flipped(every(10, 1)), body()),
        hard("half flipped", body().flipped(move |i| i < faces / 2 - 5), body()),
        hard("inverted", body().inside_out(), body()),
        hard("20 % doubled, opposite", body().doubled_opposite(every(5, 2)), body()),
    ]
}

/// The body, of which each fortieth face has corners of its own, a little off those of its neighbours.
fn cracks() -> Soup {
    let (mut cracked, loose) = (body(), body().unwelded().jittered(1e-4));
    for i in (0..cracked.faces.len()).step_by(40) {
        let first = cracked.vertices.len() as u32;
        cracked.vertices.extend(loose.faces[i].map(|index| loose.vertices[index as usize]));
        // Two corners: a slit on either side.
        let [a, ..] = cracked.faces[i];
        cracked.faces[i] = [a, first + 1, first + 2];
    }
    cracked
}

/// Triangles of hardly any height, on edges of others and on each other.
fn thin() -> Vec<Hard> {
    let cube = Soup::cuboid([0.0; 3], [1.0; 3]);
    vec![
        hard("T-junctions", t_junctions(0.0), cube.clone()),
        hard("slivers of 1e-12", t_junctions(1e-12), cube.clone()),
        hard("sheets that coincide", cube.clone().and(sheet(4, 0.6)).and(sheet(3, 0.6)), cube),
    ]
}

/// A cube with an edge that has a corner more on one of its sides, off the edge by `height`; where it is not on it,
/// slivers fill the gap.
fn t_junctions(height: f64) -> Soup {
    let mut cube = Soup::cuboid([0.0; 3], [1.0; 3]);
    // The edge from corner 4 to corner 5 is of two faces; one of them is parted.
    let has = |face: &[u32; 3]| [4, 5].iter().all(|i| face.contains(i));
    let Some(parted) = cube.faces.iter().position(has) else { return cube };
    let face = cube.faces.remove(parted);
    let middle = cube.vertices.len() as u32;
    cube.vertices.push(Vector([0.125, -0.5, 0.5 - height]));
    let with = |old: u32| face.map(|index| if index == old { middle } else { index });
    cube.faces.extend([with(4), with(5)]);
    if height > 0.0 {
        let [a, b] = [4, 5];
        let third = |face: &[u32; 3]| face.iter().position(|i| *i != a && *i != b).unwrap_or(0);
        // As the face passed its edge, so does the sliver.
        let at = third(&face);
        cube.faces.push([middle, face[(at + 1) % 3], face[(at + 2) % 3]]);
    }
    cube
}

/// The body as large and as small as bodies may be.
fn scales() -> Vec<Hard> {
    let ball = Soup::ball([0.0; 3], 0.5, 9);
    let [huge, tiny] = [1e15, 1e-9].map(|size| ball.clone().scaled(size));
    vec![hard("1e15 m", huge.clone(), huge), hard("1e-9 m", tiny.clone().inside_out(), tiny)]
}

/// A gear of 24 teeth with an outline of `count` corners, 2 cm thick: two long triangles on the side of each edge, and
/// one on each cap, from the middle.
#[must_use]
pub fn gear(count: u32) -> Soup {
    let corner = |i: u32| {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(count);
        let radius = 0.04 + 0.004 * (4.0 * (24.0 * angle).sin()).tanh();
        [radius * angle.cos(), radius * angle.sin()]
    };
    let mut vertices = Vec::new();
    for z in [-0.01, 0.01] {
        vertices.push(Vector([0.0, 0.0, z]));
        vertices.extend((0..count).map(corner).map(|[x, y]| Vector([x, y, z])));
    }
    let top = count + 1;
    let faces = (0..count).flat_map(|i| {
        let [a, b] = [i, (i + 1) % count].map(|i| i + 1);
        let [c, d] = [a + top, b + top];
        [[a, b, d], [a, d, c], [0, b, a], [top, c, d]]
    });
    Soup { vertices, faces: faces.collect() }
}
