// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Whole pictures: the same bits on any threads, a golden one, what wrong input says.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

use std::sync::atomic::{AtomicUsize, Ordering};

use palpate_field::{Shape, Vector};
use palpate_render::{
    Camera, Cut, Image, Lens, RenderError, Rendering, Settings, Shadows, Sight, SrgbColor,
    Subject, render, write_animation,
};

/// A ball on a plate with a hole, and a ring around it.
fn subject() -> Subject {
    let ball = Shape::ball(0.04).unwrap().translated([0.0, 0.05, 0.0]).unwrap();
    let hole = Shape::cylinder(0.02, 0.1).unwrap().translated([0.06, 0.0, 0.03]).unwrap();
    let plate = Shape::cuboid([0.2, 0.02, 0.15]).unwrap() - hole;
    let ring = Shape::torus(0.06, 0.008).unwrap().translated([0.0, 0.05, 0.0]).unwrap();
    Subject::of_shapes([ball, plate, ring]).unwrap()
}

fn camera(subject: &Subject) -> Camera {
    let sight = Sight::from_angles(0.5, 0.5).unwrap();
    Camera::fitting(&subject.corners(), sight, Lens::USUAL, 4.0 / 3.0).unwrap()
}

fn rendered(settings: &Settings) -> Rendering {
    let subject = subject();
    render(&subject, &camera(&subject), settings, &|_| true).unwrap().unwrap()
}

#[test]
fn a_picture_has_the_same_bits_on_any_number_of_threads() {
    let settings = Settings { ground: Some(-0.01), ..Settings::new(61, 43) };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| rendered(&settings))
    };
    let one = on(1);
    assert_eq!(one.sight.undecided + one.light.undecided, 0);
    for threads in [2, 5] {
        assert_eq!(one, on(threads));
    }
}

/// Each pixel as a letter for its hue and one for its lightness.
fn letters(image: &Image) -> String {
    let letter = |color: &SrgbColor| {
        let SrgbColor([red, green, blue]) = *color;
        let (most, least) = (red.max(green).max(blue), red.min(green).min(blue));
        let hue = match () {
            () if most - least < 24 => '.',
            () if most == blue => 'b',
            () if most == green => 'g',
            () => 'r',
        };
        format!("{hue}{:x}", most / 16)
    };
    let rows = image.pixels().chunks(image.width() as usize);
    let row = |row: &[SrgbColor]| row.iter().map(letter).collect::<String>() + "\n";
    rows.map(row).collect()
}

#[test]
fn a_small_picture_is_as_it_was() {
    let settings = Settings { ground: Some(-0.01), ..Settings::new(32, 24) };
    insta::assert_snapshot!("whole", letters(&rendered(&settings).image));
    let cut = Cut::new([0.0, 0.0, 0.01], [0.0, 0.0, 1.0]).unwrap();
    let settings = Settings { cut: Some(cut), shadows: Shadows::None, ..settings };
    insta::assert_snapshot!("cut", letters(&rendered(&settings).image));
}

/// The shares of the colours of the first three bodies and of the background.
fn shares(image: &Image) -> [f64; 4] {
    let mut counts = [0; 4];
    for SrgbColor([red, green, blue]) in image.pixels().iter().copied() {
        let (red, green, blue) = (i32::from(red), i32::from(green), i32::from(blue));
        let body = match () {
            () if blue - red > 40 => 0,
            () if red - blue > 60 => 1,
            () if green - red > 30 => 2,
            () => 3,
        };
        counts[body] += 1;
    }
    counts.map(|count| f64::from(count) / image.pixels().len() as f64)
}

#[test]
fn a_ball_covers_what_its_equation_says() {
    // Seen from 4 m, a ball of 1 m covers a disc of tan(asin(1/4)) at a distance of one.
    let subject = Subject::of_shapes([Shape::ball(1.0).unwrap()]).unwrap();
    let (eye, angle) = (Vector([0.0, 0.0, 4.0]), 0.6_f64);
    let camera = Camera::looking(eye, Vector::ZERO, Lens::Perspective(angle)).unwrap();
    let settings = Settings::new(200, 150);
    let rendering = render(&subject, &camera, &settings, &|_| true).unwrap().unwrap();
    let disc = std::f64::consts::PI * (1.0 / 15.0);
    let shown = (2.0 * (0.5 * angle).tan()).powi(2) * 200.0 / 150.0;
    let [ball, ..] = shares(&rendering.image);
    // The edge is 280 pixels long, and each is half covered within its samples.
    assert!((ball - disc / shown).abs() < 140.0 / 30_000.0, "{ball} {}", disc / shown);
}

