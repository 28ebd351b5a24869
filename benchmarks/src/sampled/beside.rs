// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The same mesh by libigl, MeshLib and Open3D, which `beside.py` asks in an environment of Python under `target/`.
//!
//! Each side answers all points of one list, on one thread. libigl builds its tree for each list, which is a twentieth
//! of its time.

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::hint::black_box;
use std::process::Command;
use std::time::Instant;

use palpate::field::{CustomField as _, Point, Shape};
use palpate::grid::{Grid, GridOptions, Lattice};
use palpate::mesh::{Solid, TriangleMesh};
use serde::{Deserialize, Serialize};

use super::bumpy;
use super::grids::CELLS;
use super::places::near;
use super::{compare, longest};
use crate::fields::Rows;
use crate::python::Peers;

const PEERS: Peers = Peers {
    name: "libigl, MeshLib and Open3D",
    packages: &[
        ("libigl", "2.6.3"),
        ("meshlib", "3.1.4.297"),
        ("open3d", "0.20.0"),
        ("numpy", "2.4.6"),
    ],
};

/// Points of the list.
const POINTS: usize = 20_000;

/// Rounds of ours; the fastest counts.
const ROUNDS: usize = 3;

/// How far values may differ [m]: theirs in single precision.
const SAME: f64 = 1e-5;

/// The peer whose signs alone are compared: libigl multiplies distances by 1 − 2w with the winding number w, which is not
/// exact, and two where a mesh overlaps itself.
const SCALED: &str = "libigl_winding";

#[derive(Serialize)]
struct Question {
    vertices: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    points: Vec<[f64; 3]>,
    /// The vertices and faces of the mesh with a piece that crosses it.
    crossing: (Vec<[f64; 3]>, Vec<[u32; 3]>),
    origin: [f64; 3],
    cell: f64,
    counts: [usize; 3],
}

#[derive(Deserialize)]
struct Answer {
    /// By each peer that was there, at each point [m].
    distances: BTreeMap<String, Vec<f64>>,
    /// A point [ns].
    times: BTreeMap<String, f64>,
    /// libigl at all nodes of the lattice, and MeshLib's narrow band [ns].
    all_nodes: f64,
    band: f64,
}

/// Adds the rows beside peers; none, and a sentence that says why, without them.
pub(super) fn measure(mesh: &TriangleMesh, rows: &mut Rows) -> Result<(), Box<dyn Error>> {
    let Some((folder, python)) = PEERS.prepared("sampled")? else { return Ok(()) };
    let crossing = bumpy::with_a_crossing_piece(mesh)?;
    let cell = longest(mesh) / CELLS;
    let lattice = Lattice::over(&mesh.bounds().grown(cell), cell);
    let points = near(mesh, POINTS);
    let parts = |mesh: &TriangleMesh| {
        (mesh.vertices().iter().map(|p| p.0).collect(), mesh.elements().to_vec())
    };
    let (vertices, faces) = parts(mesh);
    let question = Question {
        vertices,
        faces,
        points: points.iter().map(|p| p.0).collect(),
        crossing: parts(&crossing),
        origin: lattice.origin.0,
        cell,
        counts: lattice.counts,
    };
    let [script, asked, answered] =
        ["beside.py", "question.json", "answer.json"].map(|name| folder.join(name));
    fs::write(&script, include_str!("beside.py"))?;
    fs::write(&asked, serde_json::to_string(&question)?)?;
    eprintln!("asking {} …", PEERS.name);
    let status =
        Command::new(python).arg("-I").arg(&script).arg(&asked).arg(&answered).status()?;
    if !status.success() {
        return Err(format!("{} failed: {status}", script.display()).into());
    }
    let answer: Answer = serde_json::from_str(&fs::read_to_string(&answered)?)?;
    let threads = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let beside = Beside { mesh, crossing, lattice, points, answer };
    Ok(threads.install(|| beside.rows(rows).map_err(|error| error.to_string()))?)
}

/// The nodes of a lattice, the first axis first.
fn nodes(lattice: &Lattice<3>) -> impl Iterator<Item = Point<3>> {
    let [nx, ny, nz] = lattice.counts;
    (0..nx * ny * nz).map(move |i| lattice.node([i % nx, i / nx % ny, i / (nx * ny)]))
}

