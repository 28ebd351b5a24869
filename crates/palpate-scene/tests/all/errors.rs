// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Every error names its path, its line and what is wrong, and the schema
//! agrees where it can.

use crate::refusal::Schema::{Accepts, Refuses};
use crate::refusal::check_all;
use palpate_scene::{Dimension, Scene, WrittenBody, WrittenShape};

#[test]
fn a_negative_radius_is_found_in_its_line() {
    let text = r#"{
  "palpate": 1,
  "dimension": 3,
  "shapes": {
    "cup": {
      "difference": [
        {
          "rounded_cylinder": {
            "radius": 0.04, "height": 0.09, "rounding": 0.004
          }
        },
        {
          "cylinder": {
            "radius": -0.02,
            "height": 0.09
          }
        }
      ]
    }
  },
  "bodies": [{ "name": "cup", "shape": "cup" }]
}"#;
    let error = Scene::from_json(text).unwrap_err();
    assert_eq!(
        error.to_string(),
        "shapes.cup.difference[1].cylinder.radius, line 14: radius must be positive, got -0.02 m"
    );
    assert_eq!((error.first().line, error.first().column), (14, 13));
}

#[test]
fn without_a_file_there_is_a_path_and_no_line() {
    let mut scene = Scene::new(Dimension::Two);
    scene.bodies.push(WrittenBody::new("a", WrittenShape::reference("b")));
    let error = scene.build().unwrap_err();
    assert_eq!(error.to_string(), "bodies[0].shape: unknown shape `b`; there are none here");
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let error = Scene::from_file("no/such/scene.json").unwrap_err();
    assert!(error.to_string().starts_with("cannot read no/such/scene.json: "), "{error}");
}

#[test]
fn bad_files_are_refused_with_their_place() {
    let bodies = r#""bodies": [{ "name": "a", "shape": { "ball": { "radius": 1 } } }]"#;
    check_all(
        &[
            ("", "line 1: not JSON: the file is empty", Refuses),
            (
                "{",
                "line 1, column 2: not JSON: the file ends here, but `}` is missing for the `{` of \
                 line 1\n  {\n   ^",
                Refuses,
            ),
            ("[]", "line 1: the file must be an object, got a list", Refuses),
            (
                "{}",
                "3 problems, and maybe more:\n  \
                 line 1: missing key `palpate`: the version of the format, 1\n  \
                 line 1: missing key `dimension`: 2 for the plane, 3 for space\n  \
                 line 1: missing key `bodies`: what is there to be touched",
                Refuses,
            ),
            (
                "{\n\"palpate\": 2, \"dimension\": 3, BODIES}",
                "palpate, line 2: palpate must be 1, the one version of the format so far, got 2",
                Refuses,
            ),
            (
                "{\"palpate\": 1, \"palpate\": 1, \"dimension\": 3, BODIES}",
                "palpate, line 1: duplicate key `palpate`",
                Accepts,
            ),
            (
                "{\"palpate\": 1, \"dimension\": 4, BODIES}",
                "dimension, line 1: dimension must be 2 or 3, got 4",
                Refuses,
            ),
            (
                "{\"palpate\": 1, \"dimension\": \"3\", BODIES}",
                "dimension, line 1: dimension must be 2 or 3, got \"3\"",
                Refuses,
            ),
            (
                "{\"palpate\": 1, \"dimension\": 3}",
                "line 1: missing key `bodies`: what is there to be touched",
                Refuses,
            ),
            (
                "{\"palpate\": 1, \"dimension\": 3, \"bodies\": []}",
                "bodies, line 1: bodies must have at least 1 body, got 0",
                Refuses,
            ),
            (
                "{\"palpate\": 1, \"dimension\": 3, \"bodys\": [], BODIES}",
                "bodys, line 1: unknown key `bodys`, did you mean `bodies`?",
                Refuses,
            ),
            (
                "{\"palpate\": 1, \"dimension\": 3, \"description\": null, BODIES}",
                "description, line 1: description must be a string, got null",
                Refuses,
            ),
        ],
        |text| text.replace("BODIES", bodies),
    );
}

