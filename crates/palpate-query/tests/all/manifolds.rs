// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contacts that span where bodies touch.

use palpate_field::kernel::{Ball, Cuboid, Cylinder, Torus};
use palpate_field::{Pose, Rotation, Shape, ShapeError, Vector};
use palpate_query::{
    Limits, Manifold, ManifoldSettings, PairWorkspace, Placed, Track, Verdict, manifold,
};
use palpate_testkit::recall::{in_space, rows};

const LIMITS: Limits = Limits::new(1e-3).with_budget(200_000);

fn cuboid(sides: [f64; 3]) -> Result<Shape<3>, ShapeError> {
    Ok(Shape::from_kernel(Cuboid::new(Vector(sides))?))
}

fn touching<const D: usize>(
    a: &Shape<D>,
    b: &Shape<D>,
    pose: Pose<D>,
    settings: &ManifoldSettings,
) -> Manifold<D> {
    let mut workspace = PairWorkspace::new();
    let b = Placed::new(b, pose);
    manifold(a, b, settings, &LIMITS, &mut workspace).expect("bounded")
}

fn settings(margin: f64) -> ManifoldSettings {
    ManifoldSettings { margin, most: 64, ..ManifoldSettings::of_size(1.0) }
}

/// What holds of every manifold.
fn laws<const D: usize>(found: &Manifold<D>, settings: &ManifoldSettings) {
    assert_eq!(found.groups.iter().sum::<usize>(), found.contacts.len());
    assert!(found.is_whole);
    for (i, contact) in found.contacts.iter().enumerate() {
        assert!((contact.normal.norm() - 1.0).abs() < 1e-9, "{contact:?}");
        assert!(contact.gap <= settings.margin * 1.01, "{contact:?}");
        let apart = contact.point_b - contact.point_a;
        assert!((apart - contact.normal * contact.gap).norm() < 0.1 * settings.spacing);
        for other in &found.contacts[..i] {
            let is_near = (other.point_a - contact.point_a).norm() < settings.spacing;
            assert!(
                !is_near || other.normal.dot(contact.normal) < 0.9,
                "{contact:?}, {other:?}"
            );
        }
    }
    let deepest =
        found.contacts.iter().fold(f64::INFINITY, |least, contact| least.min(contact.gap));
    if found.separation.upper <= settings.margin {
        assert!(deepest <= found.separation.upper + 1e-6, "{deepest}, {:?}", found.separation);
    }
}

/// Every point of `wanted` has a contact within `close` [m].
fn includes<const D: usize>(found: &Manifold<D>, wanted: &[[f64; D]], close: f64) {
    for point in wanted {
        let nearest = found.contacts.iter().fold(f64::INFINITY, |least, contact| {
            least.min((contact.point_a - Vector(*point)).norm())
        });
        assert!(nearest <= close, "{nearest} m from {point:?}: {:?}", found.contacts);
    }
}

