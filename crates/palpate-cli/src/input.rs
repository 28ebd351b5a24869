// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Files that are read.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use palpate::field::{Aabb, LARGEST_LENGTH, Shape, Vector};
use palpate::local::GradientMethod;
use palpate::mesh::Opening;
use palpate::scene::text::rounded;
use palpate::scene::{
    AnyScene, BuiltMesh, BuiltScene, Resources, Scene, SceneError, unknown_name, utf8,
};
use palpate::sim::{HandPath, Interpolation, SimulationError};

use crate::arguments::Reading;
use crate::interrupt::Progress;
use crate::kind::Kind;
use crate::outcome::Failure;
use crate::output::{self, counted};
use crate::table::{Table, coordinates};

/// The built-in gallery, which `palpate feel` feels if no scene is named.
const GALLERY: &str = include_str!("../scenes/article_gallery.json");

/// The names of the axes.
pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];

/// A scene with its name in reports.
pub(crate) struct Named {
    pub(crate) name: String,
    pub(crate) scene: AnyScene,
}

/// Reads and builds the scene in `path`, or the built-in gallery.
pub(crate) fn scene(path: Option<&Path>, reading: Reading) -> Result<Named, Failure> {
    moving(path, None, reading)
}

/// The name and the text of the built-in gallery.
pub(crate) fn gallery() -> (String, String) {
    ("the built-in gallery".to_owned(), GALLERY.to_owned())
}

/// The name and the text of the scene in `path`, or of the built-in gallery, which is not checked
/// here.
pub(crate) fn scene_text(
    path: Option<&Path>,
    reading: Reading,
) -> Result<(String, String), Failure> {
    let Some(path) = path else { return Ok(gallery()) };
    let bytes = reading.bytes(path)?;
    let text = utf8(&bytes).map_err(|error| Failure::file(path, error))?;
    Ok((path.display().to_string(), text.to_owned()))
}

/// As [`scene`], with the motions of a file in place of its own.
pub(crate) fn moving(
    path: Option<&Path>,
    motions: Option<&Path>,
    reading: Reading,
) -> Result<Named, Failure> {
    let (name, bytes) = match path {
        None => ("the built-in gallery".to_owned(), GALLERY.as_bytes().to_owned()),
        Some(path) => (path.display().to_string(), reading.bytes(path)?),
    };
    let no_scene =
        |error| Failure::input(format!("{name}: {}", no_scene(path, &bytes, &error)));
    let bakes = Bakes::new(path.map(folder));
    let mut scene = Scene::from_bytes_in(&bytes, bakes.resources.clone()).map_err(no_scene)?;
    if let Some(path) = motions {
        let moved = scene.with_motions_of(&reading.bytes(path)?);
        scene = moved.map_err(|error| Failure::file(path, error))?;
    }
    let scene = scene.build().map_err(no_scene)?;
    match &scene {
        AnyScene::Planar(scene) => scene.meshes.iter().for_each(tell_guesses),
        AnyScene::Spatial(scene) => scene.meshes.iter().for_each(tell_guesses),
    }
    Ok(Named { name, scene })
}

/// Says where what is proven of a mesh need not hold of the thing that it was made of.
fn tell_guesses(mesh: &BuiltMesh) {
    let Some(file) = mesh.file.as_deref().map(output::shown) else { return };
    let largest = mesh.findings.openings.iter().max_by(|a, b| a.size.total_cmp(&b.size));
    if let Some(Opening { place, doubtful, .. }) = largest {
        output::remark(format_args!(
            "{file}: {} closed by caps: within {} m of the largest, at ({}) m, the sign is a guess",
            counted(mesh.findings.openings.len(), "opening", "openings"),
            rounded(*doubtful),
            place.0.map(rounded).join(", "),
        ));
    }
    if let Some(samples) = &mesh.samples {
        let step =
            samples.steps.iter().map(|step| step.norm() * mesh.scale).fold(0.0, f64::max);
        output::remark(format_args!(
            "{file}: answers hold of the surface through samples; the thing itself is known to about a sample, {} m",
            rounded(step),
        ));
    }
}

/// The folder in which grids are kept: the user's cache, or what `PALPATE_CACHE` names; `None` if that is empty.
pub(crate) fn cache() -> Option<PathBuf> {
    match std::env::var_os("PALPATE_CACHE") {
        None => Some(dirs::cache_dir()?.join("palpate").join("grids")),
        Some(folder) => {
            Some(folder.into()).filter(|folder: &PathBuf| !folder.as_os_str().is_empty())
        }
    }
}

