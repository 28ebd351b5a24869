// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A small solver in the plane, for tests of contacts: sequential impulses in substeps, with Coulomb
//! friction, warm started by the ids of the contacts.
#![expect(clippy::unwrap_used, reason = "these are tests")]

use std::collections::HashMap;

use palpate_field::{MassLimits, Pose, Rotation, Shape, Vector};
use palpate_query::{
    Contact, Limits, ManifoldSettings, PairWorkspace, Placed, Track, separation,
};

/// Substeps of a step.
const SUBSTEPS: u32 = 4;

/// Rounds over all contacts in a substep.
const ROUNDS: u32 = 8;

/// The share of a penetration beyond the slop that a substep takes back.
const PUSH: f64 = 0.2;

/// A body; without mass it stands still.
pub(crate) struct Body {
    pub(crate) shape: Shape<2>,
    /// Its centre of mass in its own coordinates [m].
    centre: Vector<f64, 2>,
    /// The inverse of its mass [1/kg] and of its moment of inertia [1/(kg m²)].
    inverse_mass: f64,
    inverse_inertia: f64,
    /// Where its centre of mass is [m], and how it is turned [rad].
    pub(crate) at: Vector<f64, 2>,
    pub(crate) angle: f64,
    pub(crate) velocity: Vector<f64, 2>,
    pub(crate) spin: f64,
}

impl Body {
    pub(crate) fn fixed(shape: Shape<2>) -> Self {
        let (centre, at, velocity) = (Vector::ZERO, Vector::ZERO, Vector::ZERO);
        let (inverse_mass, inverse_inertia, angle, spin) = (0.0, 0.0, 0.0, 0.0);
        Self { shape, centre, inverse_mass, inverse_inertia, at, angle, velocity, spin }
    }

    /// A body of 1 kg/m² whose centre of mass is at a place.
    pub(crate) fn moving(shape: Shape<2>, at: [f64; 2], angle: f64) -> Self {
        let mass =
            shape.mass(1.0, MassLimits { tolerance: 1e-4, ..MassLimits::default() }).unwrap();
        Self {
            centre: mass.centroid,
            inverse_mass: 1.0 / mass.mass(),
            inverse_inertia: 1.0 / mass.polar_inertia(),
            at: Vector(at),
            angle,
            ..Self::fixed(shape)
        }
    }

    pub(crate) fn pose(&self) -> Pose<2> {
        let turn = Rotation::from_angle(self.angle).unwrap();
        Pose::new(turn, self.at - turn.rotate(self.centre))
    }

    fn point_velocity(&self, arm: Vector<f64, 2>) -> Vector<f64, 2> {
        self.velocity + Vector([-arm[1], arm[0]]) * self.spin
    }

    fn push(&mut self, arm: Vector<f64, 2>, impulse: Vector<f64, 2>) {
        self.velocity += impulse * self.inverse_mass;
        self.spin += (arm[0] * impulse[1] - arm[1] * impulse[0]) * self.inverse_inertia;
    }

    fn inverse_mass_along(&self, arm: Vector<f64, 2>, way: Vector<f64, 2>) -> f64 {
        let lever = arm[0] * way[1] - arm[1] * way[0];
        self.inverse_mass + self.inverse_inertia * lever * lever
    }
}

/// Two bodies that may touch, and the impulses of the last step by the ids of their contacts.
struct Pair {
    bodies: [usize; 2],
    track: Track<2>,
    impulses: HashMap<u64, [f64; 2]>,
}

/// A contact in a step.
struct Joint {
    pair: usize,
    bodies: [usize; 2],
    contact: Contact<2>,
    /// Where it is on each body, in that body's coordinates.
    places: [Vector<f64, 2>; 2],
    /// From the centres of mass to the contact at the start of the step: there the impulses act. An arm that
    /// turned with a disc would leave the point on which it rolls.
    arms: [Vector<f64, 2>; 2],
    /// The impulses along the normal and along the tangent [N s].
    impulses: [f64; 2],
}

pub(crate) struct Solver {
    pub(crate) bodies: Vec<Body>,
    pub(crate) gravity: Vector<f64, 2>,
    pub(crate) friction: f64,
    /// Steps in a second.
    pub(crate) rate: f64,
    pairs: Vec<Pair>,
    workspace: PairWorkspace<2>,
    /// How many of the calls for contacts searched.
    pub(crate) searches: u32,
    pub(crate) calls: u32,
}

