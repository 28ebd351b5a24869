// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Errors in bodies, tools, motions and views name their path, their line and what
//! is wrong.

use crate::refusal::Schema::{Accepts, Refuses};
use crate::refusal::check_all;

#[test]
fn bad_bodies_tools_motions_and_views_are_refused_with_their_place() {
    check_all(
        &[
            (
                r#""shapes": { "": "x" }"#,
                "shapes.\"\", line 2: a shape must have a name, got \"\"",
                Refuses,
            ),
            (
                r#""tool": { "radius": -1 }"#,
                "tool.radius, line 2: radius must be zero or more, got -1 m",
                Refuses,
            ),
            (
                r#""tool": { "points": [[0, 0]] }"#,
                "tool.points[0], line 2: points[0] must have 3 numbers in 3D, got 2",
                Refuses,
            ),
            (
                r#""tool": { "points": [[0, 0, 0]], "shape": "x" }"#,
                "tool.points, line 2: a tool has either contact points or a shape",
                Accepts,
            ),
            (
                r#""tool": { "coupling": { "stiffness": 0 } }"#,
                "tool.coupling.stiffness, line 2: stiffness must be positive, got 0 N/m",
                Refuses,
            ),
            (
                r#""tool": { "workspace": { "scale": 0 } }"#,
                "tool.workspace.scale, line 2: scale must be positive, got 0",
                Refuses,
            ),
            (
                r#""tool": { "workspace": { "pose": { "rotate_degrees": 3 } } }"#,
                "tool.workspace.pose.rotate_degrees, line 2: rotate_degrees must be an object with `axis` and `angle` in 3D, got a number",
                Refuses,
            ),
            (
                r#""tool": { "max_force": -3 }"#,
                "tool.max_force, line 2: max_force must be positive, got -3 N",
                Refuses,
            ),
            (
                r#""tool": { "actuator": "voicecoil" }"#,
                "tool.actuator, line 2: unknown actuator `voicecoil`, did you mean `voice_coil`?",
                Refuses,
            ),
            (
                r#""motions": [{ "body": "b", "to": {} }]"#,
                "motions[0].body, line 2: unknown body `b`; known are `a`",
                Accepts,
            ),
            (
                r#""motions": [{ "body": "a" }]"#,
                "motions[0], line 2: missing key `to`",
                Refuses,
            ),
            (
                r#""motions": [{ "body": "a", "to": {}, "duration": 0 }]"#,
                "motions[0].duration, line 2: duration must be positive, got 0 s",
                Refuses,
            ),
            (
                r#""motions": [{ "body": "a", "to": {}, "turns": 0.5 }]"#,
                "motions[0].turns, line 2: turns must be a whole number, got 0.5",
                Refuses,
            ),
            (
                r#""motions": [{ "body": "a", "to": { "rotation": [0, 0, 0, 1], "rotate_degrees": { "axis": [0, 0, 1], "angle": 3 } } }]"#,
                "motions[0].to, line 2: `rotate_degrees` and `rotation` say the same; give one of them",
                Refuses,
            ),
            (
                r#""views": [{ "name": "v" }, { "name": "v" }]"#,
                "views[1].name, line 2: name must be unique, but \"v\" is also the name at [0]",
                Accepts,
            ),
            (
                r#""views": [{ "name": "" }]"#,
                "views[0].name, line 2: name must not be empty",
                Refuses,
            ),
            (
                r#""views": [{ "name": "v", "plane": "zx" }]"#,
                "views[0].plane, line 2: unknown value `zx`; known are `xy`, `xz` and `yz`",
                Refuses,
            ),
            (
                r#""views": [{ "name": "v", "width": 0 }]"#,
                "views[0].width, line 2: width must be positive, got 0 m",
                Refuses,
            ),
            (
                r#""views": [{ "name": "v", "plane": { "origin": [0, 0, 0], "right": [1, 0, 0], "up": [2, 0, 0] } }]"#,
                "views[0].plane.up, line 2: up must not be along `right`",
                Accepts,
            ),
            (
                r#""bodies": [{ "name": "b", "shape": "x", "material": { "stiffness": -3 } }]"#,
                "bodies[0].material.stiffness, line 2: stiffness must be zero or more, got -3 N/m",
                Refuses,
            ),
            (
                r#""bodies": [{ "name": "b", "shape": "x", "material": { "seam": -0.01 } }]"#,
                "bodies[0].material.seam, line 2: seam must be zero or more, got -0.01 m",
                Refuses,
            ),
            (
                r#""bodies": [{ "name": "b", "shape": "x", "material": { "static_friction": 0.2 } }]"#,
                "bodies[0].material.dynamic_friction, line 2: dynamic_friction must be at most the static friction 0.2, got 0.3",
                Accepts,
            ),
            (
                r#""bodies": [{ "name": "b", "shape": "x", "material": { "texture": { "kind": "height", "amplitude": 0, "wavelength": 1 } } }]"#,
                "bodies[0].material.texture.amplitude, line 2: amplitude must be positive, got 0 m",
                Refuses,
            ),
            (
                r#""bodies": [{ "name": "b", "shape": "x", "material": { "layers": [{ "depth": 2 }, { "depth": 1 }] } }]"#,
                "bodies[0].material.layers[1].depth, line 2: depth must be more than that of the layer above, 2 m, got 1 m",
                Accepts,
            ),
            (
                r#""bodies": [{ "name": "b", "shape": "x", "material": { "stifness": 3 } }]"#,
                "bodies[0].material.stifness, line 2: unknown key `stifness`, did you mean `stiffness`?",
                Refuses,
            ),
            (
                r#""bodies": [{ "name": "b", "shape": "x", "pose": { "translation": [1] } }]"#,
                "bodies[0].pose.translation, line 2: translation must have 3 numbers in 3D, got 1",
                Refuses,
            ),
            (
                r#""bodies": [{ "name": "b", "shape": "x" }, { "name": "b", "shape": "x" }]"#,
                "bodies[1].name, line 2: name must be unique, but \"b\" is also the name at [0]",
                Accepts,
            ),
            (
                r#""bodies": [{ "name": "b", "shape": "x", "material": "wod" }]"#,
                "bodies[0].material, line 2: unknown material `wod`, did you mean `wood`?",
                Refuses,
            ),
            (
                r#""bodies": [{ "name": "b", "shape": "x", "material": 3 }]"#,
                "bodies[0].material, line 2: material must be an object or the name of a material, got 3",
                Refuses,
            ),
            (
                r#""guides": [{ "point": [0, 0, 0], "max_force": 1 }, { "point": [0, 0, 0], "stiffness": 0 }]"#,
                "guides[1].stiffness, line 2: stiffness must be positive, got 0 N/m",
                Refuses,
            ),
            (
                r#""guides": [{ "point": [0, 0, 0], "max_force": 1 }, { "point": [0, 0] }]"#,
                "guides[1].point, line 2: point must have 3 numbers in 3D, got 2",
                Refuses,
            ),
            (
                r#""guides": [{ "point": [0, 0, 0], "max_force": 1 }, { "damping": 2 }]"#,
                "guides[1], line 2: a guide needs one of `point`, `line`, `segment`, `plane`, `curve`, `well`",
                Refuses,
            ),
            (
                r#""guides": [{ "point": [0, 0, 0], "max_force": 1 }, { "point": [0, 0, 0], "well": { "center": [0, 0, 0], "reach": 1 } }]"#,
                "guides[1], line 2: a guide has one target, got `point` and `well`",
                Refuses,
            ),
            (
                r#""guides": [{ "point": [0, 0, 0], "max_force": 1 }, { "line": { "through": [0, 0, 0], "direction": [0, 0, 0] } }]"#,
                "guides[1].line.direction, line 2: direction must be a direction, got a vector of length 0",
                Accepts,
            ),
            (
                r#""guides": [{ "point": [0, 0, 0], "max_force": 1 }, { "plane": { "through": [0, 0, 0] } }]"#,
                "guides[1].plane, line 2: missing key `normal`",
                Refuses,
            ),
            (
                r#""guides": [{ "point": [0, 0, 0], "max_force": 1 }, { "segment": { "from": [1, 0, 0], "to": [1, 0, 0] } }]"#,
                "guides[1].segment.to, line 2: to must not be where the segment begins",
                Accepts,
            ),
            (
                r#""guides": [{ "point": [0, 0, 0], "max_force": 1 }, { "curve": { "points": [[0, 0, 0]] } }]"#,
                "guides[1].curve.points, line 2: points must have 2 to 1025 points, got 1",
                Refuses,
            ),
            (
                r#""guides": [{ "point": [0, 0, 0], "max_force": 1 }, { "curve": { "points": [[0, 0, 0], [0, 1, 0], [0, 1, 0]] } }]"#,
                "guides[1].curve.points[2], line 2: points[2] must not be where the point before it is",
                Accepts,
            ),
            (
                r#""guides": [{ "point": [0, 0, 0], "max_force": 1 }, { "well": { "center": [0, 0, 0], "reach": 0.004 }, "stiffness": 500 }]"#,
                "guides[1].well.reach, line 2: reach must be more than max_force / stiffness, 0.004 m, got 0.004 m",
                Accepts,
            ),
            (
                r#""guides": [{ "point": [0, 0, 0], "max_force": 1 }, { "point": [0, 0, 0], "snap_distance": 0.02, "release_distance": 0.01 }]"#,
                "guides[1].release_distance, line 2: release_distance must be at least the snap distance 0.02 m, got 0.01 m",
                Accepts,
            ),
            (
                r#""guides": [{ "point": [0, 0, 0], "max_force": 1 }, { "point": [0, 0, 0], "release_distance": 0.01 }]"#,
                "guides[1].release_distance, line 2: release_distance has a meaning only beside `snap_distance`",
                Accepts,
            ),
            (
                r#""guides": [{ "point": [0, 0, 0], "max_force": 1 }, { "point": [0, 0, 0], "snap": 0.01 }]"#,
                "guides[1].snap, line 2: unknown key `snap`; known are `description`, `point`, `line`, `segment`, `plane`, `curve`, `well`, `stiffness`, `damping`, `snap_distance`, `release_distance` and `max_force`",
                Refuses,
            ),
            (
                r#""bodies": [{ "name": "b" }]"#,
                "bodies[0], line 2: missing key `shape`",
                Refuses,
            ),
        ],
        |part| {
            let shapes = if part.starts_with("\"shapes\"") {
                ""
            } else {
                r#""shapes": { "x": { "ball": { "radius": 1 } } },"#
            };
            let bodies = if part.starts_with("\"bodies\"") {
                ""
            } else {
                r#", "bodies": [{ "name": "a", "shape": { "ball": { "radius": 1 } } }]"#
            };
            format!("{{ \"palpate\": 1, \"dimension\": 3, {shapes}\n{part}\n{bodies} }}")
        },
    );
}
