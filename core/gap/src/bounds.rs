//! What may not be a name, whatever speaks for it on the rows that it was found in: what repeats contradict,
//! what leaves most of the gap open, and what does not hold on rows that were not used.

use std::collections::BTreeMap;

use plumbline_effects::measurements::What;
use plumbline_effects::{Assumed, Measurements, Present};

use plumbline_model::JobContext;

use crate::compare::{self, Compared, Structure};
use crate::error::GapError;
use crate::finding::{Dependence, FloorSource, NamedEffect, Shown, Verdict};
use crate::search::{self, Found, still_right};

/// Rows stay above the noise when they are this many times as far off …
const ABOVE: f64 = 1.3;
/// … and far above it when they are this many times as far off.
const FAR_ABOVE: f64 = 2.0;
/// Less than this share of the gap closes: most of it is open.
const MOSTLY_OPEN: f64 = 0.5;
/// More than this share of it closes: what is left can be one set of rows that nothing could be learned of without it,
/// an eye that was knocked between two sets, say.
const NEARLY_CLOSED: f64 = 0.8;
/// Where before is what noise leaves already, a handful of values that were fitted to a few dozen rows make others worse by
/// a tenth, however true they are.
const ALIKE: f64 = 0.15;
/// Where the noise of neighbors or of an instrument was found to be so many times as large, no more was tried.
const LARGEST_NOISE: f64 = 3.9;
/// Rows of less weight than this the search does not believe; more than this share of them is more than mishaps …
pub(crate) const NOT_BELIEVED: f64 = 0.1;
pub(crate) const MANY: f64 = 0.05;
/// … where all rows together lie this far beyond the noise of repeats, standard deviations of one measurement.
const FAR_SIGMAS: f64 = 1.0;
/// Repeats that still depend on something by less than this (units of what is left) are noise enough …
const LEAST_STRUCTURE: f64 = 0.4;
/// … and by less than this where that is how far joints stop short of their goals: a servo goes on by as much while the finger
/// presses, and no log of one moment holds that. An early log that does more has its name.
const LEAST_SHORT: f64 = 1.0;
/// … or by less than this share of the gap.
const STRUCTURE_SHARE: f64 = 0.2;

/// What rows that were not used say of the names that were found on the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum HeldOut {
    /// They are nearer to the model with them.
    Hold,
    /// They are no nearer, or farther away.
    Worse,
    /// They stay far above the noise: something else is at work, too.
    Far,
}

impl Shown {
    /// Whether held-out rows are about as far off as noise leaves them; none held out contradict nothing.
    pub fn is_near_noise(&self) -> bool {
        self.rows == 0 || self.after <= ABOVE * self.floor
    }

    /// `is_floor_known`: whether a floor that is exceeded was no guess.
    fn says(&self, is_floor_known: bool) -> HeldOut {
        if self.rows == 0 {
            return HeldOut::Hold;
        }
        // With nothing to close there is nothing to gain, but harm can be seen. Two means that only chance tells apart
        // are no harm.
        let is_worse = match self.closure {
            Some(_) => self.after >= self.before,
            None => self.after > (1.0 + ALIKE) * self.before,
        };
        if is_worse {
            return HeldOut::Worse;
        }
        // Without a closure before is what noise leaves, or no row was held out after all.
        let Some(closure) = self.closure else { return HeldOut::Hold };
        let is_open = closure < MOSTLY_OPEN && !self.is_near_noise();
        let is_far = is_floor_known && closure < NEARLY_CLOSED && self.after > FAR_ABOVE * self.floor;
        if is_open || is_far { HeldOut::Far } else { HeldOut::Hold }
    }
}

/// Whether rows can be far above this floor. A fitted one is whatever was left. What an instrument says of itself, or
/// neighbors tell, is fitted up to a factor: beyond it an arm may well scatter more. Of things that were watched a part of
/// the noise is a guess of how well laws of time fit.
fn is_floor_known(found: &Found, used: &Measurements) -> bool {
    let is_watched = used.rows.iter().any(|row| row.stand.is_some());
    is_told(found.floor.source, is_watched, found.doubt.noise_scale)
}

/// The same by where the floor comes from, whether things were watched, and how many times as large it was found.
fn is_told(source: FloorSource, is_watched: bool, noise_scale: f64) -> bool {
    match source {
        FloorSource::Repeats => true,
        FloorSource::Instrument | FloorSource::Neighbors => !is_watched && noise_scale < LARGEST_NOISE,
        FloorSource::Fitted => false,
    }
}

/// What makes rows that were not used worse, leaves most of the gap open there, or leaves them far above the noise, has
/// no name, whatever speaks for it on those that were; and a closure beyond one says that the floor was not the floor.
pub(crate) fn bound_by_held_out(
    found: &mut Found,
    used: &Measurements,
    shown: &Shown,
    warnings: &mut Vec<String>,
) {
    let named = matches!(found.verdict, Verdict::Named | Verdict::Class);
    let is_known = is_floor_known(found, used);
    let says = shown.says(is_known);
    if named && (says != HeldOut::Hold || !is_known && is_strained(found, shown)) {
        misled(found, 0.5);
    }
    // Of a floor that was fitted it is said already that nobody knows it.
    if shown.closure.is_some_and(|closure| closure > 1.0) && found.floor.source != FloorSource::Fitted {
        warnings.insert(
            0,
            "more of the gap closes than the noise leaves open: the noise was taken too large. Repeat a few measurements \
             from the same side"
                .to_owned(),
        );
    }
}

