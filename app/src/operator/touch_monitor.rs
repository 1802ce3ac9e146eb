//! Monitors, and whether the touch window fills the right one.

use plumbline_engine::ScreenWindow;
use plumbline_model::session::Touchscreen;

/// A monitor of this machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Monitor {
    /// As the system calls it.
    pub name: String,
    /// Physical pixels across and down.
    pub size_px: [u32; 2],
    /// Whether the main window is on it.
    pub is_ours: bool,
}

/// Why touches would not be felt at the right pixel; `None` when they are.
pub fn window_problem(window: &ScreenWindow, screen: &Touchscreen) -> Option<String> {
    let ScreenWindow { width_px, height_px, full_screen } = *window;
    if !full_screen {
        return Some("the touch window does not fill its monitor: press F11 in it".to_owned());
    }
    ((width_px, height_px) != (screen.width_px, screen.height_px)).then(|| {
        format!(
            "this monitor has {width_px}×{height_px} px, the touchscreen {}×{}: choose the other monitor or its full resolution",
            screen.width_px, screen.height_px
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn screen() -> Touchscreen {
        plumbline_model::robot::Rig::built_in("nico").expect("comes with the program").touchscreen
    }

    #[test]
    fn a_window_that_does_not_fit_says_so() {
        let screen = screen();
        let fits = ScreenWindow { width_px: screen.width_px, height_px: screen.height_px, full_screen: true };
        assert_eq!(window_problem(&fits, &screen), None);
        let tried = ScreenWindow { full_screen: false, ..fits.clone() };
        assert!(window_problem(&tried, &screen).expect("not full screen").contains("F11"));
        let other = ScreenWindow { width_px: 1280, ..fits };
        assert!(window_problem(&other, &screen).expect("another size").contains("1280"));
    }
}
