// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Figures of signed distance fields, as SVG and PNG.
//!
//! A picture is made in three steps. A [`Slice`] is a plane in space and a [`PlaneView`] a window of
//! it. [`Isolines::sample`] evaluates a field there through a closure, a row of points at a
//! time. A [`Figure`] stacks isolines, [views](Figure::with_views) of one scene and [`Chart`]s
//! and writes them with [`to_svg`](Figure::to_svg) or [`to_png`](Figure::to_png).
//!
//! A [`Layer`] is a legend with points and arrows for a picture of pixels that was made elsewhere.
//!
//! Over the isolines lie [`Polyline`]s, [`Arrows`], [`Markers`] and [`DimensionLine`]s, in plane coordinates;
//! [`Slice::project`] takes points of space there.
//!
//! Input is checked where it enters, so drawing cannot fail; [`PlotError`] says what is wrong,
//! with numbers and units. The same figure gives the same bytes, and no installed font is used.
//!
//! # Examples
//!
//! A sphere of 4 cm cut 1 cm above its centre, and a hand that slides over it:
//!
//! ```
//! use palpate_plot::{Figure, Isolines, Polyline, Sampling, Slice, PlaneView};
//!
//! let slice = Slice::xz(0.01)?;
//! let view = PlaneView::of_box(&slice, [-0.04; 3], [0.04; 3], 0.25)?;
//! let sphere = |points: &[[f64; 2]], values: &mut [f64]| {
//!     for (&p, value) in points.iter().zip(values) {
//!         let [x, y, z] = slice.point(p);
//!         *value = (x * x + y * y + z * z).sqrt() - 0.04;
//!     }
//! };
//! let hand = [[-0.05, 0.02, 0.03], [0.0, 0.02, 0.04], [0.05, 0.02, 0.03]];
//! let isolines = Isolines::sample(&slice, &view, Sampling::default(), sphere)?
//!     .with_polyline(Polyline::new("hand", hand.map(|p| slice.project(p)))?);
//! let figure = Figure::new("Sphere").with_caption("exact").with_isolines(isolines);
//!
//! let png = figure.to_png(800)?;
//! assert!(png.starts_with(b"\x89PNG"));
//! # Ok::<(), palpate_plot::PlotError>(())
//! ```

mod body_picture;
mod chain;
mod chart;
mod contours;
mod dimension;
mod drawing;
mod error;
mod figure;
mod follow;
mod geometry;
mod isolines;
mod labels;
mod legend;
mod names;
mod outline;
mod overlay;
mod overlay_picture;
mod palette;
mod panels;
mod picture;
mod png;
mod scale;
mod sheet;
mod slice;
mod slope;
mod svg;
mod text;
mod trust;
mod values;
mod views;
mod wheel;

pub use body_picture::DrawnBody;
pub use chart::{Chart, ChartQuantity, PixelLayer, Series};
pub use dimension::DimensionLine;
pub use error::PlotError;
pub use figure::Figure;
pub use follow::{BoundedField, Cell};
pub use isolines::Isolines;
pub use outline::SurfaceLines;
pub use overlay::{Arrow, Arrows, Dash, Markers, Measured, Polyline};
pub use palette::Color;
pub use scale::Scale;
pub use slice::{PlaneView, Sampling, Slice};
pub use slope::SampledSlope;
pub use trust::{Comparison, Promised};
