//! Every widget with sample data: to look at, and for the tests to walk through.

mod control;
mod controls;
mod gap;
mod models;
mod pictures;
mod robot;
mod sample;
mod tables;
mod touch;

use egui::{ScrollArea, Ui};

use crate::format::Quantity;
use crate::image_view::ViewState;
use crate::jog_pad::{JogIntent, JogSpeed};
use crate::notifications::Notifications;
use crate::scene3d::SceneCamera;
use crate::texture::TextureCache;
use crate::theme::{self, space};

#[cfg(test)]
pub(crate) use robot::robot_scene;

/// What the pages keep between frames.
#[derive(Default)]
pub struct GalleryState {
    /// Pictures of the pages.
    pub textures: TextureCache,
    /// Zoom shared by the two eyes.
    pub pair_view: ViewState,
    /// Zoom of single pictures.
    pub single_view: ViewState,
    /// Zoom of the deep page.
    pub deep_view: ViewState,
    /// Messages.
    pub notifications: Notifications,
    /// Selected pair of the bars.
    pub selected_pair: Option<usize>,
    /// Whether the bars are sorted.
    pub sorted: bool,
    /// Selected step of the rail.
    pub step: usize,
    /// Selected option of the choice.
    pub option: usize,
    /// Camera of the scene.
    pub camera: SceneCamera,
    /// Cameras of the page with several scenes.
    pub other_cameras: [SceneCamera; 4],
    /// Whether those of the lower row have been put in their places.
    pub places_chosen: [bool; 2],
    /// How often the scene was drawn.
    pub renders: u64,
    /// Proposed angles of the joints, radians.
    pub proposed_rad: [Option<f64>; control::JOINTS],
    /// The open row.
    pub open_joint: Option<usize>,
    /// Speed of the jog pad.
    pub speed: JogSpeed,
    /// What is asked of the jog pad right now.
    pub jog: Option<JogIntent>,
    /// Chosen point of the table, and the points.
    pub chosen_point: Option<usize>,
    /// Where the points of the table were dragged to, meters.
    pub points_m: Vec<[f64; 2]>,
    /// The area of the touch pattern.
    pub touch_area: Option<crate::touch_pattern::PatternArea>,
    /// The chosen touch.
    pub touch: Option<usize>,
    /// The last thing that was done, in words.
    pub last: String,
}

/// One page.
pub struct Page {
    /// Its name.
    pub name: &'static str,
    /// Draws it.
    pub draw: fn(&mut Ui, &mut GalleryState),
}

/// All pages.
pub const PAGES: [Page; 22] = [
    Page { name: "Window", draw: controls::window },
    Page { name: "Theme", draw: theme_page },
    Page { name: "Image views", draw: pictures::linked },
    Page { name: "Pixels", draw: pictures::deep },
    Page { name: "Image states", draw: pictures::states },
    Page { name: "Comparison", draw: pictures::comparison },
    Page { name: "Depth", draw: pictures::depth },
    Page { name: "Board ghost and residuals", draw: pictures::board },
    Page { name: "Bars", draw: tables::bars },
    Page { name: "Coverage", draw: tables::coverage },
    Page { name: "Table map", draw: tables::table_map },
    Page { name: "Training", draw: models::training },
    Page { name: "Model map and points", draw: models::map },
    Page { name: "Gap", draw: gap::gap },
    Page { name: "Touch pattern", draw: touch::pattern },
    Page { name: "Scene", draw: robot::scene },
    Page { name: "Scene states", draw: robot::scene_states },
    Page { name: "Joints", draw: control::joints },
    Page { name: "Jog", draw: control::jog },
    Page { name: "Inspector", draw: tables::inspector },
    Page { name: "Buttons and progress", draw: controls::buttons },
    Page { name: "Notifications", draw: controls::notifications },
];

/// Draws a page with its margins.
pub fn show(ui: &mut Ui, page: &Page, state: &mut GalleryState) {
    egui::Frame::new().inner_margin(space::M).show(ui, |ui| {
        ScrollArea::vertical().id_salt(page.name).show(ui, |ui| (page.draw)(ui, state));
    });
}

fn theme_page(ui: &mut Ui, _: &mut GalleryState) {
    let tokens = theme::tokens(ui);
    theme::heading(ui, "The heading of a panel");
    ui.label("Body text: hold the board into both eyes until the outline turns green.");
    ui.label(theme::weak(ui, "Secondary text: 34 of 80, solved 2 h ago."));
    ui.label(theme::small(ui, "Small text: units, axes, hints."));
    theme::group_heading(ui, "Meanings");
    for role in theme::Role::ALL {
        ui.horizontal(|ui| {
            let (rect, _) = ui.allocate_exact_size(egui::vec2(56.0, 20.0), egui::Sense::hover());
            ui.painter().rect_filled(rect, 3.0, role.color(tokens));
            ui.colored_label(role.color(tokens), format!("{role:?}"));
        });
    }
    theme::group_heading(ui, "Numbers");
    ui.label(format!(
        "{}   {}   {}   {}",
        Quantity::Length.text_with(0.120_05, 0.000_12),
        Quantity::Angle.text(0.5),
        Quantity::Pixels.text(0.0955),
        Quantity::Temperature.text(41.2)
    ));
    theme::group_heading(ui, "Controls");
    ui.horizontal(|ui| {
        let _ = ui.button("Open folder…");
        ui.add_enabled(false, egui::Button::new("Save"));
        let mut on = true;
        ui.checkbox(&mut on, "Corners");
        let mut value = 0.45f32;
        ui.add(egui::Slider::new(&mut value, 0.2..=0.6).text("distance, m"));
    });
}
