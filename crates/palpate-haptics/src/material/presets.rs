// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Materials by name.
//!
//! A device cannot render the stiffness of a real surface: wood has some 10⁵ N/m under a
//! finger. The presets differ from each other within what common desktop devices render, up to
//! 1000 N/m: harder materials are stiffer and ring higher when tapped, which is how people
//! judge hardness through a tool (Okamura, Cutkosky and Dennerlein 2001; Kuchenbecker, Fiene
//! and Niemeyer 2006).

use palpate_field::UnknownName;

use crate::{Impact, Layer, Magnet, Material, PopThrough, Texture, TextureKind};

/// A material with a name.
struct Preset {
    name: &'static str,
    material: fn() -> Material,
}

/// Declares presets: the source of the numbers, the name, the material.
///
/// A number without a source is called chosen: it is plausible and sets the material apart, but
/// is not measured.
macro_rules! presets {
    ($(#[doc = $source:literal] $name:ident => $material:expr,)*) => {
        const PRESETS: &[Preset] = &[
            $(Preset { name: stringify!($name), material: Material::$name },)*
        ];

        impl Material {
            $(
                #[doc = $source]
                #[must_use]
                pub fn $name() -> Self {
                    let description = Some($source.trim().to_owned());
                    Self { description, ..$material }
                }
            )*
        }
    };
}

presets! {
    /// Soft rubber. Its tap is low and short, in the order of Okamura, Cutkosky and Dennerlein (2001); dry friction near 1 is usual in tables; the rest is chosen.
    rubber => Material {
        stiffness: 300.0,
        damping: 2.0,
        static_friction: 1.0,
        dynamic_friction: 0.8,
        impact: Some(Impact { amplitude: 0.5, frequency: 30.0, decay: 60.0, description: None }),
        ..Material::default()
    },
    /// Planed wood. Its tap is between those of rubber and metal, in the order of Okamura, Cutkosky and Dennerlein (2001); friction 0.4 and 0.3 are usual in tables for dry wood; the rest is chosen.
    wood => Material {
        stiffness: 700.0,
        damping: 1.5,
        static_friction: 0.4,
        dynamic_friction: 0.3,
        impact: Some(Impact { amplitude: 1.5, frequency: 100.0, decay: 80.0, description: None }),
        ..Material::default()
    },
    /// Bare aluminium. Its tap is high and long, in the order of Okamura, Cutkosky and Dennerlein (2001); the rest is chosen.
    aluminium => Material {
        stiffness: 900.0,
        damping: 1.0,
        static_friction: 0.35,
        dynamic_friction: 0.25,
        impact: Some(Impact { amplitude: 3.0, frequency: 300.0, decay: 90.0, description: None }),
        ..Material::default()
    },
    /// Polished steel. All numbers are chosen: as aluminium, stiffer, smoother, and ringing longer.
    steel => Material {
        stiffness: 1000.0,
        damping: 1.0,
        static_friction: 0.25,
        dynamic_friction: 0.15,
        impact: Some(Impact { amplitude: 3.5, frequency: 350.0, decay: 60.0, description: None }),
        ..Material::default()
    },
    /// Clean glass. All numbers are chosen: hard, slippery, a high and clear tap.
    glass => Material {
        stiffness: 1000.0,
        damping: 0.8,
        static_friction: 0.15,
        dynamic_friction: 0.1,
        impact: Some(Impact { amplitude: 3.0, frequency: 400.0, decay: 70.0, description: None }),
        ..Material::default()
    },
    /// Upholstery foam. All numbers are chosen: soft, slow to give, mute.
    foam => Material {
        viscosity: 0.5,
        stiffness: 120.0,
        damping: 3.0,
        static_friction: 0.6,
        dynamic_friction: 0.5,
        ..Material::default()
    },
    /// Skin over soft tissue. All numbers are chosen: soft, stiffer once it is pressed in, mute; measured skin varies by more than a factor of ten with site and person.
    skin => Material {
        layers: vec![layer(0.004, 400.0)],
        stiffness: 200.0,
        damping: 1.5,
        static_friction: 0.6,
        dynamic_friction: 0.5,
        ..Material::default()
    },
    /// Corrugated cardboard. All numbers are chosen; flutes 6.5 mm apart are those of grade B.
    cardboard => Material {
        texture: Some(texture(TextureKind::Height, 1e-4, 6.5e-3)),
        stiffness: 450.0,
        damping: 1.5,
        static_friction: 0.45,
        dynamic_friction: 0.35,
        impact: Some(Impact { amplitude: 0.8, frequency: 70.0, decay: 120.0, description: None }),
        ..Material::default()
    },
    /// Coarse sandpaper. Grains 0.3 mm apart are those of grit P60 to P80; the rest is chosen.
    sandpaper => Material {
        texture: Some(texture(TextureKind::Height, 5e-5, 3e-4)),
        stiffness: 700.0,
        damping: 1.0,
        static_friction: 0.9,
        dynamic_friction: 0.75,
        ..Material::default()
    },
    /// A surface that draws the hand on from 5 mm away. All numbers are chosen.
    magnet => Material {
        magnet: Some(Magnet { description: None, force: 1.0, distance: 5e-3 }),
        stiffness: 700.0,
        damping: 1.0,
        static_friction: 0.4,
        dynamic_friction: 0.3,
        ..Material::default()
    },
    /// A membrane that gives way at 1.5 N, as a needle goes through it. All numbers are chosen, in the order of the needle forces of Okamura, Simone and O'Leary (2004).
    membrane => Material {
        pop_through: Some(pop_through(1.5)),
        stiffness: 500.0,
        damping: 1.0,
        static_friction: 0.3,
        dynamic_friction: 0.2,
        ..Material::default()
    },
    /// Skin that gives way, fat that does not hold a tool, muscle below. All numbers are chosen, in the order of the needle forces of Okamura, Simone and O'Leary (2004).
    layered_tissue => Material {
        pop_through: Some(pop_through(1.0)),
        layers: vec![
            Layer { viscosity: Some(2.0), ..layer(0.003, 100.0) },
            Layer {
                viscosity: Some(4.0),
                pop_through: Some(pop_through(2.0)),
                ..layer(0.012, 350.0)
            },
        ],
        stiffness: 300.0,
        damping: 1.0,
        static_friction: 0.5,
        dynamic_friction: 0.4,
        ..Material::default()
    },
}

impl Material {
    /// The names of the presets.
    ///
    /// ```
    /// use palpate_haptics::Material;
    ///
    /// assert!(Material::preset_names().any(|name| name == "glass"));
    /// ```
    pub fn preset_names() -> impl Iterator<Item = &'static str> {
        PRESETS.iter().map(|preset| preset.name)
    }

    /// The preset called `name`; its description gives the source of each number, or says that
    /// it is chosen.
    ///
    /// # Errors
    ///
    /// [`UnknownName`], which lists the known names.
    ///
    /// ```
    /// use palpate_haptics::Material;
    ///
    /// # fn main() -> Result<(), palpate_field::UnknownName> {
    /// assert_eq!(Material::preset("wood")?, Material::wood());
    /// assert!(Material::preset("glas").is_err());
    /// # Ok(())
    /// # }
    /// ```
    pub fn preset(name: &str) -> Result<Self, UnknownName> {
        let preset = PRESETS.iter().find(|preset| preset.name == name);
        let preset =
            preset.ok_or_else(|| UnknownName::new("material", name, Self::preset_names()))?;
        Ok((preset.material)())
    }
}

