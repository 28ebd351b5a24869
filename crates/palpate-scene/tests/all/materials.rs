// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Materials by name: what is shown and documented is what there is.

use std::collections::BTreeSet;

use palpate_haptics::Material;
use palpate_scene::{AnyScene, Dimension, Scene, WrittenMaterial};

#[test]
fn every_name_is_shown_and_documented() {
    let repository = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let scene = Scene::from_file(format!("{repository}/scenes/materials.json")).unwrap();
    let shown: BTreeSet<_> = scene
        .bodies
        .iter()
        .filter_map(|body| match &body.material {
            Some(WrittenMaterial::Preset(name)) => Some(name.as_str()),
            _ => None,
        })
        .collect();
    assert_eq!(shown, Material::preset_names().collect());
    let formats = std::fs::read_to_string(format!("{repository}/docs/formats.md")).unwrap();
    for name in Material::preset_names() {
        assert!(formats.contains(&format!("`\"{name}\"`")), "{name}");
    }
}

#[test]
fn a_name_is_built_to_its_numbers_and_written_as_a_name() {
    let text = r#"{ "palpate": 1, "dimension": 2,
        "bodies": [ { "name": "a", "shape": { "ball": { "radius": 1 } }, "material": "foam" } ] }"#;
    let scene = Scene::from_json(text).unwrap();
    assert_eq!(scene.dimension(), Dimension::Two);
    assert!(scene.to_json().contains(r#""material": "foam""#));
    let AnyScene::Planar(world) = scene.build().unwrap() else { panic!("dimension is 2") };
    assert_eq!(world.bodies[0].material, Material::preset("foam").unwrap());
}
