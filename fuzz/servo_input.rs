// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What must hold for a servo, whatever a device, a physics engine and a user send it.

use std::time::Duration;

use arbitrary::{Result, Unstructured};
use palpate_device::{DeviceProfile, PointState};
use palpate_field::kernel::{Ball, Cuboid, HalfSpace};
use palpate_field::{Point, Pose, Rotation, Shape, SpaceShape, Vector};
use palpate_haptics::{
    Bodies, Body, Guide, GuideOptions, HandoffOptions, Impact, Layer, Magnet, Material,
    PopThrough, Probe, Protection, Renderer, Servo, ServoOptions, Surface, Texture,
    TextureKind, Touch, Unprotected, handoff,
};
use palpate_safety::Recovery;

/// Numbers that break what is not ready for them.
const JUNK: [f64; 16] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    1e300,
    -1e300,
    f64::MAX,
    5e-324,
    -1e-310,
    f64::MIN_POSITIVE,
    0.0,
    -0.0,
    1e15,
    -1.000_000_1e15,
    1e150,
    1e8,
    -1e3,
];

/// How deep a proxy may rest in a body, as a part of the size of the scene or of how far from
/// the origin something was in this tick and the one before: double precision leaves no more.
const INSIDE: f64 = 1e-9;

/// Ticks of a case at most.
const TICKS: usize = 96;