#[test]
fn faces_touch_at_the_corners_of_their_overlap() -> Result<(), ShapeError> {
    let (large, small) = (cuboid([1.2, 0.8, 0.6])?, cuboid([0.6, 0.5, 0.4])?);
    let settings = settings(2e-3);
    // 1 mm deep and 0.1 mm apart, hanging over two sides.
    for height in [0.499, 0.5001] {
        let pose = Pose::translation(Vector([0.45, 0.3, height]));
        let found = touching(&large, &small, pose, &settings);
        laws(&found, &settings);
        assert_eq!(found.groups.len(), 1);
        let [near, far] = [[0.15, 0.05], [0.6, 0.4]];
        let corners =
            [[near[0], near[1]], [far[0], near[1]], [near[0], far[1]], [far[0], far[1]]];
        includes(&found, &corners.map(|[x, y]| [x, y, 0.3]), 3e-3);
    }
    // Turned about the normal: the corners of the small face.
    let turn = Rotation::from_axis_angle(Vector([0.0, 0.0, 1.0]), 0.5)?;
    let found = touching(&large, &small, Pose::new(turn, Vector([0.1, 0.0, 0.499])), &settings);
    laws(&found, &settings);
    let corners = [[0.3, 0.25], [-0.3, 0.25], [0.3, -0.25], [-0.3, -0.25]].map(|[x, y]| {
        let p = turn.rotate(Vector([x, y, 0.0])) + Vector([0.1, 0.0, 0.3]);
        p.0
    });
    includes(&found, &corners, 4e-3);
    // Tilted by 3 mrad: all four corners within the margin, each as deep as it is.
    let tilt = Rotation::from_axis_angle(Vector([0.0, 1.0, 0.0]), 3e-3)?;
    let found = touching(&large, &small, Pose::new(tilt, Vector([0.1, 0.0, 0.499])), &settings);
    laws(&found, &settings);
    includes(&found, &[[-0.2, 0.25, 0.3], [0.4, 0.25, 0.3], [-0.2, -0.25, 0.3]], 4e-3);
    for contact in &found.contacts {
        let truth = -1e-3 - 3e-3 * (contact.point_a[0] - 0.1);
        assert!((contact.gap - truth).abs() < 5e-5, "{contact:?}, {truth}");
    }
    Ok(())
}

#[test]
fn a_peg_touches_its_hole_all_round() -> Result<(), ShapeError> {
    let hole = Shape::from_kernel(Cylinder::new(0.1005, 1.0)?);
    let plate = cuboid([0.6, 0.4, 0.6])?.difference([hole])?;
    let peg = Shape::from_kernel(Cylinder::new(0.1, 0.6)?);
    let settings = settings(1e-3);
    let pose = Pose::translation(Vector([0.0, 0.1, 0.0]));
    let found = touching(&plate, &peg, pose, &settings);
    laws(&found, &settings);
    let mut angles: Vec<f64> = found
        .contacts
        .iter()
        .map(|contact| contact.point_a[2].atan2(contact.point_a[0]).to_degrees())
        .collect();
    angles.sort_by(f64::total_cmp);
    angles.push(angles[0] + 360.0);
    for two in angles.windows(2) {
        assert!(two[1] - two[0] < 60.0, "{angles:?}");
    }
    for end in [-0.2, 0.2] {
        let at_end =
            |contact: &&palpate_query::Contact<3>| (contact.point_a[1] - end).abs() < 0.01;
        assert!(found.contacts.iter().filter(at_end).count() >= 3, "{:?}", found.contacts);
    }
    Ok(())
}

#[test]
fn separate_places_are_separate_groups() -> Result<(), ShapeError> {
    let torus = Shape::from_kernel(Torus::new(0.35, 0.15)?);
    let settings = settings(2e-3);
    // A bar across a torus, 1 mm deep: twice.
    let bar = cuboid([1.2, 0.08, 0.08])?;
    let found = touching(&torus, &bar, Pose::translation(Vector([0.0, 0.189, 0.0])), &settings);
    laws(&found, &settings);
    assert_eq!(found.groups, [1, 1]);
    for contact in &found.contacts {
        assert!((contact.gap + 1e-3).abs() < 1e-5, "{contact:?}");
        assert!((contact.point_a[0].abs() - 0.35).abs() < 0.01, "{contact:?}");
    }
    // A slab on it: around the ring.
    let slab = cuboid([1.2, 0.2, 1.2])?;
    let found =
        touching(&torus, &slab, Pose::translation(Vector([0.0, 0.2495, 0.0])), &settings);
    laws(&found, &settings);
    assert!(found.contacts.len() >= 4, "{:?}", found.contacts);
    for contact in &found.contacts {
        let radius = contact.point_a[0].hypot(contact.point_a[2]);
        assert!((radius - 0.35).abs() < 0.04, "{contact:?}");
    }
    // A ball on a slab: once.
    let ball = Shape::from_kernel(Ball::new(0.3)?);
    let found = touching(&slab, &ball, Pose::translation(Vector([0.1, 0.399, 0.2])), &settings);
    laws(&found, &settings);
    assert_eq!(found.contacts.len(), 1);
    assert!((found.contacts[0].point_a - Vector([0.1, 0.1, 0.2])).norm() < 2e-3);
    Ok(())
}

