//! The window over made-up views: every state is drawn, and every click asks for the right thing.

mod fake;
mod guidance;
mod pictures;
mod stop;
mod words;
