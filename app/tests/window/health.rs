//! Whether the calibration in use still holds, and what is offered of a proposal that was judged.

use std::sync::Arc;

use plumbline::{Screen, WindowSettings};
use plumbline_engine::view::{
    AcceptedCalibration, EyesHealth, EyesView, HealthFigures, HealthState, HealthView, JudgedWhen, Origin,
    Proposal, ProposalHealth, SourceStatus, SourceView,
};
use plumbline_engine::{Command, EyesCommand, View};
use plumbline_model::StereoCalibration;

use crate::fake::{Fake, click, says, shows};
use crate::made_up::{everything, rig};

const ASK: &str = "Is the calibration still good?";

fn on(screen: Screen) -> WindowSettings {
    WindowSettings { screen, ..WindowSettings::default() }
}

fn figures(far_m: f64) -> HealthFigures {
    HealthFigures {
        is_good: far_m <= 0.008,
        off_m: [0.25 * far_m, 0.5 * far_m, far_m],
        sigma_m: [0.001; 3],
        turn_rad: 0.01,
        epipolar_px: 0.3,
    }
}

fn judged(in_use_m: f64, proposed: Option<(f64, ProposalHealth)>) -> HealthState {
    let proposed = proposed.map(|(far_m, verdict)| (figures(far_m), verdict));
    HealthState::Judged(Arc::new(EyesHealth { in_use: figures(in_use_m), proposed, pairs: 4, places: 520 }))
}

fn with(state: HealthState) -> View {
    let judged = if let HealthState::Judged(health) = &state { Some(health.clone()) } else { None };
    with_health(HealthView { state, judged, ..HealthView::default() })
}

/// A calibration is in use, and another one proposed.
fn with_health(health: HealthView) -> View {
    let calibration = || Arc::new(StereoCalibration::bare(rig().eyes.cameras));
    let in_use = AcceptedCalibration {
        id: "first".to_owned(),
        calibration: calibration(),
        accepted: jiff::Timestamp::now(),
        uncertainty: None,
        stated_at_m: 0.45,
        depth_per_px_m: None,
    };
    let proposal = Proposal {
        calibration: calibration(),
        origin: Origin::Imported { file: "another.toml".to_owned() },
        difference: None,
        uncertainty: None,
        stated_at_m: 0.45,
        depth_per_px_m: None,
        doubts: vec![],
        stale: None,
    };
    let eyes = EyesView {
        in_use: Some(Arc::new(in_use)),
        proposal: Some(Arc::new(proposal)),
        health,
        ..EyesView::default()
    };
    let source = SourceView { status: SourceStatus::Running, ..SourceView::clone(&everything().source) };
    View { eyes: Arc::new(eyes), source: Arc::new(source), ..everything() }
}

#[test]
fn a_calibration_that_does_not_hold_is_said_where_it_counts_and_leads_to_a_new_one() {
    for screen in [Screen::Live, Screen::Drift] {
        let why =
            "The calibration of the eyes does not hold any more: places are off by 32 mm far.".to_owned();
        let fake = Fake::over(with_health(HealthView { does_not_hold: Some(why), ..HealthView::default() }));
        let mut window = fake.window(on(screen));
        assert!(says(&window, "does not hold any more"), "{screen:?}");
        click(&mut window, "Calibrate the eyes again");
        assert!(shows(&window, "Coverage"), "where pairs are collected");
    }
}

#[test]
fn it_is_asked_for_beside_drift_and_answered_in_centimeters() {
    let fake = Fake::over(with(HealthState::NotAsked));
    let mut window = fake.window(on(Screen::Drift));
    click(&mut window, ASK);
    assert_eq!(fake.take_sent(), [Command::from(EyesCommand::JudgeHealth)]);
    for (state, words) in [
        (HealthState::Gathering { pairs: 2, of: 4 }, "Looks: 2 of 4 pairs."),
        (HealthState::Judging, "Compares what both eyes see."),
        (HealthState::Failed("Is the light on?".to_owned()), "Is the light on?"),
        (judged(0.004, None), "still good: places are off by 1 mm near, 2 mm in the middle, 4 mm far"),
        (
            judged(0.04, None),
            "not good any more: places are off by 10 mm near, 20 mm in the middle, 40 mm far",
        ),
    ] {
        let fake = Fake::over(with(state));
        assert!(says(&fake.window(on(Screen::Drift)), words), "{words}");
    }
}

