// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Operators: what turns shapes into shapes.
//!
//! Each file holds the formulas of one family, the rule by which the family's
//! promises follow from its children's, and the methods of
//! [`Shape`](crate::Shape) that build it.

pub(crate) mod boolean;
mod distortion;
mod domain;
pub(crate) mod doors;
mod guard;
mod mixture;
mod repetition;
mod smooth;
mod surface;
mod transform;

pub use repetition::Copies;
pub use smooth::Smooth;
