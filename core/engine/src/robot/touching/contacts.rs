//! Contacts that the touch window feels.

use std::sync::{Arc, Mutex, PoisonError};

use plumbline_hardware::joints::{ScreenGone, Touch, TouchSource};

/// The newest contact of the touch window. Clones are the same window.
#[derive(Clone, Debug, Default)]
pub struct WindowContacts(Arc<Mutex<Option<Touch>>>);

impl WindowContacts {
    /// A contact began, or ended.
    pub fn felt(&self, contact: Touch) {
        let mut newest = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match &mut *newest {
            // The end of a contact is told with the time of the end; what counts is its beginning.
            Some(known) if !contact.is_down => known.is_down = false,
            None if !contact.is_down => {}
            _ => *newest = Some(contact),
        }
    }
}

impl TouchSource for WindowContacts {
    fn newest(&mut self) -> Result<Option<Touch>, ScreenGone> {
        Ok(*self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