/// Whether what does most is larger than is plausible and yet leaves most of the gap open: near as the rest may be to a noise
/// that nothing told.
fn is_strained(found: &Found, shown: &Shown) -> bool {
    let is_beyond = |effect: &NamedEffect| effect.not_addable.as_deref() == Some(search::BEYOND_PLAUSIBLE);
    let is_open = shown.rows > 0 && shown.closure.is_some_and(|closure| closure < MOSTLY_OPEN);
    is_open && found.effects.first().is_some_and(is_beyond)
}

/// What leaves most of the gap open on the very rows that it was fitted to has no name, and cannot be expected
/// to hold elsewhere.
pub(crate) fn bound_by_own_rows(found: &mut Found, used: &Measurements) {
    let named = matches!(found.verdict, Verdict::Named | Verdict::Class);
    if !named || found.unexplained.share < MOSTLY_OPEN {
        return;
    }
    let left = compare::residuals(used, &found.assumed);
    let (mut square, mut count) = (0.0, 0.0);
    for ((row, left), weight) in used.rows.iter().zip(&left).zip(&found.weights) {
        let Some(left) = left else { continue };
        for (c, left) in left.iter().enumerate() {
            let Some(sd) = found.floor.of(row.what).map(|floor| floor.of_row(row, c)) else { continue };
            square += weight * (left / sd).powi(2);
            count += weight;
        }
    }
    // Many small things leave more than noise does, and are nothing unknown.
    let is_dirt = found.unexplained.p_value >= search::RIVAL_P;
    let above = if is_dirt { 1.0_f64.hypot(search::MOST_DIRT) } else { ABOVE };
    if square > above * above * count {
        misled(found, 0.5);
    }
}

/// What is larger than any robot can have of it is something else, which it follows. (Where everything is said to be a little off,
/// no name is said to be all of it.)
pub(crate) fn bound_by_what_can_be(found: &mut Found) {
    let is_beyond = |present: &Present| {
        let parameters = present.effect.parameters();
        let mut values = present.values.iter().zip(parameters);
        present.effect.is_bounded() && values.any(|(value, one)| value.abs() > search::BOUND * one.typical)
    };
    let named = matches!(found.verdict, Verdict::Named | Verdict::Class);
    if named && found.many.is_none() && found.assumed.effects.iter().any(is_beyond) {
        misled(found, 0.95);
    }
}

/// Where repeats still depend on something that was logged, with all that was found in the model, that is
/// not explained, and no noise.
pub(crate) fn still_structured(found: &mut Found, used: &Measurements, compared: &Compared) {
    let is_told = found.floor.source != FloorSource::Fitted;
    let of = |model: &Assumed| compare::structure_of(used, model, &compare::residuals(used, model), is_told);
    let Some(structure) = of(&found.assumed) else { return };
    // A small step is known although it is too small for a name.
    if of(&found.probable).is_none() {
        return;
    }
    let least = if structure.on == compare::HOW_FAR_SHORT { LEAST_SHORT } else { LEAST_STRUCTURE };
    if structure.size_sigmas < least.max(STRUCTURE_SHARE * compared.comparison.size_sigmas) {
        return;
    }
    depends_on(found, &structure);
    misled(found, 0.95);
}

/// Where nothing was measured twice, what rows that are near one another still leave alike is no noise: nothing of that has a
/// name, and that is no all-clear.
///
/// # Errors
/// Cancelled.
pub(crate) fn still_alike(
    found: &mut Found,
    used: &Measurements,
    seed: u64,
    context: &dyn JobContext,
) -> Result<(), GapError> {
    if found.verdict != Verdict::NoGap || found.floor.source == FloorSource::Repeats {
        return Ok(());
    }
    let left = compare::residuals(used, &found.assumed);
    if let Some(alike) = compare::alike(used, &left, seed, context)? {
        depends_on(found, &alike);
        misled(found, 0.95);
    }
    Ok(())
}

/// Where repeats tell the noise, what lies far beyond it is no all-clear for the rows that the search does not believe: a row that is
/// off again at every repeat is no mishap.
pub(crate) fn no_all_clear_without_them(found: &mut Found, used: &Measurements, compared: &Compared) {
    let mut cells = BTreeMap::<(What, usize), Vec<bool>>::new();
    for (row, weight) in used.rows.iter().zip(&found.weights) {
        cells.entry((row.what, row.cell)).or_default().push(*weight < NOT_BELIEVED);
    }
    let again = cells.values().filter(|own| own.len() > 1 && own.iter().all(|dropped| *dropped));
    let dropped: usize = again.map(Vec::len).sum();
    let are_many = dropped as f64 > MANY * found.weights.len() as f64;
    let told = &compared.comparison;
    let is_far = told.p_value < search::VETO_P && told.size_sigmas > FAR_SIGMAS;
    if found.verdict == Verdict::NoGap && told.floor_from_repeats && are_many && is_far {
        misled(found, 0.95);
    }
}

