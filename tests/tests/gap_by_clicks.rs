//! An operator finds an effect that is hidden in the physics, by clicks in a window over the real
//! engine: the session is compared, the effect is named, added to the model, and the gap that is left
//! is looked for again. Only the last lines read what was hidden.

#![allow(clippy::print_stdout, reason = "figures of the run, with --nocapture")]

use std::sync::Arc;

use plumbline_blind::bench::Bench;
use plumbline_blind::case::{Case, make_or_smaller};
use plumbline_blind::design::{Design, Planner};
use plumbline_blind::physics::Generator;
use plumbline_blind::recipe::{Family, Recipe};
use plumbline_blind::secret::Kind;
use plumbline_engine::View;
use plumbline_engine::gap::Verdict;
use plumbline_engine::view::StepState;
use plumbline_tests::{Beginning, Window, click, click_containing, type_over, until, view, window};

/// A rich plan with one effect of four noise deviations.
fn hidden() -> Case {
    let bench = Bench::usual().expect("the robot that comes with the program");
    let planner = Planner::new(&bench).expect("a planner");
    let recipe = Recipe {
        number: 1,
        generator: Generator::Lean,
        family: Family::Single,
        design: Design::Rich,
        dirt: false,
        size_sigmas: 4.0,
        kind: Some(Kind::JointZero),
        seed: 20_261_121,
    };
    make_or_smaller(&bench, &planner, &recipe).expect("a case")
}

fn searched(window: &mut Window, what: &str, findings: usize) {
    until(window, what, |window| {
        let gap = &view(window).gap;
        assert_eq!(gap.failed, None);
        gap.searching.is_none() && gap.findings.len() == findings
    });
}

#[test]
fn a_hidden_effect_is_found_named_added_and_the_gap_shrinks() {
    let case = hidden();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let session = folder.path().join("a session from the lab");
    case.session.write(&session).expect("the session is written");
    let beginning = Beginning::of(folder.path());

    let mut window = window(&folder.path().join("data"), None);
    click(&mut window, "Gap");
    click(&mut window, "Open folder…");
    type_over(&mut window, &session);
    click(&mut window, "Open");
    until(&mut window, "the session in the list", |window| {
        view(window).gap.sessions.iter().any(|listed| listed.folder == session && listed.problem.is_none())
    });
    assert_eq!(view(&window).gap.step, StepState::NotDone);
    until(&mut window, "what is read at the start", |window| view(window).running_job().is_none());

    click(&mut window, "Find what is missing");
    searched(&mut window, "the finding", 1);
    let found = view(&window).gap.shown.clone().expect("a finding is shown");
    assert!(matches!(found.finding.verdict, Verdict::Named | Verdict::Class), "{}", found.finding.sentence);
    assert!(view(&window).gap.model.effects.is_empty(), "nothing is added before it is accepted");

    click_containing(&mut window, " to the model");
    until(&mut window, "the model in use", |window| !view(window).gap.model.effects.is_empty());
    assert_eq!(view(&window).gap.model.name, "nominal + 1 effect");

    // What is left once the effect is in the model.
    click_containing(&mut window, "Find what is le");
    searched(&mut window, "the second finding", 2);
    let left = view(&window).gap.shown.clone().expect("a finding is shown");

    click(&mut window, "History");
    click_containing(&mut window, "Undo: ");
    until(&mut window, "the nominal model", |window| view(window).gap.model.effects.is_empty());

    // The judge.
    let effect = &found.finding.effects[0];
    let secret = &case.answer.hidden[0];
    let shown = &found.finding.shown;
    println!(
        "hidden {}, found {}@{} ({:.0} %), {:.2} mm before, {:.2} mm after, noise {:.2} mm; then {:?}",
        secret.named(),
        effect.id,
        effect.site,
        100.0 * effect.probability,
        1e3 * shown.before,
        1e3 * shown.after,
        1e3 * shown.floor,
        left.finding.verdict,
    );
    let is_in_class = effect
        .class
        .iter()
        .any(|member| member.id == secret.id && (secret.site.is_empty() || member.site == secret.site));
    assert!(is_in_class, "hidden {secret:?}, found {effect:?}");
    assert!(shown.closure.is_some_and(|closure| closure > 0.8), "{shown:?}");
    assert!(left.finding.comparison.size_sigmas < 0.5 * found.finding.comparison.size_sigmas);
    drop(found);

    beginning.leads_to_what_is_shown(window, without_seconds);
}

/// How long a search took is of that start of the program.
fn without_seconds(view: &mut View) {
    let gap = Arc::make_mut(&mut view.gap);
    for shown in [&mut gap.shown, &mut gap.beside].into_iter().flatten() {
        Arc::make_mut(shown).finding.seconds = 0.0;
    }
}
