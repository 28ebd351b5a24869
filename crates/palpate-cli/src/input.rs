// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Reads scenes and points.

use std::path::Path;

use palpate::field::{Aabb, LARGEST_LENGTH, Promise, Quality, Vector};
use palpate::local::GradientMethod;
use palpate::scene::{AnyScene, BuiltScene, Scene, SceneError, unknown_name};

use crate::kind::Kind;
use crate::outcome::Failure;

/// The built-in gallery, which `palpate feel` feels if no scene is named.
const GALLERY: &str = include_str!("../../../scenes/article_gallery.json");

/// The names of the axes.
pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];

/// A scene with its name in reports.
pub(crate) struct Named {
    pub(crate) name: String,
    pub(crate) scene: AnyScene,
}

/// Reads and builds the scene in `path`, or the built-in gallery.
pub(crate) fn scene(path: Option<&Path>) -> Result<Named, Failure> {
    let (name, bytes) = match path {
        None => ("the built-in gallery".to_owned(), GALLERY.as_bytes().to_owned()),
        Some(path) => (path.display().to_string(), bytes(path)?),
    };
    match Scene::from_bytes(&bytes).and_then(|scene| scene.build()) {
        Ok(scene) => Ok(Named { name, scene }),
        Err(error) => {
            Err(Failure::input(format!("{name}: {}", no_scene(path, &bytes, &error))))
        }
    }
}

/// Why a file is no scene: what it is instead, or what is wrong with it.
fn no_scene(path: Option<&Path>, bytes: &[u8], error: &SceneError) -> String {
    let other = path.and_then(|path| other_than_scene(path, bytes));
    other.unwrap_or_else(|| error.to_string())
}

/// What a file holds that is no scene, and what to do with it; `None` if that is not known.
pub(crate) fn other_than_scene(path: &Path, bytes: &[u8]) -> Option<String> {
    match Kind::of(bytes)? {
        Kind::Scene => None,
        Kind::Empty => Some(format!("it is an empty file; a small scene is {SMALL}")),
        kind => Some(format!("{kind}, not a scene; {}", kind.advice(path))),
    }
}

/// A scene to begin with.
const SMALL: &str = r#"{ "palpate": 1, "dimension": 3, "bodies": [ { "name": "bead", "shape": { "ball": { "radius": 0.02 } } } ] }"#;

/// The bytes of a file.
pub(crate) fn bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    if path.is_dir() {
        return Err(Failure::file(path, "is a folder; name a file in it"));
    }
    std::fs::read(path).map_err(|error| Failure::file(path, error))
}

/// The numbers of the bodies with these names, each once.
pub(crate) fn bodies(asked: &[String], names: &[&str]) -> Result<Vec<usize>, Failure> {
    let number = |name: &String| {
        let found = names.iter().position(|known| known == name);
        found.ok_or_else(|| {
            Failure::input(format!("--body: {}", unknown_name("body", name, names)))
        })
    };
    let mut bodies = asked.iter().map(number).collect::<Result<Vec<_>, _>>()?;
    bodies.sort_unstable();
    bodies.dedup();
    Ok(bodies)
}

/// The scene at a time [s].
pub(crate) fn at<const D: usize>(
    scene: &BuiltScene<D>,
    time: f64,
) -> Result<BuiltScene<D>, Failure> {
    // Written so that NaN is refused.
    if !(time >= 0.0 && time.is_finite()) {
        let rule = "--time must be finite and zero or more";
        return Err(Failure::input(format!("{rule}, got {time} s")));
    }
    scene.at(time).map_err(Failure::input)
}

/// The point that `text` names: as many numbers as dimensions, joined by commas.
pub(crate) fn point<const D: usize>(text: &str) -> Result<Vector<f64, D>, Failure> {
    let numbers: [f64; D] = numbers(text).ok_or_else(|| {
        Failure::input(format!("a point needs {D} numbers joined by commas, got {text:?}"))
    })?;
    for x in numbers {
        if x.is_nan() || x.abs() > LARGEST_LENGTH {
            let rule = format!("a coordinate must be at most {LARGEST_LENGTH:e} m, got {x}");
            return Err(Failure::input(rule));
        }
    }
    Ok(Vector(numbers))
}

/// The numbers that `text` lists, joined by commas, if there are `N`.
pub(crate) fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let numbers = text.split(',').map(|number| number.trim().parse().ok());
    numbers.collect::<Option<Vec<f64>>>()?.try_into().ok()
}

/// The way to a gradient of this name, for `D` dimensions.
pub(crate) fn gradient<const D: usize>(name: &str) -> Result<GradientMethod, Failure> {
    let method: GradientMethod =
        name.parse().map_err(|error| Failure::input(format!("--gradient: {error}")))?;
    if D > 2 && method.is_planar() {
        return Err(Failure::input(format!(
            "--gradient {method} turns in the plane, and this scene is in 3D: \
             take differences, closest_vector or exact"
        )));
    }
    Ok(method)
}

/// Numbers as one text, joined by commas.
pub(crate) fn joined(numbers: &[f64]) -> String {
    numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(", ")
}

/// The error of a scene without bounds where bounds are needed.
pub(crate) const NO_BOUNDS: &str = "the scene must have a body with bounds";

/// The box around all bounded bodies of a scene.
pub(crate) fn bounds<const D: usize>(scene: &BuiltScene<D>) -> Result<Aabb<D>, Failure> {
    scene.bounds().ok_or_else(|| Failure::input(NO_BOUNDS))
}

/// The longest edge of a box [m].
pub(crate) fn longest_edge<const D: usize>(bounds: &Aabb<D>) -> f64 {
    2.0 * bounds.half_extents().0.into_iter().fold(0.0, f64::max)
}

/// A promise in a few words: "exact outside, bound inside".
pub(crate) fn promise_in_words<const D: usize>(promise: &Promise<D>) -> String {
    let outside = quality_in_words(promise.outside);
    if !promise.has_interior {
        return format!("{outside} outside, no inside");
    }
    format!("{outside} outside, {} inside", quality_in_words(promise.inside))
}

pub(crate) fn quality_in_words(quality: Quality) -> &'static str {
    match quality {
        Quality::Exact => "exact",
        Quality::Bound => "bound",
        Quality::Lipschitz => "Lipschitz",
    }
}
