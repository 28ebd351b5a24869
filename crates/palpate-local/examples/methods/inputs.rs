// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the local searches are asked: bodies of about 1 m, triangles near their surfaces, pairs that
//! overlap by a millimetre, and motions.

use std::error::Error;

use arbitrary::Unstructured;
use palpate_field::operator::Profile;
use palpate_field::{Point, Pose, Rotation, Screw, Shape, ShapeError, Vector};
use palpate_query::{Element, Limits, PairWorkspace, Placed, separation};
use palpate_testkit::arbitrary::{self as draw};
use palpate_testkit::cases::entropy;

/// How deep the pairs overlap [m].
pub(crate) const DEPTH: f64 = 1e-3;

/// How exactly that is searched for [m].
const EXACTLY: f64 = 1e-6;

/// Enough for each search.
pub(crate) const BUDGET: u32 = 5_000_000;

/// A ring with a column, joined smoothly; a block with a notch; and a plate of 4 mm.
pub(crate) fn bodies() -> Result<[Shape<3>; 3], ShapeError> {
    let column = Shape::cylinder(0.15, 0.8)?.translated([0.15, 0.1, 0.0])?;
    let smooth =
        Shape::smooth_union([Shape::torus(0.35, 0.12)?, column], Profile::Quadratic, 0.05)?;
    let notch = Shape::cuboid([0.5, 0.6, 2.0])?.translated([0.25, 0.3, 0.0])?;
    let edged = Shape::difference(Shape::cuboid([1.0, 0.8, 0.6])?, [notch])?;
    let thin = Shape::cuboid([1.0, 0.004, 1.0])?;
    Ok([smooth, edged, thin])
}

/// Numbers of a case.
pub(crate) struct Draws(Vec<u8>);

impl Draws {
    /// Of a case of a table.
    pub(crate) fn of(table: u64, case: u64) -> Self {
        Self(entropy(1000 * table + case))
    }

    /// What `make` draws.
    pub(crate) fn take<T>(
        &self,
        make: impl FnOnce(&mut Unstructured<'_>) -> arbitrary::Result<T>,
    ) -> Result<T, Box<dyn Error>> {
        Ok(make(&mut Unstructured::new(&self.0))?)
    }
}

/// A point of the surface of a body.
fn on_surface(u: &mut Unstructured<'_>, shape: &Shape<3>) -> arbitrary::Result<Point<3>> {
    loop {
        let mut point = Vector::ZERO;
        for coordinate in &mut point.0 {
            *coordinate = 1.4 * draw::unit(u)? - 0.7;
        }
        if let Some(found) = shape.surface_point(point) {
            return Ok(found);
        }
    }
}

/// A triangle of this size [m] with its middle a tenth of it from the surface.
pub(crate) fn triangle(
    shape: &Shape<3>,
    draws: &Draws,
    size: f64,
) -> Result<Element<3, 3>, Box<dyn Error>> {
    let corners = draws.take(|u| {
        let middle = on_surface(u, shape)? + draw::direction::<3>(u)? * (0.1 * size);
        let mut corners = [middle; 3];
        for corner in &mut corners {
            *corner += draw::direction::<3>(u)? * (0.5 * size);
        }
        Ok(corners)
    })?;
    Ok(Element::new(corners)?)
}

/// A triangle of this size [m] about its own origin, and a motion that leads it past the body, with up
/// to half a turn.
pub(crate) fn moving_triangle(
    draws: &Draws,
    size: f64,
) -> Result<(Element<3, 3>, Screw<3>), Box<dyn Error>> {
    let (corners, screw) = draws.take(|u| {
        let mut corners = [Vector::ZERO; 3];
        for corner in &mut corners {
            *corner = draw::direction::<3>(u)? * (0.5 * size);
        }
        Ok((corners, past(u)?))
    })?;
    Ok((Element::new(corners)?, screw))
}

/// A motion of 2 m past the origin, at most 0.3 m from it, with up to half a turn.
pub(crate) fn past(u: &mut Unstructured<'_>) -> arbitrary::Result<Screw<3>> {
    let way = draw::direction::<3>(u)?;
    let aside = draw::direction::<3>(u)? * (0.3 * draw::unit(u)?);
    let [from, to] = [rotation(u)?, rotation(u)?];
    let ends = [Pose::new(from, aside - way), Pose::new(to, aside + way)];
    Screw::new(ends[0], ends[1], 0).map_err(|_| arbitrary::Error::IncorrectFormat)
}

fn rotation(u: &mut Unstructured<'_>) -> arbitrary::Result<Rotation<3>> {
    let (axis, angle) =
        (draw::direction::<3>(u)?, std::f64::consts::FRAC_PI_2 * draw::unit(u)?);
    Rotation::from_axis_angle(axis, angle).map_err(|_| arbitrary::Error::IncorrectFormat)
}

/// Where the second body overlaps the first by a millimetre: on a line towards it, by halving.
pub(crate) fn overlapping(
    [a, b]: [&Shape<3>; 2],
    draws: &Draws,
    workspace: &mut PairWorkspace<3>,
) -> Result<Pose<3>, Box<dyn Error>> {
    let (turned, way) = draws.take(|u| Ok((rotation(u)?, draw::direction::<3>(u)?)))?;
    let limits = Limits::new(EXACTLY).with_budget(BUDGET);
    let (mut inside, mut outside) = (0.0, 3.0);
    let at = |share: f64| Pose::new(turned, way * share);
    while outside - inside > EXACTLY {
        let middle = 0.5 * (inside + outside);
        let found = separation(a, Placed::new(b, at(middle)), &limits, workspace)?;
        if found.upper < -DEPTH { inside = middle } else { outside = middle }
    }
    Ok(at(inside))
}
