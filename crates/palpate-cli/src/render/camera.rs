// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The camera that the command line asks for.

use std::f64::consts::TAU;

use palpate::field::{Aabb, Point, Rotation, Vector};
use palpate::plot::PlaneView as Window;
use palpate::render::{Camera, Lens, Sight, Subject};
use palpate::scene::WrittenView;

use crate::outcome::Failure;
use crate::render::RenderOptions;
use crate::{input, picture, views};

/// How many sides a turntable shows, to find a distance from which it shows all.
const SIDES: u32 = 16;

/// The most of a picture's height that is left free for the legend.
const MOST_LEGEND: f64 = 0.5;

/// The camera of `--from`; or that of `--azimuth` and `--elevation`, which shows the scene above
/// a legend with a share of the picture's height.
pub(super) fn of(
    options: &RenderOptions,
    subject: &Subject,
    legend: f64,
) -> Result<Camera, Failure> {
    let lens = match options.field_of_view {
        _ if options.orthographic => Lens::Orthographic,
        Some(angle) => Lens::Perspective(angle.to_radians()),
        None => Lens::USUAL,
    };
    if let Some(from) = &options.from {
        let middle = || Ok(subject.bounds().centre());
        let at = options.at.as_deref().map_or_else(middle, input::point)?;
        return Camera::looking(input::point(from)?, at, lens).map_err(Failure::input);
    }
    let [azimuth, elevation] = [options.azimuth, options.elevation].map(f64::to_radians);
    let sight = Sight::from_angles(azimuth, elevation).map_err(Failure::input)?;
    let corners = match options.turntable {
        Some(_) => turned(subject),
        None => subject.corners().to_vec(),
    };
    let legend = legend.min(MOST_LEGEND);
    let camera = Camera::fitting(&corners, sight, lens, aspect(options, legend));
    Ok(camera.map_err(Failure::input)?.with_room_below(legend))
}

/// The camera in front of the plane of a view, and of all that has bounds, which shows the view
/// above a legend with a share of the picture's height.
pub(super) fn of_view(
    options: &RenderOptions,
    subject: &Subject,
    view: &WrittenView,
    legend: f64,
) -> Result<Camera, Failure> {
    let plane = views::plane(view)?;
    let Aabb { min, max } = subject.bounds();
    let whole =
        Window::of_box(&plane, min.0, max.0, picture::MARGIN).map_err(Failure::input)?;
    let from_origin = |st| Vector(plane.point(st)) - Vector(plane.point([0.0; 2]));
    let sight = Sight::onto_plane(from_origin([1.0, 0.0]), from_origin([0.0, 1.0]));
    let sight = sight.map_err(Failure::input)?;
    let legend = legend.min(MOST_LEGEND);
    let width = view.width.unwrap_or(whole.width());
    let height = view.height.unwrap_or(whole.height()).max(width / aspect(options, legend));
    let centre = plane.point(view.center.unwrap_or(whole.center()));
    let reach = subject.corners().map(|corner| plane.elevation(corner.0));
    let distance = reach.into_iter().fold(0.0, f64::max) + height;
    let camera = Camera::facing(sight, Vector(centre), height, distance);
    Ok(camera.map_err(Failure::input)?.with_room_below(legend))
}

/// How many times the part of a picture above a legend is as wide as high.
fn aspect(options: &RenderOptions, legend: f64) -> f64 {
    f64::from(options.width) / f64::from(options.height) / (1.0 - legend)
}

/// The corners of the scene's box, turned to all sides.
fn turned(subject: &Subject) -> Vec<Point<3>> {
    let centre = subject.bounds().centre();
    let side = |side: u32| {
        let angle = TAU * f64::from(side) / f64::from(SIDES);
        let turn = Rotation::identity().turned([0.0, angle, 0.0]);
        subject.corners().map(|corner| centre + turn.rotate(corner - centre))
    };
    (0..SIDES).flat_map(side).collect()
}
