// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Surfaces of bodies.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_device::{NumberError, limited};
use palpate_field::{Point, Shape, SpaceShape, Vector};
use palpate_safety::Impedance;

use crate::curvature::{Solver, surface_displacement};
use crate::error::HapticsError;
use crate::{Impact, Magnet, Material, TextureKind};

pub use ripples::Passing;
pub(crate) use ripples::Ripples;
pub(crate) use strata::{Friction, Strata, Stratum};

mod ripples;
mod strata;

/// The distance at which the curvature below a texture is measured, as a part of the
/// wavelength: truncation and rounding then stay far below a nanojoule.
const FAR: f64 = 1e-6;

/// Relative residual to which a texture's slope on a curved surface is solved.
const SOLVED: f64 = 1e-8;

/// The most that curvature steepens the slope of a texture: at a centre of curvature the slope
/// would grow without bound.
const STEEPER: f64 = 8.0;

/// How a hand presses on a body, in body coordinates.
#[derive(Clone, Copy)]
pub(crate) struct Press {
    /// From the device point to the proxy [m].
    pub(crate) stretch: Vector<f64, 3>,
    /// The unit normal of the touched face.
    pub(crate) normal: Vector<f64, 3>,
    /// The velocity of the device point relative to the body [m/s].
    pub(crate) velocity: Vector<f64, 3>,
    /// The proxy [m].
    pub(crate) proxy: Point<3>,
    /// Ticks a second [Hz].
    pub(crate) rate: f64,
    /// Whether the dampers act.
    pub(crate) has_dampers: bool,
}

/// A material prepared for the servo.
///
/// With the proxy `p`, the device point `x`, the stretch `s = p − x`, its direction
/// `u = s / ‖s‖`, the unit normal `n` of the touched face and the velocity `v` of the device point
/// relative to the body, the force on the hand is
///
/// ```text
/// F = N(‖s‖) u − B min(v·n, 0) n − V v + texture + ring
/// ```
///
/// - `N(d) = ∫ K`, with the stiffness `K` of the layer at each depth: the spring of Zilles and
///   Salisbury, "A constraint-based god-object method for haptic display" (1995), section 3.
/// - The damper `B` acts on the approach alone, so it never pulls the hand in, and along the
///   normal, so a hand that slides at a constant depth does not feel it. `B` and the viscosity
///   `V` are those of the layer at the depth of the hand.
/// - A texture of kind *height* is the force of the potential `∫ N` at the depth `‖s‖ + w(p) −
///   a`, with the height `w` of the wave of amplitude `a` at the proxy: the hand is pushed
///   harder over a crest, and sideways down its slope (Minsky, "Computational haptics", 1995,
///   chapter 4). The crests are at the surface and the troughs below it, so the force starts
///   gently wherever the hand enters. Below a curved surface the proxy moves farther than the
///   hand, or less far; the slope is converted to displacements of the hand, so a closed path
///   gives no energy. Where crests pass faster than a quarter of the rate, `w` fades: it is whole
///   up to there, and gone at half of the rate, above which a wave would be felt at another
///   frequency. While the fade changes, a closed path may give energy: at most `2 a N` for each
///   crest that is climbed fast and descended slowly, with the normal force `N`; the passivity
///   stage of a device's safety chain counts it. A texture of kind *displacement* is part of the body's shape, not of its
///   force.
/// - An impact rings as a decaying sinusoid along the normal (Okamura, Cutkosky and
///   Dennerlein, "Reality-based models for vibration feedback", 2001).
///
/// Beside a body of another stiffness, `N` blends with that of the other, over a length at their
/// seam, and a sideways force keeps the energy.
///
/// Friction is not a force of its own: it holds the proxy back (see [`Proxy`](crate::Proxy)).
///
/// # Examples
///
/// ```
/// use palpate_haptics::{Material, Surface};
///
/// # fn main() -> Result<(), palpate_haptics::HapticsError> {
/// let wood = Surface::new(&Material { stiffness: 800.0, ..Material::default() })?;
/// assert_eq!(wood.stiffness(), 800.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    pub(crate) strata: Strata,
    relative_stiffness: Option<f64>,
    pub(crate) magnet: Option<Pull>,
    /// A texture of kind *height*.
    ripples: Option<Ripples>,
    /// A texture of kind *displacement*.
    relief: Option<Ripples>,
    impact: Option<Ring>,
    /// The least length of a seam with another body [m].
    pub(crate) seam: Option<f64>,
}

