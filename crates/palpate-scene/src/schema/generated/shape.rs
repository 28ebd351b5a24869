// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The schema of a shape: its keys, and which go together.

use palpate_field::kernel::{Parameter, ParameterKind};
use palpate_field::operator::{Operator, Profile};
use palpate_grid::{GridKernel, GridOptions, Inside, Store};
use serde_json::{Map, Value, json};

use super::{place, reference};
use crate::catalogue::{self, Signature, file_key};
use crate::keys::{self, DESCRIPTION, LISTS, OF};
use crate::scene::Dimension;

/// A shape: the name of another shape, or an object.
///
/// The object lists all keys in one place, so that editors propose them; exactly
/// one of them, or a translation with a rotation, makes the shape.
pub(super) fn schema(dimension: Dimension) -> Value {
    let mut properties = Map::new();
    let mut makers = Vec::new();
    let requires = |key: &str| json!({ "required": [key] });
    for signature in catalogue::signatures().filter(|s| s.dimension == dimension) {
        properties.insert(signature.name.to_owned(), primitive(&signature));
        makers.push(requires(signature.name));
    }
    for (key, about) in LISTS {
        let mut list = json!({
            "description": about,
            "type": "array",
            "items": { "$ref": "#/$defs/Shape" },
            "minItems": 1,
        });
        if keys::PAIRS.contains(&key) {
            (list["minItems"], list["maxItems"]) = (2.into(), 2.into());
        }
        properties.insert(key.to_owned(), list);
        makers.push(requires(key));
    }
    let mut with_of = Vec::new();
    for (key, about) in keys::unary() {
        let Some(value) = operator(key, dimension) else { continue };
        let mut value = value;
        value["description"] = about.into();
        properties.insert(key.to_owned(), value);
        with_of.push(key);
    }
    // Moving and turning go together, so they count as one.
    let (moving, others): (Vec<&str>, Vec<&str>) =
        with_of.iter().partition(|key| keys::MOVES.contains(*key));
    makers.extend(others.into_iter().map(requires));
    makers.push(json!({ "anyOf": moving.into_iter().map(requires).collect::<Vec<_>>() }));
    makers.push(requires(keys::SHAPE));
    properties.insert(keys::GRID.to_owned(), grid());
    makers.push(requires(keys::GRID));
    if dimension == Dimension::Three {
        properties.insert(keys::MESH.to_owned(), mesh());
        makers.push(requires(keys::MESH));
        properties.insert(keys::VOLUME.to_owned(), volume());
        makers.push(requires(keys::VOLUME));
    }

    let rest = [
        (keys::WIDTH, json!({ "type": "number", "exclusiveMinimum": 0 })),
        (keys::PROFILE, json!({ "enum": Profile::ALL.map(Profile::name) })),
        (keys::HEIGHT, json!({ "type": "number", "exclusiveMinimum": 0 })),
        (keys::PROGRESS, json!({ "type": "number", "minimum": 0, "maximum": 1 })),
        (OF, operand(dimension)),
        (
            keys::SHAPE,
            json!({
                "description": "The name of another shape; a string instead of the object is the same.",
                "type": "string",
            }),
        ),
        (DESCRIPTION, json!({ "description": "What it is for.", "type": "string" })),
    ];
    properties.extend(rest.map(|(key, value)| (key.to_owned(), value)));

    let mut together = Map::new();
    for key in &with_of {
        together.insert((*key).to_owned(), json!([OF]));
    }
    // `of` needs one of the operators that take it, numbers one of their lists.
    let any_of = |keys: &[&str]| json!({ "anyOf": keys.iter().map(|key| requires(key)).collect::<Vec<_>>() });
    let mut needs = Map::new();
    needs.insert(OF.to_owned(), any_of(&with_of));
    for (key, is_needed, lists, about) in keys::WITH_LISTS {
        properties[key]["description"] = format!("{}.", capitalised(about)).into();
        needs.insert(key.to_owned(), any_of(lists));
        if is_needed {
            together.extend(lists.iter().map(|list| ((*list).to_owned(), json!([key]))));
        }
    }
    let mut shape = json!({
        "description": "A shape: an object that makes it, or the name of another shape.",
        "type": ["object", "string"],
        "properties": properties,
        "additionalProperties": false,
        "dependentRequired": together,
        "if": { "type": "object" },
        "then": { "oneOf": makers },
        "dependentSchemas": needs,
    });
    shape["not"] = json!({
        "type": "object",
        "required": [keys::ROTATE_DEGREES, keys::ROTATION],
    });
    if dimension == Dimension::Three {
        flat_operands(&mut shape);
    }
    shape
}

