// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What must hold for any text that is read as a scene.

use palpate_scene::Scene;

/// Reads `text` as a scene and checks what came of it; the scene, if it is one.
///
/// # Panics
///
/// If reading panics, an error has no place, or a scene is not what it was after
/// writing and reading.
pub fn check(text: &str) -> Option<Scene> {
    match Scene::from_json(text) {
        Ok(scene) => {
            assert!(
                serde_json::from_str::<serde_json::Value>(text).is_ok(),
                "what is no JSON was read as a scene"
            );
            let written = scene.to_json();
            let again = Scene::from_json(&written).expect("what was written can be read");
            assert_eq!(again, scene);
            assert_eq!(again.to_json(), written);
            Some(scene)
        }
        Err(error) => {
            let lines = text.split('\n').count();
            for problem in error.problems() {
                let line = problem.line;
                assert!((1..=lines).contains(&line), "{error}: a text of {lines} lines");
            }
            assert!(error.to_string().len() < 20_000);
            None
        }
    }
}
