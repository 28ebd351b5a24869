// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate render`: lit pictures.

use std::fmt;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use frames::Frames;
use palpate::field::Vector;
use palpate::plot::{Color, PixelLayer};
use palpate::render::{
    Camera, Cut, LitBody, Settings, Shadows, SrgbColor, SrgbColor as BodyColor, Subject, Work,
};
use palpate::scene::{AnyScene, BuiltBody, BuiltScene, WrittenView};
use serde::Serialize;

use crate::arguments::Reading;
use crate::arguments::numbers::{coordinate, count, length, positive, within, zero_or_more};
use crate::contact::{ContactQuestion, Touched};
use crate::interrupt::{self, Interrupt};
use crate::outcome::{Failure, Outcome};
use crate::output::{self, shown};
use crate::render::frames::Drawn;
use crate::{emptiness, input, plane, views};

mod camera;
mod frames;

pub(crate) fn run(options: &RenderOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    let frames = Frames::of(options)?;
    options.question.refuse_unless(options.contacts)?;
    let named = input::scene(Some(&options.scene), options.reading)?;
    let AnyScene::Spatial(scene) = &named.scene else {
        let problem = "the scene is in the plane, which `palpate plot` draws; render needs \"dimension\": 3";
        return Err(Failure::file(&options.scene, problem));
    };
    let stage = Stage::of(options, scene)?;
    let pool = interrupt::pool(options.threads)?;
    interrupt.heed();
    let drawn = pool.install(|| frames.draw(&stage, interrupt))?;
    output::answer().print(&Answer::of(&stage, &drawn), options.json)?;
    if drawn.is_interrupted() {
        output::remark(drawn.what_is_left());
        return Ok(Outcome::Interrupted);
    }
    Ok(if drawn.undecided() == 0 { Outcome::Yes } else { Outcome::No })
}

/// The most pictures of a turntable.
const MOST_PICTURES: u32 = 3600;

pub(crate) const EXAMPLES: &str = "\
Examples:
  palpate render scenes/cup.json
  palpate render scenes/nut_on_bolt.json --slice xy --output thread.png
  palpate render scenes/peg_in_hole.json --azimuth 60 --elevation 40 --contacts
  palpate render scenes/article_gallery.json --turntable 48 --width 600 --height 450

No surface is missed: each ray proves that nothing lies before what it meets. Rays of sight that
the budget leaves undecided are counted, their pixels are magenta, and the exit status is 1.";

