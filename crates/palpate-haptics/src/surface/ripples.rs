// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A sine wave on a surface.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::Texture;
use palpate_field::scalar::Scalar;
use palpate_field::{Kernel, Point, Promise, Vector};

use crate::error::HapticsError;
use palpate_device::NumberError;

/// Rounding errors of a wave, from the products of the phase, their sum and the sine.
const ROUNDINGS: f64 = 16.0;

/// The frequencies at which a height texture begins to fade and is gone, as parts of the rate: a
/// force that is held for a tick follows a wave well up to four ticks a wave; beyond two it cannot
/// (Nyquist), and is felt at another frequency. Choi and Tan, "Effect of update rate on perceived
/// instability of virtual haptic texture" (2004), ask for 5 to 10 kHz for that reason.
const FADES: [f64; 2] = [0.25, 0.5];

/// The part of a height texture that is rendered at `rate` [Hz] when its crests pass at `frequency`
/// [Hz]: 1 up to a quarter of the rate, 0 from half of it on, and `(1 − u)² (1 + 2u)` between, with
/// u from 0 to 1. Zero for NaN.
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
fn rendered_part(frequency: f64, rate: f64) -> f64 {
    let [begins, ends] = FADES;
    let crests = frequency / rate;
    if crests <= begins {
        return 1.0;
    }
    // `min` gives 1 for NaN.
    let faded = ((crests - begins) / (ends - begins)).min(1.0);
    (1.0 - faded) * (1.0 - faded) * (1.0 + 2.0 * faded)
}

/// How the crests of a height texture pass under a hand.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Passing {
    /// Crests a second [Hz].
    pub frequency: f64,
    /// The part of the texture that is rendered, in [0, 1]: less than 1 if crests pass faster than
    /// a quarter of the rate.
    pub part: f64,
}

impl Passing {
    /// The rate at which the texture is rendered in full [Hz]: four ticks for each crest.
    #[must_use]
    pub fn wanted_rate(&self) -> f64 {
        let [begins, _] = FADES;
        self.frequency / begins
    }
}

/// A wave through space, in a body's coordinates: `a · sin(2π u·p / λ)` along a direction `u`,
/// or `a · Π sin(2π pᵢ / λ)` along all axes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ripples {
    amplitude: f64,
    wavelength: f64,
    /// Radians a metre along each wave vector.
    waves: Waves,
}

#[derive(Clone, Debug, PartialEq)]
enum Waves {
    /// Along one wave vector [rad/m], whose direction was given in so many numbers.
    Plane { along: [f64; 3], dimension: usize },
    /// Along the first `axes` axes, with this wave number [rad/m].
    Product { number: f64, axes: usize },
}

impl Ripples {
    pub(crate) fn new(texture: &Texture) -> Result<Self, HapticsError> {
        let amplitude =
            NumberError::check_positive("texture.amplitude", texture.amplitude, "m")?;
        let wavelength =
            NumberError::check_positive("texture.wavelength", texture.wavelength, "m")?;
        let number = 2.0 * std::f64::consts::PI / wavelength;
        let Some(direction) = &texture.direction else {
            return Ok(Self {
                amplitude,
                wavelength,
                waves: Waves::Product { number, axes: 3 },
            });
        };
        let dimension = direction.len();
        let unit = match *direction.as_slice() {
            [x, y] => Vector([x, y, 0.0]).normalized(),
            [x, y, z] => Vector([x, y, z]).normalized(),
            _ => None,
        };
        let along = (unit.ok_or_else(|| wrong_direction(dimension))? * number).0;
        Ok(Self { amplitude, wavelength, waves: Waves::Plane { along, dimension } })
    }

    /// The waves on a body of so many dimensions, 2 for a planar shape.
    pub(crate) fn on_body(self, dimension: usize) -> Result<Self, HapticsError> {
        let waves = match self.waves {
            Waves::Plane { dimension: given, .. } if given != dimension => {
                return Err(wrong_direction(given));
            }
            Waves::Plane { .. } => self.waves,
            Waves::Product { number, .. } => Waves::Product { number, axes: dimension },
        };
        Ok(Self { waves, ..self })
    }

    /// The steepest change of the wave's slope [1/m]: `a (2π / λ)²`.
    ///
    /// That of a product of three waves is up to 1.09 times as large, between crest and saddle.
    pub(crate) fn bend(&self) -> f64 {
        let number = 2.0 * std::f64::consts::PI / self.wavelength;
        self.amplitude * number * number
    }

    /// This wave with `part` of its amplitude.
    pub(crate) fn lowered(&self, part: f64) -> Self {
        Self { amplitude: part * self.amplitude, ..self.clone() }
    }

    /// The amplitude of the wave [m].
    pub(crate) fn height(&self) -> f64 {
        self.amplitude
    }

    /// The number of dimensions of the body that has the waves.
    pub(crate) fn dimension(&self) -> usize {
        match self.waves {
            Waves::Plane { dimension, .. } => dimension,
            Waves::Product { axes, .. } => axes,
        }
    }

    /// The distance between crests [m].
    pub(crate) fn wavelength(&self) -> f64 {
        self.wavelength
    }

