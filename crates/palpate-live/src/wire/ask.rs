// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the page asks for.

use std::borrow::Cow;

use serde::{Deserialize, Deserializer};
use serde_json::Value;

/// The longest stop that the reading thread takes by itself [bytes].
const LONGEST_STOP: usize = 256;

/// Whether a short message holds the key `do` with the value `stop`, at any depth. It is not read as
/// JSON: no string of JSON holds these bytes, since its quotes would be escaped.
pub(crate) fn is_stop(text: &str) -> bool {
    text.len() <= LONGEST_STOP
        && text.match_indices("\"do\"").any(|(place, key)| {
            let rest = text.get(place + key.len()..).unwrap_or_default().trim_start();
            rest.strip_prefix(':')
                .is_some_and(|value| value.trim_start().starts_with("\"stop\""))
        })
}

/// What a message asks for and its number. The rest is skipped without building values.
#[derive(Debug)]
pub(crate) struct Envelope {
    pub(crate) id: Option<u32>,
    pub(crate) kind: Kind,
}

/// Who answers a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// `stop`.
    Stop,
    /// What concerns the hand or the page: done at once.
    Order,
    /// What concerns the document of the scene: done by the editor.
    Edit,
    /// A question that takes no time that a person notices.
    Short,
    /// Any other question.
    Long,
}

impl Kind {
    /// The kind of a message by its `do`; `None` of an unknown one.
    fn of(what: &str) -> Option<Self> {
        Some(match what {
            "stop" => Self::Stop,
            "release" | "hand" | "tour" | "clock" | "record" | "replay" | "cancel"
            | "hidden" => Self::Order,
            "hello" | "edit" | "undo" | "redo" | "open" | "save" => Self::Edit,
            "ask" | "slice" | "samples" | "picture" | "element" | "pair" | "sweep" | "fall" => {
                Self::Long
            }
            _ => return None,
        })
    }

    /// The longest message of this kind [bytes]. Scenes are long; no other message of the page is.
    pub(crate) fn longest(self) -> usize {
        match self {
            Self::Edit | Self::Stop => usize::MAX,
            Self::Long => 64 << 10,
            Self::Order | Self::Short => 4 << 10,
        }
    }
}

impl Envelope {
    /// Reads what a message asks for, and no more.
    ///
    /// # Errors
    ///
    /// What is wrong with it, and its number if that can be read.
    pub(crate) fn read(text: &str) -> Result<Self, Unreadable> {
        #[derive(Deserialize)]
        struct Fields<'a> {
            #[serde(borrow, rename = "do")]
            what: Option<Cow<'a, str>>,
            id: Option<Value>,
        }
        if !text.trim_start().starts_with('{') {
            return Err(Unreadable::of("a message is a JSON object"));
        }
        let Fields { what, id, .. } = serde_json::from_str(text)
            .map_err(|error| Unreadable::of(format!("a message is JSON: {error}")))?;
        let id = id.map(|id| number(&id)).transpose()?;
        let what = what.unwrap_or_default();
        match Kind::of(&what) {
            Some(Kind::Long) if what == "ask" && is_about_a_point(text) => {
                Ok(Self { id, kind: Kind::Short })
            }
            Some(kind) => Ok(Self { id, kind }),
            None => Err(Unreadable { id, why: unknown(&what) }),
        }
    }
}

/// Whether the question of an `ask` is about a point, which takes no time that a person notices.
fn is_about_a_point(text: &str) -> bool {
    #[derive(Deserialize)]
    struct Asked<'a> {
        #[serde(borrow)]
        question: Named<'a>,
    }
    #[derive(Deserialize)]
    struct Named<'a> {
        #[serde(borrow)]
        question: Cow<'a, str>,
    }
    serde_json::from_str(text).is_ok_and(|Asked { question }| question.question == "point")
}

/// Why a message is refused that is unknown, or was another one in version 1.
fn unknown(what: &str) -> String {
    let question = match what {
        "probe" => r#"{ "question": "point", "at": [0, 1], "body": "cup" }"#,
        "ball" => r#"{ "question": "point", "at": [0, 1], "radius": 0.1 }"#,
        "contacts" => r#"{ "question": "contacts", "proof": true }"#,
        _ => return format!("nothing is known of a message whose `do` is {what:?}"),
    };
    format!(
        "`{what}` is `ask` now, as in {{ \"do\": \"ask\", \"id\": 7, \"question\": {question} }}"
    )
}

/// Why a message cannot be read.
#[derive(Debug, PartialEq)]
pub(crate) struct Unreadable {
    pub(crate) id: Option<u32>,
    pub(crate) why: String,
}

impl Unreadable {
    fn of(why: impl Into<String>) -> Self {
        Self { id: None, why: why.into() }
    }
}

