//! What commissioning sees of the rest.

use plumbline_gap::Verdict;
use plumbline_model::StereoCalibration;
use plumbline_model::touchscreen::ScreenPlacement;
use plumbline_vision::mount::MountCalibration;

use super::State;
use super::rooms::{Neighbors, Rooms};
use crate::commission::view::{CommissionDone, CommissionFigure};
use crate::commission::{CommissionAround, CommissionWorkflow, Found, InUse};
use crate::gap::GapWorkflow;
use crate::grasp::view::AttemptView;
use crate::ground::World;
use crate::handeye::is_of_other_eyes;
use crate::handeye::view::HandEyeSummary;

impl Neighbors<CommissionWorkflow> for State {
    fn around(&self, world: World) -> CommissionAround {
        let Rooms { eyes, mount, touch, gap, handeye, grasp, .. } = &self.rooms;
        let (eyes, mount, touch) = (eyes.of(world), mount.of(world), touch.of(world));
        let is_stale = mount.stale(eyes.in_use().map(|eyes| &**eyes), eyes.accepted().is_some()).is_some();
        let model = gap.of(world).model();
        let is_of_others = is_of_other_eyes(model, self.models.of(world).rig());
        let hands = handeye.of(world).in_use(model).filter(|_| !is_of_others);
        CommissionAround {
            eyes: eyes.in_use().map(|calibration| of_eyes(calibration)),
            // What was made with other eyes has to be made again.
            mount: mount.in_use().filter(|_| !is_stale).map(|calibration| of_mount(calibration)),
            screen: touch.placement().map(of_screen),
            run: touch.run_standing(),
            found: of_gap(gap.of(world)),
            effects: InUse { names: gap.of(world).names_in_use(), told: gap.of(world).effects_told() },
            hands: hands.map(|seen| of_hands(seen)),
            held: grasp.of(world).held_last().map(of_grasp),
            views: eyes.pair_count() + mount.view_count(),
        }
    }
}

fn of_eyes(calibration: &StereoCalibration) -> CommissionDone {
    let figure = match &calibration.summary {
        Some(summary) => {
            CommissionFigure::Pixels(summary.cross_validated_px.unwrap_or(summary.rms_stereo_px))
        }
        None => CommissionFigure::Unknown,
    };
    CommissionDone { at: calibration.evidence.as_ref().map(|evidence| evidence.created), figure }
}

fn of_mount(calibration: &MountCalibration) -> CommissionDone {
    let figure = CommissionFigure::Pixels(calibration.rms_px);
    CommissionDone { at: Some(calibration.evidence.created), figure }
}

fn of_screen(placement: &ScreenPlacement) -> CommissionDone {
    let is_doubtful = !placement.doubts().is_empty();
    let figure = CommissionFigure::Placed { rms_m: placement.rms_m, touches: placement.touches, is_doubtful };
    CommissionDone { at: Some(placement.at), figure }
}

fn of_gap(gap: &GapWorkflow) -> Option<Found> {
    let (shown, is_open) = gap.found()?;
    let figure = match shown.finding.verdict {
        Verdict::NotInLibrary => CommissionFigure::NotInLibrary,
        _ => CommissionFigure::Effects(gap.effects_told()),
    };
    let done = CommissionDone { at: Some(shown.entry.made), figure };
    Some(Found { sessions: shown.folders.clone(), is_open, done })
}

fn of_hands(seen: &HandEyeSummary) -> CommissionDone {
    let figure = seen.error_m().map_or(CommissionFigure::Unknown, |[before_m, after_m]| {
        CommissionFigure::Seen { before_m, after_m }
    });
    CommissionDone { at: Some(seen.at), figure }
}

fn of_grasp(attempt: &AttemptView) -> CommissionDone {
    let figure = CommissionFigure::Held(attempt.object.clone());
    CommissionDone { at: Some(attempt.began), figure }
}
