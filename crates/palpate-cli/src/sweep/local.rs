// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Local searches for a first touch, beside the proven one.

use palpate::field::Shape;
use palpate::local::{
    ElementMethod, LocalSweep, PairMethod, SampledSweep, SpaceTimeGoldenSection,
};
use palpate::mesh::Mesh;
use palpate::query::{Motion, Moving};

use super::surface;
use crate::arguments::SweepOptions;
use crate::outcome::Failure;
use crate::picture::Dimensions;

/// Steps of time.
const SAMPLES: u32 = 60;

/// Cells along the longest side of a body.
const CELLS: u32 = 64;

/// A local search, as the options ask for it.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalSearch {
    method: Method,
    cells: u32,
    sampled: SampledSweep,
}

#[derive(Clone, Copy, Debug)]
enum Method {
    SpaceTime,
    Element(ElementMethod),
    Pair(PairMethod),
}

impl LocalSearch {
    /// `None` if no method is asked for. A touch is half of the gap near, which no proof calls apart.
    pub(super) fn of(options: &SweepOptions, gap: f64) -> Result<Option<Self>, Failure> {
        let Some(name) = options.method.as_deref() else { return Ok(None) };
        let method = match name.parse() {
            Ok(ElementMethod::GoldenSection) => Method::SpaceTime,
            Ok(method) => Method::Element(method),
            Err(_) => Method::Pair(name.parse().map_err(|_| unknown(name))?),
        };
        for (option, is_given, is_for) in [
            ("--samples", options.samples.is_some(), !matches!(method, Method::SpaceTime)),
            ("--cells", options.cells.is_some(), !matches!(method, Method::Pair(_))),
        ] {
            if is_given && !is_for {
                return Err(Failure::input(format!("{option} is not for --method {name}")));
            }
        }
        let sampled = SampledSweep::new(options.samples.unwrap_or(SAMPLES), 0.5 * gap);
        Ok(Some(Self { method, cells: options.cells.unwrap_or(CELLS), sampled }))
    }

    /// Its name.
    pub(super) fn name(&self) -> &'static str {
        match self.method {
            Method::SpaceTime => ElementMethod::GoldenSection.name(),
            Method::Element(method) => method.name(),
            Method::Pair(method) => method.name(),
        }
    }

    /// The first touch that it finds, of a motion over the time from 0 to 1.
    pub(super) fn first_touch<const D: usize>(
        &self,
        [a, b]: [Moving<'_, D>; 2],
    ) -> Result<LocalSweep<D>, Failure>
    where
        Dimensions: Surfaced<D>,
    {
        if let Method::Pair(method) = self.method {
            return self.sampled.of_pair(a, b, method).map_err(Failure::input);
        }
        let size = |body: &Moving<'_, D>| {
            body.shape.promise().bounds.map_or(f64::INFINITY, |b| b.aabb.half_extents().norm())
        };
        let [field, solid] = if size(&a) < size(&b) { [b, a] } else { [a, b] };
        Dimensions::touch(self, field, solid.shape, solid.motion)
    }

    fn of_mesh<const N: usize, const D: usize>(
        &self,
        field: Moving<'_, D>,
        mesh: &Mesh<N, D>,
        motion: Motion<D>,
    ) -> Result<LocalSweep<D>, Failure> {
        let gap = self.sampled.gap;
        let found = match self.method {
            Method::Element(method) => self.sampled.of_mesh(field, mesh, motion, method),
            _ => {
                SpaceTimeGoldenSection::default().first_touch_of_mesh(field, mesh, motion, gap)
            }
        };
        found.map_err(Failure::input)
    }
}

/// Dimensions in which shapes have surfaces of elements.
pub(super) trait Surfaced<const D: usize> {
    /// The first touch of the surface of a shape that moves, and a field.
    fn touch(
        search: &LocalSearch,
        field: Moving<'_, D>,
        solid: &Shape<D>,
        motion: Motion<D>,
    ) -> Result<LocalSweep<D>, Failure>;
}

impl Surfaced<2> for Dimensions {
    fn touch(
        search: &LocalSearch,
        field: Moving<'_, 2>,
        solid: &Shape<2>,
        motion: Motion<2>,
    ) -> Result<LocalSweep<2>, Failure> {
        search.of_mesh(field, &surface::outline(solid, search.cells)?, motion)
    }
}

impl Surfaced<3> for Dimensions {
    fn touch(
        search: &LocalSearch,
        field: Moving<'_, 3>,
        solid: &Shape<3>,
        motion: Motion<3>,
    ) -> Result<LocalSweep<3>, Failure> {
        search.of_mesh(field, &surface::triangles(solid, search.cells)?, motion)
    }
}

fn unknown(name: &str) -> Failure {
    let elements = ElementMethod::ALL.iter().map(|method| method.name());
    let pairs = PairMethod::ALL.iter().map(|method| method.name());
    let known: Vec<_> = elements.chain(pairs).collect();
    Failure::input(format!(
        "--method: there is no method {name:?}; there are {}",
        known.join(", ")
    ))
}
