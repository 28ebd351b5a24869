// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rays on random trees, compared with samples as close as they get, and on a ball, compared with
//! its equation.

use palpate_field::{Shape, Vector};
use palpate_testkit::{arbitrary as draw, cases};

use super::*;
use crate::camera::{Camera, Lens, Sight};
use crate::render::Settings;
use crate::subject::{Studio, Subject};

const SIZE: [u32; 2] = [12, 9];

/// Samples along a ray, and lines in its cone.
const SAMPLES: u32 = 240;
const LINES: u32 = 6;

/// The middles of all pixels.
fn middles() -> Vec<[f64; 2]> {
    let [width, height] = SIZE;
    let row = |y| (0..width).map(move |x| [f64::from(x) + 0.5, f64::from(y) + 0.5]);
    (0..height).flat_map(row).collect()
}

/// The beams of all pixels, and what they meet.
fn traced(studio: &Studio, tracer: &mut Tracer<'_>, by_models: bool) -> Vec<(Beam, Met)> {
    let beam = |place: &[f64; 2]| studio.cut(&studio.camera.beam(*place, SIZE));
    let beams: Vec<Beam> = middles().iter().map(beam).collect();
    let mut all = Vec::new();
    for block in beams.chunks(BLOCK) {
        let mut met = Vec::new();
        tracer.aim(block);
        tracer.is_steep |= by_models;
        tracer.trace(Goal::First, block, &mut met);
        all.extend(block.iter().copied().zip(met));
    }
    all
}

/// The smallest value along a part of a beam, rounding added [m].
fn least(shape: &Shape<3>, beam: &Beam, end: f64) -> f64 {
    let sample = |i: u32| {
        let share = f64::from(i) / f64::from(SAMPLES);
        let p = beam.at(beam.near + (end - beam.near) * share);
        shape.distance(p) + shape.promise().rounding.within(p.norm())
    };
    (0..SAMPLES).map(sample).fold(f64::INFINITY, f64::min)
}

#[test]
fn rays_and_cones_through_random_trees_skip_nothing() {
    let (mut rays, mut surfaces, mut proven, mut undecided) = (0, 0, 0, 0);
    cases::on_trees(160, 4, |u, _, shape| {
        let Ok(subject) = Subject::of_shapes([shape.clone()]) else {
            return Ok(Err("no subject".into()));
        };
        let sight =
            Sight::from_angles(draw::within(u, -3.0, 3.0)?, draw::within(u, -1.5, 1.5)?);
        let lens = if u.arbitrary()? { Lens::USUAL } else { Lens::Orthographic };
        let camera =
            sight.and_then(|sight| Camera::fitting(&subject.corners(), sight, lens, 4.0 / 3.0));
        let settings = Settings::new(SIZE[0], SIZE[1]);
        // A camera inside a body without bounds is refused.
        let Ok(studio) = camera.and_then(|camera| Studio::new(&subject, &camera, &settings))
        else {
            return Ok(Ok(()));
        };
        let whole = &studio.surfaces.whole;
        for by_models in [false, true] {
            let all = traced(&studio, &mut studio.tracer(), by_models);
            for (pixel, (beam, met)) in middles().iter().zip(all) {
                let wrong = |what: String| Ok(Err(format!("{what}: {met:?} of {beam:?}")));
                rays += 1;
                let passed = least(whole, &beam, met.distance);
                if beam.near < beam.far && passed <= 0.0 && met.distance > beam.near {
                    return wrong(format!("{passed} m before its end, by models: {by_models}"));
                }
                match met.end {
                    End::Undecided => undecided += 1,
                    End::Surface => {
                        surfaces += 1;
                        let value = whole.distance(beam.at(met.distance));
                        if value > studio.surfaces.gap {
                            return wrong(format!("{value} m where it meets a surface"));
                        }
                    }
                    End::Free if met.is_beside => {}
                    End::Free => {
                        proven += 1;
                        for _ in 0..LINES {
                            let [x, y] =
                                [draw::within(u, -0.5, 0.5)?, draw::within(u, -0.5, 0.5)?];
                            let line = studio.camera.beam([pixel[0] + x, pixel[1] + y], SIZE);
                            let line = Beam { near: beam.near, far: beam.far, ..line };
                            let passed = least(whole, &line, line.far);
                            if beam.near < beam.far && passed <= 0.0 {
                                return wrong(format!("{passed} m in its cone: {by_models}"));
                            }
                        }
                    }
                }
            }
        }
        Ok(Ok(()))
    });
    assert!(surfaces * 10 > rays && proven * 4 > rays, "{surfaces}, {proven} of {rays}");
    assert!(undecided * 1000 < rays, "{undecided} of {rays} are undecided");
}

/// A studio with this shape, seen from (0, 0, 4).
fn studio(shape: Shape<3>, settings: &Settings) -> Studio {
    let subject = Subject::of_shapes([shape]).unwrap();
    let camera =
        Camera::looking(Vector([0.0, 0.0, 4.0]), Vector::ZERO, Lens::Perspective(0.6)).unwrap();
    Studio::new(&subject, &camera, settings).unwrap()
}

