//! core/hardware