impl TryFrom<&Material> for Surface {
    type Error = HapticsError;

    fn try_from(material: &Material) -> Result<Self, HapticsError> {
        Self::new(material)
    }
}

impl TryFrom<Material> for Surface {
    type Error = HapticsError;

    fn try_from(material: Material) -> Result<Self, HapticsError> {
        Self::new(&material)
    }
}

impl Surface {
    /// Prepares a material.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if a number of the material breaks its rule.
    #[inline(never)]
    pub fn new(material: &Material) -> Result<Self, HapticsError> {
        let (mut ripples, mut relief) = (None, None);
        if let Some(texture) = &material.texture {
            let waves = Some(Ripples::new(texture)?);
            match texture.kind {
                TextureKind::Height => ripples = waves,
                TextureKind::Displacement => relief = waves,
            }
        }
        let part = material.relative_stiffness;
        if let Some(part) = part.filter(|part| !(0.0 < *part && *part <= 1.0)) {
            let rule = "more than 0 and at most 1";
            return Err(NumberError::new("relative_stiffness", rule, part, "").into());
        }
        Ok(Self {
            strata: Strata::new(material)?,
            relative_stiffness: part,
            magnet: material.magnet.as_ref().map(Pull::new).transpose()?,
            ripples,
            relief,
            impact: material.impact.as_ref().map(Ring::new).transpose()?,
            seam: material
                .seam
                .map(|seam| NumberError::check_not_negative("seam", seam, "m"))
                .transpose()?,
        })
    }

    /// A smooth surface, without friction, of `stiffness` [N/m] and `damping` [N·s/m].
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the stiffness is not positive, the damping negative, or
    /// either not finite.
    ///
    /// ```
    /// use palpate_haptics::Surface;
    ///
    /// let error = Surface::smooth(-3.0, 0.0).unwrap_err();
    /// assert_eq!(error.to_string(), "stiffness must be positive and finite, got -3 N/m");
    /// ```
    pub fn smooth(stiffness: f64, damping: f64) -> Result<Self, HapticsError> {
        Self::new(&Material {
            stiffness: NumberError::check_positive("stiffness", stiffness, "N/m")?,
            damping: NumberError::check_not_negative("damping", damping, "N·s/m")?,
            static_friction: 0.0,
            dynamic_friction: 0.0,
            ..Material::default()
        })
    }

    /// The stiffness at the surface [N/m].
    #[must_use]
    pub fn stiffness(&self) -> f64 {
        self.strata.stiffness()
    }

    /// The damping at the surface [N·s/m].
    #[must_use]
    pub fn damping(&self) -> f64 {
        self.strata.damping()
    }

    /// Whether the stiffness is a part of what the device renders.
    pub(crate) fn is_relative(&self) -> bool {
        self.relative_stiffness.is_some()
    }

    /// This surface on a device that renders at most a stiffness of `most` [N/m]: if the material
    /// asks for a part of that, the stiffest layer has it, and the others are in proportion.
    pub(crate) fn on_device(&self, most: f64) -> Self {
        let Some(part) = self.relative_stiffness.filter(|_| most < f64::INFINITY) else {
            return self.clone();
        };
        // A little less, so that rounding takes no stiffness above the most.
        let stiffness = part * most * (1.0 - 4.0 * f64::EPSILON);
        self.scaled(stiffness / self.strata.stiffest(), 1.0)
    }

