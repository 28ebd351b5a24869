// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The code of `docs/guide/coming-from.md`, by its sections: it compiles, and it runs.

use palpate::device::profile_named;
use palpate::field::{Promise, scalar::Scalar};
use palpate::prelude::*;
use palpate::sim::{Hand, SimulatedDevice};

type Outcome = Result<(), Error>;

fn plate() -> Result<Shape<3>, Error> {
    Ok(Shape::cuboid([0.2, 0.02, 0.2])?)
}

fn device() -> Result<SimulatedDevice, Error> {
    let hand = Hand::resting([0.0, 0.05, 0.0])?;
    Ok(SimulatedDevice::new(profile_named("omega")?, vec![hand])?)
}

fn none() -> std::io::Error {
    std::io::Error::other("no contact")
}

#[test]
fn chai3d() -> Outcome {
    use palpate::{
        haptics::{Bodies, Guide, GuideOptions, Probe, Protection, Proxy, ServoOptions},
        safety::{Recovery, WorkspaceMap},
    };
    let (plate, mut device) = (plate()?, device()?);
    let bounds = plate.promise().bounds.ok_or_else(none)?.aabb;
    let bodies = Bodies::new(vec![Body::new(plate, Material::wood())?])?;
    let profile = device.profile().clone();
    let _ = Proxy::new(Probe::default());
    let _ = ServoOptions { probe: Probe::new(0.002)?, ..ServoOptions::default() };
    let _ = Material { stiffness: 800.0, static_friction: 0.5, ..Material::wood() };
    let _ = (Material::magnet(), Material::sandpaper());
    let mut protection = Protection::new(profile.clone());
    protection.settings.recovery = Recovery::OnceOut;
    protection.settings.rise_rate = 20.0;
    let _ = Protection::new(profile).with_map(WorkspaceMap::fitting(bounds, 0.075)?);
    let _ = Shape::sphere(0.05)?;
    let _ = Guide::on_plane([0.0; 3], [0.0, 1.0, 0.0], GuideOptions::default())?;
    assert!(device.profile().max_force > 0.0);
    let mut servo = Servo::for_device(bodies, &device)?;
    let mut states = [palpate::device::PointState::at_rest(Vector::ZERO)];
    device.read(0.0, &mut states)?;
    servo.step(&states);
    device.write(servo.forces())?;
    let _ = servo.buttons();
    assert_eq!(servo.touches()[0].device, servo.touches()[0].proxy);
    assert_eq!(servo.touches()[0].wanted, Vector::ZERO);
    let report = servo.run(&mut device, Seconds(0.01))?;
    assert!(report.lateness.is_some());
    Ok(())
}

#[test]
fn openhaptics() -> Outcome {
    use palpate::{
        haptics::{Guide, GuideOptions},
        safety::WorkspaceMap,
        servo_loop::{Reconnection, ServoThread, ThreadOptions},
    };
    let mut device = device()?;
    let profile = device.profile().clone();
    let plate = plate()?;
    let bounds = plate.promise().bounds.ok_or_else(none)?.aabb;
    let mut servo = Servo::for_device(plate, &device)?;
    let mut states = [palpate::device::PointState::at_rest(Vector::ZERO)];
    device.read(0.0, &mut states)?;
    assert_eq!(states[0].position, Vector([0.0, 0.05, 0.0]));
    servo.step(&states);
    device.write(servo.forces())?;
    assert!(device.profile().max_force > 0.0);
    assert!(device.profile().max_force_rate > 0.0);
    assert!(servo.accepted()[0].stiffness_factor <= 1.0);
    assert_eq!(servo.safety().len(), 1);
    let _ = WorkspaceMap::fitting(bounds, profile.workspace_radius)?;
    let _ = GuideOptions { snap_distance: 0.01, ..GuideOptions::default() };
    let _ = Guide::to_point([0.0; 3], GuideOptions::default())?;
    assert!(servo.events().is_empty());
    let _ = servo.buttons();
    let _: ThreadOptions = ThreadOptions {
        reconnection: Some(Reconnection::every(0.5)?),
        ..ThreadOptions::default()
    };
    let mut thread = ServoThread::start(servo, Box::new(device), ThreadOptions::default())?;
    let _ = thread.control().latest();
    thread.end().report.unless_failed()?;
    Ok(())
}

