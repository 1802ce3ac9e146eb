//! What was exported is read through the published layout: `info.json` says where rows are and what is in them.

mod made;
mod others;

use std::fs::File;
use std::path::Path;

use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::{Field, Row};
use plumbline_lerobot::{ExportError, Options, export};
use plumbline_model::Unattended;
use plumbline_model::robot::default_rig;
use serde_json::{Value, json};

use crate::made::{places, recorded, recorded_with};

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
        let Field::Group(image) = value(row, "observation.images.left_eye") else { panic!("{row}") };
        let Field::Bytes(bytes) = value(image, "bytes") else { panic!("{image}") };
        let image = image::load_from_memory(bytes.data()).expect("a picture").to_rgb8();
        assert!(image.get_pixel(9, 9).0[0].abs_diff((number + 4) as u8) < 3, "pair {number}");
    }
    assert!(exported.has_places);
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

#[test]
fn a_recording_that_does_not_say_where_the_eyes_were_makes_a_set_without_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let (log, set) = (folder.path().join("log.mcap"), folder.path().join("set"));
    recorded_with(&log, None);
    let exported = export(&log, &set, &Options { task: "x", cameras: None }, &Unattended).expect("exported");
    assert!(!exported.has_places);
    let info = json_file(&set.join("meta/info.json"));
    assert!(info["features"].get("observation.robot_from_left_eye").is_none());
    let rows = read(&set.join("data/chunk-000/file-000.parquet"));
    assert!(rows[0].get_column_iter().all(|(name, _)| name != "observation.robot_from_left_eye"));
}
