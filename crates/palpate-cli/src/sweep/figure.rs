// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Pictures of a first touch.

use contour::ContourBuilder;
use fast_surface_nets::ndshape::{RuntimeShape, Shape as _};
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use palpate::field::{Aabb, Point, Shape, Vector};
use palpate::mesh::{Mesh, Outline, TriangleMesh};
use palpate::plot::{
    Arrow, Arrows, Chart, ChartQuantity, Dash, Figure, Isolines, Markers, PlaneView, PlotError,
    Polyline, Sampling, Series, Slice,
};
use palpate::query::{Limits, PairWorkspace, Placed, SweepProof, SweepWorkspace, sweep_proof};
use palpate::scene::{BuiltScene, SweepAnswer, SweepPair, SweptPart};

use crate::outcome::Failure;
use crate::picture::{self, Dimensions, Drawable, cut, in_space};
use crate::plot::title;
use crate::sweep::SweepOptions;
use crate::{ask, plane};

/// Earlier times at which the bodies are drawn.
const EARLIER: u32 = 5;

/// Times at which the way of a point is drawn, and separations are searched.
const TIMES: u32 = 60;

/// Separations are shown over all parts of motions if so many times are within each.
const PARTS: u32 = 8;

/// How exactly separations are searched, as a share of what is shown.
const EXACT: f64 = 1e-5;

/// Bounds are shown both if they are farther apart than this share of the range.
const OPEN: f64 = 0.01;

/// The first touch of a pair of a scene.
struct Drawn<'a, const D: usize> {
    scene: &'a BuiltScene<D>,
    pair: &'a SweepPair<D>,
    /// When the bodies touch; the end of the time that is looked at if they are apart [s].
    time: f64,
    /// The bodies then.
    then: BuiltScene<D>,
    /// The times that are shown [s]: all that is looked at; of motions of many parts, the part in which
    /// the bodies touch.
    part: SweptPart,
    proof: SweepProof<D>,
    /// What is shown of the scene.
    bounds: Aabb<D>,
}

/// The figure of a pair.
pub(super) fn of<const D: usize>(
    options: &SweepOptions,
    scene: &BuiltScene<D>,
    answer: &SweepAnswer<D>,
    pair: &SweepPair<D>,
) -> Result<Figure, Failure>
where
    Dimensions: Drawable<D>,
{
    let drawn = Drawn::new(scene, answer, pair)?;
    let plane = drawn.plane(options.plane.as_deref())?;
    let mut caption = String::new();
    answer.write_pair(&mut caption, pair).map_err(Failure::input)?;
    caption.truncate(caption.trim_end().len());
    if D == 3 {
        caption = format!("{}; {caption}", plane::in_words(&plane));
    }
    let isolines = drawn.isolines(&plane).map_err(Failure::input)?;
    let chart = drawn.separations()?;
    let figure = Figure::new(title(&options.scene)).with_caption(caption);
    Ok(figure.with_isolines(isolines).with_chart(chart))
}

