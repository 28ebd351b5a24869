// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Helpers that the tests of palpate share.
//!
//! - [`arbitrary`]: trees and points, biased towards what breaks formulas;
//! - [`tree`]: shapes as plain data, and their formulas written a second time;
//! - [`double`]: numbers of twice the precision, to measure rounding with;
//! - [`laws`]: laws that every field must obey; [`models`]: models against values;
//! - [`oracle`]: distances from definitions, without any formula of the library;
//! - [`separation`]: separations by a plain search; [`recall`]: poses with proven separations,
//!   as files;
//! - [`kernels`]: kernels by their names in the catalogue;
//! - [`soup`]: triangles, made and damaged; [`hard`]: meshes that are hard to make solids of;
//! - [`cases`]: runs a property a fixed number of times.
#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests compare exact numbers"))]

pub mod arbitrary;
pub mod cases;
pub mod double;
pub mod hard;
pub mod laws;
pub mod models;
pub mod recall;
pub mod separation;
pub mod soup;
pub mod tree;

pub use palpate_field::oracle::{self, kernels};
