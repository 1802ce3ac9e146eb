//! What others read of a data set: pyarrow, which LeRobot itself reads with, and nothing of this program.

use std::path::Path;
use std::process::Command;

use plumbline_lerobot::{Options, export};
use plumbline_model::Unattended;
use plumbline_model::robot::default_rig;
use serde_json::{Value, json};

use crate::made::{commanded_rad, recorded, recorded_with_gaps};

/// Goes the way that the published layout describes: `info.json`, the episodes, and by what these say the rows.
const READER: &str = r#"
import json, sys
from pathlib import Path
import pyarrow as pa
import pyarrow.parquet as pq
root = Path(sys.argv[1])
info = json.loads((root / "meta/info.json").read_text())
stats = json.loads((root / "meta/stats.json").read_text())
tasks = pq.read_table(root / "meta/tasks.parquet")
found = {"problems": [], "episodes": [], "task_index": json.loads(tasks.schema.metadata[b"pandas"])["index_columns"]}
names = {row["task_index"]: row["task"] for row in tasks.to_pylist()}
kinds = {"float32": pa.float32(), "float64": pa.float64(), "int64": pa.int64()}
for file in sorted((root / "meta/episodes").glob("*/*.parquet")):
    for episode in pq.read_table(file).to_pylist():
        where = dict(chunk_index=episode["data/chunk_index"], file_index=episode["data/file_index"])
        table = pq.read_table(root / info["data_path"].format(**where))
        known = json.loads(table.schema.metadata[b"huggingface"])["info"]["features"]
        if set(table.column_names) != set(info["features"]) or set(known) != set(info["features"]):
            found["problems"].append("columns: " + str(table.column_names))
        for name, feature in info["features"].items():
            kind = table.schema.field(name).type
            if feature["dtype"] == "image":
                good = pa.types.is_struct(kind) and {f.name for f in kind} == {"bytes", "path"}
                good = good and known[name] == {"_type": "Image"}
            elif feature["shape"] == [1]:
                good = kind == kinds[feature["dtype"]] and known[name]["dtype"] == feature["dtype"]
            else:
                good = pa.types.is_list(kind) and kind.value_type == kinds[feature["dtype"]]
                good = good and known[name]["length"] == feature["shape"][0]
            if not good:
                found["problems"].append(name + ": " + str(kind))
        rows = [row for row in table.to_pylist() if row["episode_index"] == episode["episode_index"]]
        if len(rows) != episode["length"] or len(rows) != episode["dataset_to_index"] - episode["dataset_from_index"]:
            found["problems"].append("length: " + str(len(rows)))
        for number, row in enumerate(rows):
            if row["index"] != episode["dataset_from_index"] + number or row["frame_index"] != number:
                found["problems"].append("row " + str(number) + ": index " + str(row["index"]))
            if abs(row["timestamp"] - number / info["fps"]) > 1e-4:
                found["problems"].append("row " + str(number) + ": timestamp " + str(row["timestamp"]))
            if [names[row["task_index"]]] != episode["tasks"]:
                found["problems"].append("row " + str(number) + ": task")
            for name, feature in info["features"].items():
                if feature["dtype"] == "image":
                    jpeg, (height, width, _) = row[name]["bytes"], feature["shape"]
                    frame = jpeg.index(b"\xff\xc0") if b"\xff\xc0" in jpeg else jpeg.index(b"\xff\xc2")
                    size = [int.from_bytes(jpeg[frame + k : frame + k + 2], "big") for k in (5, 7)]
                    if jpeg[:2] != b"\xff\xd8" or size != [height, width]:
                        found["problems"].append("row " + str(number) + ": " + name + " " + str(size))
                elif feature["shape"] != [1] and len(row[name]) != feature["shape"][0]:
                    found["problems"].append("row " + str(number) + ": " + name)
        listed = lambda value: value if isinstance(value, list) else [value]
        names_of_angles = [name for name in ("observation.state", "action") if name in rows[0]]
        of_all = {name: [listed(row[name]) for row in rows] for name in names_of_angles}
        ends = {name: [values[0], values[-1]] for name, values in of_all.items()}
        found["episodes"].append({"tasks": episode["tasks"], "ends": ends, "rows": len(rows)})
        for name, rows_of_it in of_all.items():
            for joint, values in enumerate(zip(*rows_of_it)):
                told = [stats[name][key][joint] for key in ("min", "max", "mean")]
                own = [min(values), max(values), sum(values) / len(values)]
                if any(abs(a - b) > 1e-5 for a, b in zip(told, own)):
                    found["problems"].append("statistics: " + name + " " + str(told) + " " + str(own))
        place = "observation.robot_from_left_eye"
        unknown = sum(all(value != value for value in row[place]) for row in rows) if place in rows[0] else None
        if unknown is not None and stats[place]["count"] != [len(rows) - unknown]:
            found["problems"].append("statistics: " + place + " " + str(stats[place]["count"]))
        found["episodes"][-1]["unknown"] = unknown
