//! The fields of a plan.

use egui::{Grid, TextEdit, Ui, WidgetInfo, vec2};
use plumbline_model::touch_plan::{Finger, Pattern, PlanOptions, Purpose, Sides};
use plumbline_widgets::NumberField;
use plumbline_widgets::buttons::choice;
use plumbline_widgets::theme::{self, space};

use super::words;
use crate::operator::{screen_of, usual_area};
use crate::panels::PanelContext;
use crate::panels::parts::warning;

/// Below this width fields stand below what they are called, pt.
const NARROW: f32 = 360.0;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>, options: &PlanOptions) {
    let mut edited = options.clone();
    ui.spacing_mut().interact_size.y = 22.0;
    let narrow = ui.available_width() < NARROW;
    let fields = |ui: &mut Ui| {
        row(ui, narrow, "For", |ui| purpose(ui, &mut edited.purpose));
        row(ui, narrow, "With", |ui| finger(ui, cx, &mut edited));
        area(ui, narrow, cx, &mut edited);
        patterns(ui, narrow, &mut edited.patterns);
        row(ui, narrow, "Each target", |ui| {
            count(ui, "Times each target", &mut edited.repeats, 1..=20);
            ui.label(theme::weak(ui, if edited.repeats == 1 { "time" } else { "times" }));
        });
        row(ui, narrow, "Coming from", |ui| {
            let sides = [(Sides::Above, "Above"), (Sides::LeftAndRight, "Left and right")];
            choice(ui, "Coming from", &mut edited.sides, &sides);
        });
        let typed = &mut cx.state.touch.draft.typed;
        row(ui, narrow, "Screen raised by", |ui| {
            list(ui, &HEIGHTS, &mut typed[0], &mut edited.screen_heights_m);
        });
        row(ui, narrow, "Weight in the hand", |ui| {
            list(ui, &WEIGHTS, &mut typed[1], &mut edited.payloads_kg);
        });
    };
    if narrow {
        ui.vertical(fields);
    } else {
        Grid::new("plan").num_columns(2).spacing([space::M, space::XS]).show(ui, fields);
    }
    cx.state.touch.draft.change(edited);
}

/// What a field is called stands beside it, or above it where the tile is narrow.
fn row(ui: &mut Ui, narrow: bool, label: &str, contents: impl FnOnce(&mut Ui)) {
    ui.label(theme::weak(ui, label));
    cell(ui, narrow, contents);
    ui.end_row();
}

/// A grid puts what is as high as one line in the middle of its row, from where more lines would grow over the next
/// row: this begins at the top.
fn cell(ui: &mut Ui, narrow: bool, contents: impl FnOnce(&mut Ui)) {
    if narrow {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(space::XS, space::XS);
            contents(ui);
        });
        ui.add_space(space::XS);
        return;
    }
    ui.vertical(|ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = space::XS;
            contents(ui);
        });
    });
}

fn purpose(ui: &mut Ui, purpose: &mut Purpose) {
    let all = [Purpose::PlaceScreen, Purpose::Train, Purpose::Check].map(|one| (one, words::purpose(one)));
    choice(ui, "For", purpose, &all);
}

/// Another finger reaches another part of the screen.
fn finger(ui: &mut Ui, cx: &PanelContext<'_>, edited: &mut PlanOptions) {
    let fingers = [(Finger::Right, "Right index finger"), (Finger::Left, "Left index finger")];
    if choice(ui, "Finger", &mut edited.finger, &fingers)
        && let Some(usual) = usual_area(cx.view, edited.finger)
    {
        edited.area = usual;
    }
}

