// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that close on a hand and leave it no room.

use std::f64::consts::PI;

use palpate_device::{Device, PointState, profile_named};
use palpate_field::{Point, Pose, Rotation, Shape, Vector};
use palpate_haptics::{
    Bodies, Body, EventKind, Material, Probe, Protection, Servo, ServoOptions, Shell, Surface,
    Tool, ToolOptions, Touch, Unprotected,
};
use palpate_sim::{Hand, HandPath, Interpolation, SimulatedDevice};

use crate::common::{ball, cases, cuboid};
use arbitrary::{Result, Unstructured};
use palpate_testkit::arbitrary::{direction, within};

const PERIOD: f64 = 1e-3;

/// The largest step of the force in a tick [N], and what rounding adds.
const LARGEST_STEP: f64 = 0.3 + 1e-9;

/// The same among bodies of any shape: where a corner passes the hand, a search may end a tick later.
const LARGEST_DRAWN_STEP: f64 = 0.5 + 1e-9;

/// A body that goes through these poses: at a time [s], a pose.
type Motion<'a> = &'a dyn Fn(f64) -> Pose<3>;

/// A body, how it moves, and its material.
struct Moved<'a> {
    shape: Shape<3>,
    motion: Motion<'a>,
    is_moved: bool,
    material: Material,
}

/// A hand among bodies that move.
struct Run {
    ticks: Vec<Touch>,
    /// How far the fastest body moves at the hand in each tick [m].
    moved: Vec<f64>,
    /// In how many ticks a stage took away of the force until then, but for the ramp.
    taken: Vec<u64>,
    events: Vec<(u32, u32, EventKind)>,
}

/// A hand of 300 N/m on an omega, or one that no force moves.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Held {
    ByOmega,
    Rigidly,
}

/// What touches.
#[derive(Clone, Copy, Debug)]
enum Tip {
    /// A ball of this radius [m].
    Ball(f64),
    /// A rod along x, 4 mm thick and 30 mm long.
    Rod,
}

impl Tip {
    fn servo(self, bodies: Bodies) -> Servo<Unprotected> {
        let radius = if let Self::Ball(radius) = self { radius } else { 0.002 };
        let options = ServoOptions {
            probe: Probe::new(radius).unwrap(),
            max_force: f64::INFINITY,
            ..ServoOptions::default()
        };
        if let Self::Ball(_) = self {
            return Servo::new(bodies, 1, options).unwrap();
        }
        let ends = [-0.013, 0.013].map(|x| Vector([x, 0.0, 0.0]));
        let shell = Shell::capsule(ends, 0.002, 15).unwrap();
        let tool =
            Tool::new(shell, ToolOptions { stiffness: 1000.0, ..ToolOptions::default() });
        Servo::with_tool(bodies, tool.unwrap(), options).unwrap()
    }

    /// How deep the tip is in a body, at least [m].
    fn depth(self, body: &Body, tip: &Pose<3>) -> f64 {
        let place = |x: f64| {
            let place = tip.transform_point(Vector([x, 0.0, 0.0]));
            body.world_from_body().inverse().transform_point(place)
        };
        let depth = |x: f64, radius: f64| radius - body.shape().distance(place(x));
        match self {
            Self::Ball(radius) => depth(0.0, radius),
            // The balls of the shell.
            Self::Rod => (-7..=7)
                .map(|ball| depth(0.013 / 7.0 * f64::from(ball), 0.002))
                .fold(f64::NEG_INFINITY, f64::max),
        }
    }
}

