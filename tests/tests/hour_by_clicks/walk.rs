//! Somebody who presses what the window offers, and counts.

use std::path::Path;
use std::time::{Duration, Instant};

use egui_kittest::Node;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use plumbline_tests::{Window, for_a_while, press, thread_processor_time, view, window_of_size};

use crate::album::{Album, is_light, size_pt};
use crate::legs::Leg;
use crate::table::{LegTaken, Taken};
use crate::watch::{Watch, is_computing, is_under_way};

/// A twin with errors like those of a robot.
const SCENARIO: &str = "lab";

/// For how long a leg is waited for: so long takes nothing that will still come.
const PATIENCE: Duration = Duration::from_secs(1800);

/// So long a button has to mean the same before it is pressed: it is read first.
const READ_FOR: Duration = Duration::from_secs(1);

/// Who sees no answer to a click presses once more.
const ANSWERED_WITHIN: Duration = Duration::from_secs(5);

/// Steps at the left.
const SCREENS: &[&str] = &[
    "Commission",
    "Live",
    "Eyes",
    "Mount",
    "Touch",
    "Models",
    "Gap",
    "Hand-eye",
    "Grasp",
    "Drift",
    "Timeline",
    "Robot",
    "Detect",
];

/// The foot in which the big button stands, with a sentence of two lines.
const FOOT_PT: f32 = 80.0;

/// The big button's own height; what else stands there is smaller.
const BIG_PT: f32 = 35.0;

/// A window and what was seen in it so far.
pub struct Walk {
    window: Window,
    watch: Watch,
    legs: Vec<LegTaken>,
    lost: Vec<String>,
    began: Instant,
    album: Album,
    /// The button that is being read, and since when.
    read: Option<(String, Instant)>,
}

