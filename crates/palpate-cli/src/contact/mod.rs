// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate contact`: where bodies touch.

use std::path::PathBuf;

use clap::Args;
use palpate::field::Vector;
use palpate::plot::{Arrow, Arrows, Color, Dash, Isolines, Markers, Polyline, Slice};
use palpate::query::{Contact, Proof, Verdict};
use palpate::scene::{
    AnyScene, BuiltScene, ContactsAnswer, ContactsQuestion, PairContacts, Question,
};

use crate::arguments::Reading;
use crate::arguments::numbers::{count, length, length_or_zero, zero_or_more};
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::picture::{cut, in_space};
use crate::{ask, emptiness, input, output, views};

/// Finds the pairs that touch; the answer is no if none do.
pub(crate) fn run(options: &ContactOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    let named = input::scene(Some(&options.scene), options.reading)?;
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

pub(crate) const EXAMPLES: &str = "\
Examples:
  palpate contact scenes/peg_in_hole.json
  palpate contact scenes/nut_on_bolt.json --margin 0.0002 --json
  palpate contact scenes/gears.json --tolerance 1e-6
  palpate contact scenes/peg_in_hole.json --body peg --every-pair
  palpate contact scenes/peg_in_hole.json --time 0.5

The separation of bodies that are exact outside is their distance; that of bodies that
overlap is minus the diameter of the largest ball inside both. Their penetration, the shortest
way by which the second body leaves the first, is printed beside it. Each lies between its
bounds, which include rounding and are printed to the nearest digit; --json has them whole. Of
other bodies that are apart, separations are lower bounds of distances. A pair touches if its
distance is proven to be at most the margin: by the upper bound of the separation, or, where that
bounds no distance, by two points of the bodies. It is apart if the lower bound is more than the
margin, and is undecided otherwise.";

/// The options of `palpate contact`.
#[derive(Args, Debug)]
pub(crate) struct ContactOptions {
    /// The scene file.
    pub(crate) scene: PathBuf,
    #[command(flatten)]
    pub(crate) question: ContactQuestion,
    /// List pairs that are apart too, with the bounds of their separation; always on where at
    /// most 66 pairs are asked about, those of 12 bodies.
    #[arg(long)]
    pub(crate) every_pair: bool,
    /// Only pairs with this body; may be given more than once.
    #[arg(long, value_name = "NAME")]
    pub(crate) body: Vec<String>,
    /// Ask about bodies where their motions have taken them at this time [s]; at their own poses
    /// if left out.
    #[arg(long, allow_negative_numbers = true, value_parser = zero_or_more("s"))]
    pub(crate) time: Option<f64>,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) reading: Reading,
}

/// What counts as touching, and how finely contacts are found.
#[derive(Args, Debug)]
pub(crate) struct ContactQuestion {
    /// The largest gap at which bodies count as touching [m]; 0.2 % of the smallest body if
    /// left out.
    #[arg(long, allow_negative_numbers = true, value_parser = length_or_zero)]
    pub(crate) margin: Option<f64>,
    /// The size of the smallest boxes in a region of contact [m]; 4 % of the smallest body if
    /// left out.
    #[arg(long, allow_negative_numbers = true, value_parser = length)]
    pub(crate) spacing: Option<f64>,
    /// How far apart the bounds of a separation may be [m]; if left out half the margin, or of the usual
    /// one if that is zero.
    #[arg(long, allow_negative_numbers = true, value_parser = length_or_zero)]
    pub(crate) tolerance: Option<f64>,
    /// The budget: the most evaluations of fields for each pair; 200000 if left out. The round
    /// that reaches it is finished.
    #[arg(long, allow_negative_numbers = true, value_parser = count(1, u32::MAX))]
    pub(crate) budget: Option<u32>,
}

/// The contacts of a scene, to be drawn.
pub(crate) struct Touched<const D: usize>(ContactsAnswer<D>);

