//! The gap: every state is drawn, with one button named by what it does, and every button asks for
//! what it says.

use std::sync::Arc;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use plumbline::{PlumblineWindow, Screen, ThemeChoice, WindowSettings};
use plumbline_engine::gap::sample;
use plumbline_engine::{Command, Correction, GapCommand, GapModel, TouchCommand, View};
use plumbline_model::touch_plan::Purpose;

use crate::fake::{Fake, click, click_at, says, shows};
use crate::made_up_gap::{
    added, failed, found, found_without, nothing, proven, recorded, searching, stale, with,
};

fn on_gap() -> WindowSettings {
    WindowSettings { screen: Screen::Gap, ..WindowSettings::default() }
}

const TALL: [f32; 2] = [1440.0, 1700.0];

fn asked(fake: &Fake) -> Vec<GapCommand> {
    let only = |command| if let Command::Gap(command) = command { Some(command) } else { None };
    fake.take_sent().into_iter().filter_map(only).collect()
}

fn window_of(view: View) -> (Fake, Harness<'static, PlumblineWindow>) {
    let fake = Fake::over(view);
    let window = fake.window_of_size(on_gap(), TALL);
    (fake, window)
}

/// Presses the one button of the step, which has this label, from the keyboard.
fn press_next(window: &mut Harness<'_, PlumblineWindow>, label: &str) {
    assert!(shows(window, label), "nothing is called {label:?}");
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Enter);
    window.run_steps(3);
}

#[test]
fn without_sessions_it_leads_to_touching() {
    let (_, mut window) = window_of(with(nothing()));
    assert!(says(&window, "Touch the screen first (step 3)"));
    press_next(&mut window, "Go to Touch");
    assert!(shows(&window, "Plan"), "the tiles of Touch are open");
}

#[test]
fn what_was_touched_is_compared_by_one_button() {
    let (fake, mut window) = window_of(with(recorded()));
    press_next(&mut window, "Find what is missing");
    assert_eq!(asked(&fake), [GapCommand::Find { seed: 1 }]);
}

#[test]
fn sessions_are_chosen_together_and_with_a_model() {
    let view = recorded();
    let (fake, mut window) = window_of(with(view.clone()));
    click(&mut window, "Compare 2026-09-12T15-05-00_touch");
    let both = vec![view.sessions[0].folder.clone(), view.sessions[1].folder.clone()];
    assert_eq!(asked(&fake), [GapCommand::Choose { sessions: both }]);
    click(&mut window, "Nominal");
    assert_eq!(asked(&fake), [GapCommand::CompareWith(GapModel::Nominal)]);
}

#[test]
fn a_chosen_session_that_cannot_be_used_can_be_taken_out() {
    let mut view = recorded();
    let broken = &view.sessions[2];
    assert!(broken.problem.is_some());
    let name = broken.name.clone();
    // From elsewhere, where it was good once.
    view.chosen = Arc::from([view.sessions[0].folder.clone(), broken.folder.clone()]);
    let (fake, mut window) = window_of(with(view.clone()));
    click(&mut window, &format!("Compare {name}"));
    let rest = vec![view.sessions[0].folder.clone()];
    assert_eq!(asked(&fake), [GapCommand::Choose { sessions: rest }]);
    // One that is not chosen is not to be.
    view.chosen = Arc::from([view.sessions[0].folder.clone()]);
    let (fake, mut window) = window_of(with(view));
    click(&mut window, &format!("Compare {name}"));
    assert_eq!(asked(&fake), []);
}

#[test]
fn a_search_under_way_says_how_far_it_is() {
    let (_, mut window) = window_of(searching());
    click(&mut window, "Name and add");
    assert!(says(&window, "held-out fold 3 of 5"));
    assert!(!shows(&window, "Find what is missing"), "one search at a time");
}

#[test]
fn a_search_that_failed_says_why_and_can_be_tried_again() {
    let (fake, mut window) = window_of(with(failed()));
    assert!(says(&window, "7 rows are too few"));
    click(&mut window, "Try again");
    assert_eq!(asked(&fake), [GapCommand::Find { seed: 1 }]);
}

