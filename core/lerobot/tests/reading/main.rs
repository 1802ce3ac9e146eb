//! What was exported is read through the published layout: `info.json` says where rows are and what is in them.

mod made;
mod others;

use std::fs::File;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::{Field, Row};
use plumbline_lerobot::{ExportError, NotCommanded, Options, export};
use plumbline_model::formats::native;
use plumbline_model::robot::default_rig;
use plumbline_model::{Cancelled, JobContext, StereoCalibration, Unattended};
use serde_json::{Value, json};

use crate::made::{
    Said, commanded_rad, places, recorded, recorded_carrying, recorded_with, recorded_with_gaps,
};

fn read(file: &Path) -> Vec<Row> {
    let file = File::open(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    let reader = SerializedFileReader::new(file).expect("a Parquet file");
    reader.get_row_iter(None).expect("rows").map(|row| row.expect("a row")).collect()
}

fn value<'a>(row: &'a Row, name: &str) -> &'a Field {
    let found = row.get_column_iter().find(|(column, _)| *column == name);
    found.unwrap_or_else(|| panic!("no column {name} in {row}")).1
}

fn json_file(file: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(file).expect("a file")).expect("JSON")
}

#[test]
fn a_recording_becomes_an_episode_that_is_read_through_the_layout() {
    let folder = tempfile::tempdir().expect("a folder");
    let (log, set) = (folder.path().join("log.mcap"), folder.path().join("set"));
    recorded(&log);
    let cameras = default_rig().eyes.cameras;
    let options = Options { task: "Look at the table.", cameras: Some(&cameras) };
    let exported = export(&log, &set, &options, &Unattended).expect("exported");
    assert_eq!((exported.frames, exported.left_out), (116, 4), "pairs before the first reading are left out");
    assert!((exported.rate_hz - 20.0).abs() < 1e-6, "{exported:?}");

    let info = json_file(&set.join("meta/info.json"));
    assert_eq!(info["codebase_version"], "v3.0");
    assert_eq!(
        (&info["fps"], &info["total_frames"], &info["robot_type"]),
        (&json!(20), &json!(116), &json!("nico"))
    );
    assert_eq!(info["features"]["observation.state"]["names"], json!(["head_z", "head_y"]));
    assert_eq!(info["features"]["observation.images.left_eye"]["shape"], json!([48, 64, 3]));

    // The layout says where the rows of an episode are.
    let episodes = read(&set.join("meta/episodes/chunk-000/file-000.parquet"));
    assert_eq!(episodes.len(), 1);
    assert_eq!(value(&episodes[0], "dataset_to_index"), &Field::Long(116));
    let path = info["data_path"].as_str().expect("a path");
    let path = path.replace("{chunk_index:03d}", "000").replace("{file_index:03d}", "000");
    let rows = read(&set.join(path));
    assert_eq!(rows.len(), 116);
    let columns: Vec<&String> = rows[0].get_column_iter().map(|(name, _)| name).collect();
    let mut features: Vec<&String> = info["features"].as_object().expect("an object").keys().collect();
    let mut sorted = columns.clone();
    sorted.sort();
    features.sort();
    assert_eq!(sorted, features, "every feature is a column, and nothing else");
    for (number, row) in rows.iter().enumerate() {
        assert_eq!(value(row, "index"), &Field::Long(number as i64));
        assert_eq!(value(row, "timestamp"), &Field::Float((number as f64 / 20.0) as f32));
        let Field::Double(captured_s) = value(row, "observation.captured_s") else { panic!("{row}") };
        assert!((captured_s - 0.05 * number as f64).abs() < 1e-6, "{captured_s}");
        let Field::ListInternal(state) = value(row, "observation.state") else { panic!("{row}") };
        let angle = 0.01 * (number + 4) as f64;
        assert_eq!(state.elements(), [Field::Float(angle as f32), Field::Float(-0.5)], "{number}");
        let Field::ListInternal(action) = value(row, "action") else { panic!("{row}") };
        let told = commanded_rad(number as u32 + 4) as f32;
        assert_eq!(action.elements(), [Field::Float(told), Field::Float(-0.5)], "the answer to {number}");
        let Field::Group(image) = value(row, "observation.images.left_eye") else { panic!("{row}") };
        let Field::Bytes(bytes) = value(image, "bytes") else { panic!("{image}") };
        let image = image::load_from_memory(bytes.data()).expect("a picture").to_rgb8();
        assert!(image.get_pixel(9, 9).0[0].abs_diff((number + 4) as u8) < 3, "pair {number}");
    }
    assert!(exported.has_places && exported.without_place == 0);
    assert_eq!((&exported.actions, &exported.not_commanded), (&exported.joints, &vec![]));
    assert_eq!(info["features"]["action"]["names"], json!(["head_z", "head_y"]));
    let robot_from_left = places().robot_from_left.isometry.to_homogeneous();
    let Field::ListInternal(place) = value(&rows[50], "observation.robot_from_left_eye") else { panic!() };
    let expected: Vec<Field> =
        robot_from_left.transpose().iter().map(|value| Field::Float(*value as f32)).collect();
    for (told, expected) in place.elements().iter().zip(&expected) {
        let (Field::Float(told), Field::Float(expected)) = (told, expected) else { panic!("{told}") };
        assert!((told - expected).abs() < 1e-6, "{told} {expected}");
    }
    assert_eq!(place.elements().len(), 16);
    let tasks = read(&set.join("meta/tasks.parquet"));
    assert_eq!(value(&tasks[0], "task"), &Field::Str("Look at the table.".to_owned()));
    let stats = json_file(&set.join("meta/stats.json"));
    assert_eq!(stats["observation.state"]["count"], json!([116]));
    let least = stats["observation.state"]["min"][0].as_f64().expect("a number");
    assert!((least - 0.04).abs() < 1e-6, "{least}");
    let most = stats["action"]["max"][0].as_f64().expect("a number");
    assert!((most - commanded_rad(119)).abs() < 1e-6, "{most}");

    let told = json_file(&set.join("meta/cameras.json"));
    assert!(
        told["observation.images.left_eye"]["lens"]["matrix_px"][0][0].as_f64().is_some_and(|fx| fx > 100.0)
    );
    let baseline = told["right_from_left"][0][3].as_f64().expect("a number");
    assert!((baseline.abs() - cameras.baseline_m()).abs() < 0.01, "{baseline}");
    assert_eq!(std::fs::read(set.join("meta/rig.toml")).expect("what was attached"), b"name = 1");
}

