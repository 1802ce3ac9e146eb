//! What has failed inside of the program, and what starts it again.

use plumbline_engine::view::ThreadFault;
use plumbline_engine::{View, WatchedThread};

use super::{Action, Screen};

impl Action {
    /// What starts a thread again, by its name for people.
    pub fn start_again_label(thread: WatchedThread) -> String {
        format!("Start again: {}", thread.title())
    }

    /// Why a thread cannot be started again now.
    pub fn start_again_refusal(thread: WatchedThread, view: &View) -> Option<&'static str> {
        match view.fault(thread) {
            None => Some("it runs"),
            Some(fault) if fault.can_start_again => None,
            Some(fault) if fault.is_silent() => Some("it gives no sign of life, but has not ended"),
            Some(_) => Some("it has not come to its end yet: wait a moment"),
        }
    }
}

/// The fault that matters most on a screen; what can hurt matters on every screen.
pub fn most_urgent(view: &View, screen: Screen) -> Option<&ThreadFault> {
    let looks = matches!(screen, Screen::Live | Screen::Collect | Screen::Mount);
    let matters = |fault: &&ThreadFault| match fault.thread {
        WatchedThread::Engine | WatchedThread::Robot => true,
        WatchedThread::Source => looks,
        WatchedThread::Rectify | WatchedThread::Probe | WatchedThread::Detect => screen == Screen::Live,
        WatchedThread::Drift => screen == Screen::Drift,
        WatchedThread::Corners => matches!(screen, Screen::Collect | Screen::Mount),
        WatchedThread::Journal => false,
    };
    // They come in this order: the heart, the robot, the rest.
    view.threads.iter().find(matters)
}