    /// Stiffness and damping of each layer.
    pub(crate) fn impedances(
        &self,
    ) -> impl Iterator<Item = Result<Impedance, HapticsError>> + '_ {
        self.strata.impedances()
    }

    /// This surface with the stiffness and the damping of all layers multiplied by these factors.
    #[must_use]
    #[inline(never)]
    pub fn scaled(&self, stiffness: f64, damping: f64) -> Self {
        Self { strata: self.strata.scaled(stiffness, damping), ..self.clone() }
    }

    /// The amplitude of the texture of kind *height* [m]; `None` without one.
    #[must_use]
    pub fn wave_height(&self) -> Option<f64> {
        self.ripples.as_ref().map(Ripples::height)
    }

    /// The largest lateral stiffness of the texture of kind *height* under a normal force [N/m];
    /// `None` without such a texture.
    ///
    /// The lateral force is `−N w'(x)`, with the normal force `N` and the wave `w`, so the stiffness
    /// is at most `N a (2π / λ)²`, with the amplitude `a` and the wavelength `λ`. With `N = K d` it
    /// grows with the depth `d` of the hand. Under the largest force of a device it does not depend on
    /// `K`: a softer body lets the hand sink in until the force is the same. So only a lower wave is
    /// less stiff.
    pub(crate) fn lateral_stiffness(&self, force: f64) -> Option<f64> {
        self.ripples.as_ref().map(|ripples| force * ripples.bend())
    }

    /// This surface with `part` of the amplitude of its texture of kind *height*.
    pub(crate) fn with_lower_waves(&self, part: f64) -> Self {
        let ripples = self.ripples.as_ref().map(|ripples| ripples.lowered(part));
        Self { ripples, ..self.clone() }
    }

    /// The surface with its textures on a body of so many dimensions, 2 for a planar shape.
    ///
    /// # Errors
    ///
    /// If the direction of a texture has another dimension.
    pub(crate) fn on_body(self, dimension: usize) -> Result<Self, HapticsError> {
        let fit = |waves: Option<Ripples>| waves.map(|w| w.on_body(dimension)).transpose();
        Ok(Self { ripples: fit(self.ripples)?, relief: fit(self.relief)?, ..self })
    }

    /// The shape with the surface's texture of kind *displacement*, if there is one.
    ///
    /// # Errors
    ///
    /// If the shape cannot be displaced.
    pub(crate) fn carved(&self, shape: SpaceShape) -> Result<SpaceShape, HapticsError> {
        let Some(relief) = &self.relief else { return Ok(shape) };
        let height = relief.height();
        Ok(match shape.flat() {
            Some(flat) => {
                flat.clone().displaced(Shape::from_kernel(relief.clone()), height)?.into()
            }
            None => {
                let shape = shape.shape().clone();
                shape.displaced(Shape::from_kernel(relief.clone()), height)?.into()
            }
        })
    }

    /// The force on the hand [N], in body coordinates.
    ///
    /// `level` is the number of punctured layers. `turn(displacement, distance)` gives the
    /// change of the unit normal along a displacement from the proxy, extrapolated from the
    /// first `distance` metres. Only textures call it, at most once per dimension of the
    /// surface.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[inline(always)]
    pub(crate) fn force(
        &self,
        level: usize,
        press: Press,
        mut turn: impl FnMut(Vector<f64, 3>, f64) -> Vector<f64, 3>,
    ) -> Vector<f64, 3> {
        let Press { stretch, normal: face, velocity, proxy, rate, has_dampers } = press;
        let depth = stretch.norm();
        let layer = self.strata.at(level, depth);
        let drag = if has_dampers { velocity * -layer.viscosity } else { Vector::ZERO };
        if depth == 0.0 {
            return drag;
        }
        let normal = stretch * (1.0 / depth);
        let (mut push, mut slope) = (depth, Vector::ZERO);
        if let Some(ripples) = &self.ripples {
            let (height, gradient) = ripples.at(proxy);
            let Passing { part, .. } = ripples.passing(velocity, normal, rate);
            // If crests rose above the surface, a hand that enters at a crest would feel a jump
            // of force, and a hand that leaves through a trough would not give the energy back.
            push = (depth + height * part - ripples.height()).max(0.0);
            // Only the gradient along the surface counts: across the surface the wave does not
            // change the depth.
            let along = gradient - normal * gradient.dot(normal);
            // Below a curved surface the proxy moves farther than the hand, or less far.
            let far = FAR * ripples.wavelength();
            let dimensions = ripples.dimension() - 1;
            let solver = Solver { solved: SOLVED, dimensions };
            let seen = surface_displacement(|way| turn(way, far), along, depth, solver);
            slope = limited(seen.unwrap_or(along), STEEPER * along.norm()) * part;
        }
        let spring = self.strata.force(level, push);
        // Without friction the stretch is along the normal, and holds also in a corner.
        let face = if layer.friction.tilts(stretch, face) { face } else { normal };
        let approach = if has_dampers { (-velocity.dot(face)).max(0.0) } else { 0.0 };
        let damper = layer.damping * approach;
        normal * (spring + damper) + (face - normal) * damper - slope * spring + drag
    }

    /// How the crests of the surface's height texture pass under a hand of this velocity [m/s]
    /// along a surface with this unit normal, both in body coordinates, at `rate` [Hz]. `None`
    /// without such a texture.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn passing(
        &self,
        velocity: Vector<f64, 3>,
        normal: Vector<f64, 3>,
        rate: f64,
    ) -> Option<Passing> {
        self.ripples.as_ref().map(|ripples| ripples.passing(velocity, normal, rate))
    }

    /// The ringing that an impact at `speed` [m/s] along the normal starts, at `rate` [Hz].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn ringing(&self, speed: f64, rate: f64) -> Ringing {
        self.impact.as_ref().map_or(Ringing::SILENT, |ring| ring.struck(speed, rate))
    }
}

