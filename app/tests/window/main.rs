//! The window over made-up views: every state is drawn, and every click asks for the right thing.

mod fake;
mod guidance;
mod made_up;
mod mount;
mod pictures;
mod robot;
mod stop;
mod twin;
mod words;
