// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Files beside a scene.

use std::fmt;
use std::ops::ControlFlow;
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

use palpate_field::{LARGEST_LENGTH, Point, SMALLEST_LENGTH, Shape, Vector};
use palpate_grid::{Grid, GridCache, GridError, GridOptions, GridProgress, Inside, Volume};
use palpate_mesh::{Findings, MeshSheet, Solid, SolidError, TriangleMesh, read_file};
use serde::Deserialize;

use crate::grids::named;
use crate::problem::Problem;

/// The solids of files, in the units of the files, with at most so many triangles in all, which take a few GB.
static SOLIDS: Kept<Key, Made> = Kept::new(1 << 22);

/// A solid, what was found in its mesh, and the samples of its volume if it has one.
type Made = (Shape<3>, Findings<3>, Option<Samples>);

/// A file, and of what is taken from it the number, by its bits, the grid and the side asked for.
type Key = (Stamp, Taken);
type Taken = (Option<(&'static str, u64)>, Option<String>, Option<Inside>);

/// The solid of a mesh or of a surface in a volume, as a scene uses it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct BuiltMesh {
    /// The file, as the scene names it; `None` of a mesh whose vertices and faces stand in the scene.
    pub file: Option<String>,
    /// Metres for a unit of the file; of a volume, whose head tells lengths, a factor.
    pub scale: f64,
    /// The grid of the file that is the volume, where the scene names it.
    pub grid: Option<String>,
    /// The value of the surface in a volume; `None` of a mesh.
    pub value: Option<f64>,
    /// The side of the value that is inside, where the scene says it; else the file does.
    pub inside: Option<Inside>,
    /// The samples of a volume, in metres before `scale`; `None` of a mesh.
    pub samples: Option<Samples>,
    /// The thickness of the plate that a sheet makes [m]; `None` of a solid.
    pub thickness: Option<f64>,
    /// The length within which corners were joined [m], where the scene says it; else their rounding does.
    pub weld_within: Option<f64>,
    /// What was found in it, and mended; nothing is looked for in a sheet.
    pub findings: Findings<3>,
    /// The solid.
    pub shape: Shape<3>,
}

/// The samples of a volume, as its file tells.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Samples {
    /// How many there are along each axis.
    pub counts: [usize; 3],
    /// The place of the first [m].
    pub origin: Point<3>,
    /// The way from one to the next along each axis [m].
    pub steps: [Vector<f64, 3>; 3],
    /// The least and the largest.
    pub range: [f32; 2],
    /// Whether their border cuts off what lies within the surface, which is then closed half a step beyond it.
    pub cut_off: bool,
}

impl Samples {
    /// The samples of a volume, and what they are to the surface at a value.
    #[must_use]
    pub fn of(volume: &Volume, value: f64) -> Self {
        let (counts, origin, steps) = (volume.counts(), volume.origin(), volume.steps());
        let (range, cut_off) = (volume.range(), volume.is_cut_off(value));
        Self { counts, origin, steps, range, cut_off }
    }
}

impl BuiltMesh {
    /// The files that it was read from, in the scene's folder.
    #[must_use]
    pub fn files(&self, folder: impl AsRef<Path>) -> Vec<PathBuf> {
        let Some(file) = &self.file else { return Vec::new() };
        let path = folder.as_ref().join(file);
        let others = others(&path, self.samples.is_some());
        std::iter::once(path).chain(others).collect()
    }

    /// Whether it is the same file at the same scale.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        let numbers = |mesh: &Self| {
            let numbers = [mesh.value, mesh.thickness, mesh.weld_within];
            (mesh.scale.to_bits(), numbers.map(|x| x.map(f64::to_bits)))
        };
        let names = |mesh: &Self| (mesh.file.clone(), mesh.grid.clone(), mesh.inside);
        self.file.is_some() && names(self) == names(other) && numbers(self) == numbers(other)
    }
}

/// A mesh as a scene gives it: a file, or vertices and faces.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
pub(crate) struct WrittenMesh {
    file: Option<String>,
    scale: Option<f64>,
    vertices: Option<Vec<[f64; 3]>>,
    faces: Option<Vec<[u32; 3]>>,
    thickness: Option<f64>,
    weld_within: Option<f64>,
}

