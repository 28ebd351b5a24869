// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate plot`: draws a scene.

use std::fmt;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use palpate::field::{Aabb, Vector};
use palpate::plot::{Figure, Isolines, Measured, PlaneView, PlotError, Sampling, Slice};
use palpate::scene::{AnyScene, BuiltScene, WrittenView};
use serde::Serialize;

use crate::arguments::Reading;
use crate::arguments::numbers::{coordinate, count, length, zero_or_more};
use crate::contact::{ContactQuestion, Touched};
use crate::error_map::Compared;
use crate::interrupt::{self, Interrupt};
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Files, shown};
use crate::picture::{self, Colours, Dimensions, Drawable, Picture};
use crate::{emptiness, input, plane, views};

pub(crate) fn run(options: &PlotOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    let inputs = [Some(options.scene.as_path()), options.against.as_deref()];
    let mut files = Files::reading(inputs.into_iter().flatten(), options.reading);
    let picture = Picture::new(&mut files, &output_path(options))?;
    picture.check_width(options.width)?;
    options.question.refuse_unless(options.contacts)?;
    let named = input::scene(Some(&options.scene), options.reading)?;
    match &named.scene {
        AnyScene::Planar(scene) => {
            let in_space = [
                ("--plane", options.plane.as_deref().is_some_and(|plane| plane != "xy")),
                ("--at", options.at.is_some()),
            ];
            if let Some((option, _)) = in_space.iter().find(|(_, is_given)| *is_given) {
                let problem =
                    "is for scenes in space; this scene is in the plane, and drawn whole";
                return Err(Failure::input(format!("{option} {problem}")));
            }
            let scene = views::at(scene, options.time)?;
            Plot::of(options, &picture, &scene)?.draw(&Slice::planar(), interrupt)
        }
        AnyScene::Spatial(scene) => {
            let scene = views::at(scene, options.time)?;
            let plot = Plot::of(options, &picture, &scene)?;
            if let Some(view) = plot.named {
                return plot.draw(&views::plane(view)?, interrupt);
            }
            let deepest = plot.touched.as_ref().and_then(Touched::deepest);
            let deepest = deepest.filter(|_| options.centre.is_none());
            let through = deepest.unwrap_or_else(|| plot.window.bounds.centre());
            plot.draw(&plane(options, through)?, interrupt)
        }
    }
}

/// The contacts, if `--contacts` asks for them.
fn touched<const D: usize>(
    options: &PlotOptions,
    scene: &BuiltScene<D>,
) -> Result<Option<Touched<D>>, Failure> {
    let find = || Touched::find(&options.question, scene, options.proof);
    options.contacts.then(find).transpose()
}

/// The part of the scene that the picture shows.
struct Window<const D: usize> {
    bounds: Aabb<D>,
    /// Room around the bounds, as a share of their longer side.
    margin: f64,
}

impl<const D: usize> Window<D> {
    /// A square about `--centre`; else the scene's box, or a metre about the origin if no body
    /// has bounds.
    fn of(options: &PlotOptions, scene: &BuiltScene<D>) -> Result<Self, Failure> {
        if let (Some(centre), Some(size)) = (&options.centre, options.size) {
            let bounds = square(input::point::<D>(centre)?, size);
            return Ok(Self { bounds, margin: 0.0 });
        }
        let whole =
            input::bounds(scene).unwrap_or_else(|_| Aabb::centred(Vector::constant(0.5)));
        Ok(Self { bounds: whole, margin: picture::MARGIN })
    }
}

/// A square about `centre`, or a cube, with edges of the length of `--size` [m].
pub(crate) fn square<const D: usize>(centre: Vector<f64, D>, size: f64) -> Aabb<D> {
    let half = Vector::constant(0.5 * size);
    Aabb { min: centre - half, max: centre + half }
}

/// A scene and what to draw of it.
struct Plot<'a, const D: usize> {
    options: &'a PlotOptions,
    picture: &'a Picture,
    scene: &'a BuiltScene<D>,
    window: Window<D>,
    /// The view of the scene that was asked for.
    named: Option<&'a WrittenView>,
    touched: Option<Touched<D>>,
    compared: Compared<'a, D>,
}

