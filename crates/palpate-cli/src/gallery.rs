// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate gallery`: pictures of many shapes.

use std::fmt;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use palpate::field::catalogue::Entry;
use palpate::field::{Aabb, Shape, Vector};
use palpate::plot::{Figure, Isolines, PlaneView, PlotError, Sampling, Slice};
use palpate::scene::{AnyScene, Scene};
use rayon::prelude::*;
use serde::Serialize;

use crate::arguments::numbers::count;
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Files, shown};
use crate::picture::{self, Colours, Dimensions, Drawable, Picture};
use crate::plot::Map;

/// A scene with one body for each operator.
const OPERATORS: &str = include_str!("../scenes/sampler_operators.json");
/// Tiles in a row: with six, the longest names of the catalogue would not fit.
const COLUMNS: usize = 5;
/// Cells along a tile, about one to a pixel of the figure, and cells whose values are compared
/// with true distances.
const TILE_CELLS: [usize; 2] = [140, 70];
/// Room around a shape, as a share of its longest edge.
const MARGIN: f64 = 0.2;

/// A shape with its name.
struct Specimen<const D: usize> {
    name: String,
    shape: Shape<D>,
}

/// The options of a run, its progress bar, and its requests to end.
struct Work<'a> {
    options: &'a GalleryOptions,
    bar: ProgressBar,
    interrupt: &'a Interrupt,
}

pub(crate) fn run(options: &GalleryOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    picture::check_width(options.format, options.width)?;
    let planar = catalogue(Entry::<2>::ALL)?;
    let spatial = catalogue(Entry::<3>::ALL)?;
    let operators = operators()?;
    let planes = options.planes();
    let in_space = planes.len() * (spatial.len() + operators.len());
    let bar = ProgressBar::new((planar.len() + in_space) as u64).with_style(
        ProgressStyle::with_template("{msg} {bar:40} {pos}/{len}").map_err(Failure::input)?,
    );
    let work = Work { options, bar, interrupt };
    interrupt.heed();
    let mut written =
        work.draw("shapes-of-the-plane", "Shapes of the plane", &planar, |_| {
            Ok(Slice::planar())
        })?;
    for plane in planes {
        let through = |bounds: &Aabb<3>| plane.through(bounds.centre());
        let name = plane.name();
        for (stem, title, specimens) in [
            ("shapes-of-space", "Shapes of space", &spatial),
            ("operators", "Operators", &operators),
        ] {
            let title = format!("{title}, {} slices through their middle", name.to_uppercase());
            written.extend(work.draw(&format!("{stem}-{name}"), &title, specimens, through)?);
        }
    }
    work.bar.finish_and_clear();
    if options.json {
        let answer = Answer { map: options.map.name(), pictures: written };
        output::answer().json(&answer)?;
    }
    Ok(if interrupt.is_asked() {
        output::remark("interrupted: the pictures listed are complete, the others are missing");
        Outcome::Interrupted
    } else {
        Outcome::Yes
    })
}

/// The answer of `palpate gallery`.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Answer {
    /// What the pictures show: `distance`, `gradient` or `promise`.
    pub(crate) map: &'static str,
    /// The pictures.
    pub(crate) pictures: Vec<Written>,
}

/// A picture that was written.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Written {
    /// The file.
    pub(crate) output: String,
    /// The names of the shapes in it.
    pub(crate) shapes: Vec<String>,
}

impl fmt::Display for Written {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let output = shown(&self.output);
        match &self.shapes[..] {
            [name] => writeln!(f, "{output}: {name}"),
            names => writeln!(f, "{output}: {} pictures", names.len()),
        }
    }
}

/// Prints a line for each picture.
fn say(written: &[Written]) -> Result<(), Failure> {
    let mut out = output::answer();
    Ok(written.iter().try_for_each(|picture| write!(out, "{picture}"))?)
}

