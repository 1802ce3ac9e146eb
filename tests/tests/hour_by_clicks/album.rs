//! Pictures of the way for people: `PLUMBLINE_HOUR_PICTURES=FOLDER`, in the size `PLUMBLINE_HOUR_SIZE=1024x700` and
//! the theme `PLUMBLINE_HOUR_THEME=light`.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use plumbline_tests::Window;

/// Of the window, where nothing else is asked for.
const SIZE_PT: [f32; 2] = [1440.0, 900.0];

/// So often a picture is made while something is under way.
const EVERY: Duration = Duration::from_secs(25);

/// The size that is asked for, pt.
///
/// # Panics
/// When something else than a size is.
pub fn size_pt() -> [f32; 2] {
    let Some(asked) = std::env::var("PLUMBLINE_HOUR_SIZE").ok() else { return SIZE_PT };
    let (width, height) = asked.split_once('x').expect("a size like 1024x700");
    [width, height].map(|side| side.parse().expect("a size like 1024x700"))
}

/// Whether the light theme is asked for.
pub fn is_light() -> bool {
    std::env::var("PLUMBLINE_HOUR_THEME").is_ok_and(|theme| theme == "light")
}

/// Pictures in the order of the way.
#[derive(Debug)]
pub struct Album {
    /// `None`: nobody wants any.
    folder: Option<PathBuf>,
    count: usize,
    newest: Instant,
}

impl Album {
    /// An empty one, where pictures are wanted.
    pub fn new() -> Self {
        let folder = std::env::var_os("PLUMBLINE_HOUR_PICTURES").map(PathBuf::from);
        Self { folder, count: 0, newest: Instant::now() }
    }

    /// Whether anybody wants pictures.
    pub fn is_wanted(&self) -> bool {
        self.folder.is_some()
    }

    /// A picture of now, if pictures are wanted.
    pub fn picture(&mut self, window: &mut Window, of: &str) {
        let Some(folder) = &self.folder else { return };
        self.count += 1;
        let of = of.replace(|letter: char| !letter.is_ascii_alphanumeric(), "-");
        let file = folder.join(format!("{:03}-{of}.png", self.count));
        window.render().expect("drawn").save(file).expect("written");
        self.newest = Instant::now();
    }

    /// The same, if the newest is old.
    pub fn picture_now_and_then(&mut self, window: &mut Window, of: &str) {
        if self.newest.elapsed() > EVERY {
            self.picture(window, of);
        }
    }
}
