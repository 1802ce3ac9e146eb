//! What a script can ask of the window. A step is `NAME` or `NAME:VALUE`, the value being JSON or
//! plain text. There is no list of steps: they are what the window's own few, the operator's actions
//! and the engine's commands are serialized as.

use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

use plumbline_engine::Command;
use plumbline_model::{ClassIndex, PixelBox, duration};
use serde::de::Error;
use serde::{Deserialize, Deserializer};
use serde_json::{Value, json};

use crate::operator::{Action, Pane};
use crate::panels::arrows::Errors;

/// One thing to do.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ScriptStep {
    /// As if its button were pressed: an action by its name.
    #[serde(skip)]
    Act(Action),
    /// Hands a command to the engine: its workflow, and what the journal has of it.
    #[serde(skip)]
    Send(Command),
    /// Lets time pass, seconds.
    #[serde(deserialize_with = "waiting")]
    Wait(Duration),
    /// Saves a picture of the window.
    Picture(PathBuf),
    /// Closes the window.
    Quit,
    /// Forgets the frame times so far.
    Measure,
    /// Brings a pane of the open screen to the front.
    Show(Pane),
    /// Which errors the maps of model and gap show.
    Errors(Errors),
    /// Keeps measuring at this pixel of the raw left image.
    Probe([f64; 2]),
    /// Chooses the pair with this place in the list.
    Pair(usize),
    /// Chooses the surest object of a class.
    Object(String),
    /// Chooses a joint for the inspector.
    Joint(String),
    /// Shows one joint at an angle (degrees), without moving.
    PreviewJoint(String, f64),
    /// Draws a box on the shown image of the data set.
    DrawBox(ClassIndex, PixelBox),
    /// Chooses a box of it, by place.
    ChooseBox(usize),
}

/// A script waits no longer than this between two steps.
const LONGEST_WAIT: Duration = Duration::from_secs(24 * 3600);

fn waiting<'de, D: Deserializer<'de>>(given: D) -> Result<Duration, D::Error> {
    let time = Value::deserialize(given)?.as_f64().and_then(duration::seconds);
    time.filter(|time| *time <= LONGEST_WAIT)
        .ok_or_else(|| D::Error::custom(format!("wants seconds from 0 to {}", LONGEST_WAIT.as_secs())))
}

impl ScriptStep {
    /// What can be written, for people.
    pub fn help() -> String {
        let actions: Vec<String> = Action::named().map(Action::name).collect();
        format!("{HELP}{}.", actions.join(", "))
    }
}

/// What `--help` says before it lists the actions.
const HELP: &str = r#"Does things without an operator, one after the other, each once the one before is done. A step is NAME or NAME:VALUE, the value being JSON or plain text; steps are separated by semicolons. A grasp that waits at "Stop after each step" is gone on with by grasp:resume; a script without that step ends there, says which step waits, and fails.

Of the window: wait:SECONDS, picture:FILE, quit, measure, show:PANE (gap-names, model-map, label-checks, …), errors:before (after, both), probe:U,V, pair:N, object:CLASS, joint:NAME, preview-joint:"NAME",DEGREES, draw-box:CLASS,[X0,Y0,X1,Y1], choose-box:N.

Of the engine, as the journal has it, WORKFLOW:COMMAND: source:{"pairs-per-second":30}, robot:{"preview":{"pose":{"name":"touch-ready"}}}, gap:{"choose":{"sessions":["FOLDER"]}}, and so on; or a whole line of a journal.

Everything that a button or the list of commands does, by its name: "#;

impl FromStr for ScriptStep {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        if text.starts_with('{') {
            let command = serde_json::from_str(text).map(Self::Send);
            return command.map_err(|why| format!("{text} is no command as the journal has it: {why}"));
        }
        let unknown = |name: &str| format!("\"{name}\" is not a step; plumbline --help lists them");
        let Some((name, value)) = text.split_once(':').filter(|(_, value)| !value.is_empty()) else {
            let action = || Action::named().find(|action| action.name() == text).map(Self::Act);
            let own = serde_json::from_value(Value::from(text)).ok();
            return own.or_else(action).ok_or_else(|| unknown(text));
        };
        let mut why = None;
        for value in meanings(value) {
            let own = serde_json::from_value(json!({ name: value }));
            let command = json!({ "workflow": name, "command": value });
            let command = serde_json::from_value(command).map(Self::Send);
            match (own, command) {
                (Ok(step), _) | (_, Ok(step)) => return Ok(step),
                (Err(own), Err(command)) => {
                    why.get_or_insert(if is_unknown(name, &own) { command } else { own })
                }
            };
        }
        Err(match why {
            Some(why) if !is_unknown(name, &why) => format!("\"{text}\": {why}"),
            _ => unknown(name),
        })
    }
}

/// What a value can stand for: JSON, the inside of a JSON array, a text.
fn meanings(value: &str) -> impl Iterator<Item = Value> {
    let json = serde_json::from_str(value).ok();
    let array = serde_json::from_str(&format!("[{value}]")).ok();
    json.or(array).into_iter().chain([Value::from(value)])
}

/// Whether it is the name that is wrong, and not the value.
fn is_unknown(name: &str, error: &serde_json::Error) -> bool {
    error.to_string().starts_with(&format!("unknown variant `{name}`"))
}

#[cfg(test)]
mod tests {
    use crate::operator::snapshot::models::Method;
    use plumbline_engine::{
        ConfusionCell, DetectCommand, GapCommand, LabelsCommand, ScoresCommand, SourceCommand, TouchCommand,
        TwinCommand,
    };

