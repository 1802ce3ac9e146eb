//! The files of a set.

use std::path::Path;

use image::RgbImage;
use image::codecs::jpeg::JpegEncoder;
use plumbline_model::files::{self, FileError, Size, shortened};
use plumbline_model::{ClassIndex, ClassNames};

use super::labels::{Label, line};
use super::{SetError, SetOptions, SetSummary, SetWorld};

/// What made the set; the first of its files, so that a set whose drawing was ended is known, too.
pub(super) const RECIPE: &str = "recipe.json";

/// Checks that nothing else is in the folder, makes its folders, and writes what the set is.
///
/// A set may be drawn in parts and again, but never mixed with one of another seed: images of the
/// same name would be replaced, and what one was to be judged by would be learned from.
pub(super) fn prepare(out: &Path, options: &SetOptions) -> Result<(), SetError> {
    files::make_folder(out)?;
    if files::present(&out.join(RECIPE))? {
        let text = files::read_text(&out.join(RECIPE), Size::SHORT)?;
        let (found, wanted) = (origin(&text), origin(&recipe_text(options, &SetSummary::default())));
        if found != wanted {
            return Err(SetError::OtherSet { folder: out.to_owned(), found, wanted });
        }
    } else {
        let listing = std::fs::read_dir(out).map_err(FileError::unreadable(out))?;
        if listing.flatten().any(|entry| !files::is_hidden(&entry.path())) {
            return Err(SetError::NotASet { folder: out.to_owned() });
        }
        recipe(out, options, &SetSummary::default())?;
    }
    for split in ["train", "val"] {
        for kind in ["images", "labels"] {
            let folder = out.join(kind).join(split);
            files::make_folder(&folder)?;
        }
    }
    write(&out.join("data.yaml"), data_yaml(options).as_bytes())
}

fn data_yaml(options: &SetOptions) -> String {
    let val = if options.val_share > 0.0 { "images/val" } else { "images/train" };
    let train = if options.val_share >= 1.0 { "images/val" } else { "images/train" };
    let mut text = format!("train: {train}\nval: {val}\nnames:\n");
    for (ClassIndex(i), name) in ClassNames::published().iter() {
        text.push_str(&format!("  {i}: {name}\n"));
    }
    text
}

/// Image and labels of one eye.
pub(super) fn one(
    out: &Path,
    split: &str,
    name: &str,
    image: &RgbImage,
    quality: u8,
    labels: &[Label],
) -> Result<(), SetError> {
    let mut jpeg = vec![];
    JpegEncoder::new_with_quality(&mut jpeg, quality)
        .encode_image(image)
        .map_err(|error| SetError::Encode(error.to_string()))?;
    // Labels first: an image is never without them, whenever the work is ended.
    let text: String = labels.iter().map(|label| line(label, image.dimensions())).collect();
    write(&out.join("labels").join(split).join(format!("{name}.txt")), text.as_bytes())?;
    write(&out.join("images").join(split).join(format!("{name}.jpg")), &jpeg)
}

/// What of a recipe decides which pair a number stands for, for people.
fn origin(recipe: &str) -> String {
    let value = |key: &str| {
        let key = format!("\"{key}\":");
        let line = recipe.lines().find_map(|line| line.trim().strip_prefix(&key));
        line.map_or("unknown", |value| value.trim().trim_end_matches(',').trim_matches('"'))
    };
    format!(
        "seed {}, world {}, {} of the pairs for validation, generator {}",
        shortened(value("seed")),
        shortened(value("world")),
        shortened(value("val_share")),
        shortened(value("generator"))
    )
}

/// What made the set, and what is in it.
pub(super) fn recipe(out: &Path, options: &SetOptions, summary: &SetSummary) -> Result<(), SetError> {
    write(&out.join(RECIPE), recipe_text(options, summary).as_bytes())
}

fn recipe_text(options: &SetOptions, summary: &SetSummary) -> String {
    let counts: Vec<String> = ClassNames::published()
        .iter()
        .zip(summary.boxes)
        .map(|((_, name), count)| format!("    \"{name}\": {count}"))
        .collect();
    format!(
        "{{\n  \"format\": 1,\n  \"made_by\": \"plumbline {}\",\n  \"generator\": {},\n  \"seed\": {},\n  \"first\": {},\n  \"world\": \"{}\",\n  \"pairs\": {},\n  \"val_share\": {},\n  \"images_without_label\": {},\n  \"boxes\": {{\n{}\n  }}\n}}\n",
        env!("CARGO_PKG_VERSION"),
        super::GENERATOR,
        options.seed,
        options.first,
        match options.world {
            SetWorld::Randomised => "randomised",
            SetWorld::Twin => "twin",
        },
        summary.pairs,
        options.val_share,
        summary.empty_images,
        counts.join(",\n"),
    )
}

fn write(file: &Path, bytes: &[u8]) -> Result<(), SetError> {
    Ok(files::write(file, bytes)?)
}
