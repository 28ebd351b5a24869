// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A local search over a segment or a triangle, beside the proven minimum.

use std::io::Write;
use std::time::{Duration, Instant};

use palpate::field::{Point, Vector};
use palpate::local::{Descent, ElementMethod, NaiveDescent};
use palpate::query::{Certified, Element, ElementWorkspace, minimum};
use palpate::scene::BuiltScene;
use serde_json::json;

use super::circles::Circles;
use super::ending::Ending;
use super::search::Search;
use super::{described, figure, limits};
use palpate::scene::text::joined;

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
    pub(super) ending: Ending<D>,
    pub(super) circles: Circles<D>,
}

/// A result, and the time that it takes [ns].
pub(super) struct Timed<T> {
    pub(super) result: T,
    ns: u64,
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
                let ns = u64::try_from(least.as_nanos()).unwrap_or(u64::MAX);
                return Self { result, ns };
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
    let certified = Timed { result: proof.result.map_err(Failure::input)?, ns: proof.ns };
    let found = Timed::of(|| search.run(shape, &element));
    let answer = Answer {
        ending: Ending::of(shape, &found.result, &certified.result, size),
        circles: Circles::of(shape, &element),
        certified,
        element,
        search,
        found,
    };
    answer.print(options.json)?;
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

    fn print(&self, as_json: bool) -> Result<(), Failure> {
        if as_json { self.print_json() } else { self.print_text() }
    }

    fn print_json(&self) -> Result<(), Failure> {
        let Self { element, search, found, certified, .. } = self;
        let mut answer = described(&found.result);
        answer["method"] = search.method.name().into();
        if search.method == ElementMethod::Naive {
            answer["alpha"] = search.naive.alpha.into();
            answer["mu_m"] = search.naive.mu_for(element).into();
            answer["gradient"] = search.naive.gradient_in::<D>().name().into();
            answer["memoir_evaluations"] = self.memoir_count().into();
        }
        answer["time_ns"] = found.ns.into();
        answer["missed_by_m"] = self.missed_by().into();
        answer["ending"] = self.ending.described();
        answer["circles"] = self.circles.described();
        answer["certified"] = json!({
            "best_point_m": certified.result.best.0.to_vec(),
            "lower_m": certified.result.lower,
            "upper_m": certified.result.upper,
            "evaluations": certified.result.evaluations,
            "time_ns": certified.ns,
        });
        output::answer().json(&answer)?;
        Ok(())
    }

    fn print_text(&self) -> Result<(), Failure> {
        let (found, certified) = (&self.found.result, &self.certified.result);
        let [time, proof_time] = [self.found.ns, self.certified.ns].map(microseconds);
        let metres = |length: f64| format!("{length} m");
        let mut out = output::answer();
        writeln!(out, "method       {}", self.search.in_words(&self.element))?;
        writeln!(out, "best point   {} m", joined(&found.best.0))?;
        writeln!(out, "value        {} m, an upper bound", found.value)?;
        write!(out, "steps        {} ({} evaluations, {time}", found.steps, found.evaluations)?;
        match self.memoir_count() {
            Some(count) => writeln!(out, "; the memoir counts 10 a gradient: {count})")?,
            None => writeln!(out, ")")?,
        }
        writeln!(out, "ended        {}", self.ending.in_words(metres))?;
        let bounds = joined(&[certified.lower, certified.upper]);
        let evaluations = certified.evaluations;
        writeln!(out, "proven       [{bounds}] m ({evaluations} evaluations, {proof_time})")?;
        writeln!(out, "lowest at    {} m", joined(&certified.best.0))?;
        writeln!(out, "missed by    {} m, with the best point", self.missed_by())?;
        for circle in self.circles.all() {
            let words = circle.in_words(name_of::<N>(), metres);
            writeln!(out, "{} about {} m: {words}", circle.name, circle.centre())?;
        }
        Ok(())
    }
}
