//! What computes steps back behind what must not wait: the joint bus and the window.

/// How far work steps back, on the scale of the system (0 usual, 19 last).
#[cfg(target_os = "linux")]
const NICE: i32 = 10;

/// Lets everything else on this machine go before the calling thread: where there are few processors, what
/// computes would leave the joint bus waiting. Threads that it starts afterwards inherit it, so it comes
/// before whatever starts some, and never on a thread that opens a bus.
///
/// Only on Linux, where it is of one thread; elsewhere it would be of the whole program.
pub fn step_back() {
    #[cfg(target_os = "linux")]
    {
        use rustix::process::{getpriority_process, setpriority_process};
        // Who started it may have stepped back before.
        if getpriority_process(None).is_ok_and(|now| now < NICE) {
            // Everybody may step back; where it is refused all the same, the work is done as ever.
            let _ = setpriority_process(None, NICE);
        }
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use rustix::process::getpriority_process;

    use super::*;

    #[test]
    fn a_thread_steps_back_alone_and_once() {
        let before = getpriority_process(None).expect("a thread has a priority");
        let stepped = std::thread::Builder::new().name("steps back".to_owned()).spawn(|| {
            step_back();
            let once = getpriority_process(None);
            step_back();
            (once, getpriority_process(None))
        });
        let stepped = stepped.expect("the system gives a thread");
        let (once, twice) = stepped.join().expect("it does not panic");
        assert_eq!(once, Ok(before.max(NICE)));
        assert_eq!(twice, once, "it goes back no further");
        assert_eq!(getpriority_process(None), Ok(before), "whoever started it goes on as before");
    }
}
