//! Writes the report of every made-up finding as HTML, SVG and PDF into a folder:
//! `cargo run --release -p plumbline-report --example sample_report -- FOLDER`

use std::error::Error;
use std::path::PathBuf;

use plumbline_report::{html, pdf, sample, svg};

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
        std::fs::write(folder.join(format!("{name}.svg")), svg(&finding, &context))?;
    }
    Ok(())
}
