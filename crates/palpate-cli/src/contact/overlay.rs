// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contacts and their proof, drawn over isolines.

use palpate::field::Vector;
use palpate::plot::{Arrow, Arrows, Color, Dash, Isolines, Markers, Polyline, Slice};
use palpate::query::{Contact, Proof, Verdict};
use palpate::scene::{BuiltScene, ContactsAnswer, ContactsQuestion, PairContacts, Question};

use crate::arguments::ContactQuestion;
use crate::ask;
use crate::emptiness;
use crate::interrupt::Interrupt;
use crate::outcome::Failure;
use crate::picture::{cut, in_space};

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
