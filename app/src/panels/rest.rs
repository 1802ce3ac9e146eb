//! A button that means something else than a moment ago rests first: who hammers the one that stood
//! there must not press the next.

/// For so long, s.
const REST_S: f64 = 0.5;
/// Said where the pointer rests on such a button.
pub(crate) const WHY: &str = "It meant something else a moment ago: wait half a second";

/// What a button means, and since when.
pub(crate) struct Rest<T> {
    meaning: Option<T>,
    since_s: f64,
    until_s: f64,
    is_new: bool,
}

impl<T> Default for Rest<T> {
    fn default() -> Self {
        Self { meaning: None, since_s: f64::NEG_INFINITY, until_s: f64::NEG_INFINITY, is_new: true }
    }
}

impl<T: PartialEq> Rest<T> {
    /// Takes in what the button means in this frame; `None`: there is none. What the window opens with
    /// does not rest.
    pub(crate) fn see(&mut self, ctx: &egui::Context, meaning: Option<T>) {
        let now_s = ctx.input(|input| input.time);
        if self.meaning != meaning {
            self.meaning = meaning;
            (self.since_s, self.until_s) = match self.is_new {
                true => (f64::NEG_INFINITY, f64::NEG_INFINITY),
                false => (now_s, now_s + REST_S),
            };
        }
        self.is_new = false;
        // Who goes on hammering has not seen yet what it means now.
        let hammers = ctx.input(|input| input.pointer.any_pressed());
        if hammers && now_s < self.until_s {
            self.until_s = now_s + REST_S;
        }
        if now_s < self.until_s {
            ctx.request_repaint_after_secs((self.until_s - now_s) as f32);
        }
    }

    /// It was pressed: what it means next is not pressed by the same hand.
    pub(crate) fn begin(&mut self, ctx: &egui::Context) {
        self.since_s = ctx.input(|input| input.time);
        self.until_s = self.since_s + REST_S;
        ctx.request_repaint_after_secs(REST_S as f32);
    }

    /// It was pressed all the same, by a key: whoever hammers has not seen yet what it means now.
    pub(crate) fn go_on(&mut self, ctx: &egui::Context) {
        self.until_s = ctx.input(|input| input.time) + REST_S;
    }

    /// The same for what ends something: pressing it does not make it rest for longer.
    pub(crate) fn is_on_at_first(&self, ctx: &egui::Context) -> bool {
        ctx.input(|input| input.time) < self.since_s + REST_S
    }

    /// Whether it is not to be pressed yet.
    pub(crate) fn is_on(&self, ctx: &egui::Context) -> bool {
        ctx.input(|input| input.time) < self.until_s
    }
}
