// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the generator of schemas says otherwise than scene files mean it.

use serde_json::Value;

/// Moves references to the definitions under `place` and forbids `null`: a key
/// is there with a value or left out.
pub(super) fn tidy(schema: &mut Value, place: &str) {
    match schema {
        Value::Object(object) => {
            if let Some(Value::Array(types)) = object.get_mut("type") {
                types.retain(|name| name != "null");
                if let [only] = types.as_slice() {
                    let only = only.clone();
                    object.insert("type".to_owned(), only);
                }
            }
            if let Some(Value::Array(choices)) = object.get_mut("anyOf") {
                choices.retain(|choice| choice.get("type") != Some(&"null".into()));
                if let [only] = choices.as_slice() {
                    let only = only.as_object().cloned().unwrap_or_default();
                    object.shift_remove("anyOf");
                    object.extend(only);
                }
            }
            if let Some(Value::String(reference)) = object.get_mut("$ref") {
                let inner = reference.strip_prefix("#/$defs/").filter(|r| !r.contains('/'));
                if let Some(name) = inner {
                    *reference = format!("#/$defs/{place}/{name}");
                }
            }
            // Widths of numbers in memory, and defaults that the text explains.
            object.shift_remove("format");
            if object.get("default").is_some_and(Value::is_null) {
                object.shift_remove("default");
            }
            if let Some(Value::String(text)) = object.get_mut("description") {
                // What follows the first paragraph is for users of this crate.
                let paragraph = text.split("\n\n").next().unwrap_or_default();
                *text = paragraph.replace('\n', " ");
            }
            object.values_mut().for_each(|value| tidy(value, place));
        }
        Value::Array(array) => array.iter_mut().for_each(|value| tidy(value, place)),
        _ => {}
    }
}
