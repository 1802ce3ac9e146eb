//! A folder with all that verbs need, made up, and the program on it.

use std::collections::BTreeMap;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use plumbline_model::robot::{Posture, Rig};
use plumbline_model::session::{Chain, Manifest, TouchRow, TouchTable};
use plumbline_model::{Pixel, Point, Session};

/// Nothing that is asked for here takes longer, also on a busy machine.
const PATIENCE: Duration = Duration::from_secs(240);
const TIP: &str = "right_index_tip";
const JOINTS: [&str; 6] = ["r_shoulder_z", "r_shoulder_y", "r_arm_x", "r_elbow_y", "r_wrist_z", "r_wrist_x"];

/// A folder of its own for one test.
pub struct Desk(tempfile::TempDir);

/// How a run ended.
pub struct Ended {
    /// Exit status; `None` after a kill.
    pub status: Option<i32>,
    /// Everything it said.
    pub said: String,
    /// How long it took.
    pub took: Duration,
}

impl Desk {
    /// With a session of touches in `s`.
    pub fn new() -> Self {
        let desk = Self(tempfile::tempdir().expect("a folder"));
        session().write(&desk.path("s")).expect("written");
        desk
    }

    /// With eight pairs of a chessboard and three of a table besides.
    pub fn with_pairs() -> Self {
        let desk = Self::new();
        for file in files(pairs()).into_keys() {
            let to = desk.path("lab").join(&file);
            std::fs::create_dir_all(to.parent().expect("below")).expect("a folder");
            std::fs::copy(pairs().join(&file), to).expect("copied");
        }
        desk
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let file = self.path(name);
        std::fs::create_dir_all(file.parent().expect("below the folder")).expect("a folder");
        std::fs::write(&file, bytes).expect("written");
        file
    }

    /// The program in this folder; `words` are divided at spaces.
    pub fn command(&self, words: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_plumbline"));
        self.prepare(&mut command).args(words.split_whitespace());
        command
    }

    /// The same where no file can grow beyond so many bytes: as on a full disk, a write fails in the
    /// middle, but for this process alone.
    pub fn command_on_full_disk(&self, words: &str, bytes: u32) -> Command {
        let mut command = Command::new("bash");
        let program = env!("CARGO_BIN_EXE_plumbline");
        // Blocks of 1024 bytes; without the trap the signal would end the program.
        let script = format!("trap '' XFSZ; ulimit -f {}; exec '{program}' {words}", bytes / 1024);
        self.prepare(&mut command).args(["-c", &script]);
        command
    }

    fn prepare<'a>(&self, command: &'a mut Command) -> &'a mut Command {
        let home = self.path(".home");
        std::fs::create_dir_all(&home).expect("a folder");
        command
            .current_dir(self.0.path())
            .env("HOME", &home)
            .env("XDG_CACHE_HOME", &home)
            .env("XDG_DATA_HOME", &home)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
    }

    pub fn run(&self, words: &str) -> Ended {
        ended(self.command(words))
    }

    /// All files with their contents, but those that are hidden.
    pub fn files(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        files(self.0.path())
    }

    /// Runs what must be refused: exit status 1, these words, and every file as it was.
    pub fn refuses(&self, words: &str, reason: &str) {
        let before = self.files();
        let ended = self.run(words);
        assert_eq!(ended.status, Some(1), "{words}: {}", ended.said);
        assert!(ended.said.contains(reason), "{words}: {}", ended.said);
        assert!(ended.took < Duration::from_secs(10), "{words} took {:?}", ended.took);
        assert!(self.files() == before, "{words} changed files");
    }
}

