//! The command line: the window without a verb, the work on recorded data with one.

mod output;
mod window_args;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use window_args::WindowArgs;

/// See, measure and calibrate with the stereo eyes of NICO.
///
/// Without a command the window opens, on a source if one is given: a folder of pairs, two
/// folders, two videos, or two cameras. The commands do on recorded data what the window does,
/// for scripts.
#[derive(Debug, Parser)]
#[command(name = "plumbline", version, args_conflicts_with_subcommands = true)]
struct Arguments {
    #[command(subcommand)]
    verb: Option<Verb>,
    #[command(flatten)]
    window: WindowArgs,
}

#[derive(Debug, Subcommand)]
enum Verb {}

/// Runs the program with the arguments it was started with.
pub fn run() -> ExitCode {
    let arguments = Arguments::parse();
    match arguments.verb {
        None => output::finish_window(arguments.window.launch()),
        Some(_verb) => ExitCode::SUCCESS,
    }
}
