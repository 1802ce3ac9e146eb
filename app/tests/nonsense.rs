//! Numbers that cannot be, thrown at the verbs: the answer is a refusal in words, or an honest "not
//! known", never nonsense with exit 0, a crash or a wait without end. Each case is one corruption of
//! something small and sound; the sound one is done first, so that a refusal is one of the corruption.

use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use nalgebra::Vector3;
use plumbline_model::camera::{Camera, CameraModel, Fisheye};
use plumbline_model::formats::native;
use plumbline_model::{Pose, StereoCalibration, StereoCameras};
use serde_json::{Value, json};

/// No verb may take longer on these.
const PATIENCE: Duration = Duration::from_secs(60);

/// A folder with what the verbs are given.
struct Desk(tempfile::TempDir);

/// What a verb did.
struct Answer {
    status: Option<i32>,
    json: Value,
    said: String,
}

impl Desk {
    fn new() -> Self {
        let desk = Self(tempfile::tempdir().expect("temporary folder"));
        desk.write("touched/session.toml", MANIFEST);
        desk.write("touched/touches.csv", &touches());
        desk.write("seen/session.toml", MANIFEST);
        desk.write("seen/localizations.csv", &localizations(1.0, 1.0));
        desk.write("points.csv", "u_px,v_px\n900,500\n400,300\n");
        desk
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).expect("there")
    }

    fn write(&self, name: &str, text: &str) {
        let file = self.path(name);
        std::fs::create_dir_all(file.parent().expect("a folder")).expect("made");
        std::fs::write(file, text).expect("written");
    }

    /// Replaces a text that must be there.
    fn change(&self, name: &str, from: &str, to: &str) {
        let before = self.text(name);
        assert!(before.contains(from), "{name} holds no {from}");
        self.write(name, &before.replace(from, to));
    }

    /// Changes every cell of a column.
    fn column(&self, name: &str, column: &str, change: impl Fn(f64) -> f64) {
        let text = self.text(name);
        let mut lines = text.lines();
        let header = lines.next().expect("a header");
        let at = header.split(',').position(|known| known == column).expect("the column");
        let rows = lines.map(|line| {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            cells[at] = format!("{:?}", change(cells[at].parse().expect("a number")));
            cells.join(",") + "\n"
        });
        self.write(name, &format!("{header}\n{}", rows.collect::<String>()));
    }

    /// Changes one cell of the third row.
    fn cell(&self, name: &str, column: &str, value: &str) {
        let text = self.text(name);
        let at = text.lines().next().expect("a header").split(',').position(|known| known == column);
        let lines = text.lines().enumerate().map(|(i, line)| {
            let mut cells: Vec<&str> = line.split(',').collect();
            if i == 3 {
                cells[at.expect("the column")] = value;
            }
            cells.join(",") + "\n"
        });
        self.write(name, &lines.collect::<String>());
    }

    /// Runs a verb in the folder; paths are relative to it.
    fn run(&self, words: &[&str]) -> Answer {
        let mut child = Command::new(env!("CARGO_BIN_EXE_plumbline"))
            .args(words)
            .arg("--json")
            .current_dir(self.0.path())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        // Read beside it: a full pipe would hold it.
        let (mut out, mut err) = (child.stdout.take().expect("piped"), child.stderr.take().expect("piped"));
        let read_out = std::thread::Builder::new().name("out".to_owned()).spawn(move || {
            let mut text = String::new();
            out.read_to_string(&mut text).map(|_| text)
        });
        let read_err = std::thread::Builder::new().name("err".to_owned()).spawn(move || {
            let mut text = String::new();
            err.read_to_string(&mut text).map(|_| text)
        });
        let began = Instant::now();
        let status = loop {
            if let Some(status) = child.try_wait().expect("a child") {
                break status;
            }
            if began.elapsed() > PATIENCE {
                child.kill().expect("killed");
                panic!("{words:?} goes on for {PATIENCE:?}");
            }
            std::thread::sleep(Duration::from_millis(5));
        };
        let text = |reader: std::io::Result<std::thread::JoinHandle<std::io::Result<String>>>| {
            reader.expect("a thread").join().expect("it ends").expect("text")
        };
        let (out, err) = (text(read_out), text(read_err));
        let json: Value = serde_json::from_str(&out).unwrap_or(Value::Null);
        let said = json["error"].as_str().map_or(err, str::to_owned);
        Answer { status: status.code(), json, said }
    }

    fn works(&self, words: &[&str]) -> Value {
        let answer = self.run(words);
        assert_eq!(answer.status, Some(0), "{words:?}: {}", answer.said);
        answer.json
    }

    /// The verb must end with 1 and say all of this.
    fn refuses(&self, words: &[&str], said: &[&str]) {
        let answer = self.run(words);
        assert_eq!(answer.status, Some(1), "{words:?}: {} {}", answer.said, answer.json);
        for part in said {
            assert!(answer.said.contains(part), "{words:?}: \"{part}\" is not in: {}", answer.said);
        }
    }
}

