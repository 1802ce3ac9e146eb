//! After the first images a detector allocates nothing (counted on the Rust side; what ONNX
//! Runtime and OpenCV do inside is theirs).
#![expect(unsafe_code, reason = "an allocator that counts can be written in no other way")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::path::Path;

use image::{Rgb, RgbImage};
use plumbline_vision::detect::{DetectSettings, Detector, DetectorOptions};

thread_local! {
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

struct Counting;

// SAFETY: everything is handed to the system's allocator as it comes.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // A thread that ends has no counter any more, and is not counted.
        let _ = COUNT.try_with(|count| count.set(count.get() + 1));
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn nothing_is_allocated_after_the_first_images() {
    std::hint::black_box(Vec::<u8>::with_capacity(1));
    assert!(COUNT.get() > 0, "this test must be able to see an allocation");
    let settings = DetectSettings::default();
    let pictures: Vec<RgbImage> = (0..3u8)
        .map(|i| RgbImage::from_fn(640, 480, |x, y| Rgb([x as u8 ^ i, y as u8, (x + y) as u8])))
        .collect();
    for name in ["raw", "transposed", "float16", "mixed", "end-to-end", "seeing", "seeing-any-size"] {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/detectors").join(format!("{name}.onnx"));
        let mut detector = Detector::open(&file, &DetectorOptions::default()).expect("a detector");
        let mut found = Vec::new();
        for picture in &pictures {
            detector.detect(picture, &settings, &mut found).expect("it runs");
        }
        let before = COUNT.get();
        for picture in pictures.iter().cycle().take(20) {
            detector.detect(picture, &settings, &mut found).expect("it runs");
        }
        let allocated = COUNT.get() - before;
        assert_eq!(allocated, 0, "{name}: {allocated} allocations in 20 images");
    }
}
