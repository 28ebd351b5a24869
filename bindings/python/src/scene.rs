// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The class `Scene`: bodies with names, as in scene files.

use std::path::PathBuf;

use palpate::field::Pose;
use palpate::scene::{AnyScene, BuiltScene, Dimension, Scene, SceneBody};
use pyo3::exceptions::{PyKeyError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::answers::Fields;
use crate::arrays::row;
use crate::error::OrRaise;
use crate::mesh::replace;
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
/// Bodies with names, and what scene files say of tool, guides, motions and views besides.
///
/// Of shapes in a dict, with their names; a shape alone gets the name "body".
///
/// >>> import palpate as pp
/// >>> scene = pp.Scene({"table": pp.cuboid([1, 0.1, 1]), "ball": pp.ball(0.05).translated([0, 0.1, 0])})
/// >>> scene.names, scene["ball"].shape.distance([0, 0.2, 0])
/// (('table', 'ball'), 0.05)
#[pyclass(frozen, module = "palpate", name = "Scene")]
pub(crate) struct PyScene {
    written: Scene,
    built: AnyScene,
    /// Where files that the scene names are looked for.
    folder: Option<PathBuf>,
}

impl PyScene {
    fn of(py: Python<'_>, written: Scene, folder: Option<PathBuf>) -> PyResult<Self> {
        let built = py.detach(|| written.build()).or_raise(py)?;
        Ok(Self { written, built, folder })
    }

    pub(crate) fn built(&self) -> &AnyScene {
        &self.built
    }

    /// A scene, or the one that a shape or a dict of shapes makes.
    pub(crate) fn given<'py>(given: &Bound<'py, PyAny>) -> PyResult<Bound<'py, Self>> {
        match given.cast::<Self>() {
            Ok(scene) => Ok(scene.clone()),
            Err(_) => Bound::new(given.py(), Self::new(given)?),
        }
    }
}

#[pymethods]
impl PyScene {
    #[new]
    fn new(bodies: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = bodies.py();
        let mut named: Vec<(String, PyShape)> = Vec::new();
        if let Ok(shape) = bodies.extract::<PyShape>() {
            named.push(("body".to_owned(), shape));
        } else if let Ok(dict) = bodies.cast::<PyDict>() {
            for (name, shape) in dict {
                named.push((name.extract()?, shape.extract()?));
            }
        } else {
            let problem = "a scene is made of a shape, or of a dict of names and shapes";
            return Err(PyTypeError::new_err(problem));
        }
        let shapes =
            named.iter().map(|(_, shape)| shape.made(py)).collect::<PyResult<Vec<_>>>()?;
        let names = || named.iter().map(|(name, _)| name);
        let planar = shapes.iter().filter_map(|shape| match shape {
            AnyShape::Planar(shape) => Some(shape.clone()),
            AnyShape::Spatial(_) => None,
        });
        let solid = shapes.iter().filter_map(|shape| match shape {
            AnyShape::Planar(_) => None,
            AnyShape::Spatial(shape) => Some(shape.clone()),
        });
        let (planar, solid): (Vec<_>, Vec<_>) = (planar.collect(), solid.collect());
        let written = match (planar.len(), solid.len()) {
            (_, 0) if !planar.is_empty() => {
                let bodies =
                    names().zip(planar).map(|(name, shape)| SceneBody::new(name, shape));
                Scene::new(Dimension::Two).with_bodies(bodies)
            }
            (0, _) => {
                let bodies =
                    names().zip(solid).map(|(name, shape)| SceneBody::new(name, shape));
                Scene::new(Dimension::Three).with_bodies(bodies)
            }
            (flat, solid) => {
                let problem = format!(
                    "a scene has one dimension, got {flat} bodies of 2D and {solid} of 3D"
                );
                return Err(PyValueError::new_err(problem));
            }
        };
        let written = written.or_raise(py)?;
        Self::of(py, written, None)
    }