const MANIFEST: &str = r#"
format = 1
rig = "nico"
started = 2026-01-01T00:00:00Z
[touchscreen]
width_px = 1920
height_px = 1080
width_m = 0.475
height_m = 0.267
origin_m = [0.545, 0.2375, 0.056]
u_axis = [0.0, -1.0, 0.0]
v_axis = [-1.0, 0.0, 0.0]
[chain]
tip = "right_index_tip"
joints = ["r_shoulder_z", "r_shoulder_y", "r_arm_x", "r_elbow_y", "r_wrist_z", "r_wrist_x"]
"#;

/// A grid of touches that were sent up to 20 mm beside their places.
fn touches() -> String {
    let joints = ["r_shoulder_z", "r_shoulder_y", "r_arm_x", "r_elbow_y", "r_wrist_z", "r_wrist_x"];
    let commands: Vec<String> = joints.iter().map(|joint| format!("cmd_{joint}_rad")).collect();
    let mut text = format!(
        "set,{},touch_u_px,touch_v_px,target_x_m,target_y_m,target_z_m,screen_height_m,payload_kg\n",
        commands.join(",")
    );
    for i in 0..54 {
        let (column, row) = (f64::from(i % 9), f64::from(i / 9));
        let jitter = f64::from((i * 37) % 17) - 8.0;
        let (u, v) = (240.0 + 180.0 * column + jitter, 140.0 + 150.0 * row - jitter);
        let (a, b) = (u / 1920.0 - 0.5, v / 1080.0 - 0.5);
        let x = 0.545 - v * 0.267 / 1080.0 + 0.012 + 0.03 * a * b;
        let y = 0.2375 - u * 0.475 / 1920.0 - 0.008 + 0.02 * a * a;
        let z = 0.06 - 0.01 * b * b;
        text += &format!("r{row},{:?},0.3,0.45,1.6,1.05,0.7,{u},{v},{x},{y},{z},0,0\n", 0.05 + 0.12 * column);
    }
    text
}

/// The published grid of places and estimates a little beside them, in units of so many per meter.
fn localizations(of_truth: f64, of_estimate: f64) -> String {
    let mut text = "true_x_m,true_y_m,true_z_m,est_x_m,est_y_m,est_z_m\n".to_owned();
    for i in 0..36 {
        let (x, y) = (0.2 + 0.1 * f64::from(i / 9), -0.4 + 0.1 * f64::from(i % 9));
        let estimate = [x + 0.02 * x, y * 1.05, 0.05 + 0.01 * x].map(|m| format!("{}", m * of_estimate));
        let truth = [x, y, 0.05].map(|m| format!("{}", m * of_truth));
        text += &format!("{},{}\n", truth.join(","), estimate.join(","));
    }
    text
}

const TRAIN: [&str; 7] = ["train", "--session", "touched", "--model", "m1", "--out", "model.json"];
const PREDICT: [&str; 3] = ["predict", "--session", "touched"];

