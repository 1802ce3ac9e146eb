//! A calibration file opened and parsed.

use std::path::{Path, PathBuf};

use super::error::FormatError;
use super::node::{Field, Node, Value};
use super::{text_file, yaml};

/// A parsed YAML file.
#[derive(Clone, Debug)]
pub(crate) struct Document {
    file: PathBuf,
    node: Node,
}

impl Document {
    /// Reads and parses; the top level must be a group of keys.
    pub fn open(file: &Path) -> Result<Self, FormatError> {
        Self::parse(file, &text_file::read(file)?)
    }

    /// Parses text that stands (or will stand) in `file`.
    pub fn parse(file: &Path, text: &str) -> Result<Self, FormatError> {
        let node = yaml::parse(file, text)?;
        if !matches!(node.value, Value::Map(_)) {
            return Err(FormatError::Unrecognized {
                file: file.to_path_buf(),
                keys: "none, it is not made of keys and values".to_owned(),
            });
        }
        Ok(Self { file: file.to_path_buf(), node })
    }

    /// The top level.
    pub fn root(&self) -> Field<'_> {
        Field::root(&self.file, &self.node)
    }

    /// Path of the file.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Names of the top-level keys, in order.
    pub fn keys(&self) -> Vec<&str> {
        match &self.node.value {
            Value::Map(entries) => entries.iter().map(|(key, _)| key.as_str()).collect(),
            _ => Vec::new(),
        }
    }
}
