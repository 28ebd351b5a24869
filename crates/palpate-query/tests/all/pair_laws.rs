// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What separations of any two bodies obey, on random trees: motions, scales, offsets,
//! true distances, and searches that may hardly look.

use arbitrary::Unstructured;
use palpate_field::{Point, Pose, Shape};
use palpate_query::{
    Certified, Limits, Nearest, PairWorkspace, Placed, QueryError, Track, overlap, penetration,
    separation,
};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::cases;
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::Solid;

/// Points of each body between which distances are measured.
const POINTS: usize = 12;

/// Steps along a line between two bodies.
const STEPS: u32 = 100;

/// Motions of a track.
const MOTIONS: usize = 6;

type Answer<const D: usize> = Certified<Nearest<D>>;

/// What a law finds wrong.
type Verdict = Result<(), String>;

/// A pair, its separation, and how that was asked.
struct Case<'w, const D: usize> {
    bodies: [Shape<D>; 2],
    size: f64,
    limits: Limits,
    answer: Answer<D>,
    workspace: &'w mut PairWorkspace<D>,
}

impl<const D: usize> Case<'_, D> {
    /// The separation of other bodies, under the same limits times `scale`.
    fn of<'a>(
        &mut self,
        a: impl Into<Placed<'a, D>>,
        b: impl Into<Placed<'a, D>>,
        scale: f64,
    ) -> Result<Answer<D>, String> {
        let limits = self.limits.with_tolerance(scale * self.limits.tolerance);
        separation(a, b, &limits, self.workspace).map_err(|error| error.to_string())
    }

    /// That `other` is the separation plus something from `least` to `most`, times
    /// `scale`.
    fn differs(
        &self,
        what: &str,
        other: &Answer<D>,
        [least, most]: [f64; 2],
        scale: f64,
    ) -> Verdict {
        let [lower, upper] =
            [self.answer.lower + least, self.answer.upper + most].map(|bound| scale * bound);
        // The last bits of these products and sums.
        let bits = 4.0 * f64::EPSILON * scale * (self.answer.lower.abs() + least.abs());
        if lower - bits <= other.upper && other.lower <= upper + bits {
            return Ok(());
        }
        let [a, b] = &self.bodies;
        Err(format!("{what}: {other:?} after {:?}: {a:?} {b:?}", self.answer))
    }
}

/// Runs a law on pairs of random trees.
fn on_trees<const D: usize>(
    count: u64,
    law: impl Fn(&mut Case<'_, D>, &mut Unstructured<'_>) -> arbitrary::Result<Verdict>,
) where
    Space: Solid<D> + Turn<D>,
{
    let mut workspace = PairWorkspace::new();
    let mut asked = 0;
    cases::numbered(count, |seed, u| {
        let Some(bodies) = draw::two::<D>(u, 1 + seed % 3)? else { return Ok(Ok(())) };
        let [a, b] = &bodies;
        let size = draw::size(a);
        let limits = Limits::new(0.02 * size).with_budget(200_000);
        let Ok(answer) = separation(a, b, &limits, &mut workspace) else {
            return Ok(Err("bounded bodies are refused".into()));
        };
        asked += 1;
        law(&mut Case { bodies, size, limits, answer, workspace: &mut workspace }, u)
    });
    let count = cases::count(count);
    assert!(asked * 2 > count, "{asked} of {count} pairs were bounded");
}

