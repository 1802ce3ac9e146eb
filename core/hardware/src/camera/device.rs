//! Which cameras this machine has.

use std::path::{Path, PathBuf};

use super::capture::{EyeCamera, V4lCamera};
use super::settings::CameraSettings;
use crate::natural_order::natural_order;

const CLASS_FOLDER: &str = "/sys/class/video4linux";

/// A video device of this machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CameraDevice {
    /// N of /dev/videoN: the number by which a camera is opened.
    pub number: u32,
    /// Name the driver gives, for example `HD USB Camera`.
    pub name: String,
    /// Whether it delivers images. A USB camera has a second device for metadata only.
    pub delivers_images: bool,
    /// The port it is plugged into, which stays the same when the number changes.
    pub port: Option<String>,
}

/// What a camera did when it was tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraProbe {
    /// Width and height of its images, pixels.
    pub size: (u32, u32),
    /// Frames per second it says it delivers.
    pub rate_hz: f64,
}

/// The video devices in the order of their numbers; empty where there is none.
pub fn camera_devices() -> Vec<CameraDevice> {
    devices_in(Path::new(CLASS_FOLDER))
}

/// Opens a camera as it is set and takes one image. The error says why it does not work and
/// what to do. May take seconds.
pub fn probe_camera(number: u32) -> Result<CameraProbe, String> {
    let as_it_is = CameraSettings { size: None, rate_hz: None, ..CameraSettings::default() };
    let delivered = V4lCamera::open(number, &as_it_is)?.delivers();
    Ok(CameraProbe { size: delivered.size, rate_hz: delivered.rate_hz })
}

/// The file through which a camera is opened.
pub(super) fn device_path(number: u32) -> PathBuf {
    PathBuf::from(format!("/dev/video{number}"))
}

/// The port a camera is plugged into.
pub(crate) fn camera_port(number: u32) -> Option<String> {
    camera_devices().into_iter().find(|device| device.number == number)?.port
}

/// The number of the camera that is plugged into a port now.
pub(crate) fn camera_number_at_port(port: &str) -> Option<u32> {
    number_at_port(&camera_devices(), port)
}

fn number_at_port(devices: &[CameraDevice], port: &str) -> Option<u32> {
    let here = |device: &&CameraDevice| device.delivers_images && device.port.as_deref() == Some(port);
    devices.iter().find(here).map(|device| device.number)
}

fn devices_in(class_folder: &Path) -> Vec<CameraDevice> {
    let Ok(entries) = std::fs::read_dir(class_folder) else { return Vec::new() };
    let mut names: Vec<String> =
        entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort_by(|a, b| natural_order(a, b));
    names.iter().filter_map(|name| device_of(class_folder, name)).collect()
}

fn device_of(class_folder: &Path, entry: &str) -> Option<CameraDevice> {
    let number = entry.strip_prefix("video")?.parse().ok()?;
    let folder = class_folder.join(entry);
    let read =
        |file: &str| std::fs::read_to_string(folder.join(file)).ok().map(|text| text.trim().to_owned());
    let port = folder.join("device").canonicalize().ok();
    Some(CameraDevice {
        number,
        name: read("name").unwrap_or_else(|| "unnamed camera".to_owned()),
        // The driver counts the devices of one camera; images come from the first.
        delivers_images: read("index").is_none_or(|index| index == "0"),
        port: port.map(|path| path.to_string_lossy().into_owned()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::os::unix::fs::symlink;

    /// A folder as the kernel shows it: one USB camera is two devices at one port.
    fn plug_in(root: &Path, number: u32, index: u32, port: &str) {
        let device = root.join("devices").join(port);
        fs::create_dir_all(&device).expect("a device folder");
        let entry = root.join("class").join(format!("video{number}"));
        fs::create_dir_all(&entry).expect("a class entry");
        fs::write(entry.join("name"), "Eye Camera\n").expect("a name");
        fs::write(entry.join("index"), format!("{index}\n")).expect("an index");
        symlink(device, entry.join("device")).expect("a link");
    }

    #[test]
    fn a_camera_is_found_at_its_port_after_its_number_changed() {
        let root = tempfile::tempdir().expect("a temporary folder");
        let class = root.path().join("class");
        plug_in(root.path(), 0, 0, "usb1-1.1");
        plug_in(root.path(), 1, 1, "usb1-1.1");
        plug_in(root.path(), 10, 0, "usb1-1.2");
        let before = devices_in(&class);
        assert_eq!(before.iter().map(|d| d.number).collect::<Vec<_>>(), [0, 1, 10]);
        assert_eq!(before.iter().map(|d| d.delivers_images).collect::<Vec<_>>(), [true, false, true]);
        assert_eq!(before[0].name, "Eye Camera");
        let port = before[0].port.clone().expect("a port");

        fs::remove_dir_all(class.join("video0")).expect("unplugging");
        fs::remove_dir_all(class.join("video1")).expect("unplugging");
        assert_eq!(number_at_port(&devices_in(&class), &port), None);
        plug_in(root.path(), 2, 0, "usb1-1.3");
        fs::create_dir_all(class.join("video4")).expect("an entry");
        fs::write(class.join("video4/index"), "0").expect("an index");
        symlink(root.path().join("devices/usb1-1.1"), class.join("video4/device")).expect("a link");
        assert_eq!(number_at_port(&devices_in(&class), &port), Some(4));
    }

    #[test]
    fn no_cameras_is_an_empty_list() {
        let root = tempfile::tempdir().expect("a temporary folder");
        assert_eq!(devices_in(&root.path().join("nothing")), []);
        assert_eq!(devices_in(root.path()), []);
    }

    #[test]
    fn a_number_without_a_camera_says_what_to_do() {
        let problem = probe_camera(4321).expect_err("nobody has so many cameras");
        assert!(problem.contains("there is no /dev/video4321; plug it in"), "{problem}");
    }
}