#[test]
fn bad_shapes_are_refused_with_their_place() {
    check_all(
        &[
            // Primitives.
            (
                r#"{ "ball": { "raduis": 1 } }"#,
                "shapes.a.ball.raduis, line 4: unknown key `raduis`, did you mean `radius`?",
                Refuses,
            ),
            (
                r#"{ "ball": { "radius": "big" } }"#,
                "shapes.a.ball.radius, line 4: radius must be a number, got \"big\"",
                Refuses,
            ),
            (
                r#"{ "ball": { "radius": 1e400 } }"#,
                "shapes.a.ball.radius, line 4: radius must be within the range of numbers, got 1e400",
                Refuses,
            ),
            (
                r#"{ "ball": { "radius": 1e16 } }"#,
                "shapes.a.ball.radius, line 4: radius must be finite and at most 1e15 in size, got 1e16 m",
                Accepts,
            ),
            (
                r#"{ "ball": { "radius": NaN } }"#,
                "line 4, column 28: not JSON: `NaN` is no number that JSON, or a scene, can have\n  \
                 \"a\": { \"ball\": { \"radius\": NaN } }\n                             ^",
                Refuses,
            ),
            (
                r#"{ "ball": {} }"#,
                "shapes.a.ball, line 4: missing key `radius`: the radius",
                Refuses,
            ),
            (
                r#"{ "ball": 3 }"#,
                "shapes.a.ball, line 4: ball must be an object with its parameters, such as { \"radius\": 0.7 }, got 3",
                Refuses,
            ),
            (
                r#"{ "ball": { "radius": 1 }, "ball": { "radius": 1 } }"#,
                "shapes.a.ball, line 4: duplicate key `ball`",
                Accepts,
            ),
            (
                r#"{ "ball": { "radius": 1 }, "cuboid": { "size": [1, 1, 1] } }"#,
                "shapes.a, line 4: `ball` and `cuboid` in one object; an object makes one shape: nest them",
                Refuses,
            ),
            (
                r#"{ "bal": { "radius": 1 } }"#,
                "shapes.a.bal, line 4: unknown key `bal`, did you mean `ball`?",
                Refuses,
            ),
            (
                r#"{ "cuboid": { "size": [1, 2] } }"#,
                "bodies[0].shape, line 6: shape `a` cannot be used in 3D: must have 3 numbers in 3D, got 2",
                Accepts,
            ),
            (
                r#"{ "cuboid": { "size": [1, 2, 3, 4] } }"#,
                "shapes.a.cuboid.size, line 4: size must have 3 numbers in 3D, got 4",
                Refuses,
            ),
            (
                r#"{ "cuboid": { "size": [1, -2, 3] } }"#,
                "shapes.a.cuboid.size, line 4: size must be positive, got -2 m",
                Accepts,
            ),
            (
                r#"{ "tetrahedron": { "points": [[0, 0, 0], [1, 0, 0], [0, 1]] } }"#,
                "shapes.a.tetrahedron.points[2], line 4: points[2] must have 3 numbers in 3D, got 2",
                Refuses,
            ),
            (
                r#"{ "regular_star": { "branches": 2.5, "outer_radius": 2, "inner_radius": 1 } }"#,
                "2 problems:\n  \
                 shapes.a.regular_star.branches, line 4: branches must be a whole number, zero or more, got 2.5\n  \
                 bodies[0].shape, line 6: shape `a` cannot be used in 3D: `regular_star` is a 2D shape, this place is 3D",
                Refuses,
            ),
            (
                r#"{ "regular_star": { "branches": 5, "outer_radius": 2, "inner_radius": 1 } }"#,
                "bodies[0].shape, line 6: shape `a` cannot be used in 3D: `regular_star` is a 2D shape, this place is 3D",
                Accepts,
            ),
            (
                r#"{ "regular_star": { "branches": 5, "outer_radius": -2, "inner_radius": 1 } }"#,
                "2 problems:\n  \
                 shapes.a.regular_star.outer_radius, line 4: outer_radius must be positive, got -2 m\n  \
                 bodies[0].shape, line 6: shape `a` cannot be used in 3D: `regular_star` is a 2D shape, this place is 3D",
                Refuses,
            ),
            // Operators.
            (
                r#"{ "union": [] }"#,
                "shapes.a.union, line 4: union must have at least 1 shape, got 0",
                Refuses,
            ),
            (
                r#"{ "union": { "ball": { "radius": 1 } } }"#,
                "shapes.a.union, line 4: union must be a list, got an object",
                Refuses,
            ),
            (
                r#"{ "union": [{ "ball": { "radius": 1 } }, 7] }"#,
                "shapes.a.union[1], line 4: union[1] must be a shape: an object, or the name of another shape, got 7",
                Refuses,
            ),
            (
                r#"{ "smooth_union": [{ "ball": { "radius": 1 } }] }"#,
                "shapes.a, line 4: missing key `width`: how far the surface moves where two distances are equal [m]",
                Refuses,
            ),
            (
                r#"{ "smooth_union": [{ "ball": { "radius": 1 } }], "width": -1 }"#,
                "shapes.a.width, line 4: width must be positive, got -1 m",
                Refuses,
            ),
            (
                r#"{ "smooth_union": [{ "ball": { "radius": 1 } }], "width": 1, "profile": "cubik" }"#,
                "shapes.a.profile, line 4: unknown value `cubik`, did you mean `cubic`?",
                Refuses,
            ),
            (
                r#"{ "smooth_difference": ["cup"], "width": 1, "height": 1 }"#,
                "shapes.a, line 4: key `height` does not go with `smooth_difference`",
                Refuses,
            ),
            (
                r#"{ "displace": ["cup", "cup"], "height": 0 }"#,
                "shapes.a.height, line 4: height must be positive, got 0 m",
                Refuses,
            ),
            (
                r#"{ "displace": ["cup"], "height": 1 }"#,
                "shapes.a.displace, line 4: displace must have 2 shapes, got 1",
                Refuses,
            ),
            (
                r#"{ "morph": ["cup", "cup"], "progress": 2 }"#,
                "shapes.a.progress, line 4: morph must be from 0 to 1, got 2",
                Refuses,
            ),
            (
                r#"{ "repeat": { "x": { "spacing": 0.5 } }, "of": "cup" }"#,
                "shapes.a.repeat, line 4: spacing must be at least half the width of the shape, 2 m, got 0.5 m",
                Accepts,
            ),
            (
                r#"{ "repeat": { "x": { "spacing": 9, "first": 1 } }, "of": "cup" }"#,
                "shapes.a.repeat.x, line 4: first and last go together",
                Refuses,
            ),
            (
                r#"{ "repeat": { "x": { "spacing": 9, "first": 2, "last": 1 } }, "of": "cup" }"#,
                "shapes.a.repeat, line 4: first must be at most the last, 1, got 2",
                Accepts,
            ),
            (
                r#"{ "repeat": { "x": { "first": 1, "last": 2 } }, "of": "cup" }"#,
                "shapes.a.repeat.x, line 4: missing key `spacing`",
                Refuses,
            ),
            (
                r#"{ "repeat": {}, "of": "cup" }"#,
                "shapes.a.repeat, line 4: repeat must have a row along at least one axis",
                Refuses,
            ),
            (
                r#"{ "twist_degrees": 1e9, "of": "cup" }"#,
                "shapes.a.twist_degrees, line 4: twist must be such that the shape turns by at most 10000 rad, got 17453292.519943297",
                Accepts,
            ),
            (
                r#"{ "bend_degrees": 9, "of": { "half_space": { "normal": [0, 1, 0], "offset": 0 } } }"#,
                "shapes.a, line 4: bend needs a shape with bounds",
                Accepts,
            ),
            (
                r#"{ "union": [{ "ball": { "radius": 1 } }], "width": 1 }"#,
                "shapes.a, line 4: key `width` does not go with `union`",
                Refuses,
            ),
            (
                r#"{ "translate": [1, 0, 0] }"#,
                "shapes.a, line 4: missing key `of`: the shape that `translate` is applied to",
                Refuses,
            ),
            (
                r#"{ "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a, line 4: missing the primitive or operator that makes the shape",
                Refuses,
            ),
            (
                r#"{ "ball": { "radius": 1 }, "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a, line 4: key `of` does not go with `ball`",
                Refuses,
            ),
            (
                r#"{ "translate": [1, 0, "x"], "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.translate[2], line 4: translate[2] must be a number, got \"x\"",
                Refuses,
            ),
            (
                r#"{ "translate": [1, 0, 1e20], "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.translate[2], line 4: translate[2] must be finite and at most 1e15 in size, got 1e20 m",
                Accepts,
            ),
            (
                r#"{ "rotate_degrees": 30, "of": { "cone": { "radius": 1, "height": 1 } } }"#,
                "shapes.a.rotate_degrees, line 4: rotate_degrees must be an object with `axis` and `angle` in 3D, got a number",
                Refuses,
            ),
            (
                r#"{ "rotate_degrees": { "axis": [0, 0, 0], "angle": 1 }, "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.rotate_degrees.axis, line 4: axis must be a direction, got 0",
                Accepts,
            ),
            (
                r#"{ "rotate_degrees": { "axis": [0, 1, 0], "angle": 1e10 }, "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.rotate_degrees.angle, line 4: angle must be at most 1e9 degrees either way, got 10000000000°",
                Accepts,
            ),
            (
                r#"{ "capped_torus": { "ring_radius": 1, "angle": 1, "angle_degrees": 57, "radius": 0.1 } }"#,
                "shapes.a.capped_torus, line 4: `angle_degrees` and `angle` say the same; give one of them",
                Refuses,
            ),
            (
                r#"{ "capped_torus": { "ring_radius": 1, "angle": -1, "radius": 0.1 } }"#,
                "shapes.a.capped_torus.angle, line 4: angle must be in (0, 2π], a full turn at most, got -1 rad (-57.29577951308232°)",
                Accepts,
            ),
            (
                r#"{ "twist": 1e9, "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.twist, line 4: twist must be such that the shape turns by at most 10000 rad, got 1000000000",
                Accepts,
            ),
            (
                r#"{ "bend": 1, "bend_degrees": 1, "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a, line 4: `bend` and `bend_degrees` in one object; an object makes one shape: nest them",
                Refuses,
            ),
            (
                r#"{ "rotate_degrees": { "axis": [0, 1, 0], "angel": 1 }, "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.rotate_degrees.angel, line 4: unknown key `angel`, did you mean `angle`?",
                Refuses,
            ),
            (
                r#"{ "rotation": [0, 0, 1], "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.rotation, line 4: rotation must be a list of 4 numbers, got 3",
                Refuses,
            ),
            (
                r#"{ "rotation": [0, 0, 0, 1, 0], "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.rotation, line 4: rotation must be a list of 4, got 5",
                Refuses,
            ),
            (
                r#"{ "rotation": [0, 0, 0, 0], "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.rotation, line 4: rotation must be a quaternion, got 0",
                Accepts,
            ),
            (
                r#"{ "rotation": [[1, 0], [0, 1]], "of": { "ball": { "radius": 1 } } }"#,
                "bodies[0].shape, line 6: shape `a` cannot be used in 3D: rotation must have 3 rows of 3 numbers in 3D",
                Accepts,
            ),
            (
                r#"{ "rotation": [[1, 0, 0], [0, 1, 0], 3], "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.rotation[2], line 4: rotation[2] must be a list, got 3",
                Refuses,
            ),
            (
                r#"{ "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 2]], "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.rotation, line 4: rotation must be an orthonormal matrix: the length of row 3 must be 1 within 1e-6, got 2",
                Accepts,
            ),
            (
                r#"{ "rotation": [[1, 0, 0], [0.6, 0.8, 0], [0, 0, 1]], "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.rotation, line 4: rotation must be an orthonormal matrix: the product of rows 1 and 2 must be 0 within 1e-6, got 0.6",
                Accepts,
            ),
            (
                r#"{ "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, -1]], "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.rotation, line 4: rotation must not mirror: the matrix is a reflection, with determinant -1; palpate is right-handed, so mirror one axis of a left-handed frame before, for instance in the device's driver",
                Accepts,
            ),
            (
                r#"{ "rotation": [0, 0, 0, 1], "rotate_degrees": { "axis": [0, 0, 1], "angle": 3 }, "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a, line 4: `rotate_degrees` and `rotation` say the same; give one of them",
                Refuses,
            ),
            (
                r#"{ "scale": 0, "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.scale, line 4: scale must be positive, from 1e-15 to 1e15, got 0",
                Refuses,
            ),
            (
                r#"{ "scale": "x", "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.scale, line 4: scale must be a number, or a list with one for each axis, got \"x\"",
                Refuses,
            ),
            (
                r#"{ "offset": -2, "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.offset, line 4: offset must be more than minus the half width of the shape, 1 m, got -2 m",
                Accepts,
            ),
            (
                r#"{ "shell": 0, "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.shell, line 4: thickness must be positive, got 0 m",
                Refuses,
            ),
            (
                r#"{ "elongate": [1, -1, 0], "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.elongate, line 4: elongate must be zero or more, got -1 m",
                Refuses,
            ),
            (
                r#"{ "mirror": "w", "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.mirror, line 4: unknown value `w`; known are `x`, `y` and `z`",
                Refuses,
            ),
            (
                r#"{ "mirror": 0, "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.mirror, line 4: mirror must be one of \"x\", \"y\", \"z\", got 0",
                Refuses,
            ),
            (
                r#"{ "extrude": 1, "of": { "cone": { "radius": 1, "height": 1 } } }"#,
                "shapes.a.of.cone, line 4: `cone` is a 3D shape, this place is 2D",
                Refuses,
            ),
            (
                r#"{ "extrude": -1, "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.extrude, line 4: height must be positive, got -1 m",
                Refuses,
            ),
            (
                r#"{ "revolve": "x", "of": { "ball": { "radius": 1 } } }"#,
                "shapes.a.revolve, line 4: unknown value `x`; known are `y`",
                Refuses,
            ),
            // References.
            (
                r#""d""#,
                "shapes.a, line 4: unknown shape `d`; known are `cup`, `a` and `b`",
                Accepts,
            ),
            (
                r#"{ "shape": "cupp" }"#,
                "shapes.a, line 4: unknown shape `cupp`, did you mean `cup`?",
                Accepts,
            ),
            (
                r#""ball""#,
                "shapes.a, line 4: unknown shape `ball`; a text is the name of one of `shapes`, and what makes a shape stands in an object: { \"ball\": { \"radius\": 0.7 } }",
                Accepts,
            ),
            (
                r#"{ "shape": "union" }"#,
                "shapes.a, line 4: unknown shape `union`; a text is the name of one of `shapes`, and what makes a shape stands in an object: { \"union\": [ …, … ] }",
                Accepts,
            ),
            (
                r#"{ "type": "torus" }"#,
                "shapes.a.type, line 4: unknown key `type`; what makes the shape is itself the key: { \"torus\": { \"ring_radius\": 0.6, \"radius\": 0.2 } }",
                Refuses,
            ),
            (
                r#"{ "cuboid": { "half_extents": [1, 2, 3] } }"#,
                "2 problems:\n  \
                 shapes.a.cuboid, line 4: missing key `size`: the edge lengths\n  \
                 shapes.a.cuboid.half_extents, line 4: unknown key `half_extents`; `cuboid` has `size` (the edge lengths)",
                Refuses,
            ),
            (
                r#""a""#,
                "shapes.a, line 4: shapes refer to each other in a cycle: a → a",
                Accepts,
            ),
            (
                r#"{ "union": ["cup", "b"] }"#,
                "shapes.b.offset, line 5: offset must be more than minus the half width of the shape, 1 m, got -9 m",
                Accepts,
            ),
        ],
        |shape| {
            let b = if shape.contains("\"b\"") { "-9" } else { "9" };
            format!(
                "{{ \"palpate\": 1, \"dimension\": 3,\n\
                 \"shapes\": {{ \n\
                 \"cup\": {{ \"ball\": {{ \"radius\": 1 }} }},\n\
                 \"a\": {shape}\n\
                 , \"b\": {{ \"offset\": {b}, \"of\": {{ \"ball\": {{ \"radius\": 1 }} }} }} }},\n\
                 \"bodies\": [{{ \"name\": \"a\", \"shape\": \"a\" }}] }}"
            )
        },
    );
}

