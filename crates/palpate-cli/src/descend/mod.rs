// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate descend`: local searches beside the proven ones.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::Args;
use palpate::field::{Aabb, LARGEST_LENGTH, Shape, UnknownName, Vector};
use palpate::local::{Descent, ElementMethod, NaiveDescent, PairMethod, Weights};
use palpate::query::{Element, Limits};
use palpate::scene::{AnyScene, BuiltScene};
use serde::Serialize;

use crate::arguments::Reading;
use crate::arguments::numbers::{count, length_or_zero};
use crate::input;
use crate::outcome::{Failure, Outcome};
use crate::output::Files;
use crate::picture::{Dimensions, Drawable, Picture};

pub(crate) mod element;
pub(crate) mod pair;

/// How far apart the bounds of the minimum may be, as a share of the longest edge.
const TOLERANCE: f64 = 1e-4;

pub(crate) fn run(options: &DescendOptions) -> Result<Outcome, Failure> {
    let mut files = Files::reading([options.scene.as_path()], options.reading);
    let picture = options.plot.as_deref().map(|path| Picture::new(&mut files, path));
    let picture = picture.transpose()?;
    match &input::scene(Some(&options.scene), options.reading)?.scene {
        AnyScene::Planar(scene) => descend(options, scene, picture.as_ref()),
        AnyScene::Spatial(scene) => descend(options, scene, picture.as_ref()),
    }
}

/// Searches over an element, or between two bodies, as the options ask.
fn descend<const D: usize>(
    options: &DescendOptions,
    scene: &BuiltScene<D>,
    picture: Option<&Picture>,
) -> Result<Outcome, Failure>
where
    Dimensions: Drawable<D>,
{
    let elements = [&options.triangle, &options.segment];
    let has_start = !options.start.is_empty() || options.halton.is_some();
    if !has_start && elements.iter().all(|points| points.is_empty()) {
        Err(nothing_asked(scene, &options.scene))
    } else if options.halton.is_some() && elements.iter().any(|points| !points.is_empty()) {
        Err(Failure::input(
            "--halton is for starts between two bodies: leave out --triangle and --segment",
        ))
    } else if !options.triangle.is_empty() {
        element::descend::<3, D>(options, scene, picture, &options.triangle)
    } else if !options.segment.is_empty() {
        element::descend::<2, D>(options, scene, picture, &options.segment)
    } else {
        pair::between(options, scene, picture)
    }
}

/// What to ask instead of nothing, with an example from the scene.
fn nothing_asked<const D: usize>(scene: &BuiltScene<D>, path: &Path) -> Failure {
    let around = Aabb::centred(Vector::constant(0.5));
    let bounds = scene.bounds().unwrap_or(around);
    let mut ends = [bounds.centre(); 2];
    (ends[0][0], ends[1][0]) = (bounds.min[0], bounds.max[0]);
    let [from, to] = ends.map(input::written_point);
    let path = path.display();
    Failure::input(format!(
        "descend needs --segment with 2 points, --triangle with 3, or, between two bodies, --start \
         with 1 or --halton with their number; for example: palpate descend {path} --segment {from} {to}"
    ))
}

/// The requested method, or `first`. A method of the `Other` kind is named with what it needs.
fn method<T, Other>(options: &DescendOptions, first: T, needs: &str) -> Result<T, Failure>
where
    T: FromStr<Err = UnknownName>,
    Other: FromStr,
{
    let Some(name) = options.method.as_deref() else { return Ok(first) };
    if name.parse::<Other>().is_ok() {
        return Err(Failure::input(format!("--method {name} {needs}")));
    }
    name.parse().map_err(|error| Failure::input(format!("--method: {error}")))
}

/// The limits of the search with a proof, over something of this size [m].
fn limits(tolerance: Option<f64>, size: f64) -> Limits {
    Limits::new(tolerance.unwrap_or(TOLERANCE * size))
}

/// The result of a local search.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Found {
    /// The best point [m].
    pub(crate) best: Vec<f64>,
    /// Its value, an upper bound of the minimum [m]; between two bodies, the larger value of both fields.
    pub(crate) value: f64,
    /// Steps that were taken.
    pub(crate) steps: u32,
    /// How often fields were evaluated; a gradient counts twice.
    pub(crate) evaluations: u32,
    /// The points of the path, from the start on [m].
    pub(crate) path: Vec<Vec<f64>>,
}

