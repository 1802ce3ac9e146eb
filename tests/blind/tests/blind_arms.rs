//! A small blind test of arms drawn by chance and measured from outside. The whole table is printed by the example
//! `blind_table`.

#[path = "../judge/mod.rs"]
mod judge;
#[path = "../judge/several.rs"]
mod several;

use plumbline_blind::answer::Plan;
use plumbline_blind::arms::{self, Kind};
use plumbline_blind::hide::Wish;
use plumbline_blind::recipe::Family;
use several::{all, scored, value};

/// Cases: 4 without anything, 6 with one effect, 4 with two, 2 with what the library lacks.
fn wishes() -> Vec<Wish<Kind>> {
    let singles = [
        (Kind::JointZero, Plan::Plain),
        (Kind::LinkLength, Plan::Plain),
        (Kind::JointSag, Plan::Rich),
        (Kind::AxisSkew, Plan::Rich),
        (Kind::JointEccentricity, Plan::Plain),
        (Kind::Backlash, Plan::Rich),
    ];
    let nameless = [Kind::CableStep, Kind::FarCable];
    let mut wishes = vec![];
    wishes.extend(
        [Plan::Plain, Plan::Rich].repeat(2).into_iter().map(|p| Wish::of(Family::Null, p, 0.0, None)),
    );
    wishes.extend(singles.map(|(kind, plan)| Wish::of(Family::Single, plan, 2.0, Some(kind))));
    wishes.extend([None; 4].map(|kind| Wish::of(Family::Pair, Plan::Rich, 2.0, kind)));
    wishes.extend(nameless.map(|kind| Wish::of(Family::OffLibrary, Plan::Rich, 5.0, Some(kind))));
    Wish::number(&mut wishes, 1900);
    wishes
}

#[test]
fn hidden_effects_of_unknown_arms_are_found_and_nothing_else() {
    let wishes = wishes();
    let score = scored(wishes.len(), |number| arms::make(&wishes[number]));
    assert_eq!(all(score.null_named).hits, 0, "a name where nothing is hidden");
    // Few cases: one of a kind may go wrong that the table does not show.
    let singles = all(score.singles_visible.values().map(|naming| naming.class));
    assert!(singles.of == 6 && singles.hits >= 5, "single effects: {singles:?}");
    let pairs = all(score.several.values().map(|naming| naming.class));
    assert!(value(&pairs) >= 0.75, "pairs: {pairs:?}");
    let nameless = all(score.nameless.values().copied());
    assert!(nameless.of == 2 && nameless.hits == 2, "not in the library: {nameless:?}");
    assert_eq!(score.nameless_named.hits, 0, "a confident name of what is in no library");
    assert!(value(&score.wrong_confident) <= 0.1, "confident and wrong: {:?}", score.wrong_confident);
    assert!(value(&score.coverage) >= 0.9, "intervals: {:?}", score.coverage);
}

/// Cases of what the library lacks, by sort and plan; every one is told, and none gets a confident name.
fn told(sorts: &[(Kind, Plan)], is_repeated: bool, first_seed: u64) {
    let of = |(kind, plan): &(Kind, Plan)| Wish::of(Family::OffLibrary, *plan, 5.0, Some(*kind));
    let mut wishes: Vec<Wish<Kind>> = sorts.iter().map(of).collect();
    Wish::number(&mut wishes, first_seed);
    wishes.iter_mut().for_each(|wish| wish.repeated = is_repeated);
    let score = scored(wishes.len(), |number| arms::make(&wishes[number]));
    let nameless = all(score.nameless.values().copied());
    assert!(nameless.of == sorts.len() && nameless.hits == nameless.of, "not in the library: {nameless:?}");
    assert_eq!(score.nameless_named.hits, 0, "a confident name of what is in no library");
}

#[test]
fn what_a_joint_does_by_another_one_or_by_its_way_is_told_where_nothing_is_repeated() {
    told(&[(Kind::FarCable, Plan::Rich), (Kind::Hysteresis, Plan::Rich)].repeat(2), false, 1950);
}

#[test]
fn a_joint_that_jumps_at_an_angle_is_told_where_nothing_is_repeated() {
    told(&[(Kind::CableStep, Plan::Plain), (Kind::CableStep, Plan::Rich)].repeat(2), false, 1960);
}

/// Each repeat comes from elsewhere, so that its spread is no noise alone.
#[test]
fn a_joint_that_remembers_is_no_play_where_poses_are_repeated() {
    told(&[(Kind::Hysteresis, Plan::Plain)].repeat(4), true, 1970);
}
