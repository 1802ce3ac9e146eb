//! The window over made-up views: every state is drawn, and every click asks for the right thing.

mod commission;
mod covered;
mod drift;
mod experiment;
mod fake;
mod faults;
mod gap;
mod guidance;
mod labels;
mod layout;
mod made_up;
mod made_up_gap;
mod made_up_labels;
mod made_up_models;
mod made_up_objects;
mod made_up_touch;
mod models;
mod mount;
mod objects;
mod pictures;
mod robot;
mod stop;
mod touch;
mod touch_window;
mod twin;
mod words;
