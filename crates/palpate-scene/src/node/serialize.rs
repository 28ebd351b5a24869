// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Writing a node: the description, the operator and its numbers, the operands.

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::{Factor, Form, Node, operators as keys, profile};
use crate::pose;

impl Serialize for Node {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if let (Form::Reference(name), None) = (&self.form, &self.description) {
            return serializer.serialize_str(name);
        }
        let mut map = serializer.serialize_map(None)?;
        if let Some(description) = &self.description {
            map.serialize_entry(keys::DESCRIPTION, description)?;
        }
        match &self.form {
            Form::Reference(name) => map.serialize_entry(keys::SHAPE, name)?,
            Form::Primitive(primitive) => map.serialize_entry(&primitive.name, primitive)?,
            Form::Placed { translate, rotation, .. } => {
                if let Some(translate) = translate {
                    map.serialize_entry(keys::TRANSLATE, translate)?;
                }
                let (rotate_degrees, rotation) = pose::keys(rotation.clone());
                if let Some(turn) = rotate_degrees {
                    map.serialize_entry(keys::ROTATE_DEGREES, &turn)?;
                }
                if let Some(attitude) = rotation {
                    map.serialize_entry(keys::ROTATION, &attitude)?;
                }
            }
            Form::Scaled { factor: Factor::Uniform(factor), .. } => {
                map.serialize_entry(keys::SCALE, factor)?;
            }
            Form::Scaled { factor: Factor::Axes(factors), .. } => {
                map.serialize_entry(keys::SCALE, factors)?;
            }
            Form::Offset { distance, .. } => map.serialize_entry(keys::OFFSET, distance)?,
            Form::Shell { thickness, .. } => map.serialize_entry(keys::SHELL, thickness)?,
            Form::Elongated { lengths, .. } => map.serialize_entry(keys::ELONGATE, lengths)?,
            Form::Mirrored { axis, .. } => map.serialize_entry(keys::MIRROR, axis)?,
            Form::Extruded { height, .. } => map.serialize_entry(keys::EXTRUDE, height)?,
            Form::Revolved { .. } => map.serialize_entry(keys::REVOLVE, "y")?,
            Form::Repeated { rows, .. } => map.serialize_entry(keys::REPEAT, rows)?,
            Form::Bent { rate, .. } => {
                map.serialize_entry(rate.key(keys::BEND_DEGREES, keys::BEND), &rate.number())?;
            }
            Form::Twisted { rate, .. } => {
                let key = rate.key(keys::TWIST_DEGREES, keys::TWIST);
                map.serialize_entry(key, &rate.number())?;
            }
            Form::Displaced { height, .. } => map.serialize_entry(keys::HEIGHT, height)?,
            Form::Morphed { progress, .. } => map.serialize_entry(keys::PROGRESS, progress)?,
            Form::Smooth { width, profile, .. } => {
                map.serialize_entry(keys::WIDTH, width)?;
                if let Some(named) = profile {
                    map.serialize_entry(keys::PROFILE, profile::name(*named))?;
                }
            }
            Form::Union(_)
            | Form::Intersection(_)
            | Form::Difference(_)
            | Form::SymmetricDifference(_) => {}
        }
        match self.form.operands() {
            ("", _) => {}
            (keys::OF, [of]) => map.serialize_entry(keys::OF, of)?,
            (list, nodes) => map.serialize_entry(list, nodes)?,
        }
        map.end()
    }
}
