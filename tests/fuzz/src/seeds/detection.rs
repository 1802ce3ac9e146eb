//! Detectors, a labeled set, class names.

use std::path::Path;

use image::{DynamicImage, ImageFormat};

use super::pictures::{encoded, picture};
use super::{Problem, put};

/// Tiny networks of the tests of detection.
const DETECTORS: [(&str, &[u8]); 5] = [
    ("raw.onnx", include_bytes!("../../../../core/vision/tests/detectors/raw.onnx")),
    ("end-to-end.onnx", include_bytes!("../../../../core/vision/tests/detectors/end-to-end.onnx")),
    ("seeing.onnx", include_bytes!("../../../../core/vision/tests/detectors/seeing.onnx")),
    ("open-shape.onnx", include_bytes!("../../../../core/vision/tests/detectors/open-shape.onnx")),
    ("float16.onnx", include_bytes!("../../../../core/vision/tests/detectors/float16.onnx")),
];

pub fn make(folder: &Path) -> Result<(), Problem> {
    for (name, content) in DETECTORS {
        put(folder, &format!("detectors/{name}"), content)?;
    }
    put(folder, "detectors/data.yaml", "names:\n  0: Banana\n  1: Duck\n")?;
    let names = "path: .\ntrain: images/train\nval: list.txt\ntest:\nnc: 3\nnames:\n  0: Banana\n  1: 'Duck'\n  2: LeftHand\n";
    put(folder, "labels/data.yaml", names)?;
    let image = encoded(&DynamicImage::ImageRgb8(picture(32, 24)), ImageFormat::Png)?;
    for name in ["train/a_left", "train/a_right", "train/b_left", "val/c_left"] {
        put(folder, &format!("labels/images/{name}.png"), &image)?;
    }
    put(folder, "labels/labels/train/a_left.txt", "0 0.5 0.5 0.25 0.25\n2 0.1 0.2 0.1 0.1\n")?;
    put(folder, "labels/labels/train/a_right.txt", "1 0.1 0.1 0.4 0.1 0.4 0.3 0.1 0.3\n")?;
    put(folder, "labels/labels/val/c_left.txt", "0 0.5 0.5 0.25 0.25\n")?;
    put(folder, "labels/list.txt", "images/val/c_left.png\n")?;
    put(
        folder,
        "labels/scenes.csv",
        "image,scene\na_left.png,a\na_right.png,a\nb_left.png,\"b, at night\"\n",
    )?;
    put(folder, "labels/to-check.txt", "a_left.png\nb_left.png\n")?;
    Ok(())
}
