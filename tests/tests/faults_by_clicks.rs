//! What talks to the arm fails inside while the twin's arm is held: the window says so within a
//! second, nothing is shown as held, and one click starts it again, not connected. By clicks over the
//! real engine and the real twin.

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui_kittest::kittest::{NodeT as _, Queryable as _};
use plumbline_engine::WatchedThread;
use plumbline_engine::view::{Connection, MotionState, RobotView};
use plumbline_engine::watched::{Strike, Trial};
use plumbline_tests::{Window, click_containing, for_a_while, until, view, window_on_trial};

fn robot(window: &Window) -> Arc<RobotView> {
    view(window).robot.clone()
}

fn says(window: &Window, words: &str) -> bool {
    window.query_all_by_label_contains(words).next().is_some()
}

fn stop_says(window: &Window) -> Option<String> {
    window.get_by_label("STOP").accesskit_node().value()
}

#[test]
fn a_dead_robot_thread_is_said_within_a_second_and_started_again() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let trial = Trial::armed();
    let mut window = window_on_trial(&folder.path().join("data"), Some("perfect"), trial.clone());
    until(&mut window, "the twin's joints", |window| robot(window).measured.is_some());
    until(&mut window, "a held arm", |window| stop_says(window).as_deref() == Some("arm held"));
    assert!(!says(&window, "Program"), "while all is well nothing is said");

    trial.strike(WatchedThread::Robot, Strike::Panic);
    until(&mut window, "the fault", |window| view(window).fault(WatchedThread::Robot).is_some());
    // The view of one frame is drawn in the same frame: what is shown is as old as the fault.
    let age = view(&window).fault(WatchedThread::Robot).expect("just seen").since.elapsed();
    assert!(age < Duration::from_secs(1), "said {age:?} after it");
    assert!(
        says(&window, "Program robot failed") && says(&window, "What talks to the arm has failed inside")
    );
    assert_ne!(stop_says(&window).as_deref(), Some("arm held"));
    assert_eq!(robot(&window).motion, MotionState::Unknown);
    assert_eq!(robot(&window).bus.cycles_per_s, None);

    // It is offered as soon as what failed has come to its end.
    until(&mut window, "its end", |window| {
        view(window).fault(WatchedThread::Robot).is_some_and(|fault| fault.can_start_again)
    });
    click_containing(&mut window, "Start again");
    let asked = Instant::now();
    until(&mut window, "it runs", |window| view(window).threads.is_empty());
    until(&mut window, "not connected", |window| robot(window).connection == Connection::None);
    for_a_while(&mut window, Duration::from_secs(1));
    assert!(asked.elapsed() >= Duration::from_secs(1));
    assert_eq!(robot(&window).connection, Connection::None, "it never connects by itself");
    assert!(robot(&window).stopped, "nothing moves until the operator releases STOP");
    assert!(!says(&window, "Program"));
}
