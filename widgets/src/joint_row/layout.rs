//! The columns that all rows share.

use egui::{Align2, Rect, Sense, TextStyle, Ui, pos2, vec2};

use crate::theme::{self, space};

/// Height of a closed row, in points.
pub const ROW_HEIGHT: f32 = 26.0;

const GAP: f32 = space::S;
const PRESENT: f32 = 48.0;
const GOAL: f32 = 58.0;
const LOAD: f32 = 52.0;
const TEMPERATURE: f32 = 66.0;
const TORQUE: f32 = 46.0;
const LEAST_BAR: f32 = 90.0;
/// Below this width there is no load.
const NARROW: f32 = 560.0;

/// Where the cells of a row are.
pub(super) struct Columns {
    pub(super) name: Rect,
    pub(super) bar: Rect,
    pub(super) present: Rect,
    pub(super) goal: Rect,
    /// Left out where the row is narrow; the open row still shows it.
    pub(super) load: Option<Rect>,
    pub(super) temperature: Rect,
    pub(super) torque: Rect,
}

impl Columns {
    pub(super) fn of(row: Rect) -> Self {
        let wide = row.width() >= NARROW;
        let load = if wide { LOAD + GAP } else { 0.0 };
        let right = PRESENT + GOAL + load + TEMPERATURE + TORQUE + 4.0 * GAP;
        let name = (row.width() - right - LEAST_BAR - GAP).clamp(84.0, 176.0);
        let bar = (row.width() - right - name - GAP).max(LEAST_BAR);
        let mut x = row.left();
        let mut cell = |width: f32| {
            let cell = Rect::from_x_y_ranges(x..=x + width, row.y_range());
            x += width + GAP;
            cell
        };
        Self {
            name: cell(name),
            bar: cell(bar),
            present: cell(PRESENT),
            goal: cell(GOAL),
            load: wide.then(|| cell(LOAD)),
            temperature: cell(TEMPERATURE),
            torque: cell(TORQUE),
        }
    }

    /// What a sentence takes in place of position and goal.
    pub(super) fn bar_to_goal(&self) -> Rect {
        self.bar.union(self.goal)
    }

    pub(super) fn width(&self) -> f32 {
        self.torque.right() - self.name.left()
    }
}

/// The heads of the columns; draw it once above the rows.
pub fn joint_header(ui: &mut Ui) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 20.0), Sense::hover());
    let columns = Columns::of(rect);
    let tokens = theme::tokens(ui);
    let font = theme::font(ui, &TextStyle::Small);
    let text = |at: egui::Pos2, anchor: Align2, text: &str| {
        ui.painter().text(at, anchor, text, font.clone(), tokens.text_weak)
    };
    let left = |cell: Rect| pos2(cell.left(), cell.center().y);
    let right = |cell: Rect| pos2(cell.right(), cell.center().y);
    text(left(columns.name) + vec2(space::M, 0.0), Align2::LEFT_CENTER, "joint");
    // The markers are explained where they stand.
    let y = columns.bar.center().y;
    let mut x = columns.bar.left() + super::bar::ends(columns.bar.width());
    super::bar::present_marker(ui.painter(), pos2(x + 4.0, y), tokens.measured);
    x = text(pos2(x + 12.0, y), Align2::LEFT_CENTER, "measured").right() + space::M;
    if columns.bar.width() > 150.0 {
        super::bar::goal_marker(ui.painter(), pos2(x + 4.0, y), tokens.predicted, tokens.panel);
        text(pos2(x + 13.0, y), Align2::LEFT_CENTER, "goal");
    }
    text(right(columns.present), Align2::RIGHT_CENTER, "now");
    text(right(columns.goal) - vec2(6.0, 0.0), Align2::RIGHT_CENTER, "goal");
    if let Some(load) = columns.load {
        text(load.center(), Align2::CENTER_CENTER, "load");
    }
    text(left(columns.temperature), Align2::LEFT_CENTER, "servo");
    text(columns.torque.center(), Align2::CENTER_CENTER, "torque");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_do_not_overlap_and_end_with_the_row() {
        for width in [470.0, 559.0, 560.0, 800.0, 1200.0] {
            let row = Rect::from_min_size(pos2(10.0, 5.0), vec2(width, ROW_HEIGHT));
            let c = Columns::of(row);
            let mut cells = vec![c.name, c.bar, c.present, c.goal];
            cells.extend(c.load);
            cells.extend([c.temperature, c.torque]);
            for pair in cells.windows(2) {
                assert!(pair[0].right() + 7.9 <= pair[1].left(), "{width}");
            }
            assert!((c.torque.right() - row.right()).abs() < 0.1, "{width}: {}", c.torque.right());
        }
    }
}
