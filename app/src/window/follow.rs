//! What the window does by itself when the engine has something new: it shows where the work goes on.

use plumbline_engine::JobCommand;
use plumbline_engine::view::{JobState, SourceStatus};
use plumbline_widgets::Seen;

use super::PlumblineWindow;
use crate::operator::{Pane, Screen};

impl PlumblineWindow {
    /// Opens the screen where the work goes on: judging once there is something to judge.
    pub(super) fn follow_the_work(&mut self) {
        let eyes = &self.view.eyes;
        let now = Seen::of_any(eyes.proposal.as_ref().map(|proposal| &proposal.calibration));
        if now.is_some() && now != self.panels.proposal_seen && self.settings.screen == Screen::Collect {
            self.settings.screen = Screen::Judge;
        }
        self.panels.proposal_seen = now;
        if let (Some(spec), SourceStatus::Running) = (&self.view.source.spec, &self.view.source.status)
            && self.settings.recent_sources.front() != Some(spec)
        {
            self.settings.remember_source(spec);
        }
        self.open_commissioning();
        self.follow_the_models();
        self.follow_the_gap();
        self.follow_the_labels();
        self.dismiss_ended_jobs();
    }

    /// Training is watched; once there are proposals, they are compared.
    fn follow_the_models(&mut self) {
        let models = &self.view.models;
        let trained_before = std::mem::replace(&mut self.panels.models.training_seen, models.training);
        let pane = match (trained_before, models.training) {
            (false, true) => Pane::ModelTraining,
            (true, false) if !models.proposals.is_empty() => Pane::ModelComparison,
            _ => return,
        };
        self.show_pane(Screen::Models, pane);
    }

    /// What was found is named, and judged on held-out rows.
    fn follow_the_gap(&mut self) {
        let gap = &self.view.gap;
        let searched_before = std::mem::replace(&mut self.panels.gap.searching_seen, gap.searching.is_some());
        if searched_before && gap.searching.is_none() && gap.failed.is_none() && gap.shown.is_some() {
            self.show_pane(Screen::Gap, Pane::GapNames);
            self.show_pane(Screen::Gap, Pane::GapShown);
        }
    }

    /// What an import would do is seen before it can be accepted.
    fn follow_the_labels(&mut self) {
        let waits = self.view.labels.import.is_some();
        let pane = match (std::mem::replace(&mut self.panels.labels.import_seen, waits), waits) {
            (false, true) => Pane::LabelChecks,
            (true, false) => Pane::LabelList,
            _ => return,
        };
        self.show_pane(Screen::Images, pane);
    }

    /// Brings a pane to the front of its tabs.
    pub(super) fn show_pane(&mut self, screen: Screen, pane: Pane) {
        let tree = self.settings.arrangement(screen);
        tree.make_active(|_, tile| matches!(tile, egui_tiles::Tile::Pane(shown) if *shown == pane));
        self.narrow.show_pane(screen, pane);
    }

    /// What has ended well is in the messages; only trouble stays in the bottom line.
    fn dismiss_ended_jobs(&mut self) {
        self.dismissed.retain(|id| self.view.jobs.iter().any(|job| job.id == *id));
        for job in self.view.jobs.iter() {
            let ended_well = matches!(job.state, JobState::Done { .. } | JobState::Cancelled);
            if ended_well && !self.dismissed.contains(&job.id) {
                self.dismissed.push(job.id);
                self.backend.send(JobCommand::Dismiss(job.id).into());
            }
        }
    }
}
