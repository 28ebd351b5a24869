// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What is known of a shell's points: how far they are from the bodies, and for how long that
//! answers.
//!
//! A rigid motion that moves the tool's origin by `v` and turns it by `ω` moves a point `ρ` from
//! the origin by at most `‖v‖ + ‖ω‖ρ`. So a cluster whose least gap was `g` touches nothing
//! before that sum has grown by `g / L`, and is not asked again until then (Mirtich,
//! "Impulse-based dynamic simulation of rigid body systems", 1996, section 2.3; for shells,
//! Johnson, Willemsen and Cohen, "Six degree-of-freedom haptic rendering using spatialized normal
//! cone search", 2005, keep what is near likewise).

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Pose, Vector};

use super::batch::{Batch, Seen};
use super::shell::{Cluster, Shell};
use super::sweep::March;
use super::twist::Twist;
use crate::nearby::Nearby;

/// When a cluster was looked at.
#[derive(Clone, Copy, Debug)]
struct Look {
    /// At which pose.
    stamp: u64,
    /// The reading of the clock before which it touches nothing.
    free_until: f64,
}

impl Look {
    const NONE: Self = Self { stamp: 0, free_until: f64::NEG_INFINITY };
}

/// How far the tool went and turned so far; grows only.
#[derive(Clone, Copy, Debug, Default)]
struct Clock {
    way: f64,
    turn: f64,
}

impl Clock {
    /// How far a point `arm` from the origin may have gone.
    fn at(&self, arm: f64) -> f64 {
        self.way + self.turn * arm
    }
}

/// What is known of a shell.
#[derive(Clone, Debug)]
pub(super) struct Scan<const D: usize> {
    points: Vec<Seen<D>>,
    looks: Vec<Look>,
    clock: Clock,
    /// Of the present pose.
    stamp: u64,
    /// Clusters to look at now.
    due: Vec<u32>,
    /// Levels that are still looked at in this tick.
    levels: usize,
    budget: u32,
    evaluations: u32,
    /// Points that are followed on their way.
    pub(super) marches: Vec<March>,
    pub(super) batch: Box<Batch<D>>,
}

impl<const D: usize> Scan<D> {
    pub(super) fn new(shell: &Shell<D>) -> Self {
        let zero = Vector::ZERO;
        let nothing = Seen { centre: zero, gap: f64::NEG_INFINITY, gradient: zero, body: 0 };
        Self {
            points: vec![nothing; shell.points().len()],
            looks: vec![Look::NONE; shell.clusters.len()],
            clock: Clock::default(),
            stamp: 1,
            due: Vec::with_capacity(shell.clusters.len()),
            levels: shell.levels.len(),
            budget: 0,
            evaluations: 0,
            marches: Vec::with_capacity(shell.points().len()),
            batch: Batch::boxed(),
        }
    }

    /// A new tick: all levels, and a budget.
    pub(super) fn begin(&mut self, shell: &Shell<D>, budget: u32) {
        (self.levels, self.budget, self.evaluations) = (shell.levels.len(), budget, 0);
    }

    /// The bodies are other ones, or elsewhere: nothing is known any more.
    pub(super) fn forget(&mut self) {
        self.looks.fill(Look::NONE);
        self.stamp += 1;
    }

    /// The tool is elsewhere.
    pub(super) fn moved(&mut self, twist: &Twist<D>) {
        self.clock.way += twist.linear.norm();
        self.clock.turn += twist.angular.norm();
        self.stamp += 1;
    }

    /// Evaluations in this tick.
    pub(super) fn evaluations(&self) -> u32 {
        self.evaluations
    }

    /// How many levels are looked at in this tick.
    pub(super) fn levels(&self) -> usize {
        self.levels
    }

    /// Evaluations that are left in this tick.
    pub(super) fn left(&self) -> u32 {
        self.budget.saturating_sub(self.evaluations)
    }

    /// Counts evaluations.
    pub(super) fn spend(&mut self, evaluations: u32) {
        self.evaluations += evaluations;
    }

    /// What is known of a point.
    pub(super) fn point(&self, number: u32) -> Option<&Seen<D>> {
        self.points.get(number as usize)
    }

