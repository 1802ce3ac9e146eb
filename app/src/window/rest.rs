//! A button that means something else than a moment ago rests first: who hammers the one that stood
//! there must not press the next.

/// For so long, s.
const REST_S: f64 = 0.5;
/// Said where the pointer rests on such a button.
pub(super) const WHY: &str = "It meant something else a moment ago: wait half a second";

/// What a button means, and since when.
pub(super) struct Rest<T> {
    meaning: Option<T>,
    until_s: f64,
    is_new: bool,
}

impl<T> Default for Rest<T> {
    fn default() -> Self {
        Self { meaning: None, until_s: f64::NEG_INFINITY, is_new: true }
    }
}

impl<T: PartialEq> Rest<T> {
    /// Takes in what the button means in this frame; `None`: there is none. What the window opens with
    /// does not rest.
    pub(super) fn see(&mut self, ctx: &egui::Context, meaning: Option<T>) {
        let now_s = ctx.input(|input| input.time);
        if self.meaning != meaning {
            self.meaning = meaning;
            self.until_s = if self.is_new { f64::NEG_INFINITY } else { now_s + REST_S };
        }
        self.is_new = false;
        // Who goes on hammering has not seen yet what it means now.
        let hammers = ctx.input(|input| input.pointer.any_pressed() || input.key_pressed(egui::Key::Enter));
        if hammers && now_s < self.until_s {
            self.until_s = now_s + REST_S;
        }
        if now_s < self.until_s {
            ctx.request_repaint_after_secs((self.until_s - now_s) as f32);
        }
    }

    /// It was pressed: what it means next is not pressed by the same hand.
    pub(super) fn begin(&mut self, ctx: &egui::Context) {
        self.until_s = ctx.input(|input| input.time) + REST_S;
        ctx.request_repaint_after_secs(REST_S as f32);
    }

    /// Whether it is not to be pressed yet.
    pub(super) fn is_on(&self, ctx: &egui::Context) -> bool {
        ctx.input(|input| input.time) < self.until_s
    }
}
