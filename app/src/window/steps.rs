//! The steps of the work, the arrangement of tiles that each one opens, and the panes in them.

use egui_tiles::{Container, Linear, LinearDir, TileId, Tiles, Tree};
use serde::{Deserialize, Serialize};

/// A screen: one arrangement of tiles, kept as the operator leaves it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Screen {
    /// Looking at the eyes.
    #[default]
    Live,
    /// Calibrating the eyes: choosing the board, collecting pairs, solving.
    Collect,
    /// Calibrating the eyes: judging what was solved.
    Judge,
    /// Calibrating the eyes: comparing with what is in use, accepting, files.
    Accept,
    /// Calibrating how the eyes sit in the head.
    Mount,
    /// Touching the screen: planning, running, placing the screen.
    Touch,
    /// Correction models, and the tables of grasp height and yaw.
    Models,
    /// The gap between model and measurement: compare, find, name, add, show.
    Gap,
    /// The robot: its joints, moving it.
    Robot,
    /// Detectors judged on a labeled data set.
    Scores,
    /// The lab's own data sets: capturing images, drawing boxes.
    Images,
}

impl Screen {
    /// All of them, in the order of work.
    pub const ALL: [Self; 11] = [
        Self::Live,
        Self::Collect,
        Self::Judge,
        Self::Accept,
        Self::Mount,
        Self::Touch,
        Self::Models,
        Self::Gap,
        Self::Robot,
        Self::Scores,
        Self::Images,
    ];

    /// Whether it belongs to "Detect".
    pub fn is_detect(self) -> bool {
        matches!(self, Self::Scores | Self::Images)
    }

    /// Whether it belongs to the step "Eyes".
    pub fn is_eyes(self) -> bool {
        matches!(self, Self::Collect | Self::Judge | Self::Accept)
    }
}

/// What a tile shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pane {
    /// The left eye as its camera delivers it.
    LeftEye,
    /// The right eye.
    RightEye,
    /// The aimed pair with its epipolar lines.
    Rectified,
    /// The aimed pair in red and cyan.
    Anaglyph,
    /// The aimed pair in turns.
    Blink,
    /// Disparity as colors.
    Disparity,
    /// Distance as colors.
    Depth,
    /// Which board, and the lens model.
    Board,
    /// Where the board has been.
    Coverage,
    /// The collected pairs.
    Pairs,
    /// Error of every pair and eye.
    PairErrors,
    /// The chosen pair with what is left of its errors.
    Residuals,
    /// The verdict and its figures.
    Figures,
    /// How well places on the table are known.
    Uncertainty,
    /// How far places on the table move against the calibration in use.
    Difference,
    /// Both calibrations side by side.
    Comparison,
    /// Reading and writing calibration files; earlier calibrations.
    Files,
    /// Robot, table and objects in three dimensions.
    Scene,
    /// The joints: where they are, where they should be.
    Joints,
    /// Moving a tip while a key is held.
    Jog,
    /// Poses with a name.
    Poses,
    /// What stands on the twin's table, its clock, its faults.
    Twin,
    /// Head poses from which the board was seen.
    HeadViews,
    /// How the eyes sit in the head: nominal, in use, proposed.
    EyeMount,
    /// What shall be touched, and what that will tell.
    TouchPlan,
    /// Targets and touches on the glass.
    TouchMap,
    /// The run under way, its figures, its last touches.
    TouchRun,
    /// Where the screen lies: nominal, in use, proposed.
    ScreenPlace,
    /// Training correction models.
    ModelTraining,
    /// All methods on the same held-out touches.
    ModelComparison,
    /// A model over the table, before and after, and its border.
    ModelMap,
    /// The tables of grasp height and yaw.
    GraspTables,
    /// Sessions and model, and how far they lie apart.
    GapCompare,
    /// What is missing, by name.
    GapNames,
    /// What the data say about every effect of the library.
    GapCandidates,
    /// What is left over the table.
    GapMap,
    /// Before and after on held-out rows.
    GapShown,
    /// What to measure next.
    GapNext,
    /// Models and findings so far.
    GapHistory,
    /// Which detectors are judged on what.
    ScoreChoice,
    /// Detectors compared.
    ScoreTable,
    /// Each class by itself.
    ScoreClasses,
    /// What was taken for what.
    ScoreConfusion,
    /// The images behind a cell of it.
    ScoreCell,
    /// The images of a data set.
    LabelList,
    /// One image, to draw boxes.
    LabelCanvas,
    /// The images as small pictures.
    LabelGallery,
    /// What is wrong in a data set; an import before it is accepted.
    LabelChecks,
}

