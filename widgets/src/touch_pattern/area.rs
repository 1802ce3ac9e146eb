//! Dragging the area: its borders, all of it, or a new one.

use egui::{CursorIcon, Id, Pos2, Response, Ui};

use super::{PatternArea, PatternTransform};

/// A border is taken within this many points.
const BORDER_PT: f32 = 7.0;
/// Smaller than this each way is no area but a slip of the hand, px.
const LEAST_PX: f64 = 20.0;

/// What is held of the range along one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Hold {
    /// Its small end.
    Low,
    /// Its large end.
    High,
    /// All of it.
    Both,
    /// None of it.
    Neither,
}

/// A drag that has begun.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Drag {
    from_px: [f64; 2],
    area: PatternArea,
    /// Along u and v; `None`: a new area is drawn.
    holds: Option<[Hold; 2]>,
}

/// The area while it is dragged, and where it was let go.
pub(super) fn drag(
    ui: &Ui,
    response: &Response,
    transform: PatternTransform,
    area: PatternArea,
) -> Option<PatternArea> {
    let id: Id = response.id.with("drag");
    if let Some(at) = response.hover_pos() {
        cursor(ui, holds(transform, area, at));
    }
    if response.drag_started()
        && let Some(at) = ui.input(|input| input.pointer.press_origin())
    {
        let begun = Drag { from_px: transform.to_px(at), area, holds: holds(transform, area, at) };
        ui.data_mut(|data| data.insert_temp(id, begun));
    }
    let begun: Drag = ui.data(|data| data.get_temp(id))?;
    let at = response.interact_pointer_pos();
    let dragged = at.map(|at| begun.at(transform.to_px(at), transform.size_px));
    if response.drag_stopped() || !response.dragged() {
        ui.data_mut(|data| data.remove::<Drag>(id));
        return dragged.filter(|_| response.drag_stopped());
    }
    dragged
}

impl Drag {
    fn at(&self, at_px: [f64; 2], size_px: [f64; 2]) -> PatternArea {
        let [across, down] = self.holds.map_or([None; 2], |[u, v]| [Some(u), Some(v)]);
        PatternArea {
            u_px: along(across, self.area.u_px, self.from_px[0], at_px[0], size_px[0]),
            v_px: along(down, self.area.v_px, self.from_px[1], at_px[1], size_px[1]),
        }
    }
}

/// One axis after a drag: whole pixels of the screen, never turned around.
fn along(hold: Option<Hold>, range: [f64; 2], from: f64, to: f64, count: f64) -> [f64; 2] {
    let on_screen = |at: f64| at.round().clamp(0.0, count - 1.0);
    let [low, high] = range;
    let by = to - from;
    let [low, high] = match hold {
        None => [from.min(to), from.max(to)],
        Some(Hold::Low) => [(low + by).min(high - LEAST_PX), high],
        Some(Hold::High) => [low, (high + by).max(low + LEAST_PX)],
        Some(Hold::Both) => {
            let by = by.clamp(-low, count - 1.0 - high);
            [low + by, high + by]
        }
        Some(Hold::Neither) => [low, high],
    };
    let (low, high) = (on_screen(low), on_screen(high));
    if high - low >= LEAST_PX { [low, high] } else { range }
}

/// What a press here would take hold of.
fn holds(transform: PatternTransform, area: PatternArea, at: Pos2) -> Option<[Hold; 2]> {
    let first = transform.to_drawing([area.u_px[0], area.v_px[0]]);
    let last = transform.to_drawing([area.u_px[1], area.v_px[1]]);
    let one = |at: f32, low: f32, high: f32| {
        if (at - low).abs() <= BORDER_PT {
            Some(Hold::Low)
        } else if (at - high).abs() <= BORDER_PT {
            Some(Hold::High)
        } else {
            (low..=high).contains(&at).then_some(Hold::Both)
        }
    };
    let holds = [one(at.x, first.x, last.x)?, one(at.y, first.y, last.y)?];
    Some(match holds {
        // On a border but away from its ends: only that border.
        [Hold::Both, border @ (Hold::Low | Hold::High)] => [Hold::Neither, border],
        [border @ (Hold::Low | Hold::High), Hold::Both] => [border, Hold::Neither],
        holds => holds,
    })
}

fn cursor(ui: &Ui, holds: Option<[Hold; 2]>) {
    let icon = match holds {
        None => CursorIcon::Crosshair,
        Some([Hold::Both, Hold::Both]) => CursorIcon::Grab,
        Some([Hold::Neither, _]) => CursorIcon::ResizeVertical,
        Some([_, Hold::Neither]) => CursorIcon::ResizeHorizontal,
        Some([Hold::Low, Hold::Low] | [Hold::High, Hold::High]) => CursorIcon::ResizeNwSe,
        Some(_) => CursorIcon::ResizeNeSw,
    };
    ui.set_cursor_icon(icon);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_area_stays_on_the_screen_and_keeps_its_size_when_moved() {
        let moved = along(Some(Hold::Both), [100.0, 300.0], 200.0, 5000.0, 1920.0);
        assert_eq!(moved, [1719.0, 1919.0]);
        assert_eq!(along(Some(Hold::Both), [100.0, 300.0], 200.0, -50.0, 1920.0), [0.0, 200.0]);
    }

    #[test]
    fn borders_never_pass_each_other() {
        assert_eq!(along(Some(Hold::Low), [100.0, 300.0], 100.0, 900.0, 1920.0), [280.0, 300.0]);
        assert_eq!(along(Some(Hold::High), [100.0, 300.0], 300.0, 0.0, 1920.0), [100.0, 120.0]);
    }

    #[test]
    fn a_new_area_is_the_same_from_either_corner_and_a_slip_changes_nothing() {
        assert_eq!(along(None, [0.0, 50.0], 400.0, 200.4, 1920.0), [200.0, 400.0]);
        assert_eq!(along(None, [0.0, 50.0], 200.4, 400.0, 1920.0), [200.0, 400.0]);
        assert_eq!(along(None, [0.0, 50.0], 200.0, 205.0, 1920.0), [0.0, 50.0]);
    }
}
