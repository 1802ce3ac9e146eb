//! Views of the gap that no engine made, one per state.

use std::path::PathBuf;
use std::sync::Arc;

use plumbline_engine::gap::{Finding, ShownUnit, sample};
use plumbline_engine::view::{
    AddedEffect, FindingEntry, GapModelView, GapSession, GapView, JobState, JobView, ModelStep, ShownFinding,
    StepState, TouchFigures, TouchPhase, TouchView,
};
use plumbline_engine::{JobId, View};
use plumbline_model::touch_plan::PlanOptions;

use crate::made_up::{everything, rig};
use crate::made_up_touch;

/// The view of one state of the gap.
pub fn with(gap: GapView) -> View {
    View { gap: Arc::new(gap), ..everything() }
}

fn session(name: &str, started: &str, touches: usize) -> GapSession {
    GapSession {
        folder: PathBuf::from("sessions").join(name),
        name: name.to_owned(),
        started: started.parse().ok(),
        is_check: name.ends_with("_check"),
        touches,
        poses: 0,
        localizations: 0,
        problem: None,
    }
}

/// Sessions wait, the newest is chosen.
pub fn recorded() -> GapView {
    let mut broken = session("2026-09-11T09-00-00_touch", "2026-09-11T09:00:00Z", 0);
    broken.problem = Some("Nothing was measured.".to_owned());
    let sessions = vec![
        session("2026-09-14T10-20-00_touch", "2026-09-14T10:20:00Z", 245),
        session("2026-09-12T15-05-00_touch", "2026-09-12T15:05:00Z", 80),
        broken,
    ];
    GapView {
        chosen: Arc::from([sessions[0].folder.clone()]),
        sessions: sessions.into(),
        model: GapModelView { name: "nominal".to_owned(), ..GapModelView::default() },
        rig: Some(rig()),
        ..GapView::default()
    }
}

/// Nothing was ever touched.
pub fn nothing() -> GapView {
    GapView {
        model: GapModelView { name: "nominal".to_owned(), ..GapModelView::default() },
        rig: Some(rig()),
        ..GapView::default()
    }
}

/// The search is under way.
pub fn searching() -> View {
    let job = JobView {
        id: JobId(7),
        title: "Find what is missing: 2026-09-14T10-20-00_touch".to_owned(),
        state: JobState::Running {
            fraction: 0.42,
            doing: "held-out fold 3 of 5".to_owned(),
            remaining: None,
            cancelling: false,
        },
        elapsed: std::time::Duration::from_secs(3),
        by_itself: false,
    };
    let gap = GapView { searching: Some(JobId(7)), step: StepState::Running, ..recorded() };
    View { jobs: Arc::from([job]), ..with(gap) }
}

/// It could not be done.
pub fn failed() -> GapView {
    let why = "7 rows are too few to find anything: measure at least 12.";
    GapView { failed: Some(why.to_owned()), ..recorded() }
}

fn entry(finding: &Finding, id: &str, model: &str) -> FindingEntry {
    let shown = &finding.shown;
    FindingEntry {
        id: id.to_owned(),
        made: "2026-09-14T11:02:00Z".parse().expect("a time"),
        model: model.to_owned(),
        sessions: finding.sessions.clone(),
        verdict: finding.verdict,
        named: finding.effects.iter().map(|effect| effect.title.clone()).collect(),
        errors: [shown.before, shown.after, shown.floor],
        in_pixels: shown.unit == ShownUnit::Pixel,
    }
}

fn shown(finding: Finding, id: &str, model: &str) -> Arc<ShownFinding> {
    Arc::new(ShownFinding {
        entry: entry(&finding, id, model),
        folders: recorded().chosen.to_vec(),
        added: vec![false; finding.effects.len()],
        left_out: vec![],
        finding,
    })
}

/// A finding of the chosen session.
pub fn found(finding: Finding) -> GapView {
    let shown = shown(finding, "2026-09-14T11-02-00Z", "nominal");
    GapView {
        step: StepState::Done,
        findings: Arc::from([shown.entry.clone()]),
        shown: Some(shown),
        ..recorded()
    }
}

/// A finding of which the operator left effects out.
pub fn found_without(finding: Finding, left_out: Vec<usize>) -> GapView {
    let view = found(finding);
    let shown = view.shown.as_deref().map(|shown| Arc::new(ShownFinding { left_out, ..shown.clone() }));
    GapView { shown, ..view }
}

/// A finding of a session that changed since.
pub fn stale() -> GapView {
    let why =
        "2026-09-14T10-20-00_touch changed or is gone since this was found. Find what is missing again.";
    let step = StepState::Stale { why: why.to_owned() };
    GapView { stale: Some(why.to_owned()), step, ..found(sample::named()) }
}

/// The effects of the finding are in the model, and the gap was looked for again.
pub fn added() -> GapView {
    let finding = sample::named();
    let effects = finding.effects.iter().map(|effect| AddedEffect {
        is_named: true,
        name: format!("{}@{}", effect.id, effect.site),
        title: effect.title.clone(),
        parameters: effect.parameters.iter().map(|p| (p.name.clone(), p.value, [p.low, p.high])).collect(),
        is_of_eyes: false,
        is_left_out: false,
        moved_m: Some(effect.size_m),
    });
    let step = |title: &str, at: &str, errors| ModelStep {
        at: at.parse().expect("a time"),
        title: title.to_owned(),
        undone: false,
        errors: Some(errors),
        in_pixels: false,
        is_rms: false,
        sessions: finding.sessions.clone(),
    };
    let model = GapModelView {
        name: "nominal + 2 effects".to_owned(),
        effects: effects.collect(),
        history: vec![
            step("Elbow: zero position off added", "2026-09-13T16:10:00Z", [6.71e-3, 4.32e-3, 3.02e-3]),
            step(
                "Shoulder, forward: bracket gives way under load added",
                "2026-09-14T11:04:00Z",
                [4.32e-3, 3.58e-3, 3.02e-3],
            ),
        ],
        can_undo: true,
        can_redo: false,
    };
    let before = shown(sample::named(), "2026-09-14T11-02-00Z", "nominal");
    let before = Arc::new(ShownFinding { added: vec![true; 2], ..(*before).clone() });
    let beside = shown(sample::no_gap(), "2026-09-14T11-06-00Z", "nominal + 2 effects");
    GapView {
        step: StepState::Done,
        findings: Arc::from([beside.entry.clone(), before.entry.clone()]),
        shown: Some(before),
        beside: Some(beside),
        model,
        ..recorded()
    }
}

/// New targets were touched with the effects of the model and without them: 6 mm beside, and so far with them.
pub fn proven(with_m: f64) -> View {
    let figures = |mean_m: f64| TouchFigures {
        count: 10,
        mean_m,
        mean_interval_m: [0.8 * mean_m, 1.2 * mean_m],
        largest_m: 2.0 * mean_m,
        bias_m: [0.0; 2],
        noise_m: None,
        repeats: 0,
    };
    let run = session("2026-09-14T12-00-00_touch", "2026-09-14T12:00:00Z", 20);
    let touch = TouchView {
        phase: TouchPhase::Finished,
        figures: Some(figures(with_m)),
        figures_described: Some(figures(0.006)),
        session: Some(run.folder.clone()),
        ..made_up_touch::planned(PlanOptions::prove(made_up_touch::area(), 10, 1))
    };
    let mut gap = added();
    gap.chosen = Arc::from([run.folder.clone()]);
    gap.sessions = std::iter::once(run).chain(gap.sessions.iter().cloned()).collect();
    View { touch: Arc::new(touch), ..with(gap) }
}