/// The number of a message.
fn number(id: &Value) -> Result<u32, Unreadable> {
    let number = id.as_u64().and_then(|id| u32::try_from(id).ok());
    number.ok_or_else(|| {
        Unreadable::of(format!("`id` must be a whole number below 2^32, got {id}"))
    })
}

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
    pub(crate) fn read(text: &str) -> Result<Self, Unreadable> {
        let message: Value = serde_json::from_str(text)
            .map_err(|error| Unreadable::of(format!("a message is JSON: {error}")))?;
        let Value::Object(mut fields) = message else {
            return Err(Unreadable::of("a message is a JSON object"));
        };
        let id = fields.remove("id").map(|id| number(&id)).transpose()?;
        let ask = serde_json::from_value(Value::Object(fields));
        ask.map(|ask| Self { id, ask })
            .map_err(|error| Unreadable { id, why: error.to_string() })
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
    Stop {
        /// Random digits that one press repeats on the socket and in its `POST /stop`.
        press: Option<String>,
    },
    Release {
        /// The number of the stop that is released.
        number: Option<u64>,
    },
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
    /// A question that every door takes.
    #[serde(rename = "ask")]
    Question {
        question: palpate::scene::Question,
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
    Pair {
        a: usize,
        b: usize,
        #[serde(default)]
        starts: Vec<Vec<f64>>,
        method: Option<String>,
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
    use palpate::scene::{PointQuestion, Question as Asked};

    use super::*;

    #[test]
    fn messages_are_read_with_their_numbers() {
        let text = r#"{"do":"ask","id":7,"question":{"question":"point","at":[0,1]}}"#;
        let question = Question::read(text).unwrap();
        assert_eq!(question.id, Some(7));
        let about = PointQuestion { at: vec![0.0, 1.0], ..PointQuestion::default() };
        let about = Asked::Point(about);
        assert!(matches!(question.ask, Ask::Question { question } if question == about));
        let text = r#"{"do":"edit","base":3,"changes":[{"at":"/a","to":null},{"at":"/b"}]}"#;
        let Ask::Edit { changes, moving: false, base: 3 } = Question::read(text).unwrap().ask
        else {
            panic!("an edit")
        };
        assert_eq!((&changes[0].to, &changes[1].to), (&Some(Value::Null), &None));
    }

    #[test]
    fn what_cannot_be_read_is_named() {
        let Unreadable { id, why } = Question::read(r#"{"do":"fly","id":1}"#).unwrap_err();
        assert!(id == Some(1) && why.contains("unknown variant `fly`"), "{why}");
        let why = Question::read(r#"{"do":"tour","on":true,"off":1}"#).unwrap_err().why;
        assert!(why.contains("unknown field `off`"), "{why}");
        let text = r#"{"do":"ask","question":{"question":"point","at":[0,1],"body_number":1}}"#;
        let why = Question::read(text).unwrap_err().why;
        assert!(why.contains("unknown field `body_number`"), "{why}");
        let why = Question::read(r#"{"do":"undo","id":-1}"#).unwrap_err().why;
        assert_eq!(why, "`id` must be a whole number below 2^32, got -1");
        assert!(Question::read("[1]").is_err() && Question::read("{").is_err());
    }

    #[test]
    fn every_message_has_a_kind() {
        let why = Question::read(r#"{"do":"fly"}"#).unwrap_err().why;
        let names: Vec<_> = why.split('`').skip(3).step_by(2).collect();
        assert!(names.len() > 20 && names.contains(&"fall"), "{why}");
        for name in names {
            let text = format!(r#"{{"text":"{{\"do\":\"fly\"}}","do":"{name}","id":7}}"#);
            let Envelope { id, kind } = Envelope::read(&text).unwrap();
            assert_eq!((id, Some(kind)), (Some(7), Kind::of(name)));
        }
        for (text, id) in [
            ("[1]", None),
            ("{", None),
            (r#"{"do":"fly","id":1}"#, Some(1)),
            (r#"{"id":2}"#, Some(2)),
        ] {
            assert_eq!(Envelope::read(text).unwrap_err().id, id, "{text}");
        }
    }

    #[test]
    fn a_question_about_a_point_is_short() {
        for (question, kind) in [("point", Kind::Short), ("contacts", Kind::Long)] {
            let text =
                format!(r#"{{"question":{{"at":[0,1],"question":"{question}"}},"do":"ask"}}"#);
            assert_eq!(Envelope::read(&text).unwrap().kind, kind, "{text}");
        }
        let text = r#"{"do":"cancel","question":7}"#;
        assert_eq!(Envelope::read(text).unwrap().kind, Kind::Order);
    }

    #[test]
    fn messages_of_version_1_are_refused_with_the_new_one() {
        let asked = ["probe", "ball", "contacts"].map(|old| {
            let text = format!(r#"{{"do":"{old}","id":3,"at":[0,1]}}"#);
            let Unreadable { id, why } = Envelope::read(&text).unwrap_err();
            let (words, example) = why.split_once(", as in ").unwrap();
            assert_eq!((id, words), (Some(3), &*format!("`{old}` is `ask` now")));
            match Question::read(example).unwrap().ask {
                Ask::Question { question } => question,
                other => panic!("{other:?} is no question"),
            }
        });
        let [Asked::Point(probe), Asked::Point(ball), Asked::Contacts(contacts)] = asked else {
            panic!("{asked:?}")
        };
        assert!(probe.radius.is_none() && ball.radius.is_some() && contacts.proof);
    }

    #[test]
    fn a_stop_is_known_by_its_bytes() {
        for text in [
            r#"{"do":"stop"}"#,
            r#" { "id" : 3, "do" : "stop", "press": "0f" } "#,
            "{\n\t\"do\"\n:\n\"stop\"}",
        ] {
            assert!(is_stop(text), "{text}");
        }
        let long = format!(r#"{}{{"do":"stop"}}"#, " ".repeat(LONGEST_STOP));
        for text in [
            r#"{"do":"stopped"}"#,
            r#"{"do":"open","name":"\"do\":\"stop\"","text":""}"#,
            r#"{"do":"release","of":"stop"}"#,
            r#"{"do"#,
            r#"{"do""#,
            &long,
        ] {
            assert!(!is_stop(text), "{text}");
        }
    }
}
