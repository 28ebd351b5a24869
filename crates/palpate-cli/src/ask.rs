// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Questions of the command line to a scene.

use palpate::scene::{
    Answer, AskError, BuiltScene, ContactsAnswer, MassAnswer, PointAnswer, Question,
};

use crate::interrupt::Interrupt;
use crate::outcome::Failure;

/// The answer to a question; `None` if the program is asked to end before it is known whole.
pub(crate) fn unless_asked<const D: usize>(
    scene: &BuiltScene<D>,
    question: Question,
    interrupt: &Interrupt,
) -> Result<Option<Answer<D>>, Failure> {
    let scene = scene.clone();
    interrupt.unless_asked(move || scene.ask(&question)).transpose().map_err(failure)
}

/// The answer to a question, or what is known of it when the program is asked to end; `None` if
/// nothing is.
pub(crate) fn ask<const D: usize>(
    scene: &BuiltScene<D>,
    question: Question,
    interrupt: &Interrupt,
) -> Result<Option<Answer<D>>, Failure> {
    let scene = scene.clone();
    interrupt.soon(move |stop| scene.ask_until(&question, stop)).transpose().map_err(failure)
}

/// Why a question of the command line has no answer.
pub(crate) fn failure(error: AskError) -> Failure {
    match error {
        AskError::UnknownBody(error) => Failure::input(format!("--body: {error}")),
        error => Failure::input(error),
    }
}

/// An answer of the kind that was asked for.
macro_rules! kinds {
    ($($name:ident: $kind:ident($answer:ident)),*) => {
        $(pub(crate) fn $name<const D: usize>(answer: &Answer<D>) -> &$answer<D> {
            match answer {
                Answer::$kind(answer) => answer,
                other => unreachable!("{other:?} does not answer such a question"),
            }
        })*
    };
}
kinds! {
    contacts: Contacts(ContactsAnswer), mass: Mass(MassAnswer), point: Point(PointAnswer)
}
