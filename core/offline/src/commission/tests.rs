//! A whole commissioning, and one that is interrupted.
