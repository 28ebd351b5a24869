// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The picture of a run: the paths, the proxies and the forces over isolines on the slices with
//! most contacts, the tool where it was, and what was felt over time.

mod charts;
mod guides;
mod overlays;
mod points;
mod tools;

use palpate::device::DeviceProfile;
use palpate::field::{Aabb, Vector};
use palpate::haptics::Material;
use palpate::plot::{Figure, Isolines};
use palpate::scene::{BuiltBody, BuiltScene};
use palpate::servo_loop::Recorder;

use super::slices::{FeltSlice, felt_slices};
use super::vibration::Vibration;
use super::{paths, report};
use crate::input;
use crate::outcome::Failure;
use crate::picture::{self, Dimensions, Drawable, Picture};
use palpate::scene::text::rounded;
use points::Points;

/// A run to be drawn.
pub(super) struct Run<'a, const D: usize> {
    pub(super) scene: &'a BuiltScene<D>,
    pub(super) recorder: &'a Recorder,
    pub(super) title: &'a str,
    /// The stiffness of each body as the device renders it [N/m].
    pub(super) rendered: &'a [f64],
    pub(super) device: &'a DeviceProfile,
    /// What actuators play, for a device without force feedback.
    pub(super) vibration: Option<&'a Vibration>,
}

impl<const D: usize> Run<'_, D>
where
    Dimensions: Drawable<D>,
{
    pub(super) fn draw(&self, picture: &Picture) -> Result<(), Failure> {
        picture.save(&self.figure()?, picture::WIDTH)
    }

    fn figure(&self) -> Result<Figure, Failure> {
        let (scene, rows) = (self.scene, self.recorder.rows());
        let end = rows.last().map_or(0.0, |row| row.time_s);
        let tools = tools::placed(scene.tool.as_ref(), rows)?;
        // The unit box stands for a scene without bounds.
        let bounds =
            input::bounds(scene).unwrap_or_else(|_| Aabb::centred(Vector::constant(0.5)));
        let moved = paths::bounds(scene, end);
        let bounds = moved.map_or(bounds, |moved| bounds.union(&moved));
        let slices = felt_slices(&bounds, rows).map_err(Failure::input)?;
        let bounds = tools::around(bounds, &tools);
        let points = Points::of(rows);
        let mut views = Vec::new();
        for slice in &slices {
            views.push(self.view(slice, &bounds, &points, &tools)?);
        }
        let step = views.iter().map(Isolines::step).fold(0.0, f64::max);
        let views = views.into_iter().map(|view| view.with_step(step));
        let views = views.collect::<Result<Vec<_>, _>>().map_err(Failure::input)?;
        let figure = Figure::new(self.title)
            .with_caption(self.caption(&slices, !tools.is_empty()))
            .with_views(views);
        let mut figure = match self.vibration {
            Some(vibration) => charts::with_levels(figure, &points, vibration)?,
            None => charts::with_forces(figure, &points).map_err(Failure::input)?,
        };
        let others = [charts::torques(rows), charts::energies(rows, points.count())];
        for chart in others {
            if let Some(chart) = chart.map_err(Failure::input)? {
                figure = figure.with_chart(chart);
            }
        }
        Ok(figure)
    }

    fn view(
        &self,
        slice: &FeltSlice,
        bounds: &Aabb<D>,
        points: &Points<'_>,
        tools: &[tools::Placed<'_, D>],
    ) -> Result<Isolines, Failure> {
        let view = Dimensions::view(&slice.plane, bounds, picture::MARGIN);
        let view = view.map_err(Failure::input)?;
        let note = |body: usize| {
            let (asked, rendered) = (self.scene.bodies.get(body), self.rendered.get(body));
            let of = |(body, felt): (_, &f64)| material(body, *felt, self.device);
            asked.zip(rendered).map_or(String::new(), of)
        };
        let scene = picture::noted(self.scene, &slice.plane, &view, note);
        let isolines = scene.map_err(Failure::input)?.in_ink().with_title(&slice.heading);
        let spacing = overlays::ARROW_SPACING * (view.width() * view.height()).sqrt();
        let end = self.recorder.rows().last().map_or(0.0, |row| row.time_s);
        paths::drawn_over(isolines, self.scene, &slice.plane, &view, end)
            .and_then(|isolines| guides::drawn(isolines, self.scene, slice, bounds))
            .and_then(|isolines| overlays::drawn(isolines, slice, points, spacing))
            .and_then(|isolines| tools::drawn(isolines, slice, &view, tools))
            .map_err(Failure::input)
    }

    fn caption(&self, slices: &[FeltSlice], has_tool: bool) -> String {
        let mut caption = self.scene.whole.promise().in_words();
        if let Some(slice) = slices.iter().find(|slice| slice.near.is_finite()) {
            let near = (1e3 * slice.near * 1e6).round() / 1e6;
            caption.push_str(&format!(
                ". Bold: within {near} mm of the slice; thin: in front of it; dashed: behind it."
            ));
            if has_tool {
                caption.push_str(" The tool is cut parallel to the slice, through its origin.");
            }
        }
        caption
    }
}

/// A body's material in a word, the name of a preset, or else the stiffness; and the stiffness
/// that the device renders [N/m], if it is another than the material's or a part of the device's.
fn material<const D: usize>(
    body: &BuiltBody<D>,
    rendered: f64,
    device: &DeviceProfile,
) -> String {
    let is_it = |name: &&str| Material::preset(name).is_ok_and(|known| known == body.material);
    let preset = Material::preset_names().find(is_it);
    let name = preset.filter(|name| **name != body.name);
    if let Some(part) = report::part(&body.material, device) {
        let (rendered, part) = (rounded(rendered), rounded(part));
        return format!("{rendered} N/m, asked {part} of the device's");
    }
    let asked = body.material.stiffness;
    let is_softer = rendered < asked * (1.0 - 1e-9);
    match (name, is_softer) {
        (None, false) => format!("{asked} N/m"),
        (Some(name), false) => (*name).to_owned(),
        (None, true) => format!("{} N/m, asked {asked} N/m", rounded(rendered)),
        (Some(name), true) => {
            format!("{name}: {} N/m, asked {asked} N/m", rounded(rendered))
        }
    }
}
