//! The operator's data folder, as the program keeps it.

use std::path::Path;

use super::{Problem, put};

pub fn make(folder: &Path) -> Result<(), Problem> {
    put(folder, "data/poses/nico.toml", POSES)?;
    put(folder, "data/detection.json", DETECTION)?;
    put(folder, "data/sessions/one/progress.json", PROGRESS)?;
    put(folder, "data/grasps/2026-01-01T00-00-00Z_m5/record.json", GRASP)?;
    put(folder, "data/commission.json", COMMISSION)?;
    put(folder, "data/experiments/one/experiment.json", EXPERIMENT)?;
    let attempt = ATTEMPT.replace("RECORD", GRASP);
    put(folder, "data/experiments/one/attempts/00001-m5.json", attempt)?;
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

const COMMISSION: &str = r#"{"format":1,"began":"2026-01-01T00:00:00Z","is_anew":false,"is_on":true,"spent_s":812.5,"touches":30,"views":34,
"counted":{"sessions/one":10,"sessions/two":20},"touched":{"session":"sessions/one","touched":24,"mean_m":0.004,
"at":"2026-01-01T00:20:00Z"},"checked":null}"#;

const EXPERIMENT: &str = r#"{"format":1,"twin":"lab","methods":["m4","m5"],"attempts":2,"positions_m":[[0.3,-0.1],[0.4,0.0]],
"object":"Tomato","seed":1}"#;

const ATTEMPT: &str = r#"{"trial":{"number":1,"position":0,"attempt":0,"method":"m5"},"placed_m":[0.301,-0.099],"record":RECORD,
"judged":{"lifted":true,"at_first":true,"camera_error_m":0.002,"reach_error_m":0.001,"alignment_m":0.003,
"palm_off_m":[0.001,0.002,0.0],"hand_error_m":null,"failure":null,"refused":false}}"#;

const PROGRESS: &str = r#"{"format":1,"purpose":"train","started":"2026-01-01T00:00:00Z","planned":10,"finished":true,
"prepared":[0.0,0.0],"records":[],"ended":{},"again":[],"gave_placement":null}"#;