    /// Looks at all clusters that the tool at `pose` could touch with in a motion like `twist`
    /// that moves no point by more than `horizon` [m]; at those of fewer levels if there are more than `share` of what the budget has left
    /// allow. `false` if it does not allow the first level.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn look(
        &mut self,
        shell: &Shell<D>,
        nearby: &Nearby<'_, D>,
        pose: &Pose<D>,
        (twist, horizon, share): (&Twist<D>, f64, f64),
    ) -> bool {
        self.due.clear();
        let left = f64::from(self.left());
        let (mut count, mut is_enough) = (0, true);
        for (index, (cluster, look)) in (0..).zip(shell.clusters.iter().zip(&self.looks)) {
            if cluster.level >= self.levels {
                break;
            }
            let remaining = look.free_until - self.clock.at(cluster.arm);
            if look.stamp == self.stamp || remaining > twist.way(cluster.arm).min(horizon) {
                continue;
            }
            let size = cluster.members.len();
            let allowed = if cluster.level == 0 { left } else { left * share };
            if (count + size) as f64 > allowed {
                self.levels = cluster.level;
                is_enough = cluster.level > 0;
                break;
            }
            count += size;
            self.due.push(index);
        }
        self.evaluate(shell, nearby, pose);
        is_enough
    }

    /// Looks at the clusters that are due.
    fn evaluate(&mut self, shell: &Shell<D>, nearby: &Nearby<'_, D>, pose: &Pose<D>) {
        let lipschitz = nearby.lipschitz().max(f64::MIN_POSITIVE);
        let due = std::mem::take(&mut self.due);
        let members = due.iter().filter_map(|cluster| shell.clusters.get(*cluster as usize));
        let mut numbers = members.clone().flat_map(|cluster| shell.members(cluster));
        let batch = &mut *self.batch;
        loop {
            batch.gather(shell, pose, &mut numbers);
            if batch.count == 0 {
                break;
            }
            batch.ask(nearby);
            self.evaluations += batch.count as u32;
            for (number, seen) in batch.results() {
                if let Some(point) = self.points.get_mut(number as usize) {
                    *point = *seen;
                }
            }
        }
        for (index, cluster) in due.iter().zip(members) {
            let gaps = shell.members(cluster).filter_map(|i| self.points.get(i as usize));
            // Written so that NaN touches.
            let least =
                gaps.fold(
                    f64::INFINITY,
                    |least, point| {
                        if point.gap >= least { least } else { point.gap }
                    },
                );
            let free_until = self.clock.at(cluster.arm) + least / lipschitz;
            if let Some(look) = self.looks.get_mut(*index as usize) {
                *look = Look { stamp: self.stamp, free_until };
            }
        }
        self.due = due;
    }

    /// The clusters that were looked at where the tool is.
    fn seen_clusters<'a>(&'a self, shell: &'a Shell<D>) -> impl Iterator<Item = &'a Cluster> {
        let known = shell.clusters.iter().zip(&self.looks);
        known.filter(|(_, look)| look.stamp == self.stamp).map(|(cluster, _)| cluster)
    }

    /// The points that were looked at where the tool is, with their numbers.
    pub(super) fn seen<'a>(
        &'a self,
        shell: &'a Shell<D>,
    ) -> impl Iterator<Item = (u32, &'a Seen<D>)> {
        let numbers = self.seen_clusters(shell).flat_map(|cluster| shell.members(cluster));
        numbers.filter_map(|i| Some((i, self.points.get(i as usize)?)))
    }

    /// The least gap of what was looked at where the tool is [m].
    pub(super) fn least_gap(&self, shell: &Shell<D>) -> f64 {
        // Written so that NaN is the least.
        self.seen(shell).fold(
            f64::INFINITY,
            |least, (_, point)| {
                if point.gap >= least { least } else { point.gap }
            },
        )
    }

    /// The part of a motion that those clusters allow which were not looked at here.
    pub(super) fn free_part(&self, shell: &Shell<D>, twist: &Twist<D>) -> f64 {
        let mut part = 1.0_f64;
        for (cluster, look) in shell.clusters.iter().zip(&self.looks) {
            if cluster.level >= self.levels || look.stamp == self.stamp {
                continue;
            }
            let remaining = (look.free_until - self.clock.at(cluster.arm)).max(0.0);
            let way = twist.way(cluster.arm);
            if way > remaining {
                part = part.min(remaining / way);
            }
        }
        part
    }

    /// How many points are known to touch nothing they should not, where the tool is.
    pub(super) fn known(&self, shell: &Shell<D>) -> u32 {
        let known = shell.clusters.iter().zip(&self.looks).filter(|(cluster, look)| {
            look.stamp == self.stamp || look.free_until >= self.clock.at(cluster.arm)
        });
        known.map(|(cluster, _)| cluster.members.len() as u32).sum()
    }
}

impl<const D: usize> Shell<D> {
    /// The numbers of the points of a cluster.
    fn members(&self, cluster: &Cluster) -> impl Iterator<Item = u32> + '_ {
        self.order.get(cluster.members.clone()).unwrap_or(&[]).iter().copied()
    }
}
