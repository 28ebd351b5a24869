// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! From the node of a shape to what a file holds.

use std::collections::HashMap;

use indexmap::IndexMap;
use palpate_field::kernel::{Argument, ParameterKind};
use palpate_field::operator::Copies;
use palpate_field::{Node as ShapeNode, Shape, node};

use super::{rotation, translation};
use crate::angle::Angle;
use crate::catalogue::file_key;
use crate::node::operators as keys;
use crate::node::{Axis, Factor, Form, Node, Row, Rows, smooth_key};
use crate::problem::Problem;

/// Where a shape lies in memory: equal for clones alone, as long as one of them is kept.
type Address = usize;

fn address<const D: usize>(shape: &Shape<D>) -> Address {
    std::ptr::from_ref(shape.node()).addr()
}

/// Writes shapes, those that are there more than once as named ones.
pub(super) struct Writer {
    /// How often each shape is held.
    uses: HashMap<Address, usize>,
    /// The names of those that are written already.
    names: HashMap<Address, String>,
    /// The named shapes of the scene.
    shapes: IndexMap<String, Node>,
}

impl Writer {
    /// A writer for a scene that has `shapes` already.
    pub(super) fn new(shapes: IndexMap<String, Node>) -> Self {
        Self { uses: HashMap::new(), names: HashMap::new(), shapes }
    }

    /// The named shapes, those of this writer included.
    pub(super) fn finish(self) -> IndexMap<String, Node> {
        self.shapes
    }

    /// Counts the uses of a shape and of those in it; the shape must outlive the writer.
    pub(super) fn count<const D: usize>(&mut self, shape: &Shape<D>) {
        let uses = self.uses.entry(address(shape)).or_default();
        *uses += 1;
        if *uses > 1 {
            return;
        }
        match shape.node() {
            ShapeNode::Union(of)
            | ShapeNode::Intersection(of)
            | ShapeNode::Difference(of)
            | ShapeNode::SymmetricDifference(of)
            | ShapeNode::Smooth { of, .. } => of.iter().for_each(|shape| self.count(shape)),
            ShapeNode::Displaced { of: a, by: b, .. }
            | ShapeNode::Morphed { from: a, into: b, .. } => {
                self.count(a);
                self.count(b);
            }
            ShapeNode::Placed { of, .. }
            | ShapeNode::Scaled { of, .. }
            | ShapeNode::Stretched { of, .. }
            | ShapeNode::Offset { of, .. }
            | ShapeNode::Shell { of, .. }
            | ShapeNode::Elongated { of, .. }
            | ShapeNode::Mirrored { of, .. }
            | ShapeNode::Repeated { of, .. }
            | ShapeNode::Bent { of, .. }
            | ShapeNode::Twisted { of, .. } => self.count(of),
            ShapeNode::Extruded { of, .. } | ShapeNode::Revolved { of } => self.count(of),
            _ => {}
        }
    }