#[test]
fn in_the_plane_faces_touch_at_both_ends() -> Result<(), ShapeError> {
    let floor = Shape::from_kernel(Cuboid::new(Vector([2.0, 0.4]))?);
    let cube = Shape::from_kernel(Cuboid::new(Vector([0.5, 0.5]))?);
    let settings = settings(2e-3);
    let found = touching(&floor, &cube, Pose::translation(Vector([0.3, 0.449])), &settings);
    laws(&found, &settings);
    includes(&found, &[[0.05, 0.2], [0.55, 0.2]], 3e-3);
    // In a corner: both sides.
    let wall = Shape::from_kernel(Cuboid::new(Vector([0.4, 2.0]))?);
    let corner = Shape::union([floor, wall.translated(Vector([-1.0, 1.0]))?])?;
    let found = touching(&corner, &cube, Pose::translation(Vector([-0.551, 0.449])), &settings);
    laws(&found, &settings);
    assert!(found.groups.len() >= 2, "{:?}", found.contacts);
    includes(&found, &[[-0.301, 0.2], [-0.8, 0.699]], 5e-3);
    Ok(())
}

#[test]
fn a_cap_keeps_the_deepest_and_the_spread() -> Result<(), ShapeError> {
    let (large, small) = (cuboid([1.2, 0.8, 0.6])?, cuboid([0.6, 0.5, 0.4])?);
    let tilt = Rotation::from_axis_angle(Vector([0.0, 1.0, 0.0]), 3e-3)?;
    let pose = Pose::new(tilt, Vector([0.1, 0.0, 0.499]));
    let all = touching(&large, &small, pose, &settings(2e-3));
    for most in 1..all.contacts.len() {
        let settings = ManifoldSettings { most, ..settings(2e-3) };
        let some = touching(&large, &small, pose, &settings);
        assert_eq!(some.contacts.len(), most);
        assert_eq!(some.dropped, all.contacts.len() - most);
        let deepest = |found: &Manifold<3>| {
            found.contacts.iter().fold(f64::INFINITY, |least, contact| least.min(contact.gap))
        };
        assert_eq!(deepest(&some), deepest(&all));
        if most >= 2 {
            let apart = some.contacts.iter().fold(0.0_f64, |far, contact| {
                far.max((contact.point_a - some.contacts[0].point_a).norm())
            });
            assert!(apart > 0.4, "{:?}", some.contacts);
        }
    }
    Ok(())
}

#[test]
fn names_stay_while_a_contact_lasts() -> Result<(), ShapeError> {
    let (large, small) = (cuboid([1.2, 0.8, 0.6])?, cuboid([0.4, 0.3, 0.4])?);
    let mut track = Track::new(large, small);
    let mut workspace = PairWorkspace::new();
    let mut at = |x: f64, z: f64| {
        let poses = [Pose::identity(), Pose::translation(Vector([x, 0.05, z]))];
        track.manifold(poses, &settings(2e-3), &LIMITS, &mut workspace).expect("bounded")
    };
    let ids = |found: &Manifold<3>| {
        let mut ids: Vec<u64> = found.contacts.iter().map(|contact| contact.id).collect();
        ids.sort_unstable();
        ids
    };
    let first = at(0.0, 0.499);
    for step in 1..60 {
        let found = at(2e-3 * f64::from(step), 0.499);
        let kept = ids(&found).iter().filter(|id| ids(&first).contains(id)).count();
        assert!(kept >= 4, "step {step}: {:?} of {:?}", ids(&found), ids(&first));
    }
    // Lifted and put back: new contacts, new names.
    assert!(at(0.1, 0.6).contacts.is_empty());
    let again = at(0.1, 0.499);
    assert!(ids(&again).iter().all(|id| !ids(&first).contains(id)));
    Ok(())
}

