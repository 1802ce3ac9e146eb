//! Things in the three-dimensional scene that can be grasped: pointed at there, they are chosen as in the eyes.

use egui::{CursorIcon, Pos2, Ui};
use nalgebra::Point3;
use plumbline_engine::view::{GraspPhase, ObjectView};
use plumbline_engine::{GraspCommand, GraspTarget, View};
use plumbline_widgets::scene3d::{self, Line, PickId, Picked, Scene, Scene3dResponse, Tint};

use crate::operator::Screen;
use crate::operator::words::grasp::{can_be_held, made_room};
use crate::panels::PanelContext;
use crate::panels::objects::found;
use crate::panels::objects::state::ObjectsPanels;

/// Pointed at from farther than this beside the circle in which it is drawn, a thing is not meant, points.
const NEAR: f32 = 6.0;
/// A dot is drawn for what is placed, of this radius, points.
const DOT: f32 = 3.5;
/// A body in front of a thing by more than this hides it, m.
const HIDES_M: f64 = 0.02;
/// What is detected this near to a toy of its class is that toy, m.
const SAME_M: f64 = 0.05;
/// The ring around a thing is so much larger than it, and around what is of no known size so large, m.
const RING_M: [f64; 2] = [0.012, 0.035];
const RING_CORNERS: u32 = 40;

/// A thing of the scene that a hand can hold.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneThing {
    /// Its class.
    class: String,
    /// Where it is drawn, robot frame, m.
    at_m: Point3<f64>,
    /// The size that it is drawn with; zero: a dot, m.
    radius_m: f64,
    /// Where it is looked for, over the table, m.
    near_m: [f64; 2],
}

impl SceneThing {
    fn target(&self) -> GraspTarget {
        GraspTarget { class: Some(self.class.clone()), near_m: Some(self.near_m) }
    }

    fn is_target(&self, target: &GraspTarget) -> bool {
        is_meant(target, &self.class, self.near_m)
    }
}

/// Whether a thing of this class that stands there is the one that was chosen.
fn is_meant(target: &GraspTarget, class: &str, [x_m, y_m]: [f64; 2]) -> bool {
    target.class.as_deref().is_some_and(|chosen| chosen.eq_ignore_ascii_case(class))
        && target.near_m.is_some_and(|at_m| (at_m[0] - x_m).hypot(at_m[1] - y_m) < SAME_M)
}

/// The object that is strong in the eyes: the one under the pointer, in an eye or in the scene, else the one that
/// was chosen.
pub fn focused<'a>(view: &'a View, panels: &ObjectsPanels) -> Option<&'a ObjectView> {
    let chosen = |object: &&ObjectView| {
        place_m(object).is_some_and(|at_m| is_meant(&view.grasp.target, &object.name, [at_m.x, at_m.y]))
    };
    panels.under_pointer(view).or_else(|| found(view).iter().find(chosen))
}

/// What can be held of all that is drawn: what the eyes place, and the toys of a twin.
fn things(view: &View) -> Vec<SceneThing> {
    let class_of = |name: &str| {
        let mut classes = view.grasp.classes.iter();
        classes.find(|class| class.eq_ignore_ascii_case(name)).map(|class| (*class).to_owned())
    };
    // What was seen from elsewhere is not drawn.
    let fresh = found(view).iter().filter(|_| view.detect.stale.is_none());
    let seen = fresh.filter_map(|object| {
        let (class, at_m) = (class_of(&object.name)?, place_m(object)?);
        Some(SceneThing { class, at_m, radius_m: 0.0, near_m: [at_m.x, at_m.y] })
    });
    let seen: Vec<SceneThing> = seen.collect();
    let out = view.twin.toys.iter().filter(|_| view.twin.running);
    let toys = out.filter_map(|toy| {
        let (class, at_m) = (class_of(&toy.name)?, toy.place?.coords);
        let mut thing = SceneThing { class, at_m, radius_m: toy.radius_m, near_m: [at_m.x, at_m.y] };
        // Where the eyes see it, they are believed.
        if let Some(seen) = seen.iter().find(|seen| seen.is_target(&thing.target())) {
            thing.near_m = seen.near_m;
        }
        Some(thing)
    });
    let toys: Vec<SceneThing> = toys.collect();
    seen.iter().cloned().chain(toys).collect()
}

/// What keeps a grasp without a thing: nothing is seen, or nothing that a hand can hold. `None`: there is one.
pub fn nothing_to_hold(view: &View) -> Option<String> {
    if !things(view).is_empty() {
        return None;
    }
    if let Some(away) = made_room(view) {
        return Some(away);
    }
    let (without_place, not_held) = seen(view);
    let listed = |names: &[&str]| plumbline_model::listed(names).to_lowercase();
    Some(match (without_place.is_empty(), not_held.is_empty()) {
        (false, _) => format!("Seen, but not where on the table: {}.", listed(&without_place)),
        (true, false) => format!(
            "The hands cannot hold: {}. They hold: {}.",
            listed(&not_held),
            listed(&view.grasp.classes)
        ),
        (true, true) => "Nothing to grasp is seen.".to_owned(),
    })
}