#[test]
fn named_effects_are_sized_and_added() {
    let (fake, mut window) = window_of(with(found(sample::named())));
    click(&mut window, "Name and add");
    assert!(says(&window, "1.78°") && says(&window, "1.60 to 1.95°"));
    assert!(says(&window, "Elbow: zero position off: 97 %"));
    press_next(&mut window, "Add 2 effects to the model");
    assert_eq!(asked(&fake), [GapCommand::Add { effects: vec![0, 1] }]);
}

#[test]
fn what_an_effect_does_to_image_points_is_in_pixels() {
    let (_, mut window) = window_of(with(found(sample::pixels())));
    click(&mut window, "Name and add");
    assert!(says(&window, "1.90 px") && !says(&window, "1900"));
}

#[test]
fn an_effect_can_be_left_out() {
    let (fake, mut window) = window_of(with(found(sample::named())));
    click(&mut window, "Name and add");
    click(&mut window, "Shoulder, forward: bracket gives way under load");
    assert_eq!(asked(&fake), [GapCommand::LeaveOut { effect: 1, is_left_out: true }]);
    fake.show(with(found_without(sample::named(), vec![1])));
    window.run_steps(3);
    // The big button adds what is ticked, too.
    press_next(&mut window, "Add joint zero of the elbow to the model");
    assert_eq!(asked(&fake), [GapCommand::Add { effects: vec![0] }]);
    fake.show(with(found_without(sample::named(), vec![0, 1])));
    window.run_steps(3);
    assert!(!says(&window, " to the model"), "nothing is ticked");
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Enter);
    window.run_steps(3);
    assert!(!asked(&fake).iter().any(|command| matches!(command, GapCommand::Add { .. })));
}

/// While the big button asks for an experiment, adding is in sight above it.
#[test]
fn what_is_one_of_several_names_can_be_added_without_scrolling() {
    for size in [[1024.0, 700.0], [1440.0, 900.0]] {
        let fake = Fake::over(with(found(sample::class())));
        let mut window = fake.window_of_size(on_gap(), size);
        click(&mut window, "Name and add");
        let add: Vec<_> = window.query_all_by_label_contains(" to the model").collect();
        let [add] = add.as_slice() else { panic!("{} buttons to add at {size:?}", add.len()) };
        let (rect, [width, height]) = (add.rect(), size);
        let tile = egui::Rect::from_min_max(egui::pos2(150.0, 100.0), egui::pos2(width, height - 55.0));
        assert!(tile.contains_rect(rect), "{rect:?} at {size:?}");
        // The pointer takes it: nothing lies on it.
        click_at(&mut window, rect.center());
        assert_eq!(asked(&fake), [GapCommand::Add { effects: vec![0] }], "at {size:?}");
    }
}

#[test]
fn what_cannot_be_told_apart_is_listed_with_what_tells_it_apart() {
    let (_, mut window) = window_of(with(found(sample::class())));
    click(&mut window, "Name and add");
    assert!(says(&window, "Found, but not one name"));
    assert!(says(&window, "One of 2 names that these data cannot tell apart"));
    assert!(says(&window, "To tell them apart: repeat ten poses with a 250 g weight"));
    click(&mut window, "Next experiment");
    assert!(says(&window, "A bracket gives way more under the weight"));
}

#[test]
fn what_is_not_in_the_library_has_no_name_and_cannot_be_added() {
    let (_, mut window) = window_of(with(found(sample::not_in_library())));
    click(&mut window, "Name and add");
    assert!(says(&window, "Not one of the known effects"));
    assert!(says(&window, "it is not a name, and it cannot be added"));
    assert!(!says(&window, "to the model"), "there is nothing to add");
}

#[test]
fn no_gap_is_said_and_nothing_is_to_be_done() {
    let (_, mut window) = window_of(with(found(sample::no_gap())));
    assert!(says(&window, "No: model and measurement agree within the noise."));
    click(&mut window, "Name and add");
    assert!(shows(&window, "No gap"));
}

#[test]
fn without_a_known_noise_nothing_is_all_clear() {
    let mut finding = sample::no_gap();
    finding.comparison.floor_from_repeats = false;
    finding.comparison.floor_source = serde_json::from_str("\"fitted\"").expect("a source of the noise");
    finding.comparison.is_gap = true;
    let (_, mut window) = window_of(with(found(finding)));
    assert!(says(&window, "the noise is not known, and nothing in the library explains what is left"));
    assert!(!says(&window, "differ by more than the noise") && !says(&window, "near neighbors"));
    click(&mut window, "Name and add");
    assert!(shows(&window, "Not told from noise") && !shows(&window, "No gap"));
    assert!(!says(&window, "Nothing has to be added"));
}

