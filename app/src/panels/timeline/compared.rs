//! Two entries side by side.

use egui::{Grid, ScrollArea, Ui};
use plumbline_engine::view::{Figure, TimelineEntry};
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::theme::{self, space};

use crate::operator::words::clock;
use crate::operator::words::timeline::{errors, figure, title};
use crate::panels::{PanelContext, padded};

/// What is compared, and what an entry says of it.
type Row = (&'static str, fn(&TimelineEntry) -> String);

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let timeline = &cx.view.timeline;
    let mut chosen: Vec<&TimelineEntry> =
        cx.state.timeline.chosen.iter().filter_map(|number| timeline.entry(*number)).collect();
    chosen.sort_by_key(|entry| (entry.at, entry.number));
    let [first, second] = chosen[..] else {
        let message = Message::new("Nothing to compare", "Click two entries of the timeline.");
        EmptyState::empty(message).show(ui);
        return;
    };
    padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            if ui.available_width() < NARROW {
                for entry in [first, second] {
                    below_each_other(ui, entry);
                }
                ui.label(difference(first, second));
                return;
            }
            let width = ((ui.available_width() - 64.0 - 2.0 * space::M) * 0.5).max(60.0);
            Grid::new("timeline compared").num_columns(3).spacing([space::M, 4.0]).show(ui, |ui| {
                let rows: [Row; 5] = [
                    ("when", |entry| clock(entry.at)),
                    ("of", |entry| entry.subject.name().to_owned()),
                    ("what", title),
                    ("error", errors),
                    ("of what", |entry| entry.basis.clone()),
                ];
                for (name, of) in rows {
                    ui.label(theme::weak(ui, name));
                    for entry in [first, second] {
                        ui.vertical(|ui| {
                            ui.set_width(width);
                            ui.add(egui::Label::new(of(entry)).wrap());
                        });
                    }
                    ui.end_row();
                }
            });
            ui.add_space(space::S);
            ui.label(difference(first, second));
        });
    });
}

/// Side by side a column would be a word wide, pt.
const NARROW: f32 = 380.0;

/// One of both, all of it in its own lines.
fn below_each_other(ui: &mut Ui, entry: &TimelineEntry) {
    ui.label(theme::small(ui, format!("{} · {}", clock(entry.at), entry.subject.name())));
    ui.add(egui::Label::new(title(entry)).wrap());
    let errors = errors(entry);
    if !errors.is_empty() {
        ui.label(theme::strong(ui, errors));
    }
    if !entry.basis.is_empty() {
        ui.label(theme::small(ui, entry.basis.clone()));
    }
    ui.add_space(space::S);
}

/// What became of the error from the older to the newer.
fn difference(first: &TimelineEntry, second: &TimelineEntry) -> String {
    match (first.after, second.after) {
        (Some(Figure::Share(_)), Some(Figure::Share(_))) if first.subject != second.subject => {
            "Shares of different things: they cannot be compared.".to_owned()
        }
        (Some(a @ Figure::Share(_)), Some(b @ Figure::Share(_))) => {
            format!("{} → {}, each on its own data.", figure(a), figure(b))
        }
        (Some(a), Some(b)) if a.is_like(b) && a.value() > 0.0 => {
            let share = b.value() / a.value();
            let data =
                if first.subject == second.subject { "each on its own data" } else { "of different things" };
            format!("{} → {}: {:.0} % of the error, {data}.", figure(a), figure(b), share * 100.0)
        }
        (Some(_), Some(_)) => "The figures have different units: they cannot be compared.".to_owned(),
        _ => "One of them has no error that is known.".to_owned(),
    }
}