/// A law in both dimensions.
macro_rules! laws {
    ($($(#[$doc:meta])* $law:ident as $space:ident and $plane:ident, $count:literal times;)*) => {$(
        $(#[$doc])*
        #[test]
        fn $space() {
            on_trees::<3>($count, $law);
        }

        $(#[$doc])*
        #[test]
        fn $plane() {
            on_trees::<2>($count, $law);
        }
    )*};
}

laws! {
    moved as bodies_in_space_that_move_together_stay_as_far_apart
        and bodies_in_the_plane_that_move_together_stay_as_far_apart, 500 times;
    scaled as separations_in_space_scale and separations_in_the_plane_scale, 500 times;
    offset as growing_bodies_in_space_lose_twice_as_much
        and growing_bodies_in_the_plane_lose_twice_as_much, 500 times;
    sampled as separations_in_space_are_no_more_than_distances
        and separations_in_the_plane_are_no_more_than_distances, 700 times;
    hasty as ten_evaluations_in_space_prove_little_and_nothing_wrong
        and ten_evaluations_in_the_plane_prove_little_and_nothing_wrong, 700 times;
    tracked as what_is_kept_of_bodies_that_move_in_space_stays_true
        and what_is_kept_of_bodies_that_move_in_the_plane_stays_true, 250 times;
    separated as penetrations_separate_bodies_in_space
        and penetrations_separate_bodies_in_the_plane, 30 times;
}

/// Posed, the bodies are as far apart as before. If the motion is built into the shapes,
/// their boxes are others, which tells more or less of what is no exact distance; but they
/// are apart if they were, and else overlap by as much.
fn moved<const D: usize>(
    case: &mut Case<'_, D>,
    u: &mut Unstructured<'_>,
) -> arbitrary::Result<Verdict>
where
    Space: Turn<D>,
{
    let pose = draw::pose(u)?;
    let [a, b] = case.bodies.clone();
    Ok((|| {
        let posed = case.of(Placed::new(&a, pose), Placed::new(&b, pose), 1.0)?;
        case.differs("posed", &posed, [0.0, 0.0], 1.0)?;
        let build = |shape: Shape<D>| shape.placed(&pose).map_err(|error| error.to_string());
        let [a, b] = [build(a)?, build(b)?];
        let built = case.of(&a, &b, 1.0)?;
        // Apart they stay, and overlapping: boxes matter outside them alone.
        let least = if case.answer.lower > 0.0 { -case.answer.lower } else { 0.0 };
        let most = if case.answer.upper > 0.0 { f64::INFINITY } else { 0.0 };
        let range = [least, most];
        case.differs("built", &built, range, 1.0)
    })())
}

/// Scaled, from a thousandth to a thousand times, separations are as much larger.
fn scaled<const D: usize>(
    case: &mut Case<'_, D>,
    u: &mut Unstructured<'_>,
) -> arbitrary::Result<Verdict> {
    let factor = 10.0_f64.powf(draw::within(u, -3.0, 3.0)?);
    let [a, b] = case.bodies.clone();
    let (Ok(a), Ok(b)) = (a.scaled(factor), b.scaled(factor)) else { return Ok(Ok(())) };
    Ok((|| {
        let other = case.of(&a, &b, factor)?;
        case.differs("scaled", &other, [0.0, 0.0], factor)
    })())
}

/// Grown by r, both `g` are less by r where they are distances: a separation of such
/// bodies is less by 2·r. Of others `f/L` is less by r/L, and the distance to a box whose
/// faces move by r by as much as its corners do, √D·r.
fn offset<const D: usize>(
    case: &mut Case<'_, D>,
    u: &mut Unstructured<'_>,
) -> arbitrary::Result<Verdict> {
    let [a, b] = case.bodies.clone();
    let r = case.size * 10.0_f64.powf(draw::within(u, -4.0, -0.5)?);
    let are_distances = [&a, &b].iter().all(|shape| {
        let promise = shape.promise();
        promise.lipschitz <= 1.0 && promise.above_bounds
    });
    let (Ok(a), Ok(b)) = (a.offset(r), b.offset(r)) else { return Ok(Ok(())) };
    let most = if are_distances { -2.0 * r } else { 0.0 };
    let least = if are_distances { most } else { -2.0 * r * (D as f64).sqrt() };
    Ok((|| {
        let other = case.of(&a, &b, 1.0)?;
        case.differs("grown", &other, [least, most], 1.0)
    })())
}

/// A separation is no more than the distance between any two points of the bodies.
fn sampled<const D: usize>(
    case: &mut Case<'_, D>,
    u: &mut Unstructured<'_>,
) -> arbitrary::Result<Verdict> {
    let lower = case.answer.lower;
    if lower <= 0.0 {
        return Ok(Ok(()));
    }
    let [a, b] = &case.bodies;
    let points = [points_of(a, u)?, points_of(b, u)?];
    for p in &points[0] {
        for q in &points[1] {
            // The last point of the one and the first of the other on the line.
            let at = |i: u32| *p + (*q - *p) * (f64::from(i) / f64::from(STEPS));
            let first = (0..=STEPS).rev().map(at).find(|x| is_in(a, *x)).unwrap_or(*p);
            let last = (0..=STEPS).map(at).find(|x| is_in(b, *x)).unwrap_or(*q);
            let distance = (last - first).norm();
            if distance < lower {
                let found = format!("{first:?} and {last:?} are {distance} m apart");
                return Ok(Err(format!("{found}: {:?}: {a:?} {b:?}", case.answer)));
            }
        }
    }
    Ok(Ok(()))
}

/// `true` if a point is in the body whatever the rounding of the field.
fn is_in<const D: usize>(shape: &Shape<D>, p: Point<D>) -> bool {
    shape.distance(p) <= -shape.promise().rounding.within(p.norm())
}

/// Points of a body, on its surface or close by.
fn points_of<const D: usize>(
    shape: &Shape<D>,
    u: &mut Unstructured<'_>,
) -> arbitrary::Result<Vec<Point<D>>> {
    let mut points = Vec::new();
    for _ in 0..POINTS {
        let p = draw::point(u, shape)?;
        let inwards = |p: Point<D>| {
            let (f, gradient) = shape.distance_gradient(p);
            p - gradient * (f + 4.0 * shape.promise().rounding.within(p.norm()))
        };
        let near = shape.surface_point(p).map(inwards);
        points.extend([Some(p), near].into_iter().flatten().filter(|p| is_in(shape, *p)));
    }
    Ok(points)
}

/// Ten evaluations, or none, bound the same separation and the same sign.
fn hasty<const D: usize>(
    case: &mut Case<'_, D>,
    u: &mut Unstructured<'_>,
) -> arbitrary::Result<Verdict> {
    let [a, b] = case.bodies.clone();
    let budget = *u.choose(&[0, 10, 300])?;
    let limits = Limits::new(1e-6 * case.size).with_budget(budget);
    let whole = separation(&a, &b, &limits, case.workspace);
    let sign = overlap(&a, &b, &limits, case.workspace);
    for answer in [whole, sign] {
        let Ok(answer) = answer else { return Ok(Err("bounded bodies are refused".into())) };
        if let Err(complaint) = case.differs("hasty", &answer, [0.0, 0.0], 1.0) {
            return Ok(Err(complaint));
        }
        // A round may end beyond the budget, and so may a descent.
        if answer.stop.is_early() && answer.evaluations > budget + 1000 {
            return Ok(Err(format!("{answer:?} of {budget}")));
        }
    }
    Ok(Ok(()))
}

/// What a track says after motions, small and large, under limits that allow little or
/// much, is what a search that starts anew says.
fn tracked<const D: usize>(
    case: &mut Case<'_, D>,
    u: &mut Unstructured<'_>,
) -> arbitrary::Result<Verdict>
where
    Space: Turn<D>,
{
    let [a, b] = case.bodies.clone();
    let mut track = Track::new(a.clone(), b.clone());
    let mut poses = [draw::pose::<D>(u)?, draw::pose::<D>(u)?];
    for _ in 0..MOTIONS {
        let budget = *u.choose(&[10, 1000, 200_000])?;
        let limits = case.limits.with_budget(budget);
        let warm = track.separation(poses, &limits, case.workspace);
        let cold = case.of(Placed::new(&a, poses[0]), Placed::new(&b, poses[1]), 1.0);
        let (Ok(warm), Ok(cold)) = (warm, cold) else {
            return Ok(Err("bodies are refused".into()));
        };
        if warm.lower > cold.upper || cold.lower > warm.upper {
            return Ok(Err(format!("{warm:?}, but anew {cold:?}: {a:?} {b:?}")));
        }
        let moved = &mut poses[u.choose_index(2)?];
        let step = case.size * 10.0_f64.powf(draw::within(u, -6.0, 0.0)?);
        moved.translation += draw::direction::<D>(u)? * step;
        if u.ratio(1, 3)? {
            moved.rotation = <Space as Turn<D>>::rotation(u)?;
        }
    }
    Ok(Ok(()))
}

/// After a translation as long as the upper bound bodies do not overlap, and after a shorter one than
/// the lower bound they do.
fn separated<const D: usize>(
    case: &mut Case<'_, D>,
    u: &mut Unstructured<'_>,
) -> arbitrary::Result<Verdict> {
    let [a, b] = case.bodies.clone();
    let (aside, share) = (draw::direction::<D>(u)?, draw::unit(u)?);
    Ok((|| {
        let error = |error: QueryError| error.to_string();
        let limits = Limits::new(0.05 * case.size).with_budget(20_000);
        let found = penetration(&a, &b, &limits, case.workspace).map_err(error)?;
        let complain = |what: &str, after: Answer<D>| {
            Err(format!("{what}: {found:?} leads to {after:?}: {a:?} {b:?}"))
        };
        let bits = 1e-9 * (case.size + found.lower);
        if let Some(direction) = found.best.direction {
            let out = Pose::translation(direction * found.upper);
            let after = case.of(&a, Placed::new(&b, out), 1.0)?;
            if after.upper < -bits {
                return complain("they overlap", after);
            }
        }
        let within = Pose::translation(aside * (share * found.lower));
        let after = case.of(&a, Placed::new(&b, within), 1.0)?;
        let is_apart = found.lower > 0.0 && after.lower > bits;
        if is_apart || found.lower > found.upper || -case.answer.upper > found.upper + bits {
            return complain("they are apart", after);
        }
        Ok(())
    })())
}
