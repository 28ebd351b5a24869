// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A local search over a segment or a triangle, beside the proven minimum.

use std::fmt;
use std::time::{Duration, Instant};

use palpate::field::{Point, Vector};
use palpate::local::{Descent, ElementMethod, NaiveDescent};
use palpate::query::{Certified, Element, ElementWorkspace, minimum};
use palpate::scene::BuiltScene;
use palpate::scene::text::joined;
use serde::Serialize;

use super::circles::Circles;
use super::ending::EndOfPath;
use super::search::Search;
use super::{Found, figure, limits};
use crate::arguments::DescendOptions;
use crate::input::{self, longest_edge};
use crate::outcome::{Failure, Outcome};
use crate::output;
use crate::picture::{self, Dimensions, Drawable, Picture};
use crate::times::microseconds;

/// The result of a local search over an element, and the proven minimum.
pub(super) struct Answer<const N: usize, const D: usize> {
    pub(super) element: Element<N, D>,
    pub(super) search: Search<N>,
    pub(super) found: Timed<Descent<D>>,
    pub(super) certified: Timed<Certified<Point<D>>>,
    pub(super) ending: EndOfPath<D>,
    pub(super) circles: Circles<D>,
}

/// A result, and the time that it takes [s].
pub(super) struct Timed<T> {
    pub(super) result: T,
    time: f64,
}

impl<T> Timed<T> {
    /// The least time of some runs: the first one is slower, and others may be disturbed.
    fn of(mut work: impl FnMut() -> T) -> Self {
        const MOST_RUNS: u32 = 16;
        const ENOUGH: Duration = Duration::from_millis(20);
        let begin = Instant::now();
        let mut least = Duration::MAX;
        let mut runs = 0;
        loop {
            let start = Instant::now();
            let result = work();
            least = least.min(start.elapsed());
            runs += 1;
            if runs == MOST_RUNS || begin.elapsed() > ENOUGH {
                return Self { result, time: least.as_secs_f64() };
            }
        }
    }
}

/// Searches over the element with these vertices.
pub(super) fn descend<const N: usize, const D: usize>(
    options: &DescendOptions,
    scene: &BuiltScene<D>,
    picture: Option<&Picture>,
    vertices: &[String],
) -> Result<Outcome, Failure>
where
    Dimensions: Drawable<D>,
{
    let element = element::<N, D>(vertices)?;
    let search = Search::of::<D>(options)?;
    // Of a long element over a small scene, most is far away.
    let scene_size = scene.bounds().map_or(f64::INFINITY, |bounds| longest_edge(&bounds));
    // Of a point, only the scene has a size.
    let size = match element.longest_edge() {
        edge if edge > 0.0 => edge.min(scene_size),
        _ if scene_size < f64::INFINITY => scene_size,
        _ => 1.0,
    };
    let limits = limits(options.tolerance, size);
    let shape = &scene.whole;
    let mut workspace = ElementWorkspace::new();
    let proof = Timed::of(|| minimum(shape, &element, &limits, &mut workspace));
    let certified = Timed { result: proof.result.map_err(Failure::input)?, time: proof.time };
    let found = Timed::of(|| search.run(shape, &element));
    let answer = Answer {
        ending: EndOfPath::of(shape, &found.result, &certified.result, size),
        circles: Circles::of(shape, &element),
        certified,
        element,
        search,
        found,
    };
    output::answer().print(&answer.report(), options.json)?;
    if let Some(picture) = picture {
        let figure = figure::of(shape, &answer, &options.scene);
        picture.save(&figure.map_err(Failure::input)?, picture::WIDTH)?;
    }
    Ok(Outcome::Yes)
}

fn element<const N: usize, const D: usize>(
    points: &[String],
) -> Result<Element<N, D>, Failure> {
    let mut vertices = [Vector::ZERO; N];
    for (vertex, text) in vertices.iter_mut().zip(points) {
        *vertex = input::point(text)?;
    }
    Element::new(vertices).map_err(Failure::input)
}

/// An element in words.
pub(super) const fn name_of<const N: usize>() -> &'static str {
    if N == 2 { "segment" } else { "triangle" }
}

