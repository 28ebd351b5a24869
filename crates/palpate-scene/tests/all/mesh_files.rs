// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes of meshes, in files and in scenes.

use palpate_field::{Shape, Vector};
use palpate_mesh::{MeshSheet, Solid, TriangleMesh};
use palpate_scene::{AnyScene, BuiltScene, Scene, WrittenShape};

/// A tetrahedron of 1, 2 and 3 m.
const TETRAHEDRON: &str =
    "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

fn text(mesh: &str) -> String {
    format!(
        r#"{{ "palpate": 1, "dimension": 3, "bodies": [
          {{ "name": "a", "shape": {{ "mesh": {mesh} }} }} ] }}"#
    )
}

/// A tetrahedron whose corners have no short decimals, of which one face is turned.
fn mesh() -> TriangleMesh {
    let corners = [[0.0, -0.0, 1e-9], [1.0 / 3.0, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 7e3]];
    let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 2, 3]];
    TriangleMesh::new(corners.map(Vector).to_vec(), faces).unwrap()
}

#[test]
fn a_mesh_made_in_code_is_written_and_read_back_to_the_bit() {
    let solid: Shape<3> = Solid::from_mesh(&mesh()).unwrap().0.into();
    let sheet: Shape<3> = MeshSheet::from_mesh(&mesh(), 0.01).unwrap().into();
    for shape in
        [solid.clone(), sheet, solid.clone().scaled(0.1).unwrap() - Shape::ball(0.1).unwrap()]
    {
        let text = WrittenShape::of(&shape).unwrap().to_json();
        let read: Shape<3> = WrittenShape::from_json(&text).unwrap().build().unwrap();
        assert_eq!(read, shape, "{text}");
        for p in [[0.1, 0.02, 0.5], [0.3, -0.2, 0.1], [0.01, 0.01, 1.0]].map(Vector) {
            assert_eq!(read.distance(p).to_bits(), shape.distance(p).to_bits(), "{p:?}");
        }
    }
    let other = TriangleMesh::new(
        mesh().vertices().iter().map(|p| *p * 2.0).collect(),
        mesh().elements().to_vec(),
    );
    assert_ne!(solid, Solid::from_mesh(&other.unwrap()).unwrap().0.into());
}

