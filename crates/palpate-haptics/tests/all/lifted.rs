// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A hand that is lifted off the bodies, and set down elsewhere; guides that are replaced.

use crate::common::tools::smooth;
use crate::common::{body, cuboid, without_limits};
use palpate_device::{DeviceProfile, PointState};
use palpate_field::{Point, Vector};
use palpate_haptics::{
    Bodies, EventKind, Guide, GuideOptions, HandoffOptions, Progress, Protection, Servo,
    ServoOptions, Shell, Surface, Tool, ToolOptions, Unprotected, handoff,
};
use palpate_safety::{Acceptance, Recovery};

/// A slab of ±1 cm around y = 0.
fn slab() -> Bodies {
    body(cuboid([1.0, 0.02, 1.0]), Surface::new(&smooth()).unwrap())
}

fn options() -> ServoOptions {
    ServoOptions { max_force: f64::INFINITY, ..ServoOptions::default() }
}

fn with_points() -> Servo<Unprotected> {
    Servo::new(slab(), 2, options()).unwrap()
}

fn with_tool() -> Servo<Unprotected> {
    let ends = [Vector([-0.04, 0.0, 0.0]), Vector([0.04, 0.0, 0.0])];
    let tool = Tool::new(Shell::capsule(ends, 0.01, 41).unwrap(), ToolOptions::default());
    Servo::with_tool(slab(), tool.unwrap(), options()).unwrap()
}

fn at(y: f64) -> [PointState; 2] {
    [PointState::at_rest(Vector([0.0, y, 0.0])), PointState::at_rest(Vector([0.2, y, 0.0]))]
}

/// The heights of a way from one place to another.
fn way(from: f64, to: f64) -> impl Iterator<Item = f64> {
    (1..=50).map(move |step| from + (to - from) * f64::from(step) / 50.0)
}

#[test]
fn a_lifted_hand_goes_through_a_wall_and_feels_nothing() {
    for mut servo in [with_points(), with_tool()].map(without_limits) {
        let points = servo.touches().len();
        for y in way(0.05, 0.0) {
            servo.step(&at(y)[..points]);
        }
        assert!(servo.forces().iter().all(|force| force[1] > 1.0));
        servo.lift(true);
        for (tick, y) in way(0.0, -0.05).enumerate() {
            servo.step(&at(y)[..points]);
            let leaves = servo.events().iter().filter(|event| event.kind == EventKind::Leave);
            let expected = if tick == 0 { points } else { 0 };
            assert_eq!((leaves.count(), servo.events().len()), (expected, expected));
            for (touch, force) in servo.touches().iter().zip(servo.forces()) {
                assert_eq!((touch.proxy, touch.contact), (touch.device, false));
                assert_eq!(*force, Vector::ZERO);
            }
        }
        servo.lift(false);
        for y in way(-0.05, -0.03) {
            servo.step(&at(y)[..points]);
            for touch in servo.touches() {
                assert_eq!((touch.proxy, touch.force), (touch.device, Vector::ZERO));
            }
        }
        // From below it is held back as from above.
        for y in way(-0.03, 0.005) {
            servo.step(&at(y)[..points]);
        }
        assert!(servo.forces().iter().all(|force| force[1] < -1.0));
    }
}

#[test]
fn a_hand_that_is_set_down_in_a_body_is_pushed_out_gently_or_not_at_all() {
    let largest = |recovery| {
        let device = DeviceProfile { max_force: 12.0, ..DeviceProfile::unlimited("gentle") };
        let protection = Protection::new(device).with(|s| {
            s.recovery = recovery;
            s.rise_rate = 10.0
        });
        let mut servo = with_points().protected(&protection).unwrap();
        servo.lift(true);
        servo.step(&at(0.005));
        servo.lift(false);
        let forces = (0..100).map(|_| {
            servo.step(&at(0.005));
            servo.forces()[0].norm()
        });
        forces.fold((0.0_f64, 0.0_f64), |(last, most), force| {
            // 10 N a second.
            assert!(force <= last + 0.010_001, "{force} N after {last} N");
            (force, most.max(force))
        })
    };
    let (_, most) = largest(Recovery::Rise);
    assert!((most - 1.0).abs() < 0.02, "{most} N");
    assert_eq!(largest(Recovery::OnceOut), (0.0, 0.0));
}