#[test]
fn what_cannot_be_exported_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = folder.path().join("log.mcap");
    recorded(&log);
    let options = Options { task: "x", cameras: None };
    let full = export(&log, folder.path(), &options, &Unattended);
    assert!(matches!(full, Err(ExportError::NotEmpty(_))), "{full:?}");
    let none = export(&folder.path().join("none.mcap"), &folder.path().join("set"), &options, &Unattended);
    assert!(matches!(none, Err(ExportError::Recording(_))), "{none:?}");
}

/// Lets so much be done, then it is cancelled.
struct CancelledLater(AtomicUsize);

impl JobContext for CancelledLater {
    fn checkpoint(&self) -> Result<(), Cancelled> {
        let left = self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1));
        left.map(drop).map_err(|_| Cancelled)
    }

    fn report(&self, _: f64, _: &str) {}
}

#[test]
fn of_a_set_that_was_cancelled_nothing_stays_and_it_can_be_written_there_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = folder.path().join("log.mcap");
    recorded(&log);
    let options = Options { task: "x", cameras: None };
    let [new, empty] = ["new", "empty"].map(|name| folder.path().join(name));
    std::fs::create_dir(&empty).expect("made");
    for (set, was_there) in [(&new, false), (&empty, true)] {
        let cancelled = export(&log, set, &options, &CancelledLater(AtomicUsize::new(1)));
        assert!(matches!(cancelled, Err(ExportError::Cancelled(_))), "{cancelled:?}");
        assert_eq!(set.is_dir(), was_there);
        assert!(!was_there || set.read_dir().expect("there").next().is_none());
        export(&log, set, &options, &Unattended).expect("exported");
    }
}

#[test]
fn of_several_exports_to_one_folder_at_once_one_makes_a_whole_set() {
    let folder = tempfile::tempdir().expect("a folder");
    let (log, set) = (folder.path().join("log.mcap"), folder.path().join("set"));
    recorded(&log);
    let options = Options { task: "x", cameras: None };
    let together = std::sync::Barrier::new(4);
    let exported = std::thread::scope(|scope| {
        let start = || {
            scope.spawn(|| {
                together.wait();
                export(&log, &set, &options, &Unattended)
            })
        };
        let all = [start(), start(), start(), start()];
        all.map(|one| one.join().expect("ended"))
    });
    let refused = exported.iter().filter(|one| matches!(one, Err(ExportError::NotEmpty(_)))).count();
    assert_eq!((exported.iter().flatten().count(), refused), (1, 3), "{exported:?}");
    for file in ["meta/info.json", "meta/stats.json", "data/chunk-000/file-000.parquet"] {
        assert!(set.join(file).is_file(), "{file}");
    }
}

