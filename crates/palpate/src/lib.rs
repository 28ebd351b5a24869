// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Signed distance functions that can be touched.
//!
//! This crate re-exports the crates of palpate: the [`field`]s and their
//! promises, [`query`] for where things touch, [`local`] searches of the literature, [`mesh`]es,
//! the [`haptics`] proxy and servo with its [`safety`] chain, the [`servo_loop`] that runs it, the
//! [`device`] trait for drivers, [simulated devices](sim), [`vibration`], [`scene`] files, [`plot`]s
//! and lit pictures ([`render`]). The [`prelude`] has what most programs need.
//!
//! # Examples
//!
//! ```
//! use palpate::device::profile_named;
//! use palpate::sim::{Hand, SimulatedDevice};
//! use palpate::prelude::*;
//!
//! # fn main() -> Result<(), Error> {
//! let plate = Shape::cuboid([0.2, 0.02, 0.2])?;
//! let ball = Shape::ball(0.05)?.translated([0.0, 0.0595, 0.0])?;
//! let both = &plate | &ball; // union; & and - likewise
//! assert!((both.distance([0.0, 0.13, 0.0]) - 0.0205).abs() < 1e-15); // above the ball [m]
//!
//! let mut query = Query::new();
//! let nearest = query.closest_points(&plate, &ball)?; // with its bounds
//! assert!(nearest.lower <= -0.0005 && -0.0005 <= nearest.upper); // 0.5 mm deep
//! let touch = query.manifold(&plate, &ball)?;
//! assert_eq!(touch.contacts.len(), 1);
//!
//! let hand = Hand::resting([0.0, 0.05, 0.0])?;
//! let mut device = SimulatedDevice::new(profile_named("omega")?, vec![hand])?;
//! let mut servo = Servo::for_device([Body::new(plate, Material::wood())?], &device)?;
//! let report = servo.run(&mut device, Seconds(0.01))?.unless_failed()?; // in real time
//! assert_eq!(report.ticks, 10);
//! # Ok(())
//! # }
//! ```
//!
//! # Features
//!
//! On by default: `mesh-files` reads OBJ, STL, PLY and glTF; `grid-files` reads grids and volumes of scanners; `parallel`
//! shares grids, batches and worlds among threads; `plot` draws; `render` renders; `scene` reads and writes scene files;
//! `serde` implements serde's traits for plain data; `std-loop` runs servos on the machine's clock and in threads.
//! Off by default: `local` has local searches from the
//! literature, without bounds; `mint` and `glam` convert vectors and poses.

mod error;
#[cfg(feature = "scene")]
pub mod hands;
pub mod prelude;
pub mod stability;

pub use error::{Error, ErrorKind};
pub use palpate_device as device;
pub use palpate_field as field;
pub use palpate_grid as grid;
pub use palpate_haptics as haptics;
#[cfg(feature = "std-loop")]
pub use palpate_haptics::servo_loop;
#[cfg(feature = "local")]
pub use palpate_local as local;
pub use palpate_mesh as mesh;
#[cfg(feature = "plot")]
pub use palpate_plot as plot;
pub use palpate_query as query;
#[cfg(feature = "render")]
pub use palpate_render as render;
pub use palpate_safety as safety;
#[cfg(feature = "scene")]
pub use palpate_scene as scene;
pub use palpate_sim as sim;
pub use palpate_vibration as vibration;

/// The examples of README.md and of three pages of the guide, as tests.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
#[doc = include_str!("../../../docs/guide/bindings.md")]
#[doc = include_str!("../../../docs/guide/devices.md")]
#[doc = include_str!("../../../docs/guide/touch.md")]
struct Pages;