struct Beside<'a> {
    mesh: &'a TriangleMesh,
    crossing: TriangleMesh,
    lattice: Lattice<3>,
    points: Vec<Point<3>>,
    answer: Answer,
}

impl Beside<'_> {
    fn rows(&self, rows: &mut Rows) -> Result<(), Box<dyn Error>> {
        let Self { mesh, crossing, lattice, points, answer } = self;
        let shape = |mesh: &TriangleMesh| -> Result<Shape<3>, Box<dyn Error>> {
            Ok(Solid::from_mesh(mesh)?.0.into())
        };
        let (ours, winding) = (shape(mesh)?, shape(crossing)?);
        for (name, shape) in
            [("open3d", &ours), ("libigl", &ours), ("libigl_winding", &winding)]
        {
            if let Some(theirs) = answer.distances.get(name) {
                agree(name, shape, points, theirs)?;
            }
        }
        let count = points.len() as f64;
        let asked = |shape: &Shape<3>| {
            fastest(|| black_box(points.iter().map(|p| shape.distance(*p)).sum::<f64>()))
        };
        let (solid, _) = Solid::from_mesh(mesh)?;
        let places: Vec<_> = nodes(lattice).collect();
        let mut values = vec![0.0; places.len()];
        let mut all_nodes = || {
            solid.distances(&places, &mut values);
            values[0]
        };
        let options = GridOptions {
            band: Some(GridOptions::SMALLEST_BAND),
            ..GridOptions::with_cell(lattice.cell)
        };
        let bake = || Grid::bake(&ours, &options).map_or(0.0, |grid| grid.deviation());
        for (key, time) in [
            ("near.all", asked(&ours) / count),
            ("near.winding", asked(&winding) / count),
            ("all_nodes", fastest(|| black_box(all_nodes()))),
            ("band", fastest(|| black_box(bake()))),
        ] {
            rows.insert(format!("mesh.{key}.ours.ns"), time);
        }
        for (key, name) in
            [("near.all", "open3d"), ("near.all", "libigl"), ("near.winding", "libigl_winding")]
        {
            if let Some(time) = answer.times.get(name) {
                rows.insert(format!("mesh.{key}.{name}.ns"), *time);
            }
        }
        rows.insert("mesh.all_nodes.libigl.ns".to_owned(), answer.all_nodes);
        rows.insert("mesh.band.meshlib.ns".to_owned(), answer.band);
        for (key, name) in [
            ("near.all", "open3d"),
            ("near.all", "libigl"),
            ("near.winding", "libigl_winding"),
            ("all_nodes", "libigl"),
            ("band", "meshlib"),
        ] {
            let [ours, theirs] = ["ours", name].map(|whose| format!("mesh.{key}.{whose}.ns"));
            compare(rows, [&ours, &theirs], &format!("mesh.{key}.ours_over_{name}"));
        }
        Ok(())
    }
}

/// The least time of some rounds [ns].
fn fastest(mut ask: impl FnMut() -> f64) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..ROUNDS {
        let start = Instant::now();
        black_box(ask());
        least = least.min(start.elapsed().as_nanos() as f64);
    }
    least
}

/// Refuses to time what does not answer the same. Signs may differ where the surface is nearer than the rounding.
fn agree(
    name: &str,
    shape: &Shape<3>,
    points: &[Point<3>],
    theirs: &[f64],
) -> Result<(), Box<dyn Error>> {
    let mut wrong = 0;
    for (p, their) in points.iter().zip(theirs) {
        let our = shape.distance(*p);
        if name != SCALED && (our.abs() - their.abs()).abs() > SAME {
            return Err(
                format!("{name}'s distance is {their} m, ours {our} m, at {p:?}").into()
            );
        }
        wrong += usize::from((our < 0.0) != (*their < 0.0) && our.abs() > SAME);
    }
    if wrong > 0 {
        eprintln!("{name} has another sign at {wrong} of {} points", points.len());
    }
    Ok(())
}
