// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The class `Scene`: bodies with names, as in scene files.

use std::io::ErrorKind;
use std::path::PathBuf;

use palpate::field::Pose;
use palpate::scene::{
    AnyScene, AskError, BuiltScene, Dimension, LARGEST_FILE, Question, Scene, SceneBody,
    SceneCause, SceneError, Versioned,
};
use pyo3::exceptions::{PyKeyError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::answers::{Fields, read};
use crate::arrays::row;
use crate::call::detached_in;
use crate::ending::detach;
use crate::error::OrRaise;
use crate::interrupt::abandonable;
use crate::mesh::replace;
use crate::pool;
use crate::poses::{self, Posed};
use crate::shape::{AnyShape, PyShape};

/// Does the same with a scene of either dimension.
macro_rules! of_either {
    ($any:expr, $scene:ident => $done:expr) => {
        match $any {
            palpate::scene::AnyScene::Planar($scene) => $done,
            palpate::scene::AnyScene::Spatial($scene) => $done,
        }
    };
}

/// Bodies with names, and what touches them and how that feels.
///
/// Of shapes in a dict, with their names; a shape alone gets the name "body". `poses` are where bodies are, by their
/// names, as of `Shape.placed`; `materials` how they feel, by their names: a preset such as "rubber", or a dict as
/// `{"stiffness": 800}`. `tool` is a dict, `guides` and `motions` are lists of dicts, with the keys of scene files;
/// arrays and shapes may stand in them.
///
/// Raises `SceneError` if a body cannot be written, as a function, or a key or number is wrong, `KeyError` if `poses` or
/// `materials` name no body, `ValueError` if bodies are of both dimensions.
///
/// >>> import palpate as pp
/// >>> scene = pp.Scene({"table": pp.cuboid([1, 0.1, 1]), "ball": pp.ball(0.05).translated([0, 0.1, 0])})
/// >>> scene.names, scene["ball"].shape.distance([0, 0.2, 0])
/// (('table', 'ball'), 0.05)
/// >>> soft = pp.Scene(pp.ball(0.05), materials={"body": {"stiffness": 200}}, tool={"radius": 0.005})
/// >>> hand = [[0, 0, 0.07, 0], [0.2, 0, 0.045, 0]]
/// >>> bool(pp.feel(soft, hand=hand, duration=0.2).trace.force[-1, 1] > 1)
/// True
#[pyclass(frozen, module = "palpate", name = "Scene")]
pub(crate) struct PyScene {
    written: Scene,
    built: AnyScene,
    /// Where files that the scene names are looked for.
    folder: Option<PathBuf>,
}

impl PyScene {
    fn of(py: Python<'_>, written: Scene, folder: Option<PathBuf>) -> PyResult<Self> {
        // Grids of the scene are baked here.
        let built =
            detached_in(py, &*pool::of_at_least_one(1)?, || written.build())?.or_raise(py)?;
        Ok(Self { written, built, folder })
    }

    pub(crate) fn built(&self) -> &AnyScene {
        &self.built
    }

    /// The names of the bodies, in their order.
    pub(crate) fn body_names(&self) -> Vec<String> {
        of_either!(&self.built, scene => {
            scene.bodies.iter().map(|body| body.name.clone()).collect()
        })
    }

    /// What a scene of a shape, or of a dict of names and shapes, says.
    fn of_bodies(
        bodies: &Bound<'_, PyAny>,
        poses: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Scene> {
        let py = bodies.py();
        let mut named: Vec<(String, PyShape)> = Vec::new();
        if let Ok(shape) = bodies.extract::<PyShape>() {
            named.push(("body".to_owned(), shape));
        } else if let Ok(dict) = bodies.cast::<PyDict>() {
            for (name, shape) in dict {
                let name: String = name.extract()?;
                let shape = shape.extract().map_err(|_| {
                    let kind = shape
                        .get_type()
                        .name()
                        .map_or_else(|_| String::new(), |own| own.to_string());
                    PyTypeError::new_err(format!(
                        "the body {name:?} must be a Shape, got a {kind}"
                    ))
                })?;
                named.push((name, shape));
            }
        } else {
            let problem = "a scene is made of a shape, or of a dict of names and shapes";
            return Err(PyTypeError::new_err(problem));
        }
        let (mut planar, mut solid) = (Vec::new(), Vec::new());
        for (name, shape) in &named {
            match shape.made(py)? {
                AnyShape::Planar(shape) => planar.push(SceneBody::new(name, shape.clone())),
                AnyShape::Spatial(shape) => solid.push(SceneBody::new(name, shape.clone())),
            }
        }
        match (planar.len(), solid.len()) {
            (1.., 0) => {
                Scene::new(Dimension::Two).with_bodies(placed(planar, poses)?).or_raise(py)
            }
            (0, _) => {
                Scene::new(Dimension::Three).with_bodies(placed(solid, poses)?).or_raise(py)
            }
            (flat, solid) => {
                let problem = format!(
                    "the bodies of a scene must have the same dimension, got {flat} in 2D and {solid} in 3D"
                );
                Err(PyValueError::new_err(problem))
            }
        }
    }

    /// A scene, or the one that a shape or a dict of shapes makes.
    pub(crate) fn given<'py>(given: &Bound<'py, PyAny>) -> PyResult<Bound<'py, Self>> {
        match given.cast::<Self>() {
            Ok(scene) => Ok(scene.clone()),
            Err(_) => {
                let py = given.py();
                Bound::new(py, Self::of(py, Self::of_bodies(given, None)?, None)?)
            }
        }
    }
}

