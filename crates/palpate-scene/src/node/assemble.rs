// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! From the keys of an object to its node.

use palpate_field::operator::{Boolean, Profile};

use super::operators::{self as keys, OF};
use super::{Axis, Factor, Form, Node, Primitive, Rows};
use crate::angle::Angle;
use crate::pose::{self, Attitude, Turn};

/// The values of a node's keys.
#[derive(Default)]
pub(super) struct Parts {
    pub(super) description: Option<String>,
    pub(super) of: Option<Node>,
    pub(super) shape: Option<String>,
    pub(super) width: Option<f64>,
    pub(super) profile: Option<Profile>,
    pub(super) height: Option<f64>,
    pub(super) progress: Option<f64>,
    pub(super) translate: Option<Vec<f64>>,
    pub(super) rotate_degrees: Option<Turn>,
    pub(super) rotation: Option<Attitude>,
    pub(super) scale: Option<Factor>,
    pub(super) offset: Option<f64>,
    pub(super) shell: Option<f64>,
    pub(super) elongate: Option<Vec<f64>>,
    pub(super) mirror: Option<Axis>,
    pub(super) repeat: Option<Rows>,
    pub(super) bend_degrees: Option<f64>,
    pub(super) bend: Option<f64>,
    pub(super) twist_degrees: Option<f64>,
    pub(super) twist: Option<f64>,
    pub(super) extrude: Option<f64>,
    pub(super) revolve: Option<About>,
    pub(super) lists: Vec<(&'static str, Vec<Node>)>,
    pub(super) primitives: Vec<Primitive>,
}

/// The axis of a revolution: y, and no other.
#[derive(serde::Deserialize)]
pub(super) enum About {
    /// The axis of all solids of revolution here.
    #[serde(rename = "y")]
    Y,
}

impl Parts {
    /// The node of these parts, or what is wrong with them.
    pub(super) fn assemble(mut self) -> Result<Node, String> {
        let heads = self.heads();
        let head = match heads.as_slice() {
            [head] => head.as_str(),
            [] => return Err("missing the primitive or operator that makes the shape".into()),
            [first, .., last] => {
                return Err(format!(
                    "`{first}` and `{last}` in one object; an object makes one shape: nest them"
                ));
            }
        };
        let is_unary = keys::UNARY.iter().any(|(key, _)| *key == head);
        if self.of.is_some() != is_unary {
            return Err(if is_unary {
                format!("missing key `{OF}`: the shape that `{head}` is applied to")
            } else {
                format!("key `{OF}` does not go with `{head}`")
            });
        }
        for (key, is_needed, lists, about) in keys::WITH_LISTS {
            let is_there = match key {
                keys::WIDTH => self.width.is_some(),
                keys::PROFILE => self.profile.is_some(),
                keys::HEIGHT => self.height.is_some(),
                _ => self.progress.is_some(),
            };
            let goes = lists.contains(&head);
            if is_there && !goes {
                return Err(format!("key `{key}` does not go with `{head}`"));
            }
            if goes && is_needed && !is_there {
                return Err(format!("missing key `{key}`: {about}"));
            }
        }
        let description = self.description.take();
        let form = self.form(head)?;
        Ok(Node { description, form })
    }