/// Waits for the end; a run that hangs is ended and told.
pub fn ended(mut command: Command) -> Ended {
    let began = Instant::now();
    let mut child = command.spawn().expect("the program starts");
    let read = |mut pipe: Box<dyn std::io::Read + Send>| {
        let reader = std::thread::Builder::new().name("what it says".to_owned());
        let read = move || {
            let mut bytes = vec![];
            let _ = pipe.read_to_end(&mut bytes);
            String::from_utf8_lossy(&bytes).into_owned()
        };
        reader.spawn(read).expect("a thread")
    };
    let out = read(Box::new(child.stdout.take().expect("piped")));
    let err = read(Box::new(child.stderr.take().expect("piped")));
    let status = loop {
        if let Some(status) = child.try_wait().expect("a child") {
            break status;
        }
        if began.elapsed() > PATIENCE {
            child.kill().expect("ended");
            panic!("{command:?} did not end");
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    let said = out.join().expect("read") + &err.join().expect("read");
    Ended { status: status.code(), said, took: began.elapsed() }
}

/// Files below a folder by their paths in it, but those that are hidden.
pub fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(at) = folders.pop() {
        for entry in std::fs::read_dir(at).expect("a folder").map(|entry| entry.expect("an entry")) {
            if entry.file_name().as_encoded_bytes().starts_with(b".") {
                continue;
            }
            let about = std::fs::metadata(entry.path());
            match about {
                Ok(about) if about.is_dir() => folders.push(entry.path()),
                Ok(about) if about.is_file() => {
                    let mut bytes = vec![];
                    let file = std::fs::File::open(entry.path()).expect("readable");
                    file.take(100_000_000).read_to_end(&mut bytes).expect("read");
                    found.insert(entry.path().strip_prefix(folder).expect("inside").to_owned(), bytes);
                }
                _ => {}
            }
        }
    }
    found
}

/// Pairs of a made-up lab, drawn once.
fn pairs() -> &'static Path {
    static PAIRS: OnceLock<tempfile::TempDir> = OnceLock::new();
    PAIRS
        .get_or_init(|| {
            let folder = tempfile::tempdir().expect("a folder");
            let made: Output = Command::new(env!("CARGO_BIN_EXE_plumbline"))
                .args(["sample", "--pairs", "8", "--out"])
                .arg(folder.path())
                .output()
                .expect("the program starts");
            assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
            folder
        })
        .path()
}

/// Touches whose elbow is 0.03 rad off, and points that were sent to hit pixels.
fn session() -> Session {
    let rig = Rig::built_in("nico").expect("comes with the program");
    let chain = rig.chain(TIP).expect("a tip");
    let screen = rig.touchscreen.clone();
    let joints: Vec<_> = JOINTS.map(|name| rig.description.find_joint(name).expect("a joint")).to_vec();
    let [base, spread] = [[-0.03, 0.31, 0.44, 1.55, 1.07, 0.73], [0.35, 0.0, 0.12, 0.25, 0.3, 0.15]];
    let mut dice = Dice(7);
    let mut rows = vec![];
    for place in 0..24 {
        let angles: Vec<f64> = (0..6).map(|j| base[j] + spread[j] * dice.around()).collect();
        let mut posture: Posture = rig.home();
        for ((joint, name), angle) in joints.iter().zip(JOINTS).zip(&angles) {
            posture[*joint] = angle + if name == "r_elbow_y" { 0.03 } else { 0.0 };
        }
        let tip = chain.robot_from_tip_in(&posture).isometry.translation.vector;
        for _ in 0..2 {
            let mut near = |value: f64| value + 0.0008 * dice.around();
            let pixel = screen.pixel_at(Point::new(near(tip.x), near(tip.y), near(tip.z)));
            let target = screen.origin.coords.coords
                + screen.u_axis.vector() * (pixel.u_px * screen.width_m / f64::from(screen.width_px))
                + screen.v_axis.vector() * (pixel.v_px * screen.height_m / f64::from(screen.height_px));
            rows.push(TouchRow {
                commanded_rad: angles.iter().copied().map(Some).collect(),
                encoder_rad: angles.iter().copied().map(Some).collect(),
                touch: Some(Pixel::new(pixel.u_px, pixel.v_px)),
                target: Some(Point::new(target.x + 0.004, near(target.y), target.z + 0.002)),
                group: Some(format!("p{place}")),
                approach: Some(["plus", "minus"][place % 2].to_owned()),
                set: Some(format!("s{}", place / 4)),
                ..TouchRow::default()
            });
        }
    }
    let names: Vec<String> = JOINTS.map(str::to_owned).to_vec();
    let manifest = Manifest {
        notes: "made up".to_owned(),
        touchscreen: Some(screen),
        chain: Some(Chain { tip: TIP.to_owned(), joints: names.clone() }),
        ..Manifest::of_rig("nico", "2026-05-01T10:00:00Z".parse().expect("a time"))
    };
    Session { touches: Some(TouchTable::from_rows(names, &rows)), ..Session::new(manifest) }
}

/// Numbers that are the same in every run.
pub struct Dice(pub u64);

impl Dice {
    /// 0 to 1.
    pub fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / f64::from(1u32 << 31)
    }

    /// −1 to 1.
    pub fn around(&mut self) -> f64 {
        2.0 * self.share() - 1.0
    }
}
