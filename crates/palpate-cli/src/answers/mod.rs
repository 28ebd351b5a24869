// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What answers of several commands have in common.

use palpate::field::Aabb;
use serde::Serialize;

#[cfg(test)]
mod page;
#[cfg(test)]
mod renamed;

/// The corners of a box [m].
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Bounds {
    /// The corner with the least coordinates [m].
    pub(crate) min: Vec<f64>,
    /// The corner with the largest coordinates [m].
    pub(crate) max: Vec<f64>,
}

impl Bounds {
    /// The lengths of the edges [m].
    pub(crate) fn size(&self) -> Vec<f64> {
        self.max.iter().zip(&self.min).map(|(max, min)| max - min).collect()
    }
}

impl<const D: usize> From<Aabb<D>> for Bounds {
    fn from(aabb: Aabb<D>) -> Self {
        Self { min: aabb.min.0.to_vec(), max: aabb.max.0.to_vec() }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::fmt::Write;

    use palpate::field::{Mass, Promise};
    use palpate::query::{
        AtPoint, Certified, Contact, FirstTouch, Manifold, Nearest, Penetration, RayHit,
    };
    use palpate::scene::{ANSWER_VERSION, Question};
    use schemars::generate::SchemaSettings;
    use schemars::{JsonSchema, SchemaGenerator};
    use serde_json::{Map, Value};

    use crate::descend::{element, pair};
    use crate::devices::{self, actuators, rendered, stability};

    use super::page::Page;
    use crate::{
        check, eval, feel, gallery, gradients, grid, identify, jitter, mesh, plot, render,
        shapes,
    };

    /// Set to write what is generated instead of comparing it.
    const RENEW: &str = "PALPATE_RENEW";

    fn of<T: JsonSchema>(generator: &mut SchemaGenerator) -> schemars::Schema {
        T::json_schema(generator)
    }

    /// The schema of each answer, by the command that prints it.
    fn answers(generator: &mut SchemaGenerator) -> Vec<(&'static str, schemars::Schema)> {
        vec![
            ("question", of::<Question>(generator)),
            ("answer", of::<palpate::scene::Answer<3>>(generator)),
            ("eval --points", of::<eval::stream::Line<3>>(generator)),
            ("check", of::<check::Answer>(generator)),
            ("check: a bad scene", of::<check::Refused>(generator)),
            ("descend: between bodies", of::<pair::Report<3>>(generator)),
            ("descend: over an element", of::<element::Report<'_, 3>>(generator)),
            ("devices", of::<devices::Answer>(generator)),
            ("devices --actuators", of::<actuators::Answer>(generator)),
            ("devices --materials", of::<rendered::Answer>(generator)),
            ("devices --stability", of::<stability::Answer>(generator)),
            ("feel", of::<feel::report::Answer<'_>>(generator)),
            ("gallery", of::<gallery::Answer>(generator)),
            ("gradients", of::<gradients::Answer>(generator)),
            ("grid", of::<grid::Answer>(generator)),
            ("identify", of::<identify::report::Answer>(generator)),
            ("jitter", of::<jitter::Answer>(generator)),
            ("mesh", of::<mesh::Checked>(generator)),
            ("mesh --output", of::<mesh::contour::Answer>(generator)),
            ("plot", of::<plot::Answer>(generator)),
            ("render", of::<render::Answer>(generator)),
            ("shapes", of::<shapes::Answer>(generator)),
        ]
    }

    /// The schema of all answers: `properties` has one for each command.
    fn schema() -> Value {
        let mut generator = SchemaSettings::draft2020_12().into_generator();
        let mut commands = Map::new();
        for (command, schema) in answers(&mut generator) {
            let mut schema = schema.to_value();
            if command == "question" {
                commands.insert(command.to_owned(), schema);
                continue;
            }
            let mut keys = Map::new();
            keys.insert(
                "palpate".to_owned(),
                serde_json::json!({
                    "const": ANSWER_VERSION,
                    "description": "The version of the vocabulary.",
                }),
            );
            keys.extend(
                schema
                    .get("properties")
                    .and_then(Value::as_object)
                    .cloned()
                    .unwrap_or_default(),
            );
            schema["properties"] = keys.into();
            if let Some(required) = schema.get_mut("required").and_then(Value::as_array_mut) {
                required.insert(0, "palpate".into());
            }
            commands.insert(command.to_owned(), schema);
        }
        serde_json::json!({
            "$schema": "https://json-schema.org/draft/2020-12/schema",
            "title": "answers of palpate",
            "description": "What `palpate COMMAND --json` prints, in SI units. Generated.",
            "properties": commands,
            "$defs": generator.take_definitions(true),
        })
    }

    /// The schema of the answers that Python has as classes, and the last parts of the renamed keys.
    /// `generate_answers.py` writes the classes from it.
    fn python() -> Value {
        let mut generator = SchemaSettings::draft2020_12().into_generator();
        let own = &mut generator;
        let classes = [
            ("AtPoint", of::<AtPoint<3>>(own)),
            ("Promise", of::<Promise<3>>(own)),
            ("Mass", of::<Mass<3>>(own)),
            ("Separation", of::<Certified<Nearest<3>>>(own)),
            ("PenetrationBounds", of::<Certified<Penetration<3>>>(own)),
            ("Overlap", of::<Certified<Nearest<3>>>(own)),
            ("ClosestPoints", of::<Certified<Option<Contact<3>>>>(own)),
            ("RayCast", of::<Certified<Option<RayHit<3>>>>(own)),
            ("Manifold", of::<Manifold<3>>(own)),
            ("FirstTouch", of::<FirstTouch<3>>(own)),
        ];
        let classes: Map<_, _> =
            classes.map(|(class, of)| (class.to_owned(), of.to_value())).into_iter().collect();
        let last = |key: &str| key.rsplit('.').next().unwrap_or_default().to_owned();
        let renamed = super::renamed::RENAMED.iter().map(|row| [last(row.old), last(row.new)]);
        let renamed: BTreeSet<_> = renamed.filter(|[old, new]| old != new).collect();
        serde_json::json!({
            "$schema": "https://json-schema.org/draft/2020-12/schema",
            "title": "answers of Python",
            "description": "The classes of answers that Rust has too. Generated.",
            "properties": classes,
            "$defs": generator.take_definitions(true),
            "renamed": renamed,
        })
    }

    /// Writes a generated text if that is asked for, and else compares it.
    fn compare(file: &str, current: &str) {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
        if std::env::var_os(RENEW).is_some() {
            std::fs::write(&path, current).unwrap();
        }
        let written = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(written == current, "{file} is stale; `cargo xtask renew` renews it");
    }

    #[test]
    fn the_committed_schema_and_its_page_are_the_generated_ones() {
        let schema = schema();
        compare("schema/answers.schema.json", &format!("{schema:#}\n"));
        compare("../../docs/answers.md", &Page::of(&schema));
        let python = python();
        compare("../../bindings/python/answers.schema.json", &format!("{python:#}\n"));
    }

    #[test]
    fn the_changelog_lists_the_renamed_keys() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../CHANGELOG.md");
        let page = std::fs::read_to_string(path).unwrap();
        let (begin, end) = ("<!-- renamed keys -->\n", "<!-- end -->\n");
        let (before, rest) = page.split_once(begin).unwrap();
        let (_, after) = rest.split_once(end).unwrap();
        let mut table = "\n| command | old | new |\n|---|---|---|\n".to_owned();
        for row in super::renamed::RENAMED {
            writeln!(table, "| `{}` | `{}` | `{}` |", row.command, row.old, row.new).unwrap();
        }
        compare("../../CHANGELOG.md", &format!("{before}{begin}{table}\n{end}{after}"));
    }
}
