//! Where the room between the rail and the inspector is too narrow for tiles side by side: the same
//! panes as tabs, one at a time. The operator's own arrangement stays as it is for a wider window.

use std::collections::BTreeMap;

use egui_tiles::{Tile, TileId, Tiles, Tree};

use crate::operator::{Pane, Screen};

/// In less room than this two tiles beside each other are too narrow for what they hold, pt.
pub(super) const NARROW: f32 = 460.0;

/// The panes of each screen as tabs, as they were looked at last.
#[derive(Default)]
pub(super) struct NarrowTabs(BTreeMap<Screen, Tree<Pane>>);

impl NarrowTabs {
    /// All panes of an arrangement, in the order of reading.
    pub fn of(&mut self, screen: Screen, arrangement: &Tree<Pane>) -> &mut Tree<Pane> {
        let wanted = panes(arrangement);
        let tree = self.0.entry(screen).or_insert_with(|| tabs(screen, &wanted));
        if panes(tree) != wanted {
            *tree = tabs(screen, &wanted);
        }
        tree
    }

    /// Brings a pane to the front.
    pub fn show_pane(&mut self, screen: Screen, pane: Pane) {
        if let Some(tree) = self.0.get_mut(&screen) {
            tree.make_active(|_, tile| matches!(tile, Tile::Pane(shown) if *shown == pane));
        }
    }
}

fn tabs(screen: Screen, panes: &[Pane]) -> Tree<Pane> {
    let mut tiles = Tiles::default();
    let children = panes.iter().map(|pane| tiles.insert_pane(*pane)).collect();
    let root = tiles.insert_tab_tile(children);
    Tree::new(egui::Id::unique(("narrow tiles", screen)), root, tiles)
}

/// The panes of an arrangement, from left to right and from top to bottom.
fn panes(tree: &Tree<Pane>) -> Vec<Pane> {
    let mut found = Vec::new();
    if let Some(root) = tree.root() {
        collect(&tree.tiles, root, &mut found);
    }
    found
}

fn collect(tiles: &Tiles<Pane>, id: TileId, found: &mut Vec<Pane>) {
    match tiles.get(id) {
        Some(Tile::Pane(pane)) => found.push(*pane),
        Some(Tile::Container(container)) => {
            container.children().for_each(|child| collect(tiles, *child, found));
        }
        None => {}
    }
}

#[cfg(test)]
mod tests {
    use super::super::arrangement::default_arrangement;
    use super::*;

    #[test]
    fn every_pane_of_a_screen_is_a_tab_and_the_chosen_one_stays() {
        for screen in Screen::ALL {
            let arrangement = default_arrangement(screen);
            let mut narrow = NarrowTabs::default();
            let all = panes(&arrangement);
            assert_eq!(panes(narrow.of(screen, &arrangement)), all, "{screen:?}");
            let last = *all.last().expect("a screen has panes");
            narrow.show_pane(screen, last);
            let tree = narrow.of(screen, &arrangement);
            let shown: Vec<Pane> =
                tree.active_tiles().iter().filter_map(|id| tree.tiles.get_pane(id)).copied().collect();
            assert_eq!(shown, [last], "{screen:?}");
        }
    }

    #[test]
    fn another_arrangement_is_followed() {
        let mut narrow = NarrowTabs::default();
        narrow.of(Screen::Live, &default_arrangement(Screen::Live));
        let other = default_arrangement(Screen::Robot);
        assert_eq!(panes(narrow.of(Screen::Live, &other)), panes(&other));
    }
}
