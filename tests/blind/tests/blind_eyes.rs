//! A small blind test of eyes. The whole table is printed by the example `blind_table`.

#[path = "../judge/mod.rs"]
mod judge;
#[path = "../judge/several.rs"]
mod several;

use plumbline_blind::answer::Plan;
use plumbline_blind::eyes::{self, Kind};
use plumbline_blind::hide::Wish;
use plumbline_blind::recipe::Family;
use several::{all, scored, value};

/// Cases: 6 without anything, 9 with one effect, 4 with two, 4 with what the library lacks.
fn wishes() -> Vec<Wish<Kind>> {
    let singles = [
        (Kind::EyeYaw, Plan::Plain),
        (Kind::Mount, Plan::Plain),
        (Kind::ImageShift, Plan::Plain),
        (Kind::HeadZero, Plan::Rich),
        (Kind::Mount, Plan::Rich),
        (Kind::EyeYaw, Plan::Rich),
        (Kind::YawGrows, Plan::Watched),
        (Kind::MountGrows, Plan::Watched),
        (Kind::ShiftGrows, Plan::Watched),
        (Kind::Bulge, Plan::Rich),
        (Kind::ShiftGrows, Plan::Rich),
    ];
    let nameless = [Kind::OneFocal, Kind::RowOffset, Kind::HeadSkew, Kind::NeckMemory];
    let plans = [Plan::Plain, Plan::Rich, Plan::Watched];
    let mut wishes = vec![];
    wishes.extend(plans.repeat(2).into_iter().map(|plan| Wish::of(Family::Null, plan, 0.0, None)));
    wishes.extend(singles.map(|(kind, plan)| Wish::of(Family::Single, plan, 3.0, Some(kind))));
    wishes.extend([None; 4].map(|kind| Wish::of(Family::Pair, Plan::Rich, 3.0, kind)));
    wishes.extend(nameless.map(|kind| Wish::of(Family::OffLibrary, Plan::Rich, 3.0, Some(kind))));
    wishes.extend([Some(Kind::Wobble); 2].map(|kind| Wish::of(Family::OffLibrary, Plan::Watched, 3.0, kind)));
    // With dirt the thing that is watched is moved by hand, too.
    let moved = Wish { dirt: true, ..Wish::of(Family::Null, Plan::Watched, 0.0, None) };
    wishes.extend([moved.clone(), moved]);
    Wish::number(&mut wishes, 1900);
    wishes
}

#[test]
fn what_is_wrong_with_eyes_is_found_and_nothing_else() {
    let wishes = wishes();
    let score = scored(wishes.len(), |number| eyes::make(&wishes[number]));
    assert_eq!(all(score.null_named).hits, 0, "a name where nothing is hidden");
    // Few cases: one of a kind may go wrong that the table does not show.
    let singles = all(score.singles_visible.values().map(|naming| naming.class));
    assert!(singles.of >= 9 && value(&singles) >= 0.9, "single effects: {singles:?}");
    let pairs = all(score.several.values().map(|naming| naming.class));
    assert!(value(&pairs) >= 0.75, "pairs: {pairs:?}");
    let nameless = all(score.nameless.values().copied());
    assert!(value(&nameless) >= 0.8, "not in the library: {nameless:?}");
    assert_eq!(score.nameless_named.hits, 0, "a confident name of what is in no library");
    assert!(value(&score.wrong_confident) <= 0.1, "confident and wrong: {:?}", score.wrong_confident);
    assert!(value(&score.coverage) >= 0.9, "intervals: {:?}", score.coverage);
}