/// The shapes that have a name: in space they may be flat.
pub(super) fn named_shapes(dimension: Dimension) -> Value {
    let own = json!({ "$ref": "#/$defs/Shape" });
    let each = match dimension {
        Dimension::Two => own,
        Dimension::Three => json!({ "anyOf": [own, flat()] }),
    };
    json!({
        "type": "object",
        "propertyNames": { "minLength": 1 },
        "additionalProperties": each,
    })
}

/// The reference to a shape of the plane.
fn flat() -> Value {
    json!({ "$ref": reference(Dimension::Two, "Shape") })
}

/// What `of` takes before the operator is known.
fn operand(dimension: Dimension) -> Value {
    let about = "The shape that the operator is applied to.";
    match dimension {
        Dimension::Two => json!({ "description": about, "$ref": "#/$defs/Shape" }),
        Dimension::Three => json!({ "description": about }),
    }
}

/// In space, what is extruded or revolved is flat and everything else is not.
fn flat_operands(shape: &mut Value) {
    let makes_solid = json!({
        "anyOf": [{ "required": [keys::EXTRUDE] }, { "required": [keys::REVOLVE] }],
    });
    let of = |schema: Value| json!({ "properties": { OF: schema } });
    shape["allOf"] = json!([{
        "if": makes_solid,
        "then": of(flat()),
        "else": of(json!({ "$ref": format!("#/$defs/{}/Shape", place(Dimension::Three)) })),
    }]);
}

/// Rows of copies along the axes of the dimension.
fn rows(dimension: Dimension) -> Value {
    let number = json!({ "type": "integer" });
    let row = json!({
        "type": "object",
        "properties": {
            "spacing": { "type": "number", "exclusiveMinimum": 0 },
            "first": number,
            "last": number,
        },
        "anyOf": [
            { "required": ["spacing"] },
            {
                "description": "The shape alone.",
                "properties": { "first": { "const": 0 }, "last": { "const": 0 } },
                "required": ["first", "last"],
            },
        ],
        "dependentRequired": { "first": ["last"], "last": ["first"] },
        "additionalProperties": false,
    });
    let mut axes = Map::new();
    for axis in keys::AXES.into_iter().take(dimension.count()) {
        axes.insert(axis.to_owned(), row.clone());
    }
    json!({
        "type": "object",
        "properties": axes,
        "minProperties": 1,
        "additionalProperties": false,
    })
}

/// The value of an operator with one operand; `None` if the dimension lacks it.
fn operator(key: &str, dimension: Dimension) -> Option<Value> {
    let is_solid = dimension == Dimension::Three;
    let factor = json!({ "type": "number", "exclusiveMinimum": 0 });
    if let Some(operator) = Operator::find(key) {
        let number = match operator.kind {
            ParameterKind::Length => factor,
            ParameterKind::LengthOrZero => json!({ "type": "number", "minimum": 0 }),
            _ => json!({ "type": "number" }),
        };
        return Some(if operator.is_per_axis { factors(&number, dimension) } else { number });
    }
    Some(match key {
        keys::TRANSLATE => json!({ "$ref": "#/$defs/Vector" }),
        keys::ROTATE_DEGREES => json!({ "$ref": "#/$defs/Turn" }),
        keys::ROTATION => json!({ "$ref": "#/$defs/Rotation" }),
        keys::SCALE => json!({ "anyOf": [factor, factors(&factor, dimension)] }),
        keys::OFFSET => json!({ "type": "number" }),
        keys::MIRROR => json!({ "enum": keys::AXES[..dimension.count()] }),
        keys::REPEAT => rows(dimension),
        keys::BEND_DEGREES | keys::BEND => json!({ "type": "number" }),
        keys::TWIST_DEGREES | keys::TWIST if is_solid => json!({ "type": "number" }),
        keys::BAKE => bake(),
        keys::EXTRUDE if is_solid => factor,
        keys::REVOLVE if is_solid => json!({ "enum": ["y"] }),
        _ => return None,
    })
}

