// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Local searches for a point in two bodies, beside their proven separation.

use std::fmt;
use std::path::Path;

use palpate::field::{Aabb, Point};
use palpate::local::{Descent, ElementMethod, PairMethod, halton_starts};
use palpate::plot::{Figure, Markers, PlotError, Polyline, Slice};
use palpate::query::{Certified, Nearest, PairWorkspace, separation};
use palpate::scene::BuiltScene;
use palpate::scene::text::joined;
use serde::Serialize;

use super::{Found, limits, method, refuse_naive, written};
use crate::descend::DescendOptions;
use crate::input::{self, longest_edge};
use crate::outcome::{Failure, Outcome};
use crate::output;
use crate::picture::{self, Dimensions, Drawable, Picture, in_space};
use crate::plot::title;

/// The result of the search from each start, and the proven separation.
struct Answer<'a, const D: usize> {
    method: PairMethod,
    bodies: [&'a str; 2],
    found: Vec<Descent<D>>,
    certified: Certified<Nearest<D>>,
}

/// Searches between the first two bodies of a scene, from each start.
pub(super) fn between<const D: usize>(
    options: &DescendOptions,
    scene: &BuiltScene<D>,
    picture: Option<&Picture>,
) -> Result<Outcome, Failure>
where
    Dimensions: Drawable<D>,
{
    let [a, b, ..] = scene.bodies.as_slice() else {
        let count = scene.bodies.len();
        let problem =
            format!("--start needs a scene with two bodies or more, this has {count}");
        return Err(Failure::input(problem));
    };
    let bounds = input::bounds(scene)?;
    let limits = limits(options.tolerance, longest_edge(&bounds));
    refuse_naive(options)?;
    let needs = "searches over an element: give --triangle or --segment";
    let first = PairMethod::AlternatingProjection;
    let method = method::<_, ElementMethod>(options, first, needs)?;
    let starts = match options.halton {
        Some(count) => halton_starts(&a.shape, &b.shape, count),
        None => {
            options.start.iter().map(|start| input::point(start)).collect::<Result<_, _>>()?
        }
    };
    if starts.is_empty() {
        return Err(Failure::input(
            "--halton starts in the common part of both bodies' boxes, and there is none",
        ));
    }
    let mut found = Vec::new();
    for start in starts {
        let descent = method.descend(&a.shape, &b.shape, start, limits.tolerance);
        found.push(descent.map_err(Failure::input)?);
    }
    let mut workspace = PairWorkspace::new();
    let certified = separation(&a.shape, &b.shape, &limits, &mut workspace);
    let certified = certified.map_err(Failure::input)?;
    let answer = Answer { method, bodies: [&a.name, &b.name], found, certified };
    let report = Report {
        method: answer.method.name(),
        bodies: answer.bodies.map(str::to_owned),
        descents: answer.found.iter().map(Found::from).collect(),
        certified: answer.certified,
    };
    output::answer().print(&report, options.json)?;
    if let Some(picture) = picture {
        let figure = answer.figure(scene, &bounds, &options.scene).map_err(Failure::input)?;
        picture.save(&figure, picture::WIDTH)?;
    }
    Ok(Outcome::Yes)
}

impl<const D: usize> Answer<'_, D> {
    /// The paths over the isolines; in space, on the plane xy through the point at which the
    /// separation is proven.
    fn figure(
        &self,
        scene: &BuiltScene<D>,
        bounds: &Aabb<D>,
        name: &Path,
    ) -> Result<Figure, PlotError>
    where
        Dimensions: Drawable<D>,
    {
        let [_, _, depth] = in_space(self.certified.best.point);
        let plane = if D < 3 { Slice::planar() } else { Slice::xy(depth)? };
        let on_plane = |p: &Point<D>| plane.project(in_space(*p));
        let view = Dimensions::view(&plane, bounds, picture::MARGIN)?;
        let mut isolines = picture::scene(scene, &plane, &view)?;
        for (i, found) in self.found.iter().enumerate() {
            let path = format!("{} {}", self.method, i + 1);
            let path = Polyline::new(path, found.path.iter().map(on_plane))?;
            isolines = isolines.with_polyline(path);
        }
        let starts = self.found.iter().filter_map(|found| found.path.first());
        let best = self.found.iter().map(|found| on_plane(&found.best));
        let proven = [on_plane(&self.certified.best.point)];
        let isolines = isolines
            .with_markers(Markers::new("start", starts.map(on_plane))?)
            .with_markers(Markers::new("best found", best)?)
            .with_markers(Markers::new("proven", proven)?);
        // Of exact fields, twice the larger value at any point is an upper bound of the separation.
        let found: Vec<_> = self.found.iter().map(|found| written(2.0 * found.value)).collect();
        let [lower, upper] = [self.certified.lower, self.certified.upper].map(written);
        let caption = format!(
            "Twice the value found: {}; proven separation: {lower} to {upper}.",
            found.join(", ")
        );
        Ok(Figure::new(title(name)).with_caption(caption).with_isolines(isolines))
    }
}

/// The answer of `palpate descend` between two bodies.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Report<const D: usize> {
    /// The name of the search.
    method: &'static str,
    /// The names of the bodies.
    bodies: [String; 2],
    /// What was found from each start.
    descents: Vec<Found>,
    /// The proven separation.
    certified: Certified<Nearest<D>>,
}

impl<const D: usize> fmt::Display for Report<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { method, bodies: [a, b], descents, certified } = self;
        writeln!(f, "method       {method}, between {a:?} and {b:?}")?;
        for found in descents {
            let start = found.path.first().map_or_else(String::new, |p| joined(p));
            let kind = if found.value <= 0.0 { "a point in both" } else { "no point in both" };
            writeln!(f, "from         {start} m: {kind}")?;
            writeln!(f, "  best point {} m", joined(&found.best))?;
            writeln!(
                f,
                "  value      {} m, the larger of both fields; where both are exact, the separation is at most twice \
                 that, {} m",
                found.value,
                2.0 * found.value
            )?;
            writeln!(f, "  steps      {} ({} evaluations)", found.steps, found.evaluations)?;
        }
        let bounds = joined(&[certified.lower, certified.upper]);
        let evaluations = certified.evaluations;
        writeln!(f, "proven       separation [{bounds}] m ({evaluations} evaluations)")?;
        writeln!(f, "at           {} m", joined(&certified.best.point.0))
    }
}
