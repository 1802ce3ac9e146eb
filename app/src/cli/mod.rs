//! The command line: the window without a verb, the work on recorded data with one.

mod bench;
mod bench_window;
mod calibrate;
mod commission;
mod common;
mod correct;
mod detect;
mod detect_eval;
mod detector_set;
mod disparity;
mod doctor;
mod gap;
mod grasp;
mod grid;
mod health;
mod ik;
mod lerobot;
mod locate;
mod output;
mod predict;
mod rig;
mod sample;
mod train;
mod window_args;

use std::process::ExitCode;

use clap::{Args, CommandFactory as _, FromArgMatches as _, Parser, Subcommand};

use output::Output;
use window_args::WindowArgs;

/// See, measure and calibrate with the stereo eyes of NICO.
///
/// Without a command the window opens, on a source if one is given: a folder of pairs, two
/// folders, two videos, or two cameras. The commands do on recorded data what the window does,
/// for scripts and checks.
#[derive(Debug, Parser)]
#[command(name = "plumbline", version, args_conflicts_with_subcommands = true, after_help = AFTER_HELP)]
struct Arguments {
    #[command(subcommand)]
    verb: Option<Verb>,
    #[command(flatten)]
    window: WindowArgs,
}

const AFTER_HELP: &str = "Exit status of the commands: 0 done; 1 the work could not be done, and the message \
                          says why and what to do; 2 wrong usage.";

#[derive(Debug, Subcommand)]
enum Verb {
    /// Calibrates the eyes from chessboard pairs, or judges a calibration.
    #[command(subcommand)]
    Calibrate(Calibrate),
    /// Says where in space points of the left image are.
    Locate(WithJson<locate::Locate>),
    /// Finds the joint angles that bring a tip of the robot to targets.
    Ik(WithJson<ik::Ik>),
    /// Trains a correction model from the touches of a session.
    Train(WithJson<train::Train>),
    /// Says which points must be sent so that the fingertip lands on pixels of the touchscreen.
    Correct(WithJson<correct::Correct>),
    /// Says what the model of the robot expects each row of a session to have measured.
    Predict(WithJson<predict::Predict>),
    /// Finds where model and measurement disagree, names what is missing, shows the gap shrink.
    Gap(WithJson<gap::Gap>),
    /// Commissions a twin without a person: eyes, mount, screen, touches, effects; a judge measures it.
    Commission(WithJson<commission::Commission>),
    /// Finds things on images with a detector, an ONNX file.
    Detect(WithJson<detect::Detect>),
    /// Judges detectors on a labeled set: average precision by the rule of COCO, times.
    DetectEval(WithJson<detect_eval::DetectEval>),
    /// Draws labeled images of the twin with everything randomised, to train a detector on.
    DetectorSet(WithJson<detector_set::DetectorSet>),
    /// Grasps once on the twin.
    Grasp(WithJson<grasp::Grasp>),
    /// Runs the grasping experiment on the twin: positions, attempts, methods; in shards if wanted.
    GraspTrials(WithJson<grasp::GraspTrials>),
    /// Says from ordinary pairs, without a board, whether the calibration of the eyes still holds.
    Health(WithJson<health::Health>),
    /// Judges places on a grid of known targets, and what the published correction makes of them.
    Grid(WithJson<grid::Grid>),
    /// Writes a recording as a LeRobot data set, version 3.
    Lerobot(WithJson<lerobot::Lerobot>),
    /// Says whether a rig file is sound, or writes the robot with its effects for other programs.
    #[command(subcommand)]
    Rig(Rig),
    /// Computes the disparity of a pair.
    Disparity(WithJson<disparity::Disparity>),
    /// Says what works on this machine: libraries, graphics, cameras, serial ports, folders.
    Doctor(WithJson<doctor::Doctor>),
    /// Writes pairs of a made-up lab, to try the program without a camera.
    Sample(WithJson<sample::Sample>),
    /// Measures accuracy and speed on the reference data, beside published figures.
    Bench(WithJson<bench::Bench>),
}

#[derive(Debug, Subcommand)]
enum Calibrate {
    /// Chessboard pairs to a stereo calibration; no initial guess is needed.
    Stereo(WithJson<calibrate::Stereo>),
    /// Judges a calibration on pairs that it has not seen.
    Check(WithJson<calibrate::Check>),
}

