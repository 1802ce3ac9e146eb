//! Threads that fail in every way.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crossbeam_channel::Receiver;

use super::{Pulse, Strike, Trial, Trouble, WatchedThread, spawn};
use crate::ground::bell::Bell;

const PATIENCE: Duration = Duration::from_secs(10);

fn pulse(trial: &Trial) -> (Pulse, Receiver<()>) {
    let (bell, rung) = Bell::new();
    (Pulse::new(WatchedThread::Robot, bell, trial.clone()), rung)
}

fn trouble(pulse: &Pulse) -> Option<Trouble> {
    pulse.trouble(Instant::now())
}

#[test]
fn a_panic_is_told_with_its_words_before_what_the_thread_owned_is_let_go() {
    /// Takes its time to be dropped, as a bus with silent servos does.
    struct Slow(Receiver<()>, Arc<AtomicBool>);
    impl Drop for Slow {
        fn drop(&mut self) {
            let _ = self.0.recv_timeout(PATIENCE);
            self.1.store(true, Ordering::SeqCst);
        }
    }
    let (pulse, rung) = pulse(&Trial::default());
    let (go, wait) = crossbeam_channel::bounded(1);
    let dropped = Arc::new(AtomicBool::new(false));
    let owned = Slow(wait, dropped.clone());
    let watched = spawn(pulse, owned, |_, _| panic!("a speed of {}", 1e-30)).expect("a thread");
    rung.recv_timeout(PATIENCE).expect("it is rung");
    match trouble(watched.pulse()) {
        Some(Trouble::Ended { said, since }) => {
            assert_eq!(said, "a speed of 0.000000000000000000000000000001");
            assert!(since.elapsed() < PATIENCE);
        }
        other => panic!("{other:?}"),
    }
    assert!(!dropped.load(Ordering::SeqCst), "told before it is let go");
    assert!(!watched.has_ended(), "another may not take its place yet");
    go.send(()).expect("it waits");
    let begun = Instant::now();
    while !watched.has_ended() && begun.elapsed() < PATIENCE {
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(watched.has_ended() && dropped.load(Ordering::SeqCst));
}

#[test]
fn a_panic_while_the_rest_is_let_go_ends_nothing_else() {
    struct Fragile;
    impl Drop for Fragile {
        fn drop(&mut self) {
            panic!("cannot be let go");
        }
    }
    let (pulse, rung) = pulse(&Trial::default());
    let watched = spawn(pulse, Fragile, |_, _| panic!("first")).expect("a thread");
    rung.recv_timeout(PATIENCE).expect("it is rung");
    let said = |watched: &super::Watched| match trouble(watched.pulse()) {
        Some(Trouble::Ended { said, .. }) => said,
        other => panic!("{other:?}"),
    };
    assert_eq!(said(&watched), "first");
    let begun = Instant::now();
    while !watched.has_ended() && begun.elapsed() < PATIENCE {
        std::thread::sleep(Duration::from_millis(1));
    }
    assert_eq!(said(&watched), "first", "what was said first counts");
}

#[test]
fn an_end_that_nobody_asked_for_is_told_and_one_that_was_is_not() {
    let (unasked, rung) = pulse(&Trial::default());
    let watched = spawn(unasked, (), |(), _| {}).expect("a thread");
    rung.recv_timeout(PATIENCE).expect("it is rung");
    assert!(matches!(
        trouble(watched.pulse()),
        Some(Trouble::Ended { said, .. }) if said.contains("although nobody asked")
    ));

    let (asked, _rung) = pulse(&Trial::default());
    let (end, wait) = crossbeam_channel::bounded::<()>(0);
    let watched = spawn(asked.clone(), (), move |(), _| {
        let _ = wait.recv();
    })
    .expect("a thread");
    watched.ask_to_end();
    drop(end);
    drop(watched);
    assert_eq!(trouble(&asked), None);
}

#[test]
fn a_promise_that_is_not_kept_is_silence_and_a_sign_of_life_ends_it() {
    let (pulse, _rung) = pulse(&Trial::default());
    let now = Instant::now();
    let in_ms = |ms| pulse.trouble(now + Duration::from_millis(ms));
    assert_eq!(in_ms(1_000_000), None, "nothing was promised yet");
    pulse.promise(Duration::from_millis(500));
    assert_eq!(in_ms(400), None);
    match in_ms(700) {
        Some(Trouble::Silent { since }) => assert!(since <= now + Duration::from_millis(100)),
        other => panic!("{other:?}"),
    }
    pulse.promise(Duration::from_secs(3));
    assert_eq!(in_ms(700), None);
    pulse.rest();
    assert_eq!(in_ms(1_000_000_000), None, "who waits for work is not silent");
    pulse.promise(Duration::MAX);
    assert_eq!(in_ms(1_000_000_000), None);
}

#[test]
fn a_trial_strikes_once_and_only_whom_it_names() {
    let trial = Trial::armed();
    let (robot, rung) = pulse(&trial);
    trial.strike(WatchedThread::Source, Strike::Panic);
    robot.promise(Duration::from_secs(1));
    assert_eq!(trouble(&robot), None);
    trial.strike(WatchedThread::Robot, Strike::Panic);
    let watched = spawn(robot, (), |(), pulse| pulse.promise(Duration::from_secs(1))).expect("a thread");
    rung.recv_timeout(PATIENCE).expect("it is rung");
    assert!(matches!(
        trouble(watched.pulse()),
        Some(Trouble::Ended { said, .. }) if said == "struck by a test"
    ));
    // The usual one strikes nobody.
    Trial::default().strike(WatchedThread::Robot, Strike::Panic);
    Trial::default().strike_now(WatchedThread::Robot);
}

#[test]
fn every_thread_says_what_its_end_means_and_what_to_do() {
    for thread in WatchedThread::ALL {
        let (end, silence) = (thread.meaning_of_end(), thread.meaning_of_silence());
        for text in [end, silence] {
            assert!(text.ends_with('.') && text.starts_with(char::is_uppercase), "{text}");
        }
        assert!(end.contains("tart it again"), "{end}");
        assert!(!thread.title().ends_with('.') && thread.title().starts_with(char::is_lowercase));
    }
    for text in [WatchedThread::Robot.meaning_of_end(), WatchedThread::Robot.meaning_of_silence()] {
        assert!(text.contains("power switch in reach"), "{text}");
    }
}
