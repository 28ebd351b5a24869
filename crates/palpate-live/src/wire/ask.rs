// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the page asks for.

use serde::{Deserialize, Deserializer};
use serde_json::Value;

/// A message of the page.
#[derive(Debug)]
pub(crate) struct Question {
    /// The number that the answer repeats, if one is wanted.
    pub(crate) id: Option<u32>,
    pub(crate) ask: Ask,
}

impl Question {
    /// Reads a message.
    ///
    /// # Errors
    ///
    /// What is wrong with it, and its number if that can be read.
    pub(crate) fn read(text: &str) -> Result<Self, (Option<u32>, String)> {
        let message: Value = serde_json::from_str(text)
            .map_err(|error| (None, format!("a message is JSON: {error}")))?;
        let Value::Object(mut fields) = message else {
            return Err((None, "a message is a JSON object".to_owned()));
        };
        let id = match fields.remove("id") {
            None => None,
            Some(id) => {
                let number = id.as_u64().and_then(|id| u32::try_from(id).ok());
                let wrong = || format!("`id` must be a whole number below 2^32, got {id}");
                Some(number.ok_or_else(|| (None, wrong()))?)
            }
        };
        let ask = serde_json::from_value(Value::Object(fields));
        ask.map(|ask| Self { id, ask }).map_err(|error| (id, error.to_string()))
    }
}

/// What a message asks for, by its `do`.
#[derive(Debug, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Ask {
    Hello {
        version: u32,
    },
    Hand {
        target: Option<Vec<f64>>,
        held: bool,
        point: Option<usize>,
        from: Option<Vec<f64>>,
    },
    Tour {
        on: bool,
    },
    Edit {
        base: u32,
        changes: Vec<Change>,
        #[serde(default)]
        moving: bool,
    },
    Undo {},
    Redo {},
    Open {
        name: String,
        text: String,
    },
    Save {
        #[serde(default)]
        force: bool,
        #[serde(rename = "as")]
        name: Option<String>,
    },
    Stop {},
    Release {},
    Clock {
        speed: Option<f64>,
        step: Option<u32>,
    },
    Record {
        on: bool,
    },
    Replay {
        on: bool,
    },
    Probe {
        at: Vec<f64>,
        body: Option<usize>,
    },
    Slice {
        origin: Vec<f64>,
        right: Option<Vec<f64>>,
        up: Option<Vec<f64>>,
        width: f64,
        height: f64,
        columns: usize,
        rows: usize,
        body: Option<usize>,
    },
    Samples {
        cells: usize,
        body: Option<usize>,
    },
    Picture {
        eye: Vec<f64>,
        target: Vec<f64>,
        field_of_view: f64,
        width: u32,
        height: u32,
    },
    Element {
        corners: Vec<Vec<f64>>,
        method: Option<String>,
        alpha: Option<f64>,
        mu: Option<f64>,
        gradient: Option<String>,
        iterations: Option<u32>,
        start: Option<Vec<f64>>,
    },
    Ball {
        centre: Vec<f64>,
        radius: f64,
    },
    Pair {
        a: usize,
        b: usize,
        #[serde(default)]
        starts: Vec<Vec<f64>>,
        method: Option<String>,
    },
    Contacts {
        #[serde(default)]
        proof: bool,
    },
    Sweep {
        corners: Vec<Vec<f64>>,
        by: Vec<f64>,
    },
    Fall {
        centre: Vec<f64>,
        radius: f64,
        gravity: Option<f64>,
        restitution: Option<f64>,
    },
    Cancel {
        question: u32,
    },
    Hidden {
        is: bool,
    },
}

/// A change of a scene.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Change {
    /// A JSON pointer.
    pub(crate) at: String,
    /// The new value; `None` to remove what is there.
    #[serde(default, deserialize_with = "given")]
    pub(crate) to: Option<Value>,
}

/// A value that is given, be it null.
fn given<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Value>, D::Error> {
    Value::deserialize(deserializer).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_read_with_their_numbers() {
        let question = Question::read(r#"{"do":"probe","id":7,"at":[0,1]}"#).unwrap();
        assert_eq!(question.id, Some(7));
        assert!(matches!(question.ask, Ask::Probe { at, body: None } if at == [0.0, 1.0]));
        let text = r#"{"do":"edit","base":3,"changes":[{"at":"/a","to":null},{"at":"/b"}]}"#;
        let Ask::Edit { changes, moving: false, base: 3 } = Question::read(text).unwrap().ask
        else {
            panic!("an edit")
        };
        assert_eq!((&changes[0].to, &changes[1].to), (&Some(Value::Null), &None));
    }

    #[test]
    fn what_cannot_be_read_is_named() {
        let (id, error) = Question::read(r#"{"do":"fly","id":1}"#).unwrap_err();
        assert!(id == Some(1) && error.contains("unknown variant `fly`"), "{error}");
        let (_, error) = Question::read(r#"{"do":"tour","on":true,"off":1}"#).unwrap_err();
        assert!(error.contains("unknown field `off`"), "{error}");
        let (_, error) = Question::read(r#"{"do":"undo","id":-1}"#).unwrap_err();
        assert_eq!(error, "`id` must be a whole number below 2^32, got -1");
        assert!(Question::read("[1]").is_err() && Question::read("{").is_err());
    }
}
