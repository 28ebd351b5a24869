// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What is drawn: bodies, ground, cut faces and their surfaces.

use palpate_field::{
    Aabb, BLOCK, Block, BoundingBall, Column, Node, Point, Shape, ShapeError, Vector,
};
use palpate_query::QueryError;

use crate::beam::{Beam, Bundle, Extent};
use crate::camera::Camera;
use crate::image::{Light, SrgbColor};
use crate::light::key_direction;
use crate::render::{RenderError, Settings};
use crate::trace::Tracer;

/// How far bodies without bounds are drawn, in radii of the ball around those that have bounds.
const FAR: f64 = 12.0;

/// Half the side of the cube that is shown of a scene without bounds [m].
const HALF_SIDE: f64 = 0.5;

/// A shape in the world, and its colour.
#[derive(Clone, Debug)]
pub struct LitBody {
    /// The shape.
    pub shape: Shape<3>,
    /// The colour.
    pub color: SrgbColor,
}

/// A plane through bodies: what lies on the side to which the normal points is cut away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// A point of the plane [m].
    pub(crate) point: Point<3>,
    /// The unit normal.
    pub(crate) normal: Vector<f64, 3>,
}

impl Cut {
    /// The plane through `point` [m] that is perpendicular to `normal`.
    ///
    /// ```
    /// use palpate_render::{Cut, Settings};
    ///
    /// let cut = Cut::new([0.0, 0.0, 0.01], [0.0, 0.0, 2.0])?;
    /// let settings = Settings { cut: Some(cut), ..Settings::new(64, 48) };
    /// assert!(Cut::new([0.0; 3], [0.0; 3]).is_err());
    /// # Ok::<(), palpate_render::RenderError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the point is not finite or beyond 1e15, or the normal has no direction.
    pub fn new(
        point: impl Into<Point<3>>,
        normal: impl Into<Vector<f64, 3>>,
    ) -> Result<Self, RenderError> {
        let (point, normal) = (point.into(), normal.into());
        QueryError::check_point("a point of a cut", point)?;
        let wrong = RenderError::NoPlane { what: "the normal of a cut", got: normal.0 };
        let normal = normal.normalized().ok_or(wrong)?;
        Ok(Self { point, normal })
    }

    /// The distance of a point from the plane, positive where bodies are cut away [m].
    pub(crate) fn elevation(&self, point: Point<3>) -> f64 {
        (point - self.point).dot(self.normal)
    }
}

/// The bodies of a picture.
#[derive(Clone, Debug)]
pub struct Subject {
    bodies: Vec<LitBody>,
}

impl Subject {
    /// These bodies.
    ///
    /// # Errors
    ///
    /// [`RenderError::NoBody`].
    pub fn new(bodies: Vec<LitBody>) -> Result<Self, RenderError> {
        if bodies.is_empty() { Err(RenderError::NoBody) } else { Ok(Self { bodies }) }
    }

    /// Shapes in the colours of [`SrgbColor::BODIES`].
    ///
    /// # Errors
    ///
    /// [`RenderError::NoBody`].
    pub fn of_shapes(shapes: impl IntoIterator<Item = Shape<3>>) -> Result<Self, RenderError> {
        let body = |(i, shape)| LitBody { shape, color: SrgbColor::of_body(i) };
        Self::new(shapes.into_iter().enumerate().map(body).collect())
    }

    /// The bodies.
    #[must_use]
    pub fn bodies(&self) -> &[LitBody] {
        &self.bodies
    }

    /// The box around all bodies that have bounds; a cube of a metre about the origin if none
    /// has.
    #[must_use]
    pub fn bounds(&self) -> Aabb<3> {
        let boxes = self.bodies.iter().filter_map(|body| body.shape.promise().bounds);
        let all = boxes.map(|bounds| bounds.aabb).reduce(|a, b| a.union(&b));
        all.unwrap_or_else(|| Aabb::centred(Vector::constant(HALF_SIDE)))
    }

    /// The corners of that box.
    #[must_use]
    pub fn corners(&self) -> [Point<3>; 8] {
        let Aabb { min, max } = self.bounds();
        let side = |code: usize, k: usize| if code >> k & 1 == 1 { max[k] } else { min[k] };
        std::array::from_fn(|code| Vector(std::array::from_fn(|k| side(code, k))))
    }

    /// `true` if every body has bounds.
    #[must_use]
    pub fn is_bounded(&self) -> bool {
        self.bodies.iter().all(|body| body.shape.promise().bounds.is_some())
    }

