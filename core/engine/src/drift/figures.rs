//! Two evaluations, or one with two corrections, side by side.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use plumbline_drift::{GridCorrection, Judged};
use plumbline_effects::RobotModel;

use super::Unjudged;
use super::command::GridSide;
use super::view::GridFigure;
use super::work::{Context, DriftWork};
use crate::ground::jobs::JobId;
use crate::ground::sessions::title_of;

/// The figures, and what is being computed for them.
#[derive(Clone, Debug, Default)]
pub(super) struct Figures {
    shown: [Option<GridFigure>; 2],
    judging: [Option<JobId>; 2],
}

impl Figures {
    pub fn view(&self) -> [Option<GridFigure>; 2] {
        self.shown.clone()
    }

    /// Shows a session with a correction, as soon as it is judged.
    pub fn show(
        &mut self,
        side: GridSide,
        session: &Path,
        correction: GridCorrection,
        model: &Arc<RobotModel>,
        context: &mut Context<'_>,
    ) {
        let k = side as usize;
        if let Some(job) = self.judging[k].take() {
            context.cancel(job);
        }
        // What is shown stays until the new figure is there, but for another session.
        let same = self.shown[k].take().filter(|shown| shown.session == session);
        let judged = same.filter(|shown| shown.correction == correction).map(|shown| shown.judged);
        self.shown[k] = Some(GridFigure {
            session: session.to_owned(),
            title: title_of(session),
            correction,
            judged: judged.unwrap_or(None),
        });
        self.judging[k] = Some(context.start(DriftWork::JudgeGrid {
            session: session.to_owned(),
            correction,
            model: model.clone(),
        }));
    }

    /// The session has changed, or the model has: what is shown of it is judged anew.
    pub fn again(
        &mut self,
        of: impl Fn(&GridFigure) -> bool,
        model: &Arc<RobotModel>,
        context: &mut Context<'_>,
    ) {
        for side in GridSide::BOTH {
            if let Some(shown) = self.shown[side as usize].clone().filter(|shown| of(shown)) {
                self.show(side, &shown.session, shown.correction, model, context);
            }
        }
    }

    /// Mean errors of a session as the description and as the model in use have it, m; `None`: both are not shown, or
    /// are being judged.
    pub fn both_m(&self, session: &Path) -> Option<[f64; 2]> {
        if self.judging.iter().any(Option::is_some) {
            return None;
        }
        let of = |correction| {
            let is_it = |shown: &&GridFigure| shown.session == session && shown.correction == correction;
            let judged = self.shown.iter().flatten().find(is_it)?.judged.as_ref()?;
            Some(judged.as_ref().ok()?.errors.mean_m)
        };
        Some([of(GridCorrection::Described)?, of(GridCorrection::Model)?])
    }

    /// Judged, or why not.
    pub fn judged(&mut self, id: JobId, judged: &Result<Arc<Judged>, Unjudged>) {
        for (judging, shown) in self.judging.iter_mut().zip(&mut self.shown) {
            if judging.take_if(|judging| *judging == id).is_some()
                && let Some(shown) = shown
            {
                shown.judged = Some(judged.clone());
            }
        }
    }

    /// Nothing came of judging.
    pub fn not_judged(&mut self, id: JobId, why: Option<&str>) {
        if let Some(why) = why {
            self.judged(id, &Err(Unjudged::Ended { said: why.to_owned() }));
        } else {
            self.judging.iter_mut().for_each(|judging| {
                judging.take_if(|judging| *judging == id);
            });
        }
    }

    /// Sessions that are shown.
    pub fn sessions(&self) -> impl Iterator<Item = &PathBuf> {
        self.shown.iter().flatten().map(|shown| &shown.session)
    }
}
