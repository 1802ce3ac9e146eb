//! Pictures and the textures they live in. Pixels are uploaded only when they changed and only
//! when they are drawn.

use std::collections::HashMap;
use std::sync::Arc;

use egui::mutex::Mutex;
use egui::{ColorImage, Context, TextureFilter, TextureHandle, TextureId, TextureOptions, TextureWrapMode};
use image::RgbImage;

/// How a texture is magnified.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sampling {
    /// Interpolated, for pictures about their own size.
    Smooth,
    /// Hard pixels, for looking at single ones.
    Pixels,
}

impl Sampling {
    fn options(self) -> TextureOptions {
        TextureOptions {
            magnification: match self {
                Self::Smooth => TextureFilter::Linear,
                Self::Pixels => TextureFilter::Nearest,
            },
            minification: TextureFilter::Linear,
            wrap_mode: TextureWrapMode::ClampToEdge,
            mipmap_mode: None,
        }
    }
}

/// A picture that can be drawn. Cheap to clone; clones share their textures.
#[derive(Clone)]
pub struct Picture {
    seq: u64,
    image: Arc<ColorImage>,
    textures: Arc<Mutex<Textures>>,
}

/// The textures of one key, at most one per kind of sampling, each with the seq that it shows.
#[derive(Default)]
struct Textures {
    smooth: Option<(u64, TextureHandle)>,
    pixels: Option<(u64, TextureHandle)>,
    uploads: u64,
}

impl Picture {
    /// Counts up when the content changes.
    pub fn seq(&self) -> u64 {
        self.seq
    }

    /// Width and height in pixels.
    pub fn size_px(&self) -> [usize; 2] {
        self.image.size
    }

    /// The pixels.
    pub fn image(&self) -> &Arc<ColorImage> {
        &self.image
    }

    /// The texture to draw; uploads the pixels if this texture does not show them yet.
    pub fn texture(&self, ctx: &Context, sampling: Sampling) -> TextureId {
        let mut textures = self.textures.lock();
        let Textures { smooth, pixels, uploads } = &mut *textures;
        let slot = match sampling {
            Sampling::Smooth => smooth,
            Sampling::Pixels => pixels,
        };
        match slot {
            Some((seq, handle)) if *seq == self.seq => handle.id(),
            Some((seq, handle)) => {
                *seq = self.seq;
                *uploads += 1;
                handle.set(Arc::clone(&self.image), sampling.options());
                handle.id()
            }
            None => {
                *uploads += 1;
                let handle = ctx.load_texture("picture", Arc::clone(&self.image), sampling.options());
                slot.insert((self.seq, handle)).1.id()
            }
        }
    }

    /// How often pixels went to the graphics card under this key.
    pub fn uploads(&self) -> u64 {
        self.textures.lock().uploads
    }
}

/// The pictures of a window by name. Converts and uploads a picture only when its `seq` changed.
///
/// Give every view its own key: `"left raw"`, `"right raw"`, `"depth"`.
#[derive(Default)]
pub struct TextureCache {
    pictures: HashMap<String, Picture>,
}

impl TextureCache {
    /// The picture under `key`; `make` is called only if `seq` differs from the stored one.
    pub fn get(&mut self, key: &str, seq: u64, make: impl FnOnce() -> ColorImage) -> &Picture {
        self.get_shared(key, seq, || Arc::new(make()))
    }

    /// As [`Self::get`], for images that another thread prepared.
    pub fn get_shared(&mut self, key: &str, seq: u64, make: impl FnOnce() -> Arc<ColorImage>) -> &Picture {
        let stored = self.pictures.entry(key.to_owned());
        match stored {
            std::collections::hash_map::Entry::Occupied(entry) => {
                let picture = entry.into_mut();
                if picture.seq != seq {
                    picture.seq = seq;
                    picture.image = make();
                }
                picture
            }
            std::collections::hash_map::Entry::Vacant(entry) => {
                entry.insert(Picture { seq, image: make(), textures: Arc::default() })
            }
        }
    }

    /// The picture of a camera image, 8-bit RGB.
    pub fn rgb(&mut self, key: &str, seq: u64, image: &RgbImage) -> &Picture {
        self.get(key, seq, || color_image(image))
    }

    /// The last picture under `key`, whatever its age.
    pub fn last(&self, key: &str) -> Option<&Picture> {
        self.pictures.get(key)
    }

    /// Frees what is stored under `key`.
    pub fn forget(&mut self, key: &str) {
        self.pictures.remove(key);
    }

    /// Frees everything.
    pub fn clear(&mut self) {
        self.pictures.clear();
    }
}

/// An 8-bit RGB image as egui wants it. About 0.3 ms for 640×480.
pub fn color_image(image: &RgbImage) -> ColorImage {
    ColorImage::from_rgb([image.width() as usize, image.height() as usize], image.as_raw())
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::Color32;

    fn one_color(color: Color32) -> ColorImage {
        ColorImage::filled([4, 3], color)
    }

    #[test]
    fn pixels_are_made_and_uploaded_once_per_seq() {
        let ctx = Context::default();
        let mut cache = TextureCache::default();
        let mut made = 0;
        for seq in [7, 7, 7, 8, 8] {
            let picture = cache.get("left", seq, || {
                made += 1;
                one_color(Color32::WHITE)
            });
            picture.texture(&ctx, Sampling::Smooth);
        }
        assert_eq!(made, 2);
        assert_eq!(cache.last("left").map(Picture::uploads), Some(2));
    }

    #[test]
    fn each_sampling_has_its_own_texture_of_the_same_seq() {
        let ctx = Context::default();
        let mut cache = TextureCache::default();
        let picture = cache.get("left", 1, || one_color(Color32::BLACK)).clone();
        let smooth = picture.texture(&ctx, Sampling::Smooth);
        let pixels = picture.texture(&ctx, Sampling::Pixels);
        assert_ne!(smooth, pixels);
        assert_eq!(picture.texture(&ctx, Sampling::Smooth), smooth);
        assert_eq!(picture.uploads(), 2);
    }

    #[test]
    fn keys_do_not_mix() {
        let mut cache = TextureCache::default();
        cache.get("left", 1, || one_color(Color32::WHITE));
        cache.get("right", 1, || one_color(Color32::BLACK));
        let color = |key| cache.last(key).map(|picture| picture.image().pixels[0]);
        assert_eq!((color("left"), color("right")), (Some(Color32::WHITE), Some(Color32::BLACK)));
        cache.forget("left");
        assert!(cache.last("left").is_none() && cache.last("right").is_some());
    }

    #[test]
    fn rgb_keeps_order_and_rows() {
        let image = RgbImage::from_fn(2, 2, |x, y| image::Rgb([x as u8, y as u8, 9]));
        let converted = color_image(&image);
        assert_eq!(converted[(1, 0)], Color32::from_rgb(1, 0, 9));
        assert_eq!(converted[(0, 1)], Color32::from_rgb(0, 1, 9));
    }
}