#[test]
fn a_mesh_that_stands_in_a_scene_is_checked() {
    let error = |mesh: &str| Scene::from_json(&text(mesh)).unwrap_err().to_string();
    let vertices = r#""vertices": [[0,0,0],[1,0,0],[0,1,0]]"#;
    for (rest, expected) in [
        (r#""faces": [[0, 1, 3]]"#, "names vertex 3"),
        (r#""faces": [[0, 1, 2]]"#, "sheet"),
        (r#""faces": []"#, "no faces"),
        (r#""faces": [[0, 1, 2]], "scale": 0.1"#, "or `vertices` in metres"),
        (r#""faces": [[0, 1, 2]], "thickness": 0"#, "thickness must be from"),
        (r#""file": "a.stl""#, "must have `file`"),
    ] {
        let problem = error(&format!("{{ {vertices}, {rest} }}"));
        assert!(problem.contains(expected), "{problem}");
    }
    let plate = format!(r#"{{ {vertices}, "faces": [[0, 1, 2]], "thickness": 0.1 }}"#);
    let AnyScene::Spatial(scene) = Scene::from_json(&text(&plate)).unwrap().build().unwrap()
    else {
        panic!("in the plane")
    };
    assert!((scene.whole.distance(Vector([0.2, 0.2, 0.1])) - 0.05).abs() < 1e-15);
    assert_eq!(scene.meshes[0].file, None);
}

#[test]
fn a_mesh_is_looked_for_beside_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("parts").join("part.obj");
    std::fs::create_dir(file.parent().unwrap()).unwrap();
    std::fs::write(&file, TETRAHEDRON).unwrap();
    let built = |mesh: &str| -> Result<BuiltScene<3>, String> {
        let scene = Scene::from_json_in(&text(mesh), folder.path());
        match scene.and_then(|scene| scene.build()) {
            Ok(AnyScene::Spatial(scene)) => Ok(scene),
            Ok(AnyScene::Planar(_)) => Err("in the plane".to_owned()),
            Err(error) => Err(error.to_string()),
        }
    };
    let scene = built(r#"{ "file": "parts/part.obj", "scale": 0.1 }"#).unwrap();
    assert_eq!(scene.meshes.len(), 1);
    assert!(scene.meshes[0].findings.is_clean());
    assert!((scene.whole.distance(Vector([0.01, 0.02, -0.5])) - 0.5).abs() < 1e-15);
    // A file that changed is read anew.
    std::fs::write(&file, TETRAHEDRON.replace("v 0 0 3", "v 0 0 30")).unwrap();
    let scene = built(r#"{ "file": "parts/part.obj", "scale": 0.1 }"#).unwrap();
    assert_eq!(scene.whole.promise().bounds.unwrap().aabb.max[2], 3.0);
    for (mesh, expected) in [
        (
            r#"{ "file": "../part.obj" }"#,
            "a mesh is a file in the scene's folder or below it, got \"../part.obj\"",
        ),
        (
            r#"{ "file": "/part.obj" }"#,
            "a mesh is a file in the scene's folder or below it, got \"/part.obj\"",
        ),
        (r#"{ "file": "parts/part.obj", "scale": 0 }"#, "scale must be positive, got 0"),
        (r#"{ "file": "gone.obj" }"#, "gone.obj: "),
        (
            r#"{ "scale": 1 }"#,
            "must have `file`, and `scale` if it is not in metres, or `vertices`",
        ),
    ] {
        let error = built(mesh).unwrap_err();
        assert!(error.contains(expected), "{error}");
    }
    let error = Scene::from_json(&text(r#"{ "file": "part.obj" }"#)).unwrap_err();
    assert!(error.to_string().contains("this scene is in no file"), "{error}");
}

/// A link led to files outside, whose first words an error told; a pipe or a device was opened, which never ended.
#[cfg(unix)]
#[test]
fn links_out_of_the_folder_and_what_is_no_file_are_refused() {
    use std::os::unix::fs::symlink;
    let outside = tempfile::tempdir().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let secret = outside.path().join("secret.obj");
    std::fs::write(&secret, TETRAHEDRON).unwrap();
    symlink(&secret, folder.path().join("link.obj")).unwrap();
    symlink(outside.path(), folder.path().join("way")).unwrap();
    std::fs::create_dir(folder.path().join("folder.obj")).unwrap();
    std::fs::write(folder.path().join("part.obj"), TETRAHEDRON).unwrap();
    symlink(folder.path().join("part.obj"), folder.path().join("same.obj")).unwrap();
    let built = |file: &str| {
        let text = text(&format!("{{ \"file\": \"{file}\" }}"));
        let scene = Scene::from_json_in(&text, folder.path());
        scene.and_then(|scene| scene.build()).map(|_| ()).map_err(|error| error.to_string())
    };
    for file in ["link.obj", "way/secret.obj"] {
        let error = built(file).unwrap_err();
        assert!(error.contains("it is a link out of the scene's folder"), "{error}");
    }
    let error = built("folder.obj").unwrap_err();
    assert!(error.contains("it is no file"), "{error}");
    assert_eq!(built("same.obj"), Ok(()));
}

#[test]
fn a_surface_of_a_volume_is_a_solid() {
    let folder = tempfile::tempdir().unwrap();
    let head =
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 5 5 5\nencoding: raw\nspacings: 2 2 2\n\n";
    let mut file = head.as_bytes().to_vec();
    file.extend((0..125).map(|node| if node == 62 { 200 } else { 0 }));
    std::fs::write(folder.path().join("dot.nrrd"), &file).unwrap();
    let built = |volume: &str| {
        let text = text("0").replace("\"mesh\": 0", &format!("\"volume\": {volume}"));
        match Scene::from_json_in(&text, folder.path()).and_then(|scene| scene.build()) {
            Ok(AnyScene::Spatial(scene)) => Ok(scene),
            Ok(AnyScene::Planar(_)) => Err("in the plane".to_owned()),
            Err(error) => Err(error.to_string()),
        }
    };
    let scene = built(r#"{ "file": "dot.nrrd", "value": 100 }"#).unwrap();
    assert_eq!(scene.meshes[0].value, Some(100.0));
    // The dot is in the middle, 4 mm from the first node, and at most a millimetre large.
    assert!(scene.whole.distance(Vector([0.004; 3])) < 0.0);
    let off = scene.whole.distance(Vector([0.006, 0.004, 0.004]));
    assert!((0.7e-3..1.8e-3).contains(&off), "{off}");
    let smaller = built(r#"{ "file": "dot.nrrd", "value": 150, "scale": 0.5 }"#).unwrap();
    assert!(smaller.whole.distance(Vector([0.002; 3])) < 0.0);
    // Below the value is all but the dot.
    let around = built(r#"{ "file": "dot.nrrd", "value": 100, "inside": "below" }"#).unwrap();
    assert!(around.whole.distance(Vector([0.004; 3])) > 0.0);
    assert!(around.whole.distance(Vector([0.001, 0.004, 0.004])) < 0.0);
    let same = built(r#"{ "file": "dot.nrrd", "value": 100, "inside": "above" }"#).unwrap();
    assert!(same.whole.distance(Vector([0.004; 3])) < 0.0);
    for (volume, expected) in [
        (
            r#"{ "file": "dot.nrrd", "value": 100, "inside": "left" }"#,
            "inside must be one of \"above\", \"below\", got \"left\"",
        ),
        (
            r#"{ "file": "dot.nrrd", "value": 300 }"#,
            "the samples are from 0 to 200: no surface lies at 300",
        ),
        (r#"{ "file": "dot.nrrd" }"#, "missing key `value`"),
        (r#"{ "file": "gone.nii", "value": 1 }"#, "gone.nii"),
        (
            r#"{ "file": "dot.nrrd", "grid": "density", "value": 1 }"#,
            "there is no grid \"density\" in it: only a file of NanoVDB has grids with names",
        ),
        (
            r#"{ "file": "../dot.nrrd", "value": 1 }"#,
            "a volume is a file in the scene's folder",
        ),
    ] {
        let error = built(volume).unwrap_err();
        assert!(error.contains(expected), "{error}");
    }
}