impl<'a, const D: usize> Plot<'a, D>
where
    Dimensions: Drawable<D>,
{
    /// Prepares a scene for the options.
    fn of(
        options: &'a PlotOptions,
        picture: &'a Picture,
        scene: &'a BuiltScene<D>,
    ) -> Result<Self, Failure> {
        if options.step.is_some() && options.map != PlotMap::Distance {
            return Err(Failure::input(
                "--step is only for --map distance: other maps have no isolines",
            ));
        }
        if !options.contacts {
            emptiness::warn(scene);
        }
        let compared = Compared::of(options, scene)?;
        let window = Window::of(options, scene)?;
        let named =
            options.view.as_deref().map(|name| views::named(scene, name)).transpose()?;
        let touched = touched(options, scene)?;
        Ok(Self { options, picture, scene, window, named, touched, compared })
    }

    /// The window of the picture; what a view of the scene leaves out shows the whole scene.
    fn view(&self, plane: &Slice) -> Result<PlaneView, Failure> {
        let whole = Dimensions::view(plane, &self.window.bounds, self.window.margin);
        let whole = whole.map_err(Failure::input)?;
        let Some(named) = self.named else { return Ok(whole) };
        let centre = named.center.unwrap_or(whole.center());
        let width = named.width.unwrap_or(whole.width());
        let height = named.height.unwrap_or(whole.height());
        PlaneView::new(centre, width, height).map_err(Failure::input)
    }

    /// The distance between isolines, if one is asked for [m].
    fn step(&self) -> Option<f64> {
        let of_view = self.named.and_then(|view| view.spacing);
        self.options.step.or(of_view.filter(|_| self.options.map == PlotMap::Distance))
    }

    /// Draws the scene on `plane`, and reports the picture.
    fn draw(&self, plane: &Slice, interrupt: &Interrupt) -> Result<Outcome, Failure> {
        let options = self.options;
        let view = self.view(plane)?;
        let isolines = self.isolines(plane, &view, interrupt).map_err(Failure::input)?;
        let Some(isolines) = isolines else {
            output::remark("interrupted: there is no picture");
            return Ok(Outcome::Interrupted);
        };
        let answer = self.answer(&isolines, plane);
        let isolines = match &self.touched {
            Some(touched) => touched.draw(isolines, plane)?,
            None => isolines,
        };
        let figure = Figure::new(title(&options.scene))
            .with_caption(self.caption(plane))
            .with_isolines(isolines);
        self.picture.save(&figure, options.width.unwrap_or(picture::WIDTH))?;
        output::answer().print(&answer, options.json)?;
        Ok(Outcome::Yes)
    }

    /// The isolines or what is in their place; `None` if interrupted.
    fn isolines(
        &self,
        plane: &Slice,
        view: &PlaneView,
        interrupt: &Interrupt,
    ) -> Result<Option<Isolines>, PlotError> {
        let isolines = picture::scene(self.scene, plane, view)?;
        if let Some(step) = self.step() {
            return isolines.with_step(step).map(Some);
        }
        let (shape, map) = (&self.scene.whole, self.options.map);
        interrupt.heed();
        match (&self.compared, map.of_one_field()) {
            (Compared::Nothing, Some(map)) => {
                let grid = Sampling::new(<Dimensions as Drawable<D>>::COMPARED)?;
                let bar = interrupt::bar();
                bar.inc_length(isolines.compared_places(grid).len() as u64);
                let watch = || {
                    bar.inc(1);
                    !interrupt.is_asked()
                };
                let colours = Colours { map, grid, watch: &watch };
                let mapped = picture::mapped(shape, plane, isolines, colours);
                bar.finish_and_clear();
                mapped
            }
            (compared, _) => compared.draw(map, shape, isolines, plane).map(Some),
        }
    }

    /// Where the plane is, the time, the promise, and what the field is compared with.
    fn caption(&self, plane: &Slice) -> String {
        let place = (D == 3).then(|| plane::in_words(plane));
        let time =
            (!self.scene.motions.is_empty()).then(|| format!("at {} s", self.options.time));
        let promise = self.scene.whole.promise().in_words();
        let said = [place, time, Some(promise), self.compared.in_words()];
        said.into_iter().flatten().collect::<Vec<_>>().join("; ")
    }

    /// The answer about a picture.
    fn answer(&self, isolines: &Isolines, plane: &Slice) -> Answer {
        let (smallest, largest) = isolines.range();
        let place = |st| <Dimensions as Drawable<D>>::point(plane, st).0.to_vec();
        let extremes = |measured: Measured| Extremes {
            smallest: measured.smallest,
            smallest_at: place(measured.smallest_at),
            largest: measured.largest,
            largest_at: place(measured.largest_at),
            open: measured.open,
        };
        let (map, measured) = (self.options.map, isolines.measured().map(extremes));
        let is_difference = matches!(self.compared, Compared::Other(_));
        let counts = self.touched.as_ref().map(Touched::counts);
        let mut answer = Answer {
            output: self.picture.path().display().to_string(),
            map: map.name(),
            smallest,
            largest,
            step: (map == PlotMap::Distance).then(|| isolines.step()),
            value_over_distance: None,
            error_degrees: None,
            difference: None,
            touching: counts.map(|(touching, _)| touching),
            boxes: counts.map(|(_, boxes)| boxes),
            shown: map,
            is_difference,
        };
        *match map {
            PlotMap::Error if is_difference => &mut answer.difference,
            PlotMap::Error => &mut answer.error_degrees,
            _ => &mut answer.value_over_distance,
        } = measured;
        answer
    }
}

