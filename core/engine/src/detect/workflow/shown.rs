//! What came of the newest pair, and what the window shows of it.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_model::Stamp;
use plumbline_model::detection::ClassIndex;
use plumbline_vision::detect_places::Rates;

use super::{Accepted, DetectAround, DetectWorkflow};
use crate::detect::command::DetectorChoice;
use crate::detect::stage::{DetectInput, DetectOutput, Turn};
use crate::detect::view::{ClassRates, DetectView, DetectorState};
use crate::ground::stage::Timed;

/// Rates are over this many pairs.
const COUNTED_PAIRS: usize = 300;
/// Boxes that are this much older than the picture are not where things are any more.
const BEHIND: Duration = Duration::from_millis(1500);
/// While the arm moves one look is taken in so long: on two cores a network takes both of them.
const GIVES_WAY: Duration = Duration::from_secs(1);

impl DetectWorkflow {
    /// What the stage is to do with the newest pair, if anything.
    pub fn input(&self, around: DetectAround) -> Option<DetectInput> {
        let in_use = self.detector.as_ref().filter(|_| self.wanted)?;
        let frame = around.newest?;
        let gives_way = around.arm_moves && !around.photographs;
        Some(DetectInput {
            turn: turn(&frame.stamp, self.first.filter(|_| gives_way)),
            frame,
            opened: around.opened,
            detector: in_use.detector.clone(),
            settings: self.settings.clone(),
            photographs: around.photographs,
            setup: around.setup,
        })
    }

    /// The stage has something. What another detector found, or on the images of another source, is
    /// not shown.
    pub fn detected(&mut self, output: Timed<DetectOutput>, opened: u64, now: Instant) {
        let result = output.result;
        let of_this = self.detector.as_ref().is_some_and(|in_use| in_use.detector.id == result.detector);
        if !of_this || result.opened != opened || !self.wanted {
            return;
        }
        self.first.get_or_insert(output.stamp.captured_at);
        if result.is_new {
            self.clock.note(now, output.stamp.captured_at, output.busy);
        }
        match result.found {
            Ok((found, places)) => {
                if result.is_new {
                    let classes = found.names.len();
                    self.rates.get_or_insert_with(|| Rates::new(classes, COUNTED_PAIRS)).add(&places);
                }
                self.failed = None;
                self.found = Some(Accepted { view: Arc::new(found), generation: result.generation });
            }
            Err(failure) if failure.broken => {
                let name = self.settings.detector.name();
                self.let_go();
                self.failed_to_open = Some((name, failure.why));
            }
            Err(failure) => {
                self.found = None;
                self.failed = Some(failure.why);
            }
        }
    }

    /// What the window shows.
    pub fn view(&mut self, skipped: u64, around: &DetectAround, now: Instant) -> DetectView {
        self.clock.set_skipped(skipped);
        DetectView {
            wanted: self.wanted,
            detector: self.detector_state(),
            opening: self.opening.as_ref().map(|opening| opening.choice.name()),
            refused: self.refused.clone(),
            settings: self.settings.clone(),
            found: self.found.as_ref().map(|found| found.view.clone()),
            stale: self.found.as_ref().and_then(|found| stale(found, around)),
            failed: self.down.clone().or_else(|| self.failed.clone()),
            rates: self.class_rates(),
            counted: self.rates.as_ref().map_or(0, Rates::frames),
            statistics: self.clock.figures(now),
        }
    }

    fn class_rates(&self) -> Arc<[ClassRates]> {
        let (Some(rates), Some(in_use)) = (&self.rates, &self.detector) else { return Arc::default() };
        let of = |(class, name): (ClassIndex, &str)| {
            let counted = rates.class(class)?;
            Some(ClassRates {
                name: name.to_owned(),
                left: counted.left,
                right: counted.right,
                agree: counted.agree,
                lost: counted.lost,
            })
        };
        in_use.detector.facts.names.iter().filter_map(of).collect()
    }

    fn detector_state(&self) -> DetectorState {
        match (&self.detector, &self.opening, &self.failed_to_open) {
            (Some(in_use), ..) => DetectorState::Ready(in_use.detector.facts.clone()),
            (None, Some(opening), _) => DetectorState::Loading { name: opening.choice.name() },
            (None, None, Some((name, why))) => DetectorState::Failed { name: name.clone(), why: why.clone() },
            (None, None, None) if self.settings.detector == DetectorChoice::Off => DetectorState::Off,
            (None, None, None) => DetectorState::None,
        }
    }
}

/// Which look a pair belongs to; `first`: it gives way, and looks are counted from then.
fn turn(stamp: &Stamp, first: Option<Instant>) -> Turn {
    match first {
        None => Turn::Pair(stamp.seq),
        Some(first) => {
            let since = stamp.captured_at.saturating_duration_since(first);
            Turn::GivesWay(since.as_secs() / GIVES_WAY.as_secs())
        }
    }
}

/// Why a result must not be taken for the present.
fn stale(found: &Accepted, around: &DetectAround) -> Option<String> {
    let newest = around.newest.as_ref()?;
    let (of, now) = (found.view.stamp, newest.stamp);
    if of.seq != now.seq && around.photographs {
        return Some("Boxes of the pair before; this one is being looked at.".to_owned());
    }
    let behind = now.captured_at.saturating_duration_since(of.captured_at);
    if behind > BEHIND {
        let why = match around.arm_moves {
            true => "while the arm moves or touches the detector looks once a second at most",
            false => "the detector does not keep up",
        };
        return Some(format!("Boxes of {:.1} s before this picture: {why}.", behind.as_secs_f64()));
    }
    let generation = around.setup.as_ref().ok().map(|setup| setup.generation);
    (found.generation != generation)
        .then(|| "Places rest on the calibration or aim before; they are being computed anew.".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many looks are begun in a second and a half of pairs at 30 Hz.
    fn looks(first: Option<Instant>, begun: Instant) -> usize {
        let mut turns: Vec<Turn> = (0..45)
            .map(|seq| {
                let captured_at = begun + Duration::from_millis(seq * 33);
                turn(&Stamp { seq, captured_at }, first)
            })
            .collect();
        turns.dedup();
        turns.len()
    }

    #[test]
    fn a_detector_gives_way_to_an_arm_that_moves() {
        let begun = Instant::now();
        assert_eq!(looks(None, begun), 45, "every pair, as fast as it goes");
        assert_eq!(looks(Some(begun), begun), 2, "one look a second");
        let stamp = Stamp { seq: 1, captured_at: begun };
        assert_ne!(turn(&stamp, None), turn(&stamp, Some(begun)), "when it stands it looks at once");
    }
}
