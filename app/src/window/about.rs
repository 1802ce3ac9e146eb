//! About: which version of the program this is, and what computes inside of it.

use std::sync::{Arc, OnceLock};

use egui::{Context, Ui};
use plumbline_widgets::key_value::{KeyValue, key_value_grid};
use plumbline_widgets::theme::{self, space};

use super::saving::on_thread;
use super::sheet::{Asked, close_button, title};

/// Versions of libraries, once they were asked; that loads them, so not on this thread.
#[derive(Clone, Debug, Default)]
pub struct About {
    libraries: Arc<OnceLock<Vec<(&'static str, String)>>>,
    renderer: String,
}

impl About {
    /// Asks the libraries who they are.
    pub fn new(ctx: &Context, renderer: &str) -> Self {
        let about = Self { renderer: renderer.to_owned(), ..Self::default() };
        let (libraries, ctx) = (Arc::clone(&about.libraries), ctx.clone());
        on_thread("about", move || {
            libraries.get_or_init(plumbline_engine::libraries);
            ctx.request_repaint();
        });
        about
    }

    /// Draws what is known.
    pub fn show(&self, ui: &mut Ui) -> Asked {
        title(ui, "About Plumbline", "Sees, measures and calibrates with the stereo eyes of NICO.");
        let mut rows = vec![
            KeyValue::text("Plumbline", env!("CARGO_PKG_VERSION")),
            KeyValue::text("Window drawn by", self.renderer.as_str()),
        ];
        match self.libraries.get() {
            Some(libraries) => {
                rows.extend(libraries.iter().map(|(name, version)| KeyValue::text(*name, version.as_str())));
            }
            None => rows.push(KeyValue::text("Libraries", "being asked")),
        }
        key_value_grid(ui, "about", &rows);
        ui.add_space(space::S);
        let license =
            "Licensed under MIT or Apache-2.0, at your choice. Help (F1) opens the manual at this screen.";
        ui.label(theme::weak(ui, license));
        if close_button(ui) { Asked::Closed } else { Asked::Open }
    }
}
