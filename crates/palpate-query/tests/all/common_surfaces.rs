// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies made with the same shape: a pin and the hole that an offset of it leaves.

use arbitrary::Unstructured;
use palpate_field::{CustomField, Point, Pose, Promise, Shape, ShapeError, Vector};
use palpate_query::{Limits, PairWorkspace, Placed, Stop, separation};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::cases;
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::Solid;

const CLEARANCE: f64 = 1e-4;

/// A bolt with a metric thread and a nut around it, with room to turn.
fn bolt_and_nut() -> Result<[Shape<3>; 2], ShapeError> {
    let pitch = 0.005;
    let depth = 5.0 / 8.0 * 3.0_f64.sqrt() / 2.0 * pitch;
    let profile = [pitch / 8.0, pitch / 4.0, depth];
    let thread = Shape::screw_thread(0.015, 0.06, pitch, 1, profile)?;
    let head = Shape::hexagonal_prism(0.029, 0.02)?.translated([0.0, -0.04, 0.0])?;
    let nut = Shape::hexagonal_prism(0.029, 0.025)? - thread.clone().offset(CLEARANCE)?;
    Ok([head | (thread & Shape::rounded_cylinder(0.015, 0.06, 0.003)?), nut])
}

#[test]
fn a_nut_is_proven_free_of_its_bolt() -> Result<(), Box<dyn std::error::Error>> {
    let [bolt, nut] = bolt_and_nut()?;
    let limits = Limits::new(1e-6).with_budget(50_000);
    let answer = separation(&bolt, &nut, &limits, &mut PairWorkspace::new())?;
    assert_eq!(answer.stop, Stop::Converged);
    assert!(answer.lower > CLEARANCE - 1.1e-6 && answer.upper < CLEARANCE + 1e-9);
    // Somewhat aside, what is proven is less by no more than the motion.
    let aside = Placed::new(&nut, Pose::translation(Vector([2e-5, -1e-5, 0.0])));
    let limits = limits.with_tolerance(3e-5);
    let answer = separation(&bolt, aside, &limits, &mut PairWorkspace::new())?;
    assert_eq!(answer.stop, Stop::Converged, "{answer:?}");
    assert!(answer.lower > 0.0 && answer.upper < CLEARANCE + 1e-9, "{answer:?}");
    Ok(())
}

/// A shape of which a search sees the values alone.
#[derive(Debug)]
struct Disguised<const D: usize>(Shape<D>);

impl<const D: usize> CustomField<D> for Disguised<D> {
    fn distance(&self, p: Point<D>) -> f64 {
        self.0.distance(p)
    }

    fn distance_gradient(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        self.0.distance_gradient(p)
    }

    fn promise(&self) -> &Promise<D> {
        self.0.promise()
    }
}

/// A body, and what an offset of a shape in it leaves of another.
fn pair<const D: usize>(
    u: &mut Unstructured<'_>,
    seed: usize,
) -> arbitrary::Result<Option<[Shape<D>; 2]>>
where
    Space: Solid<D> + Turn<D>,
{
    let Some([pin, other]) = draw::two::<D>(u, 1 + seed % 2)? else { return Ok(None) };
    let pose = draw::pose::<D>(u)?;
    let distance = draw::within(u, -0.01, 0.05)? * draw::size(&pin);
    let made = || -> Result<[Shape<D>; 2], ShapeError> {
        let hole = pin.clone().offset(distance)?;
        let moved = other.clone().placed(&pose)?;
        let second = match seed / 2 % 3 {
            0 => &other - &hole,
            1 => (&other - &hole) & moved.clone(),
            _ => (&other - &hole) | moved.clone(),
        };
        let first = match seed / 6 % 3 {
            0 => pin.clone(),
            1 => &pin & &moved,
            _ => (&pin - &moved) | other.clone(),
        };
        Ok([first, second])
    };
    Ok(made().ok())
}

/// No bound is above what a search finds that knows nothing of the shapes.
fn bounds_hold<const D: usize>(count: u64)
where
    Space: Solid<D> + Turn<D>,
{
    let mut workspace = PairWorkspace::new();
    let (mut asked, mut long) = (0, 0);
    cases::numbered(count, |seed, u| {
        let Some([first, second]) = pair::<D>(u, seed)? else { return Ok(Ok(())) };
        let size = draw::size(&first);
        let limits = Limits::new(1e-5 * size).with_budget(12_000);
        let step = draw::vector::<D>(u)? * (1e-3 * size);
        let there = if u.arbitrary()? { Pose::translation(step) } else { Pose::identity() };
        let placed = Placed::new(&second, there);
        let Ok(answer) = separation(&first, placed, &limits, &mut workspace) else {
            return Ok(Ok(()));
        };
        let [a, b] = [first.clone(), second.clone()].map(|s| Shape::custom(Disguised(s)));
        let placed = Placed::new(&b, there);
        let Ok(blind) = separation(&a, placed, &limits, &mut workspace) else {
            return Ok(Err("only the disguised bodies are refused".into()));
        };
        asked += 1;
        long += usize::from(answer.evaluations > 5000);
        Ok(if answer.lower <= blind.upper && blind.lower <= answer.upper {
            Ok(())
        } else {
            Err(format!("{answer:?} and {blind:?}: {first:?} {second:?} at {there:?}"))
        })
    });
    let count = cases::count(count);
    assert!(asked * 3 > count && long * 20 > asked as usize, "{long} of {asked} were long");
}

#[test]
fn bounds_hold_in_space() {
    bounds_hold::<3>(300);
}

#[test]
fn bounds_hold_in_the_plane() {
    bounds_hold::<2>(300);
}
