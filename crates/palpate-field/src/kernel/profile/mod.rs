// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Distances in the half plane `x ≥ 0`: what a planar shape folds to, and what a
//! solid turns about the y axis.
//!
//! Each is the distance of the planar shape that is its own mirror image, asked
//! where `x ≥ 0`. A shape that turns it about y has the same distance: the nearest
//! point of a solid of revolution is in the half plane of the point that asks.

mod arc;
mod cut_disc;
mod lens;
mod moon;
mod outline;
mod rhombus;
mod two_discs;
mod wedge;

pub(super) use arc::Curve;
pub(super) use cut_disc::{CutDisc, bounds_of_zone};
pub(super) use lens::Lens;
pub(super) use moon::Moon;
pub(super) use outline::{beside, intersection};
pub(super) use rhombus::{Rhombus, inner_radius};
pub(super) use two_discs::TwoDiscs;
pub(super) use wedge::{Wedge, half_of_less_than_a_turn};
