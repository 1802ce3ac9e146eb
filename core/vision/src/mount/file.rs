//! placeholder
/// Placeholder.
#[derive(Debug, thiserror::Error)]
pub enum MountFileError {}