print(json.dumps(found))
"#;

/// What the package says of a data set; `None`, with a word on the console, where it is not there.
fn read_by_python(set: &Path) -> Option<Value> {
    let readers = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../.native/readers");
    if !readers.join("pyarrow").exists() {
        plumbline_model::measured_data::left_out(
            "the Python package pyarrow is not here; ./plumbline test fetches it",
        );
        return None;
    }
    let told = Command::new("python3").args(["-c", READER]).arg(set).env("PYTHONPATH", readers).output();
    let told = told.expect("Python is there");
    assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stderr));
    Some(serde_json::from_slice(&told.stdout).expect("JSON"))
}

#[test]
fn pyarrow_reads_a_data_set_by_what_it_says_of_itself() {
    let folder = tempfile::tempdir().expect("a folder");
    let (log, set) = (folder.path().join("log.mcap"), folder.path().join("set"));
    recorded(&log);
    let options = Options { task: "Look at the table.", cameras: Some(&default_rig().eyes.cameras) };
    export(&log, &set, &options, &Unattended).expect("exported");
    let Some(found) = read_by_python(&set) else { return };
    assert_eq!(found["problems"], json!([]));
    assert_eq!(found["task_index"], json!(["task"]));
    let angle = |number: f32| f64::from(0.01 * number);
    let [episode] = found["episodes"].as_array().expect("a list").as_slice() else { panic!("{found}") };
    assert_eq!((&episode["rows"], &episode["tasks"]), (&json!(116), &json!(["Look at the table."])));
    for (end, number) in [(0, 4), (1, 119)] {
        let [state, action] = ["observation.state", "action"].map(|name| &episode["ends"][name][end]);
        let [pan, commanded] = [state, action].map(|of| of[0].as_f64().expect("a number"));
        assert!((pan - angle(number as f32)).abs() < 1e-6 && state[1] == json!(-0.5), "{state}");
        assert!((commanded - commanded_rad(number)).abs() < 1e-6 && action[1] == json!(-0.5), "{action}");
    }
    assert_eq!(episode["unknown"], json!(0));
}

#[test]
fn pyarrow_reads_a_set_of_which_some_is_not_known() {
    let folder = tempfile::tempdir().expect("a folder");
    let (log, set) = (folder.path().join("log.mcap"), folder.path().join("set"));
    recorded_with_gaps(&log);
    export(&log, &set, &Options { task: "x", cameras: None }, &Unattended).expect("exported");
    let Some(found) = read_by_python(&set) else { return };
    assert_eq!((&found["problems"], &found["episodes"][0]["unknown"]), (&json!([]), &json!(3)));
}

#[test]
fn what_is_wrong_with_a_data_set_is_seen_by_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let (log, set) = (folder.path().join("log.mcap"), folder.path().join("set"));
    recorded(&log);
    export(&log, &set, &Options { task: "x", cameras: None }, &Unattended).expect("exported");
    // Another rate than that of the rows, and a statement about a column that is not so.
    let file = set.join("meta/info.json");
    let said = std::fs::read_to_string(&file).expect("there");
    let said = said.replace("\"fps\": 20", "\"fps\": 19").replace("64,\n", "65,\n");
    std::fs::write(&file, said).expect("written");
    let Some(found) = read_by_python(&set) else { return };
    let problems: Vec<&str> =
        found["problems"].as_array().expect("a list").iter().filter_map(Value::as_str).collect();
    for wrong in ["timestamp", "observation.images.left_eye [48, 64]"] {
        assert!(problems.iter().any(|problem| problem.contains(wrong)), "{problems:?}");
    }
}
