// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Lit pictures of signed distance fields, by rays that prove that they miss nothing.
//!
//! A [`Subject`] is what a picture shows: shapes with colours. A [`Camera`] sees it through a
//! [`Lens`]. [`render`] makes an [`Image`] with [`Settings`], which is written as PNG; several
//! images are an [animation](write_animation).
//!
//! Every ray of sight, and every ray to the light, is a certified cast: before a surface that it
//! meets there is none, and a ray that meets none is free from its beginning to its end. A ray
//! that its budget does not decide is counted ([`Work::undecided`]). What that means for a picture
//! is in `docs/decisions/rendering.md`.
//!
//! ```
//! use palpate_field::{Shape, Vector};
//! use palpate_render::{Camera, Lens, Settings, Sight, Subject, render};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let ball = Shape::ball(0.05)?.translated([0.0, 0.05, 0.0])?;
//! let plate = Shape::cuboid([0.2, 0.02, 0.2])?;
//! let subject = Subject::of_shapes([ball, plate])?;
//! let sight = Sight::from_angles(0.6, 0.4)?;
//! let corners = subject.corners();
//! let camera = Camera::fitting(&corners, sight, Lens::USUAL, 4.0 / 3.0)?;
//! let rendering = render(&subject, &camera, &Settings::new(64, 48), &|_| true)?;
//! let rendering = rendering.ok_or("the watch ended it")?;
//! assert_eq!((rendering.image.width(), rendering.sight.undecided), (64, 0));
//! let mut file = Vec::new();
//! rendering.image.write_png(&mut file)?;
//! assert!(file.starts_with(b"\x89PNG"));
//! # Ok(())
//! # }
//! ```
#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests compare exact numbers"))]
#![cfg_attr(test, allow(clippy::unwrap_used, reason = "a test that cannot be set up fails"))]

mod beam;
mod camera;
mod image;
mod light;
mod paint;
mod render;
mod subject;
mod trace;

pub use camera::{Camera, Lens, Sight};
pub use image::{Image, SrgbColor, write_animation};
pub use render::{RenderError, Rendering, Settings, Shadows, render};
pub use subject::{Cut, LitBody, Subject};
pub use trace::Work;
