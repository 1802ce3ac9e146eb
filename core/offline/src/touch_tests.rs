//! Training, correcting and predicting without a window: what comes out, and what is said to files
//! that cannot be used.
#![allow(clippy::print_stdout, reason = "a skipped test says why")]

use std::path::{Path, PathBuf};

use plumbline_correction::Method;
use plumbline_model::session::{Manifest, names};
use plumbline_model::{Pixel, Unattended, measured_data, place_screen};

use super::*;
#[path = "../../engine/src/models/tests/made_up.rs"]
mod made_up;
#[path = "../../engine/src/rig_models/made_up.rs"]
mod made_up_model;

use made_up::{made_up_session, needed, nico};

/// A folder with a session, and files beside it.
struct Desk(tempfile::TempDir);

impl Desk {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("temporary folder");
        let desk = Self(folder);
        made_up_session(&nico()).write(&desk.session()).expect("written");
        desk
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn session(&self) -> PathBuf {
        self.path("session")
    }

    fn change(&self, name: &str, change: impl FnOnce(String) -> String) {
        let file = self.session().join(name);
        let text = std::fs::read_to_string(&file).expect("there");
        std::fs::write(&file, change(text)).expect("written");
    }

    fn write(&self, name: &str, text: &str) -> PathBuf {
        std::fs::write(self.path(name), text).expect("written");
        self.path(name)
    }

    fn train(&self, method: Method) -> Result<TrainReport, String> {
        let args = TrainArgs {
            session: self.session(),
            method,
            out: self.path("model.json"),
            seed: 1,
            published_recipe: false,
        };
        train(&args, &Unattended).map_err(|error| error.to_string())
    }

    fn correct(&self, points: &Path) -> Result<CorrectReport, String> {
        let args = CorrectArgs { model: self.path("model.json"), points: points.to_owned() };
        correct(&args, &Unattended).map_err(|error| error.to_string())
    }

    fn predict(&self, rig_model: Option<PathBuf>) -> Result<PredictReport, String> {
        predict(&PredictArgs { session: self.session(), rig_model }, &Unattended)
            .map_err(|error| error.to_string())
    }
}

#[test]
fn a_trained_model_answers_in_the_order_of_the_table() {
    let desk = Desk::new();
    let report = desk.train(Method::M3).expect("trained");
    assert_eq!((report.rows, report.blocks.len()), (63, 7));
    assert!(report.train_rms_mm < 1.0 && report.cross_validated_rms_mm >= report.train_rms_mm, "{report:?}");
    let [low, high] = report.cross_validated_mean_interval_mm;
    assert!(low <= report.cross_validated_mean_mm && report.cross_validated_mean_mm <= high);
    // 8 × 6 cells of 44.5 × 34.6 mm, and a margin around them.
    let area_cm2 = report.border_cm2.expect("a border");
    assert!((739.0..1268.0).contains(&area_cm2), "{area_cm2}");
    // A byte-order mark, other columns, another order.
    let points = desk.write("points.csv", "\u{feff}name,v_px,u_px\na,500,900\nb,1070,1900\nc,500,900\n");
    let answers = desk.correct(&points).expect("answered").points;
    assert_eq!(answers.len(), 3);
    assert_eq!(answers[0], answers[2]);
    let wanted = needed(&nico().touchscreen, Pixel::new(900.0, 500.0)).coords;
    let first = answers[0];
    assert!((first.x_m - wanted.x).hypot(first.y_m - wanted.y) < 0.001, "{first:?}");
    assert!(first.inside && !answers[1].inside, "the corner was never touched");
    assert!(answers[1].sigma_m > answers[0].sigma_m);
    assert!(desk.correct(&desk.write("none.csv", "u_px,v_px\n")).expect("nothing to do").points.is_empty());
}