impl Pane {
    /// Its title.
    pub fn title(self) -> &'static str {
        match self {
            Self::LeftEye => "Left eye",
            Self::RightEye => "Right eye",
            Self::Rectified => "Rectified pair",
            Self::Anaglyph => "Anaglyph",
            Self::Blink => "Blink",
            Self::Disparity => "Disparity",
            Self::Depth => "Depth",
            Self::Board => "Board",
            Self::Coverage => "Coverage",
            Self::Pairs => "Pairs",
            Self::PairErrors => "Error per pair",
            Self::Residuals => "Residuals",
            Self::Figures => "Verdict",
            Self::Uncertainty => "Uncertainty at the table",
            Self::Difference => "Difference at the table",
            Self::Comparison => "Comparison",
            Self::Files => "Files",
            Self::Scene => "Scene",
            Self::Joints => "Joints",
            Self::Jog => "Jog",
            Self::Poses => "Poses",
            Self::Twin => "Twin",
            Self::HeadViews => "Views",
            Self::EyeMount => "Mount of the eyes",
            Self::TouchPlan => "Plan",
            Self::TouchMap => "Touches",
            Self::TouchRun => "Run",
            Self::ScreenPlace => "Place of the screen",
            Self::ModelTraining => "Training",
            Self::ModelComparison => "Models compared",
            Self::ModelMap => "Model over the table",
            Self::GraspTables => "Grasp height and yaw",
            Self::GapCompare => "Compare",
            Self::GapNames => "Name and add",
            Self::GapCandidates => "Candidates",
            Self::GapMap => "Gap over the table",
            Self::GapShown => "Before and after",
            Self::GapNext => "Next experiment",
            Self::GapHistory => "History",
            Self::ScoreChoice => "Detectors and data set",
            Self::ScoreTable => "Detectors compared",
            Self::ScoreClasses => "Per class",
            Self::ScoreConfusion => "Confusion",
            Self::ScoreCell => "Images of the cell",
            Self::LabelList => "Data set",
            Self::LabelCanvas => "Boxes",
            Self::LabelGallery => "Gallery",
            Self::LabelChecks => "Checks",
        }
    }
}

/// The arrangement that a screen starts with.
pub fn default_arrangement(screen: Screen) -> Tree<Pane> {
    let mut tiles = Tiles::default();
    let root = match screen {
        Screen::Live => live(&mut tiles),
        Screen::Collect => collect(&mut tiles),
        Screen::Judge => judge(&mut tiles),
        Screen::Accept => accept(&mut tiles),
        Screen::Mount => mount(&mut tiles),
        Screen::Touch => touch(&mut tiles),
        Screen::Models => models(&mut tiles),
        Screen::Gap => gap(&mut tiles),
        Screen::Robot => robot(&mut tiles),
        Screen::Scores => scores(&mut tiles),
        Screen::Images => images(&mut tiles),
    };
    Tree::new(egui::Id::unique(("tiles", screen)), root, tiles)
}

fn live(tiles: &mut Tiles<Pane>) -> TileId {
    let left = tabs(tiles, &[Pane::LeftEye]);
    let right = tabs(tiles, &[Pane::RightEye]);
    let rectified = tabs(tiles, &[Pane::Rectified, Pane::Anaglyph, Pane::Blink]);
    let depth = tabs(tiles, &[Pane::Depth, Pane::Disparity]);
    let scene = tabs(tiles, &[Pane::Scene]);
    let twin = tabs(tiles, &[Pane::Twin, Pane::Joints]);
    let left = column(tiles, &[(left, 1.0), (rectified, 1.0)]);
    let right = column(tiles, &[(right, 1.0), (depth, 1.0)]);
    let robot = column(tiles, &[(scene, 0.8), (twin, 1.2)]);
    row(tiles, &[(left, 1.0), (right, 1.0), (robot, 0.85)])
}

