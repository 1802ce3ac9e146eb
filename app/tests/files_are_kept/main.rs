//! What the program does to files, as a whole program: an output is never one of its inputs, what is
//! no file is refused at once, and neither a full disk nor a kill takes a file that was there.
#![cfg(target_os = "linux")]
#![allow(clippy::print_stdout, reason = "a skipped test says why")]

mod desk;
mod full_disk;
mod inputs;
mod kills;
mod outputs;
mod sets;
