// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate contact`: where the bodies of a scene touch.

mod overlay;

use palpate::scene::{AnyScene, BuiltScene, ContactsQuestion, Question};

use crate::arguments::{ContactOptions, ContactQuestion};
use crate::ask;
use crate::emptiness;
use crate::input;
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output;
use crate::views;

pub(crate) use overlay::Touched;

/// Finds the pairs that touch; the answer is no if none do.
pub(crate) fn run(options: &ContactOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    let named = input::scene(Some(&options.scene))?;
    match &named.scene {
        AnyScene::Planar(scene) => answer(options, scene, interrupt),
        AnyScene::Spatial(scene) => answer(options, scene, interrupt),
    }
}

fn answer<const D: usize>(
    options: &ContactOptions,
    scene: &BuiltScene<D>,
    interrupt: &Interrupt,
) -> Result<Outcome, Failure> {
    let question = Question::Contacts(ContactsQuestion {
        bodies: options.body.clone(),
        every_pair: options.every_pair,
        time: options.time,
        ..options.question.asked()
    });
    if let Some(time) = options.time {
        views::remark_if_still(scene, time);
    }
    let Some(answer) = ask::ask(scene, question, interrupt)? else {
        output::remark(
            "interrupted before it was known which bodies touch; nothing is reported",
        );
        return Ok(Outcome::Interrupted);
    };
    let found = ask::contacts(&answer);
    emptiness::warn_of(&found.empty);
    output::answer().print(&answer, options.json)?;
    if !found.is_whole {
        output::remark("interrupted: some pairs that are apart are not listed");
        return Ok(Outcome::Interrupted);
    }
    Ok(if found.touching > 0 { Outcome::Yes } else { Outcome::No })
}

impl ContactQuestion {
    /// The question of these options.
    pub(crate) fn asked(&self) -> ContactsQuestion {
        ContactsQuestion {
            margin: self.margin,
            spacing: self.spacing,
            tolerance: self.tolerance,
            budget: self.budget,
            ..ContactsQuestion::default()
        }
    }

    /// Refuses options of a search for contacts where none is made.
    pub(crate) fn refuse_unless(&self, is_asked: bool) -> Result<(), Failure> {
        let given = [
            ("--margin", self.margin.is_some()),
            ("--spacing", self.spacing.is_some()),
            ("--tolerance", self.tolerance.is_some()),
            ("--budget", self.budget.is_some()),
        ];
        match given.iter().find(|(_, is_given)| *is_given && !is_asked) {
            Some((option, _)) => {
                Err(Failure::input(format!("{option} is about contacts, and needs --contacts")))
            }
            None => Ok(()),
        }
    }
}
