//! Writing to disk, always on a thread of its own: settings, pictures, the report of frame times.

use std::path::PathBuf;
use std::thread;
use std::time::Duration;

use plumbline_model::files;

use super::PlumblineWindow;
use super::frame_time::resident_mb;

impl PlumblineWindow {
    pub(super) fn save_settings_if_changed(&mut self, ctx: &egui::Context) {
        self.settings.zoom = ctx.zoom_factor();
        let size = ctx.input(|input| input.viewport().inner_rect.map(|rect| rect.size()));
        if let Some(size) = size {
            self.settings.size = [size.x, size.y];
        }
        // Not while something is being dragged: once it is let go.
        let settled = !ctx.input(|input| input.pointer.any_down());
        if settled && self.saved != self.settings {
            self.saved = self.settings.clone();
            if let Some(file) = self.settings_file.clone() {
                let settings = self.settings.clone();
                let write = move || {
                    if let Err(error) = settings.save(&file) {
                        log::warn!(
                            "the window's settings could not be written to {}: {error}",
                            file.display()
                        );
                    }
                };
                on_thread("settings writer", write);
            }
        }
    }

    pub(super) fn save_settings(&mut self) {
        if let Some(file) = &self.settings_file
            && let Err(error) = self.settings.save(file)
        {
            log::warn!("the window's settings could not be written to {}: {error}", file.display());
        }
    }

    pub(super) fn write_frame_report(&self) {
        let Some(summary) = self.frame_times.summary() else { return };
        let ms = |duration: Duration| duration.as_secs_f64() * 1e3;
        log::info!(
            "{} frames with {}: half within {:.1} ms, 95 of 100 within {:.1} ms",
            summary.count,
            self.renderer,
            ms(summary.median),
            ms(summary.percentile_95)
        );
        if let Some(file) = &self.frame_report {
            let report = serde_json::json!({
                "frames": summary.count,
                "median_ms": ms(summary.median),
                "percentile_95_ms": ms(summary.percentile_95),
                "longest_ms": ms(summary.longest),
                "over_100_ms": summary.slow,
                "renderer": self.renderer,
                "resident_before_mb": self.resident_before_mb,
                "resident_mb": resident_mb(),
            });
            if let Err(error) = files::write(file, report.to_string()) {
                log::error!("the frame times could not be written to {}: {error}", file.display());
            }
        }
    }
}

/// Writes a PNG on a thread of its own, then calls `done`.
pub(super) fn save_picture(
    ctx: &egui::Context,
    picture: &egui::ColorImage,
    file: PathBuf,
    done: impl FnOnce(Result<(), String>) + Send + 'static,
) {
    let [width, height] = picture.size;
    let rgba: Vec<u8> = picture.pixels.iter().flat_map(|pixel| pixel.to_array()).collect();
    let ctx = ctx.clone();
    on_thread("picture writer", move || {
        let saved = image::RgbaImage::from_raw(width as u32, height as u32, rgba)
            .ok_or_else(|| "the picture is incomplete".to_owned())
            .and_then(|image| {
                let image = image::DynamicImage::from(image).to_rgb8();
                files::write_png(&file, &image.into()).map_err(|error| error.to_string())
            });
        match &saved {
            Ok(()) => log::info!("saved {}", file.display()),
            Err(error) => log::error!("the picture could not be saved as {}: {error}", file.display()),
        }
        done(saved);
        ctx.request_repaint();
    });
}

/// Writes bytes that are made on a thread of their own, then calls `done`.
pub(super) fn save_bytes(
    ctx: &egui::Context,
    file: PathBuf,
    make: impl FnOnce() -> Result<Vec<u8>, String> + Send + 'static,
    done: impl FnOnce(Result<(), String>) + Send + 'static,
) {
    let ctx = ctx.clone();
    on_thread("tile writer", move || {
        let saved = make().and_then(|bytes| files::write(&file, bytes).map_err(|error| error.to_string()));
        match &saved {
            Ok(()) => log::info!("saved {}", file.display()),
            Err(error) => log::error!("{} could not be written: {error}", file.display()),
        }
        done(saved);
        ctx.request_repaint();
    });
}

/// Opens a file with the program that the desktop has for it.
pub(super) fn open_file(file: PathBuf) {
    on_thread("file opener", move || {
        if let Err(error) = open::that_detached(&file) {
            log::error!("{} could not be opened: {error}; open it from the file manager", file.display());
        }
    });
}

pub(super) fn on_thread(name: &str, work: impl FnOnce() + Send + 'static) {
    if let Err(error) = thread::Builder::new().name(name.to_owned()).spawn(work) {
        log::error!("no thread for the {name}: {error}");
    }
}
