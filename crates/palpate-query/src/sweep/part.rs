// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Parts of elements and of meshes on their way.

use palpate_field::{Point, Vector};
use palpate_mesh::FAN;
use palpate_mesh::Mesh;

use super::path::{Path, Place};
use super::stay::{Stay, bend, exit};
use crate::element::{Element, parts_of_one};
use crate::engine::Bounded;

/// What a part is a part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Of {
    /// An element of the mesh, or the only one.
    Element(u32),
    /// The ball of a node of the mesh's tree: its level and index.
    Node(u32, u32),
}

/// How parts of an element are alike: all are similar to it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Form<const N: usize> {
    /// The weights of the vertices in the centre.
    pub(super) weights: [f64; N],
    /// The number of halves.
    parts: usize,
    /// The vertex across from the longest edge; the first of a segment.
    pub(super) apex: usize,
}

/// An element, a part of one, or the ball of a node, and the time until which it is free.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part<const N: usize, const D: usize> {
    /// In the coordinates of the body; all vertices in the centre of a ball.
    pub(super) element: Element<N, D>,
    pub(super) form: Form<N>,
    pub(super) of: Of,
    /// The radius of a ball; zero of an element [m].
    pub(super) radius: f64,
    /// Before this time it is free.
    pub(super) free: f64,
    /// How far samples are lifted [m].
    pub(super) height: f64,
    /// How often the element was halved.
    pub(super) level: u32,
    /// Whether it goes on undivided.
    pub(super) is_whole: bool,
}

impl<const N: usize, const D: usize> Bounded for Part<N, D> {
    #[inline]
    fn lower(&self) -> f64 {
        self.free
    }
}

impl<const N: usize, const D: usize> Part<N, D> {
    /// An element of which nothing is known before a time.
    pub(super) fn whole(element: &Element<N, D>, name: u32, free: f64) -> Self {
        let weights = element.centre_weights();
        let flat = element.flattened(&weights);
        let parts = if flat.is_some() { 2 } else { parts_of_one::<N>() };
        let element = flat.unwrap_or(*element);
        let weights = element.centre_weights();
        let height = element.farthest(element.at(&weights));
        let form = Form { weights, parts, apex: apex(&element) };
        let of = Of::Element(name);
        Self { element, form, of, radius: 0.0, free, height, level: 0, is_whole: true }
    }

    /// The root of a mesh's tree, around all elements.
    pub(super) fn root(mesh: &Mesh<N, D>) -> Self {
        let aabb = mesh.bounds();
        let level = mesh.tree().levels().len() as u32;
        Self::ball(aabb.centre(), aabb.half_extents().norm(), Of::Node(level, 0), 0.0)
    }

    fn ball(centre: Point<D>, radius: f64, of: Of, free: f64) -> Self {
        let element = Element { vertices: [centre; N] };
        let form = Form { weights: [1.0 / N as f64; N], parts: 1, apex: 0 };
        // A node that is evaluated anew would give the same step.
        Self { element, form, of, radius, free, height: radius, level: 0, is_whole: true }
    }

    /// Whether it is an element of area or length, or a part of one.
    pub(super) fn is_of_element(&self) -> bool {
        matches!(self.of, Of::Element(_))
    }

    /// Appends its parts; of a node those that `mesh` has, of which the lowest are elements.
    pub(super) fn divide(&self, mesh: Option<&Mesh<N, D>>, parts: &mut Vec<Self>) {
        match (self.of, mesh) {
            (Of::Node(0, node), Some(mesh)) => {
                let name = mesh.tree().order()[node as usize];
                let element = Element { vertices: mesh.corners(name as usize) };
                parts.push(Self::whole(&element, name, self.free));
            }
            (Of::Node(above, node), Some(mesh)) => {
                let level = above - 1;
                let balls = &mesh.tree().levels()[level as usize];
                let first = node as usize * FAN;
                let radii = &balls.radii()[first..][..FAN];
                for (i, (centre, radius)) in
                    balls.children(node as usize).into_iter().zip(radii).enumerate()
                {
                    // Padding of a group has a negative radius.
                    if *radius >= 0.0 {
                        let of = Of::Node(level, (first + i) as u32);
                        parts.push(Self::ball(centre, *radius, of, self.free));
                    }
                }
            }
            _ => {
                let level = self.level + 1;
                let halves = self.element.halves();
                let halves = halves[..self.form.parts].iter();
                parts.extend(halves.map(|&element| Self { element, level, ..*self }));
            }
        }
    }

    /// The part on its way at a place.
    #[inline]
    pub(super) fn way(&self, path: &Path<D>, place: &Place<D>) -> Way<N, D> {
        let mut way = Way {
            places: [Vector::ZERO; N],
            velocities: [Vector::ZERO; N],
            centre: Vector::ZERO,
            mean: Vector::ZERO,
            radius: self.radius,
        };
        for (k, p) in self.element.vertices.iter().enumerate() {
            let q = place.point(*p);
            let v = path.velocity(place, *p, q);
            (way.places[k], way.velocities[k]) = (q, v);
            way.centre += q * self.form.weights[k];
            way.mean += v * self.form.weights[k];
        }
        way
    }
}

/// A part on its way, in the field's coordinates.
#[derive(Clone, Copy)]
pub(super) struct Way<const N: usize, const D: usize> {
    pub(super) places: [Point<D>; N],
    pub(super) velocities: [Vector<f64, D>; N],
    /// The centre, and the velocity there.
    pub(super) centre: Point<D>,
    pub(super) mean: Vector<f64, D>,
    /// Of a ball [m].
    radius: f64,
}

impl<const N: usize, const D: usize> Way<N, D> {
    /// How long the part stays in a ball of a `radius` about `p`, on a way of at most this
    /// `acceleration` [m].
    #[inline]
    pub(super) fn stays(&self, p: Point<D>, radius: f64, acceleration: f64) -> Stay {
        let radius = radius - self.radius;
        let mut far = 0.0_f64;
        for place in &self.places {
            let apart = *place - p;
            far = far.max(apart.dot(apart));
        }
        let centre = exit(self.centre - p, self.mean, radius + self.radius);
        let spare = radius - far.sqrt();
        let (bend, most) = bend(spare, acceleration);
        // NaN is no time.
        let mut part = if spare > 0.0 { most } else { 0.0 };
        for (place, velocity) in self.places.iter().zip(&self.velocities) {
            let exit = exit(*place - p, *velocity, radius - bend);
            part = if exit < part { exit } else { part };
        }
        let centre = if spare > 0.0 { centre.min(most) } else { centre };
        Stay { part: part * (1.0 - 1e-12), centre }
    }
}

/// The vertex across from the longest edge; the first of a segment.
fn apex<const N: usize, const D: usize>(element: &Element<N, D>) -> usize {
    let v = element.vertices();
    let edge = |k: usize| (v[(k + 1) % N] - v[(k + 2) % N]).norm();
    if N == 2 {
        0
    } else {
        (0..N).fold(0, |long, k| if edge(k) > edge(long) { k } else { long })
    }
}
