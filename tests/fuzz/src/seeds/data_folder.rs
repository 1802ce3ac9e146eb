//! The operator's data folder, as the program keeps it.

use std::path::Path;

use super::{Problem, put};

pub fn make(folder: &Path) -> Result<(), Problem> {
    put(folder, "data/poses/nico.toml", POSES)?;
    put(folder, "data/detection.json", DETECTION)?;
    put(folder, "data/sessions/one/progress.json", PROGRESS)?;
    put(folder, "data/grasps/2026-01-01T00-00-00Z_m5/record.json", GRASP)?;
    for name in ["session.toml", "touches.csv"] {
        let content = std::fs::read(folder.join("arm/short").join(name))?;
        put(folder, &format!("data/sessions/one/{name}"), content)?;
    }
    put(folder, "data/rig-model.toml", std::fs::read(folder.join("arm/rig-model.toml"))?)?;
    put(folder, "data/screen-placement.toml", std::fs::read(folder.join("arm/placement.toml"))?)?;
    Ok(())
}

const POSES: &str = "[[pose]]\ntitle = \"Wave\"\njoints_rad = { r_elbow_y = 1.2, r_wrist_z = 0.4 }\n\n[[pose]]\n\
title = \"Rest\"\njoints_rad = { r_shoulder_y = 0.1 }\n";

const DETECTION: &str = r#"{"confidence":0.4,"iou":0.6,"hidden":[],"class_confidence":{"Tomato":0.5}}"#;

const GRASP: &str = r#"{"format":1,"method":"m5","object":"Tomato","began":"2026-01-01T00:00:00Z","model":"as described",
"step":"lift","seen":[{"class":"Tomato","confidence":0.9,"boxes_px":[[1.0,2.0,3.0,4.0],null],"place":{"Err":"one eye"}}],
"chosen":0,"standing_m":[0.3,-0.1],"wanted_m":[0.29,-0.1,0.09],"heading_rad":0.2,"iterations":[],
"moments":[{"after":"approach","at_s":2.0,"commanded_rad":[0.1],"encoder_rad":[0.1],"load":[null]}],"seen_after":[],
"fingers_open_rad":0.3,"seconds":9.5,"outcome":{"result":"success"},"told_by_operator":null}"#;

const PROGRESS: &str = r#"{"format":1,"purpose":"train","started":"2026-01-01T00:00:00Z","planned":10,"finished":true,
"prepared":[0.0,0.0],"records":[],"ended":{},"again":[],"gave_placement":null}"#;
