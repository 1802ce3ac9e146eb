//! Model files: the program's own JSON, ONNX, and published weights as JSON, told apart by content.

use std::io::Read as _;
use std::path::Path;

use plumbline_correction::{CorrectionModel, FileError};
use plumbline_model::files::{self, Size};
use plumbline_model::robot::Rig;

use super::error::ModelError;
use super::screen::same_size;

/// Bytes that tell JSON from ONNX.
const HEAD: u64 = 256;

/// Reads a model of any kind, whatever its file is called.
pub fn read_any(file: &Path) -> Result<CorrectionModel, FileError> {
    let mut head = Vec::new();
    let opened = files::open(file, Size::MODEL)?;
    opened.take(HEAD).read_to_end(&mut head).map_err(files::FileError::unreadable(file))?;
    // ONNX begins with the bytes of a number, JSON with a bracket.
    let first = head.iter().find(|byte| !byte.is_ascii_whitespace() && !b"\xef\xbb\xbf".contains(byte));
    let called = |name: &str| file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(name));
    match first {
        Some(b'{' | b'[') if !called("onnx") => CorrectionModel::import(file),
        _ if called("json") => CorrectionModel::import(file),
        _ => CorrectionModel::read_onnx(file),
    }
}

/// Reads a model of this robot and its touchscreen, or says why it cannot be used, a sentence.
pub fn read(file: &Path, rig: &Rig) -> Result<CorrectionModel, ModelError> {
    let model = read_any(file)?;
    if let Some(options) = &model.provenance().options {
        if !options.rig.is_empty() && options.rig != rig.name {
            let (trained, present) = (options.rig.clone(), rig.name.clone());
            return Err(ModelError::OtherRobot { trained, present });
        }
        if let Some(screen) = &options.screen {
            same_size(screen, &(&rig.touchscreen).into(), "The model")?;
        }
    }
    Ok(model)
}

/// Reads a model that [`write`] wrote.
pub fn read_own(file: &Path) -> Result<CorrectionModel, ModelError> {
    Ok(CorrectionModel::read(file)?)
}

/// Writes a model as JSON.
pub fn write(model: &CorrectionModel, file: &Path) -> Result<(), ModelError> {
    Ok(model.write(file)?)
}

/// Writes a model as ONNX.
pub fn write_onnx(model: &CorrectionModel, file: &Path) -> Result<(), ModelError> {
    Ok(model.write_onnx(file)?)
}
