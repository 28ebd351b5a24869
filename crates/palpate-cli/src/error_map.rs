// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Errors as colours: of a gradient beside the exact one, and of a field beside another.

use std::path::Path;

use indicatif::ProgressBar;
use palpate::field::{LARGEST_LENGTH, Point, Shape, Vector};
use palpate::local::{GradientMethod, GradientSampler, angle_between, closest_vector};
use palpate::plot::{Dash, Isolines, PlotError, Polyline, Sampling, Scale, Slice};
use palpate::query::BallWorkspace;
use palpate::scene::BuiltScene;
use rayon::prelude::*;

use crate::arguments::Reading;
use crate::input::{self, longest_edge};
use crate::interrupt;
use crate::outcome::Failure;
use crate::picture::{self, Dimensions, Drawable, values};
use crate::plot::{PlotMap, PlotOptions, title};

/// The smallest angle of the scale [degrees]: finer than any picture shows a direction.
const SMALLEST: f64 = 1e-3;

/// Pixels along the longer side of a picture of directions that are searched for: one takes as
/// long as hundreds that compare values.
const SEARCHED: usize = 280;

/// The fewest pixels that share a workspace: making one takes as long as some searches.
const FEWEST: usize = 64;

/// The tolerance of closest points in pictures, as a share of the longest edge of the scene's
/// box: a pixel or less.
const TOLERANCE: f64 = 1e-3;

/// The sampler of `--offset` and `--single`; the offset follows from the scene if left out.
pub(crate) fn sampler<const D: usize>(
    offset: Option<f64>,
    is_single: bool,
    scene: &BuiltScene<D>,
) -> Result<GradientSampler, Failure> {
    let usual =
        scene.bounds().map(|bounds| GradientSampler::OFFSET_SHARE * longest_edge(&bounds));
    let offset = offset.or(usual).ok_or_else(|| {
        Failure::input("--offset is needed: no body of the scene has bounds to take it from")
    })?;
    let sampler = GradientSampler::new(offset).map_err(|_| {
        let rule = format!("positive and at most {LARGEST_LENGTH:e} m, got {offset:?} m");
        Failure::input(format!("--offset must be {rule}"))
    })?;
    Ok(if is_single { sampler.in_single_precision() } else { sampler })
}

/// A way to the gradient of a scene's shape, to be drawn.
pub(crate) struct Gradient<'a, const D: usize> {
    shape: &'a Shape<D>,
    method: GradientMethod,
    sampler: GradientSampler,
    /// How far the closest point may be from the nearest [m].
    tolerance: f64,
}

impl<'a, const D: usize> Gradient<'a, D>
where
    Dimensions: Drawable<D>,
{
    pub(crate) fn of(
        scene: &'a BuiltScene<D>,
        method: GradientMethod,
        sampler: GradientSampler,
    ) -> Self {
        let usual = scene.bounds().map(|bounds| TOLERANCE * longest_edge(&bounds));
        let tolerance = usual.unwrap_or(sampler.offset());
        Self { shape: &scene.whole, method, sampler, tolerance }
    }

    fn direction(
        &self,
        p: Point<D>,
        workspace: &mut BallWorkspace<D>,
    ) -> Option<Vector<f64, D>> {
        let found = if self.method == GradientMethod::ClosestVector {
            closest_vector(self.shape, p, self.tolerance, workspace)
        } else {
            self.sampler.find(self.method, self.shape, p)
        };
        found.direction
    }

    /// The angle between the direction at `p` and the exact one [degrees].
    fn error(&self, p: Point<D>, workspace: &mut BallWorkspace<D>) -> Option<f64> {
        let exact = self.shape.distance_gradient(p).1.normalized()?;
        Some(angle_between(self.direction(p, workspace)?, exact).to_degrees())
    }

    /// The isolines with as many pixels as the method can find directions for in seconds.
    fn prepared(&self, isolines: Isolines, bar: &ProgressBar) -> Result<Isolines, PlotError> {
        let isolines = if self.method == GradientMethod::ClosestVector {
            isolines.with_pixels(Sampling::new(SEARCHED)?)
        } else {
            isolines
        };
        bar.inc_length(isolines.pixels() as u64);
        Ok(isolines)
    }

    /// Draws the angles as colours.
    pub(crate) fn draw_error(
        &self,
        isolines: Isolines,
        plane: &Slice,
        bar: &ProgressBar,
    ) -> Result<Isolines, PlotError> {
        let isolines = self.prepared(isolines, bar)?;
        let scale =
            Scale::decades("angle from the exact gradient", "degrees", SMALLEST, 180.0)?;
        isolines.with_values(scale.with_missing("no direction"), |points, angles| {
            let pixels = points.par_iter().zip(angles).with_min_len(FEWEST);
            pixels.for_each_init(BallWorkspace::new, |workspace, (st, angle)| {
                *angle = self.error(Dimensions::point(plane, *st), workspace);
            });
            bar.inc(points.len() as u64);
        })
    }

    /// Draws the directions as colours.
    fn draw_directions(
        &self,
        isolines: Isolines,
        plane: &Slice,
        bar: &ProgressBar,
    ) -> Result<Isolines, PlotError> {
        let isolines = self.prepared(isolines, bar)?;
        isolines.with_directions(self.method.to_string(), |points, slopes| {
            let pixels = points.par_iter().zip(slopes).with_min_len(FEWEST);
            pixels.for_each_init(BallWorkspace::new, |workspace, (st, slope)| {
                let p = Dimensions::point(plane, *st);
                slope.value = self.shape.distance(p);
                let direction = self.direction(p, workspace).unwrap_or(Vector::ZERO);
                slope.gradient = Dimensions::gradient(plane, direction);
            });
            bar.inc(points.len() as u64);
        })
    }
}