#[test]
fn points_and_models_that_cannot_be_used_are_refused_with_a_sentence() {
    let desk = Desk::new();
    desk.train(Method::M1).expect("trained");
    for (table, said) in [
        ("u_px\n1\n", "no column v_px"),
        ("u_px,v_px\n1,2\n3,x\n", "line 3: \"x\" in column v_px"),
        ("u_px,v_px\n1,inf\n", "line 2: \"inf\" in column v_px"),
        ("u_px,v_px\n1\n", "line 2: 1 cells instead of 2"),
        ("", "empty"),
    ] {
        let message = desk.correct(&desk.write("points.csv", table)).expect_err("bad");
        assert!(message.contains(said), "{message}");
    }
    let points = desk.write("points.csv", "u_px,v_px\n1,2\n");
    for (model, said) in [
        ("[[[1,2,3],[4,5,6]],[1,2],[[1],[2],[3]],[1]]", "needed are kernel 2×H"),
        ("{\"format\": \"plumbline correction model\", \"version\": 7}", "version 7"),
        ("u,v\n", "no JSON"),
    ] {
        desk.write("model.json", model);
        let message = desk.correct(&points).expect_err("bad");
        assert!(message.contains(said) && message.contains("model.json"), "{message}");
    }
    std::fs::remove_file(desk.path("model.json")).expect("removed");
    assert!(desk.correct(&points).expect_err("gone").contains("model.json"));
}

#[test]
fn sessions_that_nothing_can_be_learned_from_are_refused_with_a_sentence() {
    type Change = fn(String) -> String;
    let cases: [(&str, Change, &str); 6] = [
        (names::TOUCHES, |text| text.lines().take(2).map(|line| format!("{line}\n")).collect(), "1 of"),
        (names::TOUCHES, |text| text.lines().take(10).map(|line| format!("{line}\n")).collect(), "on a line"),
        (names::TOUCHES, |text| text.lines().take(1).map(|line| format!("{line}\n")).collect(), "no touches"),
        (names::MANIFEST, |text| text.replace("width_m = 0.475", "width_m = 0.0"), "width_m"),
        (names::MANIFEST, |text| text.replace("width_px = 1920", "width_px = 0"), "width_px"),
        (names::MANIFEST, |text| text.replace("rig = \"nico\"", "rig = \"robbie\""), "robbie"),
    ];
    for (file, change, said) in cases {
        let desk = Desk::new();
        desk.change(file, change);
        let message = desk.train(Method::M3).expect_err("nothing to learn");
        assert!(message.contains(said), "{message}");
        assert!(!desk.path("model.json").exists());
    }
    let desk = Desk::new();
    std::fs::remove_dir_all(desk.session()).expect("removed");
    assert!(desk.train(Method::M3).expect_err("gone").contains("not a folder"));
}

#[test]
fn repeated_rows_and_touches_off_the_screen_are_left_out() {
    let desk = Desk::new();
    desk.change(names::TOUCHES, |text| {
        let rows: Vec<&str> = text.lines().collect();
        let column = rows[0].split(',').position(|name| name == "touch_u_px").expect("a column");
        let mut off: Vec<&str> = rows[2].split(',').collect();
        off[column] = "2500";
        format!("{text}{}\n{}\n", rows[1], off.join(","))
    });
    let report = desk.train(Method::M1).expect("trained");
    assert_eq!((report.rows, report.left_out.len()), (63, 2), "{:?}", report.left_out);
}

#[test]
fn every_row_is_predicted_and_a_placement_moves_the_prediction() {
    let desk = Desk::new();
    let report = desk.predict(None).expect("predicted");
    assert_eq!((report.rows.len(), report.screen), (63, "session"));
    let json = serde_json::to_value(&report).expect("plain");
    let row = &json["rows"][0];
    assert!(row["table"] == "touches" && row["angles"] == "commanded" && row["touch_v_px"].is_f64(), "{row}");
    let rig = nico();
    let moved = rig.touchscreen.moved(&nalgebra::Isometry3::translation(0.004, 0.0, 0.0));
    let corners = [(50.0, 50.0), (1800.0, 50.0), (1800.0, 1000.0), (50.0, 1000.0)];
    let touches = corners.map(|(u, v)| Pixel::new(u, v)).map(|pixel| (pixel, moved.point_at(pixel)));
    let placement = place_screen(&rig.touchscreen, &touches).expect("placed").of_rig("nico");
    let file = desk.path("screen.toml");
    placement.write(&file).expect("written");
    let on_moved = desk.predict(Some(file.clone())).expect("predicted");
    let v_px = |report: &PredictReport| match report.rows[0] {
        PredictedRow::Touches { touch_v_px, .. } => touch_v_px,
        _ => panic!("a touch"),
    };
    assert!((v_px(&on_moved) - v_px(&report) - 0.004 / rig.touchscreen.pitch_m()[1]).abs() < 0.01);
    assert_eq!(on_moved.screen, "rig-model");

    desk.change(names::MANIFEST, |text| text.replace("width_px = 1920", "width_px = 1280"));
    assert!(desk.predict(Some(file)).expect_err("another screen").contains("1280×1080 px"));
    for (text, said) in [("a = 1\n", "its keys are a"), ("", "empty"), ("{]", "not TOML")] {
        let file = desk.write("model.toml", text);
        let message = desk.predict(Some(file)).expect_err("unknown");
        assert!(message.contains(said) && message.contains("rig.toml"), "{message}");
    }
    desk.change(names::MANIFEST, |text| text.replace("rig = \"nico\"", "rig = \"robbie\""));
    assert!(desk.predict(None).expect_err("unknown").contains("there are: nico"));
}

