//! Touching the screen: each state is drawn, and each button asks for what it says.

use std::sync::Arc;

use egui::{Event, Modifiers, PointerButton, Pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use plumbline::{PlumblineWindow, Screen, ThemeChoice, WindowSettings};
use plumbline_engine::view::{
    Connection, ContactSource, RobotView, TouchCounts, TouchOutcome, TouchPhase, TouchView, ToyView, TwinView,
};
use plumbline_engine::{Command, Destination, RobotCommand, ScreenWindow, TouchCommand, View};
use plumbline_model::frame::Point;
use plumbline_model::touch_plan::{Finger, Pattern, PlanOptions, Purpose, TouchArea};

use crate::fake::{Fake, click, says, shows};
use crate::made_up::{connected, with_robot};
use crate::made_up_touch::{
    after, area, idle, next_number, placement, planned, running, screen, unfinished, with_touch,
};

fn on_touch() -> WindowSettings {
    WindowSettings { screen: Screen::Touch, ..WindowSettings::default() }
}

fn window(view: View) -> (Fake, Harness<'static, PlumblineWindow>) {
    let fake = Fake::over(view);
    let window = fake.window(on_touch());
    (fake, window)
}

fn sent(fake: &Fake) -> Vec<TouchCommand> {
    let only = |command| if let Command::Touch(command) = command { Some(command) } else { None };
    fake.take_sent().into_iter().filter_map(only).collect()
}

/// Presses the one button of the bottom line.
fn press_next(window: &mut Harness<'_, PlumblineWindow>, label: &str) {
    let found: Vec<_> = window.get_all_by_label(label).collect();
    found.last().unwrap_or_else(|| panic!("nothing is called {label:?}")).click();
    window.run_steps(3);
}

fn first_plan() -> TouchView {
    planned(PlanOptions::first(area()))
}

fn paused() -> TouchView {
    after(34, TouchPhase::Paused { why: None })
}

#[test]
fn without_a_robot_it_says_what_to_connect() {
    let (_, window) = window(View::default());
    assert!(shows(&window, "No touchscreen is known"));
    assert!(says(&window, "No robot is connected"));
}

#[test]
fn one_button_leads_through_the_work() {
    let proposed =
        TouchView { placement_proposal: Some(Arc::new(placement())), ..after(8, TouchPhase::Finished) };
    let prepare = Some((0.03, 0.0));
    let what = "Raise the screen by 30 mm, then go on.".to_owned();
    let reachable = first_plan().plan.expect("planned").reachable;
    let resumed = paused();
    // Touches that are out of reach have numbers as well: those that were done do not count it.
    let next = next_number(&resumed);
    let done =
        resumed.counts.touched + resumed.counts.missed + resumed.counts.skipped + resumed.counts.rejected;
    assert!(next > done + 1);
    for (touch, button, wanted) in [
        (
            idle(),
            "Plan to touch the corners".to_owned(),
            TouchCommand::Plan(PlanOptions::place_screen(area())),
        ),
        (
            TouchView { placement: Some(Arc::new(placement())), screen: Some(screen()), ..idle() },
            "Plan a first calibration".to_owned(),
            TouchCommand::Plan(PlanOptions::first(area())),
        ),
        (
            TouchView { unfinished: Arc::from([unfinished()]), ..idle() },
            "Open the unfinished run".to_owned(),
            TouchCommand::Open { session: unfinished().session },
        ),
        (first_plan(), format!("Touch {reachable} targets"), TouchCommand::Start),
        (running(), "Pause".to_owned(), TouchCommand::Pause),
        (resumed, format!("Go on with touch {next}"), TouchCommand::Resume),
        (
            after(12, TouchPhase::Waiting { what, prepare }),
            "Done, go on".to_owned(),
            TouchCommand::Prepared { screen_height_m: 0.03, payload_kg: 0.0 },
        ),
        (proposed, "Use this place of the screen".to_owned(), TouchCommand::AcceptPlacement),
    ] {
        let (fake, mut window) = window(with_touch(touch));
        press_next(&mut window, &button);
        assert_eq!(sent(&fake), [wanted], "{button}");
    }
}

#[test]
fn a_finished_training_run_leads_to_the_models() {
    let (fake, mut window) = window(with_touch(after(200, TouchPhase::Finished)));
    assert!(says(&window, "Finished: ") && shows(&window, "Go to Models"));
    let corners = planned(PlanOptions::place_screen(area()));
    let placed = TouchView { phase: TouchPhase::Finished, ..corners };
    assert!(!shows(&self::window(with_touch(placed)).1, "Go to Models"), "they teach nothing");
    press_next(&mut window, "Train models");
    assert_eq!(sent(&fake), []);
    assert!(!says(&window, "Finished: "), "another screen is open");
}

#[test]
fn fewer_touches_than_models_need_lead_to_the_gap() {
    let (fake, mut window) = window(with_touch(after(14, TouchPhase::Finished)));
    assert!(says(&window, "fewer than the 20 that M2 and M3 need"));
    press_next(&mut window, "Go to Gap");
    assert_eq!(sent(&fake), []);
    // A run that ended before its first touch has nothing for the gap or the models.
    let (fake, mut window) = self::window(with_touch(after(0, TouchPhase::Finished)));
    assert!(says(&window, "No target was touched") && !shows(&window, "Go to Models"));
    press_next(&mut window, "Plan a first calibration");
    assert_eq!(sent(&fake).len(), 1);
}

#[test]
fn a_plan_says_that_the_table_of_the_twin_is_cleared() {
    let on_table = |place| {
        let toy = ToyView { name: "tomato".to_owned(), place, radius_m: 0.03, rgb: [200, 40, 30] };
        let twin = TwinView { running: true, toys: vec![toy], board: None, ..TwinView::default() };
        let connection = Connection::Connected { to: "lab".to_owned(), twin: true };
        let robot = Arc::new(RobotView { connection, ..connected() });
        window(View { twin: Arc::new(twin), robot, ..with_touch(first_plan()) }).1
    };
    let said = "What lies on the screen or near it makes room.";
    assert!(says(&on_table(Some(Point::new(0.4, 0.0, 0.1))), said));
    assert!(!says(&on_table(None), said), "nothing lies there");
}

#[test]
fn once_no_touch_is_left_nothing_is_to_be_paused() {
    let doing = "going home, away from the screen".to_owned();
    let (fake, mut window) = window(with_touch(after(200, TouchPhase::Running { number: None, doing })));
    assert!(says(&window, "No touch is left: going home"));
    click(&mut window, "Pause");
    assert_eq!(sent(&fake), []);
}

#[test]
fn touches_for_models_that_measured_the_screen_as_well_lead_to_the_models_first() {
    let proposal = Some(Arc::new(placement()));
    let finished = TouchView { placement_proposal: proposal.clone(), ..after(200, TouchPhase::Finished) };
    let placed = TouchView { placement: proposal, ..finished.clone() };
    let (fake, mut window) = window(with_touch(placed));
    assert!(says(&window, "Next: train models on them."));
    press_next(&mut window, "Train models");
    assert_eq!(sent(&fake), []);
    // Where nobody knows where the screen lies, that goes first.
    let (fake, mut window) = self::window(with_touch(finished));
    press_next(&mut window, "Use this place of the screen");
    assert_eq!(sent(&fake), [TouchCommand::AcceptPlacement]);
}

#[test]
fn what_moves_is_said_before_it_moves() {
    let (_, window) = window(with_touch(first_plan()));
    assert!(says(&window, "The right arm touches the glass"));
    assert!(says(&window, "the head and the left arm stay"));
    assert!(says(&window, "left out: the arm is too short"), "why some are not touched");
    assert!(says(&window, "causes of misses it shows"), "what the plan will tell");
}

#[test]
fn presets_stay_where_the_arm_reaches() {
    let reach = TouchArea { u_px: [200.0, 1700.0], v_px: [450.0, 1040.0] };
    let (fake, mut window) = window(with_touch(TouchView { reach: [Some(reach), None], ..idle() }));
    press_next(&mut window, "Plan to touch the corners");
    let all = sent(&fake);
    let [TouchCommand::Plan(options)] = all.as_slice() else { panic!("planned: {all:?}") };
    assert!(options.area.corners().into_iter().all(|corner| reach.contains(corner)), "{:?}", options.area);
}

#[test]
fn the_left_finger_is_said_and_its_touches_lead_to_the_gap() {
    let left = |plan: PlanOptions| PlanOptions { finger: Finger::Left, ..plan };
    let reach = TouchArea { u_px: [200.0, 1200.0], v_px: [300.0, 900.0] };
    let touch = TouchView { reach: [Some(area()), Some(reach)], ..first_plan() };
    let (fake, mut window) = window(with_touch(touch));
    click(&mut window, "Left index finger");
    let all = sent(&fake);
    let [TouchCommand::Plan(options)] = all.as_slice() else { panic!("planned: {all:?}") };
    assert_eq!(options.finger, Finger::Left);
    assert!(options.area.corners().into_iter().all(|corner| reach.contains(corner)), "{:?}", options.area);

    let (_, window) = self::window(with_touch(planned(left(PlanOptions::quick(area())))));
    assert!(says(&window, "The left arm touches the glass") && says(&window, "the right arm stay"));
    let touched = planned(left(PlanOptions::quick(area())));
    let counts = TouchCounts { touched: 15, ..touched.counts };
    let done = TouchView { phase: TouchPhase::Finished, counts, ..touched };
    let (_, window) = self::window(with_touch(done));
    assert!(says(&window, "of the left finger") && shows(&window, "Go to Gap"));
    assert!(!shows(&window, "Train models") && !shows(&window, "Go to Models"));
}

#[test]
fn new_targets_of_a_check_are_others() {
    let checked = PlanOptions { seed: 9, ..PlanOptions::check_reach(area(), 6, 9) };
    let done = TouchView {
        phase: TouchPhase::Finished,
        placement: Some(Arc::new(placement())),
        ..planned(checked.clone())
    };
    let (fake, mut window) = window(with_touch(done));
    press_next(&mut window, "Plan new targets");
    let all = sent(&fake);
    let [TouchCommand::Plan(options)] = all.as_slice() else { panic!("planned: {all:?}") };
    assert_ne!(options.seed, checked.seed);
}

#[test]
fn two_corners_do_not_place_a_screen() {
    let mut touch = planned(PlanOptions::place_screen(area()));
    let mut touches = touch.touches.to_vec();
    for one in touches.iter_mut().filter(|one| one.target.v_px < 500.0) {
        one.outcome = TouchOutcome::Unreachable("too far".to_owned());
    }
    touch.touches = touches.into();
    let (fake, mut window) = window(with_touch(touch));
    assert!(says(&window, "three corners are needed"));
    window.key_press_modifiers(Modifiers::COMMAND, egui::Key::Enter);
    window.run_steps(2);
    assert!(!sent(&fake).contains(&TouchCommand::Start));
    // Touched all the same, and it could not be placed: it does not say that it was.
    let options = PlanOptions::place_screen(area());
    let failed = TouchView { phase: TouchPhase::Finished, ..planned(options) };
    let (_, window) = self::window(with_touch(failed));
    assert!(says(&window, "could not be placed"));
}

#[test]
fn nothing_starts_while_stop_is_latched() {
    let robot = plumbline_engine::view::RobotView { stopped: true, ..connected() };
    let view = View { touch: Arc::new(first_plan()), ..with_robot(robot) };
    let (fake, mut window) = window(view);
    assert!(says(&window, "Stopped: nothing moves"));
    window.key_press_modifiers(Modifiers::COMMAND, egui::Key::Enter);
    window.run_steps(2);
    assert_eq!(sent(&fake), []);
}

#[test]
fn while_it_runs_the_window_says_how_far_it_is_and_stop_is_there() {
    let (fake, mut window) = window(with_touch(running()));
    let number = next_number(&after(30, TouchPhase::Finished));
    assert!(says(&window, &format!("settling above target {number}")));
    assert!(says(&window, "5:30 left"));
    assert!(says(&window, "5.12 ± 0.40 mm") && says(&window, "noise floor of repeats"));
    assert!(shows(&window, "STOP"));
    click(&mut window, "Skip");
    assert_eq!(sent(&fake), [TouchCommand::Skip]);
    // Finishing early is asked about once more.
    click(&mut window, "Finish");
    assert_eq!(sent(&fake), []);
    assert!(says(&window, "the session stays, and so does the arm"));
    click(&mut window, "Finish now");
    assert_eq!(sent(&fake), [TouchCommand::Finish]);
    window.key_press(egui::Key::Escape);
    window.run_steps(1);
    assert!(fake.take_stops() > 0, "Esc stops");
}

#[test]
fn a_hand_that_stays_at_the_screen_is_said_and_its_way_home_is_shown_first() {
    let near = TouchView { near_screen: Some("Right arm".to_owned()), ..after(34, TouchPhase::Finished) };
    let (fake, mut window) = window(with_touch(near));
    assert!(says(&window, "Right arm stays at the screen"));
    click(&mut window, "Show the way home");
    let home = Destination::Pose { name: "home".to_owned() };
    assert_eq!(fake.take_sent(), [Command::from(RobotCommand::Preview(home))]);
    assert!(shows(&window, "Poses"), "where it is shown and run");
    let (_, window) = self::window(with_touch(after(34, TouchPhase::Finished)));
    assert!(!shows(&window, "Show the way home"), "it went home");
}

#[test]
fn a_pause_says_why() {
    let why = Some("no contact three times in a row: look at the finger".to_owned());
    let (_, window) = window(with_touch(after(20, TouchPhase::Paused { why })));
    assert!(says(&window, "No contact three times in a row"));
}

#[test]
fn a_touch_is_chosen_on_the_map_and_rejected_restored_done_again() {
    let (fake, mut window) = window(with_touch(paused()));
    let labels = |window: &Harness<'_, PlumblineWindow>, text: &str| -> String {
        let node = window.query_all_by_label_contains(text).next().expect("on the map");
        egui_kittest::kittest::NodeT::accesskit_node(&node).label().expect("has a label")
    };
    let touched = labels(&window, "mm off");
    click(&mut window, &touched);
    let number: usize = touched
        .trim_start_matches("touch ")
        .split([':', ' '])
        .next()
        .and_then(|number| number.trim().parse().ok())
        .expect("begins with its number");
    click(&mut window, &format!("Reject touch {number}"));
    assert_eq!(sent(&fake), [TouchCommand::Reject { number }]);
    click(&mut window, &format!("Redo touch {number}"));
    assert_eq!(sent(&fake), [TouchCommand::Redo { number }]);
    let rejected = labels(&window, "does not count");
    click(&mut window, &rejected);
    let restore = labels(&window, "Restore touch");
    click(&mut window, &restore);
    assert!(matches!(sent(&fake).as_slice(), [TouchCommand::Restore { .. }]));
}

