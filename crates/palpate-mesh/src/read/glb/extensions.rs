// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Extensions of glTF that a file requires.
//!
//! One that only paints changes no triangle and is no obstacle. One that compresses is refused
//! with the command that unpacks it.

use super::document::Document;
use crate::read::ReadProblem;
use crate::read::text::quoted;

/// Extensions that are read.
const READ: [&str; 3] =
    ["KHR_mesh_quantization", "EXT_mesh_gpu_instancing", "KHR_node_visibility"];

/// What the second word of a name says of an extension that moves no triangle: materials,
/// pictures, light and sound, notes, and what happens later.
const PAINTS: [&str; 20] = [
    "animation",
    "audio",
    "environment",
    "image",
    "interactivity",
    "light",
    "lights",
    "material",
    "materials",
    "metadata",
    "packing",
    "physics",
    "sampler",
    "sky",
    "techniques",
    "texture",
    "textureinfo",
    "textures",
    "toon",
    "xmp",
];

/// Others that move no triangle, whose names do not say so.
const LEAVES_TRIANGLES: [&str; 12] = [
    "AGI_articulations",
    "AGI_stk_metadata",
    "CESIUM_primitive_outline",
    "EXT_instance_features",
    "EXT_mesh_features",
    "EXT_mesh_manifold",
    "EXT_structural_metadata",
    "FB_geometry_metadata",
    "KHR_implicit_shapes",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "MSFT_lod",
];

const DRACO: &str = "KHR_draco_mesh_compression";

/// Refuses a document that requires an extension which is not read.
pub(super) fn check(document: &Document) -> Result<(), ReadProblem> {
    let is_no_obstacle = |name: &str| {
        READ.contains(&name) || LEAVES_TRIANGLES.contains(&name) || only_paints(name)
    };
    let obstacle = document.extensions_required.iter().find(|name| !is_no_obstacle(name));
    obstacle.map_or(Ok(()), |name| Err(refused(name)))
}

/// The complaint that an extension is not read, and what to do.
pub(super) fn refused(name: &str) -> ReadProblem {
    let advice = match name {
        DRACO => "unpack it, for example with `gltf-transform copy in.glb out.glb`",
        "EXT_meshopt_compression" | "KHR_meshopt_compression" => {
            "unpack it, for example with `gltf-transform copy in.glb out.glb` or \
             `gltfpack -noq -i in.glb -o out.glb`"
        }
        _ => "export without it",
    };
    let name = quoted(name);
    ReadProblem::Extension { name: name.trim_matches('"').to_owned(), advice }
}

/// The complaint that data are compressed by Draco.
pub(super) fn draco() -> ReadProblem {
    refused(DRACO)
}

/// Whether a name says that its extension moves no triangle: `VENDOR_materials_shine`.
fn only_paints(name: &str) -> bool {
    let kind = name.split('_').nth(1).unwrap_or_default();
    PAINTS.contains(&kind.to_ascii_lowercase().as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_that_only_paint_are_known_by_their_names() {
        for name in [
            "KHR_materials_unlit",
            "ADOBE_materials_thin_transparency",
            "VRMC_materials_mtoon",
            "ACME_materials_shine",
            "KHR_texture_basisu",
            "EXT_texture_webp",
            "MSFT_texture_dds",
            "KHR_lights_punctual",
            "EXT_lights_image_based",
            "KHR_xmp_json_ld",
            "KHR_animation_pointer",
            "KHR_techniques_webgl",
        ] {
            assert!(only_paints(name), "{name}");
        }
        for name in
            ["CESIUM_RTC", "EXT_mesh_primitive_restart", "ACME_terrain", "materials", ""]
        {
            assert!(!only_paints(name), "{name}");
        }
    }
}
