//! Tables of numbers (CSV) that verbs are given.

use std::path::Path;

use plumbline_model::files::{self, MOST_ROWS, Size, shortened};
use plumbline_model::plausible::{self, Quantity};

use super::OfflineError;

/// What a column holds.
fn quantity(column: &str) -> Option<Quantity> {
    match column {
        "u_px" | "v_px" => Some(plausible::IMAGE_PX),
        "x_m" | "y_m" | "z_m" => Some(plausible::TARGET_M),
        "roll_rad" | "pitch_rad" | "yaw_rad" => Some(plausible::ANGLE_RAD),
        _ => None,
    }
}

/// A table whose cells in the columns asked for are finite numbers.
#[derive(Debug)]
pub(super) struct Table {
    columns: Vec<&'static str>,
    rows: Vec<Vec<f64>>,
}

impl Table {
    /// Reads a table with a header line. Columns are found by name, in any order; `needed` must be
    /// there, `optional` may be, all others are ignored. `needs` tells people what the file needs.
    pub fn read(
        file: &Path,
        needed: &[&'static str],
        optional: &[&'static str],
        needs: &'static str,
    ) -> Result<Self, OfflineError> {
        let bytes = files::read(file, Size::TEXT)?;
        let bad =
            |line: usize, reason: String| OfflineError::Table { file: file.to_owned(), line, reason, needs };
        let text = String::from_utf8(bytes)
            .map_err(|_| bad(1, "the file is no text in UTF-8: save it as CSV in UTF-8".to_owned()))?;
        // Spreadsheets put a byte-order mark first.
        let mut lines = text.trim_start_matches('\u{feff}').lines().enumerate();
        let header: Vec<&str> = match lines.next() {
            Some((_, header)) => header.split(',').map(str::trim).collect(),
            None => return Err(bad(1, "the file is empty".to_owned())),
        };
        if let Some(twice) = needed
            .iter()
            .chain(optional)
            .find(|name| header.iter().filter(|column| column == name).count() > 1)
        {
            return Err(bad(1, format!("the column {twice} is there twice")));
        }
        let place = |name: &str| header.iter().position(|column| *column == name);
        if let Some(missing) = needed.iter().find(|name| place(name).is_none()) {
            let reason =
                format!("there is no column {missing} in the header \"{}\"", shortened(&header.join(",")));
            return Err(bad(1, reason));
        }
        let (columns, places): (Vec<&'static str>, Vec<usize>) =
            needed.iter().chain(optional).filter_map(|name| Some((*name, place(name)?))).unzip();
        let mut rows = Vec::new();
        for (index, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
            if rows.len() == MOST_ROWS {
                return Err(bad(
                    index + 1,
                    format!("there are more than {MOST_ROWS} rows: divide the table"),
                ));
            }
            let cells: Vec<&str> = line.split(',').map(str::trim).collect();
            if cells.len() != header.len() {
                let reason = format!("{} cells instead of {}", cells.len(), header.len());
                return Err(bad(index + 1, reason));
            }
            let number = |place: &usize| {
                let value =
                    cells[*place].parse::<f64>().ok().filter(|value| value.is_finite()).ok_or_else(|| {
                        let cell = shortened(cells[*place]);
                        bad(index + 1, format!("\"{cell}\" in column {} is no number", header[*place]))
                    })?;
                match quantity(header[*place]).map(|quantity| quantity.check(value)) {
                    Some(Err(what)) => Err(bad(index + 1, format!("column {}: {what}", header[*place]))),
                    _ => Ok(value),
                }
            };
            rows.push(places.iter().map(number).collect::<Result<_, _>>()?);
        }
        Ok(Self { columns, rows })
    }

    /// Columns that are there: those needed, then the optional ones found.
    pub fn columns(&self) -> &[&'static str] {
        &self.columns
    }

    /// Rows in the order of the file, cells in the order of [`Self::columns`].
    pub fn rows(&self) -> &[Vec<f64>] {
        &self.rows
    }
}