/// The options of `palpate render`.
#[derive(Args, Debug)]
pub(crate) struct RenderOptions {
    /// The scene file, in space.
    pub(crate) scene: PathBuf,
    /// A view of the scene: looks at its plane, without perspective.
    #[arg(long, value_name = "NAME", conflicts_with_all = ["from", "at", "azimuth", "elevation", "field_of_view", "turntable"])]
    pub(crate) view: Option<String>,
    /// Where the camera is, x,y,z [m]; so far away that the scene fills the picture if left out.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, conflicts_with_all = ["azimuth", "elevation"])]
    pub(crate) from: Option<String>,
    /// What the camera looks at, x,y,z [m]; the middle of the scene if left out.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, requires = "from")]
    pub(crate) at: Option<String>,
    /// Where the camera is: the angle about y, from z towards x [degrees].
    #[arg(long, default_value_t = 30.0, allow_negative_numbers = true, value_parser = within(-360.0, 360.0, "degrees"))]
    pub(crate) azimuth: f64,
    /// How high the camera is: the angle above the plane of x and z [degrees].
    #[arg(long, default_value_t = 28.0, allow_negative_numbers = true, value_parser = within(-90.0, 90.0, "degrees"))]
    pub(crate) elevation: f64,
    /// The angle that the height of the picture spans [degrees]; 28 if left out.
    #[arg(long, allow_negative_numbers = true, conflicts_with = "orthographic", value_parser = within(1.0, 170.0, "degrees"))]
    pub(crate) field_of_view: Option<f64>,
    /// Without perspective: all is as large, wherever it is.
    #[arg(long)]
    pub(crate) orthographic: bool,
    /// Where bodies are at this time [s], if the scene has motions.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, value_parser = zero_or_more("s"))]
    pub(crate) time: f64,
    /// Cut away what is on the viewer's side of a plane: xy, xz, yz, view (the plane of --view),
    /// or three points as origin:right:up, each x,y,z. The cut face shows the depth below the
    /// surface.
    #[arg(long, value_name = "PLANE", allow_hyphen_values = true)]
    pub(crate) slice: Option<String>,
    /// The third coordinate of a slice along two axes [m]; the middle of the scene if left out.
    #[arg(long, requires = "slice", allow_negative_numbers = true, value_parser = coordinate)]
    pub(crate) slice_at: Option<f64>,
    /// The distance between isolines on the cut face [m]; chosen if left out.
    #[arg(long, requires = "slice", allow_negative_numbers = true, value_parser = length)]
    pub(crate) step: Option<f64>,
    /// Draw where bodies touch, with normals, over what hides them.
    #[arg(long)]
    pub(crate) contacts: bool,
    #[command(flatten)]
    pub(crate) question: ContactQuestion,
    /// The shadows of the light.
    #[arg(long, value_enum, default_value_t = ShadowChoice::Soft)]
    pub(crate) shadows: ShadowChoice,
    /// Leave out the ground, on which shadows fall. There is none either below bodies without
    /// bounds, or for a camera that is not above it.
    #[arg(long)]
    pub(crate) no_ground: bool,
    /// Samples along the side of a pixel at an edge, from 1 to 8; 1 is quick and jagged.
    #[arg(long, default_value_t = 4, allow_negative_numbers = true, value_parser = count(1, 8_u32))]
    pub(crate) samples: u32,
    /// The most evaluations of the field for each ray.
    #[arg(long = "ray-budget", default_value_t = Settings::BUDGET, allow_negative_numbers = true, value_parser = count(1, u32::MAX))]
    pub(crate) ray_budget: u32,
    /// An animation of so many pictures from all around.
    #[arg(long, value_name = "PICTURES", allow_negative_numbers = true, value_parser = count(1, MOST_PICTURES))]
    pub(crate) turntable: Option<u32>,
    /// How long the camera takes to go around [s].
    #[arg(long, default_value_t = 6.0, requires = "turntable", allow_negative_numbers = true, value_parser = positive("s"))]
    pub(crate) turn_time: f64,
    /// Write the pictures of a turntable as numbered files into this folder.
    #[arg(long, value_name = "FOLDER", requires = "turntable", conflicts_with = "output")]
    pub(crate) frames: Option<PathBuf>,
    /// The picture, .png; the scene's name with .png if left out. A turntable is an animated PNG.
    #[arg(long)]
    pub(crate) output: Option<PathBuf>,
    /// The width [pixels].
    #[arg(long, default_value_t = 1200, allow_negative_numbers = true, value_parser = count(1, 16384_u32))]
    pub(crate) width: u32,
    /// The height [pixels].
    #[arg(long, default_value_t = 900, allow_negative_numbers = true, value_parser = count(1, 16384_u32))]
    pub(crate) height: u32,
    /// The number of threads; as many as the machine has if left out. The picture has the same
    /// bits.
    #[arg(long, allow_negative_numbers = true, value_parser = count(1, 1_000_000_usize))]
    pub(crate) threads: Option<usize>,
    /// Print what was drawn as JSON.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) reading: Reading,
}

/// The shadows of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ShadowChoice {
    /// Of a disc of 6°.
    Soft,
    /// Of a light as small as a point.
    Hard,
    /// None.
    None,
}

/// The most bodies that the legend names.
const MOST_NAMES: usize = 12;

/// The length of a normal, as a share of the picture's height.
const NORMAL: f64 = 0.06;