    /// How many crests pass a second at this velocity [Hz]; of waves along all axes, the most along
    /// one of them.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn frequency(&self, velocity: Vector<f64, 3>) -> f64 {
        let radians = match &self.waves {
            Waves::Plane { along, .. } => velocity.dot(Vector(*along)).abs(),
            Waves::Product { number, .. } => {
                number * velocity.0.iter().fold(0.0, |most: f64, v| most.max(v.abs()))
            }
        };
        radians / (2.0 * std::f64::consts::PI)
    }

    /// How the crests pass under a hand of this velocity along a surface with this unit normal.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn passing(
        &self,
        velocity: Vector<f64, 3>,
        normal: Vector<f64, 3>,
        rate: f64,
    ) -> Passing {
        let frequency = self.frequency(velocity - normal * velocity.dot(normal));
        Passing { frequency, part: rendered_part(frequency, rate) }
    }

    /// The height of the wave [m] and its gradient.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn at(&self, p: Point<3>) -> (f64, Vector<f64, 3>) {
        self.distance_gradient(p)
    }
}

fn wrong_direction(numbers: usize) -> HapticsError {
    let rule = "a direction of the scene's dimension";
    NumberError::new("texture.direction", rule, numbers as f64, "numbers").into()
}

impl<const D: usize> Kernel<D> for Ripples {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, D>) -> S {
        let wave = match &self.waves {
            Waves::Plane { along, .. } => p.dot_constant(&Vector(*along).truncated().0).sin(),
            Waves::Product { number, axes } => {
                let factor = |x: S| (x * S::constant(*number)).sin();
                p.0.into_iter()
                    .take(*axes)
                    .map(factor)
                    .fold(S::constant(1.0), |wave, x| wave * x)
            }
        };
        wave * S::constant(self.amplitude)
    }

    fn promise(&self) -> Promise<D> {
        // The gradient of a product wave is no longer than that of a plane wave along one axis:
        // the squares of the cosines, each times the squared sines of the other axes, sum to at
        // most 1.
        let number = match &self.waves {
            Waves::Plane { along, .. } => Vector(*along).norm(),
            Waves::Product { number, .. } => *number,
        };
        let steepness = self.amplitude * number * (1.0 + 1e-12);
        let rounding = palpate_field::Rounding::of_operations(ROUNDINGS * steepness, 0.0);
        let constant = ROUNDINGS * f64::EPSILON * self.amplitude;
        let rounding = palpate_field::Rounding { constant, ..rounding };
        Promise::lipschitz(None, steepness).with_rounding(rounding)
    }
}

#[cfg(test)]
mod tests {
    use crate::TextureKind;
    use palpate_field::Shape;

    use super::*;
    use palpate_testkit::cases::each as cases;

    fn texture(direction: Option<Vec<f64>>) -> Texture {
        let (amplitude, wavelength) = (0.5, 8.0);
        let kind = TextureKind::Height;
        Texture { description: None, kind, amplitude, wavelength, direction }
    }

    #[test]
    fn a_quarter_of_a_wave_is_a_crest() {
        let plane = Ripples::new(&texture(Some(vec![0.0, 3.0, 0.0]))).unwrap();
        let (height, slope) = plane.at(Vector([7.0, 2.0, 9.0]));
        assert!((height - 0.5).abs() < 1e-15 && slope.norm() < 1e-15);
        let product = Ripples::new(&texture(None)).unwrap().on_body(2).unwrap();
        assert!((product.at(Vector([2.0, -2.0, 0.0])).0 + 0.5).abs() < 1e-15);
        assert!(plane.on_body(2).is_err());
    }

    #[test]
    fn no_wave_is_steeper_than_promised() {
        let product = Ripples::new(&texture(None)).unwrap();
        let promised = Shape::<3>::from_kernel(product.clone()).promise().lipschitz;
        cases(500, |u| {
            let mut unit = || u.int_in_range(-1000..=1000).map(|i: i32| f64::from(i) * 0.02);
            let p = Vector([unit()?, unit()?, unit()?]);
            let (_, slope) = product.at(p);
            assert!(slope.norm() <= promised);
            let step = Vector([1e-5, -2e-5, 1e-5]);
            let change = (product.at(p + step).0 - product.at(p - step).0) * 0.5;
            assert!((change - slope.dot(step)).abs() < 1e-12);
            Ok(())
        });
    }

    #[test]
    fn crests_pass_as_often_as_the_hand_crosses_them() {
        let plane = Ripples::new(&texture(Some(vec![3.0, 4.0]))).unwrap();
        // 8 m from crest to crest: 16 m/s along the wave are two a second.
        assert!((plane.frequency(Vector([9.6, 12.8, 0.0])) - 2.0).abs() < 1e-15);
        assert!(plane.frequency(Vector([-4.0, 3.0, 0.0])).abs() < 1e-15);
        let product = Ripples::new(&texture(None)).unwrap();
        assert!((product.frequency(Vector([4.0, -16.0, 0.0])) - 2.0).abs() < 1e-15);
    }

    #[test]
    fn a_texture_is_whole_to_a_quarter_of_the_rate_and_gone_at_half() {
        let part = |frequency: f64| rendered_part(frequency, 1000.0);
        assert_eq!(
            [0.0, 100.0, 250.0, 375.0, 500.0, 1e9].map(part),
            [1.0, 1.0, 1.0, 0.5, 0.0, 0.0]
        );
        assert_eq!(part(f64::NAN), 0.0);
        for hertz in 0..600 {
            let (here, next) = (part(f64::from(hertz)), part(f64::from(hertz + 1)));
            // The steepest slope of the fade is 1.5 over 250 Hz.
            assert!((0.0..=1.5 / 250.0).contains(&(here - next)), "{hertz} Hz");
        }
    }
}
