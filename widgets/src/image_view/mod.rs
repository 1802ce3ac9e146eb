//! An image that can be looked into: zoom, pan, single pixels and their values, marks on top,
//! and deliberate pictures for "nothing yet", "loading", "failed" and "old".

mod chrome;
mod input;
mod pixels;
mod seen;

pub use crate::view_state::{ImageTransform, ViewState};

use egui::{Color32, Rect, Response, Sense, Ui, Vec2, WidgetInfo, pos2};

use crate::empty::{EmptyState, Message};
use crate::overlay::Overlay;
use crate::texture::{Picture, Sampling};
use crate::theme::{self, STALE_TINT};

/// From this magnification on, in physical pixels per image pixel, pixels are drawn as squares.
const HARD_PIXELS_FROM: f64 = 4.0;

/// What a view shows.
#[derive(Clone, Copy)]
pub enum Content<'a> {
    /// A picture.
    Picture(&'a Picture),
    /// Nothing yet: what is missing, and how to fill it.
    Empty(Message<'a>),
    /// Being made; a sentence that says what.
    Loading(&'a str),
    /// Could not be made: what failed, and what to do.
    Failed(Message<'a>),
}

/// Text of one pixel (column, row), shown when deep in and at the pointer.
pub type ValueText<'a> = &'a dyn Fn(usize, usize) -> Option<String>;

/// An image with everything that can be done to it.
///
/// ```no_run
/// # use plumbline_widgets::{image_view::*, overlay::Overlay, texture::TextureCache};
/// # fn draw(ui: &mut egui::Ui, cache: &mut TextureCache, view: &mut ViewState, frame: &image::RgbImage) {
/// let picture = cache.rgb("left raw", 7, frame);
/// let shown = ImageView::new("Left eye, raw", Content::Picture(picture)).show(ui, view);
/// if let Some(at_px) = shown.hover_px { /* probe there */ }
/// # }
/// ```
pub struct ImageView<'a> {
    label: &'a str,
    content: Content<'a>,
    overlay: Option<&'a Overlay>,
    stale: Option<&'a str>,
    note: Option<&'a str>,
    value_text: Option<ValueText<'a>>,
    size: Option<Vec2>,
    caption: bool,
    crop: bool,
}

/// What happened to a view.
pub struct ImageViewResponse {
    /// The whole view.
    pub response: Response,
    /// Where the pointer is, in image pixels, if it is on the image.
    pub hover_px: Option<[f64; 2]>,
    /// Where the image was clicked.
    pub clicked_px: Option<[f64; 2]>,
    /// How image pixels map to the screen; `None` without a picture.
    pub transform: Option<ImageTransform>,
    /// The button of an empty or failed view was pressed.
    pub button_clicked: bool,
}

impl<'a> ImageView<'a> {
    /// A view that fills the available space. The label names it, on screen and for screen
    /// readers and tests; it must be unique within its panel.
    pub fn new(label: &'a str, content: Content<'a>) -> Self {
        Self {
            label,
            content,
            overlay: None,
            stale: None,
            note: None,
            value_text: None,
            size: None,
            caption: true,
            crop: false,
        }
    }

    /// Marks on the image.
    pub fn overlay(mut self, overlay: &'a Overlay) -> Self {
        self.overlay = Some(overlay);
        self
    }

    /// Says that the picture is old, how old, and why: "3 s old: the left camera is lost, trying
    /// again". The picture is dimmed.
    pub fn stale(mut self, sentence: Option<&'a str>) -> Self {
        self.stale = sentence;
        self
    }

    /// Says something about the marks, for instance that they are old. The picture is not dimmed.
    pub fn note(mut self, sentence: Option<&'a str>) -> Self {
        self.note = sentence;
        self
    }

    /// What stands in a pixel, instead of its color: a depth, a disparity.
    pub fn value_text(mut self, value_text: ValueText<'a>) -> Self {
        self.value_text = Some(value_text);
        self
    }

    /// Takes so much space instead of all that is available.
    pub fn size(mut self, size: Vec2) -> Self {
        self.size = Some(size);
        self
    }

    /// Whether the label is drawn on the image. Default: yes.
    pub fn caption(mut self, shown: bool) -> Self {
        self.caption = shown;
        self
    }

    /// Fits the part of the picture where something is seen, and not the dark around it, as a fisheye lens
    /// leaves it; a button shows all. Default: no.
    pub fn crop(mut self) -> Self {
        self.crop = true;
        self
    }

    /// Draws it. Give several views the same `view` to link their zoom and position.
    pub fn show(self, ui: &mut Ui, view: &mut ViewState) -> ImageViewResponse {
        let size = self.size.unwrap_or_else(|| ui.available_size()).max(Vec2::splat(48.0));
        match self.content {
            Content::Picture(picture) => self.show_picture(ui, view, size, picture),
            Content::Empty(message) => self.show_message(ui, size, EmptyState::empty(message)),
            Content::Loading(what) => self.show_message(ui, size, EmptyState::loading(what)),
            Content::Failed(message) => self.show_message(ui, size, EmptyState::failed(message)),
        }
    }

    fn show_message(&self, ui: &mut Ui, size: Vec2, state: EmptyState<'_>) -> ImageViewResponse {
        let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
        ui.painter().rect_filled(rect, 4.0, theme::tokens(ui).backdrop);
        let mut inner = ui.new_child(egui::UiBuilder::new().id_salt(self.label).max_rect(rect.shrink(4.0)));
        let button_clicked = state.show(&mut inner);
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, self.label));
        ImageViewResponse { response, hover_px: None, clicked_px: None, transform: None, button_clicked }
    }

    fn show_picture(
        &self,
        ui: &mut Ui,
        view: &mut ViewState,
        size: Vec2,
        picture: &Picture,
    ) -> ImageViewResponse {
        let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        if self.crop
            && let Some(part) = seen::part(picture.image())
        {
            view.see(picture.size_px(), part);
        }
        input::handle(ui, &response, rect, view, picture.size_px());
        let transform = view.transform(picture.size_px(), rect);
        let at_pointer = |pos: Option<egui::Pos2>| {
            pos.map(|pos| transform.to_image(pos)).filter(|at_px| transform.contains(*at_px))
        };
        let hover_px = at_pointer(response.hover_pos());
        let clicked_px = at_pointer(response.interact_pointer_pos().filter(|_| response.clicked()));
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, self.label));
        if ui.is_rect_visible(rect) {
            let has_button = self.crop && view.shows_part(picture.size_px()).is_some();
            self.paint(ui, rect, &transform, picture, hover_px, has_button);
            if response.has_focus() {
                let ring = egui::Stroke::new(1.5, theme::tokens(ui).accent);
                ui.painter_at(rect).rect_stroke(rect, 0.0, ring, egui::StrokeKind::Inside);
            }
        }
        if self.crop {
            seen::button(ui, rect, self.label, view, picture.size_px());
        }
        ImageViewResponse {
            response,
            hover_px,
            clicked_px,
            transform: Some(transform),
            button_clicked: false,
        }
    }

    fn paint(
        &self,
        ui: &Ui,
        rect: Rect,
        transform: &ImageTransform,
        picture: &Picture,
        hover_px: Option<[f64; 2]>,
        has_button: bool,
    ) {
        let tokens = theme::tokens(ui);
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 0.0, tokens.backdrop);
        let magnification = transform.points_per_px * f64::from(ui.pixels_per_point());
        let sampling = if magnification >= HARD_PIXELS_FROM { Sampling::Pixels } else { Sampling::Smooth };
        let dim = if self.stale.is_some() { STALE_TINT } else { Color32::WHITE };
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        painter.image(picture.texture(ui.ctx(), sampling), transform.image_rect(), whole, dim);
        pixels::paint(&painter, transform, picture, self.value_text);
        let captions = chrome::Captions::of(self, ui, rect, has_button);
        if let Some(overlay) = self.overlay {
            overlay.paint_beside(&painter, transform, &captions.rects());
        }
        chrome::paint(self, ui, rect, transform, picture, hover_px, captions);
    }
}
