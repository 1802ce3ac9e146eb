//! The library that runs networks: ONNX Runtime, loaded when the first detector is opened.
//!
//! The program starts and does everything else without it. It is looked for in this order: the
//! file that the environment variable `ORT_DYLIB_PATH` names; beside the program; in
//! `.native/onnxruntime`, where `./plumbline setup` puts it, of a folder above the program or of
//! the checkout that it was built from; where the system looks for libraries.

use std::panic::catch_unwind;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use ort::environment::Environment;
use ort::ep::ExecutionProvider as _;
use ort::logging::LogLevel;

use super::{DetectError, Provider};

/// ONNX Runtime, loaded.
#[derive(Clone)]
pub struct Library {
    pub(super) environment: Environment,
    path: PathBuf,
}

/// Loaded once and kept: the library can neither be unloaded nor initialized twice.
static LOADED: Mutex<Option<Library>> = Mutex::new(None);

impl Library {
    /// Loads it, if that was not done yet. After a failure it is tried again.
    ///
    /// # Errors
    /// It is not there, is something else, or is older than version 1.24.
    pub fn load() -> Result<Self, DetectError> {
        let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(library) = &*loaded {
            return Ok(library.clone());
        }
        let library = Self::find_and_load()?;
        *loaded = Some(library.clone());
        Ok(library)
    }

    fn find_and_load() -> Result<Self, DetectError> {
        if let Some(path) = asked_for() {
            if !path.is_file() {
                return Err(DetectError::NoLibrary { looked_in: vec![path] });
            }
            return Self::from_file(&path);
        }
        let mut looked_in: Vec<PathBuf> = candidates();
        if let Some(path) = looked_in.iter().find(|path| path.is_file()) {
            return Self::from_file(path);
        }
        // By name alone the system looks in its own folders and in LD_LIBRARY_PATH.
        let name = PathBuf::from(file_name());
        match Self::from_file(&name) {
            Err(DetectError::BadLibrary { reason, .. }) if reason.starts_with("failed to load") => {
                looked_in.push(name);
                Err(DetectError::NoLibrary { looked_in })
            }
            result => result,
        }
    }

    fn from_file(path: &Path) -> Result<Self, DetectError> {
        let bad = |reason: String| DetectError::BadLibrary { path: path.to_owned(), reason };
        // The crate panics on a library that does not hold what its version promises.
        let environment = catch_unwind(|| environment(path))
            .unwrap_or_else(|_| Err("it lacks the interface of version 1.24".to_owned()))
            .map_err(bad)?;
        Ok(Self { environment, path: path.canonicalize().unwrap_or_else(|_| path.to_owned()) })
    }

    /// The file that was loaded.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its version if its file name says it, else what it says about how it was built.
    pub fn version(&self) -> String {
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        match name.split_once(".so.") {
            Some((_, version)) if version.starts_with(|c: char| c.is_ascii_digit()) => {
                format!("ONNX Runtime {version}")
            }
            _ => format!("ONNX Runtime ({})", ort::info().trim_start_matches("ORT Build Info: ")),
        }
    }

    /// What it can compute with, as built; a graphics card may still be missing.
    pub fn providers(&self) -> Vec<Provider> {
        Provider::ALL.into_iter().filter(|provider| is_built_in(*provider)).collect()
    }
}

/// Loads a file and starts it; else says what is wrong.
fn environment(path: &Path) -> Result<Environment, String> {
    let environment = ort::init_from(path)
        .map_err(|error| error.to_string())?
        .with_name("plumbline")
        .with_telemetry(false)
        .with_logger(Arc::new(|level, _, _, place, message| {
            // Its errors also come back as values, with a sentence of ours.
            let level = match level {
                LogLevel::Fatal | LogLevel::Error | LogLevel::Warning => log::Level::Debug,
                LogLevel::Info | LogLevel::Verbose => log::Level::Trace,
            };
            log::log!(target: "onnxruntime", level, "{message} ({place})");
        }))
        .build()
        .map_err(|error| error.message().to_owned())?;
    environment.set_log_level(LogLevel::Warning);
    Ok(environment)
}

/// Whether the loaded library was built with a provider.
fn is_built_in(provider: Provider) -> bool {
    match provider {
        Provider::Cpu => Ok(true),
        Provider::Cuda => ort::ep::CUDA::is_available(),
        Provider::TensorRt => ort::ep::TensorRT::is_available(),
        Provider::DirectMl => ort::ep::DirectML::is_available(),
        Provider::CoreMl => ort::ep::CoreML::is_available(),
    }
    .unwrap_or(false)
}

fn asked_for() -> Option<PathBuf> {
    std::env::var_os("ORT_DYLIB_PATH").filter(|path| !path.is_empty()).map(PathBuf::from)
}

fn file_name() -> String {
    format!("{}onnxruntime{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX)
}

/// Files that may be it, the first that exists is taken.
fn candidates() -> Vec<PathBuf> {
    let name = file_name();
    let in_folder = |folder: &Path| folder.join(".native/onnxruntime").join(&name);
    let mut files = Vec::new();
    if let Ok(program) = std::env::current_exe() {
        let folder = program.parent();
        files.extend(folder.map(|folder| folder.join(&name)));
        // target/release or target/release/deps below the checkout.
        let above = folder.into_iter().flat_map(Path::ancestors).skip(1).take(4).map(in_folder);
        files.extend(above.filter(|file| file.is_file()));
    }
    let checkout = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2);
    files.extend(checkout.map(in_folder));
    files
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_looked_for_beside_the_program_and_in_the_checkout() {
        let files = candidates();
        let program = std::env::current_exe().expect("this test");
        assert_eq!(files[0].parent(), program.parent());
        let last = files.last().expect("the checkout");
        assert!(last.ends_with(Path::new(".native/onnxruntime").join(file_name())), "{last:?}");
    }
}