#[test]
fn many_effects_and_warnings_are_counted_beside_the_first_three() {
    let (_, mut window) = window_of(with(found(sample::crowded())));
    click(&mut window, "Name and add");
    assert!(says(&window, "Residuals are 1000 times too large"), "warnings stand beside the verdict");
    assert!(says(&window, "1 more warning under Compare."));
    assert!(says(&window, "axis not square 2, class") && !says(&window, "axis not square 3, class"));
    assert!(shows(&window, "4 more"));
}

#[test]
fn values_that_may_be_zero_are_counted_and_not_listed() {
    let mut finding = sample::named();
    let mut other = finding.effects[0].parameters[0].clone();
    (other.value, other.low, other.high) = (0.0123, -0.01, 0.0346);
    finding.effects[0].parameters.push(other);
    let (_, mut window) = window_of(with(found(finding)));
    click(&mut window, "Name and add");
    assert!(says(&window, "1.78°") && says(&window, "One more value is not told from zero."));
    assert!(!says(&window, "0.70°"));
}

#[test]
fn a_rest_that_held_out_rows_do_not_confirm_is_no_noise() {
    let mut finding = sample::named();
    finding.shown.after = 2.0 * finding.shown.floor;
    let (_, mut window) = window_of(with(found(finding)));
    click(&mut window, "Name and add");
    assert!(says(&window, "Rows that were not used stay off by 5.96 mm"));
    assert!(!says(&window, "The rest is what noise alone would leave"));
}

#[test]
fn a_card_says_how_large_its_effect_is_in_the_model_now_where_later_looks_changed_it() {
    let same = added();
    let (_, mut window) = window_of(with(same.clone()));
    click(&mut window, "Name and add");
    assert!(shows(&window, "in the model") && !says(&window, "by what was measured since"));
    let mut model = same.model.clone();
    model.effects[0].parameters[0].1 *= 0.5;
    let (_, mut window) = window_of(with(plumbline_engine::view::GapView { model, ..same }));
    click(&mut window, "Name and add");
    assert!(says(&window, "in the model, by what was measured since: "));
}

#[test]
fn a_stale_finding_cannot_be_added() {
    let (fake, mut window) = window_of(with(stale()));
    assert!(says(&window, "changed or is gone since this was found"));
    click(&mut window, "Name and add");
    assert!(!says(&window, "effects to the model"));
    press_next(&mut window, "Find what is missing");
    assert_eq!(asked(&fake), [GapCommand::Find { seed: 1 }]);
}

#[test]
fn what_was_added_is_in_the_top_line_and_can_be_taken_back() {
    let (fake, mut window) = window_of(with(added()));
    assert!(says(&window, "nominal + 2 effects"));
    click(&mut window, "History");
    assert!(shows(&window, "Side by side"));
    // Beside the history, in the word that stands at the foot of every screen.
    window.get_all_by_label_contains("Undo: ").next().expect("a button").click();
    window.run_steps(3);
    assert_eq!(asked(&fake), [GapCommand::Undo]);
    click(&mut window, "Undo");
    assert_eq!(asked(&fake), [GapCommand::Undo]);
}

#[test]
fn after_adding_the_next_step_is_to_prove_it_by_touching_with_and_without_the_effects() {
    let (fake, mut window) = window_of(with(added()));
    click(&mut window, "Name and add");
    fake.take_sent();
    press_next(&mut window, "Prove it");
    let sent = fake.take_sent();
    let corrected = Command::Touch(TouchCommand::CorrectWith(Some(Correction::Effects)));
    assert_eq!(sent.first(), Some(&corrected), "{sent:?}");
    let Some(Command::Touch(TouchCommand::Plan(plan))) = sent.get(1) else { panic!("no plan: {sent:?}") };
    assert!(plan.beside_described && plan.purpose == Purpose::Check, "{plan:?}");
    assert!(shows(&window, "Targets corrected by"), "the plan is seen before the arm moves");
    // Without an effect there is nothing to prove.
    let (_, mut window) = window_of(with(nothing()));
    click(&mut window, "Name and add");
    assert!(!shows(&window, "Prove it"));
}

