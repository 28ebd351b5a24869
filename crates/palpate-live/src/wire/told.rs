// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the program says to a page, as text.

use palpate::field::Aabb;
use palpate::haptics::Event;
use palpate::safety::Effect;
use palpate::scene::Scene;
use serde::Serialize;
use serde_json::{Map, Value};

use crate::shader::Shader;

/// A message to a page, by its `do`.
#[derive(Debug, Serialize)]
#[serde(tag = "do", rename_all = "snake_case")]
pub(crate) enum Told<'a> {
    /// The first message of all.
    Welcome {
        /// The version of the protocol.
        version: u32,
        /// Ticks a second [Hz].
        rate: f64,
        /// The primitives, as `palpate shapes --json` describes them.
        catalogue: Vec<Value>,
        /// The operators on one shape.
        operators: Vec<OperatorTold>,
        /// The materials that have a name, as a scene writes their numbers.
        presets: Map<String, Value>,
        /// The schema of scene files.
        schema: Value,
    },
    /// The scene, whenever it changed.
    Scene(&'a SceneTold),
    /// What was asked for is done, and has no other answer.
    Done,
    /// Why what was asked for is not done, and what is wrong with the scene.
    Refused { message: &'a str, problems: &'a [Problem] },
    /// What the servo did, the oldest first.
    Events { events: &'a [Event] },
    /// What the stages of the safety chain did since the servo began, in the order in which they act.
    Safety { stages: Vec<StageTold> },
    /// Whether every tick is recorded, the rows so far, and the rows at most.
    Recording { is_on: bool, rows: usize, most: usize },
    /// How many pages are open.
    Clients { count: usize },
    /// Forces are held at zero.
    Stopped {
        /// The number of the last stop, which a release repeats.
        number: u64,
        /// Whether this page pressed it.
        is_mine: bool,
        /// The time until this page may release it [s].
        release_after: f64,
    },
    /// The stop of this number was released.
    Released { number: u64 },
    /// What a person should read.
    Notice { message: &'a str, about: Option<About> },
    /// Why the program closes the socket: the last message.
    Bye { why: &'a str },
}

/// An operator on one shape.
#[derive(Debug, Serialize)]
pub(crate) struct OperatorTold {
    pub(crate) name: &'static str,
    /// The numbers to begin with, on a shape 1 m wide.
    pub(crate) first: First,
}

/// The argument of an operator.
#[derive(Debug, Serialize)]
#[serde(untagged)]
pub(crate) enum First {
    One(f64),
    PerAxis([f64; 3]),
}

/// What a notice is about.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum About {
    /// The file of the scene.
    File,
}

/// What is wrong in a scene.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Problem {
    /// A JSON pointer to the place.
    pub(crate) at: String,
    /// The place as people read it.
    pub(crate) path: String,
    /// The line of the scene's text, from 1.
    pub(crate) line: usize,
    /// What is wrong there, in words.
    pub(crate) problem: String,
}

/// A stage of the safety chain.
#[derive(Debug, Serialize)]
pub(crate) struct StageTold {
    pub(crate) name: &'static str,
    /// In how many ticks it has changed a force.
    pub(crate) ticks: u64,
    /// The largest change of the force [N] or of the torque [N·m].
    pub(crate) largest: f64,
}

impl StageTold {
    pub(crate) fn new(name: &'static str, Effect { ticks, largest, .. }: Effect) -> Self {
        Self { name, ticks, largest }
    }
}

/// A scene as it is edited and rendered.
#[derive(Debug, Serialize)]
pub(crate) struct SceneTold {
    pub(crate) revision: u32,
    pub(crate) by: By,
    #[serde(flatten)]
    pub(crate) document: DocumentTold,
    /// The data of its file.
    pub(crate) scene: Scene,
    /// Its file.
    pub(crate) text: String,
    #[serde(flatten)]
    pub(crate) built: BuiltTold,
    /// How it is drawn.
    pub(crate) way: Way,
    /// What building this revision took.
    pub(crate) spent: Vec<Part>,
    pub(crate) device: DeviceTold,
    /// Why the servo ended and another began; `None` if it goes on.
    pub(crate) restarted: Option<String>,
}

/// The file of a scene, and its steps.
#[derive(Debug, Serialize)]
pub(crate) struct DocumentTold {
    pub(crate) name: String,
    /// The path of its file, if it has one.
    pub(crate) file: Option<String>,
    pub(crate) is_saved: bool,
    pub(crate) can_undo: bool,
    pub(crate) can_redo: bool,
}

/// The bodies of a scene, and their field.
#[derive(Debug, Serialize)]
pub(crate) struct BuiltTold {
    pub(crate) dimension: usize,
    pub(crate) bodies: Vec<BodyTold>,
    /// The box around all bodies, in space [m]; `None` if it has no end.
    pub(crate) bounds: Option<Aabb<3>>,
    /// The largest difference of two values over the distance of their points.
    pub(crate) lipschitz: f64,
    /// What the field of all bodies promises, in words.
    pub(crate) promise: String,
}

/// What made a scene as it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum By {
    /// It was opened.
    Open,
    /// An edit of a page.
    Edit,
    /// A step back.
    Undo,
    /// A step forth again.
    Redo,
    /// Its file, which was changed elsewhere.
    File,
}

/// A body of a scene.
#[derive(Debug, Serialize)]
pub(crate) struct BodyTold {
    pub(crate) name: String,
    /// Red, green, blue of sRGB.
    pub(crate) color: [u8; 3],
    /// What its field promises, in words.
    pub(crate) promise: String,
    /// The box around it, in space [m]; `None` if it has no end.
    pub(crate) bounds: Option<Aabb<3>>,
}

/// How a scene is drawn.
#[derive(Debug, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub(crate) enum Way {
    /// By a formula.
    Formula(Shader),
    /// From samples.
    Samples {
        /// Why not by a formula.
        why: String,
    },
}

/// A part of the work on a revision.
#[derive(Debug, Serialize)]
pub(crate) struct Part {
    pub(crate) name: &'static str,
    /// How long it took [s].
    pub(crate) time: f64,
}

/// The device that is simulated.
#[derive(Debug, Serialize)]
pub(crate) struct DeviceTold {
    pub(crate) name: String,
    /// The contact points of the hand.
    pub(crate) points: usize,
    /// The largest force [N].
    pub(crate) max_force: f64,
    /// Ticks a second [Hz].
    pub(crate) rate: f64,
}

/// A message as text, with the number of the question that it answers, if that had one.
pub(crate) fn written(message: &impl Serialize, id: Option<u32>) -> String {
    #[derive(Serialize)]
    struct Numbered<'a, T> {
        #[serde(flatten)]
        message: &'a T,
        #[serde(skip_serializing_if = "Option::is_none")]
        id: Option<u32>,
    }
    // All keys are text: nothing is refused.
    serde_json::to_string(&Numbered { message, id }).unwrap_or_default()
}
