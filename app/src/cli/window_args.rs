//! What the command line says about the window.

use std::path::PathBuf;

use clap::Args;

use crate::operator::Screen;
use crate::window::renderer::RendererChoice;
use crate::window::{LaunchOptions, ScriptStep, ThemeChoice, launch};

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
    /// its errors), perfect, none, or a scenario file.
    #[arg(long, value_name = "SCENARIO|FILE.toml", default_value = "lab", value_parser = scenario)]
    twin: String,
    /// What draws the window.
    #[arg(long, value_enum, default_value_t)]
    renderer: RendererChoice,
    /// Colors of the window, in place of the remembered ones.
    #[arg(long, value_enum)]
    theme: Option<ThemeChoice>,
    /// Screen to start with: commission, live, collect, judge, accept, mount, touch, models, gap, hand-eye,
    /// grasp, drift, timeline, robot, images or scores.
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
    /// Does things without an operator.
    #[arg(long = "do", value_name = "STEPS", value_delimiter = ';', long_help = ScriptStep::help(), hide_short_help = true)]
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
    if text != "none" {
        plumbline_engine::robot::check_scenario(text).map_err(|why| format!("{why}; or none, or a file"))?;
    }
    Ok(text.to_owned())
}

fn size(text: &str) -> Result<[f32; 2], String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    sides
        .filter(|[w, h]: &[f32; 2]| (200.0..=16384.0).contains(w) && (200.0..=16384.0).contains(h))
        .ok_or_else(|| "give width and height in points, for example 1280x800".to_owned())
}

fn screen(text: &str) -> Result<Screen, String> {
    let name = match text {
        "eyes" => "collect",
        "compare" => "accept",
        "detect" => "images",
        name => name,
    };
    serde_json::from_value(name.into()).map_err(|_| {
        "there are the screens commission, live, collect, judge, accept, mount, touch, models, gap, hand-eye, grasp, drift, timeline, robot, images and scores"
            .to_owned()
    })
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
    fn sizes_and_screens_say_what_they_want() {
        assert_eq!(size("1280x800"), Ok([1280.0, 800.0]));
        assert!(size("1280").expect_err("one number").contains("1280x800"));
        assert_eq!(screen("judge"), Ok(Screen::Judge));
        assert_eq!((screen("eyes"), screen("compare")), (Ok(Screen::Collect), Ok(Screen::Accept)));
        assert!(screen("dance").expect_err("no screen").contains("images and scores"));
    }
}