    /// A shape that was counted, or the reference to it.
    pub(super) fn node<const D: usize>(&mut self, shape: &Shape<D>) -> Result<Node, Problem> {
        let address = address(shape);
        if let Some(name) = self.names.get(&address) {
            return Ok(Node::reference(name));
        }
        let node = Node::new(self.form(shape.node())?);
        if self.uses.get(&address).is_none_or(|uses| *uses < 2) {
            return Ok(node);
        }
        let name = self.unused_name();
        self.shapes.insert(name.clone(), node);
        self.names.insert(address, name.clone());
        Ok(Node::reference(name))
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

    fn form<const D: usize>(&mut self, node: &ShapeNode<D>) -> Result<Form, Problem> {
        Ok(match node {
            ShapeNode::Primitive(primitive) => of_primitive(primitive),
            ShapeNode::Union(of) => Form::Union(self.list(keys::UNION, of)?),
            ShapeNode::Intersection(of) => {
                Form::Intersection(self.list(keys::INTERSECTION, of)?)
            }
            ShapeNode::Difference(of) => Form::Difference(self.list(keys::DIFFERENCE, of)?),
            ShapeNode::SymmetricDifference(of) => {
                Form::SymmetricDifference(self.list(keys::SYMMETRIC_DIFFERENCE, of)?)
            }
            ShapeNode::Smooth { boolean, profile, width, of } => {
                let of = self.list(smooth_key(*boolean), of)?;
                Form::Smooth { boolean: *boolean, of, width: *width, profile: Some(*profile) }
            }
            ShapeNode::Displaced { of, by, height } => {
                Form::Displaced { of: self.pair(keys::DISPLACE, of, by)?, height: *height }
            }
            ShapeNode::Morphed { from, into, progress } => {
                Form::Morphed { of: self.pair(keys::MORPH, from, into)?, progress: *progress }
            }
            node => self.unary(node)?,
        })
    }

    /// The operators on one shape.
    fn unary<const D: usize>(&mut self, node: &ShapeNode<D>) -> Result<Form, Problem> {
        Ok(match node {
            ShapeNode::Placed { pose, of } => {
                let rotation = rotation::written(&pose.rotation)
                    .map_err(|problem| problem.under(keys::ROTATION))?;
                let translate = translation(pose.translation);
                Form::Placed { translate, rotation, of: self.one(of)? }
            }
            ShapeNode::Scaled { factor, of } => {
                Form::Scaled { factor: Factor::Uniform(*factor), of: self.one(of)? }
            }
            ShapeNode::Stretched { factors, of } => {
                Form::Scaled { factor: Factor::Axes(factors.to_vec()), of: self.one(of)? }
            }
            ShapeNode::Offset { distance, of } => {
                Form::Offset { distance: *distance, of: self.one(of)? }
            }
            ShapeNode::Shell { thickness, of } => {
                Form::Shell { thickness: *thickness, of: self.one(of)? }
            }
            ShapeNode::Elongated { lengths, of } => {
                Form::Elongated { lengths: lengths.to_vec(), of: self.one(of)? }
            }
            ShapeNode::Mirrored { axis, of } => {
                let axis = [Axis::X, Axis::Y, Axis::Z][*axis];
                Form::Mirrored { axis, of: self.one(of)? }
            }
            ShapeNode::Repeated { copies, of } => {
                Form::Repeated { rows: rows(copies), of: self.one(of)? }
            }
            ShapeNode::Bent { rate, of } => {
                Form::Bent { rate: Angle::from_radians(*rate), of: self.one(of)? }
            }
            ShapeNode::Twisted { rate, of } => {
                Form::Twisted { rate: Angle::from_radians(*rate), of: self.one(of)? }
            }
            ShapeNode::Extruded { height, of } => {
                Form::Extruded { height: *height, of: self.one(of)? }
            }
            ShapeNode::Revolved { of } => Form::Revolved { of: self.one(of)? },
            ShapeNode::Opaque(opaque) => {
                let kind = opaque.type_name();
                let message =
                    format!("`{kind}` is opaque: files hold primitives and operators");
                return Err(Problem::new(message));
            }
            other => return Err(Problem::new(format!("files have no operator for {other:?}"))),
        })
    }

    fn one<const D: usize>(&mut self, of: &Shape<D>) -> Result<Box<Node>, Problem> {
        self.node(of).map(Box::new).map_err(|problem| problem.under(keys::OF))
    }

    fn list<const D: usize>(
        &mut self,
        key: &str,
        of: &[Shape<D>],
    ) -> Result<Vec<Node>, Problem> {
        let nodes = of.iter().enumerate();
        let node = |(i, shape)| self.node(shape).map_err(|problem| problem.at(i).under(key));
        nodes.map(node).collect()
    }

    fn pair<const D: usize>(
        &mut self,
        key: &str,
        first: &Shape<D>,
        second: &Shape<D>,
    ) -> Result<Vec<Node>, Problem> {
        let first = self.node(first).map_err(|problem| problem.at(0).under(key))?;
        let second = self.node(second).map_err(|problem| problem.at(1).under(key))?;
        Ok(vec![first, second])
    }
}

fn of_primitive<const D: usize>(primitive: &node::Primitive<D>) -> Form {
    let arguments =
        primitive.named().map(|(parameter, argument)| match (parameter.kind, argument) {
            (ParameterKind::Angle, Argument::Number(angle)) => {
                let angle = Angle::from_radians(*angle);
                let key = angle.key(&file_key(parameter), parameter.name).to_owned();
                (key, Argument::Number(angle.number()))
            }
            (_, argument) => (parameter.name.to_owned(), argument.clone()),
        });
    Node::primitive(primitive.name(), arguments).form
}

fn rows<const D: usize>(copies: &[Copies; D]) -> Rows {
    let row = |i: usize| match copies.get(i)? {
        Copies::One => None,
        Copies::Between { spacing, first, last } => {
            Some(Row { spacing: Some(*spacing), first: Some(*first), last: Some(*last) })
        }
        Copies::Endless { spacing } => {
            Some(Row { spacing: Some(*spacing), first: None, last: None })
        }
    };
    let rows = Rows { x: row(0), y: row(1), z: row(2) };
    if rows == Rows::default() {
        // A file gives at least one row.
        let alone = Row { spacing: None, first: Some(0), last: Some(0) };
        return Rows { x: Some(alone), ..rows };
    }
    rows
}
