// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate gradients`: ways to a gradient compared.

use std::fmt;
use std::path::PathBuf;

use clap::Args;
use palpate::field::{Aabb, Point, Shape};
use palpate::local::{
    FoundDirection, GradientMethod, GradientSampler, adaptive_offset, angle_between,
};
use palpate::plot::{Figure, Markers, PlotError, Sampling, Slice};
use palpate::query::{self, AtPoint};
use palpate::scene::text::joined;
use palpate::scene::{AnyScene, BuiltScene};
use serde::Serialize;

use crate::arguments::Reading;
use crate::arguments::numbers::length;
use crate::error_map::{Gradient, sampler};
use crate::input::{self, longest_edge};
use crate::interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Files};
use crate::picture::{self, Dimensions, Drawable, Picture, in_space};
use crate::plot::{square, title};

/// Panels in a row.
const COLUMNS: usize = 2;
/// Cells along a panel, about one for each pixel of a figure.
const CELLS: usize = 160;

pub(crate) fn run(options: &GradientsOptions) -> Result<Outcome, Failure> {
    let mut files = Files::reading([options.scene.as_path()], options.reading);
    let picture = options.plot.as_deref().map(|path| Picture::new(&mut files, path));
    let picture = picture.transpose()?;
    match &input::scene(Some(&options.scene), options.reading)?.scene {
        AnyScene::Planar(scene) => compare(options, scene, picture.as_ref()),
        AnyScene::Spatial(scene) => compare(options, scene, picture.as_ref()),
    }
}

fn compare<const D: usize>(
    options: &GradientsOptions,
    scene: &BuiltScene<D>,
    picture: Option<&Picture>,
) -> Result<Outcome, Failure>
where
    Dimensions: Drawable<D>,
{
    let p = input::point::<D>(&options.at)?;
    let sampler = sampler(options.offset, options.single, scene)?;
    let window = picture.map(|_| window(options.size, scene, p)).transpose()?;
    let at = query::evaluate_point(&scene.whole, p).map_err(Failure::input)?;
    let ways = GradientMethod::ALL
        .iter()
        .map(|method| Way { method: *method, found: sampler.find(*method, &scene.whole, p) });
    let ways = ways.collect();
    let jumps = jumps(&scene.whole, &at, sampler.offset());
    let comparison = Comparison { options, sampler, at, jumps, ways };
    output::answer().print(&comparison.answer(), options.json)?;
    if let (Some(picture), Some(window)) = (picture, window) {
        picture.save(&comparison.figure(scene, &window)?, picture::WIDTH)?;
    }
    Ok(Outcome::Yes)
}

/// Gradients of places beside each other that differ by more than this meet at an edge of the
/// field: a surface that turns so much there would have a radius of ten of their distances.
const JUMP: f64 = 0.1;

/// The distance of these places, in offsets.
const BESIDE: f64 = 1e-6;

/// Their least distance, in roundings of a coordinate.
const ROUNDINGS: f64 = 16.0;

/// Whether the gradient jumps at a point, as on the middle line of a slab, where the exact one is
/// that of one side.
fn jumps<const D: usize>(shape: &Shape<D>, at: &AtPoint<D>, offset: f64) -> bool {
    (0..D).any(|axis| {
        let least = ROUNDINGS * f64::EPSILON * at.point[axis].abs();
        let step = (BESIDE * offset).max(least);
        [-step, step].into_iter().any(|step| {
            let mut beside = at.point;
            beside[axis] += step;
            (shape.distance_gradient(beside).1 - at.gradient).norm() > JUMP
        })
    })
}

/// The part of a scene to be drawn, with room around it: that about a point, or all of it.
fn window<const D: usize>(
    size: Option<f64>,
    scene: &BuiltScene<D>,
    about: Point<D>,
) -> Result<Aabb<D>, Failure> {
    if let Some(size) = size {
        return Ok(square(about, size));
    }
    let bounds = scene.bounds().ok_or_else(|| {
        Failure::input("--size is needed: no body of the scene has bounds to draw")
    })?;
    Ok(bounds.grown(picture::MARGIN * longest_edge(&bounds)))
}

