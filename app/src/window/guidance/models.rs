//! What to do next with correction models.

use plumbline_engine::View;

use super::{Guidance, say};

pub(super) fn models(view: &View) -> Guidance {
    if view.models.next.is_empty() {
        return say("Models learn from touches: touch the screen first.");
    }
    say(view.models.next.clone())
}
