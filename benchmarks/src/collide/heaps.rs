// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Heaps of bodies that tremble, as parry asks them of boxes and meshes and we of fields.

use std::error::Error;
use std::time::Instant;

use palpate::field::{Pose, Rotation, Shape, ShapeError, Vector};
use palpate::query::{
    BodyId, Limits, ManifoldSettings, PairWorkspace, Track, World, WorldSettings,
};
use parry3d_f64::math::Pose as ParryPose;
use parry3d_f64::query::{
    ContactManifold, ContactManifoldsWorkspace, DefaultQueryDispatcher,
    PersistentQueryDispatcher,
};
use parry3d_f64::shape::{Cuboid, SharedShape, TriMesh};

use super::{Space, TimedRows, Turn};
use crate::fields::Rows;
use crate::random::Random;

/// Bodies along each side of the heap, and how large they are [m].
const SIDES: [usize; 3] = [5, 4, 5];
const SIZE: f64 = 0.02;

/// How far they move from their places in each step [m], and turn [rad].
const WAY: f64 = 1e-5;
const ANGLE: f64 = 5e-4;

/// Steps, of which the first are not timed.
const STEPS: usize = 30;
const WARM: usize = 5;

/// Corners around a cup: 1600 triangles.
const AROUND: u32 = 200;

/// A body, ours and parry's.
struct Twin {
    field: Shape<3>,
    shape: SharedShape,
}

/// Adds the rows of heaps, on one thread.
pub(super) fn measure(rows: &mut TimedRows) -> Result<(), Box<dyn Error>> {
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let (cube, cup) = (cube()?, cup()?);
    let heaps: [(&str, [&Twin; 2]); 3] =
        [("cubes", [&cube, &cube]), ("cups", [&cup, &cup]), ("mixed", [&cube, &cup])];
    for (name, twins) in heaps {
        let asked = one_thread.install(|| heap(name, twins, rows));
        asked.map_err(|error| -> Box<dyn Error> { error })?;
    }
    Ok(())
}

/// Adds the ratios of the medians, where they are measured.
pub(super) fn compare(rows: &mut Rows) {
    for name in ["cubes", "cups", "mixed"] {
        let median = |key: &str| rows.get(&format!("{key}.heap_of_{name}.p50_ns")).copied();
        let [tracks, world, theirs] = ["tracks", "world", "parry"].map(median);
        for (ours, key) in [(tracks, "ours_over_parry"), (world, "world_over_parry")] {
            if let Some((ours, theirs)) = ours.zip(theirs) {
                rows.insert(format!("parry.heap_of_{name}.{key}"), ours / theirs);
            }
        }
    }
}

/// A pair of bodies near each other, and what parry keeps of it.
#[derive(Default)]
struct Kept {
    manifolds: Vec<ContactManifold<(), ()>>,
    memory: Option<ContactManifoldsWorkspace>,
}