#[test]
fn a_marker_that_nobody_declared_is_told_and_has_no_place() {
    let desk = Desk::new();
    let joints =
        Manifest::read(&desk.session().join(names::MANIFEST)).expect("there").chain.expect("a chain");
    let head: String = joints.joints.iter().map(|joint| format!("cmd_{joint}_rad,")).collect();
    let angles = "0.4,".repeat(joints.joints.len());
    let rows: String = ["", "toe", "toe"].map(|tip| format!("{angles}1,2,3,{tip}\n")).concat();
    let text = format!("{head}meas_x_m,meas_y_m,meas_z_m,tip\n{rows}");
    std::fs::write(desk.session().join(names::POSES), text).expect("written");
    let rows_of = |report: &PredictReport| -> Vec<serde_json::Value> {
        let json = serde_json::to_value(report).expect("plain");
        let rows = json["rows"].as_array().expect("rows").clone();
        rows.into_iter().filter(|row| row["table"] == "poses").collect()
    };
    let model = desk.path("rig-model.toml");
    made_up_model::model_with(&nico(), &[("joint-zero", "r_elbow_y", &[0.03])])
        .write(&model, &nico())
        .expect("written");
    for rig_model in [None, Some(model)] {
        let report = desk.predict(rig_model).expect("predicted");
        let poses = rows_of(&report);
        assert_eq!(poses.len(), 3, "one per row, in order");
        assert!(poses[0]["meas_x_m"].is_f64() && poses[0]["angles"] == "commanded", "{}", poses[0]);
        for row in &poses[1..] {
            assert!(
                ["meas_x_m", "meas_y_m", "meas_z_m", "angles"].iter().all(|key| row[key].is_null()),
                "{row}"
            );
        }
        let told: Vec<_> = report.tips.iter().map(|tip| (tip.tip.as_str(), tip.rows, tip.place)).collect();
        assert_eq!(told, [(joints.tip.as_str(), 1, "description"), ("toe", 2, "none")]);
        assert!(report.tips[1].words.starts_with("not predicted: "), "{}", report.tips[1].words);
    }
    // What was mounted anew sits at no place that anybody told, and is not held against its frame.
    desk.change(names::MANIFEST, |text| text.replace("[chain]\n", "[chain]\ntip_place = \"unknown\"\n"));
    let report = desk.predict(Some(desk.path("rig-model.toml"))).expect("predicted");
    assert_eq!(report.tips[0].place, "frame");
    assert!(report.gaps.iter().all(|gap| gap.table != "poses"), "{:?}", report.gaps);
}

#[test]
fn localizations_come_with_what_the_model_infers() {
    let folder = match measured_data::folder("nico-vision/grid-z5") {
        Ok(folder) => folder,
        Err(skipped) => return println!("{skipped}"),
    };
    assert!(Manifest::read(&folder.join(names::MANIFEST)).is_ok());
    let report = predict(&PredictArgs { session: folder, rig_model: None }, &Unattended).expect("predicted");
    let json = serde_json::to_value(&report).expect("plain");
    let row = &json["rows"][0];
    // The first row of that file: an object at (0.2, -0.4, 0.05), estimated at (0.219, -0.413, 0.072).
    assert!(
        row["table"] == "localizations" && row["est_x_m"] == 0.2 && row["corrected_x_m"] == 0.219,
        "{row}"
    );
    let off = report.gaps.iter().find(|gap| gap.table == "localizations").expect("compared");
    assert!((off.mean_mm - 36.8).abs() < 0.5, "as its description says: {off:?}");
}

