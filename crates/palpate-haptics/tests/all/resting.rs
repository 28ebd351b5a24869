// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A hand that rests on an accepted body rests, whatever its texture and its stiffness.

use palpate_device::{Device, PointState, profile_named};
use palpate_field::{Shape, Vector};
use palpate_haptics::{
    Body, HapticsError, Material, Protection, Servo, ServoOptions, Texture, TextureKind,
};
use palpate_safety::{Acceptance, Accepted, DeviceLimits, SafetyError};
use palpate_sim::{Hand, HandPath, Interpolation, SimulatedDevice};

/// A half-space below the plane y = 0.
fn ground(material: &Material) -> Body {
    Body::new(Shape::half_space([0.0, 1.0, 0.0], 0.0).unwrap(), material).unwrap()
}

fn servo(material: &Material, protection: &Protection) -> Result<Servo, HapticsError> {
    let options = ServoOptions::of_device(&protection.profile);
    Servo::new(vec![ground(material)], 1, options)?.protected(protection)
}

/// The spans of force [N] and of position [m] in the last second of four, under a hand that presses
/// straight down in half a second and stays.
fn spans(servo: &mut Servo, x: f64, deep: f64) -> [f64; 2] {
    let places = vec![[x, 0.01, 0.0].into(), [x, -deep, 0.0].into(), [x, -deep, 0.0].into()];
    let path = HandPath::new(vec![0.0, 0.5, 5.0], places, Interpolation::Monotone).unwrap();
    let profile = servo.protection().profile.clone();
    let mut device = SimulatedDevice::new(profile, vec![Hand::new(path)]).unwrap();
    let mut points = [PointState::at_rest(Vector::ZERO)];
    let mut low = [Vector([f64::INFINITY; 3]); 2];
    let mut high = [Vector([f64::NEG_INFINITY; 3]); 2];
    for tick in 0..4000 {
        device.read(1e-3 * f64::from(tick), &mut points).unwrap();
        servo.step(&points);
        device.write(servo.forces()).unwrap();
        let seen = [servo.touches()[0].force, points[0].position];
        if tick >= 3000 {
            for ((low, high), seen) in low.iter_mut().zip(&mut high).zip(seen) {
                *low = Vector(std::array::from_fn(|axis| low[axis].min(seen[axis])));
                *high = Vector(std::array::from_fn(|axis| high[axis].max(seen[axis])));
            }
        }
    }
    [(high[0] - low[0]).norm(), (high[1] - low[1]).norm()]
}

fn textured(amplitude: f64, wavelength: f64, direction: Option<Vec<f64>>) -> Material {
    let kind = TextureKind::Height;
    let texture = Texture { description: None, kind, amplitude, wavelength, direction };
    Material { stiffness: 700.0, texture: Some(texture), ..Material::default() }
}

/// A desktop was shaken for ever by 8 N and 6 mm on waves of 0.5 mm, 1 mm long.
#[test]
fn a_hand_that_rests_on_a_height_texture_is_not_shaken() {
    let along = Some(vec![1.0, 0.0, 0.0]);
    for (device, amplitude, wavelength) in
        [("desktop", 5e-4, 1e-3), ("omega", 5e-5, 3e-4), ("desktop", 1e-4, 6.5e-3)]
    {
        for direction in [None, along.clone()] {
            let material = textured(amplitude, wavelength, direction);
            let protection = Protection::new(profile_named(device).unwrap());
            for x in [0.0, 0.13 * wavelength, 0.5 * wavelength] {
                let mut servo = servo(&material, &protection).unwrap();
                let [force, way] = spans(&mut servo, x, 0.003);
                let case = (device, amplitude, x);
                assert!(force < 5e-4 && way < 1e-6, "{case:?}: {force} N, {way} m");
            }
        }
    }
}

#[test]
fn waves_are_as_high_as_the_device_renders_their_slopes() {
    let material = textured(5e-4, 1e-3, Some(vec![1.0, 0.0, 0.0]));
    let protection = Protection::new(profile_named("desktop").unwrap());
    let accepted = servo(&material, &protection).unwrap();
    let lateral = &accepted.accepted_textures()[0].lateral;
    // F a (2π / λ)² = 7.9 · 0.0005 · 4 π² · 1e6 N/m, and the desktop renders 1000 N/m.
    let asked = 7.9 * 5e-4 * (2.0 * std::f64::consts::PI / 1e-3).powi(2);
    assert!((lateral.requested_stiffness - asked).abs() < 1e-9 * asked);
    assert!((lateral.device_stiffness - 1000.0).abs() < 1e-9);
    let waves = accepted.bodies().bodies()[0].surface().wave_height().unwrap();
    assert!((waves - 5e-4 * 1000.0 / asked).abs() < 1e-15, "{waves}");
    // Waves that it renders stay.
    let gentle = textured(1e-6, 1e-3, None);
    let accepted = servo(&gentle, &protection).unwrap();
    assert_eq!(accepted.bodies().bodies()[0].surface().wave_height(), Some(1e-6));
    // Strict protection refuses the others, with the number.
    let strict = protection.with(|s| s.is_strict = true);
    let said = servo(&Material { damping: 0.0, ..material }, &strict).unwrap_err().to_string();
    let expected = "height texture of body 0, across its waves: the device renders stiffness \
                    1000 N/m (asked 155900) ";
    assert!(said.starts_with(expected), "{said}");
}

#[test]
fn a_wall_taken_as_it_is_comes_to_rest_or_is_refused() {
    for name in ["desktop", "omega", "sigma", "delta"] {
        let profile = profile_named(name).unwrap();
        let limits = DeviceLimits::along(&profile);
        let most = Accepted::most_stiffness(&limits, Acceptance::Device, 1000.0).unwrap();
        let protection = Protection::new(profile).with(|s| s.acceptance = Acceptance::AsIs);
        let wall = |times: f64| Material {
            stiffness: times * most,
            damping: 0.0,
            ..Material::default()
        };
        let [force, way] = spans(&mut servo(&wall(20.0), &protection).unwrap(), 0.0, 0.01);
        assert!(force < 5e-4 && way < 1e-6, "{name}: {force} N, {way} m");
        for times in [21.0, 200.0, 2e5] {
            let refused = servo(&wall(times), &protection).unwrap_err();
            let HapticsError::Safety(SafetyError::MaterialRefused(refused)) = refused else {
                panic!("{refused}");
            };
            let said = refused[0].told(|body| format!("number {body}"));
            assert!(said.starts_with("body number 0: the device renders "), "{said}");
            assert!(said.contains("as it is, at most 20 times the stiffness"), "{said}");
        }
    }
}