impl<const N: usize, const D: usize> Answer<N, D> {
    /// How much lower than the found value some point is at least [m]; zero if no lower point
    /// is proven.
    fn missed_by(&self) -> f64 {
        (self.found.result.value - self.certified.result.upper).max(0.0)
    }

    /// How many evaluations the memoir counts for its descent.
    fn memoir_count(&self) -> Option<u32> {
        let is_memoirs = self.search.method == ElementMethod::Naive;
        is_memoirs.then(|| NaiveDescent::MEMOIR_EVALUATIONS * self.found.result.steps)
    }

    fn report(&self) -> Report<'_, D> {
        let Self { element, search, found, certified, .. } = self;
        let naive = &search.naive;
        let naive = self.memoir_count().map(|memoir_evaluations| Naive {
            alpha: naive.alpha,
            mu: naive.mu_for(element),
            gradient: naive.gradient_in::<D>().name(),
            memoir_evaluations,
        });
        Report {
            method: search.method.name(),
            naive,
            found: Found::from(&found.result),
            time: found.time,
            missed_by: self.missed_by(),
            ending: &self.ending,
            circles: &self.circles,
            certified: ProvenMinimum {
                minimum: certified.result.map(|best| best.0.to_vec()),
                time: certified.time,
            },
            search: search.in_words(element),
            element: name_of::<N>(),
        }
    }
}

/// The answer of `palpate descend` over a segment or a triangle.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Report<'a, const D: usize> {
    /// The name of the search.
    method: &'static str,
    /// The constants of the naive search.
    #[serde(flatten)]
    naive: Option<Naive>,
    #[serde(flatten)]
    found: Found,
    /// The time that the search takes [s].
    time: f64,
    /// How far the value is above one that is proven to be taken [m].
    missed_by: f64,
    /// The end of the path.
    ending: &'a EndOfPath<D>,
    /// The circles around the element, and whether they exclude it.
    circles: &'a Circles<D>,
    /// The search with a proof.
    certified: ProvenMinimum,
    /// The method, with its constants.
    #[serde(skip)]
    search: String,
    /// What the search is over.
    #[serde(skip)]
    element: &'static str,
}

/// With the method `naive` alone.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Naive {
    /// The factor of a step.
    alpha: f64,
    /// The step of a search [m].
    mu: f64,
    /// The way to gradients.
    gradient: &'static str,
    /// Ten evaluations for each step, as the memoir counts.
    memoir_evaluations: u32,
}

/// The proven minimum.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct ProvenMinimum {
    #[serde(flatten)]
    minimum: Certified<Vec<f64>>,
    /// The time that the search takes [s].
    time: f64,
}

impl<const D: usize> fmt::Display for Report<'_, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { found, certified: ProvenMinimum { minimum, time: proof_time }, .. } = self;
        let [time, proof_time] = [self.time, *proof_time].map(microseconds);
        let metres = |length: f64| format!("{length} m");
        writeln!(f, "method       {}", self.search)?;
        writeln!(f, "best point   {} m", joined(&found.best))?;
        writeln!(f, "value        {} m, an upper bound", found.value)?;
        write!(f, "steps        {} ({} evaluations, {time}", found.steps, found.evaluations)?;
        match &self.naive {
            Some(Naive { memoir_evaluations, .. }) => {
                writeln!(f, "; the memoir counts 10 a gradient: {memoir_evaluations})")?;
            }
            None => writeln!(f, ")")?,
        }
        writeln!(f, "ended        {}", self.ending.in_words(metres))?;
        let bounds = joined(&[minimum.lower, minimum.upper]);
        let evaluations = minimum.evaluations;
        writeln!(f, "proven       [{bounds}] m ({evaluations} evaluations, {proof_time})")?;
        writeln!(f, "lowest at    {} m", joined(&minimum.best))?;
        writeln!(f, "missed by    {} m, with the best point", self.missed_by)?;
        self.circles.all().try_for_each(|circle| {
            let words = circle.in_words(self.element, metres);
            writeln!(f, "{} about {} m: {words}", circle.name, circle.centre())
        })
    }
}