    /// The keys that make a shape; translation and rotation together count as one.
    fn heads(&self) -> Vec<String> {
        let mut heads: Vec<&str> = Vec::new();
        heads.extend(self.primitives.iter().map(|primitive| primitive.name.as_str()));
        heads.extend(self.lists.iter().map(|(list, _)| *list));
        let moved = [
            (self.translate.is_some(), keys::TRANSLATE),
            (self.rotate_degrees.is_some(), keys::ROTATE_DEGREES),
            (self.rotation.is_some(), keys::ROTATION),
        ];
        heads.extend(moved.iter().find(|(is_there, _)| *is_there).map(|(_, key)| *key));
        let others = [
            (self.shape.is_some(), keys::SHAPE),
            (self.scale.is_some(), keys::SCALE),
            (self.offset.is_some(), keys::OFFSET),
            (self.shell.is_some(), keys::SHELL),
            (self.elongate.is_some(), keys::ELONGATE),
            (self.mirror.is_some(), keys::MIRROR),
            (self.repeat.is_some(), keys::REPEAT),
            (self.bend_degrees.is_some(), keys::BEND_DEGREES),
            (self.bend.is_some(), keys::BEND),
            (self.twist_degrees.is_some(), keys::TWIST_DEGREES),
            (self.twist.is_some(), keys::TWIST),
            (self.extrude.is_some(), keys::EXTRUDE),
            (self.revolve.is_some(), keys::REVOLVE),
        ];
        heads.extend(others.iter().filter(|(is_there, _)| *is_there).map(|(_, key)| *key));
        heads.into_iter().map(str::to_owned).collect()
    }

    /// The form that the key `head` makes.
    fn form(self, head: &str) -> Result<Form, String> {
        if let Some(name) = self.shape {
            return Ok(Form::Reference(name));
        }
        if let Some(primitive) = self.primitives.into_iter().next() {
            return Ok(Form::Primitive(primitive));
        }
        if let Some((list, of)) = self.lists.into_iter().next() {
            // What a list needs was checked.
            let (width, profile) = (self.width.unwrap_or_default(), self.profile);
            let smooth = |boolean, of| Form::Smooth { boolean, of, width, profile };
            return Ok(match list {
                keys::UNION => Form::Union(of),
                keys::INTERSECTION => Form::Intersection(of),
                keys::DIFFERENCE => Form::Difference(of),
                keys::SYMMETRIC_DIFFERENCE => Form::SymmetricDifference(of),
                keys::SMOOTH_UNION => smooth(Boolean::Union, of),
                keys::SMOOTH_INTERSECTION => smooth(Boolean::Intersection, of),
                keys::SMOOTH_DIFFERENCE => smooth(Boolean::Difference, of),
                keys::DISPLACE => {
                    Form::Displaced { of, height: self.height.unwrap_or_default() }
                }
                _ => Form::Morphed { of, progress: self.progress.unwrap_or_default() },
            });
        }
        let Some(of) = self.of.map(Box::new) else {
            return Err(format!("missing key `{OF}`"));
        };
        if let Some(factor) = self.scale {
            Ok(Form::Scaled { factor, of })
        } else if let Some(distance) = self.offset {
            Ok(Form::Offset { distance, of })
        } else if let Some(thickness) = self.shell {
            Ok(Form::Shell { thickness, of })
        } else if let Some(lengths) = self.elongate {
            Ok(Form::Elongated { lengths, of })
        } else if let Some(axis) = self.mirror {
            Ok(Form::Mirrored { axis, of })
        } else if let Some(rows) = self.repeat {
            Ok(Form::Repeated { rows, of })
        } else if let Some(rate) = angle(self.bend_degrees, self.bend) {
            Ok(Form::Bent { rate, of })
        } else if let Some(rate) = angle(self.twist_degrees, self.twist) {
            Ok(Form::Twisted { rate, of })
        } else if let Some(height) = self.extrude {
            Ok(Form::Extruded { height, of })
        } else if let Some(About::Y) = self.revolve {
            Ok(Form::Revolved { of })
        } else {
            let rotation = pose::one_rotation(self.rotate_degrees, self.rotation)?;
            debug_assert!(self.translate.is_some() || rotation.is_some(), "{head} has a form");
            Ok(Form::Placed { translate: self.translate, rotation, of })
        }
    }
}

/// The angle of two keys, of which at most one is there.
fn angle(degrees: Option<f64>, radians: Option<f64>) -> Option<Angle> {
    degrees.map(Angle::Degrees).or(radians.map(Angle::Radians))
}
