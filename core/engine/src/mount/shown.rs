//! What the window shows of the workflow.

use std::collections::BTreeSet;

use plumbline_model::counted;
use plumbline_vision::mount::{HeadView, MountCalibration, MountChange};

use super::tour::Tour;
use super::view::{HeadViewSummary, MountSummary, MountTour, MountView};
use super::workflow::{MountAround, MountWorkflow};
use crate::ground::step::StepState;

impl MountWorkflow {
    /// What the window shows.
    pub(super) fn shown(&self, around: &MountAround) -> MountView {
        MountView {
            step: self.step_state(around),
            can_undo: !self.deleted.is_empty(),
            views: self.views.iter().map(|view| self.summary(view, around)).collect(),
            is_solved: self.in_use.as_deref().is_some_and(|mount| self.is_of_these_views(mount)),
            planned: self.still_to_be_seen().into(),
            tour: self.tour.as_ref().map(|tour| self.tour_view(tour)),
            next: self.next(around),
            proposal: self.proposal.as_deref().map(summary),
            proposal_stale: self.proposal_stale().map(str::to_owned),
            in_use: self.in_use.as_deref().map(summary),
        }
    }

    /// Those of the planned poses that no tour has been to.
    pub(super) fn still_to_be_seen(&self) -> &[(f64, f64)] {
        self.planned.get(self.seen_so_far()..).unwrap_or_default()
    }

    /// How many of the planned poses were seen, in this tour and before it.
    pub(super) fn seen_so_far(&self) -> usize {
        let by_tour = |tour: &Tour| self.planned.len().saturating_sub(tour.remaining());
        self.tour.as_ref().map_or(self.seen, by_tour)
    }

    /// Why the proposal is none of the views that are here; `None`: it is, or nothing is proposed.
    pub(super) fn proposal_stale(&self) -> Option<&'static str> {
        let proposal = self.proposal.as_deref()?;
        (!self.is_of_these_views(proposal)).then_some(
            "The views are others than those that the proposed mount was solved from. Solve it again.",
        )
    }

    /// Whether a mount was solved from just the views that are here: then there is nothing to solve.
    fn is_of_these_views(&self, mount: &MountCalibration) -> bool {
        if self.views.is_empty() {
            return false;
        }
        let used = mount.per_view.iter().map(|fit| &fit.name);
        let used: BTreeSet<&String> = used.chain(mount.rejected.iter().map(|view| &view.name)).collect();
        self.views.len() == used.len() && self.views.iter().all(|view| used.contains(&view.name))
    }

    fn tour_view(&self, tour: &Tour) -> MountTour {
        let of = self.planned.len();
        let pose = (of + 1).saturating_sub(tour.remaining()).clamp(1, of.max(1));
        MountTour { pose, of, waits: tour.waits() }
    }

    fn step_state(&self, around: &MountAround) -> StepState {
        if self.tour.is_some() || self.solving.is_some() || self.waiting.is_some() {
            return StepState::Running;
        }
        match self.stale(around.calibration.as_deref(), around.is_eyes_known) {
            Some(why) => StepState::Stale { why: why.to_owned() },
            None if self.in_use.is_some() => StepState::Done,
            None => StepState::NotDone,
        }
    }

    fn next(&self, around: &MountAround) -> String {
        if let Some(tour) = &self.tour {
            if tour.waits() {
                return "The head holds because its joints were not heard: it turns on by itself once they are."
                    .to_owned();
            }
            return format!(
                "The head turns and looks: {} left. Only the head moves.",
                counted(tour.remaining(), "pose")
            );
        }
        if self.waiting.is_some() {
            return "The board is looked for in the next image.".to_owned();
        }
        if self.solving.is_some() {
            return "The mount is being solved.".to_owned();
        }
        if let Some(why) = self.proposal_stale() {
            return why.to_owned();
        }
        if self.proposal.is_some() {
            return "Compare the solution with the mount in use, then accept or discard it.".to_owned();
        }
        if around.calibration.is_none() {
            return "Calibrate the eyes first: step 1.".to_owned();
        }
        if around.robot.measured.is_none() {
            return "Connect to the robot or the twin: the head's angles have to be known.".to_owned();
        }
        let left = self.still_to_be_seen().len();
        if left == 0 && self.in_use.as_deref().is_some_and(|mount| self.is_of_these_views(mount)) {
            return "The mount of the eyes is in use. Plan head poses again when the head was taken apart."
                .to_owned();
        }
        if self.views.len() >= MountView::LEAST_VIEWS && left == 0 {
            return format!("{} taken. Solve the mount.", counted(self.views.len(), "view"));
        }
        if left == 0 {
            return "Plan the head poses. The board has to lie flat on the table, where both eyes see all of it."
                .to_owned();
        }
        format!("Turn the head to {}. Only the head moves.", counted(left, "pose"))
    }

    fn summary(&self, view: &HeadView, around: &MountAround) -> HeadViewSummary {
        let count = |corners: &Option<plumbline_model::Corners>| {
            corners.as_ref().map_or(0, |corners| corners.iter().flatten().count())
        };
        let fit = self.proposal.as_ref().or(self.in_use.as_ref());
        let fit = fit.and_then(|mount| mount.per_view.iter().find(|fit| fit.name == view.name));
        let rms_px = fit.and_then(|fit| match (fit.left_px, fit.right_px) {
            (Some(left), Some(right)) => Some((0.5 * (left * left + right * right)).sqrt()),
            (one, other) => one.or(other),
        });
        HeadViewSummary {
            name: view.name.clone(),
            pan_rad: view.posture[around.rig.eyes.pan],
            tilt_rad: view.posture[around.rig.eyes.tilt],
            corners: (count(&view.left), count(&view.right)),
            rms_px,
            is_colder: self.is_colder(&view.name),
        }
    }
}

fn summary(mount: &MountCalibration) -> MountSummary {
    let MountChange { moved_m, turned_rad } = mount.change;
    MountSummary {
        head_from_left: mount.head_from_left,
        moved_m: moved_m.into(),
        turned_rad: turned_rad.into(),
        moved_sd_m: mount.moved_sigma_m().into(),
        turned_sd_rad: mount.turned_sigma_rad().into(),
        rms_px: mount.rms_px,
        views: mount.per_view.len(),
        rejected: mount.rejected.iter().map(|view| (view.name.clone(), view.reason.clone())).collect(),
        not_seen: mount.not_seen.clone(),
        remarks: mount.remarks.clone(),
        at: mount.evidence.created,
    }
}
