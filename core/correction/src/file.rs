//! The program's own model files: JSON, format version 1.
//!
//! ```text
//! { "format": "plumbline correction model", "version": 1,
//!   "answer":     { "method": "m3", "network": { "members": [ … ] } },
//!   "trust":      { "border": …, "spread": … },
//!   "provenance": { "session": …, "touches": [ … ], "options": …, "cross_validation": … },
//!   "self_test":  [ { "pixel": …, "target_m": …, "sd_m": … }, … ] }
//! ```
//!
//! A network holds its normalization; lengths are meters, touch pixels px.

use std::path::Path;

use plumbline_model::files::{self, Size};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::file_error::FileError;
use crate::model::{CorrectionModel, Parts, Provenance, Trust};
use crate::self_test::{Answer, EXACT_M};

const FORMAT: &str = "plumbline correction model";
const VERSION: u64 = 1;

#[derive(Serialize, Deserialize)]
struct Document {
    format: String,
    version: u64,
    answer: Parts,
    trust: Option<Trust>,
    provenance: Provenance,
    /// What it answered when it was written; empty in files of older programs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    self_test: Vec<Answer>,
}

impl CorrectionModel {
    /// Writes the model as JSON in one step: a crash leaves the old file or the new one.
    ///
    /// # Errors
    /// When the file cannot be written, or the model is damaged.
    pub fn write(&self, file: &Path) -> Result<(), FileError> {
        self.sound(file)?;
        let document = Document {
            format: FORMAT.to_owned(),
            version: VERSION,
            answer: self.parts.clone(),
            trust: self.trust.clone(),
            provenance: self.provenance.clone(),
            self_test: self.answers(),
        };
        let text = serde_json::to_string(&document).map_err(|error| FileError::damaged(file, error))?;
        replace(file, text.as_bytes())
    }

    /// Reads a model that [`Self::write`] wrote.
    ///
    /// # Errors
    /// When the file cannot be read, is something else, has another version, or its numbers make no
    /// model.
    pub fn read(file: &Path) -> Result<Self, FileError> {
        let value = json(file)?;
        if !is_own(&value) {
            return Err(FileError::not_a_model(file, format!("it does not say \"format\": \"{FORMAT}\"")));
        }
        let found = value.get("version").and_then(Value::as_u64);
        let found = found.ok_or_else(|| FileError::not_a_model(file, "its version is missing"))?;
        if found != VERSION {
            return Err(FileError::OtherVersion { file: file.to_path_buf(), found, known: VERSION });
        }
        let document: Document =
            serde_json::from_value(value).map_err(|error| FileError::damaged(file, error))?;
        let Document { answer: parts, trust, provenance, self_test, .. } = document;
        let model = Self { parts, trust, provenance };
        model.sound(file)?;
        model.check_answers(file, &self_test, EXACT_M)?;
        Ok(model)
    }

    /// Reads a model of any kind that can be imported: the program's own JSON, ONNX, or published
    /// weights as JSON.
    ///
    /// # Errors
    /// As the reader of the kind that the file turns out to be.
    pub fn import(file: &Path) -> Result<Self, FileError> {
        let is_onnx = file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("onnx"));
        if is_onnx {
            Self::read_onnx(file)
        } else if is_own(&json(file)?) {
            Self::read(file)
        } else {
            Self::read_published(file)
        }
    }

    pub(crate) fn sound(&self, file: &Path) -> Result<(), FileError> {
        let fault = self.parts.fault().or_else(|| self.trust.as_ref().and_then(Trust::fault));
        fault.map_or(Ok(()), |reason| Err(FileError::damaged(file, reason)))
    }
}

fn is_own(value: &Value) -> bool {
    value.get("format").and_then(Value::as_str) == Some(FORMAT)
}

pub(crate) fn bytes(file: &Path) -> Result<Vec<u8>, FileError> {
    Ok(files::read(file, Size::MODEL)?)
}

pub(crate) fn json(file: &Path) -> Result<Value, FileError> {
    let bytes = bytes(file)?;
    // Some editors put a byte-order mark first.
    serde_json::from_slice(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes))
        .map_err(|error| FileError::not_a_model(file, format!("it is no JSON: {error}")))
}

/// Writes a file in one step.
pub(crate) fn replace(file: &Path, bytes: &[u8]) -> Result<(), FileError> {
    Ok(files::write(file, bytes)?)
}
