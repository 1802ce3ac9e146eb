//! Files, history and predictions of models with effects.

use jiff::Timestamp;
use nalgebra::{Isometry3, Vector3};
use plumbline_model::robot::Rig;

use super::*;

pub(super) const TIP: &str = "right_index_tip";

pub(super) fn nico() -> Rig {
    Rig::built_in("nico").expect("comes with the program")
}

pub(super) fn effect(id: &str, site: &str, values: &[f64]) -> ModelEffect {
    ModelEffect {
        id: id.to_owned(),
        site: site.to_owned(),
        title: String::new(),
        tip: Some(TIP.to_owned()),
        shape: None,
        reference_s: 0.0,
        values: values.to_vec(),
        covariance: vec![],
        probability: Some(0.97),
        parameters: vec![],
    }
}

fn addition(effects: Vec<ModelEffect>) -> Addition {
    Addition {
        effects,
        screens: vec![],
        externals: vec![],
        eyes: vec![],
        together: vec![],
        replaces: false,
        at: Timestamp::UNIX_EPOCH,
        sentence: "The elbow's zero is off.".to_owned(),
        sessions: vec!["morning".to_owned()],
        version: "0.1.0".to_owned(),
        gap: Some(StepGap {
            unit: "m".to_owned(),
            rows: 49,
            before: 6.7e-3,
            after: 3.6e-3,
            floor: 3.0e-3,
            closure: Some(0.84),
            closure_range: Some([0.7, 0.9]),
        }),
    }
}

/// The model with these effects.
pub(super) fn with(rig: &Rig, effects: Vec<ModelEffect>) -> RigModel {
    let mut model = RigModel::nominal(rig);
    model.add(rig, addition(effects)).expect("fits");
    model
}

fn elbow(rig: &Rig) -> RigModel {
    let mut model = RigModel::nominal(rig);
    let motion = Isometry3::new(Vector3::new(0.01, -0.002, 0.003), Vector3::new(0.01, 0.0, 0.1));
    let screens = vec![PlacedScreen::moved("morning", &rig.touchscreen, &motion)];
    let externals = vec![PlacedExternal {
        session: "tracker".to_owned(),
        frame: Some("hall".to_owned()),
        external_from_robot: motion,
        tip_from_marker: motion.inverse(),
    }];
    let zero = ModelEffect {
        covariance: vec![1e-6],
        parameters: vec![ReportedParameter {
            name: "offset_rad".to_owned(),
            value: 0.031,
            low: 0.028,
            high: 0.034,
            text: None,
        }],
        ..effect("joint-zero", "r_elbow_y", &[0.031])
    };
    model.add(rig, Addition { screens, externals, ..addition(vec![zero]) }).expect("fits");
    model
}

#[test]
fn every_number_of_the_history_is_one() {
    let (rig, folder) = (nico(), tempfile::tempdir().expect("temporary folder"));
    let file = folder.path().join("model.toml");
    let spoil: [fn(&mut StepGap, f64); 5] = [
        |gap, bad| gap.before = bad,
        |gap, bad| gap.after = bad,
        |gap, bad| gap.floor = bad,
        |gap, bad| gap.closure = Some(bad),
        |gap, bad| gap.closure_range = Some([0.7, bad]),
    ];
    for spoil in spoil {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut model = elbow(&rig);
            spoil(model.history[0].gap.as_mut().expect("it has one"), bad);
            let said = model.write(&file, &rig).expect_err("it could not be read again").to_string();
            assert!(said.contains("a gap of its history holds"), "{said}");
            assert!(!file.exists());
        }
    }
}

#[test]
fn what_is_written_is_read_again() {
    let (rig, folder) = (nico(), tempfile::tempdir().expect("temporary folder"));
    let file = folder.path().join("model.toml");
    let mut model = elbow(&rig);
    model.remove("joint-zero", "r_elbow_y", Timestamp::UNIX_EPOCH).expect("there");
    model.undo(Timestamp::UNIX_EPOCH).expect("a step");
    for model in [RigModel::nominal(&rig), model] {
        model.write(&file, &rig).expect("written");
        let read = RigModel::read(&file, &rig).expect("read");
        assert_eq!(read.effects(), model.effects());
        assert_eq!(read.contents.externals, model.contents.externals);
        assert_eq!(read.history.len(), model.history.len());
        for (read, written) in read.contents.screens.iter().zip(&model.contents.screens) {
            let corners = read.screen.corners().into_iter().zip(written.screen.corners());
            assert!(corners.into_iter().all(|(a, b)| a.distance_m(&b) < 1e-12));
            assert!(read.is_of(&rig.touchscreen));
        }
    }
    let left: Vec<_> = std::fs::read_dir(folder.path()).expect("a folder").collect();
    assert_eq!(left.len(), 1, "no temporary file is left");
}

