//! The files of a set.

use std::fs;
use std::path::Path;

use image::RgbImage;
use image::codecs::jpeg::JpegEncoder;
use plumbline_model::{ClassIndex, ClassNames};

use super::labels::{Label, line};
use super::{SetError, SetOptions, SetSummary, SetWorld};

/// Makes the folders and writes what the set is.
pub(super) fn prepare(out: &Path, options: &SetOptions) -> Result<(), SetError> {
    for split in ["train", "val"] {
        for kind in ["images", "labels"] {
            let folder = out.join(kind).join(split);
            fs::create_dir_all(&folder).map_err(|source| SetError::Write { file: folder, source })?;
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

/// What made the set, and what is in it.
pub(super) fn recipe(out: &Path, options: &SetOptions, summary: &SetSummary) -> Result<(), SetError> {
    let counts: Vec<String> = ClassNames::published()
        .iter()
        .zip(summary.boxes)
        .map(|((_, name), count)| format!("    \"{name}\": {count}"))
        .collect();
    let text = format!(
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
    );
    write(&out.join("recipe.json"), text.as_bytes())
}

/// Under another name first, so that nobody reads half a file.
fn write(file: &Path, bytes: &[u8]) -> Result<(), SetError> {
    let failed = |source| SetError::Write { file: file.to_owned(), source };
    let mut part = file.as_os_str().to_owned();
    part.push(".part");
    fs::write(&part, bytes).map_err(failed)?;
    fs::rename(&part, file).map_err(failed)
}
