// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The pictures of a run, and their files.

use std::f64::consts::TAU;
use std::io::Write;
use std::path::{Path, PathBuf};

use indicatif::{ProgressBar, ProgressStyle};
use palpate::render::{Camera, Image, RenderError, Rendering, Work, render, write_animation};

use super::Stage;
use crate::interrupt::Interrupt;
use crate::outcome::Failure;
use crate::output::{self, Destination, Files, shown};
use crate::render::RenderOptions;

/// The most pixels of an animated PNG, whose pictures wait in memory: 600 megabytes.
const MOST_PIXELS: u64 = 200_000_000;

/// How long an animated PNG shows a picture at most [s]; its number of milliseconds has 16 bits.
const LONGEST: f64 = 65.0;

/// Steps of the progress bar for each picture.
const STEPS: f64 = 100.0;

/// Where the pictures of a run go.
pub(super) enum Frames {
    /// One picture, or an animation of so many.
    One(Destination, Option<u32>),
    /// A picture in each file.
    Many(Vec<Destination>),
}

/// What a run has drawn.
pub(super) struct Drawn {
    /// The names of the files that were written.
    pub(super) files: Vec<PathBuf>,
    /// How many pictures there are.
    pub(super) pictures: u32,
    /// How many there are to be.
    pub(super) asked: u32,
    /// What the first picture says of itself; `None` if there is none.
    pub(super) first: Option<Rendering>,
    /// For rays of sight and to the light, of all pictures.
    pub(super) work: [Work; 2],
}

impl Drawn {
    /// Whether pictures are missing.
    pub(super) fn is_interrupted(&self) -> bool {
        self.pictures < self.asked
    }

    pub(super) fn what_is_left(&self) -> String {
        let Self { pictures, asked, files, .. } = self;
        let place = match files.first() {
            Some(file) if *pictures > 0 => format!(", from {} on", file.display()),
            _ => String::new(),
        };
        format!("interrupted: {pictures} of {asked} pictures are done{place}")
    }

    /// Rays of sight that are undecided.
    pub(super) fn undecided(&self) -> u64 {
        self.work[0].undecided
    }
}

impl Frames {
    /// Checks that all files can be written.
    pub(super) fn of(options: &RenderOptions) -> Result<Self, Failure> {
        let mut files = Files::reading([options.scene.as_path()], options.reading);
        let stem = Path::new(options.scene.file_stem().unwrap_or_default());
        if let Some(pictures) = options.turntable {
            check(options, pictures)?;
        }
        let (Some(folder), Some(pictures)) = (&options.frames, options.turntable) else {
            let usual = || stem.with_extension("png");
            let path = options.output.clone().unwrap_or_else(usual);
            if output::ending(&path) != "png" {
                let problem = "the name of a rendered picture must end in .png";
                return Err(Failure::file(&path, problem));
            }
            return Ok(Self::One(files.output(&path)?, options.turntable));
        };
        output::make_folder(folder)?;
        let file = |picture: u32| {
            let name = format!("{}-{picture:04}.png", stem.display());
            files.output(&folder.join(name))
        };
        Ok(Self::Many((1..=pictures).map(file).collect::<Result<_, _>>()?))
    }

    /// Draws and writes all pictures, or those that are finished when the run is to end.
    pub(super) fn draw(
        &self,
        stage: &Stage<'_>,
        interrupt: &Interrupt,
    ) -> Result<Drawn, Failure> {
        let asked = match self {
            Self::One(_, turntable) => turntable.unwrap_or(1),
            Self::Many(files) => files.len() as u32,
        };
        let style = ProgressStyle::with_template("{msg} {bar:40} {percent}%");
        let bar = ProgressBar::new(u64::from(asked) * STEPS as u64)
            .with_style(style.map_err(Failure::input)?);
        let files = Vec::new();
        let work = [Work::default(); 2];
        let mut drawn = Drawn { files, pictures: 0, asked, first: None, work };
        let mut images = Vec::new();
        for picture in 0..asked {
            bar.set_message(format!("picture {} of {asked}", picture + 1));
            let watch = |share: f64| {
                bar.set_position((STEPS * (f64::from(picture) + share)) as u64);
                !interrupt.is_asked()
            };
            let Some(image) = drawn.picture(stage, picture, &watch)? else { break };
            match self {
                Self::One(..) => images.push(image),
                Self::Many(files) => {
                    let file = &files[picture as usize];
                    file.write(|out| image.write_png(out).map_err(failed))?;
                    if !stage.options.json {
                        bar.suspend(|| say(file.name()))?;
                    }
                    drawn.files.push(file.name().to_owned());
                }
            }
        }
        bar.finish_and_clear();
        if let Self::One(file, turntable) = self {
            drawn.write(file, turntable.map(|_| delay(stage.options)), &images)?;
        }
        Ok(drawn)
    }
}

