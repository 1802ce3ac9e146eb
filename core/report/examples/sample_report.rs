//! Writes the report of every made-up finding as HTML, SVG, PDF and picture into a folder:
//! `cargo run --release -p plumbline-report --example sample_report -- FOLDER`

use std::error::Error;
use std::path::PathBuf;
use std::sync::Arc;

use plumbline_report::{html, pdf, sample, svg};
use resvg::{tiny_skia, usvg};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("give a folder")?);
    std::fs::create_dir_all(&folder)?;
    let all = [
        ("named", sample::named()),
        ("class", sample::class()),
        ("not-in-library", sample::not_in_library()),
        ("no-gap", sample::no_gap()),
        ("empty", sample::empty()),
        ("crowded", sample::crowded()),
        ("pixels", sample::pixels()),
    ];
    for (i, (name, finding)) in all.into_iter().enumerate() {
        let mut context = sample::context();
        if i % 2 == 1 {
            context.history.clear();
        }
        std::fs::write(folder.join(format!("{name}.html")), html(&finding, &context))?;
        std::fs::write(folder.join(format!("{name}.pdf")), pdf(&finding, &context)?)?;
        let page = svg(&finding, &context);
        std::fs::write(folder.join(format!("{name}.svg")), &page)?;
        picture(&page)?.save_png(folder.join(format!("{name}.png")))?;
    }
    Ok(())
}

fn picture(page: &str) -> Result<tiny_skia::Pixmap, Box<dyn Error>> {
    let mut options = usvg::Options::default();
    let fonts = Arc::make_mut(&mut options.fontdb);
    for weight in ["Regular", "SemiBold"] {
        let file = format!("{}/../../assets/fonts/Inter-{weight}.ttf", env!("CARGO_MANIFEST_DIR"));
        fonts.load_font_data(std::fs::read(file)?);
    }
    let tree = usvg::Tree::from_str(page, &options)?;
    const SCALE: f32 = 2.0;
    let size = tree.size();
    let mut pixmap = tiny_skia::Pixmap::new((size.width() * SCALE) as u32, (size.height() * SCALE) as u32)
        .ok_or("the page has no size")?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(SCALE, SCALE), &mut pixmap.as_mut());
    Ok(pixmap)
}