#[test]
fn what_cannot_be_asked_is_refused_and_what_is_apart_has_no_contacts() -> Result<(), ShapeError>
{
    let ball = Shape::from_kernel(Ball::new(0.3)?);
    let mut workspace = PairWorkspace::new();
    for wrong in [f64::NAN, -1.0, f64::INFINITY] {
        for settings in [
            ManifoldSettings { margin: wrong, ..settings(1e-3) },
            ManifoldSettings { spacing: wrong, ..settings(1e-3) },
        ] {
            let asked = manifold(&ball, &ball, &settings, &LIMITS, &mut workspace);
            assert!(asked.is_err(), "{settings:?}");
        }
    }
    let apart = Pose::translation(Vector([0.7, 0.0, 0.0]));
    let found = touching(&ball, &ball, apart, &settings(2e-3));
    assert!(found.contacts.is_empty() && found.separation.lower > 0.09);
    // Concentric: one contact, whichever way it parts them. Its points were once both on one
    // side, with no gap.
    let found = touching(&ball, &ball, Pose::identity(), &settings(2e-3));
    assert!(!found.contacts.is_empty());
    for contact in &found.contacts {
        assert!((contact.normal.norm() - 1.0).abs() < 1e-9, "{contact:?}");
    }
    assert!((found.contacts[0].gap + 0.6).abs() < 2e-3, "{:?}", found.contacts);
    Ok(())
}

/// Precisions that are shares of the margin are never zero.
#[test]
fn without_a_margin_what_overlaps_is_spanned() -> Result<(), ShapeError> {
    let (torus, slab) = (Shape::from_kernel(Torus::new(0.35, 0.15)?), cuboid([1.2, 0.2, 1.2])?);
    let pose = Pose::translation(Vector([0.0, 0.248, 0.0]));
    let found = touching(&torus, &slab, pose, &settings(0.0));
    laws(&found, &settings(0.0));
    assert!(found.contacts.len() >= 4, "{:?}", found.contacts);
    Ok(())
}

/// A spacing of a hundred thousandth of the bodies: corners once wandered all over faces
/// of which the budget had left out the rim.
#[test]
fn a_tiny_spacing_spends_the_budget_and_little_more() -> Result<(), ShapeError> {
    let cube = cuboid([1.0, 1.0, 1.0])?;
    let settings = ManifoldSettings::of_size(1e-6);
    let mut workspace = PairWorkspace::new();
    let there = Placed::new(&cube, Pose::translation(Vector([1.0, 0.0, 0.0])));
    let limits = Limits::new(1e-10).with_budget(20_000);
    let found = manifold(&cube, there, &settings, &limits, &mut workspace).expect("bounded");
    assert!(!found.is_whole);
    assert!(found.separation.evaluations < 80_000, "{}", found.separation.evaluations);
    Ok(())
}

/// Flat boxes inside a region were once left to its rim, where there is none: one contact.
#[test]
fn a_ball_in_a_hollow_one_touches_it_all_around() -> Result<(), ShapeError> {
    let cavity = Shape::<3>::from_kernel(Ball::new(0.301)?);
    let hollow = Shape::from_kernel(Ball::new(0.9)?).difference([cavity])?;
    let ball = Shape::from_kernel(Ball::new(0.3)?);
    let settings =
        ManifoldSettings { margin: 0.1, most: 200, ..ManifoldSettings::of_size(0.5) };
    let there = Pose::translation(Vector([1e-4, 0.0, 0.0]));
    let found = touching(&hollow, &ball, there, &settings);
    laws(&found, &settings);
    for way in [[1.0, 0.0, 0.0], [0.0, 0.6, 0.8], [-0.48, -0.64, 0.6], [0.0, -1.0, 0.0]] {
        includes(&found, &[way.map(|x| 0.301 * x)], 0.2);
    }
    Ok(())
}

