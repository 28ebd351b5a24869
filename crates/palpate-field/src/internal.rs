// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the tests of this crate compare with oracles, though it is no part of the interface. Tests
//! are a program of their own, since a test build of the library would compile every kernel once
//! more.

pub use crate::kernel::between::turn_y_towards;
pub use crate::kernel::planar::parabola_foot::{Nearest, Quadratic};
pub use crate::scalar::power::{cube_root, log2_of_one_plus, power_of_half};