#[test]
fn haply() -> Outcome {
    use palpate::{
        device::{DeviceProfile, MailboxDevice, PointState},
        safety::WorkspaceMap,
    };
    let profile = DeviceProfile { max_force: 3.0, ..DeviceProfile::unlimited("my stylus") };
    let (mut device, mut mailbox) = MailboxDevice::new(profile, 1)?;
    mailbox.set(&[PointState::at_rest([0.0, 0.049, 0.0])])?;
    let _ = WorkspaceMap::new(Pose::translation([0.0, 0.1, 0.0]), 2.0)?;
    let shape = Shape::sphere(0.05)? & Shape::cuboid([0.1, 0.1, 0.1])?;
    let mut servo = Servo::for_device(shape, &device)?;
    servo.run(&mut device, Seconds(0.01))?.unless_failed()?;
    assert_eq!(mailbox.forces(), [Vector::ZERO]); // the last write
    assert!(servo.touches()[0].proxy.is_finite());
    Ok(())
}

#[test]
fn parry_and_rapier() -> Outcome {
    use palpate::query::{ManifoldSettings, Placed, World};
    use palpate::query::{Ray, WorldSettings};
    let plate = Shape::cuboid([0.2, 0.02, 0.2])?;
    let pose = Pose::translation([0.0, 0.0595, 0.0]);
    let ball = Shape::sphere(0.05)?;
    let (a, b) = (Placed::new(&plate, Pose::identity()), Placed::new(&ball, pose));
    let _ = Placed::new(&plate, pose);
    let mut query = Query::new();
    assert!(query.separation(a, b)?.lower < 0.0);
    assert_eq!(query.overlap(a, b)?.is_hit(), Some(true));
    let _ = ManifoldSettings { margin: 0.001, ..ManifoldSettings::of_size(0.1) };
    let contact = query.manifold(a, b)?.contacts[0];
    assert_eq!(contact.id, 0);
    let (shape, ray) = (ball.clone(), Ray::new([0.0, 1.0, 0.0], [0.0, -1.0, 0.0], 2.0)?);
    assert!(query.cast_ray(&shape, &ray)?.best.is_some());
    let mut world = World::new(WorldSettings::of_size(0.1))?;
    world.add(plate.clone(), Pose::identity())?;
    world.add(ball.clone(), pose)?;
    assert_eq!(world.step().len(), 1);
    Ok(())
}

#[test]
fn box2d() -> Outcome {
    use palpate::query::Placed;
    use palpate::query::{Limits, PairWorkspace, Tolerance, Track};
    let mut track =
        Track::new(Shape::rectangle([0.2, 0.1])?.offset(0.01)?, Shape::circle(0.1)?);
    let poses = [Pose::identity(), Pose::translation([0.0, 0.155])];
    let (limits, mut workspace) = (Limits::new(1e-4), PairWorkspace::new());
    let answer = track.separation(poses, &limits, &mut workspace)?;
    let [a, b] = track.shapes();
    let placed = [Placed::new(a, poses[0]), Placed::new(b, poses[1])];
    let contact = answer.best.contact(placed[0], placed[1]).ok_or_else(none)?;
    assert!(answer.upper < 0.0 && contact.gap < 0.0);
    let _: Query<2> = Query::new().with_tolerance(Tolerance::Relative(1e-4));
    Ok(())
}

