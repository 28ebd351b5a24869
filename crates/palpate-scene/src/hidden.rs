// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that no hand reaches, such as a hard nodule in soft skin.

use palpate_field::{Aabb, Shape};
use palpate_haptics::TextureKind;
use palpate_query::{Limits, PairWorkspace, any_point};

use crate::build::{BuiltBody, BuiltScene};
use crate::emptiness::is_empty;

/// Evaluations for each pair: most proofs take hundreds.
const BUDGET: u32 = 4000;

/// Evaluations for all pairs, about a second: of thousands of bodies in one place each lies in many.
const BUDGET_OF_ALL: u64 = 2_000_000;

/// The most pairs whose boxes are compared, about a tenth of a second: those of 4000 bodies.
const MOST_PAIRS: usize = 16_000_000;

/// The smallest part outside that counts as a point, as a share of the inner body's size.
const TOLERANCE: f64 = 1e-9;

/// A body that lies wholly within another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Hidden {
    /// The number of the body.
    pub body: usize,
    /// The number of the body around it.
    pub within: usize,
}

impl<const D: usize> BuiltScene<D> {
    /// The bodies that cannot be felt, because they lie wholly within another: a contact stays on the
    /// surface of all bodies together. Each entry names the first body around it.
    ///
    /// What is not proven is not told, and of many bodies only the first are asked about. Bodies that move are left
    /// out, a magnet, which pulls from afar, and what lies in a body that a hand punctures.
    #[must_use]
    pub fn hidden(&self) -> Vec<Hidden> {
        let mut rests = vec![true; self.bodies.len()];
        self.moving().for_each(|body| rests[body] = false);
        let resting = |number: &usize| rests[*number];
        let all = || (0..self.bodies.len()).filter(resting);
        let mut proofs = Proofs::default();
        let mut found = Vec::new();
        for body in all() {
            let inner = &self.bodies[body];
            let mut others = all().filter(|other| *other != body);
            let within = others.find(|other| proofs.is_hidden_in(inner, &self.bodies[*other]));
            found.extend(within.map(|within| Hidden { body, within }));
            if proofs.are_spent() {
                break;
            }
        }
        found
    }
}

/// What was asked about the pairs of a scene.
#[derive(Default)]
struct Proofs {
    /// Pairs whose boxes were compared.
    pairs: usize,
    evaluations: u64,
}

impl Proofs {
    fn are_spent(&self) -> bool {
        self.pairs >= MOST_PAIRS || self.evaluations >= BUDGET_OF_ALL
    }

    fn is_hidden_in<const D: usize>(
        &mut self,
        inner: &BuiltBody<D>,
        outer: &BuiltBody<D>,
    ) -> bool {
        if self.are_spent() {
            return false;
        }
        self.pairs += 1;
        let mut layers = outer.material.layers.iter();
        let is_punctured = outer.material.pop_through.is_some()
            || layers.any(|layer| layer.pop_through.is_some());
        let pulls = inner.material.magnet.is_some();
        // A surface that a texture moves is not that of the shape.
        let is_moved = [inner, outer].iter().any(|body| {
            let texture = body.material.texture.as_ref();
            texture.is_some_and(|texture| texture.kind == TextureKind::Displacement)
        });
        !is_punctured && !pulls && !is_moved && self.is_within(&inner.shape, &outer.shape)
    }