impl<const D: usize> From<&Descent<D>> for Found {
    fn from(found: &Descent<D>) -> Self {
        Self {
            best: found.best.0.to_vec(),
            value: found.value,
            steps: found.steps,
            evaluations: found.evaluations,
            path: found.path.iter().map(|p| p.0.to_vec()).collect(),
        }
    }
}

/// A length as figures write it.
fn written(length: f64) -> String {
    /// Parts of a metre.
    const ROUND: f64 = 1e5;
    // Adding zero turns −0 into 0.
    let rounded = (length * ROUND).round() / ROUND + 0.0;
    format!("{rounded:.5} m").replace('-', "−")
}

pub(crate) const EXAMPLES: &str = "\
Examples:
  palpate descend scenes/memoir_star.json --triangle 1.35,1.1 1.8,0.45 1.0,0.99
  palpate descend scenes/memoir_star.json --triangle 1.35,1.1 1.8,0.45 1.0,0.99 \\
    --method naive --alpha 0.1 --mu 0.1 --start 0.2,0.2,0.6 --plot descent.png
  palpate descend scenes/s3.json --segment -1,0,0 1,0.2,0.1 --method golden_section --json
  palpate descend scenes/memoir_two_bodies.json --start -0.2,0.5 --start 0.15,0.4
  palpate descend scenes/memoir_two_bodies.json --method sum_descent --halton 40

Without --triangle and --segment the search is for a point inside the first two bodies of the
scene, from each --start or from --halton starts. A local search finds an upper bound of the least value and proves
nothing; the answer says by how much it missed the proven minimum, where it ended, what both
searches cost, and whether the circles around the element exclude it.";

/// The options of `palpate descend`.
#[derive(Args, Debug)]
pub(crate) struct DescendOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    /// The corners of a triangle, each with its coordinates joined by commas [m].
    #[arg(long, value_name = "POINT", num_args = 3, allow_hyphen_values = true)]
    pub(crate) triangle: Vec<String>,
    /// The ends of a segment [m].
    #[arg(
        long,
        value_name = "POINT",
        num_args = 2,
        conflicts_with = "triangle",
        allow_hyphen_values = true
    )]
    pub(crate) segment: Vec<String>,
    /// Where the search starts. Over a triangle or a segment: the barycentric weights of its
    /// corners, u,v,w or u,v, whose sum is 1; the method's own start if left out. Between bodies:
    /// a point [m]; may be given more than once.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true)]
    pub(crate) start: Vec<String>,
    /// Between bodies: this many starts of Halton's sequence, evenly over the common part of both
    /// boxes; MuJoCo has 40.
    #[arg(long, conflicts_with = "start", allow_negative_numbers = true, value_parser = count(1, 100_000_u32))]
    pub(crate) halton: Option<u32>,
    /// The search: projected_gradient, frank_wolfe, golden_section, macklin (as PhysX ships it) or
    /// naive (the memoir's, as printed) over an element; alternating_projection, minimax_proximal or
    /// sum_descent (MuJoCo's) between bodies; the first of these if left out.
    #[arg(long)]
    pub(crate) method: Option<String>,
    /// The factor α of the steps of --method naive, α·max(f, µ); 0.1 if left out.
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) alpha: Option<f64>,
    /// The least value µ in the steps of --method naive [m]; a tenth of the longest edge if left
    /// out.
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) mu: Option<f64>,
    /// The number of steps of --method naive; 64 if left out.
    #[arg(long)]
    pub(crate) iterations: Option<u32>,
    /// How --method naive finds gradients: dichotomy or adaptive_dichotomy (in the plane),
    /// differences, closest_vector, exact; dichotomy if left out, in space differences.
    #[arg(long)]
    pub(crate) gradient: Option<String>,
    /// How far apart the proven bounds may be [m]; a ten-thousandth of the longest edge of the
    /// element or of the scene's box if left out.
    #[arg(long, allow_negative_numbers = true, value_parser = length_or_zero)]
    pub(crate) tolerance: Option<f64>,
    /// Draw the path over the isolines, on the element's plane: .svg or .png.
    #[arg(long, value_name = "PICTURE")]
    pub(crate) plot: Option<PathBuf>,
    /// Print JSON, with the points of the path.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) reading: Reading,
}

/// Most steps of the naive descent, whose path is kept.
const MOST_ITERATIONS: u32 = 100_000;

