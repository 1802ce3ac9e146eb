//! The page of the touchscreen.

use egui::{Sense, Ui, vec2};

use super::{GalleryState, sample};
use crate::theme::{self, space};
use crate::touch_pattern::{
    PatternArea, TargetLook, TouchMark, TouchMarkState, TouchPattern, error_scale, paint_felt, paint_target,
};

pub(super) fn pattern(ui: &mut Ui, state: &mut GalleryState) {
    let area = state.touch_area.unwrap_or(PatternArea { u_px: [240.0, 1680.0], v_px: [160.0, 1000.0] });
    let marks = marks();
    theme::group_heading(ui, "Planned: the area is dragged");
    let planned: Vec<TouchMark> = marks
        .iter()
        .map(|mark| {
            let reach = mark.target_px[0] > 400.0;
            let state = if reach { TouchMarkState::Planned } else { TouchMarkState::Unreachable };
            TouchMark { error_px: None, state, about: "to come".to_owned(), ..mark.clone() }
        })
        .collect();
    let shown = TouchPattern::new("Plan", [1920, 1080], 1.0, &planned)
        .area(Some(area))
        .editable(true)
        .height(250.0)
        .show(ui);
    if let Some(area) = shown.area {
        state.touch_area = Some(area);
    }
    ui.add_space(space::M);
    theme::group_heading(ui, "Under way");
    let errors = marks.iter().filter_map(|mark| mark.error_px).map(|[u, v]| u.hypot(v));
    let scale = error_scale(errors, 150.0);
    let shown = TouchPattern::new("Touches", [1920, 1080], 1.0, &marks)
        .area(Some(area))
        .selected(state.touch)
        .error_scale(scale)
        .height(300.0)
        .show(ui);
    if let Some(number) = shown.clicked {
        state.touch = Some(number);
        state.last = format!("touch {number}");
    }
    ui.add_space(space::M);
    theme::group_heading(ui, "On the glass");
    let (rect, _) = ui.allocate_exact_size(vec2(480.0, 120.0), Sense::hover());
    ui.painter().rect_filled(rect, 0.0, egui::Color32::BLACK);
    for (i, look) in [TargetLook::Done, TargetLook::Waits, TargetLook::Now].into_iter().enumerate() {
        let at = rect.left_center() + vec2(80.0 + 140.0 * i as f32, 0.0);
        paint_target(ui.painter(), at, 20.0, look);
    }
    paint_felt(ui.painter(), rect.left_center() + vec2(368.0, 6.0), 20.0, true);
}

fn marks() -> Vec<TouchMark> {
    (0..28usize)
        .map(|i| {
            let (column, row) = (i % 7, i / 7);
            let target_px = [240.0 + 240.0 * column as f64, 160.0 + 280.0 * row as f64];
            let state = match i {
                0..15 if i % 7 == 3 => TouchMarkState::Rejected,
                5 => TouchMarkState::Missed,
                9 => TouchMarkState::Skipped,
                0..15 => TouchMarkState::Touched,
                15 => TouchMarkState::Next,
                21 => TouchMarkState::Unreachable,
                _ => TouchMarkState::Planned,
            };
            let felt = matches!(state, TouchMarkState::Touched | TouchMarkState::Rejected);
            let error_px = felt.then(|| [14.0 + 9.0 * sample::noise(i), -8.0 + 9.0 * sample::noise(i + 50)]);
            TouchMark {
                number: i + 1,
                target_px,
                error_px,
                state,
                about: format!("{state:?}").to_lowercase(),
            }
        })
        .collect()
}
