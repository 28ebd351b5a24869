// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rigid motions and uniform scales; gradients written by hand.

use palpate_field::{Pose, Shape, Vector};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::kernels::{Dimension, Space};
use palpate_testkit::laws::GradientIsTheDual;
use palpate_testkit::tree::{Solid, Tree};
use palpate_testkit::{cases, laws};

/// Deepest trees drawn.
const DEEPEST: usize = 6;

/// Points for each tree.
const POINTS: usize = 40;

fn motions_and_scales<const D: usize>(count: u64)
where
    Space: Solid<D> + Turn<D>,
{
    cases::on_trees(count, DEEPEST, |u, _, shape| {
        let size = draw::size(shape);
        let mut pose: Pose<D> = draw::pose(u)?;
        pose.translation = pose.translation * size;
        let factor = 10.0_f64.powf(draw::within(u, -3.0, 3.0)?);
        for _ in 0..POINTS {
            let p = draw::point(u, shape)?;
            let outcome = laws::motion_keeps_distances(shape, &pose, p)
                .and_then(|()| laws::scale_scales_distances(shape, factor, p));
            if let Err(complaint) = outcome {
                return Ok(Err(format!("{complaint}\n  {pose:?}, {factor}")));
            }
        }
        Ok(Ok(()))
    });
}

#[test]
fn motions_and_scales_of_the_plane_carry_fields_along() {
    motions_and_scales::<2>(1200);
}

#[test]
fn motions_and_scales_of_space_carry_fields_along() {
    motions_and_scales::<3>(1200);
}

fn gradients_are_duals<const D: usize>(count: u64)
where
    Space: Dimension<D>,
{
    let catalogue = <Space as Dimension<D>>::CATALOGUE;
    let mut which = 0;
    cases::check(count * catalogue.len() as u64, |u| {
        let entry = &catalogue[which % catalogue.len()];
        which += 1;
        let drawn = draw::arguments::<D>(u, entry.name, entry.parameters)?;
        let Some(arguments) = drawn else {
            return Ok(Err(format!("no arguments found for {}", entry.name)));
        };
        let shape: Shape<D> = match entry.build(&arguments) {
            Ok(shape) => shape,
            Err(error) => return Ok(Err(error.to_string())),
        };
        let points =
            (0..POINTS).map(|_| draw::point(u, &shape)).collect::<Result<Vec<_>, _>>()?;
        let law = GradientIsTheDual { points, size: draw::size(&shape) };
        Ok(Space::with_kernel(entry.name, &arguments, law)
            .unwrap_or_else(|error| Err(error.to_string())))
    });
}

#[test]
fn gradients_written_by_hand_are_derivatives() {
    gradients_are_duals::<2>(100);
    gradients_are_duals::<3>(100);
}

fn built_where_it_is<const D: usize>()
where
    Space: Dimension<D> + Turn<D>,
{
    let catalogue = <Space as Dimension<D>>::CATALOGUE;
    let mut which = 0;
    cases::check(10 * catalogue.len() as u64, |u| {
        let entry = &catalogue[which % catalogue.len()];
        which += 1;
        let drawn = draw::arguments::<D>(u, entry.name, entry.parameters)?;
        let Some(arguments) = drawn else {
            return Ok(Err(format!("no arguments found for {}", entry.name)));
        };
        let pose = draw::pose(u)?;
        let moved = entry.build(&arguments).and_then(|shape| shape.placed(&pose));
        let at_once = entry.build_at(&arguments, &pose);
        let (moved, at_once) = (format!("{moved:?}"), format!("{at_once:?}"));
        Ok(if moved == at_once { Ok(()) } else { Err(format!("{moved}, and {at_once}")) })
    });
}

#[test]
fn primitives_built_where_they_are_are_those_moved_there() {
    built_where_it_is::<2>();
    built_where_it_is::<3>();
}

/// A motion of a motion is the motion of both.
#[test]
fn motions_compose() {
    cases::check(400, |u| {
        let tree: Tree<3> = draw::tree(u, 3)?;
        let (a, b): (Pose<3>, Pose<3>) = (draw::pose(u)?, draw::pose(u)?);
        let Ok(shape) = tree.shape() else { return Ok(Ok(())) };
        let both = shape.clone().placed(&b).and_then(|shape| shape.placed(&a));
        let (Ok(both), Ok(once)) = (both, shape.placed(&(a * b))) else {
            return Ok(Err(format!("{tree:?}")));
        };
        for _ in 0..POINTS {
            let p = draw::point(u, &once)?;
            let (f, g) = (both.distance(p), once.distance(p));
            let slack = both.promise().rounding.within(p.norm())
                + once.promise().rounding.within(p.norm())
                + 16.0 * f64::EPSILON * Vector([a, b].map(|x| x.translation.norm())).norm();
            if (f - g).abs() > slack {
                return Ok(Err(format!(
                    "{f:e} in two steps, {g:e} in one, at {p:?}: {tree:?}"
                )));
            }
        }
        Ok(Ok(()))
    });
}