fn collect(tiles: &mut Tiles<Pane>) -> TileId {
    let left = tabs(tiles, &[Pane::LeftEye]);
    let right = tabs(tiles, &[Pane::RightEye]);
    let board = tabs(tiles, &[Pane::Board]);
    let coverage = tabs(tiles, &[Pane::Coverage]);
    let pairs = tabs(tiles, &[Pane::Pairs]);
    let top = row(tiles, &[(left, 1.0), (right, 1.0)]);
    let bottom = row(tiles, &[(board, 0.9), (coverage, 1.3), (pairs, 0.9)]);
    column(tiles, &[(top, 1.0), (bottom, 1.2)])
}

fn judge(tiles: &mut Tiles<Pane>) -> TileId {
    let figures = tabs(tiles, &[Pane::Figures]);
    let errors = tabs(tiles, &[Pane::PairErrors]);
    let residuals = tabs(tiles, &[Pane::Residuals]);
    let uncertainty = tabs(tiles, &[Pane::Uncertainty]);
    let left = column(tiles, &[(figures, 1.55), (uncertainty, 1.0)]);
    let right = column(tiles, &[(errors, 1.0), (residuals, 1.25)]);
    row(tiles, &[(left, 1.0), (right, 1.55)])
}

fn accept(tiles: &mut Tiles<Pane>) -> TileId {
    let comparison = tabs(tiles, &[Pane::Comparison]);
    let difference = tabs(tiles, &[Pane::Difference]);
    let uncertainty = tabs(tiles, &[Pane::Uncertainty]);
    let files = tabs(tiles, &[Pane::Files]);
    let left = column(tiles, &[(comparison, 1.0), (files, 1.0)]);
    let right = column(tiles, &[(difference, 1.0), (uncertainty, 1.0)]);
    row(tiles, &[(left, 1.0), (right, 1.2)])
}

fn mount(tiles: &mut Tiles<Pane>) -> TileId {
    let left = tabs(tiles, &[Pane::LeftEye]);
    let right = tabs(tiles, &[Pane::RightEye]);
    let views = tabs(tiles, &[Pane::HeadViews]);
    let result = tabs(tiles, &[Pane::EyeMount]);
    let scene = tabs(tiles, &[Pane::Scene, Pane::Twin]);
    let top = row(tiles, &[(left, 1.0), (right, 1.0)]);
    let bottom = row(tiles, &[(views, 1.0), (result, 1.35), (scene, 0.85)]);
    column(tiles, &[(top, 0.9), (bottom, 1.2)])
}

fn touch(tiles: &mut Tiles<Pane>) -> TileId {
    let plan = tabs(tiles, &[Pane::TouchPlan, Pane::Scene, Pane::Twin]);
    let map = tabs(tiles, &[Pane::TouchMap]);
    let run = tabs(tiles, &[Pane::TouchRun, Pane::ScreenPlace]);
    let right = column(tiles, &[(map, 1.1), (run, 1.0)]);
    row(tiles, &[(plan, 1.0), (right, 1.15)])
}

fn models(tiles: &mut Tiles<Pane>) -> TileId {
    // All want height. Training and comparison follow each other; nobody looks at both maps at once.
    let work = tabs(tiles, &[Pane::ModelTraining, Pane::ModelComparison]);
    let maps = tabs(tiles, &[Pane::ModelMap, Pane::GraspTables]);
    row(tiles, &[(work, 1.0), (maps, 1.15)])
}

