// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes made in code come back from a scene file to the bit.

use palpate_field::catalogue::Entry;
use palpate_field::kernel::Ball;
use palpate_field::operator::{Copies, Profile};
use palpate_field::scalar::{Dual, Scalar};
use palpate_field::{Kernel, Point, Pose, Promise, Rotation, Shape, ShapeError, Vector};
use palpate_grid::{Grid, GridOptions, Lattice, Store};
use palpate_haptics::Material;
use palpate_scene::{AnyScene, BuiltScene, Dimension, Scene, SceneBody, WrittenShape};
use palpate_testkit::arbitrary::{PROFILES, Turn, arguments, point, tree};
use palpate_testkit::cases;
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::Solid;

/// A dimension of scenes.
trait Place<const D: usize> {
    fn built(scene: AnyScene) -> BuiltScene<D>;
}

impl Place<2> for Space {
    fn built(scene: AnyScene) -> BuiltScene<2> {
        let AnyScene::Planar(scene) = scene else { panic!("not planar") };
        scene
    }
}

impl Place<3> for Space {
    fn built(scene: AnyScene) -> BuiltScene<3> {
        let AnyScene::Spatial(scene) = scene else { panic!("not spatial") };
        scene
    }
}

/// The shape, written as a file and read again; writing that again gives the same file.
fn read_back<const D: usize>(shape: &Shape<D>) -> Shape<D>
where
    Space: Place<D>,
{
    let text =
        Scene::of_shape("it", shape).unwrap_or_else(|e| panic!("{shape}: {e}")).to_json();
    let scene = Scene::from_json(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert_eq!(scene.to_json(), text);
    let mut built = Space::built(scene.build().unwrap());
    let again = built.bodies.swap_remove(0).shape_in_body;
    assert_eq!(again, *shape, "{text}");
    assert_eq!(Scene::of_shape("it", &again).unwrap().to_json(), text);
    again
}

fn assert_same_bits<const D: usize>(a: &Shape<D>, b: &Shape<D>, p: Point<D>) {
    let bits = |shape: &Shape<D>| {
        let (distance, gradient) = shape.distance_gradient(p);
        (distance.to_bits(), gradient.0.map(f64::to_bits))
    };
    assert_eq!(bits(a), bits(b), "{a} at {p:?}");
}

/// A grid of points that are on no plane of symmetry.
fn points<const D: usize>() -> impl Iterator<Item = Point<D>> {
    (0..200).map(|i| {
        let steps = [0.618_034, 0.414_214, 0.732_051];
        Vector(std::array::from_fn(|k| (f64::from(i) * steps[k]).fract() * 4.0 - 2.0))
    })
}

fn check<const D: usize>(shape: &Shape<D>)
where
    Space: Place<D>,
{
    let again = read_back(shape);
    points().for_each(|p| assert_same_bits(shape, &again, p));
}

fn random_trees_come_back<const D: usize>(count: u64)
where
    Space: Place<D> + Solid<D> + Turn<D>,
{
    cases::each(count, |u| {
        let shape = tree::<D>(u, 5)?.shape().unwrap();
        let again = read_back(&shape);
        for _ in 0..20 {
            assert_same_bits(&shape, &again, point(u, &shape)?);
        }
        Ok(())
    });
}

#[test]
fn random_shapes_of_the_plane_come_back_to_the_bit() {
    random_trees_come_back::<2>(1000);
}

#[test]
fn random_shapes_of_space_come_back_to_the_bit() {
    random_trees_come_back::<3>(1000);
}

fn primitives_come_back<const D: usize>() -> usize
where
    Space: Place<D> + Solid<D>,
{
    for entry in Entry::<D>::all() {
        check(&entry.example().unwrap());
        cases::each(10, |u| {
            let Some(arguments) = arguments::<D>(u, entry.name, entry.parameters)? else {
                return Ok(());
            };
            check(&entry.build(&arguments).unwrap());
            Ok(())
        });
    }
    Entry::<D>::all().len()
}

#[test]
fn every_primitive_comes_back_to_the_bit() {
    assert!(primitives_come_back::<2>() > 40 && primitives_come_back::<3>() > 40);
}

fn operators_of_both<const D: usize>(turn: Rotation<D>) -> Result<Vec<Shape<D>>, ShapeError> {
    let axis = |i: usize, x: f64| Vector::<f64, D>::unit(i) * x;
    let a = Shape::from_kernel(Ball::new(0.5)?);
    let b = a.clone().stretched(std::array::from_fn(|i| 0.6 + 0.3 * i as f64))?;
    let b = b.translated(axis(0, 0.4))?;
    let c = a.clone().scaled(0.7)?.translated(axis(1, -0.3))?;
    let three = || [a.clone(), b.clone(), c.clone()];
    let row = Copies::Between { spacing: 1.3, first: -1, last: 2 };
    let mut grid = [Copies::One; D];
    let mut shapes = vec![
        a.clone().repeated(grid)?,
        Shape::union(three())?,
        Shape::intersection(three())?,
        a.clone().difference([b.clone(), c.clone()])?,
        Shape::symmetric_difference(three())?,
        a.clone().displaced(b.clone(), 0.05)?,
        a.clone().morphed(c.clone(), 0.3)?,
        b.clone().placed(&Pose::new(turn, axis(1, -0.0)))?,
        a.clone().translated(axis(0, -0.0))?.translated(axis(1, 0.1))?,
        a.clone().offset(-0.1)?,
        a.clone().shell(0.1)?,
        a.clone().elongated(std::array::from_fn(|i| 0.2 * i as f64))?,
        b.clone().mirrored(D - 1)?,
        c.clone().bent(0.7)?,
    ];
    grid[1] = row;
    shapes.push(c.clone().repeated(grid)?);
    shapes.push(c.clone().repeated([Copies::Endless { spacing: 2.5 }; D])?);
    for profile in PROFILES {
        shapes.push(Shape::smooth_union(three(), profile, 0.03)?);
        shapes.push(Shape::smooth_intersection(three(), profile, 0.03)?);
        shapes.push(a.clone().smooth_difference([b.clone(), c.clone()], profile, 0.03)?);
    }
    Ok(shapes)
}

#[test]
fn every_operator_comes_back_to_the_bit() {
    let flat = operators_of_both(Rotation::from_angle(0.3).unwrap()).unwrap();
    flat.iter().for_each(check);
    let turn = Rotation::from_axis_angle(Vector([1.0, -2.0, 0.5]), 0.8).unwrap();
    operators_of_both(turn).unwrap().iter().for_each(check);
    for flat in flat {
        // An endless profile has no box to be turned in.
        let Ok(solid) = flat.clone().extruded(0.3) else { continue };
        check(&solid);
        let Ok(turned) = flat.translated([3.0, 0.0]).and_then(Shape::revolved) else {
            continue;
        };
        check(&turned);
        if let Ok(twisted) = solid.twisted(-1.1) {
            check(&twisted);
        }
    }
}

#[test]
fn products_of_rotations_keep_every_bit() {
    let third = Rotation::from_axis_angle(Vector([1.0, 1.0, 1.0]), 2.1).unwrap();
    let mut turn = Rotation::from_axis_angle(Vector([0.0, 0.0, 1.0]), 0.7).unwrap();
    let step = Rotation::from_angle(0.7).unwrap();
    let mut flat = step;
    let bits = |shape: &Shape<3>| match shape.node() {
        palpate_field::Node::Placed { pose, .. } => {
            pose.rotation.matrix().map(|r| r.map(f64::to_bits))
        }
        other => panic!("{other:?} is not turned"),
    };
    for _ in 0..50 {
        let shape = Shape::cuboid([1.0, 0.5, 0.2]).unwrap().rotated(turn).unwrap();
        assert_eq!(bits(&read_back(&shape)), bits(&shape));
        check(&Shape::cuboid([1.0, 0.5]).unwrap().rotated(flat).unwrap());
        turn = third * turn;
        flat = flat * step;
    }
}

/// The text of the shape of the one body of a scene with this shape.
fn text<const D: usize>(shape: &Shape<D>) -> String {
    let scene = serde_json::to_value(Scene::of_shape("it", shape).unwrap()).unwrap();
    scene["bodies"][0]["shape"].to_string()
}

#[test]
fn a_rotation_is_written_in_the_shortest_form_that_keeps_its_bits() {
    let plate = Shape::cuboid([0.5, 0.25]).unwrap();
    let cube = Shape::cuboid([0.5, 0.25, 1.0]).unwrap();
    let flat = |turn: Rotation<2>| text(&plate.clone().rotated(turn).unwrap());
    let solid = |turn: Rotation<3>| text(&cube.clone().rotated(turn).unwrap());
    let degrees = Rotation::from_angle(30_f64.to_radians()).unwrap();
    assert!(flat(degrees).starts_with(r#"{"rotate_degrees":30,"of""#), "{}", flat(degrees));
    let about_y = Rotation::from_axis_angle(Vector::unit(1), 75_f64.to_radians()).unwrap();
    let written = r#"{"rotate_degrees":{"axis":[0,1,0],"angle":75},"of""#;
    assert!(solid(about_y).starts_with(written), "{}", solid(about_y));
    let half = Rotation::from_quaternion([0.5, 0.5, 0.5, 0.5]).unwrap();
    assert!(
        solid(half).starts_with(r#"{"rotation":[0.5,0.5,0.5,0.5],"of""#),
        "{}",
        solid(half)
    );
    let rows = Rotation::from_rows([[0.6, -0.8], [0.8, 0.6]]).unwrap();
    assert!(
        flat(rows).starts_with(r#"{"rotation":[[0.6,-0.8],[0.8,0.6]],"of""#),
        "{}",
        flat(rows)
    );
}

#[test]
fn an_angle_without_degrees_is_written_in_radians() {
    assert_eq!(text(&Shape::pie(1.0, 1.35).unwrap()), r#"{"pie":{"radius":1,"angle":1.35}}"#);
    let right = Shape::pie(1.0, std::f64::consts::FRAC_PI_2).unwrap();
    assert_eq!(text(&right), r#"{"pie":{"radius":1,"angle_degrees":90}}"#);
}

#[test]
fn a_rotation_of_few_digits_is_made_orthonormal() {
    let text = r#"{ "palpate": 1, "dimension": 2, "bodies": [ { "name": "a", "shape": {
        "rotation": [[0.7071068, -0.7071068], [0.7071068, 0.7071068]],
        "of": { "cuboid": { "size": [2, 1] } } } } ] }"#;
    let AnyScene::Planar(scene) = Scene::from_json(text).unwrap().build().unwrap() else {
        panic!("not planar")
    };
    let palpate_field::Node::Placed { pose, .. } = scene.whole.node() else { panic!() };
    let [row, _] = *pose.rotation.matrix();
    assert!((Vector(row).norm() - 1.0).abs() < 1e-15);
}

#[test]
fn a_shape_that_is_shared_is_written_once() {
    let mut shape = Shape::sphere(0.1).unwrap();
    for i in 0..16 {
        let there = shape.clone().translated([0.3 * f64::from(i), 0.1, 0.0]).unwrap();
        shape = Shape::smooth_union([shape, there], Profile::Cubic, 0.01).unwrap();
    }
    let scene = Scene::of_shape("many", &shape).unwrap();
    assert_eq!(scene.shapes.len(), 16);
    assert!(scene.to_json().len() < 8000, "{}", scene.to_json());
    let again = Space::built(Scene::from_json(&scene.to_json()).unwrap().build().unwrap());
    let again: &Shape<3> = &again.bodies[0].shape_in_body;
    assert_eq!(Scene::of_shape("many", again).unwrap(), scene);
    points().take(5).for_each(|p| assert_same_bits(&shape, again, p));
}

#[test]
fn a_shape_as_deep_as_shapes_may_be_comes_back() {
    let ball = Shape::sphere(0.1).unwrap();
    let turn = Rotation::from_axis_angle(Vector([1.0, 2.0, 3.0]), 0.3).unwrap();
    let pose = Pose::new(turn, Vector([0.1, 0.2, 0.3]));
    let deeper = |shape: &Shape<3>| {
        let placed = shape.clone().placed(&pose)?;
        Shape::smooth_union([placed, ball.clone()], Profile::Cubic, 0.01)
    };
    let mut shape = ball.clone();
    while let Ok(next) = deeper(&shape) {
        shape = next;
    }
    assert!(shape.depth() + 2 > palpate_field::MAX_DEPTH, "{}", shape.depth());
    let again = read_back(&shape);
    points().take(5).for_each(|p| assert_same_bits(&shape, &again, p));
}

#[test]
fn bodies_share_shapes_and_keep_the_names_of_a_scene() {
    let profile = Shape::rectangle([0.1, 0.2]).unwrap();
    let peg = profile.clone().extruded(1.0).unwrap();
    let ring = profile.translated([0.5, 0.0]).unwrap().revolved().unwrap();
    let mut scene = Scene::of_shape("ball", &Shape::sphere(0.1).unwrap()).unwrap();
    let own = scene.bodies[0].shape.clone();
    scene.shapes.insert("shared_1".to_owned(), own);
    let pose = Pose::translation(Vector([0.0, -0.0, 2.0]));
    let scene = scene
        .with_bodies([
            SceneBody::new("peg", peg.clone()),
            SceneBody::new("ring", ring.clone()).made_of(Material::wood()),
            SceneBody::new("other peg", peg.clone()).at(pose),
        ])
        .unwrap();
    assert_eq!(scene.shapes.keys().collect::<Vec<_>>(), ["shared_1", "shared_2", "shared_3"]);
    let scene = Scene::from_json(&scene.to_json()).unwrap();
    let built = <Space as Place<3>>::built(scene.build().unwrap());
    let names: Vec<_> = built.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, ["ball", "peg", "ring", "other peg"]);
    assert_eq!(built.bodies[1].shape_in_body, peg);
    assert_eq!(built.bodies[2].shape_in_body, ring);
    assert_eq!(built.bodies[2].material, Material::wood());
    assert_eq!(built.bodies[3].world_from_body, pose);
    assert!(built.bodies[3].world_from_body.translation[1].is_sign_negative());
}

#[derive(Clone, Debug)]
struct Wave(Promise<2>);

impl Kernel<2> for Wave {
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        p.0[1] - p.0[0].sin().scale(0.5)
    }

    fn promise(&self) -> Promise<2> {
        self.0
    }
}

#[test]
fn an_opaque_shape_is_named_with_its_type_and_place() {
    let promise = Promise::lipschitz(None, 1.2);
    let wave = Shape::from_kernel(Wave(promise));
    let plate = Shape::rectangle([1.0, 2.0]).unwrap();
    let shape = plate.clone() - wave.translated([0.1, 0.0]).unwrap();
    let error = Scene::of_shape("it", &shape).unwrap_err();
    assert_eq!(error.first().path, "bodies[0].shape.difference[1].of");
    let problem =
        "`all::from_code::Wave` is opaque: files hold primitives, operators, meshes and grids";
    assert_eq!(error.first().problem, problem);
    assert_eq!((error.first().line, error.first().column), (0, 0));

    let closure = Shape::from_fn(promise, |p: Vector<Dual<f64, 2>, 2>| p.0[1]);
    let solid = closure.displaced(plate.clone(), 0.1).and_then(|s| (plate & s).extruded(1.0));
    let error = Scene::of_shape("it", &solid.unwrap()).unwrap_err();
    assert_eq!(error.first().path, "bodies[0].shape.of.intersection[1].displace[0]");
    assert!(error.first().problem.contains("from_code::an_opaque_shape_is"), "{error}");
}

#[test]
fn a_grid_is_written_as_it_was_baked() {
    let disc = Shape::circle(0.05).unwrap();
    let bakes = [
        GridOptions::with_cell(0.01),
        GridOptions {
            kernel: palpate_grid::GridKernel::Trilinear,
            store: Store::I16,
            band: Some(8.0),
            ..GridOptions::with_tolerance(1e-3)
        },
    ];
    for options in bakes {
        let grid = Shape::from(Grid::bake(&disc, &options).unwrap());
        let shape = grid.clone() | grid.clone().translated([0.2, 0.0]).unwrap();
        let text = Scene::of_shape("it", &shape).unwrap().to_json();
        let read = Scene::from_json(&text).unwrap().build().unwrap();
        let AnyScene::Planar(read) = read else { panic!("a planar scene") };
        assert_eq!(read.bodies[0].shape, shape, "{text}");
    }
    // What text cannot make again is refused.
    let certified = GridOptions { certified: 2.0, ..GridOptions::with_cell(0.01) };
    let error = WrittenShape::of(&Grid::bake(&disc, &certified).unwrap().into()).unwrap_err();
    assert!(error.to_string().contains("certified to 2 cells"), "{error}");
    let lattice = Lattice { origin: Vector([-1.0; 2]), cell: 0.5, counts: [5, 5] };
    let samples: Vec<f64> = (0..25).map(|i| if i == 12 { -0.1 } else { 0.4 }).collect();
    let kernel = palpate_grid::GridKernel::Trilinear;
    let grid = Grid::from_samples(lattice, &samples, kernel, Store::I8).unwrap();
    let error = WrittenShape::of(&grid.into()).unwrap_err();
    assert!(error.to_string().contains("save it, and name its file"), "{error}");
}

#[test]
fn a_grid_of_samples_is_written_with_them() {
    let lattice = Lattice { origin: Vector([-1.0; 2]), cell: 0.5, counts: [5, 5] };
    let samples: Vec<f64> = (0..25).map(|i| if i == 12 { -0.1 } else { 0.4 }).collect();
    for kernel in palpate_grid::GridKernel::ALL {
        let grid = Grid::from_samples(lattice, &samples, kernel, Store::F32).unwrap();
        let shape = Shape::from(grid);
        let text = WrittenShape::of(&shape).unwrap().to_json();
        assert_eq!(
            WrittenShape::from_json(&text).unwrap().build::<2>().unwrap(),
            shape,
            "{text}"
        );
    }
    for (wrong, said) in [
        (r#"{ "grid": {} }"#, "must have `file`, or `samples`"),
        (r#"{ "grid": { "file": "a.grid", "cell": 1 } }"#, "must have `file`, or `samples`"),
        (
            r#"{ "grid": { "samples": [1], "counts": [1], "cell": 1, "origin": [0, 0] } }"#,
            "must have 2 numbers, got 1",
        ),
        (
            r#"{ "grid": { "samples": [1], "counts": [4, 4], "cell": 1, "origin": [0, 0] } }"#,
            "4 × 4 nodes need as many samples, got 1",
        ),
        (
            r#"{ "grid": { "samples": [1, 1, 1, 1], "counts": [2, 2], "cell": 1, "origin": [0, 0] } }"#,
            "at least 3 nodes along each axis, got [2, 2]",
        ),
        (
            r#"{ "grid": { "samples": [1], "counts": [4, -4], "cell": 1, "origin": [0, 0] } }"#,
            "must be a whole number, zero or more, got -4",
        ),
        // Such a grid was good, and its mass no number.
        (
            r#"{ "grid": { "kernel": "trilinear", "samples": [1, 1, 1, 1], "counts": [2, 2], "cell": 1, "origin": [0, 1e300] } }"#,
            "a coordinate of a node must be at most 1e15 m in size, got 1e300 m",
        ),
    ] {
        let error = WrittenShape::from_json(wrong).and_then(|read| read.build::<2>());
        let error = error.unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn aliases_are_read_as_their_primitives() {
    let read = |dimension: usize, shape: &str| {
        let text = format!(
            r#"{{ "palpate": 1, "dimension": {dimension},
                 "bodies": [{{ "name": "it", "shape": {shape} }}] }}"#
        );
        let validator = jsonschema::validator_for(&palpate_scene::schema()).unwrap();
        let scene = Scene::from_json(&text);
        assert_eq!(
            scene.is_ok(),
            validator.is_valid(&serde_json::from_str(&text).unwrap()),
            "{text}"
        );
        scene
    };
    let flat = |shape: &str| -> Shape<2> {
        Space::built(read(2, shape).unwrap().build().unwrap()).bodies.swap_remove(0).shape
    };
    let solid = |shape: &str| -> Shape<3> {
        Space::built(read(3, shape).unwrap().build().unwrap()).bodies.swap_remove(0).shape
    };
    let circle = flat(r#"{ "circle": { "radius": 2 } }"#);
    assert_eq!(circle, Shape::circle(2.0).unwrap());
    assert_eq!(text(&circle), r#"{"ball":{"radius":2}}"#);
    let rectangle = flat(r#"{ "rectangle": { "size": [1, 2] } }"#);
    assert_eq!(rectangle, Shape::rectangle([1.0, 2.0]).unwrap());
    assert_eq!(text(&rectangle), r#"{"cuboid":{"size":[1,2]}}"#);
    assert_eq!(solid(r#"{ "sphere": { "radius": 2 } }"#), Shape::sphere(2.0).unwrap());
    let cuboid = Shape::cuboid([1.0, 2.0, 3.0]).unwrap();
    assert_eq!(solid(r#"{ "box": { "size": [1, 2, 3] } }"#), cuboid);
    assert_eq!(solid(r#"{ "cube": { "size": 2 } }"#), Shape::cube(2.0).unwrap());
    assert_eq!(flat(r#"{ "square": { "size": 2 } }"#), Shape::square(2.0).unwrap());
    let extruded = solid(r#"{ "extrude": 1, "of": { "circle": { "radius": 2 } } }"#);
    assert_eq!(extruded, circle.extruded(1.0).unwrap());
    for (dimension, shape, problem) in [
        (
            2,
            r#"{ "sphere": { "radius": 2 } }"#,
            "bodies[0].shape.sphere, line 2: `sphere` is a 3D shape, this place is 2D",
        ),
        (
            3,
            r#"{ "sphere": { "radius": -2 } }"#,
            "bodies[0].shape.sphere.radius, line 2: radius must be positive, got -2 m",
        ),
        (
            3,
            r#"{ "cube": { "size": -2 } }"#,
            "bodies[0].shape.cube.size, line 2: size must be positive, got -2 m",
        ),
        (
            3,
            r#"{ "cube": { "size": [1, 2, 3] } }"#,
            "bodies[0].shape.cube.size, line 2: size must be a number, got a list",
        ),
        (
            3,
            r#"{ "spere": { "radius": 2 } }"#,
            "bodies[0].shape.spere, line 2: unknown key `spere`, did you mean `sphere`?",
        ),
    ] {
        assert_eq!(read(dimension, shape).unwrap_err().to_string(), problem);
    }
    // What a person wrote stays.
    let scene = read(3, r#"{ "sphere": { "radius": 2 } }"#).unwrap();
    assert!(scene.to_json().contains(r#"{ "sphere": { "radius": 2 } }"#));
    assert_eq!(Scene::from_json(&scene.to_json()), Ok(scene));
}

#[test]
fn every_alias_of_the_catalogue_is_a_key_of_the_schema() {
    let schema = palpate_scene::schema();
    for alias in palpate_field::catalogue::ALIASES {
        let place = if alias.dimension == 2 { "plane" } else { "space" };
        let keys = &schema["$defs"][place]["Shape"]["properties"];
        let [own, others] = [alias.name, alias.of].map(|name| &keys[name]["properties"]);
        assert_eq!(own == others, alias.parameters.is_none(), "{alias:?}");
        assert!(keys[alias.name].is_object(), "{alias:?}");
    }
}

#[test]
fn bodies_of_another_dimension_are_refused() {
    let circle = Shape::circle(1.0).unwrap();
    let error = Scene::new(Dimension::Three).with_bodies([SceneBody::new("flat", circle)]);
    assert_eq!(error.unwrap_err().to_string(), "bodies: the scene is 3D, its bodies are 2D");
}

#[test]
fn a_shape_alone_is_written_and_read_without_a_scene() {
    let pin = Shape::cylinder(0.002, 0.03).unwrap();
    let pair = pin.clone().translated([0.01, 0.0, 0.0]).unwrap() | pin;
    let written = WrittenShape::of(&pair).unwrap();
    assert_eq!(written.build::<3>().unwrap(), pair);
    assert_eq!(WrittenShape::from_json(&written.to_json()).unwrap(), written);

    let flat = written.build::<2>().unwrap_err();
    assert_eq!(flat.first().path, "union[0].of.cylinder");
    let named = WrittenShape::reference("cup").build::<3>().unwrap_err();
    assert_eq!(named.to_string(), "unknown shape `cup`; there are none here");
    let opaque = Shape::from_fn(Promise::lipschitz(None, 1.0), |p| p.0[1]);
    assert_eq!(WrittenShape::of(&(pair | opaque)).unwrap_err().first().path, "union[2]");
}