impl Run {
    /// A hand that begins at the first place and is at the last after half a second.
    fn new(
        bodies: &[Moved<'_>],
        tip: Tip,
        places: [Point<3>; 2],
        held: Held,
        seconds: f64,
    ) -> Self {
        let surfaces = bodies.iter().map(|body| Surface::new(&body.material).unwrap());
        let all = bodies.iter().zip(surfaces).map(|(body, surface)| {
            let new = Body::new(body.shape.clone(), surface).unwrap();
            new.at((body.motion)(0.0)).unwrap()
        });
        let servo = tip.servo(Bodies::new(all.collect()).unwrap());
        let profile = profile_named("omega").unwrap();
        let mut servo = servo.protected(&Protection::new(profile.clone())).unwrap();
        let [first, last] = places;
        let path =
            HandPath::new(vec![0.0, 0.5, 60.0], vec![first, last, last], Interpolation::Linear);
        let path = path.unwrap();
        let mut device = SimulatedDevice::new(profile, vec![Hand::new(path.clone())]).unwrap();
        let mut run = Self {
            ticks: Vec::new(),
            moved: Vec::new(),
            taken: Vec::new(),
            events: Vec::new(),
        };
        for tick in 0..(seconds / PERIOD) as u32 {
            let time = f64::from(tick) * PERIOD;
            let mut points = [PointState::at_rest(path.state_at(time).position)];
            if held == Held::ByOmega {
                device.read(time, &mut points).unwrap();
            }
            for (index, body) in bodies.iter().enumerate().filter(|(_, body)| body.is_moved) {
                servo.set_pose(index, (body.motion)(time));
            }
            let carried = |body: &Moved<'_>| {
                let [before, now] = [time - PERIOD, time].map(|time| (body.motion)(time));
                let place = points[0].position;
                (now.transform_point(before.inverse().transform_point(place)) - place).norm()
            };
            run.moved.push(bodies.iter().map(carried).fold(0.0, f64::max));
            let touch = servo.step(&points)[0];
            device.write(&[touch.force]).unwrap();
            run.ticks.push(touch);
            let effects = servo.stage_effects();
            let taking = effects.named().filter(|(name, _)| *name != "rise from zero");
            run.taken.push(taking.map(|(_, effect)| effect.ticks).sum());
            run.events.extend(servo.events().iter().map(|it| (tick, it.body, it.kind)));
            let held =
                servo.held_tool().map_or(Pose::translation(touch.proxy), |tool| tool.pose);
            for body in servo.bodies().bodies().iter().zip(bodies) {
                let (body, Moved { is_moved: false, .. }) = body else { continue };
                let depth = tip.depth(body, &held);
                let is_out = depth <= 1e-9 || !touch.contact;
                assert!(is_out, "{depth} in a body that stands still, tick {tick}: {touch:?}");
            }
        }
        run
    }

    /// The largest change of the force in a tick [N], beyond 1000 N/m times the motion of hand and
    /// bodies, and its tick.
    fn largest_step(&self) -> (f64, usize) {
        self.steps().fold((0.0, 0), |most, step| if step.0 > most.0 { step } else { most })
    }

    fn steps(&self) -> impl Iterator<Item = (f64, usize)> + '_ {
        self.ticks.windows(2).enumerate().map(|(tick, ticks)| {
            let moved = (ticks[1].device - ticks[0].device).norm() + self.moved[tick + 1];
            ((ticks[1].force - ticks[0].force).norm() - 1000.0 * moved, tick + 1)
        })
    }

    /// The same but for ticks in which a stage takes away of the force, as the law of energy does.
    fn largest_free_step(&self) -> (f64, usize) {
        let is_free = |tick: usize| self.taken[tick] == self.taken[tick - 1];
        let steps = self.steps().filter(|(_, tick)| is_free(*tick));
        steps.fold((0.0, 0), |most, step| if step.0 > most.0 { step } else { most })
    }

    fn at(&self, time: f64) -> &Touch {
        &self.ticks[(time / PERIOD) as usize]
    }

    fn squeezes(&self) -> Vec<(u32, u32)> {
        let squeezed = self.events.iter().filter(|it| it.2 == EventKind::Squeezed);
        squeezed.map(|it| (it.0, it.1)).collect()
    }
}

fn hard(friction: f64) -> Material {
    Material {
        stiffness: 1000.0,
        damping: 1.0,
        static_friction: friction,
        dynamic_friction: 0.75 * friction,
        ..Material::default()
    }
}

fn plate() -> Shape<3> {
    cuboid([0.1, 0.02, 0.1])
}

/// Goes from `from` to `to` in a second that begins at `start` [s], smoothly.
fn smooth(time: f64, start: f64, [from, to]: [f64; 2]) -> f64 {
    let part = (time - start).clamp(0.0, 1.0);
    from + (to - from) * 0.5 * (1.0 - (PI * part).cos())
}

fn height(y: f64) -> Pose<3> {
    Pose::translation(Vector([0.0, y, 0.0]))
}

fn table(friction: f64) -> Moved<'static> {
    Moved {
        shape: plate(),
        motion: &|_| height(-0.01),
        is_moved: false,
        material: hard(friction),
    }
}