#[test]
fn changes_of_the_plan_are_planned_by_themselves() {
    let (fake, mut window) = window(with_touch(first_plan()));
    click(&mut window, "Check");
    assert_eq!(sent(&fake), [TouchCommand::Plan(PlanOptions::check_reach(area(), 20, 7))]);
    let (fake, mut window) = self::window(with_touch(first_plan()));
    click(&mut window, "Lines");
    let all = sent(&fake);
    let [TouchCommand::Plan(options)] = all.as_slice() else { panic!("planned once: {all:?}") };
    assert!(!options.patterns.iter().any(|pattern| matches!(pattern, Pattern::Lines { .. })));
    assert_eq!(options.purpose, Purpose::Train);
}

#[test]
fn the_area_is_dragged_on_the_drawing_of_the_screen() {
    let (fake, mut window) = window(with_touch(first_plan()));
    let map = window.get_by_label("Touches on the screen").rect();
    // From the middle of the area by a fifth of its width to the right and a little down: it
    // would leave the screen and stays on it.
    let from = map.center();
    let to = from + egui::vec2(0.2 * map.width(), 4.0);
    drag(&mut window, from, to);
    let all = sent(&fake);
    let [TouchCommand::Plan(options)] = all.as_slice() else { panic!("planned once: {all:?}") };
    let TouchArea { u_px, .. } = options.area;
    assert_eq!(u_px[1], f64::from(screen().width_px - 1));
    assert!((u_px[1] - u_px[0] - (area().u_px[1] - area().u_px[0])).abs() <= 1.0, "keeps its size");
}

