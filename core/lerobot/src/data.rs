//! The rows: a Parquet file with a column per feature.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, FloatType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::parser::parse_message_type;

use crate::error::ExportError;

/// A column of a table and its values, one (or a list) per row.
pub(crate) enum Column {
    Integers(Vec<i64>),
    Doubles(Vec<f64>),
    Floats(Vec<f32>),
    Texts(Vec<String>),
    /// A list of so many numbers per row.
    FloatLists(usize, Vec<f32>),
    /// A list of one text per row.
    TextLists(Vec<String>),
    /// Encoded images, with the name that each had.
    Images(Vec<(Vec<u8>, String)>),
}

impl Column {
    /// Its part of the schema.
    fn schema(&self, name: &str) -> String {
        match self {
            Self::Integers(_) => format!("optional int64 {name};"),
            Self::Doubles(_) => format!("optional double {name};"),
            Self::Floats(_) => format!("optional float {name};"),
            Self::Texts(_) => format!("optional binary {name} (UTF8);"),
            Self::FloatLists(..) => {
                format!(
                    "optional group {name} (LIST) {{ repeated group list {{ optional float element; }} }}"
                )
            }
            Self::TextLists(_) => format!(
                "optional group {name} (LIST) {{ repeated group list {{ optional binary element (UTF8); }} }}"
            ),
            Self::Images(_) => {
                format!("optional group {name} {{ optional binary bytes; optional binary path (UTF8); }}")
            }
        }
    }

    fn write(&self, group: &mut SerializedRowGroupWriter<'_, File>) -> Result<(), ParquetError> {
        let texts =
            |all: &[String]| -> Vec<ByteArray> { all.iter().map(|text| text.as_str().into()).collect() };
        match self {
            Self::Integers(values) => flat::<Int64Type>(group, values),
            Self::Doubles(values) => flat::<DoubleType>(group, values),
            Self::Floats(values) => flat::<FloatType>(group, values),
            Self::Texts(values) => flat::<ByteArrayType>(group, &texts(values)),
            Self::FloatLists(length, values) => lists::<FloatType>(group, *length, values),
            Self::TextLists(values) => lists::<ByteArrayType>(group, 1, &texts(values)),
            Self::Images(images) => {
                let bytes: Vec<ByteArray> = images.iter().map(|(bytes, _)| bytes.clone().into()).collect();
                let names: Vec<ByteArray> = images.iter().map(|(_, name)| name.as_str().into()).collect();
                nested::<ByteArrayType>(group, &bytes, 2)?;
                nested::<ByteArrayType>(group, &names, 2)
            }
        }
    }
}

/// A value per row, none missing.
fn flat<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, File>,
    values: &[T::T],
) -> Result<(), ParquetError> {
    nested::<T>(group, values, 1)
}

/// A value per row inside so many optional groups, none missing.
fn nested<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, File>,
    values: &[T::T],
    depth: i16,
) -> Result<(), ParquetError> {
    let levels = vec![depth; values.len()];
    let Some(mut column) = group.next_column()? else { return Err(one_too_many()) };
    column.typed::<T>().write_batch(values, Some(&levels), None)?;
    column.close()
}

/// So many values per row.
fn lists<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, File>,
    length: usize,
    values: &[T::T],
) -> Result<(), ParquetError> {
    let depths = vec![3; values.len()];
    let repeats: Vec<i16> = (0..values.len()).map(|k| i16::from(k % length.max(1) != 0)).collect();
    let Some(mut column) = group.next_column()? else { return Err(one_too_many()) };
    column.typed::<T>().write_batch(values, Some(&depths), Some(&repeats))?;
    column.close()
}

fn one_too_many() -> ParquetError {
    ParquetError::General("a column has no place in the schema".to_owned())
}

/// A table that is written group by group of rows.
pub(crate) struct TableWriter {
    path: std::path::PathBuf,
    names: Vec<String>,
    about: Vec<(String, String)>,
    writer: Option<SerializedFileWriter<File>>,
}

impl TableWriter {
    /// Nothing is written before the first rows come. `about`: keys and values that the file carries.
    pub fn new(path: &Path, names: &[&str], about: Vec<(String, String)>) -> Self {
        let names = names.iter().map(|name| (*name).to_owned()).collect();
        Self { path: path.to_owned(), names, about, writer: None }
    }

    /// A group of rows: columns in the order of the names.
    pub fn rows(&mut self, columns: &[Column]) -> Result<(), ExportError> {
        let path = self.path.clone();
        if self.writer.is_none() {
            self.writer = Some(self.begin(columns)?);
        }
        let Some(writer) = &mut self.writer else { return Ok(()) };
        let mut group = writer.next_row_group().map_err(ExportError::table(&path))?;
        for column in columns {
            column.write(&mut group).map_err(ExportError::table(&path))?;
        }
        group.close().map_err(ExportError::table(&path))?;
        Ok(())
    }

    fn begin(&self, columns: &[Column]) -> Result<SerializedFileWriter<File>, ExportError> {
        let wrong = || ExportError::table(&self.path);
        let parts: Vec<String> =
            self.names.iter().zip(columns).map(|(name, column)| column.schema(name)).collect();
        let schema =
            parse_message_type(&format!("message schema {{ {} }}", parts.join(" "))).map_err(wrong())?;
        let about = self.about.iter().map(|(key, value)| KeyValue::new(key.clone(), value.clone())).collect();
        let properties = WriterProperties::builder().set_key_value_metadata(Some(about)).build();
        if let Some(folder) = self.path.parent() {
            std::fs::create_dir_all(folder).map_err(ExportError::io(folder))?;
        }
        let file = File::create(&self.path).map_err(ExportError::io(&self.path))?;
        SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties)).map_err(wrong())
    }

    /// No more rows.
    pub fn finish(self) -> Result<(), ExportError> {
        if let Some(writer) = self.writer {
            writer.close().map_err(ExportError::table(&self.path))?;
        }
        Ok(())
    }
}
