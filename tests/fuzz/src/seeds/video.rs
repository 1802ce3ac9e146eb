//! A pair of short videos: JPEG images in an AVI file, put together here.

use std::path::Path;

use image::{DynamicImage, ImageFormat};

use super::pictures::{encoded, picture};
use super::{Problem, put};

const WIDTH: u32 = 64;
const HEIGHT: u32 = 48;
const FRAMES: u32 = 4;
const MICROSECONDS: u32 = 100_000;

pub fn make(folder: &Path) -> Result<(), Problem> {
    for name in ["left.avi", "right.avi"] {
        put(folder, &format!("videos/{name}"), avi()?)?;
    }
    Ok(())
}

fn chunk(name: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let mut out = name.to_vec();
    out.extend((content.len() as u32).to_le_bytes());
    out.extend(content);
    out.resize(out.len() + content.len() % 2, 0);
    out
}

fn list(name: &[u8; 4], parts: &[Vec<u8>]) -> Vec<u8> {
    chunk(b"LIST", &[name.as_slice(), &parts.concat()].concat())
}

fn words(numbers: &[u32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

fn avi() -> Result<Vec<u8>, Problem> {
    let frame = encoded(&DynamicImage::ImageRgb8(picture(WIDTH, HEIGHT)), ImageFormat::Jpeg)?;
    let size = frame.len() as u32;
    // Main header: period, rate, grain, flags (has an index), frames, 0, streams, buffer, size.
    let main = words(&[MICROSECONDS, 0, 0, 0x10, FRAMES, 0, 1, size, WIDTH, HEIGHT, 0, 0, 0, 0]);
    let mut stream = b"vidsMJPG".to_vec();
    stream.extend(words(&[
        0,
        0,
        0,
        MICROSECONDS,
        1_000_000,
        0,
        FRAMES,
        size,
        u32::MAX,
        0,
        0,
        HEIGHT << 16 | WIDTH,
    ]));
    let mut format = words(&[40, WIDTH, HEIGHT, 24 << 16 | 1]);
    format.extend(b"MJPG");
    format.extend(words(&[WIDTH * HEIGHT * 3, 0, 0, 0, 0]));
    let header = list(
        b"hdrl",
        &[chunk(b"avih", &main), list(b"strl", &[chunk(b"strh", &stream), chunk(b"strf", &format)])],
    );
    let frames: Vec<Vec<u8>> = (0..FRAMES).map(|_| chunk(b"00dc", &frame)).collect();
    let mut index = vec![];
    let mut at = 4;
    for frame in &frames {
        index.extend(b"00dc");
        index.extend(words(&[0x10, at, size]));
        at += frame.len() as u32;
    }
    let whole = [header, list(b"movi", &frames), chunk(b"idx1", &index)].concat();
    Ok(chunk(b"RIFF", &[b"AVI ".as_slice(), &whole].concat()))
}