    /// The ball beyond which bodies without bounds are not drawn.
    #[must_use]
    pub fn horizon(&self) -> BoundingBall<3> {
        let bounds = self.bounds();
        let radius = bounds.half_extents().norm();
        // A scene of one point has a horizon too.
        let radius = if radius > 0.0 { radius } else { HALF_SIDE };
        BoundingBall { centre: bounds.centre(), radius: FAR * radius }
    }
}

/// How near a field must come to zero to be a surface, in pixels.
const GAP: f64 = 1.0 / 32.0;

/// The radius of curves and sheets without interior, in pixels: thinner ones would pass between
/// the middles of pixels.
const THIN: f64 = 0.6;

/// How far the sky is looked for, as a share of the scene's size.
const REACH: f64 = 0.16;

/// The distance between isolines on a cut face, as a share of the scene's size, before it is
/// rounded.
const SPACING: f64 = 0.025;

/// All that a picture is made of.
#[derive(Debug)]
pub(crate) struct Studio {
    pub(crate) surfaces: Surfaces,
    pub(crate) camera: Camera,
    pub(crate) settings: Settings,
    /// The unit vector towards the key light.
    pub(crate) key: Vector<f64, 3>,
    pub(crate) background: Light,
    /// How far the sky is looked for [m].
    pub(crate) reach: f64,
    /// Between the isolines on a cut face [m].
    pub(crate) spacing: f64,
    /// The radius of curves and sheets [m].
    pub(crate) thin: f64,
}

impl Studio {
    pub(crate) fn new(
        subject: &Subject,
        camera: &Camera,
        settings: &Settings,
    ) -> Result<Self, RenderError> {
        settings.check()?;
        let pixel = camera.pixel(settings.height);
        let (gap, thin) = (GAP * pixel, THIN * pixel);
        let surfaces = Surfaces::new(subject, settings.cut, gap, thin)?;
        let size = 2.0 * subject.bounds().half_extents().norm();
        let studio = Self {
            surfaces,
            camera: *camera,
            settings: *settings,
            key: key_direction(camera.sight()),
            background: SrgbColor::BACKGROUND.light(),
            reach: REACH * size,
            spacing: settings.spacing.unwrap_or_else(|| round(SPACING * size)),
            thin,
        };
        studio.check_eye()?;
        Ok(studio)
    }

    /// The part of a beam in which there may be surfaces, its cone included.
    pub(crate) fn cut(&self, beam: &Beam) -> Beam {
        let extent = &self.surfaces.extent;
        extent.cut(beam, beam.radius(extent.farthest(beam.origin)))
    }

    /// For rays through its surfaces.
    pub(crate) fn tracer(&self) -> Tracer<'_> {
        Tracer::new(&self.surfaces, self.settings.budget)
    }

    /// Refuses a camera within a body.
    fn check_eye(&self) -> Result<(), RenderError> {
        let eye = self.camera.eye();
        if self.camera.is_orthographic() {
            return Ok(());
        }
        let is_inside = |surface: &Surface| surface.distance(eye) <= 0.0;
        match self.surfaces.bodies.iter().position(is_inside) {
            None => Ok(()),
            Some(body) => Err(RenderError::Inside { body, from: eye.0 }),
        }
    }
}

/// The nearest number of 1, 2 or 5 times a power of ten that is not less.
fn round(length: f64) -> f64 {
    let power = libm::pow(10.0, libm::floor(libm::log10(length)));
    let steps = [1.0, 2.0, 5.0, 10.0];
    let step = steps.into_iter().find(|step| step * power >= length * (1.0 - 1e-12));
    step.unwrap_or(10.0) * power
}

/// How much of the bands is white, one after the other.
const PALE: [f64; 2] = [0.58, 0.42];

/// How dark the lines between bands are, and the outline of the body.
const LINE: f64 = 0.38;
const OUTLINE: f64 = 0.85;

/// Half the widths of lines and outline [pixels].
const HALF_LINE: f64 = 0.5;
const HALF_OUTLINE: f64 = 1.5;

