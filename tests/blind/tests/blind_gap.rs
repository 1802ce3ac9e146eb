//! A small blind test: effects hidden in physics must be found, and what is not there must not.
//! The whole table is printed by the example `blind_table`.

#[path = "../judge/mod.rs"]
mod judge;
#[path = "../judge/several.rs"]
mod several;

use plumbline_blind::bench::Bench;
use plumbline_blind::case;
use plumbline_blind::design::{Design, Planner};
use plumbline_blind::mix::recipes as recipes_of;
use plumbline_blind::physics::Generator;
use plumbline_blind::recipe::{Family, Recipe};
use plumbline_blind::secret::Kind;
use several::{all, scored, value};

/// Cases: 4 without anything, 10 with one effect, 4 with two, 4 with what the library lacks, 4 that are a little off
/// everywhere.
fn recipes() -> Vec<Recipe> {
    let singles = [
        (Kind::JointZero, Design::Plain),
        (Kind::TipOffset, Design::Rich),
        (Kind::JointSag, Design::Rich),
        (Kind::LinkLength, Design::Rich),
        (Kind::Backlash, Design::Rich),
        (Kind::TorsoLean, Design::Rich),
        (Kind::JointCoupling, Design::Rich),
        (Kind::ScreenScale, Design::Plain),
        (Kind::SlippedHorn, Design::Plain),
        (Kind::SidewaysGive, Design::Rich),
    ];
    let nameless = [Kind::CableStep, Kind::Hysteresis, Kind::OtherArm, Kind::SoftWhenWarm];
    let one = |family, design, size_sigmas, kind| Recipe {
        number: 0,
        generator: Generator::Lean,
        family,
        design,
        dirt: false,
        size_sigmas,
        kind,
        seed: 0,
    };
    let mut recipes = vec![];
    recipes
        .extend([Design::Plain, Design::Rich].repeat(2).into_iter().map(|d| one(Family::Null, d, 0.0, None)));
    recipes.extend(singles.map(|(kind, design)| one(Family::Single, design, 2.0, Some(kind))));
    recipes.extend([None; 4].map(|kind| one(Family::Pair, Design::Rich, 2.0, kind)));
    recipes.extend(nameless.map(|kind| one(Family::OffLibrary, Design::Rich, 5.0, Some(kind))));
    let everywhere = |design| one(Family::Crowd, design, 0.0, None);
    recipes.extend([Design::Plain, Design::Rich].repeat(2).into_iter().map(everywhere));
    for (number, recipe) in recipes.iter_mut().enumerate() {
        (recipe.number, recipe.seed) = (number, 1900 + number as u64);
    }
    recipes
}

#[test]
fn hidden_effects_are_found_and_nothing_else() {
    let bench = Bench::usual().expect("the rig");
    let planner = Planner::new(&bench).expect("it reaches the screen");
    let recipes = recipes();
    let score = scored(recipes.len(), |number| case::make_or_smaller(&bench, &planner, &recipes[number]));
    assert_eq!(all(score.null_named).hits, 0, "a name where nothing is hidden");
    // Few cases: one of a kind may go wrong that the table does not show.
    let singles = all(score.singles_visible.values().map(|naming| naming.class));
    assert!(value(&singles) >= 0.9, "single effects: {singles:?}");
    let several = all(score.several.values().map(|naming| naming.class));
    assert!(value(&several) >= 0.75, "pairs: {several:?}");
    let nameless = score.nameless["rich"];
    assert!(value(&nameless) >= 0.75, "not in the library: {nameless:?}");
    assert_eq!(score.nameless_named.hits, 0, "a confident name of what is in no library");
    assert!(value(&score.crowd_said) >= 0.75, "a little off everywhere: {:?}", score.crowd_said);
    assert_eq!(score.crowd_named.hits, 0, "a few names for what is off everywhere");
    assert!(score.crowd_wrong.hits <= 1, "confident and wrong, off everywhere: {:?}", score.crowd_wrong);
    assert!(value(&score.wrong_confident) <= 0.1, "confident and wrong: {:?}", score.wrong_confident);
    assert!(value(&score.coverage) >= 0.9, "intervals: {:?}", score.coverage);
}

/// A wide screen, and a link of another length beside a zero, in these two cases: a wrist that turns the other way
/// explains them better than zeros alone do, and they explain themselves better than it does.
#[test]
fn errors_of_usual_size_are_refused_for_no_joint_that_turns_the_other_way() {
    let bench = Bench::usual().expect("the rig");
    let planner = Planner::new(&bench).expect("it reaches the screen");
    let wide = recipes_of(Generator::Worn, 500, 2101).swap_remove(298);
    let longer = recipes_of(Generator::Lean, 400, 3068).swap_remove(262);
    let recipes = [wide, longer];
    let score = scored(recipes.len(), |number| case::make_or_smaller(&bench, &planner, &recipes[number]));
    let single = all(score.singles_visible.values().map(|naming| naming.exact));
    let pair = all(score.several.values().map(|naming| naming.class));
    assert_eq!((single.hits, single.of, pair.hits, pair.of), (1, 1, 1, 1));
}
