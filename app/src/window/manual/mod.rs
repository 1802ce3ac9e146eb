//! Help: the page of the manual that belongs to the open screen, beside the work. It stays open while
//! something else is clicked, follows the screen, and never covers STOP.

mod markdown;
mod pages;

use egui::text::LayoutJob;
use egui::{
    Align, Align2, Area, Context, FontId, Frame, Grid, Id, Layout, Margin, Order, ScrollArea, TextFormat,
    TextStyle, Ui, vec2,
};
use plumbline_widgets::theme::{self, space};

use self::markdown::{Block, Look, Span, blocks};
use crate::operator::Screen;

/// Below the top line, which holds STOP.
const TOP: f32 = 64.0;
/// Above the bottom line.
const BOTTOM: f32 = 64.0;
const WIDTH: f32 = 440.0;

/// Whether help is open, and which page.
#[derive(Debug, Default)]
pub struct Manual {
    is_open: bool,
    /// A page that was chosen; `None`: that of the screen.
    chosen: Option<usize>,
    /// The screen whose page was shown last.
    screen: Option<Screen>,
    page: Option<(&'static str, Vec<Block>)>,
}

impl Manual {
    /// Opens it at the page of the screen, or closes it.
    pub fn toggle(&mut self) {
        (self.is_open, self.chosen) = (!self.is_open, None);
    }

    /// Whether it is open.
    pub fn is_open(&self) -> bool {
        self.is_open
    }

    /// Draws it while it is open.
    pub fn show(&mut self, ctx: &Context, screen: Screen, escape_pressed: bool) {
        if !self.is_open {
            return;
        }
        if self.screen.replace(screen) != Some(screen) {
            self.chosen = None;
        }
        let (title, text) = self.chosen.map_or_else(|| pages::of(screen), |chosen| pages::ALL[chosen]);
        if self.page.as_ref().is_none_or(|(shown, _)| *shown != title) {
            self.page = Some((title, blocks(text)));
        }
        let room = ctx.content_rect();
        let width = WIDTH.min(room.width() - 2.0 * space::M);
        let height = (room.height() - TOP - BOTTOM).max(120.0);
        let area = Area::new(Id::unique("manual")).order(Order::Foreground);
        let area = area.anchor(Align2::RIGHT_TOP, vec2(-space::M, TOP));
        area.show(ctx, |ui| {
            let frame = Frame::popup(ui.style()).inner_margin(Margin::same(space::M as i8));
            frame.show(ui, |ui| {
                ui.set_width(width - 2.0 * space::M);
                self.heading(ui, title);
                let blocks = self.page.as_ref().map_or(&[][..], |(_, blocks)| blocks);
                let scroll = ScrollArea::vertical().id_salt(title).max_height(height - 64.0);
                scroll.auto_shrink([false, true]).show(ui, |ui| {
                    for block in blocks {
                        draw(ui, block);
                    }
                });
            });
        });
        self.is_open &= !escape_pressed;
    }

    fn heading(&mut self, ui: &mut Ui, title: &str) {
        ui.horizontal(|ui| {
            ui.heading("Help");
            let pages = egui::ComboBox::from_id_salt("page of the manual").selected_text(title);
            pages.show_ui(ui, |ui| {
                for (i, (name, _)) in pages::ALL.iter().enumerate() {
                    if ui.selectable_label(*name == title, *name).clicked() {
                        self.chosen = Some(i);
                    }
                }
            });
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if ui.button("Close help").clicked() {
                    self.is_open = false;
                }
            });
        });
        ui.add_space(space::XS);
    }
}

fn draw(ui: &mut Ui, block: &Block) {
    match block {
        Block::Heading(level, spans) => {
            let text: String = spans.iter().map(|span| span.text.as_str()).collect();
            if *level == 1 {
                ui.label(theme::strong(ui, text));
            } else {
                theme::group_heading(ui, &text);
            }
        }
        Block::Paragraph(spans) => paragraph(ui, spans),
        Block::Item(depth, mark, spans) => {
            ui.horizontal_top(|ui| {
                ui.add_space(space::M * *depth as f32);
                ui.add_sized(vec2(18.0, 16.0), egui::Label::new(theme::weak(ui, mark.as_str())));
                ui.vertical(|ui| paragraph(ui, spans));
            });
        }
        Block::Table(rows) => table(ui, rows),
        Block::Code(code) => {
            ui.add(egui::Label::new(egui::RichText::new(code).monospace().small()).wrap());
        }
    }
    ui.add_space(space::XS);
}

fn paragraph(ui: &mut Ui, spans: &[Span]) {
    let job = line(ui, spans, TextStyle::Body);
    ui.add(egui::Label::new(job).wrap());
}

fn table(ui: &mut Ui, rows: &[Vec<Vec<Span>>]) {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0).max(1);
    let width = (ui.available_width() - space::S * (columns - 1) as f32) / columns as f32;
    let id = ui.next_auto_id();
    Grid::new(id).num_columns(columns).spacing([space::S, 4.0]).striped(true).show(ui, |ui| {
        for row in rows {
            for cell in row {
                let job = line(ui, cell, TextStyle::Small);
                ui.vertical(|ui| {
                    ui.set_width(width);
                    ui.add(egui::Label::new(job).wrap());
                });
            }
            ui.end_row();
        }
    });
}

fn line(ui: &Ui, spans: &[Span], style: TextStyle) -> LayoutJob {
    let tokens = theme::tokens(ui);
    let font = style.resolve(ui.style());
    let mut job = LayoutJob::default();
    for span in spans {
        let plain = TextFormat { font_id: font.clone(), color: tokens.text, ..TextFormat::default() };
        let format = match span.look {
            Look::Plain => plain,
            Look::Strong => {
                let strong = FontId::new(font.size, theme::strong_style(ui).resolve(ui.style()).family);
                TextFormat { font_id: strong, color: tokens.text_strong, ..plain }
            }
            Look::Italic => TextFormat { italics: true, ..plain },
            Look::Code => {
                let code = FontId::monospace(font.size * 0.92);
                TextFormat { font_id: code, color: tokens.text_strong, ..plain }
            }
        };
        job.append(&span.text, 0.0, format);
    }
    job
}
