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
    rubber => tapped(contact(300.0, 2.0, (1.0, 0.8)), (0.5, 30.0, 60.0)),
    /// Planed wood. Its tap is between those of rubber and metal, in the order of Okamura, Cutkosky and Dennerlein (2001); friction 0.4 and 0.3 are usual in tables for dry wood; the rest is chosen.
    wood => tapped(contact(700.0, 1.5, (0.4, 0.3)), (1.5, 100.0, 80.0)),
    /// Bare aluminium. Its tap is high and long, in the order of Okamura, Cutkosky and Dennerlein (2001); the rest is chosen.
    aluminium => tapped(contact(900.0, 1.0, (0.35, 0.25)), (3.0, 300.0, 90.0)),
    /// Polished steel. All numbers are chosen: as aluminium, stiffer, smoother, and ringing longer.
    steel => tapped(contact(1000.0, 1.0, (0.25, 0.15)), (3.5, 350.0, 60.0)),
    /// Clean glass. All numbers are chosen: hard, slippery, a high and clear tap.
    glass => tapped(contact(1000.0, 0.8, (0.15, 0.1)), (3.0, 400.0, 70.0)),
    /// Upholstery foam. All numbers are chosen: soft, slow to give, mute.
    foam => Material { viscosity: 0.5, ..contact(120.0, 3.0, (0.6, 0.5)) },
    /// Skin over soft tissue. All numbers are chosen: soft, stiffer once it is pressed in, mute; measured skin varies by more than a factor of ten with site and person.
    skin => Material {
        layers: vec![layer(0.004, 400.0)],
        ..contact(200.0, 1.5, (0.6, 0.5))
    },
    /// Corrugated cardboard. All numbers are chosen; flutes 6.5 mm apart are those of grade B.
    cardboard => Material {
        texture: Some(texture(TextureKind::Height, 1e-4, 6.5e-3)),
        ..tapped(contact(450.0, 1.5, (0.45, 0.35)), (0.8, 70.0, 120.0))
    },
    /// Coarse sandpaper. Grains 0.3 mm apart are those of grit P60 to P80; the rest is chosen.
    sandpaper => Material {
        texture: Some(texture(TextureKind::Height, 5e-5, 3e-4)),
        ..contact(700.0, 1.0, (0.9, 0.75))
    },
    /// A surface that draws the hand on from 5 mm away. All numbers are chosen.
    magnet => Material {
        magnet: Some(Magnet { description: None, force: 1.0, distance: 5e-3 }),
        ..contact(700.0, 1.0, (0.4, 0.3))
    },
    /// A membrane that gives way at 1.5 N, as a needle goes through it. All numbers are chosen, in the order of the needle forces of Okamura, Simone and O'Leary (2004).
    membrane => Material {
        pop_through: Some(pop_through(1.5)),
        ..contact(500.0, 1.0, (0.3, 0.2))
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
        ..contact(300.0, 1.0, (0.5, 0.4))
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

/// Stiffness [N/m], damping [N·s/m], static and dynamic friction.
fn contact(stiffness: f64, damping: f64, frictions: (f64, f64)) -> Material {
    let (static_friction, dynamic_friction) = frictions;
    Material { stiffness, damping, static_friction, dynamic_friction, ..Material::default() }
}

/// The material with a tap: amplitude [N·s/m], frequency [Hz], decay [1/s].
fn tapped(material: Material, (amplitude, frequency, decay): (f64, f64, f64)) -> Material {
    let impact = Impact { description: None, amplitude, frequency, decay };
    Material { impact: Some(impact), ..material }
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
