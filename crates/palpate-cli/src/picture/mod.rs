// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Draws shapes, and writes picture files.

mod flat;
#[cfg(test)]
mod laws;

use std::path::Path;

use palpate::field::{Aabb, Pose, Rotation, Shape, Vector};
use palpate::plot::{Figure, Isolines, PlaneView, PlotError, Sampling, Slice};
use palpate::scene::{AnyScene, BuiltScene};

use crate::gallery::Format;
use crate::outcome::Failure;
use crate::output::{self, Destination, Files};
use crate::plot::Map;

use flat::slopes;
pub(crate) use flat::{isolines, noted, outline, scene, values};

/// Room around a scene, as a share of its longer side.
pub(crate) const MARGIN: f64 = 0.15;

/// The range shown of a shape without bounds, along each axis [m]: about the size of the
/// examples of the catalogue, with more below, where the infinite cone is.
const UNBOUNDED: [f64; 2] = [-1.2, 0.8];

/// The box around a shape, or a part of a shape without bounds.
pub(crate) fn shown_bounds<const D: usize>(shape: &Shape<D>) -> Aabb<D> {
    let [min, max] = UNBOUNDED.map(Vector::constant);
    shape.promise().bounds.map_or(Aabb { min, max }, |bounds| bounds.aabb)
}

/// The width of a PNG where none is asked for [pixels].
pub(crate) const WIDTH: u32 = 1200;

/// A dimension whose shapes can be drawn.
pub(crate) trait Drawable<const D: usize> {
    /// The window that shows `bounds` on `plane`, with a margin of `margin` times its longer
    /// side.
    fn view(plane: &Slice, bounds: &Aabb<D>, margin: f64) -> Result<PlaneView, PlotError>;

    /// The point of space at plane coordinates.
    fn point(plane: &Slice, st: [f64; 2]) -> Vector<f64, D>;

    /// Cells along the longer side of a picture at which values are compared with true distances:
    /// as many as samples in the plane, and fewer in space, where searches take longer.
    const COMPARED: usize;

    /// The parts of a gradient to the right, up, and towards the viewer.
    fn gradient(plane: &Slice, gradient: Vector<f64, D>) -> [f64; 3];

    /// How cells of the picture lie in space: the rotation from the picture's axes, `None` if
    /// these run along axes of space, and half the edges of a cell for which they are one.
    fn cells(plane: &Slice) -> (Option<Rotation<D>>, Vector<f64, D>);

    /// The scene, if it is of this dimension.
    fn scene(scene: AnyScene) -> Option<BuiltScene<D>>;
}

/// Marks the dimension of a shape.
pub(crate) struct Dimensions;

impl Drawable<2> for Dimensions {
    fn view(_: &Slice, bounds: &Aabb<2>, margin: f64) -> Result<PlaneView, PlotError> {
        PlaneView::from_bounds(bounds.min.0, bounds.max.0, margin)
    }

    fn point(_: &Slice, st: [f64; 2]) -> Vector<f64, 2> {
        Vector(st)
    }

    const COMPARED: usize = 420;

    fn gradient(_: &Slice, Vector([x, y]): Vector<f64, 2>) -> [f64; 3] {
        [x, y, 0.0]
    }

    fn cells(_: &Slice) -> (Option<Rotation<2>>, Vector<f64, 2>) {
        (None, Vector::constant(1.0))
    }

    fn scene(scene: AnyScene) -> Option<BuiltScene<2>> {
        match scene {
            AnyScene::Planar(scene) => Some(scene),
            AnyScene::Spatial(_) => None,
        }
    }
}

impl Drawable<3> for Dimensions {
    fn view(plane: &Slice, bounds: &Aabb<3>, margin: f64) -> Result<PlaneView, PlotError> {
        PlaneView::of_box(plane, bounds.min.0, bounds.max.0, margin)
    }

    fn point(plane: &Slice, st: [f64; 2]) -> Vector<f64, 3> {
        Vector(plane.point(st))
    }

    const COMPARED: usize = 128;

    fn gradient(plane: &Slice, gradient: Vector<f64, 3>) -> [f64; 3] {
        plane.project_gradient(gradient.0)
    }