fn drag(window: &mut Harness<'_, PlumblineWindow>, from: Pos2, to: Pos2) {
    let button = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    window.event(Event::PointerMoved(from));
    window.run_steps(2);
    window.event(button(from, true));
    window.run_steps(2);
    for part in 1..=4 {
        window.event(Event::PointerMoved(from + (to - from) * (part as f32 / 4.0)));
        window.run_steps(1);
    }
    window.event(button(to, false));
    window.run_steps(3);
}

#[test]
fn the_place_of_the_screen_is_shown_with_its_uncertainty() {
    let touch = TouchView {
        placement_proposal: Some(Arc::new(placement())),
        placement: Some(Arc::new(placement())),
        ..after(8, TouchPhase::Finished)
    };
    let (fake, mut window) = window(with_touch(touch));
    click(&mut window, "Place of the screen");
    for words in ["4.20 ± 0.98", "1.15 ± 0.11", "Touch 3 fits less well"] {
        assert!(says(&window, words), "{words}");
    }
    assert_eq!(sent(&fake), []);
    click(&mut window, "Discard proposal");
    assert_eq!(sent(&fake), [TouchCommand::DiscardPlacement]);
    click(&mut window, "Use nominal");
    assert_eq!(sent(&fake), [TouchCommand::UseNominalPlacement]);
}

