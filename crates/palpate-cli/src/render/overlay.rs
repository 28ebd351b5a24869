// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What is drawn over a picture: the names of bodies, and contacts.

use palpate::plot::{Color, PixelLayer};
use palpate::render::{Camera, LitBody, Settings, SrgbColor as BodyColor};

use super::stage::Stage;
use crate::outcome::Failure;

/// The most bodies that the legend names.
const MOST_NAMES: usize = 12;

/// The length of a normal, as a share of the picture's height.
const NORMAL: f64 = 0.06;

/// The legend of a picture: the names of bodies.
pub(super) fn legend(settings: &Settings, names: &[String], bodies: &[LitBody]) -> PixelLayer {
    let mut layer = PixelLayer::new(settings.width, settings.height);
    for (name, body) in names.iter().zip(bodies).take(MOST_NAMES) {
        let BodyColor([red, green, blue]) = body.color;
        layer = layer.with_entry(Color::rgb(red, green, blue), name);
    }
    if names.len() > MOST_NAMES {
        layer = layer.with_words(format!("and {} more", names.len() - MOST_NAMES));
    }
    layer
}

impl Stage<'_> {
    /// Red, green, blue and opacity of each pixel of what lies over the picture.
    pub(super) fn overlay(&self, camera: &Camera) -> Result<Vec<[u8; 4]>, Failure> {
        let mut layer = legend(&self.settings, &self.names, self.subject.bodies());
        // The usual camera leaves room for the legend; other ones may see bodies there.
        if self.options.view.is_some() || self.options.from.is_some() {
            let BodyColor([red, green, blue]) = BodyColor::BACKGROUND;
            layer = layer.with_band(Color::rgb(red, green, blue));
        }
        self.with_contacts(layer, camera)?.pixels().map_err(Failure::input)
    }

    /// Contacts of bodies that touch, with their normals.
    fn with_contacts(&self, layer: PixelLayer, camera: &Camera) -> Result<PixelLayer, Failure> {
        let Some(touched) = &self.touched else { return Ok(layer) };
        let size = [self.settings.width, self.settings.height];
        let length = NORMAL * f64::from(self.settings.height) * camera.pixel(size[1]);
        let seen: Vec<_> = touched
            .touching()
            .filter_map(|contact| {
                let middle = (contact.point_a + contact.point_b) * 0.5;
                let tip = middle + contact.normal * length;
                Some([camera.projected(middle, size)?, camera.projected(tip, size)?])
            })
            .collect();
        if seen.is_empty() {
            return Ok(layer);
        }
        let points = seen.iter().map(|[tail, _]| *tail).collect();
        layer
            .with_arrows("normal", Color::INK, seen)
            .and_then(|layer| layer.with_points("contact", Color::VERMILION, points))
            .map_err(Failure::input)
    }
}