/// What a scene says of how the faces of a mesh bound a body [m].
#[derive(Clone, Copy, Default)]
struct Bounding {
    thickness: Option<f64>,
    weld_within: Option<f64>,
}

/// The surface of a volume as a file gives it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
pub(crate) struct WrittenVolume {
    file: String,
    grid: Option<String>,
    value: f64,
    #[serde(default = "one")]
    scale: f64,
    inside: Option<String>,
}

/// The surface of a file that a solid is within.
#[derive(Clone, Copy)]
struct Asked<'a> {
    /// The kind of file, for messages.
    what: &'a str,
    file: &'a str,
    scale: f64,
    grid: Option<&'a str>,
    value: Option<f64>,
    inside: Option<Inside>,
    bounding: Bounding,
}

fn one() -> f64 {
    1.0
}

impl WrittenMesh {
    /// The solid; a file is looked for in `folder`.
    pub(crate) fn built(self, folder: Option<&Path>) -> Result<BuiltMesh, Problem> {
        let Self { thickness, weld_within, .. } = self;
        let bounding = Bounding { thickness, weld_within };
        match (&self.file, self.vertices, self.faces) {
            (Some(file), None, None) => {
                let scale = self.scale.unwrap_or_else(one);
                of_file(file, scale, bounding, folder)
            }
            (None, Some(vertices), Some(faces)) if self.scale.is_none() => {
                of_arrays(vertices, faces, bounding)
            }
            _ => Err(Problem::new(
                "must have `file`, and `scale` if it is not in metres, or `vertices` in metres and `faces`",
            )),
        }
    }
}

/// The solid of a mesh file, which is looked for in `folder`.
fn of_file(
    file: &str,
    scale: f64,
    bounding: Bounding,
    folder: Option<&Path>,
) -> Result<BuiltMesh, Problem> {
    let read = |path: &Path| {
        read_file(path).map(|mesh| (mesh, None)).map_err(|error| error.to_string())
    };
    let (grid, value, inside) = (None, None, None);
    let asked = Asked { what: "a mesh", file, scale, grid, value, inside, bounding };
    built(asked, folder, read)
}

/// The solid of a mesh that stands in the scene.
fn of_arrays(
    vertices: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    bounding: Bounding,
) -> Result<BuiltMesh, Problem> {
    bounding.check()?;
    let vertices = vertices.into_iter().map(Vector).collect();
    let mesh =
        TriangleMesh::new(vertices, faces).map_err(|error| Problem::new(error.to_string()))?;
    let (shape, findings) =
        solid(&mesh, bounding).map_err(|error| Problem::new(error.to_string()))?;
    let Bounding { thickness, weld_within } = bounding;
    Ok(BuiltMesh {
        file: None,
        scale: one(),
        grid: None,
        value: None,
        inside: None,
        thickness,
        weld_within,
        samples: None,
        findings,
        shape,
    })
}

/// The solid of a mesh, or the plate about its faces; lengths are in the units of the mesh.
fn solid(
    mesh: &TriangleMesh,
    Bounding { thickness, weld_within }: Bounding,
) -> Result<(Shape<3>, Findings<3>), SolidError> {
    let Some(thickness) = thickness else {
        let solid = match weld_within {
            None => Solid::from_mesh(mesh),
            Some(within) => Solid::from_mesh_within(mesh, within),
        };
        return solid.map(|(solid, found)| (solid.into(), found));
    };
    let faces = mesh.elements().len();
    MeshSheet::from_mesh(mesh, thickness).map(|sheet| {
        let mut found = Findings::default();
        (found.faces, found.own) = (faces, faces);
        (sheet.into(), found)
    })
}

impl Bounding {
    fn check(&self) -> Result<(), Problem> {
        match *self {
            Self { thickness: Some(thickness), .. }
                if !(SMALLEST_LENGTH..=LARGEST_LENGTH).contains(&thickness) =>
            {
                let rule = format!("{SMALLEST_LENGTH:e} to {LARGEST_LENGTH:e} m");
                let problem = format!("thickness must be from {rule}, got {thickness} m");
                Err(Problem::new(problem).under("thickness"))
            }
            Self { thickness: Some(_), weld_within: Some(_) } => Err(Problem::new(
                "a plate takes its faces as they are: leave weld_within or thickness out",
            )
            .under("weld_within")),
            Self { weld_within: Some(within), .. } if within.is_nan() || within < 0.0 => {
                let problem = format!("weld_within must be at least 0 m, got {within} m");
                Err(Problem::new(problem).under("weld_within"))
            }
            _ => Ok(()),
        }
    }