/// A scene in the plane and in space.
pub trait Dimension<const D: usize> {
    fn pose(u: &mut Unstructured<'_>) -> Result<Pose<3>>;
    fn special(u: &mut Unstructured<'_>) -> Result<Option<Shape<D>>>;
}

struct Here;

impl Dimension<2> for Here {
    fn pose(u: &mut Unstructured<'_>) -> Result<Pose<3>> {
        let turn = Rotation::from_angle(4.0 * unit(u)?).unwrap_or(Rotation::identity());
        Ok(Pose::new(turn, vector::<2>(u)? * 0.1).in_space())
    }
    fn special(u: &mut Unstructured<'_>) -> Result<Option<Shape<2>>> {
        Ok(cuboid([0.1, 0.01]).bent(20.0 * unit(u)?).ok())
    }
}

impl Dimension<3> for Here {
    fn pose(u: &mut Unstructured<'_>) -> Result<Pose<3>> {
        let turn = Rotation::from_axis_angle(vector(u)?, 4.0 * unit(u)?);
        Ok(Pose::new(turn.unwrap_or(Rotation::identity()), vector(u)? * 0.1))
    }
    fn special(u: &mut Unstructured<'_>) -> Result<Option<Shape<3>>> {
        Ok(cuboid([0.01, 0.1, 0.04]).twisted(20.0 * unit(u)?).ok())
    }
}

/// Plays what `data` says, and checks every tick of it.
///
/// # Panics
///
/// If the servo does, or breaks a promise.
pub fn check(data: &[u8]) {
    let mut u = Unstructured::new(data);
    let in_plane = u.arbitrary().unwrap_or(false);
    // Where the data ends, the case ends.
    let _ = if in_plane { play::<2>(&mut u) } else { play::<3>(&mut u) };
}

/// A number in [−1, 1].
fn unit(u: &mut Unstructured<'_>) -> Result<f64> {
    Ok(f64::from(u.int_in_range(-10_000..=10_000)?) * 1e-4)
}

/// A vector along the first D axes of space.
fn spatial<const D: usize>(u: &mut Unstructured<'_>) -> Result<Vector<f64, 3>> {
    Ok(vector::<D>(u)?.in_space())
}

fn vector<const D: usize>(u: &mut Unstructured<'_>) -> Result<Vector<f64, D>> {
    let mut v = [0.0; D];
    for x in &mut v {
        *x = unit(u)?;
    }
    Ok(Vector(v))
}

fn junk<const D: usize>(u: &mut Unstructured<'_>) -> Result<Vector<f64, 3>> {
    let mut v = spatial::<D>(u)? * 0.1;
    for _ in 0..u.int_in_range(0..=D)? {
        v[u.choose_index(D)?] = *u.choose(&JUNK)?;
    }
    Ok(v)
}

fn ball<const D: usize>(radius: f64) -> Shape<D> {
    Shape::from_kernel(Ball::new(radius).expect("a positive radius"))
}

fn cuboid<const D: usize>(edges: [f64; D]) -> Shape<D> {
    Shape::from_kernel(Cuboid::new(Vector(edges)).expect("positive edges"))
}

fn shape<const D: usize>(u: &mut Unstructured<'_>) -> Result<Shape<D>>
where
    Here: Dimension<D>,
{
    let size = 0.01 + 0.04 * unit(u)?.abs();
    let mut edges = [2.0 * size; D];
    edges[0] = [1e-4, 0.004, size][u.choose_index(3)?];
    let made = match u.choose_index(8)? {
        0 => Some(ball(size)),
        1 => Some(cuboid(edges)),
        2 => HalfSpace::new(Vector::unit(u.choose_index(D)?), 0.05 * unit(u)?)
            .ok()
            .map(Shape::from_kernel),
        3 => ball(size).shell(1e-4).ok(),
        4 => cuboid([2.0 * size; D]).difference([ball(1.2 * size)]).ok(),
        5 => {
            let mut factors = [1.0; D];
            factors[1] = 0.05;
            ball(size).stretched(factors).ok()
        }
        6 => Shape::union([ball(size), cuboid(edges)]).ok(),
        _ => Here::special(u)?,
    };
    Ok(made.unwrap_or_else(|| ball(size)))
}

/// A material, degenerate or not; `pops` if a layer may give way.
fn material(u: &mut Unstructured<'_>, pops: bool) -> Result<Material> {
    let mut material = Material {
        stiffness: *u.choose(&[0.0, 1e-9, 500.0, 2000.0, 1e9])?,
        damping: *u.choose(&[0.0, 1.0, 1e6])?,
        static_friction: *u.choose(&[0.0, 0.3, 10.0])?,
        dynamic_friction: *u.choose(&[0.0, 0.2, 10.0])?,
        viscosity: *u.choose(&[0.0, 0.5, 1e6])?,
        ..Material::default()
    };
    if u.ratio(1, 4)? {
        let distance = *u.choose(&[1e-9, 0.005, 100.0])?;
        material.magnet = Some(Magnet { description: None, force: 2.0, distance });
    }
    let pop = PopThrough { description: None, force: 1.0, distance: 0.001 };
    if pops && u.ratio(1, 2)? {
        material.pop_through = Some(pop.clone());
    }
    for i in 0..u.int_in_range(0..=3)? {
        material.layers.push(Layer {
            description: None,
            depth: 0.001 + 1e-9 * f64::from(i),
            stiffness: Some(*u.choose(&[0.0, 100.0, 1e6])?),
            damping: None,
            static_friction: Some(*u.choose(&[0.0, 1.0])?),
            dynamic_friction: None,
            viscosity: None,
            pop_through: (pops && u.arbitrary()?).then(|| pop.clone()),
        });
    }
    if u.ratio(1, 4)? {
        material.texture = Some(Texture {
            description: None,
            kind: if u.arbitrary()? { TextureKind::Height } else { TextureKind::Displacement },
            amplitude: 1e-4,
            wavelength: *u.choose(&[1e-4, 0.003])?,
            direction: None,
        });
    }
    if u.ratio(1, 4)? {
        let (amplitude, frequency, decay) = (2.0, *u.choose(&[1e-3, 100.0, 1e6])?, 30.0);
        material.impact = Some(Impact { description: None, amplitude, frequency, decay });
    }
    Ok(material)
}

fn bodies<const D: usize>(u: &mut Unstructured<'_>, pops: bool) -> Result<Bodies>
where
    Here: Dimension<D>,
    SpaceShape: From<Shape<D>>,
{
    let mut bodies = Vec::new();
    for _ in 0..u.int_in_range(1..=8)? {
        let surface = Surface::new(&material(u, pops)?).expect("numbers that are allowed");
        let Ok(body) = Body::new(shape::<D>(u)?, surface) else { continue };
        bodies.push(body.at(<Here as Dimension<D>>::pose(u)?).expect("a finite pose"));
    }
    Ok(Bodies::new(bodies).unwrap_or_else(|_| Bodies::from(SpaceShape::from(ball::<D>(0.05)))))
}

/// A servo with or without a safety chain.
enum AnyServo {
    Protected(Box<Servo>),
    Unprotected(Box<Servo<Unprotected>>),
}

/// Does the same with either kind of servo.
macro_rules! either {
    ($any:expr, $servo:ident => $does:expr) => {
        match $any {
            AnyServo::Protected($servo) => $does,
            AnyServo::Unprotected($servo) => $does,
        }
    };
}

impl AnyServo {
    fn seen(&self) -> &Renderer {
        either!(self, servo => servo)
    }

    fn swap_bodies(&mut self, bodies: Bodies) {
        match self {
            Self::Protected(servo) => {
                if let Ok(mut bodies) = servo.accept(bodies) {
                    assert_eq!(servo.replace_bodies(&mut bodies), Ok(()));
                }
            }
            Self::Unprotected(servo) => drop(servo.replace_bodies(bodies)),
        }
    }
}

fn servo<const D: usize>(u: &mut Unstructured<'_>, pops: bool) -> Result<AnyServo>
where
    Here: Dimension<D>,
    SpaceShape: From<Shape<D>>,
{
    let probe = Probe::new(*u.choose(&[0.0, 1e-9, 0.0005, 0.002, 0.01])?);
    let probe =
        probe.and_then(|probe| probe.with_budget([4, 9, 64][u.choose_index(3).unwrap_or(0)]));
    let options = ServoOptions {
        probe: probe.expect("a radius and a budget"),
        max_force: *u.choose(&[3.3, 1e-3, f64::INFINITY])?,
        rise_time: *u.choose(&[1e-9, 0.1])?,
        rate: *u.choose(&[1000.0, 10.0, 1e5])?,
    };
    let points = *u.choose(&[1, 2, 5, 24])?;
    let mut servo = Servo::new(bodies::<D>(u, pops)?, points, options).expect("options");
    if u.ratio(1, 3)? {
        let options = GuideOptions::default();
        if let Ok(guide) = Guide::to_point(spatial::<D>(u)? * 0.05, options) {
            servo.guide(&[guide]);
        }
    }
    if u.arbitrary()? {
        let profile = DeviceProfile {
            max_force: *u.choose(&[3.3, 12.0])?,
            continuous_force: 1.0,
            max_force_rate: *u.choose(&[f64::INFINITY, 500.0])?,
            mass: 0.05,
            least_damping: 0.5,
            friction: 0.2,
            encoder_step: *u.choose(&[0.0, 2e-5])?,
            ..DeviceProfile::unlimited("any")
        };
        let recovery = *u.choose(&[Recovery::Rise, Recovery::OnceOut])?;
        let protection = Protection::new(profile).with(|s| s.recovery = recovery);
        let servo = servo.protected(&protection).expect("a profile");
        return Ok(AnyServo::Protected(Box::new(servo)));
    }
    Ok(AnyServo::Unprotected(Box::new(servo)))
}

fn play<const D: usize>(u: &mut Unstructured<'_>) -> Result<()>
where
    Here: Dimension<D>,
    SpaceShape: From<Shape<D>>,
{
    let pops = u.ratio(1, 4)?;
    let mut servo = servo::<D>(u, pops)?;
    let points = servo.seen().touches().len();
    let mut hand: Vec<Point<3>> = vec![spatial::<D>(u)? * 0.1; points];
    let mut before = 0.0;
    for _ in 0..TICKS {
        if u.is_empty() {
            break;
        }
        act::<D>(u, &mut servo, pops)?;
        let mut states = Vec::new();
        for place in &mut hand {
            *place = match u.choose_index(24)? {
                0 => spatial::<D>(u)? * 0.1,
                1 => *place,
                _ => *place + spatial::<D>(u)? * 0.004,
            };
            let position = if u.ratio(1, 32)? { junk::<D>(u)? } else { *place };
            let velocity = if u.ratio(1, 32)? { junk::<D>(u)? } else { spatial::<D>(u)? * 0.5 };
            states.push(PointState { position, velocity });
        }
        if u.ratio(1, 32)? {
            // Fewer states than points, or far more.
            states.resize([0, 1, 3000][u.choose_index(3)?], PointState::at_rest(Vector::ZERO));
        }
        either!(&mut servo, servo => drop(servo.step(&states)));
        let extent = extent(servo.seen());
        promises_hold(servo.seen(), extent.max(before), pops);
        before = extent;
    }
    Ok(())
}

/// What else may happen between two ticks.
fn act<const D: usize>(u: &mut Unstructured<'_>, any: &mut AnyServo, pops: bool) -> Result<()>
where
    Here: Dimension<D>,
    SpaceShape: From<Shape<D>>,
{
    let body = u.choose_index(10)?;
    match u.choose_index(24)? {
        0..4 => {
            let pose = <Here as Dimension<D>>::pose(u)?;
            either!(any, servo => servo.set_pose(body, pose));
        }
        4..8 => {
            // A small motion.
            let bodies = any.seen().bodies().bodies();
            if let Some(at) = bodies.get(body).map(|b| *b.world_from_body()) {
                let translation = at.translation + spatial::<D>(u)? * 0.003;
                either!(any, servo => servo.set_pose(body, Pose { translation, ..at }));
            }
        }
        8 => {
            let pose = Pose { translation: junk::<D>(u)?, ..<Here as Dimension<D>>::pose(u)? };
            either!(any, servo => servo.set_pose(body, pose));
        }
        9 => any.swap_bodies(bodies::<D>(u, pops)?),
        10 => {
            let late = f64::from(u.int_in_range(0..=100_u8)?) * 1e-3;
            either!(any, servo => servo.set_late(late));
        }
        11 => {
            let is_stopped = u.arbitrary()?;
            either!(any, servo => servo.stop(is_stopped));
        }
        12 => {
            // The chain of a protected servo has the limit of its device already.
            if let AnyServo::Unprotected(servo) = any {
                servo.limit_force(*u.choose(&JUNK)?);
            }
        }
        13 | 14 => {
            // A physics engine: the body goes there over a time, or jumps.
            let pose = <Here as Dimension<D>>::pose(u)?;
            let over = Duration::from_millis(*u.choose(&[0, 5, 16, 100])?);
            either!(any, servo => {
                let (mut control, mut end) = handoff(servo, HandoffOptions::default());
                let is_body = body < servo.bodies().bodies().len();
                assert_eq!(control.set_poses(&[(body, pose)], over).is_ok(), is_body);
                end.receive(servo);
            });
        }
        _ => {}
    }
    Ok(())
}

/// The length of a vector whose square may be too large.
fn length(v: Vector<f64, 3>) -> f64 {
    let largest = v.0.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if largest > 0.0 {
        largest * v.0.map(|x| (x / largest).powi(2)).iter().sum::<f64>().sqrt()
    } else {
        0.0
    }
}

/// How far from the origin anything is [m].
fn extent(servo: &Renderer) -> f64 {
    let bodies = servo.bodies().bodies().iter().map(|b| b.world_from_body().translation.norm());
    let touches = servo.touches().iter();
    let touches = touches.flat_map(|t| [t.device.norm(), t.proxy.norm()]);
    let finite = bodies.chain(touches).filter(|x| x.is_finite());
    finite.fold(0.2, f64::max)
}

fn promises_hold(servo: &Renderer, farthest: f64, pops: bool) {
    // Squares of forces smaller than this vanish.
    let most = servo.options().max_force * (1.0 + 1e-12) + 1e-150;
    for (point, (touch, force)) in (0..).zip(servo.touches().iter().zip(servo.forces())) {
        assert!(touch.force.is_finite() && length(touch.force) <= most, "{touch:?}");
        assert!(force.is_finite() && length(*force) <= most, "{touch:?} wrote {force:?}");
        assert!(touch.proxy.is_finite() || !touch.device.is_finite(), "{touch:?}");
        assert!(touch.normal.is_finite() && touch.velocity.is_finite(), "{touch:?}");
        if touch.contact && !pops {
            is_outside(servo, (point, touch), farthest);
        }
    }
    assert!(servo.reactions().iter().all(|r| r.force.is_finite()), "{:?}", servo.reactions());
    assert!(servo.events().len() <= 12 * servo.touches().len());
    assert!(servo.touches().iter().all(|t| (t.body as usize) < servo.bodies().bodies().len()));
}

/// No body holds the proxy's ball, but for those that moved and left it no room.
fn is_outside(servo: &Renderer, (point, touch): (u32, &Touch), farthest: f64) {
    let yielding: Vec<_> = servo.squeezed_by(point).collect();
    let size = |body: &Body| body.bounds().map_or(0.0, |b| b.ball.radius);
    let bodies = servo.bodies().bodies();
    let tolerance = INSIDE * bodies.iter().map(size).fold(farthest, f64::max);
    let firm = (0..).zip(bodies).filter(|(index, _)| !yielding.contains(index));
    for (index, body) in firm {
        let in_body = body.world_from_body().inverse().transform_point(touch.proxy);
        // What has bounds is not closer than its ball is, whatever its field says.
        let above = body.bounds().map_or(f64::NEG_INFINITY, |bounds| {
            (in_body - bounds.ball.centre).norm() - bounds.ball.radius
        });
        let gap = body.shape().distance(in_body).max(above) - servo.options().probe.radius();
        assert!(gap >= -tolerance, "{gap} m in body {index} of {} at {touch:?}", bodies.len());
    }
}
