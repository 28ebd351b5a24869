// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Distances in the half plane `x ≥ 0`, for planar shapes with a mirror image and for solids of
//! revolution about the y axis.
//!
//! Each is the distance of a planar shape that is its own mirror image, evaluated where
//! `x ≥ 0`. The solid that the shape sweeps about y has the same distance, because the nearest
//! point of a solid of revolution lies in the half plane of the evaluated point.

mod arc;
mod cut_disk;
mod lens;
mod moon;
mod outline;
mod rhombus;
mod two_discs;
mod wedge;

pub(super) use arc::Curve;
pub(super) use cut_disk::{CutDiskProfile, bounds_of_zone};
pub(super) use lens::Lens;
pub(super) use moon::Moon;
pub(super) use outline::{beside, intersection};
pub(super) use rhombus::{Rhombus, inner_radius};
pub(super) use two_discs::TwoDiscs;
pub(super) use wedge::{Wedge, half_of_less_than_a_turn};
