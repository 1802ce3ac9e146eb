//! What watching drift sees of the rest.

use std::sync::Arc;
use std::time::{Duration, Instant};

use nalgebra::Matrix3;
use plumbline_drift::{Reference, ReferenceKind};
use plumbline_effects::{RobotModel, SeenUnder};
use plumbline_model::robot::Posture;
use plumbline_model::{Eye, Pixel, Point, Raw, Robot, StereoFrame};

use crate::detect::view::{DetectionsView, ObjectView};
use crate::ground::World;
use crate::robot::view::{MotionState, RobotView};
use crate::twin::view::TwinView;

/// Detections of pairs that are this far from the one that is looked at are of it still.
const SAME_MOMENT: Duration = Duration::from_secs(2);
/// Half the side of the square around a resting hand, m.
const HAND_M: f64 = 0.04;
/// A box is larger than the thing: what lies in its corners is the table.
const BOX_SHARE: f64 = 0.8;

/// The chessboard as both eyes saw it.
#[derive(Clone, Debug, PartialEq)]
pub struct BoardAt {
    /// When.
    pub captured_at: Instant,
    /// Its outermost corners in the left and the right image, in order around it.
    pub outlines: [[Pixel<Raw>; 4]; 2],
}

/// What the workflow can see of the rest.
#[derive(Clone, Debug)]
pub struct DriftAround {
    /// Whether a source delivers pairs.
    pub is_live: bool,
    /// Whether it was recorded at another time.
    pub is_recorded: bool,
    /// How the head stood in the newest pair of a recording, pan and tilt, rad; `None`: it does not say.
    pub recorded_head_rad: Option<[f64; 2]>,
    /// Which source, counted.
    pub opened: u64,
    /// The robot as it is known in the world that is shown.
    pub model: Arc<RobotModel>,
    /// Whether the source shows what the connected robot sees.
    pub own_eyes: bool,
    /// The robot.
    pub robot: Arc<RobotView>,
    /// Time since the eyes were switched on, s.
    pub eyes_on_s: Option<f64>,
    /// Counts how often that time was set, by the operator or because cameras were away.
    pub clock_settings: u64,
    /// Whether a calibration of the eyes is in use; how warm they were, the model says.
    pub is_calibrated: bool,
    /// Whether a calibrated mount is.
    pub is_mounted: bool,
    /// How many times faster than a clock the eyes' one runs; 1 but for a twin that was asked to.
    pub clock_pace: f64,
    /// The world that is shown, where the arm is of it, too.
    pub world: Option<World>,
    /// The twin, where it is what is shown.
    pub twin: Option<Arc<TwinView>>,
    /// What the detector found last.
    pub found: Option<Arc<DetectionsView>>,
    /// Where the chessboard was seen last.
    pub board: Option<BoardAt>,
}