/// As the first format was written.
const FORMAT_1: &str = r#"rig_model = 1
rig = "nico"

[[present.effects]]
id = "joint-zero"
site = "r_elbow_y"
tip = "right_index_tip"
values = [0.031]

[[history]]
kind = "added"
at = "2026-09-14T11:04:00Z"
effects = ["joint-zero@r_elbow_y"]
[history.gap]
unit = "mm"
rows = 49
before = 6.7
after = 3.6
floor = 3.0
closure = 0.84

[[history]]
kind = "added"
at = "2026-09-15T11:04:00Z"
effects = ["camera-mount@eyes"]
[history.gap]
unit = "px"
rows = 49
before = 2.3
after = 0.4
floor = 0.3
"#;

#[test]
fn gaps_of_the_first_format_become_meters() {
    let (rig, folder) = (nico(), tempfile::tempdir().expect("temporary folder"));
    let file = folder.path().join("model.toml");
    std::fs::write(&file, FORMAT_1).expect("writable");
    let old = RigModel::read(&file, &rig).expect("an old file is read");
    old.write(&file, &rig).expect("written");
    assert!(std::fs::read_to_string(&file).expect("readable").contains("rig_model = 2"));
    for model in [&old, &RigModel::read(&file, &rig).expect("of today's format")] {
        assert_eq!(model.effects().len(), 1);
        let gaps: Vec<&StepGap> = model.history.iter().filter_map(|step| step.gap.as_ref()).collect();
        assert_eq!((gaps[0].unit.as_str(), gaps[1].unit.as_str()), ("m", "px"));
        for (found, length_m) in [(gaps[0].before, 6.7e-3), (gaps[0].after, 3.6e-3), (gaps[0].floor, 3e-3)] {
            assert!((found - length_m).abs() < 1e-12, "{found} for {length_m}");
        }
        assert_eq!([gaps[1].before, gaps[1].after, gaps[1].floor], [2.3, 0.4, 0.3]);
    }
}

#[test]
fn what_was_taken_back_is_put_back_until_something_else_is_changed() {
    let rig = nico();
    let mut model = elbow(&rig);
    let first = model.clone();
    assert!(!model.can_redo());
    model.add(&rig, addition(vec![effect("joint-sag", "r_arm_x", &[0.01])])).expect("fits");
    let second = model.contents.clone();
    for _ in 0..2 {
        // Taken back in two steps and put back in two, as often as anybody likes.
        model.undo(Timestamp::UNIX_EPOCH).expect("a step");
        model.undo(Timestamp::UNIX_EPOCH).expect("a step");
        assert!(model.is_nominal() && model.can_redo());
        model.redo().expect("taken back");
        assert_eq!((&model.contents, model.can_redo()), (&first.contents, true));
        model.redo().expect("taken back");
        assert_eq!((&model.contents, model.can_redo()), (&second, false));
        assert!(model.history[..2].iter().all(Step::can_be_undone));
    }
    // What was put back is taken back in the same order.
    model.undo(Timestamp::UNIX_EPOCH).expect("a step");
    assert_eq!(model.contents, first.contents);
    model.add(&rig, addition(vec![effect("joint-sag", "r_arm_x", &[0.02])])).expect("fits");
    let why = model.redo().expect_err("something else was added since").to_string();
    assert!(why.contains("changed since") && !model.can_redo(), "{why}");
}

#[test]
fn taking_back_restores_what_was_in_force() {
    let rig = nico();
    let mut model = elbow(&rig);
    let first = model.contents.clone();
    model.add(&rig, addition(vec![effect("joint-sag", "r_arm_x", &[0.01])])).expect("fits");
    let second = model.contents.clone();
    model.remove("joint-zero", "r_elbow_y", Timestamp::UNIX_EPOCH).expect("there");
    assert_eq!(model.effects().len(), 1);
    model.undo(Timestamp::UNIX_EPOCH).expect("a step");
    assert_eq!(model.contents, second);
    model.undo(Timestamp::UNIX_EPOCH).expect("a step");
    assert_eq!(model.contents, first);
    model.undo(Timestamp::UNIX_EPOCH).expect("a step");
    assert!(model.is_nominal() && !model.can_undo());
    assert!(model.undo(Timestamp::UNIX_EPOCH).expect_err("none left").to_string().contains("no step left"));
    assert_eq!(model.history.len(), 6, "taking back is a step, too");
    assert_eq!(model.history.iter().filter(|step| step.kind == StepKind::Undone).count(), 3);
}

