// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Force and torque of a tool on the hand, and its reactions on the bodies.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Pose, Vector};
use palpate_query::Contact;

use super::closest::FREEDOMS;
use super::coupling::Twist;
use super::settle::{Push, stacked_along};
use super::state::{ToolState, ToolTouch};
use super::{Coupling, Tool};
use crate::bodies::Body;
use crate::contact_point::LARGEST_GAIN;
use crate::crease::Place;
use crate::event::{Event, EventKind, Reaction};
use crate::guide::limit::{Motion, damped};
use crate::nearby::Nearby;
use crate::proxy::Edited;
use crate::seam::blended;
use palpate_device::shortening;
use palpate_safety::Change;

/// The response of the pushing bodies to the coupling.
struct BodyResponse {
    /// The part of the coupling's force that the bodies bear, in [0, 1].
    part: f64,
    /// The force of the bodies' own dampers [N].
    force: Vector<f64, 3>,
    /// The torque of this force about the tool's origin [N·m].
    torque: Vector<f64, 3>,
}

/// The contact of the tick before, as events need it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Before {
    body: Option<u32>,
    is_slipping: bool,
}

impl Before {
    pub(super) fn of(touch: &ToolTouch) -> Self {
        let body = touch.body.filter(|_| touch.contact);
        Self { body, is_slipping: touch.is_slipping }
    }
}

/// What was felt in the tick before.
pub(super) struct Felt {
    pub(super) device: Pose<3>,
    force: Vector<f64, 3>,
}

impl Felt {
    pub(super) fn of(touch: &ToolTouch) -> Self {
        Self { device: touch.device, force: touch.force }
    }
}

impl Tool {
    /// The largest motion of a hand that goes from `from` to `to` relative to a body that pushes it
    /// [m].
    pub(super) fn slides(&self, nearby: &Nearby<'_>, from: &Pose<3>, to: &Pose<3>) -> f64 {
        let way = to.translation - from.translation;
        let slides = self.rest_search.rest.pushes.iter().map(|push| {
            let carried = nearby.body(push.body).and_then(|body| body.carried_pose(from));
            let carried = carried.map_or(Vector::ZERO, |it| it.translation - from.translation);
            (way - carried).norm()
        });
        slides.reduce(f64::max).unwrap_or_else(|| way.norm())
    }

    /// Whether the force changes by more than 0.3 N beyond what motion explains.
    pub(super) fn has_stepped(&self, before: &Felt) -> bool {
        let change = (self.touch.force - before.force).norm();
        Change::None.or_handed_over(change, self.explained) != Change::None
    }

    /// Writes force and torque of the tool at its new rest pose; its pose in the last tick was
    /// `before`, and hand and bodies moved its points by `way` at most [m].
    pub(super) fn write_touch(
        &mut self,
        nearby: &Nearby<'_>,
        device: &ToolState,
        before: &Pose<3>,
        way: f64,
    ) {
        let was = Before::of(&self.touch);
        self.write_rest(device);
        let rest = &self.rest_search.rest;
        let moved = Twist::between(before, &rest.pose);
        self.touch.velocity = moved.linear * self.options.rate;
        let hardest = hardest(&rest.pushes).filter(|_| self.touch.contact).copied();
        self.touch.body = hardest.map(|push| push.body);
        self.touch.normal = hardest.map_or(Vector::ZERO, |push| push.normal);
        self.carrier = self.touch.body;
        self.hand_velocity = device.velocity;
        if let Some(push) = &hardest {
            self.hand_velocity -=
                self.body_velocity(nearby, push.body, device.pose.translation);
        }
        // A tool that snaps to another face or edge moves its damper by at most `way`.
        let slow = moved.part((way / moved.way(self.shell.reach())).min(1.0));
        self.write_force(nearby, device, &slow);
        let speed = hardest.map_or(0.0, |push| {
            (-self.speed_at(nearby, &push, device, 1.0).dot(push.normal)).max(0.0)
        });
        self.tell_changes(was, speed);
    }