#[test]
fn without_a_robot_that_could_touch_the_next_step_is_to_find_what_is_left() {
    let (fake, mut window) = window_of(View { robot: Arc::default(), ..with(added()) });
    press_next(&mut window, "Find what is left");
    assert_eq!(asked(&fake), [GapCommand::Find { seed: 1 }]);
}

#[test]
fn what_the_touches_prove_is_the_headline() {
    let (fake, mut window) = window_of(proven(0.001_2));
    assert!(says(&window, "Proven: the effects take 80 % of the error away. 20 touches: 6.00 mm"));
    click(&mut window, "Name and add");
    assert!(shows(&window, "Proven: the effects take 80 % of the error away."));
    press_next(&mut window, "Find what is left");
    assert_eq!(asked(&fake), [GapCommand::Find { seed: 1 }]);
    let (_, window) = window_of(proven(0.005_5));
    assert!(says(&window, "cannot be told whether the effects help") && !says(&window, "Proven"));
}

#[test]
fn effects_that_touches_speak_against_are_taken_out_next() {
    let (fake, mut window) = window_of(proven(0.012));
    assert!(says(&window, "With the effects it misses by more"));
    press_next(&mut window, "Take all effects out");
    assert_eq!(asked(&fake), [GapCommand::UseNominal]);
}

#[test]
fn touches_of_before_the_model_was_changed_prove_nothing_of_it() {
    let mut view = proven(0.001_2);
    let gap = Arc::make_mut(&mut view.gap);
    let changed = gap.model.history.last_mut().expect("a step");
    changed.at = "2026-09-14T13:00:00Z".parse().expect("a time");
    let (_, window) = window_of(view);
    assert!(!says(&window, "Proven"));
}

#[test]
fn every_state_is_drawn_at_every_size_in_both_themes() {
    let states = [nothing(), recorded(), failed(), stale(), added()];
    let findings = [
        sample::named(),
        sample::class(),
        sample::much(),
        sample::not_in_library(),
        sample::no_gap(),
        sample::crowded(),
    ];
    let views = states.into_iter().chain(findings.into_iter().map(found)).map(with).chain([searching()]);
    for view in views {
        for theme in [ThemeChoice::Dark, ThemeChoice::Light] {
            for size in [[960.0, 600.0], [3840.0, 2160.0]] {
                let fake = Fake::over(view.clone());
                let window = fake.window_of_size(WindowSettings { theme, ..on_gap() }, size);
                assert!(shows(&window, "STOP"));
            }
        }
    }
}

/// Every state drawn into a PNG of `PLUMBLINE_WINDOW_PICTURES=<folder>`, with `--ignored pictures`.
#[test]
#[ignore = "draws pictures for people to look at"]
fn pictures_of_the_states() {
    let folder = crate::fake::picture_folder();
    let states = [
        ("recorded", with(recorded()), None),
        ("searching", searching(), Some("Name and add")),
        ("failed", with(failed()), Some("Name and add")),
        ("compare", with(found(sample::named())), None),
        ("named", with(found(sample::named())), Some("Name and add")),
        ("candidates", with(found(sample::named())), Some("Candidates")),
        ("class", with(found(sample::class())), Some("Name and add")),
        ("much", with(found(sample::much())), Some("Name and add")),
        ("not-in-library", with(found(sample::not_in_library())), Some("Name and add")),
        ("no-gap", with(found(sample::no_gap())), Some("Name and add")),
        ("crowded", with(found(sample::crowded())), Some("Name and add")),
        ("next", with(found(sample::class())), Some("Next experiment")),
        ("stale", with(stale()), Some("Name and add")),
        ("history", with(added()), Some("History")),
    ];
    for theme in [ThemeChoice::Dark, ThemeChoice::Light] {
        for (name, view, tab) in &states {
            let fake = Fake::over(view.clone());
            let mut window = fake.window_with(WindowSettings { theme, ..on_gap() }, [1440.0, 900.0], true);
            if let Some(tab) = tab {
                click(&mut window, tab);
            }
            window.run_steps(2);
            let image = window.render().expect("the test renderer draws");
            let file = format!("gap {name} {theme:?}.png").to_lowercase().replace(' ', "-");
            image.save(folder.join(file)).expect("the folder can be written");
        }
    }
}
