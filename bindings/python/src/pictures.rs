// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Pictures: isolines on a plane, and lit views.

use std::path::PathBuf;
use std::sync::atomic::Ordering;

use palpate::field::{Aabb, Shape, Vector};
use palpate::plot::{Figure, Isolines, PlaneView, Sampling, Slice};
use palpate::render::{Camera, Image, Lens, Settings, Sight, Subject, render};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::row;
use crate::call::detached;
use crate::ending::detach;
use crate::error::OrRaise;
use crate::interrupt::interruptible;
use crate::mesh::replace;
use crate::pool;
use crate::shape::{AnyShape, PyShape};

/// The margin of a picture, as a share of the longer side of what it shows.
const MARGIN: f64 = 0.15;

/// What is shown of a shape without bounds: a square or cube of this half edge [m].
const UNBOUNDED: f64 = 1.0;

/// Samples along the longer side of a figure; fewer where it is shown without being asked for, since its text stands in
/// the notebook.
const FINE: usize = 300;
const COARSE: usize = 100;

/// The pixels along a side of a figure that is shown without being asked for.
const SHOWN: u32 = 480;

/// A figure, as SVG and PNG. Notebooks show it.
///
/// >>> import palpate as pp
/// >>> figure = pp.ball(0.5).figure()
/// >>> figure.to_svg()[:4], figure.to_png()[1:4]
/// ('<svg', b'PNG')
#[pyclass(frozen, module = "palpate", name = "Figure")]
pub(crate) struct PyFigure(Figure);

#[pymethods]
impl PyFigure {
    /// The text of an SVG.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).figure().to_svg().endswith("</svg>\n")
    /// True
    fn to_svg(&self) -> String {
        self.0.to_svg()
    }

    /// The bytes of a PNG of a width in pixels.
    ///
    /// >>> import palpate as pp
    /// >>> len(pp.ball(0.5).figure().to_png(width=200)) > 1000
    /// True
    #[pyo3(signature = (*, width = 1200))]
    fn to_png<'py>(&self, py: Python<'py>, width: u32) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = detach(py, || self.0.to_png(width)).or_raise(py)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Writes a file that ends in .svg or .png. One that is there is replaced when the new one is whole.
    ///
    /// >>> import palpate as pp, tempfile, os
    /// >>> pp.ball(0.5).figure().save(os.path.join(tempfile.mkdtemp(), "ball.svg"))
    #[pyo3(signature = (file, *, width = 1200))]
    fn save(&self, py: Python<'_>, file: PathBuf, width: u32) -> PyResult<()> {
        match file.extension().and_then(|end| end.to_str()) {
            Some("svg") => replace(py, &file, self.to_svg().as_bytes()),
            Some("png") => replace(py, &file, self.to_png(py, width)?.as_bytes()),
            _ => Err(PyValueError::new_err("the name of a figure must end in .svg or .png")),
        }
    }

    fn _repr_svg_(&self) -> String {
        self.to_svg()
    }

    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        self.to_png(py, SHOWN)
    }
}

/// A lit picture. Notebooks show it.
///
/// >>> import palpate as pp
/// >>> image = pp.ball(0.5).render(width=64, height=48)
/// >>> image.pixels.shape, image.pixels.dtype.name
/// ((48, 64, 3), 'uint8')
#[pyclass(frozen, module = "palpate", name = "Image")]
pub(crate) struct PyImage(Image);

#[pymethods]
impl PyImage {
    /// Red, green and blue from 0 to 255, shape (height, width, 3).
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).render(width=64, height=48).pixels.shape
    /// (48, 64, 3)
    #[getter]
    fn pixels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let numbers: Vec<u8> = self.0.pixels().iter().flat_map(|color| color.0).collect();
        let shape = (self.0.height() as usize, self.0.width() as usize, 3);
        row(py, numbers).call_method1("reshape", shape)
    }

    /// The bytes of a PNG.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).render(width=64, height=48).to_png()[1:4]
    /// b'PNG'
    fn to_png<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let mut bytes = Vec::new();
        self.0.write_png(&mut bytes).or_raise(py)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Writes a file that ends in .png. One that is there is replaced when the new one is whole.
    ///
    /// >>> import palpate as pp, tempfile, os
    /// >>> pp.ball(0.5).render(width=64, height=48).save(os.path.join(tempfile.mkdtemp(), "ball.png"))
    fn save(&self, py: Python<'_>, file: PathBuf) -> PyResult<()> {
        if file.extension().is_none_or(|end| end != "png") {
            return Err(PyValueError::new_err("the name of a picture must end in .png"));
        }
        replace(py, &file, self.to_png(py)?.as_bytes())
    }

    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        self.to_png(py)
    }
}

#[pymethods]
impl PyShape {
    /// Isolines of the distance: in the plane, or on a plane of space, "xy", "xz" or "yz", at a place along the third
    /// axis [m].
    ///
    /// Raises `PlotError` if a number is out of range, `ValueError` if there is no such plane.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).figure(plane="xz", at=0.1).to_svg()[:4]
    /// '<svg'
    #[pyo3(signature = (*, plane = "xy", at = 0.0, title = None))]
    fn figure(
        &self,
        py: Python<'_>,
        plane: &str,
        at: f64,
        title: Option<&str>,
    ) -> PyResult<PyFigure> {
        figure(py, self.made(py)?, (plane, at), title.unwrap_or(""), FINE)
    }

