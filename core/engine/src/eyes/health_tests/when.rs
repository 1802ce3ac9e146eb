//! When a calibration was judged, and what has come since.

use std::sync::Arc;
use std::time::Duration;

use plumbline_effects::RobotModel;
use plumbline_hardware::SourceSpec;
use plumbline_model::robot::default_rig;

use super::{Desk, dark, held_still, seen};
use crate::eyes::command::EyesCommand;
use crate::eyes::view::{DriftTold, Drifted, HealthState};
use crate::source::view::{ReplayView, SourceView};

/// A watch says that far places are off by so much.
fn drifted(watch: u64, model: &Arc<RobotModel>, far_m: f64) -> Option<Drifted> {
    let off_m = [[0.0, 0.0], [0.0, 0.0], [far_m, 0.0]];
    Some(Drifted { watch, told: DriftTold::Off { model: model.clone(), off_m } })
}

fn model() -> Arc<RobotModel> {
    Arc::new(RobotModel::nominal(default_rig()))
}

#[test]
fn what_was_judged_says_when_and_how_far_places_have_moved_since() {
    let mut desk = Desk::new(0.0);
    desk.around.twin_on_s = Some(120.0);
    let model = model();
    desk.around.drifted = drifted(1, &model, 0.02);
    desk.ask(EyesCommand::JudgeHealth);
    desk.until_judging();
    let asked_at = desk.time.day;
    desk.looks_bad();
    let when = |desk: &mut Desk| desk.view().health.when.expect("it was judged");
    let first = when(&mut desk);
    assert_eq!((first.at, first.is_cold(), first.moved_too_far_m()), (asked_at, Some(true), None));
    // Of the same watch only what has come since counts.
    desk.around.drifted = drifted(1, &model, 0.083);
    let moved_m = when(&mut desk).moved_too_far_m().expect("it has moved");
    assert!((moved_m - 0.063).abs() < 1e-12, "{moved_m}");
    // A watch that began later began with nothing moved.
    desk.around.drifted = drifted(2, &model, 0.012);
    assert_eq!(when(&mut desk).moved_too_far_m(), Some(0.012));
    desk.around.drifted = drifted(2, &model, 0.004);
    assert_eq!(when(&mut desk).moved_too_far_m(), None, "a grasp bears that");
    // What another model tells is not compared.
    desk.around.drifted = drifted(1, &self::model(), 0.083);
    assert_eq!(when(&mut desk).moved_m, None);
    desk.around.drifted = None;
    assert_eq!(when(&mut desk).moved_m, None, "it is not watched");
}

/// Calibrated cold, judged cold, and warm by now: that it held says nothing of now.
#[test]
fn what_was_judged_with_cold_eyes_does_not_stand_when_they_are_warm() {
    let mut desk = Desk::new(0.0);
    desk.calibrated_after(1.0);
    desk.around.twin_on_s = Some(120.0);
    desk.ask(EyesCommand::JudgeHealth);
    desk.until_judging();
    desk.looks_bad();
    let is_outdated = |desk: &mut Desk, on_s: f64| {
        desk.around.twin_on_s = Some(on_s);
        desk.view().health.when.expect("it was judged").is_outdated(desk.time.day)
    };
    assert_eq!([125.0, 160.0, 840.0].map(|on_s| is_outdated(&mut desk, on_s)), [false, false, true]);
}

#[test]
fn what_had_moved_before_it_was_judged_is_no_motion_since_although_it_was_just_being_told_anew() {
    for (told, moved_m) in [(DriftTold::Anew, None), (DriftTold::Nothing, Some([0.0, 0.0, 0.05]))] {
        let mut desk = Desk::new(0.0);
        let model = model();
        desk.around.drifted = Some(Drifted { watch: 1, told });
        desk.ask(EyesCommand::JudgeHealth);
        desk.until_judging();
        desk.looks_bad();
        let when = |desk: &mut Desk| desk.view().health.when.expect("it was judged");
        assert_eq!(when(&mut desk).moved_m, None, "nothing is told yet");
        desk.around.drifted = drifted(1, &model, 0.05);
        assert_eq!(when(&mut desk).moved_m, moved_m);
    }
}