#[test]
fn nothing_is_trained_from_what_cannot_be() {
    let desk = Desk::new();
    let report = desk.works(&TRAIN);
    assert!(report["train_rms_mm"].as_f64().expect("a number") < 20.0, "{report}");
    type Corrupt = fn(&Desk);
    let cases: [(Corrupt, &[&str]); 8] = [
        (
            |desk| {
                for axis in ["target_x_m", "target_y_m", "target_z_m"] {
                    desk.column("touched/touches.csv", axis, |m| m * 1000.0);
                }
            },
            &["touches.csv, line 2, column target_x_m", "looks like millimeters", "54 of the 54 rows"],
        ),
        (
            |desk| desk.column("touched/touches.csv", "target_z_m", |m| m * 57.0),
            &["target_z_m", "whose arm reaches", "54 of the 54"],
        ),
        (
            |desk| desk.column("touched/touches.csv", "screen_height_m", |_| 57.0),
            &["column screen_height_m: 57 m cannot be a height of the block"],
        ),
        (
            |desk| desk.change("touched/session.toml", "height_m = 0.267", "height_m = 15.219"),
            &["session.toml", "touchscreen.height_m", "15.219 m cannot be"],
        ),
        (
            |desk| desk.column("touched/touches.csv", "payload_kg", |_| -5.0),
            &["column payload_kg: -5 kg cannot be a payload, which is 0 to 20 kg"],
        ),
        (
            |desk| desk.change("touched/session.toml", "height_m = 0.267", "height_m = 5.0"),
            &["touchscreen.height_m", "5 m cannot be a side"],
        ),
        (
            |desk| desk.change("touched/session.toml", "0.2375, 0.056]", "0.2375, 5.0]"),
            &["touchscreen.origin_m", "5 m cannot be a coordinate of the touchscreen"],
        ),
        (
            |desk| desk.column("touched/touches.csv", "target_y_m", |m| -4.0 * m),
            &["M1 misses the touches that it was trained on"],
        ),
    ];
    for (corrupt, said) in cases {
        let desk = Desk::new();
        corrupt(&desk);
        desk.refuses(&TRAIN, said);
        assert!(!desk.path("model.json").exists(), "{said:?}: nothing is written");
    }
}

#[test]
fn one_wild_row_is_left_out_and_named() {
    for (column, value, said) in [
        ("payload_kg", "-5", "column payload_kg: -5 kg cannot be a payload"),
        ("touch_u_px", "-1e308", "column touch_u_px: -1.000e308 px cannot be"),
        ("cmd_r_elbow_y_rad", "1e9", "column cmd_r_elbow_y_rad: 1.000e9 rad cannot be a joint angle"),
        ("target_x_m", "446", "looks like millimeters"),
    ] {
        let desk = Desk::new();
        desk.cell("touched/touches.csv", column, value);
        let report = desk.works(&TRAIN);
        assert_eq!(report["rows"], 53, "{report}");
        let left_out = report["left_out"][0].as_str().expect("a sentence");
        assert!(
            left_out.starts_with("1 row holds what cannot be (line 4") && left_out.contains(said),
            "{left_out}"
        );
        desk.refuses(&PREDICT, &["touches.csv, line 4", "delete the row"]);
    }
}

#[test]
fn a_search_ends_with_a_cell_of_1e308() {
    let desk = Desk::new();
    desk.cell("seen/localizations.csv", "est_y_m", "-1e308");
    let report = desk.works(&["gap", "--session", "seen"]);
    assert_eq!(report["left_out"], 1, "{report}");
    // These touches are of no arm: whatever is said of them, it is said.
    desk.cell("touched/touches.csv", "touch_v_px", "-1e308");
    let answer = desk.run(&["gap", "--session", "touched"]);
    assert!(
        matches!(answer.status, Some(0 | 1)) && !answer.said.is_empty(),
        "{:?} {}",
        answer.status,
        answer.said
    );
}

#[test]
fn no_gap_is_told_of_places_in_another_unit() {
    let desk = Desk::new();
    for (truth, estimate, said) in [
        (1000.0, 1000.0, "column true_x_m: 200 m"),
        (1000.0, 1.0, "column true_x_m: 200 m"),
        (1.0, 1000.0, "column est_x_m: 204 m"),
    ] {
        desk.write("seen/localizations.csv", &localizations(truth, estimate));
        let all = [said, "looks like millimeters", "36 of the 36 rows"];
        desk.refuses(&["gap", "--session", "seen"], &all);
        desk.refuses(&["predict", "--session", "seen"], &all);
    }
}

#[test]
fn no_angle_turns_that_often() {
    let desk = Desk::new();
    assert_eq!(desk.works(&PREDICT)["rows"].as_array().map(Vec::len), Some(54));
    desk.column("touched/touches.csv", "cmd_r_elbow_y_rad", |_| 1e9);
    desk.refuses(&PREDICT, &["column cmd_r_elbow_y_rad", "1.000e9 rad cannot be a joint angle"]);
    desk.column("touched/touches.csv", "cmd_r_elbow_y_rad", |_| 91.7);
    desk.refuses(&PREDICT, &["it looks like degrees, where radians belong"]);
}