#[test]
fn a_lifted_hand_is_not_guided() {
    let guide = Guide::to_point(Vector([0.0, 0.1, 0.0]), GuideOptions::default()).unwrap();
    for mut servo in [with_points(), with_tool()] {
        servo.guide(std::slice::from_ref(&guide));
        let points = servo.touches().len();
        let guided = servo.step(&at(0.08)[..points])[0].force.norm();
        assert!(guided > 0.0 && servo.guides(0)[0].is_engaged());
        servo.lift(true);
        assert_eq!(servo.step(&at(0.08)[..points])[0].force, Vector::ZERO);
        assert!(!servo.guides(0)[0].is_engaged());
        // Where it is set down, the force rises from zero: it gave 6 N in the first tick.
        servo.lift(false);
        let mut last = 0.0;
        for tick in 0..1000 {
            let force = servo.step(&at(0.08)[..points])[0].force.norm();
            assert!(force <= last + 0.011 * guided, "{force} N after {last} N in tick {tick}");
            last = force;
        }
        assert!((last - guided).abs() < 1e-9, "{last} N of {guided} N");
    }
}

#[test]
fn a_state_that_is_not_finite_leaves_a_lifted_proxy_where_it_was() {
    for mut servo in [with_points(), with_tool()] {
        servo.lift(true);
        servo.step(&at(0.0));
        let proxy: Point<3> = servo.touches()[0].proxy;
        let nowhere = PointState::at_rest(Vector([f64::NAN; 3]));
        let touch = servo.step(&[nowhere; 2])[0];
        assert_eq!((touch.proxy, touch.force), (proxy, Vector::ZERO));
    }
}

#[test]
fn lift_and_guides_are_handed_off() {
    let device = DeviceProfile { least_damping: 0.064, ..DeviceProfile::unlimited("gentle") };
    let protection = Protection::new(device).with(|s| s.acceptance = Acceptance::Passive);
    let mut servo: Servo = with_points().protected(&protection).unwrap();
    let guide = Guide::to_point(
        Vector([0.0, 0.1, 0.0]),
        GuideOptions { stiffness: 1000.0, damping: 0.0, ..GuideOptions::default() },
    );
    let guides = [guide.unwrap()];
    let (mut control, mut end) = handoff(&servo, HandoffOptions::default());
    control.lift(true);
    let accepted = control.replace_guides(&guides).unwrap();
    end.receive(&mut servo);
    servo.step(&at(0.09));
    end.publish(&servo, &Progress::default());
    assert!(control.latest().unwrap().is_lifted);
    control.lift(false);
    end.receive(&mut servo);
    for _ in 0..1000 {
        servo.step(&at(0.09));
    }
    // As the servo's own guides: 2 b / T = 128 N/m limits the stiffness; over 1 cm that is 1.28 N.
    let force = servo.forces()[0];
    assert!((force - Vector([0.0, 1.28, 0.0])).norm() < 1e-9, "{force:?}");
    assert_eq!(servo.guides(1).len(), 1);
    let softened = servo.guides(0)[0].options().stiffness;
    servo.guide(&guides).unwrap();
    assert_eq!(servo.guides(0)[0].options().stiffness, softened);
    assert_eq!(servo.accepted_guides(), accepted);
    // Several changes before a tick: the last one holds.
    control.replace_guides(&guides).unwrap();
    control.replace_guides(&[]).unwrap();
    end.receive(&mut servo);
    assert!(servo.guides(0).is_empty());
    end.publish(&servo, &Progress::default());
    assert!(!control.latest().unwrap().is_lifted);
}
