// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the page is told of a scene: its data, its bodies, how it is drawn.

use std::collections::BTreeSet;

use palpate::field::Shape;
use palpate::render::SrgbColor;
use palpate::scene::{AnyScene, BuiltScene};
use serde_json::{Value, json};

use super::document::Document;
use crate::shader::{Formulas, MOST_OPERATIONS, Slot};

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
    pub(super) fn of(&mut self, scene: &AnyScene, is_moving: bool) -> Value {
        match scene {
            AnyScene::Planar(scene) => self.way(scene, is_moving),
            AnyScene::Spatial(scene) => self.way(scene, is_moving),
        }
    }

    /// The way to draw a scene. While a control is dragged, the numbers that change are uniforms:
    /// then the text of the shader stays the same.
    fn way<const D: usize>(&mut self, scene: &BuiltScene<D>, is_moving: bool) -> Value {
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
            return samples(&format!(
                "the field is steep: its Lipschitz constant is {steepest:.3}"
            ));
        }
        if shader.operations > MOST_OPERATIONS {
            let count = shader.operations;
            return samples(&format!("the formula has {count} operations"));
        }
        json!({
            "kind": "formula",
            "glsl": shader.glsl,
            "uniforms": shader.uniforms,
            "operations": shader.operations,
        })
    }
}

fn samples(why: &str) -> Value {
    json!({ "kind": "samples", "why": why })
}

/// What the page is told of an edited scene.
pub(super) fn described(document: &Document, scene: &AnyScene) -> Value {
    let mut message = match scene {
        AnyScene::Planar(scene) => of_scene(scene),
        AnyScene::Spatial(scene) => of_scene(scene),
    };
    message["do"] = "scene".into();
    message["name"] = document.name.as_str().into();
    message["file"] = json!(document.shown_file());
    message["is_saved"] = document.is_saved().into();
    message["can_undo"] = document.can_undo().into();
    message["can_redo"] = document.can_redo().into();
    message["scene"] = serde_json::to_value(document.scene()).unwrap_or_default();
    message["text"] = document.text().into();
    message
}

fn of_scene<const D: usize>(scene: &BuiltScene<D>) -> Value {
    let body = |(number, body): (usize, &palpate::scene::BuiltBody<D>)| {
        json!({
            "name": body.name,
            "color": SrgbColor::of_body(number).0,
            "promise": body.shape.promise().in_words(),
            "bounds": bounds(&body.shape),
        })
    };
    json!({
        "dimension": D,
        "bodies": scene.bodies.iter().enumerate().map(body).collect::<Vec<_>>(),
        "bounds": scene.bounds().map(|bounds| [bounds.min, bounds.max].map(|p| p.in_space().0)),
        "lipschitz": scene.whole.promise().lipschitz,
        "promise": scene.whole.promise().in_words(),
    })
}

fn bounds<const D: usize>(shape: &Shape<D>) -> Value {
    json!(shape.promise().bounds.map(|bounds| {
        let aabb = bounds.aabb;
        [aabb.min, aabb.max].map(|p| p.in_space().0)
    }))
}
