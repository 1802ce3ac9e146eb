//! The touch window: a second window, full screen on the touch monitor.
