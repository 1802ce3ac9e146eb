//! An image on which boxes are drawn and corrected by hand.

pub mod grips;
mod paint;

pub use paint::box_frame;

use egui::{Color32, CursorIcon, PointerButton, Rect, Response, Sense, Ui, Vec2, WidgetInfo};
use plumbline_model::PixelBox;

use crate::image_view::{ImageTransform, ViewState};
use crate::texture::Picture;
use grips::{Grip, Side, between, box_at, dragged, grip_at};

/// Scroll distance, in points, that magnifies e times.
const SCROLL_PER_E: f64 = 240.0;
/// How near the pointer has to be to an edge, points.
const REACH_PT: f64 = 7.0;

/// A box on the canvas.
#[derive(Clone, Debug, PartialEq)]
pub struct CanvasBox {
    /// Where, on the image.
    pub area: PixelBox,
    /// Color of its class.
    pub color: Color32,
    /// What stands at it: "Tomato", "Tomato 0.83".
    pub text: String,
    /// Proposed and not accepted: drawn dashed.
    pub dashed: bool,
    /// Whether something is wrong with it.
    pub odd: bool,
}

/// An image with boxes that can be drawn, chosen, moved and resized.
///
/// Drag on the image draws a box, drag in a box moves it, drag at an edge resizes it; with Shift a drag
/// always draws. The wheel zooms; a drag with the right or the middle button moves the image.
pub struct BoxCanvas<'a> {
    label: &'a str,
    picture: &'a Picture,
    boxes: &'a [CanvasBox],
    /// Color of a box that is being drawn; `None`: nothing can be changed.
    draw: Option<Color32>,
    revision: u64,
}

/// How the canvas is looked at, and what the hand is doing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CanvasState {
    /// Zoom and position.
    pub view: ViewState,
    /// The chosen box, by place.
    pub chosen: Option<usize>,
    holding: Option<Holding>,
    /// What was done and is not in the boxes yet, with the revision that it was done to: shown until
    /// the boxes follow, so that nothing jumps back for a moment.
    done: Option<Done>,
    /// A box was drawn when the boxes had this revision; it is chosen once it is there.
    drawn_at: Option<u64>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Done {
    revision: u64,
    placed: Placed,
    /// By the clock of the window.
    at_s: f64,
}

/// What was done and is not in the boxes after this time was refused.
const FOLLOWS_WITHIN_S: f64 = 2.0;

#[derive(Clone, Copy, Debug, PartialEq)]
struct Holding {
    what: Held,
    from: [f32; 2],
    now: [f32; 2],
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Held {
    New,
    Box(usize, Grip),
}

/// A box where the hand left it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Its place in the list; `None`: a new one.
    pub index: Option<usize>,
    /// Where it is now.
    pub area: PixelBox,
}

/// What the operator did.
#[derive(Debug)]
pub struct CanvasResponse {
    /// The whole canvas.
    pub response: Response,
    /// A box was drawn, moved or resized.
    pub placed: Option<Placed>,
}

impl CanvasState {
    /// Looks there, with this box chosen.
    pub fn looking(view: ViewState, chosen: Option<usize>) -> Self {
        Self { view, chosen, ..Self::default() }
    }
}

impl<'a> BoxCanvas<'a> {
    /// An image with boxes, to look at. The label names it for screen readers and tests.
    pub fn new(label: &'a str, picture: &'a Picture, boxes: &'a [CanvasBox]) -> Self {
        Self { label, picture, boxes, draw: None, revision: 0 }
    }

    /// Boxes can be drawn and changed; `color` is that of a new one, `revision` counts the changes of
    /// the boxes.
    pub fn editable(mut self, color: Color32, revision: u64) -> Self {
        (self.draw, self.revision) = (Some(color), revision);
        self
    }