/// The light of a place whose field is `level` isolines from the surface, where a pixel is `pixel`
/// of the distance between isolines.
pub(crate) fn light(body: Light, level: f64, pixel: f64) -> Light {
    let nearest = level.round();
    let away = (level - nearest).abs() / pixel;
    let half = if nearest == 0.0 { HALF_OUTLINE } else { HALF_LINE };
    // A line is as sharp as a pixel.
    let line = (half + 0.5 - away).clamp(0.0, 1.0);
    let (below, above) = (band(level.floor()), band(level.floor() + 1.0));
    // So is the step from band to band, which a line covers.
    let share = ((level - level.floor() - 1.0) / pixel + 0.5).clamp(0.0, 1.0);
    let pale = below + share * (above - below);
    let dark = if nearest == 0.0 { OUTLINE } else { LINE };
    body.mixed(Light::white(1.0), pale) * (1.0 - dark * line)
}

/// How pale a band is.
fn band(index: f64) -> f64 {
    PALE[usize::from(index.rem_euclid(2.0) >= 1.0)]
}

/// The bodies as rays meet them.
#[derive(Debug)]
pub(crate) struct Surfaces {
    pub(crate) bodies: Vec<Surface>,
    /// The shapes that together are all bodies.
    parts: Vec<Part>,
    /// The union of all.
    pub(crate) whole: Shape<3>,
    pub(crate) extent: Extent,
    pub(crate) cut: Option<Cut>,
    /// A ray meets a surface where the field is at most this [m].
    pub(crate) gap: f64,
}

/// A body as rays meet it.
#[derive(Debug)]
pub(crate) struct Surface {
    /// The body, thickened and cut.
    shape: Shape<3>,
    /// The body, thickened.
    pub(crate) uncut: Shape<3>,
    pub(crate) light: Light,
    /// The ball around it; `None` without bounds.
    ball: Option<BoundingBall<3>>,
}

/// A member of a union.
#[derive(Debug)]
struct Part {
    shape: Shape<3>,
    ball: Option<BoundingBall<3>>,
    /// Whether the field is at least the distance to the ball.
    is_above_ball: bool,
}

impl Surface {
    /// The field of the body, thickened and cut, at a point [m].
    pub(crate) fn distance(&self, point: Point<3>) -> f64 {
        self.shape.distance(point)
    }
}

impl Surfaces {
    /// The bodies of `subject`: curves and sheets with a radius of `thin`, surfaces where fields
    /// are at most `gap`; both [m].
    pub(crate) fn new(
        subject: &Subject,
        cut: Option<Cut>,
        gap: f64,
        thin: f64,
    ) -> Result<Self, ShapeError> {
        let mut parts = Vec::new();
        let mut surface = |body: &LitBody| {
            let mut uncut = Vec::new();
            take_apart(&body.shape, thin, &mut uncut)?;
            let shapes = uncut.iter().map(|part| kept(part, cut));
            let shapes = shapes.collect::<Result<Vec<_>, ShapeError>>()?;
            parts.extend(shapes.iter().zip(&uncut).map(|(shape, uncut)| Part {
                shape: shape.clone(),
                ball: uncut.promise().bounds.map(|bounds| bounds.ball),
                is_above_ball: uncut.promise().above_bounds,
            }));
            let (shape, uncut) = (Shape::union(shapes)?, Shape::union(uncut)?);
            let ball = uncut.promise().bounds.map(|bounds| bounds.ball);
            Ok(Surface { shape, uncut, light: body.color.light(), ball })
        };
        let bodies = subject.bodies().iter().map(&mut surface);
        let bodies = bodies.collect::<Result<Vec<_>, ShapeError>>()?;
        let whole = Shape::union(parts.iter().map(|part| part.shape.clone()))?;
        let extent = if subject.is_bounded() {
            Extent::Box(subject.bounds().grown(thin))
        } else {
            Extent::Ball(subject.horizon())
        };
        Ok(Self { bodies, parts, whole, extent, cut, gap })
    }

    /// The union of the parts that some of these beams may meet; `None` if there are none.
    pub(crate) fn along(&self, beams: &[Beam]) -> Option<Shape<3>> {
        let bundle = Bundle::around(beams.iter().filter(|beam| beam.near < beam.far))?;
        self.union_of(|part| part.ball.is_none_or(|ball| bundle.may_meet(&ball)))
    }

    /// The union of the parts whose fields may be less than `reach` at these points [m]; `None` if
    /// there are none.
    pub(crate) fn around(&self, points: &[Point<3>], reach: f64) -> Option<Shape<3>> {
        let all = ball_around(points)?;
        self.union_of(|part| {
            let ball = part.ball.filter(|_| part.is_above_ball);
            ball.is_none_or(|ball| gap_between(&ball, &all) <= reach)
        })
    }

