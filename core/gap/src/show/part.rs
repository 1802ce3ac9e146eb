//! What may be added of what was found, judged by itself: what stands beside it and may not be added helps nobody
//! who presses *Add*.

use plumbline_effects::{Assumed, Measurements};

use super::{HeldOut, closure, closure_range, means};
use crate::finding::{NamedEffect, Part};
use crate::floor::Floor;
use crate::search::{self, Found};

/// Whether some of it may be added, and some may not.
pub(super) fn is_divided(whole: &Found) -> bool {
    let may = |effect: &NamedEffect| effect.not_addable.is_none();
    whole.effects.iter().any(may) && !whole.effects.iter().all(may)
}

/// The model that was found without some rows, with no effect that may not be added: by what those rows say, or all.
/// Frames are placed anew.
pub(super) fn of(known: &Measurements, floor: &Floor, whole: &Found, found: &Found) -> Assumed {
    let barred = |id: &str, site: &str| {
        let all = whole.effects.iter().chain(&found.effects);
        all.filter(|effect| effect.not_addable.is_some())
            .any(|effect| (effect.id.as_str(), effect.site.as_str()) == (id, site))
    };
    let mut part = found.assumed.clone();
    let before = part.effects.len();
    part.effects.retain(|present| !barred(present.effect.id(), &present.effect.site));
    if part.effects.len() == before { part } else { search::place(known, floor, &part) }
}

/// What the rows show with it; `None` where it was not judged by itself.
pub(super) fn summary(rows: &[HeldOut], seed: u64) -> Option<Part> {
    let rows: Vec<HeldOut> =
        rows.iter().map(|row| Some(HeldOut { after: row.part?, ..*row })).collect::<Option<_>>()?;
    let three = means(&rows);
    (!rows.is_empty()).then(|| Part {
        after: three[1],
        closure: closure(three),
        closure_range: closure_range(&rows, seed),
        unseen_after: None,
    })
}
