// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How the hand is led.

use palpate_live::{Live, LiveOptions};
use serde_json::{Value, json};

use crate::talk::{Page, request_trace, served};

/// A ring that nothing goes out of.
const RING: &str = r#"{ "palpate": 1, "dimension": 2,
    "bodies": [ { "name": "ring", "shape": { "shell": 0.02, "of": { "ball": { "radius": 0.1 } } },
                  "material": { "stiffness": 300, "damping": 0 } } ] }"#;

/// A moment of the servo in the plane.
#[derive(Debug)]
struct Moment {
    is_lifted: bool,
    is_replaying: bool,
    ticks: u64,
    /// The largest force since the last one [N].
    force: f32,
    device: [f32; 2],
    proxy: [f32; 2],
    push: [f32; 2],
}

impl Moment {
    fn is_at(&self, place: [f32; 2]) -> bool {
        (self.device[0] - place[0]).hypot(self.device[1] - place[1]) < 0.01
    }
}

fn moment(page: &mut Page) -> Moment {
    let frame = page.binary(1);
    let number = |at: usize| f32::from_le_bytes(frame[at..at + 4].try_into().unwrap());
    Moment {
        is_lifted: frame[3] & 64 != 0,
        is_replaying: frame[3] & 32 != 0,
        ticks: u64::from_le_bytes(frame[8..16].try_into().unwrap()),
        force: number(24),
        device: [number(64), number(68)],
        proxy: [number(76), number(80)],
        push: [number(88), number(92)],
    }
}

fn ring() -> (Live, Page) {
    opened(RING)
}

fn opened(scene: &str) -> (Live, Page) {
    let live = Live::start("scene", None, scene, LiveOptions::default()).unwrap();
    let mut page = Page::open(&live);
    page.ask(json!({ "do": "tour", "on": false }));
    (live, page)
}

fn press(page: &mut Page, target: Value) {
    let done = page.ask(json!({ "do": "hand", "held": true, "target": target }));
    assert_eq!(done["do"], "done", "{done}");
}

/// It was once drawn across bodies with all the force that there is.
#[test]
fn a_hand_that_is_led_far_is_lifted_and_feels_nothing_on_the_way() {
    let (_live, mut page) = ring();
    for place in [[0.0, 0.0], [0.3, 0.0], [0.01, 0.02], [0.0, -0.2]] {
        press(&mut page, json!(place));
        let place = place.map(|x| x as f32);
        let mut was_lifted = false;
        loop {
            let now = moment(&mut page);
            was_lifted |= now.is_lifted;
            assert!(now.force < 1e-3, "{now:?} on the way to {place:?}");
            if !now.is_lifted && now.is_at(place) {
                break;
            }
        }
        assert!(was_lifted);
        let now = moment(&mut page);
        assert_eq!(now.device, now.proxy);
        page.ask(json!({ "do": "hand", "held": false }));
    }
}

#[test]
fn a_hand_that_is_led_into_a_body_is_set_down_before_it() {
    let (_live, mut page) = ring();
    press(&mut page, json!([0.105, 0.0]));
    let pressed = loop {
        let now = moment(&mut page);
        if !now.is_lifted && now.push[0] > 0.5 {
            break now;
        }
    };
    // From outside, from where the target is nearest.
    let out = pressed.proxy[0].hypot(pressed.proxy[1]);
    assert!(out > 0.109, "{pressed:?}");
    // A step to the other side of the wall while it is held is a press, not a way there.
    press(&mut page, json!([0.085, 0.0]));
    for _ in 0..30 {
        let now = moment(&mut page);
        assert!(!now.is_lifted && now.proxy[0].hypot(now.proxy[1]) > 0.109, "{now:?}");
    }
}

/// In the middle of a smooth union the gradient vanishes: the hand once was set down far away.
#[test]
fn a_hand_that_is_led_to_the_middle_of_a_body_stays_near() {
    let disk = |x: f64| json!({ "translate": [x, 0], "of": { "circle": { "radius": 0.05 } } });
    let shape = json!({ "smooth_union": [disk(-0.03), disk(0.03)], "width": 0.02 });
    let scene =
        json!({ "palpate": 1, "dimension": 2, "bodies": [{ "name": "two", "shape": shape }] });
    let (_live, mut page) = opened(&scene.to_string());
    press(&mut page, json!([1e-7, 1e-4]));
    while !moment(&mut page).is_lifted {}
    page.ask(json!({ "do": "hand", "held": false }));
    while moment(&mut page).is_lifted {}
    let now = moment(&mut page);
    assert!(now.device[0].hypot(now.device[1]) < 0.2, "{now:?}");
}

