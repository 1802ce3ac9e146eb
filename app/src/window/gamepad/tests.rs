//! A made-up gamepad is pressed, pushed, pulled out and broken.

use crossbeam_channel::{Receiver, Sender};
use gilrs::Button;

use super::pads::stops;
use super::*;
use crate::operator::STOP_BUTTONS;

const PATIENCE: Duration = Duration::from_secs(10);

enum Deed {
    Press,
    Push(Sticks),
    PullOut,
    Break,
}

struct FakePads {
    deeds: Receiver<Deed>,
    plugged: Option<Sticks>,
}

impl Pads for FakePads {
    fn next(&mut self, at_most: Duration) -> Option<PadEvent> {
        match self.deeds.recv_timeout(at_most).ok()? {
            Deed::Press => return Some(PadEvent::Stop),
            Deed::Push(sticks) => self.plugged = Some(sticks),
            Deed::PullOut => self.plugged = None,
            Deed::Break => panic!("broken"),
        }
        Some(PadEvent::Other)
    }

    fn first(&self) -> Option<(String, Sticks)> {
        Some(("made up".to_owned(), self.plugged?))
    }
}

struct Bench {
    gamepads: Gamepads,
    deeds: Sender<Deed>,
    stopped: Receiver<Instant>,
    woken: Receiver<()>,
}

impl Bench {
    fn new() -> Self {
        let (deeds, received) = crossbeam_channel::bounded(8);
        let (stop, stopped) = crossbeam_channel::bounded(8);
        let (wake, woken) = crossbeam_channel::bounded(8);
        let gamepads = Gamepads::watch(
            move || Some(FakePads { deeds: received, plugged: Some(Sticks::default()) }),
            Arc::new(move || {
                let _ = stop.try_send(Instant::now());
            }),
            move || {
                let _ = wake.try_send(());
            },
        );
        Self { gamepads, deeds, stopped, woken }
    }

    fn does(&self, deed: Deed) {
        self.deeds.send(deed).expect("it listens");
    }

    fn until(&self, what: &str, holds: impl Fn(&Gamepads) -> bool) {
        let begun = Instant::now();
        while !holds(&self.gamepads) {
            assert!(begun.elapsed() < PATIENCE, "never: {what}");
            let _ = self.woken.recv_timeout(Duration::from_millis(10));
        }
    }
}

fn held() -> Sticks {
    Sticks { enabled: true, left: [0.0, 1.0], right: [0.0, 0.0] }
}

#[test]
fn its_stop_reaches_the_arm_without_a_frame_of_the_window() {
    let mut bench = Bench::new();
    assert!(!bench.gamepads.take_stop());
    bench.does(Deed::Press);
    bench.stopped.recv_timeout(PATIENCE).expect("stopped");
    bench.woken.recv_timeout(PATIENCE).expect("the window is woken");
    bench.until("counted", |gamepads| gamepads.shared.stops.load(Ordering::Acquire) == 1);
    assert!(bench.gamepads.take_stop(), "the window stops the rest");
    assert!(!bench.gamepads.take_stop(), "once");
    // A second press stops again, with the sticks held or not.
    bench.does(Deed::Push(held()));
    bench.does(Deed::Press);
    bench.stopped.recv_timeout(PATIENCE).expect("stopped again");
}

#[test]
fn only_the_buttons_that_are_named_stop() {
    assert!(stops(Button::East) && stops(Button::Start));
    for button in [Button::South, Button::North, Button::West, Button::LeftTrigger, Button::Select] {
        assert!(!stops(button), "{button:?}");
    }
    assert!(STOP_BUTTONS.contains("circle") && STOP_BUTTONS.contains("Start"));
}

#[test]
fn pulled_out_it_pushes_no_more_and_the_window_is_woken() {
    let bench = Bench::new();
    bench.does(Deed::Push(held()));
    bench.until("pushed", |gamepads| gamepads.newest(true).is_some_and(|pad| pad.enabled));
    let pushed = bench.gamepads.newest(true).expect("just seen");
    assert_eq!((pushed.push, pushed.name.as_str()), ([1.0, -0.0, 0.0, -0.0], "made up"));
    assert!(!bench.gamepads.newest(false).expect("there").enabled, "a window behind others moves nothing");
    while bench.woken.try_recv().is_ok() {}
    bench.does(Deed::PullOut);
    bench.woken.recv_timeout(PATIENCE).expect("the window is woken");
    bench.until("gone", |gamepads| gamepads.newest(true).is_none());
}

#[test]
fn a_thread_that_fails_pushes_no_more_and_is_told_once() {
    let mut bench = Bench::new();
    bench.does(Deed::Push(held()));
    bench.until("pushed", |gamepads| gamepads.newest(true).is_some_and(|pad| pad.enabled));
    assert_eq!(bench.gamepads.take_trouble(), None);
    bench.does(Deed::Break);
    bench.until("gone", |gamepads| gamepads.newest(true).is_none());
    bench.until("told", |gamepads| gamepads.shared.failed.load(Ordering::Acquire));
    let told = bench.gamepads.take_trouble().expect("told");
    assert!(told.contains("neither jogs nor stops"), "{told}");
    assert_eq!(bench.gamepads.take_trouble(), None);
}

#[test]
fn what_is_old_counts_no_more() {
    let gamepads = Gamepads::default();
    let state = GamepadState { enabled: true, ..GamepadState::default() };
    let old = Instant::now().checked_sub(FRESH + Duration::from_millis(1)).expect("the machine runs longer");
    *gamepads.shared.newest() = Some((old, state.clone()));
    assert_eq!(gamepads.newest(true), None);
    *gamepads.shared.newest() = Some((Instant::now(), state.clone()));
    assert_eq!(gamepads.newest(true), Some(state));
}

#[test]
fn a_stick_near_its_middle_is_at_rest_and_nothing_exceeds_one() {
    assert_eq!(dead_zone(0.1), 0.0);
    assert_eq!(dead_zone(f32::NAN), 0.0);
    assert_eq!(dead_zone(-1.0), -1.0);
    assert_eq!(dead_zone(1.2), 1.0);
    assert!((dead_zone(0.575) - 0.5).abs() < 1e-6);
}