    /// The same in units of so many metres.
    fn in_units(self, scale: f64) -> Self {
        Self {
            thickness: self.thickness.map(|length| length / scale),
            weld_within: self.weld_within.map(|length| length / scale),
        }
    }
}

impl WrittenVolume {
    /// The solid within the surface, in the volume of a file, which is looked for in `folder`.
    pub(crate) fn built(&self, folder: Option<&Path>) -> Result<BuiltMesh, Problem> {
        let sides = Inside::ALL.map(|side| (side.name(), side));
        let inside = self.inside.as_deref().map(|name| named(name, "inside", sides));
        let inside = inside.transpose()?;
        let surface = |path: &Path| {
            let volume = match &self.grid {
                Some(grid) => Volume::open_grid(path, grid),
                None => Volume::open(path),
            };
            let volume = volume.map_err(|error| error.to_string())?;
            let side = inside.unwrap_or(volume.inside());
            let volume = volume.with_inside(side);
            let surface = volume.surface(self.value);
            surface
                .map(|mesh| (mesh, Some(Samples::of(&volume, self.value))))
                .map_err(|problem| format!("{}: {problem}", path.display()))
        };
        let (file, scale) = (self.file.as_str(), self.scale);
        let (grid, value) = (self.grid.as_deref(), Some(self.value));
        let bounding = Bounding::default();
        let asked = Asked { what: "a volume", file, scale, grid, value, inside, bounding };
        built(asked, folder, surface)
    }
}

/// The files that the head of a volume names.
fn others(path: &Path, is_volume: bool) -> Vec<PathBuf> {
    // Why a head cannot be read is told where the volume is read.
    let files = if is_volume { Volume::files(path).unwrap_or_default() } else { Vec::new() };
    files.into_iter().skip(1).collect()
}

/// The solid of what `read` makes of a file.
fn built(
    Asked { what, file, scale, grid, value, inside, bounding }: Asked<'_>,
    folder: Option<&Path>,
    read: impl FnOnce(&Path) -> Result<(TriangleMesh, Option<Samples>), String>,
) -> Result<BuiltMesh, Problem> {
    if scale.is_nan() || scale <= 0.0 || scale.is_infinite() {
        return Err(Problem::new(format!("scale must be positive, got {scale}")).under("scale"));
    }
    bounding.check()?;
    let of_file = |message: String| Problem::new(message).under("file");
    let Beside { path, stamp } =
        Beside::of(what, file, folder).map_err(|problem| problem.under("file"))?;
    let stamp = stamp.with(&others(&path, value.is_some()));
    // Lengths of the scene are in metres, the solids that are kept in units of the file.
    let in_units = bounding.in_units(scale);
    let number = |name, number: Option<f64>| number.map(|number| (name, number.to_bits()));
    let grid = grid.map(str::to_owned);
    let taken = number("value", value)
        .or(number("thickness", in_units.thickness))
        .or(number("weld_within", in_units.weld_within));
    let key: Key = (stamp, (taken, grid.clone(), inside));
    let (shape, findings, samples) = match SOLIDS.of(&key) {
        Some(known) => known,
        None => {
            let (mesh, samples) = read(&path).map_err(of_file)?;
            let faces = mesh.elements().len();
            let (shape, findings) = solid(&mesh, in_units)
                .map_err(|error| of_file(format!("{}: {error}", path.display())))?;
            let made = (shape, findings, samples);
            // Another state of the file is of no use any more.
            SOLIDS.keep(key.clone(), &made, faces, |(known, other)| {
                known.is_of_same_file(&key.0) && (*known != key.0 || *other == key.1)
            });
            made
        }
    };
    let scaled = shape.scaled(scale);
    let Bounding { thickness, weld_within } = bounding;
    Ok(BuiltMesh {
        file: Some(file.to_owned()),
        scale,
        grid,
        value,
        inside,
        thickness,
        weld_within,
        samples,
        findings: findings.scaled(scale),
        shape: scaled.map_err(|error| Problem::new(error.to_string()).under("scale"))?,
    })
}

