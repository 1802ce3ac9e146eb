//! The gap on one page for a colleague, as HTML and PDF.
