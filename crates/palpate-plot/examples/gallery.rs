// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Draws three figures into the folder given on the command line:
//! `cargo run -p palpate-plot --example gallery -- figures`

use std::path::Path;

use palpate_plot::{
    Arrow, Arrows, Chart, ChartQuantity, Color, Dash, Figure, Isolines, Markers, PlaneView,
    PlotError, Polyline, Sampling, Series, Slice,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "figures".to_owned());
    std::fs::create_dir_all(&folder)?;
    for (name, figure) in [("union", union()?), ("cup", cup()?), ("press", press()?)] {
        let path = Path::new(&folder).join(name);
        std::fs::write(path.with_extension("svg"), figure.to_svg())?;
        std::fs::write(path.with_extension("png"), figure.to_png(800)?)?;
        println!("{}", path.display());
    }
    Ok(())
}

fn disc(p: [f64; 2], center: [f64; 2], radius: f64) -> f64 {
    (p[0] - center[0]).hypot(p[1] - center[1]) - radius
}

fn rectangle(p: [f64; 2], center: [f64; 2], half_extents: [f64; 2]) -> f64 {
    let q = [0, 1].map(|i| (p[i] - center[i]).abs() - half_extents[i]);
    q[0].max(0.0).hypot(q[1].max(0.0)) + q[0].max(q[1]).min(0.0)
}

/// Calls `distance` for each point.
fn each(distance: impl Fn([f64; 2]) -> f64) -> impl FnMut(&[[f64; 2]], &mut [f64]) {
    move |points, values| {
        for (&p, value) in points.iter().zip(values) {
            *value = distance(p);
        }
    }
}

/// A disc and a rectangle in the plane, with contacts and normals.
fn union() -> Result<Figure, PlotError> {
    let view = PlaneView::new([0.02, 0.0], 0.36, 0.24)?;
    let field =
        each(|p| disc(p, [-0.05, 0.02], 0.05).min(rectangle(p, [0.07, -0.02], [0.06, 0.035])));
    let contacts = [[-0.05, 0.07], [0.13, -0.02], [0.01, 0.015]];
    let normals = [[0.0, 1.0], [1.0, 0.0], [-0.6, 0.8]];
    let normals = contacts.iter().zip(normals).map(|(&tail, vector)| Arrow { tail, vector });
    let isolines = Isolines::sample(&Slice::planar(), &view, Sampling::default(), field)?
        .with_arrows(Arrows::directions("normal", normals)?.with_color(Color::PURPLE))
        .with_markers(
            Markers::new("contact", contacts)?
                .with_labels(["A", "B", "C"])
                .with_color(Color::PURPLE),
        );
    Ok(Figure::new("Union of a disc and a rectangle")
        .with_caption("exact outside, a bound inside")
        .with_isolines(isolines))
}

/// A cup cut through its axis: a hollow cylinder with a floor.
fn cup() -> Result<Figure, PlotError> {
    let slice = Slice::free([0.0, 0.045, 0.0], [1.0, 0.0, 1.0], [0.0, 1.0, 0.0])?;
    let view = PlaneView::of_box(&slice, [-0.04, 0.0, -0.04], [0.04, 0.09, 0.04], 0.25)?;
    let field = each(|p| {
        let [x, y, z] = slice.point(p);
        let profile = [x.hypot(z), y];
        let outer = rectangle(profile, [0.0, 0.045], [0.036, 0.041]) - 0.004;
        let inner = rectangle(profile, [0.0, 0.055], [0.034, 0.045]);
        outer.max(-inner)
    });
    let isolines = Isolines::sample(&slice, &view, Sampling::default(), field)?;
    Ok(Figure::new("Cup, cut along a diagonal")
        .with_caption("a bound on both sides: the difference of two exact solids")
        .with_isolines(isolines))
}

/// A hand that presses on a sphere and slides off: path, proxy and force, seen from above.
fn press() -> Result<Figure, PlotError> {
    let slice = Slice::xz(0.0)?;
    let view = PlaneView::new([0.0, 0.01], 0.2, 0.12)?;
    let radius = 0.05;
    let field = each(|p| {
        let [x, y, z] = slice.point(p);
        (x * x + y * y + (z - 0.02) * (z - 0.02)).sqrt() - radius
    });
    let hand: Vec<[f64; 3]> = (0..=2000)
        .map(|i| f64::from(i) / 2000.0)
        .map(|t| [-0.085 + 0.17 * t, 0.0, -0.052 + 0.042 * (std::f64::consts::PI * t).sin()])
        .collect();
    let proxy = |[x, _, z]: [f64; 3]| {
        let (dx, dz) = (x, z - 0.02);
        let scale = (radius / dx.hypot(dz)).max(1.0);
        [scale * dx, 0.0, 0.02 + scale * dz]
    };
    let force = |p: [f64; 3]| {
        let q = proxy(p);
        [0, 1, 2].map(|i| 400.0 * (q[i] - p[i]))
    };
    let arrows = hand.iter().step_by(125).map(|&p| Arrow {
        tail: slice.project(proxy(p)),
        vector: slice.project_vector(force(p)),
    });
    let isolines = Isolines::sample(&slice, &view, Sampling::default(), field)?
        .with_polyline(
            Polyline::new("proxy", hand.iter().map(|&p| slice.project(proxy(p))))?
                .with_dash(Dash::Solid)
                .with_color(Color::GREEN),
        )
        .with_polyline(
            Polyline::new("hand", hand.iter().map(|&p| slice.project(p)))?
                .with_dash(Dash::Dotted)
                .with_color(Color::PURPLE),
        )
        .with_arrows(Arrows::new("force", "N", arrows)?.with_color(Color::VERMILION));
    let component = |axis: usize| {
        hand.iter().enumerate().map(move |(i, &p)| [i as f64 * 1e-3, force(p)[axis]])
    };
    let chart = Chart::new(ChartQuantity::new("time", "s"), ChartQuantity::new("force", "N"))
        .with_series(Series::new("x", component(0))?.with_color(Color::VERMILION))
        .with_series(Series::new("z", component(2))?.with_color(Color::NAVY));
    Ok(Figure::new("Press on a sphere, and slide off")
        .with_caption("seen from above; proxy on a spring of 400 N/m, no friction")
        .with_isolines(isolines)
        .with_chart(chart))
}
