//! File names inside a session folder.

/// The manifest.
pub const MANIFEST: &str = "session.toml";
/// Touches of the touchscreen.
pub const TOUCHES: &str = "touches.csv";
/// Stereo localizations of known places.
pub const LOCALIZATIONS: &str = "localizations.csv";
/// Externally measured points of the robot.
pub const POSES: &str = "poses.csv";
/// Folder of stereo images.
pub const STEREO: &str = "stereo";
/// Live streams.
pub const LOG: &str = "log.mcap";
