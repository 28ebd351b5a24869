// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The module `palpate._palpate`: what Python asks, converted, asked of the core, and converted back.

#![expect(clippy::too_many_arguments, reason = "arguments have names in Python")]

mod answers;
mod arrays;
mod batch;
mod call;
mod chain;
mod devices;
mod ending;
mod error;
mod evaluate;
mod function;
mod grid;
mod guarded;
mod hand;
mod interrupt;
mod mailbox;
mod mass;
mod mesh;
mod operators;
mod pictures;
mod pool;
mod poses;
mod primitives;
mod program;
mod query;
mod scene;
mod servo;
mod shape;
mod stage;
mod text;
mod touched;
mod track;
mod world;

use pyo3::prelude::*;

#[pymodule]
mod _palpate {
    use pyo3::prelude::*;

    use super::answers::{STOPS, read};

    #[pymodule_export]
    use super::batch::{cast_rays, overlaps, separations};
    #[pymodule_export]
    use super::devices::device_profiles;
    #[pymodule_export]
    use super::function::from_function;
    #[pymodule_export]
    use super::grid::from_samples;
    #[pymodule_export]
    use super::mailbox::PyMailbox;
    #[pymodule_export]
    use super::mesh::{PyMesh, mesh_contacts, mesh_hits};
    #[pymodule_export]
    use super::operators::{
        difference, intersection, smooth_difference, smooth_intersection, smooth_union,
        symmetric_difference, union,
    };
    #[pymodule_export]
    use super::pictures::{PyFigure, PyImage};
    #[pymodule_export]
    use super::primitives::{catalogue, primitive};
    #[pymodule_export]
    use super::program::main;
    #[pymodule_export]
    use super::query::{cast_ray, closest_points, manifold, overlap, penetration, separation};
    #[pymodule_export]
    use super::scene::PyScene;
    #[pymodule_export]
    use super::servo::{PyServo, feel};
    #[pymodule_export]
    use super::shape::PyShape;
    #[pymodule_export]
    use super::track::PyTrack;
    #[pymodule_export]
    use super::world::{PyWorld, sweep};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        super::ending::register(module)?;
        module.add("STOPS", read(module.py(), &STOPS)?)
    }
}