#[test]
fn a_place_that_training_touches_measured_along_the_way_does_not_stand_before_what_comes_next() {
    let along_the_way = |in_use| TouchView {
        placement_proposal: Some(Arc::new(placement())),
        placement: in_use,
        ..after(32, TouchPhase::Finished)
    };
    // A screen that was never placed is to be decided, whatever the touches were made for.
    let (_, window_of_new) = window(with_touch(along_the_way(None)));
    assert!(shows(&window_of_new, "Use this place") && !shows(&window_of_new, "Close the run"));
    let (fake, mut window) = window(with_touch(along_the_way(Some(Arc::new(placement())))));
    assert!(!shows(&window, "Use this place"));
    click(&mut window, "Close the run");
    assert_eq!(sent(&fake), [TouchCommand::Close]);
    click(&mut window, "Place of the screen");
    assert!(shows(&window, "Use this place"));
}

#[test]
fn a_real_touchscreen_needs_the_touch_window_first() {
    let touch = TouchView { source: ContactSource::Window, ..first_plan() };
    let (fake, mut window) = window(with_touch(touch.clone()));
    press_next(&mut window, "Open the touch window");
    let all = sent(&fake);
    let [TouchCommand::Window(Some(shown))] = all.as_slice() else { panic!("it is open: {all:?}") };
    assert!(!shown.full_screen && shown.width_px > 100);
    assert!(shows(&window, "Touch window"));
    click(&mut window, "Close touch window");
    assert_eq!(sent(&fake), [TouchCommand::Window(None)]);
    // Not full screen: nothing begins, and it says why.
    let shown = ScreenWindow { width_px: 960, height_px: 540, full_screen: false };
    let (fake, mut window) = self::window(with_touch(TouchView { window: Some(shown), ..touch }));
    assert!(says(&window, "press F11"));
    window.key_press_modifiers(Modifiers::COMMAND, egui::Key::Enter);
    window.run_steps(2);
    assert_eq!(sent(&fake), []);
}