/// The answer of `palpate plot`.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Answer {
    /// The file.
    pub(crate) output: String,
    /// What the picture shows: `distance`, `gradient`, `promise` or `error`.
    pub(crate) map: &'static str,
    /// The smallest value that was sampled [m].
    pub(crate) smallest: f64,
    /// The largest value that was sampled [m].
    pub(crate) largest: f64,
    /// Between isolines [m]; `null` where there are none.
    pub(crate) step: Option<f64>,
    /// With `--map promise` values over true distances; `null` if all are open.
    pub(crate) value_over_distance: Option<Extremes>,
    /// With `--map error --gradient` angles from the exact gradient [degrees].
    pub(crate) error_degrees: Option<Extremes>,
    /// With `--map error --against` differences of values [m].
    pub(crate) difference: Option<Extremes>,
    /// With `--contacts` how many pairs touch.
    pub(crate) touching: Option<usize>,
    /// With `--contacts` how many boxes prove that pairs are apart.
    pub(crate) boxes: Option<usize>,
    #[serde(skip)]
    shown: PlotMap,
    #[serde(skip)]
    is_difference: bool,
}

/// The extremes of what the colours of a picture show.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Extremes {
    /// The smallest number.
    pub(crate) smallest: f64,
    /// The first place where it was found [m].
    pub(crate) smallest_at: Vec<f64>,
    /// The largest number.
    pub(crate) largest: f64,
    /// The first place where it was found [m].
    pub(crate) largest_at: Vec<f64>,
    /// The share of the picture without a number.
    pub(crate) open: f64,
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", shown(&self.output))?;
        let measured = self.value_over_distance.as_ref().or(self.error_degrees.as_ref());
        match (self.shown, measured.or(self.difference.as_ref())) {
            (PlotMap::Distance, _) => {
                writeln!(f, "isolines every {} m", self.step.unwrap_or_default())
            }
            (PlotMap::Gradient, _) => writeln!(f, "directions of the gradient"),
            (PlotMap::Promise, None) => writeln!(f, "promises; value over distance is open"),
            (PlotMap::Promise, Some(Extremes { smallest, largest, open, .. })) => {
                let open = if *open > 0.0 {
                    format!(", open in {:.1} % of the picture", 100.0 * open)
                } else {
                    String::new()
                };
                writeln!(
                    f,
                    "promises; value over distance from {smallest:.3} to {largest:.3}{open}"
                )
            }
            (PlotMap::Error, None) => writeln!(f, "errors: there is no direction in view"),
            (PlotMap::Error, Some(Extremes { smallest, largest, .. })) => {
                let (what, unit) = if self.is_difference {
                    ("differences of values", "m")
                } else {
                    ("angles from the exact gradient", "degrees")
                };
                writeln!(f, "{what} from {smallest:.6} to {largest:.6} {unit}")
            }
        }
    }
}

/// The file of `--output`; the scene's name with .svg if left out.
fn output_path(options: &PlotOptions) -> PathBuf {
    options.output.clone().unwrap_or_else(|| {
        let stem = options.scene.file_stem().unwrap_or_default();
        PathBuf::from(stem).with_extension("svg")
    })
}

/// The scene's name as a title.
pub(crate) fn title(scene: &Path) -> String {
    scene.file_stem().unwrap_or_default().to_string_lossy().replace('_', " ")
}

/// The plane of `--plane`; one along two axes goes through `middle` unless `--at` is given.
fn plane(options: &PlotOptions, middle: Vector<f64, 3>) -> Result<Slice, Failure> {
    let plane = options.plane.as_deref().unwrap_or("xy");
    if options.at.is_some() && (options.centre.is_some() || plane.contains(':')) {
        let other = if options.centre.is_some() { "--centre" } else { "--plane" };
        let problem = "both say where the plane is; leave out --at";
        return Err(Failure::input(format!("--at and the point of {other} {problem}")));
    }
    plane::named("--plane", plane, options.at, middle)
}

pub(crate) const EXAMPLES: &str = "\
Examples:
  palpate plot scenes/memoir_star.json
  palpate plot scenes/s3.json --plane xz --at 0.1 --output s3.png
  palpate plot scenes/s3.json --plane 0,0,0:1,0,0:0,1,1 --step 0.05
  palpate plot scenes/gears.json --centre 0.033,0 --size 0.02 --output mesh.png
  palpate plot scenes/nut_on_bolt.json --view thread
  palpate plot scenes/bayonet.json --time 1.4
  palpate plot scenes/memoir_star.json --map gradient --output gradient.png
  palpate plot scenes/memoir_star.json --map promise --output promise.png
  palpate plot scenes/memoir_star.json --map error --gradient dichotomy --output error.png
  palpate plot scenes/s2.json --map error --against scenes/s3.json --output difference.png
  palpate plot scenes/peg_in_hole.json --contacts --proof --output proof.png";