    fn cells(plane: &Slice) -> (Option<Rotation<3>>, Vector<f64, 3>) {
        let axes = plane.directions();
        let runs_along = |axis: [f64; 3]| axis.iter().filter(|x| **x != 0.0).count() == 1;
        let is_straight = axes.into_iter().all(runs_along);
        match Rotation::from_rows(std::array::from_fn(|k| axes.map(|axis| axis[k]))) {
            Ok(_) if is_straight => (None, Vector(plane.normal().map(|x| 1.0 - x.abs()))),
            Ok(turn) => (Some(turn), Vector([1.0, 1.0, 0.0])),
            // The axes of a slice are orthonormal; a box that holds any cell is right too.
            Err(_) => (None, Vector::constant(std::f64::consts::SQRT_2)),
        }
    }

    fn scene(scene: AnyScene) -> Option<BuiltScene<3>> {
        match scene {
            AnyScene::Spatial(scene) => Some(scene),
            AnyScene::Planar(_) => None,
        }
    }
}

/// The closed line in which a plane cuts a box that is placed in the world; `None` if it does not.
pub(crate) fn cut<const D: usize>(
    aabb: &Aabb<D>,
    world_from_box: &Pose<D>,
    plane: &Slice,
) -> Option<Vec<[f64; 2]>> {
    let corner = |code: usize| {
        let mut p = aabb.min;
        for k in (0..D).filter(|k| code >> k & 1 == 1) {
            p[k] = aabb.max[k];
        }
        in_space(world_from_box.transform_point(p))
    };
    let mut outline = if D == 2 {
        [0, 1, 3, 2].map(|code| plane.project(corner(code))).to_vec()
    } else {
        plane.cut(std::array::from_fn(corner))
    };
    outline.push(*outline.first()?);
    Some(outline)
}

/// A point of the plane or of space, as a point of space.
pub(crate) fn in_space<const D: usize>(point: Vector<f64, D>) -> [f64; 3] {
    point.in_space().0
}

/// What the colours of a picture show, and how it is found.
#[derive(Clone, Copy)]
pub(crate) struct Colours<'a> {
    pub(crate) map: Map,
    /// Where values are compared with true distances.
    pub(crate) grid: Sampling,
    /// Is told of each of these places, and says whether to go on.
    pub(crate) watch: &'a (dyn Fn() -> bool + Sync),
}

/// The picture of `shape` on `plane` with these colours; `None` if it is ended before.
pub(crate) fn mapped<const D: usize>(
    shape: &Shape<D>,
    plane: &Slice,
    isolines: Isolines,
    colours: Colours<'_>,
) -> Result<Option<Isolines>, PlotError>
where
    Dimensions: Drawable<D>,
{
    match colours.map {
        Map::Distance => Ok(Some(isolines)),
        Map::Gradient => isolines.with_gradient(slopes(shape, plane)).map(Some),
        Map::Promise => flat::with_promise(shape, plane, isolines, colours),
    }
}

/// Refuses a width in pixels for a format without pixels.
pub(crate) fn check_width(format: Format, width: Option<u32>) -> Result<(), Failure> {
    match (format, width) {
        (Format::Svg, Some(_)) => {
            Err(Failure::input("--width is for PNG pictures; an SVG is drawn at any width"))
        }
        _ => Ok(()),
    }
}

/// A picture file to be written.
#[derive(Debug)]
pub(crate) struct Picture {
    destination: Destination,
    format: Format,
}

impl Picture {
    /// A picture at `path`, in the format of its ending, as an output of the run of `files`.
    pub(crate) fn new(files: &mut Files, path: &Path) -> Result<Self, Failure> {
        let format = match output::ending(path).as_str() {
            "svg" => Format::Svg,
            "png" => Format::Png,
            _ => {
                let problem = "the name of a picture must end in .svg or .png";
                return Err(Failure::file(path, problem));
            }
        };
        Ok(Self { destination: files.output(path)?, format })
    }

    /// The path that the command line gave.
    pub(crate) fn path(&self) -> &Path {
        self.destination.name()
    }

    /// Refuses a width in pixels for a picture without pixels.
    pub(crate) fn check_width(&self, width: Option<u32>) -> Result<(), Failure> {
        check_width(self.format, width)
    }

    /// Writes `figure`; as a PNG, `width` pixels wide.
    pub(crate) fn save(&self, figure: &Figure, width: u32) -> Result<(), Failure> {
        let bytes = match self.format {
            Format::Svg => figure.to_svg().into_bytes(),
            Format::Png => figure.to_png(width).map_err(Failure::input)?,
        };
        self.destination.write(|out| Ok(out.write_all(&bytes)?))
    }
}