    /// Reads a scene file.
    ///
    /// >>> import palpate as pp, tempfile, os
    /// >>> file = os.path.join(tempfile.mkdtemp(), "scene.json")
    /// >>> pp.Scene(pp.ball(0.5)).save(file)
    /// >>> pp.Scene.load(file).names
    /// ('body',)
    #[staticmethod]
    fn load(py: Python<'_>, file: PathBuf) -> PyResult<Self> {
        let scene = py.detach(|| Scene::from_file(&file)).or_raise(py)?;
        Self::of(py, scene, file.parent().map(PathBuf::from))
    }

    /// The scene of a text; files that it names are looked for in `folder`.
    ///
    /// >>> import palpate as pp
    /// >>> pp.Scene.from_json(pp.Scene(pp.ball(0.5)).to_json()).dimension
    /// 3
    #[staticmethod]
    #[pyo3(signature = (text, *, folder = None))]
    fn from_json(py: Python<'_>, text: &str, folder: Option<PathBuf>) -> PyResult<Self> {
        let scene = match &folder {
            None => Scene::from_json(text),
            Some(folder) => {
                let resources = palpate::scene::Resources::default().in_folder(folder);
                Scene::from_json_in(text, resources)
            }
        };
        Self::of(py, scene.or_raise(py)?, folder)
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
        let names: Vec<&str> = of_either!(&self.built, scene => {
            scene.bodies.iter().map(|body| body.name.as_str()).collect()
        });
        Ok(pyo3::types::PyTuple::new(py, names)?.into_any())
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

    fn __contains__(&self, name: &str) -> bool {
        of_either!(&self.built, scene => scene.bodies.iter().any(|body| body.name == name))
    }

    fn __len__(&self) -> usize {
        of_either!(&self.built, scene => scene.bodies.len())
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.names(py)?.call_method0("__iter__")
    }

    fn __repr__(&self) -> String {
        let names = of_either!(&self.built, scene => {
            scene.bodies.iter().map(|body| body.name.clone()).collect::<Vec<_>>()
        });
        format!("<palpate.Scene in {}D: {}>", self.dimension(), names.join(", "))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| {
            let other = other.get();
            other.written.to_json() == self.written.to_json() && other.folder == self.folder
        })
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let (py, scene) = (slf.py(), slf.get());
        let rebuild = py.import("palpate._pickled")?.getattr("scene")?;
        let parts = (scene.to_json(), scene.folder.clone());
        Ok((rebuild, parts).into_pyobject(py)?.into_any())
    }
}

fn body<'py, const D: usize>(
    py: Python<'py>,
    scene: &BuiltScene<D>,
    name: &str,
) -> PyResult<Bound<'py, PyAny>>
where
    PyShape: From<palpate::field::Shape<D>>,
{
    let found = scene.bodies.iter().find(|body| body.name == name).ok_or_else(|| {
        let known: Vec<&str> = scene.bodies.iter().map(|body| body.name.as_str()).collect();
        PyKeyError::new_err(format!(
            "no body is called {name:?}: there are {}",
            known.join(", ")
        ))
    })?;
    Fields::new(py)
        .with("name", name)?
        .with("shape", PyShape::from(found.shape.clone()))?
        .with("shape_in_body", PyShape::from(found.shape_in_body.clone()))?
        .with("pose", matrix(py, &found.world_from_body)?)?
        .of_class("Body")
}

/// A pose as a matrix, with a row of zeros and a one at its end.
fn matrix<'py, const D: usize>(py: Python<'py>, pose: &Pose<D>) -> PyResult<Bound<'py, PyAny>> {
    let mut numbers = Vec::with_capacity((D + 1) * (D + 1));
    for (turn, way) in pose.rotation.matrix().iter().zip(pose.translation.0) {
        numbers.extend(turn);
        numbers.push(way);
    }
    numbers.extend([0.0; D]);
    numbers.push(1.0);
    row(py, numbers).call_method1("reshape", (D + 1, D + 1))
}