#[test]
fn a_jaw_that_closes_on_a_table_leaves_the_force_of_the_table() {
    // It leaves 1 mm for a ball of 4 mm, from 2 s to 3 s.
    let jaw =
        |time: f64| height(smooth(time, 1.0, [0.06, 0.011]) + smooth(time, 3.0, [0.0, 0.049]));
    let jaw = Moved { shape: plate(), motion: &jaw, is_moved: true, material: hard(0.4) };
    let places = [0.006, -0.006].map(|y| Vector([0.0, y, 0.0]));
    let hands = [Held::ByOmega, Held::Rigidly];
    let tips = [Tip::Ball(0.002), Tip::Rod, Tip::Ball(0.0)];
    for (held, tip) in hands.into_iter().flat_map(|held| tips.map(|tip| (held, tip))) {
        let jaw = Moved { shape: jaw.shape.clone(), material: hard(0.4), ..jaw };
        let run = Run::new(&[table(0.4), jaw], tip, places, held, 5.0);
        let before = run.at(0.9).force[1];
        assert!(before > 1.4, "{before}");
        for touch in &run.ticks[900..] {
            let force = touch.force[1];
            // The jaw pushes a hand down that the force moves.
            let most = if held == Held::ByOmega { 0.4 } else { 0.02 };
            assert!((force - before).abs() < most, "{tip:?} {held:?}: {force} of {before}");
        }
        assert!(run.largest_step().0 <= LARGEST_STEP, "{:?}", run.largest_step());
        if let Tip::Ball(0.0) = tip {
            assert_eq!(run.squeezes(), []);
            continue;
        }
        let [(tick, body)] = run.squeezes()[..] else { panic!("{:?}", run.squeezes()) };
        assert!((1800..2000).contains(&tick) && body == 1, "{tick} {body}");
    }
}

#[test]
fn a_wedge_that_closes_squeezes_the_hand_out() {
    // From 60 to 20 degrees on each side of the x axis, about the origin.
    let side = |sign: f64| {
        move |time: f64| {
            let angle = smooth(0.5 * time, 0.25, [60.0, 20.0]).to_radians() * sign;
            let turn = Rotation::from_axis_angle(Vector([0.0, 0.0, 1.0]), angle);
            let arm = Vector([0.05, 0.01 * sign, 0.0]);
            let turn = Pose::rotation(turn.unwrap());
            turn * Pose::translation(arm)
        }
    };
    let sides = [side(1.0), side(-1.0)];
    for (held, friction) in [(Held::Rigidly, 0.0), (Held::ByOmega, 0.0), (Held::Rigidly, 0.4)] {
        let bodies = sides.each_ref().map(|motion| Moved {
            shape: plate(),
            motion,
            is_moved: true,
            material: hard(friction),
        });
        let place = Vector([0.005, 0.0005, 0.0]);
        let run = Run::new(&bodies, Tip::Ball(0.002), [place, place], held, 4.0);
        assert!(run.largest_step().0 <= LARGEST_STEP, "{:?}", run.largest_step());
        let last = run.ticks.last().unwrap();
        // The ball rests where its radius over the sine of 20 degrees leaves it room.
        let room = 0.002 / 20_f64.to_radians().sin();
        if friction == 0.0 {
            assert!((last.proxy - Vector([room, 0.0, 0.0])).norm() < 1e-5, "{last:?}");
        }
        if held == Held::Rigidly && friction == 0.0 {
            assert!((last.force - Vector([0.853, -0.5, 0.0])).norm() < 0.1, "{last:?}");
        }
        assert!(run.squeezes().is_empty(), "{:?}", run.squeezes());
    }
}

#[test]
fn two_jaws_that_close_take_the_force_step_by_step() {
    let jaw = |sign: f64| {
        move |time: f64| {
            let way = smooth(time, 1.0, [0.03, 0.011]) + smooth(time, 3.0, [0.0, 0.019]);
            height(way * sign)
        }
    };
    let jaws = [jaw(1.0), jaw(-1.0)];
    for offset in [0.0, 2e-4, 1e-3, -3e-3] {
        for held in [Held::ByOmega, Held::Rigidly] {
            let bodies = jaws.each_ref().map(|motion| Moved {
                shape: plate(),
                motion,
                is_moved: true,
                material: hard(0.4),
            });
            let place = Vector([0.0, offset, 0.0]);
            let run = Run::new(&bodies, Tip::Ball(0.002), [place, place], held, 5.0);
            assert!(run.largest_step().0 <= LARGEST_STEP, "{offset}: {:?}", run.largest_step());
            assert!(!run.squeezes().is_empty(), "{offset}");
            // Free again at the end.
            assert_eq!(run.ticks.last().unwrap().force, Vector::ZERO);
        }
    }
}

