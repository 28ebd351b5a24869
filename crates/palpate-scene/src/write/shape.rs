// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! From the node of a shape to what a file holds.

use std::collections::HashMap;

use indexmap::IndexMap;
use palpate_field::kernel::{Argument, ParameterKind};
use palpate_field::operator::{Boolean, Copies};
use palpate_field::{Node, Point, Pose, Shape, node};
use palpate_grid::Grid;
use palpate_mesh::{MeshSheet, Solid};
use serde_json::{Map, Value, json};

use super::{rotation, translation};
use crate::angle::degrees;
use crate::build::MOST;
use crate::catalogue::file_key;
use crate::grids::{WrittenBake, WrittenGrid};
use crate::keys;
use crate::pose;
use crate::problem::Problem;
use crate::shape::WrittenShape;

/// Where a shape lies in memory: equal for clones alone, as long as one of them is kept.
type Address = usize;

fn address<const D: usize>(shape: &Shape<D>) -> Address {
    std::ptr::from_ref(shape.node()).addr()
}

/// Writes shapes, those that are there more than once as named ones.
pub(crate) struct Writer {
    /// How often each shape is held.
    uses: HashMap<Address, usize>,
    /// The names of those that are written already.
    names: HashMap<Address, String>,
    /// The named shapes of the scene.
    shapes: IndexMap<String, WrittenShape>,
    /// How many objects were written.
    objects: usize,
}

impl Writer {
    /// A writer for a scene that has `shapes` already.
    pub(crate) fn new(shapes: IndexMap<String, WrittenShape>) -> Self {
        Self { uses: HashMap::new(), names: HashMap::new(), shapes, objects: 0 }
    }

    /// The named shapes, those of this writer included.
    pub(crate) fn finish(self) -> IndexMap<String, WrittenShape> {
        self.shapes
    }

    /// Counts the uses of a shape and of those in it; the shape must outlive the writer.
    pub(crate) fn count<const D: usize>(&mut self, shape: &Shape<D>) {
        let uses = self.uses.entry(address(shape)).or_default();
        *uses += 1;
        if *uses > 1 {
            return;
        }
        match shape.node() {
            Node::Union(of)
            | Node::Intersection(of)
            | Node::Difference(of)
            | Node::SymmetricDifference(of)
            | Node::Smooth { of, .. } => of.iter().for_each(|shape| self.count(shape)),
            Node::Displaced { of: a, by: b, .. } | Node::Morphed { from: a, into: b, .. } => {
                self.count(a);
                self.count(b);
            }
            Node::Placed { of, .. }
            | Node::Scaled { of, .. }
            | Node::Stretched { of, .. }
            | Node::Offset { of, .. }
            | Node::Operated { of, .. }
            | Node::Mirrored { of, .. }
            | Node::Repeated { of, .. }
            | Node::Bent { of, .. }
            | Node::Twisted { of, .. } => self.count(of),
            Node::Extruded { of, .. } | Node::Revolved { of } => self.count(of),
            Node::Opaque(opaque) => {
                if let Some((of, _)) = opaque.custom::<Grid<D>>().and_then(Grid::source) {
                    self.count(of);
                }
            }
            _ => {}
        }
    }

    /// A shape that was counted, or the reference to it.
    pub(crate) fn shape<const D: usize>(
        &mut self,
        shape: &Shape<D>,
    ) -> Result<WrittenShape, Problem> {
        self.json(shape).map(WrittenShape::new)
    }

    fn json<const D: usize>(&mut self, shape: &Shape<D>) -> Result<Value, Problem> {
        let address = address(shape);
        if let Some(name) = self.names.get(&address) {
            return Ok(name.as_str().into());
        }
        self.objects += 1;
        if self.objects > MOST {
            return Err(Problem::new(format!("a file holds at most {MOST} shapes")));
        }
        let json = self.object(shape.node())?;
        if self.uses.get(&address).is_none_or(|uses| *uses < 2) {
            return Ok(json);
        }
        let name = self.unused_name();
        self.shapes.insert(name.clone(), WrittenShape::new(json));
        self.names.insert(address, name.clone());
        Ok(name.into())
    }

