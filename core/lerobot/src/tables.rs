//! What was done, and the one episode.

use std::path::Path;

use serde_json::json;

use crate::data::{Column, write_table};
use crate::error::ExportError;
use crate::meta::FIRST_EPISODES;

/// The one task, and the one episode.
pub(crate) fn write(folder: &Path, task: &str, frames: usize) -> Result<(), ExportError> {
    let index = json!({
        "index_columns": ["task"],
        "column_indexes": [],
        "columns": [
            { "name": "task_index", "field_name": "task_index", "pandas_type": "int64", "numpy_type": "int64", "metadata": null },
            { "name": "task", "field_name": "task", "pandas_type": "unicode", "numpy_type": "object", "metadata": null },
        ],
        "pandas_version": "2.0.0",
    });
    let about = vec![("pandas".to_owned(), index.to_string())];
    write_table(&folder.join("meta/tasks.parquet"), &["task_index", "task"], about, |table| {
        table.rows(&[Column::Integers(vec![0]), Column::Texts(vec![task.to_owned()])])
    })?;
    let names = [
        "episode_index",
        "tasks",
        "length",
        "data/chunk_index",
        "data/file_index",
        "dataset_from_index",
        "dataset_to_index",
        "meta/episodes/chunk_index",
        "meta/episodes/file_index",
    ];
    let frames = frames as i64;
    let number = |value: i64| Column::Integers(vec![value]);
    let columns = [
        number(0),
        Column::TextLists(vec![task.to_owned()]),
        number(frames),
        number(0),
        number(0),
        number(0),
        number(frames),
        number(0),
        number(0),
    ];
    write_table(&folder.join(FIRST_EPISODES), &names, vec![], |table| table.rows(&columns))
}