impl<'a, const D: usize> Drawn<'a, D>
where
    Dimensions: Drawable<D>,
{
    fn new(
        scene: &'a BuiltScene<D>,
        answer: &SweepAnswer<D>,
        pair: &'a SweepPair<D>,
    ) -> Result<Self, Failure> {
        let SweptPart { from, to } = pair.part;
        let [a, b] = scene.ways(pair.indices, pair.part).map_err(ask::failure)?;
        let settings = answer.settings(pair);
        let proof = sweep_proof(a, b, &settings, &mut SweepWorkspace::new());
        let proof = proof.map_err(Failure::input)?;
        let time = if pair.touch.upper < f64::INFINITY { pair.touch.upper } else { to };
        let then = scene.at(time).map_err(Failure::input)?;
        let is_short = (to - from) * f64::from(TIMES) < f64::from(PARTS) * answer.until;
        let part = if is_short { pair.part } else { SweptPart { from: 0.0, to: answer.until } };
        let bounds = Aabb::centred(Vector::ZERO);
        let mut drawn = Self { scene, pair, time, then, part, proof, bounds };
        drawn.bounds = drawn.shown()?;
        Ok(drawn)
    }

    /// A time before that of the touch [s], the `i`-th of `count`.
    fn before(&self, i: u32, count: u32) -> f64 {
        let from = self.part.from;
        from + (self.time - from) * f64::from(i) / f64::from(count)
    }

    /// The bodies of the pair that have motions.
    fn movers(&self) -> impl Iterator<Item = usize> {
        let moving: Vec<usize> = self.scene.moving().collect();
        self.pair.indices.into_iter().filter(move |body| moving.contains(body))
    }

    /// What holds both bodies until the touch; of a body without bounds, nothing.
    fn shown(&self) -> Result<Aabb<D>, Failure> {
        let mut shown: Option<Aabb<D>> = None;
        for body in self.pair.indices {
            let Some(bounds) = self.scene.bodies[body].shape_in_body.promise().bounds else {
                continue;
            };
            for i in 0..=EARLIER {
                let aabb =
                    bounds.aabb.placed(&self.scene.pose_at(body, self.before(i, EARLIER)));
                shown = Some(shown.map_or(aabb, |shown| shown.union(&aabb)));
            }
        }
        shown.ok_or_else(|| Failure::input("--plot needs a body with bounds in the pair"))
    }

    /// Where the bodies touch; the middle of what is shown if they do not.
    fn middle(&self) -> Point<D> {
        self.pair.touch.contact.map_or(self.bounds.centre(), |contact| contact.point_a)
    }

    /// The plane of an option; or along the normal of the touch and the motion there.
    fn plane(&self, asked: Option<&str>) -> Result<Slice, Failure> {
        if D < 3 {
            return Ok(Slice::planar());
        }
        let middle = in_space(self.middle());
        if let Some(asked) = asked {
            return plane::named("--plane", asked, None, Vector(middle));
        }
        let along = self.pair.touch.contact.and_then(|contact| {
            let way = self.movers().find_map(|body| {
                let before = self.time - 1e-3 * (self.time - self.part.from);
                let way = self.carried(body, self.time) - self.carried(body, before);
                way.normalized()
            })?;
            // Across the motion, the normal; of a touch along it, any axis.
            let across = contact.normal - way * contact.normal.dot(way);
            let axes =
                (0..D).map(Vector::unit).map(|axis: Vector<f64, D>| axis - way * axis.dot(way));
            let mut up = [across].into_iter().chain(axes).filter(|up| up.norm() > 1e-2);
            let up = up.next()?.normalized()?;
            // The y axis is up, unless it is across the plane.
            let upright = way * way[1] + up * up[1];
            let (right, up) = if upright.norm() > 0.1 {
                (way * up[1] - up * way[1], upright)
            } else {
                (way, up)
            };
            Slice::free(middle, in_space(right), in_space(up)).ok()
        });
        along.map_or_else(|| Slice::xy(middle[2]).map_err(Failure::input), Ok)
    }

    /// Where the point of a body that touches is at a time [s].
    fn carried(&self, body: usize, time: f64) -> Point<D> {
        let in_body = self.scene.pose_at(body, self.time).inverse();
        self.scene.pose_at(body, time).transform_point(in_body.transform_point(self.middle()))
    }

    fn isolines(&self, plane: &Slice) -> Result<Isolines, PlotError> {
        let view = Dimensions::view(plane, &self.bounds, picture::MARGIN)?;
        let mut isolines = picture::scene(&self.then, plane, &view)?;
        isolines = self.with_boxes(isolines, plane)?;
        for body in self.movers() {
            isolines = self.with_way(isolines, plane, &view, body)?;
        }
        let Some(contact) = &self.pair.touch.contact else { return Ok(isolines) };
        let at = plane.project(in_space(contact.point_a));
        let vector = plane.project_vector(in_space(contact.normal));
        Ok(isolines
            .with_arrows(Arrows::directions("normal", [Arrow { tail: at, vector }])?)
            .with_markers(Markers::new("first touch", [at])?))
    }

    /// With the boxes that were ruled out: for all of the time, and until the touch.
    fn with_boxes(&self, isolines: Isolines, plane: &Slice) -> Result<Isolines, PlotError> {
        let cuts = |is_for_ever: bool| {
            let boxes = self.proof.boxes.iter();
            let boxes = boxes.filter(move |part| (part.until >= 1.0) == is_for_ever);
            boxes.filter_map(|part| cut(&part.aabb, &self.proof.world_from_boxes, plane))
        };
        let mut isolines = isolines;
        let kinds = [
            ("no touch there at any time", Dash::Solid),
            ("no touch there for a part of the time", Dash::Dotted),
        ];
        for ((name, dash), is_for_ever) in kinds.into_iter().zip([true, false]) {
            if cuts(is_for_ever).next().is_some() {
                let boxes = Polyline::of_pieces(name, cuts(is_for_ever))?.faint();
                isolines = isolines.with_polyline(boxes.with_dash(dash));
            }
        }
        Ok(isolines)
    }

    /// With a body at earlier times, and the way of the point that touches.
    fn with_way(
        &self,
        isolines: Isolines,
        plane: &Slice,
        view: &PlaneView,
        body: usize,
    ) -> Result<Isolines, PlotError> {
        let BuiltScene { bodies, .. } = self.scene;
        let mut lines = Vec::new();
        for i in 0..EARLIER {
            let pose = self.scene.pose_at(body, self.before(i, EARLIER));
            let Ok(shape) = bodies[body].shape_in_body.clone().placed(&pose) else { continue };
            let outline = picture::outline(&shape, plane, view, Sampling::default())?;
            lines.extend(outline.lines().iter().cloned());
        }
        let name = &bodies[body].name;
        let earlier = Polyline::of_pieces(format!("{name} before"), lines)?;
        let isolines = isolines.with_polyline(earlier.with_dash(Dash::Dashed));
        if self.pair.touch.contact.is_none() {
            return Ok(isolines);
        }
        let carried = |i| plane.project(in_space(self.carried(body, self.before(i, TIMES))));
        let way =
            Polyline::new(format!("way of the point of {name}"), (0..=TIMES).map(carried))?;
        Ok(isolines.with_polyline(way))
    }

    /// The separation over the times that are shown.
    fn separations(&self) -> Result<Chart, Failure> {
        let SweptPart { from, to } = self.part;
        let mut times: Vec<f64> = (0..=TIMES)
            .map(|i| from + (to - from) * f64::from(i) / f64::from(TIMES))
            .chain([self.time])
            .filter(|time| (from..=to).contains(time))
            .collect();
        times.sort_by(f64::total_cmp);
        let limits = Limits::new(EXACT * 2.0 * self.bounds.half_extents().norm());
        let mut workspace = PairWorkspace::new();
        let (mut lower, mut upper) = (Vec::new(), Vec::new());
        for time in times {
            let [a, b] = self.pair.indices.map(|body| {
                Placed::new(
                    &self.scene.bodies[body].shape_in_body,
                    self.scene.pose_at(body, time),
                )
            });
            let apart = palpate::query::separation(a, b, &limits, &mut workspace);
            let apart = apart.map_err(Failure::input)?;
            lower.push([time, apart.lower]);
            upper.push([time, apart.upper]);
        }
        let values = || upper.iter().map(|point| point[1]);
        let least = values().fold(f64::INFINITY, f64::min);
        let most = values().fold(f64::NEG_INFINITY, f64::max);
        let is_open = |(lower, upper): (&[f64; 2], &[f64; 2])| {
            lower[1].is_finite() && upper[1] - lower[1] > OPEN * (most - least)
        };
        let are_open = lower.iter().zip(&upper).any(is_open);
        let mut chart =
            Chart::new(ChartQuantity::new("time", "s"), ChartQuantity::new("separation", "m"));
        let name = if are_open { "separation at most" } else { "separation" };
        chart = chart.with_series(Series::new(name, upper).map_err(Failure::input)?);
        if are_open {
            let lower = lower.into_iter().filter(|point: &[f64; 2]| point[1].is_finite());
            let lower = Series::new("and at least", lower.collect::<Vec<_>>())
                .map_err(Failure::input)?;
            chart = chart.with_series(lower.with_dash(Dash::Dotted));
        }
        if self.pair.touch.upper < f64::INFINITY && self.pair.touch.contact.is_some() {
            let touch = [[self.time, least], [self.time, most]];
            let touch = Series::new("first touch", touch).map_err(Failure::input)?;
            chart = chart.with_series(touch.with_dash(Dash::Dashed));
        }
        Ok(chart)
    }
}