    fn unused_name(&self) -> String {
        let mut number = self.names.len() + 1;
        loop {
            let name = format!("shared_{number}");
            if !self.shapes.contains_key(&name) {
                return name;
            }
            number += 1;
        }
    }

    /// The object of a node: the operator's numbers, then its operands.
    fn object<const D: usize>(&mut self, node: &Node<D>) -> Result<Value, Problem> {
        let (mut object, list, operands): (_, _, Vec<&Shape<D>>) = match node {
            Node::Primitive(primitive) => {
                return Ok(json!({ primitive.name(): arguments(primitive) }));
            }
            Node::Union(of) => (json!({}), keys::UNION, of.iter().collect()),
            Node::Intersection(of) => (json!({}), keys::INTERSECTION, of.iter().collect()),
            Node::Difference(of) => (json!({}), keys::DIFFERENCE, of.iter().collect()),
            Node::SymmetricDifference(of) => {
                (json!({}), keys::SYMMETRIC_DIFFERENCE, of.iter().collect())
            }
            Node::Smooth { boolean, profile, width, of } => {
                let list = match boolean {
                    Boolean::Union => keys::SMOOTH_UNION,
                    Boolean::Intersection => keys::SMOOTH_INTERSECTION,
                    Boolean::Difference => keys::SMOOTH_DIFFERENCE,
                };
                let numbers = json!({ keys::WIDTH: width, keys::PROFILE: profile.name() });
                (numbers, list, of.iter().collect())
            }
            Node::Displaced { of, by, height } => {
                (json!({ keys::HEIGHT: height }), keys::DISPLACE, vec![of, by])
            }
            Node::Morphed { from, into, progress } => {
                (json!({ keys::PROGRESS: progress }), keys::MORPH, vec![from, into])
            }
            _ => return self.unary(node),
        };
        let operands = operands.into_iter().enumerate();
        let operand =
            |(i, shape)| self.json(shape).map_err(|problem| problem.at(i).under(list));
        object[list] = operands.map(operand).collect::<Result<_, _>>()?;
        Ok(object)
    }

    /// The operators on one shape.
    fn unary<const D: usize>(&mut self, node: &Node<D>) -> Result<Value, Problem> {
        let (object, of) = match node {
            Node::Placed { pose, of } => (placement(pose), of),
            Node::Scaled { factor, of } => (json!({ keys::SCALE: factor }), of),
            Node::Stretched { factors, of } => (json!({ keys::SCALE: &factors[..] }), of),
            Node::Offset { distance, of } => (json!({ keys::OFFSET: distance }), of),
            Node::Operated { operator, argument, of } => {
                (json!({ operator.name: value(argument) }), of)
            }
            Node::Mirrored { axis, of } => (json!({ keys::MIRROR: keys::AXES[*axis] }), of),
            Node::Repeated { copies, of } => (json!({ keys::REPEAT: rows(copies) }), of),
            Node::Bent { rate, of } => {
                let (key, rate) = angle(keys::BEND_DEGREES, keys::BEND, *rate);
                (json!({ key: rate }), of)
            }
            Node::Twisted { rate, of } => {
                let (key, rate) = angle(keys::TWIST_DEGREES, keys::TWIST, *rate);
                (json!({ key: rate }), of)
            }
            Node::Extruded { height, of } => {
                return self.with_operand(json!({ keys::EXTRUDE: height }), of);
            }
            Node::Revolved { of } => {
                return self.with_operand(json!({ keys::REVOLVE: "y" }), of);
            }
            Node::Opaque(opaque) => {
                let Some(grid) = opaque.custom::<Grid<D>>() else { return mesh(opaque) };
                let Some((of, options)) = grid.source() else {
                    let written = WrittenGrid::of(grid).ok_or_else(|| {
                        let message = "a grid of which samples in single precision are not all that is known cannot \
                                       be written: save it, and name its file";
                        Problem::new(message)
                    })?;
                    return Ok(json!({ keys::GRID: written }));
                };
                (json!({ keys::BAKE: WrittenBake::of(options)? }), of)
            }
            other => return Err(Problem::new(format!("files have no operator for {other:?}"))),
        };
        self.with_operand(object, of)
    }