/// The options of `palpate plot`.
#[derive(Args, Debug)]
pub(crate) struct PlotOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    /// A view of the scene: its plane, its window and its isolines.
    #[arg(long, value_name = "NAME", conflicts_with_all = ["plane", "at", "centre", "size"])]
    pub(crate) view: Option<String>,
    /// The plane in space: xy, xz, yz, or three points as origin:right:up, each
    /// x,y,z; xy if left out.
    #[arg(long, allow_hyphen_values = true)]
    pub(crate) plane: Option<String>,
    /// The third coordinate of a plane along two axes [m].
    #[arg(long, allow_negative_numbers = true, value_parser = coordinate)]
    pub(crate) at: Option<f64>,
    /// The point in the middle of the picture, x,y or x,y,z [m]; the picture shows the whole
    /// scene if left out. A plane along two axes goes through this point.
    #[arg(long, requires = "size", allow_hyphen_values = true)]
    pub(crate) centre: Option<String>,
    /// Width and height of the part of the scene that is shown [m].
    #[arg(long, requires = "centre", allow_negative_numbers = true, value_parser = length)]
    pub(crate) size: Option<f64>,
    /// Where bodies are at this time [s], if the scene has motions.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, value_parser = zero_or_more("s"))]
    pub(crate) time: f64,
    /// What colours show.
    #[arg(long, value_enum, default_value_t = PlotMap::Distance)]
    pub(crate) map: PlotMap,
    /// The other scene of --map error, whose field is compared with this one.
    #[arg(long, value_name = "SCENE")]
    pub(crate) against: Option<PathBuf>,
    /// How gradients are found, for --map gradient and --map error: closest_vector, differences,
    /// dichotomy or adaptive_dichotomy (in the plane), exact.
    #[arg(long, value_name = "METHOD")]
    pub(crate) gradient: Option<String>,
    /// How far from a point --gradient compares values [m]; five millionths of the longest edge of
    /// the scene's box if left out.
    #[arg(long, requires = "gradient", allow_negative_numbers = true, value_parser = length)]
    pub(crate) offset: Option<f64>,
    /// Round the values that --gradient compares to single precision.
    #[arg(long, requires = "gradient")]
    pub(crate) single: bool,
    /// The distance between isolines [m], instead of that of the view; only for --map distance.
    #[arg(long, allow_negative_numbers = true, value_parser = length)]
    pub(crate) step: Option<f64>,
    /// Draw contacts, normals, and the shortest segments between bodies that are apart. A plane
    /// along two axes goes through the deepest contact unless --at or --centre says where.
    #[arg(long)]
    pub(crate) contacts: bool,
    /// Draw the proof: the boxes that the search ruled out.
    #[arg(long, requires = "contacts")]
    pub(crate) proof: bool,
    #[command(flatten)]
    pub(crate) question: ContactQuestion,
    /// The picture, .svg or .png; the scene's name with .svg if left out.
    #[arg(long)]
    pub(crate) output: Option<PathBuf>,
    /// The width of a PNG [pixels]; 1200 if left out.
    #[arg(long, allow_negative_numbers = true, value_parser = count(64, 16384_u32))]
    pub(crate) width: Option<u32>,
    /// Print what was drawn as JSON.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) reading: Reading,
}

/// What the colours of a picture of a field show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Map {
    /// Bands of distance with isolines.
    Distance,
    /// The direction of the gradient, and where its length is not one.
    Gradient,
    /// The promise of each side, and the value over the true distance, which is searched.
    Promise,
}

impl Map {
    /// The name in commands and answers.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Distance => "distance",
            Self::Gradient => "gradient",
            Self::Promise => "promise",
        }
    }
}

/// What the colours of a picture show, also beside something else.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PlotMap {
    /// Bands of distance with isolines.
    Distance,
    /// The direction of the gradient, and where its length is not one.
    Gradient,
    /// The promise of each side, and the value over the true distance, which is searched.
    Promise,
    /// The difference of two fields (--against), or the angle between a gradient (--gradient) and
    /// the exact one.
    Error,
}

impl PlotMap {
    /// The map of a field alone; `None` of an error.
    pub(crate) fn of_one_field(self) -> Option<Map> {
        match self {
            Self::Distance => Some(Map::Distance),
            Self::Gradient => Some(Map::Gradient),
            Self::Promise => Some(Map::Promise),
            Self::Error => None,
        }
    }

    /// The name in commands and answers.
    pub(crate) fn name(self) -> &'static str {
        self.of_one_field().map_or("error", Map::name)
    }
}
