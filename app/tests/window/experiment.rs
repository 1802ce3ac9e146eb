//! The experiment with grasps: put together, asked for, judged.

use std::sync::Arc;

use egui_kittest::Harness;
use plumbline::{PlumblineWindow, Screen, ScriptStep, WindowSettings};
use plumbline_engine::trials as page;
use plumbline_engine::trials::{Experiment, FORMAT, Trial};
use plumbline_engine::view::{
    GraspMethod, GraspView, MethodView, ShownTrials, TrialStage, TrialsPhase, TrialsView,
};
use plumbline_engine::{Command, TrialsCommand, View};

use crate::fake::{Fake, click, says, shows};
use crate::made_up::{everything, rig};

fn shown(made: usize) -> ShownTrials {
    let experiment = Experiment {
        format: FORMAT,
        twin: "lab".to_owned(),
        methods: vec![GraspMethod::M5],
        attempts: 1,
        positions_m: vec![[0.3, -0.2], [0.3, 0.1]],
        hand: plumbline_engine::view::HandChoice::Auto,
        object: "Tomato".to_owned(),
        seed: 1,
        lab: None,
    };
    let position = page::PagePosition {
        at_m: [0.3, -0.2],
        successes: 1,
        attempts: 1,
        published: Some(0),
        hand_found: Some(true),
    };
    let method = page::PageMethod {
        name: "M5".to_owned(),
        cells: page::HEADINGS.iter().map(|_| "100 %".to_owned()).collect(),
        positions: vec![position],
    };
    let page = page::Page {
        title: "Grasps of the tomato".to_owned(),
        sentences: vec![],
        screen_m: rig().touchscreen.corners().map(|corner| [corner.coords.x, corner.coords.y]),
        area_m: [[0.27, 0.48], [-0.23, 0.23]],
        beyond_m: vec![[0.5, -0.4]],
        methods: vec![method],
        version: "0".to_owned(),
    };
    ShownTrials { folder: "/lab/experiments/one".into(), experiment, made, all: 2, page }
}

fn trial() -> Trial {
    Trial { number: 1, position: 1, attempt: 0, method: GraspMethod::M5 }
}

fn with(phase: TrialsPhase) -> View {
    let trials = TrialsView { shown: Some(Arc::new(shown(1))), phase, ..TrialsView::default() };
    View { trials: Arc::new(trials), ..everything() }
}

/// The grasp screen with the tile of the experiment in front.
fn window(fake: &Fake) -> Harness<'static, PlumblineWindow> {
    let settings = WindowSettings { screen: Screen::Grasp, ..WindowSettings::default() };
    let mut window = fake.window(settings);
    click(&mut window, "Experiment");
    fake.take_sent();
    window
}

#[test]
fn it_is_put_together_and_begun() {
    let methods = GraspMethod::ALL.map(|method| MethodView {
        method,
        about: "so",
        lacks: (method != GraspMethod::M5).then(|| "It needs touches.".to_owned()),
    });
    let grasp =
        GraspView { methods: Arc::from(methods), classes: Arc::from(["Tomato"]), ..GraspView::default() };
    let fake = Fake::over(View { grasp: Arc::new(grasp), ..everything() });
    let mut window = window(&fake);
    assert!(shows(&window, "Begin: 66 attempts"), "22 places, three times");
    click(&mut window, "3 places");
    click(&mut window, "Begin: 9 attempts");
    let sent = fake.take_sent();
    let [Command::Trials(TrialsCommand::Begin { methods, attempts, positions_m, object, .. })] = &sent[..]
    else {
        panic!("{sent:?}")
    };
    assert_eq!((&methods[..], *attempts, object.as_str()), (&[GraspMethod::M5][..], 3, "Tomato"));
    assert_eq!(positions_m.as_ref().map(Vec::len), Some(3));
}

#[test]
fn a_person_is_asked_to_lay_the_thing_down() {
    let fake = Fake::over(with(TrialsPhase::Asks { trial: trial(), at_m: [0.3, -0.2] }));
    let mut window = window(&fake);
    assert!(says(
        &window,
        "Put the tomato at (300, −200) mm: 300 mm ahead of the robot, 200 mm to its right."
    ));
    click(&mut window, "Placed");
    assert_eq!(fake.take_sent(), [Command::from(TrialsCommand::Placed)]);
}

#[test]
fn while_it_goes_on_it_says_how_far_it_is_and_can_be_held() {
    let doing = TrialStage::Grasping;
    let fake = Fake::over(with(TrialsPhase::Running { trial: trial(), doing, pausing: false }));
    let mut window = window(&fake);
    assert!(says(&window, "1 of 2 attempts") && says(&window, "M5, place 2 of 2: grasps"));
    assert!(shows(&window, "M5: lifted in 1 of 1 attempts"), "the map");
    click(&mut window, "Pause after this attempt");
    assert_eq!(fake.take_sent(), [Command::from(TrialsCommand::Pause)]);
}

#[test]
fn scripts_can_begin_one() {
    let step = r#"trials:{"begin":{"methods":["m5"],"attempts":1,"positions_m":[[0.3,-0.1]],"object":"tomato","seed":1}}"#;
    let step: ScriptStep = step.parse().expect("a step");
    assert!(matches!(step, ScriptStep::Send(Command::Trials(TrialsCommand::Begin { .. }))), "{step:?}");
}