#[derive(Debug, Subcommand)]
enum Rig {
    /// Everything that is wrong with a rig file and its description: line, what, what to do.
    Check(WithJson<rig::Check>),
    /// The robot with those effects that are constant geometry, as URDF or MJCF.
    Export(WithJson<rig::Export>),
}

#[derive(Debug, Args)]
struct WithJson<A: Args> {
    #[command(flatten)]
    arguments: A,
    /// Prints one JSON object on standard output and nothing else there. Lengths are in the unit
    /// that the key names. Where the work could not be done, its only key is `error`.
    #[arg(long)]
    json: bool,
}

impl<A: Args> WithJson<A> {
    fn run(self, verb: impl FnOnce(A, &Output) -> anyhow::Result<()>) -> ExitCode {
        let output = Output::new(self.json);
        let result = verb(self.arguments, &output);
        output.finish(result)
    }
}

/// Runs the program with the arguments it was started with.
pub fn run() -> ExitCode {
    let matches = Arguments::command().get_matches();
    let arguments = match Arguments::from_arg_matches(&matches) {
        Ok(arguments) => arguments,
        Err(error) => error.exit(),
    };
    match arguments.verb {
        None => output::finish_window(arguments.window.launch()),
        Some(verb) => {
            crate::window::start_log(log::LevelFilter::Warn);
            match verb {
                Verb::Calibrate(Calibrate::Stereo(verb)) => verb.run(calibrate::stereo),
                Verb::Calibrate(Calibrate::Check(verb)) => verb.run(calibrate::check),
                Verb::Locate(verb) => verb.run(locate::run),
                Verb::Ik(verb) => verb.run(ik::run),
                Verb::Train(verb) => verb.run(train::run),
                Verb::Correct(verb) => verb.run(correct::run),
                Verb::Predict(verb) => verb.run(predict::run),
                Verb::Gap(verb) => verb.run(gap::run),
                Verb::Commission(verb) => verb.run(commission::run),
                Verb::Detect(verb) => verb.run(detect::run),
                Verb::DetectEval(verb) => verb.run(detect_eval::run),
                Verb::DetectorSet(verb) => verb.run(detector_set::run),
                Verb::Grasp(verb) => verb.run(grasp::grasp),
                Verb::GraspTrials(verb) => verb.run(grasp::trials),
                Verb::Health(verb) => verb.run(health::run),
                Verb::Grid(verb) => verb.run(grid::run),
                Verb::Lerobot(verb) => verb.run(lerobot::run),
                Verb::Rig(Rig::Check(verb)) => verb.run(rig::check),
                Verb::Rig(Rig::Export(verb)) => verb.run(rig::export),
                Verb::Disparity(verb) => verb.run(disparity::run),
                Verb::Doctor(verb) => verb.run(doctor::run),
                Verb::Sample(verb) => verb.run(sample::run),
                Verb::Bench(verb) => verb.run(bench::run),
            }
        }
    }
}

/// Whether the command line understands these words, the program's name first; else what it says. Nothing
/// is done.
///
/// # Errors
/// What would be printed.
pub fn understands(words: impl IntoIterator<Item = String>) -> Result<(), String> {
    let matches = Arguments::command().try_get_matches_from(words).map_err(|error| error.to_string())?;
    Arguments::from_arg_matches(&matches).map(|_| ()).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_description_of_the_command_line_holds_together() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn paths_open_the_window_and_verbs_do_not() {
        // Tests run in the package's folder.
        let arguments = Arguments::try_parse_from(["plumbline", "src", "tests"]).expect("two paths");
        assert!(arguments.verb.is_none());
        let mistyped =
            Arguments::try_parse_from(["plumbline", "calibarte"]).expect_err("neither path nor verb");
        assert_eq!(mistyped.exit_code(), 2);
        let check = ["plumbline", "doctor", "--json"];
        assert!(matches!(Arguments::try_parse_from(check).expect("a verb").verb, Some(Verb::Doctor(_))));
    }

    #[test]
    fn wrong_usage_is_told_apart_from_failed_work() {
        let error = Arguments::try_parse_from(["plumbline", "calibrate", "stereo", "--board", "8by5"]);
        assert_eq!(error.expect_err("not a board").exit_code(), 2);
        let both =
            ["plumbline", "disparity", "--left", "l", "--right", "r", "--max-disparity", "64", "--out", "o"];
        assert!(Arguments::try_parse_from(both).is_err(), "neither a calibration nor --rectified");
    }
}
