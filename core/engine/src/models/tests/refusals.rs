//! What cannot be learned from, read or used, and the words that say so.

use super::*;
use crate::ground::step::StepState;

/// The session with something changed in one of its files.
fn spoiled(lab: &Lab, file: &str, change: impl FnOnce(String) -> String) -> PathBuf {
    let session = lab.session().join(file);
    let text = std::fs::read_to_string(&session).expect("there");
    std::fs::write(&session, change(text)).expect("written");
    lab.session()
}

/// Keeps the header and these rows (counted from 0).
fn only_rows(text: &str, keep: impl Fn(usize) -> bool) -> String {
    let kept = text.lines().enumerate().filter(|(line, _)| *line == 0 || keep(line - 1));
    kept.map(|(_, line)| format!("{line}\n")).collect()
}

#[test]
fn a_broken_session_is_listed_with_its_problem() {
    let mut lab = Lab::new();
    let broken = lab.path("sessions/2026-05-02T10-00-00_touch");
    std::fs::create_dir_all(&broken).expect("a folder");
    std::fs::write(broken.join("touches.csv"), "u,v\n1,2\n").expect("written");
    std::fs::create_dir_all(lab.path("sessions/eyes")).expect("a folder without touches");
    let sessions = lab.tell(ModelsCommand::ListSessions).sessions.clone();
    assert_eq!(sessions.len(), 2);
    let listed = sessions.iter().find(|session| session.folder == broken).expect("listed");
    assert!(listed.problem.as_ref().is_some_and(|problem| problem.contains("session.toml")), "{listed:?}");
    let view = lab.tell(ModelsCommand::ChooseSession { session: broken });
    let Some(Err(reason)) = &view.data else { panic!("nothing to learn from") };
    assert_eq!(view.next, reason.to_string());
    lab.tell(train(&[Method::M1]));
    assert!(lab.said().contains("session.toml"), "{}", lab.said());
    assert_eq!(lab.view().step, StepState::NotDone);
}

#[test]
fn corners_and_checks_are_listed_but_not_chosen_by_themselves() {
    let folder = tempfile::tempdir().expect("temporary folder");
    for name in ["2026-05-01T10-00-00_touch", "2026-05-03T10-00-00_corners", "2026-05-04T10-00-00_check"] {
        made_up_session(&nico()).write(&folder.path().join("sessions").join(name)).expect("written");
    }
    let mut lab = Lab::on(folder);
    assert_eq!(lab.view().sessions.len(), 3);
    assert_eq!(lab.view().session, Some(lab.session()));
    let check = lab.path("sessions/2026-05-04T10-00-00_check");
    let chosen = lab.tell(ModelsCommand::ChooseSession { session: check.clone() });
    assert!(chosen.session == Some(check) && matches!(chosen.data, Some(Ok(_))), "who asks for it gets it");
}

#[test]
fn sessions_that_nothing_can_be_learned_from_are_refused_with_a_sentence() {
    for (what, change, said) in [
        ("one touch", (|text| only_rows(&text, |row| row == 0)) as fn(String) -> String, "1 of"),
        ("a line", |text| only_rows(&text, |row| row < 9), "lie on a line"),
        ("few", |text| only_rows(&text, |row| row % 5 == 0), "too few to train M3"),
    ] {
        let mut lab = Lab::new();
        spoiled(&lab, "touches.csv", change);
        lab.tell(train(&[Method::M3]));
        assert!(lab.said().contains(said), "{what}: {}", lab.said());
        assert!(lab.view().proposals.is_empty() && !lab.view().training);
    }
    let mut lab = Lab::new();
    spoiled(&lab, "touches.csv", |text| only_rows(&text, |row| row % 5 == 0));
    let view = lab.tell(train(&[Method::M1]));
    assert_eq!(view.proposals.len(), 1, "M1 needs fewer: {}", lab.said());
    assert_eq!(view.comparison.as_ref().map(|comparison| comparison.methods.len()), Some(1));
}

#[test]
fn a_session_of_another_screen_or_robot_is_refused() {
    for (change, said) in [
        ((|text| text.replace("width_m = 0.475", "width_m = 0.6")) as fn(String) -> String, "touchscreen of"),
        (|text| text.replace("rig = \"nico\"", "rig = \"nobody\""), "nobody"),
        (|text| text.replace("width_m = 0.475", "width_m = 0.0"), "width_m"),
    ] {
        let mut lab = Lab::new();
        spoiled(&lab, "session.toml", change);
        lab.tell(train(&[Method::M1]));
        assert!(lab.said().contains(said), "{}", lab.said());
    }
}

#[test]
fn repeated_rows_and_touches_off_the_screen_are_left_out_and_told() {
    let mut lab = Lab::new();
    spoiled(&lab, "touches.csv", |text| {
        let first = text.lines().nth(1).expect("a row").to_owned();
        format!("{text}{first}\n")
    });
    let session = lab.session();
    let view = lab.tell(ModelsCommand::ChooseSession { session });
    let Some(Ok(data)) = &view.data else { panic!("learnable") };
    assert_eq!(data.len(), 63);
    assert!(data.left_out.iter().any(|reason| reason.contains("repeated")), "{:?}", data.left_out);
}