    /// Writes the rest pose and the contacts, and what is proven about them.
    fn write_rest(&mut self, device: &ToolState) {
        let (rest, touch) = (&self.rest_search.rest, &mut self.touch);
        touch.device = device.pose;
        touch.pose = rest.pose;
        touch.contact = rest.is_outside && !rest.pushes.is_empty();
        touch.is_slipping = touch.contact && self.rest_search.is_slipping;
        touch.is_covered = !rest.is_outside;
        touch.evaluations = self.scan.evaluations();
        touch.points_known = rest.known;
        let levels = self.scan.levels();
        let finest = levels.checked_sub(1).and_then(|last| self.shell.levels.get(last));
        touch.resolution = match finest {
            Some(end) if rest.is_outside => self.shell.resolution(*end),
            _ => f64::INFINITY,
        };
        touch.is_degraded = levels < self.shell.levels.len();
        touch.contacts.clear();
        if !touch.contact {
            return;
        }
        for push in &rest.pushes {
            let point = self.shell.points().get(push.point as usize);
            let radius = point.map_or(0.0, |point| point.radius);
            let point_a = push.centre - push.normal * radius;
            let point_b = push.centre - push.normal * (radius + push.gap);
            // A point of the tool touches a body at most once, so point and body identify the
            // contact.
            let id = u64::from(push.body) << 32 | u64::from(push.point);
            touch.contacts.push(Contact::new(point_a, point_b, -push.normal).with_id(id));
        }
    }

    /// Writes force and torque of a tool whose damper moved by `moved` in this tick.
    fn write_force(&mut self, nearby: &Nearby<'_>, device: &ToolState, moved: &Twist) {
        let has_new_bodies = std::mem::take(&mut self.has_new_bodies);
        let has_jumped = std::mem::take(&mut self.has_jumped);
        let before = self.effort();
        if !self.touch.contact {
            (self.touch.force, self.touch.torque) = (Vector::ZERO, Vector::ZERO);
            if self.rest_search.rest.is_outside {
                self.rise = 1.0;
            }
            return;
        }
        let stretch = Twist::between(&device.pose, &self.touch.pose);
        if !self.rest_search.rest.touching.is_empty() {
            self.spread(self.depth(&stretch));
        }
        let body_response = self.body_response(nearby, device, &stretch);
        let (options, coupling) = (&self.options, &self.coupling);
        let velocity = device.velocity - moved.linear * options.rate;
        let spins = device.angular_velocity - moved.angular * options.rate;
        let part = body_response.part;
        let force = Motion {
            spring: stretch.linear * (coupling.stiffness * part),
            damper: velocity * (-coupling.damping * part),
        };
        let torque = Motion {
            spring: stretch.angular * (coupling.angular_stiffness * part),
            damper: spins * (-coupling.angular_damping * part),
        };
        let force = and_damper(not_pulling(force), body_response.force);
        let torque = and_damper(not_pulling(torque), body_response.torque);
        self.touch.force = damped(&force, options.force_limit()) * self.rise;
        self.touch.torque = damped(&torque, options.max_torque) * self.rise;
        if has_new_bodies && (self.edited.is_none() || has_jumped) {
            let start = shortening(self.effort(), before);
            if has_jumped && self.is_protected {
                self.start = Some(start);
            } else {
                self.rise *= start;
                self.touch.force = self.touch.force * start;
                self.touch.torque = self.touch.torque * start;
            }
        }
        let step = 1.0 / (options.rate * options.rise_time);
        self.rise = (self.rise + step).min(1.0);
        self.part = part;
    }

    /// The norm of force and torque together, where a radian counts as a length [N].
    fn effort(&self) -> f64 {
        let (force, torque) = (self.touch.force, self.touch.torque);
        let torque = torque * (1.0 / self.coupling.unit());
        (force.dot(force) + torque.dot(torque)).sqrt()
    }

