//! Synthetic eyes in front of a board or a table, and a state that is driven without threads.

use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use image::{DynamicImage, RgbImage};
use nalgebra::Point3;
use plumbline_engine::eyes::CornersStage;
use plumbline_engine::eyes::place::pose_at;
use plumbline_engine::ground::Time;
use plumbline_engine::ground::stage::{Stage, Timed};
use plumbline_engine::live::{ProbeStage, RectifyStage};
use plumbline_engine::robot::RobotControl;
use plumbline_engine::state::State;
use plumbline_engine::view::SourceView;
use plumbline_engine::{Action, Command, Skipped, View};
use plumbline_model::{
    CameraModel, Chessboard, Eye, ModelKind, Stamp, StereoCameras, StereoFrame, Unattended,
};
use plumbline_vision::synthetic::{Plane, Scene, chessboard_texture, granite_texture, nico_like_eyes};

/// 7×5 squares: few corners, so that tests are fast.
pub fn board() -> Chessboard {
    Chessboard { inner_columns: 6, inner_rows: 4, square_m: 0.04 }
}

/// Eyes like NICO's at half the resolution, so that tests are fast.
pub fn eyes() -> StereoCameras {
    let mut eyes = nico_like_eyes();
    for camera in [&mut eyes.left, &mut eyes.right] {
        let mut parameters = camera.model.parameters();
        for scaled in &mut parameters[..2] {
            *scaled *= 0.5;
        }
        for center in &mut parameters[2..4] {
            *center = 0.5 * (*center + 0.5) - 0.5;
        }
        camera.model = CameraModel::from_parameters(ModelKind::Fisheye, &parameters);
        (camera.width_px, camera.height_px) = (320, 240);
    }
    eyes
}

/// Places of the board: over the image, near and far, tilted. x, y, z in meters of the left eye;
/// top away, left away in radians.
const PLACES: [(f64, f64, f64, f64, f64); 12] = [
    (0.00, 0.00, 0.30, 0.0, 0.0),
    (0.15, 0.05, 0.30, 0.5, 0.0),
    (-0.15, 0.05, 0.25, -0.5, 0.0),
    (0.10, -0.12, 0.32, 0.0, 0.5),
    (-0.10, -0.10, 0.25, 0.0, -0.5),
    (0.00, 0.15, 0.25, 0.4, 0.3),
    (0.25, 0.00, 0.35, -0.3, 0.4),
    (-0.25, 0.02, 0.32, 0.3, -0.4),
    (0.05, 0.05, 0.40, 0.5, 0.2),
    (-0.02, -0.02, 0.20, 0.2, 0.2),
    (0.12, 0.12, 0.35, -0.4, -0.2),
    (-0.18, 0.15, 0.32, 0.2, 0.5),
];

/// Pairs of the board as the eyes of NICO would see it, with a little noise.
pub fn board_pairs() -> &'static [StereoFrame] {
    static PAIRS: OnceLock<Vec<StereoFrame>> = OnceLock::new();
    PAIRS.get_or_init(|| {
        let pair = |(i, &(x, y, z, up_down, left_right)): (usize, &(f64, f64, f64, f64, f64))| {
            let pose = pose_at(&board(), &Point3::new(x, y, z), up_down, left_right).expect("a pose");
            let plane = Plane::new(pose.isometry, chessboard_texture(&board()));
            frame(
                &Scene { planes: vec![plane], background: 110.0, ..Scene::default() },
                &format!("{i:02}.png"),
                i as u64,
            )
        };
        PLACES.iter().enumerate().map(pair).collect()
    })
}

/// A granite wall 0.4 m ahead of the left eye, across its axis.
pub fn wall_pair() -> StereoFrame {
    let left_from_plane = nalgebra::Isometry3::translation(0.0, 0.0, WALL_M);
    let plane = Plane::new(left_from_plane, granite_texture(0.006, 5));
    frame(&Scene { planes: vec![plane], background: 0.0, ..Scene::default() }, "wall.png", 99)
}

pub const WALL_M: f64 = 0.4;

fn frame(scene: &Scene, name: &str, seed: u64) -> StereoFrame {
    let (left, right) = scene.render_pair(&eyes(), 1.5, seed);
    let rgb = |gray| Arc::new(DynamicImage::ImageLuma8(gray).into_rgb8());
    StereoFrame {
        stamp: Stamp { seq: 0, captured_at: Instant::now() },
        left: rgb(left),
        right: rgb(right),
        time_difference_s: None,
        name: Some(name.to_owned()),
        beside: Default::default(),
    }
}