/// What a method found.
struct Way<const D: usize> {
    method: GradientMethod,
    found: FoundDirection<D>,
}

impl<const D: usize> Way<D> {
    /// The angle from the exact gradient [degrees], where both have a direction.
    fn error(&self, at: &AtPoint<D>) -> Option<f64> {
        Some(angle_between(self.found.direction?, at.normal?).to_degrees())
    }

    /// Why there is no direction.
    fn obstacle(&self) -> Option<&'static str> {
        match (self.found.direction, self.method) {
            (Some(_), _) => None,
            (None, method) if D > 2 && method.is_planar() => Some("only in the plane"),
            (None, GradientMethod::ClosestVector) => {
                Some("no direction: the point lies on the surface, or no surface was found")
            }
            (None, GradientMethod::Exact) => Some("no direction: the gradient is zero"),
            (None, _) => Some("no direction: the values on both sides are equal"),
        }
    }
}

/// The methods at a point.
struct Comparison<'a, const D: usize> {
    options: &'a GradientsOptions,
    sampler: GradientSampler,
    at: AtPoint<D>,
    /// Whether the gradients of several sides meet at the point.
    jumps: bool,
    ways: Vec<Way<D>>,
}

impl<const D: usize> Comparison<'_, D>
where
    Dimensions: Drawable<D>,
{
    fn precision(&self) -> &'static str {
        if self.options.single { "single" } else { "double" }
    }

    fn answer(&self) -> Answer {
        let way = |way: &Way<D>| Method {
            method: way.method.name(),
            direction: way.found.direction.map(|d| d.0.to_vec()),
            error_degrees: way.error(&self.at),
            evaluations: way.found.evaluations,
            obstacle: way.obstacle(),
        };
        Answer {
            point: self.at.point.0.to_vec(),
            distance: self.at.distance,
            gradient: self.at.gradient.0.to_vec(),
            gradient_jumps: self.jumps,
            offset: self.sampler.offset(),
            adaptive_offset: adaptive_offset(self.at.distance, self.sampler.offset()),
            precision: self.precision(),
            methods: self.ways.iter().map(way).collect(),
        }
    }

    /// The errors over a window, a panel a method.
    fn figure(&self, scene: &BuiltScene<D>, window: &Aabb<D>) -> Result<Figure, Failure> {
        let [_, _, depth] = in_space(self.at.point);
        let plane = if D < 3 { Ok(Slice::planar()) } else { Slice::xy(depth) };
        let plane = plane.map_err(Failure::input)?;
        let view = Dimensions::view(&plane, window, 0.0).map_err(Failure::input)?;
        let sampling = Sampling::new(CELLS).map_err(Failure::input)?;
        let isolines = picture::isolines(&scene.whole, &plane, &view, sampling);
        let isolines = isolines.map_err(Failure::input)?;
        let bar = interrupt::bar();
        let here = plane.project(in_space(self.at.point));
        let methods = GradientMethod::ALL.iter().filter(|m| D < 3 || !m.is_planar());
        let panels = methods.map(|method| {
            let gradient = Gradient::of(scene, *method, self.sampler);
            let panel = gradient.draw_error(isolines.clone(), &plane, &bar)?;
            let panel = panel.with_markers(Markers::new("the point", [here])?);
            Ok::<_, PlotError>(panel.with_title(method.name().replace('_', " ")))
        });
        let panels = panels.collect::<Result<Vec<_>, _>>().map_err(Failure::input)?;
        bar.finish_and_clear();
        let caption = format!(
            "{}. Offset {:.3e} m, that of the adaptive dichotomy larger with the value; values in {} \
             precision.",
            scene.whole.promise().in_words(),
            self.sampler.offset(),
            self.precision(),
        );
        let title = format!("Gradients: {}", title(&self.options.scene));
        Ok(Figure::new(title).with_caption(caption).with_sheet(COLUMNS, panels))
    }
}

