//! The legs of the way, and when each is behind.

use plumbline_engine::View;
use plumbline_engine::view::TouchPhase;
use plumbline_model::touch_plan::Purpose;

/// A part of the way.
pub struct Leg {
    /// What it is called in the table.
    pub name: &'static str,
    /// The step at the left that leads there, for who is not led there.
    pub rail: &'static str,
    /// Words of the button that is taken wherever it can be pressed, whatever else is recommended.
    pub takes: Option<&'static str>,
    /// Whether the operator chooses this step, and is not led to it.
    pub is_chosen: bool,
    /// Whether it is behind.
    pub is_behind: fn(&View) -> bool,
}

/// All legs, in the order of the way.
pub const LEGS: &[Leg] = &[
    led("Eyes", "Eyes", |view| view.eyes.in_use.is_some()),
    led("Mount", "Mount", |view| view.mount.in_use.is_some()),
    led("Screen", "Touch", |view| view.touch.placement.is_some()),
    led("Touches", "Touch", |view| is_touched(view, Purpose::Train)),
    Leg { takes: Some("Use M3"), ..led("Models", "Models", |view| view.models.in_use.is_some()) },
    led("Check", "Models", |view| is_touched(view, Purpose::Check) && view.touch.figures.is_some()),
    Leg {
        name: "Find",
        rail: "Gap",
        takes: None,
        is_chosen: true,
        is_behind: |view| view.gap.shown.is_some() && view.gap.searching.is_none(),
    },
    Leg { takes: Some(" to the model"), ..led("Add", "Gap", is_added) },
];

/// Some was added, or nothing that was found may be: then the search said so, and what to measure next.
fn is_added(view: &View) -> bool {
    let can_be = view.gap.shown.as_ref().is_some_and(|shown| !shown.finding.addable().is_empty());
    !view.gap.model.effects.is_empty() || !can_be
}

const fn led(name: &'static str, rail: &'static str, is_behind: fn(&View) -> bool) -> Leg {
    Leg { name, rail, takes: None, is_chosen: false, is_behind }
}

fn is_touched(view: &View, purpose: Purpose) -> bool {
    let planned = view.touch.plan.as_ref().map(|plan| plan.options.purpose);
    view.touch.phase == TouchPhase::Finished && planned == Some(purpose)
}
