// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The memoir's descent as printed: its path, its oscillation, where it ends.

use palpate_field::kernel::{Ball, Cuboid};
use palpate_field::{Point, Shape, Vector};
use palpate_local::{Descent, ElementMethod, GradientMethod, NaiveDescent, Weights};
use palpate_query::{Element, ElementWorkspace, Limits, minimum};

type Outcome = Result<(), Box<dyn std::error::Error>>;

fn disc(radius: f64) -> Shape<2> {
    Shape::from_kernel(Ball::new(radius).unwrap())
}

/// A descent along exact gradients.
fn exact() -> NaiveDescent {
    NaiveDescent::default().with_gradient(GradientMethod::Exact)
}

fn assert_path<const D: usize>(found: &Descent<D>, expected: &[Point<D>]) {
    assert_eq!(found.path.len(), expected.len(), "{found:?}");
    for (p, expected) in found.path.iter().zip(expected) {
        assert!((*p - *expected).norm() < 1e-15, "{p:?} is not {expected:?}");
    }
}

/// From (1.8, 2.4), which is 3 m from the centre, towards it: the values are 2, 1 and ½, the
/// steps half of them.
#[test]
fn three_steps_towards_a_disc_are_as_computed_by_hand() -> Outcome {
    let towards = Vector([0.6, 0.8]);
    // The centroid is (5.4/3, 7.2/3).
    let corners = [Vector([-1.2, -1.6]), Vector([5.6, 0.8]), Vector([1.0, 8.0])];
    let triangle = Element::new(corners)?;
    let descent = exact().with_alpha(0.5).with_mu(0.25).with_steps(3);
    let found = descent.descend(&disc(1.0), &triangle);
    assert_path(&found, &[3.0, 2.0, 1.5, 1.25].map(|r| towards * r));
    // With µ = 2 m all steps are 1 m: the third is at the centre.
    let found = descent.with_mu(2.0).descend(&disc(1.0), &triangle);
    assert_path(&found, &[3.0, 2.0, 1.0, 0.0].map(|r| towards * r));
    assert!((found.value + 1.0).abs() < 1e-15 && found.best == found.path[3]);
    Ok(())
}

/// A step out of the triangle ends at the nearest point of its edge, from which the next one
/// starts.
#[test]
fn a_step_out_of_the_triangle_comes_back_to_its_edge() -> Outcome {
    let corners = [Vector([0.0, 2.0]), Vector([3.0, 2.0]), Vector([0.0, 5.0])];
    let triangle = Element::new(corners)?;
    let descent = exact().with_alpha(1.0).with_mu(0.5).with_steps(2);
    let start = Weights::new([0.25, 0.25, 0.5])?;
    let found = descent.descend_from(&disc(1.0), &triangle, &start);
    // From (0.75, 3.5) by f = √(0.75² + 3.5²) − 1 to the circle, below the edge y = 2.
    let from = Vector([0.75, 3.5]);
    let on_circle = from * (1.0 / from.norm());
    let second = Vector([on_circle[0], 2.0]);
    let third = second * (1.0 / second.norm());
    assert_path(&found, &[from, second, Vector([third[0], 2.0])]);
    Ok(())
}

/// The memoir counts about 10 evaluations for a gradient, 640 for a triangle. A dichotomy takes
/// 12, differences 4 in the plane and 6 in space; each step takes a value, and the start one.
#[test]
fn evaluations_are_those_of_the_gradients_method() -> Outcome {
    let triangle = Element::new([Vector([-3.0, 1.0]), Vector([3.0, 2.0]), Vector([0.5, 4.0])])?;
    let found = NaiveDescent::default().descend(&disc(1.0), &triangle);
    assert_eq!((found.steps, found.evaluations), (64, 64 * (12 + 1) + 1));
    assert_eq!(64 * NaiveDescent::MEMOIR_EVALUATIONS, 640);
    for (method, of_gradient) in [
        (GradientMethod::AdaptiveDichotomy, 13),
        (GradientMethod::Differences, 4),
        (GradientMethod::ClosestVector, 2),
        (GradientMethod::Exact, 2),
    ] {
        let found =
            NaiveDescent::default().with_gradient(method).descend(&disc(0.1), &triangle);
        assert_eq!(found.evaluations, 64 * (of_gradient + 1) + 1, "{method}");
    }
    let ball = Shape::from_kernel(Ball::new(1.0)?);
    let in_space =
        [Vector([-3.0, 1.0, 1.0]), Vector([3.0, 2.0, 0.0]), Vector([0.5, 4.0, -1.0])];
    let found = NaiveDescent::default().descend(&ball, &Element::new(in_space)?);
    assert_eq!(found.evaluations, 64 * (6 + 1) + 1);
    let none = NaiveDescent::default().with_gradient(GradientMethod::Dichotomy);
    assert_eq!(none.descend(&ball, &Element::new(in_space)?).steps, 0);
    Ok(())
}