    /// Draws it into the available space.
    pub fn show(self, ui: &mut Ui, state: &mut CanvasState) -> CanvasResponse {
        let size = ui.available_size().max(Vec2::splat(64.0));
        let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        let size_px = self.picture.size_px();
        look_around(ui, &response, rect, &mut state.view, size_px);
        let transform = state.view.transform(size_px, rect);
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, self.label));
        self.follow(state, ui.input(|input| input.time));
        if state.chosen.is_some_and(|chosen| chosen >= self.boxes.len()) {
            state.chosen = None;
        }
        let pointer_px = response.hover_pos().map(|at| on_box_scale(transform.to_image(at)));
        let placed = self.hand(ui, &response, &transform, state);
        paint::paint(ui, rect, &self, &transform, state, pointer_px.filter(|_| response.hovered()));
        CanvasResponse { response, placed }
    }

    /// A box that was drawn is chosen once it is there.
    fn follow(&self, state: &mut CanvasState, now_s: f64) {
        state.done.take_if(|done| done.revision != self.revision);
        if state.drawn_at.take_if(|revision| *revision != self.revision).is_some() {
            state.chosen = self.boxes.iter().rposition(|shown| !shown.dashed);
        }
        state.done.take_if(|done| now_s - done.at_s > FOLLOWS_WITHIN_S);
    }

    fn size_px(&self) -> [f32; 2] {
        self.picture.size_px().map(|n| n as f32)
    }

    /// Pointer and boxes.
    fn hand(
        &self,
        ui: &Ui,
        response: &Response,
        transform: &ImageTransform,
        state: &mut CanvasState,
    ) -> Option<Placed> {
        let reach_px = (REACH_PT / transform.points_per_px) as f32;
        let at = |pos: egui::Pos2| on_box_scale(transform.to_image(pos));
        let shift = ui.input(|input| input.modifiers.shift);
        if let Some(pos) = response.hover_pos().filter(|_| state.holding.is_none()) {
            ui.ctx().set_cursor_icon(self.cursor(at(pos), reach_px, shift, state.chosen));
        }
        if response.clicked()
            && let Some(pos) = response.interact_pointer_pos()
        {
            state.chosen = box_at(self.areas(), at(pos));
        }
        if response.drag_started_by(PointerButton::Primary) {
            let origin = ui.input(|input| input.pointer.press_origin()).or(response.interact_pointer_pos());
            state.holding = origin.map(at).and_then(|from| self.take(from, reach_px, shift, state));
        }
        let holding = state.holding.as_mut()?;
        if let Some(pos) = response.interact_pointer_pos() {
            holding.now = at(pos);
        }
        if !response.drag_stopped() && ui.input(|input| input.pointer.primary_down()) {
            return None;
        }
        let placed = state.holding.take().and_then(|holding| self.placed(&holding))?;
        let at_s = ui.input(|input| input.time);
        state.done = Some(Done { revision: self.revision, placed, at_s });
        state.drawn_at = placed.index.is_none().then_some(self.revision);
        state.chosen = placed.index;
        Some(placed)
    }

    fn areas(&self) -> impl Iterator<Item = (usize, &PixelBox)> {
        self.boxes.iter().map(|shown| &shown.area).enumerate()
    }

    /// What is taken hold of at a point. The chosen box comes first, then the one that a click means.
    fn take(&self, from: [f32; 2], reach_px: f32, shift: bool, state: &mut CanvasState) -> Option<Holding> {
        self.draw?;
        let held = self.held(from, reach_px, shift, state.chosen);
        if let Held::Box(index, _) = held {
            state.chosen = Some(index);
        }
        Some(Holding { what: held, from, now: from })
    }

    fn held(&self, from: [f32; 2], reach_px: f32, shift: bool, chosen: Option<usize>) -> Held {
        if shift {
            return Held::New;
        }
        let of = |index: usize| Some((index, grip_at(&self.boxes.get(index)?.area, from, reach_px)?));
        let of_chosen = chosen.and_then(of);
        let under = || box_at(self.areas(), from).and_then(of);
        of_chosen.or_else(under).map_or(Held::New, |(index, grip)| Held::Box(index, grip))
    }

    fn cursor(&self, at: [f32; 2], reach_px: f32, shift: bool, chosen: Option<usize>) -> CursorIcon {
        if self.draw.is_none() {
            return CursorIcon::Default;
        }
        match self.held(at, reach_px, shift, chosen) {
            Held::New => CursorIcon::Crosshair,
            Held::Box(_, Grip::Body) => CursorIcon::Move,
            Held::Box(_, Grip::Edges { x, y }) => match (x, y) {
                (Side::None, _) => CursorIcon::ResizeVertical,
                (_, Side::None) => CursorIcon::ResizeHorizontal,
                (Side::Low, Side::Low) | (Side::High, Side::High) => CursorIcon::ResizeNwSe,
                _ => CursorIcon::ResizeNeSw,
            },
        }
    }

    fn placed(&self, holding: &Holding) -> Option<Placed> {
        let by = [holding.now[0] - holding.from[0], holding.now[1] - holding.from[1]];
        match holding.what {
            Held::New => {
                let area = between(holding.from, holding.now, self.size_px())?;
                Some(Placed { index: None, area })
            }
            Held::Box(index, grip) => {
                let before = self.boxes.get(index)?.area;
                let area = dragged(&before, grip, by, self.size_px());
                (area != before).then_some(Placed { index: Some(index), area })
            }
        }
    }

    /// What the hand is doing or has just done, to be drawn in place of the box as it was.
    fn under_way(&self, state: &CanvasState) -> Option<Placed> {
        let holding = state.holding.as_ref().and_then(|holding| self.placed(holding));
        holding.or(state.done.map(|done| done.placed))
    }
}

/// [`ImageTransform`] counts from the middle of the first pixel, boxes from its edge.
fn on_box_scale([u, v]: [f64; 2]) -> [f32; 2] {
    [(u + 0.5) as f32, (v + 0.5) as f32]
}

/// Wheel and pinch zoom, a drag with another button moves, the key 0 shows everything.
fn look_around(ui: &mut Ui, response: &Response, rect: Rect, view: &mut ViewState, size_px: [usize; 2]) {
    if let Some(pointer) = response.hover_pos() {
        let (scroll, pinch) = ui.input_mut(|input| {
            (std::mem::take(&mut input.smooth_scroll_delta), f64::from(input.zoom_delta()))
        });
        let factor = pinch * (f64::from(scroll.y) / SCROLL_PER_E).exp();
        if factor != 1.0 {
            view.zoom(factor, pointer, size_px, rect);
        }
    }
    let moving = response.dragged_by(PointerButton::Middle) || response.dragged_by(PointerButton::Secondary);
    if moving && response.drag_delta() != Vec2::ZERO && !view.is_fit() {
        view.pan(response.drag_delta(), size_px, rect);
    }
}
