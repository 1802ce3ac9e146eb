//! The gap, an experiment with grasps, or a whole setup, on one page for a colleague, as HTML and PDF; and
//! one tile of the window with its table, as PDF.
//!
//! One drawing of an A4 page is laid out (`page`) and written twice: as an inline SVG in an HTML
//! file that needs no other file, and as a PDF. Lengths on the page are points (1/72 inch).

mod drawing;
pub mod experiment;
mod font;
mod html;
mod page;
mod pdf;
pub mod sample;
pub mod setup;
mod svg;
pub mod tile;
mod values;

use plumbline_gap::Finding;

/// What the page says beyond the finding.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct ReportContext {
    /// Day of the report as it is printed ("21 November 2026").
    pub date: String,
    /// Which model was compared ("nominal", "M5 with 3 effects"). May be empty.
    pub model: String,
    /// Earlier models with their gap, the oldest first; may be empty.
    pub history: Vec<HistoryEntry>,
    /// Corners of the touchscreen in the robot frame, in order around it, m: (x forward, y left).
    pub screen_m: Option<[[f64; 2]; 4]>,
}

/// A model with its gap.
#[derive(Clone, Debug, PartialEq)]
pub struct HistoryEntry {
    /// Its name ("nominal", "joint zero of the elbow added").
    pub name: String,
    /// Mean error on rows that were not used, in the unit of the finding (m or px).
    pub gap: f64,
}

/// Why no PDF was made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReportError {
    /// The writer of PDF refused.
    #[error("the PDF could not be written ({reason}): save the report as HTML and print it from a browser")]
    Pdf {
        /// In the writer's words.
        reason: String,
    },
}

/// The page as an HTML file that needs no other file: fonts and figures are inside. Prints on one
/// A4 page.
pub fn html(finding: &Finding, context: &ReportContext) -> String {
    html::of(&page::draw(finding, context), &about(finding, context))
}

/// The page as SVG, A4 portrait. The font is Inter, which the viewer must have.
pub fn svg(finding: &Finding, context: &ReportContext) -> String {
    svg::of(&page::draw(finding, context))
}

/// The page as a PDF file, with its fonts.
///
/// # Errors
/// When the file cannot be made; HTML always can.
pub fn pdf(finding: &Finding, context: &ReportContext) -> Result<Vec<u8>, ReportError> {
    pdf::of(&page::draw(finding, context), &about(finding, context))
}

/// What a file says of itself beside its page.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct About {
    /// Title of the file.
    pub title: String,
    /// What is on it, for who cannot see it.
    pub sentence: String,
    /// Version of the program that found it.
    pub version: String,
}

fn about(finding: &Finding, context: &ReportContext) -> About {
    About {
        title: format!("Gap of {} · {}", finding.rig, context.date),
        sentence: finding.sentence.clone(),
        version: finding.version.clone(),
    }
}
