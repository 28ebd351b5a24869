// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The bars that rows are held against, and printing.

use crate::fields::Rows;

/// A row's key and the most it may be.
pub(crate) type Bar = (&'static str, f64);

/// What tells how fast the machine is: the row of a peer, and what it is on the machine
/// that bars in nanoseconds are meant for (AMD EPYC, Zen 4).
pub(crate) const YARDSTICK: (&str, f64) = ("S3.distance.point.fidget_jit.ns", 78.0);

/// Those of fields.
pub(crate) const FIELDS: &[Bar] = &[
    ("S3.distance.point.ours_over_fidget_jit", 1.0),
    ("S3.distance.point_f32.ours_over_fidget_jit", 0.9),
    ("S3.distance.1024.ours_over_fidget_jit", 0.65),
    ("S3.distance_gradient.point.ours_over_fidget_jit", 1.0),
    ("S3.distance_gradient.1024.ours_over_fidget_jit", 0.08),
    ("S4.distance.point.ours_over_fidget_jit", 0.15),
    ("S4.distance.1024.ours_over_fidget_jit", 0.5),
    ("S4.distance.clustered.ours_over_fidget_jit", 0.08),
    ("S4.distance_gradient.point.ours_over_fidget_jit", 0.2),
    ("S4.distance_gradient.1024.ours_over_fidget_jit", 0.07),
    ("S1.distance.1024.f64_over_f32", 2.8),
    ("S2.distance.1024.f64_over_f32", 2.8),
    ("S3.distance.1024.f64_over_f32", 2.8),
    ("S4.distance.1024.f64_over_f32", 2.8),
    ("S3.distance_gradient.1024.f64_over_f32", 2.8),
    ("S4.distance_gradient.1024.f64_over_f32", 2.8),
    ("S4.build.scene.ns", 10_000.0),
    ("S3.model.64.ns", 60.0),
    ("thousand.distance.point.ns", 1000.0),
    ("thousand.distance.clustered.ns", 15.0),
    ("S2_twisted.distance.1024.over_child", 4.0),
    ("S3_twisted.distance.1024.over_child", 4.0),
    ("S2_displaced.distance.1024.over_child", 4.0),
    ("S3_displaced.distance.1024.over_child", 4.0),
];

/// Those of searches.
pub(crate) const COLLIDE: &[Bar] = &[
    ("triangle.hit.S1.ns", 80.0),
    ("triangle.hit.S2.ns", 160.0),
    ("triangle.hit.S3.ns", 400.0),
    ("triangle.minimum_1pc.S1.ns", 600.0),
    ("triangle.minimum_1pc.S2.ns", 1200.0),
    ("triangle.minimum_1pc.S3.ns", 3200.0),
    ("mesh.hits_888.S3.p50_ns", 12_000.0),
    ("mesh.hits_100k.S3.p50_ns", 75_000.0),
    ("pair.sign.S3_S3.+50mm.p50_ns", 20_000.0),
    ("pair.sign.S3_S3.+5mm.p50_ns", 35_000.0),
    ("pair.sign.S3_S3.-5mm.p50_ns", 5_000.0),
    ("pair.separation.S3_S3.1pc.p50_ns", 33_000.0),
    ("pair.separation.S3_S3.1mm.p50_ns", 45_000.0),
    ("pair.separation.S3_S3.0.1mm.p50_ns", 55_000.0),
    ("pair.sign.plate_torus.-1mm.p50_ns", 2_500.0),
    ("pair.warm_1mm.S3_S3.p50_ns", 7_000.0),
    ("manifold.boxes.p50_ns", 100_000.0),
    ("manifold.peg.p50_ns", 400_000.0),
    ("manifold.bar_torus.p50_ns", 20_000.0),
    ("parry.ball_torus.manifold.ours_over_parry", 0.005),
    ("world.1000_bodies.step_ns", 10_000_000.0),
];

/// Those of the servo.
pub(crate) const HAPTICS: &[Bar] = &[
    ("tick.sphere.p50_ns", 250.0),
    ("tick.sphere.p99_ns", 500.0),
    ("tick.S3.p50_ns", 600.0),
    ("tick.S3.p99_ns", 1500.0),
    ("tick.union_1000.p50_ns", 1500.0),
    ("tick.union_1000.p99_ns", 4000.0),
    ("tick.ten_fingers_S3.p50_ns", 5000.0),
    ("tick.ten_fingers_S3.p99_ns", 10_000.0),
    ("tick.24_points_union_1000.p50_ns", 20_000.0),
    ("tick.24_points_union_1000.p99_ns", 50_000.0),
    ("tick.tool_1000_points_S3.p50_ns", 60_000.0),
    ("tick.tool_1000_points_S3.p99_ns", 120_000.0),
];

/// Rows in the plane, and those in space that they take at most as long as.
const IN_THE_PLANE: &[(&str, &str)] = &[
    ("segment.hit.P1.ns", "triangle.hit.S1.ns"),
    ("segment.minimum_1pc.P1.ns", "triangle.minimum_1pc.S1.ns"),
    ("segment.hit.P2.ns", "triangle.hit.S2.ns"),
    ("segment.minimum_1pc.P2.ns", "triangle.minimum_1pc.S2.ns"),
    ("segment.hit.P3.ns", "triangle.hit.S3.ns"),
    ("segment.minimum_1pc.P3.ns", "triangle.minimum_1pc.S3.ns"),
    ("outline.hits_888.P3.p50_ns", "mesh.hits_888.S3.p50_ns"),
    ("outline.hits_100k.P3.p50_ns", "mesh.hits_100k.S3.p50_ns"),
    ("pair.sign.P3_P3.+50mm.p50_ns", "pair.sign.S3_S3.+50mm.p50_ns"),
    ("pair.sign.P3_P3.+5mm.p50_ns", "pair.sign.S3_S3.+5mm.p50_ns"),
    ("pair.sign.P3_P3.-5mm.p50_ns", "pair.sign.S3_S3.-5mm.p50_ns"),
    ("pair.separation.P3_P3.1pc.p50_ns", "pair.separation.S3_S3.1pc.p50_ns"),
    ("pair.separation.P3_P3.1mm.p50_ns", "pair.separation.S3_S3.1mm.p50_ns"),
    ("pair.separation.P3_P3.0.1mm.p50_ns", "pair.separation.S3_S3.0.1mm.p50_ns"),
    ("pair.warm_1mm.P3_P3.p50_ns", "pair.warm_1mm.S3_S3.p50_ns"),
    ("pair.sign.bar_ring.-1mm.p50_ns", "pair.sign.plate_torus.-1mm.p50_ns"),
    ("manifold.rectangles.p50_ns", "manifold.boxes.p50_ns"),
    ("manifold.tongue.p50_ns", "manifold.peg.p50_ns"),
    ("manifold.bar_ring.p50_ns", "manifold.bar_torus.p50_ns"),
    ("world.1000_planar_bodies.step_ns", "world.1000_bodies.step_ns"),
];

/// Whether a row is in nanoseconds.
fn is_time(key: &str) -> bool {
    key.ends_with(".ns") || key.ends_with("_ns")
}

/// Prints all rows and how they stand against their bars, or the rows as JSON. Of a part of
/// a suite the bars of other parts are left out.
///
/// A bar in nanoseconds that is missed is held against the machine too: `reached here` is
/// what is within the bar times how much longer than on the bars' machine the yardstick
/// takes.
pub(crate) fn print(rows: &Rows, bars: &[Bar], is_part: bool, as_json: bool) {
    if as_json {
        let object: serde_json::Map<String, serde_json::Value> =
            rows.iter().map(|(key, number)| (key.clone(), (*number).into())).collect();
        println!("{:#}", serde_json::Value::Object(object));
        return;
    }
    for (key, number) in rows {
        println!("{key:<60} {number:>12.4}");
    }
    let (yardstick, there) = YARDSTICK;
    let here = rows.get(yardstick).copied().unwrap_or(there);
    let slower = (here / there).max(1.0);
    println!("\n{yardstick} is {here:.0} here, {there:.0} where bars in nanoseconds are from.");
    println!("`reached here` allows {slower:.2} times as long.\n");
    let in_the_plane = IN_THE_PLANE.iter().filter(|(key, _)| rows.contains_key(*key));
    let in_the_plane = in_the_plane.map(|(key, other)| (*key, rows.get(*other).copied(), 1.0));
    let bars = bars.iter().filter(|(key, _)| !is_part || rows.contains_key(*key));
    let bars =
        bars.map(|(key, bar)| (*key, Some(*bar), if is_time(key) { slower } else { 1.0 }));
    let (mut reached, mut here, mut all) = (0, 0, 0);
    for (key, bar, allowed) in bars.chain(in_the_plane) {
        let number = rows.get(key).copied().unwrap_or(f64::NAN);
        let bar = bar.unwrap_or(f64::NAN);
        let verdict = if number <= bar {
            reached += 1;
            "reached"
        } else if number <= bar * allowed {
            here += 1;
            "reached here"
        } else {
            "missed"
        };
        println!(
            "{key:<60} {number:>12.4}  at most {bar:<12.6} {verdict:<12} {:.2}",
            number / bar
        );
        all += 1;
    }
    println!("{reached} of {all} bars reached, {} here", reached + here);
}