/// Of an edge in a corner, the gap of the deepest contact was up to 28 % less deep than the separation:
/// it was taken between the nearest points of both surfaces, which are not along the normal.
#[test]
fn the_deepest_contact_is_as_deep_as_the_separation() -> Result<(), ShapeError> {
    let pairs = in_space()?;
    let rows = rows::<3>().expect("rows");
    let mut checked = 0;
    for row in rows.iter().filter(|row| row.truth.upper < 0.0).step_by(40) {
        let Some(pair) = pairs.iter().find(|pair| pair.name == row.pair) else { continue };
        let [a, b] = &pair.bodies;
        let found = touching(a, b, row.pose()?, &settings(0.002));
        let upper = found.separation.upper;
        let deepest =
            found.contacts.iter().map(|contact| contact.gap).fold(f64::INFINITY, f64::min);
        assert!(upper >= 0.0 || deepest <= upper + 1e-9, "{row}: {deepest} m, not {upper} m");
        checked += 1;
    }
    assert!(checked > 100, "{checked}");
    Ok(())
}

/// Of a hexagon, contacts once spanned four corners.
#[test]
fn a_hexagon_touches_at_all_its_corners() -> Result<(), ShapeError> {
    let table = cuboid([1.0, 0.2, 1.0])?;
    let nut = Shape::<3>::hexagonal_prism(0.1, 0.1)?;
    let corners: [[f64; 3]; 6] = std::array::from_fn(|i| {
        let (sin, cos) = (i as f64 * std::f64::consts::FRAC_PI_3).sin_cos();
        [0.1 * sin, 0.1, 0.1 * cos]
    });
    for spacing in [0.001, 0.008] {
        let settings = ManifoldSettings { spacing, ..settings(4e-4) };
        let pose = Pose::translation(Vector([0.0, 0.15, 0.0]));
        let found = touching(&table, &nut, pose, &settings);
        laws(&found, &settings);
        includes(&found, &corners, 0.75 * spacing);
    }
    Ok(())
}

/// At an edge the gradient leads out of any of the sides that meet: the normal once was 34° off, by the
/// tolerance.
#[test]
fn the_normal_of_an_edge_on_a_face_is_that_of_the_face() -> Result<(), ShapeError> {
    let (floor, cube) = (cuboid([2.0, 0.2, 2.0])?, cuboid([0.2, 0.2, 0.2])?);
    let mut workspace = PairWorkspace::new();
    for height in [-1e-4, -1e-6, 0.0, 1e-6, 1e-4] {
        for angle in [0.3, std::f64::consts::FRAC_PI_4, 1.0] {
            let turn = Rotation::from_axis_angle(Vector([0.3, 0.2, 1.0]), angle)?;
            let lowest = [0, 1, 2].map(|k| turn.rotate(Vector::unit(k) * 0.1)[1].abs());
            let middle = 0.1 + lowest.iter().sum::<f64>() + height;
            let pose = Pose::new(turn, Vector([0.0, middle, 0.0]));
            for tolerance in [1e-5, 1e-6, 1e-8] {
                let limits = Limits::new(tolerance);
                let there = Placed::new(&cube, pose);
                let found =
                    manifold(&floor, there, &settings(4e-4), &limits, &mut workspace).unwrap();
                let contact = found.contacts[0];
                assert!(contact.normal[1] > 0.9999, "{height} m, {angle}: {contact:?}");
                let allowed = tolerance + 2e-6;
                assert!((contact.gap - height).abs() <= allowed, "{height} m: {contact:?}");
                let best = found.separation.best.normal.unwrap();
                // Of several places to the tolerance, one may lie off the edge.
                let is_sharp = tolerance <= 0.01 * height.abs();
                assert!(!is_sharp || best[1] > 0.9999, "{height} m, {angle}: {best:?}");
            }
        }
    }
    Ok(())
}

