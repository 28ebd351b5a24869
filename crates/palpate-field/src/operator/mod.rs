// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Operators: what turns fields into fields.
//!
//! Each file holds the formulas of one family, the rule by which the family's
//! promises follow from its children's, and the functions that build its fields. The
//! methods of [`Shape`](crate::Shape) make a [`Node`](crate::Node), which calls them.

pub(crate) mod boolean;
pub(crate) mod catalogue;
pub(crate) mod distortion;
pub(crate) mod domain;
pub(crate) mod mixture;
pub(crate) mod repetition;
pub(crate) mod smooth;
pub(crate) mod surface;
pub(crate) mod transform;

#[cfg(feature = "oracle")]
pub use catalogue::Child;
pub use catalogue::Operator;
pub use repetition::Copies;
pub use smooth::{Boolean, Profile};