/// The answer of `palpate gradients`.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Answer {
    /// The point [m].
    pub(crate) point: Vec<f64>,
    /// The field's value [m].
    pub(crate) distance: f64,
    /// The exact gradient; where it jumps, that of one side.
    pub(crate) gradient: Vec<f64>,
    /// `true` if the gradient jumps at the point.
    pub(crate) gradient_jumps: bool,
    /// The distance of the sample points from `point` [m].
    pub(crate) offset: f64,
    /// The offset of the adaptive dichotomy [m].
    pub(crate) adaptive_offset: f64,
    /// What the values are rounded to: `double` or `single`.
    pub(crate) precision: &'static str,
    /// The ways to a gradient.
    pub(crate) methods: Vec<Method>,
}

/// The result of one method.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Method {
    /// The name of the way.
    pub(crate) method: &'static str,
    /// The unit vector that was found; `null` if there is none.
    pub(crate) direction: Option<Vec<f64>>,
    /// The angle from the exact gradient [degrees], where both have a direction.
    pub(crate) error_degrees: Option<f64>,
    /// How often the field was evaluated.
    pub(crate) evaluations: u32,
    /// Why there is no direction, in words.
    pub(crate) obstacle: Option<&'static str>,
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { distance, offset, adaptive_offset, precision, .. } = self;
        writeln!(f, "distance             {distance} m")?;
        writeln!(f, "gradient             {}", joined(&self.gradient))?;
        writeln!(f, "offset               {offset:.3e} m, adaptive {adaptive_offset:.3e} m")?;
        writeln!(f, "values               in {precision} precision")?;
        if self.gradient_jumps {
            writeln!(
                f,
                "note                 the gradient jumps here: there is none, and `exact` is that of \
                 one side"
            )?;
        }
        self.methods.iter().try_for_each(|method| writeln!(f, "{method}"))
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        /// Decimals of a direction and of an angle in degrees.
        const DIGITS: usize = 6;
        write!(f, "{:<20} ", self.method)?;
        if let Some(obstacle) = self.obstacle {
            return f.write_str(obstacle);
        }
        // Adding zero turns −0 into 0, also that of rounding.
        let rounded = |x: f64| (x * 1e6).round() / 1e6 + 0.0;
        let direction = self.direction.iter().flatten();
        let direction: Vec<_> =
            direction.map(|x| format!("{:>9.DIGITS$}", rounded(*x))).collect();
        write!(f, "{}   ", direction.join(", "))?;
        match self.error_degrees {
            Some(degrees) => write!(f, "{degrees:>10.DIGITS$}° off")?,
            None => write!(f, "no exact direction")?,
        }
        write!(f, "   {:>3} evaluations", self.evaluations)
    }
}

pub(crate) const EXAMPLES: &str = "\
Examples:
  palpate gradients scenes/memoir_star.json --at 1.35,0.8
  palpate gradients scenes/memoir_star.json --at 1.35,0.8 --offset 5e-6 --single \\
    --plot gradients.png
  palpate gradients scenes/s3.json --at 0.1,0.5,-0.2 --json

The methods are those of \"Détections de collisions avec des SDFs\", section 2.3: the vector to the
closest point, central differences, and a dichotomy over directions with a fixed and a growing
offset, which turns in the plane alone.";

/// The options of `palpate gradients`.
#[derive(Args, Debug)]
pub(crate) struct GradientsOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    /// The point, its coordinates joined by commas [m].
    #[arg(long, value_name = "X,Y[,Z]", allow_hyphen_values = true)]
    pub(crate) at: String,
    /// How far from the point values are compared [m]; five millionths of the longest edge of the
    /// scene's box if left out.
    #[arg(long, allow_negative_numbers = true, value_parser = length)]
    pub(crate) offset: Option<f64>,
    /// Round the values that are compared to single precision, as the memoir's program does.
    #[arg(long)]
    pub(crate) single: bool,
    /// Draw the angle between the direction of each method and the exact one, a panel a method;
    /// in space on the plane xy through the point: .svg or .png.
    #[arg(long, value_name = "PICTURE")]
    pub(crate) plot: Option<PathBuf>,
    /// Width and height of the drawn window around the point [m]; the whole scene if left out.
    #[arg(long, requires = "plot", allow_negative_numbers = true, value_parser = length)]
    pub(crate) size: Option<f64>,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) reading: Reading,
}
