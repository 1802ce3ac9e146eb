//! How much processor time and memory the window takes with a live pair at 30 Hz.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use plumbline_offline::Figure;
use serde::Deserialize;

/// Calibrates, so that rectification, disparity and depth run, then looks at them.
const SCRIPT: &str = r#"go-collect;collect-recording;solve;accept;go-live;source:{"pairs-per-second":30};wait:3;measure;wait:20"#;
const PATIENCE: Duration = Duration::from_secs(180);

#[derive(Deserialize)]
struct FrameReport {
    frames: u64,
    median_ms: f64,
    percentile_95_ms: f64,
    longest_ms: f64,
    over_100_ms: u64,
    resident_before_mb: Option<f64>,
    resident_mb: Option<f64>,
    renderer: String,
}

/// Opens the window on chessboard pairs (a folder with `left` and `right`) and measures.
pub fn figures(pairs: &Path) -> Vec<Figure> {
    const WHAT: &str = "window with a live pair at 30 Hz, 95 of 100 frames within";
    match measure(pairs) {
        Ok(report) => {
            let note = format!("{} frames, drawn by {}", report.frames, report.renderer);
            let mut figures = vec![
                figure(WHAT, report.percentile_95_ms, "ms", Some(16.0), &note),
                figure("the same, half of the frames within", report.median_ms, "ms", None, &note),
                figure(
                    "the same, frames over 100 ms",
                    report.over_100_ms as f64,
                    "frames",
                    Some(0.0),
                    &format!("the longest took {:.1} ms", report.longest_ms),
                ),
            ];
            if let (Some(before), Some(after)) = (report.resident_before_mb, report.resident_mb) {
                let what = "the same, growth of memory in 20 s";
                figures.push(figure(
                    what,
                    after - before,
                    "MB",
                    Some(20.0),
                    &format!("{after:.0} MB in use"),
                ));
            }
            figures
        }
        Err(why) => {
            let note = Some(why.to_string());
            vec![Figure { what: WHAT.to_owned(), value: None, unit: "ms", at_most: None, peer: None, note }]
        }
    }
}

fn figure(what: &str, value: f64, unit: &'static str, at_most: Option<f64>, note: &str) -> Figure {
    let (what, note) = (what.to_owned(), Some(note.to_owned()));
    Figure { what, value: Some(value), unit, at_most, peer: None, note }
}

fn measure(pairs: &Path) -> anyhow::Result<FrameReport> {
    let folder = std::env::temp_dir().join(format!("plumbline-bench-{}", std::process::id()));
    let report = folder.join("frames.json");
    // A new one: what somebody else put there under this name is not used.
    std::fs::create_dir(&folder)?;
    let result = run_window(pairs, &folder, &report);
    let text = result.and_then(|()| Ok(std::fs::read_to_string(&report)?));
    // The folder is small and temporary: one that stays behind does no harm.
    let _ = std::fs::remove_dir_all(&folder);
    Ok(serde_json::from_str(&text?)?)
}

fn run_window(pairs: &Path, folder: &Path, report: &Path) -> anyhow::Result<()> {
    let program = std::env::current_exe()?;
    let mut command = if has_display() {
        Command::new(program)
    } else {
        let virtual_screen = in_path("xvfb-run")
            .ok_or_else(|| anyhow::anyhow!("there is no display, and no xvfb-run to make one"))?;
        let mut command = Command::new(virtual_screen);
        command.args(["-a", "-s", "-screen 0 1280x800x24"]).arg(program);
        command
    };
    command
        .arg(pairs)
        .args(["--size", "1280x800", "--do", SCRIPT, "--do", "quit", "--frame-report"])
        .arg(report);
    command.arg("--config-dir").arg(folder).arg("--data-dir").arg(folder);
    let mut child = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn()?;
    let start = Instant::now();
    while start.elapsed() < PATIENCE {
        if let Some(status) = child.try_wait()? {
            anyhow::ensure!(status.success(), "the window could not be opened");
            return Ok(());
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    child.kill()?;
    child.wait()?;
    anyhow::bail!("the window did not close by itself within {} s", PATIENCE.as_secs())
}

fn has_display() -> bool {
    ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|name| std::env::var_os(name).is_some_and(|v| !v.is_empty()))
}

fn in_path(program: &str) -> Option<PathBuf> {
    let paths = std::env::var_os("PATH")?;
    std::env::split_paths(&paths).map(|folder| folder.join(program)).find(|file| file.is_file())
}
