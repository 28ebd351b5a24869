// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate plot`: draws isolines, gradients and promises on a plane.

use std::io::Write;
use std::path::{Path, PathBuf};

use indicatif::{ProgressBar, ProgressStyle};
use palpate::field::{Aabb, LARGEST_LENGTH, Vector};
use palpate::plot::{Figure, Isolines, Measured, PlotError, Sampling, Slice, View};
use palpate::scene::{AnyScene, BuiltScene};
use serde_json::{Value, json};

use crate::arguments::{Map, PlotOptions};
use crate::contact::Touched;
use crate::input::{self, promise_in_words};
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Files, shown};
use crate::picture::{self, Colours, Dimensions, Drawable, Picture};

pub(crate) fn run(options: &PlotOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    let mut files = Files::reading([options.scene.as_path()]);
    let picture = Picture::new(&mut files, &output(options))?;
    let named = input::scene(Some(&options.scene))?;
    match &named.scene {
        AnyScene::Planar(scene) => {
            Plot::of(options, &picture, scene)?.draw(&Slice::planar(), interrupt)
        }
        AnyScene::Spatial(scene) => {
            let plot = Plot::of(options, &picture, scene)?;
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
            if !(size > 0.0 && size <= LARGEST_LENGTH) {
                let rule = format!("positive and at most {LARGEST_LENGTH:e} m, got {size:?} m");
                return Err(Failure::input(format!("--size must be {rule}")));
            }
            let centre = input::point::<D>(centre)?;
            let half = Vector::constant(0.5 * size);
            let bounds = Aabb { min: centre - half, max: centre + half };
            return Ok(Self { bounds, margin: 0.0 });
        }
        let whole =
            input::bounds(scene).unwrap_or_else(|_| Aabb::centred(Vector::constant(0.5)));
        Ok(Self { bounds: whole, margin: picture::MARGIN })
    }
}

/// A scene and what to draw of it.
struct Plot<'a, const D: usize> {
    options: &'a PlotOptions,
    picture: &'a Picture,
    scene: &'a BuiltScene<D>,
    window: Window<D>,
    touched: Option<Touched<D>>,
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
        if options.step.is_some() && options.map != Map::Distance {
            return Err(Failure::input(
                "--step is only for --map distance: other maps have no isolines",
            ));
        }
        let window = Window::of(options, scene)?;
        let touched = touched(options, scene)?;
        Ok(Self { options, picture, scene, window, touched })
    }

    /// Draws the scene on `plane`, and reports the picture.
    fn draw(&self, plane: &Slice, interrupt: &Interrupt) -> Result<Outcome, Failure> {
        let Self { options, scene, window, .. } = self;
        let view = Dimensions::view(plane, &window.bounds, window.margin);
        let view = view.map_err(Failure::input)?;
        let isolines = self.isolines(plane, &view, interrupt).map_err(Failure::input)?;
        let Some(isolines) = isolines else {
            output::remark("interrupted: there is no picture");
            return Ok(Outcome::Interrupted);
        };
        let drawn = Drawn {
            step: isolines.step(),
            range: isolines.range(),
            measured: isolines.measured(),
        };
        let isolines = match &self.touched {
            Some(touched) => touched.draw(isolines, plane)?,
            None => isolines,
        };
        let figure = Figure::new(title(&options.scene))
            .with_caption(promise_in_words(scene.whole.promise()))
            .with_isolines(isolines);
        self.picture.save(&figure, options.width)?;
        if options.json {
            output::answer().json(&self.described(&drawn, plane))?;
        } else {
            let name = self.picture.path().display().to_string();
            writeln!(output::answer(), "{}: {}", shown(&name), self.in_words(&drawn))?;
        }
        Ok(Outcome::Yes)
    }

    /// The isolines or what is in their place; `None` if interrupted.
    fn isolines(
        &self,
        plane: &Slice,
        view: &View,
        interrupt: &Interrupt,
    ) -> Result<Option<Isolines>, PlotError> {
        let Self { options, scene, .. } = self;
        let isolines = picture::scene(scene, plane, view)?;
        if let Some(step) = options.step {
            return isolines.with_step(step).map(Some);
        }
        let grid = Sampling::new(<Dimensions as Drawable<D>>::COMPARED)?;
        let bar = bar(isolines.compared_places(grid).len());
        interrupt.heed();
        let watch = || {
            bar.inc(1);
            !interrupt.is_asked()
        };
        let colours = Colours { map: options.map, grid, watch: &watch };
        let mapped = picture::mapped(&scene.whole, plane, isolines, colours);
        bar.finish_and_clear();
        mapped
    }

    fn described(&self, drawn: &Drawn, plane: &Slice) -> Value {
        let mut answer = json!({
            "output": self.picture.path(),
            "map": self.options.map.name(),
            "smallest_m": drawn.range.0,
            "largest_m": drawn.range.1,
        });
        if self.options.map == Map::Distance {
            answer["step_m"] = json!(drawn.step);
        }
        let point = |st| <Dimensions as Drawable<D>>::point(plane, st).0.to_vec();
        if let Some(measured) = &drawn.measured {
            answer["value_over_distance"] = json!({
                "smallest": measured.smallest,
                "smallest_at_m": point(measured.smallest_at),
                "largest": measured.largest,
                "largest_at_m": point(measured.largest_at),
                "open_share": measured.open,
            });
        }
        if let Some(touched) = &self.touched {
            let (touching, boxes) = touched.counts();
            answer["touching_pairs"] = json!(touching);
            answer["proof_boxes"] = json!(boxes);
        }
        answer
    }

    fn in_words(&self, drawn: &Drawn) -> String {
        match (self.options.map, &drawn.measured) {
            (Map::Distance, _) => format!("isolines every {} m", drawn.step),
            (Map::Gradient, _) => "directions of the gradient".to_owned(),
            (Map::Promise, None) => "promises; value over distance is open".to_owned(),
            (Map::Promise, Some(Measured { smallest, largest, open, .. })) => {
                let open = if *open > 0.0 {
                    format!(", open in {:.1} % of the picture", 100.0 * open)
                } else {
                    String::new()
                };
                format!(
                    "promises; value over distance from {smallest:.3} to {largest:.3}{open}"
                )
            }
        }
    }
}

/// The numbers of a picture.
struct Drawn {
    /// Between isolines [m].
    step: f64,
    /// The smallest and the largest value [m].
    range: (f64, f64),
    /// The extremes of the value over the true distance.
    measured: Option<Measured>,
}

/// The progress of comparisons, which is hidden unless standard error is a terminal.
fn bar(places: usize) -> ProgressBar {
    ProgressBar::new(places as u64).with_style(
        ProgressStyle::with_template("true distances {bar:40} {percent} %, {eta} left")
            .unwrap_or_else(|_| ProgressStyle::default_bar()),
    )
}

fn output(options: &PlotOptions) -> PathBuf {
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
    let at = |axis: usize| options.at.unwrap_or(middle[axis]);
    match options.plane.as_str() {
        "xy" => Slice::xy(at(2)),
        "xz" => Slice::xz(at(1)),
        "yz" => Slice::yz(at(0)),
        free => {
            let points: Vec<_> =
                free.split(':').map(input::point::<3>).collect::<Result<_, _>>()?;
            let [origin, right, up] = points.try_into().map_err(|_| {
                let rule = "xy, xz, yz, or origin:right:up, each of these three numbers joined by commas";
                Failure::input(format!("--plane must be {rule}, got {free:?}"))
            })?;
            Slice::free(origin.0, right.0, up.0)
        }
    }
    .map_err(Failure::input)
}
