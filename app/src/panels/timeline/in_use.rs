//! What is in use now, and since when.

use egui::{ScrollArea, Ui};
use plumbline_engine::{TimelineFormat, View};
use plumbline_widgets::empty::EmptyState;
use plumbline_widgets::theme::{self, group_heading, space};

use crate::operator::TimelineAction;
use crate::operator::words::clock;
use crate::operator::words::timeline::figure;
use crate::panels::parts::{action_button, warning};
use crate::panels::{PanelContext, padded};

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let timeline = cx.view.timeline.clone();
    if !timeline.is_known {
        EmptyState::loading("What is in use is being read.").show(ui);
        return;
    }
    padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for now in timeline.in_use.iter() {
                ui.label(theme::strong(ui, now.subject.name()));
                ui.label(&now.title);
                let since = now.since.map(|at| format!("since {}", clock(at)));
                let details: Vec<String> = now.figure.map(figure).into_iter().chain(since).collect();
                if !details.is_empty() {
                    ui.label(theme::small(ui, details.join(" · ")));
                }
                if !now.against.is_empty() {
                    warning(ui, &now.against);
                }
                ui.add_space(space::S);
            }
            group_heading(ui, "Report of the whole setup");
            ui.horizontal_wrapped(|ui| {
                action_button(ui, cx, TimelineAction::Report(TimelineFormat::Html), "HTML…");
                action_button(ui, cx, TimelineAction::Report(TimelineFormat::Pdf), "PDF…");
                action_button(ui, cx, TimelineAction::Report(TimelineFormat::Csv), "CSV…");
            });
        });
    });
}

pub fn show_inspector(ui: &mut Ui, _: &View) {
    group_heading(ui, "What this is for");
    let text = "Everything that was ever put in use stands on one line, whoever did it and in whichever step. Click \
        two entries to compare them. What was put in use last of a kind can be taken back here; nothing is deleted by \
        that. Eyes, mount and screen can then be used again here; models and effects where they were made, in Models \
        and in Gap.";
    ui.label(theme::weak(ui, text));
    group_heading(ui, "Errors");
    let text = "Before and after of one entry are of the same data where the sentence at the entry says so: point at \
        it. Errors of different entries were measured on different data.";
    ui.label(theme::weak(ui, text));
}