/// Who is told how a grid is made, and can stop it.
pub type BakeProgress = Arc<dyn Fn(GridProgress) -> ControlFlow<()> + Send + Sync>;

/// What a scene uses beside its text: the folder of its files, a folder of grids that were baked before, and who is
/// told how a grid is made. A folder alone [becomes](From) resources.
///
/// ```
/// use palpate_scene::{Resources, Scene};
///
/// # fn main() -> Result<(), palpate_scene::SceneError> {
/// let text = r#"{ "palpate": 1, "dimension": 2, "bodies": [ { "name": "disc",
///     "shape": { "bake": { "cell": 0.002 }, "of": { "ball": { "radius": 0.02 } } } } ] }"#;
/// # let folder = tempfile::tempdir().expect("a folder");
/// let resources = Resources::default().with_cache(folder.path().join("grids"));
/// Scene::from_json_in(text, resources)?.build()?;
/// // The next run reads the grid from the folder.
/// # assert_eq!(std::fs::read_dir(folder.path().join("grids")).expect("is made").count(), 1);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Default)]
#[non_exhaustive]
pub struct Resources {
    /// The folder in which files of meshes, volumes and grids are looked for; a scene without one has none.
    pub folder: Option<PathBuf>,
    /// Where grids that are baked are kept from run to run; `None` keeps them in memory alone.
    pub cache: Option<GridCache>,
    /// Who is told how a grid is made.
    pub progress: Option<BakeProgress>,
    /// The most nodes with references followed, where that is fewer than the million of any scene.
    pub most_nodes: Option<usize>,
}

impl Resources {
    /// The same with files in a folder.
    #[must_use]
    pub fn in_folder(self, folder: impl Into<PathBuf>) -> Self {
        Self { folder: Some(folder.into()), ..self }
    }

    /// The same with grids kept in a folder, of up to 2 GiB.
    #[must_use]
    pub fn with_cache(self, folder: impl Into<PathBuf>) -> Self {
        Self { cache: Some(GridCache::in_folder(folder)), ..self }
    }

    /// The same, telling how a grid is made.
    #[must_use]
    pub fn with_progress(self, progress: BakeProgress) -> Self {
        Self { progress: Some(progress), ..self }
    }

    /// The same with at most so many nodes: where a scene is edited, each edit builds all of them.
    /// References are followed, and a node counts again in each operator that holds it.
    ///
    /// ```
    /// use palpate_scene::{Resources, Scene};
    ///
    /// let text = r#"{ "palpate": 1, "dimension": 2, "bodies": [ { "name": "discs", "shape": { "union":
    ///     [{ "ball": { "radius": 0.02 } }, { "ball": { "radius": 0.03 } }] } } ] }"#;
    /// // Two balls, and a union that holds two.
    /// assert!(Scene::from_json_in(text, Resources::default().with_most_nodes(5)).is_ok());
    /// let error = Scene::from_json_in(text, Resources::default().with_most_nodes(4)).unwrap_err();
    /// assert!(error.to_string().contains("more than 4 nodes"));
    /// ```
    #[must_use]
    pub fn with_most_nodes(self, most: usize) -> Self {
        Self { most_nodes: Some(most), ..self }
    }

    /// The grid of a shape, kept or made.
    pub(crate) fn bake<const D: usize>(
        &self,
        shape: &Shape<D>,
        options: &GridOptions,
    ) -> Result<Grid<D>, GridError> {
        let silent = |_| ControlFlow::Continue(());
        let progress: &(dyn Fn(GridProgress) -> ControlFlow<()> + Sync) = match &self.progress {
            Some(progress) => &**progress,
            None => &silent,
        };
        match &self.cache {
            Some(cache) => cache.bake(shape, options, progress).map(|(grid, _)| grid),
            None => Grid::bake_with(shape, options, progress),
        }
    }
}

impl From<PathBuf> for Resources {
    fn from(folder: PathBuf) -> Self {
        Self::default().in_folder(folder)
    }
}

