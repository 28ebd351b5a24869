// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contacts and their proof, drawn over isolines.

use palpate::field::Vector;
use palpate::plot::{Arrow, Arrows, Color, Dash, Isolines, Markers, Polyline, Slice};
use palpate::query::{Contact, Proof, Verdict};
use palpate::scene::BuiltScene;

use super::FEW;
use super::question::{Asked, Pair, Question};
use crate::arguments::ContactQuestion;
use crate::interrupt::Interrupt;
use crate::outcome::Failure;
use crate::picture::{cut, in_space};

/// The contacts of a scene, to be drawn.
pub(crate) struct Touched<const D: usize> {
    pairs: Vec<Pair<D>>,
    proofs: Vec<Proof<D>>,
    /// A slice shows only contacts at most this far from it [m].
    near: f64,
}

impl<const D: usize> Touched<D> {
    /// Finds the contacts, and the proofs if they are to be drawn.
    pub(crate) fn find(
        asked: &ContactQuestion,
        scene: &BuiltScene<D>,
        with_proof: bool,
    ) -> Result<Self, Failure> {
        let question = Question::of(asked, scene);
        let asked = Asked { bodies: &[], is_every: scene.bodies.len() <= FEW };
        // Not interruptible: a picture of some pairs would be taken for one of all pairs.
        let pairs = question.pairs(scene, &asked, &Interrupt::new())?;
        let pairs = pairs.ok_or_else(|| Failure::input("the search for contacts was ended"))?;
        let shown = pairs.iter().filter(|pair| with_proof && pair.separation.is_some());
        let proofs = shown.map(|pair| question.proof(scene, pair.bodies));
        let proofs = proofs.collect::<Result<_, _>>()?;
        Ok(Self { pairs, proofs, near: question.settings.manifold.spacing })
    }

    /// The middle of the deepest contact, or of the shortest segment between bodies.
    pub(crate) fn deepest(&self) -> Option<Vector<f64, D>> {
        let contacts = self.pairs.iter().flat_map(|pair| &pair.contacts);
        let deepest = contacts.min_by(|a, b| a.gap.total_cmp(&b.gap))?;
        Some((deepest.point_a + deepest.point_b) * 0.5)
    }

    /// The contacts of bodies that touch, or may touch.
    pub(crate) fn touching(&self) -> impl Iterator<Item = &Contact<D>> {
        let pairs = self.pairs.iter().filter(|pair| pair.verdict != Verdict::Apart);
        pairs.flat_map(|pair| &pair.contacts)
    }

    /// How many pairs touch, and how many boxes the drawn proofs have.
    pub(crate) fn counts(&self) -> (usize, usize) {
        let touching = self.pairs.iter().filter(|pair| pair.verdict == Verdict::Touching);
        (touching.count(), self.proofs.iter().map(|proof| proof.boxes.len()).sum())
    }

    /// Draws contacts and proofs over `isolines`.
    pub(crate) fn draw(&self, isolines: Isolines, plane: &Slice) -> Result<Isolines, Failure> {
        let mut isolines = isolines;
        if !self.proofs.is_empty() {
            let boxes = self.proofs.iter().flat_map(|proof| cuts(proof, plane));
            let boxes = Polyline::of_pieces("ruled out", boxes).map_err(Failure::input)?;
            isolines = isolines.with_polyline(boxes.faint());
        }
        let is_seen = |contact: &&Contact<D>| {
            plane.elevation(in_space((contact.point_a + contact.point_b) * 0.5)).abs()
                <= self.near
        };
        let contacts = |is_apart: bool| {
            let pairs = self.pairs.iter();
            let pairs = pairs.filter(move |pair| (pair.verdict == Verdict::Apart) == is_apart);
            pairs.flat_map(|pair| &pair.contacts).filter(is_seen)
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