/// A body that moved onto the hand once pushed it with no force, as forces waited for it to be out.
#[test]
fn a_body_that_moves_onto_the_hand_is_felt() {
    let scene = json!({
        "palpate": 1, "dimension": 2,
        "bodies": [{ "name": "disk", "shape": { "circle": { "radius": 0.05 } } }],
        "motions": [{ "body": "disk", "from": { "translation": [-0.1, 0] },
                      "to": { "translation": [0.02, 0] }, "duration": 2, "repeat": "back_and_forth" }],
    });
    let (_live, mut page) = opened(&scene.to_string());
    press(&mut page, json!([0.06, 0.001]));
    while moment(&mut page).force < 0.2 {}
}

/// A released click once left the hand wherever it was on its way.
#[test]
fn a_hand_that_is_let_go_while_it_is_lifted_is_set_down_where_it_was_brought() {
    let (_live, mut page) = ring();
    press(&mut page, json!([0.0, 0.0]));
    page.ask(json!({ "do": "hand", "held": false }));
    let mut now = moment(&mut page);
    while !now.is_at([0.0, 0.0]) || now.is_lifted {
        now = moment(&mut page);
        assert!(now.force < 1e-3, "{now:?}");
    }
}

/// Guides once began the servo anew.
#[test]
fn guides_are_handed_to_the_servo() {
    let (_live, mut page) = ring();
    press(&mut page, json!([0.0, 0.0]));
    while !moment(&mut page).is_at([0.0, 0.0]) {}
    let before = moment(&mut page).ticks;
    let guide = json!([{ "point": [0.03, 0.0], "stiffness": 100 }]);
    page.say(&json!({
        "do": "edit", "base": 1, "changes": [{ "at": "/guides", "to": guide }],
    }));
    let scene = page.text(|message| message["do"] == "scene");
    assert_eq!(scene["restarted"], Value::Null);
    let pulled = loop {
        let now = moment(&mut page);
        if now.push[0] > 0.5 {
            break now;
        }
    };
    assert!(pulled.ticks > before, "the servo goes on");
    page.say(&json!({ "do": "undo" }));
    page.text(|message| message["do"] == "scene");
    while moment(&mut page).push[0] > 0.0 {}
}

/// A plate that grew by 10 µm once dropped its force to zero, and let the hand sink in.
#[test]
fn an_edit_under_the_hand_keeps_the_touch() {
    let plate = |height: f64| json!({ "cuboid": { "size": [0.1, height] } });
    let scene = json!({
        "palpate": 1, "dimension": 2,
        "bodies": [{ "name": "plate", "shape": plate(0.02), "pose": { "translation": [0, -0.01] },
                     "material": { "stiffness": 300, "damping": 0 } }],
    });
    let (_live, mut page) = opened(&scene.to_string());
    press(&mut page, json!([0.0, 0.01]));
    while !moment(&mut page).is_at([0.0, 0.01]) {}
    press(&mut page, json!([0.0, -0.01]));
    let rests = |page: &mut Page| {
        let mut before = moment(page);
        loop {
            (0..10).for_each(|_| _ = moment(page));
            let now = moment(page);
            if now.push[1] > 0.5 && (now.push[1] - before.push[1]).abs() < 1e-3 {
                return now;
            }
            before = now;
        }
    };
    let before = rests(&mut page);
    page.say(&json!({
        "do": "edit", "base": 1,
        "changes": [{ "at": "/bodies/0/shape", "to": plate(0.02002) }],
    }));
    let carried = page.text(|message| message["events"][0]["kind"] == "carried");
    let distance = carried["events"][0]["distance"].as_f64().unwrap();
    assert!((distance - 1e-5).abs() < 1e-7, "{carried}");
    for _ in 0..30 {
        let now = moment(&mut page);
        assert!((now.push[1] - before.push[1]).abs() < 0.05, "{now:?} after {before:?}");
    }
}

/// A trace of a hand that was held in a body once led it there through the body.
#[test]
fn a_replay_that_begins_in_a_body_presses_as_it_did() {
    let (live, mut page) = ring();
    let trace = "time_s,x_m,y_m\n0,0.105,0\n0.3,0.1,0\n0.6,0.2,0\n";
    assert!(request_trace(&live, "POST", trace).starts_with("HTTP/1.1 204"));
    assert_eq!(page.ask(json!({ "do": "replay", "on": true }))["do"], "done");
    let mut hardest = 0.0_f32;
    loop {
        let now = moment(&mut page);
        hardest = hardest.max(now.push[0]);
        if !now.is_lifted && now.is_at([0.2, 0.0]) {
            break;
        }
    }
    // It is 10 mm deep at most.
    assert!((0.5..3.0).contains(&hardest), "{hardest} N");
}

