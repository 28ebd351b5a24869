// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The layers of a material by depth: stiffness, damping, friction, and pop-through.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::Material;

use crate::error::HapticsError;
use palpate_device::NumberError;
use palpate_field::Vector;
use palpate_safety::Impedance;

/// The stiffness used for a layer without a spring [N/m]: too small for a hand to feel.
const LEAST_STIFFNESS: f64 = 1e-9;

/// Coulomb friction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Friction {
    /// Largest ratio of tangential to normal force while sticking.
    pub(crate) fixed: f64,
    /// Ratio of tangential to normal force while slipping.
    pub(crate) slipping: f64,
}

/// A stretch in the cone of friction may be beyond it by this part, from the search for the proxy.
const CONE: f64 = 1e-3;

impl Friction {
    /// Whether friction alone explains that a stretch is not along the unit `normal` of a face. A
    /// stretch beyond the cone of friction is held by a second face too.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn tilts(&self, stretch: Vector<f64, 3>, normal: Vector<f64, 3>) -> bool {
        let height = stretch.dot(normal);
        let along = (stretch - normal * height).norm();
        let most = self.fixed.max(self.slipping) * (1.0 + CONE) * height;
        along < most
    }
}

/// The condition under which a layer gives way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PopThrough {
    /// The force at which the layer gives way [N].
    pub(crate) force: f64,
    /// The distance that the hand must keep from the body before the layer is restored [m].
    pub(crate) distance: f64,
}

/// A layer: properties from a depth on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stratum {
    /// The depth below the surface at which the layer begins [m].
    pub(crate) depth: f64,
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    pub(crate) friction: Friction,
    pub(crate) viscosity: f64,
    /// The condition under which the layer's top gives way.
    pub(crate) pop_through: Option<PopThrough>,
}

/// The layers of a material, the outermost first; at least one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Strata {
    outermost: Stratum,
    deeper: Box<[Stratum]>,
}

impl Strata {
    /// The layers of a material, with checked numbers.
    pub(crate) fn new(material: &Material) -> Result<Self, HapticsError> {
        let strata = Self::of(material);
        let mut above = 0.0;
        for stratum in strata.all() {
            NumberError::check_not_negative("stiffness", stratum.stiffness, "N/m")?;
            NumberError::check_not_negative("damping", stratum.damping, "N·s/m")?;
            NumberError::check_not_negative("viscosity", stratum.viscosity, "N·s/m")?;
            NumberError::check_not_negative("static_friction", stratum.friction.fixed, "")?;
            NumberError::check_not_negative("dynamic_friction", stratum.friction.slipping, "")?;
            NumberError::check_not_negative(
                "depth of a layer below the one above",
                stratum.depth - above,
                "m",
            )?;
            above = stratum.depth;
            if let Some(pop) = &stratum.pop_through {
                NumberError::check_positive("pop_through.force", pop.force, "N")?;
                NumberError::check_not_negative("pop_through.distance", pop.distance, "m")?;
            }
        }
        Ok(strata)
    }

    /// The layers of a material, unchecked. A property that a layer omits is inherited from the
    /// layer above.
    pub(crate) fn of(material: &Material) -> Self {
        let pop_through = |pop: &Option<crate::PopThrough>| {
            pop.as_ref().map(|pop| PopThrough { force: pop.force, distance: pop.distance })
        };
        let outermost = Stratum {
            depth: 0.0,
            stiffness: material.stiffness,
            damping: material.damping,
            friction: Friction {
                fixed: material.static_friction,
                slipping: material.dynamic_friction,
            },
            viscosity: material.viscosity,
            pop_through: pop_through(&material.pop_through),
        };
        let mut above = outermost;
        let deeper = material.layers.iter().map(|layer| {
            above = Stratum {
                depth: layer.depth,
                stiffness: layer.stiffness.unwrap_or(above.stiffness),
                damping: layer.damping.unwrap_or(above.damping),
                friction: Friction {
                    fixed: layer.static_friction.unwrap_or(above.friction.fixed),
                    slipping: layer.dynamic_friction.unwrap_or(above.friction.slipping),
                },
                viscosity: layer.viscosity.unwrap_or(above.viscosity),
                pop_through: pop_through(&layer.pop_through),
            };
            above
        });
        Self { outermost, deeper: deeper.collect() }
    }

    fn all(&self) -> impl Iterator<Item = &Stratum> + Clone {
        std::iter::once(&self.outermost).chain(&self.deeper)
    }