impl Default for Surface {
    /// Smooth, 500 N/m and 1 N·s/m: firm, and passive at 1 kHz on a device with 1.25 N·s/m of
    /// physical damping.
    fn default() -> Self {
        let material =
            Material { static_friction: 0.0, dynamic_friction: 0.0, ..Material::default() };
        let strata = Strata::of(&material);
        Self {
            strata,
            relative_stiffness: None,
            magnet: None,
            ripples: None,
            relief: None,
            impact: None,
            seam: None,
        }
    }
}

/// The height of the largest pull, as a part of the reach.
const PEAK: f64 = 0.25;

/// A pull that snaps the hand onto a surface.
///
/// With height above the surface, the pull rises linearly from zero to its largest value at a
/// quarter of the reach, and falls linearly to zero at the reach. The pull depends on the
/// height alone, so it does no work over a closed path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pull {
    force: f64,
    /// The height at which the pull ends [m].
    pub(crate) reach: f64,
}

impl Pull {
    pub(crate) fn new(magnet: &Magnet) -> Result<Self, HapticsError> {
        let force = NumberError::check_positive("magnet.force", magnet.force, "N")?;
        Ok(Self {
            force,
            reach: NumberError::check_positive("magnet.distance", magnet.distance, "m")?,
        })
    }

    /// The steepest change of the pull, next to the surface [N/m].
    pub(crate) fn stiffness(&self) -> f64 {
        self.force / (PEAK * self.reach)
    }

    /// This pull with `part` of its force.
    pub(crate) fn scaled(&self, part: f64) -> Self {
        Self { force: self.force * part, ..*self }
    }

    /// The pull at `height` above the surface [N].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn at(&self, height: f64) -> f64 {
        let part = height / self.reach;
        let share = (part / PEAK).min((1.0 - part) / (1.0 - PEAK));
        // Written so that NaN gives no pull.
        if share > 0.0 { self.force * share } else { 0.0 }
    }
}

/// Ringing ends below this part of its first amplitude.
const SILENCE: f64 = 1e-4;

/// A decaying sinusoid for each tap: `a · v · exp(−d·t) · sin(2π·f·t)` for a tap at normal
/// speed `v` (Okamura, Cutkosky and Dennerlein 2001).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ring {
    amplitude: f64,
    frequency: f64,
    decay: f64,
}

impl Ring {
    pub(crate) fn new(impact: &Impact) -> Result<Self, HapticsError> {
        Ok(Self {
            amplitude: NumberError::check_not_negative(
                "impact.amplitude",
                impact.amplitude,
                "N·s/m",
            )?,
            frequency: NumberError::check_positive("impact.frequency", impact.frequency, "Hz")?,
            decay: NumberError::check_not_negative("impact.decay", impact.decay, "1/s")?,
        })
    }