    /// Whether it is proven that a shape has points, and all of them lie within another.
    fn is_within<const D: usize>(&mut self, inner: &Shape<D>, outer: &Shape<D>) -> bool {
        let promise = inner.promise();
        // A curve or a sheet has no inside, whose points are searched for.
        let Some(bounds) = promise.bounds.filter(|_| promise.has_interior) else {
            return false;
        };
        let apart = |other: Aabb<D>| {
            (0..D)
                .any(|i| bounds.aabb.max[i] < other.min[i] || other.max[i] < bounds.aabb.min[i])
        };
        if outer.promise().bounds.is_some_and(|bounds| apart(bounds.aabb)) {
            return false;
        }
        let Ok(outside) = Shape::difference(inner.clone(), [outer.clone()]) else {
            return false;
        };
        let size = bounds.aabb.half_extents().norm();
        let limits = Limits::new(TOLERANCE * size).with_budget(BUDGET);
        let found = any_point(&outside, &limits, &mut PairWorkspace::new());
        let Ok(found) = found else { return false };
        self.evaluations += u64::from(found.evaluations);
        found.is_hit() == Some(false) && is_empty(inner) == Some(false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AnyScene, Scene};

    /// A skin of 100 mm × 40 mm × 100 mm with a ball in it; what else each of both has.
    fn hidden(radius: f64, height: f64, skin: &str, ball: &str) -> Vec<(usize, usize)> {
        let text = format!(
            r#"{{ "palpate": 1, "dimension": 3, "bodies": [
              {{ "name": "skin", "shape": {{ "cuboid": {{ "size": [0.1, 0.04, 0.1] }} }}
                {skin} }},
              {{ "name": "nodule", "shape": {{ "ball": {{ "radius": {radius} }} }},
                "pose": {{ "translation": [0, {height}, 0], "rotate_degrees":
                  {{ "axis": [1, 2, 3], "angle": 40 }} }} {ball} }} ] }}"#
        );
        let scene = Scene::from_bytes(text.as_bytes()).unwrap().build().unwrap();
        let AnyScene::Spatial(scene) = scene else { panic!() };
        scene.hidden().iter().map(|hidden| (hidden.body, hidden.within)).collect()
    }

    #[test]
    fn a_nodule_wholly_in_the_skin_is_hidden() {
        assert_eq!(hidden(0.012, 0.006, "", ""), [(1, 0)]);
        // 0.1 mm below the surface, and 0.1 mm above.
        assert_eq!(hidden(0.012, 0.0079, "", ""), [(1, 0)]);
        assert_eq!(hidden(0.012, 0.0081, "", ""), []);
        // Around the skin.
        assert_eq!(hidden(0.1, 0.0, "", ""), [(0, 1)]);
        assert_eq!(hidden(0.012, 0.06, "", ""), []);
    }

    #[test]
    fn what_a_hand_may_reach_is_not_hidden() {
        let punctured = r#", "material": { "layers": [{ "depth": 0.001,
            "pop_through": { "force": 2 } }] }"#;
        assert_eq!(hidden(0.012, 0.006, punctured, ""), []);
        let magnet = r#", "material": { "magnet": { "distance": 0.01, "force": 1 } }"#;
        assert_eq!(hidden(0.012, 0.006, "", magnet), []);
        let rough = r#", "material": { "texture": { "kind": "displacement", "amplitude": 0.001,
            "wavelength": 0.02 } }"#;
        assert_eq!(hidden(0.012, 0.006, "", rough), []);
    }

    /// Balls in one place, the largest first, each smaller than the one before by `step` [m].
    fn hidden_of_balls(count: u32, step: f64) -> Vec<Hidden> {
        let body = |i| {
            let radius = 0.01 + step * f64::from(i);
            format!(r#"{{ "name": "{i}", "shape": {{ "ball": {{ "radius": {radius} }} }} }}"#)
        };
        let bodies = (0..count).rev().map(body).collect::<Vec<_>>().join(",");
        let text = format!(r#"{{ "palpate": 1, "dimension": 3, "bodies": [ {bodies} ] }}"#);
        let scene = Scene::from_bytes(text.as_bytes()).unwrap().build().unwrap();
        let AnyScene::Spatial(scene) = scene else { panic!() };
        scene.hidden()
    }

    /// Each was once asked about with each: 9 million proofs, of which none succeeds, as the balls are nearly equal.
    #[test]
    fn many_bodies_in_one_place_take_a_bounded_time() {
        assert!(hidden_of_balls(3000, 1e-6).len() < 2999);
        assert_eq!(hidden_of_balls(2, 0.03), [Hidden { body: 1, within: 0 }]);
    }

    #[test]
    fn in_the_plane_too() {
        let text = r#"{ "palpate": 1, "dimension": 2, "bodies": [
          { "name": "floor", "shape": { "half_space": { "normal": [0, 1], "offset": 0 } } },
          { "name": "coin", "shape": { "ball": { "radius": 0.01 } },
            "pose": { "translation": [0.3, -0.02] } },
          { "name": "ring", "shape": { "ball": { "radius": 0.01 } },
            "pose": { "translation": [0.3, 0.02] } } ] }"#;
        let scene = Scene::from_bytes(text.as_bytes()).unwrap().build().unwrap();
        let AnyScene::Planar(scene) = scene else { panic!() };
        assert_eq!(scene.hidden(), [Hidden { body: 1, within: 0 }]);
    }
}