/// A clock that was held and then stepped far once skipped what was replayed.
#[test]
fn a_replay_by_steps_of_a_held_clock_skips_nothing() {
    let (live, mut page) = ring();
    let trace = "time_s,x_m,y_m\n0,0.2,0\n0.1,0.2,0.1\n0.2,0.2,-0.1\n0.3,0.2,0\n";
    assert!(request_trace(&live, "POST", trace).starts_with("HTTP/1.1 204"));
    page.ask(json!({ "do": "clock", "speed": 0 }));
    assert_eq!(page.ask(json!({ "do": "replay", "on": true }))["do"], "done");
    // Frames of a held clock come only where they differ from the last one: this one does.
    while !moment(&mut page).is_replaying {}
    page.ask(json!({ "do": "clock", "speed": 0, "step": 1500 }));
    let (mut lowest, mut highest) = (0.0_f32, 0.0_f32);
    loop {
        let now = moment(&mut page);
        (lowest, highest) = (lowest.min(now.device[1]), highest.max(now.device[1]));
        if !now.is_replaying {
            break;
        }
    }
    assert!(lowest < -0.09 && highest > 0.09, "from {lowest} m to {highest} m");
}

/// An edit of the tool once threw away what was recorded, and said nothing.
#[test]
fn a_recording_outlives_its_servo() {
    let live = served(LiveOptions::default());
    let mut page = Page::open(&live);
    page.ask(json!({ "do": "record", "on": true }));
    let told = page.text(|message| message["do"] == "recording" && message["rows"] != 0);
    assert_eq!(told["is_on"], true);
    let tool = json!({ "radius": 0.004 });
    page.say(&json!({ "do": "edit", "base": 1, "changes": [{ "at": "/tool", "to": tool }] }));
    let notice = page.text(|message| message["do"] == "notice");
    let words = notice["message"].as_str().unwrap();
    assert!(words.starts_with("another servo began: the recording ended with "), "{words}");
    let ended = page.text(|message| message["do"] == "recording" && message["is_on"] == false);
    let answer = request_trace(&live, "GET", "");
    let (_, trace) = answer.split_once("\r\n\r\n").unwrap();
    // The first line is the head.
    assert_eq!(trace.lines().count() as u64 - 1, ended["rows"].as_u64().unwrap());
}

#[test]
fn a_tour_waits_while_forces_are_stopped() {
    let (_live, mut page) = ring();
    page.ask(json!({ "do": "tour", "on": true }));
    // How far the device goes in half a second of ticks.
    let way = |page: &mut Page| {
        let begin = moment(page);
        loop {
            let now = moment(page);
            if now.ticks >= begin.ticks + 500 {
                return (now.device[0] - begin.device[0])
                    .hypot(now.device[1] - begin.device[1]);
            }
        }
    };
    while way(&mut page) < 2e-3 {}
    page.ask(json!({ "do": "stop" }));
    // The device comes to where the tour waits.
    while way(&mut page) > 1e-4 {}
    assert!(way(&mut page) < 1e-4, "the tour goes on");
    page.release(1);
    while way(&mut page) < 2e-3 {}
}

/// The way of a hand that was lifted leads through bodies.
#[test]
fn a_replay_lifts_the_hand_where_it_was_lifted() {
    let (live, mut page) = ring();
    let trace = "time_s,x_m,y_m,lifted\n0,0.2,0,false\n0.1,0.2,0,true\n0.3,0,0,true\n\
                 0.4,0,0,false\n1,0,0,false\n";
    assert!(request_trace(&live, "POST", trace).starts_with("HTTP/1.1 204"));
    assert_eq!(page.ask(json!({ "do": "replay", "on": true }))["do"], "done");
    let (mut hardest, mut was_outside) = (0.0_f32, false);
    loop {
        let now = moment(&mut page);
        hardest = hardest.max(now.force);
        was_outside |= now.is_at([0.2, 0.0]);
        if was_outside && !now.is_lifted && now.is_at([0.0, 0.0]) {
            break;
        }
    }
    assert!(hardest < 0.05, "{hardest} N");
}
