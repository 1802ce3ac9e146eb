//! Taking a tile out of the window: its picture, its rows, a page of both, to the clipboard or to a file.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Sender, bounded};
use egui::{ColorImage, Context, Rect};

use super::PlumblineWindow;
use super::dialogs::Question;
use super::saving::{save_bytes, save_picture};
use crate::operator::snapshot::page::{PagePicture, TilePage, tile_pdf};
use crate::operator::{Pane, Table, Taken};

/// Frames until the menu and its hints have left the screen.
const FRAMES: u8 = 4;
/// A picture that has not come by then does not come.
const LONGEST: Duration = Duration::from_secs(5);

/// Files whose writing the window was not told of yet.
const MOST_WRITTEN: usize = 16;

/// What a picture of a tile is for.
enum Purpose {
    Copy,
    Save,
    Page(Table),
}

/// A picture of a tile on its way.
struct Shot {
    pane: Pane,
    rect: Rect,
    purpose: Purpose,
    /// Frames to go until it is asked for.
    frames: u8,
    since: Instant,
}

/// What waits for the name of a file.
enum Pending {
    Picture(Arc<ColorImage>),
    Rows(String),
    Page(Box<TilePage>),
}

/// A file, and what came of writing it.
type Written = (PathBuf, Result<(), String>);

/// What is being taken out of a tile.
pub(super) struct Taking {
    shot: Option<Shot>,
    pending: Option<Pending>,
    pictures: (Sender<Arc<ColorImage>>, Receiver<Arc<ColorImage>>),
    written: (Sender<Written>, Receiver<Written>),
}

impl Default for Taking {
    fn default() -> Self {
        Self { shot: None, pending: None, pictures: bounded(1), written: bounded(MOST_WRITTEN) }
    }
}

impl Taking {
    /// Whether the window is about to be photographed.
    pub(super) fn waits_for_picture(&self) -> bool {
        self.shot.is_some()
    }

    /// Tells the window what came of writing a file.
    pub(super) fn teller(&self, file: PathBuf) -> impl FnOnce(Result<(), String>) + Send + 'static {
        let sender = self.written.0.clone();
        // A window that is gone needs no telling.
        move |outcome| drop(sender.try_send((file, outcome)))
    }

    /// Writes what waits for its file.
    pub(super) fn save(&mut self, ctx: &Context, file: PathBuf) {
        let told = self.teller(file.clone());
        match self.pending.take() {
            Some(Pending::Picture(picture)) => save_picture(ctx, &picture, file, told),
            Some(Pending::Rows(text)) => save_bytes(ctx, file, move || Ok(text.into_bytes()), told),
            Some(Pending::Page(page)) => {
                let make = move || tile_pdf(&page).map_err(|error| error.to_string());
                save_bytes(ctx, file, make, told);
            }
            None => {}
        }
    }
}

/// The part of a picture of the window that a tile takes; `None`: the tile is not in it.
fn crop(window: &ColorImage, rect: Rect, pixels_per_point: f32) -> Option<ColorImage> {
    let [width, height] = window.size;
    let pixel = |points: f32, most: usize| ((points * pixels_per_point).round().max(0.0) as usize).min(most);
    let (left, right) = (pixel(rect.left(), width), pixel(rect.right(), width));
    let (top, bottom) = (pixel(rect.top(), height), pixel(rect.bottom(), height));
    let is_there = left < right && top < bottom;
    is_there.then(|| window.region_by_pixels([left, top], [right - left, bottom - top]))
}

impl PlumblineWindow {
    /// Does what was asked for in the menu of a tile.
    pub(super) fn take_from(&mut self, ctx: &Context, pane: Pane, taken: Taken) {
        match taken {
            Taken::CopyPicture(picture) => self.copy_picture(ctx, picture.image().as_ref().clone()),
            Taken::SavePicture(picture) => {
                let picture = Arc::clone(picture.image());
                self.save_pending(ctx, Pending::Picture(picture), Question::SaveView);
            }
            Taken::CopyTable(table) => {
                if let Some(text) = table.csv() {
                    ctx.copy_text(text);
                    self.notices.say("The table is on the clipboard, as CSV.");
                }
            }
            Taken::SaveTable(table) => {
                if let Some(text) = table.csv() {
                    self.save_pending(ctx, Pending::Rows(text), Question::SaveRows);
                }
            }
            Taken::CopyImage => self.photograph(pane, Purpose::Copy),
            Taken::SaveImage => self.photograph(pane, Purpose::Save),
            Taken::SavePage(table) => self.photograph(pane, Purpose::Page(table)),
        }
    }