/// What is left depends on this first of all.
fn depends_on(found: &mut Found, structure: &Structure) {
    found.unexplained.depends_on.retain(|known| known.on != structure.on);
    let share = 1.0 - structure.left.iter().copied().fold(1.0, f64::min);
    let (on, of) = (structure.on.clone(), structure.of.to_owned());
    found.unexplained.depends_on.insert(0, Dependence { on, of, share, formula: None });
}

/// Something unknown is at work beside what was found: names are less sure than they look.
fn misled(found: &mut Found, probability: f64) {
    let unknown = &mut found.unexplained.probability;
    let before = *unknown;
    *unknown = unknown.max(probability);
    for effect in &mut found.effects {
        let less = still_right(*unknown) / still_right(before);
        effect.probability *= less;
        effect.class_probability *= less;
    }
    found.verdict = Verdict::NotInLibrary;
    // What something unknown does may as well be all that seemed a little off.
    found.many = None;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::finding::ShownUnit;

    /// Held-out rows of a gap of so many millimeters, and what is left of it beside half a millimeter of noise.
    fn shown(before_mm: f64, after_mm: f64) -> Shown {
        let (before, after, floor) = (before_mm * 1e-3, after_mm * 1e-3, 0.5e-3);
        Shown {
            blocks: "5 folds".to_owned(),
            rows: 60,
            unit: ShownUnit::Meter,
            before,
            after,
            floor,
            closure: (before > 1.02 * floor).then(|| (before - after) / (before - floor)),
            closure_range: None,
            worst_tenth: [before, after],
            inside_95: 0.95,
            unseen: None,
            part: None,
            covariates: vec![],
            telling: vec![],
        }
    }

    #[test]
    fn only_a_floor_that_something_tells_convicts() {
        let most = LARGEST_NOISE;
        assert!(is_told(FloorSource::Repeats, true, 10.0), "repeats were repeated");
        for source in [FloorSource::Instrument, FloorSource::Neighbors] {
            assert!(is_told(source, false, 0.9 * most));
            assert!(!is_told(source, false, most), "the noise may be larger than was tried");
            assert!(!is_told(source, true, 1.0), "a part of it is a guess");
        }
        assert!(!is_told(FloorSource::Fitted, false, 1.0), "it is whatever was left");
    }

    #[test]
    fn what_brings_held_out_rows_down_to_the_noise_holds() {
        for after_mm in [0.45, 0.5, 0.64, 0.95] {
            assert_eq!(shown(3.0, after_mm).says(true), HeldOut::Hold, "{after_mm}");
        }
        assert!(shown(3.0, 0.64).is_near_noise() && !shown(3.0, 0.66).is_near_noise());
    }

    #[test]
    fn what_makes_held_out_rows_no_better_is_no_name() {
        for after_mm in [3.0, 3.2] {
            assert_eq!(shown(3.0, after_mm).says(true), HeldOut::Worse);
            assert_eq!(shown(3.0, after_mm).says(false), HeldOut::Worse);
        }
    }

    #[test]
    fn rows_far_above_a_known_noise_take_the_name_back_even_where_half_of_the_gap_closes() {
        let far = shown(3.0, 1.27);
        assert!(far.closure.is_some_and(|closure| closure > 0.5));
        // Where nearly all of it closes, what is left is some rows that the others tell nothing of.
        assert_eq!(shown(20.0, 1.27).says(true), HeldOut::Hold);
        assert_eq!(far.says(true), HeldOut::Far);
        // Where the noise is itself a guess, it convicts nobody, unless most of the gap is open.
        assert_eq!(far.says(false), HeldOut::Hold);
        assert_eq!(shown(3.0, 2.0).says(false), HeldOut::Far);
    }

    #[test]
    fn where_there_is_nothing_to_close_harm_is_seen_all_the_same() {
        let [alike, worse, far] = [0.55, 0.6, 1.2].map(|after_mm| shown(0.5, after_mm));
        assert_eq!(alike.closure, None);
        assert_eq!(alike.says(true), HeldOut::Hold);
        assert_eq!(worse.says(true), HeldOut::Worse);
        assert_eq!(far.says(false), HeldOut::Worse);
    }

    #[test]
    fn no_row_held_out_contradicts_nothing() {
        let none = Shown { rows: 0, ..shown(3.0, 3.0) };
        assert!(none.is_near_noise());
        assert_eq!(none.says(true), HeldOut::Hold);
        // What is shown where nothing was to be held out: the gap as it is.
        let as_it_is = Shown { closure: None, ..shown(3.0, 3.0) };
        assert_eq!(as_it_is.says(true), HeldOut::Hold);
    }
}