/// The pair with left and right exchanged.
pub fn swapped(frame: &StereoFrame) -> StereoFrame {
    StereoFrame { left: frame.right.clone(), right: frame.left.clone(), ..frame.clone() }
}

/// The pair at another size.
pub fn resized(frame: &StereoFrame, (width, height): (u32, u32)) -> StereoFrame {
    let resize = |image: &RgbImage| {
        Arc::new(image::imageops::resize(image, width, height, image::imageops::FilterType::Triangle))
    };
    StereoFrame { left: resize(&frame.left), right: resize(&frame.right), ..frame.clone() }
}

/// Writes pairs as a folder with `left` and `right`.
pub fn write_pairs(folder: &Path, pairs: &[StereoFrame]) {
    for eye in Eye::BOTH {
        let side = folder.join(eye.to_string());
        std::fs::create_dir_all(&side).expect("a folder");
        for pair in pairs {
            let image = if eye == Eye::Left { &pair.left } else { &pair.right };
            image.save(side.join(pair.name.as_deref().expect("a name"))).expect("written");
        }
    }
}

/// A state with everything that happens beside it done at once.
pub struct Desk {
    pub state: State,
    pub corners: CornersStage,
    pub rectify: RectifyStage,
    pub probe: ProbeStage,
    pub seq: u64,
    /// What would be handed to the source thread.
    pub to_source: Vec<plumbline_engine::Control>,
    /// What would be handed to the robot's thread.
    pub to_robot: Vec<RobotControl>,
    /// Work is left alone until [`Desk::work`] is called.
    pub hold_work: bool,
    /// What time it is; `None`: that of the system.
    pub time: Option<Time>,
}

impl Desk {
    /// Starts with what was accepted in this folder, looking at a folder of photographs.
    pub fn new(data_dir: &Path) -> Self {
        let mut desk = Self {
            state: State::new(data_dir),
            corners: CornersStage::default(),
            rectify: RectifyStage::default(),
            probe: ProbeStage::default(),
            seq: 0,
            to_source: Vec::new(),
            to_robot: Vec::new(),
            hold_work: false,
            time: None,
        };
        desk.state.source_changed(SourceView {
            description: "synthetic pairs".to_owned(),
            photographs: true,
            ..SourceView::default()
        });
        desk.work();
        desk
    }

    /// Applies a command and what follows from it.
    pub fn apply(&mut self, command: impl Into<Command>) {
        self.state.hold_time(self.time);
        self.state.apply(command.into());
        self.react();
    }

    fn now(&self) -> Instant {
        self.time.map_or_else(Instant::now, |time| time.instant)
    }

    /// Shows a pair.
    pub fn show(&mut self, pair: &StereoFrame) {
        let mut pair = pair.clone();
        let now = self.now();
        pair.stamp = Stamp { seq: self.seq, captured_at: now };
        self.seq += 1;
        self.state.hold_time(self.time);
        self.state.frame(0, pair, now);
        self.react();
    }

    fn react(&mut self) {
        let now = self.now();
        if let Some(input) = self.state.corners_input() {
            let stamp = input.frame.stamp;
            let result = self.corners.process(input);
            self.state.looked(Timed { stamp, busy: Duration::ZERO, result }, now);
        }
        if let Some(input) = self.state.rectify_input() {
            let stamp = input.frame.stamp;
            let result = self.rectify.process(input);
            self.state.rectified(Timed { stamp, busy: Duration::ZERO, result }, now);
        }
        if let Some(input) = self.state.probe_input() {
            let stamp = input.frame.stamp;
            let result = self.probe.process(input);
            self.state.probed(Timed { stamp, busy: Duration::ZERO, result }, now);
        }
        if !self.hold_work {
            self.work();
        }
    }

    /// Does all work that was asked for.
    pub fn work(&mut self) {
        loop {
            let actions = self.state.take_actions();
            if actions.is_empty() {
                return;
            }
            for action in actions {
                match action {
                    // No robot takes part in these workflows; what it would be told is kept.
                    Action::Robot(control) => self.to_robot.push(control),
                    Action::Start(id, work) => {
                        self.state.work_ended(id, work.run(&Unattended).into(), Duration::ZERO);
                    }
                    Action::Source(control) => self.to_source.push(control),
                    Action::Cancel(_) => {}
                }
            }
        }
    }

    /// What the window would show.
    pub fn view(&mut self) -> View {
        self.state.view(Skipped::default(), 0, self.now())
    }

    /// The newest message.
    pub fn last_notice(&mut self) -> String {
        self.view().notices.last().map(|notice| notice.text.clone()).unwrap_or_default()
    }
}
