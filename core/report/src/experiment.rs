//! The page of an experiment with grasps: a table of the methods, and a map of the table for each, as in
//! the published figures.

use crate::drawing::{Anchor, Color, Drawing, Stroke, Style, ink};
use crate::page::{HEIGHT, MARGIN, WIDTH};
use crate::{About, ReportError, html, pdf};

/// Maps beside each other.
const COLUMNS: usize = 2;
/// Between two maps.
const GUTTER: f64 = 18.0;
/// Height of a map with its heading.
const MAP_HEIGHT: f64 = 176.0;
/// What the maps show of the table, robot frame: x (up the page) and y (to the left), m.
const SHOWN_M: [[f64; 2]; 2] = [[0.12, 0.56], [-0.46, 0.46]];
/// Radius of a position.
const DOT: f64 = 8.5;

/// What stands on the page.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// "Grasps of a tomato by the twin lab".
    pub title: String,
    /// What was done and with what, a sentence each.
    pub sentences: Vec<String>,
    /// Corners of the touchscreen, in order around it: x, y, m.
    pub screen_m: [[f64; 2]; 4],
    /// The area of the published networks: x and y, from and to, m.
    pub area_m: [[f64; 2]; 2],
    /// Places of the published grid that the published arm does not reach: x, y, m.
    pub beyond_m: Vec<[f64; 2]>,
    /// One per method, in the order in which they are shown.
    pub methods: Vec<Method>,
    /// Name and version of the program.
    pub version: String,
}

/// What came of a method.
#[derive(Clone, Debug, PartialEq)]
pub struct Method {
    /// "M3".
    pub name: String,
    /// Cells of the table behind the name, as the headings of [`TABLE`].
    pub cells: Vec<String>,
    /// One after the other.
    pub positions: Vec<Position>,
}

/// Headings of the table behind the name of the method.
pub const TABLE: [&str; 10] = [
    "all",
    "published",
    "inside",
    "published",
    "hand found",
    "refused",
    "palm off, mm",
    "eyes, mm",
    "arm, mm",
    "time, s",
];

/// What came of a position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position {
    /// Robot frame, m.
    pub at_m: [f64; 2],
    /// Lifted.
    pub successes: usize,
    /// Of these.
    pub attempts: usize,
    /// Lifted in the published experiment, of three; `None`: not published.
    pub published: Option<usize>,
    /// Whether the hand was found; `None`: it was not looked for.
    pub hand_found: Option<bool>,
}

/// The page as an HTML file that needs no other file.
pub fn experiment_html(experiment: &Experiment) -> String {
    html::of(&draw(experiment), &about(experiment))
}

/// The page as a PDF file, with its fonts.
///
/// # Errors
/// When the file cannot be made; HTML always can.
pub fn experiment_pdf(experiment: &Experiment) -> Result<Vec<u8>, ReportError> {
    pdf::of(&draw(experiment), &about(experiment))
}

fn about(experiment: &Experiment) -> About {
    About {
        title: experiment.title.clone(),
        sentence: experiment.sentences.join(" "),
        version: experiment.version.clone(),
    }
}

fn draw(experiment: &Experiment) -> Drawing {
    let mut drawing = Drawing::new(WIDTH, HEIGHT);
    drawing.rect(0.0, 0.0, WIDTH, HEIGHT, ink::PAPER);
    let mut y = MARGIN + 14.0;
    drawing.text([MARGIN, y], &experiment.title, Style::TITLE);
    y += 18.0;
    for sentence in &experiment.sentences {
        y = drawing.paragraph([MARGIN, y], WIDTH - 2.0 * MARGIN, sentence, Style::BODY, 3);
    }
    y = table(&mut drawing, y + 10.0, experiment) + 16.0;
    let width = (WIDTH - 2.0 * MARGIN - GUTTER * (COLUMNS - 1) as f64) / COLUMNS as f64;
    for (i, method) in experiment.methods.iter().enumerate() {
        let (column, row) = (i % COLUMNS, i / COLUMNS);
        let x = MARGIN + column as f64 * (width + GUTTER);
        let frame = Frame { x, y: y + row as f64 * MAP_HEIGHT, width };
        map(&mut drawing, &frame, experiment, method);
    }
    legend(&mut drawing, HEIGHT - MARGIN + 6.0);
    drawing
}

/// The table of the methods; the base line after it.
fn table(drawing: &mut Drawing, top: f64, experiment: &Experiment) -> f64 {
    let first = MARGIN + 36.0;
    let step = (WIDTH - MARGIN - first) / TABLE.len() as f64;
    let column = |k: usize| first + (k as f64 + 1.0) * step - 4.0;
    let mut y = top;
    for (k, heading) in TABLE.iter().enumerate() {
        let style = if *heading == "published" { Style::SMALL } else { Style::SMALL.bold() };
        drawing.anchored([column(k), y], heading, style, Anchor::End);
    }
    y += 4.0;
    drawing.line(vec![[MARGIN, y], [WIDTH - MARGIN, y]], Stroke::new(ink::LINE, 0.6));
    for method in &experiment.methods {
        y += 13.0;
        drawing.text([MARGIN, y], &method.name, Style::BODY.bold());
        for (k, cell) in method.cells.iter().enumerate().take(TABLE.len()) {
            let weak = TABLE[k] == "published";
            let style = if weak { Style::BODY.color(ink::WEAK) } else { Style::BODY };
            drawing.anchored([column(k), y], cell, style, Anchor::End);
        }
    }
    y
}

/// Where a map stands.
struct Frame {
    x: f64,
    y: f64,
    width: f64,
}

impl Frame {
    fn height(&self) -> f64 {
        MAP_HEIGHT - 34.0
    }

