//! What has failed inside of the program: a lamp that says so, and the button that starts it again.

use egui::{Popup, Ui};
use plumbline_engine::view::ThreadFault;
use plumbline_engine::{View, WatchedThread};
use plumbline_widgets::format;
use plumbline_widgets::lamp::{Health, Lamp};
use plumbline_widgets::theme;

use super::actions::Action;
use super::outbox::Outbox;
use super::steps::Screen;

impl Action {
    /// What starts a thread again, by its name for people.
    pub(super) fn start_again_label(thread: WatchedThread) -> String {
        format!("Start again: {}", thread.title())
    }

    /// Why a thread cannot be started again now.
    pub(super) fn start_again_refusal(thread: WatchedThread, view: &View) -> Option<&'static str> {
        match view.fault(thread) {
            None => Some("it runs"),
            Some(fault) if fault.can_start_again => None,
            Some(fault) if fault.is_silent() => Some("it gives no sign of life, but has not ended"),
            Some(_) => Some("it has not come to its end yet: wait a moment"),
        }
    }
}

/// The fault that matters most on a screen; what can hurt matters on every screen.
pub(super) fn most_urgent(view: &View, screen: Screen) -> Option<&ThreadFault> {
    let looks = matches!(screen, Screen::Live | Screen::Collect | Screen::Mount);
    let matters = |fault: &&ThreadFault| match fault.thread {
        WatchedThread::Engine | WatchedThread::Robot => true,
        WatchedThread::Source => looks,
        WatchedThread::Rectify | WatchedThread::Probe | WatchedThread::Detect => screen == Screen::Live,
        WatchedThread::Corners => matches!(screen, Screen::Collect | Screen::Mount),
        WatchedThread::Journal => false,
    };
    // They come in this order: the heart, the robot, the rest.
    view.threads.iter().find(matters)
}

/// Whether a fault may leave people thinking that the arm is looked after.
fn is_dangerous(fault: &ThreadFault) -> bool {
    matches!(fault.thread, WatchedThread::Engine | WatchedThread::Robot)
}

/// Nothing stands here while all is well.
pub(super) fn lamps(view: &View, ui: &mut Ui, outbox: &mut Outbox) {
    threads_lamp(view, ui, outbox);
    data_lamp(view, ui);
}

fn threads_lamp(view: &View, ui: &mut Ui, outbox: &mut Outbox) {
    let Some(first) = view.threads.first() else { return };
    let word = if first.is_silent() { "silent" } else { "failed" };
    let value = match view.threads.len() {
        1 => format!("{} {word}", first.thread.name()),
        count => format!("{} {word}, {} more", first.thread.name(), count - 1),
    };
    let health = if view.threads.iter().any(is_dangerous) { Health::Danger } else { Health::Failed };
    let lamp = Lamp::new("Program", &value, health).reason(Some(&first.meaning)).show(ui);
    Popup::menu(&lamp).width(380.0).show(|ui| details(ui, view, outbox));
}

fn details(ui: &mut Ui, view: &View, outbox: &mut Outbox) {
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
fn data_lamp(view: &View, ui: &mut Ui) {
    let kept = &view.kept;
    if let Some(problem) = &kept.problem {
        Lamp::new("Data", "at risk", Health::Warning).reason(Some(problem)).show(ui);
    }
    let lost = kept.journal_lost;
    if lost > 0 {
        let reason = format!(
            "The journal lacks {} that you asked for, because the disk did not keep up or did not take them: a report of a mistake will lack them too. They were done all the same. Look at the disk.",
            format::count(usize::try_from(lost).unwrap_or(usize::MAX), "thing")
        );
        let value = format!("{lost} lost");
        Lamp::new("Journal", &value, Health::Warning).reason(Some(&reason)).show(ui);
    }
}