/// Gaps of flat models, which are too small where a body is round, were once called the upper bound: of a box
/// and a ball 1 m apart, 0.989 m at a margin of 3 m.
#[test]
fn bounds_hold_at_margins_that_are_larger_than_the_gap() -> Result<(), ShapeError> {
    fn hold<const D: usize>(bodies: [&Shape<D>; 2], there: Pose<D>, truth: f64) {
        for margin in [1e-3, 1.1, 1.5, 2.0, 3.0, 10.0] {
            let settings =
                ManifoldSettings { margin: margin * truth, ..ManifoldSettings::of_size(2.0) };
            let limits = Limits::new(0.5 * settings.margin);
            let there = Placed::new(bodies[1], there);
            let mut workspace = PairWorkspace::new();
            let found = manifold(bodies[0], there, &settings, &limits, &mut workspace);
            let found = found.expect("bounded");
            let bounds = [found.separation.lower, found.separation.upper];
            assert!(bounds[0] <= truth && bounds[1] >= truth, "margin {margin}: {bounds:?}");
            assert!(found.distance_at_most >= truth, "margin {margin}: {found:?}");
        }
    }
    let [square, disc] = [Shape::<2>::cuboid([2.0, 2.0])?, Shape::ball(1.0)?];
    hold([&square, &disc], Pose::translation([3.0, 0.3]), 1.0);
    let [cube, ball] = [Shape::<3>::cuboid([2.0, 2.0, 2.0])?, Shape::ball(1.0)?];
    for away in [[3.0, 0.3, 0.2], [1.5, 3.2, -0.4], [2.4, 2.6, 2.2]] {
        let to_box = Vector(away.map(|x: f64| (x.abs() - 1.0).max(0.0))).norm();
        hold([&cube, &ball], Pose::translation(away), to_box - 1.0);
    }
    Ok(())
}

/// A wedge of 2° whose field tells a 57th of the distance in front of its edge: a ball 10 mm away was said
/// to touch it within 0.4 mm.
#[test]
fn a_bound_is_no_touch_until_points_of_both_bodies_show_it() {
    let wedge = |half_angle: f64| {
        let (sin, cos) = half_angle.to_radians().sin_cos();
        let side = |x: f64| Shape::<3>::half_space([x, -sin, 0.0], 0.0).unwrap();
        side(cos) & side(-cos) & Shape::<3>::cube(0.2).unwrap()
    };
    let ball = Shape::<3>::ball(0.1).unwrap();
    let settings = ManifoldSettings::of_size(0.2);
    let found = |half_angle: f64, gap: f64| {
        let there = Placed::new(&ball, Pose::translation([0.0, -0.1 - gap, 0.0]));
        let limits = Limits::new(0.5 * settings.margin);
        let wedge = wedge(half_angle);
        manifold(&wedge, there, &settings, &limits, &mut PairWorkspace::new()).unwrap()
    };
    let far = found(1.0, 0.01);
    assert!(far.separation.upper < settings.margin);
    assert_eq!(far.verdict(settings.margin), Verdict::Undecided);
    assert!((0.01..0.0101).contains(&far.distance_at_most), "{far:?}");
    let contact = far.contacts[0];
    assert!(!contact.on_surfaces && contact.gap >= far.separation.lower, "{contact:?}");
    // Exactly in front of the edge, the gradients of both faces do not lead to it.
    for half_angle in [1.0, 2.5, 15.0, 30.0, 45.0] {
        let near = found(half_angle, 1e-4);
        assert_eq!(near.verdict(settings.margin), Verdict::Touching, "{half_angle}");
        assert!(
            (1e-4..=settings.margin).contains(&near.distance_at_most),
            "{half_angle}: {near:?}"
        );
    }
    let within = found(1.0, -0.05);
    assert_eq!((within.verdict(0.0), within.distance_at_most), (Verdict::Touching, 0.0));
}
