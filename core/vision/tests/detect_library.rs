//! What is said when ONNX Runtime is missing, is something else, or is too old. A library is
//! loaded once per process, so every case has a process of its own.

use std::io::Write as _;
use std::path::Path;
use std::process::Command;

use plumbline_vision::detect::{DetectError, Detector, DetectorOptions};

/// Set where a case is run.
const CASE: &str = "PLUMBLINE_TEST_LIBRARY";
/// Printed before the sentence.
const MARK: &str = "said: ";

/// What a process says that is to load a library and to open a detector with it, twice.
fn said_about(library: &Path) -> String {
    let output = Command::new(std::env::current_exe().expect("this test"))
        .args(["--exact", "loads_what_it_is_told", "--nocapture"])
        .env("ORT_DYLIB_PATH", library)
        .env(CASE, "1")
        .output()
        .expect("this test can be started");
    assert!(output.status.success(), "it must not fall over: {}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let sentences: Vec<&str> = text.lines().filter_map(|line| Some(line.split_once(MARK)?.1)).collect();
    assert_eq!(sentences.len(), 2, "{text}");
    assert_eq!(sentences[0], sentences[1], "a second try says the same");
    sentences[0].to_owned()
}

fn open() -> Result<Detector, DetectError> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/detectors/raw.onnx");
    Detector::open(&file, &DetectorOptions::default())
}

/// Run by the others in processes of their own; by itself it loads the right library.
#[test]
fn loads_what_it_is_told() {
    if std::env::var_os(CASE).is_none() {
        let detector = open().unwrap_or_else(|error| panic!("{error}"));
        assert!(detector.info().runtime.contains("ONNX Runtime"), "{}", detector.info().runtime);
        return;
    }
    for _ in 0..2 {
        let said = open().map_or_else(|error| error.to_string(), |detector| detector.info().runtime.clone());
        writeln!(std::io::stdout(), "\n{MARK}{said}").expect("the parent reads");
    }
}

#[test]
fn a_missing_library_is_said_with_the_way_to_get_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let said = said_about(&folder.path().join("libonnxruntime.so"));
    assert!(said.contains("ONNX Runtime was not found"), "{said}");
    assert!(said.contains("libonnxruntime.so") && said.contains("./plumbline setup"), "{said}");
}

#[test]
fn what_is_no_library_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("libonnxruntime.so");
    std::fs::write(&file, "no library at all").expect("writing");
    let said = said_about(&file);
    assert!(said.contains("cannot be used as ONNX Runtime"), "{said}");
    assert!(said.contains("./plumbline setup"), "{said}");
}

/// Compiles a library; every machine that links Rust can.
#[cfg(target_os = "linux")]
fn said_about_code(code: &str) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let (source, library) = (folder.path().join("a.c"), folder.path().join("libonnxruntime.so"));
    std::fs::write(&source, code).expect("writing");
    let compiled = Command::new("cc").args(["-shared", "-fPIC", "-o"]).args([&library, &source]).status();
    assert!(compiled.expect("a compiler").success());
    said_about(&library)
}

#[cfg(target_os = "linux")]
fn made_up(version: &str) -> String {
    format!(
        "static const void *api(unsigned version) {{ (void)version; return 0; }}\n\
         static const char *version(void) {{ return \"{version}\"; }}\n\
         static struct {{ const void *(*api)(unsigned); const char *(*version)(void); }} base = {{ api, version }};\n\
         const void *OrtGetApiBase(void) {{ return &base; }}\n"
    )
}

#[test]
#[cfg(target_os = "linux")]
fn another_library_is_said() {
    let said = said_about_code("int answer(void) { return 42; }\n");
    assert!(said.contains("cannot be used as ONNX Runtime"), "{said}");
}

#[test]
#[cfg(target_os = "linux")]
fn an_old_version_is_said_with_both_versions() {
    let said = said_about_code(&made_up("1.10.0"));
    assert!(said.contains("1.10.0") && said.contains("1.24"), "{said}");
    assert!(said.contains("./plumbline setup"), "{said}");
}

#[test]
#[cfg(target_os = "linux")]
fn a_version_without_the_interface_that_it_claims_is_said() {
    let said = said_about_code(&made_up("1.99.0"));
    assert!(said.contains("cannot be used as ONNX Runtime"), "{said}");
}