    /// The response of the bodies to a stretch of the coupling, weighted by how much each
    /// pushes.
    ///
    /// At the depth `d = √(‖v‖² + ℓ²‖ω‖²)` a body bears `∫ min(K, K_body)` over the depth. This
    /// is a function of the distance from the device's pose to the nearest free pose, so the
    /// force of one body has a potential, and is no stiffer than the coupling.
    ///
    /// Where level bodies of different springs meet, each point blends them as a probe does.
    fn body_response(
        &mut self,
        nearby: &Nearby<'_>,
        device: &ToolState,
        stretch: &Twist,
    ) -> BodyResponse {
        let (mut part, mut force, mut torque) = (0.0, Vector::ZERO, Vector::ZERO);
        let Coupling { stiffness, arms, .. } = self.coupling;
        let depth = self.depth(stretch);
        let pushes = self.pushes();
        let whole: f64 = pushes.iter().map(|push| push.push).sum();
        let (mut evaluations, left) = (0, self.scan.left());
        let most_force = self.options.force_limit();
        let borne_by = |body: &Body| {
            body.surface().strata.force_up_to(stiffness, depth) / (stiffness * depth)
        };
        let is_shared = !self.rest_search.rest.touching.is_empty();
        let of_seam = 2 * nearby.all().count() as u32;
        for push in pushes {
            let share = push.push / whole;
            let Some(body) = nearby.body(push.body) else { continue };
            let strata = &body.surface().strata;
            let borne = if is_shared && evaluations + of_seam <= left {
                let Push { normal, body, .. } = *push;
                let proxy = push.centre - normal * push.gap;
                let radius = self.shell.points().get(push.point as usize);
                let radius = radius.map_or(0.0, |point| point.radius);
                let place = Place { proxy, stretch: stretch.linear, body, normal, radius };
                blended(nearby, &place, most_force, &mut evaluations, borne_by)
            } else {
                borne_by(body)
            };
            // Written so that NaN, from zero depth, gives one.
            part += share * if borne < 1.0 { borne } else { 1.0 };
            let layer = strata.at(0, depth);
            let velocity = self.speed_at(nearby, push, device, arms);
            let approach = (-velocity.dot(push.normal)).max(0.0);
            let damper = push.normal * (layer.damping * approach) - velocity * layer.viscosity;
            let arm = (push.centre - self.touch.pose.translation) * arms;
            force += damper * share;
            torque += arm.cross(damper * share);
        }
        self.scan.spend(evaluations);
        self.touch.evaluations += evaluations;
        BodyResponse { part, force, torque }
    }

    /// The norm of a stretch of the coupling, where a radian counts as a length [m].
    fn depth(&self, stretch: &Twist) -> f64 {
        stretch.stacked(self.coupling.unit()).iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    /// The velocity of the hand at a contact relative to its body, on a scaled lever arm [m/s].
    fn speed_at(
        &self,
        nearby: &Nearby<'_>,
        push: &Push,
        device: &ToolState,
        arms: f64,
    ) -> Vector<f64, 3> {
        let arm = (push.centre - self.touch.pose.translation) * arms;
        let turning = device.angular_velocity.cross(arm);
        device.velocity + turning - self.body_velocity(nearby, push.body, push.centre)
    }

    /// How far the bodies that push the tool carry the hand in this tick; `None` if none pushes.
    ///
    /// It is the motion nearest to the mean of the motions that they give to the device's pose,
    /// weighted by how much each pushes, for which the work of the whole wrench is that of the bodies
    /// at their contacts.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn bodies_moved(&self, nearby: &Nearby<'_>) -> Option<Twist> {
        if !self.touch.contact {
            return None;
        }
        if !nearby.has_moved() {
            return Some(Twist::NONE);
        }
        let pushes = &self.rest_search.rest.pushes;
        let whole: f64 = pushes.iter().map(|push| push.push).sum();
        let unit = self.coupling.unit();
        let (mut mean, mut wrench) = ([0.0; FREEDOMS], [0.0; FREEDOMS]);
        let (mut work, mut fastest) = (0.0, 0.0_f64);
        for push in pushes {
            let arm = push.centre - self.touch.pose.translation;
            let along = stacked_along(arm, push.normal, unit);
            add(&mut wrench, &along, push.push);
            let body = nearby.body(push.body);
            let Some((body, carried)) =
                body.and_then(|body| Some((body, body.carried_pose(&self.touch.device)?)))
            else {
                continue;
            };
            let twist = Twist::between(&self.touch.device, &carried);
            add(&mut mean, &twist.stacked(unit), push.push / whole);
            fastest = fastest.max(twist.squared(unit).sqrt());
            work += (body.carried(push.centre) - push.centre).dot(push.normal) * push.push;
        }
        let lacking = work - dot(&mean, &wrench);
        let squared = dot(&wrench, &wrench);
        // Where bodies push against each other, most of their work is on each other: the mean then
        // counts alone.
        if lacking != 0.0 && lacking.abs() <= LARGEST_GAIN * fastest * squared.sqrt() {
            add(&mut mean, &wrench, lacking / squared);
        }
        // Written so that NaN carries nothing.
        let is_finite = mean.iter().all(|x| x.is_finite());
        is_finite.then(|| Twist::unstacked(mean, unit))
    }

