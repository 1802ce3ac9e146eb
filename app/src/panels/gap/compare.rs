//! Which sessions are compared with which model, and how far they lie apart.

use egui::{Button, RichText, ScrollArea, Ui, vec2};
use plumbline_engine::view::{GapSession, ShownFinding};
use plumbline_engine::{GapCommand, GapModel};
use plumbline_widgets::buttons::choice;
use plumbline_widgets::format;
use plumbline_widgets::glyph::Glyph;
use plumbline_widgets::probability::{ShareRow, share_rows};
use plumbline_widgets::theme::{self, Role, space};

use super::parts::{line, state};
use crate::operator::words::gap as words;
use crate::operator::words::{clock, sentence};
use crate::operator::{GapAction, is_of_choice};
use crate::panels::parts::action_button;
use crate::panels::{PanelContext, padded};

/// Sessions that are seen without scrolling.
const ROWS: usize = 5;
const ROW_HEIGHT: f32 = 26.0;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            sessions(ui, cx);
            ui.add_space(space::S);
            model(ui, cx);
            ui.add_space(space::S);
            let gap = &cx.view.gap;
            state(ui, cx.view);
            match gap.shown.clone() {
                Some(shown) => {
                    if !is_of_choice(gap) && gap.searching.is_none() {
                        line(ui, Glyph::Info, Role::Weak, "Below is the finding of other sessions than those chosen.");
                    }
                    compared(ui, &shown);
                }
                None if gap.searching.is_none() && gap.failed.is_none() => {
                    ui.label(theme::weak(
                        ui,
                        "Comparing moves nothing: the robot's model predicts each row of the sessions, and what was measured is held against it.",
                    ));
                }
                None => {}
            }
        });
    });
}

fn sessions(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    ui.horizontal_wrapped(|ui| {
        ui.label(theme::strong(ui, "Sessions"));
        action_button(ui, cx, GapAction::ListSessions, "Look again");
        action_button(ui, cx, GapAction::OpenSession, "Open folder…");
    });
    let gap = cx.view.gap.clone();
    if gap.sessions.is_empty() {
        ui.label(theme::weak(ui, "No session yet: touch the screen (step 3), or open a folder."));
        return;
    }
    let height = ROW_HEIGHT * gap.sessions.len().clamp(1, ROWS) as f32 + space::XS;
    ScrollArea::vertical().id_salt("gap sessions").max_height(height).auto_shrink([false, true]).show(
        ui,
        |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            for session in gap.sessions.iter() {
                row(ui, cx, session);
            }
        },
    );
    if gap.chosen.len() > 1 {
        let text = format!("{} are looked at together.", format::count(gap.chosen.len(), "session"));
        ui.label(theme::small(ui, text));
    }
}

/// One session with a check mark: any number can be looked at together.
fn row(ui: &mut Ui, cx: &mut PanelContext<'_>, session: &GapSession) {
    let gap = &cx.view.gap;
    let mut chosen = gap.chosen.contains(&session.folder);
    let when = session.started.map_or_else(|| session.name.clone(), |at| format!("begun {}", clock(at)));
    let text = match &session.problem {
        None => format!("{when} · {}", measured(session)),
        Some(problem) => format!("{when} · {problem}"),
    };
    let words = match &session.problem {
        None => session.folder.display().to_string(),
        Some(problem) => format!("{problem}\n{}", session.folder.display()),
    };
    ui.horizontal(|ui| {
        ui.set_height(ROW_HEIGHT);
        let usable = session.problem.is_none();
        // What is chosen can be taken out, also where it cannot be used.
        let can_change = usable || chosen;
        let check = ui.add_enabled(can_change, egui::Checkbox::without_text(&mut chosen));
        check.widget_info(|| {
            egui::WidgetInfo::selected(
                egui::Role::CheckBox,
                can_change,
                chosen,
                format!("Compare {}", session.name),
            )
        });
        if check.changed() {
            let mut sessions = gap.chosen.to_vec();
            if chosen {
                sessions.push(session.folder.clone());
            } else {
                sessions.retain(|folder| *folder != session.folder);
            }
            cx.outbox.send(GapCommand::Choose { sessions });
        }
        let tokens = theme::tokens(ui);
        let color = if usable { tokens.text } else { tokens.text_weak };
        let button = Button::selectable(false, RichText::new(&text).color(color)).truncate();
        let size = vec2(ui.available_width(), ROW_HEIGHT);
        let layout = egui::Layout::top_down_justified(egui::Align::Min);
        let response = ui.allocate_ui_with_layout(size, layout, |ui| ui.add_enabled(usable, button)).inner;
        let response = response.on_hover_text(&words).on_disabled_hover_text(&words);
        if response.clicked() {
            cx.outbox.send(GapCommand::Choose { sessions: vec![session.folder.clone()] });
        }
    });
}