/// The legend of a picture: the names of bodies.
fn legend(settings: &Settings, names: &[String], bodies: &[LitBody]) -> PixelLayer {
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
    fn overlay(&self, camera: &Camera) -> Result<Vec<[u8; 4]>, Failure> {
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

/// The answer of `palpate render`. Counts of rays are those of all its pictures together.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Answer {
    /// The files.
    pub(crate) outputs: Vec<String>,
    /// How many pictures there are.
    pub(crate) pictures: u32,
    /// The width of a picture [pixels].
    pub(crate) width: u32,
    /// The height of a picture [pixels].
    pub(crate) height: u32,
    /// The camera of the first picture.
    pub(crate) camera: CameraTold,
    /// The height of the ground [m]; `null` without one.
    pub(crate) ground: Option<f64>,
    /// A ray meets a surface where the field is at most this [m]; `null` without a picture.
    pub(crate) gap: Option<f64>,
    /// The radius with which curves and sheets without interior are drawn [m].
    pub(crate) thin: Option<f64>,
    /// With `--slice` between isolines [m].
    pub(crate) step: Option<f64>,
    /// With `--contacts` how many pairs touch.
    pub(crate) touching: Option<usize>,
    /// The rays of sight.
    pub(crate) sight: Rays,
    /// The rays to the light.
    pub(crate) light: Rays,
    /// The most evaluations for a ray.
    #[serde(skip)]
    budget: u32,
}

/// Where a picture is taken from.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct CameraTold {
    /// The eye [m].
    pub(crate) from: [f64; 3],
    /// The unit vector in which it looks.
    pub(crate) direction: [f64; 3],
    /// `true` if all rays of sight are parallel.
    pub(crate) is_orthographic: bool,
}

/// How many rays were traced, and what they cost.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Rays {
    /// Rays.
    pub(crate) rays: u64,
    /// Evaluations of the field.
    pub(crate) evaluations: u64,
    /// Rays that were cast one by one.
    pub(crate) grazing: u64,
    /// Rays that the budget left undecided.
    pub(crate) undecided: u64,
}

impl From<Work> for Rays {
    fn from(Work { rays, evaluations, grazing, undecided, .. }: Work) -> Self {
        Self { rays, evaluations, grazing, undecided }
    }
}

impl Answer {
    fn of(stage: &Stage<'_>, drawn: &Drawn) -> Self {
        let (settings, first) = (&stage.settings, drawn.first.as_ref());
        let [sight, light] = drawn.work.map(Rays::from);
        Self {
            outputs: drawn.files.iter().map(|file| file.display().to_string()).collect(),
            pictures: drawn.pictures,
            width: settings.width,
            height: settings.height,
            camera: CameraTold {
                from: stage.camera.eye().0,
                direction: (-stage.camera.sight().back()).0,
                is_orthographic: stage.camera.is_orthographic(),
            },
            ground: settings.ground,
            gap: first.map(|first| first.gap),
            thin: first.map(|first| first.thin),
            step: first.filter(|_| settings.cut.is_some()).map(|first| first.spacing),
            touching: stage.touched.as_ref().map(|touched| touched.counts().0),
            sight,
            light,
            budget: settings.budget,
        }
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Numbered files have a line each.
        let what = match &self.outputs[..] {
            [] => return Ok(()),
            [file] => shown(file).to_string(),
            files => format!("{} pictures", files.len()),
        };
        let undecided = [self.sight.undecided, self.light.undecided];
        let decided = match undecided {
            [0, 0] => "all decided".to_owned(),
            [sight, light] => format!("{sight} of sight and {light} to the light undecided"),
        };
        writeln!(f, "{what}: {} rays, {decided}", self.sight.rays + self.light.rays)?;
        if undecided != [0; 2] {
            let budget = self.budget;
            let magenta =
                if self.sight.undecided > 0 { "; their pixels are magenta" } else { "" };
            writeln!(f, "  after {budget} evaluations{magenta}; raise --ray-budget")?;
        }
        Ok(())
    }
}

/// All that a picture shows, and how.
struct Stage<'a> {
    options: &'a RenderOptions,
    names: Vec<String>,
    subject: Subject,
    camera: Camera,
    settings: Settings,
    touched: Option<Touched<3>>,
}

impl<'a> Stage<'a> {
    fn of(options: &'a RenderOptions, scene: &BuiltScene<3>) -> Result<Self, Failure> {
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
        let legend = legend(&settings, &names, subject.bodies()).legend_height();
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