/// A body that goes from far away to near the origin and back within 4 s, turned at random, and that
/// rests where it is nearest.
fn closing(u: &mut Unstructured<'_>) -> Result<impl Fn(f64) -> Pose<3> + use<>> {
    let way = direction::<3>(u)?;
    let (turn, angle) = (direction::<3>(u)?, within(u, 0.0, 3.0)?);
    let turn = Rotation::from_axis_angle(turn, angle).unwrap();
    let near = within(u, 0.005, 0.02)?;
    Ok(move |time: f64| {
        let far = smooth(time, 0.8, [0.09, near]) + smooth(time, 2.5, [0.0, 0.09 - near]);
        Pose::new(turn, way * far)
    })
}

/// Bodies of any shape that close on a hand from all sides, beside a table and a post or two. The
/// force does not jump, and the hand is in no body that stands still.
#[test]
fn whatever_closes_the_force_does_not_jump() {
    cases(200, |u| {
        let shapes =
            [plate(), ball(0.01), cuboid([0.02, 0.02, 0.02]), cuboid([0.03, 0.001, 0.03])];
        let motions = [closing(u)?, closing(u)?];
        let friction = *u.choose(&[0.0, 0.3, 0.8])?;
        let mut bodies = Vec::new();
        if u.ratio(3, 4)? {
            bodies.push(table(friction));
        }
        let post = within(u, 0.003, 0.006)?;
        let post_at = move |_| Pose::translation(Vector([post, 0.02, 0.0]));
        if u.ratio(1, 2)? {
            let shape = cuboid([0.0005, 0.04, 0.04]);
            let material = hard(friction);
            bodies.push(Moved { shape, motion: &post_at, is_moved: false, material });
        }
        for motion in motions.iter().take(u.int_in_range(1..=2)?) {
            let shape = u.choose(&shapes)?.clone();
            bodies.push(Moved { shape, motion, is_moved: true, material: hard(friction) });
        }
        let mut place = || {
            let along = |u: &mut Unstructured<'_>| within(u, -0.004, 0.004);
            Ok(Vector([along(u)?, along(u)?, along(u)?]))
        };
        let places = [place()? + Vector([0.0, 0.008, 0.0]), place()?];
        let tip = *u.choose(&[Tip::Ball(0.002), Tip::Ball(0.004), Tip::Rod])?;
        let run = Run::new(&bodies, tip, places, Held::ByOmega, 4.0);
        let (step, tick) = run.largest_free_step();
        assert!(step <= LARGEST_DRAWN_STEP, "{tip:?}: {step} N in tick {tick}");
        Ok(())
    });
}

/// Once a body that grazed the point used up the evaluations of a tick: the point was dropped onto the
/// hand, and its force fell from 7.6 N to zero.
#[test]
fn a_point_between_two_bodies_that_move_keeps_its_touch() {
    let floor = |time: f64| {
        Pose::translation(Vector([0.01 * time, -0.01 + 0.001 * (5.0 * time).sin(), 0.0]))
    };
    let rotation = Rotation::from_axis_angle(Vector([0.0, 0.0, 1.0]), 0.4).unwrap();
    let grazing = |time: f64| Pose::new(rotation, Vector([0.014 - 0.05 * time, 0.004, 0.0]));
    let spring = Material {
        stiffness: 1000.0,
        damping: 0.0,
        static_friction: 0.0,
        dynamic_friction: 0.0,
        ..Material::default()
    };
    let surface = || Surface::new(&spring).unwrap();
    let bodies = Bodies::new(vec![
        Body::new(cuboid([0.2, 0.02, 0.2]), surface()).unwrap().at(floor(0.0)).unwrap(),
        Body::new(ball::<3>(0.01), surface()).unwrap().at(grazing(0.0)).unwrap(),
    ]);
    let mut servo = Tip::Ball(0.0).servo(bodies.unwrap());
    let mut last = None::<Touch>;
    for tick in 0..400 {
        let time = PERIOD * f64::from(tick);
        servo.set_pose(0, floor(time));
        servo.set_pose(1, grazing(time));
        let hand = Vector([-0.002, 0.02 - 1e-4 * f64::from(tick.min(240)), 0.003]);
        let touch = servo.step(&[PointState::at_rest(hand)])[0];
        if let Some(last) = last.filter(|last| last.contact) {
            assert!(touch.contact, "{tick}");
            // The bodies pass each other at 0.06 m/s, a spring of 1000 N/m each.
            let step = (touch.wanted - last.wanted).norm() - 0.06;
            assert!(step < 0.5, "{tick}: {step}");
        }
        last = Some(touch);
    }
    assert!(last.is_some_and(|last| last.wanted.norm() > 5.0));
}