/// Still good when it was judged, so many minutes ago.
fn good_before(minutes: i64, eyes_on_min: Option<f64>, moved_m: Option<[f64; 3]>) -> View {
    let HealthState::Judged(health) = judged(0.004, None) else { unreachable!("just made") };
    let at = jiff::Timestamp::now() - jiff::SignedDuration::from_mins(minutes);
    with_health(HealthView {
        cold_for_min: None,
        state: HealthState::Judged(health.clone()),
        judged: Some(health),
        when: Some(JudgedWhen { at, eyes_on_min, moved_m, colder: None, warmed_since: false }),
        colder_wait_min: None,
        does_not_hold: None,
    })
}

#[test]
fn what_was_judged_says_when_and_with_which_eyes() {
    for (eyes_on_min, words) in [
        (Some(2.0), "Judged 2 min ago, with cold eyes."),
        (Some(40.0), "Judged 2 min ago, with warm eyes."),
        (None, "Judged 2 min ago."),
    ] {
        let fake = Fake::over(good_before(2, eyes_on_min, None));
        let window = fake.window(on(Screen::Drift));
        assert!(says(&window, words) && says(&window, "in use is still good"), "{words}");
    }
}

#[test]
fn what_was_judged_steps_back_once_places_have_moved_or_it_is_old() {
    let moved = good_before(2, Some(2.0), Some([0.016, 0.031, 0.063]));
    let old = good_before(40, Some(2.0), None);
    for (view, why) in [(moved, "Places have moved by 63.0 mm"), (old, "It was judged a while ago")] {
        let fake = Fake::over(view);
        let window = fake.window(on(Screen::Drift));
        assert!(says(&window, why) && says(&window, "Then the calibration in use was still good"), "{why}");
        assert!(!says(&window, "in use is still good"), "{why}");
    }
    // What a grasp bears changes nothing.
    let fake = Fake::over(good_before(2, Some(2.0), Some([0.001, 0.002, 0.004])));
    assert!(says(&fake.window(on(Screen::Drift)), "in use is still good"));
}

#[test]
fn cold_eyes_are_told_to_wait_instead_of_being_calibrated_again() {
    let HealthState::Judged(health) = judged(0.04, None) else { unreachable!("just made") };
    let state = HealthState::Judged(health.clone());
    let health = HealthView {
        cold_for_min: None,
        state,
        judged: Some(health),
        when: None,
        colder_wait_min: Some(11.0),
        does_not_hold: None,
    };
    let fake = Fake::over(with_health(health));
    let window = fake.window(on(Screen::Drift));
    assert!(says(&window, "Wait 11 min, then ask again.") && says(&window, "off by 10 mm near"));
    assert!(!says(&window, "Calibrate the eyes again"));
}

#[test]
fn while_it_is_computed_it_is_not_asked_for_again_and_while_pairs_are_gathered_it_begins_anew() {
    for (state, sent) in [
        (HealthState::Judging, vec![]),
        (HealthState::Gathering { pairs: 2, of: 4 }, vec![Command::from(EyesCommand::JudgeHealth)]),
    ] {
        let fake = Fake::over(with(state));
        let mut window = fake.window(on(Screen::Drift));
        click(&mut window, ASK);
        assert_eq!(fake.take_sent(), sent);
    }
}

