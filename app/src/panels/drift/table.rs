//! How far places on the table come out from where they came out when watching began, as arrows.

use egui::Ui;
use plumbline_engine::view::{DriftCourse, TableRow};
use plumbline_widgets::overlay::Ink;
use plumbline_widgets::table_map::{Outline, Place, TableMap, TableMark, TableScene};
use plumbline_widgets::theme::{self, space};

use super::course::ROWS;
use super::nothing_yet;
use crate::panels::{PanelContext, padded};

/// The longest arrow is drawn this long, m on the table.
const LONGEST_M: f64 = 0.09;
/// Errors smaller than this are not blown up any further, m.
const LEAST_M: f64 = 0.002;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let Some(course) = &cx.view.drift.course else { return nothing_yet(ui, cx.view) };
    let scene = scene(cx, course);
    padded(ui, |ui| {
        let height = (ui.available_height() - 22.0).max(120.0);
        let words = |at_m: [f64; 2]| words(course, at_m);
        TableMap::new("Drift over the table", &scene).words(&words).height(height).show(ui);
        ui.add_space(space::XS);
        let times = scene.vector_scale;
        let scale = if times > 1.0 {
            format!("{times:.0} times as long as the error")
        } else {
            "in true length".to_owned()
        };
        ui.label(theme::small(ui, format!("Arrows {scale}.")));
    });
}

fn scene(cx: &PanelContext<'_>, course: &DriftCourse) -> TableScene {
    let all = || course.table.iter().flatten();
    let flat = |e: &nalgebra::Vector3<f64>| e.x.hypot(e.y);
    let most_m = all().map(|place| flat(&place.error_m)).fold(LEAST_M, f64::max);
    let mut outlines = Vec::new();
    if let Some(rig) = &cx.view.robot.rig {
        let patch = &rig.work_patch;
        outlines.push(Outline::rectangle(Place::Patch, "", patch.x_range_m, patch.y_range_m));
        let corners_m = rig.touchscreen.corners().map(|corner| [corner.coords.x, corner.coords.y]).to_vec();
        outlines.push(Outline { place: Place::Touchscreen, name: String::new(), corners_m });
    }
    let mark = |(row, place): (usize, &plumbline_engine::view::PlaceError)| TableMark {
        at_m: [place.at_m.x, place.at_m.y],
        vector_m: Some([place.error_m.x, place.error_m.y]),
        ink: Ink::Role(ROWS[row].1),
        text: String::new(),
    };
    let rows = course.table.iter().enumerate();
    let marks =
        rows.flat_map(|(row, places)| places.iter().map(move |place| (row, place))).map(mark).collect();
    TableScene { outlines, marks, vector_scale: (LONGEST_M / most_m).max(1.0).round(), ..TableScene::new() }
}

/// What the nearest of the places does.
fn words(course: &DriftCourse, at_m: [f64; 2]) -> String {
    let rows = TableRow::ALL.into_iter().zip(&course.table);
    let away =
        |place: &plumbline_engine::view::PlaceError| (place.at_m.x - at_m[0]).hypot(place.at_m.y - at_m[1]);
    let all = rows.flat_map(|(row, places)| places.iter().map(move |place| (row, place)));
    let nearest = all.min_by(|a, b| away(a.1).total_cmp(&away(b.1)));
    nearest.map_or_else(String::new, |(row, place)| {
        let [along, across] = [place.along_m, place.across_m].map(plumbline_widgets::format::mm);
        format!("{}: {along} along the line of sight, {across} across", row.name())
    })
}
