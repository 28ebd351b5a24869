// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! All tests of the crate in one program, which links faster than many.

use assert_no_alloc::AllocDisabler;

mod ball_sweeps;
mod balls;
mod carried;
mod common_surfaces;
mod deep_starts;
mod degenerate;
mod drops;
mod element_sweeps;
mod elements;
mod flat_patches;
mod flat_patches_2d;
mod integrator;
mod manifolds;
mod mesh_memory;
mod mesh_sweeps;
mod meshes;
mod notches;
mod on_edges;
mod pair_laws;
mod pairs;
mod penetration_laws;
mod penetrations;
mod queries;
mod rays;
mod recall;
mod recall_motions;
mod sampled;
mod serde;
mod solver_contacts;
mod standing;
mod sweeps;
mod thin;
mod thin_parts;
mod track_costs;
mod tracks;
mod worlds;

/// Aborts where a test forbids to allocate.
#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;
