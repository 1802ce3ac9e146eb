//! Workers that the parts of the live view share.

use std::sync::Once;

use plumbline_model::priority::step_back;

/// Starts them, once. They step back behind the joint bus and the window whoever asks for them first: left to
/// themselves they would stand where that one stands, a thread that steps back or one that does not.
pub fn start_shared_workers() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let named = rayon::ThreadPoolBuilder::new().thread_name(|i| format!("live worker {i}"));
        if let Err(error) = named.start_handler(|_| step_back()).build_global() {
            log::debug!("shared workers are there already, or there are none: {error}");
        }
    });
}