    /// A place of the table on the page: x up, y to the left.
    fn at(&self, [x_m, y_m]: [f64; 2]) -> [f64; 2] {
        let [[near, far], [right, left]] = SHOWN_M;
        let scale = (self.width / (left - right)).min(self.height() / (far - near));
        [self.x + (left - y_m) * scale, self.y + 14.0 + (far - x_m) * scale]
    }
}

fn map(drawing: &mut Drawing, frame: &Frame, experiment: &Experiment, method: &Method) {
    drawing.text([frame.x, frame.y + 6.0], &method.name, Style::HEADING);
    let [[near, far], [right, left]] = SHOWN_M;
    let corners = [[near, right], [near, left], [far, left], [far, right]];
    drawing.polygon(corners.map(|corner| frame.at(corner)).to_vec(), ink::TRACK, 1.0);
    let screen: Vec<[f64; 2]> = experiment.screen_m.iter().map(|corner| frame.at(*corner)).collect();
    drawing.polygon(screen, ink::GRID, 1.0);
    let [[x0, x1], [y0, y1]] = experiment.area_m;
    let area = [[x0, y0], [x0, y1], [x1, y1], [x1, y0], [x0, y0]];
    let dashed = Stroke::new(ink::WEAK, 0.7).dashed(3.0, 2.0);
    drawing.line(area.map(|corner| frame.at(corner)).to_vec(), dashed);
    for at_m in &experiment.beyond_m {
        if !method.positions.iter().any(|position| position.at_m == *at_m) {
            let at = frame.at(*at_m);
            drawing.circle(at, 0.35 * DOT, ink::WEAK, 1.0);
            drawing.circle(at, 0.35 * DOT - 0.8, ink::TRACK, 1.0);
        }
    }
    for position in &method.positions {
        let at = frame.at(position.at_m);
        let share = position.successes as f64 / position.attempts.max(1) as f64;
        drawing.circle(at, DOT, color(share, position.hand_found), 1.0);
        let count = position.successes.to_string();
        drawing.anchored([at[0], at[1] + 2.9], count, Style::BODY.bold().color(ink::PAPER), Anchor::Middle);
        if let Some(published) = position.published {
            let beside = [at[0] + DOT + 1.5, at[1] + DOT - 1.0];
            drawing.text(beside, published.to_string(), Style::SMALL);
        }
    }
    let robot = frame.at([near, 0.0]);
    drawing.anchored([robot[0], robot[1] + 8.0], "robot", Style::SMALL, Anchor::Middle);
}

/// From missed to lifted; gray where the hand was not located.
fn color(share: f64, hand_found: Option<bool>) -> Color {
    if hand_found == Some(false) && share == 0.0 {
        return ink::FLOOR;
    }
    let (low, high) = (ink::BEFORE, ink::AFTER);
    let mix = |a: u8, b: u8| (f64::from(a) + share * (f64::from(b) - f64::from(a))).round() as u8;
    Color(mix(low.0, high.0), mix(low.1, high.1), mix(low.2, high.2))
}

fn legend(drawing: &mut Drawing, y: f64) {
    let text = "In the dots: lifted; small beside them: lifted of three in the published experiment on the robot. Blue: \
                always lifted, orange: never, gray: never, and the hand was not located to 15 mm; small rings: \
                beyond the reach of the published arm. Light gray: touchscreen; dashed: area of the published networks. Hand found: to 15 mm. Palm off: where \
                the hand closed, median … worst; eyes and arm: medians of what each of the two errs by itself.";
    drawing.paragraph([MARGIN, y - 10.0], WIDTH - 2.0 * MARGIN, text, Style::SMALL, 3);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Experiment {
        let position = Position {
            at_m: [0.3, -0.1],
            successes: 2,
            attempts: 3,
            published: Some(1),
            hand_found: Some(true),
        };
        Experiment {
            title: "Grasps <of> a tomato".to_owned(),
            sentences: vec!["66 attempts.".to_owned()],
            screen_m: [[0.55, 0.24], [0.55, -0.24], [0.28, -0.24], [0.28, 0.24]],
            area_m: [[0.27, 0.48], [-0.23, 0.23]],
            beyond_m: vec![[0.5, -0.4], [0.5, 0.4]],
            methods: (1..=5)
                .map(|k| Method {
                    name: format!("M{k}"),
                    cells: TABLE.iter().map(|heading| (*heading).to_owned()).collect(),
                    positions: vec![position],
                })
                .collect(),
            version: "0".to_owned(),
        }
    }

    #[test]
    fn html_and_pdf_hold_every_method_and_every_count() {
        let page = experiment_html(&sample());
        assert!(page.contains("Grasps &lt;of&gt; a tomato") && page.ends_with("</html>\n"));
        for k in 1..=5 {
            assert!(page.matches(&format!("M{k}")).count() >= 2, "in the table and over its map");
        }
        assert!(experiment_pdf(&sample()).expect("written").starts_with(b"%PDF"));
    }

    #[test]
    fn everything_stands_on_the_page_and_left_is_left() {
        let drawing = draw(&sample());
        for mark in &drawing.marks {
            if let crate::drawing::Mark::Circle { center: [x, y], radius, .. } = mark {
                assert!(*x > MARGIN + radius && *x < WIDTH - MARGIN - radius);
                assert!(*y > MARGIN && *y < HEIGHT - MARGIN);
            }
        }
        let frame = Frame { x: 0.0, y: 0.0, width: 240.0 };
        assert!(frame.at([0.3, 0.2])[0] < frame.at([0.3, -0.2])[0], "the robot's left");
        assert!(frame.at([0.4, 0.0])[1] < frame.at([0.2, 0.0])[1], "far is up");
    }
}
