//! The timeline as a table of text, and as the page of the whole setup.

use jiff::Timestamp;
use jiff::tz::TimeZone;
use plumbline_report::setup::{self, Setup};

use super::around::TimelineAround;
use super::entries::in_use;
use super::view::{EntryKind, Figure, TimelineEntry};

/// Why the table cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// In the words of its writer.
    #[error("the table cannot be written ({0}): save the report as HTML")]
    Csv(#[from] csv::Error),
}

const HEADINGS: [&str; 12] = [
    "number",
    "at",
    "subject",
    "kind",
    "title",
    "before",
    "after",
    "unit",
    "basis",
    "id_before",
    "id_after",
    "outside",
];

/// Every entry, oldest first; lengths in m.
pub fn csv(entries: &[TimelineEntry]) -> Result<Vec<u8>, TableError> {
    let mut table = csv::Writer::from_writer(Vec::new());
    table.write_record(HEADINGS)?;
    for entry in entries {
        let number = |figure: Option<Figure>| figure.map(|f| format!("{:.9}", f.value())).unwrap_or_default();
        let unit = entry.after.or(entry.before).map_or("", |figure| match figure {
            Figure::Meters(_) => "m",
            Figure::Pixels(_) => "px",
            Figure::Share(_) => "share",
        });
        table.write_record([
            entry.number.to_string(),
            entry.at.to_string(),
            entry.subject.name().to_owned(),
            happened(entry.kind).to_owned(),
            entry.title.clone(),
            number(entry.before),
            number(entry.after),
            unit.to_owned(),
            entry.basis.clone(),
            entry.id_before.clone().unwrap_or_default(),
            entry.id_after.clone().unwrap_or_default(),
            entry.outside.to_string(),
        ])?;
    }
    Ok(table.into_inner().map_err(|end| csv::Error::from(end.into_error()))?)
}

fn happened(kind: EntryKind) -> &'static str {
    match kind {
        EntryKind::PutInUse => "put in use",
        EntryKind::TakenBack => "taken back",
        EntryKind::Found => "in use before",
        EntryKind::Measured => "measured",
    }
}

/// What stands on the page: what is in use, then the line, the newest first.
pub fn setup(entries: &[TimelineEntry], around: &TimelineAround, now: Timestamp) -> Setup {
    let of_twin = if around.is_twin { " (its twin: simulated)" } else { "" };
    Setup {
        title: format!("Setup of {}{of_twin}", around.rig),
        date: day(now),
        in_use: in_use(entries, around)
            .into_iter()
            .map(|now| setup::InUse {
                subject: now.subject.name().to_owned(),
                title: now.title,
                since: now.since.map(day).unwrap_or_default(),
                error: now.figure.map(text).unwrap_or_default(),
                against: now.against,
            })
            .collect(),
        steps: entries
            .iter()
            .rev()
            .map(|entry| setup::Step {
                at: day(entry.at),
                subject: entry.subject.name().to_owned(),
                title: match entry.kind {
                    EntryKind::TakenBack => format!("back to: {}", entry.title),
                    _ => entry.title.clone(),
                },
                before: entry.before.map(text).unwrap_or_default(),
                after: entry.after.map(text).unwrap_or_default(),
                is_change: entry.kind != EntryKind::Measured,
            })
            .collect(),
        version: crate::ground::software(),
    }
}

fn day(at: Timestamp) -> String {
    at.to_zoned(TimeZone::system()).strftime("%Y-%m-%d %H:%M").to_string()
}

fn text(figure: Figure) -> String {
    match figure {
        Figure::Meters(length_m) => format!("{:.2} mm", length_m * 1e3),
        Figure::Pixels(px) => format!("{px:.3} px"),
        Figure::Share(share) => format!("{:.0} %", 100.0 * share),
    }
}
