//! Where the screen lies.

use std::sync::Arc;

use plumbline_model::robot::Rig;
use plumbline_model::session::Touchscreen;
use plumbline_model::touch_plan::Purpose;
use plumbline_model::touchscreen::ScreenPlacement;

use super::super::placement::Proposal;
use super::super::refusal::{NotRestored, Refusal, Unplaced};
use super::super::store::Runs;
use super::super::work::{Context, TouchWork};
use super::{TouchAround, TouchWorkflow};
use crate::ground::notice::NoticeLevel;
use crate::motion::ScreenPlace;
use crate::rig_models::{screen_in, screens_in};

/// Said of a place that older touches give.
const OLDER: &str = "These touches are older than the place of the screen in use: if the screen was moved since, keep \
     the one in use";

impl TouchWorkflow {
    pub(super) fn accept_placement(&mut self, context: &mut Context<'_>) -> Result<(), Refusal> {
        self.no_run_under_way()?;
        let proposal = self.proposal.as_ref();
        let proposal = proposal.ok_or(Refusal::NoPlacement)?;
        let (kept, shelf) = (screen_in(&self.folder), screens_in(&self.folder));
        context.start(TouchWork::Accept { kept, shelf, placement: proposal.placement.clone() });
        Ok(())
    }

    pub(super) fn use_earlier(
        &mut self,
        id: String,
        around: &TouchAround,
        context: &mut Context<'_>,
    ) -> Result<(), Refusal> {
        self.no_run_under_way()?;
        let (kept, shelf) = (screen_in(&self.folder), screens_in(&self.folder));
        context.start(TouchWork::UseEarlier { id, shelf, kept, rig: around.rig.clone() });
        Ok(())
    }

    pub(super) fn use_nominal(&mut self, context: &mut Context<'_>) -> Result<(), Refusal> {
        self.no_run_under_way()?;
        context.start(TouchWork::Forget { kept: screen_in(&self.folder) });
        Ok(())
    }

    pub(super) fn restored(
        &mut self,
        placement: Option<Result<Arc<ScreenPlacement>, Arc<NotRestored>>>,
        runs: Runs,
        context: &mut Context<'_>,
    ) {
        self.runs = runs;
        match placement {
            None => self.is_known = true,
            Some(Ok(placement)) => (self.placement, self.is_known) = (Some(placement), true),
            Some(Err(reason)) => context.notices.add(NoticeLevel::Warning, reason.to_string()),
        }
    }

    pub(super) fn placed(&mut self, placed: Result<Proposal, Arc<Unplaced>>, context: &mut Context<'_>) {
        let in_use_since = self.placement.as_ref().map(|in_use| in_use.at);
        let run = self.run.as_mut();
        let wanted = run.as_ref().is_some_and(|run| run.plan.options.purpose == Purpose::PlaceScreen);
        match placed {
            Ok(mut proposal) => {
                if let Some(run) = run.filter(|run| run.session == proposal.session) {
                    let gave = run.progress.gave_placement;
                    if in_use_since.is_some_and(|since| run.progress.started < since && gave != Some(since)) {
                        // It goes first: nothing else matters where the screen was moved meanwhile.
                        Arc::make_mut(&mut proposal.placement).remarks.insert(0, OLDER.to_owned());
                    }
                    run.progress.gave_placement = Some(proposal.placement.at);
                    run.changed();
                }
                if let Some(trained) = &mut self.runs.trained
                    && trained.session == proposal.session
                {
                    trained.gave_placement = Some(proposal.placement.at);
                }
                self.proposal = Some(proposal);
            }
            Err(reason) if wanted => context.refuse(reason),
            Err(reason) => log::info!("no place of the screen from these touches: {reason}"),
        }
    }

    /// The screen where it is taken to lie, without a block.
    pub(in crate::touch) fn placed_screen(&self, rig: &Rig) -> Touchscreen {
        self.placement.as_ref().map_or(&rig.touchscreen, |placement| &placement.screen).clone()
    }

    /// Whether the place of the screen was measured.
    pub(super) fn screen_place(&self) -> ScreenPlace {
        if self.placement.is_some() { ScreenPlace::Measured } else { ScreenPlace::Nominal }
    }
}