/// Across the deepest point of a disc, by α·µ.
#[test]
fn too_large_an_alpha_oscillates_and_its_amplitude_is_the_step() -> Outcome {
    let segment = Element::new([Vector([-2.0, 0.0]), Vector([2.5, 0.0])])?;
    for (alpha, mu) in [(0.1, 1.0), (0.5, 0.5), (1.0, 0.7)] {
        let found = exact().with_alpha(alpha).with_mu(mu).descend(&disc(1.0), &segment);
        let amplitude = found.oscillation().unwrap();
        assert!((amplitude - alpha * mu).abs() < 1e-12, "{amplitude} with {alpha} and {mu}");
    }
    Ok(())
}

/// The minimum over the segment is its middle, 2 m above the centre of the disc: a step of
/// α·f along the gradient multiplies x by 1 − α·f/ρ ≈ 1 − α/2.
#[test]
fn steps_that_shrink_do_not_oscillate() -> Outcome {
    let segment = Element::new([Vector([-1.0, 2.0]), Vector([1.5, 2.0])])?;
    let found =
        |alpha: f64| exact().with_alpha(alpha).with_mu(0.0).descend(&disc(1.0), &segment);
    // To and fro, by half as much each time.
    let shrinking = found(3.0);
    assert_eq!(shrinking.oscillation(), None);
    assert!(shrinking.path[64][0].abs() < 1e-15, "{shrinking:?}");
    // To one side.
    assert_eq!(found(0.5).oscillation(), None);
    // By more each time, up to where the steps end.
    let growing = found(4.5).oscillation().unwrap();
    assert!(growing > 0.5, "{growing}");
    // A path that is too short to tell.
    let short = exact().with_alpha(4.5).with_mu(0.0).with_steps(7);
    assert_eq!(short.descend(&disc(1.0), &segment).oscillation(), None);
    Ok(())
}

/// Without µ the steps add up to the distance: after n steps (1 − α)ⁿ of it is left.
#[test]
fn without_mu_the_descent_ends_at_the_surface() -> Outcome {
    let segment = Element::new([Vector([-1.0, 0.0]), Vector([6.0, 0.0])])?;
    let found = exact().with_alpha(0.125).with_mu(0.0).descend(&disc(1.0), &segment);
    let expected = 1.5 * 0.875_f64.powi(64);
    assert!((found.value - expected).abs() < 1e-15, "{} {expected}", found.value);
    assert_eq!(found.oscillation(), None);
    let limits = Limits::new(1e-6);
    let least = minimum(&disc(1.0), &segment, &limits, &mut ElementWorkspace::new())?;
    assert!(least.upper < -0.999);
    Ok(())
}

/// Every method starts where it is told to.
#[test]
fn a_start_decides_which_valley_is_found() -> Outcome {
    let balls = Shape::union([
        disc(0.2).translated(Vector([-1.0, 0.0]))?,
        disc(0.1).translated(Vector([1.0, 0.0]))?,
    ])?;
    let corners = [Vector([-1.5, -0.1]), Vector([1.5, -0.2]), Vector([0.0, 1.0])];
    let triangle = Element::new(corners)?;
    let start = Weights::new([0.25, 0.75, 0.0])?;
    for method in ElementMethod::ALL {
        let found = method.descend_from(&balls, &triangle, &start);
        assert_eq!(found.path[0], triangle.at(start.of_vertices()), "{method}");
        assert!(found.value <= balls.distance(found.path[0]), "{method}");
    }
    for method in [ElementMethod::Naive, ElementMethod::ProjectedGradient] {
        let found = method.descend_from(&balls, &triangle, &start);
        assert!(found.best[0] > 0.8 && found.value > -0.1 - 1e-9, "{method}: {found:?}");
        let start = Weights::new([0.75, 0.25, 0.0])?;
        let found = method.descend_from(&balls, &triangle, &start);
        assert!(found.best[0] < -0.8 && found.value < -0.1, "{method}: {found:?}");
    }
    Ok(())
}

/// Numbers that are no lengths take no step, and none is lost.
#[test]
fn a_descent_with_bad_constants_stays_at_its_start() -> Outcome {
    let square = Shape::from_kernel(Cuboid::new(Vector([1.0, 1.0]))?);
    let segment = Element::new([Vector([1.0, 0.25]), Vector([2.0, 0.25])])?;
    for descent in [
        NaiveDescent::default().with_alpha(f64::NAN),
        NaiveDescent::default().with_alpha(-1.0),
        NaiveDescent::default().with_alpha(f64::INFINITY),
        NaiveDescent::default().with_mu(f64::INFINITY),
        NaiveDescent::default().with_steps(0),
    ] {
        let found = descent.descend(&square, &segment);
        assert_eq!((found.steps, found.best), (0, Vector([1.5, 0.25])), "{descent:?}");
    }
    Ok(())
}
