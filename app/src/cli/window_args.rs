//! What the command line says about the window.

mod detect_steps;
mod gap_steps;
mod label_steps;
mod robot_steps;
mod touch_steps;

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use plumbline_model::duration;

use crate::operator::{Action, Screen};
use crate::window::renderer::RendererChoice;
use crate::window::{LaunchOptions, ScriptStep, ThemeChoice, launch};

/// A script waits no longer than this between two steps.
const LONGEST_WAIT: Duration = Duration::from_secs(24 * 3600);

#[derive(Debug, Args)]
pub struct WindowArgs {
    /// What to open: a folder of pairs (or with `left` and `right` in it), or two folders or two
    /// videos, left eye first.
    #[arg(value_name = "PATH", num_args = 0..=2, conflicts_with = "cameras", value_parser = existing)]
    paths: Vec<PathBuf>,
    /// Two USB cameras by number, left eye first: 0,2.
    #[arg(long, value_name = "LEFT,RIGHT", value_parser = cameras)]
    cameras: Option<(u32, u32)>,
    /// The simulated robot to start with when nothing is opened: lab (like the real robot, with
    /// its errors), perfect, or none.
    #[arg(long, value_name = "SCENARIO", default_value = "lab", value_parser = scenario)]
    twin: String,
    /// What draws the window.
    #[arg(long, value_enum, default_value_t)]
    renderer: RendererChoice,
    /// Colors of the window, in place of the remembered ones.
    #[arg(long, value_enum)]
    theme: Option<ThemeChoice>,
    /// Screen to start with: live, collect, judge, accept, mount, touch, models, gap, robot, images or scores.
    #[arg(long, value_name = "SCREEN", value_parser = screen)]
    screen: Option<Screen>,
    /// Size of the window in points: 1280x800.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size)]
    size: Option<[f32; 2]>,
    /// Saves a picture of the window once it has come to rest, and closes it.
    #[arg(long, value_name = "FILE")]
    screenshot: Option<PathBuf>,
    /// Folder of the window's settings, in place of the user's configuration folder.
    #[arg(long, value_name = "DIR", hide_short_help = true)]
    config_dir: Option<PathBuf>,
    /// Folder of accepted calibrations, in place of the user's data folder.
    #[arg(long, value_name = "DIR", hide_short_help = true)]
    data_dir: Option<PathBuf>,
    /// Does things without an operator, one after the other, each once the one before is done:
    /// collect, solve, judge, accept, compare, live, play, next, stop, palette, log, inspector,
    /// messages, frame-times, pair:N, probe:U,V, rate:HZ, wait:SECONDS, measure, picture:FILE, quit;
    /// with the robot: robot, mount, connect, connect-twin, connect-port:PATH, disconnect,
    /// preview-pose:NAME, preview-joint:NAME=DEGREES, look-at:X,Y,Z, reach:X,Y,Z (meters), move,
    /// forget, release, hold, speed:SHARE, joint:NAME, twin-board-tour, twin-board:N, twin-board-lay,
    /// twin-board-at:X,Y,DEGREES,
    /// twin-board-away, twin-toy:NAME,X,Y, twin-toy-away:NAME, twin-warm-up:MINUTES, twin-cool,
    /// twin-fault:NAME=on, twin-reset, mount-plan, mount-tour, mount-capture, mount-solve,
    /// mount-accept, mount-discard; touch, models, touch-plan-corners, touch-plan-quick,
    /// touch-plan-train, touch-plan-rich, touch-plan-check, touch-correct:METHOD, touch-start,
    /// touch-pause, touch-resume, touch-skip, touch-prepared, touch-finish, touch-close,
    /// touch-accept-screen, touch-discard-screen, touch-nominal-screen, touch-window;
    /// detect-boxes, detect-file:FILE, detect-shipped, detect-off, detect-confidence:SHARE,
    /// detect-overlap:SHARE, detect-hide:CLASS, detect-show:CLASS, detect-all-classes, detect-reset,
    /// object:CLASS;
    /// gap, gap-session:FOLDER, gap-list, gap-nominal, gap-in-use, gap-find, gap-add, gap-next,
    /// gap-report:FILE, gap-report-pdf:FILE, gap-delete, gap-undo, gap-take-out, gap-map-before,
    /// gap-map-after, gap-map-both, gap-pane-compare, gap-pane-names, gap-pane-candidates,
    /// gap-pane-shown, gap-pane-next, gap-pane-history;
    /// models-list, models-train, models-accept, models-accept-m1 (m2, m3), models-show-m1 (m2, m3),
    /// models-discard, models-undo, models-none, models-check, models-training, models-compared,
    /// models-map, models-map-before, models-map-after, models-map-both, models-tables;
    /// images, labels-open:FOLDER, labels-new:FOLDER, labels-add, labels-image:NAME, labels-next,
    /// labels-previous, labels-next-open, labels-box:CLASS,X0,Y0,X1,Y1, labels-choose:N, labels-undo,
    /// labels-redo, labels-copy, labels-propose, labels-accept, labels-nothing, labels-to-check,
    /// labels-checks, labels-list, labels-import:FOLDER, labels-accept-import, labels-export:FOLDER,
    /// labels-close; scores, scores-model:FILE, scores-set:FOLDER, scores-train, scores-evaluate,
    /// scores-table, scores-classes, scores-cell:TRUTH,FOUND, scores-picture:N, scores-csv:FILE.
    #[arg(long = "do", value_name = "STEPS", value_delimiter = ';', value_parser = step, hide_short_help = true)]
    script: Vec<ScriptStep>,
    /// Writes how long the frames took, as JSON, when the window is closed.
    #[arg(long, value_name = "FILE", hide_short_help = true)]
    frame_report: Option<PathBuf>,
}

