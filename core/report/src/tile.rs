//! One tile of the window for a colleague: its picture as it stood on the screen, and its table below, on
//! as many pages as that takes.

pub use crate::drawing::Picture;
use crate::drawing::{Drawing, Stroke, Style, ink};
use crate::font;
use crate::page::{HEIGHT, MARGIN, WIDTH};
use crate::pdf::{self, Placed};
use crate::{About, ReportError};

/// Distance of the base lines of the table.
const ROW: f64 = 11.0;
/// Between columns.
const GUTTER: f64 = 8.0;
/// The highest picture.
const PICTURE_HEIGHT: f64 = 420.0;
/// A pixel of the picture is drawn no larger than this.
const LARGEST_PIXEL: f64 = 0.75;

/// What stands on the pages.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Tile {
    /// "Models compared".
    pub title: String,
    /// When it was written, and of which robot.
    pub about: String,
    /// As it stood on the screen.
    pub picture: Picture,
    /// Headings of the table with their units; empty where the tile has none.
    pub headings: Vec<String>,
    /// Its rows.
    pub rows: Vec<Vec<String>>,
    /// Name and version of the program.
    pub version: String,
}

/// The tile as a PDF file, with its fonts.
///
/// # Errors
/// When the picture is incomplete, or the file cannot be made.
pub fn tile_pdf(tile: &Tile) -> Result<Vec<u8>, ReportError> {
    let rect = picture_rect(tile.picture.size_px);
    let mut pages = vec![first(tile)];
    table(tile, rect[1] + rect[3] + 24.0, &mut pages);
    let about = About {
        title: format!("{} · {}", tile.title, tile.about),
        sentence: format!("{}, with {} rows", tile.title, tile.rows.len()),
        version: tile.version.clone(),
    };
    pdf::of_pages(&pages, Some(Placed { picture: &tile.picture, rect }), &about)
}

/// As wide as the page where its pixels allow that.
fn picture_rect(size_px: [u32; 2]) -> [f64; 4] {
    let [width, height] = size_px.map(f64::from);
    let room = [(WIDTH - 2.0 * MARGIN) / width.max(1.0), PICTURE_HEIGHT / height.max(1.0)];
    let pixel = room[0].min(room[1]).min(LARGEST_PIXEL);
    [MARGIN, MARGIN + 40.0, pixel * width, pixel * height]
}

fn blank() -> Drawing {
    let mut drawing = Drawing::new(WIDTH, HEIGHT);
    drawing.rect(0.0, 0.0, WIDTH, HEIGHT, ink::PAPER);
    drawing
}

fn first(tile: &Tile) -> Drawing {
    let mut drawing = blank();
    let title = font::fit(&tile.title, WIDTH - 2.0 * MARGIN, Style::TITLE.size, Style::TITLE.weight);
    drawing.text([MARGIN, MARGIN + 14.0], title, Style::TITLE);
    let about = format!("{} · {}", tile.about, tile.version);
    drawing.text([MARGIN, MARGIN + 30.0], about, Style::BODY.color(ink::WEAK));
    drawing
}

/// Widths of the columns: as wide as their contents where all fit, else each gets its share.
fn columns(tile: &Tile, style: Style) -> Vec<f64> {
    let of = |k: usize| {
        let cells = tile.rows.iter().filter_map(|row| row.get(k)).chain(tile.headings.get(k));
        cells.map(|cell| font::width(cell, style.size, style.weight)).fold(0.0, f64::max)
    };
    let wanted: Vec<f64> = (0..tile.headings.len()).map(of).collect();
    let room = WIDTH - 2.0 * MARGIN - GUTTER * wanted.len().saturating_sub(1) as f64;
    let all: f64 = wanted.iter().sum();
    if all <= room {
        return wanted;
    }
    // Columns narrower than an equal share keep their width; the others share what is left.
    let equal = room / wanted.len().max(1) as f64;
    let (narrow, wide): (Vec<f64>, Vec<f64>) = wanted.iter().partition(|width| **width <= equal);
    let left = (room - narrow.iter().sum::<f64>()) / wide.iter().sum::<f64>().max(1e-9);
    wanted.iter().map(|width| if *width <= equal { *width } else { width * left }).collect()
}

fn table(tile: &Tile, from: f64, pages: &mut Vec<Drawing>) {
    if tile.headings.is_empty() {
        return;
    }
    let style = Style::SMALL.color(ink::TEXT);
    let widths = columns(tile, style);
    let line = |drawing: &mut Drawing, y: f64, cells: &[String], style: Style| {
        let mut x = MARGIN;
        for (cell, width) in cells.iter().zip(&widths) {
            drawing.text([x, y], font::fit(cell, *width + 0.5, style.size, style.weight), style);
            x += width + GUTTER;
        }
    };
    let head = |drawing: &mut Drawing, y: f64| {
        line(drawing, y, &tile.headings, Style::SMALL);
        drawing.line(vec![[MARGIN, y + 3.5], [WIDTH - MARGIN, y + 3.5]], Stroke::new(ink::LINE, 0.6));
    };
    let mut y = from;
    if let Some(page) = pages.last_mut() {
        head(page, y);
    }
    for row in &tile.rows {
        y += ROW;
        if y > HEIGHT - MARGIN {
            let mut page = blank();
            y = MARGIN + ROW;
            head(&mut page, y);
            y += ROW;
            pages.push(page);
        }
        if let Some(page) = pages.last_mut() {
            line(page, y, row, style);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::Mark;

    fn sample(rows: usize, columns: usize) -> Tile {
        Tile {
            title: "Touches".to_owned(),
            about: "2026-11-23 15:00 · nico".to_owned(),
            picture: Picture { size_px: [40, 30], rgba: vec![200; 40 * 30 * 4] },
            headings: (0..columns).map(|k| format!("heading_{k}_mm")).collect(),
            rows: (0..rows)
                .map(|i| (0..columns).map(|k| format!("value {i} {k}").repeat(1 + k % 3)).collect())
                .collect(),
            version: "Plumbline 0".to_owned(),
        }
    }

    #[test]
    fn every_row_stands_on_a_page_and_nothing_leaves_it_or_meets_its_neighbor() {
        for (rows, columns) in [(0, 0), (3, 2), (200, 14)] {
            let tile = sample(rows, columns);
            let mut pages = vec![first(&tile)];
            table(&tile, 500.0, &mut pages);
            let mut found = 0;
            for page in &pages {
                let texts = page.marks.iter().filter_map(|mark| match mark {
                    Mark::Text(text) => Some(text),
                    _ => None,
                });
                let texts: Vec<_> = texts.collect();
                found += texts.iter().filter(|text| text.text.starts_with("val")).count();
                for text in &texts {
                    assert!(text.at[1] < HEIGHT - MARGIN + 1.0 && text.left() >= MARGIN - 1e-9);
                    let end = text.left() + text.width();
                    assert!(end <= WIDTH - MARGIN + 1.0, "{text:?}");
                    let beside = |other: &&&crate::drawing::Text| {
                        (other.at[1] - text.at[1]).abs() < 1e-9 && other.left() > text.left()
                    };
                    assert!(texts.iter().filter(beside).all(|other| end <= other.left() + 1e-9), "{text:?}");
                }
            }
            assert_eq!(found, rows * columns);
            let file = tile_pdf(&tile).expect("written");
            assert!(file.starts_with(b"%PDF"));
        }
    }

    #[test]
    fn a_picture_with_pixels_missing_is_refused() {
        let mut tile = sample(1, 1);
        tile.picture.rgba.pop();
        assert!(tile_pdf(&tile).expect_err("incomplete").to_string().contains("incomplete"));
    }
}