#[test]
fn what_a_search_from_the_nominal_robot_found_replaces_what_was_there() {
    let rig = nico();
    let mut model = elbow(&rig);
    let anew = Addition { replaces: true, ..addition(vec![effect("backlash", "r_elbow_y", &[0.004])]) };
    model.add(&rig, anew).expect("fits");
    assert_eq!(model.effects().iter().map(ModelEffect::name).collect::<Vec<_>>(), ["backlash@r_elbow_y"]);
    assert!(model.contents.screens.is_empty());
}

#[test]
fn taking_the_last_effect_out_leaves_the_nominal_robot() {
    let rig = nico();
    let mut model = elbow(&rig);
    let error = model.remove("joint-sag", "r_elbow_y", Timestamp::UNIX_EPOCH).expect_err("not there");
    assert!(error.to_string().contains("In the model: joint-zero@r_elbow_y"), "{error}");
    model.remove("joint-zero", "r_elbow_y", Timestamp::UNIX_EPOCH).expect("there");
    assert_eq!(model.contents, Contents::default());
}

#[test]
fn a_probability_is_between_zero_and_one() {
    let rig = nico();
    for (share, is_one) in
        [(0.0, true), (1.0, true), (1.5, false), (-0.1, false), (f64::INFINITY, false), (f64::NAN, false)]
    {
        let found = ModelEffect { probability: Some(share), ..effect("joint-zero", "r_elbow_y", &[0.01]) };
        let added = elbow(&rig).add(&rig, Addition { replaces: true, ..addition(vec![found]) });
        assert_eq!(added.is_ok(), is_one, "{share}: {added:?}");
    }
}

#[test]
fn what_cannot_be_added_changes_nothing() {
    let rig = nico();
    let mut model = elbow(&rig);
    let before = model.clone();
    for (effect, said) in [
        (effect("joint-magic", "r_elbow_y", &[0.1]), "does not know"),
        (effect("joint-zero", "r_toe", &[0.1]), "no such place"),
        (effect("joint-zero", "r_elbow_y", &[0.1, 0.2]), "2 values instead of 1"),
        (effect("joint-zero", "r_elbow_y", &[f64::NAN]), "holds NaN"),
        (ModelEffect { tip: Some("toe".into()), ..effect("joint-zero", "r_elbow_y", &[0.1]) }, "toe"),
    ] {
        let error = model.add(&rig, addition(vec![effect])).expect_err("refused").to_string();
        assert!(error.contains(said), "{error}");
    }
    assert!(model.add(&rig, addition(vec![])).expect_err("nothing").to_string().contains("at least one"));
    assert_eq!(model, before);
}

#[test]
fn files_that_are_none_are_refused_with_words() {
    let (rig, folder) = (nico(), tempfile::tempdir().expect("temporary folder"));
    let file = folder.path().join("model.toml");
    let good = elbow(&rig).to_toml(&file, &rig).expect("text");
    for (text, said) in [
        (good.replace("rig = \"nico\"", "rig = \"icub\""), "belongs to the robot \"icub\", not to \"nico\""),
        (good.replace("rig_model = 2", "rig_model = 7"), "has format 7, this program reads 2"),
        (good.replace("rig_model = 2", "format = 1"), "no key rig_model"),
        (good.replace("joint-zero", "joint-magic"), "a newer version of the program"),
        (good.replace("r_elbow_y", "r_elbow_q"), "search the gap again"),
        (good.replace("values = [0.031]", "values = []"), "0 values instead of 1"),
        (good.replace("values = [0.031]", "values = [inf]"), "holds inf"),
        (good.replace("values = [0.031]", "values = [31.0]"), "where robots have about"),
        (good.replace("width_m = 0.475", "width_m = 475.0"), "it looks like millimeters"),
        (good.replace("rig = \"nico\"", &format!("a = {}", "[".repeat(20_000))), "levels deep"),
        (good.replace("quaternion_xyzw = [", "quaternion_xyzw = [3.0, 0.0, 0.0, 0.0] #"), "length 1"),
        (good.replace("width_px = 1920", "width_px = 0"), "no size"),
        (good[..good.len() / 2].to_owned(), "is no model with effects"),
        (String::new(), "no key rig_model"),
        ("{\"rig_model\": 1}".to_owned(), "not TOML"),
        (good.replace("[[present.effects]]", "[[present.effects]]\nmood = 1"), "mood"),
    ] {
        assert_ne!(text, good, "{said}");
        std::fs::write(&file, text).expect("written");
        let error = RigModel::read(&file, &rig).expect_err(said).to_string();
        assert!(error.contains(said), "{error} instead of {said}");
    }
    std::fs::write(&file, [0xff, 0xfe, 0x00]).expect("written");
    assert!(RigModel::read(&file, &rig).expect_err("no text").to_string().contains("no text"));
    let missing = RigModel::read(&folder.path().join("none.toml"), &rig).expect_err("missing");
    assert!(missing.to_string().contains("check that the file exists"), "{missing}");
}
