// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where fields touch other things, with a proof.
//!
//! Every search returns a [`Certified`] answer: the best point that was found, between
//! which bounds the truth lies, and why the search stopped. A search that stops early
//! says less; it never says what is wrong.
//!
//! - [`separation`] says how far two bodies are apart, or how much they overlap;
//!   [`overlap`] whether they do.
//! - [`point`] says all that a field says at a point; [`ball`] how deep a ball is in it,
//!   [`touches_ball`] whether it is.
//! - [`ray`] finds the first surface along a [`Ray`]; nothing is skipped.
//! - [`minimum`] and [`touches`] ask a field over an [`Element`], a segment or a
//!   triangle, in two or three dimensions; [`contacts`] finds all places where it touches.
//! - [`mesh_hits`] and [`mesh_contacts`] ask it over all elements of a mesh.
//!
//! ```
//! use palpate_field::{Shape, ShapeError, Vector, kernel::Ball};
//! use palpate_query::{Element, Limits, Stop, Workspace, minimum};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let ball = Shape::from_kernel(Ball::new(1.0)?);
//! let triangle = Element::new([
//!     Vector([2.0, 0.0, 0.0]),
//!     Vector([0.0, 2.0, 0.0]),
//!     Vector([0.0, 0.0, 2.0]),
//! ])?;
//! let limits = Limits::new(1e-6);
//! let nearest = minimum(&ball, &triangle, &limits, &mut Workspace::new())?;
//! // The plane x + y + z = 2 is 2/√3 from the centre.
//! let truth = 2.0 / 3.0_f64.sqrt() - 1.0;
//! assert_eq!(nearest.stop, Stop::Converged);
//! assert!(nearest.lower <= truth && truth <= nearest.upper);
//! # Ok(())
//! # }
//! ```

mod ball;
mod certified;
mod contact;
mod contacts;
mod cut_box;
mod display;
mod element;
mod element_search;
mod engine;
mod error;
mod goal;
mod larger;
mod manifold;
mod mesh;
mod pair;
mod patches;
mod placed;
mod point;
mod pool;
mod query;
mod ray;
mod sampler;
mod track;
#[cfg(feature = "world")]
mod world;

pub use ball::{BallWorkspace, contact_ball, touches_ball};
pub use certified::{Certified, Limits, Stop};
pub use contact::Contact;
pub use contacts::{ElementContacts, contacts};
pub use element::Element;
pub use element_search::{Workspace, minimum, touches};
pub use error::QueryError;
pub use manifold::{Manifold, ManifoldSettings, manifold};
pub use mesh::{
    MeshContact, MeshContacts, MeshHits, MeshWorkspace, PlacedMesh, Undecided, mesh_contacts,
    mesh_hits,
};
pub use pair::{
    DistanceBound, Escape, Nearest, PairWorkspace, PoseDerivative, Proof, ProofBox, Rates,
    escape, minimax_step, overlap, proof, rates, separation,
};
pub use placed::Placed;
pub use point::{AtPoint, evaluate_point};
pub use query::{ElementMemory, Query, Tolerance};
pub use ray::{Ray, RayHit, cast_ray};
pub use track::Track;
#[cfg(feature = "world")]
pub use world::{BodyId, Neighbours, Verdict, World, WorldSettings};