fn gap(tiles: &mut Tiles<Pane>) -> TileId {
    // Read from left to right: compare and name, then where it shows and that it shrinks.
    let work = tabs(tiles, &[Pane::GapCompare, Pane::GapNames, Pane::GapCandidates]);
    let map = tabs(tiles, &[Pane::GapMap]);
    let shown = tabs(tiles, &[Pane::GapShown, Pane::GapNext, Pane::GapHistory]);
    let right = column(tiles, &[(map, 1.0), (shown, 1.15)]);
    row(tiles, &[(work, 1.0), (right, 1.1)])
}

fn robot(tiles: &mut Tiles<Pane>) -> TileId {
    let scene = tabs(tiles, &[Pane::Scene]);
    let jog = tabs(tiles, &[Pane::Jog, Pane::Twin]);
    let joints = tabs(tiles, &[Pane::Joints]);
    let poses = tabs(tiles, &[Pane::Poses]);
    // Pad and rows of joints need their width on the smallest window too.
    let top = row(tiles, &[(scene, 1.0), (jog, 1.0)]);
    let bottom = row(tiles, &[(joints, 2.4), (poses, 1.0)]);
    column(tiles, &[(top, 1.12), (bottom, 1.0)])
}

fn scores(tiles: &mut Tiles<Pane>) -> TileId {
    let choice = tabs(tiles, &[Pane::ScoreChoice]);
    let table = tabs(tiles, &[Pane::ScoreTable, Pane::ScoreClasses]);
    let confusion = tabs(tiles, &[Pane::ScoreConfusion]);
    let cell = tabs(tiles, &[Pane::ScoreCell]);
    let top = row(tiles, &[(choice, 0.8), (table, 1.6)]);
    let bottom = row(tiles, &[(confusion, 1.0), (cell, 1.1)]);
    column(tiles, &[(top, 0.8), (bottom, 1.0)])
}

fn images(tiles: &mut Tiles<Pane>) -> TileId {
    let list = tabs(tiles, &[Pane::LabelList, Pane::LabelChecks]);
    let canvas = tabs(tiles, &[Pane::LabelCanvas]);
    let gallery = tabs(tiles, &[Pane::LabelGallery]);
    let right = column(tiles, &[(canvas, 4.2), (gallery, 1.0)]);
    row(tiles, &[(list, 0.55), (right, 1.45)])
}

fn tabs(tiles: &mut Tiles<Pane>, panes: &[Pane]) -> TileId {
    let children = panes.iter().map(|&pane| tiles.insert_pane(pane)).collect();
    tiles.insert_tab_tile(children)
}

fn row(tiles: &mut Tiles<Pane>, children: &[(TileId, f32)]) -> TileId {
    linear(tiles, LinearDir::Horizontal, children)
}

fn column(tiles: &mut Tiles<Pane>, children: &[(TileId, f32)]) -> TileId {
    linear(tiles, LinearDir::Vertical, children)
}

fn linear(tiles: &mut Tiles<Pane>, direction: LinearDir, children: &[(TileId, f32)]) -> TileId {
    let mut container = Linear::new(direction, children.iter().map(|(id, _)| *id).collect());
    for (id, share) in children {
        container.shares.set_share(*id, *share);
    }
    tiles.insert_container(Container::Linear(container))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arrangement_survives_being_saved() {
        for screen in Screen::ALL {
            let tree = default_arrangement(screen);
            let text = serde_json::to_string(&tree).expect("trees are plain data");
            let back: Tree<Pane> = serde_json::from_str(&text).expect("what was written can be read");
            assert_eq!(back, tree);
        }
    }

    #[test]
    fn no_pane_stands_twice_on_a_screen() {
        for screen in Screen::ALL {
            let tree = default_arrangement(screen);
            let mut panes: Vec<Pane> = tree
                .tiles
                .tiles()
                .filter_map(|tile| match tile {
                    egui_tiles::Tile::Pane(pane) => Some(*pane),
                    egui_tiles::Tile::Container(_) => None,
                })
                .collect();
            let count = panes.len();
            panes.sort();
            panes.dedup();
            assert_eq!(panes.len(), count, "{screen:?}");
        }
    }
}
