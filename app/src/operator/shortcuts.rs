//! Keys that do the same as buttons.

use egui::{Event, Key, KeyboardShortcut, Modifiers};
use plumbline_engine::View;

use super::{Action, DetectAction, LabelsAction, Screen, actions};

impl Action {
    /// Keys that do the same.
    pub fn shortcut(self) -> Option<KeyboardShortcut> {
        let plain = |key| Some(KeyboardShortcut::new(Modifiers::NONE, key));
        let command = |key| Some(KeyboardShortcut::new(Modifiers::COMMAND, key));
        let shift = |key| Some(KeyboardShortcut::new(Modifiers::COMMAND | Modifiers::SHIFT, key));
        match self {
            Self::Stop => plain(Key::Escape),
            Self::Next => command(Key::Enter),
            Self::OpenFolder => command(Key::O),
            Self::OpenVideos => shift(Key::O),
            Self::OpenPath => command(Key::L),
            Self::PlayPause => plain(Key::P),
            Self::StepForward => plain(Key::Period),
            Self::StepBack => plain(Key::Comma),
            Self::Go(Screen::Live) => command(Key::Num1),
            Self::Go(Screen::Collect) => command(Key::Num2),
            Self::Go(Screen::Judge) => command(Key::Num3),
            Self::Go(Screen::Accept) => command(Key::Num4),
            Self::Go(Screen::Mount) => command(Key::Num5),
            Self::Go(Screen::Robot) => command(Key::Num6),
            Self::Go(Screen::Touch) => command(Key::Num7),
            Self::Go(Screen::Models) => command(Key::Num8),
            Self::Go(Screen::Gap) => command(Key::Num9),
            Self::Go(Screen::Grasp) => command(Key::Num0),
            Self::Go(Screen::Images) => command(Key::D),
            Self::Go(Screen::Scores) => shift(Key::D),
            Self::Go(Screen::Drift) => shift(Key::W),
            Self::Go(Screen::Timeline) => shift(Key::T),
            Self::WatchDrift => plain(Key::W),
            Self::ToggleRecording => plain(Key::R),
            Self::Capture => plain(Key::C),
            Self::Detect(DetectAction::ToggleBoxes) => plain(Key::B),
            Self::DeleteLast => plain(Key::Backspace),
            Self::Undo => command(Key::Z),
            Self::Solve => shift(Key::S),
            Self::SaveWindow => command(Key::S),
            Self::Palette => command(Key::K),
            Self::ToggleInspector => command(Key::I),
            Self::ToggleLog => command(Key::J),
            Self::ToggleNotices => command(Key::M),
            Self::ToggleTheme => command(Key::T),
            Self::ResetArrangement => command(Key::R),
            Self::Help => plain(Key::F1),
            Self::ToggleFrameTimes => plain(Key::F12),
            Self::Quit => command(Key::Q),
            _ => None,
        }
    }

    /// Further keys.
    pub fn second_shortcut(self) -> Option<KeyboardShortcut> {
        match self {
            Self::Stop => Some(KeyboardShortcut::new(Modifiers::NONE, Key::Space)),
            Self::Palette => Some(KeyboardShortcut::new(Modifiers::COMMAND, Key::P)),
            _ => None,
        }
    }
}

/// Keys of classes, in their order.
const CLASS_KEYS: [Key; 9] =
    [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8, Key::Num9];

/// Takes the keys for drawing boxes out of this frame's input; what cannot be done is left to mean
/// what it means elsewhere.
pub fn take_label_keys(ctx: &egui::Context, view: &View) -> Vec<Action> {
    if ctx.text_edit_focused() || view.labels.set.is_none() {
        return Vec::new();
    }
    let keyed = LabelsAction::ALL.into_iter().filter_map(|action| Some((action.keys()?, action)));
    let mut keyed: Vec<(KeyboardShortcut, LabelsAction)> = keyed.collect();
    let redo = KeyboardShortcut::new(Modifiers::COMMAND, Key::Y);
    keyed.push((redo, LabelsAction::Redo));
    // Elsewhere it deletes a pair.
    let backspace = KeyboardShortcut::new(Modifiers::NONE, Key::Backspace);
    keyed.push((backspace, LabelsAction::DeleteBox));
    keyed.sort_by_key(|(keys, _)| !keys.modifiers.shift);
    let mut taken = Vec::new();
    for (keys, action) in keyed {
        // Enter presses the button that has the focus, unless something is proposed.
        let possible = action != LabelsAction::AcceptProposals || action.refusal(view).is_none();
        if possible && ctx.input_mut(|input| input.consume_shortcut(&keys)) {
            taken.push(Action::Labels(action));
        }
    }
    for (class, key) in CLASS_KEYS.into_iter().enumerate() {
        if ctx.input_mut(|input| input.consume_key(Modifiers::NONE, key)) {
            taken.push(Action::Labels(LabelsAction::Class(class)));
        }
    }
    taken
}