/// Another field of the same dimension.
pub(crate) struct Other<const D: usize> {
    /// The title of this scene, and of the other.
    names: [String; 2],
    shape: Shape<D>,
}

impl<const D: usize> Other<D>
where
    Dimensions: Drawable<D>,
{
    /// The field of the scene in `path`, to be compared with that of `scene`.
    fn read(path: &Path, scene: &Path, reading: Reading) -> Result<Self, Failure> {
        let names = [scene, path].map(title);
        let read = input::scene(Some(path), reading)?.scene;
        let scene = Dimensions::scene(read).ok_or_else(|| {
            let problem = format!("its fields are not in {D}D, as those it is compared with");
            Failure::file(path, problem)
        })?;
        Ok(Self { names, shape: scene.whole })
    }

    /// Draws the value of the other field less that of `shape` as colours, and the surface of the
    /// other.
    fn draw_difference(
        &self,
        isolines: Isolines,
        shape: &Shape<D>,
        plane: &Slice,
    ) -> Result<Isolines, PlotError> {
        let [name, other] = &self.names;
        let outline =
            picture::outline(&self.shape, plane, &isolines.view(), Sampling::default())?;
        let outline = outline.lines().iter().cloned();
        let outline = Polyline::of_pieces(format!("surface of {other}"), outline)?;
        let scale = format!("difference of values: {other} − {name}");
        let scale = Scale::signed(scale, "m");
        let [mut other, mut own] = [values(&self.shape, plane), values(shape, plane)];
        let mut found = Vec::new();
        let difference = isolines.with_values(scale, |points, differences| {
            found.resize(2 * points.len(), 0.0);
            let (of_other, of_own) = found.split_at_mut(points.len());
            other(points, of_other);
            own(points, of_own);
            for ((difference, a), b) in differences.iter_mut().zip(of_other).zip(of_own) {
                *difference = Some(*a - *b);
            }
        })?;
        Ok(difference.with_polyline(outline.with_dash(Dash::Dashed)))
    }
}

/// What `plot` compares a field with.
pub(crate) enum Compared<'a, const D: usize> {
    Nothing,
    /// The exact gradient with another, or another gradient drawn in its place.
    Gradient(Gradient<'a, D>),
    /// Another field.
    Other(Other<D>),
}

impl<'a, const D: usize> Compared<'a, D>
where
    Dimensions: Drawable<D>,
{
    /// What the options ask for.
    pub(crate) fn of(options: &PlotOptions, scene: &'a BuiltScene<D>) -> Result<Self, Failure> {
        let wrong = |problem: &str| Err(Failure::input(problem));
        match (options.map, &options.against, options.gradient.as_deref()) {
            (PlotMap::Error, None, None) => {
                wrong("--map error needs --against SCENE or --gradient METHOD")
            }
            (PlotMap::Error, Some(_), Some(_)) => {
                wrong("--map error compares with --against or with --gradient, not with both")
            }
            (PlotMap::Error, Some(path), None) => {
                Ok(Self::Other(Other::read(path, &options.scene, options.reading)?))
            }
            (PlotMap::Error | PlotMap::Gradient, None, Some(name)) => {
                let method = method::<D>(name, options)?;
                let sampler = sampler(options.offset, options.single, scene)?;
                Ok(Self::Gradient(Gradient::of(scene, method, sampler)))
            }
            (_, Some(_), _) => wrong("--against is only for --map error"),
            (_, None, Some(_)) => {
                wrong("--gradient is only for --map gradient and --map error")
            }
            (_, None, None) => Ok(Self::Nothing),
        }
    }

    /// Draws the comparison; nothing where there is none.
    pub(crate) fn draw(
        &self,
        map: PlotMap,
        shape: &Shape<D>,
        isolines: Isolines,
        plane: &Slice,
    ) -> Result<Isolines, PlotError> {
        let bar = interrupt::bar();
        let drawn = match self {
            Self::Nothing => Ok(isolines),
            Self::Gradient(gradient) if map == PlotMap::Error => {
                gradient.draw_error(isolines, plane, &bar)
            }
            Self::Gradient(gradient) => gradient.draw_directions(isolines, plane, &bar),
            Self::Other(other) => other.draw_difference(isolines, shape, plane),
        };
        bar.finish_and_clear();
        drawn
    }

    /// What is compared, in words.
    pub(crate) fn in_words(&self) -> Option<String> {
        match self {
            Self::Nothing => None,
            Self::Gradient(Gradient { method, sampler, .. }) if method.samples() => {
                let precision = if sampler.is_single() { "single" } else { "double" };
                let offset = sampler.offset();
                let grows = match method {
                    GradientMethod::AdaptiveDichotomy => " or more, growing with the value",
                    _ => "",
                };
                Some(format!(
                    "gradient by {method}, offset {offset:.3e} m{grows}, {precision} precision"
                ))
            }
            Self::Gradient(gradient) => Some(format!("gradient by {}", gradient.method)),
            Self::Other(other) => Some(format!("beside {}", other.names[1])),
        }
    }
}

/// The method of `--gradient`, where `--offset` and `--single` are given only if they matter.
fn method<const D: usize>(
    name: &str,
    options: &PlotOptions,
) -> Result<GradientMethod, Failure> {
    let method = input::gradient::<D>(name)?;
    let given = [("--offset", options.offset.is_some()), ("--single", options.single)];
    match given.iter().find(|(_, is_given)| *is_given && !method.samples()) {
        Some((option, _)) => Err(Failure::input(format!(
            "{option} is for --gradient differences, dichotomy and adaptive_dichotomy: \
             {method} compares no values"
        ))),
        None => Ok(method),
    }
}
