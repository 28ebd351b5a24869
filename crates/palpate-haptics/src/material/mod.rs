// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What surfaces feel like, as data: stiffness, friction, layers and textures, and presets with the
//! sources of their numbers. A [`Surface`](crate::Surface) is a [`Material`] prepared for the servo;
//! scene files hold one for each body.

mod presets;

/// What a surface feels like.
///
/// Stiffness and damping are requested; a device that cannot render them stably accepts less.
///
/// ```
/// use palpate_haptics::Material;
///
/// let gum = Material { stiffness: 300.0, static_friction: 0.9, ..Material::default() };
/// assert_eq!(gum.damping, 1.0);
/// assert_eq!(Material::wood().stiffness, 700.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields, default, expecting = "an object"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Material {
    /// A note for readers, without effect.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub description: Option<String>,
    /// Force for each metre of depth [N/m]; 500, which common desktop devices render, if left
    /// out.
    #[cfg_attr(feature = "schema", schemars(range(min = 0.0)))]
    pub stiffness: f64,
    /// The part of the stiffness that a device renders at most, from above 0 to 1, that the stiffest
    /// layer has, with the others in proportion. `stiffness` counts if this is left out, or if
    /// nothing limits the stiffness of the device.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(
        feature = "schema",
        schemars(range(max = 1.0), extend("exclusiveMinimum" = 0))
    )]
    pub relative_stiffness: Option<f64>,
    /// Force for each metre per second towards the surface [N·s/m]; 1 if left
    /// out.
    #[cfg_attr(feature = "schema", schemars(range(min = 0.0)))]
    pub damping: f64,
    /// The largest ratio of tangential to normal force while sticking; 0.4 if left out.
    #[cfg_attr(feature = "schema", schemars(range(min = 0.0)))]
    pub static_friction: f64,
    /// The ratio of tangential to normal force while slipping, at most the static one; 0.3 if
    /// left out.
    #[cfg_attr(feature = "schema", schemars(range(min = 0.0)))]
    pub dynamic_friction: f64,
    /// Force for each metre per second inside the body, as in a liquid [N·s/m];
    /// 0 if left out.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "is_zero"))]
    #[cfg_attr(feature = "schema", schemars(range(min = 0.0)))]
    pub viscosity: f64,
    /// A pull towards the surface from outside.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub magnet: Option<Magnet>,
    /// The force at which the surface gives way.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub pop_through: Option<PopThrough>,
    /// Layers below the surface, each deeper than the one before.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Vec::is_empty"))]
    pub layers: Vec<Layer>,
    /// A wave on the surface.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub texture: Option<Texture>,
    /// The vibration of a tap on the surface.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub impact: Option<Impact>,
    /// How far a seam reaches at least into this body and into its neighbour [m]: beside a body
    /// whose surface is level with this one, one stiffness blends into the other. If left out, as far
    /// as the probe's radius and the device's largest force need.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(feature = "schema", schemars(range(min = 0.0)))]
    pub seam: Option<f64>,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            description: None,
            stiffness: 500.0,
            relative_stiffness: None,
            damping: 1.0,
            static_friction: 0.4,
            dynamic_friction: 0.3,
            viscosity: 0.0,
            magnet: None,
            pop_through: None,
            layers: Vec::new(),
            texture: None,
            impact: None,
            seam: None,
        }
    }
}

/// A pull towards the surface from outside, which makes a tool snap onto it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields, expecting = "an object"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Magnet {
    /// A note for readers, without effect.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub description: Option<String>,
    /// The largest pull [N].
    #[cfg_attr(feature = "schema", schemars(extend("exclusiveMinimum" = 0)))]
    pub force: f64,
    /// The distance from the surface at which the pull ends [m].
    #[cfg_attr(feature = "schema", schemars(extend("exclusiveMinimum" = 0)))]
    pub distance: f64,
}

/// When a surface gives way.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields, expecting = "an object"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PopThrough {
    /// A note for readers, without effect.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub description: Option<String>,
    /// The normal force above which the surface gives way [N].
    #[cfg_attr(feature = "schema", schemars(extend("exclusiveMinimum" = 0)))]
    pub force: f64,
    /// How far outside a tool that went through must be before the surface holds again [m];
    /// 0.001 if left out.
    #[cfg_attr(feature = "serde", serde(default = "one_millimetre"))]
    #[cfg_attr(feature = "schema", schemars(range(min = 0.0)))]
    pub distance: f64,
}

