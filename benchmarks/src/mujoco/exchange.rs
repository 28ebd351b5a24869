// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What `beside.py` is asked, and what it answers, as JSON. Lengths are in m.

use std::error::Error;

use serde::{Deserialize, Serialize};

/// All that is asked.
#[derive(Debug, Serialize)]
pub(super) struct Question {
    pub(super) bodies: Vec<Sampled>,
    pub(super) pairs: Vec<Asked>,
}

/// A plugin and its attributes, in the plugin's order.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Plugin {
    pub(super) plugin: &'static str,
    pub(super) attributes: Vec<(&'static str, f64)>,
}

/// A body, and the points at which its field is asked for.
#[derive(Debug, Serialize)]
pub(super) struct Sampled {
    #[serde(flatten)]
    pub(super) body: Plugin,
    /// The diagonal of its box.
    pub(super) size: f64,
    pub(super) points: Vec<[f64; 3]>,
}

/// A pair in many poses.
#[derive(Debug, Serialize)]
pub(super) struct Asked {
    pub(super) bodies: [Plugin; 2],
    /// Of the second body: position and quaternion, its real part first. The first body is at
    /// the origin.
    pub(super) poses: Vec<[f64; 7]>,
    /// A point in both bodies for each pose.
    pub(super) witnesses: Vec<[f64; 3]>,
}

/// All that is answered, in the order of the question.
#[derive(Debug, Deserialize)]
pub(super) struct Answer {
    /// MuJoCo's.
    pub(super) version: String,
    pub(super) bodies: Vec<FieldValues>,
    pub(super) pairs: Vec<Found>,
}

/// A plugin's field at the points of a body.
#[derive(Debug, Deserialize)]
pub(super) struct FieldValues {
    pub(super) values: Vec<f64>,
    /// The norm of its gradient, from differences.
    pub(super) steepness: Vec<f64>,
}

/// What MuJoCo found for each pose of a pair.
#[derive(Debug, Deserialize)]
pub(super) struct Found {
    /// What looking for contacts took [ns].
    pub(super) times: Vec<f64>,
    /// The least distance of a contact; none without contacts.
    pub(super) distances: Vec<Option<f64>>,
    /// The larger value of both plugins' fields at the witness.
    pub(super) at_witnesses: Vec<f64>,
}

impl Answer {
    /// Reads an answer, and checks that it has all that was asked for.
    pub(super) fn read(text: &str, question: &Question) -> Result<Self, Box<dyn Error>> {
        let answer: Self = serde_json::from_str(text)
            .map_err(|error| format!("the answer of beside.py is not read: {error}"))?;
        let bodies = answer.bodies.iter().map(|of| [of.values.len(), of.steepness.len()]);
        let asked = question.bodies.iter().map(|body| [body.points.len(); 2]);
        let pairs = answer.pairs.iter();
        let pairs = pairs.map(|of| [of.times.len(), of.distances.len(), of.at_witnesses.len()]);
        let poses = question.pairs.iter().map(|pair| [pair.poses.len(); 3]);
        if bodies.eq(asked) && pairs.eq(poses) {
            Ok(answer)
        } else {
            Err("beside.py has not answered all that it was asked".into())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn question() -> Question {
        let body = Plugin { plugin: "mujoco.sdf.torus", attributes: vec![("radius1", 0.035)] };
        Question {
            bodies: vec![Sampled {
                body: body.clone(),
                size: 0.1,
                points: vec![[0.0, 1.0, 2.0]],
            }],
            pairs: vec![Asked {
                bodies: [body.clone(), body],
                poses: vec![[0.0, 0.0, 0.1, 1.0, 0.0, 0.0, 0.0]; 2],
                witnesses: vec![[0.0; 3]; 2],
            }],
        }
    }

    const ANSWER: &str = r#"{ "version": "4.0.0",
        "bodies": [{ "values": [0.5], "steepness": [1.0] }],
        "pairs": [{ "times": [1000.0, 2000.0], "distances": [-0.001, null],
                    "at_witnesses": [-0.001, -0.002] }] }"#;

    #[test]
    fn a_plugin_is_written_beside_its_points() -> Result<(), serde_json::Error> {
        let written = serde_json::to_value(question())?;
        assert_eq!(written["bodies"][0]["plugin"], "mujoco.sdf.torus");
        assert_eq!(written["bodies"][0]["attributes"][0][0], "radius1");
        assert_eq!(written["bodies"][0]["points"][0][2], 2.0);
        assert_eq!(written["pairs"][0]["poses"][1][2], 0.1);
        Ok(())
    }

    #[test]
    fn no_contact_is_null() -> Result<(), Box<dyn Error>> {
        let answer = Answer::read(ANSWER, &question())?;
        assert_eq!(answer.pairs[0].distances, [Some(-0.001), None]);
        Ok(())
    }

    #[test]
    fn an_answer_that_lacks_a_pose_is_refused() {
        let short = ANSWER.replace("[1000.0, 2000.0]", "[1000.0]");
        assert!(Answer::read(&short, &question()).is_err());
        assert!(Answer::read(&ANSWER[..40], &question()).is_err());
    }
}