#[test]
fn a_recording_that_does_not_say_where_the_eyes_were_or_what_was_told_makes_a_set_without_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let (log, set) = (folder.path().join("log.mcap"), folder.path().join("set"));
    recorded_with(&log, |_| Said { places: None, goals: None });
    let exported = export(&log, &set, &Options { task: "x", cameras: None }, &Unattended).expect("exported");
    assert!(!exported.has_places && exported.without_place == 116);
    assert!(exported.actions.is_empty());
    let [info, stats] = ["info.json", "stats.json"].map(|name| json_file(&set.join("meta").join(name)));
    let rows = read(&set.join("data/chunk-000/file-000.parquet"));
    for missing in ["observation.robot_from_left_eye", "action"] {
        assert!(info["features"].get(missing).is_none() && stats.get(missing).is_none());
        assert!(rows[0].get_column_iter().all(|(name, _)| name != missing));
    }
}

#[test]
fn the_calibration_that_a_recording_carries_is_taken_where_none_lies_beside_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let [log, set, other] = ["log.mcap", "set", "other"].map(|name| folder.path().join(name));
    let cameras = default_rig().eyes.cameras;
    let file = folder.path().join("rig-cameras.yaml");
    native::write(&StereoCalibration::bare(cameras), &file).expect("written");
    let carried = std::fs::read(&file).expect("just written");
    recorded_carrying(&log, &carried);
    let exported = export(&log, &set, &Options { task: "x", cameras: None }, &Unattended).expect("exported");
    assert!(exported.has_cameras);
    let given = Options { task: "x", cameras: Some(&cameras) };
    export(&log, &other, &given, &Unattended).expect("exported");
    let [taken, given] = [&set, &other].map(|set| json_file(&set.join("meta/cameras.json")));
    assert_eq!(taken, given);
    // One that is damaged is none, and the rest is exported all the same.
    let [log, set] = ["cut.mcap", "cut"].map(|name| folder.path().join(name));
    recorded_carrying(&log, &carried[..carried.len() / 2]);
    let exported = export(&log, &set, &Options { task: "x", cameras: None }, &Unattended).expect("exported");
    assert!(!exported.has_cameras && exported.frames == 116);
    assert!(!set.join("meta/cameras.json").exists());
}

#[test]
fn what_is_missing_of_some_pairs_removes_nothing_of_the_others_and_is_no_number() {
    let folder = tempfile::tempdir().expect("a folder");
    let (log, set) = (folder.path().join("log.mcap"), folder.path().join("set"));
    recorded_with_gaps(&log);
    let exported = export(&log, &set, &Options { task: "x", cameras: None }, &Unattended).expect("exported");
    assert_eq!((exported.has_places, exported.without_place), (true, 3));
    assert_eq!(exported.actions, ["head_z"]);
    assert_eq!(exported.not_commanded, [NotCommanded { joint: "head_y".to_owned(), frames: 10 }]);
    let rows = read(&set.join("data/chunk-000/file-000.parquet"));
    let robot_from_left = places().robot_from_left.isometry.to_homogeneous();
    for (number, row) in rows.iter().enumerate() {
        let Field::ListInternal(place) = value(row, "observation.robot_from_left_eye") else {
            panic!("{row}")
        };
        let is_known = !(30..33).contains(&(number + 4));
        assert_eq!(place.elements().len(), 16);
        for (k, told) in place.elements().iter().enumerate() {
            let Field::Float(told) = told else { panic!("{told}") };
            let expected = robot_from_left[(k / 4, k % 4)] as f32;
            assert!(
                if is_known { (told - expected).abs() < 1e-6 } else { told.is_nan() },
                "{number}: {told}"
            );
        }
        // One number alone has no list around it in the layout.
        let told = commanded_rad(number as u32 + 4) as f32;
        assert_eq!(value(row, "action"), &Field::Float(told), "{number}");
    }
    let stats = json_file(&set.join("meta/stats.json"));
    let of_places = &stats["observation.robot_from_left_eye"];
    assert_eq!(of_places["count"], json!([113]), "of those that are known");
    let height_m = of_places["mean"][11].as_f64().expect("a number, though some are none");
    assert!((height_m - robot_from_left[(2, 3)]).abs() < 1e-6, "{height_m}");
    let info = json_file(&set.join("meta/info.json"));
    assert_eq!(info["features"]["action"]["names"], json!(["head_z"]));
}