#[test]
fn a_model_with_a_weight_a_thousand_times_too_large_does_not_answer() {
    let desk = Desk::new();
    desk.works(&["train", "--session", "touched", "--model", "m3", "--out", "model.json"]);
    let correct = ["correct", "--model", "model.json", "--points", "points.csv"];
    let report = desk.works(&correct);
    assert!(report["points"][0]["x_m"].as_f64().is_some_and(|x_m| (0.2..0.6).contains(&x_m)), "{report}");
    let mut model: Value = serde_json::from_str(&desk.text("model.json")).expect("JSON");
    let weights = model["answer"]["network"]["members"][0]["weights"][0].as_array_mut().expect("weights");
    let size = |weight: &Value| weight.as_f64().expect("a number").abs();
    let largest = weights.iter_mut().max_by(|a, b| size(a).total_cmp(&size(b))).expect("weights");
    *largest = (1000.0 * largest.as_f64().expect("a number")).into();
    desk.write("model.json", &model.to_string());
    let said = ["model.json no longer answers as it did when it was written", "train again"];
    desk.refuses(&correct, &said);
    // As an older program wrote it.
    model.as_object_mut().expect("a document").remove("self_test").expect("it was there");
    desk.write("model.json", &model.to_string());
    desk.refuses(&correct, &said);
    desk.works(&["train", "--session", "touched", "--model", "m3", "--out", "model.json"]);
    desk.write("points.csv", "u_px,v_px\n1e308,500\n");
    desk.refuses(&correct, &["points.csv, line 2", "column u_px: 1.000e308 px cannot be"]);
    desk.write("points.csv", "u_px,v_px\n17190,500\n");
    desk.refuses(&correct, &["points.csv, line 2", "beside the touchscreen of 1920 × 1080 px"]);
}

/// The robot's files, to be changed.
fn with_own_robot(desk: &Desk) {
    let robot = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../assets/robots/nico");
    for file in ["rig.toml", "nico.urdf"] {
        let text = std::fs::read_to_string(robot.join(file)).expect("the robot comes along");
        for folder in ["touched", "seen"] {
            desk.write(&format!("{folder}/{file}"), &text);
        }
    }
    for folder in ["touched", "seen"] {
        desk.change(&format!("{folder}/session.toml"), "rig = \"nico\"", "rig_file = \"rig.toml\"");
    }
    desk.write("targets.csv", "x_m,y_m,z_m\n0.3,-0.2,0.2\n");
}

#[test]
fn robots_that_cannot_be_are_refused() {
    let ik = ["ik", "--rig", "touched/rig.toml", "--tip", "right_palm_center", "--targets", "targets.csv"];
    let sound = Desk::new();
    with_own_robot(&sound);
    assert_eq!(sound.works(&ik)["reached"], 1);
    let nested = "<a>".repeat(20_000) + &"</a>".repeat(20_000);
    for (file, from, to, said) in [
        (
            "nico.urdf",
            "<axis xyz=\"0 0 1\"/>",
            "<axis xyz=\"1e308 1e308 1e308\"/>",
            "1.000e308 cannot be a length",
        ),
        ("nico.urdf", "xyz=\"0 0 -0.105\"", "xyz=\"0 0 -1e308\"", "cannot be a length of a link"),
        ("nico.urdf", "</robot>", &format!("{nested}</robot>"), "levels deep"),
        (
            "nico.urdf",
            "<mass value=\"0.090439\"/>",
            "<mass value=\"-5\"/>",
            "-5 kg cannot be a mass of a link",
        ),
        ("rig.toml", "height_m = 0.267", "height_m = 5.0", "touchscreen: 5 m cannot be"),
        ("rig.toml", "m = [-0.0699274", "m = [-69.9274", "cannot be a distance between the eyes"),
        ("rig.toml", "fx_px = 150.68417", "fx_px = 150684.17", "cannot be a focal length"),
    ] {
        let desk = Desk::new();
        with_own_robot(&desk);
        desk.change(&format!("touched/{file}"), from, to);
        desk.refuses(&ik, &[said]);
        desk.refuses(&PREDICT, &[said]);
        desk.refuses(&["gap", "--session", "touched"], &[said]);
    }
    sound.write("targets.csv", "x_m,y_m,z_m\n300,-200,200\n");
    sound.refuses(&ik, &["targets.csv, line 2", "column x_m: 300 m cannot be", "looks like millimeters"]);
    sound.write("targets.csv", "x_m,y_m,z_m\n1e308,-0.2,0.2\n");
    sound.refuses(&ik, &["targets.csv, line 2", "1.000e308 m cannot be"]);
}

