//! One camera, through OpenCV and Video4Linux.

use image::RgbImage;
use opencv::core::Mat;
use opencv::prelude::*;
use opencv::videoio::{self, VideoCapture, VideoWriter};

use super::settings::CameraSettings;
use crate::cv;

/// What a camera says that it delivers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Delivered {
    /// Width and height, pixels.
    pub size: (u32, u32),
    /// Frames per second.
    pub rate_hz: f64,
}

/// One eye's camera. Tests put another behind it.
pub(super) trait EyeCamera: Send {
    /// Waits for the next frame and keeps it; the moment this returns is the time of capture.
    /// An error means that the camera is gone.
    fn grab(&mut self) -> Result<(), String>;
    /// Decodes the frame kept by `grab`. An error means that this one frame is damaged.
    fn retrieve(&mut self) -> Result<RgbImage, String>;
    /// What it delivers.
    fn delivers(&self) -> Delivered;
}

/// A camera of this machine.
pub(super) struct V4lCamera {
    number: u32,
    capture: VideoCapture,
    delivered: Delivered,
    decoded: Mat,
}

impl V4lCamera {
    /// Opens /dev/video`number`, asks for the settings and waits for a first frame.
    /// The error says why it does not work and what to do.
    pub(super) fn open(number: u32, settings: &CameraSettings) -> Result<Self, String> {
        let path = super::device::device_path(number);
        match std::fs::File::open(&path) {
            Ok(_) => {}
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return Err(format!("there is no {}; plug it in, or choose another number", path.display()));
            }
            Err(error) if error.kind() == std::io::ErrorKind::PermissionDenied => {
                return Err(format!(
                    "you may not open {}; add yourself to the group video (sudo usermod -aG video $USER) and log in again",
                    path.display()
                ));
            }
            Err(error) => {
                return Err(format!("{} cannot be opened ({error}); plug it in again", path.display()));
            }
        }
        cv::quiet();
        let index = i32::try_from(number).map_err(|_| format!("{number} is no camera number"))?;
        let mut capture = VideoCapture::new(index, videoio::CAP_V4L2).map_err(|error| cv::message(&error))?;
        if !capture.is_opened().unwrap_or(false) {
            return Err(format!(
                "{} delivers no images: another program may be using it, or it is not the camera's image device; `plumbline doctor` lists the cameras",
                path.display()
            ));
        }
        ask_for(&mut capture, settings).map_err(|error| cv::message(&error))?;
        let delivered = Delivered { size: (0, 0), rate_hz: 30.0 };
        let mut camera = Self { number, capture, delivered, decoded: Mat::default() };
        camera.grab().map_err(|_| {
            "it opens but sends no image: close other programs that use it; if both cameras share a USB controller, plug one in elsewhere or ask for compressed frames".to_owned()
        })?;
        camera.delivered.size = camera.retrieve()?.dimensions();
        if let Ok(rate_hz) = camera.capture.get(videoio::CAP_PROP_FPS)
            && (0.1..=1000.0).contains(&rate_hz)
        {
            camera.delivered.rate_hz = rate_hz;
        }
        Ok(camera)
    }
}

/// The pixel format first, because it decides which sizes and rates there are. What a
/// camera does not know it leaves as it is.
fn ask_for(capture: &mut VideoCapture, settings: &CameraSettings) -> opencv::Result<()> {
    if settings.compressed {
        let mjpg = VideoWriter::fourcc('M', 'J', 'P', 'G')?;
        capture.set(videoio::CAP_PROP_FOURCC, f64::from(mjpg))?;
    }
    if let Some((width, height)) = settings.size {
        capture.set(videoio::CAP_PROP_FRAME_WIDTH, f64::from(width))?;
        capture.set(videoio::CAP_PROP_FRAME_HEIGHT, f64::from(height))?;
    }
    if let Some(rate_hz) = settings.rate_hz {
        capture.set(videoio::CAP_PROP_FPS, rate_hz)?;
    }
    Ok(())
}

impl EyeCamera for V4lCamera {
    fn grab(&mut self) -> Result<(), String> {
        match self.capture.grab() {
            Ok(true) => Ok(()),
            _ if !super::device::device_path(self.number).exists() => {
                Err("was unplugged; plug it in again".to_owned())
            }
            _ => Err("stopped sending images; check its cable, or plug it in again".to_owned()),
        }
    }

    fn retrieve(&mut self) -> Result<RgbImage, String> {
        match self.capture.retrieve_def(&mut self.decoded) {
            Ok(true) => cv::rgb_image(&self.decoded),
            Ok(false) => Err("the frame is damaged".to_owned()),
            Err(error) => Err(cv::message(&error)),
        }
    }

    fn delivers(&self) -> Delivered {
        self.delivered
    }
}
