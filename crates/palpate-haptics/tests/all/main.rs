// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! All tests of the crate in one program, which links faster than many.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]
#![expect(clippy::float_cmp, reason = "tests compare exact numbers")]

use assert_no_alloc::AllocDisabler;

mod common;

mod any_input;
mod bends;
mod bodies;
mod continuity;
mod corners;
mod creases;
mod degenerate;
mod devices;
mod drives;
mod edited;
mod effects;
mod energy;
mod faults;
mod felt;
mod forces;
mod friction;
mod golden;
mod guide_stability;
mod guides;
mod handoff;
mod handovers;
mod happenings;
mod hazards;
mod held_devices;
mod late;
mod lifted;
mod moving;
mod places;
mod protected;
mod real_time;
mod records;
mod recovery;
mod reports;
mod resting;
mod runs;
mod scale;
mod seams;
mod squeezed;
mod stability;
mod strikes;
mod swapped;
mod tool_faces;
mod tool_materials;
mod tool_seams;
mod tool_servo;
mod tool_wedges;
mod tools;
mod tours;
mod turn_readings;
mod turning;
mod turning_stability;
mod vibration;
mod walls;

/// Aborts where a test forbids to allocate.
#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;
