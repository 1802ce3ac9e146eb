//! What works on this machine: one check per thing that can be missing, each with a sentence
//! that says what was found or what to do.

mod detector;
mod processor;
mod serial;
mod twin;

use std::io::Write;
use std::path::Path;

use plumbline_hardware::{camera_devices, opencv_info, probe_camera};
use serde::Serialize;

/// One thing that works or does not.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Check {
    /// What was looked at, for example `camera 2`.
    pub name: String,
    /// Whether it works.
    pub ok: bool,
    /// What was found; if it does not work, why and what to do.
    pub detail: String,
}

impl Check {
    /// Something that works.
    pub fn good(name: impl Into<String>, detail: impl Into<String>) -> Self {
        Self { name: name.into(), ok: true, detail: detail.into() }
    }

    /// Something that does not work.
    pub fn bad(name: impl Into<String>, detail: impl Into<String>) -> Self {
        Self { name: name.into(), ok: false, detail: detail.into() }
    }
}

/// Looks at everything that needs no window: OpenCV, processor, memory, cameras, serial ports
/// and the folder for the program's data.
///
/// Opens every camera for one image, so it takes seconds and must not run while a camera is in
/// use by this program. Serial ports are not opened, because that makes some devices restart.
pub fn checks(data_folder: &Path) -> Vec<Check> {
    let mut checks = vec![opencv(), processor::instructions(), processor::cores(), processor::memory()];
    checks.extend(twin::checks());
    checks.extend(detector::checks());
    checks.extend(cameras());
    checks.extend(serial::ports());
    checks.push(writable(data_folder));
    checks
}

fn opencv() -> Check {
    match opencv_info() {
        Ok(info) => Check::good(
            "OpenCV",
            format!("version {}, up to {} threads, {}", info.version, info.threads, info.instructions),
        ),
        Err(problem) => Check::bad("OpenCV", format!("{problem}; run ./plumbline setup")),
    }
}

fn cameras() -> Vec<Check> {
    let devices: Vec<_> = camera_devices().into_iter().filter(|device| device.delivers_images).collect();
    let mut checks: Vec<Check> = devices
        .iter()
        .map(|device| {
            let name = format!("camera {}", device.number);
            match probe_camera(device.number) {
                Ok(probe) => Check::good(
                    name,
                    format!(
                        "{}: {}x{} px, {:.0} frames per second",
                        device.name, probe.size.0, probe.size.1, probe.rate_hz
                    ),
                ),
                Err(problem) => Check::bad(name, format!("{}: {problem}", device.name)),
            }
        })
        .collect();
    let enough = match devices.len() {
        0 => Check::bad("cameras", "none found; plug both eyes in, or work on recorded pairs"),
        1 => Check::bad("cameras", "only one found; live stereo needs two, recorded pairs need none"),
        count => Check::good("cameras", format!("{count} found")),
    };
    checks.insert(0, enough);
    checks
}

/// Writes a file and takes it away again: the only way to know.
fn writable(folder: &Path) -> Check {
    const NAME: &str = "data folder";
    let tried = std::fs::create_dir_all(folder).and_then(|()| {
        let probe = folder.join(format!(".write-test-{}", std::process::id()));
        let written = std::fs::File::create(&probe).and_then(|mut file| file.write_all(b"test"));
        // Also after a failed write (a full disk), and without hiding its reason.
        let removed = std::fs::remove_file(&probe);
        written.and(removed)
    });
    match tried {
        Ok(()) => Check::good(NAME, format!("{} can be written", folder.display())),
        Err(error) => Check::bad(
            NAME,
            format!(
                "{} cannot be written ({error}); calibrations and sessions would be lost: make room or change its permissions",
                folder.display()
            ),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_is_looked_at_and_says_something() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let checks = checks(folder.path());
        for part in [
            "OpenCV",
            "processor",
            "cores",
            "memory",
            "twin",
            "twin's eyes",
            "ONNX Runtime",
            "detector",
            "cameras",
            "serial ports",
            "data folder",
        ] {
            let found = checks.iter().filter(|check| check.name == part).count();
            assert_eq!(found, 1, "{part} in {checks:?}");
        }
        assert!(checks.iter().all(|check| !check.detail.is_empty()));
        let named: std::collections::BTreeSet<_> = checks.iter().map(|check| &check.name).collect();
        assert_eq!(named.len(), checks.len(), "a name tells which check it is: {checks:?}");
    }

    #[test]
    fn a_folder_is_made_and_left_empty() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let deep = folder.path().join("share/plumbline");
        let check = writable(&deep);
        assert!(check.ok, "{check:?}");
        assert_eq!(std::fs::read_dir(&deep).expect("it was made").count(), 0);
    }

    #[test]
    fn a_folder_that_cannot_be_is_told_with_a_way_out() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("file");
        std::fs::write(&file, "in the way").expect("writing");
        let check = writable(&file.join("plumbline"));
        assert!(!check.ok);
        assert!(
            check.detail.contains("cannot be written") && check.detail.contains("make room"),
            "{check:?}"
        );
    }

    #[test]
    fn the_keys_of_the_command_line_are_kept() {
        let json = serde_json::to_value(Check::bad("camera 2", "why")).expect("plain data");
        assert_eq!(json, serde_json::json!({"name": "camera 2", "ok": false, "detail": "why"}));
    }
}