    use super::*;
    use crate::operator::{GapAction, ModelsAction, RobotAction, Screen, TouchAction};

    fn step(text: &str) -> Result<ScriptStep, String> {
        text.parse()
    }

    fn sent(command: impl Into<Command>) -> Result<ScriptStep, String> {
        Ok(ScriptStep::Send(command.into()))
    }

    #[test]
    fn steps_of_the_window_say_what_they_want() {
        assert_eq!(step("probe:320,240.5"), Ok(ScriptStep::Probe([320.0, 240.5])));
        assert_eq!(step("wait:1.5"), Ok(ScriptStep::Wait(Duration::from_millis(1500))));
        assert_eq!(step(" quit"), Ok(ScriptStep::Quit));
        assert_eq!(step("picture:a folder/b.png"), Ok(ScriptStep::Picture("a folder/b.png".into())));
        assert_eq!(step("picture:7"), Ok(ScriptStep::Picture("7".into())));
        assert_eq!(step("errors:after"), Ok(ScriptStep::Errors(Errors::After)));
        assert_eq!(step("show:gap-names"), Ok(ScriptStep::Show(Pane::GapNames)));
        let elbow = ScriptStep::PreviewJoint("r_elbow_y".to_owned(), 92.5);
        assert_eq!(step(r#"preview-joint:"r_elbow_y",92.5"#), Ok(elbow));
        let area = PixelBox::new(1.0, 2.0, 30.5, 40.0);
        assert_eq!(step("draw-box:7,[1,2,30.5,40]"), Ok(ScriptStep::DrawBox(ClassIndex(7), area)));
        for bad in ["dance", "dance:3", "picture", "picture:", "quit:7", "touch-dance", "gap-dance", ""] {
            let why = step(bad).expect_err(bad);
            assert!(why.contains("--help") || bad == "quit:7", "{why}");
        }
        for bad in ["wait:-1", "wait:NaN", "wait:inf", "wait:1e30", "wait:86401", "wait:soon"] {
            assert!(step(bad).expect_err(bad).contains("from 0 to 86400"), "{bad}");
        }
        for bad in ["draw-box:8,[1,2]", "probe:1", "probe:a,b", "pair:x", "preview-joint:92.5", "show:dance"]
        {
            let why = step(bad).expect_err(bad);
            assert!(why.contains(bad) && why.contains("expected"), "{why}");
        }
    }

    #[test]
    fn actions_are_called_by_their_names() {
        let act = |action| Ok(ScriptStep::Act(action));
        assert_eq!(step("go-judge"), act(Action::Go(Screen::Judge)));
        assert_eq!(step("robot-move"), act(Action::Robot(RobotAction::Move)));
        assert_eq!(step("touch-start"), act(Action::Touch(TouchAction::Start)));
        assert_eq!(step("gap-find"), act(Action::Gap(GapAction::Find)));
        assert_eq!(step("models-accept-m3"), act(Action::Models(ModelsAction::Accept(Method::M3))));
        for action in Action::named().filter(|action| *action != Action::Quit) {
            assert_eq!(step(&action.name()), act(action), "{}", action.name());
            assert!(ScriptStep::help().contains(&action.name()));
        }
    }

    #[test]
    fn commands_are_written_as_the_journal_has_them() {
        assert_eq!(step(r#"source:{"pairs-per-second":4}"#), sent(SourceCommand::PairsPerSecond(4.0)));
        let two = GapCommand::Choose { sessions: vec!["a".into(), "b".into()] };
        assert_eq!(step(r#"gap:{"choose":{"sessions":["a","b"]}}"#), sent(two));
        assert_eq!(step("touch:start"), sent(TouchCommand::Start));
        let line = r#"{"at_secs":2.5,"newest_seq":7,"workflow":"touch","command":"start"}"#;
        assert_eq!(step(line), sent(TouchCommand::Start), "a line of a journal");
        let with = TouchCommand::CorrectWith(Some(Method::M3.into()));
        assert_eq!(step(r#"touch:{"correct-with":"m3"}"#), sent(with));
        let toy = TwinCommand::PlaceToy { toy: "tomato".to_owned(), x_m: 0.3, y_m: -0.1 };
        assert_eq!(step(r#"twin:{"place-toy":{"toy":"tomato","x_m":0.3,"y_m":-0.1}}"#), sent(toy));
        assert_eq!(step(r#"detect:{"confidence":0.5}"#), sent(DetectCommand::Confidence(0.5)));
        let open = LabelsCommand::Open { path: "toys".into() };
        assert_eq!(step(r#"labels:{"open":{"path":"toys"}}"#), sent(open));
        let missed = ConfusionCell { truth: Some(6), found: None };
        let open = ScoresCommand::OpenCell { model: 0, cell: missed };
        assert_eq!(step(r#"scores:{"open-cell":{"model":0,"cell":{"truth":6,"found":null}}}"#), sent(open));
        for bad in [
            "{}",
            "robot:speed",
            r#"robot:{"speed":"fast"}"#,
            r#"robot:{"speed":NaN}"#,
            "touch:dance",
            "gap:7",
        ] {
            let why = step(bad).expect_err(bad);
            assert!(why.contains(bad), "{why}");
        }
        assert!(step(r#"touch:{"correct-with":"M4"}"#).expect_err("no method").contains("effects"));
    }
}