fn eyes() -> StereoCameras {
    let camera = |cx_px: f64| Camera {
        model: CameraModel::Fisheye(Fisheye {
            fx_px: 150.7,
            fy_px: 150.8,
            cx_px,
            cy_px: 238.1,
            skew_px: 0.0,
            k: [-0.0084, -0.008, 0.0017, -0.00026],
        }),
        width_px: 640,
        height_px: 480,
    };
    StereoCameras {
        left: camera(321.3),
        right: camera(322.6),
        right_from_left: Pose::from_rotation_vector(
            Vector3::new(0.0035, -0.0089, 0.0057),
            Vector3::new(-0.06993, -0.00034, -0.00097),
        ),
    }
}

/// A picture that matches nowhere but with itself.
fn picture(file: &Path) {
    let mut seed = 1u32;
    let image = image::GrayImage::from_fn(640, 480, |_, _| {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        image::Luma([(seed >> 24) as u8])
    });
    image.save(file).expect("written");
}

#[test]
fn eyes_that_cannot_be_are_refused_before_memory_is_asked_for() {
    let desk = Desk::new();
    for name in ["left.png", "right.png"] {
        picture(&desk.path(name));
    }
    let eyes_file = desk.path("eyes.yaml");
    let calibration = StereoCalibration::bare(eyes());
    native::write(&calibration, &eyes_file).expect("written");
    let of_images = ["--cameras", "eyes.yaml", "--left", "left.png", "--right", "right.png"];
    let locate = [&["locate", "--points", "points.csv"][..], &of_images].concat();
    let disparity = [&["disparity", "--max-disparity", "32", "--out", "map.pfm"][..], &of_images].concat();
    desk.write("points.csv", "u_px,v_px\n300,250\n1e4,3\n");
    let located = desk.works(&locate);
    assert_eq!(located["points"][1]["x_m"], Value::Null, "{located}");
    desk.works(&disparity);
    // Whose eyes they are is said once.
    let both = desk.run(&[&locate[..], &["--lab", "lab"]].concat());
    assert!(both.status == Some(2) && both.said.contains("cannot be used with"), "{}", both.said);
    let neither =
        desk.run(&["locate", "--points", "points.csv", "--left", "left.png", "--right", "right.png"]);
    assert!(neither.status == Some(2) && neither.said.contains("--cameras"), "{}", neither.said);
    let in_lab = [&["locate", "--lab", "lab"][..], &locate[1..3], &of_images[2..]].concat();
    desk.refuses(&in_lab, &["lab is no commissioned lab", "plumbline commission"]);
    let before = desk.run(&[&in_lab[..], &["--eyes-on-s=-5"]].concat());
    assert!(before.status == Some(2) && before.said.contains("must not be less than 0"), "{}", before.said);
    let sound = desk.text("eyes.yaml");
    let older = sound.split("self_test:").next().expect("before").to_owned() + "complete: true\n";
    for (from, to, said) in [
        (
            "translation_m: [-0.06993",
            "translation_m: [-69.93",
            "69.93 m cannot be a distance between the eyes",
        ),
        ("translation_m: [-0.06993", "translation_m: [-1e308", "cannot be a distance between the eyes"),
        ("fx_px: 150.7", "fx_px: 150700.0", "150700 px cannot be a focal length"),
        ("fx_px: 150.7", "fx_px: 1e308", "1.000e308 px cannot be a focal length"),
        ("cx_px: 321.3", "cx_px: 1e308", "principal point"),
        ("width_px: 640", "width_px: 900000", "cannot be a side of an image"),
        ("[-0.0084", "[-1e308", "cannot be a coefficient of a fisheye lens"),
    ] {
        for text in [&sound, &older] {
            assert!(text.contains(from), "{from}");
            desk.write("eyes.yaml", &text.replace(from, to));
            desk.refuses(&locate, &["eyes.yaml", said]);
            desk.refuses(&disparity, &["eyes.yaml", said]);
        }
    }
    // What can be, but is not what was written.
    desk.write("eyes.yaml", &sound.replace("fx_px: 150.7", "fx_px: 250.7"));
    desk.refuses(&locate, &["eyes.yaml", "no longer answer as they did", "calibrate again"]);
    desk.write("eyes.yaml", &sound);
    desk.write("points.csv", "u_px,v_px\n1e308,250\n");
    desk.refuses(&locate, &["points.csv, line 2", "column u_px"]);
}

