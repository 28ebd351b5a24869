// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What matters of the JSON of glTF: that which places triangles.
//!
//! Materials, animations and all else are passed over, whatever they hold. What a small file
//! can repeat often is kept small in memory.

use std::collections::BTreeMap;
use std::fmt;

use serde::Deserialize;

use super::{Chunks, malformed};
use crate::read::ReadProblem;
use crate::read::text::quoted;

/// The document of a file.
pub(super) fn read(chunks: &Chunks<'_>) -> Result<Document, ReadProblem> {
    let document: Document = serde_json::from_slice(chunks.json)
        .map_err(|error| malformed(in_words(&error, chunks)))?;
    let Some(asset) = &document.asset else {
        return Err(malformed("its JSON has no `asset`, as glTF has"));
    };
    match asset.version.as_deref() {
        Some(version) if !version.starts_with("2.") => Err(malformed(format_args!(
            "it is glTF {}, and version 2.0 is read",
            quoted(version)
        ))),
        _ => Ok(document),
    }
}

/// What is wrong with the JSON, and at which byte of the file.
fn in_words(error: &serde_json::Error, chunks: &Chunks<'_>) -> String {
    /// Bytes before the place that are quoted.
    const SHOWN: usize = 30;
    let lines = chunks.json.split_inclusive(|byte| *byte == b'\n');
    let before: usize = lines.take(error.line().saturating_sub(1)).map(<[u8]>::len).sum();
    let end = (before + error.column()).min(chunks.json.len());
    let shown = String::from_utf8_lossy(&chunks.json[end.saturating_sub(SHOWN)..end]);
    let problem = match error.classify() {
        serde_json::error::Category::Eof => "the JSON ends there: it is cut off",
        serde_json::error::Category::Data => {
            "a value there is of the wrong kind or out of range, or a key is missing or there twice"
        }
        _ => "it is no JSON there",
    };
    format!("byte {}: {problem}, at the end of {}", chunks.json_start + end, quoted(&shown))
}

/// A whole number: an index, a count, or an offset in bytes. Some programs write `8.0`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deserialize)]
#[serde(try_from = "f64")]
pub(super) struct Whole(u32);

impl Whole {
    pub(super) fn get(self) -> usize {
        self.0 as usize
    }
}

impl fmt::Display for Whole {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl TryFrom<f64> for Whole {
    type Error = &'static str;

    fn try_from(number: f64) -> Result<Self, Self::Error> {
        let whole = number as u32;
        if f64::from(whole) == number { Ok(Self(whole)) } else { Err("no whole number") }
    }
}

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Document {
    asset: Option<Asset>,
    pub(super) scene: Option<Whole>,
    pub(super) scenes: Vec<Scene>,
    pub(super) nodes: Vec<Node>,
    pub(super) meshes: Vec<Mesh>,
    pub(super) accessors: Vec<Accessor>,
    pub(super) buffer_views: Vec<View>,
    pub(super) buffers: Vec<Buffer>,
    pub(super) extensions_required: Vec<String>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct Asset {
    version: Option<String>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct Scene {
    pub(super) nodes: Vec<Whole>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct Node {
    pub(super) mesh: Option<Whole>,
    pub(super) skin: Option<Whole>,
    pub(super) children: Vec<Whole>,
    pub(super) weights: Vec<f64>,
    /// Columns, one after the other.
    pub(super) matrix: Option<Box<[f64; 16]>>,
    pub(super) translation: Option<Box<[f64; 3]>>,
    pub(super) rotation: Option<Box<[f64; 4]>>,
    pub(super) scale: Option<Box<[f64; 3]>>,
    pub(super) extensions: Option<Box<NodeExtensions>>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct NodeExtensions {
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub(super) instancing: Option<Instancing>,
    #[serde(rename = "KHR_node_visibility")]
    pub(super) visibility: Option<Visibility>,
}

#[derive(Deserialize)]
pub(super) struct Instancing {
    pub(super) attributes: BTreeMap<String, Whole>,
}

#[derive(Deserialize)]
pub(super) struct Visibility {
    #[serde(default = "visible")]
    pub(super) visible: bool,
}

fn visible() -> bool {
    true
}

#[derive(Deserialize)]
pub(super) struct Mesh {
    pub(super) primitives: Vec<Primitive>,
    #[serde(default)]
    pub(super) weights: Vec<f64>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct Primitive {
    pub(super) attributes: Attributes,
    pub(super) indices: Option<Whole>,
    pub(super) mode: Option<Whole>,
    pub(super) targets: Vec<Attributes>,
    extensions: Option<Box<Compressed>>,
}

impl Primitive {
    pub(super) fn is_draco(&self) -> bool {
        self.extensions.as_ref().is_some_and(|extensions| extensions.draco.is_some())
    }
}

#[derive(Clone, Default, PartialEq, Eq, Hash, Deserialize)]
#[serde(default)]
pub(super) struct Attributes {
    #[serde(rename = "POSITION")]
    pub(super) position: Option<Whole>,
}

/// Whether an extension is there that compresses.
#[derive(Default, Deserialize)]
#[serde(default)]
struct Compressed {
    #[serde(rename = "KHR_draco_mesh_compression")]
    draco: Option<serde::de::IgnoredAny>,
    #[serde(rename = "EXT_meshopt_compression")]
    ext_meshopt: Option<serde::de::IgnoredAny>,
    #[serde(rename = "KHR_meshopt_compression")]
    khr_meshopt: Option<serde::de::IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<Whole>,
    #[serde(default)]
    pub(super) byte_offset: Whole,
    pub(super) component_type: Whole,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) count: Whole,
    #[serde(rename = "type")]
    pub(super) kind: String,
    pub(super) sparse: Option<Box<Sparse>>,
}

/// Items that differ from those of the accessor.
#[derive(Deserialize)]
pub(super) struct Sparse {
    pub(super) count: Whole,
    pub(super) indices: SparseIndices,
    pub(super) values: SparseValues,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseIndices {
    pub(super) buffer_view: Whole,
    #[serde(default)]
    pub(super) byte_offset: Whole,
    pub(super) component_type: Whole,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseValues {
    pub(super) buffer_view: Whole,
    #[serde(default)]
    pub(super) byte_offset: Whole,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct View {
    pub(super) buffer: Whole,
    #[serde(default)]
    pub(super) byte_offset: Whole,
    pub(super) byte_length: Whole,
    pub(super) byte_stride: Option<Whole>,
    extensions: Option<Box<Compressed>>,
}

impl View {
    /// The extension that compresses the data, if there is one.
    pub(super) fn compression(&self) -> Option<&'static str> {
        let extensions = self.extensions.as_ref()?;
        let ext = extensions.ext_meshopt.map(|_| "EXT_meshopt_compression");
        ext.or_else(|| extensions.khr_meshopt.map(|_| "KHR_meshopt_compression"))
    }
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct Buffer {
    pub(super) uri: Option<String>,
}