impl Solver {
    pub(crate) fn new(bodies: Vec<Body>, rate: f64) -> Self {
        let mut pairs = Vec::new();
        for one in 0..bodies.len() {
            for other in one + 1..bodies.len() {
                if bodies[one].inverse_mass + bodies[other].inverse_mass > 0.0 {
                    let [a, b] = [one, other].map(|i| bodies[i].shape.clone());
                    let track = Track::new(a, b);
                    let (bodies, impulses) = ([one, other], HashMap::new());
                    pairs.push(Pair { bodies, track, impulses });
                }
            }
        }
        let (gravity, friction) = (Vector([0.0, -9.81]), 0.5);
        let workspace = PairWorkspace::new();
        Self { bodies, gravity, friction, rate, pairs, workspace, searches: 0, calls: 0 }
    }

    /// The penetration that stays between two bodies at rest [m].
    pub(crate) fn slop(&self, bodies: [usize; 2]) -> f64 {
        let pair = self.pairs.iter().find(|pair| pair.bodies == bodies).unwrap();
        ManifoldSettings::for_solver(pair.track.size()).solver_slop.unwrap()
    }

    /// The contacts of a step, up to the gap that the bodies may close in it.
    fn joints(&mut self) -> Vec<Joint> {
        let mut joints = Vec::new();
        for (i, pair) in self.pairs.iter_mut().enumerate() {
            let [a, b] = pair.bodies.map(|i| &self.bodies[i]);
            let own = ManifoldSettings::for_solver(pair.track.size());
            let faster = |body: &Body| body.velocity.norm() + body.spin.abs() * 0.15;
            let closing = (faster(a) + faster(b)) / self.rate;
            let settings = ManifoldSettings { margin: own.margin + closing, ..own };
            let limits = Limits::new(own.usual_tolerance()).with_budget(20_000);
            let poses = [a.pose(), b.pose()];
            let found =
                pair.track.contacts(poses, &settings, &limits, &mut self.workspace).unwrap();
            self.calls += 1;
            for contact in &found.contacts {
                let back = |body: &Body, p| body.pose().inverse().transform_point(p);
                let places = [back(a, contact.point_a), back(b, contact.point_b)];
                let arms = [contact.point_a - a.at, contact.point_b - b.at];
                let impulses = pair.impulses.get(&contact.id).copied().unwrap_or([0.0; 2]);
                let (contact, bodies) = (*contact, pair.bodies);
                joints.push(Joint { pair: i, bodies, contact, places, arms, impulses });
            }
            pair.impulses.clear();
        }
        joints
    }

    pub(crate) fn step(&mut self) {
        let mut joints = self.joints();
        let h = 1.0 / (self.rate * f64::from(SUBSTEPS));
        for _ in 0..SUBSTEPS {
            for body in self.bodies.iter_mut().filter(|body| body.inverse_mass > 0.0) {
                body.velocity += self.gravity * h;
            }
            for joint in &joints {
                self.push(joint, joint.impulses);
            }
            for _ in 0..ROUNDS {
                joints.iter_mut().for_each(|joint| self.solve(joint, h, true));
            }
            for body in &mut self.bodies {
                body.at += body.velocity * h;
                body.angle += body.spin * h;
            }
            // What took back penetration is no velocity that lasts.
            joints.iter_mut().for_each(|joint| self.solve(joint, h, false));
        }
        for joint in joints {
            self.pairs[joint.pair].impulses.insert(joint.contact.id, joint.impulses);
        }
    }

    fn push(&mut self, joint: &Joint, [along, aside]: [f64; 2]) {
        let normal = joint.contact.normal;
        let impulse = normal * along + Vector([-normal[1], normal[0]]) * aside;
        self.bodies[joint.bodies[0]].push(joint.arms[0], -impulse);
        self.bodies[joint.bodies[1]].push(joint.arms[1], impulse);
    }

