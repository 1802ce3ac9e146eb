//! Where in a picture something is seen: a fisheye lens leaves the corners dark.

use egui::{Button, ColorImage, Rect, Ui, UiBuilder, WidgetInfo, vec2};

use super::ViewState;
use crate::theme;

/// So far apart the pixels lie that are looked at.
const EVERY_PX: usize = 8;
/// A pixel that is brighter than this in a color shows something.
const LIT: u8 = 24;
/// A row or column shows something where more of it than this is lit.
const LIT_SHARE: f64 = 0.03;

/// First and last column and row that show something; `None`: all is dark.
pub(super) fn part(image: &ColorImage) -> Option<[[f64; 2]; 2]> {
    let [width, height] = image.size;
    let is_lit = |column: usize, row: usize| {
        let pixel = image[(column, row)];
        pixel.r().max(pixel.g()).max(pixel.b()) > LIT
    };
    let columns = (0..width).step_by(EVERY_PX);
    let rows = (0..height).step_by(EVERY_PX);
    let shows = |lit: usize, of: usize| lit as f64 > LIT_SHARE * of as f64;
    let across = ends(columns.clone().filter(|&column| {
        shows(rows.clone().filter(|&row| is_lit(column, row)).count(), rows.clone().count())
    }))?;
    let down = ends(rows.clone().filter(|&row| {
        shows(columns.clone().filter(|&column| is_lit(column, row)).count(), columns.clone().count())
    }))?;
    let whole = |[first, last]: [usize; 2], n: usize| {
        [first.saturating_sub(EVERY_PX) as f64, (last + EVERY_PX).min(n.saturating_sub(1)) as f64]
    };
    Some([whole(across, width), whole(down, height)])
}

fn ends(lit: impl Iterator<Item = usize>) -> Option<[usize; 2]> {
    lit.fold(None, |ends, at| Some(ends.map_or([at, at], |[first, _]: [usize; 2]| [first, at])))
}

/// Where the button is.
pub(super) fn place(rect: Rect) -> Rect {
    Rect::from_min_max(rect.right_top() + vec2(-52.0, 6.0), rect.right_top() + vec2(-6.0, 26.0))
}

/// One click shows all, and one more only where something is seen.
pub(super) fn button(ui: &mut Ui, rect: Rect, label: &str, view: &mut ViewState, size_px: [usize; 2]) {
    let Some(part) = view.shows_part(size_px) else { return };
    let (text, about) = match part {
        true => ("All", "Shows the whole image, its dark borders too"),
        false => ("Fill", "Shows only where something is seen"),
    };
    let at = place(rect);
    let mut child = ui.new_child(UiBuilder::new().id_salt((label, "all")).max_rect(at));
    let small = theme::small(&child, text);
    let button = child.put(at, Button::new(small).min_size(at.size()));
    button.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, format!("{text} of {label}")));
    if button.on_hover_text(about).clicked() {
        view.show_whole(part);
    }
}

#[cfg(test)]
mod tests {
    use egui::{Color32, pos2};

    use super::*;
    use crate::image_view::ImageTransform;

    /// A bright disk in the middle of a dark image.
    fn disk() -> ColorImage {
        let mut image = ColorImage::filled([640, 480], Color32::from_gray(3));
        for row in 0..480 {
            for column in 0..640 {
                let away = (column as f64 - 320.0).hypot(row as f64 - 240.0);
                if away < 200.0 {
                    image[(column, row)] = Color32::from_gray(90);
                }
            }
        }
        image
    }

    #[test]
    fn the_disk_of_a_fisheye_fills_the_view_until_all_is_asked_for() {
        let [across, down] = part(&disk()).expect("a disk");
        assert!((across[0] - 120.0).abs() < 24.0 && (across[1] - 520.0).abs() < 24.0, "{across:?}");
        assert!((down[0] - 40.0).abs() < 24.0 && (down[1] - 440.0).abs() < 24.0, "{down:?}");
        let mut view = ViewState::default();
        let room = Rect::from_min_max(pos2(0.0, 0.0), pos2(300.0, 300.0));
        let whole = ImageTransform::fit([640, 480], room);
        view.see([640, 480], [across, down]);
        let filled = view.transform([640, 480], room);
        assert!(filled.points_per_px > 1.3 * whole.points_per_px);
        assert!((filled.to_screen([320.0, 240.0]) - room.center()).length() < 8.0);
        view.show_whole(true);
        assert_eq!(view.transform([640, 480], room), whole);
        assert_eq!(view.shows_part([640, 480]), Some(false));
    }

    #[test]
    fn an_image_that_is_lit_everywhere_and_one_that_is_dark_have_no_part() {
        assert_eq!(part(&ColorImage::filled([64, 48], Color32::BLACK)), None);
        let mut view = ViewState::default();
        view.see([64, 48], part(&ColorImage::filled([64, 48], Color32::WHITE)).expect("lit"));
        assert_eq!(view.shows_part([64, 48]), None);
    }
}
