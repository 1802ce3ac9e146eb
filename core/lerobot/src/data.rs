//! The rows: a Parquet file with a column per feature.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;
use std::sync::Arc;

use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, FloatType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::parser::parse_message_type;
use parquet::schema::types::Type;
use plumbline_model::files;

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

    fn write(
        &self,
        group: &mut SerializedRowGroupWriter<'_, &mut BufWriter<File>>,
    ) -> Result<(), ParquetError> {
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
    group: &mut SerializedRowGroupWriter<'_, &mut BufWriter<File>>,
    values: &[T::T],
) -> Result<(), ParquetError> {
    nested::<T>(group, values, 1)
}

/// A value per row inside so many optional groups, none missing.
fn nested<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, &mut BufWriter<File>>,
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
    group: &mut SerializedRowGroupWriter<'_, &mut BufWriter<File>>,
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
pub(crate) struct TableWriter<'a> {
    path: &'a Path,
    names: &'a [&'a str],
    about: Vec<(String, String)>,
    /// Until the first rows say what the columns are.
    out: Option<&'a mut BufWriter<File>>,
    writer: Option<SerializedFileWriter<&'a mut BufWriter<File>>>,
}

/// Writes a table in one step: `fill` gives it its rows. `about`: keys and values that the file carries.
pub(crate) fn write_table(
    path: &Path,
    names: &[&str],
    about: Vec<(String, String)>,
    fill: impl FnOnce(&mut TableWriter<'_>) -> Result<(), ExportError>,
) -> Result<(), ExportError> {
    if let Some(folder) = path.parent() {
        files::make_folder(folder)?;
    }
    let mut failed = None;
    let written = files::write_with(path, |out| {
        let mut table = TableWriter { path, names, about, out: Some(out), writer: None };
        let filled = fill(&mut table).and_then(|()| table.finish());
        filled.map_err(|error| {
            failed = Some(error);
            io::Error::other("not all of its rows could be written")
        })
    });
    match failed {
        Some(error) => Err(error),
        None => Ok(written?),
    }
}

impl TableWriter<'_> {
    /// A group of rows: columns in the order of the names.
    pub fn rows(&mut self, columns: &[Column]) -> Result<(), ExportError> {
        let path = self.path;
        let filled = |writer: &mut SerializedFileWriter<&mut BufWriter<File>>| {
            let mut group = writer.next_row_group()?;
            for column in columns {
                column.write(&mut group)?;
            }
            group.close().map(|_| ())
        };
        if let Some(out) = self.out.take() {
            let (schema, properties) = self.head(columns).map_err(ExportError::table(path))?;
            let writer = SerializedFileWriter::new(out, schema, properties);
            self.writer = Some(writer.map_err(ExportError::table(path))?);
        }
        self.writer.as_mut().map_or(Ok(()), filled).map_err(ExportError::table(path))
    }

    fn head(&self, columns: &[Column]) -> Result<(Arc<Type>, Arc<WriterProperties>), ParquetError> {
        let parts: Vec<String> =
            self.names.iter().zip(columns).map(|(name, column)| column.schema(name)).collect();
        let schema = parse_message_type(&format!("message schema {{ {} }}", parts.join(" ")))?;
        let about = self.about.iter().map(|(key, value)| KeyValue::new(key.clone(), value.clone())).collect();
        let properties = WriterProperties::builder().set_key_value_metadata(Some(about)).build();
        Ok((Arc::new(schema), Arc::new(properties)))
    }

    /// No more rows.
    fn finish(self) -> Result<(), ExportError> {
        match self.writer {
            Some(writer) => writer.close().map(|_| ()).map_err(ExportError::table(self.path)),
            None => Ok(()),
        }
    }
}
