// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The bars that rows are held against, and printing. Each is a ratio within one run: to a
//! peer, or to our own evaluation of S3.

use crate::fields::Rows;

/// A row's key and the most it may be.
pub(crate) type Bar = (&'static str, f64);

/// Those of fields.
pub(crate) const FIELDS: &[Bar] = &[
    ("S3.distance.point.ours_over_fidget_jit", 1.4),
    ("S3.distance_f64.1024.ours_over_fidget_jit", 1.6),
    ("S3.distance_gradient.point.ours_over_fidget_jit", 1.6),
    ("S3.distance_gradient_f64.1024.ours_over_fidget_jit", 0.25),
    ("S4.distance.point.ours_over_fidget_jit", 0.18),
    ("S4.distance_f64.1024.ours_over_fidget_jit", 1.4),
    ("S4.distance_f64.clustered.ours_over_fidget_jit", 0.16),
    ("S4.distance_gradient.point.ours_over_fidget_jit", 0.22),
    ("S4.distance_gradient_f64.1024.ours_over_fidget_jit", 0.19),
    ("S4.build.scene.over_S3", 6700.0),
    ("S3.model.64.over_S3", 11.0),
    ("S4.model.surface.over_S3_model", 5.0),
    ("thousand.model.surface.over_S3_model", 40.0),
    ("thousand.distance.point.over_S3", 82.0),
    ("thousand.distance.clustered.over_S3", 3.4),
    ("S2_twisted.distance.1024.over_child", 6.1),
    ("S3_twisted.distance.1024.over_child", 3.4),
    ("S2_displaced.distance.1024.over_child", 4.5),
    ("S3_displaced.distance.1024.over_child", 1.8),
];

/// Those of searches.
pub(crate) const COLLIDE: &[Bar] = &[
    ("triangle.hit.S1.over_S3", 21.0),
    ("triangle.hit.S2.over_S3", 42.0),
    ("triangle.hit.S3.over_S3", 130.0),
    ("triangle.minimum_1pc.S1.over_S3", 100.0),
    ("triangle.minimum_1pc.S2.over_S3", 300.0),
    ("triangle.minimum_1pc.S3.over_S3", 920.0),
    ("mesh.hits_888.S3.p50.over_S3", 2200.0),
    ("mesh.hits_100k.S3.p50.over_S3", 17_000.0),
    ("pair.sign.S3_S3.+50mm.p50.over_S3", 4500.0),
    ("pair.sign.S3_S3.+5mm.p50.over_S3", 6900.0),
    ("pair.sign.S3_S3.-5mm.p50.over_S3", 1200.0),
    ("pair.separation.S3_S3.1pc.p50.over_S3", 6500.0),
    ("pair.separation.S3_S3.1mm.p50.over_S3", 8400.0),
    ("pair.separation.S3_S3.0.1mm.p50.over_S3", 11_000.0),
    ("pair.sign.plate_torus.-1mm.p50.over_S3", 580.0),
    ("pair.warm_1mm.S3_S3.p50.over_S3", 1700.0),
    ("sweep.ball.S3.random.p50.over_S3", 130.0),
    ("sweep.ball.S3.grazing.p50.over_S3", 400.0),
    ("sweep.ball.S3.grazing.p95.over_S3", 3500.0),
    ("sweep.triangle.S3.0.05.p50.over_S3", 1700.0),
    ("sweep.triangle.S3.0.3.p50.over_S3", 4500.0),
    ("sweep.mesh_888.S3.p50.over_S3", 35_000.0),
    ("parry.sweep.ball_torus.ours_over_parry", 0.002),
    ("sweep.pair.S3_S3.p50.over_S3", 80_000.0),
    ("manifold.boxes.p50.over_S3", 22_000.0),
    ("manifold.peg.p50.over_S3", 86_000.0),
    ("manifold.bar_torus.p50.over_S3", 4500.0),
    ("parry.ball_torus.manifold.ours_over_parry", 0.0025),
    ("world.1000_bodies.step.over_S3", 2_800_000.0),
    ("sweep.mesh_floor.ball.over_cuboid", 5.0),
    ("sweep.mesh_cubes.1mm.over_cuboids", 10.0),
    ("track.rest.boxes.evaluations", 6.0),
    ("track.rest.stars.evaluations", 6.0),
    ("track.rest.cup_cube.evaluations", 6.0),
    ("track.rest.table_cube.evaluations", 6.0),
    ("track.first.boxes.over_separation_1pc", 10.0),
    ("track.first.stars.over_separation_1pc", 10.0),
    ("track.first.cup_cube.over_separation_1pc", 10.0),
    ("track.first.table_cube.over_separation_1pc", 10.0),
    ("parry.heap_of_cubes.ours_over_parry", 8.0),
    ("parry.heap_of_cups.ours_over_parry", 0.2),
    ("sampled.separation.trilinear_S3.over_formula", 5.9),
    ("sampled.separation.quadratic_S3.over_formula", 5.3),
    ("sampled.separation.mesh_S3.over_formula", 47.0),
];

/// Those of the servo.
pub(crate) const HAPTICS: &[Bar] = &[
    ("tick.sphere.p50.over_S3", 89.0),
    ("tick.sphere.p99.over_S3", 94.0),
    ("tick.S3.p50.over_S3", 150.0),
    ("tick.S3.p99.over_S3", 320.0),
    ("tick.union_1000.p50.over_S3", 160.0),
    ("tick.union_1000.p99.over_S3", 300.0),
    ("tick.ten_fingers_S3.p50.over_S3", 1400.0),
    ("tick.ten_fingers_S3.p99.over_S3", 2100.0),
    ("tick.24_points_union_1000.p50.over_S3", 2800.0),
    ("tick.24_points_union_1000.p99.over_S3", 6100.0),
    ("tick.tool_1000_points_S3.p50.over_S3", 4600.0),
    ("tick.tool_1000_points_S3.p99.over_S3", 26_000.0),
    ("tick.grid_S3.p50.over_tick_S3", 1.2),
    ("tick.moving_S3.p50.over_tick_S3", 1.5),
    ("tick.tool_moving.p50.over_tool_at_rest", 1.5),
];

/// Those of meshes and grids.
pub(crate) const SAMPLED: &[Bar] = &[
    ("mesh.near.ours_over_parry", 0.65),
    ("mesh.box.ours_over_parry", 0.6),
    ("mesh.touching.ours_over_parry", 0.7),
    ("mesh.path.ours_over_parry", 0.95),
    ("mesh.tree.ours_over_parry", 0.7),
    ("grid.quadratic.gradient.path.over_ball", 8.75),
    ("grid.quadratic.gradient.random.over_ball", 10.75),
    ("grid.trilinear.64.over_loop", 1.15),
    ("grid.bake.band.over_samples", 26.0),
    ("mesh.near.all.ours_over_open3d", 0.4),
    ("mesh.near.all.ours_over_libigl", 0.35),
    ("mesh.near.winding.ours_over_libigl_winding", 0.5),
    ("mesh.all_nodes.ours_over_libigl", 0.28),
    ("mesh.band.ours_over_meshlib", 16.5),
];

/// Those of the live page, which only reports.
pub(crate) const LIVE: &[Bar] = &[];

/// Those beside MuJoCo: no overlap of ours is missed.
pub(crate) const MUJOCO: &[Bar] = &[
    ("torus_torus.0.1mm.missed.ours", 0.0),
    ("torus_torus.1mm.missed.ours", 0.0),
    ("torus_torus.5mm.missed.ours", 0.0),
    ("torus_bowl.0.1mm.missed.ours", 0.0),
    ("torus_bowl.1mm.missed.ours", 0.0),
    ("torus_bowl.5mm.missed.ours", 0.0),
    ("torus_gear.0.1mm.missed.ours", 0.0),
    ("torus_gear.1mm.missed.ours", 0.0),
    ("torus_gear.5mm.missed.ours", 0.0),
    ("gear_gear.0.1mm.missed.ours", 0.0),
    ("gear_gear.1mm.missed.ours", 0.0),
    ("gear_gear.5mm.missed.ours", 0.0),
    ("large_torus_torus.0.1mm.missed.ours", 0.0),
    ("large_torus_torus.1mm.missed.ours", 0.0),
    ("large_torus_torus.5mm.missed.ours", 0.0),
    ("large_torus_bolt.0.1mm.missed.ours", 0.0),
    ("large_torus_bolt.1mm.missed.ours", 0.0),
    ("large_torus_bolt.5mm.missed.ours", 0.0),
    ("bolt_nut.0.1mm.missed.ours", 0.0),
    ("bolt_nut.1mm.missed.ours", 0.0),
    ("bolt_nut.5mm.missed.ours", 0.0),
];

/// Rows in the plane, and those in space that they take at most as long as in the same run.
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

/// Prints all rows and how they stand against their bars, or the rows as JSON. Of a part of
/// a suite the bars of other parts are left out.
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
    println!();
    print_standing(rows, bars, is_part);
}

