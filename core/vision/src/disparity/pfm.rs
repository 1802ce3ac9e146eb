//! Portable float maps: the usual file for disparities. Text header, then 32-bit floats, the
//! bottom row first; invalid is +infinity.
//!
//! Source: Debevec's PFM description; Middlebury stereo evaluation for the meaning of infinity.

use std::io::{self, BufRead, Read, Write};

use super::DisparityMap;

/// Why a PFM file cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum PfmError {
    /// Not readable at all.
    #[error("the file cannot be read: {0}")]
    Io(#[from] io::Error),
    /// Another kind of file.
    #[error(
        "not a one-channel PFM file: it should start with \"Pf\", a size, and a scale such as -1, but {what}"
    )]
    Header {
        /// What is wrong with it.
        what: String,
    },
    /// Fewer numbers than the header promises.
    #[error("the PFM file is cut off: {width_px}x{height_px} px need {needed} bytes, {found} are there")]
    Truncated {
        /// Width in the header.
        width_px: u32,
        /// Height in the header.
        height_px: u32,
        /// Bytes that should follow.
        needed: usize,
        /// Bytes that do.
        found: usize,
    },
}

/// More pixels than any camera has; a header that asks for more is damaged.
const MOST_PIXELS: u64 = 1 << 28;

/// Writes a map, measured and filled disparities alike.
pub fn write_pfm(map: &DisparityMap, mut out: impl Write) -> io::Result<()> {
    write!(out, "Pf\n{} {}\n-1.0\n", map.width_px(), map.height_px())?;
    let width = map.width_px() as usize;
    let mut bytes = Vec::with_capacity(4 * map.as_slice().len());
    for row in map.as_slice().chunks_exact(width.max(1)).rev() {
        bytes.extend(row.iter().flat_map(|d| d.to_le_bytes()));
    }
    out.write_all(&bytes)
}

/// Reads a map; every finite number counts as measured, everything else as none.
///
/// # Errors
/// When the header is not that of a one-channel PFM file, or the file is cut off.
pub fn read_pfm(mut input: impl BufRead) -> Result<DisparityMap, PfmError> {
    let header = |what: String| PfmError::Header { what };
    let kind = word(&mut input)?;
    if kind != "Pf" {
        return Err(header(format!("it starts with {kind:?}")));
    }
    let mut number = |name: &str| -> Result<f64, PfmError> {
        let text = word(&mut input)?;
        text.parse().map_err(|_| header(format!("its {name} is {text:?}")))
    };
    let (width, height, scale) = (number("width")?, number("height")?, number("scale")?);
    let whole = |n: f64| n >= 1.0 && n.fract() == 0.0 && n < 65536.0;
    if !(whole(width) && whole(height)) || width as u64 * height as u64 > MOST_PIXELS {
        return Err(header(format!("its size is {width} x {height}")));
    }
    if scale == 0.0 || !scale.is_finite() {
        return Err(header(format!("its scale is {scale}")));
    }
    let (width_px, height_px) = (width as u32, height as u32);
    let needed = 4 * width_px as usize * height_px as usize;
    let mut bytes = Vec::with_capacity(needed);
    input.take(needed as u64).read_to_end(&mut bytes)?;
    if bytes.len() < needed {
        return Err(PfmError::Truncated { width_px, height_px, needed, found: bytes.len() });
    }
    let (floats, _) = bytes.as_chunks::<4>();
    let float =
        |bytes: &[u8; 4]| if scale < 0.0 { f32::from_le_bytes(*bytes) } else { f32::from_be_bytes(*bytes) };
    let rows = floats.chunks_exact(width_px as usize).rev();
    let disparities =
        rows.flatten().map(|b| Some(float(b)).filter(|d| d.is_finite()).unwrap_or(f32::INFINITY)).collect();
    DisparityMap::from_measured(width_px, height_px, disparities)
        .ok_or_else(|| header("its size does not fit its contents".to_owned()))
}

/// The next word of the header; consumes exactly one white space after it.
fn word(input: &mut impl BufRead) -> Result<String, PfmError> {
    let mut text = String::new();
    let mut byte = [0];
    while text.len() < 32 {
        if input.read(&mut byte)? == 0 || byte[0].is_ascii_whitespace() {
            if text.is_empty() && byte[0].is_ascii_whitespace() {
                byte[0] = 0;
                continue;
            }
            break;
        }
        text.push(char::from(byte[0]));
    }
    Ok(text)
}