impl WindowArgs {
    /// Opens the window.
    pub fn launch(self) -> anyhow::Result<()> {
        let mut script = self.script;
        if let Some(file) = self.screenshot {
            script.extend([ScriptStep::Picture(file), ScriptStep::Quit]);
        }
        launch(LaunchOptions {
            paths: self.paths,
            cameras: self.cameras,
            twin: (self.twin != "none").then_some(self.twin),
            renderer: self.renderer,
            theme: self.theme,
            screen: self.screen,
            size: self.size,
            config_dir: self.config_dir,
            data_dir: self.data_dir,
            script,
            frame_report: self.frame_report,
        })
    }
}

/// A mistyped verb looks like a source; better said here than in an empty window.
fn existing(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    if path.exists() {
        return Ok(path);
    }
    Err("there is no such file or folder, and no command of that name: see --help".to_owned())
}

fn cameras(text: &str) -> Result<(u32, u32), String> {
    let numbers =
        text.split_once(',').and_then(|(l, r)| Some((l.trim().parse().ok()?, r.trim().parse().ok()?)));
    match numbers {
        Some((left, right)) if left != right => Ok((left, right)),
        Some(_) => Err("the two eyes need two different cameras".to_owned()),
        None => Err("give two camera numbers, left eye first, for example 0,2".to_owned()),
    }
}

fn scenario(text: &str) -> Result<String, String> {
    let known: Vec<&str> = plumbline_engine::robot::scenarios().collect();
    if text == "none" || known.contains(&text) {
        return Ok(text.to_owned());
    }
    Err(format!("there are the scenarios {}, and none", known.join(", ")))
}

fn size(text: &str) -> Result<[f32; 2], String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    sides
        .filter(|[w, h]: &[f32; 2]| (200.0..=16384.0).contains(w) && (200.0..=16384.0).contains(h))
        .ok_or_else(|| "give width and height in points, for example 1280x800".to_owned())
}

fn screen(text: &str) -> Result<Screen, String> {
    match text {
        "live" => Ok(Screen::Live),
        "eyes" | "collect" => Ok(Screen::Collect),
        "judge" => Ok(Screen::Judge),
        "accept" | "compare" => Ok(Screen::Accept),
        "mount" => Ok(Screen::Mount),
        "touch" => Ok(Screen::Touch),
        "models" => Ok(Screen::Models),
        "gap" => Ok(Screen::Gap),
        "robot" => Ok(Screen::Robot),
        "detect" | "images" => Ok(Screen::Images),
        "scores" => Ok(Screen::Scores),
        _ => Err("there are the screens live, collect, judge, accept, mount, touch, models, gap, robot, images and scores"
            .to_owned()),
    }
}

