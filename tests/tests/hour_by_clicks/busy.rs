//! Programs that want all of the processor.

use std::process::{Child, Command, Stdio};

/// They end when this is dropped.
pub struct Busy {
    programs: Vec<Child>,
}

impl Busy {
    /// So many, with the same priority as the test.
    ///
    /// # Panics
    /// Where there is no shell to start.
    pub fn programs(count: usize) -> Self {
        let start = || {
            let mut shell = Command::new("sh");
            shell.args(["-c", "while :; do :; done"]).stdin(Stdio::null());
            shell.spawn().expect("a shell that counts nothing")
        };
        Self { programs: (0..count).map(|_| start()).collect() }
    }
}

impl Drop for Busy {
    fn drop(&mut self) {
        for program in &mut self.programs {
            // Who has ended already needs no end.
            let _ = program.kill();
            let _ = program.wait();
        }
    }
}