/// A shard of an experiment of two attempts, in which the attempt of this number was made.
fn shard(desk: &Desk, name: &str, number: usize, lifted: bool) {
    let plan = json!({
        "format": 1, "twin": "lab", "methods": ["m5"], "attempts": 2, "positions_m": [[0.3, 0.0]],
        "hand": "auto", "object": "Tomato", "seed": 1, "lab": "of one lab"
    });
    desk.write(&format!("{name}/experiment.json"), &plan.to_string());
    let attempt = json!({
        "trial": { "number": number, "position": 0, "attempt": number, "method": "m5" },
        "placed_m": [0.3, 0.0],
        "record": {
            "format": 1, "method": "m5", "object": "Tomato", "began": "2026-01-02T03:04:05Z", "model": "nominal",
            "seen": [], "iterations": [], "moments": [], "seen_after": [], "seconds": 14.5
        },
        "judged": { "lifted": lifted, "at_first": lifted, "alignment_m": 0.001, "refused": false }
    });
    desk.write(&format!("{name}/attempts/{number:05}-m5.json"), &attempt.to_string());
    // Attempts of earlier versions have no joint tracks.
    if number == 1 {
        desk.write(&format!("{name}/attempts/{number:05}-m5.tracks.csv"), "t_s,step\n0.000,ready\n");
    }
}

#[test]
fn shards_that_are_not_of_one_experiment_are_not_put_together() {
    let merge = |shards: &[&'static str], out: &'static str| {
        [&["grasp-trials", "--merge"], shards, &["--out", out]].concat()
    };
    let desk = Desk::new();
    shard(&desk, "a", 0, true);
    shard(&desk, "b", 1, false);
    let whole = desk.works(&merge(&["a", "b"], "whole"));
    let of = &whole["methods"]["m5"];
    for key in [
        "successes",
        "attempts",
        "inside",
        "inside_attempts",
        "hand_located",
        "hand_positions",
        "refused",
        "failures",
        "alignment_mm",
        "reach_error_mm",
        "camera_error_mm",
        "seconds_median",
        "positions",
    ] {
        assert!(of.get(key).is_some(), "{key} of {of}");
    }
    assert_eq!((of["successes"].as_u64(), of["attempts"].as_u64()), (Some(1), Some(2)));
    assert_eq!(of["alignment_mm"]["median"].as_f64(), Some(1.0));
    for file in ["attempts.csv", "report.html", "report.pdf", "summary.json", "attempts/00001-m5.tracks.csv"]
    {
        assert!(desk.path("whole").join(file).is_file(), "{file}");
    }
    desk.change("b/attempts/00001-m5.tracks.csv", "ready", "look");
    desk.refuses(&merge(&["a", "b"], "whole"), &["b", "something else of 00001-m5.tracks.csv"]);

    let corrupt = |change: &dyn Fn(&Desk)| {
        let desk = Desk::new();
        shard(&desk, "a", 0, true);
        shard(&desk, "b", 1, false);
        change(&desk);
        desk
    };
    let refused = |desk: Desk, said: &[&str]| desk.refuses(&merge(&["a", "b"], "whole"), said);
    refused(
        corrupt(&|desk| desk.change("b/experiment.json", "of one lab", "of another lab")),
        &["b", "another experiment"],
    );
    refused(corrupt(&|desk| shard(desk, "b", 0, false)), &["b", "something else"]);
    refused(corrupt(&|desk| desk.write("b/experiment.json", "{")), &["experiment.json"]);
    refused(corrupt(&|desk| desk.write("b/attempts/00001-m5.json", "[]")), &["00001-m5.json"]);
}