#[test]
fn shapes_in_the_plane_know_that_they_are() {
    check_all(
        &[
            (
                r#"{ "cone": { "radius": 1, "height": 1 } }"#,
                "bodies[0].shape.cone, line 1: `cone` is a 3D shape, this place is 2D",
                Refuses,
            ),
            (
                r#"{ "extrude": 1, "of": { "ball": { "radius": 1 } } }"#,
                "bodies[0].shape, line 1: `extrude` makes a 3D shape, this place is 2D",
                Refuses,
            ),
            (
                r#"{ "mirror": "z", "of": { "ball": { "radius": 1 } } }"#,
                "bodies[0].shape.mirror, line 1: there is no z in 2D: mirror \"x\" or \"y\"",
                Refuses,
            ),
            (
                r#"{ "rotation": [0, 0, 0, 1], "of": { "ball": { "radius": 1 } } }"#,
                "bodies[0].shape.rotation, line 1: a quaternion turns in 3D; in 2D give `rotate_degrees`",
                Refuses,
            ),
            (
                r#"{ "arc": { "ring_radius": 1, "angle_degrees": -5, "radius": 0.1 } }"#,
                "bodies[0].shape.arc.angle_degrees, line 1: angle_degrees must be",
                Accepts,
            ),
        ][..4],
        |shape| {
            format!(
                r#"{{ "palpate": 1, "dimension": 2, "bodies": [{{ "name": "a", "shape": {shape} }}] }}"#
            )
        },
    );
}

