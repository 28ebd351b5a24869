// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The page of all answers, written from their schema.

use serde_json::Value;

/// What the page begins with.
const HEAD: &str = "\
# Questions and answers

<!-- `cargo xtask renew` writes this page from the types of the answers. -->

`palpate COMMAND --json` prints an answer: an object. Its numbers are in SI units (metres, \
seconds, kilograms, radians), except where the table names another unit. It begins with its version, `\"palpate\": 2`. A value that is not known is `null`, and \
so is an infinite number, except in Python. `palpate schema answers` prints the schema of this page.

The commands `eval`, `contact`, `sweep` and `mass` ask a [question](#question) and print the \
[answer](#answer). The live page, Python and `scene.ask` in Rust use the same two objects. \
`eval --points` prints an object a line.
";

/// The most keys of an alternative that fit in a line.
const MOST_IN_A_LINE: usize = 2;

/// The page, as far as it is written.
///
/// The schema is that of [`schemars`]: definitions in `$defs`, lists of alternatives in `oneOf` or
/// `anyOf`, and descriptions from doc comments.
pub(super) struct Page<'a> {
    schema: &'a Value,
    text: String,
}

impl Page<'_> {
    pub(super) fn of(schema: &Value) -> String {
        let mut page = Page { schema, text: HEAD.to_owned() };
        for (command, schema) in entries(&schema["properties"]) {
            let is_command = command != "question" && command != "answer";
            let title =
                if is_command { format!("`palpate {command}`") } else { command.clone() };
            page.object(2, &title, schema);
        }
        page.text.push_str("\n## Objects\n");
        for (name, schema) in entries(&schema["$defs"]) {
            page.object(3, name, schema);
        }
        page.text
    }

    /// A section about an object, or about each of its alternatives.
    fn object(&mut self, level: usize, title: &str, schema: &Value) {
        let hashes = "#".repeat(level);
        self.text.push_str(&format!("\n{hashes} {title}\n\n{}\n", described(schema)));
        let alternatives = schema["oneOf"].as_array().or_else(|| schema["anyOf"].as_array());
        match alternatives {
            Some(alternatives) => self.alternatives(alternatives),
            None => self.keys(schema),
        }
    }

    fn keys(&mut self, schema: &Value) {
        let mut rows = entries(&schema["properties"]).peekable();
        if rows.peek().is_some() {
            self.text.push_str("\n| key | value | |\n|---|---|---|\n");
        }
        for (key, value) in rows {
            let kind = self.kind(value);
            // A key that may be `null` is always written.
            let is_written = kind.ends_with("`null`")
                || schema["required"]
                    .as_array()
                    .is_none_or(|keys| keys.iter().any(|always| always.as_str() == Some(key)));
            let absent = if is_written { "" } else { ", or absent" };
            self.text
                .push_str(&format!("| `{key}` | {kind}{absent} | {} |\n", described(value)));
        }
        if schema["additionalProperties"].is_object() {
            let kind = self.kind(&schema["additionalProperties"]);
            self.text.push_str(&format!("| every other key | {kind} | By its name. |\n"));
        }
    }

    /// A line for each alternative, and a table of its keys where they do not fit in the line.
    fn alternatives(&mut self, alternatives: &[Value]) {
        for alternative in alternatives {
            let keys = entries(&alternative["properties"]).count();
            let (kind, described) = (self.kind(alternative), described(alternative));
            if keys > MOST_IN_A_LINE {
                let tags = entries(&alternative["properties"]);
                let mut tags = tags.filter(|(_, value)| value.get("const").is_some());
                let tag = tags
                    .next()
                    .map_or(kind, |(key, value)| format!("`{key}` {}", self.kind(value)));
                self.text.push_str(&format!("\n{tag}: {described}\n"));
                self.keys(alternative);
            } else {
                self.text.push_str(&format!("\n- {kind}: {described}"));
            }
        }
        self.text.push('\n');
    }

    /// What a value may be, in words.
    fn kind(&self, schema: &Value) -> String {
        if let Some(value) = schema.get("const") {
            return format!("`{value}`");
        }
        if let Some(values) = schema["enum"].as_array() {
            return listed(values.iter().map(|value| format!("`{value}`")));
        }
        let alternatives = schema["oneOf"].as_array().or_else(|| schema["anyOf"].as_array());
        if let Some(alternatives) = alternatives {
            return listed(alternatives.iter().map(|alternative| self.kind(alternative)));
        }
        let tags: Vec<_> = entries(&schema["properties"])
            .map(|(key, value)| format!("`{key}` {}", self.kind(value)))
            .collect();
        if let Some(reference) = schema["$ref"].as_str() {
            let name = reference.trim_start_matches("#/$defs/");
            // List the values of a small enumeration in place.
            let definition = &self.schema["$defs"][name];
            let link = format!("[{name}](#{})", name.to_lowercase());
            let with = if tags.is_empty() { String::new() } else { tags.join(", ") + ", and " };
            return if definition["enum"].is_array() {
                self.kind(definition)
            } else {
                with + &link
            };
        }
        match &schema["type"] {
            Value::Array(kinds) => {
                let of = |kind: &Value| {
                    let mut one = schema.clone();
                    one["type"] = kind.clone();
                    self.kind(&one)
                };
                listed(kinds.iter().map(of))
            }
            Value::String(kind) => match kind.as_str() {
                "array" => match self.kind(&schema["items"]).as_str() {
                    one @ ("number" | "integer" | "text") => format!("list of {one}s"),
                    other if other.contains(" or ") => format!("list of ({other})"),
                    other => format!("list of {other}"),
                },
                "boolean" => "`true` or `false`".to_owned(),
                "object" if !tags.is_empty() => tags.join(", "),
                "string" => "text".to_owned(),
                "null" => "`null`".to_owned(),
                kind => kind.to_owned(),
            },
            _ => "any".to_owned(),
        }
    }
}

/// The entries of an object; none of anything else.
fn entries(value: &Value) -> impl Iterator<Item = (&String, &Value)> {
    value.as_object().into_iter().flatten()
}

/// The first paragraph of a schema's description on one line, as Markdown without links to Rust.
fn described(schema: &Value) -> String {
    let text = schema["description"].as_str().unwrap_or_default();
    let paragraph = text.split("\n\n").next().unwrap_or_default();
    let line = paragraph.split_whitespace().collect::<Vec<_>>().join(" ");
    let mut parts = line.split("](");
    let mut plain = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        // The words of a link stay; a place in Rust goes.
        let (target, after) = part.split_once(')').unwrap_or((part, ""));
        let is_rust = target.contains("::") || target.starts_with("Self");
        let open = plain.rfind('[').filter(|_| is_rust);
        match open {
            Some(open) => {
                plain.remove(open);
            }
            None => plain.push_str(&format!("]({target})")),
        }
        plain.push_str(after);
    }
    plain.replace("`None`", "`null`").replace("[`", "`").replace("`]", "`").replace('|', "\\|")
}

/// Alternatives in a sentence.
fn listed(alternatives: impl Iterator<Item = String>) -> String {
    alternatives.collect::<Vec<_>>().join(" or ")
}
