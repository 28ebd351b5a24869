// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The thread that answers questions about the scene.

use std::sync::mpsc::Receiver;

use palpate::field::Vector;
use palpate::render::{Camera, Color, Lens, Settings, Shadows, Subject, render};
use palpate::scene::{AnyScene, BuiltScene};

use super::Shown;
use super::pages::{Out, PageId, Pages};
use super::questions::{Answer, answer};
use super::room::point_of;
use crate::wire::{Ask, Question, picture};

/// The most pixels along a side of a picture.
const LARGEST: u32 = 2048;

pub(super) fn run(questions: &Receiver<(PageId, Question)>, pages: &Pages, shown: &Shown) {
    while let Ok((page, Question { id, ask })) = questions.recv() {
        let Some((scene, revision)) = shown.get() else {
            pages.refuse(page, id, "there is no scene yet: say hello first", &[]);
            continue;
        };
        let answered = match (&*scene, &ask) {
            (AnyScene::Spatial(scene), Ask::Picture { .. }) => drawn(scene, &ask),
            (AnyScene::Planar(_), Ask::Picture { .. }) => {
                Err("a scene in the plane is drawn from samples".to_owned())
            }
            (AnyScene::Planar(scene), ask) => answer(scene, ask).unwrap_or_else(unknown),
            (AnyScene::Spatial(scene), ask) => answer(scene, ask).unwrap_or_else(unknown),
        };
        match answered {
            Ok(Answer::Text(text)) => pages.answer(page, id, text),
            Ok(Answer::Grid(grid)) => {
                let bytes = grid.bytes(id.unwrap_or_default(), revision);
                pages.send(page, Out::Binary(bytes));
            }
            Ok(Answer::Picture(png)) => {
                let bytes = picture(id.unwrap_or_default(), revision, &png);
                pages.send(page, Out::Binary(bytes));
            }
            Err(why) => pages.refuse(page, id, &why, &[]),
        }
    }
}

fn unknown() -> Result<Answer, String> {
    Err("nothing is known of such a question".to_owned())
}

/// The scene as `palpate render` draws it, without shadows.
fn drawn(scene: &BuiltScene<3>, ask: &Ask) -> Result<Answer, String> {
    let Ask::Picture { eye, target, field_of_view, width, height } = ask else {
        return unknown();
    };
    if !(1..=LARGEST).contains(width) || !(1..=LARGEST).contains(height) {
        return Err(format!(
            "a picture has 1 to {LARGEST} pixels along a side, got {width} × {height}"
        ));
    }
    let said = |error: palpate::render::RenderError| error.to_string();
    let body = |(number, body): (usize, &palpate::scene::BuiltBody<3>)| palpate::render::Body {
        shape: body.shape.clone(),
        color: Color::of_body(number),
    };
    let subject = Subject::new(scene.bodies.iter().enumerate().map(body).collect());
    let subject = subject.map_err(said)?;
    let (eye, target): (Vector<f64, 3>, _) = (point_of(eye)?, point_of(target)?);
    let camera = Camera::looking(eye, target, Lens::Perspective(*field_of_view));
    let camera = camera.map_err(said)?;
    let settings = Settings::new(*width, *height).with_samples(2).with_shadows(Shadows::None);
    let drawn = render(&subject, &camera, &settings, &|_| true).map_err(said)?;
    let drawn = drawn.ok_or("the picture was not finished")?;
    let mut png = Vec::new();
    drawn.image.write_png(&mut png).map_err(said)?;
    Ok(Answer::Picture(png))
}