#[test]
fn what_a_recording_shows_is_not_told_of_the_eyes_and_what_moved_there_has_not_moved_here() {
    let mut desk = Desk::new(0.0);
    desk.health();
    let live = desk.around.source.clone();
    let is_told = |desk: &mut Desk| desk.view().health.judged.is_some();
    // A recording is watched whose eyes had moved.
    desk.source(|source| {
        source.opened = 2;
        source.spec = Some(SourceSpec::Recording { file: "log.mcap".into(), of_twin: false });
        source.replay = Some(ReplayView { playing: true, ..held_still() });
    });
    desk.around.drifted = drifted(1, &model(), 0.08);
    assert!(!is_told(&mut desk), "the eyes of the recording were not judged");
    desk.ask(EyesCommand::JudgeHealth);
    desk.until_judging();
    desk.looks_bad();
    assert!(is_told(&mut desk));
    // It is wound back and watched again: what moves there had moved before.
    desk.around.drifted = drifted(2, &model(), 0.08);
    assert_eq!(desk.view().health.when.expect("it was judged").moved_m, None);
    // Back before the eyes, what the recording showed says nothing of them.
    desk.source(|source| *source = SourceView { opened: 3, ..(*live).clone() });
    assert!(!is_told(&mut desk), "these were judged before the recording");
    assert_eq!(desk.view().health.state, HealthState::NotAsked);
}

#[test]
fn that_places_have_moved_is_not_forgotten_when_the_eyes_are_closed_and_opened_again() {
    let mut desk = Desk::new(0.0);
    let model = model();
    desk.around.drifted = drifted(1, &model, 0.0);
    desk.health();
    let moved_m = |desk: &mut Desk| desk.view().health.when.expect("it was judged").moved_too_far_m();
    desk.around.drifted = drifted(1, &model, 0.05);
    desk.see(dark());
    let live = desk.around.source.clone();
    desk.around.drifted = None;
    desk.source(|source| *source = SourceView { opened: 2, spec: None, ..(*live).clone() });
    assert_eq!(moved_m(&mut desk), Some(0.05), "they were closed");
    // Opened again, nothing is watched yet, and then from the start.
    desk.source(|source| *source = SourceView { opened: 3, ..(*live).clone() });
    assert_eq!(moved_m(&mut desk), Some(0.05), "nothing is watched");
    for (far_m, moved) in [(0.004, 0.05), (0.06, 0.06), (0.001, 0.05)] {
        desk.around.drifted = drifted(2, &model, far_m);
        desk.see(dark());
        assert_eq!(moved_m(&mut desk), Some(moved));
    }
    // Judged anew, nothing has moved since.
    desk.health();
    assert_eq!(moved_m(&mut desk), None);
}

#[test]
fn a_proposal_that_was_judged_before_places_moved_is_judged_again_and_said_to_be_to_be() {
    let mut desk = Desk::new(0.0);
    let model = model();
    desk.around.is_watched = true;
    desk.around.drifted = drifted(1, &model, 0.0);
    desk.see(seen());
    desk.propose(0.6);
    desk.until_judging_with(&seen());
    desk.end_judging();
    assert!(
        !desk.accepts() && desk.said().iter().any(|text| text.contains("Discard it")),
        "{:?}",
        desk.said()
    );
    (0..60).for_each(|_| desk.see(seen()));
    assert!(desk.started.is_empty(), "it stands");
    desk.around.drifted = drifted(1, &model, 0.04);
    assert!(!desk.accepts());
    assert!(desk.said().iter().any(|text| text.contains("judge it again")), "{:?}", desk.said());
    // Nobody has to ask.
    desk.until_judging_with(&seen());
    desk.end_judging();
    assert!(!desk.view().health.when.expect("judged").is_outdated(desk.time.day));
    assert!(!desk.accepts(), "by how places are now");
    (0..60).for_each(|_| desk.see(seen()));
    assert!(desk.started.is_empty(), "once is enough");
}

#[test]
fn what_was_judged_of_a_proposal_an_hour_ago_is_told_to_be_judged_again() {
    let mut desk = Desk::new(0.0);
    desk.propose(0.6);
    desk.health();
    desk.time = desk.time.after(Duration::from_secs(3600));
    assert!(!desk.accepts());
    assert!(desk.said().iter().any(|text| text.contains("judge it again")), "{:?}", desk.said());
}