impl Work<'_> {
    /// Draws `specimens` on one sheet, and with `--each` on a picture each, and returns the
    /// finished pictures. An interrupted run writes no sheet, which would be incomplete.
    fn draw<const D: usize>(
        &self,
        stem: &str,
        title: &str,
        specimens: &[Specimen<D>],
        plane: impl Fn(&Aabb<D>) -> Result<Slice, PlotError> + Sync,
    ) -> Result<Vec<Written>, Failure>
    where
        Dimensions: Drawable<D>,
    {
        self.bar.set_message(stem.to_owned());
        let folder = &self.options.output;
        let each = folder.join(stem);
        let last = if self.options.each { &each } else { folder };
        output::make_folder(last)?;
        let sheet = self.picture(&folder.join(stem))?;
        let map = self.options.map;
        let drawn: Vec<(Isolines, Option<Written>)> = specimens
            .par_iter()
            .take_any_while(|_| !self.interrupt.is_asked())
            .filter_map(|specimen| self.draw_specimen(specimen, &plane, &each).transpose())
            .collect::<Result<_, Failure>>()?;
        let (tiles, single): (Vec<_>, Vec<_>) = drawn.into_iter().unzip();
        let mut written = Vec::new();
        if tiles.len() == specimens.len() {
            let figure =
                Figure::new(title).with_caption(caption(map)).with_sheet(COLUMNS, tiles);
            let shapes = specimens.iter().map(|specimen| specimen.name.clone()).collect();
            written.push(self.save(&figure, &sheet, shapes)?);
        }
        written.extend(single.into_iter().flatten());
        if !self.options.json {
            // A reader that closed the pipe, as `head` does, leaves no picture undone.
            self.bar.suspend(|| say(&written)).or_else(|failure| {
                if failure.is_closed_pipe() { Ok(()) } else { Err(failure) }
            })?;
        }
        Ok(written)
    }

    /// The tile of a specimen, and with `--each` its picture in the folder `each`; `None` if
    /// interrupted.
    fn draw_specimen<const D: usize>(
        &self,
        specimen: &Specimen<D>,
        plane: impl Fn(&Aabb<D>) -> Result<Slice, PlotError>,
        each: &Path,
    ) -> Result<Option<(Isolines, Option<Written>)>, Failure>
    where
        Dimensions: Drawable<D>,
    {
        let isolines = |grids: [Sampling; 2]| {
            specimen.picture(&plane, grids, self).map_err(Failure::input)
        };
        let sampling = |cells: usize| Sampling::new(cells).map_err(Failure::input);
        let [cells, compared] = TILE_CELLS;
        let tile = isolines([sampling(cells)?, sampling(compared)?])?;
        let Some(tile) = tile else { return Ok(None) };
        let tile = tile.with_title(&specimen.name);
        let mut written = None;
        if self.options.each {
            let compared = sampling(<Dimensions as Drawable<D>>::COMPARED)?;
            let whole = isolines([Sampling::default(), compared])?;
            let Some(whole) = whole else { return Ok(None) };
            let figure = Figure::new(specimen.name.replace('_', " "))
                .with_caption(specimen.shape.promise().in_words())
                .with_isolines(whole);
            let picture = self.picture(&each.join(specimen.name.replace(' ', "_")))?;
            written = Some(self.save(&figure, &picture, vec![specimen.name.clone()])?);
        }
        self.bar.inc(1);
        Ok(Some((tile, written)))
    }

    /// A picture at `path` with the ending of its format. Names differ and the run reads no
    /// file, so no output can overwrite another or an input.
    fn picture(&self, path: &Path) -> Result<Picture, Failure> {
        let path = path.with_extension(self.options.format.name());
        Picture::new(&mut Files::default(), &path)
    }

    fn save(
        &self,
        figure: &Figure,
        picture: &Picture,
        shapes: Vec<String>,
    ) -> Result<Written, Failure> {
        picture.save(figure, self.options.width.unwrap_or(picture::WIDTH))?;
        Ok(Written { output: picture.path().display().to_string(), shapes })
    }
}