/// One of `each` for each dimension.
fn factors(each: &Value, dimension: Dimension) -> Value {
    let size = dimension.count();
    json!({ "type": "array", "items": each, "minItems": size, "maxItems": size })
}

/// The parameters of a primitive.
fn primitive(signature: &Signature) -> Value {
    let mut properties = Map::new();
    let mut required = Vec::new();
    let mut angles = Vec::new();
    for parameter in signature.parameters {
        let key = file_key(parameter);
        if *key == *parameter.name {
            required.push(Value::from(parameter.name));
        } else {
            let mut radians = value(parameter);
            radians["description"] = format!("{} [rad]", capitalised(parameter.about)).into();
            properties.insert(parameter.name.to_owned(), radians);
            let either = [&*key, parameter.name].map(|key| json!({ "required": [key] }));
            angles.push(json!({ "oneOf": either }));
        }
        properties.insert(key.into_owned(), value(parameter));
    }
    properties.insert(DESCRIPTION.to_owned(), json!({ "type": "string" }));
    let mut primitive = json!({
        "description": signature.about,
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    });
    if !angles.is_empty() {
        primitive["allOf"] = angles.into();
    }
    primitive
}

/// The value of a parameter.
fn value(parameter: &Parameter) -> Value {
    let list = |items: Value| json!({ "type": "array", "items": items });
    let vector = json!({ "$ref": "#/$defs/Vector" });
    let (unit, mut value) = match parameter.kind {
        ParameterKind::Length => (" [m]", json!({ "type": "number", "exclusiveMinimum": 0 })),
        ParameterKind::LengthOrZero => (" [m]", json!({ "type": "number", "minimum": 0 })),
        ParameterKind::Angle => (" [°]", json!({ "type": "number" })),
        ParameterKind::Count => ("", json!({ "type": "integer", "minimum": 0 })),
        ParameterKind::Vector => (" [m]", vector),
        ParameterKind::Direction => ("", vector),
        ParameterKind::Points => (" [m]", list(vector)),
        ParameterKind::Rings => (" [m]", list(list(vector))),
        // A coordinate, and what later kinds are at least.
        _ => (" [m]", json!({ "type": "number" })),
    };
    value["description"] = format!("{}{unit}", capitalised(parameter.about)).into();
    value
}

/// The text with a capital first letter.
fn capitalised(text: &str) -> String {
    let mut characters = text.chars();
    match characters.next() {
        Some(first) => first.to_uppercase().chain(characters).collect(),
        None => String::new(),
    }
}

/// The surface of a volume.
fn volume() -> Value {
    json!({
        "description": "What lies within a surface of a volume, where samples are above or below a value: a file, beside the scene's or in a folder beside it.",
        "type": "object",
        "properties": {
            "file": {
                "description": "An NRRD, MetaImage, NIfTI, NumPy or NanoVDB file.",
                "type": "string",
                "minLength": 1,
            },
            "grid": {
                "description": "The name of a grid, of a NanoVDB file that has several.",
                "type": "string",
            },
            "value": {
                "description": "The value at the surface, between the least and the largest sample.",
                "type": "number",
            },
            "scale": {
                "description": "A factor of all lengths; 1 if left out. Of NumPy, which has no lengths, metres between samples.",
                "type": "number",
                "exclusiveMinimum": 0,
            },
            "inside": {
                "description": "The side of the value that is inside: above for densities, below for distances that are negative inside. If left out, below for a level set of NanoVDB, else above.",
                "enum": Inside::ALL.map(Inside::name),
            },
        },
        "required": ["file", "value"],
        "additionalProperties": false,
    })
}

