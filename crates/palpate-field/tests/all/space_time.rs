// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Models of four parameters: fields that move, over boxes in space and time.

use palpate_field::kernel::{Ball, Cuboid, Ellipsoid, Pyramid, Torus};
use palpate_field::scalar::{AffineModel, Model, Scalar};
use palpate_field::{BLOCK, Block, Column, Kernel, ShapeError, Vector};

/// Samples along each side of a box.
const SAMPLES: u32 = 6;

/// Rounding of the samples, in units of the largest number in them.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A box in space and time: the centre and half sides of x, y, z [m] and t [s].
#[derive(Clone, Copy, Debug)]
struct SpaceTime {
    centre: [f64; 4],
    half: [f64; 4],
}

impl SpaceTime {
    /// Boxes of several sizes, none centred.
    fn all() -> impl Iterator<Item = Self> {
        (0..40).map(|i| {
            let spread = |k: u32| (f64::from(7 * i + k) * 0.618_033_988_749_895).fract() - 0.5;
            let size = [0.5, 0.1, 0.01, 1e-4][i as usize % 4];
            Self {
                centre: [2.0 * spread(1), 2.0 * spread(2), 2.0 * spread(3), spread(4)],
                half: [size, 0.7 * size, 1.3 * size, 0.4 * size],
            }
        })
    }
}

/// A point of the world at time `t` as a body sees it that turns about z by 0.8 rad/s, and
/// moves along (0.5, −0.3, 0.2) m/s.
fn in_body<S: Scalar>([x, y, z, t]: [S; 4]) -> Vector<S, 3> {
    let angle = t.scale(0.8);
    let (sin, cos) = (angle.sin(), angle.cos());
    let (x, y, z) = (x - t.scale(0.5), y + t.scale(0.3), z - t.scale(0.2));
    Vector([cos * x + sin * y, cos * y - sin * x, z])
}

/// The model of a moving kernel over a box encloses its values all over it.
fn encloses<K: Kernel<3>>(kernel: &K, cell: SpaceTime) {
    let model: AffineModel<4> =
        kernel.model(in_body(AffineModel::cell(cell.centre, cell.half)));
    let steps = SAMPLES.pow(4);
    for sample in 0..steps {
        let u: [f64; 4] = std::array::from_fn(|k| {
            let step = sample / SAMPLES.pow(k as u32) % SAMPLES;
            2.0 * f64::from(step) / f64::from(SAMPLES - 1) - 1.0
        });
        let at = std::array::from_fn(|k| cell.centre[k] + u[k] * cell.half[k]);
        let value = kernel.distance(in_body::<f64>(at));
        let plane = model.value + (0..4).map(|k| model.gradient[k] * u[k]).sum::<f64>();
        let rounding = ROUNDING * (1.0 + value.abs());
        assert!(plane - model.lower <= value + rounding, "{value}, {model:?}, {cell:?}");
        assert!(value <= plane + model.upper + rounding, "{value}, {model:?}, {cell:?}");
    }
}

#[test]
fn a_model_bounds_a_moving_field_over_a_box_in_space_and_time() -> Result<(), ShapeError> {
    let pyramid = Pyramid::new(0.5, 0.7)?;
    let ellipsoid = Ellipsoid::new(Vector([0.6, 0.4, 0.3]))?;
    for cell in SpaceTime::all() {
        encloses(&Ball::new(0.5)?, cell);
        encloses(&Cuboid::new(Vector([0.6, 0.4, 0.5]))?, cell);
        encloses(&Torus::new(0.4, 0.15)?, cell);
        // Kernels with a rule of their own for models.
        encloses(&pyramid, cell);
        encloses(&ellipsoid, cell);
    }
    Ok(())
}

#[test]
fn remainders_shrink_with_the_square_of_the_box() -> Result<(), ShapeError> {
    let torus = Torus::new(0.4, 0.15)?;
    let width = |size: f64| {
        let half = [size, size, size, size];
        let cell = AffineModel::cell([0.5, 0.3, 0.2, 0.1], half);
        let model: AffineModel<4> = torus.model(in_body(cell));
        model.lower + model.upper
    };
    let ratio = width(1e-2) / width(1e-3);
    assert!((80.0..120.0).contains(&ratio), "{ratio}");
    Ok(())
}

/// A slab that moves along x at 2 m/s: the affine function is the field itself.
#[test]
fn a_motion_along_a_normal_is_exact() -> Result<(), ShapeError> {
    let slab = Cuboid::new(Vector([2.0, 64.0, 64.0]))?;
    let [x, y, z, t] = AffineModel::<4>::cell([4.0, 0.0, 0.0, 0.5], [0.5, 0.25, 0.25, 0.125]);
    let model = slab.model(Vector([x - t.scale(2.0), y, z]));
    // x − 2t − 1 at the centre, and 0.5 and −2·0.125 along x and t.
    assert_eq!((model.value, model.gradient), (2.0, [0.5, 0.0, 0.0, -0.25]));
    assert!(model.lower < 1e-13 && model.upper < 1e-13, "{model:?}");
    Ok(())
}

#[test]
fn a_box_without_duration_has_the_bits_of_three_parameters() -> Result<(), ShapeError> {
    let pyramid = Pyramid::new(0.5, 0.7)?;
    let torus = Torus::new(0.4, 0.15)?;
    for SpaceTime { centre: [x, y, z, _], half: [a, b, c, _] } in SpaceTime::all() {
        let four = AffineModel::<4>::cell([x, y, z], [a, b, c]);
        let three = Model::cell([x, y, z], [a, b, c]);
        for (four, three) in [
            (pyramid.model(Vector(four)), pyramid.model(Vector(three))),
            (torus.model(Vector(four)), torus.model(Vector(three))),
        ] {
            assert_eq!(four.value.to_bits(), three.value.to_bits());
            assert_eq!(four.gradient[..3], three.gradient);
            assert_eq!(four.lower.to_bits(), three.lower.to_bits());
            // The sum over corners has twice as many, with the same values.
            assert_eq!(four.upper.to_bits(), three.upper.to_bits());
            assert_eq!(four.gradient[3], 0.0);
        }
    }
    Ok(())
}

#[test]
fn blocks_hold_models_of_four_parameters() {
    let mut cells = Block::<AffineModel<4>, 3, BLOCK>::zero();
    let cell = |i: usize| {
        let [x, y, z, t] = AffineModel::cell([i as f64, 0.5, -1.0, 2.0], [0.1, 0.2, 0.3, 0.4]);
        Vector([x + t, y - t, z])
    };
    cells.fill(5, cell);
    let mut column = Column::<AffineModel<4>, BLOCK>::zero();
    for i in 0..5 {
        assert_eq!(cells.get(i), cell(i));
        column.set(i, cell(i)[0]);
        assert_eq!(column.get(i), cell(i)[0]);
    }
}
