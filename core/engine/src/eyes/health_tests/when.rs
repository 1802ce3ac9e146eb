//! When a calibration was judged, and what has come since.

use std::sync::Arc;

use plumbline_effects::RobotModel;
use plumbline_model::robot::default_rig;

use super::Desk;
use crate::eyes::command::EyesCommand;
use crate::eyes::view::Drifted;

#[test]
fn what_was_judged_says_when_and_how_far_places_have_moved_since() {
    let mut desk = Desk::new(0.0);
    desk.around.twin_on_s = Some(120.0);
    let model = Arc::new(RobotModel::nominal(default_rig()));
    let drifted = |watch, model: &Arc<RobotModel>, far_m| {
        Some(Drifted { watch, model: model.clone(), off_m: [[0.0, 0.0], [0.0, 0.0], [far_m, 0.0]] })
    };
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
    desk.around.drifted = drifted(1, &Arc::new(RobotModel::nominal(default_rig())), 0.083);
    assert_eq!(when(&mut desk).moved_m, None);
    desk.around.drifted = None;
    assert_eq!(when(&mut desk).moved_m, None, "it is not watched");
}
