// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the page is told of a scene that is built: its bodies, how it is drawn.

use std::collections::BTreeSet;

use palpate::render::SrgbColor;
use palpate::scene::{AnyScene, BuiltBody, BuiltScene};

use crate::shader::{Formulas, MOST_OPERATIONS, Slot};
use crate::wire::{BodyTold, BuiltTold, Way};

/// Fields that are steeper are drawn from samples: rays would take too many steps.
const STEEPEST: f64 = 4.0;

/// How a scene is drawn, as the page was told last.
#[derive(Debug, Default)]
pub(super) struct Drawing {
    formulas: Option<Formulas>,
    /// The numbers that are uniforms.
    moving: BTreeSet<Slot>,
}

impl Drawing {
    /// The way to draw a scene of either dimension.
    pub(super) fn of(&mut self, scene: &AnyScene, is_moving: bool) -> Way {
        match scene {
            AnyScene::Planar(scene) => self.way(scene, is_moving),
            AnyScene::Spatial(scene) => self.way(scene, is_moving),
        }
    }

    /// The way to draw a scene. While a control is dragged, the numbers that change are uniforms:
    /// then the text of the shader stays the same.
    fn way<const D: usize>(&mut self, scene: &BuiltScene<D>, is_moving: bool) -> Way {
        let steepest = scene.whole.promise().lipschitz;
        let formulas = Formulas::of(scene.bodies.iter().map(|body| &body.shape));
        let Some(formulas) = formulas else {
            return samples("a closure has no formula");
        };
        let changed = self.formulas.as_ref().and_then(|old| old.slots_that_differ(&formulas));
        match changed {
            Some(changed) if is_moving => self.moving.extend(changed),
            _ => self.moving.clear(),
        }
        let shader = formulas.shader(&self.moving);
        self.formulas = Some(formulas);
        if steepest > STEEPEST {
            samples(format!("the field is steep: its Lipschitz constant is {steepest:.3}"))
        } else if shader.operations > MOST_OPERATIONS {
            samples(format!("the formula has {} operations", shader.operations))
        } else {
            Way::Formula(shader)
        }
    }
}

fn samples(why: impl Into<String>) -> Way {
    Way::Samples { why: why.into() }
}

/// What the page is told of a scene that is built.
pub(super) fn described(scene: &AnyScene) -> BuiltTold {
    match scene {
        AnyScene::Planar(scene) => of_scene(scene),
        AnyScene::Spatial(scene) => of_scene(scene),
    }
}

fn of_scene<const D: usize>(scene: &BuiltScene<D>) -> BuiltTold {
    let promise = scene.whole.promise();
    let body = |(number, BuiltBody { name, shape, .. }): (usize, &BuiltBody<D>)| BodyTold {
        name: name.clone(),
        color: SrgbColor::of_body(number).0,
        promise: shape.promise().in_words(),
        bounds: shape.promise().bounds.map(|bounds| bounds.aabb.in_space()),
    };
    BuiltTold {
        dimension: D,
        bodies: scene.bodies.iter().enumerate().map(body).collect(),
        bounds: scene.bounds().map(|bounds| bounds.in_space()),
        lipschitz: promise.lipschitz,
        promise: promise.in_words(),
    }
}