    fn copy_picture(&mut self, ctx: &Context, picture: ColorImage) {
        ctx.copy_image(picture);
        self.notices.say("The picture is on the clipboard.");
    }

    fn save_pending(&mut self, ctx: &Context, pending: Pending, question: Question) {
        self.taking.pending = Some(pending);
        self.ask_for(ctx, question);
    }

    fn photograph(&mut self, pane: Pane, purpose: Purpose) {
        let Some(rect) = self.tile_rects.get(&pane).copied() else { return };
        // One that came too late is of another tile.
        while self.taking.pictures.1.try_recv().is_ok() {}
        self.taking.shot = Some(Shot { pane, rect, purpose, frames: FRAMES, since: Instant::now() });
    }

    /// Once a frame: asks for the picture when nothing lies over the tile any more, and uses it.
    pub(super) fn go_on_taking(&mut self, ctx: &Context) {
        while let Ok((file, outcome)) = self.taking.written.1.try_recv() {
            match outcome {
                Ok(()) => self.notices.say_written(file),
                Err(why) => {
                    let text = format!("{} could not be written: {why}.", file.display());
                    self.notices.say_failed(&text);
                }
            }
        }
        let Some(shot) = &mut self.taking.shot else { return };
        ctx.request_repaint();
        match shot.frames {
            0 => {}
            1 => {
                shot.frames = 0;
                let (sender, again) = (self.taking.pictures.0.clone(), ctx.clone());
                ctx.request_screenshot(move |picture| {
                    // A window that is gone needs no picture.
                    drop(sender.try_send(picture));
                    again.request_repaint();
                });
            }
            more => shot.frames = more - 1,
        }
        if let Ok(picture) = self.taking.pictures.1.try_recv() {
            self.use_picture(ctx, &picture);
        } else if self.taking.shot.as_ref().is_some_and(|shot| shot.since.elapsed() > LONGEST) {
            self.taking.shot = None;
            self.notices
                .say_failed("The tile could not be photographed: save a picture of the window instead.");
        }
    }

    fn use_picture(&mut self, ctx: &Context, window: &ColorImage) {
        let Some(shot) = self.taking.shot.take() else { return };
        let Some(picture) = crop(window, shot.rect, ctx.pixels_per_point()) else {
            return self
                .notices
                .say_failed("The tile left the window before it was photographed: try again.");
        };
        match shot.purpose {
            Purpose::Copy => self.copy_picture(ctx, picture),
            Purpose::Save => self.save_pending(ctx, Pending::Picture(Arc::new(picture)), Question::SaveView),
            Purpose::Page(table) => {
                let page = self.page(shot.pane, &picture, table);
                self.save_pending(ctx, Pending::Page(Box::new(page)), Question::SavePage);
            }
        }
    }

    fn page(&self, pane: Pane, picture: &ColorImage, table: Table) -> TilePage {
        let rig = self.view.robot.rig.as_ref().map(|rig| rig.name.clone());
        let now = jiff::Zoned::now().strftime("%Y-%m-%d %H:%M").to_string();
        let world = self.view.twin.running.then(|| "twin".to_owned());
        let about: Vec<String> = [Some(now), rig, world].into_iter().flatten().collect();
        let [width, height] = picture.size;
        TilePage {
            title: pane.title().to_owned(),
            about: about.join(" · "),
            picture: PagePicture {
                size_px: [width as u32, height as u32],
                rgba: picture.pixels.iter().flat_map(|pixel| pixel.to_array()).collect(),
            },
            headings: table.headings,
            rows: table.rows,
            version: plumbline_engine::software(),
        }
    }
}

#[cfg(test)]
mod tests {
    use egui::{Color32, pos2};

    use super::*;

    #[test]
    fn a_tile_is_cut_out_at_its_pixels_and_one_outside_is_not_there() {
        let mut window = ColorImage::filled([20, 10], Color32::BLACK);
        window.pixels[4 * 20 + 6] = Color32::WHITE;
        let tile = Rect::from_min_max(pos2(3.0, 2.0), pos2(5.0, 40.0));
        let picture = crop(&window, tile, 2.0).expect("inside");
        assert_eq!((picture.size, picture.pixels[0]), ([4, 6], Color32::WHITE));
        assert!(crop(&window, Rect::from_min_max(pos2(30.0, 2.0), pos2(40.0, 4.0)), 1.0).is_none());
    }
}