    /// The object of an operator with the shape that it is applied to.
    fn with_operand<const D: usize>(
        &mut self,
        mut object: Value,
        of: &Shape<D>,
    ) -> Result<Value, Problem> {
        object[keys::OF] = self.json(of).map_err(|problem| problem.under(keys::OF))?;
        Ok(object)
    }
}

/// The solid of a mesh, or the plate about its faces, with its vertices and faces.
fn mesh<const D: usize>(opaque: &node::Opaque<D>) -> Result<Value, Problem> {
    // Scenes have meshes in space alone.
    let in_space = (D == 3).then_some(opaque);
    let solid = in_space.and_then(|opaque| opaque.custom::<Solid<3, D>>());
    let sheet = in_space.and_then(|opaque| opaque.custom::<MeshSheet<3, D>>());
    let mut object = match (solid, sheet) {
        (Some(solid), _) => arrays(solid.vertices(), solid.elements()),
        (None, Some(sheet)) => arrays(sheet.mesh().vertices(), sheet.mesh().elements()),
        (None, None) => {
            let kind = opaque.type_name();
            let message = format!(
                "`{kind}` is opaque: files hold primitives, operators, meshes and grids"
            );
            return Err(Problem::new(message));
        }
    };
    if let Some(sheet) = sheet {
        object["thickness"] = json!(sheet.thickness());
    }
    Ok(json!({ keys::MESH: object }))
}

fn arrays<const D: usize>(vertices: &[Point<D>], faces: &[[u32; 3]]) -> Value {
    let vertices: Vec<&[f64]> = vertices.iter().map(|vertex| &vertex.0[..]).collect();
    json!({ "vertices": vertices, "faces": faces })
}

/// The arguments of a primitive, by their keys.
fn arguments<const D: usize>(primitive: &node::Primitive<D>) -> Value {
    let mut object = Map::new();
    for (parameter, argument) in primitive.named() {
        let (key, value) = match argument {
            Argument::Number(number) if parameter.kind == ParameterKind::Angle => {
                angle(&file_key(parameter), parameter.name, *number)
            }
            other => (parameter.name.to_owned(), value(other)),
        };
        object.insert(key, value);
    }
    Value::Object(object)
}

fn value(argument: &Argument) -> Value {
    match argument {
        Argument::Number(number) => json!(number),
        Argument::Count(count) => json!(count),
        Argument::Vector(vector) => json!(vector),
        Argument::Points(points) => json!(points),
        Argument::Rings(rings) => json!(rings),
    }
}

/// An angle [rad] with the one of two keys that keeps its bits.
fn angle(in_degrees: &str, in_radians: &str, angle: f64) -> (String, Value) {
    match degrees(angle) {
        Some(degrees) => (in_degrees.to_owned(), json!(degrees)),
        None => (in_radians.to_owned(), json!(angle)),
    }
}

/// The keys of a placement.
fn placement<const D: usize>(pose: &Pose<D>) -> Value {
    let (turn, attitude) = pose::keys(rotation::written(&pose.rotation));
    let mut object = Map::new();
    if let Some(translation) = translation(pose.translation) {
        object.insert(keys::TRANSLATE.to_owned(), json!(translation));
    }
    if let Some(turn) = turn {
        object.insert(keys::ROTATE_DEGREES.to_owned(), json!(turn));
    }
    if let Some(attitude) = attitude {
        object.insert(keys::ROTATION.to_owned(), json!(attitude));
    }
    Value::Object(object)
}

fn rows<const D: usize>(copies: &[Copies; D]) -> Value {
    let mut rows = Map::new();
    for (axis, copies) in keys::AXES.iter().zip(copies) {
        let row = match copies {
            Copies::One => continue,
            Copies::Between { spacing, first, last } => {
                json!({ "spacing": spacing, "first": first, "last": last })
            }
            Copies::Endless { spacing } => json!({ "spacing": spacing }),
        };
        rows.insert((*axis).to_owned(), row);
    }
    if rows.is_empty() {
        // A file gives at least one row.
        return json!({ "x": { "first": 0, "last": 0 } });
    }
    Value::Object(rows)
}