    /// A lit view from `yaw` and `pitch` [degrees], by rays that pass over no surface; of shapes in space with bounds.
    /// From a yaw and pitch of 0 it is seen along -z. `threads` share the work, 0 for all processors.
    ///
    /// Raises `PlotError` if a number is out of range, `ValueError` if the shape has no bounds, `TypeError` if it is
    /// one of the plane.
    ///
    /// >>> import palpate as pp
    /// >>> pp.cuboid([1, 1, 1]).render(width=64, height=48).pixels.shape
    /// (48, 64, 3)
    #[pyo3(signature = (*, width = 640, height = 480, yaw = 35.0, pitch = 25.0, threads = 1))]
    fn render(
        &self,
        py: Python<'_>,
        width: u32,
        height: u32,
        yaw: f64,
        pitch: f64,
        threads: isize,
    ) -> PyResult<PyImage> {
        let shape = self.solid(py, "render")?;
        if shape.promise().bounds.is_none() {
            let problem = "the shape has no bounds: intersect it with a box first";
            return Err(PyValueError::new_err(problem));
        }
        let (yaw, pitch) = (yaw.to_radians(), pitch.to_radians());
        let aspect = f64::from(width) / f64::from(height.max(1));
        let pool = pool::of_at_least_one(threads)?;
        let made = interruptible(py, &pool, |stop| {
            let subject = Subject::of_shapes([shape])?;
            let sight = Sight::from_angles(yaw, pitch)?;
            let camera = Camera::fitting(&subject.corners(), sight, Lens::USUAL, aspect)?;
            let goes_on = |_: f64| !stop.load(Ordering::Relaxed);
            render(&subject, &camera, &Settings::new(width, height), &goes_on)
        })?;
        match made.or_raise(py)? {
            Some(rendering) => Ok(PyImage(rendering.image)),
            None => Err(pyo3::exceptions::PyKeyboardInterrupt::new_err(())),
        }
    }

    /// Draws a cut with matplotlib: the body, isolines and the surface; gives the axes. `plane` and `at` as of `figure`,
    /// `ax` the axes to draw on.
    ///
    /// >>> import matplotlib; matplotlib.use("agg")
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).plot().get_xlabel()
    /// 'x [m]'
    #[pyo3(signature = (*, plane = "xy", at = 0.0, ax = None))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        plane: &str,
        at: f64,
        ax: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("palpate._plot")?.call_method1("plot", (slf, plane, at, ax))
    }

    /// The distances at the nodes of a lattice around the shape: an array of one axis for each dimension, where its
    /// first node is and how far apart they are [m], as pyvista's `ImageData` and others take them.
    ///
    /// >>> import palpate as pp
    /// >>> values, origin, spacing = pp.ball(0.5).sample(0.1)
    /// >>> values.shape, origin.round(2), spacing
    /// ((13, 13, 13), array([-0.6, -0.6, -0.6]), 0.1)
    #[pyo3(signature = (spacing, *, margin = None, threads = 1))]
    fn sample<'py>(
        slf: &Bound<'py, Self>,
        spacing: f64,
        margin: Option<f64>,
        threads: isize,
    ) -> PyResult<Bound<'py, PyAny>> {
        slf.py()
            .import("palpate._plot")?
            .call_method1("sample", (slf, spacing, margin, threads))
    }

    fn _repr_svg_(&self, py: Python<'_>) -> PyResult<String> {
        Ok(figure(py, self.made(py)?, ("xy", 0.0), "", COARSE)?.to_svg())
    }

    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        figure(py, self.made(py)?, ("xy", 0.0), "", COARSE)?.to_png(py, SHOWN)
    }
}

fn figure(
    py: Python<'_>,
    shape: &AnyShape,
    (plane, at): (&str, f64),
    title: &str,
    samples: usize,
) -> PyResult<PyFigure> {
    let isolines = match shape {
        AnyShape::Planar(_) if plane != "xy" || at != 0.0 => {
            return Err(PyValueError::new_err(
                "a shape in 2D has no planes: leave plane= and at= out",
            ));
        }
        AnyShape::Planar(shape) => {
            let Aabb { min, max } = shown(shape);
            let slice = Slice::planar();
            let view = PlaneView::from_bounds(min.0, max.0, MARGIN).or_raise(py)?;
            detached(py, || isolines(shape, &slice, &view, samples, |st| st))?.or_raise(py)?
        }
        AnyShape::Spatial(shape) => {
            let Aabb { min, max } = shown(shape);
            let slice = match plane {
                "xy" => Slice::xy(at),
                "xz" => Slice::xz(at),
                "yz" => Slice::yz(at),
                _ => {
                    let problem = format!("plane must be xy, xz or yz, got {plane:?}");
                    return Err(PyValueError::new_err(problem));
                }
            };
            let slice = slice.or_raise(py)?;
            let view = PlaneView::of_box(&slice, min.0, max.0, MARGIN).or_raise(py)?;
            detached(py, || isolines(shape, &slice, &view, samples, |st| slice.point(st)))?
                .or_raise(py)?
        }
    };
    Ok(PyFigure(Figure::new(title).with_isolines(isolines)))
}

/// The box that a picture shows.
fn shown<const D: usize>(shape: &Shape<D>) -> Aabb<D> {
    let half = Vector::constant(UNBOUNDED);
    shape.promise().bounds.map_or(Aabb { min: -half, max: half }, |bounds| bounds.aabb)
}

fn isolines<const D: usize>(
    shape: &Shape<D>,
    slice: &Slice,
    view: &PlaneView,
    samples: usize,
    place: impl Fn([f64; 2]) -> [f64; D],
) -> Result<Isolines, palpate::plot::PlotError> {
    let mut points = Vec::new();
    Isolines::sample(slice, view, Sampling::new(samples)?, |row, values| {
        points.clear();
        points.extend(row.iter().map(|st| Vector(place(*st))));
        shape.distances(&points, values);
    })
}