/// Every state drawn into a PNG of `PLUMBLINE_WINDOW_PICTURES=<folder>`, with `--ignored pictures`.
#[test]
#[ignore = "draws pictures for people to look at"]
fn pictures_of_touching() {
    let folder = crate::fake::picture_folder();
    let what = "Raise the screen by 30 mm: put the block under it, then go on.".to_owned();
    let waiting = after(12, TouchPhase::Waiting { what, prepare: Some((0.03, 0.0)) });
    let doing = "going home, away from the screen".to_owned();
    let withdrawing = after(12, TouchPhase::Running { number: Some(next_number(&waiting)), doing });
    let back =
        "Put the screen back on the table and take the weight off the hand, then say that it is done; nothing moves any more."
            .to_owned();
    let putting_back = after(200, TouchPhase::Waiting { what: back, prepare: Some((0.0, 0.0)) });
    let why = "Right hand over the screen. Bring it home (Robot), then go on.".to_owned();
    let paused = after(12, TouchPhase::Paused { why: Some(why) });
    let placed = TouchView {
        placement_proposal: Some(Arc::new(placement())),
        placement: Some(Arc::new(placement())),
        ..after(200, TouchPhase::Finished)
    };
    for theme in [ThemeChoice::Dark, ThemeChoice::Light] {
        for (name, touch) in [
            ("idle", idle()),
            ("planned", first_plan()),
            ("running", running()),
            ("waiting", waiting.clone()),
            ("withdrawing", withdrawing.clone()),
            ("putting-back", putting_back.clone()),
            ("paused", paused.clone()),
            ("finished", placed.clone()),
        ] {
            let fake = Fake::over(with_touch(touch));
            let settings = WindowSettings { theme, ..on_touch() };
            let mut window = fake.window_with(settings, [1280.0, 800.0], true);
            window.run_steps(2);
            let image = window.render().expect("the test renderer draws");
            let file = format!("touch {name} {theme:?}.png").to_lowercase().replace(' ', "-");
            image.save(folder.join(file)).expect("the folder can be written");
        }
    }
}