/// Shortcuts as text, for menus and hints.
pub fn shortcut_text(ctx: &egui::Context, action: Action) -> Option<String> {
    let local = if let Action::Labels(action) = action { action.keys() } else { None };
    let text = ctx.format_shortcut(&action.shortcut().or(local)?);
    // As it is printed on the keys.
    Some(text.replace("Escape", "Esc").replace("Period", ".").replace("Comma", ","))
}

/// What the keys that stop mean just now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StopKeys {
    /// Esc stops, and closes nothing.
    pub escape: bool,
    /// Something moves: space stops while a text is typed as well.
    pub moves: bool,
}

impl StopKeys {
    /// Both keys stop, whatever lies open.
    pub const ALWAYS: Self = Self { escape: true, moves: true };

    fn are_pressed(self, input: &egui::InputState, typing: bool) -> bool {
        self.escape && input.key_pressed(Key::Escape)
            || (self.moves || !typing) && input.key_pressed(Key::Space)
    }
}

/// Whether what stops was pressed in this frame; takes nothing away.
pub fn stop_asked(ctx: &egui::Context, keys: StopKeys) -> bool {
    let typing = ctx.text_edit_focused();
    ctx.input(|input| keys.are_pressed(input, typing))
}

/// Whether what stops was pressed, with whatever other keys are held. Where something moves that counts
/// while a text is typed as well: who presses it in alarm must not be asked where the cursor is. Space is
/// taken away where it is not typed, so that it does not press the button that has the focus too.
fn take_stop_keys(ctx: &egui::Context, typing: bool, keys: StopKeys) -> bool {
    ctx.input_mut(|input| {
        let pressed = keys.are_pressed(input, typing);
        if !typing && input.key_pressed(Key::Space) {
            input.events.retain(|event| !matches!(event, Event::Key { key: Key::Space, .. }));
        }
        pressed
    })
}

/// Takes the shortcuts out of this frame's input and returns their actions. While a text is
/// being typed only those with Ctrl count (and what stops, where it does), so that letters and space reach
/// the text.
pub fn take_shortcuts(ctx: &egui::Context, stop_keys: StopKeys) -> Vec<Action> {
    let typing = ctx.text_edit_focused();
    let mut taken = Vec::new();
    if take_stop_keys(ctx, typing, stop_keys) {
        taken.push(Action::Stop);
    }
    let mut shortcuts: Vec<(KeyboardShortcut, Action)> = actions::all()
        .filter(|action| *action != Action::Stop)
        .flat_map(|action| {
            [action.shortcut(), action.second_shortcut()]
                .into_iter()
                .flatten()
                .map(move |keys| (keys, action))
        })
        // Undo belongs to the text while one is typed.
        .filter(|(keys, action)| !typing || (keys.modifiers.command && *action != Action::Undo))
        .collect();
    // egui takes Ctrl+Shift+O for Ctrl+O too, so the longer ones come first.
    shortcuts.sort_by_key(|(keys, _)| !keys.modifiers.shift);
    // Nor does Ctrl+Shift+Z mean Ctrl+Z: it is redo wherever there is one, and nothing elsewhere.
    let shift = ctx.input(|input| input.modifiers.shift);
    for (keys, action) in shortcuts {
        let is_other = shift && !keys.modifiers.shift && action == Action::Undo;
        if !is_other && ctx.input_mut(|input| input.consume_shortcut(&keys)) {
            taken.push(action);
        }
    }
    taken
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_actions_share_a_shortcut_or_a_name() {
        let all: Vec<Action> = actions::all().collect();
        for (i, a) in all.iter().enumerate() {
            for b in &all[i + 1..] {
                assert_ne!(a.label(), b.label());
                let keys = |x: &Action| {
                    [x.shortcut(), x.second_shortcut()].into_iter().flatten().collect::<Vec<_>>()
                };
                for key in keys(a) {
                    assert!(!keys(b).contains(&key), "{a:?} and {b:?} share {key:?}");
                }
            }
        }
    }
}
