//! No pane of the gap names a joint, a link or an effect by its id, in no state: those are for files and for the command
//! line. What the other screens show is looked at in `spoken`.

use std::collections::BTreeSet;

use egui_kittest::kittest::Queryable as _;
use plumbline::{PlumblineWindow, Screen, WindowSettings};
use plumbline_engine::View;
use plumbline_engine::gap::sample;

use crate::fake::Fake;
use crate::layout::lines;
use crate::{made_up, made_up_gap};

/// Ids of effects that are no words of their own, as `plumbline gap --json` writes them.
const EFFECTS: [&str; 38] = [
    "joint-zero",
    "joint-scale",
    "joint-eccentricity",
    "tooth-ripple",
    "gravity-backlash",
    "servo-droop",
    "joint-sag",
    "sideways-give",
    "link-bending",
    "early-log",
    "torque-limit",
    "servo-warm-up",
    "slipped-horn",
    "joint-coupling",
    "axis-skew",
    "link-length",
    "tip-offset",
    "finger-bend",
    "finger-roll",
    "touch-drag",
    "base-tilt",
    "torso-lean",
    "payload-mass",
    "screen-bumped",
    "screen-scale",
    "screen-tilt",
    "screen-bow",
    "panel-edge",
    "camera-mount",
    "head-joint",
    "eye-yaw",
    "image-shift",
    "focal-or-baseline",
    "eye-roll",
    "lens-distortion",
    "disparity-steps",
    "background-bleed",
    "eye-latency",
];

/// Ids of joints and links that are no plain words.
fn ids_of_the_robot() -> BTreeSet<String> {
    let rig = made_up::rig();
    let joints = rig.description.joints().iter().map(|joint| joint.name.clone());
    let links = rig.description.links().iter().map(|link| link.name.clone());
    joints.chain(links).filter(|name| name.contains('_')).collect()
}

/// Ids in a text that people read.
fn raw_in(text: &str, of_robot: &BTreeSet<String>) -> Vec<String> {
    let is_part = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '@');
    let words = text.split(|c: char| !is_part(c)).filter(|word| !word.is_empty());
    let is_raw = |word: &&str| word.contains('@') || of_robot.contains(*word) || EFFECTS.contains(word);
    words.filter(is_raw).map(str::to_owned).collect()
}

fn found_in(
    window: &egui_kittest::Harness<'static, PlumblineWindow>,
    of_robot: &BTreeSet<String>,
) -> Vec<String> {
    let all = lines(window);
    assert!(all.len() > 10, "the screen draws texts");
    let raw = |text: &str| raw_in(text, of_robot).first().map(|id| format!("{id} in {text:?}"));
    all.iter().filter_map(|line| raw(&line.text)).collect()
}

#[test]
fn an_id_is_told_from_words() {
    let of_robot = ids_of_the_robot();
    for raw in ["head_z stands off", "Runner-up: link-length@r_lower_arm.", "joint-zero", "r_elbow_y: play"] {
        assert!(!raw_in(raw, &of_robot).is_empty(), "{raw}");
    }
    for words in ["Head left–right stands off", "link length of the lower arm", "2026-09-14T10-20-00_touch"]
    {
        assert_eq!(raw_in(words, &of_robot), Vec::<String>::new());
    }
}

#[test]
fn no_pane_of_the_gap_shows_an_id() {
    let of_robot = ids_of_the_robot();
    let findings = [sample::named(), sample::class(), sample::not_in_library(), sample::pixels()];
    let views: Vec<View> = findings
        .into_iter()
        .map(|finding| made_up_gap::with(made_up_gap::found(finding)))
        .chain([made_up_gap::with(made_up_gap::added()), made_up_gap::proven(0.001_2)])
        .collect();
    let mut found = vec![];
    for view in views {
        let settings = WindowSettings { screen: Screen::Gap, ..WindowSettings::default() };
        let mut window = Fake::over(view).window_of_size(settings, [1440.0, 1700.0]);
        for tab in ["Compare", "Name and add", "Candidates", "Before and after", "Next experiment", "History"]
        {
            // The rail has a *Compare* too, of the eyes.
            window.get_all_by_label(tab).last().expect("a tab").click();
            window.run_steps(3);
            found.extend(found_in(&window, &of_robot).into_iter().map(|raw| format!("{tab}: {raw}")));
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}
