// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The surface of a body: a [`Material`] prepared for the servo.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod magnet;
mod ring;
mod ripples;
mod strata;

use crate::{Material, TextureKind};
use palpate_field::{Point, Shape, SpaceShape, Vector};

use crate::curvature::{Solver, surface_displacement};
use crate::error::HapticsError;
use palpate_device::{NumberError, limited};
use palpate_safety::Impedance;

pub(crate) use magnet::Pull;
pub(crate) use ring::{Ring, Ringing};
pub use ripples::Passing;
pub(crate) use ripples::Ripples;
pub(crate) use strata::{Friction, Strata, Stratum};

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
/// `n = s / ‖s‖` and the velocity `v` of the device point relative to the body, the force on
/// the hand is
///
/// ```text
/// F = N(‖s‖) n − B min(v·n, 0) n − V v + texture + ring
/// ```
///
/// - `N(d) = ∫ K`, with the stiffness `K` of the layer at each depth: the spring of Zilles and
///   Salisbury, "A constraint-based god-object method for haptic display" (1995), section 3.
/// - The damper `B` acts on the approach alone, so it never pulls the hand in. `B` and the
///   viscosity `V` are those of the layer at the depth of the hand.
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
        let Press { stretch, velocity, proxy, rate, has_dampers } = press;
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
        let approach = if has_dampers { (-velocity.dot(normal)).max(0.0) } else { 0.0 };
        normal * (spring + layer.damping * approach) - slope * spring + drag
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
        }
    }
}
