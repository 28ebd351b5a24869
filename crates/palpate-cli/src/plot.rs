// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate plot`: draws isolines, gradients and promises on a plane.

use std::io::Write;
use std::path::{Path, PathBuf};

use palpate::field::{Aabb, Vector};
use palpate::plot::{Figure, Isolines, Measured, PlaneView, PlotError, Sampling, Slice};
use palpate::scene::{AnyScene, BuiltScene, WrittenView};
use serde_json::{Value, json};

use crate::arguments::{PlotMap, PlotOptions};
use crate::contact::Touched;
use crate::emptiness;
use crate::error_map::Compared;
use crate::input;
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Files, shown};
use crate::picture::{self, Colours, Dimensions, Drawable, Picture};
use crate::{plane, progress, views};

pub(crate) fn run(options: &PlotOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    let inputs = [Some(options.scene.as_path()), options.against.as_deref()];
    let mut files = Files::reading(inputs.into_iter().flatten());
    let picture = Picture::new(&mut files, &output_path(options))?;
    picture.check_width(options.width)?;
    options.question.refuse_unless(options.contacts)?;
    let named = input::scene(Some(&options.scene))?;
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
            .with_caption(self.caption(plane))
            .with_isolines(isolines);
        self.picture.save(&figure, options.width.unwrap_or(picture::WIDTH))?;
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
                let bar = progress::bar();
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

    fn described(&self, drawn: &Drawn, plane: &Slice) -> Value {
        let mut answer = json!({
            "output": self.picture.path(),
            "map": self.options.map.name(),
            "smallest_m": drawn.range.0,
            "largest_m": drawn.range.1,
        });
        if self.options.map == PlotMap::Distance {
            answer["step_m"] = json!(drawn.step);
        }
        let point = |st| <Dimensions as Drawable<D>>::point(plane, st).0.to_vec();
        if let Some(measured) = &drawn.measured {
            answer[self.measured_key()] = json!({
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
            (PlotMap::Distance, _) => format!("isolines every {} m", drawn.step),
            (PlotMap::Gradient, _) => "directions of the gradient".to_owned(),
            (PlotMap::Promise, None) => "promises; value over distance is open".to_owned(),
            (PlotMap::Promise, Some(Measured { smallest, largest, open, .. })) => {
                let open = if *open > 0.0 {
                    format!(", open in {:.1} % of the picture", 100.0 * open)
                } else {
                    String::new()
                };
                format!(
                    "promises; value over distance from {smallest:.3} to {largest:.3}{open}"
                )
            }
            (PlotMap::Error, None) => "errors: there is no direction in view".to_owned(),
            (PlotMap::Error, Some(Measured { smallest, largest, .. })) => {
                let (what, unit) = match self.compared {
                    Compared::Other(_) => ("differences of values", "m"),
                    _ => ("angles from the exact gradient", "degrees"),
                };
                format!("{what} from {smallest:.6} to {largest:.6} {unit}")
            }
        }
    }

    /// The JSON key of the number that colours show.
    fn measured_key(&self) -> &'static str {
        match (&self.compared, self.options.map) {
            (Compared::Other(_), _) => "difference_m",
            (Compared::Gradient(_), PlotMap::Error) => "error_degrees",
            _ => "value_over_distance",
        }
    }
}

/// The numbers of a picture.
struct Drawn {
    /// Between isolines [m].
    step: f64,
    /// The smallest and the largest value [m].
    range: (f64, f64),
    /// The extremes of what the colours show, if they show numbers.
    measured: Option<Measured>,
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