/// Cells between the shape's box and the edge of the grid.
const AROUND: f64 = 2.0;

/// The places of a grid around a shape's box.
struct Grid<const D: usize> {
    origin: Point<D>,
    /// The edge of a cell [m].
    cell: f64,
    counts: [u32; D],
}

impl<const D: usize> Grid<D> {
    /// With this many cells along the longest side of the box; `None` of a shape without bounds.
    fn around(shape: &Shape<D>, cells: u32) -> Option<Self> {
        let bounds = shape.promise().bounds?.aabb;
        let sides = bounds.max - bounds.min;
        let longest = sides.0.into_iter().fold(0.0, f64::max);
        let cell = longest / f64::from(cells);
        let counts = sides.0.map(|side| (side / cell + 2.0 * AROUND).ceil() as u32 + 1);
        let origin = bounds.min - Vector::constant(AROUND * cell);
        (cell > 0.0).then_some(Self { origin, cell, counts })
    }

    fn place(&self, index: [f64; D]) -> Point<D> {
        self.origin + Vector(index) * self.cell
    }

    /// The nearest point of the surface, of one that the grid puts near it.
    fn on_surface(&self, shape: &Shape<D>, index: [f64; D]) -> Point<D> {
        let near = self.place(index);
        let there = shape.surface_point(near);
        // Where fields are bounds, the way to the surface may end elsewhere.
        there.filter(|there| (*there - near).norm() <= self.cell).unwrap_or(near)
    }
}