/// A search over an element.
#[derive(Debug)]
struct Search<const N: usize> {
    method: ElementMethod,
    /// The constants of [`ElementMethod::Naive`].
    naive: NaiveDescent,
    /// Where it starts, if that is asked for.
    start: Option<Weights<N>>,
}

impl<const N: usize> Search<N> {
    fn of<const D: usize>(options: &DescendOptions) -> Result<Self, Failure> {
        let needs = "searches between two bodies: leave out --triangle and --segment";
        let method = method::<_, PairMethod>(options, ElementMethod::ProjectedGradient, needs)?;
        if method != ElementMethod::Naive {
            refuse_naive(options)?;
        }
        Ok(Self { method, naive: naive::<D>(options)?, start: start(options)? })
    }

    fn run<const D: usize>(&self, shape: &Shape<D>, element: &Element<N, D>) -> Descent<D> {
        match (self.method, &self.start) {
            (ElementMethod::Naive, None) => self.naive.descend(shape, element),
            (ElementMethod::Naive, Some(start)) => {
                self.naive.descend_from(shape, element, start)
            }
            (method, None) => method.descend(shape, element),
            (method, Some(start)) => method.descend_from(shape, element, start),
        }
    }

    /// The method in words, with its constants.
    fn in_words<const D: usize>(&self, element: &Element<N, D>) -> String {
        if self.method != ElementMethod::Naive {
            return self.method.to_string();
        }
        let (alpha, mu) = (self.naive.alpha, self.naive.mu_for(element));
        let gradient = self.naive.gradient_in::<D>();
        format!("naive, alpha {alpha}, mu {mu} m, gradients by {gradient}")
    }
}

/// Refuses options of the naive descent for other searches.
fn refuse_naive(options: &DescendOptions) -> Result<(), Failure> {
    let given = [
        ("--alpha", options.alpha.is_some()),
        ("--mu", options.mu.is_some()),
        ("--iterations", options.iterations.is_some()),
        ("--gradient", options.gradient.is_some()),
    ];
    match given.iter().find(|(_, is_given)| *is_given) {
        Some((name, _)) => Err(Failure::input(format!("{name} is only for --method naive"))),
        None => Ok(()),
    }
}

/// The naive descent with the constants that are asked for.
fn naive<const D: usize>(options: &DescendOptions) -> Result<NaiveDescent, Failure> {
    let mut naive = NaiveDescent::default();
    if let Some(alpha) = options.alpha {
        // Written so that NaN is refused.
        if !(alpha > 0.0 && alpha.is_finite()) {
            let problem = format!("--alpha must be positive and finite, got {alpha:?}");
            return Err(Failure::input(problem));
        }
        naive = naive.with_alpha(alpha);
    }
    if let Some(mu) = options.mu {
        if !(0.0..=LARGEST_LENGTH).contains(&mu) {
            let rule = format!("from 0 m to {LARGEST_LENGTH:e} m, got {mu:?} m");
            return Err(Failure::input(format!("--mu must be {rule}")));
        }
        naive = naive.with_mu(mu);
    }
    if let Some(iterations) = options.iterations {
        if iterations > MOST_ITERATIONS {
            let rule = format!("at most {MOST_ITERATIONS}, got {iterations}");
            return Err(Failure::input(format!("--iterations must be {rule}")));
        }
        naive = naive.with_steps(iterations);
    }
    match &options.gradient {
        Some(name) => Ok(naive.with_gradient(input::gradient::<D>(name)?)),
        None => Ok(naive),
    }
}

/// The weights of `--start`.
fn start<const N: usize>(options: &DescendOptions) -> Result<Option<Weights<N>>, Failure> {
    let [given] = options.start.as_slice() else {
        return match options.start.len() {
            0 => Ok(None),
            count => Err(Failure::input(format!(
                "a search over an element has one --start, got {count}"
            ))),
        };
    };
    let numbers = input::numbers(given).ok_or_else(|| {
        let (element, letters) =
            if N == 2 { ("segment", "u,v") } else { ("triangle", "u,v,w") };
        Failure::input(format!(
            "--start of a {element} is the barycentric weights {letters} of its corners, got {given:?}; \
             a point in metres starts a search between two bodies, without --triangle and --segment"
        ))
    })?;
    let weights = Weights::new(numbers);
    weights.map(Some).map_err(|error| Failure::input(format!("--start: {error}")))
}