#[test]
fn a_table_is_not_trained_for_nothing_where_a_network_is_asked_for() {
    let desk = Desk::new();
    let args = TrainArgs {
        session: desk.path("no session"),
        method: Method::M1,
        out: desk.path("m1.onnx"),
        seed: 1,
        published_recipe: false,
    };
    // Said before the session is even looked at.
    assert!(train(&args, &Unattended).expect_err("no network").to_string().contains("as JSON"));
}

#[test]
fn pixels_of_another_screen_are_remarked_on() {
    let desk = Desk::new();
    desk.train(Method::M1).expect("trained");
    let remarks = |points: &str| desk.correct(&desk.write("points.csv", points)).expect("answered").remarks;
    assert!(remarks("u_px,v_px\n0,0\n1919,1079\n").is_empty());
    let off = remarks("u_px,v_px\n0,0\n2500,3\n");
    assert!(off[0].contains("1 of the 2 pixels") && off[0].contains("1920×1080"), "{off:?}");
}

#[test]
fn a_model_with_effects_predicts_and_solves() {
    let desk = Desk::new();
    let rig = nico();
    let model = made_up_model::model_with(&rig, &[("joint-zero", "r_elbow_y", &[0.04])]);
    let file = desk.path("rig-model.toml");
    model.write(&file, &rig).expect("written");
    let (nominal, with) =
        (desk.predict(None).expect("predicted"), desk.predict(Some(file.clone())).expect("predicted"));
    assert_eq!((nominal.effects.len(), with.effects), (0, vec!["joint-zero@r_elbow_y".to_owned()]));
    assert_eq!(nominal.rows.len(), with.rows.len());
    assert!(nominal.rows.iter().zip(&with.rows).all(|(a, b)| a != b));
    // Without effects in it the file changes nothing.
    plumbline_effects::RigModel::nominal(&rig).write(&file, &rig).expect("written");
    assert_eq!(desk.predict(Some(file.clone())).expect("predicted"), nominal);

    model.write(&file, &rig).expect("written");
    let targets = desk.write("targets.csv", "x_m,y_m,z_m\n0.3,-0.2,0.2\n0.35,-0.1,0.15\n3,0,0\n");
    let solve = |rig_model: Option<PathBuf>| {
        let tip = "right_index_tip".to_owned();
        let args =
            IkArgs { rig: "nico".to_owned(), tip, targets: targets.clone(), upright: false, rig_model };
        ik(&args, &Unattended).map_err(|error| error.to_string())
    };
    let (own, solved) = (solve(None).expect("solved"), solve(Some(file.clone())).expect("solved"));
    assert_eq!((own.reached, solved.reached), (2, 2));
    let chain = rig.chain("right_index_tip").expect("a tip");
    for (k, target) in [[0.3, -0.2, 0.2], [0.35, -0.1, 0.15]].into_iter().enumerate() {
        let tip_m = |solution: &IkSolution, zero_rad: f64| {
            let off = |name: &String| if name == "r_elbow_y" { zero_rad } else { 0.0 };
            let angles: Vec<f64> =
                chain.names().iter().map(|name| solution.joints[name] + off(name)).collect();
            (chain.robot_from_tip(&angles).translation_m() - nalgebra::Vector3::from(target)).norm()
        };
        assert!(tip_m(&solved.solutions[k], 0.04) < 5e-5, "the robot with the wrong zero gets there");
        assert!(tip_m(&own.solutions[k], 0.04) > 2e-3, "and would not without");
    }
    assert_eq!(solved.solutions[2].status, "out-of-reach");

    let foreign = std::fs::read_to_string(&file).expect("there").replace("\"nico\"", "\"icub\"");
    let foreign = desk.write("foreign.toml", &foreign);
    for said in [
        desk.predict(Some(foreign.clone())).expect_err("another's"),
        solve(Some(foreign)).expect_err("another's"),
    ] {
        assert!(said.contains("belongs to the robot \"icub\""), "{said}");
    }
}
