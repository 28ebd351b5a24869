// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A tool that a servo renders instead of contact points. It is coupled to the one contact
//! point of a device, and its force goes through that point's port.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Pose, Vector};

use crate::accepted_bodies::AcceptedBodies;
use crate::bodies::Bodies;
use crate::contact_point::{ContactPoint, FreeForce, Setting, Touch};
use crate::ports::{Port, TurningPort};
use crate::proxy::Edited;
use crate::tool::{Coupling, HeldTool, Tool, ToolState};
use palpate_device::{PointState, TurnState, limited};
use palpate_safety::{Change, MovingBodies, SpatialVector, WrenchChain, WrenchState};

/// The two sides of a tool: the contact point that holds it, and the bodies that stop it.
pub(crate) struct Sides<'a> {
    pub(crate) point: &'a mut ContactPoint,
    pub(crate) bodies: &'a mut Bodies,
}

/// A tool coupled to the contact point of a servo, with the rotation of the device.
#[derive(Clone, Debug)]
pub(crate) struct CoupledTool {
    pub(crate) tool: Tool,
    /// The requested coupling, before device limits.
    pub(crate) requested: Coupling,
    /// Orientation and angular velocity of the device; `None` for a device without rotation.
    pub(crate) turn: Option<TurnState>,
    /// The rotational port to the device; `None` without protection.
    pub(crate) port: Option<TurningPort>,
    /// The torque limit set by the caller [N·m]; a safety chain has the device's too.
    max_torque: f64,
    /// The torque to write to the device [N·m].
    pub(crate) torque: Vector<f64, 3>,
    /// The written torque in world coordinates; `None` for a device without rotation.
    given: Option<Vector<f64, 3>>,
}

impl CoupledTool {
    pub(crate) fn new(tool: Tool) -> Self {
        let (max_torque, torque) = (f64::INFINITY, Vector::ZERO);
        let requested = tool.coupling;
        Self { tool, requested, turn: None, port: None, max_torque, torque, given: None }
    }