#[pymethods]
impl PyScene {
    #[new]
    #[pyo3(signature = (bodies, *, poses = None, materials = None, tool = None, guides = None, motions = None))]
    fn new<'py>(
        bodies: &Bound<'py, PyAny>,
        poses: Option<&Bound<'py, PyDict>>,
        materials: Option<&Bound<'py, PyAny>>,
        tool: Option<&Bound<'py, PyAny>>,
        guides: Option<&Bound<'py, PyAny>>,
        motions: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Self> {
        let py = bodies.py();
        let mut scene = Self::of_bodies(bodies, poses)?;
        let parts = PyDict::new(py);
        for (key, part) in [("tool", tool), ("guides", guides), ("motions", motions)] {
            if let Some(part) = part {
                parts.set_item(key, part)?;
            }
        }
        if materials.is_some() || !parts.is_empty() {
            let none = PyDict::new(py).into_any();
            let given = (scene.to_json(), materials.unwrap_or(&none), parts);
            let furnished = py.import("palpate._scenes")?.getattr("furnished")?;
            let text: String = furnished.call1(given)?.extract()?;
            scene = Scene::from_json(&text).or_raise(py)?;
        }
        Self::of(py, scene, None)
    }

    /// Reads a scene file, of at most `largest_file` bytes, 256 MiB if left out. Files that it names are read again
    /// where the scene is unpickled.
    ///
    /// Raises `MissingFileError` if there is no such file, `FileError` if it is too large, `SceneError` with the place in
    /// the file if it is no scene.
    ///
    /// >>> import palpate as pp, tempfile, os
    /// >>> file = os.path.join(tempfile.mkdtemp(), "scene.json")
    /// >>> pp.Scene(pp.ball(0.5)).save(file)
    /// >>> pp.Scene.load(file).names
    /// ('body',)
    #[staticmethod]
    #[pyo3(signature = (file, *, largest_file = None))]
    fn load(py: Python<'_>, file: PathBuf, largest_file: Option<u64>) -> PyResult<Self> {
        let most = largest_file.unwrap_or(LARGEST_FILE);
        let read = detach(py, || Scene::from_file_within(&file, most));
        let scene = read.map_err(with_option).or_raise(py)?;
        let folder = std::path::absolute(&file)?.parent().map(PathBuf::from);
        Self::of(py, scene, folder)
    }

