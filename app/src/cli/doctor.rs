//! `plumbline doctor`: what works on this machine.

use std::path::PathBuf;

use clap::Args;
use plumbline_offline::doctor::{self, Check};
use serde::Serialize;

use super::output::Output;
use crate::window::renderer::{self, RendererChoice};

/// Arguments of `doctor`.
#[derive(Debug, Args)]
pub struct Doctor {
    /// Folder of accepted calibrations, in place of the user's data folder.
    #[arg(long, value_name = "DIR")]
    data_dir: Option<PathBuf>,
}

/// JSON of `doctor`.
#[derive(Debug, Serialize)]
struct Report {
    checks: Vec<Check>,
}

/// Looks at everything.
pub fn run(arguments: Doctor, output: &Output) -> anyhow::Result<()> {
    let data_dir = match arguments.data_dir {
        Some(folder) => folder,
        None => directories::ProjectDirs::from("", "", "plumbline")
            .map(|dirs| dirs.data_dir().to_owned())
            .ok_or_else(|| anyhow::anyhow!("this user has no home folder: give --data-dir"))?,
    };
    let mut checks = doctor::checks(&data_dir);
    checks.extend(graphics());
    checks.push(display());
    checks.push(file_dialogs());
    output.result(&Report { checks }, text)
}

/// Every adapter, and which renderer the window takes.
fn graphics() -> Vec<Check> {
    let adapters = renderer::adapters();
    let mut checks: Vec<Check> = adapters
        .iter()
        .map(|adapter| {
            let kind = if adapter.is_cpu { "the processor, no graphics card" } else { "graphics card" };
            Check::good(format!("{} adapter", adapter.backend), format!("{}: {kind}", adapter.name))
        })
        .collect();
    if adapters.is_empty() {
        let detail = "none found; the window is drawn with OpenGL instead";
        checks.push(Check::good("Vulkan adapter", detail));
    }
    checks.push(Check::good("renderer", renderer::choose(RendererChoice::Auto, &adapters).reason));
    checks
}

fn display() -> Check {
    let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
    match set("WAYLAND_DISPLAY").or_else(|| set("DISPLAY")) {
        Some(display) => Check::good("display", format!("{}", display.to_string_lossy())),
        None => Check::bad(
            "display",
            "none: the window cannot open here; the commands work, and so does the window under xvfb-run",
        ),
    }
}

/// Without the desktop's dialogs paths are typed; that works, so it is no failure.
fn file_dialogs() -> Check {
    let session = std::env::var_os("DBUS_SESSION_BUS_ADDRESS").is_some();
    let zenity = std::env::var_os("PATH")
        .is_some_and(|paths| std::env::split_paths(&paths).any(|folder| folder.join("zenity").is_file()));
    let detail = match (session, zenity) {
        (true, _) => "the desktop's, if it runs a portal; else paths are typed",
        (false, true) => "zenity",
        (false, false) => "none: paths are typed, or files dropped on the window",
    };
    Check::good("file dialogs", detail)
}

fn text(report: &Report) -> String {
    let width = report.checks.iter().map(|check| check.name.chars().count()).max().unwrap_or(0);
    report
        .checks
        .iter()
        .map(|check| {
            let sign = if check.ok { "ok  " } else { "FAIL" };
            format!("{sign}  {:width$}  {}\n", check.name, check.detail)
        })
        .collect()
}