/// In pixels; the drawing beside drags it.
fn area(ui: &mut Ui, narrow: bool, cx: &PanelContext<'_>, edited: &mut PlanOptions) {
    let PlanOptions { area, finger, .. } = edited;
    let Some(screen) = screen_of(cx.view) else { return };
    let most = [screen.width_px, screen.height_px].map(|count| f64::from(count.saturating_sub(1)));
    row(ui, narrow, "Columns", |ui| {
        pixel(ui, "First column", &mut area.u_px[0], most[0]);
        ui.label(theme::weak(ui, "to"));
        pixel(ui, "Last column", &mut area.u_px[1], most[0]);
        ui.label(theme::weak(ui, "px"));
    });
    row(ui, narrow, "Rows", |ui| {
        pixel(ui, "First row", &mut area.v_px[0], most[1]);
        ui.label(theme::weak(ui, "to"));
        pixel(ui, "Last row", &mut area.v_px[1], most[1]);
        ui.label(theme::weak(ui, "px"));
        ui.add_space(space::S);
        let usual = usual_area(cx.view, *finger);
        let text = if cx.view.touch.reach[*finger as usize].is_some() { "In reach" } else { "All" };
        let button = ui.button(text).on_hover_text("The part of the screen that the finger reaches");
        if let (true, Some(usual)) = (button.clicked(), usual) {
            *area = usual;
        }
    });
}

/// A drag value also rounds what it is given, which is no wish: only what was dragged or typed
/// counts.
fn pixel(ui: &mut Ui, label: &str, value: &mut f64, most: f64) {
    let mut shown = value.round();
    let field = NumberField { name: label, range: 0.0..=most, suffix: "", speed: 2.0, decimals: 0 };
    if field.show(ui, &mut shown).on_hover_text(label).changed() && shown != value.round() {
        *value = shown;
    }
}

fn count(ui: &mut Ui, label: &str, value: &mut usize, range: std::ops::RangeInclusive<usize>) {
    NumberField { name: label, range, suffix: "", speed: 0.05, decimals: 0 }
        .show(ui, value)
        .on_hover_text(label);
}

/// One row per pattern, switched on and off by its box.
fn patterns(ui: &mut Ui, narrow: bool, patterns: &mut Vec<Pattern>) {
    let defaults = [
        Pattern::Corners,
        Pattern::Grid { columns: 7, rows: 4 },
        Pattern::Lines { horizontal: 2, vertical: 1, diagonal: 2, points: 7 },
        Pattern::Random { count: 20 },
        Pattern::Again { targets: 5, times: 4 },
        Pattern::Telling { places: 22, again: 3 },
    ];
    for default in defaults {
        let same = |one: &Pattern| std::mem::discriminant(one) == std::mem::discriminant(&default);
        let at = patterns.iter().position(same);
        let mut on = at.is_some();
        let changed = ui.checkbox(&mut on, name(&default)).changed();
        cell(ui, narrow, |ui| {
            if let Some(pattern) = at.and_then(|at| patterns.get_mut(at)) {
                fields(ui, pattern);
            }
        });
        ui.end_row();
        match (changed, at) {
            (true, None) => patterns.push(default),
            (true, Some(at)) => {
                patterns.remove(at);
            }
            (false, _) => {}
        }
    }
}

fn name(pattern: &Pattern) -> &'static str {
    match pattern {
        Pattern::Corners => "Corners",
        Pattern::Grid { .. } => "Grid",
        Pattern::Lines { .. } => "Lines",
        Pattern::Random { .. } => "Random",
        Pattern::Again { .. } => "Again",
        Pattern::Telling { .. } => "Most telling",
    }
}

