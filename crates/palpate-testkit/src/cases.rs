// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Listed cases, and hard ones.

use std::str::FromStr;

use arbitrary::Unstructured;
use palpate_field::{Rotation, Shape, Vector};

use crate::arbitrary::{self as draw, Turn};
use crate::kernels::Space;
use crate::soup::Soup;
use crate::tree::{Solid, Tree};

/// Bytes of entropy a case may draw.
const ENTROPY: usize = 1 << 16;

/// The share of the seeds that run unless `PALPATE_SEEDS` says otherwise; `cargo xtask test --thorough`
/// runs all.
pub const USUAL: f64 = 0.1;

/// The most complaints shown; complaints that differ only in numbers count as one.
const SHOWN: usize = 12;

/// Checks `property` for `count` seeds. Two environment variables change this. `PALPATE_FIRST_SEED`
/// is the first seed; the default is 0. `PALPATE_SEEDS` multiplies the count; the default is
/// [`USUAL`]. At least one seed runs.
///
/// A property draws its input from [`Unstructured`] and returns what is wrong
/// with it. The same seed draws the same input on every machine.
///
/// # Panics
///
/// If the property fails; the message has the simplest complaints and their seeds.
pub fn check(
    count: u64,
    mut property: impl FnMut(&mut Unstructured<'_>) -> arbitrary::Result<Result<(), String>>,
) {
    numbered(count, |_, u| property(u));
}

/// As [`check`], for a property that takes things in turn: by its seed, so that a seed alone
/// repeats its case.
///
/// # Panics
///
/// As [`check`].
pub fn numbered(
    count: u64,
    property: impl FnMut(usize, &mut Unstructured<'_>) -> arbitrary::Result<Result<(), String>>,
) {
    run(self::count(count), property);
}

/// As [`check`], with no fewer seeds than `count`: for a test of how often something happens.
///
/// # Panics
///
/// As [`check`].
pub fn in_full(
    count: u64,
    mut property: impl FnMut(&mut Unstructured<'_>) -> arbitrary::Result<Result<(), String>>,
) {
    run(self::count(count).max(count), |_, u| property(u));
}

fn run(
    count: u64,
    mut property: impl FnMut(usize, &mut Unstructured<'_>) -> arbitrary::Result<Result<(), String>>,
) {
    let mut failures = Vec::new();
    let first = number_in("PALPATE_FIRST_SEED").unwrap_or(0);
    for seed in first..first + count {
        let bytes = entropy(seed);
        let guard = Seed(seed);
        let mut input = Unstructured::new(&bytes);
        let outcome = property(seed as usize, &mut input);
        // Past its end an input draws zeros: the same case again and again.
        assert!(!input.is_empty(), "{ENTROPY} bytes are too few");
        std::mem::forget(guard);
        if let Ok(Err(complaint)) = outcome {
            failures.push((seed, complaint));
        }
    }
    if failures.is_empty() {
        return;
    }
    // The shortest complaints come from the simplest cases.
    failures.sort_by_key(|(_, complaint)| complaint.len());
    let mut kinds = Vec::new();
    let mut shown = Vec::new();
    for (seed, complaint) in &failures {
        let kind: String = complaint.chars().filter(|c| c.is_alphabetic()).collect();
        if !kinds.contains(&kind) && shown.len() < SHOWN {
            shown.push(format!("seed {seed}: {complaint}"));
            kinds.push(kind);
        }
    }
    panic!("{} of {count} cases fail\n{}", failures.len(), shown.join("\n"));
}

/// Checks `property` on `count` random trees and their shapes; their depths go from 1 to `deepest`
/// in turn. Complaints name their tree.
///
/// # Panics
///
/// As [`check`]; also if a tree makes no shape.
pub fn on_trees<const D: usize>(
    count: u64,
    deepest: usize,
    mut property: impl FnMut(
        &mut Unstructured<'_>,
        &Tree<D>,
        &Shape<D>,
    ) -> arbitrary::Result<Result<(), String>>,
) where
    Space: Solid<D> + Turn<D>,
{
    numbered(count, |seed, u| {
        let tree = draw::tree(u, 1 + seed % deepest)?;
        let outcome = match tree.shape() {
            Ok(shape) => property(u, &tree, &shape)?,
            Err(error) => Err(error.to_string()),
        };
        Ok(outcome.map_err(|complaint| format!("{complaint}\n  {tree:?}")))
    });
}

/// Makes two tests of each law, in the plane and in space, by the `on_trees` of the module.
#[macro_export]
macro_rules! in_both_dimensions {
    ($($name:ident: $law:ident, $count:literal, $points:literal;)*) => {
        $(mod $name {
            #[test]
            fn in_the_plane() {
                super::on_trees::<2>($count, $points, super::$law);
            }

            #[test]
            fn in_space() {
                super::on_trees::<3>($count, $points, super::$law);
            }
        })*
    };
}

/// Checks a `property` that panics if it fails, for the seeds of [`check`]. Cases that cannot be
/// drawn are skipped.
///
/// # Panics
///
/// If the property panics, or at least half of the cases cannot be drawn.
pub fn each(
    count: u64,
    mut property: impl FnMut(&mut Unstructured<'_>) -> arbitrary::Result<()>,
) {
    let (mut drawn, mut tried) = (0, 0);
    check(count, |u| {
        tried += 1;
        property(u)?;
        drawn += 1;
        Ok(Ok(()))
    });
    assert!(2 * drawn > tried, "only {drawn} of {tried} cases could be drawn");
}

/// The number of seeds that [`check`] runs for a count of `usual`. A test that counts cases
/// compares its count with this number.
///
/// # Panics
///
/// If `PALPATE_SEEDS` holds no positive number.
#[must_use]
pub fn count(usual: u64) -> u64 {
    multiplied(usual, number_in("PALPATE_SEEDS").unwrap_or(USUAL))
}

fn multiplied(count: u64, factor: f64) -> u64 {
    assert!(factor > 0.0 && factor.is_finite(), "PALPATE_SEEDS must be positive, got {factor}");
    ((count as f64 * factor).round() as u64).max(1)
}

/// The number in a variable of the environment; `None` if it is not set.
///
/// # Panics
///
/// If the variable holds anything else.
fn number_in<T: FromStr>(variable: &str) -> Option<T> {
    let text = std::env::var(variable).ok()?;
    Some(text.parse().unwrap_or_else(|_| panic!("{variable} must be a number, got {text}")))
}

/// The bytes of a seed, by SplitMix64 (Steele, Lea and Flood 2014).
#[must_use]
pub fn entropy(seed: u64) -> Vec<u8> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut next = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    (0..ENTROPY / 8).flat_map(|_| next().to_le_bytes()).collect()
}

/// Names the seed when a property panics.
struct Seed(u64);

impl Drop for Seed {
    fn drop(&mut self) {
        eprintln!("seed {} panicked", self.0);
    }
}

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
