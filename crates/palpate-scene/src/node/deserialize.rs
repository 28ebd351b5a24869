// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Reading a node: every key decides alone what its value is.

use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor};

use super::assemble::Parts;
use super::operators::{self, all_keys};
use super::primitive::{Parameters, Refused};
use super::profile::ByName;
use super::{Factor, Node};
use crate::catalogue;
use crate::problem::unknown;

impl<'de> Deserialize<'de> for Node {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NodeVisitor)
    }
}

struct NodeVisitor;

impl<'de> Visitor<'de> for NodeVisitor {
    type Value = Node;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a shape: an object, or the name of another shape")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<Node, E> {
        Ok(Node::reference(name))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Node, A::Error> {
        let mut parts = Parts::default();
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                operators::DESCRIPTION => parts.description = Some(map.next_value()?),
                operators::OF => parts.of = Some(map.next_value()?),
                operators::SHAPE => parts.shape = Some(map.next_value()?),
                operators::WIDTH => parts.width = Some(map.next_value()?),
                operators::PROFILE => {
                    let ByName(profile) = map.next_value()?;
                    parts.profile = Some(profile);
                }
                operators::HEIGHT => parts.height = Some(map.next_value()?),
                operators::PROGRESS => parts.progress = Some(map.next_value()?),
                operators::REPEAT => parts.repeat = Some(map.next_value()?),
                operators::BEND_DEGREES => parts.bend_degrees = Some(map.next_value()?),
                operators::BEND => parts.bend = Some(map.next_value()?),
                operators::TWIST => parts.twist = Some(map.next_value()?),
                operators::TWIST_DEGREES => parts.twist_degrees = Some(map.next_value()?),
                operators::TRANSLATE => parts.translate = Some(map.next_value()?),
                operators::ROTATE_DEGREES => parts.rotate_degrees = Some(map.next_value()?),
                operators::ROTATION => parts.rotation = Some(map.next_value()?),
                operators::SCALE => parts.scale = Some(map.next_value()?),
                operators::OFFSET => parts.offset = Some(map.next_value()?),
                operators::SHELL => parts.shell = Some(map.next_value()?),
                operators::ELONGATE => parts.elongate = Some(map.next_value()?),
                operators::MIRROR => parts.mirror = Some(map.next_value()?),
                operators::EXTRUDE => parts.extrude = Some(map.next_value()?),
                operators::REVOLVE => parts.revolve = Some(map.next_value()?),
                name => match operators::LISTS.iter().find(|(list, _)| *list == name) {
                    Some((list, _)) => parts.lists.push((*list, map.next_value()?)),
                    None => match catalogue::named(name).as_slice() {
                        [] => {
                            let refused = Refused(unknown("key", name, &all_keys()));
                            map.next_value_seed(refused)?;
                        }
                        candidates => {
                            parts.primitives.push(map.next_value_seed(Parameters(candidates))?)
                        }
                    },
                },
            }
        }
        parts.assemble().map_err(A::Error::custom)
    }
}

impl<'de> Deserialize<'de> for Factor {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(FactorVisitor)
    }
}

struct FactorVisitor;

impl<'de> Visitor<'de> for FactorVisitor {
    type Value = Factor;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, or a list with one for each axis")
    }

    fn visit_u64<E>(self, factor: u64) -> Result<Factor, E> {
        Ok(Factor::Uniform(factor as f64))
    }

    fn visit_i64<E>(self, factor: i64) -> Result<Factor, E> {
        Ok(Factor::Uniform(factor as f64))
    }

    fn visit_f64<E>(self, factor: f64) -> Result<Factor, E> {
        Ok(Factor::Uniform(factor))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Factor, A::Error> {
        let mut factors = Vec::new();
        while let Some(factor) = seq.next_element()? {
            factors.push(factor);
        }
        Ok(Factor::Axes(factors))
    }
}
