//! Changes of the tables, each of which can be taken back; files and figures follow behind.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;

use nalgebra::Vector3;
use plumbline_model::robot::{Posture, Rig};

use super::Tables;
use super::work::{TableFigures, TablesResult, TablesWork};
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::ground::text::sentence;
use crate::models::command::{GraspTable, TablesCommand};
use crate::models::view::TablesView;
use crate::models::work::{Context, ModelsWork};

/// Changes that can be taken back.
const HISTORY: usize = 100;

/// The tables of one world.
#[derive(Clone, Debug)]
pub struct TablesEditor {
    folder: PathBuf,
    now: Tables,
    history: VecDeque<Tables>,
    /// Counts changes.
    change: u64,
    figures: TableFigures,
    /// The work that keeps the tables, and of which change.
    keeping: Option<(JobId, u64)>,
}

impl TablesEditor {
    /// No tables. Files are kept in `folder`.
    pub fn new(folder: PathBuf) -> Self {
        Self {
            folder,
            now: Tables::default(),
            history: VecDeque::new(),
            change: 0,
            figures: TableFigures::default(),
            keeping: None,
        }
    }

    /// What was kept on disk is in use.
    pub fn restored(&mut self, tables: Tables, figures: TableFigures) {
        (self.now, self.figures) = (tables, figures);
    }

    /// Applies a command of the operator. `posture` is where the arm is.
    pub fn apply(
        &mut self,
        command: TablesCommand,
        rig: &Arc<Rig>,
        posture: Option<&Posture>,
        context: &mut Context<'_>,
    ) {
        let edited = match command {
            TablesCommand::Import { table, file } => {
                context.start(ModelsWork::Tables(TablesWork::Import { table, file }));
                return;
            }
            TablesCommand::Export { table, file } => return self.export(table, file, context),
            TablesCommand::Undo => return self.undo(rig, context),
            TablesCommand::Add { table, at_m, value } => self.now.with_point(table, at_m, value),
            TablesCommand::AddHere { table } => match palm(rig, posture) {
                Some((at_m, yaw_rad)) => {
                    let value = if table == GraspTable::Height { at_m[2] } else { yaw_rad };
                    self.now.with_point(table, at_m, value)
                }
                None => {
                    return context
                        .refuse("Where the palm is, is not known. Connect to the robot or the twin first.");
                }
            },
            TablesCommand::Change { table, point, at_m, value } => {
                self.now.with_changed(table, point, at_m, value)
            }
            TablesCommand::Remove { table, point } => self.now.without_point(table, point),
        };
        match edited {
            Ok(tables) => self.use_tables(tables, rig, context),
            Err(error) => context.refuse(sentence(&error.to_string())),
        }
    }

    fn export(&self, table: GraspTable, file: PathBuf, context: &mut Context<'_>) {
        let there = match table {
            GraspTable::Height => self.now.height.is_some(),
            GraspTable::Yaw => self.now.yaw.is_some(),
        };
        if there {
            context.start(ModelsWork::Tables(TablesWork::Export { table, file, tables: self.now.clone() }));
        } else {
            context.refuse("This table has no points yet. Import one or add points first.");
        }
    }

    fn undo(&mut self, rig: &Arc<Rig>, context: &mut Context<'_>) {
        match self.history.pop_back() {
            Some(before) => {
                self.now = before;
                self.changed(rig, context);
            }
            None => context.refuse("There is no change of the tables to take back."),
        }
    }

    fn use_tables(&mut self, tables: Tables, rig: &Arc<Rig>, context: &mut Context<'_>) {
        if self.history.len() == HISTORY {
            self.history.pop_front();
        }
        self.history.push_back(std::mem::replace(&mut self.now, tables));
        self.changed(rig, context);
    }

    fn changed(&mut self, rig: &Arc<Rig>, context: &mut Context<'_>) {
        self.change += 1;
        self.keep(rig, context);
    }

    /// Writes the tables and computes their figures, one such work at a time: a slow older one must
    /// not write over a newer one.
    fn keep(&mut self, rig: &Arc<Rig>, context: &mut Context<'_>) {
        if self.keeping.is_none() {
            let work =
                TablesWork::Keep { folder: self.folder.clone(), tables: self.now.clone(), rig: rig.clone() };
            self.keeping = Some((context.start(ModelsWork::Tables(work)), self.change));
        }
    }

    /// Work has ended with a result.
    pub fn work_done(&mut self, id: JobId, result: TablesResult, rig: &Arc<Rig>, context: &mut Context<'_>) {
        match result {
            TablesResult::Kept(figures) => {
                let kept = self.keeping.take_if(|(keeping, _)| *keeping == id);
                self.figures = figures;
                if kept.is_some_and(|(_, change)| change != self.change) {
                    self.keep(rig, context);
                }
            }
            TablesResult::Imported(read) => {
                let (tables, said) = self.now.with_read(&read);
                context.notices.add(NoticeLevel::Success, said);
                self.use_tables(tables, rig, context);
            }
            TablesResult::Exported(_) => {}
        }
    }

    /// Work has ended without a result; the next change tries again.
    pub fn work_ended(&mut self, id: JobId) {
        self.keeping.take_if(|(keeping, _)| *keeping == id);
    }

    /// What the window shows. Figures of an earlier change are left out.
    pub fn view(&self, rig: &Rig, posture: Option<&Posture>) -> TablesView {
        let figures = &self.figures;
        let of_now = |count: usize, errors: &[f64]| {
            if errors.len() == count && self.keeping.is_none() { errors.to_vec() } else { Vec::new() }
        };
        let heights = self.now.height.as_ref().map_or(0, |table| table.points.len());
        let yaws = self.now.yaw.as_ref().map_or(0, |table| table.points.len());
        TablesView {
            height: self.now.height.clone(),
            height_errors_m: of_now(heights, &figures.height_errors_m),
            height_field: figures.height_field.clone(),
            yaw: self.now.yaw.clone(),
            yaw_errors_rad: of_now(yaws, &figures.yaw_errors_rad),
            can_undo: !self.history.is_empty(),
            remarks: figures.remarks.clone(),
            palm: palm(rig, posture),
        }
    }
}

/// Place of the right palm, m, and the heading of its x axis, rad.
pub(in crate::models) fn palm(rig: &Rig, posture: Option<&Posture>) -> Option<([f64; 3], f64)> {
    let arm = rig.arm("right").or(rig.arms.first())?;
    let chain = rig.chain(&arm.tips.first()?.link).ok()?;
    let robot_from_palm = chain.robot_from_tip_in(posture?);
    let heading = robot_from_palm.isometry.rotation * Vector3::x();
    Some((robot_from_palm.translation_m().into(), heading.y.atan2(heading.x)))
}
