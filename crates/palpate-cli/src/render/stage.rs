// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! From the command line to what is rendered: bodies, camera, settings.

use palpate::field::Vector;
use palpate::render::{Camera, Cut, LitBody, Settings, Shadows, SrgbColor, Subject};
use palpate::scene::{BuiltBody, BuiltScene, WrittenView};

use super::{camera, overlay};
use crate::arguments::{RenderOptions, ShadowChoice};
use crate::contact::Touched;
use crate::emptiness;
use crate::outcome::Failure;
use crate::{plane, views};

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
        let scene = &views::at(scene, options.time)?;
        let view = options.view.as_deref().map(|name| views::named(scene, name)).transpose()?;
        let body = |(i, body): (usize, &BuiltBody<3>)| LitBody {
            shape: body.shape.clone(),
            color: SrgbColor::of_body(i),
        };
        let bodies = scene.bodies.iter().enumerate().map(body).collect();
        let subject = Subject::new(bodies).map_err(Failure::input)?;
        let names: Vec<_> = scene.bodies.iter().map(|body| body.name.clone()).collect();
        let settings = settings(options);
        settings.check().map_err(Failure::input)?;
        let legend = overlay::legend(&settings, &names, subject.bodies()).legend_height();
        let legend = legend / f64::from(options.height);
        let camera = match view {
            Some(view) => camera::of_view(options, &subject, view, legend)?,
            None => camera::of(options, &subject, legend)?,
        };
        let find = || Touched::find(&options.question, scene, false);
        let touched = options.contacts.then(find).transpose()?;
        if touched.is_none() {
            emptiness::warn(scene);
        }
        let settings = Settings { ground: ground(options, &subject, &camera), ..settings };
        let mut stage = Self { options, names, subject, camera, settings, touched };
        stage.settings.cut = stage.cut(view)?;
        Ok(stage)
    }

    /// The plane of `--slice`, with what lies on the camera's side cut away.
    fn cut(&self, view: Option<&WrittenView>) -> Result<Option<Cut>, Failure> {
        let Some(text) = &self.options.slice else { return Ok(None) };
        let plane = match (text.as_str(), view, self.options.slice_at) {
            ("view", Some(view), None) => views::plane(view)?,
            ("view", Some(_), Some(_)) => {
                let problem =
                    "--slice-at goes with a plane along two axes, not with that of a view";
                return Err(Failure::input(problem));
            }
            ("view", None, _) => {
                let problem = "--slice view needs --view NAME, which has the plane";
                return Err(Failure::input(problem));
            }
            (text, _, at) => plane::named("--slice", text, at, self.subject.bounds().centre())?,
        };
        let (point, normal) = (Vector(plane.point([0.0; 2])), Vector(plane.normal()));
        let side = if self.camera.is_orthographic() {
            normal.dot(self.camera.sight().back())
        } else {
            plane.elevation(self.camera.eye().0)
        };
        let normal = if side < 0.0 { -normal } else { normal };
        Cut::new(point, normal).map(Some).map_err(Failure::input)
    }
}

fn settings(options: &RenderOptions) -> Settings {
    let shadows = match options.shadows {
        ShadowChoice::Soft => Shadows::Soft,
        ShadowChoice::Hard => Shadows::Hard,
        ShadowChoice::None => Shadows::None,
    };
    Settings {
        samples: options.samples,
        shadows,
        spacing: options.step,
        budget: options.ray_budget,
        ..Settings::new(options.width, options.height)
    }
}

/// The height of the ground, if there is one.
fn ground(options: &RenderOptions, subject: &Subject, camera: &Camera) -> Option<f64> {
    let is_above = camera.sight().back()[1] > 0.0;
    let has_ground = !options.no_ground && subject.is_bounded() && is_above;
    has_ground.then(|| subject.bounds().min[1])
}
