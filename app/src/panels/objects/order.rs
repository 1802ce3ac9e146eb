//! The order of the lines of the list: it stays from pair to pair, so that no line jumps away from under the
//! pointer when another object becomes the surest.

use plumbline_engine::view::ObjectView;
use plumbline_model::Eye;

use super::key::{self, ObjectKey};

/// By class; of a class those that were listed before in their order, then new ones from left to right.
pub fn in_order<'a>(before: &[ObjectKey], objects: &'a [ObjectView]) -> Vec<&'a ObjectView> {
    let mut new: Vec<&ObjectView> = objects.iter().collect();
    new.sort_by(|a, b| across_px(a).total_cmp(&across_px(b)));
    let mut listed = Vec::with_capacity(new.len());
    for key in before {
        if let Some(i) = key.nearest(&new) {
            listed.push(new.remove(i));
        }
    }
    listed.append(&mut new);
    listed.sort_by(|a, b| a.name.cmp(&b.name));
    listed
}

fn across_px(object: &ObjectView) -> f64 {
    let seen = object.seen(Eye::Left).or_else(|| object.seen(Eye::Right));
    seen.map_or(f64::INFINITY, |seen| key::middle_px(seen)[0])
}