/// Names of what the eyes see now, hands apart: what can be held, and what cannot.
fn seen(view: &View) -> (Vec<&str>, Vec<&str>) {
    let mut seen: Vec<&str> = found(view).iter().map(|object| object.name.as_str()).collect();
    seen.retain(|name| !name.ends_with("Hand"));
    seen.sort_unstable();
    seen.dedup();
    seen.into_iter().partition(|name| can_be_held(view, name))
}

/// What is seen beside things that can be held, and is none of them.
pub fn seen_but_not_held(view: &View) -> Option<String> {
    let (_, not_held) = seen(view);
    (!not_held.is_empty() && !things(view).is_empty())
        .then(|| format!("These hands cannot hold: {}.", plumbline_model::listed(&not_held).to_lowercase()))
}

fn place_m(object: &ObjectView) -> Option<Point3<f64>> {
    object.best_place().ok().map(|place| place.point_in_robot.coords)
}

/// The thing in or beside whose circle the pointer is; of several the one whose middle is nearest to it. What is
/// behind something that `hides` cannot be meant.
fn at_pointer<'a>(
    things: &'a [SceneThing],
    mapping: &scene3d::View,
    picked: &Picked,
    hides: fn(PickId) -> bool,
) -> Option<&'a SceneThing> {
    let (pointer, _) = mapping.project(&(picked.ray.origin_m + picked.ray.direction))?;
    let depth_m = |at_m: Point3<f64>| mapping.forward.dot(&(at_m - mapping.eye_m));
    let body_m = picked.point_m.filter(|_| picked.pick.is_some_and(hides)).map(depth_m);
    let beside = |thing: &SceneThing| {
        let (middle, at_depth_m) = mapping.project(&thing.at_m)?;
        let hidden = body_m.is_some_and(|body_m| body_m < at_depth_m - thing.radius_m - HIDES_M);
        let off = off(pointer, middle, mapping.focal, thing.radius_m, at_depth_m);
        (!hidden && off <= NEAR).then(|| middle.distance(pointer))
    };
    let near = things.iter().filter_map(|thing| Some((beside(thing)?, thing)));
    near.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, thing)| thing)
}

/// How far a pointer is from the circle in which a ball is drawn, points; within it: zero.
fn off(pointer: Pos2, middle: Pos2, focal: f32, radius_m: f64, depth_m: f64) -> f32 {
    let radius = (f64::from(focal) * radius_m / depth_m) as f32;
    (middle.distance(pointer) - radius.max(DOT)).max(0.0)
}

/// Rings around what would be grasped, and around what is pointed at, here or in an eye.
pub fn mark(cx: &PanelContext<'_>, scene: &mut Scene) {
    if cx.screen != Screen::Grasp || scene.is_empty() {
        return;
    }
    let things = things(cx.view);
    let in_eye = cx.state.objects.under_pointer(cx.view).and_then(place_m);
    let pointed = |thing: &SceneThing| {
        cx.state.grasp.pointed.as_ref() == Some(&thing.target())
            || in_eye.is_some_and(|at_m| thing.near_m == [at_m.x, at_m.y])
    };
    // What is seen and what is drawn of a twin are one thing, with one ring.
    let mut ringed: Vec<GraspTarget> = vec![];
    for thing in things.iter().rev() {
        let is_target = thing.is_target(&cx.view.grasp.target);
        if (is_target || pointed(thing)) && !ringed.contains(&thing.target()) {
            let width = if pointed(thing) { 3.0 } else { 2.0 };
            scene.lines.push(ring(thing).width(width));
            ringed.push(thing.target());
        }
    }
}

fn ring(thing: &SceneThing) -> Line {
    let [around_m, unknown_m] = RING_M;
    let radius_m = if thing.radius_m > 0.0 { thing.radius_m + around_m } else { unknown_m };
    let corner = |i: u32| {
        let (sin, cos) = (f64::from(i) / f64::from(RING_CORNERS) * std::f64::consts::TAU).sin_cos();
        thing.at_m + nalgebra::Vector3::new(cos, sin, 0.0) * radius_m
    };
    Line::new((0..=RING_CORNERS).map(corner).collect(), Tint::Selected)
}

