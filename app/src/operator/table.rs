//! A table that leaves the window.

/// Rows under their headings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    /// One per column, with units.
    pub headings: Vec<String>,
    /// As many fields each as there are headings.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// From headings and rows.
    pub fn new(headings: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> Self {
        Self {
            headings: headings.iter().map(|&heading| heading.to_owned()).collect(),
            rows: rows.into_iter().collect(),
        }
    }

    /// As CSV; `None` where its writer refuses, which the log says.
    pub fn csv(&self) -> Option<String> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let written = writer
            .write_record(&self.headings)
            .and_then(|()| self.rows.iter().try_for_each(|row| writer.write_record(row)));
        if let Err(error) = written {
            log::error!("a table could not be written as CSV: {error}");
            return None;
        }
        String::from_utf8(writer.into_inner().ok()?).ok()
    }
}
