//! What can be taken out of a tile, any tile: copied or saved as image, CSV and PDF.

use egui::{Button, Layout, Ui, WidgetInfo};
use plumbline_widgets::format;
use plumbline_widgets::texture::Picture;
use plumbline_widgets::theme;

use crate::operator::{Pane, Table, Taken};

/// The button above a tile with its menu. `picture`: what the tile shows in pixels of its own; `rows`: its
/// table, asked for only while the menu is open.
pub(super) fn show(
    ui: &mut Ui,
    pane: Pane,
    text: &str,
    picture: Option<&Picture>,
    rows: impl FnOnce() -> Option<Table>,
) -> Option<Taken> {
    let button = Button::new(theme::small(ui, text)).frame(false);
    let (response, inner) = egui::containers::menu::MenuButton::from_button(button).ui(ui, |ui| {
        let layout = Layout::top_down_justified(egui::Align::Min);
        ui.with_layout(layout, |ui| entries(ui, picture, rows())).inner
    });
    response.widget_info(|| {
        let label = format!("Copy or save {}", pane.title());
        WidgetInfo::labeled(egui::Role::Button, true, label)
    });
    response.on_hover_text("Copy or save this tile: as image, CSV or PDF");
    inner.and_then(|inner| inner.inner)
}

fn entries(ui: &mut Ui, picture: Option<&Picture>, table: Option<Table>) -> Option<Taken> {
    let mut taken = None;
    let own = "The picture alone, in its own pixels";
    let none = "This tile has no rows yet";
    let mut entry = |ui: &mut Ui, text: &str, about: &str, what: Option<Taken>| {
        let button = ui.add_enabled(what.is_some(), Button::new(text).frame(false));
        if button.on_hover_text(about).on_disabled_hover_text(about).clicked() {
            taken = what;
        }
    };
    if let Some(picture) = picture {
        entry(ui, "Copy picture", own, Some(Taken::CopyPicture(picture.clone())));
    }
    entry(ui, "Copy as image", "The tile as it stands here", Some(Taken::CopyImage));
    let rows = table.as_ref().map(|table| table.rows.len());
    let about = rows
        .map_or_else(|| none.to_owned(), |rows| format!("{}, for a spreadsheet", format::count(rows, "row")));
    entry(ui, "Copy as CSV", &about, table.clone().map(Taken::CopyTable));
    ui.separator();
    if let Some(picture) = picture {
        entry(ui, "Save picture…", own, Some(Taken::SavePicture(picture.clone())));
    }
    entry(ui, "Save as image…", "The tile as it stands here, as PNG", Some(Taken::SaveImage));
    entry(ui, "Save as CSV…", &about, table.clone().map(Taken::SaveTable));
    let page = "The tile as it stands here, and its rows below it";
    entry(ui, "Save as PDF…", page, Some(Taken::SavePage(table.unwrap_or_default())));
    taken
}