impl Drawn {
    /// Draws a picture; `None` if the watch ends it.
    fn picture(
        &mut self,
        stage: &Stage<'_>,
        picture: u32,
        watch: &(dyn Fn(f64) -> bool + Sync),
    ) -> Result<Option<Image>, Failure> {
        let camera = turned(stage, f64::from(picture) / f64::from(self.asked));
        let rendering = render(&stage.subject, &camera, &stage.settings, watch);
        let Some(mut rendering) = rendering.map_err(|error| said(stage, error))? else {
            return Ok(None);
        };
        rendering.image.lay_over(&stage.overlay(&camera)?);
        for (all, work) in self.work.iter_mut().zip([rendering.sight, rendering.light]) {
            all.add(&work);
        }
        self.pictures += 1;
        let image = rendering.image.clone();
        self.first.get_or_insert(rendering);
        Ok(Some(image))
    }

    /// Writes the pictures into one file; if some are missing, into its part.
    fn write(
        &mut self,
        file: &Destination,
        delay_ms: Option<u16>,
        images: &[Image],
    ) -> Result<(), Failure> {
        let Some(first) = images.first() else { return Ok(()) };
        let is_whole = !self.is_interrupted();
        file.write_whole(
            |out| match delay_ms {
                None => first.write_png(out).map_err(failed),
                Some(delay_ms) => write_animation(images, delay_ms, out).map_err(failed),
            },
            |()| is_whole,
        )?;
        let part = file.part().filter(|_| !is_whole);
        self.files.push(part.unwrap_or_else(|| file.name().to_owned()));
        Ok(())
    }
}

/// The camera of a turntable at a share of its way around.
fn turned(stage: &Stage<'_>, share: f64) -> Camera {
    if share == 0.0 {
        return stage.camera;
    }
    stage.camera.turned(TAU * share, stage.subject.bounds().centre())
}

/// How long a picture of a turntable is shown [ms].
fn delay(options: &RenderOptions) -> u16 {
    let pictures = f64::from(options.turntable.unwrap_or(1));
    (1e3 * options.turn_time / pictures).round().clamp(1.0, f64::from(u16::MAX)) as u16
}

/// Refuses turntables that no file holds.
fn check(options: &RenderOptions, pictures: u32) -> Result<(), Failure> {
    let (time, most) = (options.turn_time, LONGEST * f64::from(pictures));
    if time > most {
        return Err(Failure::input(format!(
            "--turn-time must be at most {most} s for {pictures} pictures, {LONGEST} s for each, \
             got {time} s"
        )));
    }
    let pixels = u64::from(options.width) * u64::from(options.height) * u64::from(pictures);
    if options.frames.is_none() && pixels > MOST_PIXELS {
        return Err(Failure::input(format!(
            "an animation has {MOST_PIXELS} pixels at most, got {pixels}; make it smaller, or write \
             its pictures into a folder with --frames"
        )));
    }
    Ok(())
}

/// Prints a line for a picture that is written.
fn say(path: &Path) -> Result<(), Failure> {
    Ok(writeln!(output::answer(), "{}", shown(&path.display().to_string()))?)
}

fn failed(error: RenderError) -> Failure {
    Failure::Output(std::io::Error::other(error))
}

/// The error, with the name of a body that it numbers.
fn said(stage: &Stage<'_>, error: RenderError) -> Failure {
    match error {
        RenderError::Inside { body, from } => {
            let name = &stage.names[body];
            let advice = if stage.options.from.is_some() {
                "move it out"
            } else {
                "say with --from where it is, or give another --azimuth and --elevation"
            };
            Failure::input(format!(
                "the camera at {from:?} m is inside the body {name:?}: {advice}"
            ))
        }
        other => Failure::input(other),
    }
}