#[test]
fn a_wire_of_no_radius_is_an_unbroken_line() {
    let wire = Shape::segment([-1.0, -0.37, 0.0], [1.0, 0.41, 0.0], 0.0).unwrap();
    let subject = Subject::of_shapes([wire]).unwrap();
    let camera =
        Camera::facing(Sight::from_angles(0.0, 0.0).unwrap(), Vector::ZERO, 1.0, 2.0).unwrap();
    let settings = Settings { samples: 1, ..Settings::new(80, 60) };
    let rendering = render(&subject, &camera, &settings, &|_| true).unwrap().unwrap();
    assert!((rendering.thin - 0.6 / 60.0).abs() < 1e-15);
    let rows = rendering.image.pixels().chunks(80);
    let is_wire = |color: &SrgbColor| *color != SrgbColor::BACKGROUND;
    let columns = (0..80).filter(|x| rows.clone().any(|row| is_wire(&row[*x]))).count();
    assert_eq!(columns, 80);
}

#[test]
fn a_cut_shows_what_is_behind_it() {
    let shell = Shape::ball(1.0).unwrap() - Shape::ball(0.9).unwrap();
    let inner = Shape::ball(0.5).unwrap();
    let subject = Subject::of_shapes([shell, inner]).unwrap();
    let camera =
        Camera::facing(Sight::from_angles(0.0, 0.0).unwrap(), Vector::ZERO, 2.4, 3.0).unwrap();
    let settings =
        Settings { shadows: Shadows::None, spacing: Some(1.0), ..Settings::new(96, 72) };
    let image = |settings: &Settings| {
        render(&subject, &camera, settings, &|_| true).unwrap().unwrap().image
    };
    let [whole, none, ..] = shares(&image(&settings));
    assert!(whole > 0.3 && none == 0.0, "{whole} {none}");
    let cut = Cut::new([0.0, 0.0, 0.2], [0.0, 0.0, 1.0]).unwrap();
    let [_, inner, ..] = shares(&image(&Settings { cut: Some(cut), ..settings }));
    // A disc of √(0.5² − 0.2²) m in a picture of 3.2 m by 2.4 m, pale, but for its outline.
    let expected = std::f64::consts::PI * (0.25 - 0.04) / (3.2 * 2.4);
    assert!((inner - expected).abs() < 0.03, "{inner} {expected}");
}

#[test]
fn endless_bodies_fade_before_the_horizon() {
    let floor = Shape::half_space([0.0, 1.0, 0.0], 0.0).unwrap();
    let ball = Shape::ball(0.5).unwrap().translated([0.0, 0.5, 0.0]).unwrap();
    let subject = Subject::of_shapes([ball, floor]).unwrap();
    assert!(!subject.is_bounded());
    let camera =
        Camera::looking(Vector([0.0, 1.0, 4.0]), Vector([0.0, 1.0, 0.0]), Lens::USUAL).unwrap();
    let rendering =
        render(&subject, &camera, &Settings::new(40, 30), &|_| true).unwrap().unwrap();
    assert_eq!(rendering.sight.undecided, 0);
    let row = |y: usize| &rendering.image.pixels()[y * 40..(y + 1) * 40];
    assert!(row(0).iter().all(|color| *color == SrgbColor::BACKGROUND));
    // Just below the horizon the floor is as far as it is drawn, below it has its colour.
    let difference = |color: SrgbColor| {
        let pairs = color.0.into_iter().zip(SrgbColor::BACKGROUND.0);
        pairs.map(|(a, b)| a.abs_diff(b)).max().unwrap()
    };
    assert!(difference(row(15)[0]) < 8, "{:?}", row(15)[0]);
    assert!(difference(row(29)[0]) > 60, "{:?}", row(29)[0]);
}

#[test]
fn shadows_are_hard_soft_or_none() {
    let settings = Settings { ground: Some(-0.01), ..Settings::new(64, 48) };
    let none = rendered(&Settings { shadows: Shadows::None, ..settings });
    let [hard, soft] = [Shadows::Hard, Shadows::Soft].map(|shadows| {
        let rendering = rendered(&Settings { shadows, ..settings });
        let darker = rendering.image.pixels().iter().zip(none.image.pixels());
        let darker = darker.filter(|(a, b)| a.0[1] + 4 < b.0[1]).count();
        assert!(darker > 150, "{shadows:?}: {darker}");
        rendering
    });
    assert_eq!(none.light.rays, 0);
    assert!(soft.light.rays > hard.light.rays);
}

