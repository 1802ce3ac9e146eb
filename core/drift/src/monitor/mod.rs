//! What was seen over time: how far it usually scatters, and what is the matter.

mod band;
mod mover;
#[cfg(test)]
mod tests;

use nalgebra::Vector3;
use plumbline_effects::{RobotModel, SeenUnder};
use plumbline_model::robot::Posture;

pub use band::Band;
pub use mover::{Mover, OwnMotion};

use crate::cost::{Row, errors};
use crate::warm_up::{ToGo, fit_warm_up};
use crate::watch::Look;

/// So many looks in a row have to be out of the band.
const CONFIRMED_BY: usize = 2;
/// What changes between looks that are no farther apart than this came suddenly, s.
const SUDDEN_S: f64 = 30.0;
/// Eyes that have been on for longer than this are warm, whatever turns them, s.
const WARM_S: f64 = 2400.0;
/// Without a law of its own an eye is warm after this, s: 95 % of the way.
const USUALLY_WARM_S: f64 = 1200.0;
/// Eyes are as good as warm when places are this close to where they end, m.
const AS_GOOD_AS_WARM_M: f64 = 0.002;
/// More looks than these are thinned out: every second of the older ones stays.
const MOST_SAMPLES: usize = 4000;
/// The approach is fitted to at most so many looks, spread over all.
const FITTED: usize = 200;

/// A look and when it was.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Time since the cameras were switched on, or since watching began where nobody knows the former, s.
    pub at_s: f64,
    /// What was seen.
    pub look: Look,
}

/// Something that moved which should not have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alarm {
    /// What it is.
    pub what: Mover,
    /// The first look that shows it, s.
    pub since_s: f64,
    /// Whether it came from one look to the next.
    pub sudden: bool,
    /// How far off it puts places near, in the middle and far, m.
    pub cost_m: [f64; 3],
}

/// What is the matter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// Nothing was seen yet.
    NotSeen,
    /// How far looks scatter is being learned.
    Learning {
        /// Looks so far.
        looks: usize,
        /// Looks that are needed.
        needed: usize,
    },
    /// Places stay where they are.
    Steady {
        /// How far off they are near, in the middle and far, m.
        cost_m: [f64; 3],
    },
    /// The eyes turn slowly, as lenses do that warm up.
    Warming {
        /// Until places are as good as where they end; `None`: that cannot be told yet.
        to_go: Option<ToGo>,
        /// How far off places are by now near, in the middle and far, m.
        cost_m: [f64; 3],
        /// Which eyes.
        what: Mover,
        /// The first look out of the band, s.
        since_s: f64,
    },
    /// Something moved that should not have.
    Moved(Alarm),
}

/// Keeps what was seen.
#[derive(Clone, Debug, Default)]
pub struct Monitor {
    samples: Vec<Sample>,
    band: Option<Band>,
    /// The last sudden change, and what there was before it.
    knock: Option<(f64, [Vector3<f64>; 3])>,
    alarms: Vec<Alarm>,
    own: Vec<OwnMotion>,
}

impl Monitor {
    /// Adds a look. Times must not go back: whoever sees that begins anew.
    pub fn add(&mut self, sample: Sample) {
        let at_s = sample.at_s;
        self.samples.push(sample);
        if self.samples.len() > MOST_SAMPLES {
            let keep_from = self.samples.len() / 2;
            let mut index = 0;
            self.samples.retain(|_| {
                index += 1;
                index > keep_from || index % 2 == 1
            });
        }
        if self.band.is_none() {
            self.band = Band::learned(&self.samples);
        }
        self.note_knock();
        mover::note_own_motions(&mut self.own, &self.samples);
        if let Verdict::Moved(alarm) = self.verdict() {
            let known = self.alarms.last().is_some_and(|last| last.since_s == alarm.since_s);
            if !known && at_s >= alarm.since_s {
                self.alarms.push(alarm);
            }
        }
    }

    /// What the same looks say when the robot localizes with another model; `None`: an eye does not see a part
    /// of the table as the head stands. `knows_when`: whether times count from switching on, so that laws of
    /// time apply.
    pub fn retold(
        samples: &[Sample],
        model: &RobotModel,
        posture: &Posture,
        knows_when: bool,
    ) -> Option<Self> {
        let mut monitor = Self::default();
        let seen =
            |sample: &Sample| SeenUnder { t_secs: knows_when.then_some(sample.at_s), ..SeenUnder::default() };
        let first = seen(samples.first()?);
        for sample in samples {
            let table = errors(model, posture, sample.look.turns_rad, &first, &seen(sample))?;
            monitor.add(Sample { at_s: sample.at_s, look: Look { table, ..sample.look.clone() } });
        }
        Some(monitor)
    }

