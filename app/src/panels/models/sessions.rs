//! Which session is learned from, and what it has.

use std::path::Path;

use egui::{Button, Label, RichText, ScrollArea, Ui, vec2};
use plumbline_engine::ModelsCommand;
use plumbline_engine::view::TouchSession;
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::key_value::{KeyValue, key_value_grid};
use plumbline_widgets::theme::{self, Role, space};

use crate::operator::ModelsAction;
use crate::operator::snapshot::models::{Repeats, TouchData};
use crate::operator::words::{clock, noise_of_repeats};
use crate::panels::PanelContext;
use crate::panels::parts::action_button;

/// Sessions that are seen without scrolling.
const ROWS: usize = 4;
const ROW_HEIGHT: f32 = 28.0;

pub(super) fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    // In a narrow tile the buttons stand below the heading.
    ui.horizontal_wrapped(|ui| {
        ui.label(theme::strong(ui, "Touches"));
        action_button(ui, cx, ModelsAction::ListSessions, "Look again");
        action_button(ui, cx, ModelsAction::OpenSession, "Open folder…");
    });
    let sessions = cx.view.models.sessions.clone();
    let height = ROW_HEIGHT * sessions.len().clamp(1, ROWS) as f32 + space::XS;
    ScrollArea::vertical().id_salt("touch sessions").max_height(height).auto_shrink([false, true]).show(
        ui,
        |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            for session in sessions.iter() {
                row(ui, cx, session);
            }
        },
    );
    // A folder that was opened from elsewhere is in no list.
    if let Some(chosen) = &cx.view.models.session
        && !sessions.iter().any(|session| session.folder == *chosen)
    {
        ui.label(theme::small(ui, format!("Opened: {}", name(chosen))));
    }
    ui.add_space(space::XS);
    match &cx.view.models.data {
        Some(Ok(data)) => {
            let facts = super::parts::facts(cx);
            has(ui, data, facts.noise.as_ref());
        }
        Some(Err(why)) => {
            let color = Role::Warning.color(theme::tokens(ui));
            ui.label(RichText::new(why.to_string()).color(color));
        }
        None if cx.view.models.session.is_some() => {
            ui.horizontal(|ui| {
                ui.spinner();
                ui.label(theme::weak(ui, "Reading the touches."));
            });
        }
        None => {
            ui.label(theme::weak(ui, "Choose the session to learn from."));
        }
    }
}

fn row(ui: &mut Ui, cx: &mut PanelContext<'_>, session: &TouchSession) {
    let chosen = cx.view.models.session.as_ref() == Some(&session.folder);
    let when = session.started.map_or_else(|| name(&session.folder), clock);
    let text = match &session.problem {
        None => format!("{when} · {}", format::count(session.touches, "touch")),
        Some(problem) => format!("{when} · {problem}"),
    };
    let usable = session.problem.is_none();
    let color = if usable { theme::tokens(ui).text } else { theme::tokens(ui).text_weak };
    let button = Button::selectable(chosen, RichText::new(&text).color(color)).truncate();
    let size = vec2(ui.available_width(), ROW_HEIGHT);
    // Left, because the lines are read below each other.
    let layout = egui::Layout::top_down_justified(egui::Align::Min);
    let response = ui
        .allocate_ui_with_layout(size, layout, |ui| {
            if usable {
                return ui.add(button);
            }
            ui.set_height(ROW_HEIGHT);
            ui.horizontal_centered(|ui| {
                ui.add_space(ui.spacing().button_padding.x);
                ui.add(Label::new(RichText::new(text).color(color)).truncate().selectable(false))
            })
            .inner
        })
        .inner;
    let folder = session.folder.display().to_string();
    let words = session.problem.clone().map_or(folder.clone(), |problem| format!("{problem}\n{folder}"));
    let response = response.on_hover_text(&words);
    if usable && !chosen && response.clicked() {
        cx.outbox.send(ModelsCommand::ChooseSession { session: session.folder.clone() });
    }
}

fn name(folder: &Path) -> String {
    folder.file_name().unwrap_or(folder.as_os_str()).to_string_lossy().into_owned()
}

/// Touches, sets, repeats, and what was left out.
fn has(ui: &mut Ui, data: &TouchData, noise: Option<&Repeats>) {
    let mut sets: Vec<&str> = data.touches.iter().filter_map(|touch| touch.set.as_deref()).collect();
    sets.sort_unstable();
    sets.dedup();
    let sets = match sets.len() {
        0 => "none; areas are held out".to_owned(),
        n => n.to_string(),
    };
    let noise_help = match noise {
        Some(noise) => format!(
            "Spread of {} in {} of repeats, rms in the plane: no model can do better.",
            format::count(noise.touches, "touch"),
            format::count(noise.groups, "group"),
        ),
        None => "No touch was repeated, so the noise of touching is not known.".to_owned(),
    };
    key_value_grid(
        ui,
        "touches of the session",
        &[
            KeyValue::text("touches to learn from", data.len().to_string()),
            KeyValue::text("sets", sets)
                .help("Touches of one set are held out together: a line, a grid, a day."),
            KeyValue::optional(
                noise_of_repeats(noise.map(|noise| noise.touches)),
                Quantity::Length,
                noise.map(|noise| noise.rms_2d_m),
            )
            .help(noise_help),
        ],
    );
    for sentence in &data.left_out {
        ui.label(theme::small(ui, format!("Left out: {sentence}.")));
    }
}
