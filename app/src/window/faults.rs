//! What has failed inside of the program: a lamp that says so, and the button that starts it again.

use egui::Ui;
use plumbline_engine::view::ThreadFault;
use plumbline_engine::{View, WatchedThread};
use plumbline_widgets::lamp::Health;
use plumbline_widgets::{format, theme};

use super::PlumblineWindow;
use super::lamps::{Then, TopLamp};
use crate::operator::{Action, Outbox};

/// Whether a fault may leave people thinking that the arm is looked after.
fn is_dangerous(fault: &ThreadFault) -> bool {
    matches!(fault.thread, WatchedThread::Engine | WatchedThread::Robot)
}

/// Nothing stands here while all is well.
pub(super) fn lamps(view: &View) -> Vec<TopLamp> {
    threads_lamp(view).into_iter().chain(data_lamps(view)).collect()
}

fn threads_lamp(view: &View) -> Option<TopLamp> {
    let first = view.threads.first()?;
    let word = if first.is_silent() { "silent" } else { "failed" };
    let value = match view.threads.len() {
        1 => format!("{} {word}", first.thread.name()),
        count => format!("{} {word}, {} more", first.thread.name(), count - 1),
    };
    let health = if view.threads.iter().any(is_dangerous) { Health::Danger } else { Health::Failed };
    let reason = Some(first.meaning.to_string());
    Some(TopLamp { name: "Program", value, health, reason, then: Then::Open(380.0, details) })
}

fn details(window: &PlumblineWindow, ui: &mut Ui, outbox: &mut Outbox) {
    let view = &window.view;
    for fault in view.threads.iter() {
        ui.label(&*fault.meaning);
        let since = format::age(fault.since.elapsed());
        let said = fault.said.as_ref().map_or_else(String::new, |said| format!(" It said: {said}."));
        ui.label(theme::small(ui, format!("Since {since}.{said}")));
        let action = Action::StartAgain(fault.thread);
        let refusal = action.refusal(view);
        let button = ui.add_enabled(refusal.is_none(), egui::Button::new(action.label()));
        if button.on_disabled_hover_text(refusal.unwrap_or_default()).clicked() {
            outbox.act(action);
            ui.close();
        }
        ui.separator();
    }
}

/// Whether what is measured and done is kept.
fn data_lamps(view: &View) -> Vec<TopLamp> {
    let kept = &view.kept;
    let lamp = |name, value: String, health, reason: String| TopLamp {
        name,
        value,
        health,
        reason: Some(reason),
        then: Then::Nothing,
    };
    let mut lamps = vec![];
    if let Some(problem) = &kept.problem {
        lamps.push(lamp("Data", "at risk".to_owned(), Health::Warning, problem.to_string()));
    }
    let lost = kept.journal_lost;
    if lost > 0 {
        let reason = format!(
            "The journal lacks {} that you asked for, because the disk did not keep up or did not take them: a report of a mistake will lack them too. They were done all the same. Look at the disk.",
            format::count(usize::try_from(lost).unwrap_or(usize::MAX), "thing")
        );
        lamps.push(lamp("Journal", format!("{lost} lost"), Health::Warning, reason));
    }
    if view.lost_commands > 0 {
        let value = format!("{} lost", view.lost_commands);
        let reason = "So many things were asked for at once that some were not taken, and are not done. The log names them; ask for them again.";
        lamps.push(lamp("Requests", value, Health::Failed, reason.to_owned()));
    }
    lamps
}
