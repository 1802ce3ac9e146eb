//! Views of touching that no engine made, in every state.

use std::sync::Arc;
use std::time::Duration;

use jiff::Timestamp;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use plumbline_engine::View;
use plumbline_engine::touch::{Addition, Advice, EffectVisibility, PlanScore};
use plumbline_engine::view::{
    ContactSource, ContactView, PlanView, StepState, TouchCounts, TouchFigures, TouchOutcome, TouchPhase,
    TouchState, TouchView, UnfinishedRun,
};
use plumbline_model::Pixel;
use plumbline_model::session::Touchscreen;
use plumbline_model::touch_plan::{PlanOptions, Purpose, TouchArea, TouchPlan};
use plumbline_model::touchscreen::ScreenPlacement;

use crate::made_up::{connected, everything, rig};

pub fn screen() -> Touchscreen {
    rig().touchscreen.clone()
}

pub fn area() -> TouchArea {
    TouchArea::within(&screen(), 0.02)
}

/// The twin runs and this is the state of touching.
pub fn with_touch(touch: TouchView) -> View {
    View { touch: Arc::new(touch), ..everything() }
}

/// Nothing was ever done; the twin feels.
pub fn idle() -> TouchView {
    TouchView { screen: Some(screen()), source: ContactSource::Twin, ..TouchView::default() }
}

/// Touches of a plan; those in the far left corner are out of reach.
pub fn planned(options: PlanOptions) -> TouchView {
    let screen = screen();
    let plan = TouchPlan::make(&options, &screen).expect("a plan that can be made");
    let touches: Vec<TouchState> = plan
        .touches
        .iter()
        .map(|touch| {
            let far = touch.target.u_px < 500.0 && touch.target.v_px < 500.0;
            let place = screen.point_at(touch.target);
            TouchState {
                number: touch.number,
                target: touch.target,
                target_place: place,
                sent: place,
                inside: true,
                set: touch.set.clone(),
                group: touch.group.clone(),
                side: touch.side,
                outcome: if far {
                    TouchOutcome::Unreachable("the arm is too short".to_owned())
                } else {
                    TouchOutcome::Waiting
                },
                error_m: None,
                touched: None,
            }
        })
        .collect();
    let unreachable = touches.iter().filter(|one| one.outcome != TouchOutcome::Waiting).count();
    let reachable = touches.len() - unreachable;
    let refusals = vec![("the arm is too short".to_owned(), unreachable)];
    let posture = connected().measured.expect("read");
    let plan = PlanView {
        options,
        reachable,
        refusals: refusals.into_iter().filter(|(_, count)| *count > 0).collect(),
        duration: Duration::from_secs(7 * reachable as u64),
        model: "".into(),
        score: Some(score()),
        postures: vec![Some(posture); touches.len()].into(),
    };
    TouchView {
        phase: TouchPhase::Planned,
        counts: TouchCounts { planned: touches.len(), unreachable, ..TouchCounts::default() },
        plan: Some(Arc::new(plan)),
        touches: touches.into(),
        ..idle()
    }
}

fn score() -> PlanScore {
    let effect = |title: &str, sigmas, doubt_left| EffectVisibility {
        id: "zero".to_owned(),
        site: "r_elbow_y".to_owned(),
        title: title.to_owned(),
        sigmas,
        doubt_left,
    };
    PlanScore {
        directions: 9,
        candidates: 31,
        seen: vec![
            effect("joint zero of the right elbow is off", 24.0, 0.2),
            effect("the screen lies elsewhere, forward", 18.0, 0.3),
            effect("the right shoulder gives way under load", 2.1, 0.9),
        ],
        alike: vec![vec![("zero".to_owned(), "a".to_owned()), ("zero".to_owned(), "b".to_owned())]],
        advice: vec![Advice {
            addition: Addition::RaisedScreen,
            sentence: "Touch 12 of the targets again with the screen on a block of 60 mm: 14 instead of 9 directions can be told apart.".to_owned(),
            directions_after: 14,
        }],
        condition: 120.0,
        information_bits: 96.0,
    }
}

/// A run after so many touches: one was missed, one skipped, one rejected.
pub fn after(count: usize, phase: TouchPhase) -> TouchView {
    let mut view = planned(PlanOptions::first(area()));
    let mut touches = view.touches.to_vec();
    let mut counts = view.counts;
    let pitch = screen().pitch_m();
    let waiting = touches.iter_mut().filter(|one| one.outcome == TouchOutcome::Waiting);
    for (i, one) in waiting.take(count).enumerate() {
        match i {
            4 => {
                one.outcome = TouchOutcome::Missed("the finger reached the floor of its range".to_owned());
                counts.missed += 1;
            }
            6 => {
                one.outcome = TouchOutcome::Skipped;
                counts.skipped += 1;
            }
            _ => {
                let phase = i as f64;
                let error = [0.004 + 0.0015 * (phase * 0.7).sin(), -0.003 + 0.0015 * (phase * 1.3).cos()];
                one.error_m = Some(error);
                one.touched = Some(Pixel::new(
                    one.target.u_px + error[0] / pitch[0],
                    one.target.v_px + error[1] / pitch[1],
                ));
                one.outcome = if i == 9 { TouchOutcome::Rejected } else { TouchOutcome::Touched };
                if i == 9 { counts.rejected += 1 } else { counts.touched += 1 }
            }
        }
    }
    view.touches = touches.into();
    view.counts = counts;
    view.figures = (counts.touched > 1).then_some(TouchFigures {
        count: counts.touched,
        mean_m: 0.005_12,
        mean_interval_m: [0.004_7, 0.005_5],
        largest_m: 0.008_3,
        bias_m: [0.004, -0.003],
        noise_m: Some(0.000_9),
        repeats: 20,
    });
    view.remaining = Some(Duration::from_secs(330));
    view.session = Some("touch-2026-03-02-1".into());
    view.step = StepState::Running;
    view.phase = phase;
    view
}

/// The number of the touch that comes next.
pub fn next_number(view: &TouchView) -> usize {
    view.touches.iter().find(|one| one.outcome == TouchOutcome::Waiting).expect("one is left").number
}

/// The arm goes down on a target.
pub fn running() -> TouchView {
    let view = after(30, TouchPhase::Finished);
    let number = next_number(&view);
    let contact = ContactView { pixel: Pixel::new(900.0, 500.0), number: 27, is_down: false };
    let phase =
        TouchPhase::Running { number: Some(number), doing: format!("settling above target {number}") };
    TouchView { phase, last_contact: Some(contact), ..view }
}

/// Where the screen lies, measured.
pub fn placement() -> ScreenPlacement {
    let motion = Isometry3::from_parts(
        Translation3::new(0.004, -0.002, 0.003),
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.02),
    );
    ScreenPlacement {
        screen: screen().moved(&motion),
        moved_m: [0.0042, -0.0021, 0.0031],
        turned_rad: [0.002, -0.004, 0.02],
        sd_m: [0.0005, 0.0004, 0.0003],
        sd_rad: [0.002, 0.002, 0.001],
        rms_m: 0.0017,
        touches: 8,
        residuals_m: Vec::new(),
        remarks: vec!["Touch 3 fits less well than the others.".to_owned()],
        at: Timestamp::now(),
        rig: "nico".to_owned(),
    }
}

/// A run of last time.
pub fn unfinished() -> UnfinishedRun {
    UnfinishedRun {
        session: "touch-2026-03-01-2".into(),
        started: Timestamp::now(),
        purpose: Purpose::Train,
        touched: 34,
        planned: 80,
    }
}
