//! core/vision