    /// The scene of a text; files that it names are looked for in `folder`.
    ///
    /// Raises `SceneError` with the place in the text if it is no scene.
    ///
    /// >>> import palpate as pp
    /// >>> pp.Scene.from_json(pp.Scene(pp.ball(0.5)).to_json()).dimension
    /// 3
    #[staticmethod]
    #[pyo3(signature = (text, *, folder = None))]
    fn from_json(py: Python<'_>, text: &str, folder: Option<PathBuf>) -> PyResult<Self> {
        // The folder of a bare name is an empty path.
        let folder = folder.map(|own| std::path::absolute(PathBuf::from(".").join(own)));
        let folder = folder.transpose()?;
        let scene = match &folder {
            None => Scene::from_json(text),
            Some(folder) => {
                let resources = palpate::scene::Resources::default().in_folder(folder);
                Scene::from_json_in(text, resources)
            }
        };
        Self::of(py, scene.or_raise(py)?, folder)
    }

    /// Answers a question, with the keys of `docs/answers.md`: a dict, or its text in JSON. The answer
    /// is a dict with the keys that the program prints with `--json`, in SI units; infinite numbers stay numbers.
    ///
    /// Raises `ValueError` if the question cannot be read or does not fit the scene, `KeyError` if it names no body.
    /// After Ctrl-C the search goes on in a thread that nobody waits for.
    ///
    /// >>> import palpate as pp
    /// >>> scene = pp.Scene({"left": pp.ball(0.5), "right": pp.ball(0.5).translated([2, 0, 0])})
    /// >>> answer = scene.ask({"question": "contacts"})
    /// >>> answer["pairs"][0]["verdict"], answer["apart"]
    /// ('apart', 1)
    /// >>> scene.ask({"question": "point", "at": [0, 0, 0]})["distance"]
    /// -0.5
    fn ask<'py>(&self, question: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = question.py();
        let text = py.import("palpate._scenes")?.call_method1("question", (question,))?;
        let question = Question::from_json(&text.extract::<String>()?).map_err(refused)?;
        of_either!(self.built.clone(), scene => {
            let answer = abandonable(py, move || scene.ask(&question))?.map_err(refused)?;
            read(py, &Versioned::new(answer))
        })
    }

    /// The text of the scene, as a file holds it.
    ///
    /// >>> import palpate as pp
    /// >>> '"ball"' in pp.Scene(pp.ball(0.5)).to_json()
    /// True
    fn to_json(&self) -> String {
        self.written.to_json()
    }

    /// Writes a scene file. One that is there is replaced when the new one is whole. Files that the scene names are
    /// not copied.
    ///
    /// Raises `OSError` if the file cannot be written.
    ///
    /// >>> import palpate as pp, tempfile, os
    /// >>> pp.Scene(pp.ball(0.5)).save(os.path.join(tempfile.mkdtemp(), "scene.json"))
    fn save(&self, py: Python<'_>, file: PathBuf) -> PyResult<()> {
        replace(py, &file, self.to_json().as_bytes())
    }

    /// 2 in the plane, 3 in space.
    ///
    /// >>> import palpate as pp
    /// >>> pp.Scene(pp.ball(0.5, dimension=2)).dimension
    /// 2
    #[getter]
    fn dimension(&self) -> usize {
        self.written.dimension().count()
    }

    /// The names of the bodies, in their order.
    ///
    /// >>> import palpate as pp
    /// >>> pp.Scene({"a": pp.ball(0.5)}).names
    /// ('a',)
    #[getter]
    fn names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(PyTuple::new(py, self.body_names())?.into_any())
    }

    /// All bodies as one shape.
    ///
    /// >>> import palpate as pp
    /// >>> pp.Scene({"a": pp.ball(0.5)}).whole.distance([0, 1, 0])
    /// 0.5
    #[getter]
    fn whole(&self) -> PyShape {
        of_either!(&self.built, scene => scene.whole.clone().into())
    }

    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        of_either!(&self.built, scene => body(py, scene, name))
    }

    fn __contains__(&self, name: &Bound<'_, PyAny>) -> bool {
        name.extract::<String>().is_ok_and(|name| self.body_names().contains(&name))
    }

    fn __len__(&self) -> usize {
        of_either!(&self.built, scene => scene.bodies.len())
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.names(py)?.call_method0("__iter__")
    }

    fn __repr__(&self) -> String {
        format!("<palpate.Scene in {}D: {}>", self.dimension(), self.body_names().join(", "))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| {
            let (other, text) = (other.get(), self.written.to_json());
            // Where files are looked for matters to scenes that name some.
            let same_files = other.folder == self.folder || !text.contains("\"file\"");
            other.written.to_json() == text && same_files
        })
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let (py, scene) = (slf.py(), slf.get());
        let rebuild = py.import("palpate._pickled")?.getattr("scene")?;
        let parts = (scene.to_json(), scene.folder.clone());
        Ok((rebuild, parts).into_pyobject(py)?.into_any())
    }
}

