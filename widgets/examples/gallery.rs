//! Shows every widget in a window: `cargo run --release -p plumbline-widgets --example gallery`.

use eframe::egui;
use plumbline_widgets::gallery::{self, GalleryState, PAGES};
use plumbline_widgets::theme;

#[derive(Default)]
struct Gallery {
    page: usize,
    state: GalleryState,
}

impl eframe::App for Gallery {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        egui::Panel::left("pages").exact_size(200.0).show(ui, |ui| {
            ui.add_space(theme::space::S);
            for (index, page) in PAGES.iter().enumerate() {
                ui.selectable_value(&mut self.page, index, page.name);
            }
            ui.add_space(theme::space::M);
            let dark = ui.visuals().dark_mode;
            if ui.button(if dark { "Light theme" } else { "Dark theme" }).clicked() {
                ui.ctx().set_theme(if dark { egui::Theme::Light } else { egui::Theme::Dark });
            }
        });
        egui::CentralPanel::default().show(ui, |ui| {
            gallery::show(ui, &PAGES[self.page], &mut self.state);
        });
    }
}

fn main() -> eframe::Result {
    eframe::run_native(
        "Plumbline widgets",
        eframe::NativeOptions {
            viewport: egui::ViewportBuilder::default().with_inner_size([1480.0, 900.0]),
            ..Default::default()
        },
        Box::new(|cc| {
            theme::apply(&cc.egui_ctx, egui::ThemePreference::System);
            Ok(Box::new(Gallery::default()))
        }),
    )
}
