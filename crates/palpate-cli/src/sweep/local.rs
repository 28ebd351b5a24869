// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Local searches for a first touch, beside the proven one.

use palpate::field::Shape;
use palpate::local::{
    ElementMethod, LocalSweep, PairMethod, SampledSweep, SpaceTimeGoldenSection,
};
use palpate::mesh::{Mesh, Outline, TriangleMesh};
use palpate::query::{Motion, Moving};
use palpate::scene::{BuiltScene, LocalFinding, SweptPart};

use super::figure;
use crate::ask;
use crate::outcome::Failure;
use crate::output::{self, shown};
use crate::picture::Dimensions;
use crate::sweep::SweepOptions;

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
    /// `None` if no method is asked for.
    pub(super) fn of(options: &SweepOptions) -> Result<Option<Self>, Failure> {
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
        // The gap of the proven search is known later.
        let sampled = SampledSweep::new(options.samples.unwrap_or(SAMPLES), 0.0);
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

    /// What the search finds of two bodies, beside a proven search for this gap [m]. A touch is
    /// half of the gap near, which no proof calls apart.
    pub(super) fn beside<const D: usize>(
        mut self,
        scene: &BuiltScene<D>,
        indices: [usize; 2],
        times: &[f64],
        gap: f64,
    ) -> Result<Option<LocalFinding>, Failure>
    where
        Dimensions: Surfaced<D>,
    {
        self.sampled.gap = 0.5 * gap;
        let of = indices.map(|body| &scene.bodies[body]);
        let Some(prepared) = self.prepared(of.map(|body| &body.shape_in_body)) else {
            let [a, b] = of.map(|body| shown(&body.name));
            output::remark(format!(
                "--method {} needs the surface of {a} or {b}, and the grid shows none of either: \
                 raise --cells, or take a method between fields, as sum_descent",
                self.name()
            ));
            return Ok(None);
        };
        let mut all =
            LocalFinding { method: self.name().to_owned(), ..LocalFinding::default() };
        for part in times.windows(2) {
            let &[from, to] = part else { continue };
            let ways = scene.ways(indices, SweptPart { from, to }).map_err(ask::failure)?;
            let found = self.first_touch(ways, &prepared)?;
            all.evaluations = all.evaluations.saturating_add(found.evaluations);
            all.searched = all.searched.saturating_add(found.searched);
            if let Some(touch) = found.touch {
                all.time = Some(from + (to - from) * touch.time);
                all.point = Some(touch.point.0.to_vec());
                all.value = Some(touch.value);
                break;
            }
        }
        Ok(Some(all))
    }

    /// What of two bodies is needed: the surface of the smaller one that has one, and its index. `None`
    /// if neither has.
    pub(super) fn prepared<const D: usize>(&self, shapes: [&Shape<D>; 2]) -> Option<Prepared<D>>
    where
        Dimensions: Surfaced<D>,
    {
        if matches!(self.method, Method::Pair(_)) {
            return Some(Prepared::Fields);
        }
        let size = |shape: &Shape<D>| {
            shape.promise().bounds.map_or(f64::INFINITY, |b| b.aabb.half_extents().norm())
        };
        let first = usize::from(size(shapes[0]) >= size(shapes[1]));
        let surface = |body: usize| {
            let surface = Dimensions::surface(shapes[body], self.cells)?;
            Some(Prepared::Surface { body, surface })
        };
        surface(first).or_else(|| surface(1 - first))
    }

    /// The first touch that it finds, of a motion over the time from 0 to 1.
    pub(super) fn first_touch<const D: usize>(
        &self,
        bodies: [Moving<'_, D>; 2],
        prepared: &Prepared<D>,
    ) -> Result<LocalSweep<D>, Failure>
    where
        Dimensions: Surfaced<D>,
    {
        let [a, b] = bodies;
        match (self.method, prepared) {
            (Method::Pair(method), _) => {
                self.sampled.of_pair(a, b, method).map_err(Failure::input)
            }
            (_, Prepared::Surface { body, surface }) => {
                Dimensions::touch(self, bodies[1 - body], surface, bodies[*body].motion)
            }
            (_, Prepared::Fields) => Err(Failure::input("--method needs a surface")),
        }
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

/// What a local search needs of two bodies.
pub(super) enum Prepared<const D: usize>
where
    Dimensions: Surfaced<D>,
{
    Fields,
    Surface { body: usize, surface: <Dimensions as Surfaced<D>>::Surface },
}

/// Dimensions in which shapes have surfaces of elements.
pub(super) trait Surfaced<const D: usize> {
    type Surface;

    /// The surface of a shape; `None` of one without bounds, or without a surface that the grid shows.
    fn surface(solid: &Shape<D>, cells: u32) -> Option<Self::Surface>;

    /// The first touch of a surface that moves, and a field.
    fn touch(
        search: &LocalSearch,
        field: Moving<'_, D>,
        surface: &Self::Surface,
        motion: Motion<D>,
    ) -> Result<LocalSweep<D>, Failure>;
}

impl Surfaced<2> for Dimensions {
    type Surface = Outline;

    fn surface(solid: &Shape<2>, cells: u32) -> Option<Outline> {
        figure::outline(solid, cells)
    }

    fn touch(
        search: &LocalSearch,
        field: Moving<'_, 2>,
        surface: &Outline,
        motion: Motion<2>,
    ) -> Result<LocalSweep<2>, Failure> {
        search.of_mesh(field, surface, motion)
    }
}

impl Surfaced<3> for Dimensions {
    type Surface = TriangleMesh;

    fn surface(solid: &Shape<3>, cells: u32) -> Option<TriangleMesh> {
        figure::triangles(solid, cells)
    }

    fn touch(
        search: &LocalSearch,
        field: Moving<'_, 3>,
        surface: &TriangleMesh,
        motion: Motion<3>,
    ) -> Result<LocalSweep<3>, Failure> {
        search.of_mesh(field, surface, motion)
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