#[test]
fn mujoco() -> Outcome {
    use palpate::query::Stop;
    use palpate::{field::Kernel, query::ManifoldSettings};

    #[derive(Clone, Debug)]
    struct MyKernel {
        radius: f64,
    }

    impl Kernel<3> for MyKernel {
        fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
            p.norm() - S::constant(self.radius)
        }

        fn promise(&self) -> Promise<3> {
            Promise::lipschitz(None, 1.0)
        }
    }

    let a = Shape::from_kernel(MyKernel { radius: 0.5 });
    let b = Shape::sphere(0.1)?.translated([0.0, 0.7, 0.0])?;
    let mut query = Query::new();
    let answer = query.separation(&a, &b)?;
    assert_eq!(answer.stop, Stop::Converged);
    let contact = answer.best.contact(&a, &b).ok_or_else(none)?;
    assert!(contact.normal[1] > 0.9);
    let _ = ManifoldSettings { margin: 0.001, ..ManifoldSettings::of_size(0.1) };
    Ok(())
}

#[test]
fn fogleman_sdf() -> Outcome {
    use palpate::field::operator::Profile;
    let f = Shape::sphere(1.0)?;
    let g = Shape::cuboid([1.0, 1.0, 1.0])?.translated([0.8, 0.0, 0.0])?;
    let _ = &f - &g;
    let _ = f.clone().translated([0.0, 0.1, 0.0])?;
    let _ = f.clone().offset(0.1)?;
    let _ = Shape::smooth_union([f, g.clone()], Profile::Quadratic, 0.025)?;
    let f = g;
    let _ = f.twisted(1.5)?;
    Ok(())
}

/// The code of the page without its spaces, cell by cell.
fn cells(page: &str) -> impl Iterator<Item = String> {
    let code = |row: &str| {
        let last = row.trim_end_matches('|').rsplit('|').next().unwrap_or_default().to_owned();
        let quoted: Vec<_> = last.split('`').skip(1).step_by(2).map(bare).collect();
        quoted
    };
    page.lines().filter(|line| line.starts_with("| ")).flat_map(code)
}

/// The page up to this heading, and from it on.
fn parts() -> (&'static str, &'static str) {
    let page = include_str!("../../../../docs/guide/coming-from.md");
    let proofs = "## What palpate does beside";
    let others = "## parry and rapier";
    let (start, rest) = page.split_once(proofs).unwrap_or_default();
    let (claims, others) = rest.split_once(others).unwrap_or_default();
    assert!(start.contains("## Haply") && others.contains("## MuJoCo"));
    (page, claims)
}

#[test]
fn what_shows_a_claim_is_there() {
    let (_, claims) = parts();
    let proofs = cells(claims).filter(|cell| !cell.starts_with("palpatedevices"));
    let proofs: Vec<_> = proofs.collect();
    assert!(proofs.len() > 15, "{proofs:?}");
    let crates = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    let missing: Vec<_> = proofs.iter().filter(|proof| !crates.join(proof).is_file()).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

/// Without spaces, and without what a borrow, a clone or the end of a list adds.
fn bare(code: &str) -> String {
    let code = code.replace(".clone()", "");
    let code: String = code.chars().filter(|c| !c.is_whitespace() && *c != '&').collect();
    code.replace(",}", "}")
}

#[test]
fn every_line_of_the_page_is_tried_here() {
    let here = bare(include_str!("coming_from.rs"));
    let (page, claims) = parts();
    let page = page.replace(claims, "");
    let imports = page
        .lines()
        .filter(|line| line.starts_with("`use "))
        .map(|line| bare(line.trim_matches('`')));
    let code = cells(&page).filter(|cell| cell.contains(['(', '.'])).chain(imports);
    let code: Vec<_> = code.collect();
    assert!(code.len() > 40, "{code:#?}");
    let missing: Vec<_> = code.iter().filter(|code| !here.contains(code.as_str())).collect();
    assert!(missing.is_empty(), "{missing:#?}");
}
