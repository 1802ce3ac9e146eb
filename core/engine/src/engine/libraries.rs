//! What computes inside of the program.

/// Libraries that this program computes with, by name, with their versions, or why one does not answer.
/// Loads what was not needed until then: not for the window's thread.
pub fn libraries() -> Vec<(&'static str, String)> {
    let onnx = plumbline_vision::detect::Library::load();
    let onnx = onnx.map_or_else(
        |problem| problem.to_string(),
        |library| library.version().trim_start_matches("ONNX Runtime ").to_owned(),
    );
    let opencv = plumbline_hardware::opencv_info().map_or_else(|problem| problem, |info| info.version);
    vec![("OpenCV", opencv), ("MuJoCo", plumbline_twin::physics_version().to_owned()), ("ONNX Runtime", onnx)]
}

#[cfg(test)]
mod tests {
    #[test]
    fn every_library_answers_with_a_version() {
        for (name, version) in super::libraries() {
            assert!(version.starts_with(|c: char| c.is_ascii_digit()), "{name}: {version}");
        }
    }
}
