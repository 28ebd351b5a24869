// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate plot`: isolines, gradients and promises on a plane.

use std::io::Write;
use std::path::{Path, PathBuf};

use palpate::field::{Aabb, LARGEST_LENGTH, Vector};
use palpate::plot::{Figure, Gauge, Measured, Sampling, Slice};
use palpate::scene::{BuiltScene, World};
use serde_json::json;

use crate::arguments::{Map, PlotOptions};
use crate::contact::Touched;
use crate::input::{self, promise_in_words};
use crate::outcome::{Failure, Outcome};
use crate::picture::{self, Dimensions, Drawable};

pub(crate) fn run(options: &PlotOptions) -> Result<Outcome, Failure> {
    let named = input::scene(Some(&options.scene))?;
    match &named.world {
        World::Planar(scene) => {
            let window = Window::of(options, scene)?;
            let touched = touched(options, scene)?;
            draw(options, scene, &window, &Slice::planar(), touched.as_ref())
        }
        World::Spatial(scene) => {
            let window = Window::of(options, scene)?;
            let touched = touched(options, scene)?;
            let deepest = touched.as_ref().and_then(Touched::deepest);
            let deepest = deepest.filter(|_| options.centre.is_none());
            let through = deepest.unwrap_or_else(|| window.bounds.centre());
            let plane = plane(options, through)?;
            draw(options, scene, &window, &plane, touched.as_ref())
        }
    }
}

/// The contacts, if they are to be shown.
fn touched<const D: usize>(
    options: &PlotOptions,
    scene: &BuiltScene<D>,
) -> Result<Option<Touched<D>>, Failure> {
    let find = || Touched::find(&options.question, scene, options.proof);
    options.contacts.then(find).transpose()
}

/// What the picture shows.
struct Window<const D: usize> {
    bounds: Aabb<D>,
    /// Room around them, as a share of their longer side.
    margin: f64,
}

impl<const D: usize> Window<D> {
    /// A square about the centre that is asked for; else the scene's box, or a metre
    /// about the origin if no body has bounds.
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

fn draw<const D: usize>(
    options: &PlotOptions,
    scene: &BuiltScene<D>,
    window: &Window<D>,
    plane: &Slice,
    touched: Option<&Touched<D>>,
) -> Result<Outcome, Failure>
where
    Dimensions: Drawable<D>,
{
    if options.step.is_some() && options.map != Map::Distance {
        return Err(Failure::input(
            "--step is for --map distance: other maps have no isolines",
        ));
    }
    let view = Dimensions::view(plane, &window.bounds, window.margin);
    let view = view.map_err(Failure::input)?;
    let isolines = picture::isolines(&scene.whole, plane, &view, Sampling::default())
        .map_err(Failure::input)?;
    let isolines = match options.step {
        Some(step) => isolines.with_step(step).map_err(Failure::input)?,
        None => picture::mapped(&scene.whole, plane, isolines, options.map)
            .map_err(Failure::input)?,
    };
    let (step, range, measured) = (isolines.step(), isolines.range(), isolines.measured());
    let output = output(options);
    let isolines = match touched {
        Some(touched) => touched.draw(isolines, plane)?,
        None => isolines,
    };
    let figure = Figure::new(title(&options.scene))
        .with_caption(promise_in_words(scene.whole.promise()))
        .with_isolines(isolines);
    picture::save(&figure, &output, options.width)?;
    let gauge = match <Dimensions as Drawable<D>>::GAUGE {
        Gauge::Distance => "value_over_distance",
        Gauge::Steepness => "steepness",
    };
    let point = |st| <Dimensions as Drawable<D>>::point(plane, st).0.to_vec();
    let mut out = std::io::stdout().lock();
    if options.json {
        let mut answer = json!({
            "output": output,
            "map": options.map.name(),
            "smallest_m": range.0,
            "largest_m": range.1,
        });
        if options.map == Map::Distance {
            answer["step_m"] = json!(step);
        }
        if let Some(measured) = measured {
            answer[gauge] = json!({
                "smallest": measured.smallest,
                "smallest_at_m": point(measured.smallest_at),
                "largest": measured.largest,
                "largest_at_m": point(measured.largest_at),
            });
        }
        if let Some(touched) = touched {
            let (touching, boxes) = touched.counts();
            answer["touching_pairs"] = json!(touching);
            answer["proof_boxes"] = json!(boxes);
        }
        writeln!(out, "{answer:#}")?;
        return Ok(Outcome::Yes);
    }
    let shown = match options.map {
        Map::Distance => format!("isolines every {step} m"),
        Map::Gradient => "directions of the gradient".to_owned(),
        Map::Promise => match measured {
            None => "promises".to_owned(),
            Some(Measured { smallest, largest, .. }) => {
                format!("promises; {gauge} from {smallest:.3} to {largest:.3}")
            }
        },
    };
    writeln!(out, "{}: {shown}", output.display())?;
    Ok(Outcome::Yes)
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

/// The plane that is asked for; along two axes through `middle`, unless said otherwise.
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
                let rule = "xy, xz, yz, or origin:right:up with three numbers each";
                Failure::input(format!("a plane is {rule}, got {free:?}"))
            })?;
            Slice::free(origin.0, right.0, up.0)
        }
    }
    .map_err(Failure::input)
}
