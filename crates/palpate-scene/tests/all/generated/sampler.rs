// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Every primitive, and every operator, on a grid.

/// A name, and its shape as JSON: for primitives, what is under the name.
pub(crate) type Sample = (&'static str, &'static str);

/// From one body to the next [m].
const SPACING: f64 = 0.15;

/// Bodies in a row.
const COLUMNS: usize = 7;

/// The primitives of the plane, each about 0.1 m wide.
pub(crate) const PLANE: &[Sample] = &[
    ("ball", r#"{ "radius": 0.05 }"#),
    ("cuboid", r#"{ "size": [0.1, 0.07] }"#),
    ("rounded_cuboid", r#"{ "size": [0.1, 0.07], "rounding": 0.015 }"#),
    ("capsule", r#"{ "radius": 0.025, "height": 0.1 }"#),
    ("segment", r#"{ "from": [-0.04, -0.03], "to": [0.04, 0.03], "radius": 0.01 }"#),
    ("half_space", r#"{ "normal": [1, 2], "offset": 0.01 }"#),
    ("triangle", r#"{ "points": [[-0.05, -0.04], [0.05, -0.02], [0.01, 0.05]] }"#),
    ("ellipse", r#"{ "radii": [0.05, 0.03] }"#),
    ("ring", r#"{ "inner_radius": 0.03, "outer_radius": 0.05 }"#),
    ("arc", r#"{ "ring_radius": 0.04, "angle_degrees": 240, "radius": 0.01 }"#),
    ("regular_polygon", r#"{ "sides": 6, "radius": 0.05 }"#),
    ("regular_star", r#"{ "branches": 5, "outer_radius": 0.05, "inner_radius": 0.02 }"#),
    (
        "polygon",
        r#"{ "rings": [
             [[-0.05, -0.05], [0.05, -0.05], [0.05, 0.01], [0, 0.05], [-0.05, 0.01]],
             [[-0.015, -0.03], [0.015, -0.03], [0.015, 0], [-0.015, 0]]] }"#,
    ),
    ("cool_s", r#"{ "height": 0.1 }"#),
    (
        "rounded_rectangle",
        r#"{ "size": [0.1, 0.08], "top_left_radius": 0, "top_right_radius": 0.01,
             "bottom_right_radius": 0.02, "bottom_left_radius": 0.04 }"#,
    ),
    ("chamfered_rectangle", r#"{ "size": [0.1, 0.07], "chamfer": 0.02 }"#),
    ("oriented_rectangle", r#"{ "from": [-0.03, -0.03], "to": [0.03, 0.03], "width": 0.03 }"#),
    ("rhombus", r#"{ "size": [0.1, 0.06] }"#),
    ("isosceles_trapezoid", r#"{ "bottom_width": 0.1, "top_width": 0.05, "height": 0.07 }"#),
    ("parallelogram", r#"{ "width": 0.07, "height": 0.06, "skew": 0.03 }"#),
    ("isosceles_triangle", r#"{ "base": 0.08, "height": 0.1 }"#),
    ("stairs", r#"{ "step_width": 0.025, "step_height": 0.02, "steps": 4 }"#),
    ("cross", r#"{ "length": 0.1, "width": 0.03 }"#),
    ("rounded_x", r#"{ "size": 0.1, "radius": 0.01 }"#),
    ("tunnel", r#"{ "width": 0.07, "height": 0.1 }"#),
    ("uneven_capsule", r#"{ "bottom_radius": 0.03, "top_radius": 0.015, "height": 0.05 }"#),
    ("pie", r#"{ "radius": 0.05, "angle_degrees": 100 }"#),
    ("cut_disk", r#"{ "radius": 0.05, "cut_height": -0.02 }"#),
    ("ring_sector", r#"{ "inner_radius": 0.03, "outer_radius": 0.05, "angle_degrees": 250 }"#),
    (
        "horseshoe",
        r#"{ "ring_radius": 0.035, "angle_degrees": 200, "length": 0.03, "width": 0.015 }"#,
    ),
    ("vesica", r#"{ "width": 0.05, "height": 0.1 }"#),
    ("oriented_vesica", r#"{ "from": [-0.035, -0.035], "to": [0.035, 0.035], "width": 0.04 }"#),
    ("moon", r#"{ "radius": 0.05, "cut_radius": 0.04, "distance": 0.025 }"#),
    ("egg", r#"{ "bottom_radius": 0.04, "top_radius": 0.015 }"#),
    ("heart", r#"{ "height": 0.1 }"#),
    ("rounded_cross", r#"{ "size": [0.1, 0.1], "arc_radius": 0.06 }"#),
    ("bobbly_cross", r#"{ "width": 0.09, "dip": 0.012, "rounding": 0.005 }"#),
    ("parabola", r#"{ "focal_length": 0.01 }"#),
    ("parabola_segment", r#"{ "width": 0.08, "height": 0.1 }"#),
    (
        "quadratic_bezier",
        r#"{ "from": [-0.04, -0.04], "control": [0, 0.08], "to": [0.04, -0.02], "radius": 0.008 }"#,
    ),
    ("quadratic_circle", r#"{ "radius": 0.05 }"#),
    ("hyperbola", r#"{ "radii": [0.02, 0.01] }"#),
    ("circle_wave", r#"{ "ring_radius": 0.015, "angle_degrees": 200, "radius": 0.003 }"#),
    ("power_ball", r#"{ "radius": 0.045, "exponent": 4 }"#),
    ("power_cuboid", r#"{ "size": [0.1, 0.07], "rounding": 0.03, "exponent": 8 }"#),
];

/// The primitives of space, each about 0.1 m wide.
pub(crate) const SPACE: &[Sample] = &[
    ("ball", r#"{ "radius": 0.05 }"#),
    ("cuboid", r#"{ "size": [0.1, 0.07, 0.05] }"#),
    ("rounded_cuboid", r#"{ "size": [0.1, 0.07, 0.05], "rounding": 0.015 }"#),
    ("capsule", r#"{ "radius": 0.025, "height": 0.1 }"#),
    (
        "segment",
        r#"{ "from": [-0.04, -0.03, -0.02], "to": [0.04, 0.03, 0.02], "radius": 0.01 }"#,
    ),
    ("half_space", r#"{ "normal": [1, 2, 0.5], "offset": 0.01 }"#),
    (
        "tetrahedron",
        r#"{ "points": [[-0.05, -0.04, -0.03], [0.05, -0.04, -0.03],
             [0, -0.04, 0.05], [0, 0.05, 0]] }"#,
    ),
    ("ellipsoid", r#"{ "radii": [0.05, 0.03, 0.04] }"#),
    ("cylinder", r#"{ "radius": 0.035, "height": 0.1 }"#),
    ("rounded_cylinder", r#"{ "radius": 0.035, "height": 0.1, "rounding": 0.01 }"#),
    ("infinite_cylinder", r#"{ "radius": 0.03 }"#),
    ("capped_cone", r#"{ "bottom_radius": 0.05, "top_radius": 0.02, "height": 0.08 }"#),
    ("cone", r#"{ "radius": 0.04, "height": 0.1 }"#),
    ("pyramid", r#"{ "side": 0.08, "height": 0.1 }"#),
    ("torus", r#"{ "ring_radius": 0.035, "radius": 0.015 }"#),
    ("hexagonal_prism", r#"{ "radius": 0.05, "height": 0.06 }"#),
    ("triangular_prism", r#"{ "side": 0.08, "height": 0.06 }"#),
    ("octahedron", r#"{ "radius": 0.05 }"#),
    ("cuboid_frame", r#"{ "size": [0.1, 0.08, 0.06], "thickness": 0.01 }"#),
    ("capped_torus", r#"{ "ring_radius": 0.04, "radius": 0.01, "angle_degrees": 240 }"#),
    ("link", r#"{ "ring_radius": 0.03, "radius": 0.01, "length": 0.03 }"#),
    ("infinite_cone", r#"{ "angle_degrees": 60 }"#),
    (
        "cylinder_between",
        r#"{ "from": [-0.03, -0.03, -0.01], "to": [0.03, 0.03, 0.01], "radius": 0.02 }"#,
    ),
    (
        "capped_cone_between",
        r#"{ "from": [-0.03, -0.03, -0.01], "to": [0.03, 0.03, 0.01],
             "from_radius": 0.025, "to_radius": 0.01 }"#,
    ),
    ("solid_angle", r#"{ "radius": 0.06, "angle_degrees": 70 }"#),
    ("cut_ball", r#"{ "radius": 0.05, "cut_height": -0.02 }"#),
    ("cut_hollow_sphere", r#"{ "radius": 0.045, "cut_height": 0.02, "thickness": 0.01 }"#),
    ("death_star", r#"{ "radius": 0.05, "cut_radius": 0.035, "distance": 0.055 }"#),
    ("round_cone", r#"{ "bottom_radius": 0.03, "top_radius": 0.015, "height": 0.05 }"#),
    (
        "round_cone_between",
        r#"{ "from": [-0.02, -0.02, -0.01], "to": [0.03, 0.03, 0.01],
             "from_radius": 0.025, "to_radius": 0.015 }"#,
    ),
    (
        "vesica_segment",
        r#"{ "from": [-0.035, -0.035, -0.01], "to": [0.035, 0.035, 0.01], "width": 0.04 }"#,
    ),
    ("rhombus_prism", r#"{ "size": [0.1, 0.06, 0.07], "rounding": 0.005 }"#),
    (
        "triangle_sheet",
        r#"{ "points": [[-0.04, -0.03, -0.03], [0.04, -0.03, 0], [0, 0.04, 0.03]],
             "radius": 0.006 }"#,
    ),
    (
        "quad_sheet",
        r#"{ "points": [[-0.04, -0.03, -0.03], [0.04, -0.03, -0.03],
             [0.03, 0.03, 0.03], [-0.03, 0.03, 0.03]], "radius": 0.006 }"#,
    ),
    ("cube_approximation", r#"{ "side": 0.08 }"#),
    ("cylinder_approximation", r#"{ "radius": 0.035, "height": 0.1 }"#),
    ("cone_approximation", r#"{ "radius": 0.04, "height": 0.1 }"#),
    ("pyramid_approximation", r#"{ "side": 0.08, "height": 0.1 }"#),
    ("power_ball", r#"{ "radius": 0.04, "exponent": 6 }"#),
    ("power_cuboid", r#"{ "size": [0.1, 0.07, 0.05], "rounding": 0.025, "exponent": 4 }"#),
    (
        "power_torus",
        r#"{ "ring_radius": 0.035, "radius": 0.015, "ring_exponent": 2, "tube_exponent": 8 }"#,
    ),
    (
        "screw_thread",
        r#"{ "radius": 0.035, "height": 0.09, "pitch": -0.02, "starts": 2,
             "profile": [0.004, 0.006, 0.007] }"#,
    ),
];

/// Those that have no end.
const UNBOUNDED: [&str; 6] = [
    "half_space",
    "infinite_cylinder",
    "infinite_cone",
    "parabola",
    "hyperbola",
    "circle_wave",
];

/// The operators on shapes of space; `bar`, `bead` and `flat` are shapes.
pub(crate) const OPERATORS: &[Sample] = &[
    ("union", r#"{ "union": ["bar", "bead"] }"#),
    ("intersection", r#"{ "intersection": ["bar", "bead"] }"#),
    ("difference", r#"{ "difference": ["bar", "bead"] }"#),
    ("symmetric_difference", r#"{ "symmetric_difference": ["bar", "bead"] }"#),
    ("smooth_union", r#"{ "smooth_union": ["bar", "bead"], "width": 0.006 }"#),
    (
        "smooth_intersection",
        r#"{ "smooth_intersection": ["bar", "bead"], "width": 0.004, "profile": "circular" }"#,
    ),
    (
        "smooth_difference",
        r#"{ "smooth_difference": ["bar", "bead"], "width": 0.004, "profile": "cubic" }"#,
    ),
    (
        "displace",
        r#"{ "displace": ["bead", { "repeat": { "x": { "spacing": 0.02 },
             "y": { "spacing": 0.02 }, "z": { "spacing": 0.02 } },
             "of": { "ball": { "radius": 0.008 } } }], "height": 0.004 }"#,
    ),
    ("morph", r#"{ "morph": ["bar", "bead"], "progress": 0.5 }"#),
    ("translate", r#"{ "translate": [0.01, 0.02, 0], "of": "bar" }"#),
    (
        "rotate_degrees",
        r#"{ "rotate_degrees": { "axis": [0, 0, 1], "angle": 30 }, "of": "bar" }"#,
    ),
    ("rotation", r#"{ "rotation": [0, 0, 1, 1], "of": "bar" }"#),
    ("scale", r#"{ "scale": [1, 2, 1], "of": "bar" }"#),
    ("offset", r#"{ "offset": 0.01, "of": "bar" }"#),
    ("shell", r#"{ "shell": 0.006, "of": "bar" }"#),
    ("elongate", r#"{ "elongate": [0.03, 0, 0.02], "of": "bead" }"#),
    (
        "mirror",
        r#"{ "mirror": "x", "of": { "translate": [0.025, 0, 0],
             "rotate_degrees": { "axis": [0, 0, 1], "angle": 40 },
             "of": { "cuboid": { "size": [0.06, 0.02, 0.02] } } } }"#,
    ),
    (
        "repeat",
        r#"{ "repeat": { "x": { "spacing": 0.03, "first": -1, "last": 1 },
             "y": { "spacing": 0.03, "first": -1, "last": 1 } },
             "of": { "ball": { "radius": 0.01 } } }"#,
    ),
    (
        "bend_degrees",
        r#"{ "bend_degrees": 600, "of": { "cuboid": { "size": [0.1, 0.02, 0.02] } } }"#,
    ),
    (
        "twist_degrees",
        r#"{ "twist_degrees": 1800, "of": { "cuboid": { "size": [0.04, 0.1, 0.015] } } }"#,
    ),
    ("extrude", r#"{ "extrude": 0.03, "of": "flat" }"#),
    ("revolve", r#"{ "revolve": "y", "of": { "translate": [0.03, 0], "of": "flat" } }"#),
];

/// Every primitive of the plane.
pub(crate) fn plane() -> String {
    primitives(2, PLANE)
}

/// Every primitive of space.
pub(crate) fn space() -> String {
    primitives(3, SPACE)
}

fn primitives(dimension: usize, samples: &[Sample]) -> String {
    let size = if dimension == 2 { "[0.1, 0.1]" } else { "[0.1, 0.1, 0.1]" };
    let shape = |&(name, arguments): &Sample| {
        let alone = format!(r#"{{ "{name}": {arguments} }}"#);
        let whole =
            format!(r#"{{ "intersection": [{alone}, {{ "cuboid": {{ "size": {size} }} }}] }}"#);
        (name, if UNBOUNDED.contains(&name) { whole } else { alone })
    };
    let space = if dimension == 2 { "the plane" } else { "space" };
    format!(
        r#"{{ "palpate": 1, "dimension": {dimension},
        "description": "Every primitive of {space}; those without end are cut off by a box.",
        "bodies": [{}] }}"#,
        bodies(dimension, &samples.iter().map(shape).collect::<Vec<_>>())
    )
}

/// Every operator.
pub(crate) fn operators() -> String {
    let samples: Vec<_> = OPERATORS.iter().map(|&(name, of)| (name, of.to_owned())).collect();
    format!(
        r#"{{ "palpate": 1, "dimension": 3,
        "description": "Every operator, most of them on a bar and a bead.",
        "shapes": {{
          "bar": {{ "cuboid": {{ "size": [0.08, 0.03, 0.03] }} }},
          "bead": {{ "translate": [0.01, 0.01, 0], "of": {{ "ball": {{ "radius": 0.03 }} }} }},
          "flat": {{ "regular_star": {{
            "branches": 5, "outer_radius": 0.02, "inner_radius": 0.01 }} }} }},
        "bodies": [{}] }}"#,
        bodies(3, &samples)
    )
}

/// Bodies in rows, the first row on top, in the middle of the plane of x and y.
fn bodies(dimension: usize, samples: &[(&str, String)]) -> String {
    let rows = samples.len().div_ceil(COLUMNS);
    let body = |(i, (name, shape)): (usize, &(&str, String))| {
        let x = (i % COLUMNS) as f64 - (COLUMNS - 1) as f64 / 2.0;
        let y = (rows - 1) as f64 / 2.0 - (i / COLUMNS) as f64;
        let depth = if dimension == 2 { "" } else { ", 0" };
        format!(
            r#"{{ "name": "{name}", "shape": {shape},
            "pose": {{ "translation": [{}, {}{depth}] }} }}"#,
            super::short(x * SPACING),
            super::short(y * SPACING)
        )
    };
    samples.iter().enumerate().map(body).collect::<Vec<_>>().join(",")
}