#[test]
fn angles_are_refused_in_degrees_and_radians() {
    let text = r#"{ "palpate": 1, "dimension": 2, "bodies": [{ "name": "a", "shape":
        { "arc": { "ring_radius": 1, "angle_degrees": -90, "radius": 0.1 } } }] }"#;
    let error = Scene::from_json(text).unwrap_err().to_string();
    assert!(
        error.starts_with("bodies[0].shape.arc.angle_degrees, line 2: angle_degrees must be "),
        "{error}"
    );
    assert!(error.ends_with(", got -1.5707963267948966 rad (-90°)"), "{error}");
}

#[test]
fn cycles_are_printed_through_every_operator() {
    let scene = |shapes: &str| {
        format!(
            r#"{{ "palpate": 1, "dimension": 3, "shapes": {{ {shapes} }},
                "bodies": [{{ "name": "a", "shape": "a" }}] }}"#
        )
    };
    for (shapes, expected) in [
        (
            "\"a\": \"b\",\n\"b\": { \"union\": [{ \"ball\": { \"radius\": 1 } }, \"c\"] },\n\"c\": { \"offset\": 1, \"of\": \"a\" }",
            "shapes.c.of, line 3: shapes refer to each other in a cycle: a → b → c → a",
        ),
        (
            "\"a\": { \"ball\": { \"radius\": 1 } },\n\"b\": { \"extrude\": 1, \"of\": \"b\" }",
            "shapes.b.of, line 2: shapes refer to each other in a cycle: b → b",
        ),
    ] {
        let error = Scene::from_json(&scene(shapes)).unwrap_err();
        assert_eq!(error.to_string(), expected);
    }
}
