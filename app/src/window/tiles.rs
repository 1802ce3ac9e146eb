//! The tiles of a screen: docking, and the bar above each one.

use std::collections::BTreeMap;

use egui::{CentralPanel, Color32, Frame, Rect, RichText, Stroke, Ui, Visuals, WidgetText};
use egui_tiles::{Behavior, SimplificationOptions, TabState, TileId, Tiles, UiResponse};
use plumbline_engine::View;
use plumbline_engine::view::{Connection, SourceStatus};
use plumbline_widgets::theme;

use super::narrow::NARROW;
use super::{PlumblineWindow, tile_menu};
use crate::operator::{Outbox, Pane, Screen};
use crate::panels::{self, PanelContext, PanelState, picture_key};

pub(super) fn show(window: &mut PlumblineWindow, ui: &mut Ui, outbox: &mut Outbox) {
    let screen = window.settings.screen;
    let background = theme::tokens(ui).background;
    CentralPanel::no_frame().frame(Frame::new().fill(background)).show(ui, |ui| {
        let twin =
            window.view.twin.running || matches!(window.view.robot.connection, Connection::Connecting { .. });
        let nothing = window.view.source.status == SourceStatus::None && !twin;
        if screen == Screen::Live && nothing {
            return panels::show_start(ui, &window.settings.recent_sources, outbox);
        }
        let narrow = ui.available_width() < NARROW;
        let tight = ui.available_width() < TIGHT;
        let arranged = window.settings.arrangement(screen);
        let tree = if narrow { window.narrow.of(screen, arranged) } else { arranged };
        let (view, state, rects) = (&window.view, &mut window.panels, &mut window.tile_rects);
        rects.clear();
        let mut behavior = PaneBehavior { view, screen, narrow, tight, state, outbox, rects };
        tree.ui(&mut behavior, ui);
    });
}

/// In less room than this, pt, titles stand closer to each other and smaller, so that none is cut.
const TIGHT: f32 = 760.0;
/// What "Copy" takes beside the titles; where there is less, three dots stand for it.
const COPY_WIDTH: f32 = 52.0;
/// On each side of a title.
const TITLE_SPACING: f32 = 12.0;
/// The same where it is tight.
const TIGHT_SPACING: f32 = 6.0;

struct PaneBehavior<'a> {
    view: &'a View,
    screen: Screen,
    /// The panes are tabs, one at a time.
    narrow: bool,
    /// Titles have little room.
    tight: bool,
    state: &'a mut PanelState,
    outbox: &'a mut Outbox,
    /// Where the tiles in front lie.
    rects: &'a mut BTreeMap<Pane, Rect>,
}

impl PaneBehavior<'_> {
    fn title(&self, pane: Pane) -> WidgetText {
        let title = RichText::new(pane.title());
        if self.tight { title.text_style(egui::TextStyle::Small).into() } else { title.into() }
    }

    fn title_spacing(&self) -> f32 {
        if self.tight { TIGHT_SPACING } else { TITLE_SPACING }
    }

    fn titles_width(&self, ui: &Ui, tiles: &Tiles<Pane>, tabs: &egui_tiles::Tabs) -> f32 {
        let panes = tabs.children.iter().filter_map(|child| tiles.get_pane(child));
        let extend = Some(egui::TextWrapMode::Extend);
        let widths = panes.map(|pane| {
            let galley = self.title(*pane).into_galley(ui, extend, f32::INFINITY, egui::TextStyle::Button);
            galley.size().x + 2.0 * self.title_spacing()
        });
        widths.sum()
    }
}

impl Behavior<Pane> for PaneBehavior<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile_id: TileId, pane: &mut Pane) -> UiResponse {
        let fill = theme::tokens(ui).panel;
        ui.painter().rect_filled(ui.max_rect(), 0.0, fill);
        self.rects.insert(*pane, ui.max_rect());
        let mut context =
            PanelContext { view: self.view, screen: self.screen, state: self.state, outbox: self.outbox };
        ui.push_id(*pane, |ui| panels::show(ui, *pane, &mut context));
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> WidgetText {
        self.title(*pane)
    }

    /// Saving and copying of what the tile shows.
    fn top_bar_right_ui(
        &mut self,
        tiles: &Tiles<Pane>,
        ui: &mut Ui,
        _tile_id: TileId,
        tabs: &egui_tiles::Tabs,
        _scroll_offset: &mut f32,
    ) {
        let Some(pane) = tabs.active.and_then(|active| tiles.get_pane(&active)) else { return };
        let room = ui.available_width() - self.titles_width(ui, tiles, tabs);
        let text = if room > COPY_WIDTH { "Copy" } else { "…" };
        let picture = picture_key(*pane).and_then(|key| self.state.textures.last(key)).cloned();
        let (view, state) = (self.view, &*self.state);
        let rows = || panels::table_of(*pane, view, state);
        if let Some(taken) = tile_menu::show(ui, *pane, text, picture.as_ref(), rows) {
            self.outbox.taken = Some((*pane, taken));
        }
    }

    /// What stands as tabs for want of room is arranged in a wider window.
    fn is_tile_draggable(&self, _tiles: &Tiles<Pane>, _tile_id: TileId) -> bool {
        !self.narrow
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions { all_panes_must_have_tabs: true, ..SimplificationOptions::default() }
    }

    fn gap_width(&self, _style: &egui::Style) -> f32 {
        4.0
    }

    fn min_size(&self) -> f32 {
        96.0
    }

    fn tab_bar_height(&self, _style: &egui::Style) -> f32 {
        28.0
    }

    fn tab_title_spacing(&self, _visuals: &Visuals) -> f32 {
        self.title_spacing()
    }

    fn tab_bar_color(&self, visuals: &Visuals) -> Color32 {
        visuals.panel_fill
    }

    fn tab_bg_color(&self, _: &Visuals, _: &Tiles<Pane>, _: TileId, _: &TabState) -> Color32 {
        Color32::TRANSPARENT
    }

    fn tab_outline_stroke(&self, _: &Visuals, _: &Tiles<Pane>, _: TileId, _: &TabState) -> Stroke {
        Stroke::NONE
    }

    fn tab_bar_hline_stroke(&self, _visuals: &Visuals) -> Stroke {
        Stroke::NONE
    }

    fn tab_text_color(&self, visuals: &Visuals, _: &Tiles<Pane>, _: TileId, state: &TabState) -> Color32 {
        if state.active { visuals.strong_text_color() } else { visuals.weak_text_color() }
    }

    fn resize_stroke(&self, style: &egui::Style, state: egui_tiles::ResizeState) -> Stroke {
        match state {
            egui_tiles::ResizeState::Idle => Stroke::NONE,
            _ => Stroke::new(2.0, style.visuals.weak_text_color()),
        }
    }
}