impl From<&Path> for Resources {
    fn from(folder: &Path) -> Self {
        Self::default().in_folder(folder)
    }
}

impl PartialEq for Resources {
    /// Who is told does not count.
    fn eq(&self, other: &Self) -> bool {
        (&self.folder, &self.cache, self.most_nodes)
            == (&other.folder, &other.cache, other.most_nodes)
    }
}

impl fmt::Debug for Resources {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { folder, cache, progress: _, most_nodes } = self;
        f.debug_struct("Resources")
            .field("folder", folder)
            .field("cache", cache)
            .field("most_nodes", most_nodes)
            .finish_non_exhaustive()
    }
}

/// A file in the scene's folder or below it.
#[derive(Clone, Debug)]
pub(crate) struct Beside {
    /// Where it is, as messages tell it.
    pub(crate) path: PathBuf,
    /// What tells whether it is as it was.
    pub(crate) stamp: Stamp,
}

/// What tells whether a file is as it was.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stamp {
    path: PathBuf,
    /// When it was written, and its bytes; the same of files that it names.
    states: Vec<State>,
}

type State = Option<(Option<SystemTime>, u64)>;

impl Stamp {
    /// The same, with files that this one names.
    pub(crate) fn with(mut self, files: &[PathBuf]) -> Self {
        self.states.extend(files.iter().map(|file| state(file)));
        self
    }

    /// Whether it is of the same file, as it is or as it was.
    pub(crate) fn is_of_same_file(&self, other: &Self) -> bool {
        self.path == other.path
    }
}

impl Beside {
    /// The file that a scene in `folder` names; `what` is it: "a mesh". A problem is about the file's name.
    pub(crate) fn of(what: &str, file: &str, folder: Option<&Path>) -> Result<Self, Problem> {
        let Some(folder) = folder else {
            return Err(Problem::new(format!(
                "{what} is a file beside the scene's: this scene is in no file"
            )));
        };
        let named = Path::new(file);
        let is_below = named.components().all(|part| matches!(part, Component::Normal(_)));
        if file.is_empty() || !is_below {
            return Err(Problem::new(format!(
                "{what} is a file in the scene's folder or below it, got {file:?}"
            )));
        }
        let path = folder.join(named);
        let cannot =
            |error: std::io::Error| Problem::new(format!("{}: {error}", path.display()));
        let real = path.canonicalize().map_err(cannot)?;
        // The folder of a file that is named alone is empty.
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        if !real.starts_with(folder.canonicalize().map_err(cannot)?) {
            let shown = path.display();
            return Err(Problem::new(format!(
                "{shown}: it is a link out of the scene's folder"
            )));
        }
        let states = vec![state(&real)];
        Ok(Self { path, stamp: Stamp { path: real, states } })
    }
}

/// When a file was written, and its bytes; `None` where there is no file.
fn state(path: &Path) -> State {
    let metadata = std::fs::metadata(path).ok()?;
    Some((metadata.modified().ok(), metadata.len()))
}

/// What was made, by what it was made of: those used last, up to a weight in all.
#[derive(Debug)]
pub(crate) struct Kept<K, T> {
    /// With their weights, the last used last.
    made: Mutex<Vec<(K, T, usize)>>,
    most: usize,
}

impl<K: PartialEq, T: Clone> Kept<K, T> {
    pub(crate) const fn new(most: usize) -> Self {
        Self { made: Mutex::new(Vec::new()), most }
    }

    pub(crate) fn of(&self, key: &K) -> Option<T> {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        let found = made.iter().position(|(known, ..)| known == key)?;
        let used = made.remove(found);
        let value = used.1.clone();
        made.push(used);
        Some(value)
    }

    /// Keeps a value, and drops those that are of no use any more, and what is too much.
    pub(crate) fn keep(
        &self,
        key: K,
        value: &T,
        weight: usize,
        is_of_no_use: impl Fn(&K) -> bool,
    ) {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        made.retain(|(known, ..)| !is_of_no_use(known));
        made.push((key, value.clone(), weight));
        let mut all: usize = made.iter().map(|(_, _, weight)| weight).sum();
        while all > self.most && made.len() > 1 {
            all -= made.remove(0).2;
        }
    }
}