fn texture(kind: TextureKind, amplitude: f64, wavelength: f64) -> Texture {
    Texture { description: None, kind, amplitude, wavelength, direction: None }
}

fn pop_through(force: f64) -> PopThrough {
    PopThrough { description: None, force, distance: 1e-3 }
}

/// A layer below a depth [m], with a stiffness [N/m].
fn layer(depth: f64, stiffness: f64) -> Layer {
    Layer { depth, stiffness: Some(stiffness), ..Layer::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_is_a_material_of_its_own_that_says_where_it_is_from() {
        for (i, one) in PRESETS.iter().enumerate() {
            let material = (one.material)();
            assert!(material.stiffness <= 1000.0, "{}", one.name);
            let source = material.description.as_deref().unwrap_or_default();
            let says = |word: &str| source.contains(word);
            assert!(says("chosen") || says("(2001)") || says("(2004)"), "{}", one.name);
            for other in &PRESETS[i + 1..] {
                assert_ne!(one.name, other.name);
                assert_ne!((one.material)(), (other.material)());
            }
        }
    }

    #[test]
    fn harder_materials_ring_higher() {
        let tap = |material: Material| material.impact.unwrap();
        let (rubber, wood) = (tap(Material::rubber()), tap(Material::wood()));
        let metal = tap(Material::aluminium());
        assert!(rubber.frequency < wood.frequency && wood.frequency < metal.frequency);
        assert!(rubber.amplitude < wood.amplitude && wood.amplitude < metal.amplitude);
    }

    #[test]
    fn a_name_that_is_none_is_answered_with_those_there_are() {
        let error = Material::preset("plasma").unwrap_err().to_string();
        assert!(error.starts_with("there is no material \"plasma\"; there are rubber, wood"));
        assert!(error.ends_with(", layered_tissue"), "{error}");
    }
}