    /// Stiffness and damping of each layer.
    pub(crate) fn impedances(
        &self,
    ) -> impl Iterator<Item = Result<Impedance, HapticsError>> + '_ {
        // A layer without a spring still has a damper, which must be accepted.
        self.all().map(|layer| {
            let stiffness = layer.stiffness.max(LEAST_STIFFNESS);
            Ok(Impedance::new(stiffness, layer.damping)?)
        })
    }

    pub(crate) fn stiffness(&self) -> f64 {
        self.outermost.stiffness
    }

    /// The largest stiffness of a layer [N/m].
    pub(crate) fn stiffest(&self) -> f64 {
        self.all().map(|layer| layer.stiffness).fold(LEAST_STIFFNESS, f64::max)
    }

    pub(crate) fn damping(&self) -> f64 {
        self.outermost.damping
    }

    pub(crate) fn scaled(&self, stiffness: f64, damping: f64) -> Self {
        let scaled = |stratum: &Stratum| Stratum {
            stiffness: stiffness * stratum.stiffness,
            damping: damping * stratum.damping,
            ..*stratum
        };
        Self {
            outermost: scaled(&self.outermost),
            deeper: self.deeper.iter().map(scaled).collect(),
        }
    }

    /// The number of layers.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn count(&self) -> usize {
        1 + self.deeper.len()
    }

    /// The layer whose top constrains the proxy after `level` layers were punctured; `None`
    /// after the last one.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn top(&self, level: usize) -> Option<&Stratum> {
        match level.checked_sub(1) {
            None => Some(&self.outermost),
            Some(deeper) => self.deeper.get(deeper),
        }
    }

    /// The layer at `depth` [m] below the top of layer `level`.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn at(&self, level: usize, depth: f64) -> &Stratum {
        let top = self.top(level).unwrap_or(&self.outermost);
        let depth = top.depth + depth;
        let reached = self.deeper.iter().skip(level).take_while(|layer| layer.depth <= depth);
        reached.last().unwrap_or(top)
    }

    /// The force of the springs `depth` [m] below the top of layer `level` [N]: the integral
    /// of the stiffness.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn force(&self, level: usize, depth: f64) -> f64 {
        self.integral(level, f64::INFINITY, depth)
    }

    /// The energy that the springs store `depth` [m] below the surface [J].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn energy(&self, depth: f64) -> f64 {
        let (mut energy, mut above) = (0.0, &self.outermost);
        let stored = |layer: &Stratum, below: f64| {
            let way = below - layer.depth;
            way * (self.force(0, layer.depth) + 0.5 * layer.stiffness * way)
        };
        for layer in self.deeper.iter().take_while(|layer| layer.depth < depth) {
            energy += stored(above, layer.depth);
            above = layer;
        }
        energy + stored(above, depth)
    }

    /// Whether the springs of all layers are those of `other`.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn has_springs_of(&self, other: &Self) -> bool {
        let springs = |layer: &Stratum| (layer.depth, layer.stiffness);
        self.all().map(springs).eq(other.all().map(springs))
    }

    /// The force of the springs over the depth, `depth` [m] below the top of layer `level` [N/m].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn secant(&self, level: usize, depth: f64) -> f64 {
        let top = self.top(level).unwrap_or(&self.outermost);
        let is_in_top =
            self.deeper.get(level).is_none_or(|layer| depth <= layer.depth - top.depth);
        if is_in_top { top.stiffness } else { self.force(level, depth) / depth }
    }

    /// The force of the springs `depth` [m] below the surface, with every stiffness limited to
    /// `most` [N/m].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn force_up_to(&self, most: f64, depth: f64) -> f64 {
        self.integral(0, most, depth)
    }

    fn integral(&self, level: usize, most: f64, depth: f64) -> f64 {
        let top = self.top(level).unwrap_or(&self.outermost);
        let (mut force, mut stiffness, mut from) = (0.0, top.stiffness.min(most), 0.0);
        for layer in self.deeper.iter().skip(level) {
            let begins = layer.depth - top.depth;
            if begins >= depth {
                break;
            }
            force += stiffness * (begins - from);
            (stiffness, from) = (layer.stiffness.min(most), begins);
        }
        force + stiffness * (depth - from)
    }
}

#[cfg(test)]
mod tests {
    use crate::Layer;

    use super::*;

    fn layered() -> Strata {
        let layer =
            |depth, stiffness| Layer { depth, stiffness: Some(stiffness), ..Layer::default() };
        let layers = vec![layer(0.25, 16.0), layer(0.5, 2.0)];
        Strata::new(&Material { stiffness: 4.0, layers, ..Material::default() }).unwrap()
    }

    #[test]
    fn the_force_is_the_integral_of_the_stiffness() {
        let strata = layered();
        for (depth, force) in [(0.0, 0.0), (0.25, 1.0), (0.5, 5.0), (1.5, 7.0)] {
            assert_eq!(strata.force(0, depth), force);
        }
        assert_eq!([0.1, 0.5, 1.0].map(|depth| strata.secant(0, depth)), [4.0, 10.0, 6.0]);
        assert_eq!([0.1, 0.5].map(|depth| strata.secant(1, depth)), [16.0, 9.0]);
        for (depth, energy) in [(0.0, 0.0), (0.25, 0.125), (0.5, 0.875), (1.5, 6.875)] {
            assert_eq!(strata.energy(depth), energy);
        }
        // From the top of the second layer on.
        for (depth, force) in [(0.0, 0.0), (0.25, 4.0), (0.5, 4.5)] {
            assert_eq!(strata.force(1, depth), force);
        }
    }

    #[test]
    fn layers_begin_at_their_depths() {
        let strata = layered();
        let stiffness = |level, depth| strata.at(level, depth).stiffness;
        assert_eq!([0.0, 0.2, 0.25, 0.6].map(|d| stiffness(0, d)), [4.0, 4.0, 16.0, 2.0]);
        assert_eq!([0.0, 0.2, 0.25].map(|d| stiffness(1, d)), [16.0, 16.0, 2.0]);
        assert!(strata.top(2).is_some() && strata.top(3).is_none());
    }

    #[test]
    fn wrong_numbers_are_named() {
        let material = Material { viscosity: -1.0, ..Material::default() };
        let error = Strata::new(&material).unwrap_err();
        let text = "viscosity must be zero or more and finite, got -1 N·s/m";
        assert_eq!(error.to_string(), text);
    }
}
