// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Whole figures: their bytes, their pixels, their words.

use palpate_plot::{
    BoundedField, Cell, Chart, ChartQuantity, Color, Dash, DrawnBody, Figure, Isolines,
    Markers, PlaneView, PlotError, Polyline, SampledSlope, Sampling, Series, Slice,
    SurfaceLines,
};

fn disc(points: &[[f64; 2]], values: &mut [f64]) {
    for (p, value) in points.iter().zip(values) {
        *value = p[0].hypot(p[1]) - 0.03;
    }
}

fn isolines(cells: usize) -> Result<Isolines, PlotError> {
    let view = PlaneView::new([0.0, 0.0], 0.12, 0.08)?;
    Isolines::sample(&Slice::planar(), &view, Sampling::new(cells)?, disc)
}

fn full_figure() -> Result<Figure, PlotError> {
    let path = [[-0.05, 0.03], [0.0, 0.0], [0.05, 0.03]];
    let isolines = isolines(200)?
        .with_polyline(Polyline::new("hand <1>", path)?)
        .with_markers(Markers::new("contact", [[0.03, 0.0]])?.with_labels(["A & B"]));
    let force = Series::new("normal", [[0.0, 0.0], [1.0, 2.0], [2.0, 0.0]])?;
    let chart = Chart::new(ChartQuantity::new("time", "s"), ChartQuantity::new("force", "N"));
    Ok(Figure::new("Disc \"of\" 3 cm")
        .with_caption("exact")
        .with_isolines(isolines)
        .with_chart(chart.with_series(force)))
}