#[test]
fn a_watch_sees_the_work_grow_and_can_end_it() {
    let subject = subject();
    let (calls, settings) = (AtomicUsize::new(0), Settings::new(64, 48));
    let watch = |share: f64| {
        assert!(share > 0.0 && share <= 1.0, "{share}");
        calls.fetch_add(1, Ordering::Relaxed) < 3
    };
    assert_eq!(render(&subject, &camera(&subject), &settings, &watch).unwrap(), None);
    assert!(calls.load(Ordering::Relaxed) >= 4);
}

#[test]
fn wrong_input_says_what_is_wrong() {
    let subject = subject();
    let camera = camera(&subject);
    let settings = Settings::new(8, 6);
    let said = |camera: &Camera, settings: &Settings| {
        render(&subject, camera, settings, &|_| true).unwrap_err().to_string()
    };
    assert_eq!(
        said(&camera, &Settings::new(0, 6)),
        "a picture must have 1 to 40000000 pixels, got 0 x 6"
    );
    assert_eq!(
        said(&camera, &Settings::new(100_000, 100_000)),
        "a picture must have 1 to 40000000 pixels, got 100000 x 100000"
    );
    assert_eq!(
        said(&camera, &Settings { samples: 9, ..settings }),
        "an edge must have 1 to 8 samples along a pixel's side, got 9"
    );
    assert_eq!(
        said(&camera, &Settings { spacing: Some(0.0), ..settings }),
        "the spacing of isolines must be positive and at most 1e15, got 0.0 m"
    );
    assert_eq!(
        said(&camera, &Settings { ground: Some(f64::NAN), ..settings }),
        "the height of the ground must be finite, got NaN m"
    );
    let inside = Camera::looking(Vector([0.0, 0.0, 0.05]), Vector::ZERO, Lens::USUAL).unwrap();
    assert_eq!(
        said(&inside, &settings),
        "the camera at [0.0, 0.0, 0.05] m is inside body 1: move it out"
    );
    let refused = |camera: Result<Camera, RenderError>| camera.unwrap_err().to_string();
    assert_eq!(
        refused(Camera::looking(Vector::ZERO, Vector::ZERO, Lens::USUAL)),
        "a camera must look at another point than its own, got [0.0, 0.0, 0.0] m for both"
    );
    assert_eq!(
        refused(Camera::looking(Vector([1.0; 3]), Vector::ZERO, Lens::Perspective(3.5))),
        "the field of view must be between 0 and pi, got 3.5 rad"
    );
    assert_eq!(
        Sight::from_angles(0.0, 2.0).unwrap_err().to_string(),
        "elevation must be from -pi/2 to pi/2, got 2.0 rad"
    );
    assert_eq!(
        Sight::onto_plane([1.0, 0.0, 0.0], [-2.0, 0.0, 0.0]).unwrap_err().to_string(),
        "the up of a camera, across its right, must have a direction, got [-2.0, 0.0, 0.0]"
    );
    assert_eq!(
        Cut::new([0.0; 3], [f64::NAN; 3]).unwrap_err().to_string(),
        "the normal of a cut must have a direction, got [NaN, NaN, NaN]"
    );
    assert_eq!(
        Subject::new(Vec::new()).unwrap_err().to_string(),
        "a picture must show at least 1 body, got 0"
    );
}

#[test]
fn pictures_and_animations_are_read_back() {
    let small = rendered(&Settings { samples: 1, ..Settings::new(24, 18) }).image;
    let subject = subject();
    let turned = camera(&subject).turned(1.0, Vector::ZERO);
    let settings = Settings { samples: 1, ..Settings::new(24, 18) };
    let other = render(&subject, &turned, &settings, &|_| true).unwrap().unwrap().image;
    assert_ne!(small, other);
    let mut file = Vec::new();
    write_animation(&[small.clone(), other.clone()], 125, &mut file).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(&file)).read_info().unwrap();
    let control = reader.info().animation_control.unwrap();
    assert_eq!((control.num_frames, control.num_plays), (2, 0));
    for expected in [&small, &other] {
        let mut pixels = vec![0; 24 * 18 * 3];
        reader.next_frame(&mut pixels).unwrap();
        let expected: Vec<u8> = expected.pixels().iter().flat_map(|color| color.0).collect();
        assert_eq!(pixels, expected);
        let delay = reader.info().frame_control.unwrap();
        assert_eq!((delay.delay_num, delay.delay_den), (125, 1000));
    }
    let wrong = rendered(&Settings { samples: 1, ..Settings::new(12, 18) }).image;
    let refused = write_animation(&[small, wrong], 125, &mut Vec::new()).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "the pictures of an animation must be alike in size, got 24 x 18 and 12 x 18 pixels"
    );
    let none = write_animation(&[], 125, &mut Vec::new()).unwrap_err();
    assert_eq!(none.to_string(), "an animation must have at least 1 picture, got 0");
}
