// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Conversions from and to the types of other crates, each behind the feature of its name.

#[cfg(feature = "glam")]
mod glam;
#[cfg(feature = "mint")]
mod mint;
#[cfg(feature = "schema")]
mod schema;
#[cfg(feature = "serde")]
pub(crate) mod serde;
