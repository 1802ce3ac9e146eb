//! Every screen at small and usual sizes: no text is cut at the side of what holds it, and no text lies on
//! another one. Read from what is painted, so that nobody has to look.

use egui::epaint::{ClippedShape, Shape, TextShape};
use egui::{Rect, Vec2};
use egui_kittest::kittest::Queryable as _;
use plumbline::{PlumblineWindow, Screen, ThemeChoice, WindowSettings};
use plumbline_engine::View;
use plumbline_engine::gap::{Finding, sample};

use crate::fake::{Fake, click};
use crate::{
    made_up, made_up_gap, made_up_labels, made_up_models, made_up_objects, made_up_touch, timeline, truth,
};

/// What letters may stand over, pt: overhanging letters and rounding.
pub(super) const SLACK: f32 = 2.0;

/// How high the bar of tabs is, pt.
const TAB_BAR: f32 = 32.0;

const SIZES: [[f32; 2]; 3] = [[1024.0, 700.0], [1280.0, 800.0], [1440.0, 900.0]];

/// A line of text as it is painted.
pub(super) struct Line {
    pub text: String,
    pub rect: Rect,
    pub clip: Rect,
    /// It ends with dots for want of room.
    pub is_elided: bool,
}

pub(super) fn lines(window: &egui_kittest::Harness<'static, PlumblineWindow>) -> Vec<Line> {
    let mut lines = Vec::new();
    for ClippedShape { clip_rect, shape, .. } in &window.output().shapes {
        collect(shape, *clip_rect, &mut lines);
    }
    lines
}

fn collect(shape: &Shape, clip: Rect, lines: &mut Vec<Line>) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect(shape, clip, lines)),
        Shape::Text(text) if text.angle == 0.0 => lines.extend(lines_of(text, clip)),
        _ => {}
    }
}

fn lines_of(text: &TextShape, clip: Rect) -> impl Iterator<Item = Line> {
    let rows = text.galley.rows.iter().map(move |row| Line {
        text: row.text(),
        rect: row.rect().translate(text.pos.to_vec2()),
        clip,
        is_elided: text.galley.elided,
    });
    rows.filter(|line| !line.text.trim().is_empty() && line.rect.intersects(line.clip))
}

/// What is scrolled away above or below is no fault; what ends at the side is. Of more tabs than there
/// is room for an arrow leads to the next.
pub(super) fn cut(lines: &[Line]) -> Vec<String> {
    let is_cut = |line: &&Line| {
        let is_tab = line.rect.bottom() <= line.clip.top() + TAB_BAR;
        if is_tab {
            return false;
        }
        line.rect.left() < line.clip.left() - SLACK || line.rect.right() > line.clip.right() + SLACK
    };
    lines
        .iter()
        .filter(is_cut)
        .map(|line| format!("cut: {:?} at {} by {}", line.text, line.rect, line.clip))
        .collect()
}

pub(super) fn overlapping(lines: &[Line]) -> Vec<String> {
    let visible: Vec<_> = lines.iter().map(|line| line.rect.intersect(line.clip)).collect();
    let mut faults = Vec::new();
    for (i, a) in visible.iter().enumerate() {
        for (j, b) in visible.iter().enumerate().skip(i + 1) {
            let common = a.intersect(*b).size();
            // Shadows and double strokes draw one text twice.
            let same =
                lines[i].text == lines[j].text && (lines[i].rect.min - lines[j].rect.min).length() < 3.0;
            if !same && common.min_elem() > 0.0 && Vec2::min_elem(common) > SLACK {
                faults.push(format!(
                    "over each other: {:?} at {a} and {:?} at {b}",
                    lines[i].text, lines[j].text
                ));
            }
        }
    }
    faults
}

/// In both themes.
fn faults(view: &View, screen: Screen, size: [f32; 2], zoom: f32) -> Vec<String> {
    let of = |theme| faults_of(view, screen, (size, zoom), theme);
    [ThemeChoice::Light, ThemeChoice::Dark].into_iter().flat_map(of).collect()
}

fn faults_of(view: &View, screen: Screen, (size, zoom): ([f32; 2], f32), theme: ThemeChoice) -> Vec<String> {
    let fake = Fake::over(view.clone());
    let settings = WindowSettings { theme, screen, zoom, ..WindowSettings::default() };
    let mut window = fake.window_of_size(settings, size);
    window.run_steps(4);
    let lines = lines(&window);
    assert!(lines.len() > 10, "{screen:?} draws texts");
    let mut faults = overlapping(&lines);
    // Its tables scroll sideways.
    if screen != Screen::Scores {
        faults.extend(cut(&lines));
    }
    faults.iter().map(|fault| format!("{screen:?} {theme:?} {size:?} {zoom}: {fault}")).collect()
}

