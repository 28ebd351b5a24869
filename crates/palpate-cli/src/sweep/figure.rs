// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The first touch of two bodies, drawn: where it is, how the bodies came there, and the boxes of
//! space that were ruled out until then.

use palpate::field::{Aabb, Point, Vector};
use palpate::plot::{
    Arrow, Arrows, Chart, ChartQuantity, Dash, Figure, Isolines, Markers, PlaneView, PlotError,
    Polyline, Sampling, Series, Slice,
};
use palpate::query::{Limits, PairWorkspace, Placed, SweepProof, SweepWorkspace, sweep_proof};
use palpate::scene::{BuiltScene, SweepAnswer, SweepPair, SweptPart};

use crate::arguments::SweepOptions;
use crate::ask;
use crate::outcome::Failure;
use crate::picture::{self, Dimensions, Drawable, cut, in_space};
use crate::plane;
use crate::plot::title;

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