#[test]
fn rays_meet_a_ball_where_its_equation_says() {
    let studio = studio(Shape::ball(1.0).unwrap(), &Settings::new(SIZE[0], SIZE[1]));
    let gap = studio.surfaces.gap;
    assert!((gap - 8.0 * 0.3_f64.tan() / 9.0 / 32.0).abs() < 1e-15);
    let (mut hits, mut free) = (0, 0);
    for by_models in [false, true] {
        for (beam, met) in traced(&studio, &mut studio.tracer(), by_models) {
            // |o + t d|² = r² of the ball, and of the ball grown by the gap.
            let along = -beam.origin.dot(beam.direction);
            let enters = |radius: f64| {
                let beside = beam.origin.dot(beam.origin) - along * along;
                (beside < radius * radius).then(|| along - (radius * radius - beside).sqrt())
            };
            match (enters(1.0), enters(1.0 + gap)) {
                (Some(last), Some(first)) => {
                    assert_eq!(met.end, End::Surface, "{met:?}");
                    assert!(first - 1e-12 <= met.distance && met.distance <= last + 1e-12);
                    hits += 1;
                }
                (None, None) => {
                    assert_eq!(met.end, End::Free, "{met:?}");
                    free += 1;
                }
                _ => {}
            }
        }
    }
    assert!(hits > 80 && free > 60, "{hits} hits, {free} free");
}

#[test]
fn no_ray_passes_a_wall_however_thin() {
    for thickness in [1e-3, 1e-6, 1e-9] {
        let wall = Shape::cuboid([8.0, 8.0, thickness]).unwrap();
        let studio = studio(wall, &Settings::new(SIZE[0], SIZE[1]));
        for (beam, met) in traced(&studio, &mut studio.tracer(), false) {
            assert_eq!(met.end, End::Surface);
            let depth = beam.at(met.distance)[2] - 0.5 * thickness;
            assert!((0.0..=studio.surfaces.gap).contains(&depth), "{depth}");
        }
    }
}

#[test]
fn sheets_and_curves_are_as_thick_as_the_picture_needs() {
    let corners = [[-1.0, -1.0, 0.0], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0]];
    let sheet = Shape::triangle_sheet(corners, 0.0).unwrap();
    let wire = Shape::segment([-0.5, -0.3, 1.0], [0.6, 0.5, 1.0], 0.0).unwrap();
    let both = sheet | wire;
    let studio = studio(both, &Settings::new(SIZE[0], SIZE[1]));
    let thin = studio.thin;
    assert!((thin - 0.6 * 32.0 * studio.surfaces.gap).abs() < 1e-15);
    // On the wire and on the sheet, half a radius beside them, and clear of both.
    for (place, expected) in [
        ([0.05, 0.1, 1.0], true),
        ([0.3, 0.3, 0.5 * thin], true),
        ([0.0, 0.0, 1.01 * thin], false),
    ] {
        assert_eq!(studio.surfaces.whole.distance(place) <= 0.0, expected, "{place:?}");
    }
}

#[test]
fn a_ray_along_a_wall_is_decided_by_few_models() {
    let wall = Shape::cuboid([60.0, 1.0, 1.0]).unwrap();
    let studio = studio(wall, &Settings::new(SIZE[0], SIZE[1]));
    let gap = studio.surfaces.gap;
    for height in [1.000_001, 1.5, 4.0] {
        let origin = Vector([-29.0, 0.5 + height * gap, 0.0]);
        let ray = Beam::ray(origin, Vector::unit(0));
        let beam = Beam { far: 58.0, radius: 6.0 * gap, ..ray };
        let (mut tracer, mut met) = (studio.tracer(), Vec::new());
        tracer.aim(&[beam]);
        tracer.is_steep = true;
        tracer.trace(Goal::First, &[beam], &mut met);
        assert!(met[0].end == End::Free && met[0].is_beside, "{height} {met:?}");
        let Work { grazing, evaluations, .. } = tracer.work;
        assert!(grazing == 0 && evaluations < 1000, "{height} {:?}", tracer.work);
    }
}

#[test]
fn a_ray_without_budget_is_undecided() {
    let settings = Settings { budget: 2, ..Settings::new(SIZE[0], SIZE[1]) };
    let shape = Shape::torus(1.0, 0.3).unwrap();
    let studio = studio(shape, &settings);
    let mut tracer = studio.tracer();
    let all = traced(&studio, &mut tracer, false);
    let undecided = all.iter().filter(|(_, met)| met.end == End::Undecided).count();
    assert!(undecided > 20, "{undecided}");
    assert_eq!(tracer.work.undecided, undecided as u64);
    for (beam, met) in all {
        assert!(least(&studio.surfaces.whole, &beam, met.distance) > 0.0, "{met:?}");
    }
}