#[test]
fn a_shape_in_many_words_stands_on_lines_of_its_own() {
    let mut finding = sample::class();
    let which = finding.effects[0].parameters.first_mut().expect("a parameter");
    which.name = "which".to_owned();
    which.text = Some("way that the joints yield while the finger presses".to_owned());
    let view = made_up_gap::with(made_up_gap::found(finding));
    assert_eq!(cut_on_tab(&view, "Name and add", SIZES[0]), Vec::<String>::new());
}

#[test]
fn numbers_of_the_board_stand_within_their_tile_and_a_long_sentence_on_two_lines() {
    let fake = Fake::over(made_up::everything());
    let settings =
        WindowSettings { theme: ThemeChoice::Light, screen: Screen::Collect, ..WindowSettings::default() };
    let mut window = fake.window_of_size(settings, [1024.0, 700.0]);
    window.run_steps(4);
    let next_tile = window.get_by_label("Coverage").rect().left();
    for number in ["Squares across", "Squares down", "Side of a square"] {
        let right = window.get_by_label(number).rect().right();
        assert!(right < next_tile - SLACK, "{number} ends at {right}, the next tile begins at {next_tile}");
    }
    // Too long for one line of the foot, and not cut there.
    let sentence = "The board has to lie where both eyes see it and stays there while the head turns, so lay it flat \
                    on the table, away from the hands, and press this button when nothing moves any more.";
    let robot = plumbline_engine::view::RobotView {
        connection: plumbline_engine::view::Connection::Lost {
            to: "twin".to_owned(),
            reason: sentence.to_owned(),
        },
        ..made_up::connected()
    };
    fake.show(made_up::with_robot(robot));
    let settings =
        WindowSettings { theme: ThemeChoice::Light, screen: Screen::Robot, ..WindowSettings::default() };
    let mut window = fake.window_of_size(settings, [1024.0, 700.0]);
    window.run_steps(4);
    let foot: Vec<_> = lines(&window).into_iter().filter(|line| line.rect.top() > 640.0).collect();
    let said: Vec<_> = foot.iter().filter(|line| sentence.contains(line.text.trim())).collect();
    assert_eq!(said.len(), 2, "on two lines");
    assert!(said.iter().all(|line| !line.is_elided && line.rect.bottom() < 700.0));
}

fn assert_none(all: &[String]) {
    assert!(all.is_empty(), "{} faults:\n{}", all.len(), all.join("\n"));
}

#[test]
fn no_text_is_cut_or_covered_on_any_screen() {
    let mut all = Vec::new();
    for view in [View::default(), made_up::everything()] {
        for screen in Screen::ALL {
            for size in SIZES {
                all.extend(faults(&view, screen, size, 1.0));
            }
            // As large again: the window of 1440 by 900 at 200 %.
            all.extend(faults(&view, screen, [720.0, 450.0], 2.0));
        }
    }
    assert_none(&all);
}

/// Screens that show much.
pub(super) fn much_to_show() -> [(Screen, View); 16] {
    [
        (Screen::Mount, View { mount: made_up::mount().into(), ..made_up::everything() }),
        (Screen::Touch, made_up_touch::with_touch(made_up_touch::running())),
        (Screen::Touch, made_up_touch::with_touch(made_up_touch::after(12, made_up_touch::running().phase))),
        (Screen::Models, made_up_models::with(made_up_models::recorded())),
        (Screen::Models, made_up_models::with(made_up_models::training())),
        (Screen::Models, made_up_models::with(made_up_models::trained())),
        (Screen::Models, made_up_models::with(made_up_models::in_use())),
        (Screen::Gap, made_up_gap::searching()),
        (Screen::Gap, made_up_gap::with(made_up_gap::failed())),
        (Screen::Gap, made_up_gap::with(made_up_gap::added())),
        (Screen::HandEye, made_up::with_hands_looked_at()),
        (Screen::Timeline, View { timeline: timeline::results().into(), ..made_up::everything() }),
        (Screen::Touch, View { truth: truth::truth().into(), ..made_up::everything() }),
        (Screen::Live, made_up_objects::live(made_up_objects::detect())),
        (Screen::Images, made_up_labels::labeling(made_up_labels::proposed())),
        (Screen::Scores, made_up_labels::judging(made_up_labels::judged())),
    ]
}

