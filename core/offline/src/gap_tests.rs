//! What `gap` prints as JSON, against what is promised of its keys.

use plumbline_gap::Finding;
use plumbline_gap::finding::FoundParameter;
use plumbline_report::sample;
use serde_json::Value;

use super::gap::GapReport;

fn json(finding: Finding) -> Value {
    serde_json::to_value(GapReport::of(finding)).expect("a report can be written")
}

#[test]
fn a_number_has_its_interval_and_a_choice_is_a_string() {
    let mut finding = sample::pixels();
    let choice = |name: &str, text: &str| FoundParameter {
        name: name.to_owned(),
        value: 0.0,
        low: 0.0,
        high: 0.0,
        text: Some(text.to_owned()),
    };
    let effect = &mut finding.effects[0];
    effect.id = "focal-or-baseline".to_owned();
    effect.parameters[0].name = "scale".to_owned();
    effect.parameters.push(choice("which", "distance of the eyes"));
    effect.parameters.push(choice("from_joint", "r_shoulder_y"));
    let json = json(finding);
    let parameters = json["effects"][0]["parameters"].as_object().expect("parameters by name");
    assert_eq!(parameters.len(), 3, "the choice takes no number's place: {parameters:?}");
    let scale = parameters["scale"].as_object().expect("a number with its interval");
    let mut keys: Vec<&str> = scale.keys().map(String::as_str).collect();
    keys.sort_unstable();
    assert_eq!(keys, ["high", "low", "value"]);
    assert!(scale.values().all(Value::is_f64), "{scale:?}");
    assert_eq!(parameters["which"], "distance of the eyes");
    assert_eq!(parameters["from_joint"], "r_shoulder_y");
}

#[test]
fn the_promised_keys_are_there_and_names_stay_ids() {
    let json = json(sample::class());
    assert_eq!(json["verdict"], "class");
    let effect = &json["effects"][0];
    for key in ["id", "site", "probability", "parameters", "class", "split_by"] {
        assert!(!effect[key].is_null(), "{key} in {effect}");
    }
    assert_eq!(effect["class"][0], "joint-sag@r_shoulder_y");
    assert_eq!(effect["class"][1], "joint-eccentricity@r_shoulder_y");
    assert_eq!(effect["runner_up"][0], "joint-eccentricity@r_shoulder_y");
    for key in ["rows", "before_mm", "after_mm", "floor_mm", "closure"] {
        assert!(json["held_out"][key].is_number(), "{key} in {}", json["held_out"]);
    }
    assert!(json["unexplained"]["p_value"].is_f64() && json["unexplained"]["depends_on"].is_array());
    assert!(json["next_experiment"]["what"].is_string());
    assert!(json["next_experiment"]["expected_probability"].is_f64());
}

#[test]
fn each_verdict_has_its_word_and_image_points_are_in_pixels() {
    let verdicts = [
        (sample::no_gap(), "no-gap"),
        (sample::named(), "named"),
        (sample::class(), "class"),
        (sample::not_in_library(), "not-in-library"),
    ];
    for (finding, word) in verdicts {
        assert_eq!(json(finding)["verdict"], word);
    }
    let held_out = &json(sample::pixels())["held_out"];
    assert_eq!(held_out["before_px"], 2.31);
    assert!(held_out.get("before_mm").is_none(), "{held_out}");
}

#[test]
fn without_a_next_experiment_there_is_none() {
    assert!(json(sample::named())["next_experiment"].is_null());
}