fn refused(error: AskError) -> PyErr {
    match error {
        AskError::UnknownBody(problem) => PyKeyError::new_err(problem),
        error => PyValueError::new_err(error.to_string()),
    }
}

/// Bodies with the poses that a caller gives them.
fn placed<const D: usize>(
    mut bodies: Vec<SceneBody<D>>,
    poses: Option<&Bound<'_, PyDict>>,
) -> PyResult<Vec<SceneBody<D>>>
where
    Pose<D>: Posed,
{
    let Some(poses) = poses else { return Ok(bodies) };
    let names: Vec<_> = bodies.iter().map(|body| body.name.clone()).zip(0..).collect();
    for (body, pose) in poses::named::<usize, _>(poses, &names)? {
        bodies[body].world_from_body = Some(pose);
    }
    Ok(bodies)
}

fn body<'py, const D: usize>(
    py: Python<'py>,
    scene: &BuiltScene<D>,
    name: &str,
) -> PyResult<Bound<'py, PyAny>>
where
    PyShape: From<palpate::field::Shape<D>>,
{
    let names: Vec<_> = scene.bodies.iter().map(|body| body.name.clone()).zip(0..).collect();
    let found = &scene.bodies[poses::body::<usize>(name, &names)?];
    Fields::new(py)
        .with("name", name)?
        .with("shape", PyShape::from(found.shape.clone()))?
        .with("shape_in_body", PyShape::from(found.shape_in_body.clone()))?
        .with("pose", matrix(py, &found.world_from_body)?)?
        .of_class("Body")
}

/// A pose as a matrix, with a row of zeros and a one at its end.
pub(crate) fn matrix<'py, const D: usize>(
    py: Python<'py>,
    pose: &Pose<D>,
) -> PyResult<Bound<'py, PyAny>> {
    matrices(py, [*pose])?.get_item(0)
}

/// Poses as an array of matrices.
pub(crate) fn matrices<'py, const D: usize>(
    py: Python<'py>,
    poses: impl IntoIterator<Item = Pose<D>>,
) -> PyResult<Bound<'py, PyAny>> {
    let mut numbers = Vec::new();
    for pose in poses {
        for (turn, way) in pose.rotation.matrix().iter().zip(pose.translation.0) {
            numbers.extend(turn);
            numbers.push(way);
        }
        numbers.extend([0.0; D]);
        numbers.push(1.0);
    }
    row(py, numbers).call_method1("reshape", (-1, D + 1, D + 1))
}

/// An error of a file that is too large, with the option that raises the limit.
fn with_option(error: SceneError) -> SceneError {
    let mut first = error.first().clone();
    match first.cause.as_deref() {
        Some(SceneCause::File(ErrorKind::FileTooLarge)) => {
            first.problem.push_str("; largest_file raises that");
            first.into()
        }
        _ => error,
    }
}
