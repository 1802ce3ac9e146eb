//! Pictures and the textures they live in. Pixels are uploaded only when they changed and only
//! when they are drawn.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

use egui::mutex::Mutex;
use egui::{ColorImage, Context, TextureFilter, TextureHandle, TextureId, TextureOptions, TextureWrapMode};
use image::{GrayImage, RgbImage};

use crate::seen::Seen;

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
    of: Of,
    /// Counts up when the content changes.
    change: u64,
    image: Arc<ColorImage>,
    textures: Arc<Mutex<Textures>>,
}

/// What a picture was made from: what tells its content from another.
#[derive(Clone, PartialEq)]
enum Of {
    Seq(u64),
    Rgb(Seen<RgbImage>),
    Gray(Seen<GrayImage>),
}

/// The textures of one key, at most one per kind of sampling, each with the change that it shows.
#[derive(Default)]
struct Textures {
    smooth: Option<(u64, TextureHandle)>,
    pixels: Option<(u64, TextureHandle)>,
    uploads: u64,
}

impl Picture {
    /// The number that its content is told by; `None` where an image itself tells.
    pub fn seq(&self) -> Option<u64> {
        if let Of::Seq(seq) = self.of { Some(seq) } else { None }
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
            Some((shown, handle)) if *shown == self.change => handle.id(),
            Some((shown, handle)) => {
                *shown = self.change;
                *uploads += 1;
                handle.set(Arc::clone(&self.image), sampling.options());
                handle.id()
            }
            None => {
                *uploads += 1;
                let handle = ctx.load_texture("picture", Arc::clone(&self.image), sampling.options());
                slot.insert((self.change, handle)).1.id()
            }
        }
    }

    /// How often pixels went to the graphics card under this key.
    pub fn uploads(&self) -> u64 {
        self.textures.lock().uploads
    }
}

/// The pictures of a window by name. Converts and uploads a picture only when its content changed:
/// that is told by a `seq`, or by the image that it was made from.
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
        self.made(key, Of::Seq(seq), make)
    }

    /// The picture of a camera image, 8-bit RGB.
    pub fn rgb(&mut self, key: &str, seq: u64, image: &RgbImage) -> &Picture {
        self.get(key, seq, || color_image(image))
    }

    /// The picture of an image that never changes, told from others by itself.
    pub fn rgb_of(&mut self, key: &str, image: &Arc<RgbImage>) -> &Picture {
        self.made(key, Of::Rgb(Seen::of(image)), || Arc::new(color_image(image)))
    }

    /// As [`Self::rgb_of`], for a gray image.
    pub fn gray_of(&mut self, key: &str, image: &Arc<GrayImage>) -> &Picture {
        self.made(key, Of::Gray(Seen::of(image)), || {
            Arc::new(ColorImage::from_gray([image.width() as usize, image.height() as usize], image.as_raw()))
        })
    }

    fn made(&mut self, key: &str, of: Of, make: impl FnOnce() -> Arc<ColorImage>) -> &Picture {
        match self.pictures.entry(key.to_owned()) {
            Entry::Occupied(entry) => {
                let picture = entry.into_mut();
                if picture.of != of {
                    picture.of = of;
                    picture.change += 1;
                    picture.image = make();
                }
                picture
            }
            Entry::Vacant(entry) => {
                entry.insert(Picture { of, change: 0, image: make(), textures: Arc::default() })
            }
        }
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

    /// Images that are gone before the next one comes, so that an allocator puts it where the last
    /// one lay.
    #[test]
    fn an_image_at_an_address_that_was_used_before_is_another_picture() {
        let mut cache = TextureCache::default();
        for level in 0..200 {
            let image = Arc::new(RgbImage::from_pixel(4, 3, image::Rgb([level, 0, 0])));
            let shown = cache.rgb_of("thumbnail 1", &image).image().pixels[0];
            assert_eq!(shown, Color32::from_rgb(level, 0, 0));
            let image = Arc::new(GrayImage::from_pixel(4, 3, image::Luma([level])));
            let shown = cache.gray_of("chosen left", &image).image().pixels[0];
            assert_eq!(shown, Color32::from_gray(level));
        }
    }

    #[test]
    fn an_image_is_uploaded_once_and_a_number_tells_nothing_of_an_image() {
        let ctx = Context::default();
        let mut cache = TextureCache::default();
        let image = Arc::new(RgbImage::new(4, 3));
        for _ in 0..3 {
            cache.rgb_of("left", &image).texture(&ctx, Sampling::Smooth);
        }
        assert_eq!(cache.last("left").map(|picture| (picture.uploads(), picture.seq())), Some((1, None)));
        for seq in [0, 1] {
            cache.rgb("left", seq, &image).texture(&ctx, Sampling::Smooth);
        }
        assert_eq!(cache.last("left").map(|picture| (picture.uploads(), picture.seq())), Some((3, Some(1))));
    }

    #[test]
    fn rgb_keeps_order_and_rows() {
        let image = RgbImage::from_fn(2, 2, |x, y| image::Rgb([x as u8, y as u8, 9]));
        let converted = color_image(&image);
        assert_eq!(converted[(1, 0)], Color32::from_rgb(1, 0, 9));
        assert_eq!(converted[(0, 1)], Color32::from_rgb(0, 1, 9));
    }
}
