//! Image files of all kinds that are read, and folders of pairs.

use std::io::Cursor;
use std::path::Path;

use image::{DynamicImage, ImageFormat, Luma, Rgb, RgbImage, Rgba};

use jiff::{SignedDuration, Timestamp};
use plumbline_model::EyesThen;
use plumbline_model::robot::default_rig;
use plumbline_recording::{
    About, Attached, EyePlaces, JointGoal, JointReading, Jpeg, Level, Note, Outline, RecordingWriter, Topic,
};

use super::{Problem, put};

pub fn make(folder: &Path) -> Result<(), Problem> {
    let shade = |x: u32, y: u32| ((x * 7 + y * 13) % 251) as u8;
    let color = picture(24, 18);
    let gray16 = image::ImageBuffer::from_fn(20, 14, |x, y| Luma([u16::from(shade(x, y)) * 257]));
    let clear = image::ImageBuffer::from_fn(20, 14, |x, y| Rgba([shade(x, y), shade(y, x), 9, shade(x, x)]));
    let images = [
        ("color.png", DynamicImage::ImageRgb8(color.clone()), ImageFormat::Png),
        ("gray16.png", DynamicImage::ImageLuma16(gray16), ImageFormat::Png),
        ("clear.png", DynamicImage::ImageRgba8(clear), ImageFormat::Png),
        ("color.jpg", DynamicImage::ImageRgb8(color.clone()), ImageFormat::Jpeg),
    ];
    for (name, image, format) in images {
        put(folder, &format!("images/{name}"), encoded(&image, format)?)?;
    }
    for eye in ["left", "right"] {
        for k in 0..3 {
            let image = DynamicImage::ImageRgb8(picture(16 + 2 * (k % 2), 12));
            let (name, format) = if k == 2 {
                ("c.jpg".to_owned(), ImageFormat::Jpeg)
            } else {
                (format!("{k}.png"), ImageFormat::Png)
            };
            put(folder, &format!("pairs/{eye}/{name}"), encoded(&image, format)?)?;
        }
    }
    recording(&folder.join("recordings"))
}

/// Both eyes for three seconds, with something of everything.
fn recording(folder: &Path) -> Result<(), Problem> {
    std::fs::create_dir_all(folder)?;
    let start = Timestamp::from_second(1_780_000_000)?;
    let rig = Attached {
        name: "rig.toml".to_owned(),
        media_type: "application/toml".to_owned(),
        bytes: b"name = \"nico\"".to_vec(),
    };
    let about = About { rig: "nico".to_owned(), attached: vec![rig], ..About::default() };
    let mut writer = RecordingWriter::create(&folder.join("log.mcap"), start, &about)?;
    let rig_of_all = default_rig();
    let robot_from_left = rig_of_all.robot_from_left(&rig_of_all.home());
    for number in 0..6_u8 {
        let at = start + SignedDuration::from_millis(500 * i64::from(number));
        let jpeg = Jpeg(encoded(&DynamicImage::ImageRgb8(picture(16, 12)), ImageFormat::Jpeg)?);
        writer.pair(at, u64::from(number), [jpeg.clone(), jpeg], Some(0.001))?;
        let then = EyesThen { on_s: Some(f64::from(number)), head_rad: Some([0.1, -0.6]) };
        let places = EyePlaces { robot_from_left, right_from_left: rig_of_all.eyes.cameras.right_from_left };
        writer.eyes(at, u64::from(number), &then, Some(&places))?;
        let outline = Outline { box_px: [1.0, 2.0, 8.0, 9.0], text: "tomato 0.9".to_owned() };
        writer.outlines(at, &[vec![outline], vec![]])?;
        let joint = JointReading { name: "head_z".to_owned(), angle_rad: 0.1, speed_rad_s: None };
        writer.joints(at, &[joint])?;
        writer.goals(at, &[JointGoal { name: "head_z".to_owned(), angle_rad: 0.2 }])?;
        writer.note(at, &Note { level: Level::Warning, text: "hot".to_owned() })?;
        writer.told(Topic::Commands, at, &serde_json::json!({ "command": number }))?;
    }
    writer.finish()?;
    Ok(())
}

/// A small picture with structure.
pub fn picture(width: u32, height: u32) -> RgbImage {
    RgbImage::from_fn(width, height, |x, y| {
        Rgb([(x * 9) as u8, (y * 11) as u8, if (x / 3 + y / 3) % 2 == 0 { 200 } else { 30 }])
    })
}

/// The bytes of an image file.
pub fn encoded(image: &DynamicImage, format: ImageFormat) -> Result<Vec<u8>, Problem> {
    let mut bytes = Cursor::new(vec![]);
    image.write_to(&mut bytes, format)?;
    Ok(bytes.into_inner())
}