#[cfg(feature = "serde")]
fn one_millimetre() -> f64 {
    1e-3
}

/// A layer below a depth. Numbers that are left out are those of the layer above.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields, expecting = "an object"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Layer {
    /// A note for readers, without effect.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub description: Option<String>,
    /// How deep below the surface the layer begins [m].
    #[cfg_attr(feature = "schema", schemars(extend("exclusiveMinimum" = 0)))]
    pub depth: f64,
    /// Force for each further metre of depth [N/m].
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(feature = "schema", schemars(range(min = 0.0)))]
    pub stiffness: Option<f64>,
    /// Force for each metre per second towards the surface [N·s/m].
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(feature = "schema", schemars(range(min = 0.0)))]
    pub damping: Option<f64>,
    /// The largest ratio of tangential to normal force while sticking.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(feature = "schema", schemars(range(min = 0.0)))]
    pub static_friction: Option<f64>,
    /// The ratio of tangential to normal force while slipping.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(feature = "schema", schemars(range(min = 0.0)))]
    pub dynamic_friction: Option<f64>,
    /// Force for each metre per second inside the layer [N·s/m].
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(feature = "schema", schemars(range(min = 0.0)))]
    pub viscosity: Option<f64>,
    /// The force at which the top of this layer gives way.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub pop_through: Option<PopThrough>,
}

/// A sine wave on a surface.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields, expecting = "an object"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Texture {
    /// A note for readers, without effect.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub description: Option<String>,
    /// Whether the wave changes the surface or the force.
    pub kind: TextureKind,
    /// How far the wave rises above the mean surface [m].
    #[cfg_attr(feature = "schema", schemars(extend("exclusiveMinimum" = 0)))]
    pub amplitude: f64,
    /// From crest to crest [m].
    #[cfg_attr(feature = "schema", schemars(extend("exclusiveMinimum" = 0)))]
    pub wavelength: f64,
    /// The direction from crest to crest in the body's coordinates; if left out, the texture is
    /// the product of waves along all axes.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(feature = "schema", schemars(with = "Option<VectorSchema>"))]
    pub direction: Option<Vec<f64>>,
}

impl Texture {
    /// The radius of curvature of the wave's valleys [m], where its second derivative is largest:
    /// `λ² / (4 π² a)` for `a sin(2 π x / λ)`.
    ///
    /// A probe that is larger, with the depth to which a hand presses it, is caught in the valleys
    /// of a [displacement](TextureKind::Displacement) and jumps over waves.
    ///
    /// ```
    /// use palpate_haptics::{Texture, TextureKind};
    ///
    /// let pi = std::f64::consts::PI;
    /// let (kind, amplitude, wavelength) = (TextureKind::Displacement, 0.001, 0.02 * pi);
    /// let wave = Texture { description: None, kind, amplitude, wavelength, direction: None };
    /// assert!((wave.valley_radius() - 0.1).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn valley_radius(&self) -> f64 {
        let per_radian = self.wavelength / (2.0 * std::f64::consts::PI);
        per_radian * per_radian / self.amplitude
    }
}

/// Whether a texture changes the surface or the force.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(inline))]
pub enum TextureKind {
    /// The surface itself: a tool rides over the crests.
    Displacement,
    /// Only the force, by the height of the wave under the tool.
    Height,
}

/// A decaying sinusoid for each tap (Okamura, Cutkosky and Dennerlein 2001):
/// `a · v · exp(−d·t) · sin(2π·f·t)` for a tap at normal speed v.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields, expecting = "an object"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Impact {
    /// A note for readers, without effect.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub description: Option<String>,
    /// Its amplitude a, for each metre per second of the tap [N·s/m].
    #[cfg_attr(feature = "schema", schemars(range(min = 0.0)))]
    pub amplitude: f64,
    /// Its frequency f [Hz].
    #[cfg_attr(feature = "schema", schemars(extend("exclusiveMinimum" = 0)))]
    pub frequency: f64,
    /// Its rate of decay d [1/s].
    #[cfg_attr(feature = "schema", schemars(range(min = 0.0)))]
    pub decay: f64,
}

/// `true` if a number is the default of a missing key, so that it need not be written.
#[cfg(feature = "serde")]
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it with a reference")]
fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

/// In the schema of a scene: one number for each dimension.
#[cfg(feature = "schema")]
struct VectorSchema;

#[cfg(feature = "schema")]
impl schemars::JsonSchema for VectorSchema {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Vector".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({})
    }
}
