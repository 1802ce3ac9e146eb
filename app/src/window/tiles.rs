//! The tiles of a screen: docking, and the bar above each one.

use egui::{CentralPanel, Color32, Frame, Stroke, Ui, Visuals, WidgetText};
use egui_tiles::{Behavior, SimplificationOptions, TabState, TileId, Tiles, UiResponse};
use plumbline_engine::View;
use plumbline_engine::view::{Connection, SourceStatus};
use plumbline_widgets::texture::Picture;
use plumbline_widgets::theme;

use super::PlumblineWindow;
use super::narrow::NARROW;
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
        let arranged = window.settings.arrangement(screen);
        let tree = if narrow { window.narrow.of(screen, arranged) } else { arranged };
        let (view, state) = (&window.view, &mut window.panels);
        let mut behavior = PaneBehavior { view, screen, narrow, state, outbox };
        tree.ui(&mut behavior, ui);
    });
}

/// What "Copy" and "Save…" take beside the titles, and what the menu takes that holds both where they
/// would lie over a title; where not even that fits, a title is worth more.
const BUTTONS_WIDTH: f32 = 100.0;
const MENU_WIDTH: f32 = 32.0;
const TABLE_BUTTON_WIDTH: f32 = 48.0;
/// On each side of a title.
const TITLE_SPACING: f32 = 12.0;

fn titles_width(ui: &Ui, tiles: &Tiles<Pane>, tabs: &egui_tiles::Tabs) -> f32 {
    let panes = tabs.children.iter().filter_map(|child| tiles.get_pane(child));
    let widths = panes.map(|pane| {
        let title: WidgetText = pane.title().into();
        let galley =
            title.into_galley(ui, Some(egui::TextWrapMode::Extend), f32::INFINITY, egui::TextStyle::Button);
        galley.size().x + 2.0 * TITLE_SPACING
    });
    widths.sum()
}

fn picture_buttons(ui: &mut Ui, pane: Pane, picture: &Picture, outbox: &mut Outbox) {
    for (text, slot) in [("Save…", &mut outbox.save), ("Copy", &mut outbox.copy)] {
        let button = ui.add(egui::Button::new(theme::small(ui, text)).frame(false));
        button.widget_info(|| {
            let label = format!("{} {}", text.trim_end_matches('…'), pane.title());
            egui::WidgetInfo::labeled(egui::Role::Button, true, label)
        });
        if button.on_hover_text("The picture alone, in its own pixels").clicked() {
            *slot = Some(picture.clone());
        }
    }
}

impl PaneBehavior<'_> {
    fn table_button(&mut self, ui: &mut Ui, pane: Pane) {
        let button = ui.add(egui::Button::new(theme::small(ui, "Copy")).frame(false));
        button.widget_info(|| {
            let label = format!("Copy {} as a table", pane.title());
            egui::WidgetInfo::labeled(egui::Role::Button, true, label)
        });
        if button.on_hover_text("All rows as CSV, for a spreadsheet").clicked()
            && let Some(table) = panels::csv_of(pane, self.view)
        {
            self.outbox.table = Some(table);
        }
    }
}

struct PaneBehavior<'a> {
    view: &'a View,
    screen: Screen,
    /// The panes are tabs, one at a time.
    narrow: bool,
    state: &'a mut PanelState,
    outbox: &'a mut Outbox,
}

impl Behavior<Pane> for PaneBehavior<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile_id: TileId, pane: &mut Pane) -> UiResponse {
        let fill = theme::tokens(ui).panel;
        ui.painter().rect_filled(ui.max_rect(), 0.0, fill);
        let mut context =
            PanelContext { view: self.view, screen: self.screen, state: self.state, outbox: self.outbox };
        ui.push_id(*pane, |ui| panels::show(ui, *pane, &mut context));
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> WidgetText {
        pane.title().into()
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
        let room = ui.available_width() - titles_width(ui, tiles, tabs);
        if room > TABLE_BUTTON_WIDTH && panels::has_table(*pane, self.view) {
            self.table_button(ui, *pane);
        }
        let Some(picture) = picture_key(*pane).and_then(|key| self.state.textures.last(key)).cloned() else {
            return;
        };
        if room > BUTTONS_WIDTH {
            ui.spacing_mut().item_spacing.x = theme::space::S + 2.0;
            ui.add_space(0.0);
            picture_buttons(ui, *pane, &picture, self.outbox);
        } else if room > MENU_WIDTH {
            let more = ui.menu_button(theme::small(ui, "⋯"), |ui| {
                ui.with_layout(egui::Layout::top_down_justified(egui::Align::Min), |ui| {
                    picture_buttons(ui, *pane, &picture, self.outbox);
                });
            });
            more.response.widget_info(|| {
                let label = format!("Copy or save {}", pane.title());
                egui::WidgetInfo::labeled(egui::Role::Button, true, label)
            });
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
        TITLE_SPACING
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