    /// The velocity of a body at a place [m/s].
    fn body_velocity(
        &self,
        nearby: &Nearby<'_>,
        body: u32,
        place: Vector<f64, 3>,
    ) -> Vector<f64, 3> {
        match nearby.body(body).filter(|body| body.has_moved()) {
            Some(body) => (body.carried(place) - place) * self.options.rate,
            None => Vector::ZERO,
        }
    }

    /// Emits the events of this tick.
    pub(super) fn tell_changes(&mut self, was: Before, speed: f64) {
        let is = Before::of(&self.touch);
        let mut tell = |body, kind| {
            self.events.push(Event { tick: self.tick, point: 0, body, kind });
        };
        match (was.body, is.body) {
            (Some(before), Some(body)) if before == body => {
                if was.is_slipping != is.is_slipping {
                    let slips = is.is_slipping;
                    tell(body, if slips { EventKind::Slip } else { EventKind::Stick });
                }
            }
            (before, body) => {
                before.into_iter().for_each(|body| tell(body, EventKind::Leave));
                body.into_iter().for_each(|body| tell(body, EventKind::Touch { speed }));
            }
        }
    }

    /// Tells what new bodies did to the tool.
    pub(super) fn tell_edited(&mut self, has_jumped: bool, before: &Felt) {
        let kind = match self.edited {
            None if has_jumped && self.has_stepped(before) => EventKind::Placed,
            None => return,
            Some(Edited::Carried { distance }) => EventKind::Carried { distance },
            Some(Edited::Placed) => EventKind::Placed,
        };
        let body = self.touch.body.unwrap_or(0);
        self.events.push(Event { tick: self.tick, point: 0, body, kind });
    }

    /// The stiffness of coupling and bodies in the last contact: force over depth [N/m].
    pub(crate) fn secant(&self) -> f64 {
        self.coupling.stiffness * self.part
    }

    /// Applies the opposite of the hand's force and torque to the bodies: to each the push of
    /// its contacts, and its share of what dampers and limits change.
    pub(super) fn react(&self, nearby: &Nearby<'_>, reactions: &mut [Reaction]) {
        if !self.touch.contact {
            return;
        }
        let pushes = self.pushes();
        let origin = self.touch.pose.translation;
        let stiffness = self.coupling.stiffness * self.part * self.rise;
        let mut force = self.touch.force;
        let mut torque = self.touch.torque;
        let whole: f64 = pushes.iter().map(|push| push.push).sum();
        for push in pushes {
            let pushed = push.normal * (stiffness * push.push);
            force -= pushed;
            torque -= (push.centre - origin).cross(pushed);
        }
        for push in pushes {
            let place = nearby.body(push.body).map(|body| body.world_from_body().translation);
            let reaction = reactions.get_mut(push.body as usize);
            let Some((place, reaction)) = place.zip(reaction) else { continue };
            let share = push.push / whole;
            reaction.add(push.normal * (-stiffness * push.push), push.centre - place);
            reaction.add(force * -share, origin - place);
            reaction.torque -= torque * share;
        }
    }
}

/// Adds a multiple of stacked numbers.
fn add(sum: &mut [f64; FREEDOMS], other: &[f64; FREEDOMS], factor: f64) {
    sum.iter_mut().zip(other).for_each(|(sum, x)| *sum += x * factor);
}

fn dot(a: &[f64; FREEDOMS], b: &[f64; FREEDOMS]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The contact that pushes hardest.
fn hardest(pushes: &[Push]) -> Option<&Push> {
    pushes.iter().fold(None, |hardest: Option<&Push>, push| match hardest {
        Some(hardest) if hardest.push >= push.push => Some(hardest),
        _ => Some(push),
    })
}

/// The motion with its damper limited so that it at most cancels the spring's push.
fn not_pulling(motion: Motion) -> Motion {
    let Some(along) = motion.spring.normalized() else {
        return Motion { damper: Vector::ZERO, ..motion };
    };
    let pulls = -(motion.damper.dot(along) + motion.spring.norm());
    let damper = if pulls > 0.0 { motion.damper + along * pulls } else { motion.damper };
    Motion { damper, ..motion }
}

/// The motion with one more damper.
fn and_damper(motion: Motion, damper: Vector<f64, 3>) -> Motion {
    Motion { damper: motion.damper + damper, ..motion }
}
