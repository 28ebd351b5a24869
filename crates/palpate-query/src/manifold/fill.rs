// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contacts where a region has no rim that spans it: a ball in a hollow one, or bodies so
//! deep in each other that they do not face each other where the region ends.

use palpate_field::scalar::Model;
use palpate_field::{Point, Vector};

use super::grid::distance;
use super::patch::Patches;
use super::{COPIES, LIKE, ManifoldSettings, Member, Touch};
use crate::contact::NormalSource;
use crate::pair::cell::BoxCell;

/// How far apart points are laid, in spacings: less than `NEIGHBOURS` of patches.
const APART: f64 = 1.9;

/// A flat box in the middle of a region, of which no candidate was made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Middle<const D: usize> {
    point: Point<D>,
    normal: Vector<f64, D>,
    radius: f64,
    values: [f64; 2],
    slopes: [Vector<f64, D>; 2],
}

impl<const D: usize> Middle<D> {
    /// The box, by the models of both fields in it; `None` where they do not face each
    /// other.
    pub(super) fn of(cell: &BoxCell<D>, [a, b]: &[Model; 2]) -> Option<Self> {
        let mut slopes = [Vector::ZERO; 2];
        for k in (0..D).filter(|k| cell.half[*k] > 0.0) {
            (slopes[0][k], slopes[1][k]) =
                (a.gradient[k] / cell.half[k], b.gradient[k] / cell.half[k]);
        }
        let normal = (slopes[0] - slopes[1]).normalized()?;
        let is_facing = slopes[0].dot(slopes[1]) < 0.0;
        let (point, radius, values) = (cell.centre, cell.radius(), [a.value, b.value]);
        is_facing.then_some(Self { point, normal, radius, values, slopes })
    }

    /// Appends points of the surface between the bodies in the box, where its flat models have it: near
    /// its sides, and so far apart that each has neighbours.
    pub(super) fn lay(
        &self,
        cell: &BoxCell<D>,
        settings: &ManifoldSettings,
        candidates: &mut Vec<Touch<D>>,
    ) {
        let [a, b] = self.slopes;
        let between = a - b;
        let across =
            (0..D).fold(0, |k, i| if between[i].abs() > between[k].abs() { i } else { k });
        // Of the axis across, the surface tells the place.
        let counts: [usize; D] = std::array::from_fn(|k| {
            let steps = 2.0 * cell.half[k] / (APART * settings.spacing);
            if k == across { 1 } else { steps.ceil().max(1.0) as usize }
        });
        for index in 0..counts.iter().product() {
            let (mut offset, mut rest, mut is_outer) = (Vector::ZERO, index, false);
            for k in (0..D).filter(|k| *k != across) {
                let step = rest % counts[k];
                let share = (step as f64 + 0.5) / counts[k] as f64;
                offset[k] = (2.0 * share - 1.0) * cell.half[k];
                is_outer |= step == 0 || step + 1 == counts[k];
                rest /= counts[k];
            }
            if !is_outer {
                continue;
            }
            let apart = self.values[0] - self.values[1] + between.dot(offset);
            offset[across] = -apart / between[across];
            let gap = 2.0 * (self.values[0] + a.dot(offset));
            if offset[across].abs() <= cell.half[across] && gap <= settings.margin {
                let (point, source) = (self.point + offset, NormalSource::Gradients);
                candidates.push(Touch { point, normal: self.normal, gap, source });
            }
        }
    }

    fn is_like(&self, contact: &Member<D>) -> bool {
        contact.touch.normal.dot(self.normal) > LIKE
    }

    /// Whether the box is next to one of the contacts from `first` on, or between one of
    /// them and another: in the ball about both.
    fn is_spanned(&self, contacts: &[Member<D>], first: usize, near: f64) -> bool {
        let away = |contact: &Member<D>| contact.touch.point - self.point;
        (first..contacts.len()).filter(|i| self.is_like(&contacts[*i])).any(|i| {
            let one = away(&contacts[i]);
            let mut others = contacts[..i].iter().filter(|other| self.is_like(other));
            one.norm() < near || others.any(|other| one.dot(away(other)) <= 0.0)
        })
    }

    /// How far the next contact with a like normal is, and its group.
    fn next(&self, contacts: &[Member<D>]) -> (f64, Option<usize>) {
        let like = contacts.iter().filter(|contact| self.is_like(contact));
        like.fold((f64::INFINITY, None), |least, member| {
            let apart = distance(member.touch.point, self.point);
            if apart < least.0 { (apart, Some(member.group)) } else { least }
        })
    }
}

impl<const D: usize> Patches<'_, '_, D> {
    /// Appends contacts until they span all of `middles`, always where it is farthest to
    /// the next.
    pub(super) fn fill(&mut self, middles: &mut Vec<Middle<D>>, contacts: &mut Vec<Member<D>>) {
        let near = COPIES * self.settings.spacing;
        let mut first = 0;
        loop {
            middles.retain(|middle| !middle.is_spanned(contacts, first, near));
            first = contacts.len();
            let farthest = (0..middles.len()).max_by(|&i, &k| {
                let [one, other] = [i, k].map(|i| middles[i].next(contacts).0);
                one.total_cmp(&other).then(k.cmp(&i))
            });
            let Some(farthest) = farthest else { break };
            let middle = middles.swap_remove(farthest);
            let Some(touch) = self.settle(middle.point, middle.radius) else { continue };
            let new = contacts.iter().map(|member| member.group + 1).max().unwrap_or(0);
            let group = middle.next(contacts).1.unwrap_or(new);
            contacts.push(Member { touch, group });
        }
    }
}
