//! Which board is used, counted in squares as people count, and how to solve.

use egui::Ui;
use plumbline_engine::{EyesCommand, View};
use plumbline_model::ModelKind;
use plumbline_widgets::NumberField;
use plumbline_widgets::buttons::choice;
use plumbline_widgets::theme::{self, Role, space};

use super::PanelContext;
use super::board_draft::BoardDraft;
use crate::operator::{Action, is_held_by_a_person, other_board};

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    super::padded(ui, |ui| {
        egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            board(ui, cx);
            ui.add_space(space::M);
            lens(ui, cx);
        });
    });
}

/// Where a tile is narrower, numbers stand below what they are.
const NARROW_PT: f32 = 190.0;

fn board(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let eyes = &cx.view.eyes;
    let draft = match cx.state.board {
        Some(draft) if draft.from == eyes.board => draft,
        _ => BoardDraft::of(&eyes.board),
    };
    let mut edited = draft;
    if ui.available_width() < NARROW_PT {
        ui.label("Squares");
        squares(ui, &mut edited);
        ui.label("Side of one");
        side(ui, &mut edited);
    } else {
        egui::Grid::new("board").num_columns(2).spacing([space::S, space::S]).show(ui, |ui| {
            ui.label("Squares");
            squares(ui, &mut edited);
            ui.end_row();
            ui.label("Side of one");
            side(ui, &mut edited);
            ui.end_row();
        });
    }
    chosen(ui, cx, draft, edited);
}

fn squares(ui: &mut Ui, edited: &mut BoardDraft) {
    ui.horizontal(|ui| {
        number(ui, "Squares across", &mut edited.columns);
        ui.label("×");
        number(ui, "Squares down", &mut edited.rows);
    });
}

fn side(ui: &mut Ui, edited: &mut BoardDraft) {
    let side =
        NumberField { name: "Side of a square", range: 1.0..=1000.0, suffix: " mm", speed: 0.1, decimals: 3 };
    side.show(ui, &mut edited.square_mm)
        .on_hover_text("Measure several squares with a ruler and divide: all lengths rest on it");
}

/// What comes of the numbers, and what is seen.
fn chosen(ui: &mut Ui, cx: &mut PanelContext<'_>, draft: BoardDraft, edited: BoardDraft) {
    let eyes = &cx.view.eyes;
    match edited.board() {
        Ok(board) => {
            let inner = format!("{}×{} inner corners", board.inner_columns, board.inner_rows);
            ui.label(theme::small(ui, inner));
            if board != eyes.board || (edited != draft && !eyes.board_chosen) {
                let (columns, rows) = board.squares();
                cx.outbox.send(EyesCommand::ChooseBoard { columns, rows, square_m: board.square_m });
            }
        }
        Err(why) => {
            ui.label(egui::RichText::new(why).color(Role::Warning.color(theme::tokens(ui))));
        }
    }
    // Kept while it cannot be used, so that typing goes on from what was typed.
    cx.state.board = edited.board().is_err().then_some(edited);
    seen(ui, cx.view);
    if let Some((columns, rows)) = other_board(eyes)
        && ui.button(format!("Use {columns}×{rows} squares")).clicked()
    {
        cx.outbox.act(Action::UseSeenBoard);
    }
    ui.add_space(space::XS);
    let action = Action::RecognizeBoard;
    let refusal = action.refusal(cx.view);
    let button = ui.add_enabled(refusal.is_none(), egui::Button::new(action.label()).wrap());
    let button = button.on_hover_text("Counts the squares of the board in the newest pair");
    if button.on_disabled_hover_text(refusal.unwrap_or_default()).clicked() {
        cx.outbox.act(action);
    }
}

fn number(ui: &mut Ui, label: &str, value: &mut u32) {
    NumberField { name: label, range: 2..=41, suffix: "", speed: 0.05, decimals: 0 }
        .show(ui, value)
        .on_hover_text(label);
}

/// What a search for any board found, when that differs from what is looked for.
fn seen(ui: &mut Ui, view: &View) {
    let eyes = &view.eyes;
    let Some(seen) = &eyes.board_seen else { return };
    let as_chosen = seen.inner_corners.is_some() && other_board(eyes).is_none();
    // No board is in view most of the time, and nothing is wrong then.
    let role = match seen.inner_corners {
        None => Role::Weak,
        Some(_) if as_chosen => Role::Accepted,
        Some(_) => Role::Warning,
    };
    ui.add_space(space::XS);
    // How to hold it is of use to who holds it.
    let is_held = seen.inner_corners.is_some() || is_held_by_a_person(view);
    let text = if is_held { &seen.text } else { "No chessboard is seen." };
    ui.label(egui::RichText::new(text).color(role.color(theme::tokens(ui))));
}

fn lens(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let mut options = cx.view.eyes.options.clone();
    ui.label(theme::strong(ui, "Solve with"));
    let kinds = [(ModelKind::Fisheye, "Fisheye lens"), (ModelKind::Pinhole, "Pinhole lens")];
    choice(ui, "Lens model", &mut options.model, &kinds);
    ui.checkbox(&mut options.leave_out_bad_corners, "Leave out bad corners")
        .on_hover_text("Single corners that were found wrongly are left out; the pair stays");
    let mut cross_validate = options.cross_validation_folds > 0;
    let hover = "Solves again without each fifth of the pairs, and tells the error on those";
    if ui.checkbox(&mut cross_validate, "Cross-validate").on_hover_text(hover).changed() {
        options.cross_validation_folds = if cross_validate { 5 } else { 0 };
    }
    if options != cx.view.eyes.options {
        cx.outbox.send(EyesCommand::ChooseOptions(options));
    }
}