    /// The tool after the last tick.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn held(&self) -> HeldTool {
        HeldTool { given: self.given, ..self.tool.held() }
    }

    /// The safety chain of force and torque; `None` for a device that gives no torque.
    pub(crate) fn chain(&mut self) -> Option<&mut WrenchChain> {
        self.port.as_mut().and_then(|port| port.chain.as_mut())
    }

    /// Touches other bodies from the next tick on, with their accepted coupling; they carry a
    /// point without a radius by `most_of_point` [m] at most.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn adopt(&mut self, bodies: &AcceptedBodies, most_of_point: f64) {
        self.tool.forget_bodies();
        self.tool.most_of_point = most_of_point;
        if let Some(coupling) = bodies.coupling {
            self.tool.coupling = coupling;
        }
        if let Some((chain, (along, about))) = self.chain().zip(bodies.wrench()) {
            chain.renew(along, about);
        }
    }

    /// Lowers the force limit [N].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn limit_force(&mut self, max_force: f64) {
        self.tool.limit_force(max_force);
        if let Some(chain) = self.chain() {
            chain.limit_force(max_force);
        }
    }

    /// Sets the torque of this tick to zero.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn withhold(&mut self) {
        self.torque = Vector::ZERO;
        self.given = self.given.map(|_| Vector::ZERO);
    }

    /// Lowers the torque limit [N·m].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn limit_torque(&mut self, max_torque: f64) {
        // `min` ignores NaN.
        self.max_torque = self.max_torque.min(max_torque);
        self.keep_torque_limit();
    }

    /// Hands the torque limit on to the safety chain.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn keep_torque_limit(&mut self) {
        let max_torque = self.max_torque;
        if let Some(chain) = self.chain() {
            chain.limit_torque(max_torque);
        }
    }

    /// One tick of the tool coupled to `point`, from the state of the device to the force to
    /// write [N], both in device coordinates; the torque to write is stored. `touch` describes
    /// the whole tool.
    ///
    /// Real-time: as [`Tool::step`].
    pub(crate) fn tick(
        &mut self,
        sides: Sides<'_>,
        setting: &Setting,
        state: PointState,
        touch: &mut Touch,
    ) -> Vector<f64, 3> {
        let Sides { point, bodies } = sides;
        let Setting { map, arrival, is_lifted, .. } = setting;
        let is_turn_sound = self
            .port
            .as_mut()
            .is_none_or(|port| port.counts(self.turn, state.position, arrival.elapsed));
        let at_device = point
            .port
            .as_mut()
            .map_or(state, |port| port.state(state, *arrival, is_turn_sound));
        let elapsed = point.port.as_ref().map_or(arrival.elapsed, Port::elapsed);
        let (turn, angle) = match &mut self.port {
            Some(port) => port.state(self.turn, elapsed),
            None => (self.turn, Vector::ZERO),
        };
        let PointState { position, velocity } = map.state_to_world(at_device);
        let (rotation, angular_velocity) = match &turn {
            Some(turn) => (
                map.orientation_to_world(turn.orientation),
                map.spin_to_world(turn.angular_velocity),
            ),
            None => (map.rotation(), Vector::ZERO),
        };
        let pose = Pose::new(rotation, position);
        let state = ToolState { pose, velocity, angular_velocity };
        let mut free = Vector::ZERO;
        self.tool.is_protected = point.port.is_some();
        if *is_lifted {
            bodies.settle();
            self.tool.hover(&state);
            point.let_go();
        } else {
            free = point.guided(position, velocity, setting);
            self.tool.step(bodies, &state);
        }
        let felt = self.tool.touch();
        *touch = Touch {
            device: position,
            velocity: self.tool.hand_velocity,
            proxy: felt.pose.translation,
            wanted: felt.force,
            force: Vector::ZERO,
            normal: felt.normal,
            contact: felt.contact,
            body: felt.body.unwrap_or(0),
            is_slipping: felt.is_slipping,
            evaluations: felt.evaluations,
        };
        let torque = turn.map_or(Vector::ZERO, |_| map.torque_to_device(felt.torque));
        point.stiffness = self.tool.secant();
        let stiffness = point.stiffness * map.scale();
        let (start, change) = self.change();
        let (moved, explained) = (self.tool.bodies_moved, self.tool.explained);
        let change = if arrival.is_ready { change } else { Change::Begins };
        let force = if let Some(chain) = self.chain() {
            let force = map.force_to_device(touch.wanted);
            let spin = turn.map_or(Vector::ZERO, |turn| turn.angular_velocity);
            let state = WrenchState {
                position: SpatialVector { along: at_device.position, about: angle },
                velocity: SpatialVector { along: at_device.velocity, about: spin },
                free_force: map.force_to_device(free),
                late: point.port.as_ref().map_or(arrival.late, |port| port.late(arrival.late)),
                elapsed,
                start,
                change,
                explained,
                stiffness,
                bodies: MovingBodies {
                    driven: SpatialVector {
                        along: map.velocity_to_device(moved.linear),
                        about: map.spin_to_device(moved.angular),
                    },
                    ..MovingBodies::default()
                },
            };
            let wanted = SpatialVector { along: force, about: torque };
            let given = chain.step_within(wanted, setting.options.max_force, &state);
            self.torque = given.about;
            touch.force = map.force_to_world(given.along);
            given.along
        } else {
            // A port without a safety chain belongs to a device that gives no torque.
            let most = if self.port.is_some() { 0.0 } else { self.max_torque };
            self.torque = limited(torque, most);
            // Without protection the tool's own rise is that of a placement.
            let placed = point.port.is_some() && start == 0.0;
            let carried = moved.linear;
            let free = FreeForce { force: free, placed, change, explained, carried };
            point.give(setting, at_device, touch, free)
        };
        self.given = turn.map(|_| map.torque_to_world(self.torque));
        force
    }

    /// What happened to the tool in this tick, and the part of its force to render.
    fn change(&self) -> (f64, Change) {
        if let Some(start) = self.tool.start {
            return (start, Change::None);
        }
        match self.tool.edited {
            Some(Edited::Placed) => (0.0, Change::None),
            Some(Edited::Carried { .. }) => (1.0, Change::Carried),
            None if self.tool.begins => (1.0, Change::Begins),
            None if self.tool.hands_over => (1.0, Change::HandedOver),
            None => (1.0, Change::None),
        }
    }
}