/// Says which thing the pointer is on, and chooses it where it was clicked. Whether a thing took the click: one
/// that ends a drag is none. `hides`: whether a part of the scene hides what is behind it.
pub fn point(ui: &Ui, cx: &mut PanelContext<'_>, shown: &Scene3dResponse, hides: fn(PickId) -> bool) -> bool {
    if cx.screen != Screen::Grasp || cx.view.grasp.phase != GraspPhase::Idle {
        cx.state.grasp.pointed = None;
        return false;
    }
    let things = things(cx.view);
    let mapping = cx.state.robot.camera.view(shown.response.rect.size());
    let at = |picked: Option<&Picked>| at_pointer(&things, &mapping, picked?, hides);
    let pointed = at(shown.hovered.as_ref());
    let target = pointed.map(SceneThing::target);
    if cx.state.grasp.pointed != target {
        // The ring is drawn with the next picture.
        ui.ctx().request_repaint();
    }
    if let Some(thing) = pointed {
        ui.ctx().set_cursor_icon(CursorIcon::PointingHand);
        shown.response.clone().on_hover_text_at_pointer(click_chooses(&thing.class));
        let is_it = |at_m: Point3<f64>| thing.near_m == [at_m.x, at_m.y];
        let seen = found(cx.view).iter().find(|object| place_m(object).is_some_and(is_it));
        if let Some(object) = seen {
            cx.state.objects.hover(object);
        }
    }
    cx.state.grasp.pointed = target;
    let clicked = at(shown.clicked.as_ref()).map(SceneThing::target);
    let took = clicked.is_some();
    if let Some(target) = clicked {
        cx.outbox.send(GraspCommand::Target(target));
    }
    took
}

/// What a click on a thing does, for who points at it.
pub fn click_chooses(class: &str) -> String {
    format!("Click: this {} is to be grasped", class.to_lowercase())
}

#[cfg(test)]
mod tests {
    use egui::vec2;
    use plumbline_widgets::scene3d::SceneCamera;

    use super::*;

    fn mapping() -> scene3d::View {
        SceneCamera::default().view(vec2(600.0, 400.0))
    }

    fn thing(class: &str, at_m: [f64; 3], radius_m: f64) -> SceneThing {
        SceneThing { class: class.to_owned(), at_m: at_m.into(), radius_m, near_m: [at_m[0], at_m[1]] }
    }

    /// A pointer that is so many points to the right of a place.
    fn beside(at_m: Point3<f64>, by: f32) -> Picked {
        let (place, _) = mapping().project(&at_m).expect("in view");
        Picked { pick: None, ray: mapping().ray(place + vec2(by, 0.0)), point_m: None }
    }

    fn meant(things: &[SceneThing], picked: &Picked) -> Option<String> {
        at_pointer(things, &mapping(), picked, |_| true).map(|thing| thing.class.clone())
    }

    #[test]
    fn a_pointer_in_its_circle_or_a_few_points_beside_it_means_a_thing() {
        let tomato = thing("Tomato", [0.35, -0.1, 0.08], 0.03);
        let (_, depth_m) = mapping().project(&tomato.at_m).expect("in view");
        let radius = mapping().focal * (0.03 / depth_m) as f32;
        let things = [tomato];
        for (by, is_meant) in
            [(0.0, true), (radius - 1.0, true), (radius + NEAR - 1.0, true), (radius + NEAR + 1.0, false)]
        {
            let meant = meant(&things, &beside(things[0].at_m, by));
            assert_eq!(meant.is_some(), is_meant, "{by} points beside the middle, radius {radius}");
        }
        // What is placed without a size is drawn as a dot.
        let seen = [thing("Duck", [0.35, -0.1, 0.08], 0.0)];
        assert!(meant(&seen, &beside(seen[0].at_m, DOT + NEAR - 1.0)).is_some());
        assert!(meant(&seen, &beside(seen[0].at_m, DOT + NEAR + 1.0)).is_none());
    }

    #[test]
    fn of_two_things_the_one_whose_middle_is_nearer_is_meant() {
        let things = [thing("Tomato", [0.35, -0.1, 0.08], 0.03), thing("Onion", [0.35, -0.06, 0.08], 0.03)];
        assert_eq!(meant(&things, &beside(things[0].at_m, 0.0)).as_deref(), Some("Tomato"));
        assert_eq!(meant(&things, &beside(things[1].at_m, 0.0)).as_deref(), Some("Onion"));
    }

    #[test]
    fn what_the_robot_hides_is_not_meant_and_what_stands_before_it_is() {
        let things = [thing("Tomato", [0.35, -0.1, 0.08], 0.03)];
        let straight = beside(things[0].at_m, 0.0);
        let at = |share: f64| {
            let to_thing = (things[0].at_m - straight.ray.origin_m).norm();
            Some(straight.ray.origin_m + straight.ray.direction * (share * to_thing))
        };
        let joint = Some(PickId(3));
        assert_eq!(meant(&things, &Picked { pick: joint, point_m: at(0.8), ..straight }), None);
        assert!(meant(&things, &Picked { pick: joint, point_m: at(1.2), ..straight }).is_some());
        // The table behind it, and its own surface, hide nothing.
        assert!(meant(&things, &Picked { pick: None, point_m: at(0.8), ..straight }).is_some());
    }

    #[test]
    fn the_ring_is_around_it() {
        let tomato = thing("Tomato", [0.35, -0.1, 0.08], 0.03);
        let ring = ring(&tomato);
        let around = ring.points_m.iter().all(|corner| ((corner - tomato.at_m).norm() - 0.042).abs() < 1e-9);
        assert!(around && ring.points_m.len() == 41, "{ring:?}");
    }
}