#[test]
fn a_proposal_that_was_not_better_stays_so_while_it_is_judged_again_and_when_that_fails() {
    let HealthState::Judged(health) = judged(0.004, Some((0.02, ProposalHealth::Worse))) else {
        unreachable!("just made")
    };
    for state in [
        HealthState::Gathering { pairs: 2, of: 4 },
        HealthState::Judging,
        HealthState::Failed("Is the light on?".to_owned()),
    ] {
        let fake = Fake::over(with_health(HealthView {
            state,
            judged: Some(health.clone()),
            ..HealthView::default()
        }));
        let window = fake.window(on(Screen::Accept));
        assert!(says(&window, "is worse than") && !shows(&window, "Accept calibration"));
    }
}

#[test]
fn a_proposal_that_is_not_better_is_not_offered_and_both_are_told_in_figures() {
    for (verdict, words) in
        [(ProposalHealth::Worse, "is worse than"), (ProposalHealth::Undecided, "cannot be told apart from")]
    {
        let fake = Fake::over(with(judged(0.004, Some((0.02, verdict)))));
        let window = fake.window(on(Screen::Accept));
        assert!(says(&window, words), "{words}");
        assert!(says(&window, "In use: 1 mm near, 2 mm in the middle, 4 mm far"), "{words}");
        assert!(says(&window, "proposed: 5 mm near, 10 mm in the middle, 20 mm far"), "{words}");
        assert!(
            !shows(&window, "Accept calibration") && !shows(&window, "Accept it all the same"),
            "{words}"
        );
    }
}

#[test]
fn a_proposal_that_is_better_or_was_not_judged_is_offered() {
    for state in [
        HealthState::NotAsked,
        judged(0.04, Some((0.002, ProposalHealth::Better))),
        judged(0.04, Some((0.04, ProposalHealth::Untold))),
        judged(0.004, Some((0.004, ProposalHealth::KnowsWhen))),
    ] {
        let fake = Fake::over(with(state));
        let mut window = fake.window(on(Screen::Accept));
        click(&mut window, "Accept calibration");
        assert_eq!(fake.take_sent(), [Command::from(EyesCommand::Accept)]);
    }
}

#[test]
fn a_proposal_that_was_judged_before_places_moved_is_to_be_judged_again() {
    let HealthState::Judged(health) = judged(0.004, Some((0.02, ProposalHealth::Worse))) else {
        unreachable!("just made")
    };
    let state = HealthState::Judged(health.clone());
    let at = jiff::Timestamp::now();
    let when = Some(JudgedWhen {
        at,
        eyes_on_min: None,
        moved_m: Some([0.01, 0.02, 0.04]),
        colder: None,
        warmed_since: false,
    });
    let view = with_health(HealthView {
        cold_for_min: None,
        state,
        judged: Some(health),
        when,
        colder_wait_min: None,
        does_not_hold: None,
    });
    let fake = Fake::over(view);
    let mut window = fake.window(on(Screen::Judge));
    assert!(says(&window, "Places have moved by 40.0 mm since it was judged"));
    assert!(!shows(&window, "Accept calibration") && !says(&window, "is worse than"));
    click(&mut window, ASK);
    assert_eq!(fake.take_sent(), [Command::from(EyesCommand::JudgeHealth)]);
}

/// What cold eyes saw is not told of eyes that are warm by now.
#[test]
fn what_was_judged_with_colder_eyes_does_not_stand_once_they_are_warm() {
    let HealthState::Judged(health) = judged(0.032, None) else { unreachable!("just made") };
    let of = |warmed_since| {
        let at = jiff::Timestamp::now();
        let when = JudgedWhen { at, eyes_on_min: Some(3.0), moved_m: None, colder: Some(true), warmed_since };
        let view = with_health(HealthView {
            cold_for_min: None,
            state: HealthState::Judged(health.clone()),
            judged: Some(health.clone()),
            when: Some(when),
            colder_wait_min: (!warmed_since).then_some(7.0),
            does_not_hold: None,
        });
        Fake::over(view).window(on(Screen::Drift))
    };
    let cold = of(false);
    assert!(says(&cold, "Wait 7 min, then ask again") && says(&cold, "with cold eyes"));
    let warm = of(true);
    assert!(says(&warm, "have got warmer since it was judged: it does not stand any more. Ask again."));
    assert!(!says(&warm, "Calibrate the eyes again"));
}