fn step(text: &str) -> Result<ScriptStep, String> {
    let (name, value) = text.split_once(':').unwrap_or((text, ""));
    let act = |action| Ok(ScriptStep::Act(action));
    let seconds = |text: &str| {
        let seconds = text.parse::<f64>().ok().and_then(duration::seconds);
        seconds.filter(|time| *time <= LONGEST_WAIT)
    };
    let rate = |text: &str| text.parse::<f64>().ok().filter(|hz| (0.01..=1000.0).contains(hz));
    match name.trim() {
        "collect" => act(Action::CollectRecording),
        "capture" => act(Action::Capture),
        "solve" => act(Action::Solve),
        "accept" => act(Action::Accept),
        "live" => act(Action::Go(Screen::Live)),
        "eyes" => act(Action::Go(Screen::Collect)),
        "judge" => act(Action::Go(Screen::Judge)),
        "compare" => act(Action::Go(Screen::Accept)),
        "play" => act(Action::PlayPause),
        "forward" => act(Action::StepForward),
        "next" => act(Action::Next),
        "stop" => act(Action::Stop),
        "palette" => act(Action::Palette),
        "log" => act(Action::ToggleLog),
        "inspector" => act(Action::ToggleInspector),
        "messages" => act(Action::ToggleNotices),
        "frame-times" => act(Action::ToggleFrameTimes),
        "measure" => Ok(ScriptStep::Measure),
        "quit" => Ok(ScriptStep::Quit),
        "pair" => value.parse().map(ScriptStep::ChoosePair).map_err(|_| "pair:N wants a number".to_owned()),
        "probe" => {
            let at = value.split_once(',').and_then(|(u, v)| Some([u.parse().ok()?, v.parse().ok()?]));
            at.map(ScriptStep::Probe).ok_or_else(|| "probe:U,V wants a pixel".to_owned())
        }
        "rate" => {
            let wants = || "rate:HZ wants pairs per second between 0.01 and 1000".to_owned();
            rate(value).map(ScriptStep::PairsPerSecond).ok_or_else(wants)
        }
        "wait" => {
            let wants = || format!("wait:SECONDS wants a number from 0 to {}", LONGEST_WAIT.as_secs());
            seconds(value).map(ScriptStep::Wait).ok_or_else(wants)
        }
        "picture" if !value.is_empty() => Ok(ScriptStep::Picture(value.into())),
        other => robot_steps::step(other, value)
            .or_else(|| touch_steps::step(other, value))
            .or_else(|| gap_steps::step(other, value))
            .or_else(|| label_steps::step(other, value))
            .or_else(|| detect_steps::step(other, value))
            .unwrap_or_else(|| Err(format!("\"{other}\" is not a step; plumbline --help lists them"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_are_two_different_numbers() {
        assert_eq!(cameras("0, 2"), Ok((0, 2)));
        assert!(cameras("1,1").is_err() && cameras("0").is_err() && cameras("a,b").is_err());
    }

    #[test]
    fn sizes_and_steps_say_what_they_want() {
        assert_eq!(size("1280x800"), Ok([1280.0, 800.0]));
        assert!(size("1280").expect_err("one number").contains("1280x800"));
        assert_eq!(step("probe:320,240.5"), Ok(ScriptStep::Probe([320.0, 240.5])));
        assert_eq!(step("wait:1.5"), Ok(ScriptStep::Wait(Duration::from_millis(1500))));
        assert!(step("dance").is_err());
        for bad in ["wait:-1", "wait:NaN", "wait:inf", "wait:1e30", "wait:86401", "wait:soon"] {
            assert!(step(bad).expect_err(bad).contains("from 0 to 86400"), "{bad}");
        }
        for bad in ["rate:0", "rate:-1", "rate:NaN", "rate:1e-30", "rate:1e9", "rate:fast"] {
            assert!(step(bad).expect_err(bad).contains("between 0.01 and 1000"), "{bad}");
        }
        assert_eq!(step("rate:4"), Ok(ScriptStep::PairsPerSecond(4.0)));
    }
}