/// The grid of a file, or of samples.
fn grid() -> Value {
    let numbers = |about: &str| json!({ "description": about, "type": "array", "items": { "type": "number" } });
    let of_samples = ["samples", "counts", "cell", "origin"];
    let any_of_samples: Vec<Value> =
        of_samples.iter().chain(&["kernel"]).map(|key| json!({ "required": [key] })).collect();
    json!({
        "description": "A field of samples: a grid that was baked before, from a file, beside the scene's or in a folder beside it; or samples that stand here.",
        "type": "object",
        "properties": {
            "file": { "description": "A file of `palpate grid`.", "type": "string", "minLength": 1 },
            "samples": numbers("The values at the nodes [m], along the first axis first; those at the border are positive."),
            "counts": {
                "description": "How many nodes there are along each axis.",
                "type": "array",
                "items": { "type": "integer", "minimum": 2 },
            },
            "cell": { "description": "How far nodes are apart [m].", "type": "number", "exclusiveMinimum": 0 },
            "origin": numbers("The place of the first node [m]."),
            "kernel": {
                "description": "How samples are interpolated; quadratic if left out, to be touched.",
                "enum": GridKernel::ALL.map(GridKernel::name),
            },
        },
        "oneOf": [
            { "required": ["file"], "not": { "anyOf": any_of_samples } },
            { "required": of_samples, "not": { "required": ["file"] } },
        ],
        "additionalProperties": false,
    })
}

/// How a shape is baked.
fn bake() -> Value {
    let length =
        |about: &str| json!({ "description": about, "type": "number", "exclusiveMinimum": 0 });
    json!({
        "type": "object",
        "properties": {
            "tolerance": length("The largest deviation from the shape [m]; cells are as small as it takes."),
            "cell": length("The size of a cell [m], instead of a tolerance."),
            "kernel": {
                "description": "How samples are interpolated; quadratic if left out, to be touched.",
                "enum": GridKernel::ALL.map(GridKernel::name),
            },
            "store": {
                "description": "How samples are stored; f32 if left out.",
                "enum": Store::ALL.map(Store::name),
            },
            "band": {
                "description": "Only samples within so many cells of the surface are kept; all if left out.",
                "type": "number",
                "minimum": GridOptions::SMALLEST_BAND,
            },
        },
        "oneOf": [{ "required": ["tolerance"] }, { "required": ["cell"] }],
        "additionalProperties": false,
    })
}

/// The solid of a mesh.
fn mesh() -> Value {
    json!({
        "description": "The solid that a mesh of triangles bounds: of a file, beside the scene's or in a folder beside it, or of vertices and faces.",
        "type": "object",
        "properties": {
            "file": {
                "description": "An OBJ, STL, PLY or GLB file.",
                "type": "string",
                "minLength": 1,
            },
            "scale": {
                "description": "Metres for a unit of the file: 0.001 for millimetres; 1 if left out.",
                "type": "number",
                "exclusiveMinimum": 0,
            },
            "vertices": {
                "description": "The vertices [m].",
                "type": "array",
                "items": { "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 },
            },
            "faces": {
                "description": "The numbers of each triangle's vertices, from 0.",
                "type": "array",
                "items": { "type": "array", "items": { "type": "integer", "minimum": 0 }, "minItems": 3, "maxItems": 3 },
            },
            "thickness": {
                "description": "Of faces that bound nothing, the thickness of the plate about them [m].",
                "type": "number",
                "exclusiveMinimum": 0,
            },
            "weld_within": {
                "description": "Corners at open edges that are at most this far apart are joined where that closes edges [m]; if left out, those equal up to rounding; with 0, those exactly equal.",
                "type": "number",
                "minimum": 0,
            },
        },
        "oneOf": [
            { "required": ["file"], "not": { "anyOf": [{ "required": ["vertices"] }, { "required": ["faces"] }] } },
            {
                "required": ["vertices", "faces"],
                "not": { "anyOf": [{ "required": ["file"] }, { "required": ["scale"] }] },
            },
        ],
        "additionalProperties": false,
    })
}