/// The words of a figure: titles, ticks, labels and legend.
fn words(svg: &str) -> Vec<&str> {
    svg.split("aria-label=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

#[test]
fn golden_figure() {
    let svg = Figure::new("Disc").with_isolines(isolines(8).unwrap()).to_svg();
    // Outlines of letters are the font's, not ours: the words stand for them.
    let ours: Vec<String> = svg
        .lines()
        .map(|line| match line.split_once("aria-label=") {
            Some((before, rest)) => format!("{before}{}", rest.split(" d=").next().unwrap()),
            None if line.contains("aria-hidden") => {
                line.split(" d=").next().unwrap().to_owned()
            }
            None => line.to_owned(),
        })
        .collect();
    insta::assert_snapshot!(ours.join("\n"));
}

/// A halo once was the stroke of its letters, to be painted first by `paint-order`; renderers
/// that do not know that covered every label with its halo.
#[test]
fn letters_are_painted_over_their_halos() {
    let svg = full_figure().unwrap().to_svg();
    let lines: Vec<&str> = svg.lines().collect();
    let outline = |line: &str| line.split(" d=").nth(1).map(str::to_owned);
    let halos: Vec<usize> =
        (0..lines.len()).filter(|i| lines[*i].contains("aria-hidden")).collect();
    assert!(!halos.is_empty());
    for i in halos {
        let letters = lines[i + 1];
        assert!(letters.contains("aria-label") && !letters.contains("stroke"), "{letters}");
        assert_eq!(outline(lines[i]), outline(letters));
    }
}

#[test]
fn same_figure_same_bytes() {
    let (a, b) = (full_figure().unwrap(), full_figure().unwrap());
    assert_eq!(a.to_svg(), b.to_svg());
    assert_eq!(a.to_png(400).unwrap(), b.to_png(400).unwrap());
}

#[test]
fn figures_say_what_they_show() {
    let svg = full_figure().unwrap().to_svg();
    let words = words(&svg);
    for expected in [
        "Disc &quot;of&quot; 3 cm",
        "exact",
        "x [m]",
        "y [m]",
        "inside",
        "surface",
        "outside",
        "isolines every 0.01 m, labelled in metres",
        "20 mm",
        "−0.01",
        "0.01",
        "hand &lt;1&gt;",
        "A &amp; B",
        "time [s]",
        "force [N]",
        "normal",
    ] {
        assert!(words.contains(&expected), "{expected} in {words:?}");
    }
}

#[test]
fn a_figure_without_surface_says_so() {
    let view = PlaneView::new([1.0, 0.0], 0.1, 0.1).unwrap();
    let isolines =
        Isolines::sample(&Slice::planar(), &view, Sampling::default(), disc).unwrap();
    let svg = Figure::new("").with_isolines(isolines).to_svg();
    let words = words(&svg);
    assert!(words.contains(&"no surface in view") && !words.contains(&"inside"), "{words:?}");
}

#[test]
fn a_curve_without_interior_has_a_surface_line() {
    let view = PlaneView::new([0.0, 0.0], 0.1, 0.1).unwrap();
    let circle = |points: &[[f64; 2]], values: &mut [f64]| {
        disc(points, values);
        values.iter_mut().for_each(|value| *value = value.abs());
    };
    let isolines =
        Isolines::sample(&Slice::planar(), &view, Sampling::default(), circle).unwrap();
    let svg = Figure::new("").with_isolines(isolines).to_svg();
    assert!(words(&svg).contains(&"surface") && !words(&svg).contains(&"inside"));
    assert!(svg.contains("<path fill=\"#171a1f\" fill-rule=\"evenodd\" d="));
}

/// A disc about a point of the x axis.
struct Disc(f64);

impl Disc {
    const RADIUS: f64 = 0.03;

    fn value(&self, p: &[f64; 2]) -> f64 {
        (p[0] - self.0).hypot(p[1]) - Self::RADIUS
    }
}

impl BoundedField for Disc {
    fn values(&mut self, points: &[[f64; 2]], values: &mut [f64]) {
        points.iter().zip(values).for_each(|(p, value)| *value = self.value(p));
    }

    fn slopes(&mut self, points: &[[f64; 2]], slopes: &mut [SampledSlope]) {
        for (p, slope) in points.iter().zip(slopes) {
            let value = self.value(p);
            let gradient = [p[0] - self.0, p[1], 0.0].map(|x| x / (value + Self::RADIUS));
            *slope = SampledSlope { value, gradient };
        }
    }

    fn safe_radii(&mut self, points: &[[f64; 2]], radii: &mut [f64]) {
        self.values(points, radii);
        radii.iter_mut().for_each(|radius| *radius = radius.abs());
    }

    fn bounds(&mut self, cells: &[Cell], bounds: &mut [[f64; 2]]) {
        for (cell, bounds) in cells.iter().zip(bounds) {
            let (value, change) = (self.value(&cell.centre), 1.5 * cell.half);
            *bounds = [value - change, value + change];
        }
    }
}

/// Discs about these points of the x axis, called disc 0, disc 1 and so on.
fn discs(places: &[f64]) -> Result<Figure, PlotError> {
    let view = PlaneView::new([0.0, 0.0], 0.3, 0.1)?;
    let whole = |points: &[[f64; 2]], values: &mut [f64]| {
        let value = |p| places.iter().map(|x| Disc(*x).value(p)).fold(f64::INFINITY, f64::min);
        points.iter().zip(values).for_each(|(p, v)| *v = value(p));
    };
    let body = |(number, x): (usize, &f64)| {
        let outline = SurfaceLines::follow(&view, Sampling::new(100)?, Disc(*x))?;
        Ok(DrawnBody::new(format!("disc {number}"), outline).with_note("wood"))
    };
    let bodies: Vec<DrawnBody> =
        places.iter().enumerate().map(body).collect::<Result<_, _>>()?;
    let isolines = Isolines::sample(&Slice::planar(), &view, Sampling::new(100)?, whole)?;
    Ok(Figure::new("Discs").with_isolines(isolines.with_bodies(bodies)))
}

#[test]
fn bodies_have_names_colours_and_a_legend() {
    let svg = discs(&[-0.1, 0.0, 0.1]).unwrap().to_svg();
    let found = words(&svg);
    // Once at the body, once in the legend with the note.
    for expected in ["disc 0", "disc 1", "disc 2", "wood", "disc 0 (wood)", "disc 2 (wood)"] {
        assert!(found.contains(&expected), "{expected} in {found:?}");
    }
    assert!(!found.contains(&"in several bodies") && !found.contains(&"surface"));
    // An outline and a key each, in colours that differ and of one width.
    for color in ["#1b5fb0", "#a82a1a", "#1a7d3c"] {
        let stroke = format!("stroke=\"{color}\" stroke-width=\"3.2\"");
        assert_eq!(svg.matches(&stroke).count(), 2, "{color}");
        assert!(svg.contains(&format!("fill=\"{color}\" fill-rule=\"evenodd\" fill-opacity")));
    }
}

#[test]
fn what_bodies_share_is_hatched_and_outlines_that_meet_differ_in_width() {
    let svg = discs(&[-0.02, 0.02]).unwrap().to_svg();
    assert!(words(&svg).contains(&"in several bodies"));
    assert!(svg.contains("stroke=\"#1b5fb0\" stroke-width=\"3.2\""));
    assert!(svg.contains("stroke=\"#a82a1a\" stroke-width=\"1.5\""));
    // Where outlines coincide, the narrow one is drawn last.
    let svg = discs(&[0.0, 0.0]).unwrap().to_svg();
    let place = |text: &str| svg.find(text).unwrap();
    assert!(place("stroke-width=\"3.2\"") < place("stroke-width=\"1.5\""));
}

#[test]
fn a_body_alone_is_drawn_in_ink_with_its_name() {
    let svg = discs(&[0.0]).unwrap().to_svg();
    assert!(words(&svg).contains(&"surface of disc 0 (wood)"));
    assert!(svg.contains("stroke=\"#171a1f\" stroke-width=\"2.8\""));
    assert!(svg.contains("fill=\"#b2d1ea\"") && !svg.contains("fill-opacity"));
    // Out of sight, it is not in the legend.
    let beyond = discs(&[9.0]).unwrap().to_svg();
    assert!(words(&beyond).contains(&"no surface in view"));
}

#[test]
fn more_than_twelve_bodies_share_colours_and_the_legend_says_which() {
    let places: Vec<f64> = (0..14).map(|i| 0.02 * f64::from(i) - 0.13).collect();
    let svg = discs(&places).unwrap().to_svg();
    let found = words(&svg);
    assert!(found.contains(&"disc 0 (wood), disc 12 (wood)"), "{found:?}");
    assert!(
        found.contains(&"disc 1 (wood), disc 13 (wood)") && found.contains(&"disc 2 (wood)")
    );
    let places: Vec<f64> = (0..62).map(|i| 0.004 * f64::from(i) - 0.13).collect();
    let svg = discs(&places).unwrap().to_svg();
    let listed = "disc 0 (wood), disc 12 (wood), disc 24 (wood), disc 36 (wood) and 2 more";
    assert!(words(&svg).contains(&listed), "{:?}", words(&svg));
}

#[test]
fn svg_and_png_are_the_same_picture() {
    let figure = full_figure().unwrap();
    let tree = resvg::usvg::Tree::from_str(&figure.to_svg(), &Default::default()).unwrap();
    let size = tree.size().to_int_size();
    let mut from_svg = resvg::tiny_skia::Pixmap::new(size.width(), size.height()).unwrap();
    resvg::render(&tree, Default::default(), &mut from_svg.as_mut());
    let png = figure.to_png(800).unwrap();
    let ours = resvg::tiny_skia::Pixmap::decode_png(&png).unwrap();
    assert_eq!((ours.width(), ours.height()), (from_svg.width(), from_svg.height()));
    // The SVG rounds coordinates to hundredths of a pixel: greys of edges differ a little.
    let differences = ours.data().iter().zip(from_svg.data()).map(|(a, b)| a.abs_diff(*b));
    let largest = differences.clone().max().unwrap();
    let mean = differences.map(f64::from).sum::<f64>() / ours.data().len() as f64;
    assert!(largest <= 48 && mean < 0.05, "{largest} {mean}");
}

/// A disc with its gradients.
fn slopes(points: &[[f64; 2]], slopes: &mut [SampledSlope]) {
    for (p, slope) in points.iter().zip(slopes) {
        let r = p[0].hypot(p[1]);
        *slope = SampledSlope { value: r - 0.03, gradient: [p[0] / r, p[1] / r, 0.0] };
    }
}

#[test]
fn a_gradient_has_the_colour_of_its_direction() {
    let gradient = isolines(200).unwrap().with_gradient(slopes).unwrap();
    let figure = Figure::new("").with_isolines(gradient);
    let pixels = resvg::tiny_skia::Pixmap::decode_png(&figure.to_png(800).unwrap()).unwrap();
    // The plot spans 0.12 m, right of the ticks; its middle is the disc's.
    let svg = figure.to_svg();
    let number = |key: &str| -> f64 {
        let rest = svg.split("<image ").nth(1).unwrap().split(&format!("{key}=\"")).nth(1);
        rest.unwrap().split('"').next().unwrap().parse().unwrap()
    };
    let [x, y, width, height] = ["x", "y", "width", "height"].map(number);
    let at = |right: f64, up: f64| {
        let place = [x + width * (0.5 + right), y + height * 0.5 - width * up];
        let pixel = pixels.pixel(place[0] as u32, place[1] as u32).unwrap();
        [pixel.red(), pixel.green(), pixel.blue()].map(i32::from)
    };
    let ([r, g, b], [left_r, left_g, left_b]) = (at(0.4, 0.0), at(-0.4, 0.0));
    assert!(r + g + b > left_r + left_g + left_b + 150, "lighter to the right");
    assert!(g > r && left_r > left_g, "green to the right, red to the left");
    let ([r, _, b], [down_r, _, down_b]) = (at(0.0, 0.3), at(0.0, -0.3));
    assert!(r > b + 100 && down_b > down_r + 100, "yellow upwards, blue downwards");
    assert_eq!(at(0.3, 0.0), at(0.42, 0.0), "the same for the same direction");
    let words = words(&svg);
    assert!(words.contains(&"x") && words.contains(&"y"), "{words:?}");
    assert!(!words.contains(&"inside") && words.contains(&"surface"), "{words:?}");
}

#[test]
fn directions_are_those_of_a_method() {
    let picture = isolines(100).unwrap().with_directions("dichotomy", slopes).unwrap();
    let svg = Figure::new("").with_isolines(picture).to_svg();
    let words = words(&svg);
    assert!(words.contains(&"direction that dichotomy finds"));
    assert!(words.contains(&"none, or leaning out of the plane"), "{words:?}");
    assert!(!words.iter().any(|word| word.contains("steeper") || word.contains("rim")));
}

#[test]
fn panels_share_axes_and_a_legend() -> Result<(), PlotError> {
    let finger = |number: usize| {
        let force = Series::new("force", [[0.0, 0.0], [4.0, 1.0 + number as f64]])?;
        let force = force.with_color(Color::numbered(number)).with_dash(Dash::Solid);
        let chart =
            Chart::new(ChartQuantity::new("time", "s"), ChartQuantity::new("force", "N"));
        Ok(chart.with_series(force).with_title(format!("finger {number}")))
    };
    let fingers = (0..5).map(finger).collect::<Result<Vec<_>, PlotError>>()?;
    let svg = Figure::new("").with_panels(fingers).to_svg();
    let found = words(&svg);
    let count = |text: &str| found.iter().filter(|word| **word == text).count();
    // The last panel of each column has an axis below it, the first of each row one beside it.
    assert_eq!(["time [s]", "force [N]", "force"].map(count), [2, 1, 1], "{found:?}");
    assert_eq!(count("5"), 3, "the largest force is on every axis: {found:?}");
    assert!((0..5).all(|number| count(&format!("finger {number}")) == 1));
    // A line in a colour of its own in each panel, explained in ink.
    assert_eq!(svg.matches("stroke=\"#743aa6\"").count(), 1);
    Ok(())
}

#[test]
fn pictures_of_impossible_size_are_refused() {
    let figure = full_figure().unwrap();
    for width in [0, 63, 20_000, u32::MAX] {
        let error = figure.to_png(width).unwrap_err();
        assert!(matches!(error, PlotError::PictureSize { .. }), "{error}");
    }
    assert!(figure.to_png(64).is_ok());
}

#[test]
fn bad_samples_are_named() {
    let view = PlaneView::new([0.0, 0.0], 0.12, 0.08).unwrap();
    let nan = |_: &[[f64; 2]], values: &mut [f64]| values.fill(f64::NAN);
    let error =
        Isolines::sample(&Slice::planar(), &view, Sampling::default(), nan).unwrap_err();
    assert!(error.to_string().starts_with("the field is NaN at (-0.06"), "{error}");
    assert!(isolines(20).unwrap().with_step(-1.0).is_err());
    assert!(isolines(20).unwrap().with_step(1e-9).is_err());
}
