// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate plot`: draws isolines, gradients and promises on a plane.

use std::io::Write;
use std::path::{Path, PathBuf};

use palpate::field::{Aabb, Vector};
use palpate::plot::{Figure, Gauge, Measured, Sampling, Slice};
use palpate::scene::{AnyScene, BuiltScene};
use serde_json::{Value, json};

use crate::arguments::{Map, PlotOptions};
use crate::contact::Touched;
use crate::emptiness;
use crate::input::{self, promise_in_words};
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Files, shown};
use crate::picture::{self, Dimensions, Drawable, Picture};

pub(crate) fn run(options: &PlotOptions) -> Result<Outcome, Failure> {
    let mut files = Files::reading([options.scene.as_path()]);
    let picture = Picture::new(&mut files, &output(options))?;
    picture.check_width(options.width)?;
    check_contacts(options)?;
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
            Plot::of(options, &picture, scene)?.draw(&Slice::planar())
        }
        AnyScene::Spatial(scene) => {
            let plot = Plot::of(options, &picture, scene)?;
            let deepest = plot.touched.as_ref().and_then(Touched::deepest);
            let deepest = deepest.filter(|_| options.centre.is_none());
            let through = deepest.unwrap_or_else(|| plot.window.bounds.centre());
            plot.draw(&plane(options, through)?)
        }
    }
}

/// Refuses options of a search for contacts where none is made.
fn check_contacts(options: &PlotOptions) -> Result<(), Failure> {
    let asked = &options.question;
    let given = [
        ("--margin", asked.margin.is_some()),
        ("--spacing", asked.spacing.is_some()),
        ("--tolerance", asked.tolerance.is_some()),
        ("--budget", asked.budget.is_some()),
    ];
    match given.iter().find(|(_, is_given)| *is_given && !options.contacts) {
        Some((option, _)) => {
            Err(Failure::input(format!("{option} is about contacts, and needs --contacts")))
        }
        None => Ok(()),
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
        emptiness::warn(scene);
        let window = Window::of(options, scene)?;
        let touched = touched(options, scene)?;
        Ok(Self { options, picture, scene, window, touched })
    }

    /// Draws the scene on `plane`, and reports the picture.
    fn draw(&self, plane: &Slice) -> Result<Outcome, Failure> {
        let Self { options, scene, window, .. } = self;
        let view = Dimensions::view(plane, &window.bounds, window.margin);
        let view = view.map_err(Failure::input)?;
        let isolines = picture::isolines(&scene.whole, plane, &view, Sampling::default())
            .map_err(Failure::input)?;
        let isolines = match options.step {
            Some(step) => isolines.with_step(step).map_err(Failure::input)?,
            None => picture::mapped(&scene.whole, plane, isolines, options.map)
                .map_err(Failure::input)?,
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
        self.picture.save(&figure, options.width.unwrap_or(picture::WIDTH))?;
        if options.json {
            output::answer().json(&self.described(&drawn, plane))?;
        } else {
            let name = self.picture.path().display().to_string();
            writeln!(output::answer(), "{}: {}", shown(&name), self.in_words(&drawn))?;
        }
        Ok(Outcome::Yes)
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
            answer[gauge::<D>()] = json!({
                "smallest": measured.smallest,
                "smallest_at_m": point(measured.smallest_at),
                "largest": measured.largest,
                "largest_at_m": point(measured.largest_at),
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
            (Map::Promise, None) => "promises".to_owned(),
            (Map::Promise, Some(Measured { smallest, largest, .. })) => {
                format!("promises; {} from {smallest:.3} to {largest:.3}", gauge::<D>())
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
    /// The extremes of the number that is compared with the promise.
    measured: Option<Measured>,
}

/// The JSON key of the number that is compared with the promise.
fn gauge<const D: usize>() -> &'static str
where
    Dimensions: Drawable<D>,
{
    match <Dimensions as Drawable<D>>::GAUGE {
        Gauge::Distance => "value_over_distance",
        Gauge::Steepness => "steepness",
    }
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
    let plane = options.plane.as_deref().unwrap_or("xy");
    if options.at.is_some() && (options.centre.is_some() || plane.contains(':')) {
        let other = if options.centre.is_some() { "--centre" } else { "--plane" };
        let problem = "both say where the plane is; leave out --at";
        return Err(Failure::input(format!("--at and the point of {other} {problem}")));
    }
    let at = |axis: usize| options.at.unwrap_or(middle[axis]);
    match plane {
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
