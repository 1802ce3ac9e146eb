//! The arrangement of tiles that each screen starts with.

use egui_tiles::{Container, Linear, LinearDir, TileId, Tiles, Tree};

use crate::operator::{Pane, Screen};

/// The arrangement that a screen starts with.
pub fn default_arrangement(screen: Screen) -> Tree<Pane> {
    let mut tiles = Tiles::default();
    let root = match screen {
        Screen::Commission => commission(&mut tiles),
        Screen::Live => live(&mut tiles),
        Screen::Collect => collect(&mut tiles),
        Screen::Judge => judge(&mut tiles),
        Screen::Accept => accept(&mut tiles),
        Screen::Mount => mount(&mut tiles),
        Screen::Touch => touch(&mut tiles),
        Screen::Models => models(&mut tiles),
        Screen::Gap => gap(&mut tiles),
        Screen::HandEye => handeye(&mut tiles),
        Screen::Grasp => grasp(&mut tiles),
        Screen::Drift => drift(&mut tiles),
        Screen::Timeline => timeline(&mut tiles),
        Screen::Robot => robot(&mut tiles),
        Screen::Scores => scores(&mut tiles),
        Screen::Images => images(&mut tiles),
    };
    Tree::new(egui::Id::unique(("tiles", screen)), root, tiles)
}

fn commission(tiles: &mut Tiles<Pane>) -> TileId {
    let steps = tabs(tiles, &[Pane::CommissionSteps]);
    let scene = tabs(tiles, &[Pane::Scene]);
    row(tiles, &[(steps, 1.25), (scene, 1.0)])
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

fn handeye(tiles: &mut Tiles<Pane>) -> TileId {
    let left = tabs(tiles, &[Pane::LeftEye]);
    let right = tabs(tiles, &[Pane::RightEye]);
    let parts = tabs(tiles, &[Pane::HandEyeParts]);
    let map = tabs(tiles, &[Pane::HandEyeMap, Pane::Scene]);
    let eyes = row(tiles, &[(left, 1.0), (right, 1.0)]);
    let seen = column(tiles, &[(eyes, 0.7), (map, 1.0)]);
    row(tiles, &[(seen, 1.6), (parts, 1.0)])
}

fn grasp(tiles: &mut Tiles<Pane>) -> TileId {
    let left = tabs(tiles, &[Pane::LeftEye]);
    let right = tabs(tiles, &[Pane::RightEye]);
    let scene = tabs(tiles, &[Pane::Scene, Pane::Twin, Pane::GraspAttempts, Pane::GraspExperiment]);
    // Steps, hand and result are as tall as a small window.
    let run = tabs(tiles, &[Pane::GraspRun]);
    let eyes = row(tiles, &[(left, 1.0), (right, 1.0)]);
    let seen = column(tiles, &[(eyes, 0.6), (scene, 1.0)]);
    row(tiles, &[(seen, 1.15), (run, 1.0)])
}

fn drift(tiles: &mut Tiles<Pane>) -> TileId {
    let course = tabs(tiles, &[Pane::DriftCourse, Pane::DriftGrid]);
    let table = tabs(tiles, &[Pane::DriftTable]);
    let eye = tabs(tiles, &[Pane::LeftEye, Pane::RightEye, Pane::Twin]);
    let right = column(tiles, &[(table, 1.25), (eye, 1.0)]);
    row(tiles, &[(course, 1.35), (right, 1.0)])
}

fn timeline(tiles: &mut Tiles<Pane>) -> TileId {
    let line = tabs(tiles, &[Pane::TimelineLine]);
    let in_use = tabs(tiles, &[Pane::TimelineInUse]);
    let compared = tabs(tiles, &[Pane::TimelineCompared]);
    let right = column(tiles, &[(in_use, 1.9), (compared, 1.0)]);
    row(tiles, &[(line, 1.5), (right, 1.0)])
}

fn robot(tiles: &mut Tiles<Pane>) -> TileId {
    let scene = tabs(tiles, &[Pane::Scene]);
    let jog = tabs(tiles, &[Pane::Jog, Pane::Twin]);
    let joints = tabs(tiles, &[Pane::Joints]);
    let poses = tabs(tiles, &[Pane::Poses]);
    // The pad needs its height on the smallest window too: rows of joints scroll, and so do postures.
    let left = column(tiles, &[(scene, 1.0), (joints, 1.1)]);
    let right = column(tiles, &[(jog, 2.8), (poses, 1.0)]);
    row(tiles, &[(left, 1.25), (right, 1.0)])
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
