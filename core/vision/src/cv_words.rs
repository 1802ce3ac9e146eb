//! What errors of OpenCV mean, for people.

/// In words. OpenCV's own text, which speaks of its source code, is in the log.
pub(crate) fn words(error: &opencv::Error) -> &'static str {
    log::warn!("OpenCV: {}", error.message.trim());
    if error.code == opencv::core::StsNoMem {
        "there is not enough memory: close other programs, or use smaller images"
    } else {
        "the image or the calibration is not what it should be: check both, and look into the log for what OpenCV said"
    }
}

/// Whether a text is of OpenCV's source code rather than of what was read.
pub(crate) fn is_raw(text: &str) -> bool {
    ["Assertion", "OpenCV(", "error: (", ".cpp"].iter().any(|mark| text.contains(mark))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn assertions_stay_in_the_log() {
        let raw = "OpenCV(4.6.0) ./modules/imgproc/src/imgwarp.cpp:1703: error: (-215:Assertion failed) dst.cols < SHRT_MAX in function 'remap'";
        assert!(is_raw(raw));
        for code in [opencv::core::StsAssert, opencv::core::StsNoMem] {
            assert!(!is_raw(words(&opencv::Error::new(code, raw))));
        }
    }
}
