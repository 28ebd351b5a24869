// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! From the command line to what is rendered: bodies, camera, settings.

use palpate::field::{LARGEST_LENGTH, Vector};
use palpate::plot::Slice;
use palpate::render::{Body, Camera, Color, Cut, Lens, Settings, Shadows, Sight, Subject};
use palpate::scene::BuiltScene;

use crate::arguments::{RenderOptions, ShadowChoice};
use crate::contact::Touched;
use crate::input;
use crate::outcome::Failure;
use crate::plane;

/// How many sides a box is turned to so that a turntable shows all of it.
const SIDES: u32 = 16;

/// All that a picture shows, and how.
pub(super) struct Stage<'a> {
    pub(super) options: &'a RenderOptions,
    pub(super) names: Vec<String>,
    pub(super) subject: Subject,
    pub(super) camera: Camera,
    pub(super) settings: Settings,
    pub(super) touched: Option<Touched<3>>,
}

impl<'a> Stage<'a> {
    pub(super) fn of(
        options: &'a RenderOptions,
        scene: &BuiltScene<3>,
    ) -> Result<Self, Failure> {
        let scene = &scene.at(options.time).map_err(Failure::input)?;
        let body = |(i, body): (usize, &palpate::scene::BuiltBody<3>)| Body {
            shape: body.shape.clone(),
            color: Color::of_body(i),
        };
        let bodies = scene.bodies.iter().enumerate().map(body).collect();
        let subject = Subject::new(bodies).map_err(Failure::input)?;
        let camera = camera(options, &subject)?;
        let shadows = match options.shadows {
            ShadowChoice::Soft => Shadows::Soft,
            ShadowChoice::Hard => Shadows::Hard,
            ShadowChoice::None => Shadows::None,
        };
        let settings = Settings::new(options.width, options.height)
            .with_samples(options.samples)
            .with_shadows(shadows)
            .with_ground(ground(options, &subject, &camera))
            .with_cut(cut(options, &subject, &camera)?)
            .with_spacing(options.step)
            .with_budget(options.ray_budget);
        let find = || Touched::find(&options.question, scene, false);
        let touched = options.contacts.then(find).transpose()?;
        let names = scene.bodies.iter().map(|body| body.name.clone()).collect();
        Ok(Self { options, names, subject, camera, settings, touched })
    }
}

/// The camera that the options ask for.
fn camera(options: &RenderOptions, subject: &Subject) -> Result<Camera, Failure> {
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
    let aspect = f64::from(options.width) / f64::from(options.height);
    let centre = subject.bounds().centre();
    let mut points = subject.corners().to_vec();
    if options.turntable.is_some() {
        points = (0..SIDES)
            .flat_map(|side| {
                let angle = std::f64::consts::TAU * f64::from(side) / f64::from(SIDES);
                let turn = palpate::field::Rotation::identity().turned([0.0, angle, 0.0]);
                subject.corners().map(|corner| centre + turn.rotate(corner - centre))
            })
            .collect();
    }
    Camera::fitting(&points, sight, lens, aspect).map_err(Failure::input)
}

/// The height of the ground, if there is one.
fn ground(options: &RenderOptions, subject: &Subject, camera: &Camera) -> Option<f64> {
    let is_above = camera.sight().back()[1] > 0.0;
    let has_ground = !options.no_ground && subject.is_bounded() && is_above;
    has_ground.then(|| subject.bounds().min[1])
}

/// The plane of `--slice`, with what lies on the camera's side cut away.
fn cut(
    options: &RenderOptions,
    subject: &Subject,
    camera: &Camera,
) -> Result<Option<Cut>, Failure> {
    let Some(text) = &options.slice else { return Ok(None) };
    if let Some(at) = options.slice_at.filter(|at| !(at.abs() <= LARGEST_LENGTH)) {
        let rule = format!("at most {LARGEST_LENGTH:e} m in size, got {at} m");
        return Err(Failure::input(format!("--slice-at must be {rule}")));
    }
    let middle = subject.bounds().centre();
    let plane: Slice = plane::named("--slice", text, options.slice_at, middle)?;
    let (point, normal) = (Vector(plane.point([0.0; 2])), Vector(plane.normal()));
    let side = if camera.is_orthographic() {
        normal.dot(camera.sight().back())
    } else {
        plane.elevation(camera.eye().0)
    };
    let normal = if side < 0.0 { -normal } else { normal };
    Ok(Some(Cut { point, normal }))
}
