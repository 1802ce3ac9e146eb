//! One camera, through OpenCV and Video4Linux.

use std::sync::Arc;

use image::RgbImage;
use opencv::core::{Mat, Vector};
use opencv::imgcodecs;
use opencv::prelude::*;
use opencv::videoio::{self, VideoCapture, VideoWriter};

use super::settings::CameraSettings;
use crate::{cv, jpeg};

/// What a camera says that it delivers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Delivered {
    /// Width and height, pixels.
    pub size: (u32, u32),
    /// Frames per second.
    pub rate_hz: f64,
}

/// A frame.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Captured {
    /// 8-bit RGB.
    pub image: RgbImage,
    /// As the camera has compressed it, where it did and left out nothing that decoders need.
    pub jpeg: Option<Arc<[u8]>>,
}

/// One eye's camera. Tests put another behind it.
pub(super) trait EyeCamera: Send {
    /// Waits for the next frame and keeps it; the moment this returns is the time of capture.
    /// An error means that the camera is gone.
    fn grab(&mut self) -> Result<(), String>;
    /// Decodes the frame kept by `grab`. An error means that this one frame is damaged.
    fn retrieve(&mut self) -> Result<Captured, String>;
    /// What it delivers.
    fn delivers(&self) -> Delivered;
}

/// A camera of this machine.
pub(super) struct V4lCamera {
    number: u32,
    capture: VideoCapture,
    delivered: Delivered,
    received: Mat,
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
        let mut camera = Self { number, capture, delivered, received: Mat::default() };
        camera.ask_for_jpeg(true);
        camera.grab_first()?;
        let first = match camera.retrieve() {
            Ok(first) => first,
            // It says that it compresses, and its driver does not hand that out: OpenCV decodes as ever.
            Err(_) => {
                camera.ask_for_jpeg(false);
                camera.grab_first()?;
                camera.retrieve()?
            }
        };
        camera.delivered.size = first.image.dimensions();
        if let Ok(rate_hz) = camera.capture.get(videoio::CAP_PROP_FPS)
            && (0.1..=1000.0).contains(&rate_hz)
        {
            camera.delivered.rate_hz = rate_hz;
        }
        Ok(camera)
    }

    fn grab_first(&mut self) -> Result<(), String> {
        self.grab().map_err(|_| {
            "it opens but sends no image: close other programs that use it; if both cameras share a USB controller, plug one in elsewhere or ask for compressed frames".to_owned()
        })
    }

    /// Whether frames of a camera that compresses them come as it has sent them, so that a recording keeps just these.
    /// A driver that knows nothing of it leaves them as they are.
    fn ask_for_jpeg(&mut self, as_sent: bool) {
        let code = self.capture.get(videoio::CAP_PROP_FOURCC).unwrap_or_default();
        let compresses = VideoWriter::fourcc('M', 'J', 'P', 'G').is_ok_and(|mjpg| f64::from(mjpg) == code);
        let decoded_by_opencv = if as_sent && compresses { 0.0 } else { 1.0 };
        if let Err(error) = self.capture.set(videoio::CAP_PROP_CONVERT_RGB, decoded_by_opencv) {
            log::debug!("camera {} decodes as it does: {}", self.number, cv::message(&error));
        }
    }
}

/// A frame as OpenCV hands it out: pixels, or one row of bytes that are a JPEG.
pub(super) fn captured(received: &Mat) -> Result<Captured, String> {
    let is_sent = received.rows() == 1 && received.channels() == 1;
    if !is_sent {
        return Ok(Captured { image: cv::rgb_image(received)?, jpeg: None });
    }
    let buffer = received.data_bytes().map_err(|error| cv::message(&error))?;
    let Some(bytes) = jpeg::whole(buffer) else {
        return Err("the frame is damaged: its end is missing".to_owned());
    };
    let sent = Vector::from_slice(bytes);
    let pixels = imgcodecs::imdecode(&sent, imgcodecs::IMREAD_COLOR).map_err(|error| cv::message(&error))?;
    // What is recorded must be read by every program.
    let jpeg = jpeg::has_huffman_tables(bytes).then(|| bytes.into());
    Ok(Captured { image: cv::rgb_image(&pixels)?, jpeg })
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

    fn retrieve(&mut self) -> Result<Captured, String> {
        match self.capture.retrieve_def(&mut self.received) {
            Ok(true) => captured(&self.received),
            Ok(false) => Err("the frame is damaged".to_owned()),
            Err(error) => Err(cv::message(&error)),
        }
    }

    fn delivers(&self) -> Delivered {
        self.delivered
    }
}

#[cfg(test)]
mod tests {
    use image::Rgb;

    use super::*;

    #[test]
    fn what_a_camera_has_compressed_is_kept_as_it_was_sent() {
        let image = RgbImage::from_fn(64, 48, |u, v| Rgb([(3 * u) as u8, (4 * v) as u8, 90]));
        let sent = jpeg::encode(&image, jpeg::QUALITY).expect("small");
        // The rest of the buffer is not of this frame.
        let buffer = [&sent[..], &sent[300..], &[0; 100]].concat();
        let received = Mat::new_rows_cols_with_bytes::<u8>(1, buffer.len() as i32, &buffer)
            .expect("bytes")
            .clone_pointee();
        let found = captured(&received).expect("whole");
        assert_eq!(found.jpeg.as_deref(), Some(&sent[..]));
        assert_eq!(found.image.dimensions(), (64, 48));
        let off = found.image.iter().zip(image.iter()).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>();
        assert!(off / (image.len() as f64) < 3.0, "colors are where they were");
        let cut = Mat::new_rows_cols_with_bytes::<u8>(1, 200, &sent[..200]).expect("bytes").clone_pointee();
        assert!(captured(&cut).is_err_and(|why| why.contains("its end is missing")));
        let bare = jpeg::without_huffman_tables(&sent);
        let received =
            Mat::new_rows_cols_with_bytes::<u8>(1, bare.len() as i32, &bare).expect("bytes").clone_pointee();
        let without_tables = captured(&received).expect("whole");
        assert_eq!((without_tables.jpeg, without_tables.image), (None, found.image));
        let pixels = Mat::new_rows_cols_with_bytes::<opencv::core::Vec3b>(48, 64, &image)
            .expect("pixels")
            .clone_pointee();
        assert_eq!(captured(&pixels).expect("pixels").jpeg, None);
    }
}