impl<const D: usize> Specimen<D> {
    /// The shape in a square window around it, with grids for isolines and for comparisons;
    /// `None` if interrupted.
    fn picture(
        &self,
        plane: impl Fn(&Aabb<D>) -> Result<Slice, PlotError>,
        [sampling, grid]: [Sampling; 2],
        work: &Work<'_>,
    ) -> Result<Option<Isolines>, PlotError>
    where
        Dimensions: Drawable<D>,
    {
        let bounds = picture::shown_bounds(&self.shape);
        let plane = plane(&bounds)?;
        let view = Dimensions::view(&plane, &bounds, picture::MARGIN)?;
        let longest = bounds.half_extents().0.into_iter().fold(0.0, f64::max);
        let side = 2.0 * (1.0 + 2.0 * MARGIN) * longest;
        let view = PlaneView::new(view.center(), side, side)?;
        let isolines = picture::isolines(&self.shape, &plane, &view, sampling)?;
        let watch = || !work.interrupt.is_asked();
        let colours = Colours { map: work.options.map, grid, watch: &watch };
        picture::mapped(&self.shape, &plane, isolines, colours)
    }
}

fn catalogue<const D: usize>(entries: &[Entry<D>]) -> Result<Vec<Specimen<D>>, Failure> {
    let specimen = |entry: &Entry<D>| {
        let shape = entry.example().map_err(Failure::input)?;
        Ok(Specimen { name: entry.name.to_owned(), shape })
    };
    entries.iter().map(specimen).collect()
}

fn operators() -> Result<Vec<Specimen<3>>, Failure> {
    let world = Scene::from_json(OPERATORS).and_then(|scene| scene.build());
    match world.map_err(Failure::input)? {
        AnyScene::Spatial(scene) => Ok(scene
            .bodies
            .into_iter()
            .map(|body| Specimen { name: body.name, shape: body.shape_in_body })
            .collect()),
        AnyScene::Planar(_) => Ok(Vec::new()),
    }
}

fn caption(map: Map) -> &'static str {
    match map {
        Map::Distance => "Distances; each shape at its own scale, with a scale bar",
        Map::Gradient => "Directions of gradients; each shape at its own scale",
        Map::Promise => "Promises, and how values compare; each shape at its own scale",
    }
}

impl Plane {
    fn through(self, Vector([x, y, z]): Vector<f64, 3>) -> Result<Slice, PlotError> {
        match self {
            Self::Xy => Slice::xy(z),
            Self::Xz => Slice::xz(y),
            Self::Yz => Slice::yz(x),
        }
    }
}

pub(crate) const EXAMPLES: &str = "\
Examples:
  palpate gallery
  palpate gallery --output pictures --map promise --plane xy
  palpate gallery --each --format svg --json";

/// The options of `palpate gallery`.
#[derive(Args, Debug)]
pub(crate) struct GalleryOptions {
    /// The folder for the pictures; created if it is missing.
    #[arg(long, value_name = "DIR", default_value = "gallery")]
    pub(crate) output: PathBuf,
    /// What colours show.
    #[arg(long, value_enum, default_value_t = Map::Distance)]
    pub(crate) map: Map,
    /// The plane through the middle of each shape of space; xy and xz if left out. May be given
    /// more than once.
    #[arg(long, value_enum)]
    pub(crate) plane: Vec<Plane>,
    /// Also draw each shape as a picture of its own, in a folder beside its sheet.
    #[arg(long)]
    pub(crate) each: bool,
    /// The format of the pictures.
    #[arg(long, value_enum, default_value_t = Format::Png)]
    pub(crate) format: Format,
    /// The width of a PNG [pixels]; 1200 if left out.
    #[arg(long, allow_negative_numbers = true, value_parser = count(64, 16384_u32))]
    pub(crate) width: Option<u32>,
    /// Print what was drawn as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

impl GalleryOptions {
    /// The planes asked for, each once.
    pub(crate) fn planes(&self) -> Vec<Plane> {
        let all = [Plane::Xy, Plane::Xz, Plane::Yz];
        let asked = |plane: &Plane| match self.plane[..] {
            [] => *plane != Plane::Yz,
            _ => self.plane.contains(plane),
        };
        all.into_iter().filter(asked).collect()
    }
}

/// A plane along two axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Plane {
    /// Seen from the front.
    Xy,
    /// Seen from above.
    Xz,
    /// Seen from the side.
    Yz,
}

impl Plane {
    /// The name in commands and files.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Xy => "xy",
            Self::Xz => "xz",
            Self::Yz => "yz",
        }
    }
}

/// A kind of picture file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Pixels.
    Png,
    /// Lines and curves.
    Svg,
}

impl Format {
    /// The ending of its files.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Svg => "svg",
        }
    }
}