impl<const D: usize> Touched<D> {
    /// Finds the contacts, and the proofs if they are to be drawn.
    pub(crate) fn find(
        asked: &ContactQuestion,
        scene: &BuiltScene<D>,
        with_proof: bool,
    ) -> Result<Self, Failure> {
        let question = ContactsQuestion { proof: with_proof, ..asked.asked() };
        // Not interruptible: a picture of some pairs would be taken for one of all pairs.
        let answer = ask::ask(scene, Question::Contacts(question), &Interrupt::new())?;
        let answer =
            answer.ok_or_else(|| Failure::input("the search for contacts was ended"))?;
        let found = ask::contacts(&answer).clone();
        emptiness::warn_of(&found.empty);
        Ok(Self(found))
    }

    fn proofs(&self) -> impl Iterator<Item = &Proof<D>> {
        self.0.pairs.iter().filter_map(|pair| pair.proof.as_ref())
    }

    /// The contacts of a pair, or the points that are nearest each other.
    fn drawn(pair: &PairContacts<D>) -> impl Iterator<Item = &Contact<D>> {
        pair.contacts.iter().chain(&pair.witness)
    }

    /// The middle of the deepest contact, or of the shortest segment between bodies.
    pub(crate) fn deepest(&self) -> Option<Vector<f64, D>> {
        let contacts = self.0.pairs.iter().flat_map(Self::drawn);
        let deepest = contacts.min_by(|a, b| a.gap.total_cmp(&b.gap))?;
        Some((deepest.point_a + deepest.point_b) * 0.5)
    }

    /// The contacts of bodies that touch, or may touch.
    pub(crate) fn touching(&self) -> impl Iterator<Item = &Contact<D>> {
        self.0.pairs.iter().flat_map(|pair| &pair.contacts)
    }

    /// How many pairs touch, and how many boxes the drawn proofs have.
    pub(crate) fn counts(&self) -> (usize, usize) {
        (self.0.touching, self.proofs().map(|proof| proof.boxes.len()).sum())
    }

    /// Draws contacts and proofs over `isolines`.
    pub(crate) fn draw(&self, isolines: Isolines, plane: &Slice) -> Result<Isolines, Failure> {
        let mut isolines = isolines;
        if self.proofs().next().is_some() {
            let boxes = self.proofs().flat_map(|proof| cuts(proof, plane));
            let boxes = Polyline::of_pieces("ruled out", boxes).map_err(Failure::input)?;
            isolines = isolines.with_polyline(boxes.faint());
        }
        let is_seen = |contact: &&Contact<D>| {
            plane.elevation(in_space((contact.point_a + contact.point_b) * 0.5)).abs()
                <= self.0.spacing
        };
        let contacts = |is_apart: bool| {
            let pairs = self.0.pairs.iter();
            let pairs = pairs.filter(move |pair| (pair.verdict == Verdict::Apart) == is_apart);
            pairs.flat_map(Self::drawn).filter(is_seen)
        };
        let at = |point: Vector<f64, D>| plane.project(in_space(point));
        let ends = |contact: &Contact<D>| vec![at(contact.point_a), at(contact.point_b)];
        if contacts(true).next().is_some() {
            let ways = Polyline::of_pieces("between bodies", contacts(true).map(ends));
            let ways = ways.map_err(Failure::input)?.with_dash(Dash::Dashed);
            isolines = isolines.with_polyline(ways.with_color(Color::PURPLE));
        }
        if contacts(false).next().is_some() {
            let normals = contacts(false).map(|contact| Arrow {
                tail: at((contact.point_a + contact.point_b) * 0.5),
                vector: plane.project_vector(in_space(contact.normal)),
            });
            let normals = Arrows::directions("normal", normals).map_err(Failure::input)?;
            let witnesses = contacts(false).flat_map(ends);
            let witnesses = Markers::new("contact", witnesses).map_err(Failure::input)?;
            isolines = isolines.with_arrows(normals).with_markers(witnesses);
        }
        Ok(isolines)
    }
}

/// The closed lines in which the plane cuts the boxes of a proof.
fn cuts<const D: usize>(
    proof: &Proof<D>,
    plane: &Slice,
) -> impl Iterator<Item = Vec<[f64; 2]>> {
    proof.boxes.iter().filter_map(|part| cut(&part.aabb, &proof.world_from_boxes, plane))
}