/// What scenes use beside their text. How far a grid is made is shown.
pub(crate) struct Bakes {
    pub(crate) resources: Resources,
    shown: Arc<Mutex<Option<Progress>>>,
}

impl Bakes {
    /// For a scene whose files are in `folder`.
    pub(crate) fn new(folder: Option<&Path>) -> Self {
        let shown = Arc::new(Mutex::new(None));
        let shared = Arc::clone(&shown);
        let mut resources = Resources::default().with_progress(Arc::new(move |progress| {
            let mut shown = shared.lock().unwrap_or_else(PoisonError::into_inner);
            let shown = shown.get_or_insert_with(|| Progress::of("sampling a grid"));
            shown.show(progress.done, progress.of, "");
            ControlFlow::Continue(())
        }));
        resources.folder = folder.map(Path::to_owned);
        if let Some(cache) = cache() {
            resources = resources.with_cache(cache);
        }
        Self { resources, shown }
    }
}

impl Drop for Bakes {
    fn drop(&mut self) {
        // The scene that was built may keep its resources.
        drop(self.shown.lock().unwrap_or_else(PoisonError::into_inner).take());
    }
}

/// The folder of a file, in which the files that it names are.
pub(crate) fn folder(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// Why a file is no scene: what it is instead, or what is wrong with it.
fn no_scene(path: Option<&Path>, bytes: &[u8], error: &SceneError) -> String {
    let other = path.and_then(|path| other_than_scene(path, bytes));
    other.unwrap_or_else(|| error.to_string())
}

/// What a file holds that is no scene, and what to do with it; `None` if that is not known.
pub(crate) fn other_than_scene(path: &Path, bytes: &[u8]) -> Option<String> {
    match Kind::of(bytes)? {
        Kind::Scene => None,
        Kind::Empty => Some(format!("it is an empty file; a small scene is {SMALL}")),
        kind => Some(format!("{kind}, not a scene; {}", kind.advice(path))),
    }
}

/// A scene to begin with.
const SMALL: &str = r#"{ "palpate": 1, "dimension": 3, "bodies": [ { "name": "bead", "shape": { "ball": { "radius": 0.02 } } } ] }"#;

/// The numbers of the bodies with these names, each once.
pub(crate) fn bodies(asked: &[String], names: &[&str]) -> Result<Vec<usize>, Failure> {
    let number = |name: &String| {
        let found = names.iter().position(|known| known == name);
        found.ok_or_else(|| {
            Failure::input(format!("--body: {}", unknown_name("body", name, names)))
        })
    };
    let mut bodies = asked.iter().map(number).collect::<Result<Vec<_>, _>>()?;
    bodies.sort_unstable();
    bodies.dedup();
    Ok(bodies)
}

/// The body with this name, or all bodies as one shape.
pub(crate) fn body_or_whole<'a, const D: usize>(
    scene: &'a BuiltScene<D>,
    body: Option<&str>,
) -> Result<&'a Shape<D>, Failure> {
    let Some(name) = body else { return Ok(&scene.whole) };
    let names: Vec<_> = scene.bodies.iter().map(|body| body.name.as_str()).collect();
    let found = bodies(&[name.to_owned()], &names)?;
    Ok(&scene.bodies[found[0]].shape)
}

/// The point that `text` names: as many numbers as dimensions, joined by commas.
pub(crate) fn point<const D: usize>(text: &str) -> Result<Vector<f64, D>, Failure> {
    let axes = AXES[..D].join(",");
    let wrong = |got: String| {
        Failure::input(format!(
            "the scene is {D}D: a point is {D} numbers {axes} joined by commas, got {got}"
        ))
    };
    let parts: Vec<_> = text.split(',').collect();
    let number = |part: &str| part.trim().parse::<f64>().ok();
    let numbers: Option<Vec<f64>> = parts.iter().copied().map(number).collect();
    let numbers: [f64; D] = match numbers.map(TryInto::try_into) {
        Some(Ok(numbers)) => numbers,
        Some(Err(numbers)) if numbers.len() == 2 * D => {
            let got = format!("{} in {text:?}", numbers.len());
            return Err(wrong(format!("{got}; a decimal comma is written as a point")));
        }
        Some(Err(numbers)) => return Err(wrong(format!("{} in {text:?}", numbers.len()))),
        None if text.contains([';', ' ']) && !text.contains(',') => {
            return Err(wrong(format!("{text:?}; numbers are joined by commas alone")));
        }
        None => return Err(wrong(format!("{text:?}"))),
    };
    // Written so that NaN is refused.
    let is_good = |x: &f64| x.abs() <= LARGEST_LENGTH;
    match numbers.iter().position(|x| !is_good(x)) {
        None => Ok(Vector(numbers)),
        Some(axis) => Err(Failure::input(format!(
            "{} must be finite and at most {LARGEST_LENGTH:e} m in size, got {} m",
            AXES[axis], numbers[axis]
        ))),
    }
}