    fn union_of(&self, is_near: impl Fn(&Part) -> bool) -> Option<Shape<3>> {
        let near: Vec<_> = self.parts.iter().filter(|part| is_near(part)).collect();
        if near.len() == self.parts.len() {
            return Some(self.whole.clone());
        }
        // A union of fewer members is no deeper than that of all.
        Shape::union(near.into_iter().map(|part| part.shape.clone())).ok()
    }

    /// `true` where the face of the cut lies nearer than the body's own surface.
    pub(crate) fn is_cut_face(&self, body: usize, point: Point<3>) -> bool {
        let above = |cut: Cut| cut.elevation(point) > self.bodies[body].uncut.distance(point);
        self.cut.is_some_and(above)
    }
}

/// What is left of a shape that is cut.
fn kept(shape: &Shape<3>, cut: Option<Cut>) -> Result<Shape<3>, ShapeError> {
    let Some(Cut { point, normal }) = cut else { return Ok(shape.clone()) };
    Shape::intersection([shape.clone(), Shape::half_space(normal, point.dot(normal))?])
}

/// Takes a shape apart into the members of its unions. Curves and sheets become as thick as
/// `2 radius` [m]; where an operator other than a union or a motion holds them, they are as thick
/// as they are.
fn take_apart(
    shape: &Shape<3>,
    radius: f64,
    parts: &mut Vec<Shape<3>>,
) -> Result<(), ShapeError> {
    match shape.node() {
        Node::Union(of) => of.iter().try_for_each(|of| take_apart(of, radius, parts))?,
        Node::Placed { pose, of } => {
            let first = parts.len();
            take_apart(of, radius, parts)?;
            for part in &mut parts[first..] {
                *part = part.clone().placed(pose)?;
            }
        }
        _ if !shape.promise().has_interior => parts.push(shape.clone().offset(radius)?),
        _ => parts.push(shape.clone()),
    }
    Ok(())
}

/// Finds the body whose surface a point lies on.
#[derive(Debug)]
pub(crate) struct Owners {
    block: Block<f64, 3, BLOCK>,
    values: Column<f64, BLOCK>,
    least: [f64; BLOCK],
    /// The body of each point.
    pub(crate) bodies: [usize; BLOCK],
}

impl Owners {
    pub(crate) fn new() -> Self {
        Self {
            block: Block::zero(),
            values: Column::zero(),
            least: [f64::INFINITY; BLOCK],
            bodies: [0; BLOCK],
        }
    }

    /// Sets [`bodies`](Self::bodies) to those whose fields are least at points of surfaces, at
    /// most [`BLOCK`]; the first of equals.
    pub(crate) fn find(&mut self, surfaces: &Surfaces, points: &[Point<3>]) {
        self.least = [f64::INFINITY; BLOCK];
        self.bodies = [0; BLOCK];
        let Some(all) = ball_around(points).filter(|_| surfaces.bodies.len() > 1) else {
            return;
        };
        self.block.fill(points.len(), |i| points[i]);
        for (index, body) in surfaces.bodies.iter().enumerate() {
            let is_far = body.ball.is_some_and(|ball| gap_between(&ball, &all) > surfaces.gap);
            // A field may be less than the distance to its ball.
            if is_far && body.shape.promise().above_bounds {
                continue;
            }
            body.shape.block_distances(&self.block, points.len(), &mut self.values);
            for i in 0..points.len() {
                let value = self.values.get(i);
                if value < self.least[i] {
                    (self.least[i], self.bodies[i]) = (value, index);
                }
            }
        }
    }
}

/// A ball around points; `None` if there are none.
fn ball_around(points: &[Point<3>]) -> Option<BoundingBall<3>> {
    let bounds = Aabb::around(points.iter().copied())?;
    Some(BoundingBall { centre: bounds.centre(), radius: bounds.half_extents().norm() })
}

/// How far two balls are apart; negative if they overlap [m].
fn gap_between(a: &BoundingBall<3>, b: &BoundingBall<3>) -> f64 {
    (a.centre - b.centre).norm() - a.radius - b.radius
}

#[cfg(test)]
mod studio_tests {
    use super::round;

    #[test]
    fn spacings_are_round() {
        assert_eq!([0.0013, 0.02, 0.021, 7.0].map(round), [0.002, 0.02, 0.05, 10.0]);
    }
}