    fn solve(&mut self, joint: &mut Joint, h: f64, is_pushing: bool) {
        let points = [0, 1]
            .map(|i| self.bodies[joint.bodies[i]].pose().transform_point(joint.places[i]));
        let normal = joint.contact.normal;
        let slop = self.slop(joint.bodies);
        let gap = (points[1] - points[0]).dot(normal);
        let ways = [normal, Vector([-normal[1], normal[0]])];
        for (k, way) in ways.into_iter().enumerate() {
            let [a, b] = joint.bodies.map(|i| &self.bodies[i]);
            let speed =
                (b.point_velocity(joint.arms[1]) - a.point_velocity(joint.arms[0])).dot(way);
            let inverse = a.inverse_mass_along(joint.arms[0], way)
                + b.inverse_mass_along(joint.arms[1], way);
            let wanted = match k {
                0 if gap > 0.0 => -gap / h,
                0 if is_pushing => (-PUSH * (gap + slop) / h).clamp(0.0, 2.0),
                _ => 0.0,
            };
            let total = joint.impulses[k] + (wanted - speed) / inverse;
            let most = self.friction * joint.impulses[0];
            let total = if k == 0 { total.max(0.0) } else { total.clamp(-most, most) };
            let mut change = [0.0; 2];
            change[k] = total - joint.impulses[k];
            joint.impulses[k] = total;
            self.push(joint, change);
        }
    }

    /// How deep any two bodies overlap at least [m], as their separation proves, with the names of both.
    pub(crate) fn deepest(&mut self) -> (f64, [usize; 2]) {
        let mut deepest = (f64::INFINITY, [0, 0]);
        for pair in &self.pairs {
            let [a, b] = pair.bodies.map(|i| &self.bodies[i]);
            let (at_a, at_b) =
                (Placed::new(&a.shape, a.pose()), Placed::new(&b.shape, b.pose()));
            let limits = Limits::new(2e-5);
            let found = separation(at_a, at_b, &limits, &mut self.workspace).unwrap();
            if found.upper < deepest.0 {
                deepest = (found.upper, pair.bodies);
            }
        }
        deepest
    }
}

#[test]
fn a_disc_rolls_down_as_fast_as_it_should() {
    let slope = 10.0_f64.to_radians();
    for rate in [60.0, 240.0, 1000.0] {
        let floor = Shape::half_space([slope.sin(), slope.cos()], 0.0).unwrap();
        let normal = Vector([slope.sin(), slope.cos()]);
        let start = normal * (0.08 - 1e-5);
        let disc = Body::moving(Shape::ball(0.08).unwrap(), start.0, 0.0);
        let mut solver = Solver::new(vec![Body::fixed(floor), disc], rate);
        let mut speed_before = 0.0;
        let steps = rate as u32;
        let along = Vector([slope.cos(), -slope.sin()]);
        for step in 0..steps {
            solver.step();
            if step + 1 == steps / 4 {
                speed_before = solver.bodies[1].velocity.dot(along);
            }
        }
        let gained = solver.bodies[1].velocity.dot(along) - speed_before;
        let exact = 2.0 / 3.0 * 9.81 * slope.sin() * 0.75;
        let share = gained / exact - 1.0;
        println!("{rate} Hz: {share:+.5}, searches {} of {}", solver.searches, solver.calls);
        // The explicit steps of the integrator leave an error that falls with their length.
        assert!(share.abs() < 0.4 / rate, "{rate} Hz: {share:+}");
    }
}

#[test]
fn a_heap_of_boxes_rests() {
    let floor = Shape::half_space([0.0, 1.0], 0.0).unwrap();
    let mut bodies = vec![Body::fixed(floor)];
    for i in 0..5 {
        let plate = Shape::rectangle([0.2, 0.12]).unwrap();
        bodies.push(Body::moving(plate, [0.0, 0.06 + 0.1201 * f64::from(i)], 0.0));
    }
    let mut solver = Solver::new(bodies, 240.0);
    (0..480).for_each(|_| solver.step());
    let searches = solver.searches;
    let before: Vec<_> = solver.bodies.iter().map(|body| (body.at, body.angle)).collect();
    (0..240).for_each(|_| solver.step());
    assert_eq!(solver.searches, searches, "bodies at rest are searched");
    let (deepest, bodies) = solver.deepest();
    let slop = solver.slop(bodies);
    println!("deepest {deepest}, slop {slop}");
    assert!(deepest > -slop - 2e-4, "{deepest} of a slop of {slop}");
    for (body, (at, angle)) in solver.bodies.iter().zip(before) {
        assert!((body.at - at).norm() < 1e-5, "{:?}", body.at - at);
        assert!((body.angle - angle).abs() < 1e-5, "{}", body.angle - angle);
    }
}