/// A point of a scene as the command line writes it, for an example: the middle of its box.
pub(crate) fn example_point<const D: usize>(scene: &BuiltScene<D>) -> String {
    let middle = scene.bounds().map_or(Vector::ZERO, |bounds| bounds.centre());
    written_point(middle)
}

/// A point as the command line writes it, to three digits.
pub(crate) fn written_point<const D: usize>(point: Vector<f64, D>) -> String {
    // Adding zero turns −0 into 0.
    let rounded = point.0.map(|x| format!("{x:.2e}").parse::<f64>().unwrap_or(x) + 0.0);
    rounded.map(|x| x.to_string()).join(",")
}

/// The numbers that `text` lists, joined by commas, if there are `N`.
pub(crate) fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let numbers = text.split(',').map(|number| number.trim().parse().ok());
    numbers.collect::<Option<Vec<f64>>>()?.try_into().ok()
}

/// The way to a gradient of this name, for `D` dimensions.
pub(crate) fn gradient<const D: usize>(name: &str) -> Result<GradientMethod, Failure> {
    let method: GradientMethod =
        name.parse().map_err(|error| Failure::input(format!("--gradient: {error}")))?;
    if D > 2 && method.is_planar() {
        return Err(Failure::input(format!(
            "--gradient {method} turns in the plane, and this scene is in 3D: \
             take differences, closest_vector or exact"
        )));
    }
    Ok(method)
}

/// The box around all bounded bodies of a scene.
pub(crate) fn bounds<const D: usize>(scene: &BuiltScene<D>) -> Result<Aabb<D>, Failure> {
    scene.bounds().ok_or_else(|| Failure::input(SimulationError::NoBounds))
}

/// The longest edge of a box [m].
pub(crate) fn longest_edge<const D: usize>(bounds: &Aabb<D>) -> f64 {
    2.0 * bounds.half_extents().0.into_iter().fold(0.0, f64::max)
}

/// The times [s] and positions [m] of a contact point.
type Samples = (Vec<f64>, Vec<Vector<f64, 3>>);

/// Reads a path for each contact point of a scene of `D` dimensions from the columns `time_s,x_m,y_m[,z_m]` and, optionally,
/// `point`, the number of the row's contact point.
pub(crate) fn read<const D: usize>(
    path: &Path,
    reading: Reading,
) -> Result<Vec<HandPath>, Failure> {
    let mut table = Table::open(path, reading)?;
    let columns = coordinates::<D>(&table, &format!("a hand path in {D}D"), &["time_s"])?;
    let point = table.column("point");
    let mut paths: Vec<Samples> = Vec::new();
    while table.advance()? {
        let index = match point {
            None => Some(0),
            Some(column) => number_of_point(&mut table, column, paths.len()),
        };
        let numbers: Vec<_> = columns.iter().map(|column| table.number(*column)).collect();
        let numbers: Option<Vec<f64>> = numbers.into_iter().collect();
        let (Some(index), Some([time, position @ ..])) = (index, numbers.as_deref()) else {
            continue;
        };
        if index == paths.len() {
            paths.push((Vec::new(), Vec::new()));
        }
        let before = paths[index].0.last().copied().filter(|before| *time <= *before);
        if let Some(before) = before {
            let rule = format!("must be more than that of the row before, {before} s");
            table.note_at(columns[0], &format!("{rule}, got {time} s"));
        }
        paths[index].0.push(*time);
        paths[index]
            .1
            .push(Vector::<_, D>(std::array::from_fn(|axis| position[axis])).in_space());
    }
    table.finish()?;
    if paths.is_empty() {
        return Err(table.failure("there are no rows"));
    }
    let path = |(times, positions): Samples| {
        HandPath::new(times, positions, Interpolation::Monotone)
            .map_err(|error| table.failure(error))
    };
    paths.into_iter().map(path).collect()
}

/// The number of a contact point: one of the `known`, or the next.
fn number_of_point(table: &mut Table, column: usize, known: usize) -> Option<usize> {
    let field = table.text(column);
    let index = field.parse::<usize>().ok().filter(|index| *index <= known);
    if index.is_none() {
        let problem = format!(
            "points must be numbered 0, 1, 2 … in order, got {field:?} after {known} points"
        );
        table.note_at(column, &problem);
    }
    index
}