fn fields(ui: &mut Ui, pattern: &mut Pattern) {
    let word = |ui: &mut Ui, text: &str| {
        ui.label(theme::weak(ui, text));
    };
    match pattern {
        Pattern::Corners => word(ui, "of the area"),
        Pattern::Grid { columns, rows } => {
            count(ui, "Columns of the grid", columns, 1..=40);
            word(ui, "×");
            count(ui, "Rows of the grid", rows, 1..=40);
            word(ui, "targets");
        }
        Pattern::Lines { horizontal, vertical, diagonal, points } => {
            ui.vertical(|ui| {
                ui.spacing_mut().item_spacing.y = space::XS;
                ui.horizontal(|ui| {
                    count(ui, "Lines across", horizontal, 0..=20);
                    word(ui, "across,");
                    count(ui, "Lines down", vertical, 0..=20);
                    word(ui, "down,");
                });
                ui.horizontal(|ui| {
                    count(ui, "Diagonals", diagonal, 0..=2);
                    word(ui, "diagonal,");
                    count(ui, "Targets per line", points, 2..=40);
                    word(ui, "targets each");
                });
            });
        }
        Pattern::Random { count: targets } => {
            count(ui, "Random targets", targets, 1..=1000);
            word(ui, "targets");
        }
        Pattern::Again { targets, times } => {
            count(ui, "Targets touched again", targets, 1..=40);
            word(ui, "targets");
            count(ui, "Times more", times, 1..=20);
            word(ui, "times more");
        }
        Pattern::Telling { places, again } => {
            count(ui, "Places that tell most", places, 1..=100);
            word(ui, "places, of them");
            count(ui, "Of them touched twice", again, 0..=40);
            word(ui, "twice");
        }
    }
}

/// A list of numbers in thousandths, and how large each may be.
struct List {
    name: &'static str,
    unit: &'static str,
    most: f64,
}

/// A block that is higher lifts the screen out of the arm's reach.
const HEIGHTS: List = List { name: "Heights of the screen", unit: "mm", most: 300.0 };
/// More than a hand of servos carries.
const WEIGHTS: List = List { name: "Weights", unit: "g", most: 1000.0 };

/// As people type it: "0, 60, 120".
fn list(ui: &mut Ui, of: &List, typed: &mut Option<String>, values: &mut Vec<f64>) {
    let mut text = typed.clone().unwrap_or_else(|| written(values));
    let edit = ui.add(TextEdit::singleline(&mut text).desired_width(110.0));
    edit.widget_info(|| WidgetInfo::labeled(egui::Role::TextInput, true, of.name));
    ui.label(theme::weak(ui, of.unit));
    if edit.changed() {
        *typed = Some(text);
    }
    let Some(text) = typed.clone() else { return };
    match (read(&text, of), edit.has_focus()) {
        (Ok(read), false) => {
            *values = read;
            *typed = None;
        }
        (Err(why), false) => warning(ui, &why),
        (_, true) => {}
    }
}

fn written(values: &[f64]) -> String {
    let all: Vec<String> = values.iter().map(|value| format!("{}", (value * 1e6).round() / 1e3)).collect();
    all.join(", ")
}

fn read(text: &str, of: &List) -> Result<Vec<f64>, String> {
    let mut all = vec![];
    for part in text.split([',', ';']).map(str::trim) {
        let number: f64 = part.parse().map_err(|_| "numbers with commas between: 0, 60".to_owned())?;
        if !(0.0..=of.most).contains(&number) {
            return Err(format!("{part} is not between 0 and {} {}", of.most, of.unit));
        }
        let value = number / 1e3;
        if all.contains(&value) {
            return Err(format!("{part} stands there twice"));
        }
        all.push(value);
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_numbers_survive_being_written_and_read() {
        assert_eq!(written(&[0.0, 0.06, 0.12]), "0, 60, 120");
        assert_eq!(read("0, 60 ,120", &HEIGHTS), Ok(vec![0.0, 0.06, 0.12]));
        assert_eq!(read(&written(&[0.0125]), &HEIGHTS), Ok(vec![0.0125]));
        let why = |text| read(text, &WEIGHTS).expect_err(text);
        assert!(why("0, a").contains("numbers with commas") && why("").contains("numbers with commas"));
        assert_eq!(why("9999999"), "9999999 is not between 0 and 1000 g");
        assert_eq!(
            (why("-5").as_str(), why("inf").as_str()),
            ("-5 is not between 0 and 1000 g", "inf is not between 0 and 1000 g",)
        );
        assert_eq!(why("0, 0.0"), "0.0 stands there twice");
    }
}