/// The outline of a planar shape, by marching squares.
pub(super) fn outline(shape: &Shape<2>, cells: u32) -> Option<Outline> {
    let grid = Grid::around(shape, cells)?;
    let [columns, rows] = grid.counts.map(|count| count as usize);
    let places = (0..rows).flat_map(|y| (0..columns).map(move |x| [x as f64, y as f64]));
    // Negated: lines are around what is at least the level.
    let values: Vec<f64> = places.map(|index| -shape.distance(grid.place(index))).collect();
    let lines =
        ContourBuilder::new(columns, rows, true).lines(&values, &[0.0]).unwrap_or_default();
    let (mut vertices, mut elements) = (Vec::new(), Vec::new());
    for ring in lines.into_iter().flat_map(|line| line.into_inner().0.0) {
        // The last point is the first.
        let points = &ring.0[1..];
        let first = vertices.len() as u32;
        let count = points.len() as u32;
        // Lines are drawn between the middles of the grid's cells.
        let at = points.iter().map(|p| grid.on_surface(shape, [p.x - 0.5, p.y - 0.5]));
        vertices.extend(at);
        elements.extend((0..count).map(|k| [first + k, first + (k + 1) % count]));
    }
    // Without elements there is no surface.
    Mesh::new(vertices, elements).ok()
}

/// The surface of a solid, by surface nets.
pub(super) fn triangles(shape: &Shape<3>, cells: u32) -> Option<TriangleMesh> {
    let grid = Grid::around(shape, cells)?;
    let places = RuntimeShape::<u32, 3>::new(grid.counts);
    let values: Vec<f32> = (0..places.size())
        .map(|k| shape.distance(grid.place(places.delinearize(k).map(f64::from))))
        .map(|value| (value / grid.cell) as f32)
        .collect();
    let mut surface = SurfaceNetsBuffer::default();
    surface_nets(&values, &places, [0; 3], grid.counts.map(|count| count - 1), &mut surface);
    let at = |p: &[f32; 3]| grid.on_surface(shape, p.map(f64::from));
    let vertices = surface.positions.iter().map(at).collect();
    let faces =
        surface.indices.chunks_exact(3).map(|face| [face[0], face[1], face[2]]).collect();
    Mesh::new(vertices, faces).ok()
}

#[cfg(test)]
mod surface_tests {
    use super::*;

    #[test]
    fn a_ball_and_a_ring_have_their_surfaces() {
        let ball = Shape::<3>::ball(0.3).unwrap().translated(Vector([1.0, -2.0, 0.5])).unwrap();
        let surface = triangles(&ball, 32).unwrap();
        let report = surface.report();
        assert!(report.is_watertight(), "{report}");
        let volume = report.enclosed.unwrap();
        let truth = 4.0 / 3.0 * std::f64::consts::PI * 0.027;
        assert!((volume - truth).abs() < 0.01 * truth, "{volume}, {truth}");
        let disc = Shape::<2>::ball(0.3).unwrap();
        let ring = disc.shell(0.1).unwrap();
        let outline = outline(&ring, 64).unwrap();
        assert!(outline.vertices().iter().all(|p| ring.distance(*p).abs() < 1e-9));
        let length: f64 = (0..outline.elements().len())
            .map(|k| outline.corners(k))
            .map(|[a, b]| (a - b).norm())
            .sum();
        // Both circles, of 0.25 m and 0.35 m.
        let truth = std::f64::consts::TAU * 0.6;
        assert!((length - truth).abs() < 0.01 * truth, "{length}, {truth}");
    }
}