/// A heap of both twins in turns, each of which touches its neighbours at first.
fn heap(
    name: &str,
    twins: [&Twin; 2],
    rows: &mut TimedRows,
) -> Result<(), Box<dyn Error + Send + Sync>> {
    let mut random = Random::new(23);
    let settings = ManifoldSettings::for_solver(SIZE);
    let limits = Limits::new(settings.usual_tolerance());
    let mut world = World::new(WorldSettings::new(settings, limits))?;
    let margin = settings.margin;
    let mut bodies: Vec<(BodyId, &Twin, Vector<f64, 3>)> = Vec::new();
    for i in 0..SIDES.iter().product() {
        let [x, y, z] = [i % SIDES[0], i / SIDES[0] % SIDES[1], i / (SIDES[0] * SIDES[1])];
        let place = Vector([x, y, z].map(|k| k as f64 * SIZE));
        let twin = twins[(x + y + z) % 2];
        bodies.push((world.add(twin.field.clone(), Pose::translation(place))?, twin, place));
    }
    let far = SIZE + 4.0 * margin;
    let is_near = |one: usize, other: usize| {
        let apart = bodies[one].2 - bodies[other].2;
        apart.0.iter().all(|x| x.abs() < far)
    };
    let pairs =
        (0..bodies.len()).flat_map(|one| (one + 1..bodies.len()).map(move |b| (one, b)));
    let pairs: Vec<_> = pairs.filter(|(one, other)| is_near(*one, *other)).collect();
    let mut kept: Vec<Kept> = pairs.iter().map(|_| Kept::default()).collect();
    let new = |one: usize, other: usize| {
        Track::new(bodies[one].1.field.clone(), bodies[other].1.field.clone())
    };
    let mut tracks: Vec<_> = pairs.iter().map(|(one, other)| new(*one, *other)).collect();
    let mut workspace = PairWorkspace::new();
    let (mut ours, mut tracked, mut theirs) = (Vec::new(), Vec::new(), Vec::new());
    let (mut touching, mut touching_there) = (0, 0);
    let mut searches = Vec::new();
    for step in 0..STEPS {
        let mut poses = Vec::new();
        for (body, _, place) in &bodies {
            let way: Vector<f64, 3> = Vector(random.point([0.0; 3], WAY));
            let turn = <Space as Turn<3>>::by(&mut random, ANGLE)?;
            poses.push((*body, Pose::new(turn, *place + way)));
        }
        world.set_poses(&poses)?;
        let start = Instant::now();
        touching = world.step().len();
        let of_ours = start.elapsed().as_nanos() as f64;
        let start = Instant::now();
        let mut searched = 0;
        for ((one, other), track) in pairs.iter().zip(&mut tracks) {
            let poses = [poses[*one].1, poses[*other].1];
            let found = track.contacts(poses, &settings, &limits, &mut workspace)?;
            searched += u32::from(found.is_searched);
        }
        let of_tracks = start.elapsed().as_nanos() as f64;
        let there: Vec<ParryPose> = poses.iter().map(|(_, pose)| placed(pose)).collect();
        let start = Instant::now();
        for ((one, other), kept) in pairs.iter().zip(&mut kept) {
            DefaultQueryDispatcher.contact_manifolds(
                &there[*one].inv_mul(&there[*other]),
                &*bodies[*one].1.shape,
                &*bodies[*other].1.shape,
                margin,
                &mut kept.manifolds,
                &mut kept.memory,
            )?;
        }
        let of_theirs = start.elapsed().as_nanos() as f64;
        if step >= WARM {
            ours.push(of_ours);
            tracked.push(of_tracks);
            searches.push(f64::from(searched));
            theirs.push(of_theirs);
        }
        let has_points = |kept: &&Kept| kept.manifolds.iter().any(|it| !it.points.is_empty());
        touching_there = kept.iter().filter(has_points).count();
    }
    rows.add_times(&format!("world.heap_of_{name}"), ours);
    rows.add_times(&format!("tracks.heap_of_{name}"), tracked);
    rows.add_times(&format!("parry.heap_of_{name}"), theirs);
    let searches = searches.iter().sum::<f64>() / (STEPS - WARM) as f64;
    rows.insert(format!("tracks.heap_of_{name}.searches"), searches);
    rows.insert(format!("world.heap_of_{name}.pairs"), touching as f64);
    rows.insert(format!("parry.heap_of_{name}.pairs"), touching_there as f64);
    Ok(())
}

/// A pose as parry has it.
fn placed(pose: &Pose<3>) -> ParryPose {
    let [x, y, z] = pose.translation.0;
    let rotation: &Rotation<3> = &pose.rotation;
    let [a, b, c, w] = rotation.quaternion();
    let turn = parry3d_f64::math::Rotation::from_xyzw(a, b, c, w);
    ParryPose::from_parts(parry3d_f64::math::Vector::new(x, y, z), turn)
}

fn cube() -> Result<Twin, ShapeError> {
    let half = parry3d_f64::math::Vector::from_array([0.5 * SIZE; 3]);
    Ok(Twin {
        field: Shape::<3>::cuboid([SIZE; 3])?,
        shape: SharedShape::new(Cuboid::new(half)),
    })
}

/// A cup of a wall of 1.5 mm, as wide and as high as a cube.
fn cup() -> Result<Twin, Box<dyn Error>> {
    let (radius, height, wall) = (0.5 * SIZE, SIZE, 0.0015);
    let inner = Shape::<3>::cylinder(radius - wall, height)?.translated([0.0, wall, 0.0])?;
    let field = Shape::<3>::cylinder(radius, height)? - inner;
    let (top, bottom) = (0.5 * height, -0.5 * height);
    let profile = [
        [0.0, bottom],
        [radius, bottom],
        [radius, top],
        [radius - wall, top],
        [radius - wall, bottom + wall],
        [0.0, bottom + wall],
    ];
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..AROUND {
        let (sine, cosine) =
            (std::f64::consts::TAU * f64::from(i) / f64::from(AROUND)).sin_cos();
        points
            .extend(profile.map(|[r, y]| {
                parry3d_f64::math::Vector::from_array([r * cosine, y, r * sine])
            }));
    }
    let count = profile.len() as u32;
    for i in 0..AROUND {
        let next = (i + 1) % AROUND;
        for k in 0..count - 1 {
            let [a, b] = [i * count + k, i * count + k + 1];
            let [c, d] = [next * count + k + 1, next * count + k];
            // At the axis, sides have no length.
            if k + 1 < count - 1 {
                triangles.push([a, b, c]);
            }
            if k > 0 {
                triangles.push([a, c, d]);
            }
        }
    }
    Ok(Twin { field, shape: SharedShape::new(TriMesh::new(points, triangles)?) })
}