    /// The ringing that a tap at `speed` [m/s] starts, at `rate` [Hz].
    ///
    /// A frequency above half the rate would only produce its alias, so the tap is silent; so
    /// is a tap whose amplitude overflows.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn struck(&self, speed: f64, rate: f64) -> Ringing {
        let loudest = self.amplitude * speed;
        // Both parts of the phasor may add up to twice the amplitude.
        if self.frequency >= 0.5 * rate || !(2.0 * loudest).is_finite() {
            return Ringing::SILENT;
        }
        let angle = 2.0 * std::f64::consts::PI * self.frequency / rate;
        let shrink = libm::exp(-self.decay / rate);
        Ringing {
            force: 0.0,
            quadrature: loudest,
            sin: libm::sin(angle) * shrink,
            cos: libm::cos(angle) * shrink,
            silence: SILENCE * loudest,
        }
    }
}

/// Ringing in progress: a phasor that rotates and decays with each tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ringing {
    /// The force along the normal [N].
    force: f64,
    quadrature: f64,
    /// The sine and the cosine of the angle of a tick, both shrunk by the decay in a tick.
    sin: f64,
    cos: f64,
    /// The amplitude at which it ends [N].
    silence: f64,
}

impl Ringing {
    pub(crate) const SILENT: Self =
        Self { force: 0.0, quadrature: 0.0, sin: 0.0, cos: 0.0, silence: 0.0 };

    /// The force of this tick along the normal [N]; advances to the next tick.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn step(&mut self) -> f64 {
        let force = self.force;
        if force.abs() + self.quadrature.abs() <= self.silence {
            *self = Self::SILENT;
            return force;
        }
        let Self { sin, cos, .. } = *self;
        self.force = force * cos + self.quadrature * sin;
        self.quadrature = self.quadrature * cos - force * sin;
        force
    }
}

#[cfg(test)]
mod magnet_tests {
    use super::*;

    #[test]
    fn the_pull_is_greatest_at_a_quarter_of_its_reach() {
        let pull = Pull { force: 3.0, reach: 0.5 };
        let pulls = [-0.1, 0.0, 0.0625, 0.125, 0.3125, 0.5, 0.6, f64::NAN].map(|h| pull.at(h));
        assert_eq!(pulls, [0.0, 0.0, 1.5, 3.0, 1.5, 0.0, 0.0, 0.0]);
    }
}

#[cfg(test)]
mod ring_tests {
    use super::*;

    #[test]
    fn a_tap_rings_as_its_formula_says() {
        let impact =
            Impact { description: None, amplitude: 3.0, frequency: 100.0, decay: 40.0 };
        let ring = Ring::new(&impact).unwrap();
        let mut ringing = ring.struck(0.5, 1000.0);
        for tick in 0..200 {
            let time = 1e-3 * f64::from(tick);
            let turn = 2.0 * std::f64::consts::PI * 100.0 * time;
            let expected = 1.5 * (-40.0 * time).exp() * turn.sin();
            assert!((ringing.step() - expected).abs() < 1e-12, "{tick}");
        }
        for _ in 0..1000 {
            ringing.step();
        }
        assert_eq!(ringing, Ringing::SILENT);
        assert_eq!(ring.struck(0.5, 150.0), Ringing::SILENT);
    }

    /// A tap at nearly the largest number, as from a broken device, would ring as NaN without
    /// end and remove the force of the spring. Found by fuzzing.
    #[test]
    fn no_blow_rings_without_end() {
        let impact =
            Impact { description: None, amplitude: 2.0, frequency: 100.0, decay: 30.0 };
        let ring = Ring::new(&impact).unwrap();
        for speed in [0.2 * f64::MAX, 0.45 * f64::MAX, f64::MAX, f64::INFINITY, f64::NAN] {
            let mut ringing = ring.struck(speed, 1000.0);
            for _ in 0..1000 {
                assert!(ringing.step().is_finite(), "{speed}");
            }
            assert_eq!(ringing, Ringing::SILENT, "{speed}");
        }
    }
}