/// "60 touches, 12 poses".
fn measured(session: &GapSession) -> String {
    let parts =
        [(session.touches, "touch"), (session.poses, "pose"), (session.localizations, "localization")];
    let said: Vec<String> =
        parts.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format::count(*n, what)).collect();
    said.join(", ")
}

fn model(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let gap = &cx.view.gap;
    let mut with = gap.with;
    ui.label(theme::strong(ui, "Compared with"));
    let in_use = if gap.model.effects.is_empty() {
        "Model in use (nominal)".to_owned()
    } else {
        format!("Model in use ({})", gap.model.name)
    };
    let options = [(GapModel::InUse, in_use.as_str()), (GapModel::Nominal, "Nominal")];
    if choice(ui, "Compared with", &mut with, &options) {
        cx.outbox.send(GapCommand::CompareWith(with));
    }
}

/// The verdict, and what the gap consists of.
fn compared(ui: &mut Ui, shown: &ShownFinding) {
    let finding = &shown.finding;
    let comparison = &finding.comparison;
    let (sign, role) = match comparison.is_gap || !comparison.is_noise_known() {
        true => (Glyph::Info, Role::Ink),
        false => (Glyph::Check, Role::Accepted),
    };
    ui.add_space(space::XS);
    theme::group_heading(ui, "Is there a gap?");
    line(ui, sign, role, words::is_there_a_gap(finding));
    for sentence in words::trust(finding) {
        ui.label(theme::small(ui, sentence));
    }
    ui.add_space(space::S);
    let noise = if comparison.is_noise_known() { "noise" } else { "best model" };
    for kind in &comparison.kinds {
        theme::group_heading(ui, &format!("Where it shows: {}", words::kind(kind.what)));
        let rows: Vec<ShareRow> = kind
            .coordinates
            .iter()
            .map(|of| {
                let quantity = words::quantity(of);
                ShareRow {
                    name: of.name.clone(),
                    share: of.share,
                    note: format!("{}, {noise} {}", quantity.text(of.rms), quantity.text(of.floor)),
                    role: Role::Difference,
                }
            })
            .collect();
        share_rows(ui, &rows);
    }
    let against = if comparison.is_noise_known() {
        "the noise of one measurement"
    } else {
        "what the best model leaves, which stands for the noise"
    };
    ui.label(theme::small(
        ui,
        format!(
            "Shares of the squared gap in units of the noise; beside them the rms of measured − predicted, the frame of the screen placed, and {against}."
        ),
    ));
    ui.add_space(space::S);
    for warning in &finding.warnings {
        line(ui, Glyph::Warning, Role::Warning, &sentence(warning));
    }
    left_out(ui, shown);
}

/// Rows that could not be used, by reason.
fn left_out(ui: &mut Ui, shown: &ShownFinding) {
    let mut reasons: Vec<(&str, usize)> = Vec::new();
    for row in &shown.finding.left_out {
        match reasons.iter_mut().find(|(why, _)| *why == row.why) {
            Some((_, count)) => *count += 1,
            None => reasons.push((&row.why, 1)),
        }
    }
    for (why, count) in reasons {
        ui.label(theme::small(ui, format!("Left out: {}, {why}.", format::count(count, "row"))));
    }
}
