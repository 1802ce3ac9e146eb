//! The order of a list: it stays while the pointer is over the list, so that no line jumps away from under it.

use std::collections::HashSet;
use std::hash::Hash;

use egui::{Id, Rect, Ui};

/// What is kept of a list from frame to frame.
#[derive(Clone)]
struct Kept<K> {
    order: Vec<K>,
    area: Rect,
}

/// In which order lines are shown that are wanted in this one. While the pointer is over the list they stay where they
/// were: those that are new stand behind the others, and the wanted order comes when the pointer has left. Whoever asks
/// for another order (`asked`: another choice of it than in the frame before) has it at once.
pub fn in_order<K, A>(ui: &Ui, list: Id, wanted: Vec<K>, asked: A) -> Vec<K>
where
    K: Clone + Eq + Hash + Send + Sync + 'static,
    A: Clone + PartialEq + Send + Sync + 'static,
{
    let before: Option<A> = ui.data(|data| data.get_temp(list));
    let kept: Option<Kept<K>> = ui.data(|data| data.get_temp(list));
    let is_same = before.is_none_or(|before| before == asked);
    ui.data_mut(|data| data.insert_temp(list, asked));
    let held = kept.filter(|kept| is_same && is_over(ui, kept.area));
    held.map_or_else(|| wanted.clone(), |kept| held_order(&kept.order, &wanted))
}

/// Keeps the order that was shown, and where: everything above the list that is drawn next.
pub fn keep<K>(ui: &Ui, list: Id, order: Vec<K>, area: Rect)
where
    K: Clone + Send + Sync + 'static,
{
    ui.data_mut(|data| data.insert_temp(list, Kept { order, area }));
}

fn is_over(ui: &Ui, area: Rect) -> bool {
    ui.input(|input| input.pointer.hover_pos()).is_some_and(|at| area.contains(at))
}

/// Those that were shown in their order, then those that are new in theirs.
fn held_order<K: Clone + Eq + Hash>(shown: &[K], wanted: &[K]) -> Vec<K> {
    let (were, are): (HashSet<&K>, HashSet<&K>) = (shown.iter().collect(), wanted.iter().collect());
    let still = shown.iter().filter(|key| are.contains(key));
    let new = wanted.iter().filter(|key| !were.contains(key));
    still.chain(new).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_shown_stays_and_what_is_new_stands_behind_it() {
        assert_eq!(held_order(&[3, 1, 2], &[1, 2, 3]), [3, 1, 2]);
        assert_eq!(held_order(&[3, 1, 2], &[4, 2, 3]), [3, 2, 4], "one is gone, one is new");
        assert_eq!(held_order(&[], &[2, 1]), [2, 1]);
    }
}