#[test]
fn files_of_wrong_shape_are_refused_with_words() {
    let mut lab = Lab::new();
    for (name, text, said) in [
        ("shape.json", r#"[[[1,2,3],[4,5,6]],[1,2,3],[[1],[2],[3]],[1]]"#, "shapes"),
        ("text.json", "hello", "no JSON"),
        ("other.json", r#"{"a": 1}"#, "shapes"),
        ("empty.onnx", "", "onnx"),
        ("noise.bin", "\u{1}\u{2}\u{3}", "noise.bin"),
    ] {
        let file = lab.path(name);
        std::fs::write(&file, text).expect("written");
        lab.tell(ModelsCommand::Import { file });
        assert!(lab.said().contains(said), "{name}: {}", lab.said());
        assert!(lab.view().proposals.is_empty());
    }
    let file = lab.path("missing.json");
    lab.tell(ModelsCommand::Import { file });
    assert!(lab.said().contains("missing.json"), "{}", lab.said());
}

#[test]
fn models_go_out_and_come_back_unless_they_are_another_screens() {
    let mut lab = Lab::new();
    let trained = lab.tell(train(&[Method::M1, Method::M3]));
    let answer = |view: &ModelsView, method: Method| {
        let model = view.proposals.iter().find(|model| model.method() == method).expect("proposed");
        model.correct(Pixel::new(700.0, 300.0))
    };
    let (json, onnx) = (lab.path("out.json"), lab.path("out.onnx"));
    for (onnx, file) in [(false, &json), (true, &onnx)] {
        lab.tell(ModelsCommand::Export { method: Method::M3, onnx, file: file.clone() });
        assert!(file.is_file(), "{}", lab.said());
    }
    lab.tell(ModelsCommand::Export { method: Method::M1, onnx: true, file: lab.path("m1.onnx") });
    assert!(lab.said().contains("JSON"), "{}", lab.said());
    lab.tell(ModelsCommand::Export { method: Method::M2, onnx: false, file: lab.path("m2.json") });
    assert!(lab.said().contains("no M2"), "{}", lab.said());
    assert!(lab.tell(ModelsCommand::Discard).proposals.is_empty());
    let back = lab.tell(ModelsCommand::Import { file: json.clone() });
    assert_eq!(answer(&back, Method::M3), answer(&trained, Method::M3));
    let back = lab.tell(ModelsCommand::Import { file: onnx });
    let place = |view: &ModelsView| answer(view, Method::M3).target;
    assert!(place(&back).distance_m(&place(&trained)) < 1e-6);
    lab.tell(ModelsCommand::Discard);
    for (from, to, said) in [
        ("\"width_px\":1920", "\"width_px\":1280", "touchscreen of 1280×1080 px"),
        ("\"rig\":\"nico\"", "\"rig\":\"icub\"", "robot \"icub\""),
    ] {
        let text = std::fs::read_to_string(&json).expect("exported");
        assert!(text.contains(from));
        let file = lab.path("other.json");
        std::fs::write(&file, text.replace(from, to)).expect("written");
        lab.tell(ModelsCommand::Import { file });
        assert!(lab.said().contains(said), "{}", lab.said());
        assert!(lab.view().proposals.is_empty());
    }
}

#[test]
fn published_weights_are_used_without_a_border() {
    let mut lab = Lab::new();
    let file = lab.path("weights.json");
    // x = 0.1 + 1e-4 u, y = 0.2 - 1e-4 v, from two units.
    let weights = r#"{"kernel": [[1e-4, 0.0], [0.0, 1e-4]], "bias": [0.0, 0.0],
        "kernel_out": [[1.0, 0.0], [0.0, -1.0]], "bias_out": [0.1, 0.2],
        "input_mean": 0.0, "input_std": 1.0, "output_mean": 0.0, "output_std": 1.0}"#;
    std::fs::write(&file, weights).expect("written");
    lab.tell(ModelsCommand::Import { file });
    let view = lab.tell(ModelsCommand::Accept(Method::M2));
    let model = view.in_use.as_ref().unwrap_or_else(|| panic!("{}", lab.said()));
    let answer = model.correct(Pixel::new(1000.0, 500.0));
    assert!((answer.target.coords.xy() - nalgebra::Point2::new(0.2, 0.15)).norm() < 1e-9, "{answer:?}");
    assert!(!answer.inside);
    let map = view.map.as_ref().expect("a map");
    assert!(map.touches.is_empty() && map.border_m.is_empty());
    assert!(map.sd.values_m.iter().all(Option::is_none) && map.shift.values_m.iter().all(Option::is_some));
}

#[test]
fn what_cannot_be_done_now_is_said() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let mut lab = Lab::on(folder);
    assert!(lab.view().next.contains("Touch the screen first"), "{}", lab.view().next);
    for (command, said) in [
        (train(&[Method::M3]), "Choose a session"),
        (train(&[]), "at least one"),
        (ModelsCommand::Accept(Method::M3), "no M3"),
        (ModelsCommand::UseNone, "No model is in use"),
        (ModelsCommand::Undo, "Nothing was in use"),
    ] {
        lab.tell(command);
        assert!(lab.said().contains(said), "{}", lab.said());
    }
}

#[test]
fn a_damaged_list_of_models_is_told_and_not_written_over() {
    let mut lab = Lab::new();
    lab.tell(train(&[Method::M1]));
    lab.tell(ModelsCommand::Accept(Method::M1));
    let list = lab.path("models/history.json");
    std::fs::write(&list, "{ damaged").expect("written");
    let mut lab = lab.restarted();
    assert!(lab.view().in_use.is_none());
    let notices = lab.whole_view().notices;
    assert!(notices.iter().any(|notice| notice.text.contains("history.json")), "{notices:?}");
    lab.tell(train(&[Method::M1]));
    lab.tell(ModelsCommand::Accept(Method::M1));
    assert!(lab.said().contains("could not be read"), "{}", lab.said());
    assert_eq!(std::fs::read_to_string(&list).expect("there"), "{ damaged");
}
