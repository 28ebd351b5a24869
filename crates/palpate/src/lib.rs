// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Signed distance functions that can be touched.
//!
//! One crate for everything: the [`field`]s and their promises, [`scene`] files,
//! [`query`] for where things touch, the [`haptics`] proxy and servo, [`devices`] to touch
//! with, and [`plot`]s. Each is a crate of its own; this one only gathers them.
//!
//! ```
//! use palpate::field::kernel::{Ball, Cuboid};
//! use palpate::field::{Shape, ShapeError, Vector};
//!
//! # fn main() -> Result<(), ShapeError> {
//! let ball = Shape::from_kernel(Ball::new(0.05)?);
//! let plate = Shape::from_kernel(Cuboid::new(Vector([0.2, 0.02, 0.2]))?);
//! let world = Shape::union([ball.translated(Vector([0.0, 0.06, 0.0]))?, plate])?;
//! let (distance, gradient) = world.distance_gradient(Vector([0.0, 0.131, 0.0]));
//! assert!((distance - 0.021).abs() < 1e-15); // above the ball [m]
//! assert_eq!(gradient, Vector([0.0, 1.0, 0.0]));
//! # Ok(())
//! # }
//! ```

pub use palpate_devices as devices;
pub use palpate_field as field;
pub use palpate_haptics as haptics;
#[cfg(feature = "local")]
pub use palpate_local as local;
pub use palpate_mesh as mesh;
pub use palpate_plot as plot;
pub use palpate_query as query;
pub use palpate_scene as scene;