impl DriftAround {
    /// Why it cannot look now, a sentence.
    pub(super) fn waits_because(&self) -> Option<&'static str> {
        if !self.is_live {
            return Some("No pairs come: open the eyes, or let the recording play.");
        }
        if !self.own_eyes || !self.robot.connection.is_connected() {
            return None;
        }
        if matches!(self.robot.motion, MotionState::Moving { .. }) {
            return Some("The arm moves: it looks again when it rests.");
        }
        let eyes = &self.model.rig().eyes;
        self.robot
            .known(&[eyes.pan, eyes.tilt])
            .is_none()
            .then_some("It is not known how the head stands: look at its servos on the screen Robot.")
    }

    /// Angles of all joints; a robot that is not connected stands as usual, with the head of a recording as it stood.
    pub(super) fn posture(&self) -> Posture {
        if let Some(head_rad) = &self.recorded_head_rad {
            let rig = self.model.rig();
            return rig.home().with(&[rig.eyes.pan, rig.eyes.tilt], head_rad);
        }
        let connected = self.own_eyes && self.robot.connection.is_connected();
        let measured = self.robot.measured.clone().filter(|_| connected);
        measured.unwrap_or_else(|| self.model.rig().home())
    }

    /// The touchscreen, the board and things that were seen just now, and hands whose joints are known.
    pub(super) fn references(&self, frame: &StereoFrame) -> Vec<Reference> {
        let posture = self.posture();
        let mut references: Vec<Reference> = self.hands(&posture);
        let is_of_now = |seen: Instant| {
            let now = frame.stamp.captured_at;
            seen.max(now).duration_since(seen.min(now)) < SAME_MOMENT
        };
        // The board lies on top of what is below it.
        if let Some(board) = self.board.as_ref().filter(|board| is_of_now(board.captured_at)) {
            references.extend(self.board(board, &posture));
        }
        if let Some(found) = self.found.as_ref().filter(|found| is_of_now(found.stamp.captured_at)) {
            references.extend(things(&found.objects));
        }
        let screen = self.model.touchscreen();
        let middle = screen.point_at(screen.middle());
        let corners = screen.corners();
        references.extend(self.outlined("Touchscreen", ReferenceKind::Screen, middle, &corners, &posture));
        references
    }

    /// `None`: the eyes do not agree where it is.
    fn board(&self, board: &BoardAt, posture: &Posture) -> Option<Reference> {
        let [left, right] = &board.outlines;
        let in_left = self.model.rig().eyes.cameras.triangulate(left[0], right[0])?;
        let seen = SeenUnder { t_secs: self.eyes_on_s, ..SeenUnder::default() };
        let place = self.model.place(&in_left, &Matrix3::zeros(), posture, &seen)?.point;
        let outlines = [left.to_vec(), right.to_vec()];
        Some(Reference { name: "Board".to_owned(), kind: ReferenceKind::Thing, place, outlines })
    }

    fn hands(&self, posture: &Posture) -> Vec<Reference> {
        if !self.own_eyes || !self.robot.connection.is_connected() {
            return Vec::new();
        }
        let rig = self.model.rig();
        let known = |joints: &[_]| self.robot.known(joints).is_some();
        let links = rig.description.forward(posture);
        let arms = rig.arms.iter().filter(|arm| known(&arm.joints) && known(&arm.hand));
        let hand = |arm: &plumbline_model::robot::Arm| {
            let link = rig.description.find_link(&arm.tips.first()?.link).ok()?;
            let at = links.of(link).translation_m();
            let corner = |[dy, dz]: [f64; 2]| Point::new(at.x, at.y + HAND_M * dy, at.z + HAND_M * dz);
            let corners = [[1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]].map(corner);
            let place = Point::new(at.x, at.y, at.z);
            self.outlined(&format!("{} hand", arm.title), ReferenceKind::Hand, place, &corners, posture)
        };
        arms.filter_map(hand).collect()
    }

    /// `None`: an eye does not see all corners.
    fn outlined(
        &self,
        name: &str,
        kind: ReferenceKind,
        place: Point<Robot>,
        corners: &[Point<Robot>],
        posture: &Posture,
    ) -> Option<Reference> {
        let seen = SeenUnder { t_secs: self.eyes_on_s, ..SeenUnder::default() };
        let pairs: Option<Vec<_>> =
            corners.iter().map(|corner| self.model.project(corner, posture, &seen)).collect();
        let (left, right) = pairs?.into_iter().unzip();
        Some(Reference { name: name.to_owned(), kind, place, outlines: [left, right] })
    }
}

/// Things that both eyes see, with their places; of several of a class the surest.
fn things(objects: &[ObjectView]) -> Vec<Reference> {
    let mut all: Vec<Reference> = Vec::new();
    for object in objects {
        let (Some(left), Some(right), Ok(place)) =
            (object.seen(Eye::Left), object.seen(Eye::Right), &object.place)
        else {
            continue;
        };
        if all.iter().any(|known| known.name == object.name) {
            continue;
        }
        let outline = |area: &plumbline_model::PixelBox| -> Vec<Pixel<Raw>> {
            let middle = [0.5 * (area.x0_px + area.x1_px), 0.5 * (area.y0_px + area.y1_px)].map(f64::from);
            let half = [area.x1_px - area.x0_px, area.y1_px - area.y0_px]
                .map(|side| 0.5 * BOX_SHARE * f64::from(side));
            let corner = |[u, v]: [f64; 2]| Pixel::new(middle[0] + u * half[0], middle[1] + v * half[1]);
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(corner).to_vec()
        };
        all.push(Reference {
            name: object.name.clone(),
            kind: ReferenceKind::Thing,
            place: place.point_in_robot,
            outlines: [outline(&left.area), outline(&right.area)],
        });
    }
    all
}