/// Prints how rows stand against their bars.
pub(crate) fn print_standing(rows: &Rows, bars: &[Bar], is_part: bool) {
    let bars = bars.iter().filter(|(key, _)| !is_part || rows.contains_key(*key));
    let of_rows = bars.map(|(key, bar)| (*key, rows.get(*key).copied(), *bar));
    let in_the_plane = IN_THE_PLANE.iter().filter(|(key, _)| rows.contains_key(*key));
    let in_the_plane = in_the_plane.map(|(key, other)| {
        let ratio = rows.get(*key).zip(rows.get(*other)).map(|(time, other)| time / other);
        (*key, ratio, 1.0)
    });
    let (mut reached, mut all) = (0, 0);
    for (key, number, bar) in of_rows.chain(in_the_plane) {
        let number = number.unwrap_or(f64::NAN);
        let verdict = if number <= bar { "reached" } else { "missed" };
        reached += u32::from(number <= bar);
        all += 1;
        println!("{key:<60} {number:>12.4}  at most {bar:<10} {verdict}");
    }
    println!("{reached} of {all} bars reached");
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bar in nanoseconds would say something about a machine.
    #[test]
    fn every_bar_is_a_ratio() {
        let ratios = [
            ".over_S3",
            "_over_fidget_jit",
            "_over_parry",
            ".over_child",
            ".over_S3_model",
            ".over_formula",
            ".over_ball",
            ".over_loop",
            ".over_samples",
            ".over_tick_S3",
            ".over_tool_at_rest",
            "_over_open3d",
            "_over_libigl",
            "_over_libigl_winding",
            "_over_meshlib",
            ".over_cuboid",
            ".over_cuboids",
            ".over_separation_1pc",
            // A count is the same on every machine.
            ".evaluations",
        ];
        for (key, _) in [FIELDS, COLLIDE, HAPTICS, SAMPLED].concat() {
            assert!(ratios.iter().any(|ratio| key.ends_with(ratio)), "{key}");
        }
    }

    #[test]
    fn beside_mujoco_nothing_may_be_missed() {
        for (key, bar) in MUJOCO {
            assert!(key.ends_with(".missed.ours") && *bar == 0.0, "{key}");
        }
    }

    #[test]
    fn the_document_has_every_bar() {
        let document = include_str!("../README.md");
        // Rows of sampled data share a cell of the document's table.
        let bars = FIELDS.iter().chain(COLLIDE).chain(HAPTICS);
        for (key, most) in bars.filter(|(key, _)| !key.starts_with("sampled.")) {
            let row = document.lines().find(|line| line.starts_with(&format!("| `{key}` |")));
            let row = row.unwrap_or_else(|| panic!("no row for {key}"));
            let cells = row.split('|').map(|cell| cell.replace([' ', '\u{a0}'], ""));
            let is_bar = |cell: String| cell.parse() == Ok(*most);
            assert!(cells.into_iter().any(is_bar), "{key} is at most {most}: {row}");
        }
    }
}
