// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where fields touch each other, balls, rays, segments, triangles and meshes, with a proof.
//!
//! A [`Query`] asks about shapes, and owns the memory that its questions need:
//!
//! ```
//! use palpate_field::{Shape, Vector, kernel::{Ball, Cuboid}};
//! use palpate_query::{Query, Stop};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let cube = Shape::from_kernel(Cuboid::new(Vector([1.0, 1.0, 1.0]))?);
//! let ball = Shape::from_kernel(Ball::new(0.25)?).translated(Vector([1.0, 0.0, 0.0]))?;
//! let mut query = Query::new();
//! let apart = query.separation(&cube, &ball)?;
//! assert_eq!(apart.stop, Stop::Converged);
//! assert!(apart.lower <= 0.25 && 0.25 <= apart.upper);
//! # Ok(())
//! # }
//! ```
//!
//! A search for one number returns a [`Certified`] answer: the best point that was found, the
//! bounds between which the distance asked for lies, and why the search stopped. A search that
//! stops early returns wider bounds, never wrong ones. Searches for many contacts return lists of
//! [`Contact`]s, with such an answer or the reason why they stopped.
//!
//! - [`separation`] bounds how far two bodies are apart, or how much they overlap;
//!   [`overlap`] decides whether they do; [`manifold`] finds the contacts that span the
//!   region in which they touch; [`penetration`] bounds how far one must move to leave
//!   the other. [`Track`] follows a pair that moves, [`World`] many bodies;
//!   [`Track::contacts`] finds the contacts of a solver.
//! - [`any_point`] decides whether a shape has any point.
//! - [`evaluate_point`] evaluates a field at a point; [`contact_ball`] bounds how deep a ball
//!   is in it, [`touches_ball`] decides whether it touches; [`cast_ray`] finds the first
//!   surface along a [`Ray`], by balls that are free of it ([`free_radius`]).
//! - [`minimum`] and [`touches`] ask a field, in two or three dimensions, over an [`Element`]: a
//!   segment or a triangle; [`contacts`] finds all places where the element touches.
//! - [`mesh_hits`] and [`mesh_contacts`] ask a field over all elements of a mesh.
//!
//! - [`sweep`] finds when two bodies that move touch first, [`sweep_element`] and [`sweep_mesh`]
//!   when a segment, a triangle or a mesh does that moves, [`World::first_impact`] when bodies of a
//!   world do, and [`cast_ball`] where a ball does that moves along a line.
//! - [`rates`] says how a separation changes with both poses; [`proof`] lists the boxes that the
//!   search for a separation ruled out.
//!
//! The searches take [`Limits`] and a workspace, for real time: once a workspace has grown,
//! only [`manifold`] and [`proof`] allocate, for their lists. A `Query` calls these functions with
//! a workspace of its own; it has no [`evaluate_point`], [`rates`], [`Track`] or [`World`].
//!
//! Features, both on by default: `parallel` shares batches and worlds among threads; `world`
//! adds [`World`].

mod ball;
mod certified;
pub mod constraints;
mod contact;
mod contacts;
mod element_search;
mod engine;
mod error;
mod instances;
mod manifold;
mod mesh;
mod pair;
mod point;
mod query;
mod ray;
mod sampler;
mod sweep;
mod track;
#[cfg(feature = "world")]
mod world;

pub use ball::{BallWorkspace, contact_ball, touches_ball};
pub use certified::{Certified, Limits, Stop, Verdict};
pub use contact::{Contact, NormalSource};
pub use contacts::{ElementContacts, contacts};
pub use element_search::{Element, ElementWorkspace, minimum, parts_of_one, touches};
pub use error::QueryError;
#[doc(hidden)]
pub use instances::instances;
pub use manifold::{Manifold, ManifoldSettings, manifold};
pub use mesh::{
    MeshContact, MeshContacts, MeshHits, MeshWorkspace, PlacedMesh, Undecided, mesh_contacts,
    mesh_hits,
};
pub use pair::{
    DistanceBound, Nearest, PairWorkspace, Penetration, PoseDerivative, Proof, ProofBox, Rates,
    minimax_step, overlap, penetration, proof, rates, separation,
};
pub use point::{AtPoint, any_point, evaluate_point};
pub use query::{ElementMemory, Query, Tolerance};
pub use ray::{Ray, RayHit, cast_ray};
pub use sampler::{Placed, free_radius};
pub use sweep::{
    ElementSweep, FirstTouch, FreeBox, Motion, Moving, Start, SweepProof, SweepSettings,
    SweepWorkspace, cast_ball, sweep, sweep_element, sweep_mesh, sweep_proof,
};
pub use track::{Track, TrackMemory, TrackedContacts};
#[cfg(feature = "world")]
pub use world::{BodyId, BodyImpact, Neighbours, World, WorldSettings};
