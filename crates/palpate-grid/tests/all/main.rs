// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Tests of grids.

#![expect(clippy::unwrap_used, reason = "tests")]

#[cfg(feature = "files")]
mod files;
mod grids;
#[cfg(feature = "volumes")]
mod places;
#[cfg(feature = "volumes")]
mod volumes;