#[test]
fn no_text_is_cut_or_covered_where_there_is_much_to_show() {
    let mut all = Vec::new();
    for (screen, view) in much_to_show() {
        for size in SIZES {
            all.extend(faults(&view, screen, size, 1.0));
        }
    }
    assert_none(&all);
}

/// In a small window the tiles need what the inspector can spare: what stands in it never makes it wider, on no
/// screen, since it stays so on all that come after.
#[test]
fn nothing_makes_the_inspector_of_a_small_window_wider() {
    const MOST: f32 = 226.0;
    let all = Screen::ALL.map(|screen| (screen, made_up::everything()));
    let mut faults = Vec::new();
    for (screen, view) in all.into_iter().chain(much_to_show()) {
        let settings = WindowSettings { screen, ..WindowSettings::default() };
        let mut window = Fake::over(view).window_of_size(settings, [1024.0, 700.0]);
        window.run_steps(6);
        let width =
            1024.0 - window.get_all_by_label("Undo").map(|undo| undo.rect().left()).fold(0.0, f32::max);
        if width > MOST {
            let lines = lines(&window).into_iter().filter(|line| line.rect.left() > 1024.0 - width - SLACK);
            let widest = lines.max_by(|a, b| a.rect.right().total_cmp(&b.rect.right()));
            let widest = widest.map_or_else(String::new, |line| format!("{:?} at {}", line.text, line.rect));
            faults.push(format!("{screen:?}: {width} pt, {widest}"));
        }
    }
    assert_none(&faults);
}

/// What the usual laptop and a small one leave of the screen.
const LAPTOPS: [[f32; 2]; 2] = [[1280.0, 800.0], [1024.0, 700.0]];

/// The finding with the longest words and the widest numbers that an effect can have.
fn with_wide_values() -> Finding {
    let mut finding = sample::named();
    let effect = &mut finding.effects[0];
    effect.title =
        "Right shoulder swing: bracket gives way under load, the further the arm reaches".to_owned();
    let of = effect.parameters[0].clone();
    let names = ["rot_b_rad", "give_rad_per_nm", "bow_v_per_m", "time_constant_s"];
    effect.parameters = names.map(|_| of.clone()).to_vec();
    for (parameter, name) in effect.parameters.iter_mut().zip(names) {
        parameter.name = name.to_owned();
        (parameter.value, parameter.low, parameter.high) = (-0.0123, -0.0143, -0.0101);
    }
    effect.runner_up = Some(("joint-eccentricity@r_shoulder_y".to_owned(), 6.0));
    finding.warnings =
        vec!["there are too few repeats: the noise was estimated from near neighbors".to_owned()];
    finding
}

/// Everything on the screen of the gap with one of its tabs in front.
fn cut_on_tab(view: &View, tab: &str, size: [f32; 2]) -> Vec<String> {
    let settings =
        WindowSettings { theme: ThemeChoice::Light, screen: Screen::Gap, ..WindowSettings::default() };
    let mut window = Fake::over(view.clone()).window_of_size(settings, size);
    click(&mut window, tab);
    window.run_steps(2);
    let lines = lines(&window);
    assert!(lines.len() > 10, "{tab} draws texts");
    cut(&lines).iter().map(|fault| format!("{tab} {size:?}: {fault}")).collect()
}

#[test]
fn cards_of_effects_are_cut_nowhere() {
    let findings = [
        sample::named(),
        sample::class(),
        sample::not_in_library(),
        sample::crowded(),
        sample::pixels(),
        with_wide_values(),
    ];
    let found = findings.into_iter().map(|finding| made_up_gap::with(made_up_gap::found(finding)));
    let views = found.chain([made_up_gap::with(made_up_gap::added()), made_up_gap::proven(0.001_2)]);
    let mut all = Vec::new();
    for view in views {
        for size in LAPTOPS {
            all.extend(cut_on_tab(&view, "Name and add", size));
        }
    }
    assert_none(&all);
}

#[test]
fn two_findings_side_by_side_are_cut_nowhere() {
    let view = made_up_gap::with(made_up_gap::added());
    assert_none(&cut_on_tab(&view, "History", LAPTOPS[0]));
}