    /// Everything that was seen, oldest first.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// How far looks scatter; `None`: not learned yet.
    pub fn band(&self) -> Option<&Band> {
        self.band.as_ref()
    }

    /// All that moved which should not have, oldest first.
    pub fn alarms(&self) -> &[Alarm] {
        &self.alarms
    }

    /// References that moved by themselves, oldest first.
    pub fn own_motions(&self) -> &[OwnMotion] {
        &self.own
    }

    /// How far places are from where they came out in the first minutes near, in the middle and far, m.
    pub fn off_m(&self, sample: &Sample) -> [f64; 3] {
        self.band.as_ref().map_or_else(|| sample.look.table.sizes_m(), |band| band.off_m(&sample.look))
    }

    /// What is the matter now.
    pub fn verdict(&self) -> Verdict {
        let Some(newest) = self.samples.last() else { return Verdict::NotSeen };
        if let Some(alarm) = self.knocked(newest) {
            return Verdict::Moved(alarm);
        }
        let Some(band) = &self.band else {
            return Verdict::Learning { looks: self.samples.len(), needed: Band::LOOKS };
        };
        let cost_m = band.off_m(&newest.look);
        let out = self.samples.iter().rev().take_while(|sample| band.costs(&sample.look)).count();
        if out < CONFIRMED_BY {
            return Verdict::Steady { cost_m };
        }
        let since_s = self.samples[self.samples.len() - out].at_s;
        let what = Mover::of(&band.turns_since(&newest.look), newest.look.knows_which);
        if what == Mover::Head || since_s > WARM_S {
            return Verdict::Moved(Alarm { what, since_s, sudden: false, cost_m });
        }
        let to_go = if newest.at_s > WARM_S { Some(ToGo::default()) } else { self.to_go(newest) };
        Verdict::Warming { to_go, cost_m, what, since_s }
    }

    /// Until the eyes are as good as warm.
    fn to_go(&self, newest: &Sample) -> Option<ToGo> {
        let step = self.samples.len().div_ceil(FITTED).max(1);
        let far = |sample: &Sample| {
            let places = sample.look.table.rows[Row::Far as usize].map(|place| place.error_m);
            (sample.at_s, places)
        };
        let mut seen: Vec<_> = self.samples.iter().step_by(step).map(far).collect();
        if !(self.samples.len() - 1).is_multiple_of(step) {
            seen.push(far(newest));
        }
        match fit_warm_up(&seen) {
            Some(approach) => Some(approach.until_within(AS_GOOD_AS_WARM_M)),
            None => (newest.at_s < USUALLY_WARM_S).then(|| ToGo::of(USUALLY_WARM_S - newest.at_s)),
        }
    }

    /// A change from one look to the next that the look after it confirms.
    fn note_knock(&mut self) {
        let [.., before, first, second] = self.samples.as_slice() else { return };
        let over = |a: &Sample, b: &Sample| Band::are_apart(self.band.as_ref(), &a.look, &b.look);
        let soon = first.at_s - before.at_s <= SUDDEN_S && second.at_s - first.at_s <= SUDDEN_S;
        let same = !over(first, second);
        if soon && same && over(before, first) && over(before, second) {
            // Put back where it was it is no matter any more.
            let is_back = self.band.as_ref().is_some_and(|band| !band.is_out(&second.look));
            self.knock = (!is_back).then(|| (first.at_s, mover::turns(&before.look)));
        }
    }

    /// What is left of the last sudden change.
    fn knocked(&self, newest: &Sample) -> Option<Alarm> {
        let (since_s, before) = self.knock?;
        let since = mover::since(&before, &newest.look);
        let earlier = self.samples.iter().rev().find(|sample| sample.at_s < since_s)?;
        let cost_m = newest.look.table.apart_m(&earlier.look.table);
        let is_left = Band::are_apart(self.band.as_ref(), &newest.look, &earlier.look);
        let what = Mover::of(&since, newest.look.knows_which);
        is_left.then_some(Alarm { what, since_s, sudden: true, cost_m })
    }
}