impl Walk {
    /// The first start on the twin, with nothing done before.
    pub fn begin(data_dir: &Path) -> Self {
        let began = Instant::now();
        let mut window = window_of_size(data_dir, Some(SCENARIO), size_pt().into());
        if is_light() && window.ctx.theme() == egui::Theme::Dark {
            window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::T);
            window.run_steps(2);
        }
        Self {
            began,
            window,
            watch: Watch::default(),
            legs: vec![],
            lost: vec![],
            read: None,
            album: Album::new(),
        }
    }

    /// Goes on until the leg is behind.
    ///
    /// # Panics
    /// When it is not within half an hour.
    pub fn take(&mut self, leg: &Leg) {
        let began = if self.legs.is_empty() { self.began } else { Instant::now() };
        let (pauses, slow) = (self.watch.pauses.len(), self.watch.slow.len());
        let mut clicks: Vec<String> = vec![];
        if leg.is_chosen {
            self.click(leg.rail, leg, &mut clicks);
        }
        while !(leg.is_behind)(&view(&self.window)) {
            let waited = began.elapsed();
            assert!(waited < PATIENCE, "{} is not behind: {clicks:#?}, {:#?}", leg.name, self.watch);
            self.step(leg.name);
            let now = view(&self.window);
            if is_under_way(&now) || (leg.is_behind)(&now) {
                self.read = None;
                self.album.picture_now_and_then(&mut self.window, leg.name);
                continue;
            }
            let Some(label) = self.taken(leg).or_else(|| self.primary()).filter(|label| self.is_read(label))
            else {
                continue;
            };
            let goes_round = clicks.iter().filter(|clicked| **clicked == label).count() > 1;
            if goes_round {
                self.lost.push(format!("{}: \"{label}\" again and again", leg.name));
                assert!(self.lost.len() < 10, "{:#?}", self.lost);
                self.click(leg.rail, leg, &mut clicks);
            } else {
                self.album.picture(&mut self.window, &format!("{}-before-{label}", leg.name));
                self.click(&label, leg, &mut clicks);
                self.album.picture(&mut self.window, &format!("{}-after-{label}", leg.name));
            }
        }
        self.album.picture(&mut self.window, &format!("{}-behind", leg.name));
        let taken = LegTaken {
            name: leg.name,
            clicks,
            time: began.elapsed(),
            pauses: self.watch.pauses.len() - pauses,
            slow: self.watch.slow.len() - slow,
        };
        println!("{taken}");
        self.legs.push(taken);
    }

    /// What all of it took. Where pictures are wanted, there is one of every other screen too.
    pub fn end(mut self) -> Taken {
        let screens = if self.album.is_wanted() { SCREENS } else { &[] };
        for step in screens {
            press(&mut self.window, step, button);
            for_a_while(&mut self.window, Duration::from_secs(2));
            self.album.picture(&mut self.window, step);
        }
        let Watch { pauses, slow, frames, longest, warnings, .. } = self.watch;
        Taken { legs: self.legs, pauses, slow, frames, longest, lost: self.lost, warnings }
    }

    fn click(&mut self, label: &str, leg: &Leg, clicks: &mut Vec<String>) {
        println!("{:7.1} s  {label}", self.began.elapsed().as_secs_f64());
        press(&mut self.window, label, button);
        clicks.push(label.to_owned());
        // The engine takes in what was pressed while the next frames are drawn: who presses waits for that.
        let pressed = Instant::now();
        let is_offered = |walk: &Self| {
            [walk.taken(leg), walk.primary()].iter().any(|offered| offered.as_deref() == Some(label))
        };
        while pressed.elapsed() < ANSWERED_WITHIN && is_offered(self) {
            self.step(label);
        }
        self.read = None;
    }

    /// One frame, and what is to be seen in it.
    fn step(&mut self, doing: &str) {
        let computed = is_computing(&view(&self.window));
        let before = thread_processor_time();
        self.window.step();
        let took = thread_processor_time().zip(before).and_then(|(now, before)| now.checked_sub(before));
        let now = view(&self.window);
        if let Some(took) = took {
            self.watch.frame(took, computed || is_computing(&now), doing);
        }
        self.watch.look(&now);
        std::thread::sleep(Duration::from_millis(10));
    }

    /// Whether a button was there long enough to be read.
    fn is_read(&mut self, label: &str) -> bool {
        let before = self.read.take().filter(|(read, _)| read == label);
        let (_, since) = self.read.insert(before.unwrap_or_else(|| (label.to_owned(), Instant::now())));
        since.elapsed() >= READ_FOR
    }

    /// The button that this leg takes wherever it is, where it can be pressed.
    fn taken(&self, leg: &Leg) -> Option<String> {
        let words = leg.takes?;
        let by_the_foot = self.primary().filter(|label| label.contains(words));
        by_the_foot.or_else(|| {
            let mut found = self.window.query_all_by_label_contains(words);
            found.find(can_be_pressed)?.accesskit_node().label()
        })
    }

    /// What stands on the big button of the bottom line, where it can be pressed.
    fn primary(&self) -> Option<String> {
        big(&self.window)?.accesskit_node().label()
    }
}

/// What is pressed for a label: the big button where it says so, as what stands further up may be scrolled away.
fn button<'w>(window: &'w Window, label: &'w str) -> Option<Node<'w>> {
    let big = big(window).filter(|node| node.accesskit_node().label().as_deref() == Some(label));
    big.or_else(|| window.query_all_by_label(label).next())
}

/// The big button of the bottom line, where it can be pressed.
fn big(window: &Window) -> Option<Node<'_>> {
    let [_, height] = size_pt();
    let is_big = |node: &Node<'_>| {
        let rect = node.rect();
        rect.height() >= BIG_PT && rect.top() >= height - FOOT_PT && rect.bottom() <= height
    };
    let mut buttons = window.query_all_by_role(egui::accesskit::Role::Button);
    buttons.find(|node| is_big(node) && can_be_pressed(node))
}

fn can_be_pressed(node: &Node<'_>) -> bool {
    let node = node.accesskit_node();
    node.role() == egui::accesskit::Role::Button && !node.is_disabled()
}
