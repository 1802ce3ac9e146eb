//! The few things that cameras and videos need from OpenCV.

use image::RgbImage;
use opencv::core::{CV_8U, Mat, MatTraitConst, MatTraitConstManual};
use opencv::imgproc;

/// The OpenCV that this program is linked to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OpenCvInfo {
    /// For example `4.6.0`.
    pub version: String,
    /// Threads it uses at most.
    pub threads: i32,
    /// Instruction sets it was built for and, marked with `*`, those it chooses at run time;
    /// those this processor lacks are marked with `?`.
    pub instructions: String,
}

/// Asks OpenCV who it is. The error says what is wrong with it.
pub fn opencv_info() -> Result<OpenCvInfo, String> {
    let failed = |error: opencv::Error| format!("OpenCV does not answer ({})", message(&error));
    Ok(OpenCvInfo {
        version: opencv::core::get_version_string().map_err(failed)?,
        threads: opencv::core::get_num_threads().map_err(failed)?,
        instructions: opencv::core::get_cpu_features_line().map_err(failed)?,
    })
}

/// What OpenCV's error means, for people. Its own text, which speaks of its source code, is in the log.
pub(crate) fn message(error: &opencv::Error) -> String {
    log::warn!("OpenCV: {}", error.message.trim());
    match error.code {
        opencv::core::StsNoMem => "there is not enough memory; close other programs".to_owned(),
        opencv::core::StsNotImplemented => "this build of OpenCV cannot do it".to_owned(),
        _ => "OpenCV refused it; what it said is in the log".to_owned(),
    }
}

/// Keeps OpenCV's readers from writing to standard error: what goes wrong is told by ours.
pub(crate) fn quiet() {
    static ONCE: std::sync::Once = std::sync::Once::new();
    ONCE.call_once(|| {
        let silent = opencv::core::LogLevel::LOG_LEVEL_SILENT;
        if let Err(error) = opencv::core::set_log_level(silent) {
            log::debug!("OpenCV keeps its log level: {}", message(&error));
        }
    });
}

/// An 8-bit gray, BGR or BGRA image as RGB.
pub(crate) fn rgb_image(mat: &Mat) -> Result<RgbImage, String> {
    if mat.empty() {
        return Err("the frame is empty".to_owned());
    }
    let code = match (mat.depth(), mat.channels()) {
        (CV_8U, 1) => imgproc::COLOR_GRAY2RGB,
        (CV_8U, 3) => imgproc::COLOR_BGR2RGB,
        (CV_8U, 4) => imgproc::COLOR_BGRA2RGB,
        (depth, channels) => {
            return Err(format!("frames of {channels} channels and depth code {depth} are not read"));
        }
    };
    let mut rgb = Mat::default();
    imgproc::cvt_color_def(mat, &mut rgb, code).map_err(|error| message(&error))?;
    let (Ok(width), Ok(height)) = (u32::try_from(rgb.cols()), u32::try_from(rgb.rows())) else {
        return Err("the frame has no size".to_owned());
    };
    let bytes = rgb.data_bytes().map_err(|error| message(&error))?.to_vec();
    RgbImage::from_raw(width, height, bytes).ok_or_else(|| "the frame is incomplete".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use opencv::core::{Scalar, Vec3b};

    #[test]
    fn opencv_says_who_it_is() {
        let info = opencv_info().expect("it is linked");
        assert!(info.version.starts_with("4."), "{info:?}");
        assert!(info.threads >= 1, "{info:?}");
    }

    #[test]
    fn assertions_stay_in_the_log() {
        let raw = "OpenCV(4.6.0) ./modules/imgproc/src/color.cpp:182: error: (-215:Assertion failed) !_src.empty() in function 'cvtColor'";
        for code in [opencv::core::StsAssert, opencv::core::StsNoMem, opencv::core::StsError] {
            let words = message(&opencv::Error::new(code, raw));
            assert!(!words.contains("Assertion") && !words.contains("modules"), "{words}");
        }
    }

    #[test]
    fn channels_are_put_in_order() {
        let blue_green_red = Vec3b::from([1, 2, 3]);
        let mat = Mat::from_slice(&[blue_green_red]).expect("a mat").clone_pointee();
        let image = rgb_image(&mat).expect("BGR");
        assert_eq!(image.get_pixel(0, 0).0, [3, 2, 1]);
    }

    #[test]
    fn other_kinds_are_refused_not_misread() {
        let mat =
            Mat::new_rows_cols_with_default(2, 2, opencv::core::CV_16UC1, Scalar::all(1.0)).expect("a mat");
        assert!(rgb_image(&mat).is_err());
        assert!(rgb_image(&Mat::default()).is_err());
    }
}
