// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate plot --map error`, and directions by other methods.

use crate::common::{Folder, assert_refused, disc, json, number, palpate, text};
use crate::pictures::words;

/// Of two discs about one centre, the smaller has the larger distance, by the difference of their
/// radii.
#[test]
fn the_difference_of_two_discs_is_that_of_their_radii() {
    let folder = Folder::new();
    let [large, small] = [("large.json", 0.3), ("small.json", 0.05)]
        .map(|(name, r)| folder.write(name, &disc(r)));
    let svg = folder.name("difference.svg");
    let plot = |scene: &str, other: &str| {
        json(&["plot", scene, "--map", "error", "--against", other, "--output", &svg, "--json"])
    };
    for (scene, other, expected) in [(&large, &small, 0.25), (&small, &large, -0.25)] {
        let answer = plot(scene, other);
        assert_eq!(answer["map"], "error");
        for end in ["smallest", "largest"] {
            let found = number(&answer["difference"][end]);
            assert!((found - expected).abs() < 1e-15, "{answer}");
        }
    }
    plot(&large, &small);
    let picture = std::fs::read_to_string(&svg).unwrap();
    let words = words(&picture);
    for word in [
        "difference of values: small − large [m]",
        "surface of disc",
        "surface of small",
        "−0.50",
        "0.50",
    ] {
        assert!(words.contains(&word), "{word} in {words:?}");
    }
    let same =
        palpate(&["plot", &large, "--map", "error", "--against", &large, "--output", &svg]);
    assert!(
        text(&same).ends_with("differences of values from 0.000000 to 0.000000 m\n"),
        "{}",
        text(&same)
    );
}

/// A dichotomy errs by up to 120°/2¹⁰; the exact gradient not at all.
#[test]
fn the_angles_of_a_gradient_are_drawn() {
    let folder = Folder::new();
    let scene = folder.write("disc.json", &disc(0.3));
    let svg = folder.name("error.svg");
    let plot = |method: &str| {
        json(&[
            "plot",
            &scene,
            "--map",
            "error",
            "--gradient",
            method,
            "--output",
            &svg,
            "--json",
        ])
    };
    let most = 120.0 / 1024.0;
    let dichotomy = plot("dichotomy");
    let largest = number(&dichotomy["error_degrees"]["largest"]);
    assert!(largest > 0.99 * most && largest < most + 1e-5, "{dichotomy}");
    assert_eq!(dichotomy["error_degrees"]["largest_at"].as_array().unwrap().len(), 2);
    let picture = std::fs::read_to_string(&svg).unwrap();
    assert!(words(&picture).contains(&"angle from the exact gradient [degrees]"));
    let caption = words(&picture).join(" ");
    assert!(
        caption.contains("gradient by dichotomy, offset 3.000e-6 m, double precision"),
        "{caption}"
    );
    let directions = text(&palpate(&[
        "plot",
        &scene,
        "--map",
        "gradient",
        "--gradient",
        "closest_vector",
        "--output",
        &svg,
    ]));
    assert!(directions.ends_with("directions of the gradient\n"), "{directions}");
    let picture = std::fs::read_to_string(&svg).unwrap();
    let legend = "direction that closest_vector finds";
    assert!(words(&picture).contains(&legend), "{:?}", words(&picture));
    assert_eq!(number(&plot("exact")["error_degrees"]["largest"]), 0.0);
    let closest = plot("closest_vector");
    assert!(number(&closest["error_degrees"]["largest"]) > 179.999, "{closest}");
    assert!(number(&closest["error_degrees"]["smallest"]) < 1e-6, "{closest}");
}

#[test]
fn directions_are_drawn_by_any_method() {
    let folder = Folder::new();
    let svg = folder.name("directions.svg");
    let plot = |scene: &str, method: &str| {
        let answer = json(&[
            "plot",
            scene,
            "--map",
            "gradient",
            "--gradient",
            method,
            "--output",
            &svg,
            "--json",
        ]);
        assert_eq!(answer["map"], "gradient");
        std::fs::read_to_string(&svg).unwrap()
    };
    let scene = folder.write("disc.json", &disc(0.3));
    let exact = plot(&scene, "exact");
    assert!(words(&exact).contains(&"direction that exact finds"));
    // By differences the directions are the same to the eye, by the closest vector they are not.
    assert_ne!(exact, plot(&scene, "closest_vector"));
    let in_space = plot("scenes/s1.json", "differences");
    assert!(words(&in_space).join(" ").contains("gradient by differences"));
}

#[test]
fn options_that_do_not_fit_the_map_are_refused() {
    let folder = Folder::new();
    let svg = folder.name("error.svg");
    let flat = folder.write("flat.json", &disc(0.3));
    let plot = ["plot", "scenes/s1.json", "--output", &svg];
    let planar = format!("{flat}: its fields are not in 3D, as those it is compared with");
    for (more, said) in [
        (&["--map", "error"][..], "--map error needs --against SCENE or --gradient METHOD"),
        (
            &["--map", "error", "--against", "scenes/s2.json", "--gradient", "exact"],
            "--map error compares with --against or with --gradient, not with both",
        ),
        (&["--against", "scenes/s2.json"], "--against is only for --map error"),
        (
            &["--map", "gradient", "--against", "scenes/s2.json", "--gradient", "exact"],
            "--against is only for --map error",
        ),
        (&["--gradient", "exact"], "--gradient is only for --map gradient and --map error"),
        (
            &["--map", "error", "--gradient", "dichotomy"],
            "--gradient dichotomy turns in the plane, and this scene is in 3D: take differences, closest_vector or exact",
        ),
        (
            &["--map", "error", "--gradient", "exact", "--offset", "1e-5"],
            "--offset is for --gradient differences, dichotomy and adaptive_dichotomy: exact compares no values",
        ),
        (
            &["--map", "error", "--gradient", "closest_vector", "--single"],
            "--single is for --gradient differences, dichotomy and adaptive_dichotomy: closest_vector compares no values",
        ),
        (
            &["--map", "error", "--gradient", "exact", "--step", "0.1"],
            "--step is only for --map distance: other maps have no isolines",
        ),
        (&["--map", "error", "--against", &flat], &planar),
    ] {
        assert_refused(&[&plot[..], more].concat(), said);
    }
}
